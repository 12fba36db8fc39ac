#pragma once

#include "solid/part.h"
#include "solid/strained.h"

namespace argil::solid {

/// Internal forces at the present iterate.
struct Forces {
  Eigen::Matrix3Xd corner;     ///< of each corner, N columns a tet, and one more [N]
  Eigen::Matrix3Xd of_points;  ///< p2: V P ∇λ of each point, four columns a point [N]
  Points internal;             ///< 3×n: their sum at each node [N]
  VolumeChange volume;         ///< p1_nodal
};

/// Derivative of the elastic energy by the nodes' positions, of the nodes of `part`. `body` is strained with
/// the volume change in `forces`.
void assemble_forces(const Strained& body, const Part& part, Forces& forces);

/// Sum at the nodes of `part` of what their corners get.
void gather(const Model& model, const Part& part, const Eigen::Matrix3Xd& corner_force, Points& force);

}  // namespace argil::solid
