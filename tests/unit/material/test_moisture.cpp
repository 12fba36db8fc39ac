// The table against the laws it tabulates, and each law's meaning.
#include "material/moisture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace argil::material {
namespace {

constexpr Elastic kClay{1e5, 0.3};
constexpr double kYield = 0.02;
constexpr double kPorosity = 0.4;

double youngs_modulus(const MoistState& s) {
  return s.mu * (3.0 * s.lambda + 2.0 * s.mu) / (s.lambda + s.mu);
}
double poissons_ratio(const MoistState& s) {
  return s.lambda / (2.0 * (s.lambda + s.mu));
}

TEST(MoistureTable, FollowsTheEffectiveMediumToTheInterpolationError) {
  for (const Scheme scheme : {Scheme::mori_tanaka, Scheme::dilute, Scheme::self_consistent})
    for (const double K_I : {0.0, 2.2e9}) {
      Moisture moisture;
      moisture.medium.scheme = scheme;
      moisture.medium.fluid_bulk_modulus = K_I;
      const MoistureTable table(kClay, kYield, moisture, kPorosity);
      for (double S = 0.0; S <= 1.0; S += 0.01237) {
        const MediumResult exact = compute_effective_medium(kClay, moisture.medium, kPorosity * S);
        const MoistState wet = table.at(S);
        // h²/8 of the curvature: 1.2e-7·|f''|; the scheme's moduli bend by less than 5 of themselves over S.
        EXPECT_NEAR(wet.mu, exact.shear_modulus, 6e-7 * exact.shear_modulus) << S;
        EXPECT_NEAR(wet.lambda + 2.0 / 3.0 * wet.mu, exact.bulk_modulus, 2e-6 * exact.bulk_modulus) << S;
        EXPECT_EQ(wet.yield, kYield);
      }
    }
}

TEST(MoistureTable, MeetsTheDryAndTheSaturatedStateExactly) {
  const Moisture moisture;
  const MoistureTable table(kClay, kYield, moisture, kPorosity);
  EXPECT_NEAR(youngs_modulus(table.at(0.0)), 1e5, 1e-9);
  EXPECT_NEAR(poissons_ratio(table.at(0.0)), 0.3, 1e-14);
  const MediumResult wet = compute_effective_medium(kClay, moisture.medium, kPorosity);
  EXPECT_DOUBLE_EQ(table.at(1.0).mu, wet.shear_modulus);
}

TEST(MoistureTable, ByLiquidityIndexSoftensThirtyfivefoldAndKeepsTheYieldStrain) {
  Moisture moisture;
  moisture.law = MoistureLaw::liquidity_index;
  const MoistureTable table(kClay, kYield, moisture, kPorosity);
  EXPECT_NEAR(youngs_modulus(table.at(1.0)), 1e5 / 35.0, 1e-8);
  EXPECT_NEAR(poissons_ratio(table.at(1.0)), 0.3, 1e-14);
  EXPECT_NEAR(youngs_modulus(table.at(0.5)), 1e5 / std::sqrt(35.0), 1e-8);  // log-linear; a node of the table
  for (double S = 0.0; S <= 1.0; S += 0.013) {
    EXPECT_NEAR(youngs_modulus(table.at(S)) / (1e5 * std::pow(35.0, -S)), 1.0, 1e-14);
    EXPECT_EQ(table.at(S).yield, kYield);
  }
}

TEST(MoistureTable, ByLiquidityIndexFallsBetweenTheLimitsOnly) {
  // Kaolin with limits w_P = 30 %, w_L = 60 % at n = 0.6, grains 2650 kg/m³: S = w (1−n) ρ_s/(n ρ_w).
  const auto S_of = [](double w) { return w * 0.4 * 2650.0 / (0.6 * 1000.0); };
  Moisture moisture;
  moisture.law = MoistureLaw::liquidity_index;
  moisture.plastic_limit_saturation = S_of(0.3);
  moisture.liquid_limit_saturation = S_of(0.6);
  const MoistureTable table(kClay, kYield, moisture, 0.6);
  EXPECT_NEAR(youngs_modulus(table.at(0.2)), 1e5, 1e-9);
  EXPECT_NEAR(youngs_modulus(table.at(S_of(0.3))), 1e5, 1e-8);
  EXPECT_NEAR(youngs_modulus(table.at(S_of(0.45))), 1e5 / std::sqrt(35.0), 1e-8);
  moisture.liquid_limit_saturation = 0.8;
  const MoistureTable slurry(kClay, kYield, moisture, 0.6);
  EXPECT_NEAR(youngs_modulus(slurry.at(0.8)), 1e5 / 35.0, 1e-9);
  EXPECT_LT(youngs_modulus(slurry.at(0.9)), 0.8 * 1e5 / 35.0);  // past the liquid limit the law goes on
}

TEST(MoistureTable, SuctionStiffensSlightlyWetClayOnceAndNeitherDryNorSaturatedClay) {
  Moisture moisture;
  moisture.law = MoistureLaw::liquidity_index;
  moisture.suction_peak_ratio = 1.8;
  for (const double peak : {0.1, 0.3, 0.5}) {
    moisture.suction_peak_saturation = peak;
    EXPECT_EQ(compute_suction_factor(moisture, 0.0), 1.0);
    EXPECT_EQ(compute_suction_factor(moisture, 1.0), 1.0);
    EXPECT_NEAR(compute_suction_factor(moisture, peak), 1.8, 1e-15);
    double last = 1.0;
    for (double S = 0.01; S < 0.995; S += 0.01) {
      const double factor = compute_suction_factor(moisture, S);
      EXPECT_LE(factor, 1.8 + 1e-15);
      EXPECT_EQ(factor > last, S < peak + 0.001) << S;
      last = factor;
    }
  }
  const MoistureTable table(kClay, kYield, moisture, kPorosity);
  EXPECT_NEAR(youngs_modulus(table.at(0.5)), 1.8 * 1e5 / std::sqrt(35.0), 1e-8);
  EXPECT_EQ(table.at(0.5).yield, kYield);  // modulus and yield stress rise alike
  moisture.softens_elasticity = false;
  const MoistureTable dry(kClay, kYield, moisture, kPorosity);
  EXPECT_NEAR(youngs_modulus(dry.at(0.5)), 1e5, 1e-8);
  EXPECT_NEAR(dry.at(0.5).yield, 1.8 * kYield / std::sqrt(35.0), 1e-16);
}

TEST(MoistureTable, WithStiffnessKeptDryLetsTheStrengthFallAsAYieldStrain) {
  Moisture moisture;
  moisture.law = MoistureLaw::liquidity_index;
  moisture.softens_elasticity = false;
  const MoistureTable table(kClay, kYield, moisture, kPorosity);
  EXPECT_NEAR(youngs_modulus(table.at(1.0)), 1e5, 1e-8);
  EXPECT_NEAR(table.at(1.0).yield, kYield / 35.0, 1e-17);
  moisture.law = MoistureLaw::effective_medium;
  moisture.yield_law = YieldLaw::log_linear;
  moisture.saturated_yield_ratio = 0.25;
  const MoistureTable split(kClay, kYield, moisture, kPorosity);
  EXPECT_NEAR(youngs_modulus(split.at(1.0)), 1e5, 1e-8);
  EXPECT_NEAR(split.at(0.5).yield, 0.5 * kYield, 1e-17);
}

TEST(MoistureTable, OfAUserPassesThroughTheDataAndNeverOvershoots) {
  Moisture moisture;
  moisture.law = MoistureLaw::table;
  moisture.table_saturation = {0.0, 0.125, 0.25, 0.75, 1.0};      // nodes of the tabulation
  moisture.table_youngs_modulus = {1e5, 1.4e5, 1.4e5, 2e4, 1e4};  // stiffer when slightly wet
  moisture.table_yield = {0.02, 0.02, 0.015, 0.01, 0.001};
  const MoistureTable table(kClay, kYield, moisture, kPorosity);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(youngs_modulus(table.at(moisture.table_saturation[i])), moisture.table_youngs_modulus[i],
                1e-8);
    EXPECT_NEAR(table.at(moisture.table_saturation[i]).yield, moisture.table_yield[i], 1e-16);
  }
  double last = youngs_modulus(table.at(0.0));
  for (double S = 0.001; S <= 1.0; S += 0.001) {
    const double E = youngs_modulus(table.at(S));
    EXPECT_LE(E, 1.4e5 * (1.0 + 1e-14));
    if (S <= 0.125) {
      EXPECT_GE(E, last * (1.0 - 1e-14)) << S;
    }
    if (S >= 0.25) {
      EXPECT_LE(E, last * (1.0 + 1e-14)) << S;
    }
    last = E;
  }
}

