#include "shapes/creatures.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "shapes/distance.h"

namespace argil::shapes {
namespace {

// A limb runs through spheres (centre, radius) that cones connect. Given on the half y ≥ 0, it has a twin.
struct Limb {
  std::vector<Vec4> spheres;
  double blend;  // width of the rounded crease to what was put there before
};
struct Lump {
  Ellipsoid ellipsoid;
  double blend;
};

// A creature of unit size, mirrored in y. Lumps come first.
struct Creature {
  std::vector<Lump> lumps;
  std::vector<Limb> limbs;
};

Ellipsoid tilted(const Vec3& centre, const Vec3& radii, double slope_xz) {
  Ellipsoid ellipsoid = {centre, radii, Mat3::Identity()};
  const double scale = 1.0 / std::sqrt(1.0 + slope_xz * slope_xz);  // a rotation about y without trigonometry
  ellipsoid.axes.col(0) = scale * Vec3(1.0, 0.0, slope_xz);
  ellipsoid.axes.col(2) = scale * Vec3(-slope_xz, 0.0, 1.0);
  return ellipsoid;
}

double compute_distance(const Limb& limb, const Vec3& x) {
  constexpr double kJointBlend = 0.4;  // of the joint's radius: fills the hollow of a bend, hardly swells it
  double distance = 1e9;
  for (std::size_t i = 0; i + 1 < limb.spheres.size(); ++i) {
    const Vec4& a = limb.spheres[i];
    const Vec4& b = limb.spheres[i + 1];
    distance = smooth_min(distance, compute_distance(TaperedCapsule{a.head<3>(), b.head<3>(), a(3), b(3)}, x),
                          kJointBlend * a(3));
  }
  return distance;
}

double compute_value(const Creature& creature, const Vec3& x) {
  const Vec3 half(x(0), std::abs(x(1)), x(2));
  double value = 1e9;
  for (const Lump& lump : creature.lumps)
    value = smooth_min(value, compute_distance(lump.ellipsoid, half), lump.blend);
  for (const Limb& limb : creature.limbs) value = smooth_min(value, compute_distance(limb, half), limb.blend);
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
      {tilted({-0.03, 0.0, 0.33}, {0.13, 0.082, 0.1}, 0.12), 0.05},   // hips
      {tilted({0.1, 0.0, 0.345}, {0.12, 0.078, 0.09}, 0.3), 0.06},    // belly and chest
      {tilted({0.315, 0.0, 0.538}, {0.078, 0.06, 0.06}, 0.0), 0.04},  // skull
  };
  creature.limbs = {
      // tail
      {{{-0.07, 0, 0.335, 0.085},
        {-0.2, 0, 0.302, 0.06},
        {-0.34, 0, 0.288, 0.034},
        {-0.488, 0, 0.306, 0.012}},
       0.06},
      // neck
      {{{0.15, 0, 0.375, 0.078}, {0.22, 0, 0.455, 0.06}, {0.28, 0, 0.52, 0.05}}, 0.06},
      // upper jaw, lower jaw, brow, eye
      {{{0.34, 0.016, 0.54, 0.047}, {0.464, 0.016, 0.522, 0.034}}, 0.025},
      {{{0.31, 0.022, 0.485, 0.034}, {0.442, 0.012, 0.424, 0.021}}, 0.02},
      {{{0.345, 0.042, 0.588, 0.013}, {0.405, 0.034, 0.569, 0.01}}, 0.018},
      {{{0.36, 0.045, 0.568, 0.0135}, {0.366, 0.0455, 0.567, 0.0135}}, 0.004},
      // leg down to the ankle, instep
      {{{-0.03, 0.065, 0.32, 0.088},
        {0.035, 0.095, 0.195, 0.052},
        {-0.05, 0.1, 0.095, 0.029},
        {-0.008, 0.105, 0.022, 0.028}},
       0.03},
      // toes
      {{{-0.01, 0.105, 0.016, 0.028}, {0.085, 0.11, 0.011, 0.017}}, 0.015},
      {{{-0.01, 0.1, 0.016, 0.025}, {0.068, 0.07, 0.011, 0.016}}, 0.012},
      {{{-0.01, 0.11, 0.016, 0.025}, {0.06, 0.15, 0.011, 0.016}}, 0.012},
      // arm and two fingers
      {{{0.165, 0.066, 0.36, 0.036}, {0.18, 0.1, 0.303, 0.029}, {0.232, 0.094, 0.293, 0.024}}, 0.025},
      {{{0.232, 0.1, 0.293, 0.017}, {0.264, 0.112, 0.276, 0.012}}, 0.01},
      {{{0.232, 0.088, 0.293, 0.017}, {0.264, 0.078, 0.276, 0.012}}, 0.01},
  };
  return creature;
}

Creature make_unit_figure() {
  Creature creature;
  creature.lumps = {
      {tilted({0.0, 0.0, 0.565}, {0.066, 0.095, 0.08}, 0.0), 0.03},     // hips
      {tilted({0.0, 0.0, 0.725}, {0.07, 0.11, 0.11}, 0.05), 0.09},      // chest
      {tilted({0.005, 0.0, 0.928}, {0.062, 0.052, 0.072}, 0.0), 0.01},  // head
  };
  creature.limbs = {
      // neck
      {{{-0.005, 0, 0.79, 0.042}, {0.0, 0, 0.88, 0.036}}, 0.03},
      // chin, nose
      {{{0.02, 0, 0.885, 0.032}, {0.04, 0, 0.88, 0.022}}, 0.03},
      {{{0.06, 0, 0.93, 0.008}, {0.068, 0, 0.912, 0.011}}, 0.015},
      // shoulder, arm, hand, thumb
      {{{-0.005, 0.06, 0.795, 0.045},
        {-0.005, 0.125, 0.775, 0.047},
        {-0.01, 0.195, 0.635, 0.038},
        {0.02, 0.245, 0.5, 0.031}},
       0.03},
      {{{0.022, 0.247, 0.485, 0.031}, {0.034, 0.262, 0.43, 0.036}}, 0.02},
      {{{0.04, 0.247, 0.475, 0.015}, {0.075, 0.236, 0.438, 0.014}}, 0.012},
      // leg, foot
      {{{0.0, 0.058, 0.53, 0.07}, {0.012, 0.08, 0.29, 0.051}, {-0.012, 0.095, 0.06, 0.036}}, 0.03},
      {{{-0.02, 0.095, 0.025, 0.038}, {0.085, 0.115, 0.016, 0.031}}, 0.025},
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

}  // namespace argil::shapes
