#pragma once

#include <optional>
#include <string>

#include "embed/cage.h"
#include "scenario/scenario.h"
#include "sim/state.h"

namespace argil::scenario {

/// A body as it is between two steps.
struct PresentShape {
  const sim::Body& body;
  const Points& x;               ///< its nodes (3×n) [m]
  const Eigen::MatrixXi& nodes;  ///< of its tets: 4×m or 10×m
  mesh::TriangleMesh touched;    ///< what the tool meets, where it is now
  const mesh::TriangleMesh& tool;
  std::optional<contact::Pose> touching;  ///< the tool is there and presses
};

/// Can a body get new cells while the run goes on? What stands in the way, or empty.
std::string find_remesh_obstacle(const Scenario& s);

/// A body of new cells as a result has them, whose supports hold the listed vertices, with all that is found
/// of its mesh and its scenario.
sim::Body complete_cells(const Scenario& s, sim::Body body);

struct NewCells {
  sim::Body body;        ///< mesh, topology, skin and what the tool meets; not the clay's state
  bool is_torn = false;  ///< they leave out what is thinner than a cell, and what hung on it
};

/// New cells for a body in its present shape: a lattice that is fitted to what the tool meets, about as many
/// tets as before, or half as many more for thin parts, small at the places by which the old ones were
/// graded, which have moved with the clay. Throws InputError where there is no such lattice.
NewCells make_new_cells(const Scenario& s, const PresentShape& now);

}  // namespace argil::scenario
