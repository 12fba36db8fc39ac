#pragma once

#include <vector>

#include "base/archive.h"
#include "contact/contact.h"

namespace argil::contact {

/// Coulomb friction of a pressure: every touched point hangs on the tool by a spring along the surface, as
/// stiff as its pressure, that slides beyond μ times the pressure. How far springs are stretched belongs to
/// the surface's vertices, and to points between them by their weights: a rigid motion is linear in the
/// place, so that points may come and go.
class SurfaceFriction {
 public:
  SurfaceFriction(double friction, int num_vertices);

  /// Adds to contacts between a tool that went from pose_t0 to pose_t1 and a surface that went from x_t0 to
  /// x_t1 before, what their springs would carry without a limit if the body stayed where it is. Successive
  /// calls must join.
  void stretch(const Points& x_t0, const Points& x_t1, const Pose& pose_t0, const Pose& pose_t1,
               Contacts& contacts);

  /// Of a surface of other vertices, which are at `x` where it was at x_t1 and went there from x_t0 since the
  /// last call: what belonged to a vertex goes to the nearest of these.
  void go_on_from(const SurfaceFriction& before, const Points& x_t0, const Points& x_t1, const Points& x);
  void commit() { m_committed = m_state; }
  void roll_back() { m_state = m_committed; }
  void serialize(Archive& archive);

 private:
  struct State {
    std::vector<int> vertex;    // those of the last call's contacts
    std::vector<Vec3> stretch;  // of their springs [m]
  };
  struct Limit {
    double stretch = 0.0;        // at which the spring of the hardest pressed of its points slides [m]
    Vec3 normal = Vec3::Zero();  // of its points, by weight and spring
  };

  void take_over(const Points& x_t0, const Points& x_t1, const Contacts& contacts);
  void limit_stretch(const Contacts& contacts);
  Vec3 find_stretch(const Contact& contact) const;

  double m_friction;
  State m_state, m_committed;
  State m_next;                 // working arrays, as are the rest
  std::vector<Limit> m_limits;  // of each vertex of the state
  std::vector<int> m_place;     // of each vertex of the surface in the state; −1: none
};

}  // namespace argil::contact
