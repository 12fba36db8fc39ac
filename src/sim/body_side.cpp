#include "sim/body_side.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/lanes.h"
#include "base/ordered_sum.h"
#include "base/parallel.h"
#include "material/plasticity.h"

namespace argil::sim {
namespace {

/// A full model is whole unless the scenario asks for a region.
solid::SolidParams make_solid_params(const Params& params) {
  solid::SolidParams p = params.solid;
  if (p.extent == solid::Extent::automatic && params.fidelity.mode == FidelityMode::full)
    p.extent = solid::Extent::whole;
  return p;
}

}  // namespace

BodySide::BodySide(Body body, const Params& params)
    : m_params(params),
      m_body(std::move(body)),
      m_moisture(params.elastic, params.plasticity.yield, params.moisture, params.water.porosity),
      m_solid(m_body.mesh, m_body.topology, m_body.supports, make_solid_params(params), params.threads),
      m_water(m_body.mesh, m_body.topology, params.water, m_body.initial_saturation, params.threads),
      m_surface(params.contact_surface, m_body, m_solid.elements()),
      m_fidelity(params.fidelity, params.solid.rayleigh_stiffness /
                                      solid::compute_tau(params.solid.integrator, step_seconds())) {
  const Eigen::Index n = m_solid.elements().num_nodes();
  m_state.solid = m_solid.make_rest_state();
  m_load_force = solid::compute_load_force(m_solid.elements(), m_body.topology.boundary, m_body.loads);
  m_external_force = m_load_force;
  m_forced_nodes.reserve(static_cast<std::size_t>(n));
  m_changed_nodes.reserve(static_cast<std::size_t>(2 * n));
  m_held_back.setZero(3, n);
  m_yield.setZero(m_solid.elements().num_points());
  m_is_flowing.resize(static_cast<std::size_t>(m_solid.elements().num_points() / kLanes + 1), 0);
  const bool keeps_volume = params.plasticity.enabled && params.plasticity.deviatoric;
  if (!m_moisture.is_isotropic() && keeps_volume)
    m_shape_stiffness.resize(static_cast<std::size_t>(m_body.mesh.num_tets()));
  m_is_flow_driven =
      keeps_volume && (!m_moisture.is_isotropic() ||
                       find_law(params.solid.model).plastic_split != solid::PlasticSplit::additive);
  m_is_moved = std::any_of(m_body.supports.begin(), m_body.supports.end(),
                           [](const solid::Support& s) { return s.displacement.norm() > 0.0; });
  StepStatus rest = m_solid.update_kinematics(m_state.solid.x, 0);
  ARGIL_ASSERT(rest.is_ok());
  const bool is_loaded = params.solid.gravity.norm() > 0.0 || m_load_force.norm() > 0.0;
  if (!m_is_moved && !is_loaded) fall_asleep();
  rest = refresh_materials(-1.0);
  ARGIL_ASSERT(rest.is_ok());
  if (m_state.is_at_rest) m_solid.sleep_all();
  m_solid.make_ready(m_state.solid, m_external_force);
  find_reach(OrderedItems(params.threads));
}

StepStatus BodySide::settle() {
  return m_solid.find_equilibrium(m_state.solid, {m_load_force});
}

BodyAtFrame BodySide::at_frame(Tick tick) {
  return {m_solid, m_surface, m_state.solid, step_seconds(), tick};
}

/// Sets right what was gathered in more or fewer ticks than planned, and answers that nothing has moved yet.
void BodySide::begin_step(ContactLoad& load, BodyAnswer& answer) {
  ++m_state.steps;
  m_hand = load.hand;
  answer.step = m_state.steps;
  answer.has_moved = false;
  answer.felt = load.hand.felt;
  load.force.list();
  if (load.scale == 1.0) return;
  for (const int n : load.force.nodes) load.force.at.col(n) *= load.scale;
  for (solid::PointStiffness& entry : load.stiffness) {
    entry.stiffness *= load.scale;
    entry.force *= load.scale;
  }
  for (ContactYield& entry : load.yields) entry.force_at_rest *= load.scale;
}

/// Loads and contacts, at the nodes where these act now or did in the last step.
void BodySide::set_external_force(const ContactLoad& load) {
  m_changed_nodes = m_forced_nodes;
  m_changed_nodes.insert(m_changed_nodes.end(), load.force.nodes.begin(), load.force.nodes.end());
  for (const int n : m_changed_nodes) m_external_force.col(n) = load.force.at.col(n) + m_load_force.col(n);
  m_forced_nodes = load.force.nodes;
}

/// What a step has found the body to yield under the tool lets the forces of its contacts fall: those on the
/// body, and of the last detection those that the hand feels. With one detection a step, both are equal and
/// opposite.
void BodySide::apply_contact_yield(ContactLoad& load, device::Wrench& felt) {
  m_solid.apply_contact_stiffness(load.stiffness, load.force.at);
  for (std::size_t i = load.last_detection; i < load.stiffness.size(); ++i) {
    const Vec3 at_rest = load.yields[i].force_at_rest * load.stiffness[i].normal;
    const Vec3 change = load.detections * (at_rest + m_solid.compute_contact_change(load.stiffness, i));
    felt.force -= change;
    felt.torque -= (load.yields[i].point - load.hand.tool.position).cross(change);
  }
}

/// v ← G_d^{h/h_ref}(r) v with r from the point of contact (eq. 9). A body that nothing presses is left free,
/// else clay held in mid-air would freeze in whatever shape it has.
void BodySide::apply_clay_kernel(const ContactLoad& load, double step_s) {
  if (!load.is_pressed || m_params.kernel.form == material::KernelForm::off) return;
  m_solid.moving_nodes().each(m_state.solid.v.cols(), [&](std::ptrdiff_t v) {
    if (!m_state.solid.v.col(v).isZero(0.0)) m_state.solid.v.col(v) *= clay_factor(v, load, step_s);
  });
}

double BodySide::clay_factor(Eigen::Index node, const ContactLoad& load, double step_s) const {
  const double r = (m_state.solid.x.col(node) - load.centre).norm();
  return material::compute_clay_factor(r, m_params.kernel, step_s);
}

/// Books what hand, loads and supports gave the body in the step just taken, and stops a run in which it
/// moves with many times the energy that they ever gave it: no body does, a scheme past its limit does. Clay
/// that swells is left alone: its water gives it energy, too, that no one books.
StepStatus BodySide::check_energy(const ContactLoad& contacts) {
  if (m_params.energy_limit == 0.0 || m_params.water.swelling > 0.0) return StepStatus::ok();
  constexpr double kSpeed = 1e-3;  // [m/s] of a body that counts as still: below is what a loose solve leaves
  const solid::SolidState& solid = m_state.solid;
  const Field& mass = m_solid.mass();
  m_state.energy_given += m_solid.moving_nodes().sum(solid.x.cols(), [&](std::ptrdiff_t n) {
    const Vec3 way = solid.x.col(n) - m_solid.x_start().col(n);
    const Vec3 load = m_load_force.col(n) + mass(n) * m_params.solid.gravity;
    const Vec3 reaction = (m_solid.constraints().support.col(n).array() >= 0)
                              .select(m_solid.internal_force().col(n), Vec3::Zero());
    return std::max(0.0, way.dot(contacts.force.at.col(n))) + std::abs(way.dot(load)) +
           std::abs(way.dot(reaction));
  });
  const double kinetic = m_solid.compute_kinetic_energy(solid);
  double bound = m_params.energy_limit * m_state.energy_given;
  if (kinetic <= bound) return StepStatus::ok();
  bound += 0.5 * kSpeed * kSpeed * mass.sum();
  if (kinetic <= bound) return StepStatus::ok();
  return StepStatus::failed(
      {tick(), "solid", -1, "kinetic energy [J] of a body that was given less", kinetic, bound});
}

/// Puts the body back to where the step began that has failed.
void BodySide::take_back(double energy_given) {
  m_state.solid.x = m_solid.x_start();
  m_state.solid.v = m_solid.v_start();
  m_state.energy_given = energy_given;
  const StepStatus status = m_solid.restore_kinematics(m_state.solid.x, tick());
  ARGIL_ASSERT(status.is_ok());
}

/// ε_p of a point after a step's flow.
Vec6 BodySide::compute_flow(int point, double step_s) const {
  const int tet = m_solid.elements().tet_of_point(point);
  const Vec6 before = m_state.solid.plastic_strain.col(point);
  material::FlowPoint at{m_solid.material(tet).yield};
  Vec6 drive;
  if (m_is_flow_driven) {
    const double shape_stiffness = m_shape_stiffness.empty()
                                       ? 2.0 * m_solid.material(tet).mu
                                       : m_shape_stiffness[static_cast<std::size_t>(tet)];
    drive = m_solid.compute_flow_drive(point, before, shape_stiffness);
    at.drive = &drive;
  }
  return material::compute_plastic_strain(m_solid.strain().col(point), before, at, m_params.plasticity,
                                          step_s);
}

/// Flow of every point whose elastic strain lies beyond its yield; others are not looked at one by one.
void BodySide::apply_plastic_flow(double step_s) {
  if (!m_params.plasticity.enabled) return;
  m_state.plastic_dissipation += m_solid.sum_moving_points(
      [&](std::ptrdiff_t begin, std::ptrdiff_t end) { return flow_at_points(begin, end, step_s); });
  m_flows = m_solid.has_any_moving(m_is_flowing);
}

/// Of at most kLanes points; returns what their flow dissipates [J].
double BodySide::flow_at_points(std::ptrdiff_t begin, std::ptrdiff_t end, double step_s) {
  unsigned flowing =
      m_is_flow_driven ? (1U << (end - begin)) - 1U
                       : material::find_flowing(m_solid.strain().data(), m_state.solid.plastic_strain.data(),
                                                m_yield.data(), m_params.plasticity, begin, end);
  m_is_flowing[static_cast<std::size_t>(begin / kLanes)] = flowing != 0;
  double released = 0.0;
  for (; flowing != 0; flowing &= flowing - 1)
    released += flow_at_point(static_cast<int>(begin) + std::countr_zero(flowing), step_s);
  return released;
}

/// Returns what flow dissipates [J]: at fixed strain, the elastic energy that it releases. Energy is no
/// quadratic function of ε_p in a multiplicative split: there a long step of flow is halved until it releases
/// energy.
double BodySide::flow_at_point(int point, double step_s) {
  constexpr int kHalvings = 10;
  const bool is_bent = find_law(m_params.solid.model).plastic_split != solid::PlasticSplit::additive;
  const Vec6 before = m_state.solid.plastic_strain.col(point);
  Vec6 after = compute_flow(point, step_s);
  if ((after.array() == before.array()).all()) return 0.0;
  const double energy = m_solid.compute_elastic_energy(point, before);
  double released = energy - m_solid.compute_elastic_energy(point, after);
  for (int k = 0; is_bent && released < 0.0 && k < kHalvings; ++k) {
    after = k + 1 < kHalvings ? Vec6(0.5 * (before + after)) : before;
    released = energy - m_solid.compute_elastic_energy(point, after);
  }
  m_state.solid.plastic_strain.col(point) = after;
  return released;
}

/// Moduli, yield, size and weight of a tet at the saturation S.
void BodySide::refresh_material(int tet, double S) {
  const bool has_own_modulus = m_body.youngs_modulus.size() > 0;
  const double E = has_own_modulus ? m_body.youngs_modulus(tet) : m_params.elastic.youngs_modulus;
  const material::WetState wet = has_own_modulus ? m_moisture.at(S, E) : m_moisture.at(S);
  m_solid.set_material(tet, {wet.lambda, wet.mu, wet.yield});
  const int Q = m_solid.elements().points_per_tet;
  m_yield.segment(static_cast<Eigen::Index>(Q) * tet, Q).setConstant(wet.yield);
  if (m_params.water.swelling > 0.0) m_solid.set_swelling(tet, 1.0 + m_params.water.swelling * S);
  if (m_params.water.adds_mass) m_solid.set_water_mass(tet, m_water.capacity(tet) * S);
  if (m_moisture.is_isotropic()) return;
  const Vec3 axis =
      m_body.pore_axis.cols() > 0 ? Vec3(m_body.pore_axis.col(tet)) : m_params.moisture.medium.axis;
  const Mat6 C = has_own_modulus ? m_moisture.stiffness_at(S, axis, E) : m_moisture.stiffness_at(S, axis);
  m_solid.set_anisotropic_stiffness(tet, C);
  if (!m_shape_stiffness.empty())
    m_shape_stiffness[static_cast<std::size_t>(tet)] = material::compute_shape_stiffness(C);
}

/// Brings the solid up to date with every tet whose saturation moved by more than `tolerance` since last
/// time.
StepStatus BodySide::refresh_materials(double tolerance) {
  m_water.collect_changed(tolerance, m_changed_tets);
  for (const int tet : m_changed_tets) {
    refresh_material(tet, m_water.saturation()(tet));
    if (m_state.is_at_rest && m_solid.is_strained(tet, m_state.solid.plastic_strain))
      m_state.is_at_rest = false;  // other moduli under strain: another balance
  }
  const bool gains_weight = m_params.water.adds_mass && m_params.solid.gravity.norm() > 0.0;
  if (gains_weight && !m_changed_tets.empty()) m_state.is_at_rest = false;
  const bool may_grow = m_params.water.swelling > 0.0 && !m_changed_tets.empty();
  const bool is_start = tolerance < 0.0;  // dry clay has the size that it came with
  if (!may_grow || (is_start && (m_water.saturation().array() == 0.0).all())) return StepStatus::ok();
  m_state.is_at_rest = false;
  return m_solid.update_kinematics(m_state.solid.x, tick());
}

void BodySide::fall_asleep() {
  m_state.is_at_rest = true;
  m_state.slow_steps = 0;
  m_state.solid.v.setZero();
  m_state.solid.v_before.setZero();
  if (m_state.solid.x_before.size() > 0) m_state.solid.x_before = m_state.solid.x;
  m_solid.sleep_all();
  m_rest_strain = m_solid.summarise(m_state.solid.plastic_strain);
}

/// Is the body left as it is in this physics step? It falls asleep when nothing has touched it and it has
/// been slower than rest_speed for two steps, and wakes when anything acts. A body that never moved rests
/// from the start; only rounding would stir it.
bool BodySide::rests(const ContactLoad& load) {
  if (!m_fidelity.is_full()) return sleeps_on(load);
  if (load.is_touched || m_is_moved) {
    m_state.is_at_rest = false;
    m_state.slow_steps = 0;
    return false;
  }
  if (m_state.is_at_rest || m_params.rest_speed == 0.0) return m_state.is_at_rest;
  const double speed = std::sqrt(m_state.solid.v.colwise().squaredNorm().maxCoeff());
  m_state.slow_steps = speed <= m_params.rest_speed ? m_state.slow_steps + 1 : 0;
  if (m_state.slow_steps >= 2) fall_asleep();
  return m_state.is_at_rest;
}

void BodySide::find_reach(const OrderedItems& nodes) {
  m_fidelity.find_reach(m_state.solid.x, m_solid.elements().rest, nodes);
}

/// fidelity: does the body still sleep under this load? A surface that yields between frames asks for a step
/// after each frame in which it was touched.
bool BodySide::sleeps_on(const ContactLoad& load) {
  m_fidelity.begin_step(load.hand.felt.force);
  if (load.is_touched && m_params.rates.between_frames == BetweenFrames::compliant)
    m_state.is_at_rest = false;
  if (!m_state.is_at_rest) {
    find_reach(m_solid.moving_nodes());
    return false;
  }
  double squares = m_held_back_squares;
  for (const int n : load.force.nodes) {
    const Vec3 force = m_solid.find_free_part(load.force.at.col(n), n);
    squares += force.dot(2.0 * m_held_back.col(n) + force);
  }
  m_state.is_at_rest = m_fidelity.sleeps_on(std::sqrt(std::max(0.0, squares)), m_solid.held_back());
  return m_state.is_at_rest;
}

/// fidelity: the mean strain of the points that move, each by its elastic energy. Laws of elasticity agree
/// for small strain and differ in the next power, so that the force of another one may be off by about as
/// much.
void BodySide::watch_strain() {
  constexpr int kSteps = 16;  // between two looks
  if (m_fidelity.is_full() || m_state.steps % kSteps != 0) return;
  const auto weigh = [&](std::ptrdiff_t begin, std::ptrdiff_t end, bool by_strain) {
    double sum = 0.0;
    for (auto p = static_cast<int>(begin); p < static_cast<int>(end); ++p) {
      const Vec6 strain = m_solid.strain().col(p);
      const Vec6 elastic = strain - m_state.solid.plastic_strain.col(p);
      sum += m_solid.material(m_solid.elements().tet_of_point(p)).mu * m_solid.elements().weight(p) *
             elastic.squaredNorm() * (by_strain ? strain.norm() : 1.0);
    }
    return sum;
  };
  const auto sum = [&](bool by_strain) {
    return m_solid.sum_moving_points(
        [&](std::ptrdiff_t begin, std::ptrdiff_t end) { return weigh(begin, end, by_strain); });
  };
  const double energy = sum(false);
  m_fidelity.set_large_strain(energy > 0.0 ? sum(true) / energy : 0.0);
}

/// fidelity: may the body stop where it is, instead of the step that was assembled?
bool BodySide::falls_asleep(const ContactLoad& load, const solid::StepLoads& loads) {
  if (m_is_moved || m_params.rates.between_frames == BetweenFrames::compliant) return false;
  if (!m_fidelity.falls_asleep(m_solid.compute_imbalance(loads), m_solid.held_back(), m_flows)) return false;
  const OrderedItems& nodes = m_solid.moving_nodes();
  m_held_back.setZero();
  m_held_back_squares = nodes.sum(m_held_back.cols(), [&](std::ptrdiff_t n) {
    if (!m_solid.is_awake(n)) return 0.0;
    m_held_back.col(n) = m_solid.find_imbalance(loads, n) - m_solid.find_free_part(load.force.at.col(n), n);
    return m_held_back.col(n).squaredNorm();
  });
  for (const int n : load.force.nodes) {  // in balance where the body slept before
    if (m_solid.is_awake(n)) continue;
    m_held_back.col(n) = -m_solid.find_free_part(load.force.at.col(n), n);
    m_held_back_squares += m_held_back.col(n).squaredNorm();
  }
  find_reach(nodes);
  fall_asleep();
  return true;
}

}  // namespace argil::sim
