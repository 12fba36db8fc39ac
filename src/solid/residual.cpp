// What the iterate leaves of the step's equation, and what Newton's method measures it by.

#include "solid/residual.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/ordered_sum.h"
#include "base/parallel.h"
#include "solid/body.h"
#include "solid/matrix.h"
#include "solid/product.h"

namespace argil::solid {
namespace {

constexpr double kRounding = 16.0 * std::numeric_limits<double>::epsilon();

/// What gravity acts on: in time the lumped mass, so that a free body falls as one; in statics ρ∫N dV, the
/// elements' own load.
double gravity_mass(const Body& body, Eigen::Index node) {
  return body.prediction.is_static ? body.materials.static_mass()(node) : body.materials.mass()(node);
}

/// ‖∇N‖ of a node at a point, or of all nodes [1/m].
double find_gradient_norm(const Elements& elements, const Eigen::Matrix3Xd& gradient, Eigen::Index point,
                          int node = -1) {
  const auto find = [node](const auto& of_nodes) {
    return node < 0 ? of_nodes.norm() : of_nodes.col(node).norm();
  };
  return elements.nodes_per_tet == 4 ? find(find_node_gradients<4>(gradient, point))
                                     : find(find_node_gradients<10>(gradient, point));
}

/// What rounding alone may leave of the sum of internal forces at each node [N]: that of its tets' corner
/// forces, and of positions, ε |x| times their stiffness, as independent errors. Nothing smaller can be asked
/// for, and a body at rest has nothing else. By nodes, so that a stiff or thin tet does not speak for the
/// others.
void set_rounding(Body& body) {
  constexpr double kOperations = 8.0;  // roundings on the way from x to a point's force
  constexpr double kLarger = 4.0;      // than its size to be expected is what some of many errors come to
  const double rounding =
      kOperations * std::numeric_limits<double>::epsilon() * body.trial.x.cwiseAbs().maxCoeff();
  const Elements& elements = body.model.elements;
  const Materials& materials = body.materials;
  const int N = elements.nodes_per_tet;
  const int Q = elements.points_per_tet;
  body.newton.corner_scale = body.forces.corner.squaredNorm();
  body.newton.rounding.resize(elements.num_nodes());
  parallel_for(elements.num_nodes(), body.model.threads, [&](std::ptrdiff_t node) {
    double squares = 0.0;
    for (int c = elements.node_begin[static_cast<std::size_t>(node)];
         c < elements.node_begin[static_cast<std::size_t>(node) + 1]; ++c) {
      const int corner = elements.node_corners[static_cast<std::size_t>(c)];
      const TetMaterial material = materials.of(corner / N);
      double stiffness = 0.0;
      for (Eigen::Index p = Q * (corner / N); p < Q * (corner / N + 1); ++p)
        stiffness += (material.lambda + 2.0 * material.mu) * materials.weight()(p) *
                     find_gradient_norm(elements, materials.gradient(), p, corner % N) *
                     find_gradient_norm(elements, materials.gradient(), p);
      squares +=
          std::pow(rounding * stiffness, 2) + std::pow(kRounding * body.forces.corner.col(corner).norm(), 2);
    }
    body.newton.rounding(node) = kLarger * std::sqrt(squares);
  });
}

/// What Newton's residual is small against: loads, momenta, the forces in the supports, and, so that a body
/// at rest is found to be so, the rounding of corner forces and of the positions that they come from.
void set_residual_scale(Body& body, const StepLoads& loads) {
  const Model& model = body.model;
  const Prediction& step = body.prediction;
  NewtonMeasures& newton = body.newton;
  const double inertia = step.is_static ? 0.0 : 1.0;
  const double given = ordered_sum(model.num_free(), [&](std::ptrdiff_t row) {
    const int n = model.node_of_row[static_cast<std::size_t>(row)];
    return inertia * body.materials.mass()(n) * (step.v_hat.col(n).norm() + body.trial.v.col(n).norm()) +
           step.tau * find_applied_force(body, loads, n).norm();
  });
  const double reactions = ordered_sum(model.elements.num_nodes(), [&](std::ptrdiff_t n) {
    return (model.constraints.support.col(n).array() >= 0)
        .select(body.forces.internal.col(n), Vec3::Zero())
        .norm();
  });
  newton.residual_scale = given + step.tau * reactions;
  newton.is_driven = given > 0.0 || step.is_shifted;
  // Of the energy: force times what rounding moves each corner.
  const auto corners = static_cast<double>(model.elements.nodes.size());
  newton.potential_rounding =
      kRounding * body.trial.x.cwiseAbs().maxCoeff() * std::sqrt(corners * newton.corner_scale);
  if (!find_law(model.params.model).has_cancelling_energy) return;
  // The law's energy is what is left of terms of the size of its moduli.
  newton.potential_rounding += kRounding * ordered_sum(model.elements.num_points(), [&](std::ptrdiff_t p) {
                                 const TetMaterial material =
                                     body.materials.of(model.elements.tet_of_point(static_cast<int>(p)));
                                 return (material.lambda + material.mu) * body.materials.weight()(p);
                               });
}

}  // namespace

Vec3 find_applied_force(const Body& body, const StepLoads& loads, Eigen::Index node) {
  return body.prediction.load_share *
         (loads.force.col(node) + gravity_mass(body, node) * body.model.params.gravity);
}

Vec3 find_imbalance(const Body& body, const StepLoads& loads, Eigen::Index node) {
  return find_free_part(body.model, find_applied_force(body, loads, node) - body.forces.internal.col(node),
                        node);
}

void assemble_residual(Body& body, const Part& part, const StepLoads& loads) {
  const SolidParams& params = body.model.params;
  const Points& v = body.trial.v;
  if (body.is_newton() || body.newton.iterations == 0 || body.newton.has_moved)  // else the same place
    assemble_forces(body.strained(), part, body.forces);
  body.newton.has_moved = false;
  if (body.is_newton()) set_rounding(body);
  const bool is_viscous =
      !body.prediction.is_static && params.rayleigh_stiffness > 0.0 &&
      part.nodes.sum(v.cols(), [&](std::ptrdiff_t n) { return v.col(n).isZero(0.0) ? 0.0 : 1.0; }) > 0.0;
  Points& product = body.scratch.product;
  part.nodes.each(product.cols(), [&](std::ptrdiff_t n) { product.col(n).setZero(); });
  if (is_viscous) compute_stiffness_product(body, part, v, params.rayleigh_stiffness, 0.0, product);
  if (!body.prediction.is_static && params.implicit_contact) {
    const StepContacts contacts = body.step_contacts(loads.contacts);
    const double share = find_contact_share(body);
    for (std::size_t i = 0; i < loads.contacts.size(); ++i)
      spread(loads.contacts[i], share * contacts.compute_fall(i, body.trial.x, body.contacts), product);
  }
  set_rhs(body, part, loads);
  if (body.is_newton()) set_residual_scale(body, loads);
}

void set_rhs(Body& body, const Part& part, const StepLoads& loads) {
  const Model& model = body.model;
  const Prediction& step = body.prediction;
  const Field& mass = body.materials.mass();
  const double a = step.is_static ? 0.0 : model.params.rayleigh_mass;
  const double inertia = step.is_static ? 0.0 : 1.0;
  part.near_rows.each(model.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row) {
      const int n = model.node_of_row[static_cast<std::size_t>(row)];
      const Vec3 force = find_applied_force(body, loads, n) - body.forces.internal.col(n) -
                         body.scratch.product.col(n) - a * mass(n) * body.trial.v.col(n);
      body.system.rhs.col(row) =
          inertia * mass(n) * (step.v_hat.col(n) - body.trial.v.col(n)) + step.tau * force;
    }
  });
  for (const int row : model.held_rows)
    for (int k = 0; k < 3; ++k)
      if (model.constraints.support(k, model.node_of_row[static_cast<std::size_t>(row)]) >= 0)
        body.system.rhs(k, row) = 0.0;
}

