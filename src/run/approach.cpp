#include "run/approach.h"

#include <sstream>
#include <utility>

#include "run/loop.h"
#include "run/run.h"
#include "solid/elements.h"

namespace argil::run {

std::vector<contact::Pose> list_poses(const scenario::Scenario& s, const device::Trace& trace) {
  const Tick num_ticks = count_ticks(s, trace);
  std::vector<contact::Pose> poses;
  poses.reserve(static_cast<std::size_t>(num_ticks) + 1);
  for (Tick k = 0; k <= num_ticks; ++k) {
    const device::DeviceSample sample = sample_at(s, trace, k);
    poses.push_back({sample.position, sample.orientation});
  }
  return poses;
}

contact::ApproachFinder make_approach_finder(const scenario::Scenario& s, const scenario::Scene& scene) {
  contact::ToolSolid tool = contact::make_tool_solid(s.params.contact.round_tool, scene.tool);
  const sim::Body& body = scene.body;
  if (s.params.contact_surface == sim::SurfaceKind::skin) return {body.skin, std::move(tool)};
  const solid::Elements elements = solid::make_elements(body.mesh, body.topology, s.params.solid.element);
  return {{elements.rest, elements.surface}, std::move(tool)};
}

std::string describe_miss(const scenario::Scenario& s, const scenario::Scene& scene,
                          const std::string& given_trace) {
  if (scene.trace.samples.empty() || s.hand.kind == scenario::HandKind::simulated) return "";
  if (!scene.contact_cells.empty()) return "";  // which are those of the places that it touches
  const contact::Approach nearest =
      make_approach_finder(s, scene).find(list_poses(s, scene.trace), Vec3::Zero(), 0.0);
  if (nearest.distance <= 0.0) return "";
  std::ostringstream text;
  text.precision(3);
  text << "the tool never comes nearer than " << nearest.distance << " m to the body at rest, at "
       << static_cast<double>(nearest.pose) * s.params.rates.haptic_period << " s; argil place "
       << quote_word(s.file) << (given_trace.empty() ? "" : " --trace " + quote_word(given_trace))
       << " brings the motion onto it";
  return text.str();
}

}  // namespace argil::run
