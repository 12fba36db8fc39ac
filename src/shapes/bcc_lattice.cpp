#include "shapes/bcc_lattice.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace argil::shapes {
namespace {

// A node moves onto a cut that lies nearer than this fraction of the edge. The pair guarantees dihedral
// angles between 10.78 and 164.74 degrees on a uniform lattice [Labelle2007, §4].
constexpr double kSnapLong = 0.24999;
constexpr double kSnapShort = 0.41189;
double snap_fraction(int direction) {
  return is_long_edge(direction) ? kSnapLong : kSnapShort;
}

const double kShortLength = 0.5 * std::sqrt(3.0);  // of a short edge, in cube edges

// Cuts are refined to this fraction of an edge: far below what a triangle's flatness costs.
constexpr double kCutTolerance = 1e-11;
constexpr int kCutIterations = 80;

LatticePlace step(const LatticePlace& place, int direction) {
  const LatticePlace& d = kLatticeEdges[static_cast<std::size_t>(direction)];
  return {place[0] + d[0], place[1] + d[1], place[2] + d[2]};
}

// Root of value on the segment a–b as a fraction from a: regula falsi with the Illinois rule (the end that
// stays counts half), which also closes in on a kink or a jump.
double find_root_fraction(const ImplicitSurface& surface, const Vec3& a, const Vec3& b, double value_a,
                          double value_b) {
  double low = 0.0;
  double high = 1.0;
  double f_low = value_a;
  double f_high = value_b;
  double t_before = -1.0;
  int kept_end = 0;
  for (int i = 0; i < kCutIterations; ++i) {
    const double t = std::clamp(low + (high - low) * (f_low / (f_low - f_high)), low, high);
    if (std::abs(t - t_before) <= kCutTolerance) return t;
    t_before = t;
    const double f = surface.value((1.0 - t) * a + t * b);
    if (f == 0.0) return t;
    if ((f < 0.0) == (value_a < 0.0)) {
      low = t;
      f_low = f;
      if (kept_end == 1) f_high *= 0.5;
      kept_end = 1;
    } else {
      high = t;
      f_high = f;
      if (kept_end == -1) f_low *= 0.5;
      kept_end = -1;
    }
  }
  return t_before;
}

}  // namespace

BccLattice::BccLattice(const ImplicitSurface& surface, double cell_size) : m_cell_size(cell_size) {
  ARGIL_ASSERT(cell_size > 0.0 && std::isfinite(cell_size), cell_size);
  const Vec3 centre = 0.5 * (surface.lower + surface.upper);
  double num_nodes = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = 0.5 * (surface.upper(axis) - surface.lower(axis)) / cell_size;
    ARGIL_ASSERT(half >= 0.0 && half < 1e6, axis, half);
    const int cells = static_cast<int>(std::ceil(half)) + 1;
    m_cells[static_cast<std::size_t>(axis)] = 2 * cells;
    m_origin(axis) = centre(axis) - cells * cell_size;
    num_nodes *= 2 * cells + 1;
  }
  ARGIL_ASSERT(num_nodes < 1e9, num_nodes, cell_size);
  m_num_corners = (m_cells[0] + 1) * (m_cells[1] + 1) * (m_cells[2] + 1);
}

int BccLattice::node(const LatticePlace& p) const {
  if (p[0] % 2 == 0) return p[0] / 2 + (m_cells[0] + 1) * (p[1] / 2 + (m_cells[1] + 1) * (p[2] / 2));
  return m_num_corners + p[0] / 2 + m_cells[0] * (p[1] / 2 + m_cells[1] * (p[2] / 2));
}

LatticePlace BccLattice::place(int node) const {
  const bool is_corner = node < m_num_corners;
  const int index = is_corner ? node : node - m_num_corners;
  const int nx = is_corner ? m_cells[0] + 1 : m_cells[0];
  const int ny = is_corner ? m_cells[1] + 1 : m_cells[1];
  const int odd = is_corner ? 0 : 1;
  return {2 * (index % nx) + odd, 2 * (index / nx % ny) + odd, 2 * (index / nx / ny) + odd};
}

Vec3 BccLattice::position(const LatticePlace& p) const {
  return m_origin + (0.5 * m_cell_size) * Vec3(p[0], p[1], p[2]);
}

bool BccLattice::contains(const LatticePlace& p) const {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (p[axis] < 0 || p[axis] > 2 * m_cells[axis]) return false;
  return true;  // an odd place inside these bounds is a centre inside the box
}

CutLattice::CutLattice(const ImplicitSurface& surface, double cell_size) : m_lattice(surface, cell_size) {
  Field value(m_lattice.num_nodes());
  classify_nodes(surface, value);
  find_cuts(surface, value);
  m_is_kept.assign(m_side.size(), false);
  snap_nodes();
}

int CutLattice::neighbour(int node, int direction) const {
  const LatticePlace place = step(m_lattice.place(node), direction);
  return m_lattice.contains(place) ? m_lattice.node(place) : -1;
}

