#include "solid/material_changes.h"

#include <algorithm>

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

void note_flow(Body& body, const std::vector<char>& is_flowing, const std::vector<char>& was_flowing) {
  if (body.elastic.is_empty()) return;
  const auto num_tets = static_cast<std::size_t>(body.model.elements.num_tets());
  for (std::size_t run = 0; run < is_flowing.size(); ++run) {
    if (is_flowing[run] == 0 && was_flowing[run] == 0) continue;
    body.elastic.forget(static_cast<std::ptrdiff_t>(run));
    const std::size_t first = kLanes * run;
    for (std::size_t t = first; t < std::min(first + kLanes, num_tets); ++t) {
      body.system.is_tet_changed[t] = 1;
      if (body.model.params.flows_in_solve) body.kinematics.renew_frame(static_cast<int>(t));
    }
  }
}

void set_water_mass(Body& body, int tet, double mass) {
  body.materials.set_water_mass(tet, mass);
  for (const int node : body.model.elements.nodes.col(tet))
    if (const int row = body.model.row_of_node[static_cast<std::size_t>(node)]; row >= 0)
      body.system.is_row_stale[static_cast<std::size_t>(row)] = 1;
}

}  // namespace argil::solid
