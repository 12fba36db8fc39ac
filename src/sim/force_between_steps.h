#pragma once

#include <vector>

#include "base/archive.h"
#include "contact/contact.h"
#include "contact/pressure.h"
#include "device/gate.h"
#include "sim/contact_load.h"
#include "sim/params.h"
#include "sim/pressed_patch.h"

namespace argil::sim {

/// What the hand feels between two steps of a body that a pressure deforms, and what the body gets for it.
///
/// A step answers where the tool was with one force. As the tool goes on, that force grows like the one of an
/// elastic body under a patch that keeps its size, as stiff as the body is there along the patch's normal and
/// along the surface; friction keeps Coulomb's limit. Of clay that has hardly been pressed yet it is no
/// less than Hertz's force there, while the body as a whole gives way.
///
/// That is a forecast. What the hand felt more than the body got is owed to the body: a part of it is given
/// with every step, and all of it once the tool has left. So both get the same impulse.
class ForceBetweenSteps {
 public:
  /// `lag`: how far before the end of its way the tool was that a step answers for, in steps.
  ForceBetweenSteps(const RateParams& rates, double lag);

  /// Before the first tick: the tool is here.
  void begin_at(const contact::Pose& tool);
  /// The body is told of these contacts, found while the tool went from `from` to `to`, on a patch of that
  /// modulus and of such cells.
  void tell(const contact::Contacts& contacts, const contact::Patch& patch, const contact::Pose& from,
            const contact::Pose& to);
  /// Gives the body its part of what is owed, as forces in `load`.
  void repay(bool has_left, LoadCollector& load);
  /// The body has answered with this on the hand; `friction` is a part of its force [N]. K is by the body's
  /// compliance where the answer presses; where that is not known, that of a half-space.
  void receive(const device::Wrench& answer, const Vec3& friction, const PressedPatch& pressed = {});

  /// Between two steps that force has become this for the hand, which the body has not got.
  void change_answer(const device::Wrench& answer, const Vec3& friction);

  /// A surface that keeps its shape under a tool.
  struct Unpressed {
    Vec3 force = Vec3::Zero();  ///< on the hand [N]
    double stiffness = 0.0;     ///< by which that grows with the depth [N/m]
  };
  /// With the tool here, may the force come up to that of a surface that has not been pressed? Under a ball
  /// it does once the force is 4.4 times the answer, under a cone 5 times, under a flat tool never.
  bool may_be_unpressed(const contact::Pose& tool) const;
  bool knows_stiffness() const { return m_state.place.stiffness >= 0.0; }
  /// The last answer has not been compared yet.
  bool wants_compared() const { return presses() && m_state.place.share < 0.0; }
  /// With a surface as it is after the last answer, for the tool of it. What is more than the answer does not
  /// count as missing.
  void compare(const Unpressed& unpressed);
  const contact::Pose& tool() const { return m_state.place.tool; }  ///< for which the body has answered

  /// How the force is limited as the tool goes on.
  struct Limits {
    bool holds = false;     ///< a grip: it draws as it pushes, and does not slide
    double friction = 0.0;  ///< μ
    Unpressed unpressed;    ///< of clay that has not been pressed yet
  };
  /// On the hand, with the tool at `tool` now.
  device::Wrench forecast(const contact::Pose& tool, const Limits& limits) const;

  /// The hand has felt this for a tick.
  void feel(const Vec3& force);

  /// Of a surface of other vertices, which are at `x` where it was at `x_before`: what is owed goes to the
  /// nearest of them.
  void go_on_from(const ForceBetweenSteps& before, const Points& x_before, const Points& x);
  void commit() { m_committed = m_state; }
  void roll_back() { m_state = m_committed; }
  void serialize(Archive& archive);

 private:
  /// Where the body was told of the tool.
  struct Place {
    contact::Pose tool;
    Vec3 centre = Vec3::Zero();    // of what is touched [m]
    Vec3 outward = Vec3::Zero();   // unit: from the clay to the tool; zero without contacts
    bool has_passed = false;       // the tool has gone through what it touched, and leaves it behind
    double springs = 0.0;          // stiffness of the contacts themselves [N/m]
    double modulus = 0.0;          // E* [Pa] of the body there
    double cell = 0.0;             // edge of its cells there [m]
    double stiffness = -1.0;       // K along `outward` [N/m]; negative: not known
    Mat3 sideways = Mat3::Zero();  // of body and contacts in all directions [N/m]; zero: not known
    Vec3 drift = Vec3::Zero();     // of the body in the next step [m]
    double give = 0.0;             // of the body beside that of a half-space [m/N]
    double share = -1.0;           // of an unpressed surface's force that counts; negative: not known
  };
  struct State {
    Place told;   // the body has not answered yet
    Place place;  // of the last answer
    device::Wrench answer;
    Vec3 friction = Vec3::Zero();      // of its force [N]
    int ticks = 0;                     // that the hand has felt since the answer
    Vec3 excess = Vec3::Zero();        // Σ of what it felt beyond the answer in each [N]
    Vec3 owed = Vec3::Zero();          // to the body [N s]: its reaction is what the hand has felt too much
    std::vector<SurfaceForce> shares;  // of the last contacts, by their springs; sum 1 [–]
  };

  bool presses() const { return !m_state.place.outward.isZero(0.0); }

  void find_stiffness(const PressedPatch& pressed);
  Vec3 find_way(const contact::Pose& tool) const;
  double find_pressing(const contact::Pose& tool) const;
  Vec3 find_growth_along(const Vec3& way) const;
  Vec3 find_force(const Unpressed& unpressed) const;

  /// ½(N − 1) + N·lag: ticks by which the hand feels a steady growth before the body answers with it.
  double ticks_ahead() const;

  double m_period;  // δ [s]
  int m_planned;    // ticks of a step
  double m_lag;     // [steps]
  State m_state, m_committed;
};

}  // namespace argil::sim
