// Equilibria where rounding and stiffness differ by many orders within one body, and nearly incompressible
// ones by every solver.
#include "solid/committed.h"
#include "support/laws.h"
#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

constexpr double kLength = 0.5;

std::vector<int> find_end(const mesh::TetMesh& mesh, double at) {
  std::vector<int> nodes;
  for (int n = 0; n < static_cast<int>(mesh.vertices.cols()); ++n)
    if (std::abs(mesh.vertices(0, n) - at) < 1e-9) nodes.push_back(n);
  return nodes;
}

/// Bar of 6×2×2 cells, held at x = 0, whose middle node of the first section lies `gap` of a cell before the
/// next.
Scene make_bar_with_sliver(const SolidParams& params, double gap) {
  mesh::TetMesh mesh = test::make_block(6, 2, 2, Vec3(kLength, 0.1, 0.1));
  for (Eigen::Index n = 0; n < mesh.vertices.cols(); ++n)
    if ((mesh.vertices.col(n) - Vec3(kLength / 6, 0.05, 0.05)).norm() < 1e-9)
      mesh.vertices(0, n) += (1.0 - gap) * kLength / 6;
  return {mesh, {test::hold_nodes(find_end(mesh, 0.0))}, params, 1e5, 0.3};
}

double bend(Scene& scene) {
  const std::vector<int> tip = find_end(scene.mesh, kLength);
  for (const int n : tip) scene.load.col(n) = Vec3(0, 0, -0.01);
  const StepStatus status = scene.find_equilibrium();
  EXPECT_TRUE(status.is_ok()) << status.failure().quantity << ' ' << status.failure().value;
  return scene.displacement()(2, tip.front());
}

TEST(FindEquilibrium, OfABodyWithASliverIsNearlyThatWithout) {
  for (const StrainModel model : test::every_model()) {
    SolidParams params;
    params.model = model;
    Scene thick = make_bar_with_sliver(params, 1e-4);
    const double expected = bend(thick);  // tets of a ten-thousandth of a cell: already as good as none
    ASSERT_LT(expected, -1e-5);
    for (const double gap : {1e-8, 1e-10, 1e-12}) {
      Scene scene = make_bar_with_sliver(params, gap);
      EXPECT_NEAR(bend(scene), expected, 1e-3 * -expected) << gap;
    }
  }
}

TEST(FindEquilibrium, OfASoftBarBesideAStiffOneIsTheClosedForm) {
  for (const StrainModel model : test::every_model())
    for (const double ratio : {1.0, 1e6, 1e9})
      for (const double pull : {1.0, 1e-2, 1e-4}) {
        SolidParams params;
        params.model = model;
        const mesh::TetMesh mesh = test::make_block(10, 2, 2, Vec3(kLength, 0.1, 0.1));
        Support slide = test::hold_nodes(find_end(mesh, 0.0));
        Scene scene(mesh, {slide}, params, 1e5, 0.0);  // ν = 0: no strain across
        for (int t = 0; t < mesh.num_tets(); ++t) {
          double middle = 0.0;
          for (int i = 0; i < 4; ++i) middle += 0.25 * mesh.vertices(0, mesh.tets(i, t));
          set_material(scene.solid, scene.region, t,
                       test::make_material(middle < 0.5 * kLength ? 1e5 * ratio : 1e5, 0.0));
        }
        const std::vector<int> tip = find_end(mesh, kLength);
        // Consistent nodal forces of a uniform pull: a third of the area of the triangles around each node.
        for (Eigen::Index f = 0; f < scene.solid.model.elements.surface.cols(); ++f) {
          const auto face = scene.solid.model.elements.surface.col(f);
          bool is_tip = true;
          for (int k = 0; k < 3; ++k) is_tip = is_tip && std::abs(mesh.vertices(0, face(k)) - kLength) < 1e-9;
          for (int k = 0; k < 3 && is_tip; ++k) scene.load(0, face(k)) += pull * 0.5 * 0.05 * 0.05 / 3.0;
        }
        const StepStatus status = scene.find_equilibrium();
        EXPECT_TRUE(status.is_ok()) << static_cast<int>(model) << ' ' << ratio << ' ' << pull << ' '
                                    << status.failure().quantity << ' ' << status.failure().value;
        const double expected = pull / 1e5 * 0.5 * kLength * (1.0 + 1.0 / ratio);
        for (const int n : tip)
          EXPECT_NEAR(scene.displacement()(0, n), expected, 1e-4 * expected) << ratio << ' ' << pull;
      }
}

TEST(FindEquilibrium, SaysWhenPositionsHoldNoDigitOfTheDisplacement) {
  SolidParams params;
  mesh::TetMesh mesh = test::make_block(4, 2, 2, Vec3(kLength, 0.1, 0.1));
  const std::vector<int> held = find_end(mesh, 0.0);
  const std::vector<int> tip = find_end(mesh, kLength);
  mesh.vertices.colwise() += Vec3(1e3, 1e3, 1e3);
  Scene scene(mesh, {test::hold_nodes(held)}, params, 1e5, 0.3);
  for (const int n : tip) scene.load(0, n) = 1e-9;
  const StepStatus status = scene.find_equilibrium();
  ASSERT_FALSE(status.is_ok());
  EXPECT_NE(status.failure().quantity.find("rounding of positions"), std::string::npos);
}

