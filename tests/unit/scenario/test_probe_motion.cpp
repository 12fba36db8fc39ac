// `argil probe`: contact integrals, the polar decomposition and one element, against values derived by hand;
// and what the command refuses.
#include <Eigen/Eigenvalues>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/types.h"
#include "probe_calls.h"
#include "support/temp_folder.h"

namespace argil::scenario {
namespace {

constexpr double kRounding = 1e-14;

void expect_vector(const Json& list, const Vec3& expected, double tolerance = kRounding) {
  for (Eigen::Index i = 0; i < 3; ++i)
    EXPECT_NEAR(at(list, static_cast<std::size_t>(i)), expected(i), tolerance);
}

void expect_weights(const Json& list, std::array<double, 4> expected) {
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(at(list, i), expected[i], kRounding);
}

/// A vertex over ¼, ¼ of the triangle (0,0,0) (1,0,0) (0,1,0) from height z0 to z1.
Json drop(const std::string& z0, const std::string& z1, const std::string& inside) {
  const std::string face = ", [0,0,0], [1,0,0], [0,1,0]]";
  return probe_one("vertex_face", R"({"t0": [[0.25,0.25,)" + z0 + "]" + face + R"(, "t1": [[0.25,0.25,)" +
                                      z1 + "]" + face + R"(, "inside_at_start": )" + inside + "}");
}

TEST(ProbeVertexFace, StraightEntryIsATriangleOfDepthOverTime) {
  // z = 0.3 − 0.4t crosses at t = ¾ and is −0.1 at the end: ∫ z dt = −½·¼·0.1.
  const Json result = drop("0.3", "-0.1", "false");
  ASSERT_EQ(result["intervals"].size(), 1u);
  EXPECT_NEAR(at(result["intervals"], 0, 0), 0.75, kRounding);
  EXPECT_EQ(at(result["intervals"], 0, 1), 1.0);
  expect_vector(result["integral"], {0, 0, -0.0125});
  expect_weights(result["entry_weights"], {1, 0.5, 0.25, 0.25});
}

TEST(ProbeVertexFace, InsideAtTheStartPressesUntilItIsOut) {
  const Json result = drop("-0.1", "0.3", "true");
  EXPECT_EQ(at(result["intervals"], 0, 0), 0.0);
  EXPECT_NEAR(at(result["intervals"], 0, 1), 0.25, kRounding);
  expect_vector(result["integral"], {0, 0, -0.0125});
  // Resting inside for the whole interval: the depth itself.
  expect_vector(drop("-0.1", "-0.1", "true")["integral"], {0, 0, -0.1});
}

TEST(ProbeVertexFace, MotionOutwardsOrBesideTheFaceIsNoPenetration) {
  EXPECT_TRUE(drop("-0.1", "0.3", "false")["intervals"].empty());
  const Json beside = probe_one("vertex_face", R"({"t0": [[2,2,0.3], [0,0,0], [1,0,0], [0,1,0]],
                                                   "t1": [[2,2,-0.1], [0,0,0], [1,0,0], [0,1,0]]})");
  EXPECT_TRUE(beside["intervals"].empty());
}

TEST(ProbeVertexFace, SizesWhoseVolumesAreNoNumbersAreRefusedWithTheBound) {
  const auto scaled = [](const char* kernel, const std::string& unit, const std::string& end) {
    const std::string face = ", [0,0,0], [" + unit + ",0,0], [0," + unit + ",0]]";
    return probe_one(kernel,
                     R"({"t0": [[0,0,)" + unit + "]" + face + R"(, "t1": [[0,0,)" + end + "]" + face + "}");
  };
  for (const char* kernel : {"vertex_face", "edge_edge"}) {
    ARGIL_EXPECT_THROW_WITH(scaled(kernel, "1e200", "-1e200"), InputError, "is outside [-1e50, 1e50] m");
    ARGIL_EXPECT_THROW_WITH(scaled(kernel, "1", "-1e308"), InputError, "cases[0].t1");
    ARGIL_EXPECT_THROW_WITH(scaled(kernel, "1e-200", "-1e-200"), InputError, "less than 1e-50 m apart");
  }
  // At both bounds a drop to as far below as it was above crosses at one half.
  for (const char* unit : {"1e50", "1e-50"})
    EXPECT_EQ(at(scaled("vertex_face", unit, std::string("-") + unit)["intervals"], 0, 0), 0.5) << unit;
}

TEST(ProbeVertexFace, TurningFaceUsesItsUnitNormalAtEachMoment) {
  // Face (0,0,0) (1,0,0) (0,1,t), vertex at rest in (¼, ½, ¼). With N = (0, −t, 1), N·p = ¼ − t/2 turns
  // negative at ½, and ∫ N (N·p)/(1 + t²) dt from ½ to 1 has this primitive:
  const auto y = [](double t) { return -(0.125 * std::log1p(t * t) - 0.5 * (t - std::atan(t))); };
  const auto z = [](double t) { return 0.25 * std::atan(t) - 0.25 * std::log1p(t * t); };
  const Json result = probe_one("vertex_face", R"({"t0": [[0.25,0.5,0.25], [0,0,0], [1,0,0], [0,1,0]],
                                                   "t1": [[0.25,0.5,0.25], [0,0,0], [1,0,0], [0,1,1]]})");
  EXPECT_NEAR(at(result["intervals"], 0, 0), 0.5, kRounding);
  expect_vector(result["integral"], {0, y(1.0) - y(0.5), z(1.0) - z(0.5)}, 1e-13);
  expect_weights(result["entry_weights"], {1, 0.25, 0.25, 0.5});
}

