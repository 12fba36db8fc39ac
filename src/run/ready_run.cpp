#include "run/ready_run.h"

#include <utility>

#include "run/approach.h"
#include "run/loop.h"
#include "run/start.h"

namespace argil::run {
namespace {

std::unique_ptr<FullModel> make_full(const scenario::Scenario& s, const scenario::Scene& scene,
                                     const device::DeviceSample& start) {
  if (s.params.fidelity.mode != sim::FidelityMode::check) return nullptr;
  return std::make_unique<FullModel>(scene.body, scene.tool, s.params, start);
}

}  // namespace

ReadyRun::ReadyRun(const scenario::Scenario& scenario, const std::string& given_trace,
                   const std::string& note, const std::optional<device::DeviceSample>& start)
    : s(scenario),
      scene(scenario::build_scene(s)),
      miss(start ? "" : describe_miss(s, scene, given_trace)),
      tool(scene.tool),
      full(make_full(s, scene, start ? *start : sample_at(s, scene.trace, 0))),
      simulation(std::move(scene.body), tool, s.params, start ? *start : sample_at(s, scene.trace, 0)),
      hand(s, scene.trace) {
  if (!note.empty()) scene.notes.push_back(note);
  if (!miss.empty()) scene.notes.push_back(miss);
  if (start) {
    require_free_start(simulation, tool, s.file, "the hand's start", "start outside the body");
    return;
  }
  const bool is_given = !given_trace.empty();
  require_free_start(simulation, tool, is_given ? given_trace : s.file, is_given ? "" : "/trace",
                     "start the motion outside it, or move it there by argil place");
}

output::ResultHeader ReadyRun::make_header(const Identity& identity) const {
  output::ResultHeader header = run::make_header(s, simulation, scene, tool, identity);
  header.fidelity = s.params.fidelity.mode;  // here a full run may go beside
  return header;
}

}  // namespace argil::run
