#pragma once

#include <string>
#include <vector>

#include "device/trace.h"
#include "mesh_files/readers.h"
#include "scenario/scenario.h"
#include "sim/state.h"

namespace argil::scenario {

/// What a simulation needs, made from a scenario's files and shapes.
struct Scene {
  sim::Body body;
  mesh::TriangleMesh tool;
  device::Trace trace;             ///< empty where the scenario has none: a live session's replay
  std::string medium_status;       ///< where eq. 6 stands at every φ and dry modulus that the run can reach
  std::vector<std::string> notes;  ///< for the user: mesh quality, cage report, warnings
  mesh_files::FileVertices file_vertices;  ///< of the body's mesh file
  std::vector<std::string> file_notes;     ///< what of the body's files was left out or turned; in notes, too
  std::string contact_cells;               ///< for the user, of the motion: describe_contact_cells
  std::string free_motion;                 ///< for the user, of a motion: describe_free_motion; in notes, too
};

/// Reads or generates the body, its cage and skin, the tool and the trace. Throws InputError for what cannot
/// run: inverted or flat tets, orphan vertices, regions without vertices, node numbers out of range, an open
/// tool, a trace that is shorter than asked; IoError when a file cannot be read. Cells are graded by the
/// scenario's trace, or by `touched_places` where they are given: those of a session that is replayed.
Scene build_scene(const Scenario& scenario, const std::vector<sim::TouchedPlace>* touched_places = nullptr);

}  // namespace argil::scenario
