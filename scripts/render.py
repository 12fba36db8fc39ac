#!/usr/bin/python3
"""Draws the body of one or more runs at chosen moments, with the tool and the force that the hand feels.

Usage: render.py A.h5 [B.h5 ...] [--labels A B ...] [--frames before,during,after] [--field saturation] [-o FILE.png]
       render.py A.h5 --movie FILE.mp4|FILE.gif [--field saturation]

One row a run, one column a moment. A moment is before (the first frame), wetting or drying (the frame in the middle
of that contact), push, pull, during (nearest to the largest force of that mode; of either), after (the last frame), or
a time in seconds. Fields: saturation, displacement, on the skin influence, on the cage plastic_strain. A movie has one
picture a frame of the file, in real time. The pictures are made by VTK without a window; where there is no display
the script starts a virtual one (Xvfb).
"""
import argparse
import contextlib
import os
import shutil
import subprocess
from typing import NamedTuple

import argil_plot as ap
from argil_plot import np, plt
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize

MOMENTS = ("before", "wetting", "drying", "push", "pull", "during", "after")
MODES_OF = {"wetting": ("wet",), "drying": ("dry",), "push": ("push",), "pull": ("pull",), "during": ("push", "pull")}
PANEL_PIXELS = {"wide": (1280, 960), "tall": (720, 960)}
BACKGROUND = (0.965, 0.968, 0.972)
CLAY = (0.80, 0.56, 0.43)
TOOL = (0.86, 0.90, 0.94)
ARROW = (0.10, 0.10, 0.12)


class Field(NamedTuple):
    """How a quantity is named and coloured."""

    title: str
    colours: LinearSegmentedColormap
    scale: float = 1.0  # from SI to the title's unit
    top: float = None  # of the colour bar; the largest value of all panels when None
    on_cage_only: bool = False
    on_skin_only: bool = False


# From dry clay to deep water: lightness falls all the way, so the order survives a grey print.
WET = LinearSegmentedColormap.from_list("wet", (CLAY, (0.52, 0.56, 0.62), (0.13, 0.40, 0.66), (0.04, 0.15, 0.40)))
STRAINED = LinearSegmentedColormap.from_list("strained", (CLAY, (0.72, 0.33, 0.36), (0.40, 0.12, 0.40),
                                                          (0.13, 0.04, 0.24)))

FIELDS = {
    "saturation": Field("saturation S [–]", WET, top=1.0),
    "displacement": Field("displacement [mm]", STRAINED, scale=1e3),
    "influence": Field("region of influence [–]", STRAINED, top=1.0, on_skin_only=True),
    "plastic_strain": Field("plastic strain ‖ε_p‖ [–]", STRAINED, on_cage_only=True),
}

# ---- What is drawn: read from the file -------------------------------------------------------------------------


class Shot:
    """One moment of a run: surface, field, tool (None where there is none) and force. SI units."""

    def __init__(self, result, frame, field):
        self.time = float(frame.attrs["time"])
        mesh, haptic = result["mesh"], result["haptic"]
        skinned = len(mesh["skin_triangles"]) > 0 and not FIELDS[field].on_cage_only
        if FIELDS[field].on_skin_only and not skinned:
            ap.refuse(f"{result.filename}: has no skin, so there is no field '{field}'")
        self.points = frame["skin_position" if skinned else "position"][:]
        self.triangles = mesh["skin_triangles" if skinned else "surface_triangles"][:]
        self.cage, self.cage_triangles = frame["position"][:], mesh["surface_triangles"][:]
        self.values = FIELDS[field].scale * point_values(result, frame, field, skinned)
        self.force, self.tool_points = np.zeros(3), None
        self.tool_triangles = mesh["tool_triangles"][:]
        if len(haptic["time"]) > 0 and len(self.tool_triangles) > 0:
            sample = min(np.searchsorted(haptic["time"][:], self.time - 1e-9), len(haptic["time"]) - 1)
            self.tool_position = haptic["tool_position"][sample]
            turned = mesh["tool_vertices"][:] @ rotation_matrix(haptic["tool_orientation"][sample]).T
            self.tool_points = turned + self.tool_position
            self.force = haptic["force"][sample]


