#pragma once

#include <cmath>

#include "base/types.h"

namespace argil::material {

/// Isotropic fourth-order tensor by its two eigenvalues: on the mean part (3K of a stiffness) and on the
/// deviator (2G of a stiffness).
struct Isotropic {
  double mean = 0.0;
  double deviator = 0.0;
};

/// Fourth-order tensor that is unchanged by turns about axis 3, in an orthonormal basis of the symmetric
/// tensors: u = 1/√3 and w = diag(−1,−1,2)/√6 (a full 2×2 block, not symmetric in general), the two shears in
/// the plane 12 (eigenvalue `plane`) and the two out of it (eigenvalue `axial`). Mean and deviator do not mix
/// in this basis, so a shear modulus 10⁵ times below the bulk modulus keeps all its digits.
struct Transverse {
  double uu = 0.0, uw = 0.0, wu = 0.0, ww = 0.0;
  double plane = 0.0;
  double axial = 0.0;
};

inline Transverse to_transverse(const Isotropic& a) {
  return {a.mean, 0.0, 0.0, a.deviator, a.deviator, a.deviator};
}

/// Average over all orientations: the isotropic part.
inline Isotropic average(const Transverse& a) {
  return {a.uu, (a.ww + 2.0 * a.plane + 2.0 * a.axial) / 5.0};
}

inline bool is_coupled(const Transverse& a) {
  return a.uw != 0.0 || a.wu != 0.0;
}

// Product and inverse treat the uncoupled apart, so that a mean part at its pole (∞) leaves the deviator
// alone.
inline Transverse operator*(const Transverse& a, const Transverse& b) {
  if (!is_coupled(a) && !is_coupled(b))
    return {a.uu * b.uu, 0.0, 0.0, a.ww * b.ww, a.plane * b.plane, a.axial * b.axial};
  return {a.uu * b.uu + a.uw * b.wu, a.uu * b.uw + a.uw * b.ww, a.wu * b.uu + a.ww * b.wu,
          a.wu * b.uw + a.ww * b.ww, a.plane * b.plane,         a.axial * b.axial};
}

/// α a + β b.
inline Transverse combine(double alpha, const Transverse& a, double beta, const Transverse& b) {
  return {alpha * a.uu + beta * b.uu, alpha * a.uw + beta * b.uw,       alpha * a.wu + beta * b.wu,
          alpha * a.ww + beta * b.ww, alpha * a.plane + beta * b.plane, alpha * a.axial + beta * b.axial};
}

inline Transverse inverse(const Transverse& a) {
  if (!is_coupled(a)) return {1.0 / a.uu, 0.0, 0.0, 1.0 / a.ww, 1.0 / a.plane, 1.0 / a.axial};
  const double det = a.uu * a.ww - a.uw * a.wu;
  return {a.ww / det, -a.uw / det, -a.wu / det, a.uu / det, 1.0 / a.plane, 1.0 / a.axial};
}

/// 6×6 Mandel matrix.
inline Mat6 to_mandel_matrix(const Transverse& a) {
  Vec6 u = Vec6::Zero();
  Vec6 w = Vec6::Zero();
  Vec6 p = Vec6::Zero();
  u.head<3>().setConstant(1.0 / std::sqrt(3.0));
  w.head<3>() = Vec3(-1.0, -1.0, 2.0) / std::sqrt(6.0);
  p.head<3>() = Vec3(1.0, -1.0, 0.0) / std::sqrt(2.0);
  Mat6 m = a.uu * u * u.transpose() + a.uw * u * w.transpose() + a.wu * w * u.transpose() +
           a.ww * w * w.transpose() + a.plane * p * p.transpose();
  m(3, 3) = m(4, 4) = a.axial;
  m(5, 5) = a.plane;
  return m;
}

}  // namespace argil::material
