// `argil probe`: effective medium, Eshelby's tensor, plastic flow and the clay kernel against closed forms of
// the literature.
#include <gtest/gtest.h>

#include <cmath>

#include "probe_calls.h"

namespace argil::scenario {
namespace {

constexpr double kE = 1e5;
constexpr double kNu = 0.3;
constexpr double kK = kE / (3.0 * (1.0 - 2.0 * kNu));
constexpr double kG = kE / (2.0 * (1.0 + kNu));
constexpr double kFluidK = 2e4;
constexpr double kFluidG = 5e3;
constexpr double kPhi = 0.3;

struct Moduli {
  double K, G;
};

Moduli probe_scheme(const std::string& scheme, double phi = kPhi) {
  const Json result =
      probe_one("effective_medium",
                R"({"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "fluid_bulk_modulus_Pa": 2e4,
                                    "fluid_shear_modulus_Pa": 5e3, "scheme": ")" +
                    scheme + R"(", "phi": )" + std::to_string(phi) + "}");
  return {result["bulk_modulus_Pa"].get<double>(), result["shear_modulus_Pa"].get<double>()};
}

void expect_moduli(const Moduli& result, const Moduli& expected, double tolerance = 1e-13) {  // rounding
  EXPECT_NEAR(result.K, expected.K, tolerance * kK);
  EXPECT_NEAR(result.G, expected.G, tolerance * kG);
}

/// Shear of a sphere's surroundings: ζ = G(9K + 8G)/(6(K + 2G)); their bulk counterpart is 4G/3.
double compute_zeta(const Moduli& m) {
  return m.G * (9.0 * m.K + 8.0 * m.G) / (6.0 * (m.K + 2.0 * m.G));
}

/// Hashin and Shtrikman's bound with `matrix` around spheres that fill `share` (J. Mech. Phys. Solids 1963).
Moduli compute_hashin_shtrikman(const Moduli& matrix, const Moduli& sphere, double share) {
  const double k = 3.0 * (1.0 - share) / (3.0 * matrix.K + 4.0 * matrix.G);
  const double g = (1.0 - share) / (matrix.G + compute_zeta(matrix));
  return {matrix.K + share / (1.0 / (sphere.K - matrix.K) + k),
          matrix.G + share / (1.0 / (sphere.G - matrix.G) + g)};
}

TEST(ProbeEffectiveMedium, VoigtAndReussAreTheTwoMeans) {
  expect_moduli(probe_scheme("voigt"),
                {(1 - kPhi) * kK + kPhi * kFluidK, (1 - kPhi) * kG + kPhi * kFluidG});  // eq. 3
  expect_moduli(probe_scheme("reuss"), {1.0 / ((1 - kPhi) / kK + kPhi / kFluidK),
                                        1.0 / ((1 - kPhi) / kG + kPhi / kFluidG)});  // eq. 4
}

TEST(ProbeEffectiveMedium, DiluteIsThePapersEquation6) {
  // [1 + φ(Q − P)⁻¹]S^M for each part: Q = K_M/(K_M − K_I), P = α for the bulk and β for the shear part.
  const double alpha = (1 + kNu) / (3 * (1 - kNu));
  const double beta = 2 * (4 - 5 * kNu) / (15 * (1 - kNu));
  expect_moduli(probe_scheme("dilute"), {kK / (1 + kPhi / (kK / (kK - kFluidK) - alpha)),
                                         kG / (1 + kPhi / (kG / (kG - kFluidG) - beta))});
  expect_moduli(probe_scheme("dilute_strain"),
                {kK + kPhi * (kFluidK - kK) / (1 + alpha * (kFluidK - kK) / kK),
                 kG + kPhi * (kFluidG - kG) / (1 + beta * (kFluidG - kG) / kG)});
}

TEST(ProbeEffectiveMedium, HashinShtrikmanBoundsAndMoriTanakaAreTheirFormulas) {
  const Moduli upper = compute_hashin_shtrikman({kK, kG}, {kFluidK, kFluidG}, kPhi);
  expect_moduli(probe_scheme("hs_upper"), upper);
  expect_moduli(probe_scheme("mori_tanaka"), upper);  // with spheres in the stiffer phase the two agree
  expect_moduli(probe_scheme("hs_lower"), compute_hashin_shtrikman({kFluidK, kFluidG}, {kK, kG}, 1.0 - kPhi));
}

TEST(ProbeEffectiveMedium, SelfConsistentSolvesHillsEquations) {
  // Σ φᵢ(Kᵢ − K)/(Kᵢ + 4G/3) = 0 and Σ φᵢ(Gᵢ − G)/(Gᵢ + ζ) = 0 (Berryman 1980, spheres).
  const Moduli m = probe_scheme("self_consistent");
  const double four = 4.0 * m.G / 3.0;
  const double zeta = compute_zeta(m);
  EXPECT_NEAR((1 - kPhi) * (kK - m.K) / (kK + four) + kPhi * (kFluidK - m.K) / (kFluidK + four), 0.0, 1e-11);
  EXPECT_NEAR((1 - kPhi) * (kG - m.G) / (kG + zeta) + kPhi * (kFluidG - m.G) / (kFluidG + zeta), 0.0, 1e-11);
}

TEST(ProbeEffectiveMedium, DifferentialFollowsItsOrdinaryDifferentialEquation) {
  // (1 − φ) K' = (K_I − K)(K + 4G/3)/(K_I + 4G/3), the same for G with ζ (McLaughlin 1977); Runge–Kutta.
  const auto slope = [](const Moduli& m, double phi) -> Moduli {
    const double four = 4.0 * m.G / 3.0;
    const double zeta = compute_zeta(m);
    return {(kFluidK - m.K) / (1 - phi) * (m.K + four) / (kFluidK + four),
            (kFluidG - m.G) / (1 - phi) * (m.G + zeta) / (kFluidG + zeta)};
  };
  const auto add = [](const Moduli& m, const Moduli& d, double h) -> Moduli {
    return {m.K + h * d.K, m.G + h * d.G};
  };
  constexpr int kSteps = 1000;
  const double h = kPhi / kSteps;
  Moduli m{kK, kG};
  for (int i = 0; i < kSteps; ++i) {
    const Moduli a = slope(m, i * h);
    const Moduli b = slope(add(m, a, h / 2), (i + 0.5) * h);
    const Moduli c = slope(add(m, b, h / 2), (i + 0.5) * h);
    const Moduli d = slope(add(m, c, h), (i + 1) * h);
    m = add(add(add(add(m, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
  }
  expect_moduli(probe_scheme("differential"), m, 1e-8);  // both integrate; the program's step is the coarser
}

TEST(ProbeEffectiveMedium, StatusTellsWhereThePaperLeavesTheBoundsAndWhereItFails) {
  // ν = 0.3, water of 2.2 GPa: above Voigt from φ = α = 0.619 (bulk), not positive definite past
  // α + K_M/(K_I − K_M) = 0.6191; shear leaves Voigt from φ = β = 0.476.
  const auto status = [](double phi) {
    return probe_one("effective_medium", R"({"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3,
      "fluid_bulk_modulus_Pa": 2.2e9, "scheme": "dilute", "phi": )" +
                                             std::to_string(phi) + "}")["status"]
        .get<std::string>();
  };
  EXPECT_EQ(status(0.47), "ok");
  EXPECT_EQ(status(0.48), "above_voigt");
  EXPECT_EQ(status(0.62), "not_positive_definite");
}

TEST(ProbeEffectiveMedium, StiffnessIsThreeKAndTwoGInMandelForm) {
  const Json result =
      probe_one("effective_medium", R"({"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "phi": 0.2})");
  const double K = result["bulk_modulus_Pa"].get<double>();
  const double G = result["shear_modulus_Pa"].get<double>();
  const Json& C = result["stiffness_mandel"];
  EXPECT_NEAR(at(C, 0, 0), K + 4.0 * G / 3.0, 1e-9);
  EXPECT_NEAR(at(C, 0, 1), K - 2.0 * G / 3.0, 1e-9);
  EXPECT_NEAR(at(C, 5, 5), 2.0 * G, 1e-9);
  EXPECT_NEAR(at(C, 0, 5), 0.0, 1e-9);
}

TEST(ProbeEshelby, SphereIsMurasFormula) {
  // [Mura1987, 11.21]: S1111 = (7 − 5ν)/(15(1 − ν)), S1122 = (5ν − 1)/(15(1 − ν)), S1212 = (4 − 5ν)/(15(1 −
  // ν)).
  const double nu = 0.25;
  const Json S = probe_one("eshelby", R"({"poissons_ratio": 0.25, "aspect": 1})")["eshelby_mandel"];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(at(S, i, j), (i == j ? 7 - 5 * nu : 5 * nu - 1) / (15 * (1 - nu)), 1e-14);
      EXPECT_NEAR(at(S, i + 3, j + 3), i == j ? 2 * (4 - 5 * nu) / (15 * (1 - nu)) : 0.0, 1e-14);
    }
}

TEST(ProbeEffectiveMedium, GoesToTheEndsOfShapeAndShare) {
  // φ = 1 is the fluid itself; layers (aspect 0) across axis 3 are Backus's laminate: G₁₃ harmonic, G₁₂ mean.
  expect_moduli(probe_scheme("mori_tanaka", 1.0), {kFluidK, kFluidG});
  expect_moduli(probe_scheme("differential", 1.0), {kFluidK, kFluidG}, 1e-9);
  const Json C = probe_one("effective_medium", R"({"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3,
    "fluid_bulk_modulus_Pa": 2e4, "fluid_shear_modulus_Pa": 5e3, "phi": 0.3, "aspect": 0,
    "orientation": "aligned"})")["stiffness_mandel"];
  EXPECT_NEAR(at(C, 4, 4), 2.0 / ((1 - kPhi) / kG + kPhi / kFluidG), 1e-12 * kG);
  EXPECT_NEAR(at(C, 5, 5), 2.0 * ((1 - kPhi) * kG + kPhi * kFluidG), 1e-12 * kG);
}

TEST(ProbeEshelby, PennyOfNoThicknessIsALayer) {
  const Json S = probe_one("eshelby", R"({"poissons_ratio": 0.25, "aspect": 0})")["eshelby_mandel"];
  EXPECT_NEAR(at(S, 2, 2), 1.0, 1e-15);
  EXPECT_NEAR(at(S, 4, 4), 1.0, 1e-15);
  EXPECT_NEAR(at(S, 2, 0), 0.25 / 0.75, 1e-15);
  EXPECT_NEAR(at(S, 0, 0), 0.0, 1e-15);
}

TEST(ProbeEshelby, LongFibreAlongAxis3IsTheCylinder) {
  // [Mura1987, 11.22] with axis 3: S1111 = (5 − 4ν)/(8(1 − ν)), S3333 = 0, S1313 = ¼ (Mandel ½).
  const double nu = 0.25;
  const Json S = probe_one("eshelby", R"({"poissons_ratio": 0.25, "aspect": 1e4})")["eshelby_mandel"];
  constexpr double kFinite = 1e-6;  // (ln a)/a² is 1e-7 at this aspect
  EXPECT_NEAR(at(S, 0, 0), (5 - 4 * nu) / (8 * (1 - nu)), kFinite);
  EXPECT_NEAR(at(S, 2, 2), 0.0, kFinite);
  EXPECT_NEAR(at(S, 4, 4), 0.5, kFinite);
}

/// Plastic strain 11 after 10 ms at ε = diag(0.1, 0, 0), yield 0.02, creep 20/s.
Json flow(const std::string& more) {
  return probe_one("plastic_update", R"({"strain": [[0.1,0,0],[0,0,0],[0,0,0]], "yield": 0.02,
    "creep_per_s": 20, "step_s": 0.01)" + more +
                                         "}")["plastic_strain"];
}

