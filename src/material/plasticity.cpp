#include "material/plasticity.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/lanes.h"
#include "base/mandel.h"

namespace argil::material {
namespace {

/// Norm of a symmetric tensor: Frobenius, or the Euclidean norm of its six components 11 22 33 23 13 12 with
/// tensor shear, as [Mueller2004] print it. The latter changes when the axes are turned.
double compute_norm(const Vec6& mandel, StrainNorm norm) {
  if (norm == StrainNorm::frobenius) return mandel.norm();
  return std::sqrt(mandel.head<3>().squaredNorm() + 0.5 * mandel.tail<3>().squaredNorm());
}

Vec6 deviator(Vec6 e) {
  e.head<3>().array() -= e.head<3>().sum() / 3.0;
  return e;
}

/// Share f ≤ `flow` at which ‖before + f q‖ reaches `max`: 0 when it lies there already.
double shorten_to_cap(const Vec6& before, const Vec6& q, double max, double flow) {
  const double a = q.squaredNorm();
  const double b = before.dot(q);
  const double room = max * max - before.squaredNorm();
  if (!(room > 0.0)) return 0.0;
  return std::min(flow, (std::sqrt(b * b + a * room) - b) / a);
}

}  // namespace

FlowRule make_flow_rule(const Plasticity& law, double step_s) {
  switch (law.form) {
    case FlowForm::rate:
      return {-std::expm1(-law.creep_per_s * step_s), false};
    case FlowForm::rate_to_yield:
      return {-std::expm1(-law.creep_per_s * step_s), true};
    case FlowForm::literal:
      return {law.creep_per_s * step_s, false};
    case FlowForm::j2:
      break;
  }
  return {1.0, true, law.rate_growth, law.reference_rate * step_s / kSqrt2};
}

double FlowRule::find_share(double norm, double yield) const {
  if (!stops_at_yield) return most;
  const double beyond = norm - yield;
  if (growth == 0.0 || !(beyond > reference_flow)) return std::min(most, 1.0 - yield / norm);
  // Δ + y a log₁₀(Δ/Δ₀) = norm − y. In u = ln(Δ/Δ₀) the left side is convex and rises, so that Newton's steps
  // from above fall to the root.
  constexpr int kMostSteps = 50;
  const double slope = growth * yield / std::numbers::ln10;
  double u = std::log(beyond / reference_flow);
  double flow = beyond;
  for (int i = 0; i < kMostSteps; ++i) {
    const double next = u - (flow + slope * u - beyond) / (flow + slope);
    if (!(next < u)) break;
    u = next;
    flow = reference_flow * std::exp(u);
  }
  return std::min(most, flow / norm);
}

double compute_yield_strain(const Plasticity& law, const Elastic& dry) {
  const double shear_modulus = dry.youngs_modulus / (2.0 * (1.0 + dry.poissons_ratio));
  return law.strength > 0.0 ? law.strength / (kSqrt2 * shear_modulus) : law.yield;
}

Vec6 compute_plastic_strain(const Vec6& strain, const Vec6& plastic_strain, const FlowPoint& point,
                            const Plasticity& law, double step_s) {
  Vec6 elastic = strain - plastic_strain;
  const bool is_j2 = law.form == FlowForm::j2;
  const bool is_driven = (law.deviatoric || is_j2) && point.drive;
  if (is_driven)
    elastic = *point.drive;
  else if (law.deviatoric || is_j2)
    elastic = deviator(elastic);
  const double elastic_norm = compute_norm(elastic, is_j2 ? StrainNorm::frobenius : law.norm);
  if (!(elastic_norm > point.yield)) return plastic_strain;
  const double flow = make_flow_rule(law, step_s).find_share(elastic_norm, point.yield);
  Vec6 after = plastic_strain + flow * elastic;
  const double norm = compute_norm(after, law.norm);
  if (!(law.max > 0.0 && norm > law.max)) return after;
  if (is_driven) return plastic_strain + shorten_to_cap(plastic_strain, elastic, law.max, flow) * elastic;
  return after * (law.max / norm);
}

double compute_shape_stiffness(const Mat6& C) {
  Mat6 shape;  // dev C dev
  for (int k = 0; k < 6; ++k) shape.col(k) = deviator(C.col(k));
  for (int k = 0; k < 6; ++k) shape.row(k) = deviator(Vec6(shape.row(k).transpose())).transpose();
  return Eigen::SelfAdjointEigenSolver<Mat6>(shape, Eigen::EigenvaluesOnly).eigenvalues()(5);
}

Vec6 compute_stress_drive(const Vec6& stress, double shape_stiffness) {
  return deviator(stress) / shape_stiffness;
}

ARGIL_EVERY_PROCESSOR unsigned find_flowing(const double* strain, const double* plastic_strain,
                                            const double* yield, const Plasticity& law, std::ptrdiff_t begin,
                                            std::ptrdiff_t end) {
  constexpr double kCertain = 1.0 - 1e-10;  // squares are rounded otherwise than norms
  Lanes total[6], plastic[6], limit;
  read_lanes<6>(strain, begin, end - 1, total);
  read_lanes<6>(plastic_strain, begin, end - 1, plastic);
  read_lanes<1>(yield, begin, end - 1, &limit);
  const bool is_j2 = law.form == FlowForm::j2;
  const Lanes trace = total[0] - plastic[0] + (total[1] - plastic[1]) + (total[2] - plastic[2]);
  const Lanes mean = law.deviatoric || is_j2 ? trace / 3.0 : Lanes{};
  const double shear_weight = is_j2 || law.norm == StrainNorm::frobenius ? 1.0 : 0.5;
  Lanes squares = {};
  for (int k = 0; k < 3; ++k) {
    const Lanes e = total[k] - plastic[k] - mean;
    squares += e * e;
  }
  for (int k = 3; k < 6; ++k) {
    const Lanes e = total[k] - plastic[k];
    squares += shear_weight * (e * e);
  }
  const Lanes stays = squares <= kCertain * limit * limit ? Lanes{} + 1.0 : Lanes{};  // a NaN does not
  unsigned found = 0;
  for (int lane = 0; lane < static_cast<int>(end - begin); ++lane)
    found |= stays[lane] == 0.0 ? 1U << lane : 0U;
  return found;
}

double compute_clay_weight(double r, const ClayKernel& kernel) {
  const double near = 1.0 + kernel.k1 * r;
  if (r < kernel.radius) return 1.0 / near;
  const double exponent = kernel.k2 * r;
  constexpr double kLargestExponent = 700.0;  // e^709.8 is the last finite double
  return exponent > kLargestExponent ? 0.0 : 1.0 / (near + std::exp(exponent));
}

double compute_clay_factor(double r, const ClayKernel& kernel, double step_s) {
  switch (kernel.form) {
    case KernelForm::off:
      return 1.0;
    case KernelForm::per_step:
      return compute_clay_weight(r, kernel);
    case KernelForm::rate:
      return std::pow(compute_clay_weight(r, kernel), step_s / kernel.reference_step);
  }
  return 1.0;
}

}  // namespace argil::material
