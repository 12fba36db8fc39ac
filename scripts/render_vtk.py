"""Pictures of shots by VTK, without a window: body, cage, tool and the arrow of the force."""
import contextlib
import os
import shutil
import subprocess
from typing import NamedTuple

import argil_plot as ap
import render_shots
from argil_plot import np

PANEL_PIXELS = {"wide": (1280, 960), "tall": (720, 960)}
BACKGROUND = (0.965, 0.968, 0.972)
TOOL = (0.86, 0.90, 0.94)
ARROW = (0.10, 0.10, 0.12)
PATH = (0.12, 0.30, 0.60)
EDGE = 0.94  # of half a panel, up to which arrows go


def poly_data(vtk, points, triangles):
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

    vertices = vtk.vtkPoints()
    vertices.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=float), deep=True))
    cells = vtk.vtkCellArray()
    offsets = numpy_to_vtkIdTypeArray(np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int64), deep=True)
    corners = np.ascontiguousarray(triangles, dtype=np.int64).ravel()
    cells.SetData(offsets, numpy_to_vtkIdTypeArray(corners, deep=True))
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


def body_actor(vtk, shot, field, top):
    from vtk.util.numpy_support import numpy_to_vtk

    data = poly_data(vtk, shot.points, shot.triangles)
    share = 0.5 * (shot.values / top + 1.0) if field.is_signed else shot.values / top
    rgb = (255.0 * field.colours(np.clip(share, 0.0, 1.0))[:, :3]).round().astype(np.uint8)
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


def path_actor(vtk, path):
    """Where the hand's point goes over the whole motion, where the body does not hide it."""
    points = vtk.vtkPoints()
    for place in path:
        points.InsertNextPoint(*place)
    line = vtk.vtkPolyLineSource()
    line.SetPoints(points)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(line.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*PATH)
    actor.GetProperty().SetLineWidth(5)
    actor.GetProperty().LightingOff()
    return actor


def arrow_heading(shot):
    """Where the arrow of the force on the hand lies from the hand's point: along the force; where that goes into the body,
    which would hide the arrow, opposite, so that the arrow ends there."""
    direction = shot.force / np.linalg.norm(shot.force)
    nearest = np.linalg.norm(shot.points - shot.tool_position, axis=1).argmin()
    outward = render_shots.vertex_normals(shot.points, shot.triangles)[nearest]
    return -direction if direction @ outward < 0.0 else direction


def arrow_start(shot, length):
    heading = arrow_heading(shot)
    return shot.tool_position + (length * heading if heading @ shot.force < 0.0 else 0.0)


def arrow_actor(vtk, shot, length):
    """The force on the hand, `length` metres long."""
    direction = shot.force / np.linalg.norm(shot.force)
    side = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    side /= np.linalg.norm(side)
    columns = np.stack([direction, side, np.cross(direction, side)], axis=1) * length
    matrix = np.eye(4)
    matrix[:3, :3] = columns
    matrix[:3, 3] = arrow_start(shot, length)
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


class View(NamedTuple):
    """From where a body is seen."""

    up: str = "z"  # the axis that points up in the picture
    angles: tuple = None  # azimuth and elevation of the eye [degrees]; None: the side that the tools touch, from above
    zoom: float = 1.0  # more than 1: closer to the tool


