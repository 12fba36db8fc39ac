#include "solid/material_changes.h"

#include "solid/active_region.h"

namespace argil::solid {

void set_material(Body& body, ActiveRegion& region, int tet, const TetMaterial& material) {
  region.wake_tet(tet);
  body.materials.set_moduli(tet, material);
  body.system.is_tet_changed[static_cast<std::size_t>(tet)] = 1;
  body.energies.is_batch_new[static_cast<std::size_t>(tet / kLanes)] = 1;
}

void set_stiffness(Body& body, int tet, const Mat6& C, double shape_stiffness) {
  body.materials.set_stiffness(tet, C, shape_stiffness);
  body.system.is_tet_changed[static_cast<std::size_t>(tet)] = 1;
}

void set_swelling(Body& body, int tet, double volume_ratio) {
  body.materials.set_swelling(tet, volume_ratio);
  body.kinematics.drop_frame(tet);
  body.system.is_tet_changed[static_cast<std::size_t>(tet)] = 1;
}

void set_water_mass(Body& body, int tet, double mass) {
  body.materials.set_water_mass(tet, mass);
  for (const int node : body.model.elements.nodes.col(tet))
    if (const int row = body.model.row_of_node[static_cast<std::size_t>(node)]; row >= 0)
      body.system.is_row_stale[static_cast<std::size_t>(row)] = 1;
}

}  // namespace argil::solid
