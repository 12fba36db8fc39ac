// Where every tet keeps its shape, each part of the body that faces hold together moves as a rigid body: six
// unknowns a part. Supports and shared vertices are linear equations between them; what these leave is a
// motion without strain.

#include "solid/rigid_motion.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <sstream>
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
      const Eigen::SelfAdjointEigenSolver<Mat6> modes(sum);
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

std::string describe_motion(const Part& part, const Eigen::Matrix<double, 6, 1>& mode) {
  const Vec3 shift = mode.head<3>();
  const Vec3 turn = mode.tail<3>();
  const std::string who = "the part with node " + std::to_string(part.nodes.front()) + " can ";
  if (!(turn.norm() > 0.5 * shift.norm())) return who + "shift along " + print_vector(shift.normalized());
  const Vec3 on_axis = part.centre + part.size * turn.cross(shift) / turn.squaredNorm();
  return who + "turn about an axis along " + print_vector(turn.normalized()) + " near " +
         print_vector(on_axis) + " m";
}

}  // namespace

std::string find_rigid_motion(const Elements& elements, const mesh::Topology& topology,
                              const Constraints& constraints) {
  std::vector<Part> parts = find_parts(elements, topology);
  const auto parts_of_node = find_parts_of_nodes(parts, elements.num_nodes());
  hold_parts(elements, constraints, parts_of_node, parts);
  std::vector<int> loose;  // parts
  std::vector<Eigen::Index> place(parts.size(), -1);
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (!parts[p].is_held) {
      place[p] = 6 * static_cast<Eigen::Index>(loose.size());
      loose.push_back(static_cast<int>(p));
    }
  if (loose.empty()) return {};

  // The loose parts may still hold each other, as the three legs of a tripod do.
  const auto size = 6 * static_cast<Eigen::Index>(loose.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
  for (int n = 0; n < elements.num_nodes(); ++n) {
    const Vec3 x = elements.rest.col(n);
    const auto& around = parts_of_node[static_cast<std::size_t>(n)];
    const bool is_held = std::any_of(around.begin(), around.end(),
                                     [&](int p) { return parts[static_cast<std::size_t>(p)].is_held; });
    Eigen::Index first = -1;  // place of the part that the others are joined to
    Rows first_rows;
    for (const int p : around) {
      const Eigen::Index own = place[static_cast<std::size_t>(p)];
      if (own < 0) continue;
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
  if (modes.eigenvalues()(0) > kZero * std::max(1.0, modes.eigenvalues()(size - 1))) return {};
  const Eigen::VectorXd mode = modes.eigenvectors().col(0);
  std::size_t mover = 0;
  for (std::size_t i = 0; i < loose.size(); ++i)
    if (mode.segment<6>(6 * static_cast<Eigen::Index>(i)).norm() >
        (1.0 + 1e-6) * mode.segment<6>(6 * static_cast<Eigen::Index>(mover)).norm())
      mover = i;
  return describe_motion(parts[static_cast<std::size_t>(loose[mover])],
                         mode.segment<6>(6 * static_cast<Eigen::Index>(mover)));
}

}  // namespace argil::solid
