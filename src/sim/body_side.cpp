#include "sim/body_side.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/check.h"
#include "sim/extent.h"
#include "solid/committed.h"
#include "solid/material_changes.h"
#include "solid/statics.h"
#include "solid/step_solver.h"

namespace argil::sim {

namespace {

/// Of one linearisation: Newton's iteration asks for the forces at held plastic strain.
solid::SolidParams make_solid_params(const Params& params) {
  solid::SolidParams solid = params.solid;
  solid.flows_in_solve = params.plasticity.enabled && params.plasticity.form == material::FlowForm::j2 &&
                         solid.iteration == solid::Iteration::one;
  if (params.carries_force_on()) solid.response_tolerance = solid.solver.tolerance;
  return solid;
}

}  // namespace

BodySide::BodySide(Body body, const Params& params)
    : m_params(params),
      m_body(std::move(body)),
      m_solid(m_body.mesh, m_body.topology, m_body.supports, make_solid_params(params), params.threads),
      m_region(m_solid, restricts_to_region(params, m_body.supports, m_solid.model.num_free())),
      m_water(m_body.mesh, m_body.topology, params.water, m_body.initial_saturation, params.threads),
      m_surface(params.contact_surface, params.contact.law, m_body, m_solid.model.elements),
      m_surface_moduli(m_surface, m_solid, params.contact),
      m_force(solid::compute_load_force(m_solid.model.elements, m_body.topology.boundary, m_body.loads)),
      m_loads{m_force.total()},
      m_materials(m_body, params, m_water, m_solid, m_region),
      m_flow(params, m_solid, m_region),
      m_economy(params, m_body, m_solid, m_region),
      m_error(params, m_solid, m_region),
      m_limiter(m_solid) {
  m_loads.changed = &m_force.changed();
  m_state.solid = solid::make_rest_state(m_solid.model);
  StepStatus rest = solid::update_kinematics(m_solid, m_region, m_state.solid.x, 0);
  ARGIL_ASSERT(rest.is_ok());
  m_economy.begin(m_state, params.solid.gravity.norm() > 0.0 || m_force.loads().norm() > 0.0);
  m_materials.set_all();
  for (Eigen::Index t = 0; t < m_body.rest_volume_ratio.size(); ++t)
    solid::set_swelling(m_solid, static_cast<int>(t), m_body.rest_volume_ratio(t));
  const bool is_swollen = m_body.rest_volume_ratio.size() > 0 ||
                          (params.water.swelling > 0.0 && (m_water.saturation().array() != 0.0).any());
  if (is_swollen) {  // dry clay has the size that it came with
    m_state.is_at_rest = false;
    rest = solid::update_kinematics(m_solid, m_region, m_state.solid.x, 0);
    ARGIL_ASSERT(rest.is_ok());
  }
  if (m_state.is_at_rest) m_region.sleep_all();
  solid::make_ready(m_solid, m_region, m_state.solid, m_force.total());
  solid::commit(m_solid, m_region, m_state.solid);
  commit();
}

void BodySide::go_on_from(const BodySide& before, const RemappedState& clay) {
  constexpr double kRounding = 1e-14;
  static_cast<BodyProgress&>(m_state) = before.m_state;
  m_state.is_at_rest = false;
  m_state.solid.v = (m_solid.model.constraints.support.array() < 0).select(clay.v.array(), 0.0);
  water::WaterState water = m_water.state();
  water.initial = before.m_water.state().initial;
  water.added = before.m_water.state().added;
  water.removed = before.m_water.state().removed;
  const double lost = before.m_water.mass() - m_water.mass();  // what full cells have no room for
  if (lost > kRounding * before.m_water.mass()) water.removed.add(lost);
  m_water.restore(water);
  m_region.wake_all();
  m_error.go_on_from(before.m_error);
  begin_strained(clay.elastic);
}

/// In the shape of its mesh, F = J^⅓ 1 of the volume J over that at rest, so that C_p = J^⅔ b⁻¹.
void BodySide::begin_strained(const TensorField& elastic) {
  const int points_per_tet = m_solid.model.elements.points_per_tet;
  for (int point = 0; point < m_solid.model.elements.num_points(); ++point) {
    const int tet = point / points_per_tet;
    m_state.solid.plastic_strain.col(point) = -elastic.col(point);
    m_state.solid.plastic_strain.col(point).head<3>().array() -=
        std::log(m_body.rest_volume_ratio(tet)) / 3.0;
  }
  m_state.solid.x = m_solid.model.elements.rest;
  solid::forget(m_solid, m_region);
  const StepStatus status = solid::update_kinematics(m_solid, m_region, m_state.solid.x, m_state.hand.ticks);
  ARGIL_ASSERT(status.is_ok());
  solid::set_start(m_solid, m_region, m_state.solid);
  solid::commit(m_solid, m_region, m_state.solid);
  commit();
}

/// By turns to the elastic equilibrium, which is the nearest stress in balance, and to the nearest within the
/// strength; both sets are convex, so that the turns lead to a stress in both, where there is one. Sooner
/// where each return goes on beyond [Agmon1954].
double BodySide::balance(const Points& contact_force) {
  constexpr int kTurns = 20;
  constexpr double kEnough = 1e-3;  // past the strength
  const Points v = m_state.solid.v;
  const Points force = m_force.loads() + contact_force;
  TensorField balanced = find_elastic_strain(m_solid);  // of the last turn that came to an end
  double beyond = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < kTurns && beyond >= kEnough; ++turn) {
    using Accuracy = solid::EquilibriumAccuracy;
    const StepStatus status = solid::find_equilibrium(m_solid, m_region.whole(), {force}, m_state.solid,
                                                      turn == 0 ? Accuracy::rough : Accuracy::rough_again);
    if (status.is_ok()) balanced = find_elastic_strain(m_solid);
    TensorField elastic = balanced;
    if (status.is_ok() && turn + 1 < kTurns) beyond = limit_to_strength(elastic);
    m_state.solid.v = v;
    begin_strained(elastic);
    if (!status.is_ok()) return std::numeric_limits<double>::infinity();
  }
  return beyond;
}

