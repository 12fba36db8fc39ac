// Effective medium against closed forms, exact solutions and proven bounds. Eq. 6 for spheres:
// K = K_M/(1 + φ t/(1 − α t)), t = 1 − K_I/K_M, α = (1+ν)/(3(1−ν)); shear with β = 2(4−5ν)/(15(1−ν)).
#include "material/effective_medium.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "base/mandel.h"
#include "base/rng.h"

namespace argil::material {
namespace {

constexpr double kWater = 2.2e9;  // [Pa]

struct Moduli {
  double K, G;
};

Moduli to_moduli(const Elastic& e) {
  return {e.youngs_modulus / (3.0 * (1.0 - 2.0 * e.poissons_ratio)),
          e.youngs_modulus / (2.0 * (1.0 + e.poissons_ratio))};
}
double alpha(double nu) {
  return (1.0 + nu) / (3.0 * (1.0 - nu));
}
double beta(double nu) {
  return 2.0 * (4.0 - 5.0 * nu) / (15.0 * (1.0 - nu));
}

EffectiveMedium make_medium(Scheme scheme, double K_I = 0.0, double G_I = 0.0) {
  EffectiveMedium medium;
  medium.scheme = scheme;
  medium.fluid_bulk_modulus = K_I;
  medium.fluid_shear_modulus = G_I;
  return medium;
}

void expect_relative(double value, double expected, double tolerance, const std::string& what) {
  EXPECT_LE(std::abs(value - expected), tolerance * std::abs(expected))
      << what << ": " << value << " for " << expected;
}

/// Stiffness with axis 3 turned to `axis`, by the definition C_ijkl = Q Q Q Q C on tensors.
Mat6 turn(const Mat6& C, const Vec3& axis) {
  const Mat3 Q = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis).toRotationMatrix();
  Mat6 turned;
  for (int j = 0; j < 6; ++j) {
    const Mat3 strain = Q.transpose() * from_mandel(Vec6::Unit(j)) * Q;
    turned.col(j) = argil::to_mandel(Mat3(Q * from_mandel(C * argil::to_mandel(strain)) * Q.transpose()));
  }
  return turned;
}

TEST(Dilute, OfSpheresIsThePapersClosedForm) {
  for (const double nu : {0.0, 0.2, 0.3, 0.45})
    for (const Moduli fluid : {Moduli{0.0, 0.0}, Moduli{kWater, 0.0}, Moduli{3e4, 1e4}})
      for (const double phi : {0.01, 0.2, 0.45}) {
        const Elastic solid{1e5, nu};
        const auto [K, G] = to_moduli(solid);
        const auto expected = [phi](double m, double f, double shape) {
          const double t = 1.0 - f / m;
          return m / (1.0 + phi * t / (1.0 - shape * t));
        };
        const MediumResult result =
            compute_effective_medium(solid, make_medium(Scheme::dilute, fluid.K, fluid.G), phi);
        // 1 − φ… cancels towards the pole of the bulk modulus, at most a hundredfold here
        expect_relative(result.bulk_modulus, expected(K, fluid.K, alpha(nu)), 1e-13, "bulk");
        expect_relative(result.shear_modulus, expected(G, fluid.G, beta(nu)), 1e-13, "shear");
      }
}

TEST(Dilute, LeavesTheVoigtBoundAtAlphaInBulkAndAtBetaInShear) {
  for (const double K_I : {0.0, kWater}) {
    // ν = 0: α = 1/3 < β = 8/15; ν = 0.3: β < α. Whichever is smaller is met first.
    const MediumRange bulk = compute_medium_range({1e5, 0.0}, make_medium(Scheme::dilute, K_I), 0.5);
    EXPECT_EQ(bulk.mode, "bulk");
    EXPECT_NEAR(bulk.phi_above_voigt, 1.0 / 3.0, K_I > 0.0 ? 1e-9 : 1e-11);
    const MediumRange shear = compute_medium_range({1e5, 0.3}, make_medium(Scheme::dilute, K_I), 0.6);
    EXPECT_EQ(shear.worst, MediumStatus::above_voigt);
    EXPECT_EQ(shear.mode, "shear");
    EXPECT_NEAR(shear.phi_above_voigt, beta(0.3), 1e-11);
  }
}

TEST(Dilute, BulkModulusOfWetClayTurnsNegativeWhileYoungsModulusLooksHealthy) {
  const Elastic solid{1e5, 0.3};
  const double K = to_moduli(solid).K;
  const double pole = alpha(0.3) + K / (kWater - K);
  EXPECT_NEAR(pole, 0.619, 5e-4);  // SPEC's printed digits
  const EffectiveMedium water = make_medium(Scheme::dilute, kWater);
  const MediumRange range = compute_medium_range(solid, water, 0.8);
  EXPECT_EQ(range.worst, MediumStatus::not_positive_definite);
  EXPECT_EQ(range.mode, "bulk");
  EXPECT_NEAR(range.phi_not_positive_definite, pole, 1e-11);
  const MediumResult past = compute_effective_medium(solid, water, pole + 0.02);
  EXPECT_LT(past.bulk_modulus, 0.0);
  const double E =
      9.0 * past.bulk_modulus * past.shear_modulus / (3.0 * past.bulk_modulus + past.shear_modulus);
  EXPECT_GT(E, 0.3 * solid.youngs_modulus);
  EXPECT_EQ(compute_medium_range(solid, water, pole - 1e-6).worst, MediumStatus::above_voigt);
}

TEST(Dilute, RandomPennyCracksSoftenAsBudianskyAndOConnellSay) {
  // K_M/K = 1 + 16(1−ν²)/(9(1−2ν)) ε, G_M/G = 1 + 32(1−ν)(5−ν)/(45(2−ν)) ε, crack density ε = 3φ/(4π c), c →
  // 0.
  const double nu = 0.25, density = 0.1;
  EffectiveMedium medium = make_medium(Scheme::dilute);
  medium.aspect = 1e-5;
  const Elastic solid{1e7, nu};
  const MediumResult r =
      compute_effective_medium(solid, medium, 4.0 / 3.0 * std::numbers::pi * medium.aspect * density);
  const auto [K, G] = to_moduli(solid);
  expect_relative(K / r.bulk_modulus, 1.0 + 16.0 * (1.0 - nu * nu) / (9.0 * (1.0 - 2.0 * nu)) * density, 2e-5,
                  "K");
  expect_relative(G / r.shear_modulus, 1.0 + 32.0 * (1.0 - nu) * (5.0 - nu) / (45.0 * (2.0 - nu)) * density,
                  2e-5, "G");
}

TEST(MoriTanaka, OfSpheresHasTheBulkModulusOfCompositeSpheres) {
  // Exact for Hashin's composite sphere assemblage: K = K_M + φ/(1/(K_I−K_M) + 3(1−φ)/(3K_M+4G_M))
  // [Hashin1962].
  for (const double nu : {0.1, 0.3, 0.45})
    for (const double K_I : {0.0, 1e4, kWater})
      for (const double phi : {0.05, 0.4, 0.9}) {
        const Elastic solid{1e5, nu};
        const auto [K, G] = to_moduli(solid);
        const double expected = K + phi / (1.0 / (K_I - K) + 3.0 * (1.0 - phi) / (3.0 * K + 4.0 * G));
        const MediumResult r = compute_effective_medium(solid, make_medium(Scheme::mori_tanaka, K_I), phi);
        expect_relative(r.bulk_modulus, expected, 1e-13, "K");
        EXPECT_EQ(r.status, MediumStatus::ok);
      }
}

TEST(MoriTanaka, OfSofterSpheresIsTheUpperHashinShtrikmanBound) {
  for (const double nu : {0.0, 0.3, 0.49})
    for (const Moduli fluid : {Moduli{0.0, 0.0}, Moduli{2e4, 1e3}}) {
      const Elastic solid{1e5, nu};
      const auto mt =
          compute_effective_medium(solid, make_medium(Scheme::mori_tanaka, fluid.K, fluid.G), 0.35);
      const auto hs = compute_effective_medium(solid, make_medium(Scheme::hs_upper, fluid.K, fluid.G), 0.35);
      EXPECT_LT((mt.stiffness - hs.stiffness).norm(), 1e-13 * hs.stiffness.norm());
    }
}

TEST(MoriTanaka, AlignedCylindricalPoresLeaveTheExactAxialModuli) {
  // Parallel pores: E₃ = (1−φ) E exactly, axial shear G (1−φ)/(1+φ) [Hashin & Rosen 1964].
  EffectiveMedium medium = make_medium(Scheme::mori_tanaka);
  medium.aspect = 1e7;
  medium.orientation = Orientation::aligned;
  const Elastic solid{1e5, 0.3};
  const Mat6 C = compute_effective_medium(solid, medium, 0.3).stiffness;
  const Mat6 S = C.inverse();
  expect_relative(1.0 / S(2, 2), 0.7 * solid.youngs_modulus, 1e-11, "E3");
  expect_relative(0.5 * C(4, 4), to_moduli(solid).G * 0.7 / 1.3, 1e-11, "G13");
  expect_relative(-S(0, 2) / S(2, 2), 0.3, 1e-11, "nu31");
}

TEST(MoriTanaka, AlignedFlatDiscsAreBackusLayers) {
  // Exact laminate [Backus1962], M = λ + 2μ: C₃₃ = ⟨1/M⟩⁻¹, C₁₃ = ⟨λ/M⟩ C₃₃, C₄₄ = ⟨1/μ⟩⁻¹, C₆₆ = ⟨μ⟩.
  const Elastic solid{1e5, 0.25};
  const auto [K1, G1] = to_moduli(solid);
  const double K2 = 2e4, G2 = 5e3, phi = 0.3;
  EffectiveMedium medium = make_medium(Scheme::mori_tanaka, K2, G2);
  medium.aspect = 1e-9;
  medium.orientation = Orientation::aligned;
  const Mat6 C = compute_effective_medium(solid, medium, phi).stiffness;
  const auto mean = [phi](double a, double b) { return (1.0 - phi) * a + phi * b; };
  const double M1 = K1 + 4.0 / 3.0 * G1, M2 = K2 + 4.0 / 3.0 * G2;
  const double l1 = M1 - 2.0 * G1, l2 = M2 - 2.0 * G2;
  const double C33 = 1.0 / mean(1.0 / M1, 1.0 / M2);
  const double share = mean(l1 / M1, l2 / M2);
  const double tolerance = 1e-7;  // the aspect, times the contrast
  expect_relative(C(2, 2), C33, tolerance, "C33");
  expect_relative(C(0, 2), share * C33, tolerance, "C13");
  expect_relative(C(2, 0), share * C33, tolerance, "C31");
  expect_relative(C(0, 0), mean(4.0 * G1 * (l1 + G1) / M1, 4.0 * G2 * (l2 + G2) / M2) + share * share * C33,
                  tolerance, "C11");
  expect_relative(0.5 * C(4, 4), 1.0 / mean(1.0 / G1, 1.0 / G2), tolerance, "C44");
  expect_relative(0.5 * C(5, 5), mean(G1, G2), tolerance, "C66");
}

TEST(SelfConsistent, SolvesHillsEquationsForSpheres) {
  // [Hill1965]: 1/(K+4G/3) = Σ c_r/(K_r+4G/3);  Σ c_r K_r/(K_r+4G/3) + 5[c_M G_I/(G−G_I) + c_I G_M/(G−G_M)] +
  // 2 = 0.
  for (const double nu : {0.05, 0.3, 0.49})
    for (const Moduli fluid : {Moduli{0.0, 0.0}, Moduli{kWater, 0.0}, Moduli{kWater, 2e6}, Moduli{1e4, 3e3}})
      for (const double phi : {0.05, 0.3, 0.49}) {
        const Elastic solid{1e5, nu};
        const auto [K_M, G_M] = to_moduli(solid);
        const auto r =
            compute_effective_medium(solid, make_medium(Scheme::self_consistent, fluid.K, fluid.G), phi);
        const double K = r.bulk_modulus, G = r.shear_modulus, s = 4.0 / 3.0 * G;
        expect_relative(1.0 / (K + s), (1.0 - phi) / (K_M + s) + phi / (fluid.K + s), 1e-11, "bulk");
        const double residual = (1.0 - phi) * K_M / (K_M + s) + phi * fluid.K / (fluid.K + s) +
                                5.0 * ((1.0 - phi) * fluid.G / (G - fluid.G) + phi * G_M / (G - G_M)) + 2.0;
        EXPECT_NEAR(residual, 0.0, 1e-10) << nu << ' ' << fluid.K << ' ' << fluid.G << ' ' << phi;
      }
}

TEST(SelfConsistent, OfVoidsAtPoissonOneFifthFallsLinearlyAndPercolatesAtOneHalf) {
  const Elastic solid{1e5, 0.2};
  for (const double phi : {0.1, 0.3, 0.49, 0.4999}) {
    const auto r = compute_effective_medium(solid, make_medium(Scheme::self_consistent), phi);
    const double E = 9.0 * r.bulk_modulus * r.shear_modulus / (3.0 * r.bulk_modulus + r.shear_modulus);
    expect_relative(E, 1e5 * (1.0 - 2.0 * phi), 1e-9, "E");  // 1 − 2φ cancels
  }
  for (const double nu : {0.05, 0.2, 0.45})  // the threshold does not depend on ν
    EXPECT_NEAR(
        compute_medium_range({1e5, nu}, make_medium(Scheme::self_consistent), 0.9).phi_not_positive_definite,
        0.5, 1e-6);
  const auto suspension = compute_effective_medium(solid, make_medium(Scheme::self_consistent, kWater), 0.6);
  EXPECT_EQ(suspension.shear_modulus, 0.0);
  const double K_M = to_moduli(solid).K;
  expect_relative(suspension.bulk_modulus, 1.0 / (0.4 / K_M + 0.6 / kWater), 1e-12, "Wood's suspension");
}

/// dC/dφ of the differential scheme for spheres with the closed α, β; classical Runge–Kutta in φ.
Moduli integrate_differential(Moduli C, const Moduli& fluid, double phi, int steps) {
  const auto slope = [&](const Moduli& m, double at) {
    const double nu = (3.0 * m.K - 2.0 * m.G) / (2.0 * (3.0 * m.K + m.G));
    return Moduli{(fluid.K - m.K) / (1.0 - alpha(nu) * (1.0 - fluid.K / m.K)) / (1.0 - at),
                  (fluid.G - m.G) / (1.0 - beta(nu) * (1.0 - fluid.G / m.G)) / (1.0 - at)};
  };
  const double h = phi / steps;
  for (int i = 0; i < steps; ++i) {
    const double at = h * i;
    const Moduli a = slope(C, at);
    const Moduli b = slope({C.K + h / 2 * a.K, C.G + h / 2 * a.G}, at + h / 2);
    const Moduli c = slope({C.K + h / 2 * b.K, C.G + h / 2 * b.G}, at + h / 2);
    const Moduli d = slope({C.K + h * c.K, C.G + h * c.G}, at + h);
    C.K += h / 6 * (a.K + 2 * b.K + 2 * c.K + d.K);
    C.G += h / 6 * (a.G + 2 * b.G + 2 * c.G + d.G);
  }
  return C;
}

TEST(Differential, OfVoidsAtPoissonOneFifthIsTheSquareLaw) {
  for (const double phi : {0.1, 0.5, 0.95}) {
    const auto r = compute_effective_medium({1e5, 0.2}, make_medium(Scheme::differential), phi);
    const double E = 9.0 * r.bulk_modulus * r.shear_modulus / (3.0 * r.bulk_modulus + r.shear_modulus);
    expect_relative(E, 1e5 * (1.0 - phi) * (1.0 - phi), 1e-11, "E");
  }
}

TEST(Differential, AgreesWithASlowIntegrationOfTheSphereEquations) {
  for (const double nu : {0.05, 0.45, 0.499})
    for (const Moduli fluid : {Moduli{0.0, 0.0}, Moduli{kWater, 0.0}, Moduli{1e4, 3e3}}) {
      const Elastic solid{1e5, nu};
      const Moduli reference = integrate_differential(to_moduli(solid), fluid, 0.4, 40000);
      const auto r =
          compute_effective_medium(solid, make_medium(Scheme::differential, fluid.K, fluid.G), 0.4);
      expect_relative(r.bulk_modulus, reference.K, 2e-10, "K");  // both errors
      expect_relative(r.shear_modulus, reference.G, 2e-10, "G");
    }
}

TEST(Schemes, ShareTheSlopeOfEquationSixAtZeroWater) {
  const double phi = 1e-7;
  for (const double aspect : {0.1, 1.0, 8.0}) {
    const Elastic solid{1e5, 0.3};
    const auto drop = [&](Scheme scheme) {
      EffectiveMedium medium = make_medium(scheme, 2e4, 3e3);
      medium.aspect = aspect;
      const auto [K, G] = to_moduli(solid);
      const auto r = compute_effective_medium(solid, medium, phi);
      return Eigen::Vector2d(Eigen::Vector2d(K - r.bulk_modulus, G - r.shear_modulus) / (phi * K));
    };
    const Eigen::Vector2d dilute = drop(Scheme::dilute);
    EXPECT_GT(dilute.minCoeff(), 0.0);
    for (const Scheme s :
         {Scheme::dilute_strain, Scheme::mori_tanaka, Scheme::self_consistent, Scheme::differential})
      EXPECT_LT((drop(s) - dilute).norm(), 1e-5 * dilute.norm())
          << static_cast<int>(s);  // next order in φ, digits
    EXPECT_GT((drop(Scheme::voigt) - dilute).norm(), 0.05 * dilute.norm());
  }
}

TEST(Schemes, KeepReussHashinShtrikmanAndVoigtInOrder) {
  Rng rng(7, "order");
  for (int i = 0; i < 300; ++i) {
    const Elastic solid{1e5, rng.uniform(-0.2, 0.49)};
    const auto [K, G] = to_moduli(solid);
    const double K_I = K * rng.uniform(0.01, 1.0), G_I = G * rng.uniform(0.01, 1.0), phi = rng.uniform();
    MediumResult last;
    last.status = MediumStatus::ok;
    for (const Scheme s : {Scheme::reuss, Scheme::hs_lower, Scheme::self_consistent, Scheme::differential,
                           Scheme::mori_tanaka, Scheme::hs_upper, Scheme::voigt}) {
      const auto r = compute_effective_medium(solid, make_medium(s, K_I, G_I), phi);
      EXPECT_EQ(r.status, MediumStatus::ok) << static_cast<int>(s);
      EXPECT_GE(r.bulk_modulus, last.bulk_modulus * (1.0 - 1e-11)) << static_cast<int>(s) << " phi " << phi;
      EXPECT_GE(r.shear_modulus, last.shear_modulus * (1.0 - 1e-11)) << static_cast<int>(s) << " phi " << phi;
      last = r;
    }
  }
}

TEST(Schemes, RandomOrientationIsTheMeanOfTheTurnedAlignedOnes) {
  // The six axes of an icosahedron integrate fourth-order tensors exactly. Linear quantities: C of
  // `dilute_strain`, S of `dilute`.
  const double g = std::numbers::phi;
  Eigen::Matrix<double, 3, 6> axes;
  axes << 0, 0, 1, -1, g, g, 1, -1, g, g, 0, 0, g, g, 0, 0, 1, -1;
  for (const double aspect : {0.1, 3.0}) {
    const Elastic solid{1e5, 0.3};
    for (const Scheme scheme : {Scheme::dilute_strain, Scheme::dilute}) {
      EffectiveMedium medium = make_medium(scheme, 2e4, 1e3);
      medium.aspect = aspect;
      const Mat6 random = compute_effective_medium(solid, medium, 0.1).stiffness;
      medium.orientation = Orientation::aligned;
      Mat6 aligned = compute_effective_medium(solid, medium, 0.1).stiffness;
      const bool of_compliance = scheme == Scheme::dilute;
      if (of_compliance) aligned = aligned.inverse().eval();
      Mat6 mean = Mat6::Zero();
      for (int i = 0; i < 6; ++i) mean += turn(aligned, axes.col(i).normalized()) / 6.0;
      if (of_compliance) mean = mean.inverse().eval();
      EXPECT_LT((random - mean).norm(), 1e-13 * random.norm());
    }
  }
}

TEST(Schemes, AlignedSpheroidsAreTransverselyIsotropicAndSpheresAreNot) {
  EffectiveMedium medium = make_medium(Scheme::mori_tanaka);
  medium.aspect = 0.2;
  medium.orientation = Orientation::aligned;
  const Mat6 C = compute_effective_medium({1e5, 0.3}, medium, 0.3).stiffness;
  EXPECT_FALSE(is_isotropic(medium));
  EXPECT_NEAR(C(0, 0) - C(0, 1), C(5, 5), 1e-9 * C(0, 0));  // isotropic in the plane 12
  EXPECT_LT(C(2, 2), 0.75 * C(0, 0));                       // flat pores across 3
  EXPECT_LT((turn(C, Vec3(0, 1, 0)) - C).norm() / C.norm(), 1.0);
  EXPECT_GT((turn(C, Vec3(0, 1, 0)) - C).norm() / C.norm(), 0.2);
  medium.aspect = 1.0;
  EXPECT_TRUE(is_isotropic(medium));
  const Mat6 sphere = compute_effective_medium({1e5, 0.3}, medium, 0.3).stiffness;
  EXPECT_LT((turn(sphere, Vec3(1, 2, 3).normalized()) - sphere).norm(), 1e-14 * sphere.norm());
}

TEST(Schemes, KeepAllDigitsOfTheShearModulusBesideStiffWater) {
  // K_I/G_M = 6·10⁴. Closed forms of the Mori–Tanaka and dilute shear moduli do not contain K_I at all.
  const Elastic solid{1e5, 0.3};
  const auto drained = compute_effective_medium(solid, make_medium(Scheme::mori_tanaka), 0.3);
  const auto undrained = compute_effective_medium(solid, make_medium(Scheme::mori_tanaka, kWater), 0.3);
  expect_relative(undrained.shear_modulus, drained.shear_modulus, 1e-15, "G");
  EXPECT_GT(undrained.bulk_modulus, 1.6 * to_moduli(solid).K);
}

}  // namespace
}  // namespace argil::material
