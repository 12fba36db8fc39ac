#include "sim/economy.h"

#include <algorithm>
#include <cmath>

#include "solid/step_solver.h"

namespace argil::sim {

Economy::Economy(const Params& params, const Body& body, solid::Body& solid, solid::ActiveRegion& region)
    : m_params(params),
      m_solid(solid),
      m_region(region),
      m_fidelity(params.fidelity,
                 params.solid.rayleigh_stiffness /
                     solid::compute_tau(params.solid.integrator, params.rates.step_seconds())),
      m_committed_fidelity(m_fidelity) {
  m_held_back.setZero(3, solid.model.elements.num_nodes());
  m_is_moved = std::any_of(body.supports.begin(), body.supports.end(),
                           [](const solid::Support& s) { return s.displacement.norm() > 0.0; });
}

void Economy::begin(BodyState& state, bool is_loaded) {
  find_reach(state, OrderedItems(m_params.threads));
  if (!m_is_moved && !is_loaded) fall_asleep(state);
  commit();
}

void Economy::fall_asleep(BodyState& state) {
  state.is_at_rest = true;
  m_slow_steps = 0;
  state.solid.v.setZero();
  if (m_params.solid.integrator == solid::Integrator::bdf2) {  // it has been here and at rest a step ago
    state.solid.x_before = state.solid.x;
    state.solid.v_before = state.solid.v;
  }
  m_region.sleep_all();
  m_rest_strain = solid::summarise(m_solid.strained(state.solid.plastic_strain), m_solid.energies,
                                   m_solid.scratch.nodal.change);
}

/// It falls asleep when nothing has touched it and it has been slower than rest_speed for two steps, and
/// wakes when anything acts.
bool Economy::rests(BodyState& state, const ContactLoad& load, const NodalForce& contacts) {
  if (!m_fidelity.is_full()) return sleeps_on(state, load, contacts);
  if (load.patch.is_touched || m_is_moved) {
    state.is_at_rest = false;
    m_slow_steps = 0;
    return false;
  }
  if (state.is_at_rest || m_params.rest_speed == 0.0) return state.is_at_rest;
  const double speed = std::sqrt(state.solid.v.colwise().squaredNorm().maxCoeff());
  m_slow_steps = speed <= m_params.rest_speed ? m_slow_steps + 1 : 0;
  if (m_slow_steps >= 2) fall_asleep(state);
  return state.is_at_rest;
}

void Economy::find_reach(const BodyState& state, const OrderedItems& nodes) {
  m_fidelity.find_reach(state.solid.x, m_solid.model.elements.rest, nodes);
}

/// fidelity: does the body still sleep under this load? A surface that deflects between frames asks for a
/// step after each frame in which it was touched.
bool Economy::sleeps_on(BodyState& state, const ContactLoad& load, const NodalForce& contacts) {
  m_fidelity.begin_step(load.hand.felt.force);
  if (load.patch.is_touched && m_params.deflects_between_steps()) state.is_at_rest = false;
  if (!state.is_at_rest) {
    find_reach(state, m_region.part().nodes);
    return false;
  }
  double squares = m_held_back_squares;
  for (const int n : contacts.nodes()) {
    const Vec3 force = solid::find_free_part(m_solid.model, contacts.at.col(n), n);
    squares += force.dot(2.0 * m_held_back.col(n) + force);
  }
  state.is_at_rest = m_fidelity.sleeps_on(std::sqrt(std::max(0.0, squares)), m_region.held_back());
  return state.is_at_rest;
}

void Economy::set_budget(solid::StepLoads& loads) const {
  loads.slack = m_fidelity.solve_slack();
  loads.limit = m_fidelity.solve_limit();
  loads.region_slack = m_fidelity.region_slack();
}

bool Economy::stops(BodyState& state, const solid::StepLoads& loads, const NodalForce& contacts, bool flows) {
  if (m_fidelity.is_full() || m_solid.history.counters.newton_iterations > 0) return false;
  if (m_is_moved || m_params.deflects_between_steps()) return false;
  if (!m_fidelity.falls_asleep(solid::compute_imbalance(m_solid, m_region, loads), m_region.held_back(),
                               flows))
    return false;
  const OrderedItems& nodes = m_region.part().nodes;
  m_held_back.setZero();
  m_held_back_squares = nodes.sum(m_held_back.cols(), [&](std::ptrdiff_t n) {
    if (!m_region.is_awake(n)) return 0.0;
    m_held_back.col(n) = solid::find_imbalance(m_solid, loads, n) -
                         solid::find_free_part(m_solid.model, contacts.at.col(n), n);
    return m_held_back.col(n).squaredNorm();
  });
  for (const int n : contacts.nodes()) {  // in balance where the body slept before
    if (m_region.is_awake(n)) continue;
    m_held_back.col(n) = -solid::find_free_part(m_solid.model, contacts.at.col(n), n);
    m_held_back_squares += m_held_back.col(n).squaredNorm();
  }
  find_reach(state, nodes);
  fall_asleep(state);
  return true;
}

void Economy::finish_step(const BodyState& state) {
  watch_strain(state);
  m_fidelity.set_made(m_solid.history.counters.has_solved, m_solid.history.counters.imbalance,
                      m_region.held_back());
}

/// fidelity: the mean strain of the points that move, each by its elastic energy. Laws of elasticity agree
/// for small strain and differ in the next power, so that the force of another one may be off by about as
/// much.
void Economy::watch_strain(const BodyState& state) {
  constexpr int kSteps = 16;  // between two looks
  if (m_fidelity.is_full() || state.steps % kSteps != 0) return;
  const auto weigh = [&](std::ptrdiff_t begin, std::ptrdiff_t end, bool by_strain) {
    double sum = 0.0;
    const int Q = m_solid.model.elements.points_per_tet;
    for (int p = Q * static_cast<int>(begin); p < Q * static_cast<int>(end); ++p) {
      const Vec6 strain = m_solid.kinematics.strain().col(p);
      const Vec6 elastic = strain - state.solid.plastic_strain.col(p);
      sum += m_solid.materials.of(m_solid.model.elements.tet_of_point(p)).mu * m_solid.materials.weight()(p) *
             elastic.squaredNorm() * (by_strain ? strain.norm() : 1.0);
    }
    return sum;
  };
  const auto sum = [&](bool by_strain) {
    return m_region.part().batches.sum(
        m_solid.model.elements.num_tets(),
        [&](std::ptrdiff_t begin, std::ptrdiff_t end) { return weigh(begin, end, by_strain); });
  };
  const double energy = sum(false);
  m_fidelity.set_large_strain(energy > 0.0 ? sum(true) / energy : 0.0);
}

void Economy::commit() {
  m_committed_fidelity = m_fidelity;
  m_committed_slow_steps = m_slow_steps;
}

void Economy::roll_back() {
  m_fidelity = m_committed_fidelity;
  m_slow_steps = m_committed_slow_steps;
}

void Economy::serialize(Archive& archive) {
  archive.number("solid/slow_steps", m_slow_steps);
  archive.number("solid/rest_energy", m_rest_strain.elastic_energy);
  archive.number("solid/rest_plastic_strain", m_rest_strain.largest_plastic_strain);
  if (m_fidelity.is_full()) return;
  archive.array("fidelity/held_back", m_held_back);
  archive.number("fidelity/held_back_squares", m_held_back_squares);
  m_fidelity.serialize(archive);
}

}  // namespace argil::sim
