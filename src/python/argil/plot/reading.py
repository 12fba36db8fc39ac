"""What figures read of results and tables."""
import contextlib
import os
import warnings
from pathlib import Path

import h5py
import numpy as np

from ..errors import InputError
from ..result import Result, open_file

MODES = ("push", "pull", "wet", "dry")


@contextlib.contextmanager
def opened(source):
    """h5py's file of a result: of its name, of an argil.Result or of itself. Warns where the run did not reach its
    end."""
    is_name = isinstance(source, (str, os.PathLike))
    file = open_file(source) if is_name else source.h5 if isinstance(source, Result) else source
    warn_of_end(file)
    try:
        yield file
    finally:
        if is_name:
            file.close()


def warn_of_end(file):
    """Says so where the run of a result did not reach its end."""
    if not file.attrs.get("complete", 0):
        warnings.warn(f"{file.filename}: the run did not reach its end; drawing what there is", stacklevel=3)


def name_of(source):
    """A result's name, as it stands in messages."""
    return os.fspath(source) if isinstance(source, (str, os.PathLike)) else source.filename if isinstance(
        source, h5py.File) else source.file


def frames_of(result):
    """The frames in the order of time."""
    frames = [result["frames"][name] for name in sorted(result["frames"])]
    if not frames:
        raise InputError(f"{result.filename}: has no frames; /output in the scenario says how often they are written")
    return frames


def cells_of(result, frame):
    """The group that has the cells of a frame: those at the start, or those that the body got while the run went on."""
    epoch = frame.attrs.get("epoch", 0)
    return result["mesh"] if epoch == 0 else result[f"epochs/{epoch:06d}/mesh"]


def force_norm(result):
    """‖force on the hand‖ [N] of every haptic tick, before the output gate."""
    return np.linalg.norm(result["haptic/force"][:], axis=1)


def is_deforming(result):
    """Which haptic ticks push or pull, rather than wet or dry."""
    return result["haptic/mode"][:] < MODES.index("wet")


def spans(flags):
    """First and last index of each run of True in a boolean array."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    return [(first, end - 1) for first, end in zip(edges[::2], edges[1::2])]


def labels_for(sources, given):
    """The labels given, or the files' names when none are."""
    if given and len(given) != len(sources):
        raise InputError(f"{len(sources)} files but {len(given)} labels")
    return given or [Path(name_of(source)).stem for source in sources]
