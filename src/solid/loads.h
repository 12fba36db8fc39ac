#pragma once

#include "solid/elements.h"
#include "solid/supports.h"

namespace argil::solid {

/// Constant force on some nodes.
struct NodalLoad {
  std::vector<int> nodes;
  Vec3 force = Vec3::Zero();  ///< [N] on each
};

/// Constant pressure on the boundary faces whose corners all lie in a region.
struct PressureLoad {
  Region region;
  double pressure = 0.0;  ///< [Pa], pushing inward
};

/// Loads that do not change during a run: dead loads, on the shape at rest.
struct Loads {
  std::vector<NodalLoad> nodal;
  std::vector<PressureLoad> pressure;
};

/// Boundary faces (3×b vertex numbers) whose corners all lie in the region, increasing.
std::vector<int> find_faces(const Points& rest, const Triangles& boundary, const Region& region);

/// 3×n nodal forces [N] of all loads.
Points compute_load_force(const Elements& elements, const Triangles& boundary, const Loads& loads);

}  // namespace argil::solid
