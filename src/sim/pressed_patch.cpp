#include "sim/pressed_patch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace argil::sim {

namespace {

constexpr double kOfCell = 0.4;  // radius of the disc as which one node yields, over the cells' edge

}  // namespace

double PressedPatch::find_half_space_stiffness(double modulus, double cell) const {
  if (!(springs > 0.0)) return 0.0;
  const double a = std::hypot(length, kOfCell * cell);
  const double ratio = std::hypot(width, kOfCell * cell) / a;
  constexpr double kLine = 1.0 - 1e-6;  // of e: a line has none
  const double eccentricity = std::min(kLine, std::sqrt(std::max(0.0, 1.0 - ratio * ratio)));
  return std::numbers::pi * modulus * a / std::comp_ellint_1(eccentricity);
}

void PressedMoments::add(const Vec3& point, double force, double spring) {
  if (!(force > 0.0)) return;
  m_springs += spring;
  m_force += force;
  const Vec3 from_before = point - m_centre;
  m_centre += force / m_force * from_before;
  m_spread += force * from_before * (point - m_centre).transpose();
}

/// Of Hertz's pressure on an ellipse the mean square distance from an axis is a fifth of the other
/// semi-axis's square.
PressedPatch PressedMoments::find_patch() const {
  constexpr double kHertz = 5.0;
  if (!(m_force > 0.0)) return {};
  const Mat3 symmetric = 0.5 / m_force * (m_spread + m_spread.transpose());
  const Vec3 spread = Eigen::SelfAdjointEigenSolver<Mat3>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
  return {m_springs, std::sqrt(kHertz * std::max(0.0, spread.z())),
          std::sqrt(kHertz * std::max(0.0, spread.y()))};
}

}  // namespace argil::sim
