#pragma once

#include <optional>

#include "output/result_reader.h"
#include "scenario/scenario.h"
#include "sim/simulation.h"

namespace argil::run {

/// The scenario as a live session is known by: its motion comes from the device.
scenario::Scenario without_trace(scenario::Scenario s);

/// The session that TRACE holds, if it is one of this scenario (but for /trace) and its inputs. Nothing for
/// any other trace; `note` says then why a session is taken for its motion alone.
std::optional<output::Session> find_session(const std::string& trace, const scenario::Scenario& s,
                                            std::string& note);

/// With what the device allowed, and a start that is never sudden.
sim::Params session_params(const output::SessionHead& head, sim::Params params);

/// The last frame and the hash of all, when the hand has ended and the body made its last step.
void end_session(sim::Simulation& simulation, output::ResultFile& file);

/// Makes the session again in one thread: the same samples, each physics step with the same ticks' contacts
/// and seen in the same tick. Writes the same records, frames and hashes. Returns the failure in which it
/// ended.
std::optional<Failure> replay(const output::Session& session, sim::Simulation& simulation,
                              output::ResultFile& file);

}  // namespace argil::run
