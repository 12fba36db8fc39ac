"""argil: porous clay that a haptic tool presses, pulls, wets and dries.

    scene = argil.load("press.json", set={"/material/youngs_modulus_Pa": 5e4})
    scene.run("press.h5")                      # as `argil run` does, to the same bits
    force = argil.open("press.h5").force       # ticks × 3 [N]

    sim = scene.start()                        # or tick by tick
    while sim.ticks < sim.num_ticks:
        force = sim.tick()

Keys, units, ranges and defaults of a scenario are `argil.schema()` and, to read, `argil.reference()`. Figures are in
`argil.plot`, which is imported by that name.
"""
from .errors import InputError, IoError, RunFailed
from .result import Array, Frame, Result, open  # pylint: disable=redefined-builtin

# What simulates lies in a compiled module. It is loaded when it is first asked for, so that results are read and drawn
# also where nothing was built.
_SIMULATES = {"Scenario": "scenario", "load": "scenario", "run": "scenario", "schema": "scenario",
              "reference": "scenario", "compare": "scenario", "build": "scenario", "Simulation": "simulation"}

__all__ = ["Array", "Frame", "InputError", "IoError", "Result", "RunFailed", "open", *_SIMULATES]


def __getattr__(name):
    if name in _SIMULATES:
        from importlib import import_module
        return getattr(import_module(f".{_SIMULATES[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__():
    return sorted(__all__)
