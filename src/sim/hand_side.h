#pragma once

#include <optional>
#include <vector>

#include "base/archive.h"
#include "contact/contact.h"
#include "device/chatter_watch.h"
#include "device/gate.h"
#include "device/sample.h"
#include "sim/clock.h"
#include "sim/compliance.h"
#include "sim/contact_surface.h"
#include "sim/exchange.h"
#include "sim/params.h"
#include "sim/record.h"
#include "sim/stage.h"
#include "sim/state.h"

namespace argil::sim {

/// The hand's side of the loop: the tool, its contacts with the surface that the body last had, and the force
/// that the device renders. It knows the body by ContactLoad and BodyAnswer alone, so that both sides may run
/// at their own pace; only a surface that yields between steps (`compliant`) looks at the body itself.
class HandSide {
 public:
  /// `params`, `surface` and `elements` are kept by reference.
  HandSide(const mesh::TriangleMesh& tool, const Params& params, const ContactSurface& surface,
           const solid::Elements& elements, const device::DeviceSample& start);
  HandSide(const HandSide&) = delete;
  HandSide& operator=(const HandSide&) = delete;

  /// Before the first tick: the hand is here.
  void begin_at(const device::DeviceSample& start);
  /// Does beforehand what the first ticks would take long for. From now on the hand's ticks are on one
  /// thread, as the body's have theirs at the same time.
  void prepare_alone();

  // Of a tick, in this order.
  /// The body's surface has moved; takes the answer's arrays and leaves others of their size. What the hand
  /// felt has fallen where no detection has found it anew since.
  void see(BodyAnswer& answer);
  /// The tool goes to where the hand is at the end of the tick.
  void move(const device::DeviceSample& sample);
  /// Contacts and the force on the hand. `begins_step`: the tick ends by give(). `body` for `compliant`.
  StepStatus touch(bool begins_step, const BodyAtFrame* body);
  /// Exchanges what was gathered since the last step for `empty`.
  void give(ContactLoad& empty);
  /// The force, old or new, through the passivity controller and the device's limits; ends the tick.
  void render(device::HandFeed feed);
  /// Failed when the force has trembled for so long that there may be no further tick.
  StepStatus status() const;

  /// After a step of the body and its answer, for `compliant`.
  StepStatus begin_frame(const BodyAtFrame& body, const Points& x_before);
  /// The surface stands at `x` (3×vertices), as if it had always.
  void place_surface(const Points& x);
  /// Does the tool touch or lie in a body whose surface is at x?
  bool overlaps(const Points& x) const { return m_detector.overlaps(x, m_state.tool); }
  /// Is every answer seen, and has nothing been gathered since? Only then is there a state to keep.
  bool is_between_steps() const { return m_ticks_since_step == 0 && m_load.stiffness.empty(); }

  const HandState& state() const { return m_state; }
  const Clock& clock() const { return m_clock; }
  const contact::Contacts& contacts() const { return m_contacts; }
  const device::GatedForce& gated() const { return m_gated; }
  HandPose pose() const { return {m_clock.tick, m_state.tool, {m_state.hand_force, m_state.hand_torque}}; }
  HapticRecord make_record() const;  ///< of the last tick
  void exchange_state(Archive& archive);
  /// After a return, with the body as it has returned.
  void see_again(const BodyState& body);
  void observe_stages(StageObserver* observer) { m_observer = observer; }

 private:
  // Stages of a tick: step.cpp.
  void contact_step(int ticks, const BodyAtFrame* body);
  StepStatus yielding_contact_step(const BodyAtFrame& body);

  // hand_side.cpp
  bool is_yielding() const;
  bool is_wetting() const;
  int steps_per_water() const {
    return m_params.rates.water_period_ticks / m_params.rates.physics_period_ticks;
  }
  void find_contacts(int ticks);
  bool finds_same_contacts();
  void move_surface(const Points& x);
  std::optional<double> find_surface_motion() const;
  void take_up_surface();
  void forget_motion();
  void act_on_body(const contact::Contact& c, const Vec3& force);
  void spread_contact_force();
  void add_contact_stiffness(const contact::Contact& c, const Vec3& force, bool pushes);
  void add_contact_stiffness(const contact::Contact& c, const Vec3& direction, double stiffness,
                             double force_at_rest);
  std::size_t find_group(const contact::Contact& c, std::size_t first, std::size_t pieces);
  void follow_with_springs();
  void make_springs();
  void exchange_contacts(Archive& archive);
  void exchange_springs(Archive& archive);

  const Params& m_params;
  const ContactSurface& m_surface;
  const solid::Elements& m_elements;
  double m_share;  // of the step in which a detection's contacts act, when it has as many ticks as planned
  Clock m_clock;
  HandState m_state;
  contact::ContactDetector m_detector;
  contact::Contacts m_contacts;
  // Since the last detection:
  bool m_has_all_moved = false;     // any vertex of the surface may have moved
  std::vector<int> m_moved;         // else these have
  bool m_is_surface_known = false;  // surface_x holds all vertices, also where they have not moved
  double m_pressed_weight = 0.0;    // Σ|force| of the last detection
  int m_still_detections = 0;       // in a row, in which neither tool nor surface had moved
  LocalCompliance m_compliance;
  std::vector<ContactSpring> m_springs;       // of the last detection, with their forces
  std::vector<std::size_t> m_spring_contact;  // and their places in m_contacts
  Points m_yielded_x;                         // 3×n, nodes as they have yielded between physics steps
  ContactLoad m_load;                         // gathered since the last step
  int m_ticks_since_step = 0;
  Tick m_steps_begun = 0;
  bool m_has_felt_anew = false;  // some detection since the last step
  device::ChatterWatch m_chatter;
  device::OutputGate m_gate;
  device::GatedForce m_gated;
  StageObserver* m_observer = nullptr;
};

}  // namespace argil::sim
