// A step of the solid in time: prediction, residual, Newton's line search. Linear solves are in solve.cpp.

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/ordered_sum.h"
#include "base/parallel.h"
#include "solid/solid.h"

namespace argil::solid {
namespace {

constexpr double kRounding = 16.0 * std::numeric_limits<double>::epsilon();

double sum_products(const Points& a, const Points& b) {
  return ordered_sum(a.cols(), [&](std::ptrdiff_t i) { return a.col(i).dot(b.col(i)); });
}

}  // namespace

StepStatus Solid::begin_step(const SolidState& state, const StepLoads& loads, double step_s, double time,
                             Tick tick) {
  m_is_static = false;
  m_load_share = 1.0;
  m_counters = {};
  m_iterations = 0;
  start_contacts(loads.contacts.size());
  m_plastic_strain = &state.plastic_strain;
  take_up(state);
  keep_damping_frame();
  predict(state, loads, step_s);
  const bool has_moved = place_supports(time, 1.0);
  if (!is_explicit())
    each_node([&](std::ptrdiff_t n) { m_v.col(n) = (m_x.col(n) - m_x_hat.col(n)) / m_tau; });
  // Held components go at their mean velocity; Newmark's own rule would let it swing about that.
  for (const auto& [n, k] : m_placed_components) m_v(k, n) = (m_held_x(k, n) - state.x(k, n)) / step_s;
  if (is_explicit()) m_x = state.x;  // forces are those of the start
  return has_moved && !is_explicit() ? update_kinematics(m_x, tick) : StepStatus::ok();
}

/// Where the step begins. Of nodes that sleep all is as it was in the last step.
void Solid::take_up(const SolidState& state) {
  if (m_has_old_nodes) m_nodes.visit(nullptr);
  each_node([&](std::ptrdiff_t n) {
    m_x_start.col(n) = m_x_hat.col(n) = m_x.col(n) = state.x.col(n);
    m_v_start.col(n) = m_v_hat.col(n) = m_v.col(n) = state.v.col(n);
  });
  if (m_has_old_nodes && m_region) m_nodes.visit(&m_region->nodes());
  m_has_old_nodes = false;
}

/// Newton's method damps in the frame of the step's start, so that a step has a potential.
void Solid::keep_damping_frame() {
  if (is_newton() && m_params.rayleigh_stiffness > 0.0)
    m_kept_rotation = m_kinematics.rotation();
  else
    m_kept_rotation.resize(3, 0);
}

double compute_tau(Integrator integrator, double step_s) {
  switch (integrator) {
    case Integrator::bdf2:
      return 2.0 / 3.0 * step_s;
    case Integrator::newmark:
      return 0.5 * step_s;
    case Integrator::backward_euler:
    case Integrator::symplectic_euler:
      break;
  }
  return step_s;
}

/// The first step of bdf2 has no past and is backward Euler's.
double Solid::find_tau(const SolidState& state, double step_s) const {
  const bool has_past = m_params.integrator != Integrator::bdf2 || state.x_before.size() > 0;
  return has_past ? compute_tau(m_params.integrator, step_s) : step_s;
}

/// x̂, v̂, τ of each integrator.
void Solid::predict(const SolidState& state, const StepLoads& loads, double step_s) {
  m_tau = find_tau(state, step_s);
  switch (m_params.integrator) {
    case Integrator::backward_euler:
    case Integrator::symplectic_euler:
      return;
    case Integrator::bdf2:
      if (state.x_before.size() == 0) return;
      m_x_hat = (4.0 * state.x - state.x_before) / 3.0;
      m_v_hat = (4.0 * state.v - state.v_before) / 3.0;
      return;
    case Integrator::newmark:
      break;
  }
  // Average acceleration: v' = v + ½h(a + a'), x' = x + ½h(v + v').
  m_v = state.v;
  m_v_hat = state.v;
  compute_residual(loads);  // τ (f_ext − f_int − D v) at the start
  for (int row = 0; row < num_free(); ++row) {
    const int node = m_node_of_row[static_cast<std::size_t>(row)];
    m_v_hat.col(node) = state.v.col(node) + m_rhs.col(row) / m_mass(node);
  }
  m_x_hat = state.x + m_tau * state.v;
}

/// Puts the prescribed components of m_x where they are at `time`. True when any of them moved.
bool Solid::place_supports(double time, double share) {
  bool has_moved = false;
  m_is_shifted = false;
  for (const auto& [n, k] : m_placed_components) {
    const auto support = static_cast<std::size_t>(m_constraints.support(k, n));
    m_held_x(k, n) = m_elements.rest(k, n) + share * compute_displacement(m_supports[support], time)(k);
    has_moved = has_moved || m_x(k, n) != m_held_x(k, n);
    m_is_shifted = m_is_shifted || m_held_x(k, n) != m_elements.rest(k, n);
    m_x(k, n) = m_held_x(k, n);
  }
  return has_moved;
}

/// What gravity acts on: in time the lumped mass, so that a free body falls as one; in statics ρ∫N dV, the
/// elements' own load.
double Solid::gravity_mass(Eigen::Index node) const {
  return m_is_static ? m_static_mass(node) : m_mass(node);
}

/// What rounding alone may leave of the sum of internal forces at each node [N]: that of its tets' corner
/// forces, and of positions, ε |x| times their stiffness, as independent errors. Nothing smaller can be asked
/// for, and a body at rest has nothing else. By nodes, so that a stiff or thin tet does not speak for the
/// others.
void Solid::set_rounding() {
  constexpr double kOperations = 8.0;  // roundings on the way from x to a point's force
  constexpr double kLarger = 4.0;      // than its size to be expected is what some of many errors come to
  const double rounding = kOperations * std::numeric_limits<double>::epsilon() * m_x.cwiseAbs().maxCoeff();
  const int N = m_elements.nodes_per_tet;
  const int Q = m_elements.points_per_tet;
  m_corner_scale = m_corner_force.squaredNorm();
  m_rounding.resize(m_elements.num_nodes());
  parallel_for(m_elements.num_nodes(), m_threads, [&](std::ptrdiff_t node) {
    double squares = 0.0;
    for (int c = m_elements.node_begin[static_cast<std::size_t>(node)];
         c < m_elements.node_begin[static_cast<std::size_t>(node) + 1]; ++c) {
      const int corner = m_elements.node_corners[static_cast<std::size_t>(c)];
      const TetMaterial& material = m_material[static_cast<std::size_t>(corner / N)];
      double stiffness = 0.0;
      for (Eigen::Index p = Q * (corner / N); p < Q * (corner / N + 1); ++p)
        stiffness += (material.lambda + 2.0 * material.mu) * m_elements.weight(p) *
                     m_elements.gradient.col(N * p + corner % N).norm() *
                     m_elements.gradient.middleCols(N * p, N).norm();
      squares +=
          std::pow(rounding * stiffness, 2) + std::pow(kRounding * m_corner_force.col(corner).norm(), 2);
    }
    m_rounding(node) = kLarger * std::sqrt(squares);
  });
}

/// Norm of the residual beyond what rounding leaves of it.
double Solid::compute_excess() const {
  return std::sqrt(ordered_sum(num_free(), [&](std::ptrdiff_t row) {
    const int node = m_node_of_row[static_cast<std::size_t>(row)];
    return std::pow(std::max(0.0, m_rhs.col(row).norm() - m_tau * m_rounding(node)), 2);
  }));
}

/// r = M (v̂ − v) + τ (f_ext + M g − f_int − D v) less the fall of the contacts' forces; statics: the forces
/// alone.
void Solid::compute_residual(const StepLoads& loads) {
  if (is_newton() || m_iterations == 0) assemble_internal_force();  // other contacts, the same place
  if (is_newton()) set_rounding();
  const bool is_viscous =
      !m_is_static && m_params.rayleigh_stiffness > 0.0 &&
      m_nodes.sum(m_v.cols(), [&](std::ptrdiff_t n) { return m_v.col(n).isZero(0.0) ? 0.0 : 1.0; }) > 0.0;
  each_node([&](std::ptrdiff_t n) { m_product.col(n).setZero(); });
  if (is_viscous) compute_stiffness_product(m_v, m_params.rayleigh_stiffness, 0.0, m_product);
  if (!m_is_static && m_params.implicit_contact)
    for (std::size_t i = 0; i < loads.contacts.size(); ++i)
      spread(loads.contacts[i], compute_contact_fall(loads.contacts, i), m_product);
  set_rhs(loads);
  if (is_newton()) set_residual_scale(loads);
}

void Solid::set_rhs(const StepLoads& loads) {
  const double a = m_is_static ? 0.0 : m_params.rayleigh_mass;
  const double inertia = m_is_static ? 0.0 : 1.0;
  m_near_rows.each(num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row) {
      const int n = m_node_of_row[static_cast<std::size_t>(row)];
      const Vec3 force =
          applied_force(loads, n) - m_internal_force.col(n) - m_product.col(n) - a * m_mass(n) * m_v.col(n);
      m_rhs.col(row) = inertia * m_mass(n) * (m_v_hat.col(n) - m_v.col(n)) + m_tau * force;
    }
  });
  for (const int row : m_held_rows)
    for (int k = 0; k < 3; ++k)
      if (m_constraints.support(k, m_node_of_row[static_cast<std::size_t>(row)]) >= 0) m_rhs(k, row) = 0.0;
}

