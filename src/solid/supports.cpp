#include "solid/supports.h"

#include <algorithm>
#include <cmath>

#include "mesh/quadratic.h"
#include "solid/elements.h"

namespace argil::solid {
namespace {

bool contains(const Region& region, const Vec3& x) {
  switch (region.kind) {
    case Region::Kind::box:
      return (x.array() >= region.lower.array()).all() && (x.array() <= region.upper.array()).all();
    case Region::Kind::sphere:
      return (x - region.centre).norm() <= region.radius;
    case Region::Kind::half_space:
      return region.normal.normalized().dot(x) <= region.offset;
    case Region::Kind::plane:
      return std::abs(region.normal.normalized().dot(x) - region.offset) <= region.thickness;
    case Region::Kind::nodes:
      return false;
  }
  return false;
}

/// Adds the nodes in the middle of edges between two of them.
void add_middles(const Elements& elements, std::vector<int>& nodes) {
  if (elements.nodes_per_tet == 4 || nodes.size() < 2) return;
  std::vector<char> is_listed(static_cast<std::size_t>(elements.num_nodes()), 0);
  for (const int node : nodes) is_listed[static_cast<std::size_t>(node)] = 1;
  for (int t = 0; t < elements.num_tets(); ++t)
    for (int k = 0; k < 6; ++k) {
      const auto is_end_listed = [&](int end) {
        return is_listed[static_cast<std::size_t>(elements.nodes(mesh::kTetEdges[k][end], t))] == 1;
      };
      if (is_end_listed(0) && is_end_listed(1)) nodes.push_back(elements.nodes(4 + k, t));
    }
}

}  // namespace

std::vector<int> find_nodes(const Points& rest, std::span<const Region> regions) {
  std::vector<int> found;
  for (const Region& region : regions) {
    found.insert(found.end(), region.nodes.begin(), region.nodes.end());
    for (int v = 0; v < rest.cols(); ++v)
      if (contains(region, rest.col(v))) found.push_back(v);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

Constraints find_constraints(const Elements& elements, std::span<const Support> supports) {
  Constraints constraints;
  constraints.support.setConstant(3, elements.num_nodes(), -1);
  for (std::size_t s = 0; s < supports.size(); ++s) {
    std::vector<int> nodes = find_nodes(elements.rest, std::span(&supports[s].region, 1));
    add_middles(elements, nodes);
    for (const int node : nodes)
      for (int k = 0; k < 3; ++k)
        if (supports[s].fixes[static_cast<std::size_t>(k)])
          constraints.support(k, node) = static_cast<int>(s);
  }
  return constraints;
}

Vec3 compute_displacement(const Support& support, double time) {
  const double length = support.ramp_end - support.ramp_start;
  if (!(length > 0.0)) return time >= support.ramp_start ? support.displacement : Vec3(Vec3::Zero());
  return std::clamp((time - support.ramp_start) / length, 0.0, 1.0) * support.displacement;
}

}  // namespace argil::solid
