#include "solid/active_region.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/parallel.h"
#include "solid/matrix.h"

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

ActiveRegion::ActiveRegion(Body& body, bool restricts)
    : m_body(body), m_whole(body.model), m_part(body.model) {
  if (restricts) make();
  commit();
}

void ActiveRegion::make() {
  m_active =
      std::make_unique<ActiveSet>(m_body.model.elements, m_body.model.node_of_row, m_body.model.row_of_node);
  m_pulls.reserve(m_active->awake().size());
  m_run_speed.reserve(m_active->awake().size());
  m_committed_load.reserve(static_cast<std::size_t>(m_body.model.elements.num_nodes()));
  restrict_stages();
}

void ActiveRegion::drop() {
  m_left = std::move(m_active);
  restrict_stages();
  m_past.held_back = 0.0;
}

/// Part and solver take the present lists.
void ActiveRegion::restrict_stages() {
  m_part.rows.restrict_to(m_active ? &m_active->awake() : nullptr);
  m_part.near_rows.restrict_to(m_active ? &m_active->near() : nullptr);
  m_part.nodes.restrict_to(m_active ? &m_active->nodes() : nullptr);
  m_part.batches.restrict_to(m_active ? &m_active->batches() : nullptr);
  const bool is_restricted = m_body.history.solver->restrict_to(m_active ? &m_active->awake() : nullptr);
  ARGIL_ASSERT(is_restricted || !m_active);
}

bool ActiveRegion::is_awake(Eigen::Index node) const {
  const int row = m_body.model.row_of_node[static_cast<std::size_t>(node)];
  return !m_active || (row >= 0 && m_active->is_row_awake(row));
}

int ActiveRegion::num_active() const {
  return m_active ? m_active->num_awake_rows() : m_body.model.num_free();
}

void ActiveRegion::wake_all() {
  if (!m_active) return;
  m_active->wake_all();
  if (m_active->update()) restrict_stages();
}

void ActiveRegion::sleep_all() {
  if (m_active) m_active->sleep_all();
  m_body.is_state_changed = true;  // it loses its speed
}

void ActiveRegion::wake_tet(int tet) {
  if (!m_active) return;
  for (const int node : m_body.model.elements.nodes.col(tet)) m_active->wake_node(node);
}

void ActiveRegion::forget() {
  m_is_start_known = m_are_forces_known = false;
}

void ActiveRegion::make_ready(const Points& force) {
  if (m_active) m_last_load = force;
  if (m_active && m_active->update()) restrict_stages();
  assemble_forces(m_body.strained(), m_whole, m_body.forces);
  m_are_forces_known = true;
}

void ActiveRegion::leave(const StepLoads& loads) {
  m_active->wake_all();
  if (m_active->update()) take_in(loads);
  drop();
}

void ActiveRegion::wake(const StepLoads& loads) {
  if (!m_active) return;
  const bool is_first = m_last_load.size() == 0;
  if (is_first) m_last_load.setZero(3, loads.force.cols());
  const auto look_at = [&](Eigen::Index n) {
    if ((loads.force.col(n).array() == m_last_load.col(n).array()).all()) return;
    m_active->wake_node(static_cast<int>(n));
    set_last_load(n, loads.force.col(n));
  };
  if (is_first || !m_are_forces_known || !loads.changed) {
    for (Eigen::Index n = 0; n < loads.force.cols(); ++n) look_at(n);
  } else {
    for (const int node : *loads.changed) look_at(node);
  }
  for (const PointStiffness& contact : loads.contacts)
    for (std::size_t i = 0; i < contact.count(); ++i) m_active->wake_node(contact.vertex[i]);
  if (m_active->update()) restrict_stages();
  if (!m_are_forces_known) assemble_forces(m_body.strained(), m_whole, m_body.forces);
  m_are_forces_known = true;
}

void ActiveRegion::set_last_load(Eigen::Index node, const Vec3& force) {
  if (m_had_last_load) m_committed_load.emplace_back(static_cast<int>(node), m_last_load.col(node));
  m_last_load.col(node) = force;
}

