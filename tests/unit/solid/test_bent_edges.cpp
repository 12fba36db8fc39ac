// Ten-node tets whose edges bend: what affine motions, masses and pressures owe to the body's true shape.
#include <Eigen/Cholesky>

#include <numbers>
#include <set>

#include "mesh/curved.h"
#include "shapes/shapes.h"
#include "solid/loads.h"
#include "support/laws.h"
#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

constexpr double kE = 2e5;
constexpr double kNu = 0.37;

mesh::TetMesh make_bent(shapes::ShapeKind kind, int num_tets) {
  const shapes::Shape shape{kind, 0.06};
  mesh::TetMesh mesh = shapes::make_shape_mesh(shape, num_tets);
  mesh::curve_boundary(shapes::make_boundary_point(shape), mesh::make_topology(mesh), mesh);
  EXPECT_GT(mesh.edge_nodes.size(), 50U);
  return mesh;
}

SolidParams make_params(StrainModel model) {
  SolidParams params;
  params.model = model;
  params.element = ElementKind::p2;
  params.newton_tolerance = 1e-13;
  params.solver.kind = linear::SolverKind::cholesky;
  return params;
}

Mat3 make_gradient() {
  Mat3 F;
  F << 1.06, 0.05, -0.02, 0.01, 0.93, 0.04, 0.03, -0.02, 1.05;
  return F;
}

class BentEdges : public testing::TestWithParam<StrainModel> {};

TEST_P(BentEdges, GiveAnAffineMotionItsGradientEverywhere) {
  const Scene scene(make_bent(shapes::ShapeKind::sphere, 340), {0}, make_params(GetParam()), kE, kNu);
  const Elements& e = scene.solid.model.elements;
  const Points x = make_gradient() * e.rest;
  for (int p = 0; p < e.num_points(); ++p)
    EXPECT_LT((find_gradient<10>(e, e.gradient, x, p) - make_gradient()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_P(BentEdges, FeelNoRigidTurn) {
  if (find_law(GetParam()).is_linear) GTEST_SKIP() << "the linear model feels turns";
  Scene scene(make_bent(shapes::ShapeKind::sphere, 340), std::vector<Support>{}, make_params(GetParam()), kE,
              kNu);
  const Mat3 Q = Eigen::AngleAxisd(2.0, Vec3(1, -2, 2) / 3.0).toRotationMatrix();
  const Points f = scene.compute_force((Q * scene.rest()).colwise() + Vec3(0.1, 0.2, 0.3));
  EXPECT_LT(f.cwiseAbs().maxCoeff(), 1e-12 * kE * 0.06 * 0.06);
}

/// Of a body whose boundary moves by F: how far what is inside goes astray, over the body's size.
double find_patch_error(mesh::TetMesh mesh, StrainModel model) {
  const SolidParams params = make_params(model);
  const Elements e = make_elements(mesh, mesh::make_topology(mesh), params.element);
  const Mat3 F = make_gradient();
  std::vector<Support> supports;
  const std::vector<int> nodes(e.surface.reshaped().begin(), e.surface.reshaped().end());
  for (const int node : std::set<int>(nodes.begin(), nodes.end())) {
    supports.push_back(test::hold_nodes({node}));
    supports.back().displacement = (F - Mat3::Identity()) * e.rest.col(node);
  }
  Scene scene(std::move(mesh), std::move(supports), params, kE, kNu);
  EXPECT_TRUE(scene.find_equilibrium().is_ok());
  return (scene.state.x - F * e.rest).cwiseAbs().maxCoeff() / 0.06;
}

TEST_P(BentEdges, OfACylinderPassThePatchTest) {
  // All bends of one tet there go the same way, so that four points are exact.
  EXPECT_LT(find_patch_error(make_bent(shapes::ShapeKind::cylinder, 400), GetParam()), 1e-11);
}

std::string name_model(const testing::TestParamInfo<StrainModel>& info) {
  return find_law(info.param).name;
}

INSTANTIATE_TEST_SUITE_P(Every, BentEdges, testing::ValuesIn(test::every_model()), name_model);

TEST(BentBall, MissesThePatchTestByBendsThatCross) {
  // (h/R)²/8 is a bend over an edge, h/R the angle between two: what the points miss falls as h³.
  const double coarse = find_patch_error(make_bent(shapes::ShapeKind::sphere, 300), StrainModel::linear);
  const double fine = find_patch_error(make_bent(shapes::ShapeKind::sphere, 2400), StrainModel::linear);
  EXPECT_LT(coarse, 1e-4);  // of motions of 0.07
  EXPECT_GT(coarse / fine, 5.0);
}

TEST(BentBall, WeighsWhatItsVolumeDoes) {
  const mesh::TetMesh mesh = make_bent(shapes::ShapeKind::sphere, 340);
  const Elements e = make_elements(mesh, mesh::make_topology(mesh), ElementKind::p2);
  const double volume = mesh::compute_rest_volumes(mesh).sum();
  EXPECT_NEAR(e.weight.sum(), volume, 1e-15 * volume * 100);
  EXPECT_NEAR(e.node_volume.sum(), volume, 1e-15 * volume * 100);
  EXPECT_NEAR(e.shape_volume.sum(), volume, 1e-15 * volume * 100);
  EXPECT_GT(e.node_volume.minCoeff(), 0.0);
  // The middle of what its weight acts on is the ball's.
  const Vec3 middle = e.rest * e.shape_volume / volume;
  EXPECT_LT((middle - Vec3(0.0, 0.0, 0.03)).norm(), 1e-5);

  Scene scene(mesh, {0}, make_params(StrainModel::corotational), kE, kNu);
  const double density = scene.params.density;
  for (int t = 0; t < mesh.num_tets(); ++t)
    set_water_mass(scene.solid, t, 0.3 * density * e.weight.segment<4>(4 * t).sum());
  EXPECT_NEAR(scene.solid.materials.mass().sum(), 1.3 * density * volume, 1e-12 * density * volume);
}

TEST(BentBall, IsPressedFromAllSidesByItsVolume) {
  // Σ f ⊗ X = −p ∫ n ⊗ X dA = −p V 1, whatever the shape; and all forces together are none.
  const mesh::TetMesh mesh = make_bent(shapes::ShapeKind::sphere, 340);
  const mesh::Topology topology = mesh::make_topology(mesh);
  const Elements e = make_elements(mesh, topology, ElementKind::p2);
  PressureLoad pressure;
  pressure.region.lower = Vec3::Constant(-1.0);
  pressure.region.upper = Vec3::Constant(1.0);
  pressure.pressure = 300.0;
  Loads loads;
  loads.pressure.push_back(pressure);
  const Points force = compute_load_force(e, topology.boundary, loads);
  const double work = 300.0 * mesh::compute_rest_volumes(mesh).sum();
  EXPECT_LT(force.rowwise().sum().norm(), 1e-12 * work / 0.06);
  EXPECT_LT((force * e.rest.transpose() + work * Mat3::Identity()).norm(), 1e-12 * work);
}

}  // namespace
}  // namespace argil::solid
