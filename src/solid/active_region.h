#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "base/archive.h"
#include "solid/active_set.h"
#include "solid/body.h"

namespace argil::solid {

/// Which part of a body its steps solve for: the runs of rows that move, or all of it. The rest keeps its
/// place, strain and forces. Stages of a step are told the part and know nothing else of it.
class ActiveRegion {
 public:
  /// `restricts`: steps solve for the region that moves, else for all of the body, always.
  explicit ActiveRegion(Body& body, bool restricts = false);

  bool is_used() const { return m_active != nullptr; }  ///< else the whole body moves, always
  const Part& part() const { return m_part; }
  /// For stages that read what a part's nodes had: the whole body, once it was set from outside.
  const Part& start_part() const { return m_is_start_known ? m_part : m_whole; }
  const Part& whole() const { return m_whole; }
  bool is_awake(Eigen::Index node) const;
  int num_active() const;  ///< nodes that the next step solves for
  /// By what the last step left as it is: how much of that force the hand may feel [N].
  double held_back() const { return m_past.held_back; }

  void wake_all();
  void sleep_all();  ///< those that are awake, until something acts; the state has no speed any more
  void wake_tet(int tet);

  /// The body was set from outside: what nodes and tets that sleep have is not known.
  void forget();
  /// Does ahead of the first step what is done once: memory, and the forces of tets that do not move.
  /// `force`: 3×n [N] that act already, of which no node needs to be told.
  void make_ready(const Points& force);
  bool is_start_known() const { return m_is_start_known; }
  void set_start_known() { m_is_start_known = true; }

  /// Before a step's forces: those that change and contacts wake their nodes, and those around.
  void wake(const StepLoads& loads);
  /// After its matrix: rows that awake tets pull at wake where they would move faster than the bound of the
  /// parameters. With a region slack nothing: then it grows with the solve.
  void grow_by_speed(const StepLoads& loads);
  /// With a solution: the runs whose pull the hand would feel most wake, until what is left holds back no
  /// more than it may. True when any woke.
  bool grow_by_force(const StepLoads& loads);
  /// From now on, in the midst of a step, the whole body moves and always will.
  void leave(const StepLoads& loads);
  /// After a step: runs that have been slow for some steps, and whose tets do not flow, fall asleep and lose
  /// their speed. `is_flowing`: of each run of kLanes tets.
  void put_to_sleep(SolidState& state, const std::vector<char>& is_flowing);

  void serialize(Archive& archive);
  /// What woke and fell asleep since the last commit stays so; or all is as it was then.
  void commit();
  void roll_back();

 private:
  struct LargestDisplacement {
    double size = 0.0;          // [m]
    Vec3 place = Vec3::Zero();  // at rest, of the node that has gone so far
  };
  void make();
  void drop();
  void restrict_stages();
  void take_in(const StepLoads& loads);
  Vec3 find_displacement(Eigen::Index row) const;
  double find_reach(std::size_t row, const LargestDisplacement& largest) const;
  double find_felt_pull(int run, const LargestDisplacement& largest, const StepLoads& loads) const;
  LargestDisplacement find_largest_displacement() const;

  void set_last_load(Eigen::Index node, const Vec3& force);

  Body& m_body;
  Part m_whole, m_part;
  std::unique_ptr<ActiveSet> m_active, m_left;  // since the last commit
  bool m_is_start_known = false;                // of nodes that sleep
  bool m_are_forces_known = false;              // of tets that sleep
  double m_slack = 0.0;                         // of the present step [N]
  struct {
    double fastest = 0.0;    // speed of the last step [m/s]
    double held_back = 0.0;  // [N]
  } m_past, m_committed_past;
  std::vector<std::pair<double, int>> m_pulls;         // on runs that sleep [N], and their numbers
  Points m_last_load;                                  // forces of the last step
  bool m_had_last_load = false;                        // at the last commit
  std::vector<std::pair<int, Vec3>> m_committed_load;  // of nodes where it has changed since then
  std::vector<double> m_run_speed;                     // of the fastest node of each run that is awake
};

}  // namespace argil::solid
