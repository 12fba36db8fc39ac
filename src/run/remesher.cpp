#include "run/remesher.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include "base/error.h"
#include "scenario/renew_cells.h"

namespace argil::run {
namespace {

constexpr Tick kStepsBetweenLooks = 4;
constexpr double kShortestEpoch = 0.012;  // [s]
// mesh::compute_shape of the worst tet, below which cells are renewed. A lattice that a body began with is
// flattened evenly, and bears more of it than cells that were laid on a shape.
constexpr double kSpoiltFirst = 0.15;
constexpr double kSpoilt = 0.2;
constexpr double kWait = 0.25;  // [s] after a shape that gave no cells

}  // namespace

Remesher::Remesher(const scenario::Scenario& s, output::ResultFile* file, bool is_quiet)
    : m_scenario(s),
      m_file(file),
      m_is_quiet(is_quiet),
      m_can_renew(scenario::find_remesh_obstacle(s).empty()) {}

bool Remesher::is_due(const sim::Simulation& simulation) const {
  const sim::RateParams& rates = m_scenario.params.rates;
  const Tick tick = simulation.clock().tick;
  if (tick <= m_waits_until) return false;
  if (tick % (kStepsBetweenLooks * rates.physics_period_ticks) != 0) return false;
  const sim::Body& body = simulation.body();
  if (static_cast<double>(tick - body.epoch_tick) * rates.haptic_period < kShortestEpoch) return false;
  if (simulation.body_state().is_at_rest && simulation.body_state().plastic_dissipation == 0.0) return false;
  return simulation.body_side().find_worst_shape() < (body.epoch == 0 ? kSpoiltFirst : kSpoilt);
}

bool Remesher::renew_if_spoilt(sim::Simulation& simulation) {
  if (!m_can_renew || !is_due(simulation)) return false;
  const auto start = std::chrono::steady_clock::now();
  const sim::Body& before = simulation.body();
  const Points& x = simulation.body_state().solid.x;
  const sim::HandState& hand = simulation.hand_state();
  const double worst = simulation.body_side().find_worst_shape();
  const int num_before = before.mesh.num_tets();
  bool is_torn = false;
  try {
    scenario::NewCells made = scenario::make_new_cells(
        m_scenario, {before,
                     x,
                     simulation.solid().model.elements.nodes,
                     {simulation.surface_now(), simulation.body_side().surface().triangles()},
                     simulation.tool(),
                     hand.num_contacts > 0 ? std::optional(hand.contact_tool) : std::nullopt});
    is_torn = made.is_torn;
    sim::Body& body = made.body;
    body.epoch = before.epoch + 1;
    body.epoch_tick = simulation.clock().tick;
    if (!simulation.renew_cells(std::move(body)))
      throw InputError("the clay", "", "is pressed beyond what its law bears", "");
  } catch (const InputError& error) {
    if (!m_is_quiet && !m_has_told)
      std::fprintf(stderr, "argil: note: the clay's shape gives no new cells: %s\n", error.what());
    m_has_told = true;
    m_waits_until =
        simulation.clock().tick + static_cast<Tick>(std::ceil(kWait / m_scenario.params.rates.haptic_period));
    return false;
  }
  if (!m_is_quiet)
    std::fprintf(stderr,
                 "argil: note: tick %lld: new cells, %d tets for %d whose worst had the quality %.2g%s\n",
                 static_cast<long long>(simulation.clock().tick), simulation.body().mesh.num_tets(),
                 num_before, worst, is_torn ? "; what is thinner than a cell is torn off" : "");
  if (m_file) m_file->begin_epoch(simulation.body());
  m_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return true;
}

}  // namespace argil::run
