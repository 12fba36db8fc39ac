// Regions of nodes, and whether supports hold a body: decided by parts that move as one, checked against the
// rank of the body's own stiffness.
#include "solid/rigid_motion.h"

#include <Eigen/Eigenvalues>

#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

TEST(FindNodes, CollectsEveryRegionOnceInOrder) {
  const mesh::TetMesh mesh = test::make_block(2, 2, 2, Vec3(1, 1, 1));
  Region bottom;
  bottom.kind = Region::Kind::half_space;
  bottom.offset = 1e-9;
  Region corner;
  corner.kind = Region::Kind::sphere;
  corner.radius = 0.1;
  Region one;
  one.kind = Region::Kind::nodes;
  one.nodes = {26, 3};
  const std::vector<Region> regions = {one, bottom, corner};
  EXPECT_EQ(find_nodes(mesh.vertices, regions), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 26}));
}

TEST(FindConstraints, HoldsTheSameByNumberAsByPlace) {
  // The bottom of a block: 9 vertices, and of ten-node tets the middles of its 16 edges.
  const mesh::TetMesh mesh = test::make_block(2, 2, 2, Vec3(1, 1, 1));
  const mesh::Topology topology = mesh::make_topology(mesh);
  Support by_place;
  by_place.region.kind = Region::Kind::plane;
  Support by_number;
  by_number.region.kind = Region::Kind::nodes;
  by_number.region.nodes = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  for (const auto& [kind, count] : {std::pair(ElementKind::p1, 9), std::pair(ElementKind::p2, 25)}) {
    const Elements elements = make_elements(mesh, topology, kind);
    const Constraints number = find_constraints(elements, {&by_number, 1});
    EXPECT_EQ(number.support, find_constraints(elements, {&by_place, 1}).support);
    EXPECT_EQ((number.support.array() >= 0).count(), 3 * count);
  }
}

TEST(FindNodes, TakesTheDirectionOfANormalAndNotItsLength) {
  // The diagonal plane through the middle of a unit cube lies √3/2 from its corner.
  const mesh::TetMesh mesh = test::make_block(2, 2, 2, Vec3(1, 1, 1));
  for (const double length : {0.01, 1.0, 250.0}) {
    Region region;
    region.normal = length * Vec3(1, 1, 1);
    region.offset = 0.5 * std::sqrt(3.0) + 1e-9;
    region.thickness = 1e-6;
    region.kind = Region::Kind::half_space;
    EXPECT_EQ(find_nodes(mesh.vertices, std::span(&region, 1)).size(), 17U) << length;
    region.kind = Region::Kind::plane;
    EXPECT_EQ(find_nodes(mesh.vertices, std::span(&region, 1)).size(), 7U) << length;
  }
}

/// Adds a unit cube with its lowest corner at `corner`; vertices in equal places are shared.
void add_cube(const Vec3& corner, mesh::TetMesh& mesh) {
  const mesh::TetMesh cube = test::make_block(1, 1, 1, Vec3(1, 1, 1));
  std::vector<int> number;
  for (Eigen::Index v = 0; v < cube.vertices.cols(); ++v) {
    const Vec3 x = cube.vertices.col(v) + corner;
    int found = 0;
    while (found < mesh.num_vertices() && (mesh.vertices.col(found) - x).norm() > 1e-9) ++found;
    if (found == mesh.num_vertices()) {
      mesh.vertices.conservativeResize(3, found + 1);
      mesh.vertices.col(found) = x;
    }
    number.push_back(found);
  }
  const Eigen::Index first = mesh.tets.cols();
  mesh.tets.conservativeResize(4, first + cube.tets.cols());
  for (Eigen::Index t = 0; t < cube.tets.cols(); ++t)
    for (int k = 0; k < 4; ++k) mesh.tets(k, first + t) = number[static_cast<std::size_t>(cube.tets(k, t))];
}

mesh::TetMesh make_cubes(const std::vector<Vec3>& corners) {
  mesh::TetMesh mesh;
  mesh.vertices.resize(3, 0);
  mesh.tets.resize(4, 0);
  for (const Vec3& corner : corners) add_cube(corner, mesh);
  return mesh;
}

Support hold_box(const Vec3& lower, const Vec3& upper) {
  Support support;
  support.region.lower = lower.array() - 1e-6;
  support.region.upper = upper.array() + 1e-6;
  return support;
}

std::string find_motion(const mesh::TetMesh& mesh, const std::vector<Support>& supports,
                        ElementKind element = ElementKind::p1) {
  const mesh::Topology topology = mesh::make_topology(mesh);
  const Elements elements = make_elements(mesh, topology, element);
  return find_rigid_motion(elements, topology, find_constraints(elements, supports));
}

