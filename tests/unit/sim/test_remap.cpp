// Clay that gets other cells keeps what it is: of uniform strain and linear speed to rounding, of water to
// the last gram, of supports the same face. Expected strains are ½ ln AAᵀ of the deformation A that was
// applied.
#include "sim/remap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/mandel.h"
#include "base/rng.h"
#include "mesh/quadratic.h"
#include "support/solid_scene.h"

namespace argil::sim {
namespace {

constexpr double kRounding = 1e-11;
const Vec3 kSize(0.04, 0.03, 0.02);

solid::SolidParams make_hencky(solid::ElementKind element) {
  solid::SolidParams params;
  params.model = solid::StrainModel::hencky;
  params.element = element;
  return params;
}

struct Change : ::testing::TestWithParam<solid::ElementKind> {
  test::Scene scene{test::make_irregular_block(4, 3, 2, kSize),
                    {test::hold_nodes(find_bottom(test::make_irregular_block(4, 3, 2, kSize)))},
                    make_hencky(GetParam()),
                    1e5,
                    0.3};
  Body from, to;
  Mat3 A = Mat3::Identity();
  TensorField flow = TensorField::Zero(6, scene.mesh.num_tets());

  static std::vector<int> find_bottom(const mesh::TetMesh& mesh) {
    std::vector<int> bottom;
    for (int v = 0; v < mesh.num_vertices(); ++v)
      if (mesh.vertices(2, v) < 1e-9) bottom.push_back(v);
    return bottom;
  }

