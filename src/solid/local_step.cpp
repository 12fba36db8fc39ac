// Extent::local: which part of the body a step solves for.

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/parallel.h"
#include "solid/solid.h"

namespace argil::solid {
namespace {

constexpr double kStill = 1e-4;      // [m/s]: where nothing is faster, speeds are measured by this
constexpr int kCalmSteps = 8;        // that a run must have been slow before it falls asleep
constexpr double kFelt = 2.0 / 3.0;  // of the sum of what each pull is felt by: they point different ways
constexpr double kSleepShare = 0.5;  // of the speed that wakes it, below which a run is slow

/// First row of a run, and the one after its last.
std::pair<std::size_t, std::size_t> find_rows(int run, std::size_t num_rows) {
  const std::size_t begin = static_cast<std::size_t>(run) * OrderedRuns::kLength;
  return {begin, std::min(begin + OrderedRuns::kLength, num_rows)};
}

}  // namespace

bool Solid::is_awake(Eigen::Index node) const {
  const int row = m_row_of_node[static_cast<std::size_t>(node)];
  return !m_region || (row >= 0 && m_region->is_row_awake(row));
}

void Solid::make_region() {
  m_region = std::make_unique<ActiveSet>(m_elements, m_node_of_row, m_row_of_node);
  m_pulls.reserve(m_region->awake().size());
  m_run_speed.reserve(m_region->awake().size());
  visit_region();
}

void Solid::drop_region() {
  m_region.reset();
  m_rows.visit(nullptr);
  m_near_rows.visit(nullptr);
  m_nodes.visit(nullptr);
  m_solver->visit(nullptr);
  m_held_back = 0.0;
}

/// From now on, in the midst of a step, the whole body moves and always will.
void Solid::leave_region(const StepLoads& loads) {
  m_region->wake_all();
  if (m_region->update()) take_in_region(loads);
  drop_region();
}

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
  if (m_region) m_region->sleep_all();
}

void Solid::make_ready(const SolidState& state, const Points& force) {
  if (m_region) m_last_load = force;
  m_plastic_strain = &state.plastic_strain;
  if (m_region && m_region->update()) visit_region();
  take_up(state);
  assemble_internal_force();
  if (!is_explicit()) m_solver->prepare(m_matrix);
}

bool Solid::has_any_moving(const std::vector<char>& of_batch) const {
  if (!m_region) return std::any_of(of_batch.begin(), of_batch.end(), [](char c) { return c != 0; });
  const std::vector<int>& batches = m_region->batches();
  return std::any_of(batches.begin(), batches.end(),
                     [&](int batch) { return of_batch[static_cast<std::size_t>(batch)] != 0; });
}