/// How many motions of the free components cost no energy: zero eigenvalues of the stiffness.
int count_free_motions(const mesh::TetMesh& mesh, const std::vector<Support>& supports) {
  SolidParams params;
  params.model = StrainModel::linear;
  Scene scene(mesh, supports, params, 1.0, 0.3);
  std::vector<std::pair<int, int>> free;
  for (int n = 0; n < scene.num_nodes(); ++n)
    for (int k = 0; k < 3; ++k)
      if (scene.solid.model.constraints.support(k, n) < 0) free.emplace_back(k, n);
  const auto size = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd K(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    const auto [k, n] = free[static_cast<std::size_t>(j)];
    Points x = scene.rest();
    x(k, n) += 0.125;
    const Points f = 8.0 * scene.compute_force(x);
    for (Eigen::Index i = 0; i < size; ++i)
      K(i, j) = f(free[static_cast<std::size_t>(i)].first, free[static_cast<std::size_t>(i)].second);
  }
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
  return static_cast<int>((values.array() < 1e-10 * values(size - 1)).count());
}

TEST(FindRigidMotion, NamesTheEdgeAboutWhichAPartTurns) {
  // Two cubes share the upright edge x = y = 1; the first stands fast.
  const mesh::TetMesh mesh = make_cubes({Vec3(0, 0, 0), Vec3(1, 1, 0)});
  const std::vector<Support> supports = {hold_box(Vec3(0, 0, 0), Vec3(1, 1, 0))};
  ASSERT_EQ(count_free_motions(mesh, supports), 1);
  const std::string motion = find_motion(mesh, supports);
  EXPECT_NE(motion.find("can turn about an axis along (0, 0, "), std::string::npos) << motion;
  EXPECT_NE(motion.find("near (1, 1, "), std::string::npos) << motion;
}

TEST(FindRigidMotion, FindsAPartThatHangsOnOneVertex) {
  const mesh::TetMesh mesh = make_cubes({Vec3(0, 0, 0), Vec3(1, 1, 1)});
  const std::vector<Support> supports = {hold_box(Vec3(0, 0, 0), Vec3(1, 1, 0))};
  ASSERT_EQ(count_free_motions(mesh, supports), 3);
  EXPECT_NE(find_motion(mesh, supports).find("turn"), std::string::npos);
}

TEST(FindRigidMotion, LetsAHingedPartBeHeldAnywhereOffItsHinge) {
  const mesh::TetMesh mesh = make_cubes({Vec3(0, 0, 0), Vec3(1, 1, 0)});
  const std::vector<Support> supports = {hold_box(Vec3(0, 0, 0), Vec3(1, 1, 0)),
                                         hold_box(Vec3(2, 2, 0), Vec3(2, 2, 0))};
  ASSERT_EQ(count_free_motions(mesh, supports), 0);
  EXPECT_EQ(find_motion(mesh, supports), "");
}

TEST(FindRigidMotion, KnowsPartsThatHoldEachOther) {
  // Two cubes, each held along one edge at its foot, meet in an upright edge: alone each may turn about its
  // foot, together neither may. Held along parallel edges of the same line they fall over together.
  const mesh::TetMesh mesh = make_cubes({Vec3(0, 0, 0), Vec3(1, 1, 0)});
  const std::vector<Support> crossed = {hold_box(Vec3(0, 0, 0), Vec3(1, 0, 0)),
                                        hold_box(Vec3(2, 1, 0), Vec3(2, 2, 0))};
  ASSERT_EQ(count_free_motions(mesh, crossed), 0);
  EXPECT_EQ(find_motion(mesh, crossed), "");
  const std::vector<Support> in_line = {hold_box(Vec3(0, 1, 0), Vec3(2, 1, 0))};
  ASSERT_EQ(count_free_motions(mesh, in_line), 1);
  EXPECT_NE(find_motion(mesh, in_line).find("turn about an axis along ("), std::string::npos);
}

TEST(FindRigidMotion, OfALooseBodyIsFoundAndOfAHeldOneNot) {
  const mesh::TetMesh mesh = make_cubes({Vec3(0, 0, 0), Vec3(5, 0, 0)});
  EXPECT_NE(find_motion(mesh, {}).find("node 0"), std::string::npos);
  const Support first = hold_box(Vec3(0, 0, 0), Vec3(1, 1, 0));
  ASSERT_EQ(count_free_motions(mesh, {first}), 6);
  EXPECT_NE(find_motion(mesh, {first}).find("node 8"), std::string::npos);  // the other cube's first
  EXPECT_EQ(find_motion(mesh, {first, hold_box(Vec3(5, 0, 0), Vec3(6, 0, 1))}), "");
}

TEST(FindRigidMotion, CountsTheMidpointsThatHoldATenNodeTet) {
  // One vertex and the middles of the edges around it: enough for p2, a ball joint for p1.
  const mesh::TetMesh cube = make_cubes({Vec3::Zero()});
  const std::vector<Support> around_corner = {hold_box(Vec3::Zero(), Vec3::Constant(0.5))};
  EXPECT_EQ(find_motion(cube, around_corner, ElementKind::p2), "");
  EXPECT_NE(find_motion(cube, around_corner, ElementKind::p1), "");
}

}  // namespace
}  // namespace argil::solid
