#include "sim/fidelity.h"

#include <algorithm>
#include <cmath>

namespace argil::sim {
namespace {

// Shares of the bound.
constexpr double kSolve = 0.25;
constexpr double kRegion = 0.5;
constexpr double kSleep = 0.8;       // for a body that sleeps, with what its region holds back
constexpr double kFallAsleep = 0.5;  // of what is left for sleep, for one that falls asleep: far from waking
constexpr int kCalmSteps = 8;        // that it must have been so
constexpr double kSafety = 2.0;      // of the reach

}  // namespace

void Fidelity::begin_step(const Vec3& felt_force) {
  m_record.bound = std::max(m_params.force_floor, m_params.force_tolerance * felt_force.norm());
  m_force_change = (felt_force - m_felt_force).norm();
  m_felt_force = felt_force;
}

void Fidelity::find_reach(const Points& x, const Points& rest, const OrderedItems& nodes) {
  const auto squared_displacement = [&](std::ptrdiff_t n) { return (x.col(n) - rest.col(n)).squaredNorm(); };
  const double squares = nodes.sum(x.cols(), squared_displacement);
  const double largest = nodes.find_largest(x.cols(), squared_displacement);
  // As long as the hand has moved nothing, all nodes may go with it.
  const auto count = static_cast<double>(x.cols());
  m_reach = kSafety * std::sqrt(largest > 0.0 ? squares / largest : count);
}

double Fidelity::lasting_share() const {
  const double floor = m_params.force_floor;
  return floor * floor / (floor + m_force_change) / m_reach;
}

double Fidelity::solve_slack() const {
  return is_full() ? 0.0 : kSolve * lasting_share() / m_stiffening;
}

double Fidelity::solve_limit() const {
  return m_record.bound / (m_reach * m_stiffening);
}

double Fidelity::region_slack() const {
  return is_full() ? 0.0 : kRegion * lasting_share() * m_reach;
}

bool Fidelity::falls_asleep(double imbalance, double held_back, bool flows) {
  const double most = kFallAsleep * (kSleep * m_record.bound - held_back);
  const bool is_calm = !flows && m_reach * imbalance <= most;
  m_calm_steps = is_calm ? m_calm_steps + 1 : 0;
  if (m_calm_steps < kCalmSteps) return false;
  m_calm_steps = 0;
  m_record.rung = Rung::asleep;
  m_record.estimate = m_reach * imbalance + held_back;
  return true;
}

bool Fidelity::sleeps_on(double imbalance, double held_back) {
  m_record.rung = Rung::asleep;
  m_record.estimate = m_reach * imbalance + held_back;
  return m_record.estimate <= kSleep * m_record.bound;
}

void Fidelity::set_made(bool is_solved, double imbalance, double held_back) {
  m_record.rung = is_solved ? Rung::solved : Rung::coasting;
  m_record.estimate = m_reach * m_stiffening * imbalance + held_back;
}

void Fidelity::serialize(Archive& archive) {
  archive.array("fidelity/felt_force", m_felt_force);
  archive.number("fidelity/reach", m_reach);
  archive.number("fidelity/large_strain", m_record.large_strain);
  archive.number("fidelity/calm_steps", m_calm_steps);
}

}  // namespace argil::sim
