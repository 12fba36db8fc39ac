#include "solid/model.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "mesh/order.h"

namespace argil::solid {
namespace {

/// Must a step be told where this support is? Backward Euler's leaves what does not move where it is.
bool is_placed(const Model& model, int support) {
  return model.params.integrator != Integrator::backward_euler ||
         !model.supports[static_cast<std::size_t>(support)].displacement.isZero(0.0);
}

void number_rows(Model& model) {
  const Elements& elements = model.elements;
  model.row_of_node.assign(static_cast<std::size_t>(elements.num_nodes()), -1);
  for (int n = 0; n < elements.num_nodes(); ++n)
    for (int k = 0; k < 3; ++k)
      if (const int support = model.constraints.support(k, n); support >= 0 && is_placed(model, support))
        model.placed_components.push_back({n, k});
  model.nodes_along_curve.resize(model.row_of_node.size());
  std::iota(model.nodes_along_curve.begin(), model.nodes_along_curve.end(), 0);
  mesh::sort_along_curve(elements.rest, model.nodes_along_curve);
  std::copy_if(model.nodes_along_curve.begin(), model.nodes_along_curve.end(),
               std::back_inserter(model.node_of_row),
               [&model](int n) { return !model.constraints.is_held(n); });
  for (int row = 0; row < model.num_free(); ++row) {
    const int n = model.node_of_row[static_cast<std::size_t>(row)];
    model.row_of_node[static_cast<std::size_t>(n)] = row;
    if (!model.constraints.is_free(n)) model.held_rows.push_back(row);
  }
}

}  // namespace

Model::Model(const mesh::TetMesh& mesh, const mesh::Topology& topology, std::vector<Support> held,
             const SolidParams& parameters, int num_threads)
    : params(parameters),
      threads(num_threads),
      elements(make_elements(mesh, topology, params.element)),
      supports(std::move(held)),
      constraints(find_constraints(elements, supports)) {
  number_rows(*this);
}

bool Model::keeps_tet_stiffness() const {
  const ElasticLaw& law = find_law(params.model);
  const bool has_no_other_way = !law.is_quadratic || params.element == ElementKind::p2;
  return law.lanes.stiffness && has_no_other_way && params.iteration == Iteration::one &&
         !has_only_diagonal();
}

bool Model::has_deformed_frames() const {
  return keeps_tet_stiffness() && !find_law(params.model).is_quadratic;
}

bool Model::has_logarithmic_points() const {
  const ElasticLaw& law = find_law(params.model);
  return law.lanes.forces && law.plastic_split == PlasticSplit::logarithmic;
}

Vec3 find_free_part(const Model& model, const Vec3& force, Eigen::Index node) {
  return (model.constraints.support.col(node).array() >= 0).select(Vec3::Zero(), force);
}

void clear_held(const Model& model, Points& u) {
  for (const int row : model.held_rows) {
    const int n = model.node_of_row[static_cast<std::size_t>(row)];
    for (int k = 0; k < 3; ++k)
      if (model.constraints.support(k, n) >= 0) u(k, n) = 0.0;
  }
}

}  // namespace argil::solid
