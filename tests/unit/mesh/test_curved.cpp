// Ten-node tets whose edges bend with the surface: volumes in closed form, and where edges have to stay
// straight.
#include "mesh/curved.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <numbers>

#include "shapes/shapes.h"

namespace argil::mesh {
namespace {

/// A tet whose edge between corners 0 and 1 bends by `bend`, as a mesh of itself.
TetMesh make_bent_tet(const Vec3& bend) {
  TetMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0.0, 1.1, 0.2, 0.1,  //
      0.1, 0.0, 0.9, 0.3,               //
      0.0, 0.2, 0.1, 1.2;
  mesh.tets.resize(4, 1);
  mesh.tets << 0, 1, 2, 3;
  mesh.edge_nodes = {{0, 1, 0.5 * (mesh.vertices.col(0) + mesh.vertices.col(1)) + bend}};
  return mesh;
}

Vec3 compute_area(const TetMesh& mesh, int a, int b, int c) {
  const Vec3 first = mesh.vertices.col(a);
  return 0.5 * Vec3(mesh.vertices.col(b) - first).cross(Vec3(mesh.vertices.col(c) - first));
}

TEST(BentTet, HasTheVolumeThatItsFacesSweep) {
  // Two faces move by 4 L₀L₁ d, whose mean over each of them is d/3; one bend makes no second-order term.
  const Vec3 bend(0.05, -0.12, -0.08);
  const TetMesh mesh = make_bent_tet(bend);
  const double straight = compute_volumes(mesh.vertices, mesh.tets)(0);
  const Vec3 outward = compute_area(mesh, 0, 2, 1) + compute_area(mesh, 0, 1, 3);
  const double volume = compute_rest_volumes(mesh)(0);
  EXPECT_NEAR(volume, straight + bend.dot(outward) / 3.0, 1e-15);
  EXPECT_GT(volume, 1.1 * straight);
}

TEST(BentTet, IntegratesItsShapeAndItsPlace) {
  // Σ Xᵢ ∫Nᵢ dV is the first moment. It is found here by cutting the unit tet into many and taking middles.
  const TetMesh mesh = make_bent_tet(Vec3(0.05, -0.12, -0.08));
  const CurvedTets curved(mesh);
  const QuadraticNodes& nodes = *curved.find(0);
  const Eigen::Matrix<double, 10, 1> found = integrate_shape(nodes);
  constexpr int n = 60;
  Eigen::Matrix<double, 10, 1> sum = Eigen::Matrix<double, 10, 1>::Zero();
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        // Duffy's map of the cube's cells.
        const double u = (i + 0.5) / n, v = (j + 0.5) / n, w = (k + 0.5) / n;
        const Vec4 L(1.0 - u, u * (1.0 - v), u * v * (1.0 - w), u * v * w);
        const auto tet = compute_tangent_tet(nodes, L);
        const double jacobian =
            6.0 * compute_tet_volume(tet.col(0), tet.col(1), tet.col(2), tet.col(3)) * u * u * v;
        sum += jacobian / (n * n * n) * compute_quadratic_shape(L);
      }
  EXPECT_LT((found - sum).cwiseAbs().maxCoeff(), 3e-4 * found.sum());
}

TEST(BentTet, FindsAPlaceThatItHas) {
  const TetMesh mesh = make_bent_tet(Vec3(0.05, -0.12, -0.08));
  const CurvedTets curved(mesh);
  const QuadraticNodes& nodes = *curved.find(0);
  for (const Vec4& L : {Vec4(0.4, 0.4, 0.1, 0.1), Vec4(0.5, 0.5, 0.0, 0.0), Vec4(0.1, 0.2, 0.6, 0.1)}) {
    const Vec3 x = nodes * compute_quadratic_shape(L);
    const Mat3 edges = nodes.middleCols<3>(1).colwise() - nodes.col(0);
    const Vec3 straight = edges.inverse() * (x - nodes.col(0));
    const Vec4 start(1.0 - straight.sum(), straight(0), straight(1), straight(2));
    EXPECT_LT((find_in_tet(nodes, x, start) - L).cwiseAbs().maxCoeff(), 1e-12);
  }
  const Vec4 far(5.0, -4.0, 3.0, -3.0);  // of what hangs far outside, the straight tet's weights are kept
  EXPECT_EQ(find_in_tet(nodes, nodes.leftCols<4>() * far + Vec3(9.0, 9.0, 9.0), far), far);
}

struct Ball {
  TetMesh mesh;
  CurvedEdges edges;
  double straight_error = 0.0;  // of the volume, as a share
  double error = 0.0;
};

Ball make_ball(int num_tets) {
  const shapes::Shape shape{shapes::ShapeKind::sphere, 0.06};
  Ball ball;
  ball.mesh = shapes::make_shape_mesh(shape, num_tets);
  ball.edges = curve_boundary(shapes::make_boundary_point(shape), make_topology(ball.mesh), ball.mesh);
  const double wanted = std::numbers::pi / 6.0 * std::pow(0.06, 3);
  ball.straight_error = 1.0 - compute_volumes(ball.mesh.vertices, ball.mesh.tets).sum() / wanted;
  ball.error = 1.0 - compute_rest_volumes(ball.mesh).sum() / wanted;
  return ball;
}

TEST(BentEdges, GiveABallItsVolumeToFourthOrder) {
  const Ball coarse = make_ball(300), fine = make_ball(2400);
  EXPECT_GT(coarse.straight_error, 0.02);
  EXPECT_LT(std::abs(coarse.error), 0.04 * coarse.straight_error);
  EXPECT_GT(coarse.error / fine.error, 10.0);  // cells of half the size: 16; straight edges give 4
  EXPECT_NEAR(coarse.straight_error / fine.straight_error, 4.0, 1.0);
  for (const Ball* ball : {&coarse, &fine}) {
    EXPECT_GT(ball->edges.num_curved, 100);
    EXPECT_EQ(ball->edges.num_straight, 0);
    for (const EdgeNode& node : ball->mesh.edge_nodes)
      EXPECT_NEAR((node.place - Vec3(0.0, 0.0, 0.03)).norm(), 0.03, 1e-12);
  }
}

TEST(BentEdges, OfACylinderAreThoseOfItsWallAndRims) {
  const shapes::Shape shape{shapes::ShapeKind::cylinder, 0.08};
  TetMesh mesh = shapes::make_shape_mesh(shape, 800);
  curve_boundary(shapes::make_boundary_point(shape), make_topology(mesh), mesh);
  const double wanted = std::numbers::pi * 0.02 * 0.02 * 0.08;
  EXPECT_NEAR(compute_rest_volumes(mesh).sum(), wanted, 2e-3 * wanted);
  EXPECT_LT(compute_volumes(mesh.vertices, mesh.tets).sum(), 0.98 * wanted);
}

TEST(BentEdges, StayStraightWhereTetsDoNotBearIt) {
  // A surface that lies so far inside that tets there would be turned over.
  TetMesh mesh = shapes::make_shape_mesh({shapes::ShapeKind::sphere, 0.06}, 300);
  const Vec3 middle(0.0, 0.0, 0.03);
  const auto dented = [&middle](const Vec3& a, const Vec3& b) -> Vec3 {
    const Vec3 x = 0.5 * (a + b);
    return x(2) > 0.045 ? Vec3(x - 0.24 * (b - a).norm() * (x - middle).normalized()) : x;
  };
  const Topology topology = make_topology(mesh);
  const CurvedEdges edges = curve_boundary(dented, topology, mesh);
  EXPECT_GT(edges.num_straight, 0);
  EXPECT_EQ(static_cast<int>(mesh.edge_nodes.size()), edges.num_curved);
  const CurvedTets curved(mesh);
  const Field straight = compute_volumes(mesh.vertices, mesh.tets);
  for (int t = 0; t < mesh.num_tets(); ++t)
    if (const QuadraticNodes* nodes = curved.find(t)) {
      for (int i = 0; i < 4; ++i) {
        const auto tet = compute_tangent_tet(*nodes, Vec4::Unit(i));
        EXPECT_GT(compute_tet_volume(tet.col(0), tet.col(1), tet.col(2), tet.col(3)), 0.25 * straight(t));
      }
    }
}

}  // namespace
}  // namespace argil::mesh