def rotation_matrix(quaternion):
    """Of a unit quaternion x, y, z, w."""
    x, y, z, w = quaternion
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def point_values(result, frame, field, skinned):
    """The field at the vertices that are drawn. What the file holds per tet is averaged around each cage vertex."""
    if field == "displacement":
        name = "skin_position" if skinned else "position"
        return np.linalg.norm(frame[name][:] - ap.frames_of(result)[0][name][:], axis=1)
    if skinned:
        return frame["skin_influence" if field == "influence" else "skin_saturation"][:]
    per_tet = frame["plastic_strain_norm" if field == "plastic_strain" else "saturation"][:]
    tets = result["mesh/tets"][:]
    num_points = len(frame["position"])
    total = np.bincount(tets.ravel(), weights=np.repeat(per_tet, 4), minlength=num_points)
    return total / np.maximum(np.bincount(tets.ravel(), minlength=num_points), 1)


def contact_force(result, moment):
    """Size of the force [N] at each haptic tick in a mode of that moment, 0 at the others."""
    modes = [ap.MODES.index(mode) for mode in MODES_OF[moment]]
    return ap.force_norm(result) * np.isin(result["haptic/mode"][:], modes)


def find_time(result, moment):
    """Time [s] of a moment's name, or of a number of seconds."""
    if moment in ("before", "after"):
        return ap.frames_of(result)[0 if moment == "before" else -1].attrs["time"]
    if moment in MODES_OF:
        force = contact_force(result, moment)
        if not np.max(force, initial=0.0) > 0.0:
            ap.refuse(f"{result.filename}: no such contact, so there is no moment '{moment}'")
        time = result["haptic/time"][:]
        return np.median(time[force > 0.0]) if moment in ("wetting", "drying") else time[np.argmax(force)]
    try:
        return float(moment)
    except ValueError:
        ap.refuse(f"moment '{moment}': use {', '.join(MOMENTS)} or seconds")


def default_moments(file):
    with ap.open_result(file) as result:
        touched = np.max(contact_force(result, "during"), initial=0.0) > 0.0
    return ["before", "during", "after"] if touched else ["before", "after"]


def read_all_shots(file, field):
    with ap.open_result(file) as result:
        return [Shot(result, frame, field) for frame in ap.frames_of(result)]


def read_shots(file, moments, field):
    with ap.open_result(file) as result:
        frames = ap.frames_of(result)
        times = np.array([frame.attrs["time"] for frame in frames])
        nearest = [frames[np.argmin(np.abs(times - find_time(result, moment)))] for moment in moments]
        return [Shot(result, frame, field) for frame in nearest]


# ---- How it is drawn: VTK --------------------------------------------------------------------------------------


def poly_data(vtk, points, triangles):
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

    vertices = vtk.vtkPoints()
    vertices.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=float), deep=True))
    cells = vtk.vtkCellArray()
    offsets = numpy_to_vtkIdTypeArray(np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int64), deep=True)
    cells.SetData(offsets, numpy_to_vtkIdTypeArray(np.ascontiguousarray(triangles, dtype=np.int64).ravel(), deep=True))
    data = vtk.vtkPolyData()
    data.SetPoints(vertices)
    data.SetPolys(cells)
    return data


def smooth_mapper(vtk, data):
    """Maps a surface with one normal a vertex, except at the edges of boxes: shading without facets."""
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputData(data)
    normals.SetFeatureAngle(60)
    normals.ConsistencyOff()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    mapper.ScalarVisibilityOff()
    return mapper


def body_actor(vtk, shot, colours, top):
    from vtk.util.numpy_support import numpy_to_vtk

    data = poly_data(vtk, shot.points, shot.triangles)
    rgb = (255.0 * colours(np.clip(shot.values / top, 0.0, 1.0))[:, :3]).round().astype(np.uint8)
    data.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(rgb), deep=True))
    mapper = smooth_mapper(vtk, data)
    mapper.ScalarVisibilityOn()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(0.26)
    actor.GetProperty().SetDiffuse(0.78)
    actor.GetProperty().SetSpecular(0.10)
    actor.GetProperty().SetSpecularPower(18)
    return actor


def cage_actor(vtk, shot):
    """The edges of the cage's boundary."""
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(poly_data(vtk, shot.cage, shot.cage_triangles))
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetRepresentationToWireframe()
    actor.GetProperty().SetColor(*ARROW)
    actor.GetProperty().SetLineWidth(1.5)
    actor.GetProperty().LightingOff()
    return actor


