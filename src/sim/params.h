#pragma once

#include <vector>

#include "contact/parameters.h"
#include "device/gate.h"
#include "device/passivity.h"
#include "material/parameters.h"
#include "sim/fidelity.h"
#include "solid/parameters.h"
#include "water/parameters.h"

namespace argil::sim {

/// How the hand's force is found between two physics steps.
enum class BetweenFrames {
  hold,  ///< the paper: one detection a physics step over the tool's whole motion, then the force is kept
  re_evaluate,  ///< pairs: contact every tick against the last surface; a pressure: carried on as the body
                ///< yields
  compliant,    ///< pairs: the same, and the surface yields, too (compliance.h); a pressure: as re_evaluate
};

/// How much of a body a step solves for.
enum class Extent {
  automatic,  ///< local where that can be and saves time, else whole (extent.h)
  whole,
  local,  ///< the region that moves; the rest stays where it is
};

/// What the tool meets.
enum class SurfaceKind {
  cage,       ///< the boundary of the solid (the paper)
  skin,       ///< the embedded surface: what the eye sees
  automatic,  ///< of a scenario: by the pressure law the skin where there is one, else the cage
};

/// Rates as whole numbers of haptic ticks.
struct RateParams {
  double haptic_period = 0.001;  ///< δ [s]
  int physics_period_ticks = 1;  ///< solid and contact work once in so many ticks
  int water_period_ticks = 10;   ///< uptake, diffusion and moduli; a multiple of physics_period_ticks
  int frame_period_ticks = 100;  ///< pictures
  BetweenFrames between_frames = BetweenFrames::hold;

  double step_seconds() const { return haptic_period * physics_period_ticks; }  ///< of physics [s]
  /// Does step number `step`, from 1, move water?
  bool moves_water(Tick step) const { return step * physics_period_ticks % water_period_ticks == 0; }
};

/// Everything that stays the same during a run, in SI units.
struct Params {
  RateParams rates;
  material::Elastic elastic;
  material::Moisture moisture;
  material::Plasticity plasticity;
  material::ClayKernel kernel;
  water::WaterParams water;
  solid::SolidParams solid;
  Extent extent = Extent::whole;
  contact::ContactParams contact;
  SurfaceKind contact_surface = SurfaceKind::cage;
  FidelityParams fidelity;
  device::DeviceLimits device;
  device::Passivity passivity = device::Passivity::none;
  double chatter_limit = 0.3;  ///< of device::ChatterWatch; 1: none
  /// Speed of the fastest node [m/s] at which a body that nothing touches counts as at rest for two steps: it
  /// is then stopped and not solved for until something acts. 0: only a body that has not moved yet.
  double rest_speed = 0.0;
  /// Kinetic energy over the energy that hand, loads and supports gave the body since the start, each push
  /// counted and no recoil, beyond which the run stops. 0: no limit; none where clay swells.
  double energy_limit = 10.0;
  /// A step that cannot be made ends the run. Else its motion is limited, or the body stands still for it,
  /// and the run goes on.
  bool is_strict = true;
  /// Estimate in every step by how much the force at the hand is off.
  bool estimates_error = false;
  int threads = 1;

  /// The body gets the contacts of one detection a step, over the tool's whole motion since the last.
  bool detects_once_a_step() const {
    return rates.between_frames == BetweenFrames::hold || contact.law == contact::ContactLaw::pressure;
  }
  /// Between two steps the hand feels how the last answer to a pressure goes on.
  bool carries_force_on() const {
    return contact.law == contact::ContactLaw::pressure && rates.between_frames != BetweenFrames::hold &&
           rates.physics_period_ticks > 1;
  }
  /// The surface that the tool meets deflects between two steps.
  bool deflects_between_steps() const {
    return rates.between_frames == BetweenFrames::compliant && contact.law == contact::ContactLaw::pairs;
  }
};

}  // namespace argil::sim
