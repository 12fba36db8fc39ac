#include "water/stencil.h"

#include <Eigen/QR>

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "mesh/curved.h"

namespace argil::water {
namespace {

// Two neighbours of positive volume always lie on either side of their face: d_n = (height + height)/4. Where
// both are slivers lying flat on it, d_n falls below this share of |d| and is held there: the conductance,
// and with it the number of substeps, stays within ten times A/|d|. The correction then uses the same d_n, so
// that a linear field keeps flowing exactly.
constexpr double kSmallestProjection = 0.1;

constexpr int kOppositeFace[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

Vec3 compute_centroid(const mesh::TetMesh& mesh, int t) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 4; ++i) sum += mesh.vertices.col(mesh.tets(i, t));
  return 0.25 * sum;
}

/// Area vector [m²] of the face opposite to `corner`, pointing out of tet t.
Vec3 compute_area(const mesh::TetMesh& mesh, int t, int corner) {
  const auto& face = kOppositeFace[corner];
  const Vec3 a = mesh.vertices.col(mesh.tets(face[0], t));
  const Vec3 b = mesh.vertices.col(mesh.tets(face[1], t));
  const Vec3 c = mesh.vertices.col(mesh.tets(face[2], t));
  return 0.5 * (b - a).cross(c - a);
}

int find_corner(const Tets& neighbours, int t, int neighbour) {
  int corner = 0;
  while (neighbours(corner, t) != neighbour) ++corner;
  return corner;
}

/// Fills the face between t and the higher-numbered tet `other` on both sides.
void set_face(const mesh::TetMesh& mesh, double D, int t, int corner, int other, Stencil& stencil) {
  const Vec3 area = compute_area(mesh, t, corner);
  const Vec3 across = compute_centroid(mesh, other) - compute_centroid(mesh, t);
  const double size = area.norm();
  const double distance = std::max(across.dot(area) / size, kSmallestProjection * across.norm());
  const int its_corner = find_corner(stencil.neighbours, other, t);
  stencil.conductance(corner, t) = stencil.conductance(its_corner, other) = D * size / distance;
  if (stencil.tangent.cols() == 0) return;
  const Vec3 tangent = D * (area - size / distance * across);
  stencil.tangent.col(t).segment<3>(row_of(corner)) = tangent;
  stencil.tangent.col(other).segment<3>(row_of(its_corner)) = -tangent;
}

/// Least-squares gradient from the four faces: d·∇S = S_o − S_t inside, n·∇S = 0 at the sealed boundary,
/// weighted by inverse distance. Exact for linear fields inside, and for those that respect the boundary.
void set_gradient(const mesh::TetMesh& mesh, int t, Stencil& stencil) {
  Eigen::Matrix<double, 4, 3> rows;
  Vec4 scale;
  const Vec3 centre = compute_centroid(mesh, t);
  for (int corner = 0; corner < 4; ++corner) {
    const int other = stencil.neighbours(corner, t);
    const Vec3 direction =
        other >= 0 ? Vec3(compute_centroid(mesh, other) - centre) : compute_area(mesh, t, corner);
    scale(corner) = other >= 0 ? 1.0 / direction.norm() : 0.0;
    rows.row(corner) = direction.normalized().transpose();
  }
  const Eigen::Matrix<double, 3, 4> inverse = rows.completeOrthogonalDecomposition().pseudoInverse();
  for (int corner = 0; corner < 4; ++corner)
    stencil.gradient.col(t).segment<3>(row_of(corner)) = scale(corner) * inverse.col(corner);
}

/// Σ A/distance over the boundary faces is as if all lay at this distance; a centroid is at a quarter of its
/// height 3V/A above a face.
double compute_wall_distance(const mesh::TetMesh& mesh, const Stencil& stencil, int t) {
  const bool is_inside = (stencil.neighbours.col(t).array() >= 0).all();
  double sum = 0.0, squares = 0.0;
  for (int corner = 0; corner < 4; ++corner) {
    if (!is_inside && stencil.neighbours(corner, t) >= 0) continue;
    const double area = compute_area(mesh, t, corner).norm();
    sum += area;
    squares += area * area;
  }
  return 0.75 * stencil.volume(t) * sum / squares;
}

}  // namespace

Stencil make_stencil(const mesh::TetMesh& mesh, const mesh::Topology& topology, double diffusivity,
                     FluxForm form) {
  const int num_tets = mesh.num_tets();
  Stencil stencil;
  stencil.neighbours = topology.neighbours;
  stencil.volume = mesh::compute_rest_volumes(mesh);
  stencil.wall_distance.setZero(num_tets);
  stencil.conductance.setZero(4, num_tets);
  if (form == FluxForm::corrected) {
    stencil.tangent.setZero(12, num_tets);
    stencil.gradient.setZero(12, num_tets);
  }
  for (int t = 0; t < num_tets; ++t) {
    ARGIL_ASSERT(stencil.volume(t) > 0.0, t, stencil.volume(t));
    for (int corner = 0; corner < 4; ++corner)
      if (const int other = stencil.neighbours(corner, t); other > t)
        set_face(mesh, diffusivity, t, corner, other, stencil);
    if (form == FluxForm::corrected) set_gradient(mesh, t, stencil);
    stencil.wall_distance(t) = compute_wall_distance(mesh, stencil, t);
  }
  stencil.monotone_step = std::numeric_limits<double>::infinity();
  for (int t = 0; t < num_tets; ++t)
    if (const double sum = stencil.conductance.col(t).sum(); sum > 0.0)
      stencil.monotone_step = std::min(stencil.monotone_step, stencil.volume(t) / sum);
  return stencil;
}

}  // namespace argil::water
