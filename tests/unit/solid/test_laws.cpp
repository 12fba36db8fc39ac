// Every elastic law of the table at one point: stress and tangent against the derivatives of the energy,
// objectivity, isotropy, the state of rest and that of small strain.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "base/rng.h"
#include "support/laws.h"

namespace argil::solid {
namespace {

Mat3 make_random_matrix(Rng& rng, double scale) {
  Mat3 a;
  for (int i = 0; i < 9; ++i) a(i) = rng.uniform(-scale, scale);
  return a;
}

Mat3 make_random_rotation(Rng& rng) {
  return Quat(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1))
      .normalized()
      .toRotationMatrix();
}

struct LawCase {
  StrainModel model;
  bool is_anisotropic;
  bool is_plastic;
};

std::string name_case(const LawCase& c) {
  return std::string(find_law(c.model).name) + (c.is_anisotropic ? "_anisotropic" : "") +
         (c.is_plastic ? "_plastic" : "");
}

void PrintTo(const LawCase& c, std::ostream* out) {
  *out << name_case(c);
}

class EveryLaw : public testing::TestWithParam<LawCase> {
 protected:
  EveryLaw() {
    C = make_isotropic_stiffness(3.0, 2.0);
    C(0, 0) += 1.5;
    C(3, 3) += 0.7;
    e.lambda = 3.0;
    e.mu = 2.0;
    if (GetParam().is_anisotropic) e.C = &C;
    if (GetParam().is_plastic) plastic = to_mandel(make_symmetric(0.1));
    F = make_random_rotation(rng) * (Mat3::Identity() + make_symmetric(0.25));
  }
  Mat3 make_symmetric(double scale) {
    const Mat3 a = make_random_matrix(rng, scale);
    return 0.5 * (a + a.transpose());
  }
  StrainModel model() const { return GetParam().model; }
  const ElasticLaw& law() const { return find_law(model()); }
  PointMotion motion(const Mat3& at) const { return make_motion(model(), at); }
  Mat3 piola(const Mat3& at) const { return compute_piola(model(), motion(at), plastic, e); }
  double energy(const Mat3& at) const { return compute_energy_density(model(), motion(at), plastic, e); }
  Mat9 tangent(const Mat3& at) const { return compute_tangent(model(), motion(at), plastic, e); }
  /// ∂P/∂F by central differences, column by column.
  Mat9 find_stress_slope(const Mat3& at, double d) const {
    Mat9 slope;
    for (int i = 0; i < 9; ++i) {
      Mat3 step = Mat3::Zero();
      step(i) = d;
      slope.col(i) = ((piola(at + step) - piola(at - step)) / (2 * d)).reshaped();
    }
    return slope;
  }

