// Writes the table of results/contact/stability.csv to standard output; scripts/plot_stability.py builds and
// runs it.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <span>

#include "stability.h"

namespace argil::verification {
namespace {

using contact::PenaltyKind;
using device::Passivity;
using sim::BetweenFrames;

struct Case {
  const char* name;
  Wall wall;
};

constexpr double kMost = 1e5;  // [N/m]
constexpr auto kPressure = contact::ContactLaw::pressure;
constexpr auto kPairs = contact::ContactLaw::pairs;
constexpr Case kCases[] = {
    {"1 kHz", {false, kPressure, 1, BetweenFrames::hold}},
    {"1 kHz mean", {false, kPairs, 1, BetweenFrames::hold, PenaltyKind::continuous}},
    {"71 Hz hold", {false, kPressure, 14, BetweenFrames::hold}},
    {"71 Hz hold mean", {false, kPairs, 14, BetweenFrames::hold, PenaltyKind::continuous}},
    {"71 Hz re_evaluate", {false, kPressure, 14, BetweenFrames::re_evaluate}},
    {"1 kHz", {true, kPressure, 1, BetweenFrames::hold}},
    {"71 Hz hold", {true, kPressure, 14, BetweenFrames::hold}},
    {"71 Hz re_evaluate", {true, kPressure, 14, BetweenFrames::re_evaluate}},
};
constexpr double kDamping[] = {0.1, 0.2, 0.5, 1.0, 2.0, 5.0};
constexpr double kDampingOnBody[] = {0.1, 0.5, 2.0, 5.0};  // whose rows take minutes

/// Contact stiffness at which the polynomial loses its stability; what is felt of it is in series with the
/// body.
double compute_exact(const Case& c, const Operator& hand) {
  const bool is_held = c.wall.between == BetweenFrames::hold;
  const double K =
      compute_stable_stiffness(hand, 1e-3 * (is_held ? c.wall.physics_period_ticks : 1), c.wall.penalty);
  const double body = compute_body_stiffness(c.wall.law);
  if (!c.wall.gives_way) return std::min(K, kMost);
  return K < body ? std::min(K * body / (body - K), kMost) : kMost;
}

void write_table() {
  std::cout
      << "body,case,damping_N_s_per_m,exact_N_per_m,nudge_N_per_m,drop_N_per_m,drop_passivity_N_per_m\n";
  for (const Case& c : kCases)
    for (const double damping : c.wall.gives_way ? std::span<const double>(kDampingOnBody) : kDamping) {
      Operator hand;
      hand.damping = damping;
      Wall controlled = c.wall;
      controlled.passivity = Passivity::time_domain;
      const double exact = compute_exact(c, hand);
      const double least = 0.5 * compute_stable_stiffness(hand, 0.014, PenaltyKind::continuous);
      std::cout << (c.wall.gives_way ? "elastic" : "wall") << ',' << c.name << ',' << damping << ',' << exact
                << ',' << find_stable_stiffness(c.wall, hand, Start::nudge, least, kMost) << ','
                << find_stable_stiffness(c.wall, hand, Start::drop, least, kMost) << ','
                << find_stable_stiffness(controlled, hand, Start::drop, least, kMost) << std::endl;
    }
}

}  // namespace
}  // namespace argil::verification

int main() {
  argil::verification::write_table();
  return 0;
}