class Camera:
    """Parallel projection, three-quarter view from the side that the tools touch, the same for all panels."""

    def __init__(self, points, body, tool_centre, view):
        """Fits `points` (n×3) [m], of the `body` and of the tool, into the panel; closer than that, looks at
        the tool's centre."""
        upright = np.roll(np.eye(3), 2 - "xyz".index(view.up), axis=0)  # from x, y, z to ahead, aside, up
        lowest, highest = body.min(axis=0), body.max(axis=0)
        azimuth, elevation = (np.radians(view.angles) if view.angles else
                              self.find_angles(upright @ (tool_centre - 0.5 * (lowest + highest)), upright @ (highest - lowest)))
        right = [-np.sin(azimuth), np.cos(azimuth), 0.0]
        away = [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
        self.axes = np.stack([right, np.cross(away, right), away]) @ upright  # right, up, to the eye
        self.direction = self.axes[2]
        self.zoom, self.tool_centre = view.zoom, tool_centre
        self.fit(points)

    def fit(self, points):
        seen = points @ self.axes.T
        width, height, _ = np.ptp(seen, axis=0)
        self.pixels = PANEL_PIXELS["tall" if height > 1.2 * width else "wide"]
        aspect = self.pixels[0] / self.pixels[1]
        self.half_height = 0.5 * max(height, width / aspect) * 1.12 / self.zoom
        self.half_size = np.array([aspect, 1.0]) * self.half_height
        middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0))
        self.focus = middle @ self.axes if self.zoom == 1.0 else self.tool_centre
        self.reach = 1.5 * np.linalg.norm(np.ptp(points, axis=0))
        self.distance = 2.0 * self.reach

    def project(self, points):
        """Right and up in the panel; from -1 to 1 is inside."""
        return ((points - self.focus) @ self.axes[:2].T) / self.half_size

    def room(self, start, direction):
        """How far from a point along a direction the panel's edge is, less a margin [m]; no limit outside of the panel."""
        place, step = self.project(start), self.project(self.focus + direction)
        if np.abs(place).max() > EDGE:
            return np.inf
        return np.min((EDGE - np.sign(step) * place) / np.maximum(np.abs(step), 1e-12))

    @staticmethod
    def find_angles(tool, size):
        """Azimuth and elevation of the eye: 30 degrees off the side of the body's box that is nearest to the tool, where the
        third axis points up."""
        if abs(tool[0]) / size[0] > abs(tool[1]) / size[1]:
            away = np.array([0.92 if tool[0] > 0.0 else -0.92, -0.50])
        else:
            away = np.array([0.50, 0.92 if tool[1] > 0.0 else -0.92])
        return np.arctan2(away[1], away[0]), np.arctan2(0.36, np.linalg.norm(away))

    def apply(self, camera):
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*self.focus)
        camera.SetPosition(*(self.focus + self.distance * self.direction))
        camera.SetViewUp(*self.axes[1])
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


def fit_arrows(camera, points, shots, largest_force):
    """The arrows' common scale [m/N], and the camera fitted to them too. Closer than the whole they end at the panel's edge."""
    scale = 0.9 * camera.half_height / largest_force
    if camera.zoom > 1.0:
        return min([scale] + [camera.room(shot.tool_position, arrow_heading(shot)) / np.linalg.norm(shot.force) for shot in shots])
    ends = [shot.tool_position + scale * np.linalg.norm(shot.force) * arrow_heading(shot) for shot in shots]
    camera.fit(np.concatenate([points, ends]))
    return scale


def render_rows(rows, field, view, shows_cage=False, shows_path=False):
    """Images of all shots by one camera, one scale of colours and of forces; and the colours' top."""
    import vtk

    shots = [shot for row in rows for shot in row]
    shows_tool = render_shots.FIELDS[field].shows_scene
    points = np.concatenate([part for s in shots for part in (s.points, s.tool_points if shows_tool else None)
                             if part is not None])
    strongest = max(shots, key=lambda shot: np.linalg.norm(shot.force))
    largest_force = np.linalg.norm(strongest.force)
    top = render_shots.FIELDS[field].top or max(np.abs(shot.values).max() for shot in shots) or 1.0
    touched = points.mean(axis=0) if strongest.tool_points is None else strongest.tool_position
    camera = Camera(points, np.concatenate([shot.points for shot in shots]), touched, view)
    size = np.ptp(points, axis=0).max()
    with_arrow = [shot for shot in shots if shows_tool and np.linalg.norm(shot.force) > 1e-3 * largest_force > 0.0]
    metres_per_newton = fit_arrows(camera, points, with_arrow, largest_force) if with_arrow else 0.0

    def actors_of(shot):
        actors = [body_actor(vtk, shot, render_shots.FIELDS[field], top)]
        if shows_cage:
            actors.append(cage_actor(vtk, shot))
        if shows_tool and shot.tool_points is not None:
            actors.append(tool_actor(vtk, shot))
            if shows_path:
                actors.append(path_actor(vtk, shot.path))
        if any(shot is one for one in with_arrow):
            actors.append(arrow_actor(vtk, shot, metres_per_newton * np.linalg.norm(shot.force)))
        return actors

    window = make_window(vtk, camera.pixels)  # one for all: a virtual display ends with its last window
    return [[picture(vtk, window, actors_of(shot), camera, 0.08 * size) for shot in row] for row in rows], top


@contextlib.contextmanager
def display():
    """VTK of Debian draws through an X server, also without a window: a virtual one where there is none."""
    if os.environ.get("DISPLAY"):
        yield
        return
    if not shutil.which("Xvfb"):
        ap.refuse("no display and no Xvfb; scripts/setup installs it (package xvfb)")
    # The server picks a free number itself and writes it when it is ready: two renderings do not meet.
    read_end, write_end = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write_end), "-screen", "0", "1280x1024x24",
                               "-nolisten", "tcp", "-terminate"],  # with its last client, also a killed one
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