Vec3 Solid::applied_force(const StepLoads& loads, Eigen::Index node) const {
  return m_load_share * (loads.force.col(node) + gravity_mass(node) * m_params.gravity);
}

/// What Newton's residual is small against: loads, momenta, the forces in the supports, and, so that a body
/// at rest is found to be so, the rounding of corner forces and of the positions that they come from.
void Solid::set_residual_scale(const StepLoads& loads) {
  const double inertia = m_is_static ? 0.0 : 1.0;
  const double given = ordered_sum(num_free(), [&](std::ptrdiff_t row) {
    const int n = m_node_of_row[static_cast<std::size_t>(row)];
    return inertia * m_mass(n) * (m_v_hat.col(n).norm() + m_v.col(n).norm()) +
           m_tau * applied_force(loads, n).norm();
  });
  const double reactions = ordered_sum(m_elements.num_nodes(), [&](std::ptrdiff_t n) {
    return (m_constraints.support.col(n).array() >= 0).select(m_internal_force.col(n), Vec3::Zero()).norm();
  });
  m_residual_scale = given + m_tau * reactions;
  m_is_driven = given > 0.0 || m_is_shifted;
  // Of the energy: force times what rounding moves each corner.
  const auto corners = static_cast<double>(m_elements.nodes.size());
  m_potential_rounding = kRounding * m_x.cwiseAbs().maxCoeff() * std::sqrt(corners * m_corner_scale);
  if (!find_law(m_params.model).has_cancelling_energy) return;
  // The law's energy is what is left of terms of the size of its moduli.
  m_potential_rounding += kRounding * ordered_sum(m_elements.num_points(), [&](std::ptrdiff_t p) {
                            const auto tet =
                                static_cast<std::size_t>(m_elements.tet_of_point(static_cast<int>(p)));
                            return (m_material[tet].lambda + m_material[tet].mu) * m_elements.weight(p);
                          });
}

