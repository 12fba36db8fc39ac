#pragma once

#include <cmath>
#include <optional>

#include "base/archive.h"
#include "sim/contact_load.h"
#include "sim/economy.h"
#include "sim/nodal_force.h"
#include "sim/params.h"
#include "sim/state.h"
#include "solid/recovered_error.h"

namespace argil::sim {

/// Every number of the rates, for an archive.
void serialize_rates(Archive& archive, const std::string& prefix, ForceErrorRates& rates);

/// Estimates, step by step, by how much the force at the hand is off, part by part (ForceErrorRates). Nothing
/// that a step computes depends on it.
///
/// While a tool presses, strain counts from the touch on, so that weight, swelling and older dents are no
/// part of what the hand does. Estimates that go through the whole body are found at the touch and then once
/// in some steps; in between they are so many parts of the force.
class ForceErrorEstimate {
 public:
  /// All are kept by reference.
  ForceErrorEstimate(const Params& params, solid::Body& solid, const solid::ActiveRegion& region);

  bool is_on() const { return m_recovered.has_value(); }
  /// Of a step: before the body moves.
  void begin_step(const ContactLoad& load);
  /// The step is solved; the body has its speed and moves next. `contacts`: what acted on it.
  void keep_solution(const ContactLoad& load, const NodalForce& contacts, const Points& v);
  /// After the first assembly of the next step, whose forces are those where the body is now.
  void check_last_step();
  /// The body has moved.
  void finish_step(const ContactLoad& load, const BodyState& state);
  /// Of the last step; also of one that left the body as it was. `economy`: what it left out.
  ForceErrorRates rates(const Economy& economy) const;

  /// Of a body with other cells: what was done until now counts on.
  void go_on_from(const ForceErrorEstimate& before);
  void commit() { m_committed = m_state; }
  void roll_back() { m_state = m_committed; }
  void serialize(Archive& archive);

 private:
  struct State {
    bool is_touched = false;
    int steps = 0;           // since the touch
    int next = 0;            // of these, in which it is found again
    solid::MeshError found;  // since the touch
    solid::MeshError kept;   // since the touch, with other cells
    ForceErrorRates rates;
    // Of a step that the next one checks:
    bool is_kept = false;
    double solved_power = 0.0;  // [W] that the internal forces at its end were solved to take
    double hand_power = 0.0;    // [W] of its force, at the speed of the tool or of the fastest node
    Vec3 tool = Vec3::Zero();   // where it was at the end of the last step [m]
    double reach = 0.0;         // root of Σ (uᵢ/u)² of the displacements uᵢ, u the largest
  };

  bool is_due() const { return m_state.steps >= m_state.next; }
  double find_stiffness_power(const Points& v) const;
  struct Pressing {
    double force = 0.0;  // [N]
    double depth = 0.0;  // of the tool below the surface, its mean by the force [m]
  };
  double find_unresolved(double cells) const;
  Pressing find_pressing(const ContactLoad& load) const;
  void find_reach(const Points& x);

  const Params& m_params;
  solid::Body& m_solid;
  const solid::ActiveRegion& m_region;
  std::optional<solid::RecoveredError> m_recovered;  // where it is on
  State m_state, m_committed;
};

}  // namespace argil::sim
