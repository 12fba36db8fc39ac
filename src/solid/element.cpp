#include "solid/element.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <cmath>

namespace argil::solid {
namespace {

/// Strain (Mandel) of a displacement of one corner: Bᵢ with ε = Σ Bᵢ uᵢ.
Eigen::Matrix<double, 6, 3> make_strain_operator(const Vec3& g) {
  constexpr double s = 1.0 / kSqrt2;
  Eigen::Matrix<double, 6, 3> B;
  B << g(0), 0, 0,            //
      0, g(1), 0,             //
      0, 0, g(2),             //
      0, s * g(2), s * g(1),  //
      s * g(2), 0, s * g(0),  //
      s * g(1), s * g(0), 0;
  return B;
}

Mat3 compute_cofactor(const Mat3& a) {
  Mat3 c;
  c.col(0) = a.col(1).cross(a.col(2));
  c.col(1) = a.col(2).cross(a.col(0));
  c.col(2) = a.col(0).cross(a.col(1));
  return c;
}

Mat3 compute_rotation_by_svd(const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU();
  if (U.determinant() * svd.matrixV().determinant() < 0.0) U.col(2) = -U.col(2);
  return U * svd.matrixV().transpose();
}

}  // namespace

TetGeometry make_tet_geometry(const Mat34& rest) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = rest.col(k + 1) - rest.col(0);
  TetGeometry tet;
  tet.volume = edges.determinant() / 6.0;
  tet.gradient.rightCols<3>() = edges.inverse().transpose();
  tet.gradient.col(0) = -tet.gradient.rightCols<3>().rowwise().sum();
  return tet;
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

Vec6 compute_strain(const Mat3& F, const Mat3& R) {
  const Mat3 S = R.transpose() * F;
  return to_mandel(0.5 * (S + S.transpose()) - Mat3::Identity());
}

Mat6 make_isotropic_stiffness(double lambda, double mu) {
  Mat6 C = 2.0 * mu * Mat6::Identity();
  C.topLeftCorner<3, 3>().array() += lambda;
  return C;
}

Mat34 compute_element_force(const TetGeometry& tet, const Mat3& R, const Vec6& elastic_strain,
                            const Mat6& C) {
  const Mat3 sigma = from_mandel(C * elastic_strain);
  return tet.volume * (R * sigma) * tet.gradient;
}

Mat12 compute_element_stiffness(const TetGeometry& tet, const Mat3& R, const Mat6& C) {
  Eigen::Matrix<double, 6, 12> B;
  for (int i = 0; i < 4; ++i)
    B.middleCols<3>(3 * i) = make_strain_operator(tet.gradient.col(i)) * R.transpose();
  return tet.volume * B.transpose() * C * B;
}

}  // namespace argil::solid
