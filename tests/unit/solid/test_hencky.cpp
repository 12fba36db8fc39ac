// Hencky's law against closed forms: at a point, where stretches are repeated, and of a bar of tets.
#include <Eigen/LU>
#include <unsupported/Eigen/MatrixFunctions>

#include <cmath>

#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

constexpr double kE = 2e5;
constexpr double kNu = 0.3;
constexpr StrainModel kHencky = StrainModel::hencky;

Elasticity make_elasticity(double E = kE, double nu = kNu) {
  const TetMaterial m = test::make_material(E, nu);
  return {m.lambda, m.mu};
}

double find_energy(const Mat3& F, const Elasticity& e = make_elasticity()) {
  return compute_energy_density(kHencky, make_motion(kHencky, F), Vec6::Zero(), e);
}

Mat3 find_piola(const Mat3& F, const Elasticity& e = make_elasticity()) {
  return compute_piola(kHencky, make_motion(kHencky, F), Vec6::Zero(), e);
}

/// τ = P Fᵀ [Pa], which is J times the true stress.
Mat3 find_kirchhoff_stress(const Mat3& F) {
  return find_piola(F) * F.transpose();
}

Mat9 find_tangent(const Mat3& F, const Elasticity& e = make_elasticity()) {
  return compute_tangent(kHencky, make_motion(kHencky, F), Vec6::Zero(), e);
}

