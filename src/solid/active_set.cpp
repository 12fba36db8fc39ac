#include "solid/active_set.h"

#include <algorithm>
#include <bit>
#include <iterator>

#include "base/lanes.h"
#include "base/ordered_loops.h"

namespace argil::solid {
namespace {

constexpr int kRun = static_cast<int>(OrderedRuns::kLength);

}  // namespace

void ActiveSet::Marks::move_to(std::vector<int>& list) {
  list.clear();
  for (std::size_t w = 0; w < m_words.size(); ++w) {
    for (std::uint64_t word = m_words[w]; word != 0; word &= word - 1)
      list.push_back(static_cast<int>(64 * w) + std::countr_zero(word));
    m_words[w] = 0;
  }
}

ActiveSet::Table ActiveSet::make_table(std::vector<std::pair<int, int>>& pairs, int count) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  Table table;
  table.begin.assign(static_cast<std::size_t>(count) + 1, 0);
  for (const auto& [of, item] : pairs) {
    ++table.begin[static_cast<std::size_t>(of) + 1];
    table.item.push_back(item);
  }
  for (std::size_t i = 1; i < table.begin.size(); ++i) table.begin[i] += table.begin[i - 1];
  return table;
}

ActiveSet::ActiveSet(const Elements& elements, const std::vector<int>& node_of_row,
                     const std::vector<int>& row_of_node)
    : m_num_rows(static_cast<int>(node_of_row.size())) {
  for (const int row : row_of_node) m_run_of_node.push_back(row < 0 ? -1 : row / kRun);
  std::vector<std::pair<int, int>> batches_of_run, runs_of_batch, nodes_of_batch;
  for (int t = 0; t < elements.num_tets(); ++t)
    for (const int node : elements.nodes.col(t)) {
      nodes_of_batch.emplace_back(t / kLanes, node);
      const int run = m_run_of_node[static_cast<std::size_t>(node)];
      if (run < 0) continue;
      batches_of_run.emplace_back(run, t / kLanes);
      runs_of_batch.emplace_back(t / kLanes, run);
    }
  const int num_runs = (m_num_rows + kRun - 1) / kRun;
  const int num_batches = (elements.num_tets() + kLanes - 1) / kLanes;
  m_batches_of_run = make_table(batches_of_run, num_runs);
  m_runs_of_batch = make_table(runs_of_batch, num_batches);
  m_nodes_of_batch = make_table(nodes_of_batch, num_batches);
  m_state.assign(static_cast<std::size_t>(num_runs), kAwake);
  m_calm_steps.assign(m_state.size(), 0);
  m_listed = m_state;
  m_changed_runs.resize(m_state.size());
  m_before.reserve(m_state.size());
  m_batch_marks.resize(static_cast<std::size_t>(num_batches));
  m_run_marks.resize(m_state.size());
  m_node_marks.resize(static_cast<std::size_t>(elements.num_nodes()));
  m_fringe.reserve(m_state.size());  // the others are as long as they can be: all is awake
  update();
}

void ActiveSet::wake_all() {
  for (int run = 0; run < num_runs(); ++run) wake(run);
}

void ActiveSet::sleep_all() {
  for (int run = 0; run < num_runs(); ++run)
    if (is_awake(run)) make_drowsy(run);
  m_is_changed = true;
}

void ActiveSet::wake(int run) {
  set_calm_steps(run, 0);
  char& state = m_state[static_cast<std::size_t>(run)];
  if (state == kAwake) return;
  remember(run);
  state = kAwake;
  m_is_changed = true;
}

void ActiveSet::set_calm_steps(int run, int steps) {
  if (calm_steps(run) == steps) return;
  remember(run);
  m_calm_steps[static_cast<std::size_t>(run)] = steps;
}

void ActiveSet::wake_node(int node) {
  const int own = m_run_of_node[static_cast<std::size_t>(node)];
  if (own < 0) return;
  const bool was_awake = is_awake(own);
  wake(own);
  if (was_awake) return;
  const auto [first, last] = m_batches_of_run.of(own);
  for (auto batch = first; batch != last; ++batch) {
    const auto [begin, end] = m_runs_of_batch.of(*batch);
    for (auto run = begin; run != end; ++run) wake(*run);
  }
}