bool Solid::assemble(const StepLoads& loads) {
  if (m_region && !m_is_static) wake_region(loads);
  compute_residual(loads);
  if (is_explicit()) return false;
  if (is_newton()) {
    // At least one solve where something acts: what it does may be small beside the rounding of stiffer
    // parts.
    const bool may_end = m_iterations > 0 || !m_is_driven;
    if (may_end && compute_excess() <= m_params.newton_tolerance * m_residual_scale) {
      if (!exchange_contacts(loads.contacts)) return true;
      m_iterations = 1;  // of the next round; not the step's first
      compute_residual(loads);
    }
    m_is_moved_by_load = true;
    m_potential = compute_potential(loads);
  }
  m_is_projected = !is_newton();
  assemble_matrix(loads.contacts);
  if (m_region && !m_is_static) grow_region(loads);
  return false;
}

Vec3 Solid::find_free_part(const Vec3& force, Eigen::Index node) const {
  return (m_constraints.support.col(node).array() >= 0).select(Vec3::Zero(), force);
}

Vec3 Solid::find_imbalance(const StepLoads& loads, Eigen::Index node) const {
  return find_free_part(applied_force(loads, node) - m_internal_force.col(node), node);
}

double Solid::compute_imbalance(const StepLoads& loads) const {
  return std::sqrt(m_nodes.sum(m_elements.num_nodes(), [&](std::ptrdiff_t n) {
    if (!is_awake(n)) return 0.0;
    return (find_imbalance(loads, n) + m_mass(n) / m_tau * m_v_start.col(n)).squaredNorm();
  }));
}

