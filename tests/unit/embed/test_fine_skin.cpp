// Triangles larger than the cage's cells are split: closed, flat at rest, carried everywhere, the rest as it
// was.
#include "embed/fine_skin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "base/rng.h"
#include "mesh/topology.h"
#include "support/block_mesh.h"
#include "support/box_skin.h"

namespace argil::embed {
namespace {

constexpr double kCells = 8.0;
const Vec3 kSize(0.04, 0.04, 0.02);

mesh::TetMesh make_cage() {
  return test::make_block(static_cast<int>(kCells), static_cast<int>(kCells), 4, kSize);
}

FineSkin split(const mesh::TriangleMesh& skin, const mesh::TetMesh& cage, double size_over_cell) {
  return split_to_cells(skin, make_embedding(cage, skin.vertices, "skin"), cage, size_over_cell);
}

Points place(const FineSkin& fine, const mesh::TetMesh& cage, const Points& x) {
  Points out;
  interpolate_positions(fine.embedding, cage.tets, x, out);
  return out;
}

Vec3 area_vector(const Points& x, const Eigen::Vector3i& t) {
  return 0.5 * Vec3(x.col(t(1)) - x.col(t(0))).cross(Vec3(x.col(t(2)) - x.col(t(0))));
}

double longest_edge(const Points& x, const Triangles& triangles) {
  double longest = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (x.col(triangles(k, t)) - x.col(triangles((k + 1) % 3, t))).norm());
  return longest;
}

/// Triangles as places of their corners in a fixed order, whatever their numbers.
std::vector<std::array<double, 9>> list_places(const Points& x, const Triangles& triangles) {
  std::vector<std::array<double, 9>> list;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    std::array<std::array<double, 3>, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < 3; ++i)
        corner[k][i] = x(static_cast<Eigen::Index>(i), triangles(static_cast<Eigen::Index>(k), t));
    std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
    std::array<double, 9> all{};
    for (std::size_t k = 0; k < 9; ++k) all[k] = corner[k / 3][k % 3];
    list.push_back(all);
  }
  std::sort(list.begin(), list.end());
  return list;
}

class BoxSkin : public testing::TestWithParam<int> {};

/// A manifold has each edge once in either direction; pieces of a flat triangle have its normal and, all
/// together, the box's area; each edge is as short as was asked.
TEST_P(BoxSkin, StaysClosedFlatAndOfItsArea) {
  const mesh::TetMesh cage = make_cage();
  const mesh::TriangleMesh skin =
      test::make_box_skin(GetParam(), 1e-4 * Vec3::Ones(), kSize - 2e-4 * Vec3::Ones());
  const FineSkin fine = split(skin, cage, 0.5);
  const Points x = place(fine, cage, cage.vertices);
  std::map<std::pair<int, int>, int> times;
  double area = 0.0;
  for (Eigen::Index t = 0; t < fine.triangles.cols(); ++t) {
    const Eigen::Vector3i v = fine.triangles.col(t);
    for (int k = 0; k < 3; ++k) ++times[{v(k), v((k + 1) % 3)}];
    const Vec3 a = area_vector(x, v);
    EXPECT_NEAR(a.cwiseAbs().maxCoeff(), a.norm(), 1e-12 * a.norm());
    EXPECT_GT(a.dot(Vec3(x.col(v(0)) - 0.5 * kSize)), 0.0);  // outward
    area += a.norm();
  }
  for (const auto& [edge, count] : times) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(times.contains({edge.second, edge.first}));
  }
  const Vec3 s = kSize - 2e-4 * Vec3::Ones();
  EXPECT_NEAR(area, 2.0 * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x()), 1e-12 * area);
  // Of a cube's six tets: three edges, two diagonals of its faces, its own diagonal.
  const double mean_edge = kSize.x() / kCells * (3.0 + 2.0 * std::sqrt(2.0) + std::sqrt(3.0)) / 6.0;
  EXPECT_LE(longest_edge(x, fine.triangles), 0.5 * mean_edge * (1.0 + 1e-9));
}

INSTANTIATE_TEST_SUITE_P(Cells, BoxSkin, testing::Values(1, 2, 3, 7, 16));

TEST(FineSkin, FollowsTheCageWhereTheLargeTriangleCouldNot) {
  // x² is no linear function: over a large triangle it is missed by up to a quarter of the edge squared; a
  // cage of cells c across misses it by at most its own edges squared over 8, and pieces by as much again.
  const mesh::TetMesh cage = make_cage();
  const FineSkin fine = split(test::make_box_skin(1, Vec3::Zero(), kSize), cage, 0.5);
  Points bent = cage.vertices;
  bent.row(2).array() += 10.0 * cage.vertices.row(0).array().square();
  const Points rest = place(fine, cage, cage.vertices);
  const Points x = place(fine, cage, bent);
  const double cell = kSize.x() / kCells;
  double farthest = 0.0;
  for (Eigen::Index t = 0; t < fine.triangles.cols(); ++t) {
    const Eigen::Vector3i v = fine.triangles.col(t);
    const Vec3 at = (rest.col(v(0)) + rest.col(v(1)) + rest.col(v(2))) / 3.0;
    const double lift = (x(2, v(0)) + x(2, v(1)) + x(2, v(2))) / 3.0 - at.z();
    farthest = std::max(farthest, std::abs(lift - 10.0 * at.x() * at.x()));
  }
  EXPECT_LT(farthest, 10.0 * 2.0 * 3.0 * cell * cell / 8.0);
}

