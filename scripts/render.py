#!/usr/bin/python3
"""Draws the body of one or more runs at chosen moments, with the tool and the force that the hand feels.

Usage: render.py A.h5 [B.h5 ...] [--labels A B ...] [--frames before,during,after] [--field saturation]
                 [--up x|y|z] [--view AZIMUTH ELEVATION] [--path] [--dpi 300] [-o FILE.png]
       render.py A.h5 --movie FILE.mp4|FILE.gif [--field saturation]

One row a run, one column a moment; of one moment all runs beside each other. A moment is before (the first frame), wetting
or drying (the frame in the middle of that contact), push, pull, during (nearest to the largest force of that mode; of
either), after (the last frame), or a time in seconds. The caption has the frame's own time. Fields: saturation,
displacement, normal (displacement along the outward normal), plastic_strain, on a skin alone influence; shape is the body
alone. The skin is drawn where there is one, else the cage. A movie has one picture a frame of the file, in real time.

Up is the axis against gravity; without gravity y where the body is held at its foot in y and not in z, else z. The eye is
on the side that the tools touch, a little above. --view puts it elsewhere: degrees about the upward axis, from the axis
that follows it (x after z), and above the horizon.

The pictures are made by VTK without a window; where there is no display the script starts a virtual one (Xvfb).
"""
import argparse
import textwrap
from pathlib import Path

import argil_plot as ap
import render_shots
import render_vtk
from argil_plot import np, plt
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from render_shots import FIELDS, MOMENTS
from render_vtk import BACKGROUND


def three_digits(value):
    """As 0.15 or 0.00412: never rounded to nothing."""
    return np.format_float_positional(value, 3, fractional=False, trim="-")


def caption(shot, name, shows_scene=True):
    """Name, the frame's own time, the force; and the moment that was asked for where the frame is off it."""
    if not shows_scene:
        return name
    force = np.linalg.norm(shot.force)
    words = f"{name}\n{three_digits(shot.time)} s" + (f", {three_digits(force)} N" if force > 0.0 else "")
    is_off = abs(shot.asked - shot.time) > 0.01 * abs(shot.asked)
    return words + (f"\nnearest to {three_digits(shot.asked)} s" if is_off else "")


def wrapped(words, characters):
    """Each line broken where it would run into the next panel."""
    return "\n".join("\n".join(textwrap.wrap(line, characters)) for line in words.split("\n"))


def writable(name):
    """The name, its folder made."""
    try:
        Path(name).parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        ap.refuse(f"{name}: its folder cannot be made: {error.strerror}")
    return name


def compose(images, captions, field, top):
    """Puts rows of images, each under its caption, on one sheet with one colour bar."""
    num_rows, num_columns = len(images), len(images[0])
    rows, columns, _ = images[0][0].shape
    panel_width = min(62.0 if columns > rows else 42.0, 240.0 / num_columns) * ap.MILLIMETRES
    characters = round(0.42 * panel_width / ap.MILLIMETRES)  # that fit beside each other
    panel_height = panel_width * rows / columns + 0.4
    figure, panels = plt.subplots(num_rows, num_columns, squeeze=False,
                                  figsize=(panel_width * num_columns + 0.65, panel_height * num_rows),
                                  facecolor=BACKGROUND, gridspec_kw={"hspace": 0, "wspace": 0})
    figure.get_layout_engine().set(w_pad=0.01, h_pad=0.03, wspace=0, hspace=0)
    for axes, image, words in zip(panels.flat, sum(images, []), sum(captions, [])):
        axes.imshow(image, interpolation="lanczos")
        axes.set_axis_off()
        axes.set_title(wrapped(words, characters), loc="left", color="#222222", fontsize=9, pad=2, x=0.03)
    if not FIELDS[field].shows_scene:
        return figure
    scale = ScalarMappable(Normalize(-top if FIELDS[field].is_signed else 0.0, top), FIELDS[field].colours)
    bar = figure.colorbar(scale, ax=panels, shrink=0.6 if num_rows > 1 else 0.75, aspect=22, pad=0.01)
    bar.set_label(FIELDS[field].title)
    bar.outline.set_visible(False)
    return figure


def view_of(options):
    """As asked for; which axis is up otherwise follows from the first result."""
    with ap.open_result(options.files[0]) as result:
        up = options.up or render_shots.find_up(result)
    return render_vtk.View(up, options.view and tuple(options.view), options.zoom)