  void deform(const Mat3& by) {
    A = by;
    from.mesh = scene.mesh;
    from.supports = {test::hold_nodes(find_bottom(scene.mesh))};
    scene.state.x = A * scene.rest();
    scene.solid.plastic_strain = &scene.state.plastic_strain;
    ASSERT_TRUE(solid::update_kinematics(scene.solid, scene.region, scene.state.x, 0).is_ok());
    to.mesh = test::make_irregular_block(5, 4, 3, kSize, 0.15);
    to.mesh.vertices = A * to.mesh.vertices;
    to.topology = mesh::make_topology(to.mesh);
  }
  RemappedState remap(const Field& saturation) {
    return sim::remap(from, scene.solid, scene.state.x, saturation, flow, to);
  }
  Points new_nodes() const {
    return GetParam() == solid::ElementKind::p2 ? mesh::make_quadratic_mesh(to.mesh, to.topology).nodes
                                                : to.mesh.vertices;
  }
  Field dry() const { return Field::Zero(from.mesh.num_tets()); }
};

TEST_P(Change, OfCellsKeepsAUniformStrain) {
  deform((Mat3() << 1.2, 0.3, 0, -0.1, 0.9, 0.2, 0.05, 0, 1.1).finished());
  const Eigen::SelfAdjointEigenSolver<Mat3> modes(A * A.transpose());
  const Mat3 strain = modes.eigenvectors() * Vec3(0.5 * modes.eigenvalues().array().log()).asDiagonal() *
                      modes.eigenvectors().transpose();
  const RemappedState state = remap(dry());
  ASSERT_EQ(state.elastic.cols(), scene.solid.model.elements.points_per_tet * to.mesh.num_tets());
  EXPECT_LT((state.elastic.colwise() - to_mandel(strain)).cwiseAbs().maxCoeff(), kRounding);
}

TEST_P(Change, OfCellsKnowsFlowFromStrain) {
  const Vec3 stretch(0.5, -0.2, -0.3);  // without change of volume
  scene.state.plastic_strain.colwise() = to_mandel(Mat3(stretch.asDiagonal()));
  deform(Vec3(stretch.array().exp()).asDiagonal());
  EXPECT_LT(remap(dry()).elastic.cwiseAbs().maxCoeff(), kRounding);
}

TEST_P(Change, OfCellsTurnsTheFlowWithTheClay) {
  flow.colwise() = to_mandel(Mat3(Vec3(0.5, -0.2, -0.3).asDiagonal()));
  deform((Mat3() << 0, -1.1, 0, 0.9, 0, 0, 0, 0, 1).finished());  // stretched, then a quarter turn about z
  const RemappedState state = remap(dry());
  ASSERT_EQ(state.flow.cols(), to.mesh.num_tets());
  const Vec6 turned = to_mandel(Mat3(Vec3(-0.2, 0.5, -0.3).asDiagonal()));
  EXPECT_LT((state.flow.colwise() - turned).cwiseAbs().maxCoeff(), kRounding);
}

TEST_P(Change, OfCellsKeepsALinearSpeed) {
  deform(Mat3::Identity());
  const Mat3 rate = (Mat3() << 1, 2, 0, -1, 0.5, 3, 0, 1, -2).finished();
  scene.solid.committed.v = rate * scene.state.x;
  const RemappedState state = remap(dry());
  EXPECT_LT((state.v - rate * new_nodes()).cwiseAbs().maxCoeff(), kRounding);
}

TEST_P(Change, OfCellsForThemselvesKeepsEachPoint) {
  Rng rng(7);
  Field size(scene.state.plastic_strain.cols());
  for (double& e : size) e = rng.uniform(-0.1, 0.1);
  const Vec6 shape = to_mandel(Mat3(Vec3(1.0, -0.4, -0.6).asDiagonal()));
  scene.state.plastic_strain = -shape * size.transpose();
  deform(Mat3::Identity());
  to.mesh = from.mesh;
  to.topology = mesh::make_topology(to.mesh);
  EXPECT_LT((remap(dry()).elastic + scene.state.plastic_strain).cwiseAbs().maxCoeff(), kRounding);
}

TEST_P(Change, OfTenNodeCellsKeepsAQuadraticSpeed) {
  if (GetParam() != solid::ElementKind::p2) GTEST_SKIP() << "four nodes carry a linear speed";
  deform(Mat3::Identity());
  const auto find_speed = [](const Points& x) -> Points {
    Points v(3, x.cols());
    for (Eigen::Index n = 0; n < x.cols(); ++n)
      v.col(n) = Vec3(x(0, n) * x(1, n), x(2, n) * x(2, n) - x(0, n), x(1, n) * (1.0 + x(2, n)));
    return v;
  };
  scene.solid.committed.v = find_speed(scene.state.x);
  EXPECT_LT((remap(dry()).v - find_speed(new_nodes())).cwiseAbs().maxCoeff(), kRounding);
}

TEST_P(Change, OfCellsKeepsTheWater) {
  deform(Vec3(1.1, 0.9, 1.0).asDiagonal());
  Rng rng(3);
  Field saturation(from.mesh.num_tets());
  for (double& S : saturation) S = rng.uniform(0.0, 1.0);
  const double before = mesh::compute_volumes(from.mesh.vertices, from.mesh.tets).dot(saturation);
  remap(saturation);
  const double after = mesh::compute_volumes(to.mesh.vertices, to.mesh.tets).dot(to.initial_saturation);
  EXPECT_NEAR(after, before, 1e-14 * before);
  EXPECT_GE(to.initial_saturation.minCoeff(), 0.0);
  EXPECT_LE(to.initial_saturation.maxCoeff(), 1.0);
}

TEST_P(Change, OfCellsKeepsTheWaterOfTetsThatAreNearlyFull) {
  deform(Vec3(0.99, 0.99, 1.0).asDiagonal());  // less room than before
  Field saturation = Field::Constant(from.mesh.num_tets(), 1.0);
  saturation.head(10).setConstant(0.2);
  const double before = mesh::compute_volumes(from.mesh.vertices, from.mesh.tets).dot(saturation);
  remap(saturation);
  const double after = mesh::compute_volumes(to.mesh.vertices, to.mesh.tets).dot(to.initial_saturation);
  EXPECT_NEAR(after, before, 1e-14 * before);
  EXPECT_LE(to.initial_saturation.maxCoeff(), 1.0);
}

TEST_P(Change, OfCellsHoldsSomethingWhereOneVertexIsHeld) {
  deform(Mat3::Identity());
  test::Scene held(test::make_irregular_block(4, 3, 2, kSize), {0}, make_hencky(GetParam()), 1e5, 0.3);
  held.solid.plastic_strain = &held.state.plastic_strain;
  from.supports = {test::hold_nodes({0})};
  sim::remap(from, held.solid, held.state.x, dry(), flow, to);
  EXPECT_EQ(to.supports[0].region.nodes.size(), 1U);
}

TEST_P(Change, OfCellsHoldsTheSameFace) {
  deform(Mat3::Identity());
  remap(dry());
  ASSERT_EQ(to.supports.size(), 1U);
  EXPECT_EQ(to.supports[0].region.nodes, find_bottom(to.mesh));
}

INSTANTIATE_TEST_SUITE_P(Elements, Change, ::testing::Values(solid::ElementKind::p1, solid::ElementKind::p2),
                         [](const auto& element) {
                           return element.param == solid::ElementKind::p1 ? "FourNodes" : "TenNodes";
                         });

}  // namespace
}  // namespace argil::sim