TEST(MoistureTable, OfAUserBendsByTheHarmonicMeanOfTheSecants) {
  // Secants of −20 and −140 kPa: the slope between them is 2ab/(a+b) = −35 kPa [Fritsch & Butland 1984], at
  // the ends the secant. Hermite's cubic is (y₀+y₁)/2 + h(m₀−m₁)/8 in the middle. A mean of −80 kPa would lie
  // beyond three times the flat secant, where no cubic is monotone [Fritsch & Carlson 1980].
  Moisture moisture;
  moisture.law = MoistureLaw::table;
  moisture.table_saturation = {0.0, 0.5, 1.0};
  moisture.table_youngs_modulus = {1e5, 9e4, 2e4};
  moisture.table_yield = {0.02, 0.018, 0.004};
  const MoistureTable table(kClay, kYield, moisture, kPorosity);
  EXPECT_NEAR(youngs_modulus(table.at(0.25)), 95e3 + 0.5 / 8.0 * (-20e3 + 35e3), 1e-8);
  EXPECT_NEAR(youngs_modulus(table.at(0.75)), 55e3 + 0.5 / 8.0 * (-35e3 + 140e3), 1e-8);
  EXPECT_NEAR(table.at(0.25).yield, 0.019 + 0.5 / 8.0 * (-0.004 + 0.007), 1e-16);
}

