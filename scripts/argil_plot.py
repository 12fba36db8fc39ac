"""What the figures of argil share: how a result file is read, the style, and how a figure is saved.

Colours are those of Okabe and Ito, which people with any kind of colour blindness tell apart; from the third on
lines also differ in their dashes, for a grey print.
"""
import sys
from pathlib import Path

try:
    import h5py
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
except ImportError as missing:
    sys.exit(f"{sys.argv[0]}: {missing}. scripts/setup installs what is missing for Debian's /usr/bin/python3; "
             "start the script by its own name, not by another python3.")

MODES = ("push", "pull", "wet", "dry")
COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
DASHES = ("-", "-", (0, (5, 1.5)), (0, (1.5, 1.5)), (0, (5, 1.5, 1.5, 1.5)), (0, (8, 2)))
GREY = "#5A5F66"
WATER_BAND = "#56B4E9"
MILLIMETRES = 1.0 / 25.4
UNITS = {"N": "N", "Pa": "Pa", "J": "J", "Hz": "Hz", "kg": "kg", "m": "m", "m2": "m²", "m3": "m³", "s": "s",
         "ticks": "ticks", "per": "per"}  # the last words of a key, as argil spells them

plt.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 9, "axes.titlesize": 9, "axes.labelsize": 9,
    "legend.fontsize": 8, "legend.frameon": False, "axes.spines.top": False, "axes.spines.right": False,
    "axes.edgecolor": GREY, "axes.labelcolor": "#222222", "xtick.color": GREY, "ytick.color": GREY,
    "axes.grid": True, "grid.color": "#E4E6E9", "grid.linewidth": 0.6, "axes.axisbelow": True,
    "lines.linewidth": 1.3, "savefig.dpi": 160, "figure.constrained_layout.use": True,
    "pdf.fonttype": 42, "svg.fonttype": "none", "svg.hashsalt": "argil",
})


def open_result(file):
    """A result file of `argil run`, open for reading; a word on stderr and exit code 2 when it is none."""
    try:
        result = h5py.File(file, "r")
    except OSError as error:
        refuse(f"{file}: cannot be read: {error}")
    kind = result.attrs.get("format", "")
    if (kind.decode() if isinstance(kind, bytes) else str(kind)) != "argil-result":
        refuse(f"{file}: is not a result file of argil run")
    if not result.attrs.get("complete", 0):
        print(f"{file}: the run did not reach its end; drawing what there is", file=sys.stderr)
    return result


def refuse(words):
    print(f"{Path(sys.argv[0]).name}: {words}", file=sys.stderr)
    sys.exit(2)


def frames_of(result):
    """The frames in the order of time."""
    frames = [result["frames"][name] for name in sorted(result["frames"])]
    if not frames:
        refuse(f"{result.filename}: has no frames; /output in the scenario says how often they are written")
    return frames


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


def labels_for(files, given):
    """The labels given, or the files' names when none are."""
    if given and len(given) != len(files):
        refuse(f"{len(files)} files but {len(given)} labels")
    return given or [Path(file).stem for file in files]


def quantity_label(name, has_unit=True):
    """Words and unit of a key or column: "material.youngs_modulus_Pa" → "youngs modulus [Pa]". The keys of argil end
    in their unit; those that end in none are numbers [–], unless `has_unit` is false (text)."""
    words, unit = name.rsplit(".", 1)[-1].replace("youngs", "Young's").replace("poissons", "Poisson's").split("_"), []
    while len(words) > 1 and words[-1] in UNITS:
        unit.insert(0, UNITS[words.pop()])
    above, _, below = " ".join(unit).partition("per ")
    below = f"/({below})" if " " in below else below and "/" + below
    return " ".join(words) + (f" [{(above.strip() or below and '1') + below or '–'}]" if has_unit else "")


def save(figure, stem):
    """Writes STEM.png and STEM.pdf; a suffix of one of these is dropped first. No date inside, so that the same
    data give the same bytes."""
    stem = Path(stem)
    stem = stem.with_suffix("") if stem.suffix in (".png", ".pdf") else stem
    stem.parent.mkdir(parents=True, exist_ok=True)
    # Once more than by savefig: the first layout does not know the ticks yet, and a label grew out of the picture.
    figure.draw_without_rendering()
    # An axis' own extent leaves out how far its label goes past it.
    words = [axis.label for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) if axes.axison]
    for suffix, metadata in ((".png", {"Software": None}), (".pdf", {"CreationDate": None})):
        file = stem.with_name(stem.name + suffix)
        # Cut to what is there: words that the layout has no room for would be cut off.
        figure.savefig(file, metadata=metadata, bbox_inches="tight", pad_inches=0.03,
                       bbox_extra_artists=figure.get_default_bbox_extra_artists() + words)
        print(file)
    plt.close(figure)