def tool_actor(vtk, shot):
    actor = vtk.vtkActor()
    actor.SetMapper(smooth_mapper(vtk, poly_data(vtk, shot.tool_points, shot.tool_triangles)))
    actor.GetProperty().SetColor(*TOOL)
    actor.GetProperty().SetOpacity(0.42)  # the dent under the tool is what one wants to see
    actor.GetProperty().BackfaceCullingOn()  # its far side would shine through in patches
    actor.GetProperty().SetSpecular(0.5)
    actor.GetProperty().SetSpecularPower(40)
    return actor


def arrow_actor(vtk, shot, length):
    """The force on the hand, from the hand's point, `length` metres long."""
    direction = shot.force / np.linalg.norm(shot.force)
    side = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    side /= np.linalg.norm(side)
    columns = np.stack([direction, side, np.cross(direction, side)], axis=1) * length
    matrix = np.eye(4)
    matrix[:3, :3] = columns
    matrix[:3, 3] = shot.tool_position
    source = vtk.vtkArrowSource()
    source.SetTipResolution(48)
    source.SetShaftResolution(32)
    source.SetTipLength(0.32)
    source.SetTipRadius(0.085)
    source.SetShaftRadius(0.03)
    transform = vtk.vtkTransform()
    transform.SetMatrix(matrix.ravel())
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.SetUserTransform(transform)
    actor.GetProperty().SetColor(*ARROW)
    return actor


def add_lights(vtk, renderer):
    """Key from above the camera's left, fill from the right, rim from behind; all fixed to the camera."""
    for position, brightness, colour in (((-0.55, 0.75, 1.1), 0.92, (1.0, 0.985, 0.96)),
                                         ((1.0, 0.1, 0.6), 0.34, (0.93, 0.96, 1.0)),
                                         ((0.3, 0.8, -1.0), 0.35, (1.0, 1.0, 1.0))):
        light = vtk.vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(*position)
        light.SetFocalPoint(0, 0, 0)
        light.SetIntensity(brightness)
        light.SetColor(*colour)
        renderer.AddLight(light)


class Camera:
    """Parallel projection, three-quarter view from the side on which the tools touch, the same for all panels."""

    def __init__(self, points, tool_centre, zoom):
        """Fits `points` (n×3) [m] into the panel; closer than that, looks at the tool's centre."""
        lowest, highest = points.min(axis=0), points.max(axis=0)
        self.direction = self.find_direction(tool_centre - 0.5 * (lowest + highest), highest - lowest)
        right = np.cross([0.0, 0.0, 1.0], self.direction)
        right /= np.linalg.norm(right)
        axes = np.stack([right, np.cross(self.direction, right), self.direction])  # right, up, towards the eye
        seen = points @ axes.T
        width, height, _ = np.ptp(seen, axis=0)
        self.pixels = PANEL_PIXELS["tall" if height > 1.2 * width else "wide"]
        aspect = self.pixels[0] / self.pixels[1]
        self.half_height = 0.5 * max(height, width / aspect) * 1.12 / zoom
        middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0))
        self.focus = middle @ axes if zoom == 1.0 else tool_centre
        self.reach = 1.5 * np.linalg.norm(highest - lowest)
        self.distance = 2.0 * self.reach

    @staticmethod
    def find_direction(tool, size):
        """Towards the eye: 30 degrees off the side of the body's box that the tool is nearest to, and from above."""
        if abs(tool[0]) / size[0] > abs(tool[1]) / size[1]:
            away = np.array([0.92 if tool[0] > 0.0 else -0.92, -0.50, 0.36])
        else:
            away = np.array([0.50, 0.92 if tool[1] > 0.0 else -0.92, 0.36])
        return away / np.linalg.norm(away)

    def apply(self, camera):
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*self.focus)
        camera.SetPosition(*(self.focus + self.distance * self.direction))
        camera.SetViewUp(0, 0, 1)
        camera.SetParallelScale(self.half_height)
        # No wider than needed: the occlusion pass compares depths, and coarse ones draw contour lines.
        camera.SetClippingRange(self.distance - self.reach, self.distance + self.reach)


def make_window(vtk, pixels):
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)  # does not work through passes; the sheet scales the image down instead
    window.SetSize(*pixels)
    return window


