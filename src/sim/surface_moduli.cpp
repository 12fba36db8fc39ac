#include "sim/surface_moduli.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace argil::sim {

SurfaceModuli::SurfaceModuli(const ContactSurface& surface, const solid::Body& solid,
                             const contact::ContactParams& params)
    : m_surface(surface), m_solid(solid), m_params(params) {
  if (params.law != contact::ContactLaw::pressure) return;
  for (int t = 0; t < static_cast<int>(surface.triangles().cols()); ++t)
    m_above.emplace_back(surface.tet_under(t), t);
  std::sort(m_above.begin(), m_above.end());
}

/// Edge of a regular tet of its volume [m].
double SurfaceModuli::find_cell(int tet) const {
  const int points = m_solid.model.elements.points_per_tet;
  double volume = 0.0;
  for (int p = 0; p < points; ++p) volume += m_solid.materials.weight()(tet * points + p);
  return std::cbrt(6.0 * std::numbers::sqrt2 * volume);
}

contact::StiffnessOfTriangle SurfaceModuli::find(int triangle, int tet) const {
  const solid::Elements& elements = m_solid.model.elements;
  const double nodes_per_edge = elements.nodes_per_tet == 4 ? 1.0 : 2.0;
  const solid::TetMaterial material = m_solid.materials.of(tet);
  const double lambda = material.lambda, mu = material.mu;
  const double modulus = 4.0 * mu * (lambda + mu) / (lambda + 2.0 * mu);
  const double chosen = contact::kChosenStiffness * modulus * nodes_per_edge / find_cell(tet);
  return {triangle, m_params.pressure_stiffness > 0.0 ? m_params.pressure_stiffness : chosen, modulus};
}

/// Are all nodes held that carry its corners?
bool SurfaceModuli::is_held(int triangle) const {
  const solid::Constraints& constraints = m_solid.model.constraints;
  const auto corners = m_surface.triangles().col(triangle);
  return std::all_of(corners.begin(), corners.end(), [&](int vertex) {
    const std::span<const int> nodes = m_surface.nodes(vertex);
    return std::all_of(nodes.begin(), nodes.end(), [&](int node) { return constraints.is_held(node); });
  });
}

contact::SurfaceStiffness SurfaceModuli::find_all() const {
  const Eigen::Index count = m_surface.triangles().cols();
  contact::SurfaceStiffness all{Field(count), Field(count),
                                std::vector<char>(static_cast<std::size_t>(count)), Field(count)};
  for (const auto& [tet, triangle] : m_above) {
    const contact::StiffnessOfTriangle found = find(triangle, tet);
    all.per_area(triangle) = found.per_area;
    all.modulus(triangle) = found.modulus;
    all.cell(triangle) = find_cell(tet);
    all.is_rigid[static_cast<std::size_t>(triangle)] = is_held(triangle) ? 1 : 0;
  }
  all.are_flat = m_solid.model.elements.nodes_per_tet == 4;
  return all;
}

void SurfaceModuli::find_above(std::span<const int> tets,
                               std::vector<contact::StiffnessOfTriangle>& out) const {
  if (m_above.empty()) return;
  for (const int tet : tets) {
    auto at = std::lower_bound(m_above.begin(), m_above.end(), std::pair(tet, -1));
    for (; at != m_above.end() && at->first == tet; ++at) out.push_back(find(at->second, tet));
  }
}

}  // namespace argil::sim
