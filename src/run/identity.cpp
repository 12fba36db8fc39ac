#include "run/identity.h"

#include <sstream>

#include "base/hash.h"
#include "run/build_info.h"
#include "run/files.h"

namespace argil::run {
std::string Identity::id() const {
  return Sha256().add(scenario + "\n" + inputs + build).hex_digest();
}

std::vector<std::pair<std::string, std::string>> Identity::provenance() const {
  std::vector<std::pair<std::string, std::string>> texts = {
      {"run_id", id()}, {"scenario_sha256", scenario}, {"inputs_sha256", inputs}, {"build", build}};
  if (!asked_id.empty()) texts.emplace_back("asked_run_id", asked_id);
  return texts;
}

Identity find_identity(const scenario::Scenario& s) {
  Identity identity;
  identity.scenario = Sha256().add(scenario::print_portable(s)).hex_digest();
  for (const scenario::InputFile& input : scenario::list_input_files(s))
    if (!input.pointer.empty()) identity.inputs += input.pointer + " " + hash_file(input.file) + "\n";
  identity.build = describe_build();
  return identity;
}

std::string describe_build() {
  std::ostringstream text;
  text << "argil " << kVersion << "\ncommit " << kCommit << "\ncompiler " << kCompiler << "\nbuild "
       << kBuildType << "\nflags " << kFlags << "\neigen " << EIGEN_WORLD_VERSION << '.'
       << EIGEN_MAJOR_VERSION << '.' << EIGEN_MINOR_VERSION
       << "\ncholesky CHOLMOD simplicial LDL'\nthreads do not change results\n";
  return text.str();
}

}  // namespace argil::run
