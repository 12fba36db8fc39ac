#!/usr/bin/python3
"""Makes the synthetic hand motions of traces/: what a 1 kHz haptic device would have recorded.

A motion is a list of strokes between way-points, each the minimum-jerk path of a reaching hand [Flash & Hogan
1985], plus physiological tremor (8 to 12 Hz), seen through a device that resolves only steps of a grid. What a
real device adds and this one does not: a low-pass filter of its driver, joint angles in place of Cartesian
steps, and a hand that the force pushes back. Without the filter the speed between two samples jumps by a whole
grid step, the harder case for a simulator. Places marked smooth get the planned way alone: scenes whose forces are to
converge with finer steps need a motion that does.

Nothing but Python's standard library is used and every number is rounded to the digits written, so the files
are the same bytes on every machine.

Usage: make_traces.py [--check] [--out FOLDER]
"""
import argparse
import hashlib
import math
import random
import sys
from pathlib import Path
from typing import NamedTuple

# ---- The table: where the hand touches, and what it does there -------------------------------------------------


class Place(NamedTuple):
    """Where a trace touches the body. Lengths in mm, world frame; the dinosaur stands on z = 0 and looks along +x."""

    contact: tuple  # point of the surface
    normal: tuple  # outward, of any length
    slide: tuple  # direction of sliding, of any length; its part along the normal is left out
    tool_radius: float
    is_smooth: bool = False  # the way itself, without tremor and device, so that finer steps see the same motion


class Stroke(NamedTuple):
    """One minimum-jerk stroke to a way-point."""

    mode: str  # push, pull, wet or dry
    seconds: float
    height: float  # of the tool's surface over the contact point [mm], negative: into the body
    slide: float  # along Place.slide [mm]
    tilt: float  # of the tool about normal × slide [degrees]
    side: float = 0.0  # along normal × slide [mm]


HAUNCH = Place(contact=(-6.0, -30.4, 62.0), normal=(0.0, -1.0, 0.0), slide=(0.35, 0.0, -0.94), tool_radius=8.0)

TIP = HAUNCH._replace(tool_radius=3.0, is_smooth=True)  # firm clay answers a device's grid with jumps of the force

BLOCK = Place(contact=(0.37, 0.21, 30.0), normal=(0.0, 0.0, 1.0), slide=(1.0, 0.0, 0.0), tool_radius=24.0,
              is_smooth=True)
BELLY = Place(contact=(13.7, 0.0, 125.0), normal=(1.0, 0.0, 0.0), slide=(0.0, 0.0, 1.0), tool_radius=8.0)
POST = Place(contact=(-50.0 / 3.0, 0.23, 85.0), normal=(-1.0, 0.0, 0.0), slide=(0.0, 1.0, 0.0), tool_radius=8.0,
             is_smooth=True)

START = Stroke("push", 0.0, 25.0, 0.0, 0.0)  # where every motion begins

PRESS = [  # three presses, each deeper and held, a slide, and away
    Stroke("push", 0.60, 2.0, 0.0, 0.0),
    Stroke("push", 0.25, -2.0, 0.0, 1.0),
    Stroke("push", 0.30, -2.0, 0.0, 1.0),
    Stroke("push", 0.25, 2.0, 0.0, 0.0),
    Stroke("push", 0.25, -3.0, 0.0, 2.0),
    Stroke("push", 0.30, -3.0, 0.0, 2.0),
    Stroke("push", 0.25, 2.0, 0.0, 0.0),
    Stroke("push", 0.25, -4.0, 0.0, 3.0),
    Stroke("push", 0.30, -4.0, 0.0, 3.0),
    Stroke("push", 0.80, -3.0, 8.0, 6.0),
    Stroke("push", 0.20, -3.0, 8.0, 6.0),
    Stroke("push", 0.25, 5.0, 8.0, 3.0),
    Stroke("push", 0.50, 25.0, 0.0, 0.0),
    Stroke("push", 0.50, 25.0, 0.0, 0.0),
]

