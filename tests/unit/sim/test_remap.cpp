// Clay that gets other cells keeps what it is: of uniform strain and linear speed to rounding, of water to
// the last gram, of supports the same face. Expected strains are ½ ln AAᵀ of the deformation A that was
// applied.
#include "sim/remap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/mandel.h"
#include "base/rng.h"
#include "support/solid_scene.h"

namespace argil::sim {
namespace {

constexpr double kRounding = 1e-11;
const Vec3 kSize(0.04, 0.03, 0.02);

solid::SolidParams make_hencky() {
  solid::SolidParams params;
  params.model = solid::StrainModel::hencky;
  return params;
}

struct Change : ::testing::Test {
  test::Scene scene{test::make_irregular_block(4, 3, 2, kSize),
                    {test::hold_nodes(find_bottom(test::make_irregular_block(4, 3, 2, kSize)))},
                    make_hencky(),
                    1e5,
                    0.3};
  Body from, to;
  Mat3 A = Mat3::Identity();

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
    return sim::remap(from, scene.solid, scene.state.x, saturation, to);
  }
  Field dry() const { return Field::Zero(from.mesh.num_tets()); }
};

TEST_F(Change, OfCellsKeepsAUniformStrain) {
  deform((Mat3() << 1.2, 0.3, 0, -0.1, 0.9, 0.2, 0.05, 0, 1.1).finished());
  const Eigen::SelfAdjointEigenSolver<Mat3> modes(A * A.transpose());
  const Mat3 strain = modes.eigenvectors() * Vec3(0.5 * modes.eigenvalues().array().log()).asDiagonal() *
                      modes.eigenvectors().transpose();
  const RemappedState state = remap(dry());
  ASSERT_EQ(state.elastic.cols(), to.mesh.num_tets());
  EXPECT_LT((state.elastic.colwise() - to_mandel(strain)).cwiseAbs().maxCoeff(), kRounding);
}

TEST_F(Change, OfCellsKnowsFlowFromStrain) {
  const Vec3 stretch(0.5, -0.2, -0.3);  // without change of volume
  scene.state.plastic_strain.colwise() = to_mandel(Mat3(stretch.asDiagonal()));
  deform(Vec3(stretch.array().exp()).asDiagonal());
  EXPECT_LT(remap(dry()).elastic.cwiseAbs().maxCoeff(), kRounding);
}

TEST_F(Change, OfCellsKeepsALinearSpeed) {
  deform(Mat3::Identity());
  const Mat3 rate = (Mat3() << 1, 2, 0, -1, 0.5, 3, 0, 1, -2).finished();
  scene.solid.committed.v = rate * scene.state.x;
  const RemappedState state = remap(dry());
  EXPECT_LT((state.v - rate * to.mesh.vertices).cwiseAbs().maxCoeff(), kRounding);
}

TEST_F(Change, OfCellsKeepsTheWater) {
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

TEST_F(Change, OfCellsKeepsTheWaterOfTetsThatAreNearlyFull) {
  deform(Vec3(0.99, 0.99, 1.0).asDiagonal());  // less room than before
  Field saturation = Field::Constant(from.mesh.num_tets(), 1.0);
  saturation.head(10).setConstant(0.2);
  const double before = mesh::compute_volumes(from.mesh.vertices, from.mesh.tets).dot(saturation);
  remap(saturation);
  const double after = mesh::compute_volumes(to.mesh.vertices, to.mesh.tets).dot(to.initial_saturation);
  EXPECT_NEAR(after, before, 1e-14 * before);
  EXPECT_LE(to.initial_saturation.maxCoeff(), 1.0);
}

TEST_F(Change, OfCellsHoldsSomethingWhereOneVertexIsHeld) {
  deform(Mat3::Identity());
  test::Scene held(test::make_irregular_block(4, 3, 2, kSize), {0}, make_hencky(), 1e5, 0.3);
  held.solid.plastic_strain = &held.state.plastic_strain;
  from.supports = {test::hold_nodes({0})};
  sim::remap(from, held.solid, held.state.x, dry(), to);
  EXPECT_EQ(to.supports[0].region.nodes.size(), 1U);
}

TEST_F(Change, OfCellsHoldsTheSameFace) {
  deform(Mat3::Identity());
  remap(dry());
  ASSERT_EQ(to.supports.size(), 1U);
  EXPECT_EQ(to.supports[0].region.nodes, find_bottom(to.mesh));
}

}  // namespace
}  // namespace argil::sim