TEST(ProbeVertexFace, TurningFaceCanBeEnteredTwice) {
  // Edges (1, 0, t) and (t, 1, 0) have N = (−t, t², 1); with p = (0.4, ¼(3/2 − t), 3/128 + 0.228125 t)
  // N·p = −¼ (t − ¼)(t − ½)(t − ¾), so that the vertex is inside from ¼ to ½ and from ¾ on.
  const Json result = probe_one("vertex_face", R"({"t0": [[0.4,0.375,0.0234375], [0,0,0], [1,0,0], [0,1,0]],
                                                   "t1": [[0.4,0.125,0.2515625], [0,0,0], [1,0,1], [1,1,0]]})");
  ASSERT_EQ(result["intervals"].size(), 2u);
  EXPECT_NEAR(at(result["intervals"], 0, 0), 0.25, 1e-13);
  EXPECT_NEAR(at(result["intervals"], 0, 1), 0.5, 1e-13);
  EXPECT_NEAR(at(result["intervals"], 1, 0), 0.75, 1e-13);
  EXPECT_EQ(at(result["intervals"], 1, 1), 1.0);
  // ∫ N (N·p)/|N|² dt by Simpson's rule on the formula above.
  Vec3 expected = Vec3::Zero();
  constexpr int kPieces = 400;
  for (const auto& [begin, end] : {std::pair{0.25, 0.5}, {0.75, 1.0}})
    for (int i = 0; i <= kPieces; ++i) {
      const double t = begin + (end - begin) * i / kPieces;
      const double w = (i == 0 || i == kPieces ? 1.0
                        : i % 2 == 0           ? 2.0
                                               : 4.0) *
                       (end - begin) / (3.0 * kPieces);
      const double height = -0.25 * (t - 0.25) * (t - 0.5) * (t - 0.75);
      expected += w * height / (1.0 + t * t + t * t * t * t) * Vec3(-t, t * t, 1.0);
    }
  expect_vector(result["integral"], expected, 1e-13);
  // At the first entry: p = β (1, 0, t) + γ (t, 1, 0) with γ = ¼(3/2 − t), β = 0.4 − γ t.
  expect_weights(result["entry_weights"], {1, 1 - 0.3125 - 0.321875, 0.321875, 0.3125});
}