TIP_PRESS = [  # the same with a tip in a potter's clay: half as deep, which a desktop device has the force for
    stroke._replace(height=stroke.height * (0.5 if stroke.height < 0.0 else 1.0), slide=0.375 * stroke.slide)
    for stroke in PRESS
]

WIPE = [  # slide, side, height [mm]: inwards round the place that is pressed later. The haunch bulges; each height is
    # 1 mm below the one at which the tool just touches there, so that the hand feels 1 N or 2.
    (0.0, 0.0, -0.22), (5.0, 0.0, -0.37), (10.0, 0.0, -0.54), (8.0, 5.0, -0.93), (4.0, 6.5, -0.71),
    (0.0, 7.0, -1.07), (-4.0, 6.0, -0.83), (-7.0, 5.0, -0.81), (-9.0, 0.0, -0.99), (-7.0, -4.0, -1.23),
    (-4.0, -5.5, -1.18), (0.0, -6.5, -1.17), (4.0, -6.0, -1.40), (8.0, -5.0, -1.65), (6.5, -2.5, -0.75),
    (5.0, 0.0, -0.37), (4.0, 3.5, -0.45), (0.0, 4.5, -0.30), (-4.0, 3.0, -0.26), (-5.0, 0.0, -0.49),
    (-4.0, -3.0, -0.84), (0.0, -4.0, -0.59), (4.0, -3.0, -0.56), (0.0, 0.0, -0.22),
]

TIP_WIPE = [  # with a tip, 1.2 mm below the height at which it just touches
    (0.0, 0.0, -1.08), (1.5, 0.0, -1.16), (3.0, 0.0, -1.24), (3.5, 1.5, -1.22), (2.0, 2.5, -1.2), (0.0, 2.5, -1.14),
    (-2.0, 1.5, -1.04), (-2.5, 0.0, -1.05), (-2.0, -1.5, -1.14), (0.0, -2.5, -1.34), (2.0, -2.5, -1.48),
    (3.5, -1.5, -1.42), (2.5, 0.0, -1.22), (1.0, 1.0, -1.12), (-1.0, 0.5, -1.04), (-0.5, -1.0, -1.13),
    (1.0, -1.0, -1.21), (0.0, 0.0, -1.08),
]

WET = [  # come, wipe with water, stay at the place, and return to START
    Stroke("wet", 0.60, 2.0, 0.0, 0.0),
    *(Stroke("wet", 0.55, height, slide, 0.0, side) for slide, side, height in WIPE),
    Stroke("wet", 1.40, -0.22, 0.0, 0.0),
    Stroke("wet", 0.60, 25.0, 0.0, 0.0),
]

TIP_WET = [
    Stroke("wet", 0.60, 2.0, 0.0, 0.0),
    *(Stroke("wet", 0.35, height, slide, 0.0, side) for slide, side, height in TIP_WIPE),
    Stroke("wet", 1.00, -1.08, 0.0, 0.0),
    Stroke("wet", 0.60, 25.0, 0.0, 0.0),
]

POKE = [  # stabs whose highest speeds are 0.25, 0.5 and 1 m/s: 15/8 of the way over the time
    Stroke("push", 0.40, 17.0, 0.0, 0.0),
    Stroke("push", 0.15, -3.0, 0.0, 0.0),
    Stroke("push", 0.15, 17.0, 0.0, 0.0),
    Stroke("push", 0.30, 17.0, 0.0, 0.0),
    Stroke("push", 0.075, -3.0, 0.0, 0.0),
    Stroke("push", 0.075, 17.0, 0.0, 0.0),
    Stroke("push", 0.30, 17.0, 0.0, 0.0),
    Stroke("push", 0.0375, -3.0, 0.0, 0.0),
    Stroke("push", 0.0375, 17.0, 0.0, 0.0),
    Stroke("push", 0.50, 25.0, 0.0, 0.0),
]

PULL = [  # touch, draw outward while sliding up, and away
    Stroke("pull", 0.60, 2.0, 0.0, 0.0),
    Stroke("pull", 0.25, -1.5, -4.0, -2.0),
    Stroke("pull", 0.60, -1.5, -4.0, -2.0),
    Stroke("pull", 0.60, -1.0, 4.0, 2.0),
    Stroke("pull", 0.60, 25.0, 0.0, 0.0),
]

