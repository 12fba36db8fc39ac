#pragma once

#include "solid/materials.h"

namespace argil::solid {

struct Body;
class ActiveRegion;

// What water changes of one tet, with the marks by which later stages know that it did. Forces and energy are
// those of the changed tet from the next kinematics on.

/// Stiffness and yield; the tet wakes.
void set_material(Body& body, ActiveRegion& region, int tet, const TetMaterial& material);
/// C (Mandel) [Pa] of an anisotropic law and its 2μ* [Pa]; set_material makes the tet isotropic again.
void set_stiffness(Body& body, int tet, const Mat6& C, double shape_stiffness = 0.0);
/// Rest volume of a tet over what it was made with (> 0): its shape at rest grows alike in all directions.
/// Mass stays.
void set_swelling(Body& body, int tet, double volume_ratio);
/// Flow of the points of runs of kLanes tets, or its end after the step before: elastic strain changes, and
/// stiffness that hangs on plastic strain.
void note_flow(Body& body, const std::vector<char>& is_flowing, const std::vector<char>& was_flowing);
/// Mass [kg] of water in a tet, shared among its nodes like that of the clay.
void set_water_mass(Body& body, int tet, double mass);

}  // namespace argil::solid
