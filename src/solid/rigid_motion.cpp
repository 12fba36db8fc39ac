// Where every tet keeps its shape, each part of the body that faces hold together moves as a rigid body: six
// unknowns a part. Supports and shared vertices are linear equations between them; what these leave is a
// motion without strain.

#include "solid/rigid_motion.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

namespace argil::solid {
namespace {

using Rows = Eigen::Matrix<double, 3, 6>;  // a node's displacement by its part's motion

constexpr double kZero = 1e-12;  // a squared sine: supports this close to a line do not hold

/// What moves as one: tets joined by faces.
struct Part {
  std::vector<int> nodes;  // increasing
  Vec3 centre = Vec3::Zero();
  double size = 1.0;     // [m]; rotations are counted in it, so that they weigh like translations
  bool is_held = false;  // supports and held parts leave it no motion

  Rows rows(const Vec3& x) const {
    const Vec3 arm = (x - centre) / size;
    Rows rows = Rows::Zero();
    for (int k = 0; k < 3; ++k)
      rows.row(k) << Vec3::Unit(k).transpose(), arm.cross(Vec3::Unit(k)).transpose();
    return rows;  // e·(ω×a) = ω·(a×e)
  }
};

std::vector<Part> find_parts(const Elements& elements, const mesh::Topology& topology) {
  std::vector<Part> parts;
  std::vector<bool> is_done(static_cast<std::size_t>(elements.num_tets()), false);
  for (int first = 0; first < elements.num_tets(); ++first) {
    if (is_done[static_cast<std::size_t>(first)]) continue;
    Part& part = parts.emplace_back();
    std::vector<int> front = {first};
    is_done[static_cast<std::size_t>(first)] = true;
    while (!front.empty()) {
      const int tet = front.back();
      front.pop_back();
      for (const int node : elements.nodes.col(tet)) part.nodes.push_back(node);
      for (int k = 0; k < 4; ++k) {
        const int next = topology.neighbours(k, tet);
        if (next < 0 || is_done[static_cast<std::size_t>(next)]) continue;
        is_done[static_cast<std::size_t>(next)] = true;
        front.push_back(next);
      }
    }
    std::sort(part.nodes.begin(), part.nodes.end());
    part.nodes.erase(std::unique(part.nodes.begin(), part.nodes.end()), part.nodes.end());
    for (const int n : part.nodes)
      part.centre += elements.rest.col(n) / static_cast<double>(part.nodes.size());
    part.size = 0.0;
    for (const int n : part.nodes)
      part.size = std::max(part.size, (elements.rest.col(n) - part.centre).norm());
  }
  return parts;
}

/// Parts around each node.
std::vector<std::vector<int>> find_parts_of_nodes(const std::vector<Part>& parts, Eigen::Index num_nodes) {
  std::vector<std::vector<int>> found(static_cast<std::size_t>(num_nodes));
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (const int n : parts[p].nodes) found[static_cast<std::size_t>(n)].push_back(static_cast<int>(p));
  return found;
}

/// The equations of one node: held components, and all three where a held part has it.
Mat6 compute_normal_matrix(const Part& part, const Vec3& x, const Eigen::Vector3i& support, bool is_held) {
  const Rows rows = part.rows(x);
  Mat6 sum = Mat6::Zero();
  for (int k = 0; k < 3; ++k)
    if (is_held || support(k) >= 0) sum += rows.row(k).transpose() * rows.row(k);
  return sum;
}

/// Marks the parts that supports, or parts already held, hold by themselves. Nearly always that is all.
void hold_parts(const Elements& elements, const Constraints& constraints,
                const std::vector<std::vector<int>>& parts_of_node, std::vector<Part>& parts) {
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (Part& part : parts) {
      if (part.is_held) continue;
      Mat6 sum = Mat6::Zero();
      for (const int n : part.nodes) {
        const auto& around = parts_of_node[static_cast<std::size_t>(n)];
        const bool is_held = std::any_of(around.begin(), around.end(),
                                         [&](int p) { return parts[static_cast<std::size_t>(p)].is_held; });
        sum += compute_normal_matrix(part, elements.rest.col(n), constraints.support.col(n), is_held);
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(sum);
      part.is_held = modes.eigenvalues()(0) > kZero * std::max(1.0, modes.eigenvalues()(5));
      has_changed = has_changed || part.is_held;
    }
  }
}

/// Three decimals are enough to find a direction by.
std::string print_vector(const Vec3& a) {
  std::ostringstream text;
  for (int k = 0; k < 3; ++k) text << (k > 0 ? ", " : "(") << std::round(a(k) * 1e3) / 1e3 + 0.0;
  text << ')';
  return text.str();
}

std::string describe_motion(const std::string& who, const Part& part,
                            const Eigen::Matrix<double, 6, 1>& mode) {
  const Vec3 shift = mode.head<3>();
  const Vec3 turn = mode.tail<3>();
  if (!(turn.norm() > 0.5 * shift.norm()))
    return who + " can shift along " + print_vector(shift.normalized());
  const Vec3 on_axis = part.centre + part.size * turn.cross(shift) / turn.squaredNorm();
  return who + " can turn about an axis along " + print_vector(turn.normalized()) + " near " +
         print_vector(on_axis) + " m";
}

/// Loose parts that share vertices with each other, by the way of others too; each in order of number.
std::vector<std::vector<int>> find_groups(const std::vector<Part>& parts,
                                          const std::vector<std::vector<int>>& parts_of_node) {
  std::vector<std::vector<int>> groups;
  std::vector<bool> is_done(parts.size(), false);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (is_done[p] || parts[p].is_held) continue;
    std::vector<int>& group = groups.emplace_back(1, static_cast<int>(p));
    is_done[p] = true;
    for (std::size_t i = 0; i < group.size(); ++i)
      for (const int n : parts[static_cast<std::size_t>(group[i])].nodes)
        for (const int q : parts_of_node[static_cast<std::size_t>(n)]) {
          const auto other = static_cast<std::size_t>(q);
          if (is_done[other] || parts[other].is_held) continue;
          is_done[other] = true;
          group.push_back(q);
        }
    std::sort(group.begin(), group.end());
  }
  return groups;
}

/// A motion that is left to loose parts, which may hold each other, as the three legs of a tripod do.
std::string find_motion_of(const std::vector<int>& group, const Elements& elements,
                           const Constraints& constraints, const std::vector<Part>& parts,
                           const std::vector<std::vector<int>>& parts_of_node) {
  std::map<int, Eigen::Index> place;  // of a part's six unknowns
  std::set<int> nodes;
  for (const int p : group) {
    place.emplace(p, 6 * static_cast<Eigen::Index>(place.size()));
    const Part& part = parts[static_cast<std::size_t>(p)];
    nodes.insert(part.nodes.begin(), part.nodes.end());
  }
  const auto size = 6 * static_cast<Eigen::Index>(group.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
  for (const int n : nodes) {
    const Vec3 x = elements.rest.col(n);
    const auto& around = parts_of_node[static_cast<std::size_t>(n)];
    const bool is_held = std::any_of(around.begin(), around.end(),
                                     [&](int p) { return parts[static_cast<std::size_t>(p)].is_held; });
    Eigen::Index first = -1;  // place of the part that the others are joined to
    Rows first_rows;
    for (const int p : around) {
      const auto found = place.find(p);
      if (found == place.end()) continue;
      const Eigen::Index own = found->second;
      const Part& part = parts[static_cast<std::size_t>(p)];
      sum.block<6, 6>(own, own) += compute_normal_matrix(part, x, constraints.support.col(n), is_held);
      const Rows rows = part.rows(x);
      if (first < 0) {
        first = own;
        first_rows = rows;
        continue;
      }
      sum.block<6, 6>(own, own) += rows.transpose() * rows;
      sum.block<6, 6>(first, first) += first_rows.transpose() * first_rows;
      sum.block<6, 6>(own, first) -= rows.transpose() * first_rows;
      sum.block<6, 6>(first, own) -= first_rows.transpose() * rows;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(sum);
  const double zero = kZero * std::max(1.0, modes.eigenvalues()(size - 1));
  const auto num_free = (modes.eigenvalues().array() <= zero).count();
  if (num_free == 0) return {};
  const Eigen::VectorXd mode = modes.eigenvectors().col(0);
  std::size_t mover = 0;
  for (std::size_t i = 0; i < group.size(); ++i)
    if (mode.segment<6>(6 * static_cast<Eigen::Index>(i)).norm() >
        (1.0 + 1e-6) * mode.segment<6>(6 * static_cast<Eigen::Index>(mover)).norm())
      mover = i;
  const Part& part = parts[static_cast<std::size_t>(group[mover])];
  const std::string who =
      parts.size() == 1 ? "the body" : "the part with node " + std::to_string(part.nodes.front());
  std::string text = describe_motion(who, part, mode.segment<6>(6 * static_cast<Eigen::Index>(mover)));
  if (num_free > 1) text += ", one of " + std::to_string(num_free) + " free motions";
  return text;
}

}  // namespace

std::string find_rigid_motion(const Elements& elements, const mesh::Topology& topology,
                              const Constraints& constraints) {
  std::vector<Part> parts = find_parts(elements, topology);
  const auto parts_of_node = find_parts_of_nodes(parts, elements.num_nodes());
  hold_parts(elements, constraints, parts_of_node, parts);
  for (const std::vector<int>& group : find_groups(parts, parts_of_node))
    if (std::string motion = find_motion_of(group, elements, constraints, parts, parts_of_node);
        !motion.empty())
      return motion;
  return {};
}

}  // namespace argil::solid
