"""Scenarios: what a run reads, with settings in the place of its own, checked as the program checks them."""
import json
import os

from . import _argil
from .errors import InputError


def _to_json(value):
    """A value of Python or numpy as JSON."""
    return json.dumps(value, default=lambda other: other.tolist() if hasattr(other, "tolist") else os.fspath(other))


def _settings(settings):
    if settings is not None and not isinstance(settings, dict):
        raise InputError(f'set: is a {type(settings).__name__}; give a dict, for instance {{"/tool/mode": "push"}}')
    for pointer in settings or {}:
        if not str(pointer).startswith("/"):
            raise InputError(f'set: "{pointer}" is no JSON pointer; it begins with "/", as "/material/youngs_modulus_Pa"')
    return [f"{pointer}={_to_json(value)}" for pointer, value in (settings or {}).items()]


class Scenario:
    """A scenario that has been read, checked and completed by its defaults.

    source: a JSON file, or a dict of the same keys.
    folder: of a dict; paths in it are relative to this folder.
    set: {"/json/pointer": value}, put in the place of the scenario's own values. Numpy's numbers and arrays are taken.
    patches: a JSON file or several with some of a scenario's keys, put in its place before `set`.
    trace: a recorded motion (CSV or HDF5) in the place of the scenario's. With a hand of one's own there need not be one.

    Raises InputError for what cannot run, IoError for what cannot be read.
    """

    def __init__(self, source, *, folder=".", set=None, patches=(), trace=None):  # pylint: disable=redefined-builtin
        is_dict = isinstance(source, dict)
        file = os.path.normpath(os.path.join(folder, "scenario")) if is_dict else os.fspath(source)
        patches = (patches,) if isinstance(patches, (str, os.PathLike)) else patches
        self._loaded = _argil.Scenario(file, _to_json(source) if is_dict else "", _settings(set),
                                       [os.fspath(patch) for patch in patches], os.fspath(trace or ""))

    @property
    def file(self):
        """The file that it was read from; what stands for it in messages where it was a dict."""
        return self._loaded.file

    @property
    def about(self):
        """What the scenario says of itself."""
        return self._loaded.about

    @property
    def warnings(self):
        """What its check has to say, a list of texts."""
        return self._loaded.warnings

    @property
    def resolved(self):
        """All its keys with every default written out, a dict; a Scenario of it is the same scenario."""
        return json.loads(self._loaded.resolved())

    def run(self, result, *, threads=1, resume=False, xdmf=True, quiet=True):
        """Runs it to its end and writes a result file, the bits of which are those of `argil run`.

        result: name of the HDF5 file; its XDMF for ParaView lies beside it unless `xdmf` is false.
        threads: results do not depend on them.
        resume: go on from the result's last checkpoint, if there is one.
        quiet: print nothing, as --quiet; else notes and progress go to the terminal.

        Returns the result, open for reading. Raises RunFailed, InputError, IoError. Ctrl-C ends it after the next step
        with a file that can be resumed, and raises KeyboardInterrupt. Other threads of Python go on meanwhile.
        """
        from .result import Result
        self._loaded.run(os.fspath(result), threads, resume, xdmf, quiet)
        return Result(result)

    def start(self, *, threads=1, record=None, position=None, orientation=None, mode=None):
        """A simulation that stands before its first tick; see Simulation. Of a live session as trace it takes the motion alone.

        threads: results do not depend on them.
        record: name of a result file that is written meanwhile.
        position [m], orientation (unit quaternion x, y, z, w), mode: where a hand of one's own is. Without a position
        it is where the scenario's motion begins.
        """
        from .simulation import Simulation
        return Simulation(self, threads=threads, record=record, position=position, orientation=orientation, mode=mode)

    def __repr__(self):
        return f"<argil.Scenario {self.file}: {self.about}>"


def load(file, *, set=None, patches=(), trace=None):  # pylint: disable=redefined-builtin
    """Reads a scenario file: Scenario(file, …)."""
    return Scenario(file, set=set, patches=patches, trace=trace)


def run(scenario, result, *, set=None, patches=(), trace=None, **options):  # pylint: disable=redefined-builtin
    """Reads a scenario, runs it and returns the result: load(…).run(result, …)."""
    return load(scenario, set=set, patches=patches, trace=trace).run(result, **options)


def schema():
    """The JSON Schema (2020-12) of a scenario, a dict."""
    return json.loads(_argil.schema())


def reference():
    """Every key of a scenario with unit, range, default and meaning: a page in Markdown."""
    return _argil.reference()


def build():
    """Version, commit, compiler and flags: what bits depend on besides the scenario."""
    return _argil.build()


def compare(a, b):
    """What is different between two result files, bit by bit, as `argil compare` says it; empty where nothing is."""
    return _argil.compare(os.fspath(a), os.fspath(b))
