#include "solid/curnier_lanes.h"

#include "solid/curnier_point.h"
#include "solid/pair_blocks.h"

namespace argil::solid {

ARGIL_EVERY_PROCESSOR void compute_curnier_forces(const ForceArrays& tets, std::ptrdiff_t begin,
                                                  std::ptrdiff_t end) {
  const std::ptrdiff_t last = end - 1;
  Lanes strain[6], stress[6], lambda, mu, weight, pressure = {};
  read_tensor(tets.strain, begin, last, strain);
  read_lanes<1>(tets.lambda, begin, last, &lambda);
  read_lanes<1>(tets.mu, begin, last, &mu);
  read_lanes<1>(tets.weight, begin, last, &weight);
  if (tets.pressure) read_lanes<1>(tets.pressure, begin, last, &pressure);
  set_curnier_stress(strain, lambda * weight, mu * weight, pressure * weight, stress);

  Lanes gradient[12], force[12];
  Real33<Lanes> R, biot, piola;
  read_lanes<9>(tets.R, begin, last, R.m);
  read_lanes<12>(tets.gradient, begin, last, gradient);
  set_symmetric(stress, biot);
  multiply(R, biot, piola);
  turn(piola, gradient, force);
  write_lanes<12>(force, begin, end, tets.corner_force);
}

ARGIL_EVERY_PROCESSOR double compute_curnier_energy(const ForceArrays& tets, std::ptrdiff_t begin,
                                                    std::ptrdiff_t end) {
  const std::ptrdiff_t last = end - 1;
  Lanes strain[6], lambda, mu, weight, energy;
  read_tensor(tets.strain, begin, last, strain);
  read_lanes<1>(tets.lambda, begin, last, &lambda);
  read_lanes<1>(tets.mu, begin, last, &mu);
  read_lanes<1>(tets.weight, begin, last, &weight);
  set_curnier_energy(strain, lambda, mu, energy);
  double sum = 0.0;
  for (std::ptrdiff_t t = begin; t < end; ++t) sum += weight[t - begin] * energy[t - begin];
  return sum;
}

ARGIL_EVERY_PROCESSOR void compute_curnier_stiffness(const TangentArrays& tets, std::ptrdiff_t begin,
                                                     std::ptrdiff_t end) {
  TangentLanes lanes;
  read_tangent_lanes(tets, begin, end, lanes);
  Lanes trace, none = {};
  Real33<Lanes> N;
  PrincipalTangent<Lanes> tangent;
  find_curnier_tangent(lanes.strain, lanes.lambda, lanes.mu, none, N, trace, tangent);
  write_pair_blocks(tets, begin, end, lanes, N, trace, tangent);
}

}  // namespace argil::solid
