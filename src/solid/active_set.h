#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "base/archive.h"
#include "base/change_marks.h"
#include "base/ordered_loops.h"
#include "solid/elements.h"

namespace argil::solid {

/// The part of a body that steps solve for; the rest stays where it is, with its strain and the forces of it.
/// Rows of the matrix (free nodes) wake and sleep in the runs of OrderedRuns, tets in runs of kLanes. A run
/// that falls asleep is drowsy for one step first, in which its tets are still brought up to date.
class ActiveSet {
 public:
  ActiveSet(const Elements& elements, const std::vector<int>& node_of_row,
            const std::vector<int>& row_of_node);

  void wake_all();
  void sleep_all();  ///< those that are awake, after the lists of the next update
  void wake(int run);
  void wake_node(int node);                              ///< and the runs that share a tet with its run
  void wake_batches(const std::vector<char>& of_batch);  ///< runs at those that move and for which it is set
  void make_drowsy(int run);
  bool is_awake(int run) const { return m_state[static_cast<std::size_t>(run)] == kAwake; }
  bool is_row_awake(Eigen::Index row) const { return is_awake(static_cast<int>(row / OrderedRuns::kLength)); }
  int num_awake_rows() const { return m_num_awake_rows; }
  int num_runs() const { return static_cast<int>(m_state.size()); }

  /// Brings the lists up to date with what woke or fell asleep. True when they changed.
  bool update();

  // Increasing numbers of runs:
  const std::vector<int>& awake() const { return m_awake; }      ///< of rows that are solved for
  const std::vector<int>& fringe() const { return m_fringe; }    ///< of other rows that awake tets pull at
  const std::vector<int>& near() const { return m_near; }        ///< both
  const std::vector<int>& batches() const { return m_batches; }  ///< of tets that move, kLanes each
  const std::vector<int>& nodes() const { return m_nodes; }      ///< of those tets

  bool has_any(int run,
               const std::vector<char>& of_batch) const;  ///< is it set for any of a run's batches of tets?

  /// Steps for which a run has been slow.
  int calm_steps(int run) const { return m_calm_steps[static_cast<std::size_t>(run)]; }
  void set_calm_steps(int run, int steps);
  void serialize(Archive& archive);
  /// What woke and fell asleep since the last commit stays so; or all, lists too, is as it was then.
  void commit();
  void roll_back();

 private:
  /// A set of small numbers that is read in their order.
  class Marks {
   public:
    void resize(std::size_t count) { m_words.assign((count + 63) / 64, 0); }
    void set(int i) { m_words[static_cast<std::size_t>(i) / 64] |= std::uint64_t{1} << (i % 64); }
    /// Empties the set into `list`.
    void move_to(std::vector<int>& list);

   private:
    std::vector<std::uint64_t> m_words;
  };

  static constexpr char kAsleep = 0, kDrowsy = 1, kAwake = 2;

  /// Lists of lists.
  struct Table {
    std::vector<int> begin, item;
    auto of(int i) const {
      return std::pair(item.begin() + begin[static_cast<std::size_t>(i)],
                       item.begin() + begin[static_cast<std::size_t>(i) + 1]);
    }
  };
  static Table make_table(std::vector<std::pair<int, int>>& pairs, int count);
  void make_lists();
  void remember(int run);

  int m_num_rows;
  std::vector<int> m_run_of_node;  // −1: held
  Table m_batches_of_run, m_runs_of_batch, m_nodes_of_batch;
  std::vector<char> m_state;
  std::vector<char> m_listed;  // states at the last update, which the lists are of
  std::vector<int> m_calm_steps;
  Marks m_batch_marks, m_run_marks, m_node_marks;
  /// Of a run that has changed since the last commit, what it was then.
  struct Before {
    int run, calm_steps;
    char state, listed;
  };
  std::vector<Before> m_before;
  ChangeMarks m_changed_runs;
  bool m_was_changed = true;  // m_is_changed at the last commit
  bool m_is_changed = true;
  bool m_has_drowsy = false;
  std::vector<int> m_awake, m_fringe, m_near, m_batches, m_nodes;
  int m_num_awake_rows = 0;
};

}  // namespace argil::solid