TEST(FineSkin, ThatIsFineAlreadyStaysAsItIs) {
  const mesh::TetMesh cage = make_cage();
  const mesh::TriangleMesh skin = test::make_box_skin(32, 1e-4 * Vec3::Ones(), kSize - 2e-4 * Vec3::Ones());
  const Embedding embedding = make_embedding(cage, skin.vertices, "skin");
  const FineSkin fine = split_to_cells(skin, embedding, cage, 0.5);
  EXPECT_EQ(fine.triangles, skin.triangles);
  EXPECT_EQ(fine.embedding.tet, embedding.tet);
  EXPECT_EQ(fine.embedding.weights, embedding.weights);
}

TEST(FineSkin, DoesNotHangOnNumbers) {
  const mesh::TetMesh cage = make_cage();
  const mesh::TriangleMesh skin = test::make_box_skin(3, 1e-4 * Vec3::Ones(), kSize - 2e-4 * Vec3::Ones());
  mesh::TriangleMesh other = skin;
  const int n = skin.num_vertices(), m = skin.num_triangles();
  for (int v = 0; v < n; ++v) other.vertices.col(n - 1 - v) = skin.vertices.col(v);
  for (int t = 0; t < m; ++t)
    for (int k = 0; k < 3; ++k) other.triangles(k, (7 * t + 5) % m) = n - 1 - skin.triangles((k + t) % 3, t);
  const FineSkin a = split(skin, cage, 0.5), b = split(other, cage, 0.5);
  const Points xa = place(a, cage, cage.vertices), xb = place(b, cage, cage.vertices);
  EXPECT_GT(a.triangles.cols(), 4 * m);
  EXPECT_EQ(list_places(xa, a.triangles), list_places(xb, b.triangles));
}

/// A block and the same again 50 mm along x, for skins that reach from one to the other.
mesh::TetMesh make_two_apart(mesh::TetMesh cage) {
  const int n = cage.num_vertices(), m = cage.num_tets();
  cage.vertices.conservativeResize(3, 2 * n);
  cage.vertices.rightCols(n) = cage.vertices.leftCols(n).colwise() + Vec3(0.05, 0, 0);
  cage.tets.conservativeResize(4, 2 * m);
  cage.tets.rightCols(m) = cage.tets.leftCols(m).array() + n;
  return cage;
}

TEST(FineSkin, LeavesAnEdgeWhoseMiddleLiesOutOfTheCage) {
  const mesh::TetMesh cage = make_two_apart(test::make_block(2, 2, 2, Vec3::Constant(0.01)));
  mesh::TriangleMesh skin;
  skin.vertices.resize(3, 3);
  skin.vertices.col(0) = Vec3(0.001, 0.001, 0.005);
  skin.vertices.col(1) = Vec3(0.059, 0.001, 0.005);
  skin.vertices.col(2) = Vec3(0.001, 0.009, 0.005);
  skin.triangles = Eigen::Vector3i(0, 1, 2);
  const FineSkin fine = split(skin, cage, 1.0);
  const Points x = place(fine, cage, cage.vertices);
  // The short edge alone is halved.
  EXPECT_EQ(fine.triangles.cols(), 2);
  ASSERT_EQ(x.cols(), 4);
  EXPECT_LT((Vec3(x.col(3)) - Vec3(0.001, 0.005, 0.005)).norm(), 1e-15);
}

/// An edge many cells long stays as it is, and the triangle beside it can have no short edges only.
TEST(FineSkin, EndsBesideALongEdgeThatStays) {
  const mesh::TetMesh cage = make_two_apart(test::make_block(4, 8, 4, Vec3(0.01, 0.02, 0.01)));
  mesh::TriangleMesh skin;
  skin.vertices.resize(3, 4);
  skin.vertices.col(0) = Vec3(0.009, 0.001, 0.005);
  skin.vertices.col(1) = Vec3(0.051, 0.001, 0.005);
  skin.vertices.col(2) = Vec3(0.009, 0.019, 0.005);
  skin.vertices.col(3) = Vec3(0.051, 0.019, 0.005);
  skin.triangles.resize(3, 2);
  skin.triangles << 0, 1, 1, 3, 2, 2;
  const FineSkin fine = split(skin, cage, 0.5);
  const Points x = place(fine, cage, cage.vertices);
  double area = 0.0;
  for (Eigen::Index t = 0; t < fine.triangles.cols(); ++t) {
    const Vec3 a = area_vector(x, fine.triangles.col(t));
    EXPECT_GT(a.z(), 0.0);
    area += a.z();
  }
  EXPECT_NEAR(area / (0.042 * 0.018), 1.0, 1e-12);
  EXPECT_LT(fine.triangles.cols(), 1000);
}

}  // namespace
}  // namespace argil::embed
