#include "run/resume.h"

#include <filesystem>

#include "base/error.h"
#include "output/result_reader.h"

namespace argil::run {

ResumePoint find_resume_point(const std::string& result, const Identity& identity) {
  if (!std::filesystem::exists(result)) return {};
  const output::ResultReader reader(result);
  const auto require = [&](const char* name, const std::string& what, const std::string& wanted) {
    const std::string found = reader.find_provenance(name).value_or("");
    if (found != wanted)
      throw InputError(result, std::string("/provenance/") + name, "was written by " + what,
                       "resume with what it was begun with, or leave --resume out to begin anew");
  };
  require("scenario_sha256", "another scenario or with other settings", identity.scenario);
  require("inputs_sha256", "a run that read other files (trace, body or tool)", identity.inputs);
  require("build", "another build of argil, whose bits may differ", identity.build);
  if (reader.outcome() == output::Outcome::done) return {ResumePoint::Kind::done, {}, {}};
  std::optional<Snapshot> state = reader.find_checkpoint();
  if (!state) return {};
  const auto tick = static_cast<Tick>(state->at("tick")(0, 0));
  return {ResumePoint::Kind::checkpoint, std::move(*state), reader.find_last_cells(tick)};
}

}  // namespace argil::run
