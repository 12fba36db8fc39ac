#include "solid/loads.h"

#include <algorithm>
#include <array>

namespace argil::solid {
namespace {

using FaceNodes = Eigen::Matrix<double, 3, 6>;

/// Corners of the flat triangle that goes with a face near L: Σ xᵢ ∂Nᵢ/∂L.
Mat3 compute_tangent_triangle(const FaceNodes& x, const Vec3& L) {
  Mat3 corners;
  for (int i = 0; i < 3; ++i)
    corners.col(i) = (4.0 * L(i) - 1.0) * x.col(i) + 4.0 * L((i + 1) % 3) * x.col(3 + i) +
                     4.0 * L((i + 2) % 3) * x.col(3 + (i + 2) % 3);
  return corners;
}

/// ∫Nᵢ n dA of a face's six nodes, by six points of degree 4 [Dunavant1985], as its integrand is.
FaceNodes integrate_normal(const FaceNodes& x) {
  constexpr double kShares[2] = {0.223381589678011, 0.109951743655322};
  constexpr double kFar[2] = {0.108103018168070, 0.816847572980459};
  FaceNodes sum = FaceNodes::Zero();
  for (int set = 0; set < 2; ++set)
    for (int k = 0; k < 3; ++k) {
      Vec3 L = Vec3::Constant(0.5 * (1.0 - kFar[set]));
      L(k) = kFar[set];
      const Mat3 t = compute_tangent_triangle(x, L);
      const Vec3 area = 0.5 * kShares[set] * Vec3(t.col(1) - t.col(0)).cross(Vec3(t.col(2) - t.col(0)));
      for (int i = 0; i < 3; ++i) {
        sum.col(i) += L(i) * (2.0 * L(i) - 1.0) * area;
        sum.col(3 + i) += 4.0 * L(i) * L((i + 1) % 3) * area;
      }
    }
  return sum;
}

/// Six nodes of a face of ten-node tets: its corners, then those of 01, 12, 20.
std::array<int, 6> find_face_nodes(const Elements& e, int face) {
  const auto of = [&e, face](int k, int corner) {
    return e.surface(corner, 4 * static_cast<Eigen::Index>(face) + k);
  };
  return {of(0, 0), of(1, 1), of(2, 2), of(0, 1), of(1, 2), of(0, 2)};
}

bool is_bent(const FaceNodes& x) {
  for (int i = 0; i < 3; ++i)
    if (x.col(3 + i) != 0.5 * (x.col(i) + x.col((i + 1) % 3))) return true;
  return false;
}

/// False: the face's edges are straight.
bool add_bent_pressure(const Elements& e, int face, double pressure, Points& force) {
  const std::array<int, 6> nodes = find_face_nodes(e, face);
  FaceNodes x;
  for (std::size_t i = 0; i < 6; ++i) x.col(static_cast<Eigen::Index>(i)) = e.rest.col(nodes[i]);
  if (!is_bent(x)) return false;
  const FaceNodes areas = integrate_normal(x);
  for (std::size_t i = 0; i < 6; ++i)
    force.col(nodes[i]) -= pressure * areas.col(static_cast<Eigen::Index>(i));
  return true;
}

/// Equal shares at the corners (p1) or at the edges' nodes (p2), which is what the shape functions give where
/// edges are straight.
void add_pressure(const Elements& e, const std::vector<int>& faces, double pressure, Points& force) {
  const int per_face = e.surface_per_face;
  for (const int face : faces) {
    if (per_face == 4 && add_bent_pressure(e, face, pressure, force)) continue;
    for (int k = 0; k < per_face; ++k) {
      // p2: the fourth flat triangle joins the midpoints, and has a quarter of the face's area.
      if (per_face == 4 && k < 3) continue;
      const Eigen::Vector3i n = e.surface.col(per_face * static_cast<Eigen::Index>(face) + k);
      const Vec3 area =
          0.5 * per_face * (e.rest.col(n(1)) - e.rest.col(n(0))).cross(e.rest.col(n(2)) - e.rest.col(n(0)));
      for (const int node : n) force.col(node) -= pressure / 3.0 * area;
    }
  }
}

}  // namespace

std::vector<int> find_faces(const Points& rest, const Triangles& boundary, const Region& region) {
  const std::vector<int> nodes = find_nodes(rest, std::span(&region, 1));
  std::vector<int> faces;
  for (int f = 0; f < static_cast<int>(boundary.cols()); ++f)
    if (std::all_of(boundary.col(f).begin(), boundary.col(f).end(),
                    [&](int v) { return std::binary_search(nodes.begin(), nodes.end(), v); }))
      faces.push_back(f);
  return faces;
}

Points compute_load_force(const Elements& elements, const Triangles& boundary, const Loads& loads) {
  Points force = Points::Zero(3, elements.num_nodes());
  for (const NodalLoad& load : loads.nodal)
    for (const int node : load.nodes) force.col(node) += load.force;
  for (const PressureLoad& load : loads.pressure)
    add_pressure(elements, find_faces(elements.rest, boundary, load.region), load.pressure, force);
  return force;
}

}  // namespace argil::solid
