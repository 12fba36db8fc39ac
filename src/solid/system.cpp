#include "solid/system.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "solid/tet_lanes.h"

namespace argil::solid {
namespace {

/// Does the matrix leave out the nodes' stiffness of p1_nodal, to begin with? Its factors take a third of the
/// memory and no assembly; but a Cholesky factor of the rest alone is no exact one, and the matrix of a
/// law that is not quadratic needs two sets of factors, for elasticity and damping.
bool keeps_nodal_factors(const SolidParams& params) {
  using linear::SolverKind;
  const SolverKind kind = params.solver.kind;
  return (kind == SolverKind::pcg || kind == SolverKind::pcg_jacobi) && params.iteration == Iteration::one &&
         (find_law(params.model).is_quadratic ||
          (find_law(params.model).lanes.stiffness && params.rayleigh_stiffness == 0.0));
}

/// Rows that share a block with each row, itself included, increasing.
std::vector<std::vector<int>> find_neighbours(const Model& model, const NodalVolume* stored) {
  std::vector<std::vector<int>> rows(model.node_of_row.size());
  if (model.has_only_diagonal()) {
    for (std::size_t row = 0; row < rows.size(); ++row) rows[row] = {static_cast<int>(row)};
    return rows;
  }
  if (stored) return stored->find_row_neighbours();
  const auto neighbours = find_node_neighbours(model.elements);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (const int node : neighbours[static_cast<std::size_t>(model.node_of_row[row])])
      if (model.row_of_node[static_cast<std::size_t>(node)] >= 0)
        rows[row].push_back(model.row_of_node[static_cast<std::size_t>(node)]);
    std::sort(rows[row].begin(), rows[row].end());
  }
  return rows;
}

void make_pattern(const Model& model, const Materials& materials, System& system) {
  NodalVolume* stored = system.has_nodal_blocks(materials) ? materials.nodal() : nullptr;
  system.matrix = linear::make_block_matrix(find_neighbours(model, stored));
  if (stored && !model.has_only_diagonal()) stored->connect(system.matrix);
  const Elements& elements = model.elements;
  const int N = elements.nodes_per_tet;
  system.block_of_corner_pair.clear();
  system.block_of_corner_pair.reserve(static_cast<std::size_t>(N * N * elements.num_tets()));
  for (int t = 0; t < elements.num_tets(); ++t)
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) {
        const int row = model.row_of_node[static_cast<std::size_t>(elements.nodes(i, t))];
        const int column = model.row_of_node[static_cast<std::size_t>(elements.nodes(j, t))];
        system.block_of_corner_pair.push_back(
            row < 0 || column < 0 ? -1 : linear::find_block(system.matrix, row, column));
      }
}

std::unique_ptr<NodalProduct> make_nodal_product(const Model& model, const Materials& materials) {
  return std::make_unique<NodalProduct>(
      *materials.nodal(), model.node_of_row, model.row_of_node, model.constraints,
      model.params.solver.tolerance >= linear::kRoomForFloats, model.threads);
}

void make_anew(const Model& model, const Materials& materials, System& system) {
  std::vector<std::uint32_t> revision = std::move(system.matrix.revision);  // none comes twice
  make_pattern(model, materials, system);
  for (std::size_t row = 0; row < revision.size(); ++row) system.matrix.revision[row] = revision[row] + 1;
  system.stored_shares = {};
  std::fill(system.is_row_stale.begin(), system.is_row_stale.end(), char{1});
}

}  // namespace

System::System(const Model& model, const Materials& materials) {
  if (materials.nodal() && keeps_nodal_factors(model.params))
    nodal_product = make_nodal_product(model, materials);
  make_pattern(model, materials, *this);
  is_tet_changed.resize(static_cast<std::size_t>(model.elements.num_tets()), 1);
  unloads.resize(static_cast<std::size_t>(model.elements.num_points()), 0);
  is_row_stale.resize(static_cast<std::size_t>(model.num_free()), 1);
  if (model.keeps_tet_stiffness()) {
    const Elements& elements = model.elements;
    const bool is_quadratic = elements.nodes_per_tet == 10;
    pairs.setZero(9, (is_quadratic ? kQuadraticPairs : kPairBlocks) * elements.num_tets());
    if (is_quadratic) point_pairs.setZero(9, kPairBlocks * elements.num_points());
  }
  rhs.setZero(3, model.num_free());
  delta.setZero(3, model.num_free());
  v_base.setZero(3, model.elements.num_nodes());
}

void System::mark_all_changed() {
  std::fill(is_tet_changed.begin(), is_tet_changed.end(), char{1});
}

void store_nodal_stiffness(const Model& model, const Materials& materials, System& system) {
  if (!system.nodal_product) return;
  system.nodal_product.reset();
  make_anew(model, materials, system);
}

void drop_nodal_stiffness(const Model& model, const Materials& materials, System& system) {
  if (system.nodal_product || !materials.nodal()) return;
  system.nodal_product = make_nodal_product(model, materials);
  make_anew(model, materials, system);
}

}  // namespace argil::solid