/// By D⁻¹ r, the speed that they would take on if all others stayed, with what the step leaves of it.
void ActiveRegion::grow_by_speed(const StepLoads& loads) {
  if (!m_active) return;
  m_slack = loads.region_slack;
  if (loads.region_slack > 0.0) return;
  const Model& model = m_body.model;
  const linear::BlockMatrix& matrix = m_body.system.matrix;
  const double bound = model.params.region_tolerance * std::max(m_past.fastest, kStill);
  for (const int run : m_active->fringe()) {
    const auto [begin, end] = find_rows(run, model.node_of_row.size());
    for (std::size_t row = begin; row < end; ++row) {
      const Eigen::Index node = model.node_of_row[row];
      const double mobility = loads.mobility ? loads.mobility(node) : 1.0;
      const Vec3 speed = linear::invert_block(matrix.block(matrix.diagonal[row])) *
                         m_body.system.rhs.col(static_cast<Eigen::Index>(row));
      if (!(mobility * speed.norm() > bound)) continue;
      m_active->wake(run);
      break;
    }
  }
  if (m_active->update()) take_in(loads);
}

/// How far a row has gone from its place at rest once the step is made by the present solution.
Vec3 ActiveRegion::find_displacement(Eigen::Index row) const {
  const int node = m_body.model.node_of_row[static_cast<std::size_t>(row)];
  const Vec3 displacement = m_body.prediction.x_hat.col(node) - m_body.model.elements.rest.col(node);
  if (!m_active->is_row_awake(row)) return displacement;
  return displacement + m_body.prediction.tau * m_body.system.delta.col(row);
}

/// By the reciprocity of Maxwell and Betti a force is felt at the place of contact by as much of it as its
/// node goes when that place is moved by a unit. That is read off the body: how far the node, or one that it
/// is joined to, has gone so far, over the largest displacement. But next to nodes that are held back a node
/// goes less far than it would: in a body that yields as c/r [Boussinesq1885] and is held at R, by c/r − c/R,
/// whose slope there is that of the free one; r times the slope is how far the free one goes.
double ActiveRegion::find_reach(std::size_t row, const LargestDisplacement& largest) const {
  if (largest.size == 0.0) return 1.0;
  const Model& model = m_body.model;
  const linear::BlockMatrix& matrix = m_body.system.matrix;
  const auto own = static_cast<Eigen::Index>(row);
  const Vec3 place = model.elements.rest.col(model.node_of_row[row]);
  const Vec3 own_displacement = find_displacement(own);
  const double distance = (place - largest.place).norm();
  double reach = 0.0;
  for (int b = matrix.row_begin[row]; b < matrix.row_begin[row + 1]; ++b) {
    const int other = matrix.column[static_cast<std::size_t>(b)];
    if (other == own) continue;
    const Vec3 displacement = find_displacement(other);
    const double edge =
        (model.elements.rest.col(model.node_of_row[static_cast<std::size_t>(other)]) - place).norm();
    reach =
        std::max({reach, displacement.norm(), distance / edge * (displacement - own_displacement).norm()});
  }
  return std::min(1.0, reach / largest.size);
}

/// How much of what pulls at a run that sleeps, while the others move by the present solution, the hand would
/// feel at most [N].
double ActiveRegion::find_felt_pull(int run, const LargestDisplacement& largest,
                                    const StepLoads& loads) const {
  constexpr double kNothing = 1e-6;  // of what may be left out: too little to look closer
  const Model& model = m_body.model;
  const linear::BlockMatrix& matrix = m_body.system.matrix;
  const auto [begin, end] = find_rows(run, model.node_of_row.size());
  double felt = 0.0;
  for (std::size_t row = begin; row < end; ++row) {
    Vec3 momentum = m_body.system.rhs.col(static_cast<Eigen::Index>(row));
    for (int b = matrix.row_begin[row]; b < matrix.row_begin[row + 1]; ++b) {
      const int column = matrix.column[static_cast<std::size_t>(b)];
      if (m_active->is_row_awake(column)) momentum -= matrix.block(b) * m_body.system.delta.col(column);
    }
    double pull = momentum.norm() / m_body.prediction.tau;
    if (pull > kNothing * loads.region_slack) {
      if (loads.mobility) pull *= loads.mobility(model.node_of_row[row]);
      pull *= find_reach(row, largest);
    }
    felt += kFelt * pull;
  }
  return felt;
}

ActiveRegion::LargestDisplacement ActiveRegion::find_largest_displacement() const {
  const Model& model = m_body.model;
  LargestDisplacement largest;
  for (const int run : m_active->awake()) {
    const auto [begin, end] = find_rows(run, model.node_of_row.size());
    for (std::size_t row = begin; row < end; ++row)
      if (const double size = find_displacement(static_cast<Eigen::Index>(row)).norm(); size > largest.size)
        largest = {size, model.elements.rest.col(model.node_of_row[row])};
  }
  return largest;
}

