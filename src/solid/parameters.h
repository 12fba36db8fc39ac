#pragma once

#include "base/types.h"
#include "linear/solver.h"
#include "solid/law.h"

namespace argil::solid {

enum class ElementKind {
  p1,        ///< 4-node tets (eq. 1)
  p1_nodal,  ///< 4-node tets whose bulk stiffness above that of ν = 0.3 acts on volume changes averaged at
             ///< nodes
  p2,        ///< 10-node tets, four points
};

enum class Integrator {
  backward_euler,    ///< first order, damps
  bdf2,              ///< second order, damps what the step does not resolve
  newmark,           ///< average acceleration: second order, no damping of its own
  symplectic_euler,  ///< explicit, stable below the step 2/ω_max
};

/// τ of x' = x̂ + τ v' in a step of this length that has a past [s].
double compute_tau(Integrator integrator, double step_s);

enum class Iteration {
  one,     ///< one linearised step, rotations kept [Baraff1998]
  newton,  ///< to convergence, with line search on the incremental potential
};

struct SolidParams {
  StrainModel model = StrainModel::corotational;
  ElementKind element = ElementKind::p1;
  Integrator integrator = Integrator::backward_euler;
  Iteration iteration = Iteration::one;
  double newton_tolerance = 1e-10;  ///< of the residual over the loads, reactions and momenta
  int newton_max_iterations = 50;
  double density = 1500.0;          ///< of dry clay [kg/m³]
  double rayleigh_mass = 0.0;       ///< a [1/s] in D = a M + b K
  double rayleigh_stiffness = 0.0;  ///< b [s]
  Vec3 gravity = Vec3::Zero();      ///< [m/s²]
  linear::SolverParams solver;
  double response_tolerance =
      1e-8;  ///< of find_response's solves; the smaller of this and that of `solver` counts
  double region_tolerance =
      1e-3;  ///< of an active region: speed over the fastest node's below which nodes stay where they are
  bool implicit_contact = true;  ///< contact stiffness enters the implicit solve
  /// Tets whose law splits flow off by logarithms and that are at their yield resist a step as they flow.
  bool flows_in_solve = false;
  double min_volume_ratio = 0.0;  ///< det F at or below which the run stops
  /// Does a step in time solve for its contacts' forces? Then it takes them as they are at its end, and lets
  /// go what would draw there.
  bool solves_contact() const { return implicit_contact && integrator != Integrator::symplectic_euler; }
};

}  // namespace argil::solid
