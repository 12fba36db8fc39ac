#pragma once

#include "base/mandel.h"
#include "base/types.h"

namespace argil::solid {

/// Working arrays: nothing in them outlives a call.
struct Scratch {
  Points product, direction;  ///< 3×n
  Points left, correction;    ///< a column a row: what δ leaves of the step, and what to add

  /// Of 4-node tets by a small displacement, the present rotations kept.
  struct {
    TensorField strain;
    Eigen::Matrix3Xd corner_force;
    Field volume, pressure;
  } change;

  /// p1_nodal
  struct {
    Field change, mean_kept, mean_exact;  ///< of volume, of each tet
    Eigen::Matrix3Xd gradient;
  } nodal;
};

}  // namespace argil::solid
