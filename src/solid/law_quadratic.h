#pragma once

// What the laws with the energy ½ ε_e:C:ε_e, ε_e = sym(RᵀF) − 1 − ε_p, have in common.

#include "material/plasticity.h"
#include "solid/law.h"

namespace argil::solid {

inline Vec6 compute_elastic_strain(const PointMotion& m, const Vec6& plastic_strain) {
  return compute_strain(m.F, m.R) - plastic_strain;
}

/// W = ½ ε_e:C:ε_e [J/m³].
inline double compute_quadratic_energy(const PointMotion& m, const Vec6& plastic_strain,
                                       const Elasticity& e) {
  const Vec6 elastic = compute_elastic_strain(m, plastic_strain);
  return 0.5 * elastic.dot(compute_stress(e, elastic));
}

/// −∂W/∂ε_p = σ: its deviator over 2μ* [–].
inline Vec6 compute_quadratic_drive(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e,
                                    double shape_stiffness) {
  return material::compute_stress_drive(compute_stress(e, compute_elastic_strain(m, plastic_strain)),
                                        shape_stiffness);
}

/// θ = tr ε_e, whose derivative is ∂θ/∂F = R.
inline double compute_trace(const PointMotion& m, const Vec6& plastic_strain) {
  return compute_elastic_strain(m, plastic_strain).head<3>().sum();
}
inline Mat3 compute_trace_gradient(const PointMotion& m, const Vec6& /*plastic_strain*/) {
  return m.R;
}

}  // namespace argil::solid
