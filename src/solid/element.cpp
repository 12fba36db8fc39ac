#include "solid/element.h"

#include <Eigen/LU>

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

Mat34 compute_element_force(const TetGeometry& tet, StrainModel model, const PointMotion& motion,
                            const Vec6& plastic_strain, const Elasticity& e) {
  return tet.volume * compute_piola(model, motion, plastic_strain, e) * tet.gradient;
}

Mat12 compute_element_stiffness(const TetGeometry& tet, const Mat3& R, const Mat6& C) {
  Eigen::Matrix<double, 6, 12> B;
  for (int i = 0; i < 4; ++i)
    B.middleCols<3>(3 * i) = make_strain_operator(tet.gradient.col(i)) * R.transpose();
  return tet.volume * B.transpose() * C * B;
}

Mat12 compute_element_stiffness(const TetGeometry& tet, const Mat9& tangent) {
  Mat12 K;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      K.block<3, 3>(3 * i, 3 * j) =
          tet.volume * compute_tangent_block(tet.gradient.col(i), tangent, tet.gradient.col(j));
  return K;
}

Mat3 compute_tangent_block(const Vec3& g_i, const Mat9& A, const Vec3& g_j) {
  Mat3 block = Mat3::Zero();
  for (int c = 0; c < 3; ++c)
    for (int d = 0; d < 3; ++d) block += g_i(c) * g_j(d) * A.block<3, 3>(3 * c, 3 * d);
  return block;
}

}  // namespace argil::solid
