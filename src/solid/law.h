#pragma once

#include <array>
#include <cstddef>

#include "base/mandel.h"
#include "base/types.h"

namespace argil::solid {

struct FlowArrays;
struct ForceArrays;
struct TangentArrays;

using Mat9 = Eigen::Matrix<double, 9, 9>;  ///< dP = A dF with both matrices read column by column

/// Elastic constants at a point: Lamé's, or a full stiffness in the turned frame.
struct Elasticity {
  double lambda = 0.0;         ///< [Pa]
  double mu = 0.0;             ///< [Pa]
  const Mat6* C = nullptr;     ///< [Pa], Mandel; takes the place of both where it is given
  double excess_bulk = 0.0;    ///< part of the bulk modulus that acts on `volume_change` instead [Pa]
  double volume_change = 0.0;  ///< mean relative volume change around, which excess_bulk multiplies [–]
};

/// Where a point is: F, and the rotation that its strain is measured in (1 for the linear model).
struct PointMotion {
  Mat3 F = Mat3::Identity();
  Mat3 R = Mat3::Identity();
};

/// How plastic strain enters a law.
enum class PlasticSplit {
  additive,        ///< ε_e = ε − ε_p
  multiplicative,  ///< Fₑ = F F_p⁻¹ with F_p = 1 + ε_p, scaled; no eigenvalue of ε_p may reach −1
  none,            ///< it is elastic
  logarithmic,     ///< F = Fₑ F_p, ε_p = ½ ln F_pᵀF_p; `flow` in the place of flow_drive
};

/// An elastic law at a point: its traits, by which the body chooses how to work with it, and its functions.
/// Each law is one file law_*.cpp; kElasticLaws below lists all of them.
struct ElasticLaw {
  /// Of a point, its plastic strain (6, Mandel) and its elastic constants.
  template <class Value>
  using Function = Value (*)(const PointMotion& motion, const Vec6& plastic_strain, const Elasticity& e);

  const char* name;     ///< as in JSON
  const char* about;    ///< what the law is for, in the list of parameters
  const char* summary;  ///< its line in the summary of a model
  bool is_simplified;   ///< the summary counts it among the simplifications

  /// The strain is linear in the displacement: R = 1, the stiffness never turns, inversion means nothing.
  bool is_linear;
  /// W = ½ ε_e:C:ε_e in the strain ε of the frame R: the matrix of a one-step solve keeps its rotation. Any
  /// other law takes ∂P/∂F.
  bool is_quadratic;
  bool takes_full_stiffness;  ///< C (6×6) may take the place of λ and μ
  bool bears_inversion;  ///< W is finite where det F ≤ 0; else it is infinite there, P and ∂P/∂F are NaN
  bool has_cancelling_energy;  ///< W near rest is what is left of terms of the size of the moduli
  PlasticSplit plastic_split;

  Function<double> energy_density;  ///< see compute_energy_density, and so on below
  Function<Mat3> piola;
  Function<Mat9> tangent;
  Vec6 (*flow_drive)(const PointMotion& motion, const Vec6& plastic_strain, const Elasticity& e,
                     double shape_stiffness);
  double (*volume_change)(const PointMotion& motion, const Vec6& plastic_strain);
  Mat3 (*volume_gradient)(const PointMotion& motion, const Vec6& plastic_strain);
  /// Of a logarithmic split: flow of points begin … end−1, at most kLanes of them; bit p − begin is set where
  /// p flowed. dissipated: over μ and the volume of each. Else null.
  unsigned (*flow)(const FlowArrays& points, std::ptrdiff_t begin, std::ptrdiff_t end, double* dissipated);
  /// ∂P/∂F without its negative modes, where the law knows a way; else null.
  Function<Mat9> positive_tangent;

  /// Of isotropic points begin … end−1, which go eight at a time: forces, energy and stiffness. All null:
  /// point by point.
  struct Lanes {
    void (*forces)(const ForceArrays& points, std::ptrdiff_t begin, std::ptrdiff_t end);
    double (*energy)(const ForceArrays& points, std::ptrdiff_t begin, std::ptrdiff_t end);
    void (*stiffness)(const TangentArrays& points, std::ptrdiff_t begin, std::ptrdiff_t end);
  } lanes;
};

extern const ElasticLaw kCorotationalLaw, kLinearLaw, kNeoHookeanLaw, kHenckyLaw, kCurnierLaw;

/// The laws; kElasticLaws is in the same order.
enum class StrainModel {
  corotational,  ///< small strain in the frame turned by the polar decomposition
  linear,        ///< the paper's Cauchy strain
  neo_hookean,   ///< stable neo-Hookean law, isotropic: the reference for large strain [Smith2018]
  hencky,        ///< large strain, isotropic, linear in the logarithmic strain [Hencky1928]
  curnier,       ///< large strain, elastic and isotropic, linear in a generalised strain [Curnier1991]
};
inline constexpr std::array kElasticLaws{&kCorotationalLaw, &kLinearLaw, &kNeoHookeanLaw, &kHenckyLaw,
                                         &kCurnierLaw};

inline const ElasticLaw& find_law(StrainModel model) {
  return *kElasticLaws[static_cast<std::size_t>(model)];
}

PointMotion make_motion(StrainModel model, const Mat3& F);

/// Small strain in the turned frame: ε = sym(RᵀF) − 1 (Mandel). R = 1 gives the paper's Cauchy strain; for
/// the neo-Hookean law it is what plastic flow sees.
Vec6 compute_strain(const Mat3& F, const Mat3& R);

/// Isotropic stiffness in Mandel form [Pa].
Mat6 make_isotropic_stiffness(double lambda, double mu);

/// σ = C ε_e [Pa], Mandel.
Vec6 compute_stress(const Elasticity& e, const Vec6& elastic_strain);

/// Energy per rest volume [J/m³] without the excess bulk modulus.
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
Mat9 compute_positive_tangent(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                              const Elasticity& e);

/// What drives plastic flow that keeps the volume: −dev ∂W/∂ε_p over 2μ* [–], along which flow loses energy;
/// dev ε_e in an isotropic quadratic law. shape_stiffness: 2μ* [Pa].
Vec6 compute_flow_drive(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain,
                        const Elasticity& e, double shape_stiffness);

/// Relative volume change θ as the law measures it, tr ε_e, det Fₑ − 1 or ln det F, and its derivative ∂θ/∂F.
double compute_volume_change(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain);
Mat3 compute_volume_gradient(StrainModel model, const PointMotion& motion, const Vec6& plastic_strain);

}  // namespace argil::solid
