#include "run/place.h"

#include <cstdio>
#include <utility>

#include "base/error.h"
#include "output/text.h"
#include "run/files.h"

namespace argil::run {

int place(const PlaceOptions& options) {
  scenario::Scenario s = load(options.run);
  if (s.mode == scenario::Mode::equilibrium)
    throw InputError(s.file, "/dynamics/mode", "\"static\" has no motion to place", "give a trace");
  if (options.touch.from && !(options.touch.from->norm() > 0.0))
    throw InputError("--from", "", "is no direction", "write for instance --from 0,0,1");
  if (options.touch.at.has_value() != options.touch.from.has_value())
    throw InputError("--at", "", "and --from go together: a place and the direction that the tool comes from",
                     "write for instance --at 0,0,0.05 --from 0,0,1");
  check_patch_name(s, options.run.patches, options.output);
  Placing placing(options.touch, std::move(s));
  placing.print_start();
  placing.find();
  placing.print_end();
  if (options.output.empty()) {
    std::printf("\n%s", placing.patch().c_str());
    return kDone;
  }
  output::write_file(options.output, placing.patch());
  RunOptions next = options.run;
  next.patches.push_back(options.output);
  std::printf("%s: argil run %s\n", options.output.c_str(), repeat_words(next).c_str());
  return kDone;
}

}  // namespace argil::run
