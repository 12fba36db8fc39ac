// A coarse surface that is split where it bends: a sphere becomes rounder and keeps its volume, a cube stays
// a cube.
#include "embed/curved_split.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh/topology.h"
#include "shapes/shapes.h"
#include "support/block_mesh.h"

namespace argil::embed {
namespace {

double enclose(const mesh::TriangleMesh& m) {
  double sum = 0.0;
  for (const auto& v : m.triangles.colwise())
    sum += m.vertices.col(v(0)).dot(m.vertices.col(v(1)).cross(m.vertices.col(v(2)))) / 6.0;
  return sum;
}

/// An octahedron, halved twice, on the unit sphere.
mesh::TriangleMesh make_coarse_sphere() {
  mesh::TriangleMesh m;
  m.vertices.resize(3, 6);
  m.vertices << 1, -1, 0, 0, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0, 1, -1;
  m.triangles.resize(3, 8);
  m.triangles << 0, 2, 1, 3, 2, 1, 3, 0, 2, 1, 3, 0, 0, 2, 1, 3, 4, 4, 4, 4, 5, 5, 5, 5;
  for (int level = 0; level < 2; ++level) {
    std::vector<Vec3> x;
    std::vector<Eigen::Vector3i> t;
    for (const auto& v : m.triangles.colwise()) {
      const Vec3 a = m.vertices.col(v(0)), b = m.vertices.col(v(1)), c = m.vertices.col(v(2));
      const int first = static_cast<int>(x.size());
      for (const Vec3& p : {a, b, c, Vec3(a + b), Vec3(b + c), Vec3(c + a)}) x.push_back(p.normalized());
      for (const Eigen::Vector3i& part : {Eigen::Vector3i(0, 3, 5), Eigen::Vector3i(3, 1, 4),
                                          Eigen::Vector3i(5, 4, 2), Eigen::Vector3i(3, 4, 5)})
        t.push_back(part + Eigen::Vector3i::Constant(first));
    }
    // Equal places are one vertex.
    std::vector<int> number(x.size());
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < x.size(); ++i) {
      std::size_t k = 0;
      while (k < kept.size() && (kept[k] - x[i]).norm() > 1e-9) ++k;
      if (k == kept.size()) kept.push_back(x[i]);
      number[i] = static_cast<int>(k);
    }
    m.vertices.resize(3, static_cast<Eigen::Index>(kept.size()));
    for (std::size_t i = 0; i < kept.size(); ++i) m.vertices.col(static_cast<Eigen::Index>(i)) = kept[i];
    m.triangles.resize(3, static_cast<Eigen::Index>(t.size()));
    for (std::size_t i = 0; i < t.size(); ++i)
      for (int k = 0; k < 3; ++k)
        m.triangles(k, static_cast<Eigen::Index>(i)) = number[static_cast<std::size_t>(t[i](k))];
  }
  return m;
}

/// Largest less smallest distance of points of the triangles from the middle: of a flat one the vertices are
/// far out and the middle is not.
double find_unroundness(const mesh::TriangleMesh& m) {
  double low = 1e300, high = 0.0;
  for (const auto& v : m.triangles.colwise()) {
    const Vec3 middle = (m.vertices.col(v(0)) + m.vertices.col(v(1)) + m.vertices.col(v(2))) / 3.0;
    for (const Vec3& p : {Vec3(m.vertices.col(v(0))), middle}) {
      low = std::min(low, p.norm());
      high = std::max(high, p.norm());
    }
  }
  return high - low;
}

TEST(CurvedSplit, MakesASphereRounderOfTheSameVolume) {
  const mesh::TriangleMesh coarse = make_coarse_sphere();
  const mesh::TriangleMesh fine = split_where_curved(coarse);
  EXPECT_GT(enclose(coarse), 0.0);
  EXPECT_EQ(fine.num_triangles(), 16 * coarse.num_triangles());
  EXPECT_NEAR(enclose(fine), enclose(coarse), 0.02 * enclose(coarse));
  EXPECT_LT(find_unroundness(fine), 0.6 * find_unroundness(coarse));
}

TEST(CurvedSplit, LeavesACubeAsItIs) {
  const mesh::TetMesh block = test::make_block(2, 2, 2, Vec3(1, 1, 1));
  const mesh::TriangleMesh cube{block.vertices, mesh::make_topology(block).boundary};
  const mesh::TriangleMesh split = split_where_curved(cube);
  EXPECT_EQ(split.vertices, cube.vertices);
  EXPECT_EQ(split.triangles, cube.triangles);
}

}  // namespace
}  // namespace argil::embed
