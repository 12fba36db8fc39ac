#include "solid/polar.h"

#include <Eigen/SVD>

#include "solid/polar_newton.h"

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
  Real33<double> from, rotation;
  Mat3::Map(from.m) = F;
  double is_found = 0.0;
  iterate_rotation(from, rotation, is_found);
  return is_found != 0.0 ? Mat3(Mat3::Map(rotation.m)) : compute_rotation_by_svd(F);
}

}  // namespace argil::solid
