// Ten-node tets whose edges bend with the surface, from a scenario to a run: where they do, what lies on
// them, what a press is worth, and that a run is taken up again with them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "embed/embedding.h"
#include "embed/skin_shape.h"
#include "mesh/curved.h"
#include "scenario/build.h"
#include "shapes/shapes.h"
#include "solid/elements.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

class BentEdges : public testing::Test {
 protected:
  test::TempFolder folder;

  /// A ball of clay of 40 mm, pressed from above by one of 6 mm; with `skin`, fitted to one.
  scenario::Scene build(std::vector<std::string> settings) {
    const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0455, 0.02, "push");
    settings.insert(settings.begin(), "/dynamics/element=p2");
    std::vector<scenario::Setting> list;
    for (const std::string& setting : settings) list.push_back(scenario::parse_setting(setting));
    return scenario::build_scene(
        scenario::load_scenario(folder.write("scenario.json", test::make_ball_scenario(trace)), list));
  }
};

const std::string* find_note(const scenario::Scene& scene, const std::string& words) {
  for (const std::string& note : scene.notes)
    if (note.find(words) != std::string::npos) return &note;
  return nullptr;
}

double find_volume(const sim::Body& body) {
  return mesh::compute_rest_volumes(body.mesh).sum();
}

const double kBall = std::numbers::pi / 6.0 * std::pow(0.04, 3);

TEST_F(BentEdges, AreThoseOfTenNodeTetsOnRoundShapes) {
  const scenario::Scene ball = build({});
  EXPECT_NEAR(find_volume(ball.body), kBall, 1e-3 * kBall);
  ASSERT_NE(find_note(ball, "edges bend with the surface"), nullptr);
  EXPECT_EQ(find_note(ball, "stay straight"), nullptr);
  EXPECT_TRUE(build({"/dynamics/element=p1"}).body.mesh.edge_nodes.empty());
  EXPECT_TRUE(build({"/body/shape/kind=box"}).body.mesh.edge_nodes.empty());
  const scenario::Scene figure = build({"/body/shape/kind=figure", "/body/shape/target_tets=2500"});
  EXPECT_GT(figure.body.mesh.edge_nodes.size(), 500U);
}

TEST_F(BentEdges, OfGradedCellsGoOn) {
  const scenario::Scene graded = build({"/body/cells/kind=graded", "/body/cells/near_tool_m=0.001"});
  EXPECT_GT(graded.body.mesh.num_tets(), 1000);
  EXPECT_NEAR(find_volume(graded.body), kBall, 1e-3 * kBall);
  const solid::Elements elements =
      solid::make_elements(graded.body.mesh, graded.body.topology, solid::ElementKind::p2);
  for (const int node : elements.surface.reshaped())
    EXPECT_NEAR((elements.rest.col(node) - Vec3(0.0, 0.0, 0.02)).norm(), 0.02, 1e-6);
}

TEST_F(BentEdges, OfAFittedBodyLieOnItsSkinAndCarryItWhereItWas) {
  const scenario::Scene scene =
      build({"/body/shape/skin_triangles=6000", "/body/shape/fit=surface", "/contact/surface=skin"});
  const sim::Body& body = scene.body;
  ASSERT_NE(find_note(scene, "edges bend with the surface"), nullptr);
  const double skin = embed::compute_skin_volume(body.skin);
  EXPECT_NEAR(find_volume(body), skin, 2e-3 * skin);
  const solid::Elements elements = solid::make_elements(body.mesh, body.topology, solid::ElementKind::p2);
  for (const int node : elements.surface.reshaped())
    EXPECT_NEAR((elements.rest.col(node) - Vec3(0.0, 0.0, 0.02)).norm(), 0.02, 5e-5);
  Points carried;
  embed::interpolate_positions(body.skin_embedding, elements.nodes, elements.rest, carried);
  EXPECT_LT((carried - body.skin.vertices).cwiseAbs().maxCoeff(), 1e-14);
}

TEST_F(BentEdges, EnclosingCagesHaveNone) {
  EXPECT_TRUE(build({"/body/shape/skin_triangles=6000"}).body.mesh.edge_nodes.empty());
}

}  // namespace
}  // namespace argil
