#include "material/iterated_schemes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "material/eshelby.h"

namespace argil::material {
namespace {

/// Logarithms of the two moduli over the solid's: both unknowns stay positive by construction.
using LogModuli = std::array<double, 2>;

Isotropic to_moduli(const Isotropic& solid, const LogModuli& y) {
  return {solid.mean * std::exp(y[0]), solid.deviator * std::exp(y[1])};
}

double poissons_ratio_of(const Isotropic& stiffness) {
  const double K = stiffness.mean / 3.0;
  const double G = stiffness.deviator / 2.0;
  return (3.0 * K - 2.0 * G) / (2.0 * (3.0 * K + G));
}

/// One modulus of the self-consistent equation, solved for with the constraint of the surroundings held
/// fixed. Writing A = (k + s)/(f + s) defines the constraint s ≥ 0 (4G/3 for the bulk modulus round a
/// sphere); then k = m + φ(f − m)(k + s)/(f + s) gives k = 1/((1−φ)/(m+s) + φ/(f+s)) − s, which is positive
/// for every s.
double solve_with_constraint(double m, double f, double phi, double k, double concentration) {
  const double t = 1.0 - f / k;
  // p = k/(k+s). At t = 0 the inclusion is no inhomogeneity and any constraint gives the same k.
  const double p = std::abs(t) > 1e-9 ? (1.0 - 1.0 / concentration) / t : 0.5;
  const double s = p > 0.0 ? std::max(0.0, k * (1.0 / p - 1.0)) : k;
  // 1/((1−φ)/(m+s) + φ/(f+s)) − s with s taken out of the difference.
  const double soft = (1.0 - phi) * f + phi * m;
  return (m * f + s * ((1.0 - phi) * m + phi * f)) / (soft + s);
}

/// ln of the image of y under the iteration above, minus y: zero at the solution.
LogModuli compute_residual(const Isotropic& solid, const Isotropic& fluid, double phi, double aspect,
                           const LogModuli& y) {
  const Isotropic C = to_moduli(solid, y);
  const Isotropic A = average(compute_concentration(C, fluid, aspect));
  return {std::log(solve_with_constraint(solid.mean, fluid.mean, phi, C.mean, A.mean) / C.mean),
          std::log(solve_with_constraint(solid.deviator, fluid.deviator, phi, C.deviator, A.deviator) /
                   C.deviator)};
}

double size_of(const LogModuli& a) {
  return std::max(std::abs(a[0]), std::abs(a[1]));
}

/// Right-hand side in τ = −ln(1 − φ): d ln C/dτ = (C^I/C − 1) ⟨A(C)⟩.
LogModuli compute_slope(const Isotropic& solid, const Isotropic& fluid, double aspect, const LogModuli& y) {
  const Isotropic C = to_moduli(solid, y);
  const Isotropic A = average(compute_concentration(C, fluid, aspect));
  return {(fluid.mean / C.mean - 1.0) * A.mean, (fluid.deviator / C.deviator - 1.0) * A.deviator};
}

/// One step of the pair of orders 5 and 4 of [Dormand1980]; returns the difference of the two, i.e. the
/// error.
template <class Slope>
LogModuli step_dormand_prince(const Slope& slope, double h, LogModuli& y) {
  constexpr double a[6][6] = {
      {1.0 / 5.0},
      {3.0 / 40.0, 9.0 / 40.0},
      {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
      {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
      {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
      {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0}};
  constexpr double e[7] = {71.0 / 57600.0,      0.0,          -71.0 / 16695.0, 71.0 / 1920.0,
                           -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0};
  std::array<LogModuli, 7> k{};
  k[0] = slope(y);
  LogModuli next = y;
  for (std::size_t stage = 1; stage < 7; ++stage) {
    next = y;
    for (std::size_t j = 0; j < stage; ++j)
      for (std::size_t c = 0; c < 2; ++c) next[c] += h * a[stage - 1][j] * k[j][c];
    k[stage] = slope(next);
  }
  LogModuli error{};
  for (std::size_t j = 0; j < 7; ++j)
    for (std::size_t c = 0; c < 2; ++c) error[c] += h * e[j] * k[j][c];
  y = next;
  return error;
}

}  // namespace

Transverse compute_concentration(const Isotropic& matrix, const Isotropic& fluid, double aspect) {
  const Isotropic T{1.0 - fluid.mean / matrix.mean, 1.0 - fluid.deviator / matrix.deviator};
  const Transverse P = compute_eshelby_transverse(poissons_ratio_of(matrix), aspect);
  return inverse(combine(1.0, to_transverse({1.0, 1.0}), -1.0, P * to_transverse(T)));
}

Isotropic compute_self_consistent(const Isotropic& solid, const Isotropic& fluid, double phi, double aspect) {
  constexpr int kMaxIterations = 20000;
  constexpr double kConverged = 1e-14;  // rounding of a logarithm
  constexpr double kRounded = 1e-11;    // and with what cancels on the way to it; nothing worse is accepted
  constexpr double kApart = -18.0;      // ln of a shear modulus that counts as lost: 1.5e-8 of the solid's
  constexpr double kProbe = 1e-7;       // difference quotient; only the speed of Newton's method rests on it
  constexpr double kLongestStep = 3.0;
  if (phi >= 1.0) return fluid;
  const auto residual = [&](const LogModuli& y) { return compute_residual(solid, fluid, phi, aspect, y); };
  LogModuli y = {0.0, 0.0};
  LogModuli r = residual(y);
  for (int i = 0; i < kMaxIterations && size_of(r) > kConverged; ++i) {
    if (y[1] < kApart) {
      const double reuss = 1.0 / ((1.0 - phi) / solid.mean + phi / fluid.mean);  // 0 when drained
      return {reuss, 0.0};
    }
    const LogModuli r0 = residual({y[0] + kProbe, y[1]});
    const LogModuli r1 = residual({y[0], y[1] + kProbe});
    const double j00 = (r0[0] - r[0]) / kProbe, j01 = (r1[0] - r[0]) / kProbe;
    const double j10 = (r0[1] - r[1]) / kProbe, j11 = (r1[1] - r[1]) / kProbe;
    const double det = j00 * j11 - j01 * j10;
    const LogModuli step = {(j01 * r[1] - j11 * r[0]) / det, (j10 * r[0] - j00 * r[1]) / det};
    // Newton's step where it helps; else the plain iteration, which descends from the solid's side.
    const double shorten = std::min(1.0, kLongestStep / size_of(step));
    LogModuli next = {y[0] + shorten * step[0], y[1] + shorten * step[1]};
    LogModuli next_r = residual(next);
    if (!(size_of(next_r) < size_of(r))) {
      if (size_of(r) < kRounded) break;
      next = {y[0] + r[0], y[1] + r[1]};
      next_r = residual(next);
    }
    y = next;
    r = next_r;
  }
  ARGIL_ASSERT(size_of(r) < kRounded, phi, aspect, y[0], y[1], r[0], r[1]);
  return to_moduli(solid, y);
}

Isotropic compute_differential(const Isotropic& solid, const Isotropic& fluid, double phi, double aspect) {
  constexpr int kMaxSteps = 100000;
  constexpr double kTolerance = 1e-12;  // per step, of a logarithm
  constexpr double kApart = -300.0;     // ln of a shear modulus that counts as lost: doubles end at −745
  if (phi >= 1.0) return fluid;
  const auto slope = [&](const LogModuli& y) { return compute_slope(solid, fluid, aspect, y); };
  const double end = -std::log1p(-phi);
  LogModuli y = {0.0, 0.0};
  double at = 0.0;
  double h = std::min(end, 1e-3);
  for (int i = 0; at < end; ++i) {
    ARGIL_ASSERT(i < kMaxSteps, phi, aspect, at, h);
    if (y[1] < kApart) {  // a suspension: the rest of the fluid is added as Reuss does
      const double share = std::exp(at - end);
      return {1.0 / (share / to_moduli(solid, y).mean + (1.0 - share) / fluid.mean), 0.0};
    }
    const bool is_last = at + h >= end;
    LogModuli next = y;
    const double error = size_of(step_dormand_prince(slope, is_last ? end - at : h, next));
    const double factor = 0.9 * std::pow(kTolerance / std::max(error, 1e-3 * kTolerance), 0.2);
    if (error <= kTolerance) {
      y = next;
      if (is_last) break;
      at += h;
    }
    h *= error == error ? std::clamp(factor, 0.2, 3.0) : 0.2;
  }
  return to_moduli(solid, y);
}

}  // namespace argil::material
