#pragma once

#include <array>
#include <vector>

#include "base/archive.h"
#include "contact/pressure.h"

namespace argil::sim {

/// The patch that a pulling tool holds: vertices of the touched surface hang on places of the tool by springs
/// that pull as they push, along the surface as across it, until the mean traction is more than the grip
/// bears.
///
/// All springs together are kStiffness times as stiff as an elastic half-space under a disc as large as the
/// patch, 2 E* a, or as the cells that bear it. Each has its part by the square of the force that presses on
/// its vertex: that hardly hangs on κ, and a rim that hardly presses hardly holds.
class Grip {
 public:
  explicit Grip(double strength) : m_strength(strength) {}

  bool holds() const { return !m_state.bonds.empty(); }
  /// It has torn off, and holds nothing more until release().
  bool has_let_go() const { return m_state.has_let_go; }

  /// Bonds what these contacts press on to the tool. The bonds carry `on_hand` [N], which the body has
  /// answered to the tool there, shared out as the contacts press, and hold until the tool presses harder.
  /// The patch is no smaller than `patch` says. `x`: the touched surface's vertices (3×n) [m].
  void hold(const contact::Contacts& contacts, const contact::Patch& patch, const Points& x,
            const Vec3& on_hand, const contact::Pose& tool);
  /// The body gets these contacts for a step.
  void remember(const contact::Contacts& contacts);
  /// What the body has made of those, as its surface has gone from x_before to x: contacts that press with
  /// the forces of its step. They stay what they are where none are remembered.
  void find_pressed(const Points& x_before, const Points& x, contact::Contacts& contacts) const;
  void forget() { m_state.pressed.clear(); }
  void release();
  /// `on_hand` [N]: the force on the tool that the body has answered to it at `tool`; it is at `now` when the
  /// body gets the next one. Lets go when the patch pulls by more than the grip bears, or will there; what
  /// presses does not count. Where the tool presses harder than when it took hold, it holds nothing: its
  /// patch grows.
  void test(const Vec3& on_hand, const contact::Pose& tool, const contact::Pose& now);

  /// The bonds as contacts with a surface at x (3×vertices), means over the tool's way.
  void find_contacts(const Points& x, const contact::Pose& from, const contact::Pose& to,
                     contact::Contacts& contacts) const;

  /// Of a surface of other vertices, which are at `x` where it was at `x_before`: bonds go to the nearest of
  /// them, so that they carry what they carried. It lets go where most of the patch has none within its
  /// radius: the clay that it held is torn off.
  void go_on_from(const Grip& before, const Points& x_before, const Points& x, const contact::Pose& tool);
  void commit() { m_committed = m_state; }
  void roll_back() { m_state = m_committed; }
  void serialize(Archive& archive);

 private:
  struct Bond {
    int vertex = -1;             ///< of the surface
    Vec3 place = Vec3::Zero();   ///< in the tool frame, where the vertex is without force [m]
    Vec3 normal = Vec3::Zero();  ///< in the tool frame: the way out of the tool, unit
    double stiffness = 0.0;      ///< [N/m], in all directions
  };
  /// Of a contact that presses, or that is near enough to do so in a step.
  struct Pressed {
    std::array<int, 3> vertex = {-1, -1, -1};
    std::array<double, 3> weight = {};
    Vec3 normal = Vec3::Zero();
    double force = 0.0;      ///< along that [N], negative where it is apart
    double stiffness = 0.0;  ///< [N/m]
  };
  struct State {
    std::vector<Bond> bonds;
    std::vector<Pressed> pressed;  ///< in the last step, while nothing is held
    double area = 0.0;             ///< of the patch [m²]
    double pressing_force = 0.0;   ///< [N] when it took hold
    Vec3 answer = Vec3::Zero();    ///< the last one [N], on the hand
    Vec3 centre = Vec3::Zero();    ///< of the places, with the tool for which that was [m]
    bool has_let_go = false;
  };

  Vec3 find_normal(const contact::Pose& tool) const;
  Vec3 find_centre(const contact::Pose& tool) const;
  Vec3 forecast(const Vec3& on_hand, const Vec3& centre, const Vec3& now) const;
  bool bears(const Vec3& on_hand, const Vec3& normal) const;

  double m_strength;  // [Pa]
  State m_state, m_committed;
};

}  // namespace argil::sim