TEST(NodalVolumes, GiveTheSameEquilibriumByEverySolver) {
  using linear::SolverKind;
  for (const double nu : {0.4999, 0.49999}) {
    const auto find = [&](SolverKind kind) {
      SolidParams params;
      params.element = ElementKind::p1_nodal;
      params.solver.kind = kind;
      params.solver.max_iterations = 20000;
      const mesh::TetMesh mesh = test::make_block(12, 3, 3, Vec3(kLength, 0.1, 0.1));
      Scene scene(mesh, {test::hold_nodes(find_end(mesh, 0.0))}, params, 1e5, nu);
      for (const int n : find_end(mesh, kLength)) scene.load.col(n) = Vec3(0, 0, -0.01);
      const StepStatus status = scene.find_equilibrium();
      EXPECT_TRUE(status.is_ok()) << status.failure().quantity << ' ' << status.failure().value;
      return scene.displacement();
    };
    const Points expected = find(SolverKind::cholesky);
    for (const SolverKind kind : {SolverKind::pcg, SolverKind::pcg_cholesky, SolverKind::supernodal})
      EXPECT_LT((find(kind) - expected).cwiseAbs().maxCoeff(), 1e-8 * expected.cwiseAbs().maxCoeff())
          << nu << ' ' << static_cast<int>(kind);
  }
}

TEST(NodalVolumes, TakeAFactorOfAllTheirStiffnessInLongSteps) {
  SolidParams params;  // the default solver
  params.element = ElementKind::p1_nodal;
  const mesh::TetMesh mesh = test::make_block(12, 3, 3, Vec3(kLength, 0.1, 0.1));
  Scene scene(mesh, {test::hold_nodes(find_end(mesh, 0.0))}, params, 1e5, 0.4999);
  for (const int n : find_end(mesh, kLength)) scene.load.col(n) = Vec3(0, 0, -0.01);
  for (int step = 0; step < 5; ++step) {
    ASSERT_TRUE(scene.step(0.1).is_ok());
    if (step == 0) continue;
    EXPECT_LT(scene.solid.history.counters.linear_iterations,
              30);  // over a factor of the tets' own part: twice as many
  }
}

class RoughEquilibrium : public testing::TestWithParam<ElementKind> {};

TEST_P(RoughEquilibrium, IsNearlyTheExactOneAndGathersOneMatrixForManyLoads) {
  SolidParams params;
  params.model = StrainModel::hencky;
  params.element = GetParam();
  params.iteration = Iteration::newton;
  const mesh::TetMesh mesh = test::make_irregular_block(6, 2, 2, Vec3(kLength, 0.1, 0.1));
  const auto make_scene = [&] {
    return Scene(mesh, {test::hold_nodes(find_end(mesh, 0.0))}, params, 1e5, 0.3);
  };
  Scene rough = make_scene();
  const SolidState at_rest = rough.state;
  const std::vector<int> tip = find_end(mesh, kLength);
  for (const double pull : {0.2, 0.25, -0.2}) {  // which also bends
    Scene exact = make_scene();
    for (const int n : tip) exact.load.col(n) = Vec3(pull, 0.0, -0.1 * pull);
    ASSERT_TRUE(exact.find_equilibrium().is_ok());
    const double largest = exact.displacement().cwiseAbs().maxCoeff();
    ASSERT_GT(largest, 0.005 * kLength);
    const bool is_first = pull == 0.2;
    rough.state = at_rest;
    ASSERT_TRUE(find_equilibrium(rough.solid, rough.region.whole(), {exact.load}, rough.state,
                                 is_first ? EquilibriumAccuracy::rough : EquilibriumAccuracy::rough_again)
                    .is_ok());
    EXPECT_LT((rough.state.x - exact.state.x).cwiseAbs().maxCoeff(), 0.01 * largest) << pull;
    EXPECT_EQ(rough.solid.history.counters.assembled_rows, is_first ? rough.solid.model.num_free() : 0);
  }
  for (const int n : tip) rough.load.col(n) = Vec3(0.5, 0.0, -0.05);
  rough.state = at_rest;
  forget(rough.solid, rough.region);
  ASSERT_TRUE(update_kinematics(rough.solid, rough.region, rough.state.x, 0).is_ok());
  ASSERT_TRUE(rough.step(1e-3).is_ok());  // with a matrix of its own
  Scene fresh = make_scene();
  fresh.load = rough.load;
  ASSERT_TRUE(fresh.step(1e-3).is_ok());
  EXPECT_LT((rough.state.v - fresh.state.v).norm(), 1e-3 * fresh.state.v.norm());
}

INSTANTIATE_TEST_SUITE_P(Elements, RoughEquilibrium,
                         testing::Values(ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2));

}  // namespace
}  // namespace argil::solid