/// Φ with ∂Φ/∂v = −r: ½(v−v̂)M(v−v̂) + ½τ vDv + W(x) − (f_ext + M g)·(x − X) and the contacts'.
double Solid::compute_potential(const StepLoads& loads) {
  const double elastic = compute_elastic_energy(*m_plastic_strain);
  double sum = elastic;
  double magnitude = elastic;
  const auto add = [&](double term) {
    sum += term;
    magnitude += std::abs(term);
  };
  add(-m_load_share * ordered_sum(m_mass.size(), [&](std::ptrdiff_t n) {
    const Vec3 force = loads.force.col(n) + gravity_mass(n) * m_params.gravity;
    return force.dot(m_x.col(n) - m_elements.rest.col(n));
  }));
  if (!m_is_static) {
    add(ordered_sum(m_mass.size(), [&](std::ptrdiff_t n) {
      return 0.5 * m_mass(n) *
             ((m_v.col(n) - m_v_hat.col(n)).squaredNorm() +
              m_tau * m_params.rayleigh_mass * m_v.col(n).squaredNorm());
    }));
    if (m_params.rayleigh_stiffness > 0.0) {
      compute_stiffness_product(m_v, m_params.rayleigh_stiffness, 0.0, m_product);
      add(0.5 * m_tau * sum_products(m_v, m_product));
    }
    if (m_params.implicit_contact)
      for (std::size_t i = 0; i < loads.contacts.size(); ++i)
        add(compute_contact_potential(loads.contacts, i));
  }
  m_potential_scale = magnitude;
  return sum;
}

/// v = v_base + share · δ, x = x̂ + τ v.
void Solid::set_iterate(double share) {
  m_rows.each(num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row) {
      const int n = m_node_of_row[static_cast<std::size_t>(row)];
      m_v.col(n) = m_v_base.col(n) + share * m_delta.col(row);
      m_x.col(n) = m_x_hat.col(n) + m_tau * m_v.col(n);
    }
  });
  for (const auto& [n, k] : m_placed_components) {
    m_v(k, n) = m_v_base(k, n);
    m_x(k, n) = m_held_x(k, n);
  }
}

/// Halves the step until the potential falls by a share of what its slope promises [Armijo1966]. Where the
/// promise is below rounding, the full step is taken.
StepStatus Solid::search_line(const StepLoads& loads, Tick tick) {
  constexpr double kPromised = 1e-4;
  constexpr int kHalvings = 40;
  const double slope = -sum_products(m_rhs, m_delta);
  const double before = m_potential;
  const double rounding = m_potential_rounding + kRounding * m_potential_scale;
  m_v_base = m_v;
  double share = 1.0;
  StepStatus status = StepStatus::ok();
  for (int i = 0; i <= kHalvings; ++i, share *= 0.5) {
    set_iterate(share);
    status = update_motion(m_x, tick, m_kept_rotation.size() > 0);
    if (!status.is_ok()) continue;
    update_volume_change(*m_plastic_strain);
    const double after = compute_potential(loads);
    if (after <= before + kPromised * share * slope + rounding) return StepStatus::ok();
  }
  if (!status.is_ok()) return status;
  return StepStatus::failed({tick, "solid", -1, "line search: slope of the potential", slope, 0.0});
}

void Solid::finish_step(SolidState& state) const {
  each_node([&](std::ptrdiff_t n) { state.v.col(n) = m_v.col(n); });
}

void Solid::move(SolidState& state) const {
  each_node([&](std::ptrdiff_t n) { state.x.col(n) = m_x_hat.col(n) + m_tau * state.v.col(n); });
  for (const auto& [n, k] : m_placed_components) state.x(k, n) = m_held_x(k, n);
}

void Solid::keep_start(SolidState& state) const {
  if (m_params.integrator != Integrator::bdf2) return;
  state.x_before = m_x_start;
  state.v_before = m_v_start;
}

}  // namespace argil::solid
