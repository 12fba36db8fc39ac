"""What scripts that draw share: the package argil of this folder's project, in its style, and how a script refuses."""
import functools
import sys
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "src" / "python"))  # also where nothing was built
try:
    import h5py  # noqa: F401  # what is missing is said here
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np  # noqa: F401  # for scripts
except ImportError as missing:
    sys.exit(f"{sys.argv[0]}: {missing}. scripts/setup installs what is missing for Debian's /usr/bin/python3; "
             "start the script by its own name, not by another python3.")

from argil.errors import InputError, IoError  # noqa: E402
from argil.plot import reading, style  # noqa: E402
from argil.plot.reading import MODES, cells_of, force_norm, is_deforming, spans  # noqa: E402, F401
from argil.plot.style import COLOURS, DASHES, GREY, MARKS, MILLIMETRES, quantity_label  # noqa: E402, F401
from argil.result import open_file  # noqa: E402

plt.rcParams.update(style.STYLE)
warnings.showwarning = lambda message, *_: print(message, file=sys.stderr)


def refuse(words):
    print(f"{Path(sys.argv[0]).name}: {words}", file=sys.stderr)
    sys.exit(2)


def refusing(function):
    """What the package refuses ends a script with a word on stderr and exit code 2."""
    @functools.wraps(function)
    def call(*arguments, **options):
        try:
            return function(*arguments, **options)
        except (InputError, IoError) as error:
            return refuse(error)
    return call


@refusing
def open_result(file):
    """A result file of `argil run`, open for reading."""
    result = open_file(file)
    reading.warn_of_end(result)
    return result


frames_of = refusing(reading.frames_of)
labels_for = refusing(reading.labels_for)


def save(figure, stem):
    """Writes STEM.png and STEM.pdf, and says so."""
    print(*style.save(figure, stem), sep="\n")
