#include "solid/strained.h"

#include "base/parallel.h"

namespace argil::solid {

Elasticity Strained::elasticity(int tet) const {
  Elasticity e = materials.elasticity(tet);
  if (volume.mean.size() > 0) e.volume_change = volume.mean(tet);
  return e;
}

Mat3 Strained::volume_gradient(int tet) const {
  return compute_volume_gradient(law(), kinematics.at(tet), plastic_strain.col(tet));
}

bool has_isotropic_tets(const Model& model, const Materials& materials) {
  return model.elements.nodes_per_tet == 4 && materials.is_isotropic();
}

bool has_plain_tets(const Model& model, const Materials& materials) {
  return materials.is_isotropic() && find_law(model.params.model).lanes.forces;
}

ForceArrays make_force_arrays(const Strained& body, double* corner_force) {
  return {body.materials.gradient().data(),
          body.kinematics.rotation().data(),
          body.kinematics.strain().data(),
          body.plastic_strain.data(),
          body.materials.weight().data(),
          body.materials.point_lambda().data(),
          body.materials.point_mu().data(),
          body.materials.nodal() ? body.volume.pressure.data() : nullptr,
          find_law(body.law()).is_linear,
          corner_force,
          body.elastic};
}

void compute_volume_changes(const Strained& body, Field& change) {
  change.resize(body.model.elements.num_tets());
  const bool is_quadratic = find_law(body.law()).is_quadratic;  // whose volume change is tr ε_e
  parallel_for(change.size(), body.model.threads, [&](std::ptrdiff_t t) {
    change(t) = is_quadratic ? (body.kinematics.strain().col(t) - body.plastic_strain.col(t)).head<3>().sum()
                             : compute_volume_change(body.law(), body.kinematics.at(static_cast<int>(t)),
                                                     body.plastic_strain.col(t));
  });
}

void update_volume_change(const Strained& body, VolumeChange& volume) {
  NodalVolume* nodal = body.materials.nodal();
  if (!nodal) return;
  nodal->update_stiffness();
  compute_volume_changes(body, volume.of_tet);
  nodal->average(volume.of_tet, volume.mean);
  volume.pressure = body.materials.excess_bulk().cwiseProduct(volume.mean);
}

}  // namespace argil::solid
