// Extent::local: which part of the body a step solves for.

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "solid/solid.h"

namespace argil::solid {
namespace {

constexpr double kStill = 1e-4;      // [m/s]: where nothing is faster, speeds are measured by this
constexpr int kCalmSteps = 8;        // that a run must have been slow before it falls asleep
constexpr double kSleepShare = 0.5;  // of the speed that wakes it, below which a run is slow

/// First row of a run, and the one after its last.
std::pair<std::size_t, std::size_t> find_rows(int run, std::size_t num_rows) {
  const std::size_t begin = static_cast<std::size_t>(run) * OrderedRuns::kLength;
  return {begin, std::min(begin + OrderedRuns::kLength, num_rows)};
}

}  // namespace

void Solid::visit_region() {
  m_rows.visit(&m_region->awake());
  m_near_rows.visit(&m_region->near());
  m_nodes.visit(&m_region->nodes());
  const bool can_visit = m_solver->visit(&m_region->awake());
  ARGIL_ASSERT(can_visit);
}

void Solid::wake_all() {
  if (!m_region) return;
  m_region->wake_all();
  if (m_region->update()) visit_region();
}

void Solid::sleep_all() {
  if (!m_region) return;
  m_region->sleep_all();
  m_has_old_forces = true;
  if (m_region->update()) visit_region();
}

/// Forces that change and contacts wake their nodes, and those around.
void Solid::wake_region(const StepLoads& loads) {
  if (m_last_load.size() == 0) m_last_load.setZero(3, loads.force.cols());
  for (Eigen::Index n = 0; n < loads.force.cols(); ++n)
    if ((loads.force.col(n).array() != m_last_load.col(n).array()).any())
      m_region->wake_node(static_cast<int>(n));
  m_last_load = loads.force;
  for (const PointStiffness& contact : loads.contacts)
    for (std::size_t i = 0; i < contact.count(); ++i) m_region->wake_node(contact.vertex[i]);
  if (m_region->update()) visit_region();
}

/// Rows that awake tets pull at wake where they would move: D⁻¹ r, the speed that they would take on if all
/// others stayed, with what the step leaves of it.
void Solid::grow_region_by_speed(const StepLoads& loads) {
  const double bound = m_params.region_tolerance * std::max(m_fastest, kStill);
  for (const int run : m_region->fringe()) {
    const auto [begin, end] = find_rows(run, m_node_of_row.size());
    for (std::size_t row = begin; row < end; ++row) {
      const Eigen::Index node = m_node_of_row[row];
      const double mobility = loads.mobility ? loads.mobility(node) : 1.0;
      const Vec3 speed = linear::invert_block(m_matrix.block(m_matrix.diagonal[row])) *
                         m_rhs.col(static_cast<Eigen::Index>(row));
      if (!(mobility * speed.norm() > bound)) continue;
      m_region->wake(run);
      break;
    }
  }
}

/// The runs that are pulled at most wake, until what is left holds back no more than it may.
void Solid::grow_region_by_force(const StepLoads& loads) {
  m_pulls.clear();
  double total = 0.0;
  for (const int run : m_region->fringe()) {
    const auto [begin, end] = find_rows(run, m_node_of_row.size());
    double squares = 0.0;
    for (std::size_t row = begin; row < end; ++row) {
      const double mobility = loads.mobility ? loads.mobility(m_node_of_row[row]) : 1.0;
      squares += (mobility / m_tau * m_rhs.col(static_cast<Eigen::Index>(row))).squaredNorm();
    }
    m_pulls.emplace_back(-squares, run);
    total += squares;
  }
  std::sort(m_pulls.begin(), m_pulls.end());
  for (const auto& [minus_squares, run] : m_pulls) {
    if (!(total > loads.region_slack * loads.region_slack)) break;
    m_region->wake(run);
    total += minus_squares;
  }
  m_held_back = std::sqrt(std::max(0.0, total));
}

void Solid::grow_region(const StepLoads& loads) {
  m_region_slack = loads.region_slack;
  if (loads.region_slack > 0.0)
    grow_region_by_force(loads);
  else
    grow_region_by_speed(loads);
  if (!m_region->update()) return;
  visit_region();
  assemble_matrix(loads.contacts);
}

void Solid::settle_region(SolidState& state, const std::vector<char>& is_flowing) {
  if (!m_region) return;
  std::vector<double>& fastest = m_run_speed;
  fastest.assign(m_region->awake().size(), 0.0);
  m_fastest = 0.0;
  for (std::size_t i = 0; i < fastest.size(); ++i) {
    const auto [begin, end] = find_rows(m_region->awake()[i], m_node_of_row.size());
    for (std::size_t row = begin; row < end; ++row)
      fastest[i] = std::max(fastest[i], state.v.col(m_node_of_row[row]).norm());
    m_fastest = std::max(m_fastest, fastest[i]);
  }
  m_region->wake_batches(is_flowing);
  const double bound = kSleepShare * m_params.region_tolerance * std::max(m_fastest, kStill);
  // What is stopped is, with all others that may be, as much as may be held back.
  const double share =
      kSleepShare * m_region_slack / std::sqrt(std::max(1.0, static_cast<double>(fastest.size())));
  const auto is_slow = [&](std::size_t i, int run) {
    if (m_region_slack == 0.0) return fastest[i] <= bound;
    const auto [begin, end] = find_rows(run, m_node_of_row.size());
    double squares = 0.0;
    for (std::size_t row = begin; row < end; ++row)
      squares += (m_mass(m_node_of_row[row]) / m_tau * state.v.col(m_node_of_row[row])).squaredNorm();
    return squares <= share * share;
  };
  for (std::size_t i = 0; i < fastest.size(); ++i) {
    const int run = m_region->awake()[i];
    int& calm = m_region->calm_steps(run);
    calm = is_slow(i, run) && !m_region->has_any(run, is_flowing) ? calm + 1 : 0;
    if (calm < kCalmSteps) continue;
    m_region->make_drowsy(run);
    const auto [begin, end] = find_rows(run, m_node_of_row.size());
    for (std::size_t row = begin; row < end; ++row) state.v.col(m_node_of_row[row]).setZero();
  }
}

}  // namespace argil::solid
