"""What is drawn of a result: the chosen moments, their surfaces and the field that colours them."""
import json
from typing import NamedTuple

import argil_plot as ap
from argil_plot import np
from matplotlib.colors import LinearSegmentedColormap

MOMENTS = ("before", "wetting", "drying", "push", "pull", "during", "after")
MODES_OF = {"wetting": ("wet",), "drying": ("dry",), "push": ("push",), "pull": ("pull",),
            "during": ("push", "pull")}
CLAY = (0.80, 0.56, 0.43)


PATH_POINTS = 1000  # of the tool's path, about
FOOT = 0.3  # of a body's height, at most
NEAREST = 60  # tets around a skin vertex among which the containing one is looked for


class Field(NamedTuple):
    """How a quantity is named and coloured."""

    title: str
    colours: LinearSegmentedColormap
    scale: float = 1.0  # from SI to the title's unit
    top: float = None  # of the colour bar; the largest size of all panels when None
    is_signed: bool = False  # the bar goes from -top to top
    on_skin_only: bool = False
    shows_scene: bool = True  # tool, force and bar; else the body alone


# From dry clay to deep water: lightness falls all the way, so the order survives a grey print.
WET = LinearSegmentedColormap.from_list("wet", (CLAY, (0.52, 0.56, 0.62), (0.13, 0.40, 0.66),
                                                (0.04, 0.15, 0.40)))
STRAINED = LinearSegmentedColormap.from_list("strained", (CLAY, (0.72, 0.33, 0.36), (0.40, 0.12, 0.40),
                                                          (0.13, 0.04, 0.24)))
# Inwards blue, outwards orange, nothing light: told apart by any colour blindness.
SIGNED = LinearSegmentedColormap.from_list("signed", ((0.03, 0.15, 0.38), (0.0, 0.45, 0.70), (0.55, 0.74, 0.87),
                                                      (0.93, 0.92, 0.90), (0.95, 0.69, 0.45), (0.80, 0.36, 0.0),
                                                      (0.38, 0.14, 0.0)))

FIELDS = {
    "saturation": Field("saturation S [–]", WET, top=1.0),
    "displacement": Field("displacement [mm]", STRAINED, scale=1e3),
    "normal": Field("moved along the normal,\noutwards > 0 [mm]", SIGNED, scale=1e3, is_signed=True),
    "influence": Field("region of influence [–]", STRAINED, top=1.0, on_skin_only=True),
    "plastic_strain": Field("plastic strain ‖ε$_\\mathrm{p}$‖ [–]", STRAINED),
    "shape": Field("", LinearSegmentedColormap.from_list("clay", (CLAY, CLAY)), top=1.0, shows_scene=False),
}


