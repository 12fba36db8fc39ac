#include "stability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/check.h"
#include "contact/tool_shape.h"
#include "support/block_body.h"
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

using contact::ContactLaw;

// A block that is pressed evenly: without Poisson's effect it is a column, of the stiffness E A/h, and the
// contact one of κ A.
constexpr double kSide = 0.02;          // of the square top, and the height [m]
constexpr double kTop = kSide * kSide;  // [m²]
constexpr double kFlat = 2e3;  // radius of a ball whose surface is flat over the top, to 10⁻⁷ m [m]
const material::Elastic kColumn = {2e4, 0.0};

sim::Params make_params(const Wall& wall, double stiffness) {
  sim::Params params = test::make_one_node_params();
  params.contact.law = wall.law;
  params.contact.penalty = wall.penalty;
  params.rates.physics_period_ticks = wall.physics_period_ticks;
  params.rates.between_frames = wall.between;
  params.passivity = wall.passivity;
  if (wall.law == ContactLaw::pairs) {
    params.contact.vertex_face_stiffness = stiffness;
    params.contact.edge_edge_stiffness = stiffness;
  } else {
    params.elastic = kColumn;
    params.contact.pressure_stiffness = stiffness / kTop;
    params.contact.grip_strength = 1e9;
    params.contact.round_tool = contact::RoundTool{kFlat, 0.0, kFlat, false};
  }
  return params;
}

device::DeviceSample press(const Wall& wall, double depth) {
  if (wall.law == ContactLaw::pairs)
    return test::press_apex(depth, wall.gives_way ? device::ToolMode::push : device::ToolMode::dry);
  device::DeviceSample sample;
  sample.position = {0.5 * kSide, 0.5 * kSide, kSide + kFlat - depth};
  return sample;
}

sim::Simulation make_simulation(const Wall& wall, const sim::Params& params) {
  if (wall.law == ContactLaw::pairs) return test::make_one_node_simulation(params);
  // Small faces press with their corners.
  sim::Body block = test::make_block_body(6, 6, 1, Vec3(kSide, kSide, kSide));
  if (!wall.gives_way) block.supports.front().region.offset = 2.0 * kSide;  // all of it is held
  return {block, contact::make_sphere_tool(kFlat, 0), params, press(wall, -1e-3)};
}

}  // namespace

double compute_body_stiffness(ContactLaw law) {
  return law == ContactLaw::pairs ? test::compute_apex_stiffness(test::make_one_node_params().elastic)
                                  : kColumn.youngs_modulus * kTop / kSide;
}

Closed run_closed_loop(const Wall& wall, const Operator& hand, double stiffness, Start start) {
  const sim::Params params = make_params(wall, stiffness);
  const double felt =
      wall.gives_way ? test::compute_series(stiffness, compute_body_stiffness(wall.law)) : stiffness;
  const double balance = hand.press / felt;
  const double frequency = std::sqrt(felt / hand.mass);
  const double seconds = std::max(3.0, 40.0 * 2.0 * std::numbers::pi / frequency);
  sim::Simulation simulation = make_simulation(wall, params);
  const HeldMotion motion(hand, kTick);
  Closed closed;
  double depth = start == Start::nudge ? balance : -2e-3;
  double speed = 0.0;  // inward
  if (start == Start::nudge) {
    for (int k = 0; k < 280; ++k)  // until the body is in balance too
      ARGIL_ASSERT(simulation.tick(press(wall, depth)).is_ok());
    speed = closed.begin_speed = 1e-3 * balance * frequency;  // a thousandth of the depth
  }
  double given = simulation.hand_state().port_energy;
  const int ticks = static_cast<int>(std::lround(seconds / kTick));
  for (int k = 0; k < ticks; ++k) {
    const double force = hand.press - simulation.haptic_record().device_force.z();
    depth += motion.a * speed + motion.c * force;
    speed = motion.p * speed + motion.q * force;
    if (closed.begin_speed == 0.0 && depth > 0.0) closed.begin_speed = speed;
    if (!(std::abs(depth) < 0.5) || !simulation.tick(press(wall, depth)).is_ok()) {
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