PUSH_PULL = [  # press the belly, go up, draw the chest out
    Stroke("push", 0.50, 2.0, -4.0, 0.0),
    Stroke("push", 0.30, -4.0, -4.0, 0.0),
    Stroke("push", 0.50, -4.0, -4.0, 0.0),
    Stroke("push", 0.30, 15.0, -4.0, 0.0),
    Stroke("push", 0.50, 4.0, 16.0, 0.0),
    Stroke("pull", 0.30, -2.0, 16.0, 0.0),
    Stroke("pull", 0.70, 4.0, 16.0, 0.0),
    Stroke("push", 0.80, 25.0, 0.0, 0.0),
]

LIGHT = [  # come, press, hold and let go
    Stroke("push", 0.10, 1.0, 0.0, 0.0),
    Stroke("push", 0.12, -2.0, 0.0, 0.0),
    Stroke("push", 0.08, -2.0, 0.0, 0.0),
    Stroke("push", 0.10, 1.0, 0.0, 0.0),
]

REST = [  # press and stay for two seconds
    Stroke("push", 0.10, 1.0, 0.0, 0.0),
    Stroke("push", 0.12, -2.0, 0.0, 0.0),
    Stroke("push", 2.00, -2.0, 0.0, 0.0),
    Stroke("push", 0.10, 1.0, 0.0, 0.0),
    Stroke("push", 0.30, 1.0, 0.0, 0.0),
]

DEEP = [  # a sixth of the block's height
    Stroke("push", 0.10, 1.0, 0.0, 0.0),
    Stroke("push", 0.20, -5.0, 0.0, 0.0),
    Stroke("push", 0.10, -5.0, 0.0, 0.0),
    Stroke("push", 0.15, 1.0, 0.0, 0.0),
    Stroke("push", 0.20, 1.0, 0.0, 0.0),
]

DRAW = [  # touch, draw outward, let go
    Stroke("pull", 0.10, 1.0, 0.0, 0.0),
    Stroke("pull", 0.10, -1.0, 0.0, 0.0),
    Stroke("pull", 0.20, 0.5, 0.0, 0.0),
    Stroke("pull", 0.10, 6.0, 0.0, 0.0),
    Stroke("pull", 0.20, 6.0, 0.0, 0.0),
]

BEND = [  # push a post over with the middle of a rod of 60 mm held across it
    Stroke("push", 0.10, 1.0, -30.0, 90.0),
    Stroke("push", 0.30, -25.0, -30.0, 90.0),
    Stroke("push", 0.10, -25.0, -30.0, 90.0),
]


def follow_bend(place, half_width, foot, degrees, steps, seconds=0.1):
    """Strokes with which such a rod stays at one place of a post's side and square to it, 1.5 mm deep, as if all of
    the post from its foot [mm] below the place on bent to an arc; so that it does not slip off the top. A post that is
    stiffer than that lags behind: 130 degrees of the way turn its top by a little over 90."""
    radius = place.tool_radius
    for step in range(1, steps + 1):
        angle = math.radians(degrees) * step / steps
        over = half_width + radius - 1.5  # from the post's middle to the rod's
        along = foot * (1.0 - math.cos(angle)) / angle - over * math.cos(angle)
        up = foot * math.sin(angle) / angle + over * math.sin(angle)
        yield Stroke("push", seconds, -along - half_width - radius, -30.0, 90.0, foot - up)


def drive(start, pieces):
    """Strokes of a tick from where one ended on: pieces of (seconds, first and last speed [mm/s] of the height), with jumps of
    the speed between them, which a minimum-jerk stroke does not have."""
    height = start.height
    for seconds, first, last in pieces:
        count = round(1000 * seconds)
        for tick in range(count):
            height += 1e-3 * (first + (last - first) * (tick + 0.5) / count)
            yield start._replace(seconds=1e-3, height=height)