  Rng rng{4};
  Mat6 C;
  Elasticity e;
  Vec6 plastic = Vec6::Zero();
  Mat3 F;
};

class EveryLawWithoutFlow : public EveryLaw {};  // ε_p = 0
class EveryObjectiveLaw : public EveryLaw {};    // all but the linear one
class EveryIsotropicLaw : public EveryLaw {};    // without directions of its own

/// The order at which an error falls when the step of a difference is halved.
double find_order(double error, double error_of_half) {
  return std::log2(error / error_of_half);
}

TEST_P(EveryLawWithoutFlow, RestHasNoEnergyAndNoStress) {
  EXPECT_EQ(energy(Mat3::Identity()), 0.0);
  EXPECT_LT(piola(Mat3::Identity()).norm(), 1e-15);
  if (law().is_linear) return;
  const Mat3 Q = make_random_rotation(rng);
  EXPECT_NEAR(energy(Q), 0.0, 1e-15);
  EXPECT_LT(piola(Q).norm(), 1e-14);
}

TEST_P(EveryLawWithoutFlow, EnergyIsPositiveWhereThereIsStrain) {
  for (const double size : {1e-6, 1e-3, 0.1, 0.4}) {
    EXPECT_GT(energy(Mat3::Identity() + make_symmetric(size)), 0.0) << size;
  }
}

TEST_P(EveryLaw, StressIsTheDerivativeOfTheEnergy) {
  const Mat3 P = piola(F);
  for (int i = 0; i < 9; ++i) {
    const double d = 1e-5;  // error d² and rounding ε/d of the energy: both some 1e-10
    Mat3 plus = F;
    Mat3 minus = F;
    plus(i) += d;
    minus(i) -= d;
    EXPECT_NEAR(P(i), (energy(plus) - energy(minus)) / (2 * d), 1e-8) << i;
  }
}

TEST_P(EveryLaw, DifferencesOfEnergyReachTheStressAtTheirOrder) {
  const Mat3 D = make_random_matrix(rng, 1.0);
  const auto error = [&](double d) {
    return std::abs((energy(F + d * D) - energy(F - d * D)) / (2 * d) - piola(F).cwiseProduct(D).sum());
  };
  if (law().is_linear) {
    EXPECT_LT(error(1e-2), 1e-12);  // differences of a quadratic function are exact
  } else {
    EXPECT_NEAR(find_order(error(1e-2), error(5e-3)), 2.0, 0.02);
  }
}

TEST_P(EveryObjectiveLaw, StressTurnsWithTheBodyAndBalancesMoments) {
  const Mat3 Q = make_random_rotation(rng);
  EXPECT_LT((piola(Q * F) - Q * piola(F)).norm(), 1e-13);
  const Mat3 kirchhoff = piola(F) * F.transpose();
  EXPECT_LT((kirchhoff - kirchhoff.transpose()).norm(), 1e-13);
}

TEST_P(EveryObjectiveLaw, EnergyIsBlindToATurnOfTheBody) {
  const Mat3 Q = make_random_rotation(rng);
  EXPECT_NEAR(energy(Q * F), energy(F), 1e-14 * (1.0 + energy(F)));
}

TEST_P(EveryIsotropicLaw, IsotropicOneIsBlindToATurnOfTheMaterial) {
  const Mat3 Q = make_random_rotation(rng);
  const Mat3 turned = Q.transpose() * F * Q;  // of axes and body alike, so that the linear law bears it
  EXPECT_NEAR(energy(turned), energy(F), 1e-14 * (1.0 + energy(F)));
  EXPECT_LT((piola(turned) - Q.transpose() * piola(F) * Q).norm(), 1e-13);
  if (law().is_linear) return;
  EXPECT_NEAR(energy(F * Q), energy(F), 1e-14 * (1.0 + energy(F)));
  EXPECT_LT((piola(F * Q) - piola(F) * Q).norm(), 1e-13);
}

TEST_P(EveryLaw, TangentIsTheDerivativeOfTheStress) {
  e.excess_bulk = 5.0;  // held fast: its own change has another place in the matrix
  e.volume_change = 0.07;
  const Mat9 A = tangent(F);
  const Mat9 slope = find_stress_slope(F, 1e-6);
  for (int i = 0; i < 9; ++i) EXPECT_LT((A.col(i) - slope.col(i)).norm(), 1e-7) << i;
}

TEST_P(EveryLaw, DifferencesOfStressReachTheTangentAtTheirOrder) {
  e.excess_bulk = 5.0;
  e.volume_change = 0.07;
  const Mat3 D = make_random_matrix(rng, 1.0);
  const Eigen::Matrix<double, 9, 1> change = tangent(F) * D.reshaped();
  const auto error = [&](double d) {
    return ((piola(F + d * D) - piola(F - d * D)).reshaped() / (2 * d) - change).norm();
  };
  if (law().is_linear) {
    EXPECT_LT(error(1e-2), 1e-12);
  } else {
    EXPECT_NEAR(find_order(error(1e-2), error(5e-3)), 2.0, 0.02);
  }
}

TEST_P(EveryLaw, TangentIsSymmetric) {
  const Mat9 A = tangent(F);
  EXPECT_LT((A - A.transpose()).norm(), 1e-13 * A.norm());
}

TEST_P(EveryLaw, TangentHasNoNegativeModeUnderStrongCompression) {
  F = make_random_rotation(rng) * Vec3(0.3, 0.4, 0.5).asDiagonal();
  const Mat9 A = compute_positive_tangent(model(), motion(F), plastic, e);
  EXPECT_LT((A - A.transpose()).norm(), 1e-12 * A.norm());
  EXPECT_GT(A.selfadjointView<Eigen::Lower>().eigenvalues()(0), -1e-8 * A.norm());
}

TEST_P(EveryLawWithoutFlow, SmallStrainIsHookesLaw) {
  const Mat3 strain = make_symmetric(1e-7);
  const Vec6 stress = compute_stress(e, to_mandel(strain));
  const Mat3 expected = from_mandel(stress);
  EXPECT_LT((piola(Mat3::Identity() + strain) - expected).norm(), 1e-5 * expected.norm());
  const double work = 0.5 * stress.dot(to_mandel(strain));
  // A law whose energy cancels loses the digits of strains whose square is near rounding.
  EXPECT_NEAR(energy(Mat3::Identity() + strain), work, law().has_cancelling_energy ? 1e-15 : 1e-5 * work);
}

TEST_P(EveryLawWithoutFlow, TangentAtRestIsTheStiffness) {
  const Mat9 A = tangent(Mat3::Identity());
  for (int k = 0; k < 9; ++k) {
    const Mat3 dF = Mat3::Identity().col(k % 3) * Mat3::Identity().col(k / 3).transpose();
    const Mat3 expected = from_mandel(compute_stress(e, to_mandel(0.5 * (dF + dF.transpose()))));
    EXPECT_LT((A.col(k) - expected.reshaped()).norm(), 1e-14 * A.norm()) << k;
  }
}

TEST_P(EveryLaw, ExcessBulkPressesAlongTheVolumeGradient) {
  const Mat3 own = piola(F);
  e.excess_bulk = 5.0;
  e.volume_change = 0.07;
  const Mat3 gradient = compute_volume_gradient(model(), motion(F), plastic);
  EXPECT_LT((piola(F) - own - 0.35 * gradient).norm(), 1e-13);
}

TEST_P(EveryLaw, VolumeGradientIsTheDerivativeOfTheVolumeChange) {
  const Mat3 gradient = compute_volume_gradient(model(), motion(F), plastic);
  for (int i = 0; i < 9; ++i) {
    const double d = 1e-5;
    const auto change = [&](double step) {
      Mat3 at = F;
      at(i) += step;
      return compute_volume_change(model(), motion(at), plastic);
    };
    EXPECT_NEAR(gradient(i), (change(d) - change(-d)) / (2 * d), 1e-9) << i;
  }
}

TEST_P(EveryLaw, BearsInversionOrSaysThatItDoesNot) {
  for (const double least : {-0.2, 0.0}) {
    F = make_random_rotation(rng) * Vec3(1.1, 0.9, least).asDiagonal();
    if (law().bears_inversion) {
      EXPECT_TRUE(std::isfinite(energy(F)) && piola(F).allFinite() && tangent(F).allFinite()) << least;
    } else {
      EXPECT_EQ(energy(F), INFINITY) << least;
      EXPECT_TRUE(piola(F).array().isNaN().all() && tangent(F).array().isNaN().all()) << least;
    }
  }
}

/// All combinations that the laws allow and `belongs` takes.
template <class Belongs>
std::vector<LawCase> make_cases(Belongs belongs) {
  std::vector<LawCase> cases;
  for (const StrainModel model : test::every_model())
    for (const bool is_anisotropic : {false, true})
      for (const bool is_plastic : {false, true}) {
        const LawCase c{model, is_anisotropic, is_plastic};
        const ElasticLaw& law = find_law(model);
        const bool is_possible = (!is_anisotropic || law.takes_full_stiffness) &&
                                 (!is_plastic || law.plastic_split != PlasticSplit::none);
        if (is_possible && belongs(c)) cases.push_back(c);
      }
  return cases;
}

std::string name_param(const testing::TestParamInfo<LawCase>& info) {
  return name_case(info.param);
}

INSTANTIATE_TEST_SUITE_P(Laws, EveryLaw, testing::ValuesIn(make_cases([](const LawCase&) { return true; })),
                         name_param);
INSTANTIATE_TEST_SUITE_P(Laws, EveryLawWithoutFlow,
                         testing::ValuesIn(make_cases([](const LawCase& c) { return !c.is_plastic; })),
                         name_param);
INSTANTIATE_TEST_SUITE_P(Laws, EveryObjectiveLaw, testing::ValuesIn(make_cases([](const LawCase& c) {
                           return !find_law(c.model).is_linear;
                         })),
                         name_param);
INSTANTIATE_TEST_SUITE_P(Laws, EveryIsotropicLaw, testing::ValuesIn(make_cases([](const LawCase& c) {
                           return !c.is_anisotropic && !c.is_plastic;
                         })),
                         name_param);

TEST(ElasticLaws, StandInTheOrderOfTheirModelsUnderNamesOfTheirOwn) {
  EXPECT_STREQ(find_law(StrainModel::corotational).name, "corotational");
  EXPECT_STREQ(find_law(StrainModel::linear).name, "linear");
  EXPECT_STREQ(find_law(StrainModel::neo_hookean).name, "neo_hookean");
  EXPECT_STREQ(find_law(StrainModel::hencky).name, "hencky");
  EXPECT_STREQ(find_law(StrainModel::curnier).name, "curnier");
}

Vec6 make_deviator(Vec6 e) {
  e.head<3>().array() -= e.head<3>().sum() / 3.0;
  return e;
}

TEST(NeoHookean, PlasticStrainWithoutTraceTakesNoVolumeHoweverLarge) {
  // The body at its rest shape after ε_p: det Fₑ = 1/det F_p = exp(−tr ε_p).
  Rng rng(3, "plastic");
  const Mat3 a = make_random_matrix(rng, 0.3);
  const Vec6 e = to_mandel(0.5 * (a + a.transpose()));
  const PointMotion rest = make_motion(StrainModel::neo_hookean, Mat3::Identity());
  EXPECT_NEAR(compute_volume_change(StrainModel::neo_hookean, rest, make_deviator(e)), 0.0, 1e-15);
  EXPECT_NEAR(compute_volume_change(StrainModel::neo_hookean, rest, e), std::exp(-e.head<3>().sum()) - 1.0,
              1e-15);
}

TEST(FlowDrive, IsTheEnergysSlopeAlongPlasticStrainWithoutTrace) {
  // −∂W/∂ε_p : d = 2μ q : d for every d without trace, by central differences; also where F_p is large.
  Rng rng(9, "drive");
  const Elasticity e{30.0, 2.0};
  for (const StrainModel model : {StrainModel::linear, StrainModel::corotational, StrainModel::neo_hookean})
    for (const double size : {0.05, 0.3}) {
      const Mat3 F = make_random_rotation(rng) * (Mat3::Identity() + make_random_matrix(rng, size));
      const PointMotion motion = make_motion(model, F);
      const Mat3 a = make_random_matrix(rng, size);
      const Vec6 plastic = to_mandel(0.5 * (a + a.transpose()));
      const Vec6 q = compute_flow_drive(model, motion, plastic, e, 2.0 * e.mu);
      const Mat3 b = make_random_matrix(rng, 1.0);
      const Vec6 d = make_deviator(to_mandel(0.5 * (b + b.transpose())));
      const auto energy = [&](double s) { return compute_energy_density(model, motion, plastic + s * d, e); };
      EXPECT_NEAR(-(energy(1e-5) - energy(-1e-5)) / 2e-5, 2.0 * e.mu * q.dot(d), 1e-7 * (1.0 + energy(0.0)));
      EXPECT_NEAR(q.head<3>().sum(), 0.0, 1e-14 * (1.0 + q.norm()));
    }
}

}  // namespace
}  // namespace argil::solid
