#pragma once

#include <vector>

#include "solid/part.h"
#include "solid/strained.h"

namespace argil::solid {

/// Of the body as a whole.
struct StrainSummary {
  double elastic_energy = 0.0;          ///< [J]
  double largest_plastic_strain = 0.0;  ///< ‖ε_p‖
};

/// Energies of runs of kLanes tets, found anew only where they moved.
struct EnergySums {
  explicit EnergySums(const Elements& elements);

  std::vector<char> is_batch_new;  ///< have its tets moved since they were summed up?
  Field batch_energy, batch_plastic_strain;
  Field group_energy, group_plastic_strain;  ///< of each group of these runs
};

/// Elastic energy of one point for the given plastic strain [J], without what nodes share (p1_nodal).
double compute_elastic_energy(const Strained& body, int point, const Vec6& plastic_strain);

/// Of the body [J]. `change`: working array of p1_nodal.
double compute_elastic_energy(const Strained& body, Field& change);

/// The same and the largest ‖ε_p‖. Tets that have not moved since the last call are not looked at.
StrainSummary summarise(const Strained& body, EnergySums& sums, Field& change);

/// Of the nodes of the part; the others have no speed [J]. v: 3×n [m/s].
double compute_kinetic_energy(const Materials& materials, const Part& part, const Points& v);

/// Does a tet hold elastic strain beyond what rounding leaves in a body at rest?
bool is_strained(const Strained& body, int tet);

}  // namespace argil::solid
