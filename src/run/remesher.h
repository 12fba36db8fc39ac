#pragma once

#include <string>

#include "output/result_file.h"
#include "scenario/scenario.h"
#include "sim/simulation.h"

namespace argil::run {

/// Gives a body new cells between two steps where flow has spoilt those that it has. When, and which, is a
/// function of the committed state, and of the last shape that gave none.
class Remesher {
 public:
  /// `file`: gets the new cells, if there is one. Both are kept by reference.
  Remesher(const scenario::Scenario& s, output::ResultFile* file, bool is_quiet);

  /// After a tick. True when the body has got new cells.
  bool renew_if_spoilt(sim::Simulation& simulation);
  /// Where a shape gives no cells, the next one that is tried is some time later: not at this tick or before.
  Tick waits_until() const { return m_waits_until; }
  void wait_until(Tick tick) { m_waits_until = tick; }
  double seconds() const { return m_seconds; }  ///< of wall clock that new cells have taken

 private:
  bool is_due(const sim::Simulation& simulation) const;

  const scenario::Scenario& m_scenario;
  output::ResultFile* m_file;
  bool m_is_quiet;
  bool m_can_renew;
  bool m_has_told = false;  // of a shape that gives none
  Tick m_waits_until = -1;
  double m_seconds = 0.0;
};

}  // namespace argil::run