void ActiveSet::wake_batches(const std::vector<char>& of_batch) {
  for (const int batch : m_batches) {
    if (of_batch[static_cast<std::size_t>(batch)] == 0) continue;
    const auto [first, last] = m_runs_of_batch.of(batch);
    for (auto run = first; run != last; ++run)
      if (!is_awake(*run)) wake(*run);
  }
}

void ActiveSet::make_drowsy(int run) {
  remember(run);
  m_state[static_cast<std::size_t>(run)] = kDrowsy;
  m_is_changed = true;
}

bool ActiveSet::update() {
  if (!m_is_changed && !m_has_drowsy) return false;
  for (int run = 0; run < num_runs(); ++run) {
    char& state = m_state[static_cast<std::size_t>(run)];
    char& listed = m_listed[static_cast<std::size_t>(run)];
    if (state == listed && state != kDrowsy) continue;
    remember(run);
    listed = state;
    if (state == kDrowsy) state = kAsleep;  // gone from the lists of the next update
  }
  make_lists();
  m_is_changed = false;
  return true;
}

/// Keeps what a run is, before it first changes after a commit.
void ActiveSet::remember(int run) {
  const auto r = static_cast<std::size_t>(run);
  if (m_changed_runs.set(r)) m_before.push_back({run, m_calm_steps[r], m_state[r], m_listed[r]});
}

void ActiveSet::commit() {
  m_changed_runs.clear();
  m_before.clear();
  m_was_changed = m_is_changed;
}

void ActiveSet::roll_back() {
  for (const Before& before : m_before) {
    const auto r = static_cast<std::size_t>(before.run);
    m_calm_steps[r] = before.calm_steps;
    m_state[r] = before.state;
    m_listed[r] = before.listed;
  }
  make_lists();
  m_is_changed = m_was_changed;
  commit();
}

void ActiveSet::make_lists() {
  m_awake.clear();
  m_fringe.clear();
  m_num_awake_rows = 0;
  m_has_drowsy = false;
  for (int run = 0; run < num_runs(); ++run) {
    const char state = m_listed[static_cast<std::size_t>(run)];
    if (state == kAsleep) continue;
    const auto [first, last] = m_batches_of_run.of(run);
    for (auto batch = first; batch != last; ++batch) m_batch_marks.set(*batch);
    if (state == kAwake) {
      m_awake.push_back(run);
      m_num_awake_rows += std::min(kRun, m_num_rows - kRun * run);
    } else {
      m_has_drowsy = true;
    }
  }
  m_batch_marks.move_to(m_batches);
  for (const int batch : m_batches) {
    const auto [run, last_run] = m_runs_of_batch.of(batch);
    std::for_each(run, last_run, [this](int r) { m_run_marks.set(r); });
    const auto [nodes, last_nodes] = m_nodes_of_batch.of(batch);
    std::for_each(nodes, last_nodes, [this](int n) { m_node_marks.set(n); });
  }
  m_run_marks.move_to(m_near);
  m_node_marks.move_to(m_nodes);
  std::set_difference(m_near.begin(), m_near.end(), m_awake.begin(), m_awake.end(),
                      std::back_inserter(m_fringe));
}

bool ActiveSet::has_any(int run, const std::vector<char>& of_batch) const {
  const auto [first, last] = m_batches_of_run.of(run);
  return std::any_of(first, last, [&](int batch) { return of_batch[static_cast<std::size_t>(batch)] != 0; });
}

void ActiveSet::serialize(Archive& archive) {
  archive.list("region/state", m_state);
  archive.list("region/calm_steps", m_calm_steps);
  archive.list("region/listed", m_listed);
  archive.number("region/is_changed", m_is_changed);
  if (archive.is_restoring()) make_lists();
}

}  // namespace argil::solid
