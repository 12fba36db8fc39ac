#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "device/trace.h"
#include "mesh/bisection.h"
#include "scenario/scenario.h"
#include "sim/state.h"

namespace argil::scenario {

/// Cells that are small where the tool comes and grow away from there.
struct CellSizes {
  double near = 0.0;    ///< where the tool comes [m]
  double growth = 0.0;  ///< per distance from them [–]; 0: as its power 6/5, in radii of contact
  std::vector<sim::TouchedPlace> places;
  std::vector<CellRegion> regions;
  double share = 1.0;  ///< by which all lengths of a place are smaller
  /// Wanted at x [m].
  double find(const Vec3& x) const;
};

/// Of a body that argil makes, before cells are graded: with fewer, limbs and edges get lost.
int count_fewest_tets(const BodySpec& body);

/// Tets to begin with, before cells are graded: less than are wanted in the end, where that is left open.
int count_first_tets(const BodySpec& body);

/// Halves the tets of a surface's body near the places of a motion, as a file has them, to the size `near`
/// [m]. Places farther from the surface than ten times that do not count. Throws InputError when none is
/// left.
mesh::TetMesh grade_cage(const embed::Cage& cage, embed::Fit fit, const mesh::TriangleMesh& surface,
                         const device::Trace& trace, double near);

/// What became of the vertices of a body whose cells were graded.
struct Halvings {
  std::vector<std::array<int, 2>> ends;  ///< of each halved edge: vertices, or others halved before
  std::vector<int> number;  ///< of the vertices that were there, then of the middles of those edges
  /// Puts numbers in the graded body in the place of those before.
  void renumber(std::vector<int>& nodes) const;
  /// The same with the middles between two of them.
  void renumber_with_middles(std::vector<int>& nodes) const;
};

/// Halves a body's tets as /body/cells asks for, by the motion of the tool or by `touched_places`, where they
/// are given, and says so in `notes`. What the scenario leaves open of the sizes is chosen so that a body
/// that argil makes gets about as many tets as wanted; in a mesh file's, so that two cells lie along the
/// largest radius of a touched place. Where stresses fall as 1/r², sizes that grow as r^{6/5} make the error
/// of linear tets least for their number: in elastic clay they are h₀ (1 + d/a)^{6/5} at a distance d from
/// the ball of 1.5 a round a patch of radius a. Clay that flows wants more of the cells below the tool
/// (results/clay): there, in a mesh file and where h₀ is given they are h₀ + 2.4 d h₀/a, with a slope of 0.8
/// at most. None, and the reason in `notes`, where neither motion nor regions say where, or no tets are left
/// to halve. `bends_edges`: the edges of the boundary are to bend with the surface; else they stay straight.
std::optional<Halvings> grade_cells(const Scenario& s, const device::Trace& trace,
                                    const mesh::TriangleMesh& tool_surface,
                                    const std::vector<sim::TouchedPlace>* touched_places, sim::Body& body,
                                    std::vector<std::string>& notes, bool bends_edges = false);

/// Of the largest patch that the motion presses on the body at rest [m]; 0: none.
double find_contact_radius(const Scenario& s, const device::Trace& trace,
                           const mesh::TriangleMesh& tool_surface, const sim::Body& body);

/// How many cells lie along the radius of contact, where they are fewest of the places that the motion
/// presses at least half as wide as at its widest; what error that makes of an elastic force, and what mends
/// it. Those of cells that were graded are the places that they were graded by. Empty where the motion does
/// not meet the body at rest.
std::string describe_contact_cells(const Scenario& s, const device::Trace& trace,
                                   const mesh::TriangleMesh& tool_surface, const sim::Body& body);

}  // namespace argil::scenario