ACROSS = Stroke("push", 0.10, 1.0, -30.0, 90.0)  # the rod beside the post
TURNED = list(follow_bend(POST, 50.0 / 3.0, 85.0, 130.0, 12))
FOLD = [ACROSS, *TURNED, TURNED[-1]._replace(seconds=0.2)]  # until the top lies on its side
SWEPT = list(follow_bend(POST, 50.0 / 3.0, 85.0, 90.0, 8, 0.02))
SWAY = [ACROSS, *2 * [*SWEPT, *SWEPT[-2::-1], ACROSS._replace(seconds=0.02)]]  # over and back in 0.3 s, twice

BESIDE = ACROSS._replace(height=0.5)
LET_GO = [BESIDE, *drive(BESIDE, [(0.05, 0.0, -8.0), (0.6, -8.0, -40.0), (0.1, 0.0, 0.0), (0.3, 40.0, 40.0), (0.2, 0.0, 0.0)]),
          BESIDE._replace(seconds=0.2, height=2.0)]  # bend the post ever faster, stop at once, and leave at an even speed

OVER = Stroke("push", 0.10, 0.5, 0.0, 0.0)
REVERSAL = [OVER, *drive(OVER, [(0.05, 0.0, -8.0), (0.12, -20.0, -20.0), (0.05, 20.0, 20.0), (0.2, 0.0, 0.0)]),
            OVER._replace(seconds=0.15, height=2.0)]  # press and turn round at once

SEEP = [  # press a dent, leave, wet the clay beside it, and rest in the dent while the water comes
    Stroke("push", 0.10, 1.0, 3.0, 0.0),
    Stroke("push", 0.12, -4.0, 3.0, 0.0),
    Stroke("push", 0.10, -4.0, 3.0, 0.0),
    Stroke("push", 0.10, 2.0, 3.0, 0.0),
    Stroke("push", 0.30, 2.0, 3.0, 0.0),
    Stroke("wet", 0.10, 1.0, -8.0, 0.0),
    Stroke("wet", 0.05, -0.5, -8.0, 0.0),
    Stroke("wet", 0.30, -0.5, -8.0, 0.0),
    Stroke("push", 0.05, 3.0, -8.0, 0.0),
    Stroke("push", 0.15, 3.0, 3.0, 0.0),
    Stroke("push", 0.30, -2.0, 3.0, 0.0),
    Stroke("push", 2.00, -2.0, 3.0, 0.0),
    Stroke("push", 0.10, 3.0, 3.0, 0.0),
    Stroke("push", 0.30, 3.0, 3.0, 0.0),
]

WET_LIGHT = [  # wet a place, then press it
    Stroke("wet", 0.10, 1.0, 0.0, 0.0),
    Stroke("wet", 0.05, -0.3, 0.0, 0.0),
    Stroke("wet", 0.25, -0.3, 0.0, 0.0),
    Stroke("push", 0.05, 1.0, 0.0, 0.0),
    *LIGHT[1:],
]

SLIDE = [  # press and slide, to and fro
    Stroke("push", 0.10, 1.0, -7.0, 0.0),
    Stroke("push", 0.08, -1.5, -7.0, 0.0),
    Stroke("push", 0.20, -1.5, 7.0, 0.0),
    Stroke("push", 0.08, 1.0, 7.0, 0.0),
]

DRY = [stroke._replace(mode="dry") for stroke in WET]

def ring(mode, seconds, middle, radius, sides):
    """Once round a place in a plane of one height [mm]."""
    turns = (2.0 * math.pi * k / sides for k in range(sides + 1))
    x, y, z = middle
    return [(mode, seconds, (x + radius * math.cos(a), y + radius * math.sin(a), z)) for a in turns]


