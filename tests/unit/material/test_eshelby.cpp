// Eshelby's tensor against closed forms of its limits [Mura1987, sec. 11] and against a slow reference that
// shares no formula with the code: P = (1/4π) ∫ Γ(n) dω : C with n ∝ (ξ₁, ξ₂, ξ₃/c), Γ the Green operator
// [Mura1987, 17.x].
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "base/mandel.h"
#include "material/eshelby.h"

namespace argil::material {
namespace {

struct GaussRule {
  std::vector<double> x, w;  // on [−1, 1]
};

GaussRule make_gauss(int n) {
  GaussRule rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
    double slope = 1.0;
    for (int it = 0; it < 100; ++it) {
      double p0 = 1.0, p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1.0);
      const double dx = p1 / slope;
      x -= dx;
      if (std::abs(dx) < 1e-16) break;
    }
    rule.x.push_back(x);
    rule.w.push_back(2.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

/// Γ:C for unit n in an isotropic medium: strain from an eigenstrain that varies along n only, by its
/// definition: u = N (C:ε*)·n, N = (1 − n nᵀ/(2(1−ν)))/μ, ε = sym(u nᵀ).
Mat6 compute_green_times_stiffness(const Vec3& n, double nu) {
  Mat6 result;
  const Mat3 N = Mat3::Identity() - n * n.transpose() / (2.0 * (1.0 - nu));
  for (int j = 0; j < 6; ++j) {
    const Mat3 strain = from_mandel(Vec6::Unit(j));
    const Mat3 stress =
        2.0 * strain + 2.0 * nu / (1.0 - 2.0 * nu) * strain.trace() * Mat3::Identity();  // μ = 1
    const Vec3 u = N * (stress * n);
    result.col(j) = to_mandel(0.5 * (u * n.transpose() + n * u.transpose()));
  }
  return result;
}

Mat6 compute_reference(double nu, double aspect) {
  static const GaussRule rule = make_gauss(400);
  constexpr int kTurns = 8;  // trapezoid rule, exact for the fourth-order harmonics that occur
  Mat6 P = Mat6::Zero();
  for (std::size_t i = 0; i < rule.x.size(); ++i)
    for (int k = 0; k < kTurns; ++k) {
      const double z = rule.x[i];
      const double r = std::sqrt(1.0 - z * z);
      const double turn = 2.0 * std::numbers::pi * k / kTurns;
      const Vec3 n = Vec3(r * std::cos(turn), r * std::sin(turn), z / aspect).normalized();
      P += 0.5 * rule.w[i] / kTurns * compute_green_times_stiffness(n, nu);
    }
  return P;
}

TEST(Eshelby, AgreesWithTheGreenOperatorIntegralAtEveryAspectAndPoissonRatio) {
  // 0.9499 … 1.0501 straddle the places where the code changes its formulas.
  for (const double c :
       {0.05, 0.2, 0.7, 0.9499, 0.9501, 0.999999, 1.0, 1.0000001, 1.0499, 1.0501, 1.8, 5.0, 20.0})
    for (const double nu : {-0.3, 0.0, 0.2, 0.3, 0.45}) {
      const double difference =
          (compute_eshelby_tensor(nu, c) - compute_reference(nu, c)).cwiseAbs().maxCoeff();
      EXPECT_LT(difference, 2e-13) << "aspect " << c << " nu " << nu;  // rounding of 3200 terms
    }
}

TEST(Eshelby, OfASphereIsTheClosedForm) {
  for (const double nu : {0.0, 0.1, 0.3, 0.49}) {
    const Mat6 P = compute_eshelby_tensor(nu, 1.0);
    const double d = 15.0 * (1.0 - nu);
    EXPECT_NEAR(P(0, 0), (7.0 - 5.0 * nu) / d, 1e-15);
    EXPECT_NEAR(P(2, 2), (7.0 - 5.0 * nu) / d, 1e-15);
    EXPECT_NEAR(P(0, 1), (5.0 * nu - 1.0) / d, 1e-15);
    EXPECT_NEAR(P(2, 0), (5.0 * nu - 1.0) / d, 1e-15);
    EXPECT_NEAR(P(3, 3), 2.0 * (4.0 - 5.0 * nu) / d, 1e-15);  // Mandel: 2 P₂₃₂₃
    EXPECT_NEAR(P(5, 5), 2.0 * (4.0 - 5.0 * nu) / d, 1e-15);
  }
}

TEST(Eshelby, OfALongFibreTendsToTheCylinder) {
  const double nu = 0.3;
  const Mat6 P = compute_eshelby_tensor(nu, 1e7);
  const double d = 8.0 * (1.0 - nu);
  const double tolerance = 1e-12;  // the correction is of order ln(c)/c²
  EXPECT_NEAR(P(0, 0), (5.0 - 4.0 * nu) / d, tolerance);
  EXPECT_NEAR(P(0, 1), (4.0 * nu - 1.0) / d, tolerance);
  EXPECT_NEAR(P(0, 2), nu / (2.0 * (1.0 - nu)), tolerance);
  EXPECT_NEAR(P(2, 2), 0.0, tolerance);
  EXPECT_NEAR(P(2, 0), 0.0, tolerance);
  EXPECT_NEAR(P(5, 5), 2.0 * (3.0 - 4.0 * nu) / d, tolerance);
  EXPECT_NEAR(P(4, 4), 0.5, tolerance);
}

TEST(Eshelby, OfAFlatDiscTendsToThePenny) {
  const double nu = 0.3;
  const double c = 1e-6;
  const double pi = std::numbers::pi;
  const Mat6 P = compute_eshelby_tensor(nu, c);
  const double tolerance = 1e-11;  // c²
  EXPECT_NEAR(P(2, 2), 1.0 - (1.0 - 2.0 * nu) / (1.0 - nu) * pi / 4.0 * c, tolerance);
  EXPECT_NEAR(P(0, 0), (13.0 - 8.0 * nu) / (32.0 * (1.0 - nu)) * pi * c, tolerance);
  EXPECT_NEAR(P(2, 0), nu / (1.0 - nu) * (1.0 - (4.0 * nu + 1.0) / (8.0 * nu) * pi * c), tolerance);
  EXPECT_NEAR(P(0, 2), (2.0 * nu - 1.0) / (8.0 * (1.0 - nu)) * pi * c, tolerance);
  EXPECT_NEAR(P(4, 4), 1.0 + (nu - 2.0) / (1.0 - nu) * pi / 4.0 * c, tolerance);
}

TEST(Eshelby, DilatationOfTheInclusionIsThatOfTheSphereWhateverTheShape) {
  // tr(P 1) = (1+ν)/(1−ν): the potential's Laplacian does not know the shape [Eshelby1957].
  for (const double c : {1e-3, 0.3, 1.0, 1.04, 4.0, 1e3})
    for (const double nu : {0.0, 0.25, 0.45})
      EXPECT_NEAR((compute_eshelby_tensor(nu, c).topLeftCorner<3, 3>().sum()), (1.0 + nu) / (1.0 - nu),
                  4e-14);
}

TEST(EshelbyDeathTest, RefusesAnAspectThatIsNoShape) {
  EXPECT_DEATH(compute_eshelby_tensor(0.3, 0.0), "0");
  EXPECT_DEATH(compute_eshelby_tensor(0.3, -1.0), "-1");
  EXPECT_DEATH(compute_eshelby_tensor(0.3, std::nan("")), "nan");
}

}  // namespace
}  // namespace argil::material
