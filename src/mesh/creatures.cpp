#include "mesh/creatures.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "mesh/distance.h"

namespace argil::mesh {
namespace {

// One lump of clay and how softly it joins what was put there before. Lumps off the middle plane have a twin.
struct Limb {
  TaperedCapsule capsule;
  double blend;  // width of the rounded crease
};
struct Lump {
  Ellipsoid ellipsoid;
  double blend;
};

// A creature of unit size, given by its half y ≥ 0 and mirrored.
struct Creature {
  std::vector<Limb> limbs;
  std::vector<Lump> lumps;
};

Ellipsoid tilted(const Vec3& centre, const Vec3& radii, double slope_xz) {
  Ellipsoid ellipsoid = {centre, radii, Mat3::Identity()};
  const double scale = 1.0 / std::sqrt(1.0 + slope_xz * slope_xz);  // a rotation about y without trigonometry
  ellipsoid.axes.col(0) = scale * Vec3(1.0, 0.0, slope_xz);
  ellipsoid.axes.col(2) = scale * Vec3(-slope_xz, 0.0, 1.0);
  return ellipsoid;
}

double compute_value(const Creature& creature, const Vec3& x) {
  const Vec3 half(x(0), std::abs(x(1)), x(2));
  double value = 1e9;
  for (const Lump& lump : creature.lumps)
    value = smooth_min(value, compute_distance(lump.ellipsoid, half), lump.blend);
  for (const Limb& limb : creature.limbs)
    value = smooth_min(value, compute_distance(limb.capsule, half), limb.blend);
  return std::max(value, -x(2));  // flat soles
}

ImplicitSurface make_surface(Creature creature, double size, const Vec3& lower, const Vec3& upper) {
  ImplicitSurface surface;
  surface.lower = size * lower;
  surface.upper = size * upper;
  surface.value = [parts = std::move(creature), size](const Vec3& x) {
    return size * compute_value(parts, x / size);
  };
  return surface;
}

Creature make_unit_dinosaur() {
  Creature creature;
  creature.lumps = {
      {tilted({-0.02, 0.0, 0.325}, {0.13, 0.088, 0.105}, 0.15), 0.05},    // hips
      {tilted({0.115, 0.0, 0.355}, {0.12, 0.085, 0.1}, 0.35), 0.06},      // chest
      {tilted({0.335, 0.0, 0.528}, {0.07, 0.056, 0.055}, -0.05), 0.05},   // skull
      {tilted({0.415, 0.0, 0.518}, {0.082, 0.043, 0.037}, -0.12), 0.03},  // snout
  };
  creature.limbs = {
      {{{-0.06, 0, 0.325}, {-0.22, 0, 0.288}, 0.085, 0.055}, 0.05},  // tail
      {{{-0.22, 0, 0.288}, {-0.36, 0, 0.275}, 0.055, 0.034}, 0.03},
      {{{-0.36, 0, 0.275}, {-0.482, 0, 0.305}, 0.034, 0.016}, 0.03},
      {{{0.17, 0, 0.39}, {0.235, 0, 0.465}, 0.082, 0.064}, 0.06},  // neck
      {{{0.235, 0, 0.465}, {0.315, 0, 0.525}, 0.064, 0.056}, 0.05},
      {{{0.31, 0, 0.485}, {0.435, 0, 0.432}, 0.034, 0.021}, 0.02},           // lower jaw
      {{{0.365, 0.04, 0.568}, {0.405, 0.034, 0.556}, 0.014, 0.01}, 0.015},   // brow
      {{{-0.015, 0.07, 0.315}, {0.04, 0.1, 0.18}, 0.085, 0.05}, 0.04},       // thigh
      {{{0.04, 0.1, 0.18}, {-0.045, 0.105, 0.09}, 0.046, 0.03}, 0.03},       // shin
      {{{-0.045, 0.105, 0.09}, {0.0, 0.105, 0.022}, 0.03, 0.03}, 0.025},     // instep
      {{{-0.005, 0.105, 0.018}, {0.085, 0.105, 0.012}, 0.03, 0.018}, 0.02},  // toes
      {{{-0.005, 0.1, 0.018}, {0.065, 0.065, 0.012}, 0.025, 0.017}, 0.015},
      {{{-0.005, 0.11, 0.018}, {0.06, 0.148, 0.012}, 0.025, 0.017}, 0.015},
      {{{0.18, 0.07, 0.37}, {0.19, 0.1, 0.315}, 0.03, 0.02}, 0.025},  // arm
      {{{0.19, 0.1, 0.315}, {0.24, 0.095, 0.3}, 0.02, 0.015}, 0.015},
      {{{0.24, 0.095, 0.3}, {0.262, 0.088, 0.278}, 0.012, 0.01}, 0.01},
  };
  return creature;
}

Creature make_unit_figure() {
  Creature creature;
  creature.lumps = {
      {tilted({0.0, 0.0, 0.92}, {0.068, 0.06, 0.08}, 0.0), 0.03},   // head
      {tilted({0.0, 0.0, 0.70}, {0.075, 0.115, 0.11}, 0.0), 0.03},  // chest
      {tilted({0.0, 0.0, 0.53}, {0.075, 0.1, 0.075}, 0.0), 0.08},   // pelvis
  };
  creature.limbs = {
      {{{0, 0, 0.78}, {0.005, 0, 0.87}, 0.045, 0.04}, 0.04},           // neck
      {{{0, 0, 0.55}, {0, 0, 0.68}, 0.08, 0.08}, 0.08},                // waist
      {{{0, 0.115, 0.765}, {-0.005, 0.2, 0.62}, 0.046, 0.036}, 0.04},  // arms
      {{{-0.005, 0.2, 0.62}, {0.025, 0.255, 0.48}, 0.036, 0.03}, 0.02},
      {{{0.025, 0.255, 0.48}, {0.035, 0.272, 0.43}, 0.032, 0.03}, 0.02},  // hands
      {{{0, 0.06, 0.5}, {0.01, 0.09, 0.28}, 0.068, 0.05}, 0.03},          // legs
      {{{0.01, 0.09, 0.28}, {-0.01, 0.105, 0.06}, 0.05, 0.036}, 0.03},
      {{{-0.015, 0.105, 0.03}, {0.085, 0.12, 0.022}, 0.038, 0.03}, 0.03},  // feet
  };
  return creature;
}

}  // namespace

ImplicitSurface make_dinosaur(double length) {
  return make_surface(make_unit_dinosaur(), length, {-0.5, -0.2, 0.0}, {0.5, 0.2, 0.6});
}

ImplicitSurface make_figure(double height) {
  return make_surface(make_unit_figure(), height, {-0.1, -0.32, 0.0}, {0.13, 0.32, 1.0});
}

}  // namespace argil::mesh
