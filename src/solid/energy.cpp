// Energies of the body.

#include "solid/energy.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/ordered_sum.h"
#include "base/parallel.h"

namespace argil::solid {

EnergySums::EnergySums(const Elements& elements) {
  const Eigen::Index num_batches = (elements.num_tets() + kLanes - 1) / kLanes;
  is_batch_new.resize(static_cast<std::size_t>(num_batches), 1);
  batch_energy.setZero(num_batches);
  batch_plastic_strain.setZero(num_batches);
  group_energy.setZero((num_batches + kBatchGroup - 1) / kBatchGroup);
  group_plastic_strain.setZero(group_energy.size());
}

double compute_elastic_energy(const Strained& body, int point, const Vec6& plastic_strain) {
  return body.materials.weight()(point) *
         compute_energy_density(body.law(), body.kinematics.at(point), plastic_strain,
                                body.elasticity(body.model.elements.tet_of_point(point)));
}

double compute_elastic_energy(const Strained& body, Field& change) {
  NodalVolume* nodal = body.materials.nodal();
  if (has_plain_tets(body.model, body.materials) && !nodal) {
    const ForceArrays tets = make_force_arrays(body, nullptr);
    const std::ptrdiff_t count = body.model.elements.num_points();
    const auto compute = find_law(body.law()).lanes.energy;
    return ordered_sum((count + kLanes - 1) / kLanes, [&](std::ptrdiff_t batch) {
      return compute(tets, batch * kLanes, std::min((batch + 1) * kLanes, count));
    });
  }
  const double own = ordered_sum(body.model.elements.num_points(), [&](std::ptrdiff_t p) {
    return compute_elastic_energy(body, static_cast<int>(p), body.plastic_strain.col(p));
  });
  if (!nodal) return own;
  nodal->update_stiffness();
  compute_volume_changes(body, change);
  return own + nodal->compute_energy(change);
}

StrainSummary summarise(const Strained& body, EnergySums& sums, Field& change) {
  const TensorField& plastic_strain = body.plastic_strain;
  const auto find_largest = [&](Eigen::Index begin, Eigen::Index end) {
    double squares = 0.0;
    for (Eigen::Index p = begin; p < end; ++p)
      squares = std::max(squares, plastic_strain.col(p).squaredNorm());
    return std::sqrt(squares);
  };
  if (!has_plain_tets(body.model, body.materials) || body.materials.nodal())
    return {compute_elastic_energy(body, change), find_largest(0, plastic_strain.cols())};
  const ForceArrays tets = make_force_arrays(body, nullptr);
  const Elements& elements = body.model.elements;
  const auto is_new = [&sums](std::ptrdiff_t batch) {
    return sums.is_batch_new.begin() + std::min<std::ptrdiff_t>(batch, std::ssize(sums.is_batch_new));
  };
  parallel_for(sums.group_energy.size(), body.model.threads, [&](std::ptrdiff_t group) {
    const auto begin = is_new(kBatchGroup * group), end = is_new(kBatchGroup * (group + 1));
    if (std::find(begin, end, char{1}) == end) return;
    double& energy = sums.group_energy(group);
    double& largest = sums.group_plastic_strain(group);
    energy = largest = 0.0;
    for (auto at = begin; at != end; ++at) {
      const std::ptrdiff_t batch = at - sums.is_batch_new.begin();
      if (*at != 0) {
        double of_batch = 0.0, largest_of_batch = 0.0;
        const std::ptrdiff_t first = batch * kLanes;
        each_points(elements, first, std::min<std::ptrdiff_t>(first + kLanes, elements.num_tets()),
                    [&](std::ptrdiff_t from, std::ptrdiff_t to) {
                      of_batch += find_law(body.law()).lanes.energy(tets, from, to);
                      largest_of_batch = std::max(largest_of_batch, find_largest(from, to));
                    });
        sums.batch_energy(batch) = of_batch;
        sums.batch_plastic_strain(batch) = largest_of_batch;
        *at = 0;
      }
      energy += sums.batch_energy(batch);
      largest = std::max(largest, sums.batch_plastic_strain(batch));
    }
  });
  return {
      ordered_sum(sums.group_energy.size(), [&](std::ptrdiff_t group) { return sums.group_energy(group); }),
      sums.group_plastic_strain.maxCoeff()};
}

double compute_kinetic_energy(const Materials& materials, const Part& part, const Points& v) {
  const Field& mass = materials.mass();
  return part.nodes.sum(mass.size(),
                        [&](std::ptrdiff_t n) { return 0.5 * mass(n) * v.col(n).squaredNorm(); });
}

bool is_strained(const Strained& body, int tet) {
  constexpr double kRounding = 1e-12;  // of a strain; a body at rest has some 1e-16
  const Eigen::Index Q = body.model.elements.points_per_tet;
  for (Eigen::Index p = Q * tet; p < Q * (tet + 1); ++p)
    if (!((body.kinematics.strain().col(p) - body.plastic_strain.col(p)).norm() <= kRounding)) return true;
  return false;
}

}  // namespace argil::solid