TEST(ProbePlasticUpdate, FlowsByRateOrLiterally) {
  EXPECT_NEAR(at(flow(R"(, "max": 1)"), 0, 0), 0.1 * (1.0 - std::exp(-0.2)), 1e-16);
  EXPECT_NEAR(at(flow(R"(, "max": 1, "form": "literal")"), 0, 0), 0.1 * 0.2, 1e-16);
  EXPECT_EQ(at(flow(R"(, "max": 1)"), 1, 1), 0.0);
}

TEST(ProbePlasticUpdate, FlowsOfTheElasticPartOnlyAndUpToTheCap) {
  // ε_e = 0.1 − 0.09 is below the yield strain: nothing moves.
  EXPECT_EQ(at(flow(R"(, "max": 1, "plastic_strain": [[0.09,0,0],[0,0,0],[0,0,0]])"), 0, 0), 0.09);
  EXPECT_NEAR(at(flow(R"(, "max": 0.01)"), 0, 0), 0.01, 1e-16);
}

TEST(ProbePlasticUpdate, NormsDifferInShear) {
  // ε₁₂ = 0.015: Frobenius 0.015·√2 = 0.0212 is above the yield strain 0.02, the six-vector's 0.015 below.
  const auto shear = [](const std::string& norm) {
    return at(probe_one("plastic_update",
                        R"({"strain": [[0,0.015,0],[0.015,0,0],[0,0,0]], "yield": 0.02, "creep_per_s": 20,
                            "max": 1, "step_s": 0.01, "norm": ")" +
                            norm + "\"}")["plastic_strain"],
              0, 1);
  };
  EXPECT_NEAR(shear("frobenius"), 0.015 * (1.0 - std::exp(-0.2)), 1e-17);
  EXPECT_EQ(shear("voigt6"), 0.0);
}