def draw_sheet(options, labels):
    """The chosen moments of each run, in one picture."""
    moments = options.frames.split(",") if options.frames else render_shots.default_moments(options.files[0])
    rows = [render_shots.read_shots(file, moments, options.field) for file in options.files]
    captions = [[caption(shot, label + (f", {moment}" if moment in MOMENTS else ""),
                         FIELDS[options.field].shows_scene)
                 for shot, moment in zip(row, moments)] for row, label in zip(rows, labels)]
    with render_vtk.display():
        images, top = render_vtk.render_rows(rows, options.field, view_of(options), options.cage, options.path)
    if len(moments) == 1:
        images, captions = [sum(images, [])], [sum(captions, [])]
    figure = compose(images, captions, options.field, top)
    # Cut to what is there: words that the layout has no room for would be cut off.
    figure.draw_without_rendering()  # as in argil_plot.save
    figure.savefig(writable(options.output), dpi=options.dpi, facecolor=BACKGROUND, metadata={"Software": None},
                   bbox_inches="tight", pad_inches=0.05, pil_kwargs={"optimize": True})
    print(options.output)


def draw_movie(options, labels):
    """Every frame of one run, at the speed at which it happened; Pillow writes GIF, ffmpeg the rest."""
    if len(options.files) > 1:
        ap.refuse("--movie takes one result")
    from matplotlib.animation import FFMpegWriter, PillowWriter

    is_gif = options.movie.endswith(".gif")
    if not is_gif and not FFMpegWriter.isAvailable():
        ap.refuse(f"{options.movie}: there is no ffmpeg (package ffmpeg); a .gif needs none")
    shots = render_shots.read_all_shots(options.files[0], options.field)
    with render_vtk.display():
        (images,), top = render_vtk.render_rows([shots], options.field, view_of(options), options.cage, options.path)
    duration = shots[-1].time - shots[0].time
    writer = (PillowWriter if is_gif else FFMpegWriter)(fps=max(1.0, (len(shots) - 1) / max(duration, 1e-3)))
    figure = compose([images[:1]], [[caption(shots[0], labels[0])]], options.field, top)
    axes = figure.axes[0]
    with writer.saving(figure, writable(options.movie), dpi=200):
        for shot, image in zip(shots, images):
            axes.images[0].set_data(image)
            axes.set_title(caption(shot, labels[0]), loc="left", color="#222222", fontsize=9, pad=2, x=0.03)
            writer.grab_frame(facecolor=BACKGROUND)
    print(options.movie)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", metavar="RESULT.h5")
    parser.add_argument("--labels", nargs="+", help="one a file; default: the files' names")
    parser.add_argument("--frames", metavar="MOMENTS", help="before, wetting, drying, push, pull, during, "
                        "after or seconds, with commas between; default: before,during,after, without the "
                        "second where nothing was touched")
    parser.add_argument("--field", default="saturation", choices=FIELDS, help="default: %(default)s")
    parser.add_argument("--zoom", type=float, default=1.0, help="more than 1: look at the tool from closer")
    parser.add_argument("--up", choices=["x", "y", "z"], help="axis that points up; default: against gravity, else as the body is held")
    parser.add_argument("--view", nargs=2, type=float, metavar=("AZIMUTH", "ELEVATION"),
                        help="of the eye, in degrees; default: the side that the tool touches, from a little above")
    parser.add_argument("--cage", action="store_true", help="draw the edges of the cage too")
    parser.add_argument("--path", action="store_true", help="draw the tool's whole path too")
    parser.add_argument("--movie", metavar="FILE.mp4|FILE.gif", help="every frame of one result, no sheet")
    parser.add_argument("--dpi", type=int, default=300, help="points an inch of a sheet; default: %(default)s")
    parser.add_argument("-o", "--output", default="body.png", metavar="FILE.png", help="default: %(default)s")
    options = parser.parse_args()
    if not options.zoom >= 1.0:
        ap.refuse(f"zoom {options.zoom:g}: give 1 or more")
    if not 50 <= options.dpi <= 1200:
        ap.refuse(f"dpi {options.dpi}: give 50 to 1200")
    if options.view and not (abs(options.view[0]) <= 360.0 and abs(options.view[1]) <= 90.0):
        ap.refuse(f"view {options.view[0]:g} {options.view[1]:g}: give an azimuth from -360 to 360 and an elevation from -90 to 90 degrees")
    labels = ap.labels_for(options.files, options.labels)
    try:
        import vtk  # noqa: F401
    except ImportError:
        ap.refuse("VTK is missing, so there is no picture; scripts/setup installs it (package python3-vtk9)")
    (draw_movie if options.movie else draw_sheet)(options, labels)


if __name__ == "__main__":
    main()
