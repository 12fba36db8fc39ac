#pragma once

#include <vector>

#include "base/types.h"

namespace argil::solid {

enum class StrainModel {
  corotational,  ///< small strain in the frame turned by the polar decomposition
  linear,        ///< the paper's Cauchy strain
};

enum class SolverKind {
  pcg_cholesky,  ///< conjugate gradients preconditioned by a kept CHOLMOD factor
  pcg_jacobi,    ///< conjugate gradients preconditioned by the 3×3 diagonal blocks
  cholesky,      ///< CHOLMOD simplicial LDLᵀ every step
};

/// Part of space whose vertices at rest are meant; the kinds of SPEC's regions.
struct Region {
  enum class Kind { box, sphere, half_space, nodes } kind = Kind::box;
  Vec3 lower = Vec3::Zero();    ///< box [m]
  Vec3 upper = Vec3::Zero();    ///< box [m]
  Vec3 centre = Vec3::Zero();   ///< sphere [m]
  double radius = 0.0;          ///< sphere [m]
  Vec3 normal = Vec3::UnitZ();  ///< half_space: vertices with normal·x ≤ offset
  double offset = 0.0;          ///< half_space [m]
  std::vector<int> nodes;       ///< nodes
};

struct SolidParams {
  StrainModel model = StrainModel::corotational;
  double density = 1500.0;          ///< of dry clay [kg/m³]
  double rayleigh_mass = 0.0;       ///< a [1/s] in D = a M + b K
  double rayleigh_stiffness = 0.0;  ///< b [s]
  Vec3 gravity = Vec3::Zero();      ///< [m/s²]
  SolverKind solver = SolverKind::pcg_cholesky;
  double solver_tolerance = 1e-8;  ///< relative residual at which the iteration stops
  int solver_max_iterations = 500;
  int refactor_iterations = 12;   ///< pcg_cholesky: factorise anew after a solve with more iterations
  bool implicit_contact = true;   ///< contact stiffness enters the implicit solve
  double min_volume_ratio = 0.0;  ///< det F at or below which the run stops
};

}  // namespace argil::solid
