"""How the figures of argil look, and how they are saved.

Colours are those of Okabe and Ito, which people with any kind of colour blindness tell apart; from the third on
lines also differ in their dashes, for a grey print.
"""
import functools
import math
import re
import textwrap
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
DASHES = ("-", "-", (0, (5, 1.5)), (0, (1.5, 1.5)), (0, (5, 1.5, 1.5, 1.5)), (0, (8, 2)))
MARKS = "osD^vP*X"
GREY = "#5A5F66"
WATER_BAND = "#56B4E9"
MILLIMETRES = 1.0 / 25.4
UNITS = {"N": "N", "Pa": "Pa", "J": "J", "Hz": "Hz", "kg": "kg", "m": "m", "m2": "m²", "m3": "m³", "s": "s",
         "ticks": "ticks", "per": "per"}  # the last words of a key, as argil spells them
STYLE = {
    "font.family": "DejaVu Sans", "font.size": 9, "axes.titlesize": 9, "axes.labelsize": 9,
    "legend.fontsize": 8, "legend.frameon": False, "axes.spines.top": False, "axes.spines.right": False,
    "axes.edgecolor": GREY, "axes.labelcolor": "#222222", "xtick.color": GREY, "ytick.color": GREY,
    "axes.grid": True, "grid.color": "#E4E6E9", "grid.linewidth": 0.6, "axes.axisbelow": True,
    "lines.linewidth": 1.3, "savefig.dpi": 160, "figure.constrained_layout.use": True,
    "pdf.fonttype": 42, "svg.fonttype": "none", "svg.hashsalt": "argil",
}


def styled(draw):
    """A function that draws, in argil's style whatever the caller's is."""
    @functools.wraps(draw)
    def in_style(*arguments, **options):
        with plt.rc_context(STYLE):
            figure = draw(*arguments, **options)
            figure.draw_without_rendering()  # makes the ticks, which would take the caller's style later
            return figure
    return in_style


def put_legend(figure, handles, labels, above=False, **options):
    """A legend of the whole figure below its panels, or above them, in as many columns as fit; long labels are broken. The
    figure grows by it, so that no axes shrink."""
    width, height = figure.get_size_inches()
    fitting = round(width / MILLIMETRES / 2.0)  # characters in one column
    labels = [textwrap.fill(label, fitting) for label in labels]
    for columns in range(max(1, min(len(labels), 4)), 0, -1):
        legend = figure.legend(handles, labels, ncol=columns, loc=("upper" if above else "lower") + " left", columnspacing=1.4,
                               borderaxespad=0.2, **options)
        size = legend.get_window_extent().size / figure.dpi
        if size[0] <= width or columns == 1:
            break
        legend.remove()
    total = height + size[1] + 0.08
    figure.set_size_inches(width, total)
    figure.get_layout_engine().set(rect=(0.0, 0.0 if above else 1.0 - height / total, 1.0, height / total))
    return legend


def math_words(text):
    """Text whose symbols with an index, as ω_max, are set as such."""
    return re.sub(r"([^\W\d_])_(\w+)", r"$\\mathrm{\1_{\2}}$", text)


def tick_text(value, _=None):
    """A number as people write it: 0.002, 500, 10⁵."""
    if value == 0.0 or 1e-3 <= abs(value) < 1e4:
        return f"{value:g}"
    mantissa, exponent = f"{value:.5e}".split("e")
    return ("" if float(mantissa) == 1.0 else f"{float(mantissa):g}·") + f"$10^{{{int(exponent)}}}$"


def number_log_axis(axis, values, most=8):
    """Ticks of a logarithmic axis: at the few values themselves, else 1, 2, 5 over little more than a decade, else its powers."""
    values = sorted(set(values))
    decades = math.log10(values[-1] / values[0])
    gaps = [math.log10(b / a) for a, b in zip(values, values[1:])]
    if len(values) <= most and min(gaps, default=1.0) > 0.04 * decades:
        axis.set_ticks(values)
    else:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if decades < 2.5 else (1.0,)))
    axis.set_major_formatter(FuncFormatter(tick_text))
    axis.set_minor_formatter(NullFormatter())
    if len(values) <= most:
        axis.set_minor_locator(NullLocator())


def entries_of(*panels):
    """Handles and labels of all panels, each label once."""
    entries = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            entries.setdefault(label, handle)
    return list(entries.values()), list(entries)


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
    data give the same bytes. Returns the two names, and closes the figure."""
    stem = Path(stem)
    stem = stem.with_suffix("") if stem.suffix in (".png", ".pdf") else stem
    stem.parent.mkdir(parents=True, exist_ok=True)
    files = []
    with plt.rc_context(STYLE):
        # Once more than by savefig: the first layout does not know the ticks yet, and a label grew out of the picture.
        figure.draw_without_rendering()
        # An axis' own extent leaves out how far its label goes past it.
        words = [axis.label for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) if axes.axison]
        for suffix, metadata in ((".png", {"Software": None}), (".pdf", {"CreationDate": None})):
            files.append(stem.with_name(stem.name + suffix))
            # Cut to what is there: words that the layout has no room for would be cut off.
            figure.savefig(files[-1], metadata=metadata, bbox_inches="tight", pad_inches=0.03,
                           bbox_extra_artists=figure.get_default_bbox_extra_artists() + words)
    plt.close(figure)
    return files
