// What the effective medium promises about states, not about values (those: tests/verification).
#include "material/effective_medium.h"

#include <gtest/gtest.h>

#include <cmath>

namespace argil::material {
namespace {

constexpr Elastic kClay{1e5, 0.3};
constexpr Scheme kAll[] = {Scheme::dilute,          Scheme::dilute_strain, Scheme::mori_tanaka,
                           Scheme::self_consistent, Scheme::differential,  Scheme::voigt,
                           Scheme::reuss,           Scheme::hs_lower,      Scheme::hs_upper};

TEST(EffectiveMedium, WithoutWaterEverySchemeGivesTheDryClay) {
  const double lambda = 1e5 * 0.3 / (1.3 * 0.4);
  const double mu = 1e5 / 2.6;
  Mat6 dry = 2.0 * mu * Mat6::Identity();
  dry.topLeftCorner<3, 3>().array() += lambda;
  for (const Scheme scheme : kAll)
    for (const double K_I : {0.0, 2.2e9}) {
      EffectiveMedium medium;
      medium.scheme = scheme;
      medium.fluid_bulk_modulus = K_I;
      const MediumResult r = compute_effective_medium(kClay, medium, 0.0);
      EXPECT_LT((r.stiffness - dry).norm(), 1e-14 * dry.norm()) << static_cast<int>(scheme);
      EXPECT_EQ(r.status, MediumStatus::ok);
      EXPECT_TRUE(r.mode.empty());
    }
}

TEST(EffectiveMedium, RefusesIteratedSchemesWithAlignedSpheroidsOnly) {
  for (const Scheme scheme : kAll) {
    EffectiveMedium medium;
    medium.scheme = scheme;
    medium.aspect = 0.5;
    EXPECT_TRUE(is_supported(medium));
    medium.orientation = Orientation::aligned;
    const bool iterated = scheme == Scheme::self_consistent || scheme == Scheme::differential;
    EXPECT_EQ(is_supported(medium), !iterated);
    if (iterated) {
      EXPECT_DEATH(compute_effective_medium(kClay, medium, 0.1), "is_supported");
    }
    medium.aspect = 1.0;
    EXPECT_TRUE(is_supported(medium));
  }
}

TEST(EffectiveMedium, NamesTheModeThatFails) {
  EffectiveMedium medium;
  medium.scheme = Scheme::dilute_strain;
  medium.aspect = 0.05;
  medium.orientation = Orientation::aligned;  // flat pores open most easily across their plane
  const MediumResult r = compute_effective_medium(kClay, medium, 0.2);
  EXPECT_EQ(r.status, MediumStatus::not_positive_definite);
  EXPECT_EQ(r.mode, "axisymmetric");
  medium.orientation = Orientation::random;
  EXPECT_EQ(compute_effective_medium(kClay, medium, 0.4).mode, "bulk");
}

TEST(EffectiveMedium, DrainedReussIsNoStiffness) {
  EffectiveMedium medium;
  medium.scheme = Scheme::reuss;
  EXPECT_EQ(compute_effective_medium(kClay, medium, 1e-9).status, MediumStatus::not_positive_definite);
  const MediumRange range = compute_medium_range(kClay, medium, 0.4);
  EXPECT_EQ(range.worst, MediumStatus::not_positive_definite);
  EXPECT_LT(range.phi_not_positive_definite, 1e-15);
}

TEST(EffectiveMedium, VoigtAndMoriTanakaAreSafeAtEveryWaterContent) {
  for (const Scheme scheme : {Scheme::voigt, Scheme::mori_tanaka, Scheme::differential})
    for (const double K_I : {0.0, 2.2e9}) {
      EffectiveMedium medium;
      medium.scheme = scheme;
      medium.fluid_bulk_modulus = K_I;
      const MediumRange range = compute_medium_range(kClay, medium, 0.95);
      EXPECT_EQ(range.worst, MediumStatus::ok);
      EXPECT_EQ(range.phi_above_voigt, -1.0);
      EXPECT_EQ(range.phi_not_positive_definite, -1.0);
    }
}

TEST(EffectiveMedium, IteratedSchemesStaySolvableNearTheEdges) {
  // Every case either converges or aborts (asserted inside); thin and long spheroids, nearly incompressible
  // clay, both sides of percolation.
  for (const Scheme scheme : {Scheme::self_consistent, Scheme::differential})
    for (const double aspect : {1e-4, 0.01, 0.1, 1.0, 10.0, 100.0, 1e4})
      for (const double nu : {0.0, 0.2, 0.499})
        for (const double K_I : {0.0, 1e5, 2.2e9})
          for (const double phi : {1e-6, 0.1, 0.33, 0.4, 0.499, 0.5, 0.501, 0.7, 1.0}) {
            EffectiveMedium medium;
            medium.scheme = scheme;
            medium.aspect = aspect;
            medium.fluid_bulk_modulus = K_I;
            const MediumResult r = compute_effective_medium({1e5, nu}, medium, phi);
            EXPECT_TRUE(r.bulk_modulus >= 0.0 && r.shear_modulus >= 0.0) << aspect << ' ' << nu << ' ' << phi;
            EXPECT_NE(r.status, MediumStatus::above_voigt);
          }
}

TEST(EffectiveMedium, IteratedSchemesEndAtTheFluidItself) {
  for (const Scheme scheme : {Scheme::self_consistent, Scheme::differential})
    for (const double aspect : {1e-4, 1.0, 1e4}) {
      EffectiveMedium medium;
      medium.scheme = scheme;
      medium.aspect = aspect;
      for (const double K_I : {0.0, 2e4}) {
        medium.fluid_bulk_modulus = K_I;
        const MediumResult r = compute_effective_medium({1e5, 0.3}, medium, 1.0);
        EXPECT_NEAR(r.bulk_modulus, K_I, 1e-10);
        EXPECT_EQ(r.shear_modulus, 0.0);
        EXPECT_EQ(r.status, MediumStatus::not_positive_definite);
      }
    }
}

TEST(EffectiveMedium, DifferentialSchemeOfFlatWaterTendsToTheSuspension) {
  // Pores of aspect 1e-4 cut the clay apart long before φ = 0.3; what is left adds compliances (Wood 1930).
  EffectiveMedium medium;
  medium.scheme = Scheme::differential;
  medium.aspect = 1e-4;
  medium.fluid_bulk_modulus = 2e4;
  const MediumResult r = compute_effective_medium({1e5, 0.3}, medium, 0.3);
  const double K = 1e5 / (3.0 * 0.4);
  EXPECT_NEAR(r.bulk_modulus, 1.0 / (0.7 / K + 0.3 / 2e4), 1e-2 * K);
  EXPECT_EQ(r.shear_modulus, 0.0);
  medium.fluid_bulk_modulus = 0.0;
  EXPECT_EQ(compute_effective_medium({1e5, 0.3}, medium, 0.3).bulk_modulus, 0.0);
}

}  // namespace
}  // namespace argil::material
