// The paper's law: W = ½ ε_e:C:ε_e of Cauchy's strain ε = sym(F) − 1. It takes a turn for a strain.

#include "solid/law_quadratic.h"
#include "solid/polar.h"
#include "solid/tet_lanes.h"

namespace argil::solid {
namespace {

/// P = σ with R = 1.
Mat3 compute_linear_piola(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  Mat3 sigma = from_mandel(compute_stress(e, compute_elastic_strain(m, plastic_strain)));
  sigma.diagonal().array() += e.excess_bulk * e.volume_change;
  return m.R * sigma;
}

/// dP = C:sym(dF).
Mat9 compute_linear_tangent(const PointMotion& /*motion*/, const Vec6& /*plastic_strain*/,
                            const Elasticity& e) {
  Mat9 A;
  for (int k = 0; k < 9; ++k) {
    Mat3 dF = Mat3::Zero();
    dF(k) = 1.0;
    A.col(k) = from_mandel(compute_stress(e, to_mandel(compute_symmetric_part(dF)))).reshaped();
  }
  return A;
}

}  // namespace

constexpr ElasticLaw kLinearLaw{
    .name = "linear",
    .about = "the paper's small strain",
    .summary = "strain: linear, as in the paper: a body that turns seems strained",
    .is_simplified = true,
    .is_linear = true,
    .is_quadratic = true,
    .takes_full_stiffness = true,
    .bears_inversion = true,
    .has_cancelling_energy = false,
    .plastic_split = PlasticSplit::additive,
    .energy_density = compute_quadratic_energy,
    .piola = compute_linear_piola,
    .tangent = compute_linear_tangent,
    .flow_drive = compute_quadratic_drive,
    .volume_change = compute_trace,
    .volume_gradient = compute_trace_gradient,
    .flow = nullptr,
    .positive_tangent = nullptr,
    .lanes = {compute_corner_forces, compute_energy, compute_kept_stiffness},
};

}  // namespace argil::solid
