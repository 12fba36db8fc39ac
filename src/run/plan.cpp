#include "run/plan.h"

#include <cstdio>
#include <filesystem>
#include <sstream>
#include <vector>

#include "base/error.h"
#include "output/result_reader.h"
#include "output/text.h"
#include "run/accuracy.h"
#include "run/files.h"
#include "scenario/patch.h"
#include "scenario/scenario_text.h"

namespace argil::run {
namespace {

/// A file that is there no longer than this.
struct ShortLived {
  std::string name;
  ~ShortLived() {
    std::error_code ignored;
    std::filesystem::remove(name, ignored);
  }
};

template <class Number>
scenario::Setting set_number(const std::string& pointer, Number number) {
  std::ostringstream text;
  text.precision(17);
  text << number;
  return {pointer, text.str()};
}

/// Of a result, what its run had chosen.
std::vector<scenario::Setting> read_choice(const scenario::Scenario& s) {
  std::vector<scenario::Setting> choice = {
      {"/dynamics/element", scenario::quote("p2")},
      {"/body/cells/kind", scenario::quote("graded")},
      set_number("/body/cells/near_tool_m", s.body.cells.near_tool),
      set_number("/haptics/physics_period_ticks", s.params.rates.physics_period_ticks),
      set_number("/fidelity/accuracy", 0)};
  if (const std::string target = find_target_pointer(s.body); !target.empty())
    choice.push_back(set_number(target, s.body.target_tets));
  return choice;
}

}  // namespace

int plan(const PlanOptions& options) {
  const scenario::Scenario s = load(options.run);
  if (!(s.accuracy > 0.0))
    throw InputError(s.file, "/fidelity/accuracy", "is not given", "say --accuracy 0.02, for instance");
  check_patch_name(s, options.run.patches, options.output);
  const ShortLived result{std::filesystem::path(s.file).stem().string() + ".plan.h5"};
  RunOptions run_options = options.run;
  run_options.output = result.name;
  run_options.writes_xdmf = false;
  const RunEnd end = run_to_accuracy(s, run_options);
  if (end.code != kDone) {
    std::fprintf(stderr, "argil: %s\n", end.message.c_str());
    return end.code;
  }
  const output::ResultReader reader(result.name);
  const auto text = reader.find_provenance("scenario");
  const scenario::Scenario chosen = scenario::load_text(*text, s.file, {});
  if (!(chosen.body.cells.near_tool > 0.0))
    throw InputError(s.file, "/trace", "does not touch the body at rest: no cells follow from it",
                     "argil place " + repeat_words(options.run) + " says where it goes and how to move it");
  double seconds = 0.0;
  for (const auto& [name, of_name] : reader.read_timing())
    if (name == "total") seconds = of_name;
  const double motion = s.params.rates.haptic_period * static_cast<double>(reader.read_haptic().size());
  std::fprintf(
      stderr,
      "argil: note: a second of this motion took %.2g s; a live session cannot take longer than it lasts\n",
      seconds / motion);
  const std::string patch = scenario::print_patch(read_choice(chosen));
  if (options.output.empty()) {
    std::fputs(patch.c_str(), stdout);
    return kDone;
  }
  output::write_file(options.output, patch);
  std::printf("%s: argil live %s --patch %s\n", options.output.c_str(), options.run.scenario.c_str(),
              options.output.c_str());
  return kDone;
}

}  // namespace argil::run
