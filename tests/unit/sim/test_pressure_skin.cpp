// By the pressure law the force is that of the body, whatever the number of triangles of its skin.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/box_skin.h"
#include "unit/sim/pressure_scene.h"

namespace argil::sim {
namespace {

using device::ToolMode;
using test::lead;
using test::press_block;

constexpr double kDepth = 2e-3;  // [m]

/// Block of cells 3.3 mm across in a skin of so many squares along its longer edges, which is its boundary.
Simulation make_skinned_block(const Params& params, int squares, ToolMode mode) {
  const Vec3 size(0.04, 0.04, test::kBlockHeight);
  Body body = argil::test::make_block_body(12, 12, 6, size);
  body.skin = argil::test::make_box_skin(squares, Vec3::Zero(), size);
  body.skin_embedding = embed::make_embedding(body.mesh, body.skin.vertices, "skin");
  return {std::move(body), contact::make_sphere_tool(test::kBallRadius, 2), params,
          press_block(-1e-3, 0.0, mode)};
}

Params make_params() {
  Params params = test::make_pressure_params();
  params.contact_surface = SurfaceKind::skin;
  params.solid.solver.kind = linear::SolverKind::cholesky;
  return params;
}

/// The force of a ball that has come to rest in the body.
double press(int squares, ToolMode mode) {
  Simulation simulation = make_skinned_block(make_params(), squares, mode);
  lead(simulation, press_block(kDepth, 0.0, mode), 6);
  return lead(simulation, press_block(kDepth, 0.0, mode), mode == ToolMode::push ? 20 : 2).back().z();
}

class PressedSkin : public testing::TestWithParam<ToolMode> {};

/// From 180 triangles, each more than two cells across, to 32 768. Unsplit, the first three press 41, 9 and 2
/// % harder than the last.
TEST_P(PressedSkin, HasAForceThatDoesNotHangOnItsTriangles) {
  std::vector<double> forces;
  for (const int squares : {5, 8, 16, 64}) forces.push_back(press(squares, GetParam()));
  ASSERT_GT(forces.back(), 0.1);
  for (const double force : forces) EXPECT_NEAR(force / forces.back(), 1.0, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Modes, PressedSkin, testing::Values(ToolMode::push, ToolMode::wet));

TEST(PressedSkin, IsWrittenAsItCame) {
  Simulation simulation = make_skinned_block(make_params(), 4, ToolMode::push);
  EXPECT_GT(simulation.body_side().surface().triangles().cols(), 4 * 128);
  const Frame frame = simulation.make_frame();
  EXPECT_EQ(simulation.body().skin.triangles.cols(), 128);
  ASSERT_EQ(frame.skin_position.cols(), simulation.body().skin.vertices.cols());
  EXPECT_LT((frame.skin_position - simulation.body().skin.vertices).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(frame.skin_saturation.size(), frame.skin_position.cols());
}

/// A ball in the middle of a large triangle wets the tets that it touches, and not those under the corners.
TEST(PressedSkin, TakesUpWaterWhereItIsTouched) {
  Simulation simulation = make_skinned_block(make_params(), 1, ToolMode::wet);
  lead(simulation, press_block(kDepth, 0.0, ToolMode::wet), 10);
  const Field& saturation = simulation.pore_water().saturation();
  ASSERT_GT(saturation.maxCoeff(), 0.0);
  const mesh::TetMesh& mesh = simulation.body().mesh;
  for (int t = 0; t < mesh.num_tets(); ++t) {
    if (!(saturation(t) > 0.0)) continue;
    Vec3 middle = Vec3::Zero();
    for (int k = 0; k < 4; ++k) middle += 0.25 * mesh.vertices.col(mesh.tets(k, t));
    EXPECT_LT((middle - press_block(0.0).position).head<2>().norm(), 0.01) << t;
  }
}

}  // namespace
}  // namespace argil::sim