TEST(ProbeEdgeEdge, CrossingEdgesGiveDepthAlongTheirCommonNormal) {
  // Edge a along x from x = −½ to 1.5, sinking from 0.2 to −0.2 through edge b along y: ∫ = −½·½·0.2.
  const Json result = probe_one("edge_edge", R"({"t0": [[-0.5,0,0.2], [1.5,0,0.2], [0,-1,0], [0,1,0]],
                                                 "t1": [[-0.5,0,-0.2], [1.5,0,-0.2], [0,-1,0], [0,1,0]]})");
  ASSERT_EQ(result["intervals"].size(), 1u);
  EXPECT_NEAR(at(result["intervals"], 0, 0), 0.5, kRounding);
  expect_vector(result["integral"], {0, 0, -0.05});
  expect_weights(result["entry_weights"], {0.75, 0.25, 0.5, 0.5});
}

TEST(ProbeEdgeEdge, EdgesThatPassBesideEachOtherDoNotMeet) {
  EXPECT_TRUE(probe_one("edge_edge", R"({"t0": [[0.5,0,0.2], [1.5,0,0.2], [0,-1,0], [0,1,0]],
                                         "t1": [[0.5,0,-0.2], [1.5,0,-0.2], [0,-1,0], [0,1,0]]})")
                  ["intervals"]
                      .empty());
}

TEST(ProbePolar, ReturnsTheFactorsOfAKnownProduct) {
  // R turns by 30° about z; S = [[2, 0.5, 0], [0.5, 1, 0], [0, 0, 3]].
  const double c = std::cos(std::numbers::pi / 6.0);
  const double s = 0.5;
  const Mat3 R = (Mat3() << c, -s, 0, s, c, 0, 0, 0, 1).finished();
  const Mat3 S = (Mat3() << 2, 0.5, 0, 0.5, 1, 0, 0, 0, 3).finished();
  const Mat3 F = R * S;
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({F(i, 0), F(i, 1), F(i, 2)});
  const Json result = probe_one("polar", Json({{"F", rows}}).dump());
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(at(result["R"], i, j), R(static_cast<int>(i), static_cast<int>(j)), kRounding);
      EXPECT_NEAR(at(result["S"], i, j), S(static_cast<int>(i), static_cast<int>(j)), kRounding);
    }
}

constexpr const char* kUnitTet = R"("rest": [[0,0,0], [1,0,0], [0,1,0], [0,0,1]], "youngs_modulus_Pa": 1000,
  "poissons_ratio": 0.25, )";

TEST(ProbeElement, UniaxialStressLoadsTheFacesByStressTimesAreaOverThree) {
  // Stretched by e along x and contracted by νe across, then turned by 90° about z: σ = E e along the turned
  // axis. ∂W/∂x of corner 1 is σ·½·⅓ along y, of corner 0 the opposite, of the others 0. W = ½ E e² V.
  const Json result =
      probe_one("element", std::string("{") + kUnitTet +
                               R"("deformed": [[0,0,0], [0,1.01,0], [-0.9975,0,0], [0,0,0.9975]]})");
  const double e = 0.01;
  expect_vector(result["force"][1], {0, 1000 * e / 6, 0}, 1e-12);
  expect_vector(result["force"][0], {0, -1000 * e / 6, 0}, 1e-12);
  expect_vector(result["force"][2], {0, 0, 0}, 1e-12);
  EXPECT_NEAR(result["energy_J"].get<double>(), 0.5 * 1000 * e * e / 6.0, 1e-14);
}

TEST(ProbeElement, PlasticStrainTakesTheStressAway) {
  const Json result = probe_one("element", std::string("{") + kUnitTet +
                                               R"("deformed": [[0,0,0], [1.01,0,0], [0,1,0], [0,0,1]],
                                                  "plastic_strain": [[0.01,0,0],[0,0,0],[0,0,0]]})");
  for (std::size_t i = 0; i < 4; ++i) expect_vector(result["force"][i], {0, 0, 0}, 1e-12);
}

