#pragma once

#include "sim/external_force.h"
#include "sim/fidelity.h"
#include "sim/params.h"
#include "sim/state.h"

namespace argil::sim {

/// What a step of the body may leave out, and the sleep of a body that nothing moves: no physics, only
/// whether and how exactly it is computed.
class Economy {
 public:
  /// All are kept by reference. `is_loaded`: something acts on the body from the start.
  Economy(const Params& params, const Body& body, solid::Body& solid, solid::ActiveRegion& region);

  /// Before the first step: a body that nothing loads and no support moves rests from the start; only
  /// rounding would stir it.
  void begin(BodyState& state, bool is_loaded);
  /// Is the body left as it is in this step?
  bool rests(BodyState& state, const ContactLoad& load, const NodalForce& contacts);
  /// How exactly the step has to be solved.
  void set_budget(solid::StepLoads& loads) const;
  /// After its first assembly: does the body stop where it is, instead? `flows`: it did in the last step.
  bool stops(BodyState& state, const solid::StepLoads& loads, const NodalForce& contacts, bool flows);
  /// The step is made.
  void finish_step(const BodyState& state);

  bool is_full() const { return m_fidelity.is_full(); }
  const FidelityRecord& record() const { return m_fidelity.record(); }
  /// Of the body while it is at rest.
  const solid::StrainSummary& rest_strain() const { return m_rest_strain; }

  void commit();
  void roll_back();
  void serialize(Archive& archive);

 private:
  void fall_asleep(BodyState& state);
  bool sleeps_on(BodyState& state, const ContactLoad& load, const NodalForce& contacts);
  void find_reach(const BodyState& state, const OrderedItems& nodes);
  void watch_strain(const BodyState& state);

  const Params& m_params;
  solid::Body& m_solid;
  solid::ActiveRegion& m_region;
  bool m_is_moved = false;  // some support moves
  Fidelity m_fidelity, m_committed_fidelity;
  int m_slow_steps = 0, m_committed_slow_steps = 0;  // in a row, slower than rest_speed
  // Of a body that sleeps:
  Points m_held_back;  // 3×n [N], loads less internal forces, where nodes are free
  double m_held_back_squares = 0.0;
  solid::StrainSummary m_rest_strain;
};

}  // namespace argil::sim
