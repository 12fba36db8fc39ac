#include "embed/tet_locator.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/check.h"

namespace argil::embed {
namespace {

constexpr double kWeightTolerance = 1e-10;  // round-off of a weight in a tet of the worst shape we accept
constexpr double kMaxBoxes = 2e7;
// Of a tet's extent: a point farther out has a weight below −kBoundsMargin/3, far beyond round-off.
constexpr double kBoundsMargin = 1e-3;

bool is_within(const std::array<Vec3, 2>& bounds, const Vec3& x) {
  for (int k = 0; k < 3; ++k)
    if (x(k) < bounds[0](k) || x(k) > bounds[1](k)) return false;
  return true;
}

TetLocator::Place bend_place(const mesh::CurvedTets& curved, const TetLocator::Place& straight,
                             const Vec3& x) {
  const mesh::QuadraticNodes* nodes = straight.tet < 0 ? nullptr : curved.find(straight.tet);
  return nodes ? TetLocator::Place{straight.tet, mesh::find_in_tet(*nodes, x, straight.weights)} : straight;
}

}  // namespace

Vec4 compute_barycentric_weights(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& x) {
  const Vec3 u = b - a;
  const Vec3 v = c - a;
  const Vec3 w = d - a;
  const Vec3 y = x - a;
  const double volume = u.dot(v.cross(w));
  const double wb = y.dot(v.cross(w)) / volume;
  const double wc = y.dot(w.cross(u)) / volume;
  const double wd = y.dot(u.cross(v)) / volume;
  return {1.0 - wb - wc - wd, wb, wc, wd};
}

TetLocator::TetLocator(const mesh::TetMesh& mesh)
    : m_vertices(mesh.vertices), m_tets(mesh.tets), m_curved(mesh) {
  ARGIL_ASSERT(mesh.num_tets() > 0);
  m_lower = m_vertices.rowwise().minCoeff();
  const Vec3 extent = m_vertices.rowwise().maxCoeff() - m_lower;
  double sum = 0.0;  // of the tets' largest extents
  m_bounds.resize(static_cast<std::size_t>(mesh.num_tets()));
  for (int t = 0; t < mesh.num_tets(); ++t) {
    auto& [low, high] = m_bounds[static_cast<std::size_t>(t)];
    low = high = m_vertices.col(m_tets(0, t));
    for (int i = 1; i < 4; ++i) {
      low = low.cwiseMin(m_vertices.col(m_tets(i, t)));
      high = high.cwiseMax(m_vertices.col(m_tets(i, t)));
    }
    sum += (high - low).maxCoeff();
  }
  m_box_size = std::max(sum / mesh.num_tets(), std::cbrt(extent.prod() / kMaxBoxes));
  ARGIL_ASSERT(m_box_size > 0.0);
  for (std::size_t axis = 0; axis < 3; ++axis)
    m_counts[axis] = 1 + static_cast<int>(extent(static_cast<Eigen::Index>(axis)) / m_box_size);
  const auto visit = [this](auto&& action) {
    for (std::size_t t = 0; t < m_bounds.size(); ++t) {
      const std::array<int, 3> low = box(m_bounds[t][0]);
      const std::array<int, 3> high = box(m_bounds[t][1]);
      for (int k = low[2]; k <= high[2]; ++k)
        for (int j = low[1]; j <= high[1]; ++j)
          for (int i = low[0]; i <= high[0]; ++i)
            action(static_cast<std::size_t>(i + m_counts[0] * (j + m_counts[1] * k)), static_cast<int>(t));
    }
  };
  m_begin.assign(static_cast<std::size_t>(m_counts[0] * m_counts[1] * m_counts[2]) + 1, 0);
  visit([this](std::size_t b, int) { ++m_begin[b + 1]; });
  for (std::size_t b = 1; b < m_begin.size(); ++b) m_begin[b] += m_begin[b - 1];
  m_list.resize(static_cast<std::size_t>(m_begin.back()));
  std::vector<int> next(m_begin.begin(), m_begin.end() - 1);
  visit([this, &next](std::size_t b, int t) { m_list[static_cast<std::size_t>(next[b]++)] = t; });
  for (auto& [low, high] : m_bounds) {
    const Vec3 margin = kBoundsMargin * (high - low);
    low -= margin;
    high += margin;
  }
}

std::array<int, 3> TetLocator::box(const Vec3& x) const {
  std::array<int, 3> result{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const double place = std::floor((x(a) - m_lower(a)) / m_box_size);
    result[axis] = static_cast<int>(std::clamp(place, 0.0, static_cast<double>(m_counts[axis] - 1)));
  }
  return result;
}

std::size_t TetLocator::box_index(const Vec3& x) const {
  const std::array<int, 3> b = box(x);
  return static_cast<std::size_t>(b[0] + m_counts[0] * (b[1] + m_counts[1] * b[2]));
}

Vec4 TetLocator::compute_weights(int tet, const Vec3& x) const {
  return compute_barycentric_weights(m_vertices.col(m_tets(0, tet)), m_vertices.col(m_tets(1, tet)),
                                     m_vertices.col(m_tets(2, tet)), m_vertices.col(m_tets(3, tet)), x);
}

TetLocator::Place TetLocator::find(const Vec3& x) const {
  return bend_place(m_curved, find_straight(x), x);
}

TetLocator::Place TetLocator::find_straight(const Vec3& x) const {
  const std::size_t index = box_index(x);
  for (int i = m_begin[index]; i < m_begin[index + 1]; ++i) {
    const int t = m_list[static_cast<std::size_t>(i)];
    if (!is_within(m_bounds[static_cast<std::size_t>(t)], x)) continue;  // of small tets a box lists hundreds
    const Vec4 weights = compute_weights(t, x);
    if (weights.minCoeff() >= -kWeightTolerance) return {t, weights};
  }
  return {};
}

TetLocator::Place TetLocator::find_near(const Vec3& x, double beyond) const {
  Place near = find_straight(x);
  if (near.tet >= 0) return bend_place(m_curved, near, x);
  const std::size_t index = box_index(x);
  double highest = -beyond;
  for (int i = m_begin[index]; i < m_begin[index + 1]; ++i) {
    const int t = m_list[static_cast<std::size_t>(i)];
    const Vec4 weights = compute_weights(t, x);
    if (weights.minCoeff() < highest || (near.tet >= 0 && weights.minCoeff() == highest)) continue;
    highest = weights.minCoeff();
    near = {t, weights};
  }
  return bend_place(m_curved, near, x);
}

BoundaryTets::BoundaryTets(const mesh::TetMesh& mesh, const mesh::Topology& topology)
    : m_vertices(mesh.vertices),
      m_tets(mesh.tets),
      m_boundary_tet(topology.boundary_tet),
      m_boundary({mesh.vertices, topology.boundary}),
      m_curved(mesh) {}

TetLocator::Place BoundaryTets::find(const Vec3& x, double most_beyond, double farthest) const {
  const TriangleTree::Nearest nearest = m_boundary.find_nearest(x, farthest);
  if (nearest.triangle < 0) return {};
  const int tet = m_boundary_tet[static_cast<std::size_t>(nearest.triangle)];
  std::array<Vec3, 4> corner;
  for (std::size_t i = 0; i < 4; ++i) corner[i] = m_vertices.col(m_tets(static_cast<Eigen::Index>(i), tet));
  double longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) longest = std::max(longest, (corner[j] - corner[i]).norm());
  if (!(nearest.distance <= most_beyond * longest)) return {};
  return bend_place(m_curved,
                    {tet, compute_barycentric_weights(corner[0], corner[1], corner[2], corner[3], x)}, x);
}

}  // namespace argil::embed
