#include "solid/solid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solid/active_region.h"
#include "solid/frame_lag.h"
#include "solid/move.h"
#include "solid/response.h"
#include "solid/solve.h"
#include "solid/statics.h"
#include "solid/step_solver.h"

namespace argil::solid {

Solid::~Solid() = default;
Solid::Solid(Solid&&) noexcept = default;

Solid::Solid(const mesh::TetMesh& mesh, const mesh::Topology& topology, std::vector<Support> supports,
             const SolidParams& params, int threads)
    : m_body(std::make_unique<Body>(mesh, topology, std::move(supports), params, threads)),
      m_region(std::make_unique<ActiveRegion>(*m_body)) {}

SolidState Solid::make_rest_state() const {
  return solid::make_rest_state(m_body->model);
}

void Solid::set_material(int tet, const TetMaterial& material) {
  m_region->wake_tet(tet);
  m_body->materials.set_moduli(tet, material);
  m_body->system.is_tet_changed[static_cast<std::size_t>(tet)] = 1;
  m_body->energies.is_batch_new[static_cast<std::size_t>(tet / kLanes)] = 1;
}

void Solid::set_anisotropic_stiffness(int tet, const Mat6& C) {
  m_body->materials.set_stiffness(tet, C);
  m_body->system.is_tet_changed[static_cast<std::size_t>(tet)] = 1;
}

void Solid::set_swelling(int tet, double volume_ratio) {
  m_body->materials.set_swelling(tet, volume_ratio);
  m_body->kinematics.drop_frame(tet);
  m_body->system.is_tet_changed[static_cast<std::size_t>(tet)] = 1;
}

void Solid::set_water_mass(int tet, double mass) {
  m_body->materials.set_water_mass(tet, mass);
  for (const int node : m_body->model.elements.nodes.col(tet))
    if (const int row = m_body->model.row_of_node[static_cast<std::size_t>(node)]; row >= 0)
      m_body->system.is_row_stale[static_cast<std::size_t>(row)] = 1;
}

StepStatus Solid::update_kinematics(const Points& x, Tick tick) {
  const FrameUpdate frames{find_frame_tolerance(*m_body), false};
  return solid::update_kinematics(*m_body, m_region->start_part(), x, frames, tick);
}

StepStatus Solid::restore_kinematics(const Points& x, Tick tick) {
  const FrameUpdate frames{find_frame_tolerance(*m_body), has_lagging_frames(*m_body)};
  return solid::update_kinematics(*m_body, m_region->start_part(), x, frames, tick);
}

/// Where the step begins. Of nodes that sleep all is as it was in the last step.
void Solid::take_up(const SolidState& state) {
  SolidState& start = m_body->committed;
  const Part& part = m_region->start_part();
  part.nodes.each(state.x.cols(), [&](std::ptrdiff_t n) {
    start.x.col(n) = state.x.col(n);
    start.v.col(n) = state.v.col(n);
  });
  start.x_before = state.x_before;
  start.v_before = state.v_before;
  m_body->plastic_strain = &state.plastic_strain;
  start_from_committed(*m_body, part);
  m_region->set_start_known();
}

StepStatus Solid::begin_step(const SolidState& state, const StepLoads& loads, double step_s, double time,
                             Tick tick) {
  take_up(state);
  const bool has_moved = predict(*m_body, m_region->part(), loads, step_s, time);
  return has_moved ? update_kinematics(m_body->trial.x, tick) : StepStatus::ok();
}

bool Solid::assemble(const StepLoads& loads) {
  return solid::assemble(*m_body, *m_region, loads);
}

StepStatus Solid::solve(const StepLoads& loads, Tick tick, bool& solved) {
  return solid::solve(*m_body, *m_region, loads, tick, solved);
}

Vec3 Solid::find_free_part(const Vec3& force, Eigen::Index node) const {
  return solid::find_free_part(m_body->model, force, node);
}

Vec3 Solid::find_imbalance(const StepLoads& loads, Eigen::Index node) const {
  return solid::find_imbalance(*m_body, loads, node);
}

double Solid::compute_imbalance(const StepLoads& loads) const {
  const Field& mass = m_body->materials.mass();
  return std::sqrt(moving_nodes().sum(mass.size(), [&](std::ptrdiff_t n) {
    if (!is_awake(n)) return 0.0;
    const Vec3 momentum_rate = mass(n) / m_body->prediction.tau * m_body->committed.v.col(n);
    return (find_imbalance(loads, n) + momentum_rate).squaredNorm();
  }));
}

void Solid::finish_step(SolidState& state) const {
  take_velocity(*m_body, m_region->part(), state);
}

void Solid::move(SolidState& state) const {
  solid::move(*m_body, m_region->part(), state);
}

void Solid::keep_start(SolidState& state) const {
  if (m_body->model.params.integrator != Integrator::bdf2) return;
  state.x_before = m_body->committed.x;
  state.v_before = m_body->committed.v;
}

void Solid::settle_region(SolidState& state, const std::vector<char>& is_flowing) {
  m_region->put_to_sleep(state, is_flowing);
}

void Solid::wake_all() {
  m_region->wake_all();
}

void Solid::sleep_all() {
  m_region->sleep_all();
}

void Solid::make_ready(const SolidState& state, const Points& force) {
  take_up(state);
  m_region->make_ready(force);
  if (!m_body->is_explicit()) m_body->history.solver->prepare(m_body->system.matrix);
}

bool Solid::is_awake(Eigen::Index node) const {
  return m_region->is_awake(node);
}

bool Solid::has_any_moving(const std::vector<char>& of_batch) const {
  const auto is_set = [&](int batch) { return of_batch[static_cast<std::size_t>(batch)] != 0; };
  const std::vector<int>* batches = moving_batches().visited();
  if (batches) return std::any_of(batches->begin(), batches->end(), is_set);
  return std::any_of(of_batch.begin(), of_batch.end(), [](char c) { return c != 0; });
}

double Solid::held_back() const {
  return m_region->held_back();
}

int Solid::num_active() const {
  return m_region->num_active();
}

Vec3 Solid::compute_contact_change(std::span<const PointStiffness> contacts, std::size_t i) const {
  const SolidParams& params = m_body->model.params;
  if (!params.implicit_contact || m_body->is_explicit()) return Vec3::Zero();
  // Newmark's step takes the mean of both ends.
  const double share = params.integrator == Integrator::newmark ? 0.5 : 1.0;
  return -share * m_body->step_contacts(contacts).compute_fall(i, m_body->trial.x, m_body->contacts);
}

bool Solid::acts(int group) const {
  return m_body->contacts.is_acting(group);
}

void Solid::apply_contact_stiffness(std::span<const PointStiffness> contacts, Points& force) const {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    spread(contacts[i], compute_contact_change(contacts, i), force);
}

StepStatus Solid::find_equilibrium(SolidState& state, const StepLoads& loads) {
  wake_all();
  m_body->plastic_strain = &state.plastic_strain;
  return solid::find_equilibrium(*m_body, m_region->whole(), loads, state);
}

void Solid::prepare_response(const SolidState& state, double step_s) {
  m_body->plastic_strain = &state.plastic_strain;
  solid::prepare_response(*m_body, m_region->part(), state, step_s);
}

StepStatus Solid::find_response(const Points& force, Tick tick, Points& displacement) {
  return solid::find_response(*m_body, m_region->part(), force, tick, displacement);
}

Mat3 Solid::compute_local_response(int node) const {
  return solid::compute_local_response(*m_body, node);
}

void Solid::exchange_state(Archive& archive) {
  SolverHistory& history = m_body->history;
  System& system = m_body->system;
  archive.number("solid/newton_iterations", history.counters.newton_iterations);
  archive.number("solid/linear_iterations", history.counters.linear_iterations);
  archive.number("solid/residual", history.counters.residual);
  bool stores_nodal = system.has_nodal_blocks(m_body->materials);
  archive.number("solid/stores_nodal", stores_nodal);
  if (stores_nodal) store_nodal_stiffness(m_body->model, m_body->materials, system);
  history.solver->exchange_state(archive, "solver/", system.matrix);
  m_region->serialize_use(archive);
  bool has_response_solver = history.response_solver != nullptr;
  archive.number("response/is_known", has_response_solver);
  if (!has_response_solver) return;
  const SolidParams& params = m_body->model.params;
  if (!history.response_solver)
    history.response_solver = linear::make_solver(make_exact(params.solver), m_body->model.threads);
  history.response_solver->exchange_state(archive, "response/", system.matrix);
}

void Solid::exchange_frames(Archive& archive) {
  m_region->serialize(archive);
  if (archive.is_restoring()) {
    m_region->forget();
    m_body->system.mark_all_changed();
    std::fill(m_body->energies.is_batch_new.begin(), m_body->energies.is_batch_new.end(), char{1});
  }
  FrameLag& lag = m_body->history.frame_lag;
  archive.number("solid/frame_slack", lag.slack);
  archive.number("solid/frame_error", lag.left);
  archive.number("solid/frame_error_way", lag.lag_speed);
  archive.number("solid/frame_error_steps", lag.steps);
  if (has_lagging_frames(*m_body)) m_body->kinematics.exchange_frames(archive);
}

const Elements& Solid::elements() const {
  return m_body->model.elements;
}

const Constraints& Solid::constraints() const {
  return m_body->model.constraints;
}

const TensorField& Solid::strain() const {
  return m_body->kinematics.strain();
}

const Field& Solid::mass() const {
  return m_body->materials.mass();
}

const Field& Solid::weight() const {
  return m_body->materials.weight();
}

TetMaterial Solid::material(int tet) const {
  return m_body->materials.of(tet);
}

const StepCounters& Solid::counters() const {
  return m_body->history.counters;
}

const linear::SolverCost& Solid::solver_cost() const {
  return m_body->history.solver->cost();
}

bool Solid::is_strained(int tet, const TensorField& plastic_strain) const {
  return solid::is_strained(m_body->strained(plastic_strain), tet);
}

double Solid::min_volume_ratio() const {
  return m_body->kinematics.min_volume_ratio();
}

int Solid::num_free() const {
  return m_body->model.num_free();
}

const OrderedItems& Solid::moving_nodes() const {
  return m_region->part().nodes;
}

const OrderedRuns& Solid::moving_batches() const {
  return m_region->part().batches;
}

const Points& Solid::x_start() const {
  return m_body->committed.x;
}

const Points& Solid::v_start() const {
  return m_body->committed.v;
}

const Points& Solid::internal_force() const {
  return m_body->forces.internal;
}

double Solid::compute_elastic_energy(int point, const Vec6& plastic_strain) const {
  return solid::compute_elastic_energy(m_body->strained(), point, plastic_strain);
}

Vec6 Solid::compute_flow_drive(int point, const Vec6& plastic_strain, double shape_stiffness) const {
  const Strained body = m_body->strained();
  return solid::compute_flow_drive(body.law(), body.kinematics.at(point), plastic_strain,
                                   body.elasticity(body.model.elements.tet_of_point(point)), shape_stiffness);
}

double Solid::compute_elastic_energy(const TensorField& plastic_strain) const {
  return solid::compute_elastic_energy(m_body->strained(plastic_strain), m_body->scratch.nodal.change);
}

StrainSummary Solid::summarise(const TensorField& plastic_strain) const {
  return solid::summarise(m_body->strained(plastic_strain), m_body->energies, m_body->scratch.nodal.change);
}

double Solid::compute_kinetic_energy(const SolidState& state) const {
  return solid::compute_kinetic_energy(m_body->materials, m_region->part(), state.v);
}

}  // namespace argil::solid
