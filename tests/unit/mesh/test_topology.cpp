// Topology of two tets that share a face, and of a cube cut into five, whose counts follow from Euler's
// formula.
#include "mesh/topology.h"

#include <gtest/gtest.h>

#include "support/two_tets.h"

namespace argil::mesh {
namespace {

TEST(Topology, TwoTetsShareOneFace) {
  const Topology topology = make_topology(test::make_two_tets());
  EXPECT_EQ(topology.boundary.cols(), 6);
  EXPECT_EQ(topology.neighbours(0, 0), 1);
  EXPECT_EQ(topology.neighbours(3, 1), 0);
  EXPECT_EQ((topology.neighbours.array() < 0).count(), 6);
}

TEST(Topology, BoundaryNormalsPointOutSoThatTheDivergenceTheoremGivesTheVolume) {
  const TetMesh mesh = test::make_two_tets();
  const Topology topology = make_topology(mesh);
  double volume = 0.0;  // ∮ x·n dA / 3
  for (Eigen::Index f = 0; f < topology.boundary.cols(); ++f) {
    const Vec3 a = mesh.vertices.col(topology.boundary(0, f));
    const Vec3 b = mesh.vertices.col(topology.boundary(1, f));
    const Vec3 c = mesh.vertices.col(topology.boundary(2, f));
    volume += a.dot(b.cross(c)) / 6.0;
  }
  EXPECT_NEAR(volume, compute_volumes(mesh.vertices, mesh.tets).sum(), 1e-15);
  EXPECT_NEAR(volume, 1.0 / 6.0 + 1.0 / 3.0, 1e-15);
}

TEST(Topology, VertexListsNameEveryTetAroundAVertexOnce) {
  const Topology topology = make_topology(test::make_two_tets());
  ASSERT_EQ(topology.vertex_begin.size(), 6U);
  EXPECT_EQ(topology.vertex_begin[5], 8);
  EXPECT_EQ(topology.vertex_corners[static_cast<std::size_t>(topology.vertex_begin[4])], 4 * 1 + 3);
  EXPECT_EQ(topology.vertex_begin[2] - topology.vertex_begin[1], 2);
}

}  // namespace
}  // namespace argil::mesh
