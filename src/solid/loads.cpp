#include "solid/loads.h"

#include <algorithm>

namespace argil::solid {
namespace {

/// Equal shares at the corners (p1) or at the edge midpoints (p2), which is what the shape functions give.
void add_pressure(const Elements& e, const std::vector<int>& faces, double pressure, Points& force) {
  const int per_face = e.surface_per_face;
  for (const int face : faces)
    for (int k = 0; k < per_face; ++k) {
      // p2: the fourth flat triangle joins the midpoints, and has a quarter of the face's area.
      if (per_face == 4 && k < 3) continue;
      const Eigen::Vector3i n = e.surface.col(per_face * static_cast<Eigen::Index>(face) + k);
      const Vec3 area =
          0.5 * per_face * (e.rest.col(n(1)) - e.rest.col(n(0))).cross(e.rest.col(n(2)) - e.rest.col(n(0)));
      for (const int node : n) force.col(node) -= pressure / 3.0 * area;
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