class Shot:
    """One moment of a run: surface, field, tool (None where there is none) and force. SI units."""

    def __init__(self, result, frame, field, skin_tets=None):
        self.time = self.asked = float(frame.attrs["time"])  # [s]; asked: the moment that this frame is nearest to
        mesh, haptic = result["mesh"], result["haptic"]
        skinned = len(mesh["skin_triangles"]) > 0
        if FIELDS[field].on_skin_only and not skinned:
            ap.refuse(f"{result.filename}: has no skin, so there is no field '{field}'")
        self.points = frame["skin_position" if skinned else "position"][:]
        self.cage, self.cage_triangles = frame["position"][:], ap.cells_of(result, frame)["surface_triangles"][:]
        self.triangles = mesh["skin_triangles"][:] if skinned else self.cage_triangles
        self.values = FIELDS[field].scale * point_values(result, frame, field, skinned, skin_tets)
        self.force, self.tool_points = np.zeros(3), None
        self.tool_triangles = mesh["tool_triangles"][:]
        if len(haptic["time"]) > 0 and len(self.tool_triangles) > 0:
            sample = min(np.searchsorted(haptic["time"][:], self.time - 1e-9), len(haptic["time"]) - 1)
            self.tool_position = haptic["tool_position"][sample]
            turned = mesh["tool_vertices"][:] @ rotation_matrix(haptic["tool_orientation"][sample]).T
            self.tool_points = turned + self.tool_position
            self.force = haptic["force"][sample]
            self.path = haptic["tool_position"][:: max(1, len(haptic["time"]) // PATH_POINTS)]


def rotation_matrix(quaternion):
    """Of a unit quaternion x, y, z, w."""
    x, y, z, w = quaternion
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def rest_points(result, skinned):
    """The vertices when nothing deforms the body, which may be so in no frame: of a static result."""
    first, rest = ap.frames_of(result)[0], result["mesh/rest_position"][:]
    if not skinned:
        return rest
    skin, cage = first["skin_position"][:], first["position"][:]
    if np.array_equal(cage, rest):
        return skin
    tets = result["mesh/tets"][:]
    tet, weights = find_weights(cage, tets, skin)
    return np.einsum("vi,vij->vj", weights, rest[tets[tet]])


def list_weights(points, tets, skin, count):
    """The `count` tets about each skin vertex, by their centroids, and its barycentric weights in each: [vertices, count] and
    [vertices, count, 4]."""
    from scipy.spatial import cKDTree  # here, for few pictures need it

    corners = points[tets]
    inverse = np.linalg.inv((corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1))
    _, nearest = cKDTree(corners.mean(axis=1)).query(skin, min(count, len(tets)))
    nearest = nearest.reshape(len(skin), -1)
    last = np.einsum("vnij,vnj->vni", inverse[nearest], skin[:, None] - corners[nearest, 0])
    return nearest, np.concatenate([1.0 - last.sum(axis=2, keepdims=True), last], axis=2)


def find_weights(points, tets, skin):
    """Containing tet of each skin vertex and its barycentric weights there."""
    nearest, weights = list_weights(points, tets, skin, NEAREST)
    best = weights.min(axis=2).argmax(axis=1)
    rows = np.arange(len(skin))
    return nearest[rows, best], weights[rows, best]


def find_skin_tets(result, field):
    """The tet around each skin vertex, for a field that only tets have; None for the others and without a skin."""
    if field != "plastic_strain" or len(result["mesh/skin_triangles"]) == 0:
        return None
    first = ap.frames_of(result)[0]
    return find_weights(first["position"][:], result["mesh/tets"][:], first["skin_position"][:])[0]


def held_points(result, scenario):
    """The vertices at rest that the scenario holds, as far as its boxes and balls, half spaces and planes say."""
    rest = result["mesh/rest_position"][:]
    is_held = np.zeros(len(rest), bool)
    for support in scenario.get("body", {}).get("fixed", []):
        kind = support["kind"]
        if kind == "box":
            is_held |= np.all((rest >= support["lower_m"]) & (rest <= support["upper_m"]), axis=1)
        elif kind == "sphere":
            is_held |= np.linalg.norm(rest - support["centre_m"], axis=1) <= support["radius_m"]
        elif kind in ("half_space", "plane"):
            height = rest @ support["normal"] / np.linalg.norm(support["normal"]) - support["offset_m"]
            is_held |= height <= 0.0 if kind == "half_space" else np.abs(height) <= support.get("thickness_m", 0.0)
    return rest[is_held]


def find_up(result):
    """The axis that points up: against the scenario's gravity; else y where the body is held at its foot in y and not in z;
    else z. A body held at one end in x is a beam at a wall."""
    words = result["provenance"].get("scenario")
    try:
        scenario = json.loads(words[()]) if words is not None else {}
    except ValueError:  # a result made by hand
        scenario = {}
    gravity = np.array(scenario.get("body", {}).get("loads", {}).get("gravity_m_per_s2", [0.0, 0.0, 0.0]))
    if np.any(gravity):
        return "xyz"[np.abs(gravity).argmax()]
    held, rest = held_points(result, scenario), result["mesh/rest_position"][:]
    if len(held) == 0:
        return "z"
    is_foot = held.max(axis=0) - rest.min(axis=0) < FOOT * np.ptp(rest, axis=0)
    return "y" if is_foot[1] and not is_foot[2] else "z"


def vertex_normals(points, triangles):
    """Outward unit normals, the mean of the triangles around by area; 0 where there are none."""
    corners = points[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.stack([np.bincount(triangles.ravel(), weights=np.repeat(faces[:, k], 3), minlength=len(points))
                     for k in range(3)], axis=1)
    return sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-300)


def point_values(result, frame, field, skinned, skin_tets=None):
    """The field at the vertices that are drawn. What is held per tet is averaged around each vertex of the cage; a vertex of
    the skin has what the tet around it has, `skin_tets`."""
    if field == "shape":
        return np.zeros(len(frame["skin_position" if skinned else "position"]))
    if field in ("displacement", "normal"):
        if not skinned and frame.attrs.get("epoch", 0) > 0:
            ap.refuse(f"{result.filename}: the body got new cells, so that there is no field '{field}' on them; give it a skin")
        rest = rest_points(result, skinned)
        moved = frame["skin_position" if skinned else "position"][:] - rest
        if field == "displacement":
            return np.linalg.norm(moved, axis=1)
        triangles = result["mesh/skin_triangles" if skinned else "mesh/surface_triangles"][:]
        return np.einsum("vi,vi->v", moved, vertex_normals(rest, triangles))
    if skinned and field == "plastic_strain":
        if frame.attrs.get("epoch", 0) > 0:
            skin_tets = find_weights(frame["position"][:], ap.cells_of(result, frame)["tets"][:], frame["skin_position"][:])[0]
        return frame["plastic_strain_norm"][:][skin_tets]
    if skinned:
        return frame["skin_influence" if field == "influence" else "skin_saturation"][:]
    per_tet = frame["plastic_strain_norm" if field == "plastic_strain" else "saturation"][:]
    tets = ap.cells_of(result, frame)["tets"][:]
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
        skin_tets = find_skin_tets(result, field)
        return [Shot(result, frame, field, skin_tets) for frame in ap.frames_of(result)]


def read_shots(file, moments, field):
    with ap.open_result(file) as result:
        frames = ap.frames_of(result)
        times = np.array([frame.attrs["time"] for frame in frames])
        asked = [float(find_time(result, moment)) for moment in moments]
        skin_tets = find_skin_tets(result, field)
        shots = [Shot(result, frames[np.abs(times - time).argmin()], field, skin_tets) for time in asked]
    for shot, moment, time in zip(shots, moments, asked):
        if moment not in ("wetting", "drying"):  # any frame of their middle will do
            shot.asked = time
    return shots