Mat3 make_turn(double angle, const Vec3& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

TEST(Hencky, UniaxialStretchHasTheStressOfALinearSpringInTheLogarithm) {
  // Lateral strains −ν ln s: τ = E ln s along the bar, nothing across, W = ½ E (ln s)².
  for (const double s : {0.2, 0.9, 1.0 + 1e-9, 1.5, 6.0}) {
    const Vec3 stretch(s, std::pow(s, -kNu), std::pow(s, -kNu));
    const double strain = std::log(s);
    const Mat3 tau = find_kirchhoff_stress(stretch.asDiagonal());
    EXPECT_NEAR(tau(0, 0), kE * strain, 1e-14 * kE) << s;
    EXPECT_LT((tau - tau(0, 0) * Vec3::UnitX() * Vec3::UnitX().transpose()).norm(), 2e-15 * kE) << s;
    EXPECT_NEAR(find_energy(stretch.asDiagonal()), 0.5 * kE * strain * strain, 1e-14 * kE * std::abs(strain));
  }
}

TEST(Hencky, SimpleShearHasTheClosedForm) {
  // Principal strains ±a, a = asinh ½γ, in axes turned by θ with tan 2θ = 2/γ: τ₁₂ = 2μ a/√(1 + ¼γ²),
  // τ₁₁ = −τ₂₂ = ½γ τ₁₂, W = 2μ a².
  for (const double shear : {1e-8, 1e-3, 0.5, 3.0, 20.0}) {
    Mat3 F = Mat3::Identity();
    F(0, 1) = shear;
    const double mu = make_elasticity().mu;
    const double a = std::asinh(0.5 * shear);
    const double tau = 2.0 * mu * a / std::sqrt(1.0 + 0.25 * shear * shear);
    Mat3 expected = Mat3::Zero();
    expected(0, 1) = expected(1, 0) = tau;
    expected(0, 0) = 0.5 * shear * tau;
    expected(1, 1) = -0.5 * shear * tau;
    EXPECT_LT((find_kirchhoff_stress(F) - expected).norm(), 1e-14 * (1.0 + shear * shear) * kE) << shear;
    EXPECT_NEAR(find_energy(F), 2.0 * mu * a * a, 1e-14 * (1.0 + shear) * kE * a) << shear;
  }
}

TEST(Hencky, PureDilatationHasThreeTimesTheBulkModulus) {
  const double K = kE / (3.0 * (1.0 - 2.0 * kNu));
  for (const double s : {0.05, 0.7, 1.0 + 1e-10, 1.3, 9.0}) {
    const Mat3 F = s * make_turn(0.7, Vec3(1, 2, -2));
    const double logarithm = std::log(s);
    const Mat3 tau = find_kirchhoff_stress(F);
    EXPECT_LT((tau - 3.0 * K * logarithm * Mat3::Identity()).norm(), 1e-14 * K * (1.0 + 0.1 / s)) << s;
    EXPECT_NEAR(find_energy(F), 4.5 * K * logarithm * logarithm, 1e-14 * K * std::abs(logarithm)) << s;
  }
}

TEST(Hencky, IsTheLogarithmOfTheMatrix) {
  // ε = ½ log FᵀF by Eigen's inverse scaling and squaring, which knows nothing of principal stretches.
  Rng rng(7);
  const Elasticity e = make_elasticity();
  for (int k = 0; k < 50; ++k) {
    Mat3 F;
    do {
      for (int i = 0; i < 9; ++i) F(i) = rng.uniform(-1.0, 1.0);
    } while (F.determinant() < 0.1);
    const Mat3 strain = 0.5 * Mat3(F.transpose() * F).log();
    const Mat3 deviator = strain - strain.trace() / 3.0 * Mat3::Identity();
    const double bulk = e.lambda + 2.0 / 3.0 * e.mu;
    const double energy = e.mu * deviator.squaredNorm() + 0.5 * bulk * std::pow(strain.trace(), 2);
    EXPECT_NEAR(find_energy(F), energy, 1e-11 * energy) << k;
    // P = F⁻ᵀ (2μ dev ε + K tr ε 1), as ε and FᵀF commute.
    const Mat3 tau = 2.0 * e.mu * deviator + bulk * strain.trace() * Mat3::Identity();
    const Mat3 P = F.inverse().transpose() * tau;
    EXPECT_LT((find_piola(F) - P).norm(), 1e-11 * P.norm()) << k;
  }
}

TEST(Hencky, SmallStrainsKeepTheirDigits) {
  const Elasticity e = make_elasticity();
  for (const double size : {1e-5, 1e-8}) {
    Mat3 strain;
    strain << 1.0, 0.4, -0.2, 0.4, -0.7, 0.3, -0.2, 0.3, 0.5;
    strain *= size;
    const Vec6 stress = compute_stress(e, to_mandel(strain));
    const Mat3 F = Mat3::Identity() + strain;
    const double rounding = 1e-15 / size;  // of 1 + strain
    const double expected = 0.5 * stress.dot(to_mandel(strain));
    EXPECT_NEAR(find_energy(F), expected, (5.0 * size + rounding) * expected) << size;
    EXPECT_LT((find_piola(F) - from_mandel(stress)).norm(), (5.0 * size + rounding) * stress.norm()) << size;
  }
}

/// Two stretches apart by `gap`, the third near or far, in axes that are no special ones.
Mat3 make_nearly_repeated(double gap, double third) {
  const Vec3 stretch(1.4 * (1.0 + 0.5 * gap), 1.4 * (1.0 - 0.5 * gap), third);
  return make_turn(1.1, Vec3(2, 1, -2)) * stretch.asDiagonal() * make_turn(0.4, Vec3(1, -1, 3));
}

TEST(Hencky, IsSmoothWhereStretchesAreRepeated) {
  // Values at ±gap differ from twice that at 0 by the second order in the gap and by rounding, and from each
  // other by the first: difference quotients of nearly equal stretches would lose all digits on the way.
  constexpr double kRounding = 1e-13;  // of a tangent whose norm is some 20
  const Elasticity e{3.0, 2.0, nullptr, 5.0, 0.07};
  for (const double third : {0.6, 1.4, 1.4 * (1.0 + 1e-9)}) {
    const Mat3 F = make_nearly_repeated(0.0, third);
    for (double gap = 1e-2; gap > 0.5e-14; gap *= 0.1) {
      SCOPED_TRACE(testing::Message() << "gap " << gap << ", third " << third);
      const Mat3 plus = make_nearly_repeated(gap, third);
      const Mat3 minus = make_nearly_repeated(-gap, third);
      const double first = 20.0 * gap + kRounding;
      const double second = 20.0 * gap * gap + 2.0 * kRounding;
      EXPECT_NEAR(find_energy(plus, e), find_energy(F, e), first);
      EXPECT_NEAR(find_energy(plus, e) + find_energy(minus, e), 2.0 * find_energy(F, e), second);
      const Mat3 P = find_piola(F, e);
      EXPECT_LT((find_piola(plus, e) - P).norm(), first);
      EXPECT_LT((find_piola(plus, e) + find_piola(minus, e) - 2.0 * P).norm(), second);
      const Mat9 A = find_tangent(F, e);
      EXPECT_LT((find_tangent(plus, e) - A).norm(), first);
      EXPECT_LT((find_tangent(plus, e) + find_tangent(minus, e) - 2.0 * A).norm(), second);
    }
  }
}

TEST(Hencky, TangentIsTheDerivativeOfTheStressWhereStretchesAreRepeated) {
  const Elasticity e{3.0, 2.0, nullptr, 5.0, 0.07};
  for (const double third : {0.6, 1.4})
    for (const double gap : {0.0, 1e-12, 1e-8, 1e-4, 1e-2}) {
      const Mat3 F = make_nearly_repeated(gap, third);
      const Mat9 A = find_tangent(F, e);
      for (int i = 0; i < 9; ++i) {
        const double d = 1e-5;
        Mat3 step = Mat3::Zero();
        step(i) = d;
        const Mat3 slope = (find_piola(F + step, e) - find_piola(F - step, e)) / (2 * d);
        EXPECT_LT((A.col(i) - slope.reshaped()).norm(), 1e-8) << gap << ' ' << third << ' ' << i;
      }
    }
}

Support slide(const Vec3& normal, double offset, double displacement) {
  Support support;
  support.region.kind = Region::Kind::plane;
  support.region.normal = normal;
  support.region.offset = offset;
  support.fixes = {normal.x() != 0.0, normal.y() != 0.0, normal.z() != 0.0};
  support.displacement = displacement * normal;
  return support;
}

class HenckyBar : public testing::TestWithParam<ElementKind> {
 protected:
  static constexpr double kLength = 0.3, kWidth = 0.1, kHeight = 0.08;
};

TEST_P(HenckyBar, StretchedToTwiceItsLengthHasTheTrueStressOfTheLogarithm) {
  // Free across: lateral strains −ν ln 2. True stress σ = E ln 2/J with J = 2^{1−2ν}, over the area that is
  // left, A = A₀ 2^{−2ν}: the force on the end is E ln 2 A₀/2.
  SolidParams params;
  params.model = kHencky;
  params.element = GetParam();
  params.solver.kind = linear::SolverKind::cholesky;
  for (const double nu : {0.3, 0.49}) {
    Scene scene(test::make_irregular_block(3, 2, 2, Vec3(kLength, kWidth, kHeight)),
                {slide(Vec3::UnitX(), 0.0, 0.0), slide(Vec3::UnitY(), 0.0, 0.0),
                 slide(Vec3::UnitZ(), 0.0, 0.0), slide(Vec3::UnitX(), kLength, kLength)},
                params, kE, nu);
    const StepStatus status = scene.find_equilibrium();
    ASSERT_TRUE(status.is_ok()) << status.failure().quantity << ' ' << status.failure().value;
    const double across = std::pow(2.0, -nu);
    const Points expected = Vec3(2.0, across, across).asDiagonal() * scene.rest();
    EXPECT_LT((scene.state.x - expected).cwiseAbs().maxCoeff(), 1e-9 * kLength) << nu;
    const Points force = scene.compute_force(scene.state.x);
    double pull = 0.0;
    for (int n = 0; n < scene.num_nodes(); ++n)
      if (scene.rest()(0, n) > (1.0 - 1e-9) * kLength) pull += force(0, n);
    const double area = kWidth * kHeight * across * across;
    const double true_stress = kE * std::log(2.0) / std::pow(2.0, 1.0 - 2.0 * nu);
    EXPECT_NEAR(pull / area, true_stress, 1e-9 * true_stress) << nu;
    // Strain energy: ½ E (ln 2)² over the rest volume.
    const double energy = 0.5 * kE * std::pow(std::log(2.0), 2) * kLength * kWidth * kHeight;
    EXPECT_NEAR(scene.compute_elastic_energy(), energy, 1e-9 * energy) << nu;
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, HenckyBar,
                         testing::Values(ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2));

}  // namespace
}  // namespace argil::solid
