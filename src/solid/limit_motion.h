#pragma once

#include <vector>

#include "solid/part.h"
#include "solid/state.h"

namespace argil::solid {

struct Body;

/// What a step's motion was cut by, so that no tet turned inside out.
struct MotionLimit {
  int num_tets = 0;    ///< whose nodes were held back
  int worst_tet = -1;  ///< the one that would have been the flattest, as its mesh file numbers it; −1: none
};

/// Holds nodes back in a step that would turn tets inside out: to half of their way, and to half of that
/// again, until every tet is deformed by at most a half, ‖F F₀⁻¹ − 1‖ ≤ ½ with F₀ of the step's start, beyond
/// which no linearised step means anything, and its det F is at least a twentieth above the bound of the
/// parameters, or what it was where that is below. Clay around such a place moves on. Components that
/// supports prescribe are not held back.
class MotionLimiter {
 public:
  /// `body` is kept by reference.
  explicit MotionLimiter(const Body& body);
  /// Of the step that led from the committed state to `state`. Nodes that are held back lose as much of their
  /// speed.
  MotionLimit apply(const Part& part, SolidState& state);
  /// All nodes of `part` go so far of their way, 0 to 1, and lose as much of their speed.
  void scale(const Part& part, double share, SolidState& state) const;

 private:
  void find_tets(const Part& part);
  void find_tets_around(const std::vector<int>& nodes);
  Vec3 find_place(const SolidState& state, Eigen::Index node, double share) const;
  void hold_back(Eigen::Index node, double share, SolidState& state) const;
  /// Least over the tet's points by how much the bounds are kept; NaN where a place is not finite.
  double find_margin(const SolidState& state, int tet) const;

  const Body& m_body;
  std::vector<double> m_share;    // of its way, per node
  std::vector<char> m_is_listed;  // node or tet: in the list that is being made
  std::vector<char> m_is_held;    // tet: has had its nodes held back
  std::vector<int> m_tets, m_nodes, m_held_nodes;
};

}  // namespace argil::solid