double compute_excess(const Body& body) {
  return std::sqrt(ordered_sum(body.model.num_free(), [&](std::ptrdiff_t row) {
    const int node = body.model.node_of_row[static_cast<std::size_t>(row)];
    const double rounding = body.prediction.tau * body.newton.rounding(node);
    return std::pow(std::max(0.0, body.system.rhs.col(row).norm() - rounding), 2);
  }));
}

double compute_potential(Body& body, const Part& part, const StepLoads& loads) {
  const Model& model = body.model;
  const Prediction& step = body.prediction;
  const SolidState& trial = body.trial;
  const Field& mass = body.materials.mass();
  const double elastic = compute_elastic_energy(body.strained(), body.scratch.nodal.change);
  double sum = elastic;
  double magnitude = elastic;
  const auto add = [&](double term) {
    sum += term;
    magnitude += std::abs(term);
  };
  add(-step.load_share * ordered_sum(mass.size(), [&](std::ptrdiff_t n) {
    const Vec3 force = loads.force.col(n) + gravity_mass(body, n) * model.params.gravity;
    return force.dot(trial.x.col(n) - model.elements.rest.col(n));
  }));
  if (!step.is_static) {
    add(ordered_sum(mass.size(), [&](std::ptrdiff_t n) {
      return 0.5 * mass(n) *
             ((trial.v.col(n) - step.v_hat.col(n)).squaredNorm() +
              step.tau * model.params.rayleigh_mass * trial.v.col(n).squaredNorm());
    }));
    if (model.params.rayleigh_stiffness > 0.0) {
      Points& product = body.scratch.product;
      compute_stiffness_product(body, part, trial.v, model.params.rayleigh_stiffness, 0.0, product);
      add(0.5 * step.tau *
          ordered_sum(product.cols(), [&](std::ptrdiff_t n) { return trial.v.col(n).dot(product.col(n)); }));
    }
    if (model.params.implicit_contact) {
      const StepContacts contacts = body.step_contacts(loads.contacts);
      const double share = find_contact_share(body);
      for (std::size_t i = 0; i < loads.contacts.size(); ++i)
        add(share * contacts.compute_potential(i, trial.x, body.contacts));
    }
  }
  body.newton.potential_scale = magnitude;
  return sum;
}

}  // namespace argil::solid
