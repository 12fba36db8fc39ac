// Forces in two passes, each writing one slot an item: tets compute what their corners get, then every node
// gathers its force from the tets around it in the order of their numbers.

#include "solid/forces.h"

#include <algorithm>

#include "base/parallel.h"
#include "solid/quadratic_lanes.h"

namespace argil::solid {
namespace {

template <int N>
void set_corner_forces(const Strained& body, Eigen::Matrix3Xd& corner_force) {
  const int Q = body.model.elements.points_per_tet;
  parallel_for(body.model.elements.num_tets(), body.model.threads, [&](std::ptrdiff_t t) {
    const Elasticity e = body.elasticity(static_cast<int>(t));
    Eigen::Matrix<double, 3, N> force = Eigen::Matrix<double, 3, N>::Zero();
    for (int q = 0; q < Q; ++q) {
      const std::ptrdiff_t p = Q * t + q;
      const Mat3 P =
          body.materials.weight()(p) *
          compute_piola(body.law(), body.kinematics.at(static_cast<int>(p)), body.plastic_strain.col(p), e);
      force.noalias() += P * find_node_gradients<N>(body.materials.gradient(), p);
    }
    corner_force.middleCols<N>(N * t) = force;
  });
}

}  // namespace

/// Nodes along the curve: by the thread that has just set the forces around them.
void gather(const Model& model, const Part& part, const Eigen::Matrix3Xd& corner_force, Points& force) {
  constexpr std::size_t kAhead = 2;
  const Elements& elements = model.elements;
  const std::vector<int>& nodes = part.nodes.list() ? *part.nodes.list() : model.nodes_along_curve;
  const int* corners = elements.node_corners.data();
  parallel_for(static_cast<std::ptrdiff_t>(nodes.size()), model.threads, [&](std::ptrdiff_t item) {
    const auto i = static_cast<std::size_t>(item);
    const auto n = static_cast<std::size_t>(nodes[i]);
    const auto next = static_cast<std::size_t>(nodes[std::min(i + kAhead, nodes.size() - 1)]);
    __builtin_prefetch(corners + elements.node_begin[next]);
    __builtin_prefetch(corners + elements.node_begin[next] + 16);
    sum_corner_forces(corner_force.data(), corners, elements.node_begin[n], elements.node_begin[n + 1],
                      force.data() + 3 * n);
  });
}

void assemble_forces(const Strained& body, const Part& part, Forces& forces) {
  update_volume_change(body, forces.volume);
  const Elements& elements = body.model.elements;
  if (has_plain_tets(body.model, body.materials)) {
    const bool is_quadratic = elements.nodes_per_tet == 10;
    const ForceArrays points =
        make_force_arrays(body, is_quadratic ? forces.of_points.data() : forces.corner.data());
    part.batches.each(elements.num_tets(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      each_points(elements, begin, end, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
        find_law(body.law()).lanes.forces(points, first, last);
      });
      if (is_quadratic) set_node_forces(forces.of_points.data(), begin, end, forces.corner.data());
    });
  } else if (elements.nodes_per_tet == 4) {
    set_corner_forces<4>(body, forces.corner);
  } else {
    set_corner_forces<10>(body, forces.corner);
  }
  gather(body.model, part, forces.corner, forces.internal);
}

}  // namespace argil::solid