StepStatus BodySide::settle(const ContactLoad& load, StepResult& result) {
  const BodyProgress before = m_state;
  const Points v = m_state.solid.v;
  m_state.solid.v.setZero();
  begin_step(load, result);
  ARGIL_TRY(step_solid(load, result));
  static_cast<BodyProgress&>(m_state) = before;
  m_state.solid.v = v;
  return StepStatus::ok();
}

/// And on as far again, all but a fifth. Returns by what share the farthest was beyond.
double BodySide::limit_to_strength(TensorField& elastic) const {
  constexpr double kFarther = 1.8;
  double farthest = 0.0;
  for (Eigen::Index point = 0; point < elastic.cols(); ++point) {
    Vec6 deviator = elastic.col(point);
    deviator.head<3>().array() -= elastic.col(point).head<3>().mean();
    const double yield = m_solid.materials.yield()(point);
    const double norm = deviator.norm();
    if (!(norm > yield)) continue;
    farthest = std::max(farthest, norm / yield - 1.0);
    elastic.col(point) -= kFarther * (1.0 - yield / norm) * deviator;
  }
  return farthest;
}

StepStatus BodySide::find_equilibrium() {
  m_region.wake_all();
  ARGIL_TRY(solid::find_equilibrium(m_solid, m_region.whole(), {m_force.loads()}, m_state.solid));
  solid::commit(m_solid, m_region, m_state.solid);
  commit();
  return StepStatus::ok();
}

BodyBetweenSteps BodySide::between_steps(Tick tick) {
  return {m_solid, m_region.part(), m_surface, m_state.solid, m_params.rates.step_seconds(), tick};
}

StepStatus BodySide::step(const ContactLoad& load, StepResult& result) {
  const StepStatus status = make_step(load, result);
  if (status.is_ok()) find_pressed(load, result);
  result.error = m_error.rates(m_economy);
  result.is_limited = m_limit.num_tets > 0;
  if (status.is_ok() || m_params.is_strict) return status;
  hold_still(load, status.failure(), result);
  return StepStatus::ok();
}

/// In the place of a step that failed: the body, its water too, is as it was, without speed.
void BodySide::hold_still(const ContactLoad& load, const Failure& failure, StepResult& result) {
  roll_back();
  begin_step(load, result);
  result.is_held = true;
  m_limit = {m_body.mesh.num_tets(), failure.element};
  m_state.solid.v.setZero();
  m_has_begun_solid = true;
  solid::set_start(m_solid, m_region, m_state.solid);
}

StepStatus BodySide::make_step(const ContactLoad& load, StepResult& result) {
  begin_step(load, result);
  if (m_params.rates.moves_water(m_state.steps)) ARGIL_TRY(move_water(load, result));
  if (m_economy.rests(m_state, load, m_force.contacts())) return StepStatus::ok();
  return step_solid(load, result);
}

StepStatus BodySide::step_solid(const ContactLoad& load, StepResult& result) {
  ARGIL_TRY(find_velocity(load));
  if (m_state.is_at_rest) return StepStatus::ok();
  return move_solid(load, result);
}

void BodySide::begin_step(const ContactLoad& load, StepResult& result) {
  ++m_state.steps;
  m_state.hand = load.hand;
  m_force.set_contacts(load, m_surface);
  m_error.begin_step(load);
  result.step = m_state.steps;
  result.has_moved = false;
  result.is_held = false;
  m_limit = {};
  result.felt = load.hand.felt;
  result.stiffness.clear();
  result.friction.setZero();
  for (const solid::PointStiffness& entry : load.stiffness)
    if (entry.friction > 0.0 && !entry.is_near) result.friction -= entry.force;
  result.pressed = {};
}

/// A contact of a pressure whose force on the body has changed by this in the step.
void BodySide::add_pressed(const ContactLoad& load, std::size_t i, const Vec3& change,
                           PressedMoments& pressed) const {
  const solid::PointStiffness& entry = load.stiffness[i];
  if (!m_params.carries_force_on() || !entry.is_alone) return;
  const double force = entry.normal.dot((entry.is_near ? Vec3(Vec3::Zero()) : entry.force) + change);
  pressed.add(load.levers[i].point, force, entry.stiffness);
}

void BodySide::commit() {
  const bool falls_asleep = m_state.is_at_rest && !m_committed.is_at_rest;
  if (m_has_begun_solid || m_has_moved_water || falls_asleep)
    solid::commit(m_solid, m_region, m_state.solid, m_flow.is_flowing());
  m_committed = m_state;
  if (m_has_moved_water) m_water.commit();
  m_materials.commit();
  m_flow.commit();
  m_economy.commit();
  m_error.commit();
  m_has_moved_water = m_has_begun_solid = false;
}

void BodySide::roll_back() {
  static_cast<BodyProgress&>(m_state) = m_committed;
  if (m_has_moved_water) m_water.roll_back();
  m_materials.roll_back();
  m_flow.roll_back();
  m_economy.roll_back();
  m_error.roll_back();
  const StepStatus status = solid::roll_back(m_solid, m_region, m_state.solid, tick());
  ARGIL_ASSERT(status.is_ok());
  m_has_moved_water = m_has_begun_solid = false;
}

}  // namespace argil::sim
