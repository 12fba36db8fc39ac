#pragma once

#include <Eigen/SparseCore>

#include "base/types.h"
#include "solid/parameters.h"

namespace argil::study {

/// The displacement of a body anywhere in its tets, from that of its vertices at rest, which is all that a
/// result holds. Four-node tets: linear, as they are. Ten-node tets, whose mid-edge nodes are not kept: of
/// second order, by gradients at the vertices that a quadratic fitted to the vertices around each gives
/// [Zhang2005]; exact for a displacement that is quadratic in place. Where a mesh has too few vertices for
/// such a fit, an affine one.
class DisplacementField {
 public:
  DisplacementField(const Points& rest, const Tets& tets, solid::ElementKind element);

  /// What `find` gives from here on: 3×n [m], one a vertex.
  void set(Points displacement);
  /// Displacement [m] at barycentric weights of a tet.
  Vec3 find(int tet, const Vec4& weights) const;

 private:
  Points m_rest;
  Tets m_tets;
  bool m_is_quadratic;
  Eigen::SparseMatrix<double> m_differences;  // n×3n: displacement times it is ∂u/∂x at each vertex
  Points m_displacement;
  Eigen::Matrix3Xd m_gradient;  // 3×3n
};

}  // namespace argil::study
