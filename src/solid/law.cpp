#include "solid/law.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "base/check.h"
#include "solid/polar.h"

namespace argil::solid {

PointMotion make_motion(StrainModel model, const Mat3& F) {
  return {F, find_law(model).is_linear ? Mat3(Mat3::Identity()) : compute_rotation(F)};
}

Vec6 compute_strain(const Mat3& F, const Mat3& R) {
  return to_mandel(compute_symmetric_part(R.transpose() * F) - Mat3::Identity());
}

Mat6 make_isotropic_stiffness(double lambda, double mu) {
  Mat6 C = 2.0 * mu * Mat6::Identity();
  C.topLeftCorner<3, 3>().array() += lambda;
  return C;
}

Vec6 compute_stress(const Elasticity& e, const Vec6& elastic_strain) {
  if (e.C) return *e.C * elastic_strain;
  Vec6 sigma = 2.0 * e.mu * elastic_strain;
  sigma.head<3>().array() += e.lambda * elastic_strain.head<3>().sum();
  return sigma;
}

double compute_energy_density(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                              const Elasticity& e) {
  return find_law(model).energy_density(motion, plastic_strain, e);
}

Mat3 compute_piola(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                   const Elasticity& e) {
  return find_law(model).piola(motion, plastic_strain, e);
}

Mat9 compute_tangent(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                     const Elasticity& e) {
  return find_law(model).tangent(motion, plastic_strain, e);
}

namespace {

Mat9 make_positive(const Mat9& A) {
  // A small multiple of the identity lets semi-definite matrices, which are fine, pass the quick test.
  const Mat9 shifted = A + 1e-9 * A.diagonal().cwiseAbs().maxCoeff() * Mat9::Identity();
  if (shifted.llt().info() == Eigen::Success) return A;
  const Eigen::SelfAdjointEigenSolver<Mat9> modes(A);
  return modes.eigenvectors() * modes.eigenvalues().cwiseMax(0.0).asDiagonal() *
         modes.eigenvectors().transpose();
}

}  // namespace

Mat9 compute_positive_tangent(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                              const Elasticity& e) {
  const ElasticLaw& law = find_law(model);
  if (law.positive_tangent) return law.positive_tangent(motion, plastic_strain, e);
  return make_positive(law.tangent(motion, plastic_strain, e));
}

Vec6 compute_flow_drive(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                        const Elasticity& e, double shape_stiffness) {
  const ElasticLaw& law = find_law(model);
  ARGIL_ASSERT(law.flow_drive, law.name);
  return law.flow_drive(motion, plastic_strain, e, shape_stiffness);
}

double compute_volume_change(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain) {
  return find_law(model).volume_change(motion, plastic_strain);
}

Mat3 compute_volume_gradient(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain) {
  return find_law(model).volume_gradient(motion, plastic_strain);
}

}  // namespace argil::solid
