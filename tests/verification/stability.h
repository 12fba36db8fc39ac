#pragma once

#include "sim/simulation.h"

namespace argil::verification {

/// What holds the tool: a mass that moves along z through a damper, pressed down by a steady force.
struct Operator {
  double mass = 0.1;     ///< of hand and device [kg]
  double damping = 0.5;  ///< [N s/m]
  double press = 0.02;   ///< [N]
};

/// How the wall is touched: a large ball, flat over the whole top of a block (the pressure law), or on a
/// point (pairs).
struct Wall {
  bool gives_way = false;  ///< is elastic, or does not move at all
  contact::ContactLaw law = contact::ContactLaw::pressure;
  int physics_period_ticks = 1;
  sim::BetweenFrames between = sim::BetweenFrames::hold;
  contact::PenaltyKind penalty = contact::PenaltyKind::discrete;  ///< of pairs
  device::Passivity passivity = device::Passivity::none;
};

/// How the operator begins.
enum class Start {
  nudge,  ///< at rest in balance with the wall, with a small speed: the linear limit
  drop,   ///< at rest 2 mm above the wall: bounces
};

/// What came of it. Speeds in m/s.
struct Closed {
  double begin_speed = 0.0;    ///< of the nudge, or of the first touch after the drop
  double first_speed = 0.0;    ///< largest in the first third of the run
  double last_speed = 0.0;     ///< largest in the last third; infinite when the body was crushed
  double largest_speed = 0.0;  ///< of all
  double lowest_energy = 0.0;  ///< of the passivity observer [J]
  double largest_step = 0.0;   ///< largest energy that one tick gave or took [J]

  /// Did the motion die away? A nudge must stay small throughout, so that the loop is linear.
  bool dies_away(Start start) const {
    return start == Start::nudge ? largest_speed < 20.0 * begin_speed && last_speed < first_speed
                                 : last_speed < 0.9 * begin_speed;
  }
};

/// Stiffness of a wall that gives way [N/m].
double compute_body_stiffness(contact::ContactLaw law);

/// The operator in closed loop with the simulation's own ticks, for 40 of its periods at the wall and 3 s at
/// least; its motion under the held force is exact. `stiffness`: of the contact [N/m].
Closed run_closed_loop(const Wall& wall, const Operator& hand, double stiffness, Start start);

/// Smallest contact stiffness [N/m] from `least` on at which the motion does not die away, to 1 in 1000;
/// `most` when there is none.
double find_stable_stiffness(const Wall& wall, const Operator& hand, Start start, double least, double most);

/// Stiffness [N/m] up to which a linear wall is stable, from its characteristic polynomial: the force −K x,
/// or with `continuous` −K times the mean of the last two x, is held for `period` seconds while m ẍ + b ẋ =
/// F.
double compute_stable_stiffness(const Operator& hand, double period, contact::PenaltyKind penalty);

}  // namespace argil::verification