bool ActiveRegion::grow_by_force(const StepLoads& loads) {
  const LargestDisplacement largest = find_largest_displacement();
  m_pulls.resize(m_active->fringe().size());
  parallel_for(static_cast<std::ptrdiff_t>(m_pulls.size()), m_body.model.threads, [&](std::ptrdiff_t i) {
    const int run = m_active->fringe()[static_cast<std::size_t>(i)];
    m_pulls[static_cast<std::size_t>(i)] = {-find_felt_pull(run, largest, loads), run};
  });
  double total = 0.0;
  for (const auto& [minus_felt, run] : m_pulls) total -= minus_felt;
  std::sort(m_pulls.begin(), m_pulls.end());
  for (const auto& [minus_felt, run] : m_pulls) {
    if (!(total > loads.region_slack)) break;
    m_active->wake(run);
    total += minus_felt;
  }
  m_past.held_back = std::max(0.0, total);
  if (!m_active->update()) return false;
  take_in(loads);
  return true;
}

/// Matrix and residual of the rows that came into reach; those that sleep do not move.
void ActiveRegion::take_in(const StepLoads& loads) {
  restrict_stages();
  for (const int run : m_active->fringe()) {
    const auto [begin, end] = find_rows(run, m_body.model.node_of_row.size());
    m_body.system.delta.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin))
        .setZero();
  }
  set_rhs(m_body, m_part, loads);
  assemble_matrix(m_body, m_part, loads.contacts);
}

void ActiveRegion::put_to_sleep(SolidState& state, const std::vector<char>& is_flowing) {
  if (!m_active) return;
  const std::vector<int>& node_of_row = m_body.model.node_of_row;
  std::vector<double>& fastest = m_run_speed;
  fastest.assign(m_active->awake().size(), 0.0);
  m_past.fastest = 0.0;
  for (std::size_t i = 0; i < fastest.size(); ++i) {
    const auto [begin, end] = find_rows(m_active->awake()[i], node_of_row.size());
    for (std::size_t row = begin; row < end; ++row)
      fastest[i] = std::max(fastest[i], state.v.col(node_of_row[row]).norm());
    m_past.fastest = std::max(m_past.fastest, fastest[i]);
  }
  m_active->wake_batches(is_flowing);
  const double bound = kSleepShare * m_body.model.params.region_tolerance * std::max(m_past.fastest, kStill);
  // What is stopped is, with all others that may be, felt by as much as may be held back.
  const double share = kSleepShare * m_slack / std::sqrt(std::max(1.0, static_cast<double>(fastest.size())));
  const auto is_slow = [&](std::size_t i, int run) {
    if (m_slack == 0.0) return fastest[i] <= bound;
    const auto [begin, end] = find_rows(run, node_of_row.size());
    double felt = 0.0;
    for (std::size_t row = begin; row < end; ++row) {
      const int node = node_of_row[row];
      felt += kFelt * (m_body.materials.mass()(node) / m_body.prediction.tau * state.v.col(node)).norm();
    }
    return felt <= share;
  };
  for (std::size_t i = 0; i < fastest.size(); ++i) {
    const int run = m_active->awake()[i];
    const bool is_calm = is_slow(i, run) && !m_active->has_any(run, is_flowing);
    m_active->set_calm_steps(run, is_calm ? m_active->calm_steps(run) + 1 : 0);
    if (m_active->calm_steps(run) < kCalmSteps) continue;
    m_active->make_drowsy(run);
    const auto [begin, end] = find_rows(run, node_of_row.size());
    for (std::size_t row = begin; row < end; ++row) state.v.col(node_of_row[row]).setZero();
  }
}

void ActiveRegion::commit() {
  if (m_active) m_active->commit();
  m_left.reset();
  m_committed_past = m_past;
  m_committed_load.clear();
  m_had_last_load = m_last_load.size() > 0;
}

void ActiveRegion::roll_back() {
  if (m_left) m_active = std::move(m_left);
  if (m_active) m_active->roll_back();
  restrict_stages();
  m_past = m_committed_past;
  for (auto change = m_committed_load.rbegin(); change != m_committed_load.rend(); ++change)
    m_last_load.col(change->first) = change->second;
  if (!m_had_last_load) m_last_load.resize(3, 0);
  m_committed_load.clear();
  forget();
}

void ActiveRegion::serialize(Archive& archive) {
  bool is_used = m_active != nullptr;
  archive.number("region/is_used", is_used);
  if (is_used && !m_active) make();
  if (!is_used && m_active) drop();
  if (!m_active) return;
  m_active->serialize(archive);
  if (archive.is_restoring()) restrict_stages();
  archive.number("region/fastest", m_past.fastest);
  archive.number("region/held_back", m_past.held_back);
  archive.any_size("region/last_load", m_last_load);
}

}  // namespace argil::solid
