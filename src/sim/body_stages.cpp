// Stages of a step of the body, in the order of step.cpp.

#include <algorithm>
#include <cmath>

#include "material/plasticity.h"
#include "sim/body_side.h"
#include "solid/material_changes.h"
#include "solid/matrix.h"
#include "solid/move.h"
#include "solid/product.h"
#include "solid/response.h"
#include "solid/step_solver.h"

namespace argil::sim {

void BodySide::transfer_and_diffuse(const ContactLoad& load, double step_s) {
  const StageScope scope(m_observer, Stage::water);
  const int sign = load.mode == device::ToolMode::wet ? 1 : load.mode == device::ToolMode::dry ? -1 : 0;
  m_water.move({load.touched_tet, load.touched_area, sign}, step_s);
  m_has_moved_water = true;
}

/// Brings the solid up to date with the water. Other moduli under strain, another weight or size: another
/// balance, for which the body wakes.
StepStatus BodySide::refresh_materials(StepResult& result) {
  const StageScope scope(m_observer, Stage::water);
  const std::span<const int> changed = m_materials.refresh(m_params.moisture.refresh_tolerance);
  m_surface_moduli.find_above(changed, result.stiffness);
  for (const int tet : changed)
    if (m_state.is_at_rest && solid::is_strained(m_solid.strained(m_state.solid.plastic_strain), tet))
      m_state.is_at_rest = false;
  if (changed.empty()) return StepStatus::ok();
  if (m_params.water.adds_mass && m_params.solid.gravity.norm() > 0.0) m_state.is_at_rest = false;
  if (!(m_params.water.swelling > 0.0)) return StepStatus::ok();
  m_state.is_at_rest = false;
  return solid::update_kinematics(m_solid, m_region, m_state.solid.x, tick());
}

StepStatus BodySide::predict(const ContactLoad& load) {
  const StageScope scope(m_observer, Stage::assemble);
  m_force.update_total();
  m_loads.contacts = load.stiffness;
  m_loads.mobility = nullptr;
  if (load.patch.is_pressed)
    m_loads.mobility = [this, &load](Eigen::Index node) { return clay_factor(node, load.patch); };
  constexpr double kLongWay = 0.03;  // over the patch: shorter ones leave 0.5 % of a friction of 0.2
  m_loads.follows_turns = load.way_over_patch > kLongWay && !m_flow.is_anywhere();
  m_economy.set_budget(m_loads);
  m_has_begun_solid = true;
  return solid::begin_step(m_solid, m_region, m_state.solid, m_loads,
                           {m_params.rates.step_seconds(), time_at_end(), tick()});
}

/// True when nothing is left to solve for, also because the body stops where it is (`economy.h`).
bool BodySide::assemble_or_stop() {
  const StageScope scope(m_observer, Stage::assemble);
  const bool is_solved = solid::assemble(m_solid, m_region, m_loads);
  m_error.check_last_step();
  return m_economy.stops(m_state, m_loads, m_force.contacts(), m_flow.is_anywhere()) || is_solved;
}

StepStatus BodySide::solve(bool& is_solved) {
  const StageScope scope(m_observer, Stage::solve);
  return solid::solve(m_solid, m_region, m_loads, tick(), is_solved);
}

/// The deflection of the body under the tool lets the forces of its contacts fall: those on the body, and of
/// the last detection those that the hand feels. With one detection a step, both are equal and opposite.
void BodySide::apply_deflection(const ContactLoad& load, StepResult& result) {
  const StageScope scope(m_observer, Stage::solve);
  solid::apply_contact_stiffness(m_solid, load.stiffness, m_force.contacts().at);
  PressedMoments pressed;
  for (std::size_t i = load.last_detection; i < load.stiffness.size(); ++i) {
    const Vec3 at_rest = load.levers[i].force_at_rest * load.stiffness[i].normal;
    const Vec3 change =
        load.detections * (at_rest + solid::compute_contact_change(m_solid, load.stiffness, i));
    result.felt.force -= change;
    if (load.stiffness[i].friction > 0.0) result.friction -= change;
    result.felt.torque -= (load.levers[i].point - load.hand.tool.position).cross(change);
    add_pressed(load, i, change, pressed);
  }
  result.pressed = pressed.find_patch();
}

/// What the hand carries the answer on by.
void BodySide::find_pressed(const ContactLoad& load, StepResult& result) {
  if (!m_params.carries_force_on()) return;
  const StageScope scope(m_observer, Stage::solve);
  if (!result.has_moved) {
    PressedMoments pressed;
    for (std::size_t i = load.last_detection; i < load.stiffness.size(); ++i)
      add_pressed(load, i, Vec3::Zero(), pressed);
    result.pressed = pressed.find_patch();
  }
  const contact::Pose& tool = m_state.hand.tool;
  const contact::Pose& before = m_committed.hand.tool;
  const bool is_same = !result.has_moved && tool.position == before.position &&
                       tool.orientation.coeffs() == before.orientation.coeffs();
  if (!is_same) find_compliance(load, result.pressed);
  result.pressed.compliance = m_state.compliance;
}

/// Of the place that the contacts press on, or soon will; zero where a solve does not come to its end.
void BodySide::find_compliance(const ContactLoad& load, PressedPatch& pressed) {
  m_state.compliance.setZero();
  if (!m_params.solid.solves_contact() || !share_force(load, pressed)) return;
  m_has_begun_solid = true;  // its solver may be taken back
  const solid::Part& part = m_region.part();
  solid::prepare_response(m_solid, part, m_state.solid, m_params.rates.step_seconds());
  find_drift();
  const double tau = solid::compute_tau(m_params.solid.integrator, m_params.rates.step_seconds());
  const bool goes_aside = m_params.contact.friction > 0.0 || load.mode == device::ToolMode::pull;
  for (int k = 0; k < (goes_aside ? 3 : 1); ++k) {
    const Vec3 along = goes_aside ? Vec3(Vec3::Unit(k)) : load.inward;
    m_push.noalias() = along * m_shares;
    if (!solid::find_response(m_solid, part, m_push, tick(), m_response).is_ok()) {
      m_state.compliance.setZero();
      pressed.drift.setZero();
      return;
    }
    const Vec3 way = solid::find_contact_share(m_solid) * m_response * m_shares.transpose();
    m_state.compliance += way * along.transpose();
    pressed.drift += m_drift.cwiseProduct(m_response).sum() / (tau * tau) * along;  // fᵀ A⁻¹ = uᵀ/τ²
  }
}

/// A unit of force among the nodes, as the answer presses; of a grip, whose forces may cancel out, and of
/// what only comes near, as their springs share it. False where nothing touches a body that yields.
bool BodySide::share_force(const ContactLoad& load, const PressedPatch& pressed) {
  if (load.inward.isZero(0.0)) return false;
  m_shares.setZero(m_state.solid.x.cols());
  if (pressed.springs > 0.0)
    for (const int node : m_force.contacts().nodes())
      m_shares(node) = load.inward.dot(m_force.contacts().at.col(node));
  if (!(m_shares.sum() > 0.0)) {
    m_shares.setZero();
    for (std::size_t i = load.last_detection; i < load.stiffness.size(); ++i) {
      const solid::PointStiffness& entry = load.stiffness[i];
      for (std::size_t k = 0; k < entry.count() && entry.friction == 0.0; ++k)
        m_shares(entry.vertex[k]) += entry.weight[k] * entry.stiffness;
    }
  }
  const double sum = m_shares.sum();
  if (!(sum > 0.0)) return false;
  m_shares /= sum;
  return true;
}

/// Momentum times time by which the body goes on in the next step if the forces stay as they are:
/// with each integrator it goes A⁻¹ ((M + τ D) h v' + τ M (v' − v)), where v' − v is h times its acceleration
/// and D the damping.
void BodySide::find_drift() {
  const solid::SolidParams& p = m_params.solid;
  const Points& v = m_state.solid.v;
  const Points& before = m_solid.committed.v;
  const Field& mass = m_solid.materials.mass();
  const double h = m_params.rates.step_seconds();
  const double tau = solid::compute_tau(p.integrator, h);
  m_drift.setZero(3, v.cols());
  if (p.rayleigh_stiffness > 0.0)
    solid::compute_stiffness_product(m_solid, m_region.part(), v, tau * h * p.rayleigh_stiffness, 0.0,
                                     m_drift);
  m_region.part().nodes.each(v.cols(), [&](std::ptrdiff_t n) {
    const Vec3 way = (1.0 + tau * p.rayleigh_mass) * h * v.col(n) + tau * (v.col(n) - before.col(n));
    m_drift.col(n) += mass(n) * way;
  });
}

/// v ← G_d^{h/h_ref}(r) v with r from the point of contact (eq. 9). A body that nothing presses is left free,
/// else clay held in mid-air would freeze in whatever shape it has.
void BodySide::scale_velocity(const ContactPatch& patch) {
  const StageScope scope(m_observer, Stage::solve);
  if (!patch.is_pressed || m_params.kernel.form == material::KernelForm::off) return;
  m_region.part().nodes.each(m_state.solid.v.cols(), [&](std::ptrdiff_t v) {
    if (!m_state.solid.v.col(v).isZero(0.0)) m_state.solid.v.col(v) *= clay_factor(v, patch);
  });
}

double BodySide::clay_factor(Eigen::Index node, const ContactPatch& patch) const {
  const double r = (m_state.solid.x.col(node) - patch.centre).norm();
  return material::compute_clay_factor(r, m_params.kernel, m_params.rates.step_seconds());
}

/// Books what hand, loads and supports gave the body in the step just taken. Where it moves with many times
/// the energy that they ever gave it, the run stops or the body is slowed down: no body does so, a scheme
/// past its limit does. Clay that swells is left alone: its water gives it energy, too, that no one books.
StepStatus BodySide::check_energy() {
  const StageScope scope(m_observer, Stage::kinematics);
  if (m_params.energy_limit == 0.0 || m_params.water.swelling > 0.0) return StepStatus::ok();
  constexpr double kSpeed = 1e-3;  // [m/s] of a body that counts as still: below is what a loose solve leaves
  const Points& x = m_state.solid.x;
  const Field& mass = m_solid.materials.mass();
  m_state.energy_given += m_region.part().nodes.sum(x.cols(), [&](std::ptrdiff_t n) {
    const Vec3 path = x.col(n) - m_solid.committed.x.col(n);
    const Vec3 load = m_force.loads().col(n) + mass(n) * m_params.solid.gravity;
    const Vec3 reaction = (m_solid.model.constraints.support.col(n).array() >= 0)
                              .select(m_solid.forces.internal.col(n), Vec3::Zero());
    return std::max(0.0, path.dot(m_force.contacts().at.col(n))) + std::abs(path.dot(load)) +
           std::abs(path.dot(reaction));
  });
  const double kinetic = solid::compute_kinetic_energy(m_solid.materials, m_region.part(), m_state.solid.v);
  double bound = m_params.energy_limit * m_state.energy_given;
  if (kinetic <= bound) return StepStatus::ok();
  bound += 0.5 * kSpeed * kSpeed * mass.sum();
  if (kinetic <= bound) return StepStatus::ok();
  if (!m_params.is_strict) {
    m_limiter.scale(m_region.part(), std::sqrt(bound / kinetic), m_state.solid);
    m_limit.num_tets = m_body.mesh.num_tets();
    return StepStatus::ok();
  }
  return StepStatus::failed(
      {tick(), "solid", -1, "kinetic energy [J] of a body that was given less", kinetic, bound});
}

StepStatus BodySide::update_kinematics() {
  const StageScope scope(m_observer, Stage::kinematics);
  StepStatus status = solid::update_kinematics(m_solid, m_region, m_state.solid.x, tick());
  if (!status.is_ok() && !m_params.is_strict) {
    const solid::MotionLimit limit = m_limiter.apply(m_region.part(), m_state.solid);
    m_limit = {std::max(limit.num_tets, m_limit.num_tets), limit.worst_tet};
    status = solid::update_kinematics(m_solid, m_region, m_state.solid.x, tick());
  }
  ARGIL_TRY(status);
  solid::keep_start(m_solid, m_state.solid);
  for (const int n : m_force.contacts().nodes())
    m_state.contact_work +=
        m_force.contacts().at.col(n).dot(m_state.solid.x.col(n) - m_solid.committed.x.col(n));
  return StepStatus::ok();
}

void BodySide::flow() {
  const StageScope scope(m_observer, Stage::plasticity);
  m_state.plastic_dissipation += m_flow.apply(m_state.solid.plastic_strain);
  solid::note_flow(m_solid, m_flow.is_flowing(), m_flow.was_flowing());
  m_region.put_to_sleep(m_state.solid, m_flow.is_flowing());
}

void BodySide::find_surface(StepResult& result) {
  const StageScope scope(m_observer, Stage::plasticity);
  const Points& x = m_state.solid.x;
  result.is_whole = !m_surface.find_moved(m_region.part().nodes, x, result.moved, result.surface_x);
  if (result.is_whole) m_surface.find_positions(x, result.surface_x);
  result.has_moved = true;
}

}  // namespace argil::sim
