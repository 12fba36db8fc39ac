#pragma once

#include <vector>

#include "linear/cholesky.h"

namespace argil::water {

/// Matrix V + h L of an implicit step and its factor. L: conductances of the faces.
struct ImplicitSystem {
  linear::SparseCholesky factor;
  std::vector<int> row, column;  // of each stored number of the lower triangle
  std::vector<int> corner;       // face of the column's tet that leads to the row's; −1 on the diagonal
  double step = 0.0;             // h that the factor is of [s]; 0: none
  Field low_order;               // S after the two-point step
  Field solution;                // S with corrections
  Eigen::Matrix4Xd conductance;  // of each face with the D of its two tets at the step's start [m³/s]
};

}  // namespace argil::water
