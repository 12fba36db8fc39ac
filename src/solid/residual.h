#pragma once

#include "solid/part.h"
#include "solid/step_loads.h"

namespace argil::solid {

struct Body;

/// What Newton's method measures its residual and potential by.
struct NewtonMeasures {
  int iterations = 0;               ///< of the present step or share of the load
  bool is_follow_up = false;        ///< it is solved once more about where it came to
  bool has_moved = false;           ///< the internal forces are to be found anew
  double tolerance = 0.0;           ///< of the residual over residual_scale
  double solve_scale = 0.0;         ///< norm that what a step's solves leave is small beside
  double residual_scale = 0.0;      ///< loads, momenta and reactions, which the residual is small against
  double corner_scale = 0.0;        ///< Σ‖corner force‖²
  Field rounding;                   ///< what rounding alone leaves of the internal force at each node [N]
  bool is_driven = false;           ///< something acts in this step: a body left alone is not stirred
  bool is_moved_by_load = false;    ///< statics: some solve was made
  double potential = 0.0;           ///< Φ with ∂Φ/∂v = −r
  double potential_scale = 0.0;     ///< Σ of the size of its terms
  double potential_rounding = 0.0;  ///< what the positions' rounding does to it
};

/// External force on a node with gravity [N].
Vec3 find_applied_force(const Body& body, const StepLoads& loads, Eigen::Index node);

/// r = M (v̂ − v) + τ (f_ext + M g − f_int − D v) less the fall of the contacts' forces; statics: the forces
/// alone. In the rows of `part` and those next to them.
void assemble_residual(Body& body, const Part& part, const StepLoads& loads);

/// The last of its passes: r from the forces that are known.
void set_rhs(Body& body, const Part& part, const StepLoads& loads);

/// Norm of the residual beyond what rounding leaves of it.
double compute_excess(const Body& body);

/// Φ with ∂Φ/∂v = −r: ½(v−v̂)M(v−v̂) + ½τ vDv + W(x) − (f_ext + M g)·(x − X) and the contacts'.
double compute_potential(Body& body, const Part& part, const StepLoads& loads);

/// After the first residual of a step: the force [N] that would act on a node if the body were stopped where
/// it is.
Vec3 find_imbalance(const Body& body, const StepLoads& loads, Eigen::Index node);

}  // namespace argil::solid
