#include "run/start.h"

#include <algorithm>
#include <iomanip>
#include <limits>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/print.h"
#include "embed/triangle_tree.h"
#include "mesh/order.h"

namespace argil::run {

std::string describe_contact_stiffness(const sim::BodySide& body, const contact::ContactParams& params) {
  if (params.law != contact::ContactLaw::pressure) return "";
  std::ostringstream text;
  text << std::setprecision(3);
  if (params.pressure_stiffness > 0.0) {
    text << "pressure, " << params.pressure_stiffness << " Pa/m as given";
    return text.str();
  }
  Field list = body.find_surface_stiffness().per_area;
  std::sort(list.begin(), list.end());
  text << "pressure, " << list(list.size() / 2) << " Pa/m (" << list(0) << " to " << list(list.size() - 1)
       << ") as chosen, " << contact::kChosenStiffness << " E*/cell";
  return text.str();
}

output::ResultHeader make_header(const scenario::Scenario& s, const sim::Simulation& simulation,
                                 const scenario::Scene& scene, const mesh::TriangleMesh& tool,
                                 const Identity& identity) {
  output::ResultHeader header;
  header.rest_position = simulation.body().mesh.vertices;
  header.tets = mesh::in_file_order(simulation.body().mesh, simulation.body().mesh.tets);
  header.surface_triangles = simulation.body().topology.boundary;
  header.skin_triangles = simulation.body().skin.triangles;
  header.tool = tool;
  header.touched_places = simulation.body().touched_places;
  header.haptic_period = s.params.rates.haptic_period;
  header.estimates_error = s.params.estimates_error;
  // Statics writes one frame, which other programs compare node by node.
  header.frame_precision =
      s.mode == scenario::Mode::dynamic ? s.frame_precision : output::FramePrecision::whole;
  if (s.params.fidelity.mode != sim::FidelityMode::full) header.fidelity = sim::FidelityMode::automatic;
  std::string notes;
  for (const std::string& note : scene.notes) notes += note + "\n";
  header.provenance = {{"about", s.about},
                       {"scenario", scenario::print_portable(s)},
                       {"trace_sha256", scene.trace.sha256},
                       {"effective_medium", scene.medium_status},
                       {"notes", notes}};
  if (std::string text = describe_contact_stiffness(simulation.body_side(), s.params.contact); !text.empty())
    header.provenance.emplace_back("contact", std::move(text));
  if (!scene.contact_cells.empty()) header.provenance.emplace_back("contact_cells", scene.contact_cells);
  for (const auto& [name, text] : identity.provenance()) header.provenance.emplace_back(name, text);
  return header;
}

namespace {

/// Deepest place of a surface's vertices in a closed surface [m]; 0 when all are outside.
double find_depth(const Points& vertices, const mesh::TriangleMesh& surface) {
  const embed::TriangleTree tree(surface);
  double depth = 0.0;
  for (Eigen::Index v = 0; v < vertices.cols(); ++v)
    if (tree.compute_winding_number(vertices.col(v)) > 0.5)
      depth = std::max(depth, tree.compute_distance(vertices.col(v), std::numeric_limits<double>::max()));
  return depth;
}

}  // namespace

void require_free_start(const sim::Simulation& simulation, mesh::TriangleMesh tool, const std::string& file,
                        const std::string& place, const std::string& remedy) {
  if (!simulation.tool_overlaps_body()) return;
  const contact::Pose& pose = simulation.hand_state().tool;
  tool.vertices = (pose.orientation.toRotationMatrix() * tool.vertices).colwise() + pose.position;
  const solid::Elements& elements = simulation.solid().model.elements;
  const mesh::TriangleMesh body{elements.rest, elements.surface};
  const double depth = std::max(find_depth(tool.vertices, body), find_depth(body.vertices, tool));
  std::ostringstream text;
  text << "the tool starts in or across the body, " << std::setprecision(3) << 1e3 * depth
       << " mm deep, with the hand at " << print_place(pose.position) << " m";
  throw InputError(file, place, text.str(), remedy);
}

}  // namespace argil::run
