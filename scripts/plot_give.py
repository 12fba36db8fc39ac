#!/usr/bin/python3
"""Draws force at the hand and depth of the tool in the clay against time, dry and wet, of a hand that is put along its
trace and of one that gives way.

Usage: plot_give.py DRY.h5 WET.h5 HAND_DRY.h5 HAND_WET.h5 [-o STEM]

The depth is that of the tool's lowest point below the skin at rest, while it touches. What a hand gives way by is of
`/hand/kind` simulated, whose spring the title tells.
"""
import argparse
import json

import argil_plot as ap
import render_shots
from argil_plot import np, plt
from argil.plot.force_figure import moving_mean

EVERY = 10  # ticks between two depths
SUBDIVIDED = 10  # parts of a triangle's edge between the points that stand for it


def points_near(rest, triangles, places, reach):
    """Points on the triangles near the places, and their outward normals: (n, 3) each [m], [–]."""
    centre, half = 0.5 * (places.max(axis=0) + places.min(axis=0)), 0.5 * np.ptp(places, axis=0)
    corners = rest[triangles]
    corners = corners[np.all(np.abs(corners.mean(axis=1) - centre) < half + reach, axis=1)]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    shares = [(i / SUBDIVIDED, j / SUBDIVIDED) for i in range(SUBDIVIDED + 1) for j in range(SUBDIVIDED + 1 - i)]
    points = [a * corners[:, 0] + b * corners[:, 1] + (1.0 - a - b) * corners[:, 2] for a, b in shares]
    return np.concatenate(points), np.tile(normal, (len(shares), 1))


def depth_of(centre, radius, points, normals):
    """How deep a ball's lowest point lies below a surface [m]; negative: above it."""
    away = centre - points
    distance = np.linalg.norm(away, axis=1)
    nearest = np.argmin(distance)
    return radius - np.copysign(distance[nearest], away[nearest] @ normals[nearest])


def read_way(file):
    """Time since the push began [s], force [N], depth [m] (nan: no touch), and the hand's spring [N/m], 0 of none."""
    with ap.open_result(file) as result:
        scene = json.loads(result["provenance/scenario"][()])
        if scene["tool"]["shape"]["kind"] != "sphere":
            ap.refuse(f"{file}: the depth is that of a ball, and its tool is none")
        radius = scene["tool"]["shape"]["radius_m"]
        deforming = ap.is_deforming(result)
        ticks = np.flatnonzero(deforming)
        time = result["haptic/time"][:] - result["haptic/time"][ticks[0]]
        places, touching = result["haptic/tool_position"][:], result["haptic/num_contacts"][:] > 0
        is_skinned = len(result["mesh/skin_triangles"]) > 0
        rest = render_shots.rest_points(result, is_skinned)
        triangles = result["mesh/skin_triangles" if is_skinned else "mesh/surface_triangles"][:]
        ticks = ticks[::EVERY]
        depth = np.full(len(ticks), np.nan)
        if touching[ticks].any():
            near = places[ticks[touching[ticks]]]
            points, normals = points_near(rest, triangles, near, 2.0 * radius)
            for row, tick in enumerate(ticks):
                if touching[tick]:
                    depth[row] = depth_of(places[tick], radius, points, normals)
        force = moving_mean(time, ap.force_norm(result), 0.1)[ticks]
        hand = scene["hand"]
        return time[ticks], force, depth, hand["stiffness_N_per_m"] if hand["kind"] == "simulated" else 0.0


def draw(ways):
    """Two columns, the same motion and the same hand; force above depth."""
    figure, panels = plt.subplots(2, 2, figsize=(180 * ap.MILLIMETRES, 105 * ap.MILLIMETRES), sharex=True, sharey="row")
    for column, pair in enumerate(ways):
        spring = pair[0][3]
        panels[0][column].set_title(f"the same hand, a spring of {spring:g} N/m" if spring else "the same motion", loc="left",
                                    color=ap.GREY)
        for number, (label, (time, force, depth, _)) in enumerate(zip(("dry", "wet"), pair)):
            for row, values in enumerate((force, 1e3 * depth)):
                panels[row][column].plot(time, values, label=label, color=ap.COLOURS[number], linestyle=ap.DASHES[number])
        panels[1][column].set_xlabel("time since the push began [s]")
    panels[0][0].set_ylabel("force at the hand [N]\nmean over 0.1 s")
    panels[1][0].set_ylabel("depth of the tool [mm]")
    panels[0][0].set_ylim(bottom=0.0)
    panels[1][0].invert_yaxis()
    panels[1][0].margins(x=0)
    panels[0][0].legend(loc="upper left")
    figure.tight_layout()
    return figure


@ap.refusing
def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("motion", nargs=2, metavar="RESULT.h5", help="dry and wet, of a hand that is put along its trace")
    parser.add_argument("hand", nargs=2, metavar="HAND.h5", help="dry and wet, of a hand that gives way")
    parser.add_argument("-o", "--output", default="give", metavar="STEM", help="default: %(default)s")
    options = parser.parse_args()
    ways = [[read_way(file) for file in pair] for pair in (options.motion, options.hand)]
    for name, pair in zip(("same motion", "same hand"), ways):
        print(f"{name}: " + "; ".join(f"{label} {force.max():.2f} N, {1e3 * np.nanmax(depth):.2f} mm"
                                      for label, (_, force, depth, _) in zip(("dry", "wet"), pair)))
    ap.save(draw(ways), options.output)


if __name__ == "__main__":
    main()
