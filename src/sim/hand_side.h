#pragma once

#include <optional>
#include <vector>

#include "base/archive.h"
#include "contact/contact.h"
#include "contact/pressure.h"
#include "contact/surface_friction.h"
#include "device/sample.h"
#include "sim/compliance.h"
#include "sim/contact_load.h"
#include "sim/contact_surface.h"
#include "sim/force_between_steps.h"
#include "sim/grip.h"
#include "sim/kept_pressure.h"
#include "sim/params.h"
#include "sim/record.h"
#include "sim/stage.h"
#include "sim/state.h"
#include "sim/step_result.h"
#include "sim/touched_surface.h"

namespace argil::sim {

class BodySide;

/// The hand's side of the loop: the tool, its contacts with the surface that the body last had, and the force
/// that the device renders. It knows the body by ContactLoad and StepResult alone, so that both sides may run
/// at their own pace; only a surface that deflects between steps (pairs, `compliant`) looks at the body
/// itself.
class HandSide {
 public:
  /// All but `start` are kept by reference.
  HandSide(const mesh::TriangleMesh& tool, const Params& params, const ContactSurface& surface,
           BodySide& body, const device::DeviceSample& start);
  HandSide(const HandSide&) = delete;
  HandSide& operator=(const HandSide&) = delete;

  /// Before the first tick: the hand is here.
  void begin_at(const device::DeviceSample& start);
  /// Does beforehand what the first ticks would take long for. From now on the hand's ticks are on one
  /// thread, as the body's have theirs at the same time.
  void prepare_alone();

  // Stages of a tick, in the order of make_tick().
  /// Failed when the force has trembled for so long that there may be no further tick.
  StepStatus status() const;
  /// A step of the body has ended; takes the result's arrays and leaves others of their size. If no detection
  /// has come since the step began, the hand takes the force that the step left.
  void receive(StepResult& result);
  /// The tool goes to where the hand is at the end of the tick; books the work of the last force on the way.
  void advance(const device::DeviceSample& sample);
  /// Contacts over the path since the last detection, and the force on the hand. `begins_step`: the tick ends
  /// by hand_over(). In `hold` only then; in other ticks the last force stays.
  StepStatus find_contact_force(bool begins_step);
  /// Exchanges what was gathered since the last step for an empty load.
  void hand_over(ContactLoad& load);
  /// The force, old or new, through the passivity controller and the device's limits; ends the tick.
  void render(device::HandFeed feed);

  // Called by sim::tick alone.
  /// The tick is made.
  void commit();
  /// All is as after the last tick that was made. `load`: what this one has handed over; null: nothing.
  void roll_back(ContactLoad* load);

  /// After a step of the body and before its result, for pairs that are `compliant`.
  StepStatus update_compliance();
  /// The surface stands at `x` (3×vertices), as if it had always.
  void place_surface(const Points& x);
  /// Goes on as the hand of a body whose surface, now at `x`, has other vertices besides those it had.
  void go_on_from(const HandSide& before, const Points& x);
  /// What it presses on now; empty where nothing yields to it, or it holds.
  std::vector<PressedPoint> find_pressed();
  /// A surface at `x` is put under the tool so that it presses as it did before (keep_pressure). Returns
  /// where its vertices are then.
  Points put_under_tool(const std::vector<PressedPoint>& before, const Points& x);
  /// The load of a tool that stands where it was last told to be.
  void hand_over_still(ContactLoad& load);
  /// The body has settled under that: its surface stands at `x` now.
  void feel_settled(const StepResult& result, const Points& x);
  /// On the body, 3×n nodes [N]: pressures where the tool is now, scaled to the force that the hand feels.
  Points find_contact_force();
  /// Does it touch a body that yields to it, by the pressure law?
  bool is_pressing() const { return m_pressure && !keeps_shape() && m_state.num_contacts > 0; }
  /// Does the tool touch or lie in a body whose surface is at x?
  bool overlaps(const Points& x) const { return m_detector.overlaps(x, m_state.tool); }

  const HandState& state() const { return m_state; }
  const Clock& clock() const { return m_state.clock; }
  const contact::Contacts& contacts() const { return m_contacts; }
  const Points& surface_x() const { return m_touched.x_t0(); }  ///< vertices at the last detection [m]
  const device::GatedForce& gated() const { return m_state.gated; }
  HandPose pose() const {
    return {m_state.clock.tick, m_state.tool, {m_state.hand_force, m_state.hand_torque}};
  }
  HapticRecord make_record() const;  ///< of the last tick
  void serialize(Archive& archive);
  void observe_stages(StageObserver* observer) { m_observer = observer; }

 private:
  // step.cpp
  void find_penalty_force(int ticks);
  // pressure_contact.cpp
  void choose_yielding();
  bool keeps_shape() const;
  void update_grip();
  void find_pressure();
  void find_pressure_force(bool begins_step);
  ForceBetweenSteps::Unpressed find_unpressed(const contact::Pose& tool);
  void feel_between_steps();
  void meet_surface();
  double find_way_over_patch() const;
  PatchResolution find_resolution();
  void gather_pressure();
  // compliant_contact.cpp
  StepStatus find_compliant_force();
  void follow_with_springs();
  void make_springs();
  void press(const contact::Contact& contact, const Vec3& on_hand, const ContactSpring& spring);
  void release_springs();
  // hand_side.cpp
  void find_still_contacts();
  void prepare_detection(const Points& x);
  bool is_compliant() const;
  bool is_wetting() const;
  bool reverses() const { return !m_pressure && m_state.mode == device::ToolMode::pull; }
  void find_contacts(int ticks);
  bool finds_same_contacts();
  void gather_contact_forces();
  void limit_force(device::Wrench& felt) const;
  void note_answer(const StepResult& result);
  ForceErrorParts find_error() const;
  // snapshot.cpp, as serialize()
  void serialize_contacts(Archive& archive);
  void serialize_springs(Archive& archive);

  const mesh::TriangleMesh& m_tool;
  const Params& m_params;
  const ContactSurface& m_surface;
  BodySide& m_body;
  HandState m_state, m_committed;
  TouchedSurface m_touched;
  contact::ContactDetector m_detector;
  std::optional<contact::PressureContact> m_pressure;  // in place of the detector's pairs
  std::vector<contact::StiffnessOfTriangle>
      m_stiffness_before;                              // of m_pressure, where this tick has changed it
  std::optional<contact::SurfaceFriction> m_friction;  // with pressure
  std::optional<ForceBetweenSteps> m_between;          // likewise, where it is not held
  Grip m_grip;                                         // of a pulling tool, with pressure
  contact::Contacts m_contacts;                        // of the last detection
  contact::Contacts m_unpressed;                       // with the surface as if it had kept its shape
  contact::Pose m_told_tool;                           // where the present detection began
  device::Wrench m_felt;                               // in the present tick, where a step begins
  double m_most_force = 0.0;                           // [N] from a step of limited motion
  bool m_has_met_surface = false;                      // m_pressure knows where the surface is now
  int m_still_detections = 0;  // in a row, in which neither tool nor surface had moved
  LoadCollector m_collector;
  LocalCompliance m_compliance;
  std::vector<ContactSpring> m_springs, m_committed_springs;  // of the last detection, with their forces
  std::vector<std::size_t> m_spring_contact;                  // and their places in m_contacts
  Points m_deflected_x;  // 3×n, nodes as they have deflected between physics steps
  StageObserver* m_observer = nullptr;
};

}  // namespace argil::sim
