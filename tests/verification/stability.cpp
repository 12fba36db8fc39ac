#include "stability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/check.h"
#include "support/one_node.h"

namespace argil::verification {
namespace {

constexpr double kTick = 1e-3;  // [s]

/// x' = x + a v + c F, v' = p v + q F after `period` seconds of m ẍ + b ẋ = F.
struct HeldMotion {
  double a, c, p, q;
  HeldMotion(const Operator& hand, double period) {
    p = std::exp(-hand.damping * period / hand.mass);
    q = (1.0 - p) / hand.damping;
    a = hand.mass * q;
    c = (period - a) / hand.damping;
  }
};

sim::Params make_params(const Wall& wall, double stiffness) {
  sim::Params params = test::make_one_node_params();
  params.contact.vertex_face_stiffness = stiffness;
  params.contact.edge_edge_stiffness = stiffness;
  params.contact.penalty = wall.penalty;
  params.rates.physics_period_ticks = wall.physics_period_ticks;
  params.rates.between_frames = wall.between;
  params.passivity = wall.passivity;
  return params;
}

}  // namespace

Closed run_closed_loop(const Wall& wall, const Operator& hand, double stiffness, Start start) {
  const sim::Params params = make_params(wall, stiffness);
  const device::ToolMode mode = wall.gives_way ? device::ToolMode::push : device::ToolMode::dry;
  const double felt = wall.gives_way
                          ? test::compute_series(stiffness, test::compute_apex_stiffness(params.elastic))
                          : stiffness;
  const double balance = hand.press / felt;
  const double frequency = std::sqrt(felt / hand.mass);
  const double seconds = std::max(3.0, 40.0 * 2.0 * std::numbers::pi / frequency);
  sim::Simulation simulation = test::make_one_node_simulation(params);
  const HeldMotion motion(hand, kTick);
  Closed closed;
  double depth = start == Start::nudge ? balance : -2e-3;
  double speed = 0.0;  // inward
  if (start == Start::nudge) {
    for (int k = 0; k < 280; ++k)  // until the body is in balance too
      ARGIL_ASSERT(simulation.tick(test::press_apex(depth, mode)).is_ok());
    speed = closed.begin_speed = 1e-3 * balance * frequency;  // a thousandth of the depth
  }
  double given = simulation.hand_state().port_energy;
  const int ticks = static_cast<int>(std::lround(seconds / kTick));
  for (int k = 0; k < ticks; ++k) {
    const double force = hand.press - simulation.haptic_record().device_force.z();
    depth += motion.a * speed + motion.c * force;
    speed = motion.p * speed + motion.q * force;
    if (closed.begin_speed == 0.0 && depth > 0.0) closed.begin_speed = speed;
    if (!(std::abs(depth) < 0.5) || !simulation.tick(test::press_apex(depth, mode)).is_ok()) {
      closed.last_speed = closed.largest_speed = std::numeric_limits<double>::infinity();
      break;
    }
    closed.largest_speed = std::max(closed.largest_speed, std::abs(speed));
    double& largest = 3 * k < ticks ? closed.first_speed : closed.last_speed;
    if (3 * k < ticks || 3 * k >= 2 * ticks) largest = std::max(largest, std::abs(speed));
    const double now = simulation.hand_state().port_energy;
    closed.largest_step = std::max(closed.largest_step, std::abs(now - given));
    closed.lowest_energy = std::min(closed.lowest_energy, -now);
    given = now;
  }
  return closed;
}

double find_stable_stiffness(const Wall& wall, const Operator& hand, Start start, double least, double most) {
  const auto dies_away = [&](double k) { return run_closed_loop(wall, hand, k, start).dies_away(start); };
  // Bounces may come to rest at a stiffness above one at which they do not: the first that does not counts.
  constexpr double kFactor = 1.5;
  double stable = least;
  if (!dies_away(least)) return 0.0;
  double unstable = std::min(kFactor * least, most);
  while (dies_away(unstable)) {
    if (unstable == most) return most;
    stable = unstable;
    unstable = std::min(kFactor * unstable, most);
  }
  while (unstable / stable > 1.001) {
    const double middle = std::sqrt(stable * unstable);
    (dies_away(middle) ? stable : unstable) = middle;
  }
  return stable;
}

double compute_stable_stiffness(const Operator& hand, double period, contact::PenaltyKind penalty) {
  const HeldMotion m(hand, period);
  // From F to x: (c z + a q − c p)/((z − 1)(z − p)); from x to F: −K, or −K (z + 1)/(2 z).
  const double d = m.a * m.q - m.c * m.p;
  const auto is_stable = [&](double K) {
    Eigen::Matrix3d companion = Eigen::Matrix3d::Zero();
    companion.diagonal(-1).setOnes();
    if (penalty == contact::PenaltyKind::discrete) {  // z (z² − (1 + p − K c) z + p + K d)
      companion.row(0) << 1.0 + m.p - K * m.c, -(m.p + K * d), 0.0;
    } else {  // z³ − (1 + p − ½K c) z² + (p + ½K (c + d)) z + ½K d
      companion.row(0) << 1.0 + m.p - 0.5 * K * m.c, -(m.p + 0.5 * K * (m.c + d)), -0.5 * K * d;
    }
    return companion.eigenvalues().cwiseAbs().maxCoeff() < 1.0;
  };
  double stable = 1e-6;
  double unstable = 1e9;
  while (unstable / stable > 1.0 + 1e-12) {
    const double middle = std::sqrt(stable * unstable);
    (is_stable(middle) ? stable : unstable) = middle;
  }
  return stable;
}

}  // namespace argil::verification