TEST(ProbeElement, StiffnessHasRankSixAndTheLinearModelsForceIsItTimesTheDisplacement) {
  const Json result = probe_one("element", std::string("{") + kUnitTet +
                                               R"("model": "linear",
      "deformed": [[0,0,0], [1.01,0.02,0], [0.03,1,-0.01], [0.01,0,1.02]]})");
  Eigen::Matrix<double, 12, 12> K;
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = 0; j < 12; ++j)
      K(static_cast<int>(i), static_cast<int>(j)) = at(result["stiffness"], i, j);
  EXPECT_LT((K - K.transpose()).norm(), 1e-12 * K.norm());
  const Eigen::VectorXd modes = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
  EXPECT_EQ((modes.array().abs() > 1e-12 * modes.maxCoeff()).count(), 6);  // 12 less 6 rigid motions
  Eigen::Matrix<double, 12, 1> u;
  u << 0, 0, 0, 0.01, 0.02, 0, 0.03, 0, -0.01, 0.01, 0, 0.02;
  const Eigen::VectorXd f = K * u;
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_NEAR(at(result["force"], i / 3, i % 3), f(static_cast<int>(i)), 1e-11);
}

TEST(ProbeElement, StiffnessIsTheForcesSlope) {
  // At a turned rest shape, and for laws of large strain also where it is strained, against central
  // differences.
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(2, -1, 2) / 3.0).toRotationMatrix();
  const Mat3 strained = turn * Vec3(1.1, 1.05, 0.97).asDiagonal();
  Eigen::Matrix<double, 3, 4> rest;
  rest << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  const auto probe = [](const std::string& model, const Eigen::Matrix<double, 3, 4>& x) {
    Json points = Json::array();
    for (int i = 0; i < 4; ++i) points.push_back({x(0, i), x(1, i), x(2, i)});
    return probe_one("element", std::string("{") + kUnitTet + R"("model": ")" + model + R"(", "deformed": )" +
                                    points.dump() + "}");
  };
  for (const auto& [model, F] : {std::pair<std::string, Mat3>{"corotational", turn},
                                 {"neo_hookean", turn},
                                 {"hencky", turn},
                                 {"hencky", strained},
                                 {"neo_hookean", strained}}) {
    const Eigen::Matrix<double, 3, 4> x = F * rest;
    const Json K = probe(model, x)["stiffness"];
    for (std::size_t j = 0; j < 12; ++j) {
      const double d = 1e-5;
      Eigen::Matrix<double, 3, 4> step = Eigen::Matrix<double, 3, 4>::Zero();
      step(static_cast<int>(j)) = d;
      const Json plus = probe(model, x + step)["force"];
      const Json minus = probe(model, x - step)["force"];
      for (std::size_t i = 0; i < 12; ++i)
        EXPECT_NEAR(at(K, i, j), (at(plus, i / 3, i % 3) - at(minus, i / 3, i % 3)) / (2 * d), 1e-6 * 1000)
            << model << " " << i << " " << j;
    }
  }
}

void expect_refused(const std::string& kernel, const std::string& cases, std::vector<std::string> parts) {
  for (const std::string& part : parts)
    ARGIL_EXPECT_THROW_WITH(run_probe(kernel, "{\"cases\": [" + cases + "]}"), InputError, part);
}

TEST(ProbeElement, HenckyTakesNoInvertedTet) {
  const std::string hencky = std::string("{") + kUnitTet + R"("model": "hencky", "deformed": )";
  for (const char* corner : {"[0,0,-1]", "[0.3,0.3,0]"})
    expect_refused("element", hencky + "[[0,0,0], [1,0,0], [0,1,0], " + corner + "]}",
                   {"cases[0].deformed", "hencky"});
}