SCULPT = [  # mode, seconds, tool's centre [mm]: a ball of 6 mm goes round the dinosaur
    ("wet", 0.0, (2.0, 0.0, 115.0)),
    ("wet", 0.50, (2.0, 0.0, 93.2)),  # wet the back
    *(("wet", 0.35, (x, y, 92.0)) for x, y in ((2.0, 0.0), (5.0, 2.0), (0.0, 3.0), (-2.0, -2.0), (3.0, -3.0),
                                               (2.0, 0.0))),
    ("wet", 0.30, (2.0, 0.0, 100.0)),
    ("push", 0.10, (2.0, 0.0, 94.0)),
    ("pull", 0.30, (2.0, 0.0, 89.5)),  # and draw a horn out of it
    ("pull", 1.50, (2.0, 0.0, 108.0)),
    ("push", 0.40, (2.0, -20.0, 118.0)),
    ("wet", 0.60, (-6.0, -50.0, 62.0)),
    ("wet", 0.30, (-6.0, -35.2, 62.0)),  # wet the haunch
    *(("wet", 0.35, (x, -35.2, z)) for x, z in ((-2.0, 62.0), (-6.0, 65.0), (-10.0, 62.0), (-6.0, 59.0), (-6.0, 62.0))),
    ("push", 0.20, (-6.0, -38.0, 62.0)),
    ("push", 1.00, (-6.0, -25.5, 62.0)),  # and press a hole into it
    ("push", 0.40, (-6.0, -50.0, 62.0)),
    ("push", 0.50, (-60.0, -45.0, 80.0)),
    ("push", 0.40, (-88.0, -25.0, 44.0)),
    ("push", 0.30, (-88.0, 0.0, 44.0)),
    ("push", 1.50, (-84.0, 0.0, 67.0)),  # bend the tail up from below
    ("push", 0.40, (-88.0, 0.0, 42.0)),
    ("push", 0.50, (-60.0, -45.0, 60.0)),
    ("push", 0.60, (14.0, -30.0, 112.0)),
    ("dry", 0.40, (14.0, 0.0, 112.0)),
    *ring("dry", 0.30, (2.0, 0.0, 101.0), 10.0, 8),  # dry the horn
    ("dry", 0.50, (2.0, 0.0, 125.0)),
]

TRACES = {  # file: place, strokes before time zero of the tremor, strokes from there on
    "press_flank.csv": (HAUNCH, [], PRESS),
    "wet_press_flank.csv": (HAUNCH, WET, PRESS),
    "press_tip.csv": (TIP, [], TIP_PRESS),
    "wet_press_tip.csv": (TIP, TIP_WET, TIP_PRESS),
    "figure_push_pull.csv": (BELLY, [], PUSH_PULL),
    "poke.csv": (HAUNCH, [], POKE),
    "block_light.csv": (BLOCK, [], LIGHT),
    "block_wet.csv": (BLOCK, [], WET_LIGHT),
    "block_slide.csv": (BLOCK, [], SLIDE),
    "block_rest.csv": (BLOCK, [], REST),
    "block_rest_tremor.csv": (BLOCK._replace(is_smooth=False), [], REST),
    "block_deep.csv": (BLOCK, [], DEEP),
    "block_draw.csv": (BLOCK, [], DRAW),
    "post_bend.csv": (POST, [], BEND),
    "post_fold.csv": (POST, [], FOLD),
    "post_sway.csv": (POST, [], SWAY),
    "post_let_go.csv": (POST, [], LET_GO),
    "block_reversal.csv": (BLOCK, [], REVERSAL),
    "block_seep.csv": (BLOCK._replace(tool_radius=8.0), [], SEEP),
    "long_session.csv": (HAUNCH, [], WET + PRESS + PULL + DRY + PRESS),
}

RATE_HZ = 1000
GRID_MM = 0.06  # what the device resolves
STEP_MM = 0.1  # between the samples of the straight line
TREMOR_BAND_HZ = (8.0, 12.0)
TREMOR_AMPLITUDE_MM = 0.07  # √2 times the root mean square, of each coordinate
TREMOR_SINES = 6  # of each coordinate, one in each equal part of the band
DEVICE = (
    f"synthetic hand at {RATE_HZ} Hz, steps of {GRID_MM} mm, tremor of {TREMOR_AMPLITUDE_MM} mm at "
    f"{TREMOR_BAND_HZ[0]:g} to {TREMOR_BAND_HZ[1]:g} Hz, by scripts/make_traces.py"
)
SMOOTH = f"the planned way of a hand at {RATE_HZ} Hz, by scripts/make_traces.py"

# ---- Vectors and quaternions (x, y, z, w) ----------------------------------------------------------------------