TEST(ProbePlasticUpdate, J2ReturnsTheDeviatorToTheYieldNorm) {
  // dev ε = 0.1 (2, −1, −1)/3 of norm 0.1 √(2/3): what is left of it has the norm of the yield strain.
  const Json result = flow(R"(, "max": 1, "form": "j2")");
  const double flown = 1.0 - 0.02 / (0.1 * std::sqrt(2.0 / 3.0));
  EXPECT_NEAR(at(result, 0, 0), 0.2 / 3.0 * flown, 1e-16);
  EXPECT_NEAR(at(result, 1, 1), -0.1 / 3.0 * flown, 1e-16);
  EXPECT_NEAR(at(result, 2, 2), -0.1 / 3.0 * flown, 1e-16);
}

TEST(ProbePlasticUpdate, MandelStrainGivesMandelPlasticStrain) {
  const Json result = probe_one("plastic_update", R"({"strain": [0.1,0,0,0,0,0], "yield": 0.02,
    "creep_per_s": 20, "max": 1, "step_s": 0.01, "form": "literal"})")["plastic_strain"];
  EXPECT_NEAR(at(result, 0), 0.02, 1e-17);
}

double probe_weight(const std::string& r, const std::string& k2 = "60") {
  return probe_one("clay_kernel",
                   R"({"k1": 2, "k2": )" + k2 + R"(, "radius_m": 0.04, "r_m": )" + r + "}")["weight"]
      .get<double>();
}

TEST(ProbeClayKernel, IsEquation9OnBothSidesOfTheRadius) {
  EXPECT_DOUBLE_EQ(probe_weight("0"), 1.0);
  EXPECT_DOUBLE_EQ(probe_weight("0.03"), 1.0 / 1.06);
  EXPECT_DOUBLE_EQ(probe_weight("0.04"),
                   1.0 / (1.08 + std::exp(2.4)));  // r = R_D is outside: r < R_D is inside
  EXPECT_DOUBLE_EQ(probe_weight("0.1"), 1.0 / (1.2 + std::exp(6.0)));
}

TEST(ProbeClayKernel, GoesToZeroWhereTheExponentialOverflows) {
  EXPECT_GT(probe_weight("1", "690"), 0.0);
  EXPECT_EQ(probe_weight("1", "1e6"), 0.0);
}

}  // namespace
}  // namespace argil::scenario
