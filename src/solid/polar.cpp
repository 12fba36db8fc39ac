#include "solid/polar.h"

#include <Eigen/SVD>

#include <cmath>

namespace argil::solid {
namespace {

Mat3 compute_rotation_by_svd(const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU();
  if (U.determinant() * svd.matrixV().determinant() < 0.0) U.col(2) = -U.col(2);
  return U * svd.matrixV().transpose();
}

}  // namespace

Mat3 compute_cofactor(const Mat3& a) {
  Mat3 c;
  c.col(0) = a.col(1).cross(a.col(2));
  c.col(1) = a.col(2).cross(a.col(0));
  c.col(2) = a.col(0).cross(a.col(1));
  return c;
}

Mat3 compute_rotation(const Mat3& F) {
  // Newton is quadratically convergent; from a condition number of 1e3 the scaled iteration needs at most 9
  // steps.
  constexpr int kMaxIterations = 12;
  constexpr double kSmallestRelativeDeterminant = 1e-8;
  const double norm = F.norm();
  const double det = F.determinant();
  if (!(det > kSmallestRelativeDeterminant * norm * norm * norm)) return compute_rotation_by_svd(F);
  Mat3 X = F;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const Mat3 cofactor = compute_cofactor(X);
    const double det_X = X.col(0).dot(cofactor.col(0));
    const Mat3 inverse_transposed = cofactor / det_X;
    const double change = (X - inverse_transposed).squaredNorm();
    // Error is half the change once the iteration is near; 1e-9 now means below 1e-18 after this step.
    const bool last = change < 1e-18;
    const double gamma = change < 1e-2 ? 1.0 : std::sqrt(inverse_transposed.norm() / X.norm());
    X = 0.5 * (gamma * X + inverse_transposed / gamma);
    if (last) return X;
  }
  return compute_rotation_by_svd(F);
}

}  // namespace argil::solid