def scaled(a, s):
    return tuple(s * x for x in a)


def added(*vectors):
    return tuple(sum(parts) for parts in zip(*vectors))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    return scaled(a, 1.0 / math.sqrt(dot(a, a)))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def quaternion_product(p, q):
    vector = added(scaled(p[:3], q[3]), scaled(q[:3], p[3]), cross(p[:3], q[:3]))
    return (*vector, p[3] * q[3] - dot(p[:3], q[:3]))


def rotation_about(axis, angle):
    return (*scaled(axis, math.sin(0.5 * angle)), math.cos(0.5 * angle))


def rotation_from_z(direction):
    """Shortest rotation that takes +z to a unit direction; about x when it is −z."""
    if direction[2] < -1.0 + 1e-12:
        return (1.0, 0.0, 0.0, 0.0)
    return unit((*cross((0.0, 0.0, 1.0), direction), 1.0 + direction[2]))


# ---- The hand --------------------------------------------------------------------------------------------------


def minimum_jerk(s):
    """Fraction of the way at the fraction s of the time: 10 s³ − 15 s⁴ + 6 s⁵ [Flash & Hogan 1985]."""
    return s * s * s * (10.0 + s * (6.0 * s - 15.0))


def way_at(strokes, time):
    """Height [mm], slide [mm], tilt [degrees], side [mm] and mode `time` seconds after the strokes began at START."""
    origin = START
    for stroke in strokes:
        # A sample on the border belongs to the next stroke; half a nanosecond takes up the sum's rounding.
        if time < stroke.seconds - 5e-10:
            s = minimum_jerk(max(time, 0.0) / stroke.seconds)
            ways = (a + s * (b - a) for a, b in zip(origin[2:], stroke[2:]))
            return (*ways, stroke.mode)
        time -= stroke.seconds
        origin = stroke
    return (*origin[2:], origin.mode)


def make_tremor(seed):
    """Displacement [mm] as a function of time [s]: per coordinate a sum of sines, one in each part of the band."""
    numbers = random.Random(seed)  # its random() is the same on every version and machine
    low, high = TREMOR_BAND_HZ
    sines = [
        [(low + (high - low) * (part + numbers.random()) / TREMOR_SINES, 2.0 * math.pi * numbers.random())
         for part in range(TREMOR_SINES)]
        for _ in range(3)
    ]
    amplitude = TREMOR_AMPLITUDE_MM / math.sqrt(TREMOR_SINES)

    def tremor(time):
        return tuple(amplitude * sum(math.sin(2.0 * math.pi * f * time + phase) for f, phase in axis) for axis in sines)

    return tremor


def duration(strokes):
    return sum(stroke.seconds for stroke in strokes)


def without_minus_zero(cell):
    return cell[1:] if cell.startswith("-0.") and not cell.strip("-0.") else cell


def make_rows(place, before, after):
    """The samples of a trace, one line each. The tremor's clock starts after `before`, so that the samples of
    `after` do not depend on what came first."""
    normal = unit(place.normal)
    slide = unit(added(place.slide, scaled(normal, -dot(normal, place.slide))))
    upright = rotation_from_z(normal)  # the tool's tip lies towards its −z
    tilt_axis = cross(normal, slide)
    tremor = make_tremor("argil tremor 1")
    first = -round(duration(before) * RATE_HZ)
    last = round(duration(after) * RATE_HZ)
    for tick in range(first, last + 1):
        time = tick / RATE_HZ
        strokes, local = (before, time + duration(before)) if tick < 0 else (after, time)
        height, slid, tilt, aside, mode = way_at(strokes, local)
        hand = added(place.contact, scaled(normal, place.tool_radius + height), scaled(slide, slid),
                     scaled(tilt_axis, aside), (0.0, 0.0, 0.0) if place.is_smooth else tremor(time))
        # Rotations about one axis: interpolating the angle is the slerp.
        turn = quaternion_product(rotation_about(tilt_axis, math.radians(tilt)), upright)
        if place.is_smooth:
            position = (f"{1e-3 * x:.9f}" for x in hand)
        else:
            position = (f"{1e-3 * GRID_MM * round(x / GRID_MM):.5f}" for x in hand)
        cells = [f"{(tick - first) / RATE_HZ:.3f}", *position, *(f"{q:.6f}" for q in turn), mode]
        yield ",".join(without_minus_zero(cell) for cell in cells) + "\n"


