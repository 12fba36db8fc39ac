// Command line → command → exit code.

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "cli/commands.h"
#include "run/identity.h"
#include "run/interrupt.h"
#include "run/run.h"
#include "scenario/json_document.h"

namespace {

/// The parser would only miss a command.
void require_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (word.starts_with("-") || std::find(names.begin(), names.end(), word) != names.end()) return;
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  const std::string nearest = argil::scenario::find_nearest(word, names);
  throw argil::InputError(
      word, "", "is no command",
      (nearest.empty() ? "" : "did you mean " + nearest + "? ") + ("commands are: " + list));
}

}  // namespace

int main(int argc, char** argv) {
  using argil::run::ExitCode;
  CLI::App app("Deterministic simulator of porous, deformable clay touched by a haptic tool", "argil");
  app.set_version_flag("--version", argil::run::describe_build());
  app.require_subcommand(1);
  int code = ExitCode::kDone;
  argil::cli::add_run_commands(app, code);
  argil::cli::add_law_commands(app, code);
  argil::cli::add_study_commands(app, code);
  try {
    if (argc > 1) require_command(app, argv[1]);
    app.parse(argc, argv);
    return code;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ExitCode::kDone : ExitCode::kInputRefused;
  } catch (const argil::InputError& error) {
    std::istringstream lines(error.what());  // a fault each
    for (std::string line; std::getline(lines, line);) std::fprintf(stderr, "argil: %s\n", line.c_str());
    return ExitCode::kInputRefused;
  } catch (const argil::run::Interrupted& signal) {
    std::fprintf(stderr, "argil: %s\n", signal.what());
    return ExitCode::kInterrupted;
  } catch (const argil::IoError& error) {
    std::fprintf(stderr, "argil: %s\n", error.what());
    return ExitCode::kIoFailed;
  } catch (const std::filesystem::filesystem_error& error) {
    std::fprintf(stderr, "argil: %s: %s; check the place and its permissions\n", error.path1().c_str(),
                 error.code().message().c_str());
    return ExitCode::kIoFailed;
  } catch (const std::bad_alloc&) {
    std::fputs("argil: not enough memory for this input; make it smaller\n", stderr);
    return ExitCode::kIoFailed;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "argil: %s\n", error.what());
    return ExitCode::kIoFailed;
  }
}
