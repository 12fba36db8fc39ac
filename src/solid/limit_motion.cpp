#include "solid/limit_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "solid/body.h"

namespace argil::solid {

MotionLimiter::MotionLimiter(const Body& body)
    : m_body(body),
      m_share(static_cast<std::size_t>(body.model.elements.num_nodes()), 1.0),
      m_is_listed(std::max(m_share.size(), static_cast<std::size_t>(body.model.elements.num_tets()))),
      m_is_held(static_cast<std::size_t>(body.model.elements.num_tets())) {
  m_tets.reserve(m_is_held.size());
  m_nodes.reserve(m_share.size());
  m_held_nodes.reserve(m_share.size());
}

void MotionLimiter::find_tets(const Part& part) {
  const int num_tets = m_body.model.elements.num_tets();
  m_tets.clear();
  if (const std::vector<int>* batches = part.batches.list()) {
    for (const int batch : *batches)
      for (int tet = batch * kLanes; tet < std::min((batch + 1) * kLanes, num_tets); ++tet)
        m_tets.push_back(tet);
  } else {
    m_tets.resize(static_cast<std::size_t>(num_tets));
    std::iota(m_tets.begin(), m_tets.end(), 0);
  }
}

void MotionLimiter::find_tets_around(const std::vector<int>& nodes) {
  const Elements& elements = m_body.model.elements;
  m_tets.clear();
  for (const int node : nodes) {
    const auto n = static_cast<std::size_t>(node);
    for (int i = elements.node_begin[n]; i < elements.node_begin[n + 1]; ++i) {
      const int tet = elements.node_corners[static_cast<std::size_t>(i)] / elements.nodes_per_tet;
      char& is_listed = m_is_listed[static_cast<std::size_t>(tet)];
      if (is_listed != 0) continue;
      is_listed = 1;
      m_tets.push_back(tet);
    }
  }
  for (const int tet : m_tets) m_is_listed[static_cast<std::size_t>(tet)] = 0;
}

Vec3 MotionLimiter::find_place(const SolidState& state, Eigen::Index node, double share) const {
  const Vec3 from = m_body.committed.x.col(node);
  const Vec3 to = state.x.col(node);
  if (share == 1.0) return to;
  const auto is_prescribed = m_body.model.constraints.support.col(node).array() >= 0;
  const Vec3 place = share == 0.0 ? from : Vec3(from + share * (to - from));  // also where `to` is no number
  return is_prescribed.select(to, place);
}

void MotionLimiter::hold_back(Eigen::Index node, double share, SolidState& state) const {
  state.x.col(node) = find_place(state, node, share);
  state.v.col(node) = share == 0.0 ? Vec3::Zero() : Vec3(share * state.v.col(node));
}

double MotionLimiter::find_margin(const SolidState& state, int tet) const {
  const Elements& elements = m_body.model.elements;
  const Eigen::Matrix3Xd& gradient = m_body.materials.gradient();
  constexpr double kFlattest = 0.05;
  constexpr double kMostDeformed = 0.5;
  constexpr double kRounding = 1e-9;
  const double bound = m_body.model.params.min_volume_ratio;
  double least = std::numeric_limits<double>::infinity();
  for (int p = tet * elements.points_per_tet; p < (tet + 1) * elements.points_per_tet; ++p) {
    Mat3 before = Mat3::Zero();
    Mat3 after = Mat3::Zero();
    Eigen::Matrix<double, 3, 10> of_nodes;
    if (elements.nodes_per_tet == 4)
      of_nodes.leftCols<4>() = find_node_gradients<4>(gradient, p);
    else
      of_nodes = find_node_gradients<10>(gradient, p);
    for (int i = 0; i < elements.nodes_per_tet; ++i) {
      const int node = elements.nodes(i, tet);
      const auto at = of_nodes.col(i).transpose();
      before += m_body.committed.x.col(node) * at;
      after += find_place(state, node, m_share[static_cast<std::size_t>(node)]) * at;
    }
    const double kept = (1.0 - kRounding) * (before.determinant() - bound);
    const double margin = after.determinant() - bound - std::min(kept, kFlattest);
    if (!(margin >= least)) least = margin;
    const double deformed = (after * before.inverse() - Mat3::Identity()).norm();
    if (!(kMostDeformed - deformed >= least)) least = kMostDeformed - deformed;
  }
  return least;
}

MotionLimit MotionLimiter::apply(const Part& part, SolidState& state) {
  constexpr int kHalvings = 12;                // then a node stays where it is
  constexpr int kMostRounds = 40 * kHalvings;  // each reaches one layer of tets farther
  MotionLimit limit;
  double least_margin = 0.0;
  m_held_nodes.clear();
  find_tets(part);
  for (int round = 0; round < kMostRounds; ++round) {
    m_nodes.clear();
    for (const int tet : m_tets) {
      const double margin = find_margin(state, tet);
      if (margin >= 0.0) continue;
      char& is_held = m_is_held[static_cast<std::size_t>(tet)];
      if (is_held == 0) ++limit.num_tets;
      is_held = 1;
      if (round == 0 && !(margin >= least_margin)) {
        least_margin = margin;
        limit.worst_tet = m_body.model.elements.number_of_point(tet * m_body.model.elements.points_per_tet);
      }
      for (int i = 0; i < m_body.model.elements.nodes_per_tet; ++i) {
        const int node = m_body.model.elements.nodes(i, tet);
        char& is_listed = m_is_listed[static_cast<std::size_t>(node)];
        if (is_listed != 0 || m_share[static_cast<std::size_t>(node)] == 0.0) continue;
        is_listed = 1;
        m_nodes.push_back(node);
      }
    }
    if (m_nodes.empty()) break;
    for (const int node : m_nodes) {
      double& share = m_share[static_cast<std::size_t>(node)];
      m_is_listed[static_cast<std::size_t>(node)] = 0;
      if (share == 1.0) m_held_nodes.push_back(node);
      share = share > std::ldexp(1.0, -kHalvings) ? 0.5 * share : 0.0;
    }
    find_tets_around(m_nodes);
  }
  for (const int node : m_held_nodes) {
    double& share = m_share[static_cast<std::size_t>(node)];
    hold_back(node, share, state);
    share = 1.0;
  }
  std::fill(m_is_held.begin(), m_is_held.end(), char{0});
  return limit;
}

void MotionLimiter::scale(const Part& part, double share, SolidState& state) const {
  part.nodes.each(state.x.cols(), [&](std::ptrdiff_t n) { hold_back(n, share, state); });
}

}  // namespace argil::solid
