#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/archive.h"
#include "base/ordered_loops.h"
#include "base/types.h"

namespace argil::sim {

/// How much of the model a run computes.
enum class FidelityMode {
  full,       ///< all of it, always
  automatic,  ///< what the force at the hand needs
  check,      ///< the same, beside a full run of the same motion (run/full_model.h)
};

struct FidelityParams {
  FidelityMode mode = FidelityMode::full;
  double force_tolerance = 0.01;  ///< of the force at the hand
  double force_floor = 0.02;      ///< [N] below which no error counts
};

/// What a step computes.
enum class Rung : std::uint8_t {
  asleep,    ///< nothing: the body stays where it is
  coasting,  ///< no solve: the body goes on as before
  solved,    ///< the step's equation
};

/// A step under `automatic`, as recorded.
struct FidelityRecord {
  Rung rung = Rung::solved;
  double bound = 0.0;     ///< [N] error that the force at the hand may have
  double estimate = 0.0;  ///< [N] that the step adds by what it leaves out
  double error = 0.0;     ///< check: [N] that it had since the last step
  double large_strain =
      0.0;  ///< of the force, by which another law of elasticity may differ: the mean strain [–]
};

/// Chooses what a step may leave out. Whatever it is, it leaves forces r in the body without balance. By the
/// reciprocity of Maxwell and Betti such a force changes that at the hand by g·r, where g is how far its node
/// goes when the place of contact is moved by a unit, so that the error is at most ‖g‖‖r‖. The reach ‖g‖
/// is read off the body: what the hand has done to it so far, over the largest displacement.
class Fidelity {
 public:
  /// `damped_steps`: over so many steps damping spreads what the body does under a force, β/τ. What these
  /// leave adds up as what has no common sign does, by the root of their number.
  explicit Fidelity(const FidelityParams& params, double damped_steps = 0.0)
      : m_params(params), m_stiffening(std::sqrt(std::max(1.0, damped_steps))) {}

  bool is_full() const { return m_params.mode == FidelityMode::full; }
  /// A step begins while the hand feels a force [N].
  void begin_step(const Vec3& felt_force);
  /// The body has gone from `rest` to `x`: how far forces on `nodes` of it reach.
  void find_reach(const Points& x, const Points& rest, const OrderedItems& nodes);
  /// [N] without balance that a step's solve may leave, and a region that is held where it is. What these
  /// leave stays in the body and is felt later, maybe at a small force and, where contacts come and go, much
  /// enlarged: so they have shares of the floor, and less while the force changes fast.
  double solve_slack() const;
  double region_slack() const;
  /// No solve may leave more [N]: the hand would feel it by more than the bound.
  double solve_limit() const;
  /// May a body that would hold `imbalance` [N] back, were it stopped, stop now? Of it, `held_back` [N] more
  /// is felt by what does not move as it is. It must have been so for some steps in a row, and not flow.
  bool falls_asleep(double imbalance, double held_back, bool flows);
  /// May a body that sleeps and holds back `imbalance` [N] go on so?
  bool sleeps_on(double imbalance, double held_back);
  /// The step was made, `is_solved`: by more than going on as before, and left so much without balance [N].
  void set_made(bool is_solved, double imbalance, double held_back);

  void set_large_strain(double mean_strain) { m_record.large_strain = mean_strain; }
  const FidelityRecord& record() const { return m_record; }
  void serialize(Archive& archive);

 private:
  double lasting_share() const;

  FidelityParams m_params;
  double m_stiffening;  // by damping, of what is left of the steps over which it spreads
  FidelityRecord m_record;
  double m_reach = 1.0;
  Vec3 m_felt_force = Vec3::Zero();
  double m_force_change = 0.0;  // since the last step [N]
  int m_calm_steps = 0;
};

}  // namespace argil::sim
