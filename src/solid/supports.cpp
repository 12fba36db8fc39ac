#include "solid/supports.h"

#include <algorithm>
#include <cmath>

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

Constraints find_constraints(const Points& rest, std::span<const Support> supports) {
  Constraints constraints;
  constraints.support.setConstant(3, rest.cols(), -1);
  for (std::size_t s = 0; s < supports.size(); ++s)
    for (const int node : find_nodes(rest, std::span(&supports[s].region, 1)))
      for (int k = 0; k < 3; ++k)
        if (supports[s].fixes[static_cast<std::size_t>(k)])
          constraints.support(k, node) = static_cast<int>(s);
  return constraints;
}

Vec3 compute_displacement(const Support& support, double time) {
  const double length = support.ramp_end - support.ramp_start;
  if (!(length > 0.0)) return time >= support.ramp_start ? support.displacement : Vec3(Vec3::Zero());
  return std::clamp((time - support.ramp_start) / length, 0.0, 1.0) * support.displacement;
}

}  // namespace argil::solid
