#pragma once

#include <memory>
#include <string>

#include "sim/body_side.h"
#include "sim/hand_side.h"
#include "sim/remap.h"
#include "sim/tick.h"

namespace argil::sim {

/// One body, one tool, one loop. Feed it a device sample a tick; read records and frames between ticks.
/// Same parameters and samples give the same bits on any number of threads.
class Simulation final : private BodySteps {
 public:
  /// `tool`: closed surface in the tool frame; `start`: pose and mode before the first tick.
  Simulation(Body body, const mesh::TriangleMesh& tool, const Params& params,
             const device::DeviceSample& start);

  /// One haptic tick: the tool goes to `sample`, the paper's loop runs, the hand gets its force. A physics
  /// step takes no time. After a tick that fails all is as before it.
  StepStatus tick(const device::DeviceSample& sample);
  /// The same with steps that the hand does not wait for: it receives what a step finds in the tick that
  /// `plan` says. A step that failed is told then.
  StepStatus tick(const device::DeviceSample& sample, const TickPlan& plan);

  /// Vertices of the touched surface, where they are after the last step (3×n) [m].
  Points surface_now() const;
  /// Between two steps: the body gets new cells in the shape that it has now. `body`: these, with skin,
  /// embedding and topology; what its clay is like, water, speed and strain, is taken over from the old ones
  /// (remap). The hand feels what it felt, but for what the new cells do not bear. False, and nothing has
  /// changed, where the clay of some cell would be pressed beyond what its law bears.
  bool renew_cells(Body body);
  /// The body has these cells, of which a snapshot was taken that is restored next.
  void restore_cells(Body body);

  /// Of the last step, also when its result has not been received.
  const StepStatus& step_status() const { return m_step_status; }

  /// Takes the body to its elastic equilibrium under its loads, without the tool. Kinematics, records and
  /// frames are those of the equilibrium then.
  StepStatus find_equilibrium();
  /// Does the tool touch or lie in the body as it is now? A run must not start so.
  bool tool_overlaps_body() const;

  /// The two sides, for a loop that runs each in a thread of its own.
  HandSide& hand() { return m_sides->hand; }
  const HandSide& hand() const { return m_sides->hand; }
  BodySide& body_side() { return m_sides->body; }
  const BodySide& body_side() const { return m_sides->body; }
  const HandState& hand_state() const { return hand().state(); }
  const BodyState& body_state() const { return body_side().state(); }
  const Body& body() const { return body_side().body(); }
  const Clock& clock() const { return hand().clock(); }
  const water::PoreWater& pore_water() const { return body_side().pore_water(); }
  const solid::Body& solid() const { return body_side().solid(); }
  const contact::Contacts& contacts() const { return hand().contacts(); }
  const Params& params() const { return m_params; }
  const mesh::TriangleMesh& tool() const { return m_tool; }  ///< its surface in its own frame
  /// Batch only, where the hand waits for every step: did the last tick make one?
  bool physics_due_last_tick() const {
    return clock().tick > 0 && clock().tick % m_params.rates.physics_period_ticks == 0;
  }
  bool frame_due_last_tick() const { return clock().tick % m_params.rates.frame_period_ticks == 0; }

  HapticRecord haptic_record() const { return hand().make_record(); }   ///< of the last tick
  PhysicsRecord physics_record() { return body_side().make_record(); }  ///< of the last physics step
  Frame make_frame();                                                   ///< the body as it is now
  /// SHA-256 of all that a tick takes from earlier ones: from equal hashes, equal samples lead to equal bits.
  std::string state_hash();

  /// All that a tick takes from earlier ones: bits after a return are those without.
  Snapshot take_snapshot();
  /// Goes on from `snapshot`, taken from a simulation of the same body, tool and parameters. `origin` is what
  /// messages call it. Throws IoError when it does not fit.
  void restore(const Snapshot& snapshot, const std::string& origin);
  /// The same without solver history, as where the mesh changes: goes on to the same motion, but for the
  /// tolerance of the solves.
  void restore_without_history(const Snapshot& snapshot, const std::string& origin);

  void observe_stages(StageObserver* observer) {
    m_observer = observer;
    hand().observe_stages(observer);
    body_side().observe_stages(observer);
  }

 private:
  void start_step(HandSide& hand) override;
  StepStatus receive_step(HandSide& hand) override;
  void serialize(Archive& archive);
  struct Sides;
  void set_sides(std::unique_ptr<Sides> sides);
  /// That go on from the present ones with other cells.
  std::unique_ptr<Sides> make_next_sides(Body body, const RemappedState& clay);
  /// What the balance has left beyond the strength flows, in a step without time, and the hand feels that.
  void settle();

  /// Body and hand, who know each other.
  struct Sides {
    Sides(Body of, const mesh::TriangleMesh& tool, const Params& params, const device::DeviceSample& start)
        : body(std::move(of), params), hand(tool, params, body.surface(), body, start) {}
    BodySide body;
    HandSide hand;
  };

  Params m_params;
  mesh::TriangleMesh m_tool;
  std::unique_ptr<Sides> m_sides;
  ContactLoad m_load;  // of the last step
  StepResult m_result;
  StepStatus m_step_status = StepStatus::ok();
  StageObserver* m_observer = nullptr;
};

}  // namespace argil::sim
