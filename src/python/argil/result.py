"""Results: reads what is asked for when it is asked for, with unit and meaning. Names are those of the file."""
import os

import h5py
import numpy as np

from .errors import InputError, IoError

# The first that has a name gives it.
_GROUPS = ("haptic", "physics", "fidelity", "session", "mesh")


def open_file(file):
    """h5py's file of a result. Raises IoError, InputError where it is none."""
    try:
        result = h5py.File(os.fspath(file), "r")
    except OSError as error:
        reason = f"cannot be read: {error}"
        if "unable to lock" in str(error):
            reason = "a run writes it at present; wait for its end"
        elif "file signature not found" in str(error):
            reason = "is no HDF5 file, as results of argil run are"
        raise IoError(f"{os.fspath(file)}: {reason}") from None
    if _attributes(result).get("format", "") != "argil-result":
        result.close()
        raise InputError(f"{os.fspath(file)}: is not a result file of argil run")
    return result


def _attributes(node):
    return {name: value.decode() if isinstance(value, bytes) else value for name, value in node.attrs.items()}


class Array(np.ndarray):
    """A numpy array that knows its unit and its meaning. What is computed from it is a plain one."""

    units = about = ""

    def __array_finalize__(self, other):
        self.units, self.about = getattr(other, "units", ""), getattr(other, "about", "")

    def __array_wrap__(self, array, context=None):
        return np.asarray(array)[()]


def _read(dataset):
    if dataset.shape == () and h5py.check_string_dtype(dataset.dtype):
        return dataset.asstr()[()]
    array = dataset[()]
    if not isinstance(array, np.ndarray):
        return array
    array = array.view(Array)
    words = _attributes(dataset)
    array.units, array.about = words.get("units", ""), words.get("about", "")
    return array


class Group:
    """A group of a result: its datasets are attributes, each read when it is asked for; [name] is h5py's dataset, of
    which a part alone can be read."""

    def __init__(self, group):
        self._group = group

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            found = self._group[name]
        except KeyError:
            raise AttributeError(f"{self._group.file.filename}: no {name} in {self._group.name}; there is "
                                 f"{', '.join(dir(self))}") from None
        return Group(found) if isinstance(found, h5py.Group) else _read(found)

    def __getitem__(self, name):
        return self._group[name]

    def __dir__(self):
        return sorted(self._group)

    def __repr__(self):
        return f"<argil {self._group.name} of {self._group.file.filename}: {', '.join(dir(self))}>"


class Frame(Group):
    """The body at one moment: `position` n×3 [m], `saturation` of each tet, `plastic_strain`, `skin_position` …"""

    @property
    def time(self):
        """[s] since the start."""
        return float(self._group.attrs["time"])

    @property
    def tick(self):
        """Ticks since the start."""
        return int(self._group.attrs["tick"])


class _Frames:
    """A sequence of Frame in the order of time."""

    def __init__(self, group):
        self._group, self._names = group, sorted(group)

    def __len__(self):
        return len(self._names)

    def __getitem__(self, number):
        if isinstance(number, slice):
            return [Frame(self._group[name]) for name in self._names[number]]
        return Frame(self._group[self._names[number]])


class Result:
    """A result file, open for reading.

    `result.force` is /haptic/force, ticks × 3; `result.kinetic_energy` is /physics/kinetic_energy. A name that stands
    in several groups is that of the ticks: `result.time`; for the others say `result.physics.time`. Every attribute is
    read when it is asked for, an Array with `.units` and `.about`; nothing is kept. `result["haptic/force"][:100]`
    reads a part.
    """

    def __init__(self, file):
        self._file = open_file(file)

    @property
    def h5(self):
        """h5py's file."""
        return self._file

    @property
    def attrs(self):
        """What the file says of itself, a dict."""
        return _attributes(self._file)

    @property
    def file(self):
        """Its name."""
        return self._file.filename

    @property
    def outcome(self):
        """How the run ended: "done", "interrupted", "failed", or "running"."""
        return str(self.attrs.get("outcome", ""))

    @property
    def is_complete(self):
        """Did it reach its end?"""
        return bool(self.attrs.get("complete", 0))

    @property
    def frames(self):
        """The body at its moments, in the order of time; frames[-1].position is read when it is asked for."""
        return _Frames(self._file["frames"])

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._file:
            return Group(self._file[name])
        for group in _GROUPS:
            if group in self._file and name in self._file[group]:
                return getattr(Group(self._file[group]), name)
        raise AttributeError(f"{self.file}: no {name}; there is {', '.join(dir(self))}")

    def __getitem__(self, name):
        """h5py's own group or dataset."""
        return self._file[name]

    def __dir__(self):
        own = [name for name in super().__dir__() if not name.startswith("_")]
        return sorted({*own, *self._file, *(name for group in _GROUPS for name in self._file.get(group, ()))})

    def close(self):
        """Closes the file; arrays that were read stay."""
        self._file.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __repr__(self):
        if not self._file:
            return "<argil.Result, closed>"
        return (f"<argil.Result {self.file}: {self.outcome}, {len(self._file['haptic/time'])} ticks, "
                f"{len(self.frames)} frames>")


def open(file):  # pylint: disable=redefined-builtin
    """Opens a result file for reading: Result(file). Raises IoError, InputError where it is none."""
    return Result(file)
