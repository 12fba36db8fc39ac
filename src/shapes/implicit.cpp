#include "shapes/implicit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "mesh/topology.h"
#include "shapes/stuffing.h"

namespace argil::shapes {
namespace {

// Where the surface is finer than the lattice, snapped nodes can join two sheets in a point or an edge. Such
// nodes go back to their places; without any snapped node the boundary is manifold, so this ends. Returns the
// layer of tets at the surface.
StuffedLattice stuff_without_pinches(CutLattice& cut_lattice, Triangles& boundary) {
  while (true) {
    StuffedLattice stuffed = stuff_lattice(cut_lattice, StuffingPart::surface_layer);
    boundary = find_surface_faces(stuffed);
    std::vector<int> pinched;
    for (const int vertex : mesh::find_non_manifold_vertices(boundary, stuffed.mesh.num_vertices()))
      if (const int node = stuffed.node[static_cast<std::size_t>(vertex)]; node >= 0) pinched.push_back(node);
    if (pinched.empty()) return stuffed;
    cut_lattice.keep_in_place(pinched);
  }
}

Vec3 compute_gradient(const ImplicitSurface& surface, const Vec3& x, double step) {
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 d = step * Vec3::Unit(axis);
    gradient(axis) = (surface.value(x + d) - surface.value(x - d)) / (2.0 * step);
  }
  return gradient;
}

// Worst of the triangles `around` a vertex when it lies at `x`; 1: equilateral, negative: turned over.
double smallest_quality(const mesh::TriangleMesh& mesh, const std::vector<int>& around, int vertex,
                        const Vec3& x) {
  double smallest = 1.0;
  for (const int t : around) {
    std::array<Vec3, 3> before;
    std::array<Vec3, 3> after;
    for (std::size_t i = 0; i < 3; ++i) {
      const int v = mesh.triangles(static_cast<int>(i), t);
      before[i] = mesh.vertices.col(v);
      after[i] = v == vertex ? x : before[i];
    }
    const Vec3 normal_before = (before[1] - before[0]).cross(before[2] - before[0]);
    const Vec3 normal = (after[1] - after[0]).cross(after[2] - after[0]);
    const double edges = (after[1] - after[0]).squaredNorm() + (after[2] - after[1]).squaredNorm() +
                         (after[0] - after[2]).squaredNorm();
    const double quality = 2.0 * std::sqrt(3.0) * normal.norm() / edges;
    smallest = std::min(smallest, normal.dot(normal_before) > 0.0 ? quality : -quality);
  }
  return smallest;
}

}  // namespace

Vec3 project_onto(const ImplicitSurface& surface, Vec3 x, double length) {
  constexpr int kSteps = 4;
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 gradient = compute_gradient(surface, x, 1e-4 * length);
    const double slope = gradient.squaredNorm();
    if (!(slope > 0.01)) break;  // of a signed distance it is 1
    const double distance = surface.value(x);
    x -= (distance / slope) * gradient;
    if (std::abs(distance) < 1e-12 * length) break;
  }
  return x;
}

mesh::TetMesh stuff_isosurface(const ImplicitSurface& surface, double cell_size) {
  CutLattice cut_lattice(surface, cell_size);
  Triangles boundary;
  stuff_without_pinches(cut_lattice, boundary);
  return stuff_lattice(cut_lattice, StuffingPart::all).mesh;
}

namespace {

mesh::TriangleMesh compact(const Points& vertices, const Triangles& triangles) {
  std::vector<int> number(static_cast<std::size_t>(vertices.cols()), -1);
  mesh::TriangleMesh mesh;
  mesh.triangles.resize(3, triangles.cols());
  mesh.vertices.resize(3, vertices.cols());
  int num_used = 0;
  for (Eigen::Index i = 0; i < triangles.size(); ++i) {
    const int vertex = triangles.data()[i];
    int& n = number[static_cast<std::size_t>(vertex)];
    if (n < 0) {
      n = num_used++;
      mesh.vertices.col(n) = vertices.col(vertex);
    }
    mesh.triangles.data()[i] = n;
  }
  mesh.vertices.conservativeResize(3, num_used);
  return mesh;
}

// Moves each vertex toward the mean of its neighbours and back onto the surface, where that makes the worst
// of its triangles better.
void relax(const ImplicitSurface& surface, double cell_size, mesh::TriangleMesh& mesh) {
  constexpr int kSweeps = 4;
  std::vector<std::vector<int>> around(static_cast<std::size_t>(mesh.num_vertices()));
  for (int t = 0; t < mesh.num_triangles(); ++t)
    for (int i = 0; i < 3; ++i) around[static_cast<std::size_t>(mesh.triangles(i, t))].push_back(t);
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int v = 0; v < mesh.num_vertices(); ++v) {
      const std::vector<int>& triangles = around[static_cast<std::size_t>(v)];
      Vec3 mean = Vec3::Zero();  // each neighbour counts twice: a closed fan
      for (const int t : triangles)
        for (int i = 0; i < 3; ++i)
          if (mesh.triangles(i, t) != v) mean += mesh.vertices.col(mesh.triangles(i, t));
      mean /= 2.0 * static_cast<double>(triangles.size());
      const Vec3 before = mesh.vertices.col(v);
      const Vec3 after = project_onto(surface, mean, cell_size);
      if (smallest_quality(mesh, triangles, v, after) > smallest_quality(mesh, triangles, v, before))
        mesh.vertices.col(v) = after;
    }
}

}  // namespace

mesh::TriangleMesh extract_isosurface(const ImplicitSurface& surface, double cell_size) {
  CutLattice cut_lattice(surface, cell_size);
  Triangles boundary;
  const StuffedLattice stuffed = stuff_without_pinches(cut_lattice, boundary);
  mesh::TriangleMesh mesh = compact(stuffed.mesh.vertices, boundary);
  relax(surface, cell_size, mesh);
  return mesh;
}

}  // namespace argil::shapes