def picture(vtk, window, actors, camera, occlusion_radius):
    """Renders actors into an off-screen window; an image as rows × columns × 3 bytes."""
    from vtk.util.numpy_support import vtk_to_numpy

    renderer = vtk.vtkRenderer()
    renderer.SetBackground(*BACKGROUND)
    renderer.AutomaticLightCreationOff()
    add_lights(vtk, renderer)
    for actor in actors:
        renderer.AddActor(actor)
    camera.apply(renderer.GetActiveCamera())
    shade_creases(vtk, renderer, occlusion_radius)
    window.AddRenderer(renderer)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    window.RemoveRenderer(renderer)
    image = grab.GetOutput()
    columns, rows, _ = image.GetDimensions()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, 3)
    return pixels[::-1].copy()  # VTK keeps and reuses its own


def shade_creases(vtk, renderer, radius):
    """Ambient occlusion within `radius` [m]: creases and dents darken as they do to the eye."""
    occlusion = vtk.vtkSSAOPass()
    occlusion.SetRadius(radius)
    occlusion.SetBias(0.04 * radius)
    occlusion.SetKernelSize(48)
    occlusion.BlurOn()
    occlusion.SetDelegatePass(vtk.vtkRenderStepsPass())
    renderer.SetPass(occlusion)


# ---- The sheet -------------------------------------------------------------------------------------------------


def render_rows(rows, field, zoom, shows_cage):
    """Images of all shots by one camera, one scale of colours and of forces; and the top of the colours' scale."""
    import vtk

    shots = [shot for row in rows for shot in row]
    points = np.concatenate([part for s in shots for part in (s.points, s.tool_points) if part is not None])
    strongest = max(shots, key=lambda shot: np.linalg.norm(shot.force))
    largest_force = np.linalg.norm(strongest.force)
    top = FIELDS[field].top or max(max(shot.values.max() for shot in shots), 1e-12)
    touched = points.mean(axis=0) if strongest.tool_points is None else strongest.tool_position
    camera = Camera(points, touched, zoom)
    size = np.ptp(points, axis=0).max()

    def actors_of(shot):
        actors = [body_actor(vtk, shot, FIELDS[field].colours, top)]
        if shows_cage:
            actors.append(cage_actor(vtk, shot))
        if shot.tool_points is not None:
            actors.append(tool_actor(vtk, shot))
        force = np.linalg.norm(shot.force)
        if force > 1e-3 * largest_force > 0.0:
            actors.append(arrow_actor(vtk, shot, 0.9 * camera.half_height * force / largest_force))
        return actors

    window = make_window(vtk, camera.pixels)  # one for all: a virtual display ends with its last window
    return [[picture(vtk, window, actors_of(shot), camera, 0.08 * size) for shot in row] for row in rows], top


def caption(shot, name):
    force = np.linalg.norm(shot.force)
    return f"{name}\n{shot.time:.1f} s" + (f", {force:.2f} N" if force > 0.0 else "")


def compose(images, captions, field, top):
    """Puts rows of images, each under its caption, on one sheet with one colour bar."""
    num_rows, num_columns = len(images), len(images[0])
    rows, columns, _ = images[0][0].shape
    panel_width = min(62.0 if columns > rows else 42.0, 240.0 / num_columns) * ap.MILLIMETRES
    panel_height = panel_width * rows / columns + 0.4
    figure, panels = plt.subplots(num_rows, num_columns, squeeze=False,
                                  figsize=(panel_width * num_columns + 0.65, panel_height * num_rows),
                                  facecolor=BACKGROUND, gridspec_kw={"hspace": 0, "wspace": 0})
    figure.get_layout_engine().set(w_pad=0.01, h_pad=0.03, wspace=0, hspace=0)
    for axes, image, words in zip(panels.flat, sum(images, []), sum(captions, [])):
        axes.imshow(image, interpolation="lanczos")
        axes.set_axis_off()
        axes.set_title(words, loc="left", color="#222222", fontsize=9, pad=2, x=0.03)
    scale = ScalarMappable(Normalize(0.0, top), FIELDS[field].colours)
    bar = figure.colorbar(scale, ax=panels, shrink=0.6 if num_rows > 1 else 0.75, aspect=22, pad=0.01)
    bar.set_label(FIELDS[field].title)
    bar.outline.set_visible(False)
    return figure