/// Forces that change and contacts wake their nodes, and those around.
void Solid::wake_region(const StepLoads& loads) {
  const bool is_first = m_last_load.size() == 0;
  if (is_first) m_last_load.setZero(3, loads.force.cols());
  const auto see = [&](Eigen::Index n) {
    if ((loads.force.col(n).array() == m_last_load.col(n).array()).all()) return;
    m_region->wake_node(static_cast<int>(n));
    m_last_load.col(n) = loads.force.col(n);
  };
  if (is_first || m_has_old_forces || !loads.changed) {
    for (Eigen::Index n = 0; n < loads.force.cols(); ++n) see(n);
  } else {
    for (const int node : *loads.changed) see(node);
  }
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

/// How far a row has gone from its place at rest once the step is made by the present solution.
Vec3 Solid::find_way(Eigen::Index row) const {
  const int node = m_node_of_row[static_cast<std::size_t>(row)];
  const Vec3 way = m_x_hat.col(node) - m_elements.rest.col(node);
  if (!m_region->is_row_awake(row)) return way;
  return way + m_tau * m_delta.col(row);
}

/// By the reciprocity of Maxwell and Betti a force is felt at the place of contact by as much of it as its
/// node goes when that place is moved by a unit. That is read off the body: how far the node, or one that it
/// is joined to, has gone so far, over the largest way. But next to nodes that are held back a node goes less
/// far than it would: in a body that yields as c/r [Boussinesq1885] and is held at R, by c/r − c/R, whose
/// slope there is that of the free one; r times the slope is how far the free one goes.
double Solid::find_reach(std::size_t row, const LargestWay& largest) const {
  if (largest.size == 0.0) return 1.0;
  const auto own = static_cast<Eigen::Index>(row);
  const Vec3 place = m_elements.rest.col(m_node_of_row[row]);
  const Vec3 own_way = find_way(own);
  const double distance = (place - largest.place).norm();
  double way = 0.0;
  for (int b = m_matrix.row_begin[row]; b < m_matrix.row_begin[row + 1]; ++b) {
    const int other = m_matrix.column[static_cast<std::size_t>(b)];
    if (other == own) continue;
    const Vec3 other_way = find_way(other);
    const double edge = (m_elements.rest.col(m_node_of_row[static_cast<std::size_t>(other)]) - place).norm();
    way = std::max({way, other_way.norm(), distance / edge * (other_way - own_way).norm()});
  }
  return std::min(1.0, way / largest.size);
}

/// How much of what pulls at a run that sleeps, while the others move by the present solution, the hand would
/// feel at most [N].
double Solid::find_felt_pull(int run, const LargestWay& largest, const StepLoads& loads) const {
  constexpr double kNothing = 1e-6;  // of what may be left out: too little to look closer
  const auto [begin, end] = find_rows(run, m_node_of_row.size());
  double felt = 0.0;
  for (std::size_t row = begin; row < end; ++row) {
    Vec3 momentum = m_rhs.col(static_cast<Eigen::Index>(row));
    for (int b = m_matrix.row_begin[row]; b < m_matrix.row_begin[row + 1]; ++b) {
      const int column = m_matrix.column[static_cast<std::size_t>(b)];
      if (m_region->is_row_awake(column)) momentum -= m_matrix.block(b) * m_delta.col(column);
    }
    double pull = momentum.norm() / m_tau;
    if (pull > kNothing * loads.region_slack) {
      if (loads.mobility) pull *= loads.mobility(m_node_of_row[row]);
      pull *= find_reach(row, largest);
    }
    felt += kFelt * pull;
  }
  return felt;
}

/// The runs whose pull the hand would feel most wake, until what is left holds back no more than it may. True
/// when any woke.
bool Solid::grow_region_by_force(const StepLoads& loads) {
  LargestWay largest;
  for (const int run : m_region->awake()) {
    const auto [begin, end] = find_rows(run, m_node_of_row.size());
    for (std::size_t row = begin; row < end; ++row)
      if (const double way = find_way(static_cast<Eigen::Index>(row)).norm(); way > largest.size)
        largest = {way, m_elements.rest.col(m_node_of_row[row])};
  }
  m_pulls.resize(m_region->fringe().size());
  parallel_for(static_cast<std::ptrdiff_t>(m_pulls.size()), m_threads, [&](std::ptrdiff_t i) {
    const int run = m_region->fringe()[static_cast<std::size_t>(i)];
    m_pulls[static_cast<std::size_t>(i)] = {-find_felt_pull(run, largest, loads), run};
  });
  double total = 0.0;
  for (const auto& [minus_felt, run] : m_pulls) total -= minus_felt;
  std::sort(m_pulls.begin(), m_pulls.end());
  for (const auto& [minus_felt, run] : m_pulls) {
    if (!(total > loads.region_slack)) break;
    m_region->wake(run);
    total += minus_felt;
  }
  m_held_back = std::max(0.0, total);
  if (!m_region->update()) return false;
  take_in_region(loads);
  return true;
}

/// Matrix and residual of the rows that came into reach; those that sleep do not move.
void Solid::take_in_region(const StepLoads& loads) {
  visit_region();
  for (const int run : m_region->fringe()) {
    const auto [begin, end] = find_rows(run, m_node_of_row.size());
    m_delta.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin)).setZero();
  }
  set_rhs(loads);
  assemble_matrix(loads.contacts);
}

void Solid::grow_region(const StepLoads& loads) {
  m_region_slack = loads.region_slack;
  if (loads.region_slack > 0.0) return;  // by the solve
  grow_region_by_speed(loads);
  if (m_region->update()) take_in_region(loads);
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
  // What is stopped is, with all others that may be, felt by as much as may be held back.
  const double share =
      kSleepShare * m_region_slack / std::sqrt(std::max(1.0, static_cast<double>(fastest.size())));
  const auto is_slow = [&](std::size_t i, int run) {
    if (m_region_slack == 0.0) return fastest[i] <= bound;
    const auto [begin, end] = find_rows(run, m_node_of_row.size());
    double felt = 0.0;
    for (std::size_t row = begin; row < end; ++row)
      felt += kFelt * (m_mass(m_node_of_row[row]) / m_tau * state.v.col(m_node_of_row[row])).norm();
    return felt <= share;
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
