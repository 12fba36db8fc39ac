#pragma once

#include <array>
#include <vector>

#include "base/archive.h"
#include "contact/contact.h"

namespace argil::sim {

/// The patch that a pulling tool holds: each of its points hangs on a place of the tool by a spring that
/// pulls as it pushes, along the surface as across it, until the mean traction is more than the grip bears.
class Grip {
 public:
  explicit Grip(double strength) : m_strength(strength) {}

  bool holds() const { return !m_state.bonds.empty(); }
  /// It has torn off, and holds nothing more until release().
  bool has_let_go() const { return m_state.has_let_go; }

  /// Bonds the points of these contacts to the tool where they press on it: they carry the same forces. So
  /// does it points so near to it that which of them press is the mesh's doing; they carry none yet. That is
  /// what is held until the tool presses harder than now.
  void hold(const contact::Contacts& contacts, const Vec3& on_hand, const contact::Pose& tool);
  void release() { m_state = {}; }
  /// `on_hand` [N]: the force that the patch exerts on the tool. Lets go when it pulls by more than the grip
  /// bears; what presses does not count. Where the tool presses harder than when it took hold, it holds
  /// nothing: its patch grows.
  void test(const Vec3& on_hand, const contact::Pose& tool);

  /// The bonds as contacts with a surface at x (3×vertices), means over the tool's way.
  void find_contacts(const Points& x, const contact::Pose& from, const contact::Pose& to,
                     contact::Contacts& contacts) const;

  void commit() { m_committed = m_state; }
  void roll_back() { m_state = m_committed; }
  void serialize(Archive& archive);

 private:
  struct Bond {
    std::array<int, 3> vertex = {-1, -1, -1};  ///< of the surface; −1 beyond the last
    std::array<double, 3> weight = {};
    Vec3 place = Vec3::Zero();   ///< in the tool frame, where the point is without force [m]
    Vec3 normal = Vec3::Zero();  ///< in the tool frame: the way out of the tool, unit
    double stiffness = 0.0;      ///< [N/m], in all directions
    double area = 0.0;           ///< [m²]
  };
  struct State {
    std::vector<Bond> bonds;
    double pressing_force = 0.0;  ///< [N] when it took hold
    bool has_let_go = false;
  };

  Vec3 find_normal(const contact::Pose& tool) const;

  double m_strength;  // [Pa]
  State m_state, m_committed;
};

}  // namespace argil::sim
