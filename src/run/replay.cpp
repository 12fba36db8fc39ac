#include "run/replay.h"

#include <algorithm>

#include "base/error.h"
#include "hdf5/file.h"
#include "run/identity.h"
#include "scenario/patch.h"

namespace argil::run {
namespace {

constexpr int kMostSaid = 5;  // differences between two scenarios

/// After a step of the body: as the physics thread of the session did.
void append_step(Tick ticks_before, sim::Simulation& simulation, output::ResultFile& file) {
  sim::BodySide& body = simulation.body_side();
  file.append(body.make_record());
  const int period = simulation.params().rates.frame_period_ticks;
  if (sim::passes_multiple(ticks_before, body.hand().ticks, period)) file.append(body.make_frame_of_step());
}

}  // namespace

scenario::Scenario without_trace(scenario::Scenario s) {
  s.trace = {};
  return s;
}

std::optional<output::Session> find_session(const std::string& trace, const scenario::Scenario& s,
                                            std::string& note) {
  if (trace.empty() || s.mode == scenario::Mode::equilibrium || !hdf5::is_hdf5(trace)) return std::nullopt;
  {
    const hdf5::File file = hdf5::File::open_for_reading(trace);
    if (!file.root().has("session")) return std::nullopt;
  }
  const output::ResultReader reader(trace);
  const Identity identity = find_identity(without_trace(s));
  const auto differs = [&](const char* name, const std::string& wanted) {
    return reader.find_provenance(name).value_or("") != wanted;
  };
  if (differs("scenario_sha256", identity.scenario) || differs("inputs_sha256", identity.inputs)) {
    const std::string settings =
        scenario::describe_differences(reader.find_provenance("scenario").value_or(""),
                                       scenario::print_portable(without_trace(s)), kMostSaid);
    note = trace + " is a session of another scenario or other inputs: only its motion is taken" +
           (settings.empty() ? "" : "; other settings: " + settings);
    return std::nullopt;
  }
  if (differs("build", identity.build))
    note = trace + " was recorded by another build, whose bits may differ";
  return reader.find_session();
}

sim::Params session_params(const output::SessionHead& head, sim::Params params) {
  constexpr double kSoftStart = 0.2;  // [s] in which a live hand's force rises at least
  params.device.max_force = head.max_force;
  params.device.max_torque = head.max_torque;
  params.device.ramp_s = std::max(params.device.ramp_s, kSoftStart);
  return params;
}

void end_session(sim::Simulation& simulation, output::ResultFile& file) {
  const bool is_in_last_frame =
      simulation.frame_due_last_tick() && simulation.body_side().hand().ticks == simulation.clock().tick;
  if (!is_in_last_frame) file.append(simulation.make_frame());
  file.end_session(simulation.state_hash());
}

std::optional<Failure> replay(const output::Session& session, sim::Simulation& simulation,
                              output::ResultFile& file) {
  file.begin_session(session.head, false);
  file.append(simulation.make_frame());
  Tick seen = 0;
  for (std::size_t k = 0; k < session.ticks.size(); ++k) {
    const output::SessionTick& tick = session.ticks[k];
    const Tick ticks_before = simulation.body_side().hand().ticks;
    const sim::TickPlan plan{tick.seen_step != seen, tick.begun_step != 0, tick.feed};
    seen = tick.seen_step;
    const StepStatus status = simulation.tick(session.samples[k], plan);
    if (!status.is_ok()) return status.failure();
    file.append(tick);
    file.append(simulation.haptic_record());
    if (plan.begins_step && simulation.step_status().is_ok()) append_step(ticks_before, simulation, file);
  }
  end_session(simulation, file);
  for (const StepStatus& status : {simulation.hand().status(), simulation.step_status()})
    if (!status.is_ok()) return status.failure();
  return std::nullopt;
}

}  // namespace argil::run
