// The matrix is updated where something changed and nowhere else, and is then what a new one would be.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "solid/tet_lanes.h"
#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

constexpr double kStep = 1e-3;
constexpr int kWet = 17, kSwollen = 60, kHeavy = 101;

Scene make_scene(StrainModel model) {
  SolidParams params;
  params.model = model;
  params.solver.kind = linear::SolverKind::cholesky;  // the matrix's bits decide the solution's
  Scene scene(test::make_irregular_block(4, 4, 3, Vec3(0.1, 0.1, 0.08)), {0, 1, 2, 3, 4}, params, 2e5, 0.3);
  scene.load.col(scene.num_nodes() - 1) = Vec3(0.3, -0.2, 0.4);
  return scene;
}

void change_three_tets(Scene& scene) {
  set_material(scene.solid, scene.region, kWet, test::make_material(3e4, 0.4));
  set_swelling(scene.solid, kSwollen, 1.1);
  set_water_mass(scene.solid, kHeavy, 1e-3);
  ASSERT_TRUE(update_kinematics(scene.solid, scene.region, scene.state.x, 0).is_ok());
}

std::vector<PointStiffness> make_contact(const Scene& scene) {
  const mesh::Topology topology = mesh::make_topology(scene.mesh);
  PointStiffness contact;
  for (std::size_t i = 0; i < 3; ++i) {
    contact.vertex[i] = topology.boundary(static_cast<int>(i), 7);
    contact.weight[i] = 1.0 / 3.0;
  }
  contact.normal = Vec3::UnitZ();
  contact.stiffness = 500.0;
  return {contact};
}

class MatrixUpdate : public testing::TestWithParam<StrainModel> {};

TEST_P(MatrixUpdate, LeavesTheMatrixThatANewBodyWouldHave) {
  Scene scene = make_scene(GetParam());
  ASSERT_TRUE(scene.step(kStep, make_contact(scene)).is_ok());
  ASSERT_TRUE(scene.step(kStep).is_ok());
  change_three_tets(scene);

  Scene fresh = make_scene(GetParam());
  fresh.state = scene.state;
  change_three_tets(fresh);

  ASSERT_TRUE(scene.solve(kStep).is_ok());
  ASSERT_TRUE(fresh.solve(kStep).is_ok());
  EXPECT_EQ(fresh.solid.history.counters.assembled_rows, fresh.solid.model.num_free());
  EXPECT_EQ((scene.state.v - fresh.state.v).cwiseAbs().maxCoeff(), 0.0);
}

/// Tets around one edge, whose ends have more neighbours than a row that is gathered in one piece.
mesh::TetMesh make_fan() {
  constexpr int kAround = kLongestRow + 20;
  mesh::TetMesh fan;
  fan.vertices.resize(3, kAround + 2);
  fan.vertices.col(0) = Vec3(0.0, 0.0, -0.05);
  fan.vertices.col(1) = Vec3(0.0, 0.0, 0.05);
  fan.tets.resize(4, kAround);
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2.0 * M_PI * i / kAround;
    fan.vertices.col(2 + i) =
        Vec3(0.06 * std::cos(angle), 0.05 * std::sin(angle), 0.01 * std::cos(3.0 * angle));
    fan.tets.col(i) << 0, 2 + i, 2 + (i + 1) % kAround, 1;
  }
  return fan;
}

TEST_P(MatrixUpdate, GathersRowsOfAnyLength) {
  SolidParams params;
  params.model = GetParam();
  params.solver.tolerance = 1e-12;
  Points moved[2];
  for (const bool is_stored : {false, true}) {
    params.solver.kind = is_stored ? linear::SolverKind::cholesky : linear::SolverKind::pcg_matrix_free;
    Scene scene(make_fan(), {2, 3, 40, 41, 80}, params, 2e5, 0.3);
    scene.load.col(1) = Vec3(0.3, -0.2, -2.0);
    for (int k = 0; k < 5; ++k) ASSERT_TRUE(scene.step(kStep).is_ok());
    moved[is_stored] = scene.displacement();
  }
  ASSERT_GT(moved[0].norm(), 1e-5);
  EXPECT_LT((moved[1] - moved[0]).norm(), 1e-9 * moved[0].norm());
}

INSTANTIATE_TEST_SUITE_P(Every, MatrixUpdate,
                         testing::Values(StrainModel::linear, StrainModel::corotational, StrainModel::hencky),
                         [](const auto& instance) { return find_law(instance.param).name; });

TEST(MatrixUpdate, GathersTheRowsAroundChangedTetsAlone) {
  Scene scene = make_scene(StrainModel::linear);
  ASSERT_TRUE(scene.step(kStep).is_ok());
  ASSERT_TRUE(scene.step(kStep).is_ok());
  EXPECT_EQ(scene.solid.history.counters.assembled_rows, 0);
  change_three_tets(scene);
  std::set<int> rows;
  for (const int tet : {kWet, kSwollen, kHeavy})
    for (const int node : scene.mesh.tets.col(tet))
      if (!scene.solid.model.constraints.is_held(node)) rows.insert(node);
  ASSERT_TRUE(scene.step(kStep).is_ok());
  EXPECT_EQ(scene.solid.history.counters.assembled_rows, static_cast<int>(rows.size()));
}

TEST(MatrixUpdate, GathersAllRowsForAnotherStep) {
  Scene scene = make_scene(StrainModel::linear);
  ASSERT_TRUE(scene.step(kStep).is_ok());
  ASSERT_TRUE(scene.step(2.0 * kStep).is_ok());
  EXPECT_EQ(scene.solid.history.counters.assembled_rows, scene.solid.model.num_free());
}

TEST(Matrix, IsTakenAnewByASolverInFloatsWhereModuliChange) {
  const auto move = [](linear::SolverKind kind) {
    SolidParams params;
    params.solver.kind = kind;
    test::Scene scene(test::make_block(3, 2, 2, Vec3(0.3, 0.2, 0.2)), {0, 1, 2}, params, 1e5, 0.3);
    scene.load.col(20) = Vec3(1, 2, 3);
    EXPECT_TRUE(scene.step(0.05).is_ok());
    for (int t = 0; t < scene.mesh.num_tets(); ++t)
      set_material(scene.solid, scene.region, t, test::make_material(1e3, 0.3));
    EXPECT_TRUE(scene.step(0.05).is_ok());
    return scene.displacement();
  };
  const Points expected = move(linear::SolverKind::cholesky);
  EXPECT_LT((move(linear::SolverKind::pcg) - expected).norm(), 0.01 * expected.norm());  // solved to 1e-3
}

}  // namespace
}  // namespace argil::solid
