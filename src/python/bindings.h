#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "run/run.h"

namespace argil::python {

/// argil.RunFailed on its way to Python.
struct RunFailed {
  run::RunEnd end;
};

/// A scenario that has been read, and how.
struct LoadedScenario {
  run::RunOptions options;
  scenario::Scenario s;
};

/// The scenario for a run on so many threads. Throws InputError where those are too few or too many.
LoadedScenario with_threads(LoadedScenario loaded, int threads);

/// simulation.cpp
void bind_simulation(pybind11::module_& module);

}  // namespace argil::python