TEST(MoistureTable, OfAUserWithTwoPointsIsAStraightLine) {
  Moisture moisture;
  moisture.law = MoistureLaw::table;
  moisture.table_saturation = {0.0, 1.0};
  moisture.table_youngs_modulus = {1e5, 2e4};
  moisture.table_yield = {0.02, 0.01};
  const MoistureTable table(kClay, kYield, moisture, kPorosity);
  for (const double S : {0.1, 0.37, 0.9}) EXPECT_NEAR(youngs_modulus(table.at(S)), 1e5 - 8e4 * S, 1e-8);
}

TEST(MoistureTable, HasAPreferredAxisOnlyForAlignedSpheroids) {
  Moisture moisture;
  EXPECT_TRUE(MoistureTable(kClay, kYield, moisture, kPorosity).is_isotropic());
  moisture.medium.aspect = 0.2;
  EXPECT_TRUE(MoistureTable(kClay, kYield, moisture, kPorosity).is_isotropic());
  moisture.medium.orientation = Orientation::aligned;
  const MoistureTable table(kClay, kYield, moisture, kPorosity);
  EXPECT_FALSE(table.is_isotropic());
  const Mat6 exact = compute_effective_medium(kClay, moisture.medium, kPorosity * 0.377).stiffness;
  EXPECT_LT((table.stiffness_at(0.377, Vec3::UnitZ()) - exact).norm(), 2e-6 * exact.norm());
  // Laid along x: what was C₃₃ is C₁₁ now.
  EXPECT_NEAR(table.stiffness_at(0.377, Vec3::UnitX())(0, 0), exact(2, 2), 2e-6 * exact(2, 2));
  EXPECT_LT(exact(2, 2), 0.8 * exact(0, 0));
  moisture.suction_peak_ratio = 1.8;
  moisture.suction_peak_saturation = 0.377;
  const MoistureTable sucked(kClay, kYield, moisture, kPorosity);
  EXPECT_LT((sucked.stiffness_at(0.377, Vec3::UnitZ()) - 1.8 * exact).norm(), 4e-6 * exact.norm());
  moisture.softens_elasticity = false;
  EXPECT_TRUE(MoistureTable(kClay, kYield, moisture, kPorosity).is_isotropic());
}

TEST(MoistureTable, IsReadableAtARoundedEndpoint) {
  const MoistureTable table(kClay, kYield, Moisture{}, kPorosity);
  EXPECT_EQ(table.at(std::nextafter(1.0, 2.0)).mu, table.at(1.0).mu);
  EXPECT_EQ(table.at(-1e-320).mu, table.at(0.0).mu);
}

}  // namespace
}  // namespace argil::material
