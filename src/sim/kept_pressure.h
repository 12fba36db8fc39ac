#pragma once

#include <vector>

#include "contact/pressure.h"

namespace argil::sim {

/// A point of a surface that a tool presses on.
struct PressedPoint {
  Vec3 place = Vec3::Zero();  ///< [m]
  double force = 0.0;         ///< [N]
  double area = 0.0;          ///< [m²]
};

/// Of a surface at x, with κ `per_area` [Pa/m] of its triangles.
std::vector<PressedPoint> list_pressed(const contact::Contacts& contacts, const Triangles& triangles,
                                       const Points& x, const Field& per_area);

/// How the tool stands on the surface that takes the place of another.
struct StandingTool {
  contact::ToolSolid& shape;
  contact::Pose pose;
  double force = 0.0;  ///< [N] that it pressed with
};

/// A new surface on which the tool presses as it did on the one before. Its facets lie elsewhere, by more
/// than clay gives way: near the tool its vertices are moved along the way out of it until `law` finds on
/// each the pressure there was, all to the same force. Returns their places [m].
Points keep_pressure(const std::vector<PressedPoint>& before, const StandingTool& tool,
                     const Triangles& triangles, const Points& x, contact::PressureContact& law);

}  // namespace argil::sim