void CutLattice::classify_nodes(const ImplicitSurface& surface, Field& value) {
  const int num_nodes = m_lattice.num_nodes();
  m_is_inside.resize(static_cast<std::size_t>(num_nodes));
  m_side.resize(static_cast<std::size_t>(num_nodes));
  for (int node = 0; node < num_nodes; ++node) {
    const LatticePlace place = m_lattice.place(node);
    value(node) = surface.value(m_lattice.position(place));
    ARGIL_ASSERT(!std::isnan(value(node)), node);
    m_is_inside[static_cast<std::size_t>(node)] = value(node) <= 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool is_rim = place[axis] <= 1 || place[axis] >= 2 * m_lattice.num_cells()[axis] - 1;
      ARGIL_ASSERT(!is_rim || value(node) > 0.0, "the box does not contain the surface", axis, value(node));
    }
  }
}

void CutLattice::find_cuts(const ImplicitSurface& surface, const Field& value) {
  const int num_nodes = m_lattice.num_nodes();
  m_cut_begin.assign(static_cast<std::size_t>(num_nodes) + 1, 0);
  for (int node = 0; node < num_nodes; ++node) {
    m_cut_begin[static_cast<std::size_t>(node)] = num_cuts();
    const LatticePlace place = m_lattice.place(node);
    for (int direction = 0; direction < kForwardEdges; ++direction) {
      const LatticePlace other_place = step(place, direction);
      if (!m_lattice.contains(other_place)) continue;
      const int other = m_lattice.node(other_place);
      if (m_is_inside[static_cast<std::size_t>(node)] == m_is_inside[static_cast<std::size_t>(other)])
        continue;
      const Vec3 a = m_lattice.position(place);
      const Vec3 b = m_lattice.position(other_place);
      const double t = find_root_fraction(surface, a, b, value(node), value(other));
      m_cuts.push_back({direction, t, (1.0 - t) * a + t * b});
      m_cut_nodes.push_back(node);
      m_cut_nodes.push_back(other);
    }
  }
  m_cut_begin.back() = num_cuts();
  std::sort(m_cut_nodes.begin(), m_cut_nodes.end());
  m_cut_nodes.erase(std::unique(m_cut_nodes.begin(), m_cut_nodes.end()), m_cut_nodes.end());
}

int CutLattice::find_cut(int node, int direction) const {
  if (direction >= kForwardEdges) {
    node = neighbour(node, direction);
    direction -= kForwardEdges;
    if (node < 0) return -1;
  }
  for (int i = m_cut_begin[static_cast<std::size_t>(node)];
       i < m_cut_begin[static_cast<std::size_t>(node) + 1]; ++i)
    if (m_cuts[static_cast<std::size_t>(i)].direction == direction) return i;
  return -1;
}

// The nearest of the cuts that are too close to `node` and whose other end has not moved; −1: none.
int CutLattice::find_nearest_cut(int node) const {
  int nearest = -1;
  double nearest_distance = 1.0;  // in cube edges
  for (int direction = 0; direction < 2 * kForwardEdges; ++direction) {
    const int i = find_cut(node, direction);
    if (i < 0 || side(neighbour(node, direction)) == Side::surface) continue;
    const double from_start = m_cuts[static_cast<std::size_t>(i)].fraction;
    const double fraction = direction < kForwardEdges ? from_start : 1.0 - from_start;
    if (fraction >= snap_fraction(direction)) continue;
    const double distance = fraction * (is_long_edge(direction) ? 1.0 : kShortLength);
    if (distance >= nearest_distance) continue;
    nearest = i;
    nearest_distance = distance;
  }
  return nearest;
}

// Nodes are visited in order; a node that moves takes the cuts of its edges with it, as in the paper.
void CutLattice::snap_nodes() {
  for (std::size_t node = 0; node < m_side.size(); ++node)
    m_side[node] = m_is_inside[node] ? Side::inside : Side::outside;
  m_snapped_node.clear();
  m_snapped_cut.clear();
  for (const int node : m_cut_nodes) {
    if (m_is_kept[static_cast<std::size_t>(node)]) continue;
    const int cut = find_nearest_cut(node);
    if (cut < 0) continue;
    m_side[static_cast<std::size_t>(node)] = Side::surface;
    m_snapped_node.push_back(node);
    m_snapped_cut.push_back(cut);
  }
}

void CutLattice::keep_in_place(const std::vector<int>& nodes) {
  for (const int node : nodes) {
    m_is_kept[static_cast<std::size_t>(node)] = true;
    for (int direction = 0; direction < 2 * kForwardEdges; ++direction) {
      const int i = find_cut(node, direction);
      if (i < 0) continue;
      Cut& cut = m_cuts[static_cast<std::size_t>(i)];
      const bool is_forward = direction < kForwardEdges;
      const double fraction = is_forward ? cut.fraction : 1.0 - cut.fraction;
      if (fraction >= snap_fraction(direction)) continue;
      cut.fraction = is_forward ? snap_fraction(direction) : 1.0 - snap_fraction(direction);
      const LatticePlace place = m_lattice.place(node);
      cut.position = (1.0 - snap_fraction(direction)) * m_lattice.position(place) +
                     snap_fraction(direction) * m_lattice.position(step(place, direction));
    }
  }
  snap_nodes();
}

Vec3 CutLattice::position(int node) const {
  if (side(node) != Side::surface) return m_lattice.position(m_lattice.place(node));
  const auto found = std::lower_bound(m_snapped_node.begin(), m_snapped_node.end(), node);
  return cut_position(m_snapped_cut[static_cast<std::size_t>(found - m_snapped_node.begin())]);
}

}  // namespace argil::shapes
