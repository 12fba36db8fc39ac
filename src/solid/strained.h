#pragma once

#include "solid/kinematics.h"
#include "solid/materials.h"
#include "solid/tet_lanes.h"

namespace argil::solid {

/// p1_nodal: relative volume changes at the present kinematics.
struct VolumeChange {
  Field of_tet;    ///< θ of each tet [–]
  Field mean;      ///< of each tet's nodes, their mean [–]; empty before the first update
  Field pressure;  ///< and the stress that it is [Pa]
};

/// The body as it is strained: what forces, matrix and energies are computed from.
struct Strained {
  const Model& model;
  const Materials& materials;
  const Kinematics& kinematics;
  const TensorField& plastic_strain;  ///< ε_p of each point
  const VolumeChange& volume;
  ElasticArrays elastic = {};  ///< as far as they are known

  StrainModel law() const { return model.params.model; }
  Elasticity elasticity(int tet) const;
  /// ∂θ/∂F of a 4-node tet.
  Mat3 volume_gradient(int tet) const;
};

/// Are all 4-node tets of an isotropic law?
bool has_isotropic_tets(const Model& model, const Materials& materials);
/// Do the points of all tets go eight at a time for forces and energies?
bool has_plain_tets(const Model& model, const Materials& materials);

/// Of such points, what forces and energies are computed from; corner_force may be null.
ForceArrays make_force_arrays(const Strained& body, double* corner_force);

/// p1_nodal: θ of each tet.
void compute_volume_changes(const Strained& body, Field& change);

/// p1_nodal: brings `volume`, that of `body`, up to date; else nothing.
void update_volume_change(const Strained& body, VolumeChange& volume);

}  // namespace argil::solid