TEST(RunProbe, NamesCaseAndKeyOfWhatItRefuses) {
  const std::string good = R"({"r_m": 0, "k1": 2, "k2": 60, "radius_m": 0.04})";
  expect_refused("clay_kernel", good + R"(, {"r_m": 0, "k1": 2, "k2": 60})",
                 {"cases[1].radius_m", "is missing"});
  expect_refused("clay_kernel", R"({"r_m": 0, "k1": "2", "k2": 60, "radius_m": 0.04})",
                 {"cases[0].k1", "\"2\" is not a number"});
  expect_refused("clay_kernel", R"({"r_m": 0, "k1": -2, "k2": 60, "radius_m": 0.04})",
                 {"cases[0].k1", "-2", "[0, ∞) 1/m"});
  expect_refused("clay_kernel", R"({"r_m": 0, "k1": 2, "k2": 60, "radius_m": 0.04, "radius": 1})",
                 {"cases[0].radius", "is not a known key", "radius_m"});
  expect_refused("clay_kernel", "7", {"cases[0]", "7 is not an object"});
}

TEST(RunProbe, NamesRangesAndUnits) {
  expect_refused("eshelby", R"({"poissons_ratio": 0.5, "aspect": 1})",
                 {"cases[0].poissons_ratio", "0.5", "0.5)"});
  expect_refused("effective_medium", R"({"youngs_modulus_Pa": -1, "poissons_ratio": 0.3, "phi": 0.1})",
                 {"cases[0].youngs_modulus_Pa", "-1", "(0, ∞) Pa"});
  expect_refused("effective_medium",
                 R"({"youngs_modulus_Pa": 1, "poissons_ratio": 0.3, "phi": 0.1, "scheme": "mori"})",
                 {"cases[0].scheme", "\"mori\"", "mori_tanaka"});
  expect_refused("plastic_update",
                 R"({"strain": [0,0,0,0,0,0], "yield": 0.1, "creep_per_s": 1, "max": 1, "step_s": -1})",
                 {"cases[0].step_s", "-1", "[0, ∞) s"});
  expect_refused("element", R"({"rest": [[0,0,0], [1,0,0], [0,0,1], [0,1,0]],
      "deformed": [[0,0,0], [1,0,0], [0,0,1], [0,1,0]], "youngs_modulus_Pa": 1, "poissons_ratio": 0})",
                 {"cases[0].rest", "positive volume"});
}

TEST(RunProbe, RefusesLayersOfAFluidWithoutShearModulus) {
  expect_refused("effective_medium",
                 R"({"youngs_modulus_Pa": 1, "poissons_ratio": 0.3, "phi": 0.1, "aspect": 0})",
                 {"cases[0].aspect", "0 is outside (0, ∞)", "layer without shear modulus"});
  expect_refused("effective_medium", R"({"youngs_modulus_Pa": 1, "poissons_ratio": 0.3, "phi": 1.001})",
                 {"cases[0].phi", "[0, 1]"});
}

TEST(RunProbe, CountsTheNumbersOfAList) {
  expect_refused("polar", R"({"F": [[1,0],[0,1]]})", {"cases[0].F", "9 numbers"});
  expect_refused("polar", R"({"F": [[1,0,0],[0,1,0],[0,0,1,"one"]]})", {"cases[0].F", "9 numbers"});
}

TEST(RunProbe, RefusesWhatIsNoListOfCasesAndUnknownKernels) {
  ARGIL_EXPECT_THROW_WITH(run_probe("polar", "[]"), InputError, "is not {\"cases\": [...]}");
  ARGIL_EXPECT_THROW_WITH(run_probe("polar", "{\"cases\": ["), InputError, "standard input: line 1");
  ARGIL_EXPECT_THROW_WITH(run_probe("poler", "{\"cases\": []}"), InputError,
                          "choose one of effective_medium");
  EXPECT_EQ(run_probe("polar", "{\"cases\": []}"), "{\"results\":[]}\n");
}

}  // namespace
}  // namespace argil::scenario
