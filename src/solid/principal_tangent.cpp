#include "solid/principal_tangent.h"

namespace argil::solid {
namespace {

/// dP Fᵀ of l = dF F⁻¹, both in the directions of b.
Mat3 apply(const PrincipalTangent<double>& tangent, double lambda, const Mat3& l) {
  Mat3 change = Mat3::Zero();
  for (int i = 0; i < 3; ++i) change(i, i) = lambda * l.trace() + tangent.normal[i] * l(i, i);
  for (int k = 0; k < 3; ++k) {
    const int i = kPlanes[k][0], j = kPlanes[k][1];
    change(i, j) = tangent.own[k] * l(i, j) + tangent.coupling[k] * l(j, i);
    change(j, i) = tangent.next[k] * l(j, i) + tangent.coupling[k] * l(i, j);
  }
  return change;
}

}  // namespace

Mat9 make_tangent(const PrincipalTangent<double>& tangent, double lambda, const Mat3& directions,
                  const Mat3& inverse) {
  Mat9 A;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) {
      const Mat3 l = directions.row(row).transpose() * inverse.row(column);
      A.col(3 * column + row) = (directions * apply(tangent, lambda, l) * inverse.transpose()).reshaped();
    }
  return 0.5 * (A + A.transpose());  // which it is but for rounding
}

}  // namespace argil::solid