def draw_sheet(options, labels):
    """The chosen moments of each run, in one picture."""
    moments = options.frames.split(",") if options.frames else default_moments(options.files[0])
    rows = [read_shots(file, moments, options.field) for file in options.files]
    captions = [[caption(shot, label + (f", {moment}" if moment in MOMENTS else "")) for shot, moment in zip(row, moments)]
                for row, label in zip(rows, labels)]
    with display():
        images, top = render_rows(rows, options.field, options.zoom, options.cage)
    figure = compose(images, captions, options.field, top)
    figure.savefig(options.output, dpi=140, facecolor=BACKGROUND, metadata={"Software": None},
                   pil_kwargs={"optimize": True})
    print(options.output)


def draw_movie(options, labels):
    """Every frame of one run, at the speed at which it happened; Pillow writes GIF, ffmpeg everything else."""
    if len(options.files) > 1:
        ap.refuse("--movie takes one result")
    from matplotlib.animation import FFMpegWriter, PillowWriter

    is_gif = options.movie.endswith(".gif")
    if not is_gif and not FFMpegWriter.isAvailable():
        ap.refuse(f"{options.movie}: there is no ffmpeg (package ffmpeg); a .gif needs none")
    shots = read_all_shots(options.files[0], options.field)
    with display():
        (images,), top = render_rows([shots], options.field, options.zoom, options.cage)
    duration = shots[-1].time - shots[0].time
    writer = (PillowWriter if is_gif else FFMpegWriter)(fps=max(1.0, (len(shots) - 1) / max(duration, 1e-3)))
    figure = compose([images[:1]], [[caption(shots[0], labels[0])]], options.field, top)
    axes = figure.axes[0]
    with writer.saving(figure, options.movie, dpi=200):
        for shot, image in zip(shots, images):
            axes.images[0].set_data(image)
            axes.set_title(caption(shot, labels[0]), loc="left", color="#222222", fontsize=9, pad=2, x=0.03)
            writer.grab_frame(facecolor=BACKGROUND)
    print(options.movie)


@contextlib.contextmanager
def display():
    """VTK of Debian draws through an X server, also without a window: a virtual one where there is none."""
    if os.environ.get("DISPLAY"):
        yield
        return
    if not shutil.which("Xvfb"):
        ap.refuse("no display and no Xvfb; scripts/setup installs it (package xvfb)")
    # The server picks a free number itself and writes it when it is ready: two renderings do not get in their way.
    read_end, write_end = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write_end), "-screen", "0", "1280x1024x24", "-nolisten", "tcp",
                               "-terminate"],  # with its last client, also when that was killed
                              pass_fds=[write_end], stderr=subprocess.DEVNULL)
    os.close(write_end)
    try:
        with os.fdopen(read_end) as pipe:
            number = pipe.readline().strip()
        if not number:
            ap.refuse("Xvfb did not start")
        os.environ["DISPLAY"] = ":" + number
        yield
    finally:
        os.environ.pop("DISPLAY", None)
        server.terminate()
        server.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", metavar="RESULT.h5")
    parser.add_argument("--labels", nargs="+", help="one a file; default: the files' names")
    parser.add_argument("--frames", metavar="MOMENTS", help="before, wetting, drying, push, pull, during, after or "
                        "seconds, with commas between; default: before,during,after, without the second where nothing was touched")
    parser.add_argument("--field", default="saturation", choices=FIELDS, help="default: %(default)s")
    parser.add_argument("--zoom", type=float, default=1.0, help="more than 1: look at the tool from closer")
    parser.add_argument("--cage", action="store_true", help="draw the edges of the cage too")
    parser.add_argument("--movie", metavar="FILE.mp4|FILE.gif", help="every frame of one result, instead of a sheet")
    parser.add_argument("-o", "--output", default="body.png", metavar="FILE.png", help="default: %(default)s")
    options = parser.parse_args()
    if not options.zoom >= 1.0:
        ap.refuse(f"zoom {options.zoom:g}: give 1 or more")
    labels = ap.labels_for(options.files, options.labels)
    try:
        import vtk  # noqa: F401
    except ImportError:
        ap.refuse("VTK is missing, so there is no picture; scripts/setup installs it (package python3-vtk9)")
    (draw_movie if options.movie else draw_sheet)(options, labels)


if __name__ == "__main__":
    main()
