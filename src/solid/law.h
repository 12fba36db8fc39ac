#pragma once

#include "base/mandel.h"
#include "solid/parameters.h"

namespace argil::solid {

using Mat9 = Eigen::Matrix<double, 9, 9>;  ///< dP = A dF with both matrices read column by column

/// Elastic constants at a point: Lamé's, or a full stiffness in the turned frame.
struct Elasticity {
  double lambda = 0.0;         ///< [Pa]
  double mu = 0.0;             ///< [Pa]
  const Mat6* C = nullptr;     ///< [Pa], Mandel; takes the place of both where it is given
  double excess_bulk = 0.0;    ///< part of the bulk modulus that acts on `pressure_ratio` instead [Pa]
  double volume_change = 0.0;  ///< mean relative volume change around, which excess_bulk multiplies [–]
};

/// Where a point is: F, and the rotation that its strain is measured in (1 for the linear model).
struct PointMotion {
  Mat3 F = Mat3::Identity();
  Mat3 R = Mat3::Identity();
};

PointMotion make_motion(StrainModel model, const Mat3& F);

/// Small strain in the turned frame: ε = sym(RᵀF) − 1 (Mandel). R = 1 gives the paper's Cauchy strain; for
/// the neo-Hookean law it is what plastic flow sees.
Vec6 compute_strain(const Mat3& F, const Mat3& R);

/// Isotropic stiffness in Mandel form [Pa].
Mat6 make_isotropic_stiffness(double lambda, double mu);

/// σ = C ε_e [Pa], Mandel.
Vec6 compute_stress(const Elasticity& e, const Vec6& elastic_strain);

/// Energy per rest volume [J/m³] without the excess bulk modulus.
/// linear, corotational: ½ ε_e:C:ε_e with ε_e = ε − ε_p. neo_hookean [Smith2018, without the logarithm]:
/// ½μ(tr FₑᵀFₑ − 3) − μ(J − 1) + ½(λ + μ)(J − 1)², J = det Fₑ, Fₑ = F F_p⁻¹, F_p = 1 + ε_p scaled to det F_p
/// = exp(tr ε_p).
double compute_energy_density(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                              const Elasticity& e);

/// First Piola–Kirchhoff stress P = ∂W/∂F [Pa], the rotation's own derivative included, so that force is the
/// energy's gradient also for anisotropic stiffness and plastic strain; plus excess_bulk times volume_change.
Mat3 compute_piola(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                   const Elasticity& e);

/// ∂P/∂F, the energy's second derivative: exact for every law, symmetric. volume_change counts as given.
Mat9 compute_tangent(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                     const Elasticity& e);

/// The same with its negative modes set to zero, so that a step's matrix is positive [Teran2005].
Mat9 make_positive(const Mat9& tangent);

/// What drives plastic flow that keeps the volume: −dev ∂W/∂ε_p over 2μ* [–], along which flow loses energy;
/// dev ε_e in an isotropic linear law. With the Mandel stress M = Fₑᵀ ∂W/∂Fₑ the neo-Hookean law has −∂W/∂ε_p
/// = sym(dev M (1 + ε_p)⁻¹) for a change without trace. shape_stiffness: 2μ* [Pa].
Vec6 compute_flow_drive(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                        const Elasticity& e, double shape_stiffness);

/// Relative volume change θ: tr(ε − ε_p), or J − 1 for the neo-Hookean law; and its derivative ∂θ/∂F.
double compute_volume_change(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain);
Mat3 compute_volume_gradient(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain);

}  // namespace argil::solid
