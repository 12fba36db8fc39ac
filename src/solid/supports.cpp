#include "solid/supports.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

namespace argil::solid {
namespace {

bool contains(const Region& region, const Vec3& x) {
  switch (region.kind) {
    case Region::Kind::box:
      return (x.array() >= region.lower.array()).all() && (x.array() <= region.upper.array()).all();
    case Region::Kind::sphere:
      return (x - region.centre).norm() <= region.radius;
    case Region::Kind::half_space:
      return region.normal.dot(x) <= region.offset;
    case Region::Kind::plane:
      return std::abs(region.normal.normalized().dot(x) - region.offset) <= region.thickness;
    case Region::Kind::nodes:
      return false;
  }
  return false;
}

/// Number of the lowest node of each node's connected part.
std::vector<int> find_parts(Eigen::Index num_nodes, const Eigen::MatrixXi& element_nodes) {
  std::vector<int> root(static_cast<std::size_t>(num_nodes));
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&root](int node) {
    while (root[static_cast<std::size_t>(node)] != node) {
      int& up = root[static_cast<std::size_t>(node)];
      up = root[static_cast<std::size_t>(up)];
      node = up;
    }
    return node;
  };
  for (Eigen::Index t = 0; t < element_nodes.cols(); ++t)
    for (Eigen::Index k = 1; k < element_nodes.rows(); ++k) {
      const int a = find(element_nodes(0, t));
      const int b = find(element_nodes(k, t));
      root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  for (int n = 0; n < static_cast<int>(root.size()); ++n) root[static_cast<std::size_t>(n)] = find(n);
  return root;
}

using Mode = Eigen::Matrix<double, 6, 1>;  // translation, then rotation about the part's centre over its size

/// Three decimals are enough to find a direction by.
std::string print_vector(const Vec3& a) {
  std::ostringstream text;
  for (int k = 0; k < 3; ++k) text << (k > 0 ? ", " : "(") << std::round(a(k) * 1e3) / 1e3 + 0.0;
  text << ')';
  return text.str();
}

std::string describe_motion(const Mode& mode, const Vec3& centre) {
  const Vec3 shift = mode.head<3>();
  const Vec3 turn = mode.tail<3>();
  if (turn.norm() > 0.5 * shift.norm())
    return "turn about an axis along " + print_vector(turn.normalized()) + " near " + print_vector(centre) +
           " m";
  return "shift along " + print_vector(shift.normalized());
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

std::string find_rigid_motion(const Points& rest, const Eigen::MatrixXi& element_nodes,
                              const Constraints& constraints) {
  const std::vector<int> part = find_parts(rest.cols(), element_nodes);
  for (int root = 0; root < rest.cols(); ++root) {
    if (part[static_cast<std::size_t>(root)] != root) continue;
    Vec3 centre = Vec3::Zero();
    double count = 0.0;
    for (int n = root; n < rest.cols(); ++n)
      if (part[static_cast<std::size_t>(n)] == root) {
        centre += rest.col(n);
        count += 1.0;
      }
    centre /= count;
    double size = 0.0;
    for (int n = root; n < rest.cols(); ++n)
      if (part[static_cast<std::size_t>(n)] == root) size = std::max(size, (rest.col(n) - centre).norm());
    if (size == 0.0) size = 1.0;
    // Rows of the held components in the six rigid modes; what they leave free is their null space.
    Mat6 normal_matrix = Mat6::Zero();
    for (int n = root; n < rest.cols(); ++n) {
      if (part[static_cast<std::size_t>(n)] != root) continue;
      const Vec3 arm = (rest.col(n) - centre) / size;
      for (int k = 0; k < 3; ++k) {
        if (constraints.support(k, n) < 0) continue;
        Mode row;
        row << Vec3::Unit(k), arm.cross(Vec3::Unit(k));  // e·(ω×a) = ω·(a×e)
        normal_matrix += row * row.transpose();
      }
    }
    const Eigen::JacobiSVD<Mat6> svd(normal_matrix, Eigen::ComputeFullV);
    constexpr double kZero = 1e-12;  // a squared sine: supports this close to a line do not hold
    if (svd.singularValues()(5) > kZero * std::max(1.0, svd.singularValues()(0))) continue;
    return "the part with node " + std::to_string(root) + " can " +
           describe_motion(svd.matrixV().col(5), centre);
  }
  return {};
}

}  // namespace argil::solid
