#pragma once

#include <array>
#include <vector>

#include "mesh/topology.h"
#include "solid/elements.h"
#include "solid/parameters.h"
#include "solid/supports.h"

namespace argil::solid {

/// The body as it was made. No step changes any of it; another mesh is another model.
struct Model {
  Model(const mesh::TetMesh& mesh, const mesh::Topology& topology, std::vector<Support> supports,
        const SolidParams& params, int threads);

  SolidParams params;
  int threads;  ///< bits do not depend on it
  Elements elements;
  std::vector<Support> supports;
  Constraints constraints;

  // Rows of the system: nodes that are free in some direction, along a space-filling curve.
  std::vector<int> row_of_node;        ///< −1: held in all directions
  std::vector<int> node_of_row;        ///< node of each row
  std::vector<int> held_rows;          ///< rows with a held component
  std::vector<int> nodes_along_curve;  ///< every node, in the order of the curve
  /// Node and direction of the prescribed components that a step must be told about.
  std::vector<std::array<int, 2>> placed_components;

  int num_free() const { return static_cast<int>(node_of_row.size()); }  ///< rows
  /// Is the stiffness of each tet kept, from which rows are gathered? Where it changes with the strain, in
  /// steps with one linearisation.
  bool keeps_tet_stiffness() const;
  /// Does it follow the deformation, not the rotation alone?
  bool has_deformed_frames() const;
  /// Do points find their elastic strain by a logarithm?
  bool has_logarithmic_points() const;
  bool has_nodal_volume() const { return params.element == ElementKind::p1_nodal; }
  /// Does the matrix hold its diagonal blocks alone?
  bool has_only_diagonal() const { return params.solver.kind == linear::SolverKind::pcg_matrix_free; }
};

/// Of a force on a node [N], the part that no support takes.
Vec3 find_free_part(const Model& model, const Vec3& force, Eigen::Index node);

/// Sets the held components of 3×n nodes to zero.
void clear_held(const Model& model, Points& u);

}  // namespace argil::solid
