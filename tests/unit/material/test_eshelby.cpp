// Eshelby's tensor: the closed forms of spheroids against those of their limits [Mura1987, sec. 11] and
// against the integral of the Green operator, which shares no formula with them; the integral itself against
// closed forms of ellipsoids and of stretched media.
#include "material/eshelby.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/mandel.h"
#include "base/rng.h"
#include "eshelby_integral.h"
#include "material/orientation.h"

namespace argil::material {
namespace {

Mat6 make_isotropic(double nu) {
  Mat6 C = 2.0 * Mat6::Identity();  // μ = 1
  C.topLeftCorner<3, 3>().array() += 2.0 * nu / (1.0 - 2.0 * nu);
  return C;
}

/// e ↦ B⁻ᵀ e B⁻¹ on Mandel vectors.
Mat6 make_strain_map(const Mat3& B) {
  const Mat3 inverse = B.inverse();
  Mat6 map;
  for (int j = 0; j < 6; ++j)
    map.col(j) = to_mandel(inverse.transpose() * from_mandel(Vec6::Unit(j)) * inverse);
  return map;
}

TEST(Eshelby, AgreesWithTheGreenOperatorIntegralAtEveryAspectAndPoissonRatio) {
  // 0.9499 … 1.0501 straddle the places where the code changes its formulas.
  for (const double c :
       {0.05, 0.2, 0.7, 0.9499, 0.9501, 0.999999, 1.0, 1.0000001, 1.0499, 1.0501, 1.8, 5.0, 20.0})
    for (const double nu : {-0.3, 0.0, 0.2, 0.3, 0.45}) {
      const EshelbyIntegral reference =
          compute_eshelby_integral(make_isotropic(nu), Vec3(1.0, 1.0, c), 1e-13);
      EXPECT_LE(reference.difference, 1e-13) << c;
      const double difference = (compute_eshelby_tensor(nu, c) - reference.tensor).cwiseAbs().maxCoeff();
      EXPECT_LT(difference, 3e-13) << "aspect " << c << " nu " << nu;  // both errors
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
  const Mat6 P = compute_eshelby_tensor(nu, std::numeric_limits<double>::infinity());
  EXPECT_LT((P - compute_eshelby_tensor(nu, 1e7)).cwiseAbs().maxCoeff(), 1e-12);  // ln(c)/c²
  const double d = 8.0 * (1.0 - nu);
  const double tolerance = 1e-15;
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

TEST(Eshelby, TraceIsThreeWhateverTheShapeAndTheMatrix) {
  // P_ijij = 3. P is a mean over directions n of Γ(n) : C, and each of these projects onto the strains
  // sym(n ⊗ u), a space of three dimensions: the trace of a projector is its rank.
  for (const double nu : {-0.3, 0.0, 0.25, 0.49})
    for (double c = 1e-3; c < 2e3; c *= 10.0)
      EXPECT_NEAR(compute_eshelby_tensor(nu, c).trace(), 3.0, 1e-14) << "aspect " << c << " nu " << nu;
  Mat6 C = make_isotropic(0.3);
  C(2, 2) *= 0.4;
  C(3, 3) *= 0.7;
  C(0, 5) = C(5, 0) = 0.2;  // no symmetry but the plane's
  for (const Vec3& axes : {Vec3(1.0, 1.0, 1.0), Vec3(3.0, 2.0, 1.0), Vec3(0.3, 1.0, 2.0)})
    for (const Mat6& matrix : {make_isotropic(0.3), C})
      EXPECT_NEAR(compute_eshelby_integral(matrix, axes, 1e-12).tensor.trace(), 3.0, 1e-13);
}

TEST(Eshelby, OfAPennyOfNoThicknessIsThatOfALayer) {
  // All normal and out-of-plane strain of the layer is its own, none of it in the plane [Mura1987, 11.23].
  const double nu = 0.3;
  const Mat6 P = compute_eshelby_tensor(nu, 0.0);
  Mat6 expected = Mat6::Zero();
  expected(2, 2) = expected(3, 3) = expected(4, 4) = 1.0;
  expected(2, 0) = expected(2, 1) = nu / (1.0 - nu);
  EXPECT_LT((P - expected).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(EshelbyIntegral, OfAnEllipsoidHasTheDepolarisingFactorsOfMurasEllipticIntegrals) {
  // In an isotropic medium P_11kk = (1+ν)/(1−ν) I₁/4π (from 11.16), with I₁/4π = (a₁a₂a₃/2) ∫
  // ds/((a₁²+s)Δ(s)), here with s = a₁² (x⁻² − 1) and a fine midpoint rule.
  const Vec3 a(3.0, 2.0, 1.0);
  const double nu = 0.3;
  const EshelbyIntegral P = compute_eshelby_integral(make_isotropic(nu), a, 1e-12);
  for (int k = 0; k < 3; ++k) {
    double I = 0.0;
    const int n = 20000;
    for (int i = 0; i < n; ++i) {
      const double x = (i + 0.5) / n;
      const double s = a(k) * a(k) * (1.0 / (x * x) - 1.0);
      const double slope = 2.0 * a(k) * a(k) / (x * x * x);
      const double delta = std::sqrt((a.array().square() + s).prod());
      I += 0.5 * a.prod() * slope / ((a(k) * a(k) + s) * delta) / n;
    }
    EXPECT_NEAR(P.tensor.row(k).head<3>().sum(), (1.0 + nu) / (1.0 - nu) * I, 1e-8);  // midpoint rule, n⁻²
  }
}

TEST(EshelbyIntegral, OfAStretchedMediumIsTheStretchedTensor) {
  // x → Bx turns an isotropic medium with a sphere into an anisotropic one with an ellipsoid, exactly:
  // C'_ijkl = B_ip B_jq B_kr B_ls C_pqrs, u' = B⁻ᵀu, P' = 𝓑 P 𝓑⁻¹ with 𝓑: e ↦ B⁻ᵀ e B⁻¹.
  const Mat6 C = make_isotropic(0.25);
  for (const Vec3& stretch : {Vec3(1.0, 1.0, 0.4), Vec3(1.0, 1.0, 2.5), Vec3(1.3, 0.8, 2.0)}) {
    const Mat3 B = stretch.asDiagonal();
    const Mat6 map = make_strain_map(B);
    const Mat6 inverse = map.inverse();
    const Mat6 stretched = inverse.transpose() * C * inverse;  // energy e:C:e is the same
    const Mat6 expected = map * compute_eshelby_tensor(0.25, 1.0) * inverse;
    const EshelbyIntegral P = compute_eshelby_integral(stretched, stretch, 1e-13);
    EXPECT_LT((P.tensor - expected).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_GT((stretched - C).norm(), 0.5 * C.norm());  // far from isotropic
  }
}

TEST(Orientation, LaysAxis3AlongAnyOther) {
  Rng rng(3, "axes");
  Mat6 C = make_isotropic(0.3);
  C(2, 2) *= 0.5;  // transversely isotropic about 3
  C(3, 3) = C(4, 4) = 0.7;
  for (int i = 0; i < 20; ++i) {
    const Vec3 axis = Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)).normalized();
    const Mat6 laid = lay_along(C, axis);
    const Vec6 along = to_mandel(axis * axis.transpose());
    EXPECT_NEAR(along.dot(laid * along), C(2, 2), 1e-14);  // stiffness in uniaxial strain along the axis
    EXPECT_LT((laid - lay_along(C, -axis)).norm(), 1e-14);
    const Mat6 turn = make_mandel_rotation(Eigen::AngleAxisd(1.1, axis).toRotationMatrix());
    EXPECT_LT((turn * laid * turn.transpose() - laid).norm(), 1e-14);  // isotropic round the axis
    EXPECT_LT((turn * turn.transpose() - Mat6::Identity()).norm(), 1e-14);
  }
  EXPECT_LT((lay_along(C, Vec3::UnitZ()) - C).norm(), 1e-15);
}

TEST(EshelbyDeathTest, RefusesAnAspectThatIsNoShape) {
  EXPECT_DEATH(compute_eshelby_tensor(0.3, -1.0), "-1");
  EXPECT_DEATH(compute_eshelby_integral(make_isotropic(0.3), Vec3(1.0, 0.0, 1.0), 1e-6), "semi_axes");
  EXPECT_DEATH(compute_eshelby_tensor(0.3, std::nan("")), "nan");
}

}  // namespace
}  // namespace argil::material
