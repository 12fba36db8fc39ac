#include "water/water.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"

namespace argil::water {
namespace {

// The explicit substep stays this far below the monotone limit, so that rounding cannot cross it.
constexpr double kLimitShare = 0.9;

// Two centroids whose distance along the face normal is below this share of their distance lie beside each
// other rather than across the face; the projected distance is then replaced by that share (slivers).
constexpr double kSmallestProjection = 0.1;

constexpr int kOppositeFace[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

Vec3 compute_centroid(const mesh::TetMesh& mesh, int t) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 4; ++i) sum += mesh.vertices.col(mesh.tets(i, t));
  return 0.25 * sum;
}

/// A_f / d_f [m] across the face opposite to `corner` of tet t: d_f is the centroids' distance along the
/// normal.
double compute_transmissibility(const mesh::TetMesh& mesh, int t, int corner, int neighbour) {
  const auto& face = kOppositeFace[corner];
  const Vec3 a = mesh.vertices.col(mesh.tets(face[0], t));
  const Vec3 area = 0.5 * (Vec3(mesh.vertices.col(mesh.tets(face[1], t))) - a)
                              .cross(Vec3(mesh.vertices.col(mesh.tets(face[2], t))) - a);
  const Vec3 across = compute_centroid(mesh, neighbour) - compute_centroid(mesh, t);
  const double size = area.norm();
  const double distance = std::max(std::abs(across.dot(area)) / size, kSmallestProjection * across.norm());
  return size / distance;
}

}  // namespace

void PoreWater::CompensatedSum::add(double x) {
  const double next = sum + x;
  error += std::abs(sum) >= std::abs(x) ? (sum - next) + x : (x - next) + sum;
  sum = next;
}

PoreWater::PoreWater(const mesh::TetMesh& mesh, const mesh::Topology& topology, const WaterParams& params,
                     const Field& initial_saturation)
    : m_params(params),
      m_neighbours(topology.neighbours),
      m_boundary_tet(topology.boundary_tet),
      m_volume(mesh::compute_volumes(mesh.vertices, mesh.tets)),
      m_capacity(params.density * params.porosity * m_volume),
      m_saturation(initial_saturation),
      m_flow(Field::Zero(mesh.num_tets())),
      m_collected(initial_saturation),
      m_is_active(static_cast<std::size_t>(mesh.num_tets()), 0) {
  ARGIL_ASSERT(initial_saturation.size() == mesh.num_tets());
  m_active.reserve(m_is_active.size());
  m_conductance.setZero(4, mesh.num_tets());
  for (int t = 0; t < mesh.num_tets(); ++t)
    for (int corner = 0; corner < 4; ++corner) {
      const int other = m_neighbours(corner, t);
      if (other < 0) continue;
      // Computed from the lower tet, so that both sides hold the same bits and no water is lost between them.
      const int first = std::min(t, other);
      int its_corner = corner;
      if (first != t)
        for (its_corner = 0; m_neighbours(its_corner, first) != t;) ++its_corner;
      m_conductance(corner, t) =
          params.diffusivity * compute_transmissibility(mesh, first, its_corner, first == t ? other : t);
    }
  m_monotone_step = std::numeric_limits<double>::infinity();
  for (int t = 0; t < mesh.num_tets(); ++t) {
    const double sum = m_conductance.col(t).sum();
    if (sum > 0.0) m_monotone_step = std::min(m_monotone_step, m_volume(t) / sum);
    if (m_saturation(t) > 0.0) activate_around(t);
  }
  m_initial = mass();
}

void PoreWater::activate(int tet) {
  char& active = m_is_active[static_cast<std::size_t>(tet)];
  if (active) return;
  active = 1;
  m_active.push_back(tet);
}

void PoreWater::activate_around(int tet) {
  activate(tet);
  for (int corner = 0; corner < 4; ++corner)
    if (m_neighbours(corner, tet) >= 0) activate(m_neighbours(corner, tet));
}

/// Adds `mass` (negative: takes it) as far as the tet can hold or has it, and books what really moved.
void PoreWater::give(int tet, double mass) {
  const double before = m_saturation(tet);
  const double after = std::clamp(before + mass / m_capacity(tet), 0.0, 1.0);
  const double moved = m_capacity(tet) * (after - before);
  m_saturation(tet) = after;
  if (moved > 0.0) m_added.add(moved);
  if (moved < 0.0) m_removed.add(-moved);
  if (after > 0.0) activate_around(tet);
}

void PoreWater::exchange(std::span<const int> triangle, std::span<const double> area, int sign,
                         double step_s) {
  if (m_params.uptake == UptakeForm::flux) {
    const double flux = sign > 0 ? m_params.wetting_flux : -m_params.drying_flux;
    for (std::size_t i = 0; i < triangle.size(); ++i)
      give(m_boundary_tet[static_cast<std::size_t>(triangle[i])], flux * area[i] * step_s);
    return;
  }
  m_touched.clear();
  for (const int face : triangle) m_touched.push_back(m_boundary_tet[static_cast<std::size_t>(face)]);
  std::sort(m_touched.begin(), m_touched.end());
  m_touched.erase(std::unique(m_touched.begin(), m_touched.end()), m_touched.end());
  for (const int tet : m_touched) give(tet, sign * m_params.saturation_increment * m_capacity(tet));
}

int PoreWater::diffuse(double step_s) {
  if (m_active.empty() || !(m_params.diffusivity > 0.0)) return 0;
  const int substeps = std::max(1, static_cast<int>(std::ceil(step_s / (kLimitShare * m_monotone_step))));
  const double h = step_s / substeps;
  for (int substep = 0; substep < substeps; ++substep) {
    // A flow seen from its two sides differs in sign only, bit for bit; so the order of the tets does not
    // matter.
    for (const int t : m_active) {
      double flow = 0.0;
      for (int corner = 0; corner < 4; ++corner) {
        const int other = m_neighbours(corner, t);
        if (other >= 0) flow += m_conductance(corner, t) * (m_saturation(other) - m_saturation(t));
      }
      m_flow(t) = flow;
    }
    const std::size_t num_active = m_active.size();
    for (std::size_t i = 0; i < num_active; ++i) {
      const int t = m_active[i];
      const bool was_dry = !(m_saturation(t) > 0.0);
      m_saturation(t) += h * m_flow(t) / m_volume(t);
      if (was_dry && m_saturation(t) > 0.0) activate_around(t);
    }
  }
  return substeps;
}

void PoreWater::collect_changed(double tolerance, std::vector<int>& tets) {
  tets.clear();
  if (m_all_pending) {
    for (int t = 0; t < m_saturation.size(); ++t) tets.push_back(t);
    m_all_pending = false;
  } else {
    for (const int t : m_active)
      if (std::abs(m_saturation(t) - m_collected(t)) > tolerance) tets.push_back(t);
    std::sort(tets.begin(), tets.end());
  }
  for (const int t : tets) m_collected(t) = m_saturation(t);
}

double PoreWater::mass() const {
  CompensatedSum sum;
  for (Eigen::Index t = 0; t < m_saturation.size(); ++t) sum.add(m_capacity(t) * m_saturation(t));
  return sum.value();
}

WaterLedger PoreWater::ledger() const {
  return {m_initial, m_added.value(), m_removed.value()};
}

double PoreWater::ledger_error() const {
  return (mass() - m_initial - m_added.value() + m_removed.value()) / m_capacity.sum();
}

}  // namespace argil::water
