#include "shapes/shapes.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/check.h"
#include "base/error.h"
#include "shapes/creatures.h"
#include "shapes/hexahedra.h"

namespace argil::shapes {
namespace {

constexpr double kCountTolerance = 0.15;  // promised by make_shape_mesh
constexpr int kTetsPerCube = 12;

void require_size(const Shape& shape) {
  if (!(shape.size > 0.0 && shape.size < 1e6))
    throw InputError("", "", "size " + std::to_string(shape.size) + " m is outside (0, 1e6) m",
                     "give the body's size in metres");
}

ImplicitSurface make_sphere(double diameter) {
  const double radius = 0.5 * diameter;
  ImplicitSurface surface;
  surface.lower = Vec3(-radius, -radius, 0.0);
  surface.upper = Vec3(radius, radius, diameter);
  surface.value = [radius](const Vec3& x) { return (x - Vec3(0.0, 0.0, radius)).norm() - radius; };
  return surface;
}

// Distance to a set of which a point lies `q` beyond the walls of each independent direction.
template <class Vector>
double combine_walls(const Vector& q) {
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

Vec3 find_box_size(const Shape& shape) {
  return {shape.size / shape.slenderness, shape.size / shape.slenderness, shape.size};
}

ImplicitSurface make_box(const Vec3& size) {
  const Vec3 half = 0.5 * size;
  ImplicitSurface surface;
  surface.lower = Vec3(-half(0), -half(1), 0.0);
  surface.upper = Vec3(half(0), half(1), size(2));
  surface.value = [half](const Vec3& x) {
    return combine_walls(Vec3((x - Vec3(0.0, 0.0, half(2))).cwiseAbs() - half));
  };
  return surface;
}

ImplicitSurface make_cylinder(double height) {
  const double radius = 0.25 * height;
  ImplicitSurface surface;
  surface.lower = Vec3(-radius, -radius, 0.0);
  surface.upper = Vec3(radius, radius, height);
  surface.value = [radius, height](const Vec3& x) {
    const Eigen::Vector2d q(x.head<2>().norm() - radius, std::abs(x(2) - 0.5 * height) - 0.5 * height);
    return combine_walls(q);
  };
  return surface;
}

// Cells along x, y, z that are nearly cubes and whose number is nearest to `num_cubes`.
Eigen::Vector3i choose_box_counts(const Shape& shape, double num_cubes) {
  const double along = std::cbrt(num_cubes / shape.slenderness);
  const auto floor_of = [](double cells) { return std::max(1, static_cast<int>(std::floor(cells))); };
  const Eigen::Vector3i fewest(floor_of(along), floor_of(along), floor_of(shape.slenderness * along));
  Eigen::Vector3i best = fewest;
  for (int i = 1; i < 8; ++i) {
    const Eigen::Vector3i counts = fewest + Eigen::Vector3i(i >> 2 & 1, i >> 1 & 1, i & 1);
    if (std::abs(counts.prod() - num_cubes) < std::abs(best.prod() - num_cubes)) best = counts;
  }
  return best;
}

// Counts whose cells are nearest to cubes and whose number is nearest to `num_cells`.
CylinderCounts choose_cylinder_counts(double num_cells) {
  constexpr double kCountWeight = 4.0;  // a wrong number is worse than a stretched cell
  constexpr double kCoreWidth =
      1.25;  // of `core` cells, mean between the core (0.9) and the rim (1.6), in radii
  constexpr double kRingsWidth = 0.53;  // what is left for the rings
  constexpr double kHeight = 4.0;       // of the cylinder, in radii
  const double cube = std::cbrt(std::acos(-1.0) * kHeight / num_cells);
  const auto stretch = [cube](double length) { return std::abs(std::log(length / cube)); };
  CylinderCounts best;
  double best_cost = 1e9;
  const int max_core = static_cast<int>(2.0 * kCoreWidth / cube) + 2;
  for (int core = 2; core <= max_core; ++core)
    for (int rings = std::max(1, core / 3); rings <= core + 1; ++rings) {
      CylinderCounts counts = {core, rings, 1};
      counts.layers = std::max(1, static_cast<int>(std::lround(num_cells / counts.num_cells())));
      const double cost = stretch(kCoreWidth / core) + stretch(kRingsWidth / rings) +
                          stretch(kHeight / counts.layers) +
                          kCountWeight * std::abs(std::log(counts.num_cells() / num_cells));
      if (cost >= best_cost) continue;
      best = counts;
      best_cost = cost;
    }
  return best;
}

// Lattice size that gives the wanted number of tets: N ∝ 1/h³ corrected from try to try. N is not monotone in
// h for coarse meshes, hence the best of all tries is kept.
mesh::TetMesh stuff_to_count(const ImplicitSurface& surface, int target_tets) {
  constexpr int kTries = 12;
  constexpr double kGoodEnough = 0.02;
  const Vec3 extent = surface.upper - surface.lower;
  double cell_size = std::cbrt(extent.prod() * kTetsPerCube / target_tets);
  mesh::TetMesh best;
  double best_error = 1e9;
  for (int i = 0; i < kTries && best_error > kGoodEnough; ++i) {
    mesh::TetMesh mesh = stuff_isosurface(surface, cell_size);
    const double ratio = static_cast<double>(std::max(mesh.num_tets(), 1)) / target_tets;
    // A second visit to the same size would repeat itself: later tries go part of the way.
    const double damping = i < kTries / 2 ? 1.0 : 0.5;
    cell_size *= std::clamp(std::pow(ratio, damping / 3.0), 0.4, 2.0);
    if (std::abs(ratio - 1.0) >= best_error) continue;
    best_error = std::abs(ratio - 1.0);
    best = std::move(mesh);
  }
  return best;
}

}  // namespace

ImplicitSurface make_implicit_shape(const Shape& shape) {
  require_size(shape);
  switch (shape.kind) {
    case ShapeKind::sphere:
      return make_sphere(shape.size);
    case ShapeKind::cylinder:
      return make_cylinder(shape.size);
    case ShapeKind::box:
      return make_box(find_box_size(shape));
    case ShapeKind::dinosaur:
      return make_dinosaur(shape.size);
    case ShapeKind::figure:
      return make_figure(shape.size);
  }
  ARGIL_ASSERT(false, static_cast<int>(shape.kind));
  return {};
}

mesh::TetMesh make_shape_mesh(const Shape& shape, int target_tets, Count count) {
  require_size(shape);
  constexpr int kFewest = 100;
  constexpr int kMost = 20'000'000;
  if (target_tets < kFewest || target_tets > kMost)
    throw InputError("", "", "target_tets " + std::to_string(target_tets) + " is outside [100, 20000000]",
                     "ask for a number of tets in this range");
  const double num_cubes = static_cast<double>(target_tets) / kTetsPerCube;
  mesh::TetMesh mesh;
  if (shape.kind == ShapeKind::box)
    mesh = split_hexahedra(make_box_hexahedra(find_box_size(shape), choose_box_counts(shape, num_cubes)));
  else if (shape.kind == ShapeKind::cylinder)
    mesh = split_hexahedra(
        make_cylinder_hexahedra(0.25 * shape.size, shape.size, choose_cylinder_counts(num_cubes)));
  else
    mesh = stuff_to_count(make_implicit_shape(shape), target_tets);
  const double error = std::abs(mesh.num_tets() - target_tets) / static_cast<double>(target_tets);
  if (count == Count::wanted && !(error <= kCountTolerance))
    throw InputError("", "",
                     "target_tets " + std::to_string(target_tets) +
                         " cannot be met within 15 %; nearest is " + std::to_string(mesh.num_tets()),
                     "ask for that number or for more tets");
  return mesh;
}

mesh::BoundaryPoint make_boundary_point(const Shape& shape) {
  if (shape.kind == ShapeKind::box) return {};
  if (shape.kind != ShapeKind::cylinder)
    return [surface = make_implicit_shape(shape)](const Vec3& a, const Vec3& b) {
      return project_onto(surface, 0.5 * (a + b), (b - a).norm());
    };
  const double wall = 0.25 * shape.size;
  return [wall](const Vec3& a, const Vec3& b) {
    const auto is_on_wall = [wall](const Vec3& x) {
      return std::abs(x.head<2>().norm() - wall) < 1e-9 * wall;
    };
    Vec3 middle = 0.5 * (a + b);
    if (is_on_wall(a) && is_on_wall(b)) middle.head<2>() *= wall / middle.head<2>().norm();
    return middle;
  };
}

mesh::TriangleMesh make_shape_skin(const Shape& shape, int min_triangles) {
  require_size(shape);
  ARGIL_ASSERT(min_triangles <= 20'000'000, min_triangles);
  const double wanted = std::max(min_triangles, 100);
  if (shape.kind == ShapeKind::box) {
    const int n = static_cast<int>(std::ceil(std::sqrt(wanted / (4.0 + 8.0 * shape.slenderness))));
    const int layers = static_cast<int>(std::ceil(shape.slenderness * n));
    return extract_boundary(make_box_hexahedra(find_box_size(shape), {n, n, layers}));
  }
  if (shape.kind == ShapeKind::cylinder) {
    CylinderCounts counts;
    const auto num_triangles = [&counts] {
      return 4.0 * (counts.core * counts.core + 4 * counts.core * counts.rings) +
             8.0 * counts.core * counts.layers;
    };
    while (num_triangles() < wanted) {
      ++counts.core;
      counts.rings = (counts.core + 1) / 2;
      counts.layers = 4 * counts.core;
    }
    return extract_boundary(make_cylinder_hexahedra(0.25 * shape.size, shape.size, counts));
  }
  const ImplicitSurface surface = make_implicit_shape(shape);
  double cell_size = 0.2 * (surface.upper - surface.lower).minCoeff();
  while (true) {  // the number of triangles grows as 1/h²
    mesh::TriangleMesh skin = extract_isosurface(surface, cell_size);
    if (skin.num_triangles() >= wanted) return skin;
    cell_size *= 0.98 * std::sqrt(std::max(skin.num_triangles(), 10) / wanted);
  }
}

}  // namespace argil::shapes