def make_trace(place, before, after):
    """The whole file, as the format in src/device/README.md wants it."""
    body = "time_s,x_m,y_m,z_m,qx,qy,qz,qw,mode\n" + "".join(make_rows(place, before, after))
    digest = hashlib.sha256(body.encode()).hexdigest()
    device = SMOOTH if place.is_smooth else DEVICE
    return f"# argil-trace: 1\n# device: {device}\n# units: m\n# rate_hz: {RATE_HZ}\n# sha256: {digest}\n{body}"


def make_approach():
    """A straight way from 4 mm above the block to 4 mm within and as many samples of rest, STEP_MM apart and without
    time: /trace/default_rate_hz gives the speed."""
    contact, radius = BLOCK.contact, BLOCK.tool_radius
    count = round(8 / STEP_MM)
    heights = [4 - 8 * i / count for i in range(count + 1)] + [-4.0] * count
    rows = (f"{1e-3 * contact[0]:.5f},{1e-3 * contact[1]:.5f},{1e-3 * (contact[2] + radius + height):.5f},0,0,0,1,push\n"
            for height in heights)
    body = "x_m,y_m,z_m,qx,qy,qz,qw,mode\n" + "".join(rows)
    digest = hashlib.sha256(body.encode()).hexdigest()
    return (f"# argil-trace: 1\n# device: straight line in steps of {STEP_MM} mm, by scripts/make_traces.py\n"
            f"# units: m\n# sha256: {digest}\n{body}")


def make_round(points):
    """A motion between places in the world, the tool upright; without tremor and grid."""
    def rows():
        place, time = points[0][2], 0
        yield f"{0:.3f}," + ",".join(f"{1e-3 * x:.6f}" for x in place) + f",{points[0][0]}\n"
        for mode, seconds, there in points[1:]:
            count = round(seconds * RATE_HZ)
            for tick in range(1, count + 1):
                hand = added(place, scaled(added(there, scaled(place, -1.0)), minimum_jerk(tick / count)))
                time += 1
                yield (f"{time / RATE_HZ:.3f}," + ",".join(without_minus_zero(f"{1e-3 * x:.6f}") for x in hand) + f",{mode}\n")
            place = there

    body = "time_s,x_m,y_m,z_m,mode\n" + "".join(rows())
    digest = hashlib.sha256(body.encode()).hexdigest()
    return f"# argil-trace: 1\n# device: {SMOOTH}\n# units: m\n# rate_hz: {RATE_HZ}\n# sha256: {digest}\n{body}"


def find_difference(file, text):
    """What differs between a file and the text that it should hold; nothing when they are equal."""
    if not file.is_file():
        return "is missing"
    found = file.read_bytes().decode(errors="replace")
    if found == text:
        return None
    lines = zip(found.splitlines(), text.splitlines())
    first = next((i for i, (a, b) in enumerate(lines, start=1) if a != b), "past the end of one")
    return f"differs from what this script makes, first at line {first}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    folder = Path(__file__).resolve().parent.parent / "traces"
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 when a file differs")
    parser.add_argument("--out", type=Path, default=folder, metavar="FOLDER", help="default: traces/")
    options = parser.parse_args()
    num_different = 0
    texts = {name: make_trace(*motion) for name, motion in TRACES.items()} | {"approach.csv": make_approach(), "sculpt.csv": make_round(SCULPT)}
    for name, text in texts.items():
        file = options.out / name
        if options.check:
            difference = find_difference(file, text)
            if difference:
                print(f"{file}: {difference}", file=sys.stderr)
                num_different += 1
        else:
            options.out.mkdir(parents=True, exist_ok=True)
            file.write_text(text, newline="\n")
            print(file)
    return 1 if num_different else 0


if __name__ == "__main__":
    sys.exit(main())
