// What Python calls of a scenario and a run to a file; errors as the classes of argil/errors.py. The
// package's own modules check and convert arguments and hold the documentation.

#include <pybind11/stl.h>

#include <csignal>
#include <cstdio>
#include <filesystem>

#include "base/error.h"
#include "output/compare.h"
#include "python/bindings.h"
#include "run/identity.h"
#include "run/interrupt.h"

namespace argil::python {
namespace py = pybind11;

LoadedScenario with_threads(LoadedScenario loaded, int threads) {
  if (threads < 1 || threads > run::kMostThreads)
    throw InputError("threads", "",
                     std::to_string(threads) + " is outside [1, " + std::to_string(run::kMostThreads) + "]",
                     "give a number of threads");
  loaded.options.threads = loaded.s.params.threads = threads;
  return loaded;
}

namespace {

LoadedScenario load(const std::string& file, const std::string& text,
                    const std::vector<std::string>& settings, const std::vector<std::string>& patches,
                    const std::string& trace) {
  LoadedScenario loaded;
  loaded.options.scenario = file;
  loaded.options.text = text;
  loaded.options.settings = settings;
  loaded.options.patches = patches;
  loaded.options.trace = trace;
  loaded.options.remedy = "go on with resume=True";
  loaded.options.has_own_hand = true;
  loaded.s = run::load(loaded.options);
  return loaded;
}

/// A signal ended the run: now Python does with it what it would have done.
[[noreturn]] void pass_on(int signal, const std::string& message) {
  std::raise(signal);
  if (PyErr_CheckSignals() == 0) PyErr_SetString(PyExc_KeyboardInterrupt, message.c_str());
  throw py::error_already_set();
}

void run_to_file(const LoadedScenario& loaded, const std::string& result, int threads, bool resume,
                 bool writes_xdmf, bool quiet) {
  run::require_motion(loaded.s, "add it, or move the tool tick by tick (start)");
  LoadedScenario run = with_threads(loaded, threads);
  run.options.output = result;
  run.options.resume = resume;
  run.options.writes_xdmf = writes_xdmf;
  run.options.quiet = quiet;
  run::RunEnd end;
  int signal = 0;
  {
    const run::SignalGuest signals;
    const py::gil_scoped_release others_may_go_on;
    end = run::run_loaded(run.s, run.options);
    signal = signals.caught();
  }
  std::fflush(stdout);
  if (end.code == run::kInterrupted) pass_on(signal, end.message);
  if (end.code != run::kDone) throw RunFailed{end};
}

/// What became different between two results, for a person; empty: nothing.
std::string compare(const std::string& a, const std::string& b) {
  const py::gil_scoped_release others_may_go_on;
  const output::CompareReport report = output::compare_results(a, b, {});
  return report.is_equal() ? "" : to_string(report);
}

void raise(const char* name, const py::tuple& arguments) {
  const py::object type = py::module_::import("argil.errors").attr(name);
  PyErr_SetObject(type.ptr(), type(*arguments).ptr());
}

void raise_failed(const run::RunEnd& end) {
  const Failure f = end.failure.value_or(Failure{});
  raise("RunFailed", py::make_tuple(end.message, f.tick, f.stage, f.element, f.quantity, f.value, f.bound));
}

/// As the exit codes of the program have them.
void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    raise("InputError", py::make_tuple(error.what()));
  } catch (const IoError& error) {
    raise("IoError", py::make_tuple(error.what()));
  } catch (const RunFailed& failed) {
    raise_failed(failed.end);
  } catch (const std::filesystem::filesystem_error& error) {
    raise("IoError", py::make_tuple(error.path1().string() + ": " + error.code().message() +
                                    "; check the place and its permissions"));
  }
}

}  // namespace
}  // namespace argil::python

PYBIND11_MODULE(_argil, module) {
  using namespace argil;
  using namespace argil::python;
  py::register_exception_translator(translate);
  py::class_<LoadedScenario>(module, "Scenario")
      .def(py::init(&load))
      .def_property_readonly("file", [](const LoadedScenario& loaded) { return loaded.s.file; })
      .def_property_readonly("about", [](const LoadedScenario& loaded) { return loaded.s.about; })
      .def_property_readonly("warnings", [](const LoadedScenario& loaded) { return loaded.s.warnings; })
      .def("resolved", [](const LoadedScenario& loaded) { return scenario::print_resolved(loaded.s); })
      .def("run", &run_to_file);
  bind_simulation(module);
  module.def("schema", &scenario::print_schema);
  module.def("reference", &scenario::print_reference);
  module.def("build", &run::describe_build);
  module.def("compare", &compare);
}
