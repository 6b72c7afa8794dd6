"""Random chords for the tests of the kernels, and a slow independent solution of the chord equations."""

from __future__ import annotations

from fractions import Fraction
from math import cos, hypot, pi, sin
from random import Random

import numpy as np
from numpy.typing import NDArray

from strategies import random_row
from workhold.kernels.base.tables import CURVE_REALS, FROM, TANGENT_FROM, TANGENT_TO, TO
from workhold.kernels.chord.coincidences import NONE, find_coincidence
from workhold.kernels.chord.evaluation import compute_chord, write_curve
from workhold.kernels.chord.intervals import ALIVE, MOST_EVENTS, MOST_RANGES, write_chord_intervals
from workhold.kernels.curves.sliding_pairs import MOST_SLIDES, write_sliding_pairs

Array = NDArray[np.float64]

KINDS = ("line", "arc", "circle")
PAIRS = [(a, b) for a in KINDS for b in KINDS]
TURN = 2 * pi


def chord_intervals(a: Array, b: Array, d: float) -> Array:
    """All ranges of direction (N, 5) of a chord, see ``write_chord_intervals``."""
    events, out = np.empty((MOST_EVENTS, ALIVE + 1)), np.empty((MOST_RANGES, 5))
    return out[: write_chord_intervals(a, b, d, events, out)]


def sliding_pairs_between(a: Array, b: Array, d: float) -> Array:
    """Sliding pairs (N, 3) of a chord, see ``write_sliding_pairs``."""
    out = np.empty((MOST_SLIDES, 3))
    return out[: write_sliding_pairs(a, b, d, out)]


def arc_row(
    x: float, y: float, radius: float, middle: float = 0.0, half: float = pi, sign: float = 1.0
) -> Array:
    """A feature row of an arc."""
    return np.array([1.0, x, y, cos(middle), sin(middle), half, radius, sign, 0.0, 0.0])


def line_row(x: float, y: float, angle: float, half: float) -> Array:
    """A feature row of a line."""
    return np.array([0.0, x, y, cos(angle), sin(angle), half, 0.0, 1.0, 0.0, 0.0])


def random_chord(random: Random, kinds: tuple[str, str]) -> tuple[Array, Array, float]:
    """Two features of given kinds and a length of chord; now and then in a special position to each other."""
    a, b = np.array(random_row(random, kinds[0])), np.array(random_row(random, kinds[1]))
    d = random.uniform(3.0, 40.0)
    if kinds[0] != "line" and kinds[1] != "line":
        special = random.random()
        if special < 0.1:
            b[1:3] = a[1:3]
        elif special < 0.2:
            b[6] = a[6]
        elif special < 0.3:
            b[6], d = a[6], hypot(b[1] - a[1], b[2] - a[2])
    return a, b, d


def long_wedge(random: Random) -> tuple[Array, Array, float]:
    """Two long lines that are nearly parallel, and a short chord."""
    turn, half = random.uniform(-pi, pi), 10 ** random.uniform(1.0, 3.5)
    a = line_row(random.uniform(-5, 5), random.uniform(-5, 5), turn, half)
    tilt = random.choice([1, -1]) * 10 ** random.uniform(-7, -0.5)
    b = line_row(a[1] + random.uniform(-5, 5), a[2] + random.uniform(-5, 5), turn + tilt, half)
    return a, b, random.uniform(2.0, 12.0)


def nearly_one_chord_apart(random: Random) -> tuple[Array, Array, float]:
    """Two nearly equal arcs whose centres are nearly one chord apart."""
    a, d, way = (
        arc_row(random.uniform(-9, 9), 3.0, random.uniform(1, 15)),
        random.uniform(3, 30),
        random.uniform(-pi, pi),
    )
    away, wider = (random.choice([0.0, 10 ** random.uniform(-8, -1)]) for _ in range(2))
    b = arc_row(a[1] + (d + away) * cos(way), a[2] + (d + away) * sin(way), a[6] + wider)
    return a, b, d


def coincident_arcs(random: Random) -> tuple[Array, Array, float]:
    """Two equal arcs whose centres are exactly one chord apart."""
    radius, step = random.randint(8, 60) / 4, random.choice([(3, 4), (-4, 3), (5, 12), (8, -15)])
    return arc_row(1.0, -2.0, radius), arc_row(1.0 + step[0], -2.0 + step[1], radius), hypot(*step)


def touching(random: Random) -> tuple[Array, Array, float, float]:
    """Two arcs that touch where a chord runs along or against their centres' line, and its direction there."""
    step, apart = random.choice([((3, 4), 5), ((-4, 3), 5), ((5, 12), 13), ((8, -15), 17)])
    while True:
        radii = random.randint(8, 60) / 4, random.randint(8, 60) / 4
        along = random.random() < 0.6
        d = apart + random.choice([1, -1]) * (radii[0] - radii[1]) if along else sum(radii) - apart
        if d > 1.0 and abs(radii[0] - radii[1]) > 0.25 * min(radii):
            break
    a, b = arc_row(1.0, -2.0, radii[0]), arc_row(1.0 + step[0], -2.0 + step[1], radii[1])
    turn = float(np.arctan2(step[1], step[0]))
    return a, b, d, turn if along else turn + pi


def touching_arcs(random: Random) -> tuple[Array, Array, float]:
    """Two arcs that touch where a chord runs along or against their centres' line."""
    return touching(random)[:3]


def coincident_line(random: Random) -> tuple[Array, Array, float]:
    """A line and an arc whose centre is exactly as far beyond it as the chord is longer than the radius."""
    radius, d = random.randint(8, 60) / 4, random.randint(16, 100) / 4
    pair = [line_row(0.5, -3.0, 0.0, 40.0), arc_row(2.0, -3.0 - (d - radius), radius)]
    if random.random() < 0.5:
        pair.reverse()
    return pair[0], pair[1], d


def tangent_joint(random: Random) -> tuple[Array, Array, float]:
    """A line that runs into an arc without a corner, in either order: a chord along the line is a smooth tangency."""
    turn, radius, half = random.uniform(-pi, pi), random.uniform(0.5, 20), random.uniform(3, 30)
    side = random.choice([1, -1])
    line = line_row(random.uniform(-20, 20), random.uniform(-20, 20), turn, half)
    end = line[1:3] + half * line[3:5]
    center = end + side * radius * np.array([-line[4], line[3]])
    first, sweep = turn - side * pi / 2, random.uniform(0.5, 3.0)
    arc = arc_row(center[0], center[1], radius, first + side * sweep / 2, sweep / 2, side)
    pair = (line, arc) if random.random() < 0.5 else (arc, line)
    return *pair, random.uniform(1, 2 * half)


def unlike_arcs(random: Random) -> tuple[Array, Array, float]:
    """A tiny arc or a small fillet beside a huge arc, in either order."""
    big, small = random.uniform(100, 900), 10 ** random.uniform(-1.5, 0.5)
    away = big + random.uniform(-30, 30)
    arcs = [
        arc_row(0.0, -away, big, pi / 2, random.uniform(0.05, 1)),
        arc_row(random.uniform(-9, 9), 0.0, small),
    ]
    if random.random() < 0.5:
        arcs.reverse()
    return arcs[0], arcs[1], random.uniform(1, 40)


def nearly_touching(random: Random) -> tuple[Array, Array, float]:
    """Arcs whose chord exists in a narrow range of directions only, or passes near a tangency."""
    a, b = (
        arc_row(random.uniform(-9, 9), 3.0, random.uniform(1, 15)),
        arc_row(0.0, 0.0, random.uniform(1, 15)),
    )
    d, way, inside = random.uniform(3, 30), random.uniform(-pi, pi), 10 ** random.uniform(-9, -1)
    apart = abs(d + random.choice([1, -1]) * (random.choice([a[6] + b[6], abs(a[6] - b[6])]) - inside))
    b[1:3] = a[1] + apart * cos(way), a[2] + apart * sin(way)
    return a, b, d


def nearly_a_diameter(random: Random) -> tuple[Array, Array, float]:
    """A chord between concentric circles, or of one circle, nearly along a line through the centre."""
    a = arc_row(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(2, 15))
    b = arc_row(a[1], a[2], random.choice([a[6], random.uniform(1, 20)]))
    return a, b, a[6] + b[6] - 10 ** random.uniform(-9, -1)


def turning_fillet(random: Random) -> tuple[Array, Array, float]:
    """A line and a small fillet."""
    pair = [
        line_row(0.0, 0.0, 0.0, 40.0),
        arc_row(random.uniform(-5, 5), random.uniform(1, 9), random.uniform(0.3, 2)),
    ]
    if random.random() < 0.5:
        pair.reverse()
    return pair[0], pair[1], random.uniform(2, 15)


SPECIAL = (
    long_wedge,
    nearly_one_chord_apart,
    coincident_arcs,
    coincident_line,
    touching_arcs,
    tangent_joint,
    unlike_arcs,
    nearly_touching,
    nearly_a_diameter,
    turning_fillet,
)


def is_rounded_coincidence(a: Array, b: Array, d: float) -> bool:
    """Whether a chord is at a coincidence up to rounding only: its exact motion there is not that of the search's part."""
    if find_coincidence(a, b, d)[0] == NONE:
        return False
    p, q, size = [Fraction(float(v)) for v in a], [Fraction(float(v)) for v in b], Fraction(float(d))
    dx, dy = q[1] - p[1], q[2] - p[2]
    if p[0] and q[0]:
        lengths = size + p[6] - q[6], size - p[6] + q[6], p[6] + q[6] - size
        return all(dx * dx + dy * dy != length * length for length in lengths)
    line, radius = (q, p[6]) if p[0] else (p, q[6])
    apart = abs(line[4] * dx - line[3] * dy)
    return line[3] ** 2 + line[4] ** 2 != 1 or abs(size - radius) != apart


def any_ranges(random: Random, least: float = 1e-9) -> tuple[Array, Array, float, Array]:
    """A chord that exists, in a special position as often as not, with its ranges no narrower than ``least`` radians."""
    while True:
        if random.random() < 0.4:
            a, b, d = random_chord(random, (random.choice(KINDS), random.choice(KINDS)))
        else:
            a, b, d = random.choice(SPECIAL)(random)
        if is_rounded_coincidence(a, b, d):
            continue
        ranges = chord_intervals(a, b, d)
        ranges = ranges[ranges[:, 1] - ranges[:, 0] > least]
        if len(ranges):
            return a, b, d, ranges


def random_ranges(
    random: Random, kinds: tuple[str, str], least: float = 1e-6
) -> tuple[Array, Array, float, Array]:
    """A random chord that exists, with its ranges no narrower than ``least`` radians."""
    while True:
        a, b, d = random_chord(random, kinds)
        ranges = chord_intervals(a, b, d)
        ranges = ranges[ranges[:, 1] - ranges[:, 0] > least]
        if len(ranges):
            return a, b, d, ranges


def curve_row(
    a: Array,
    b: Array,
    d: float,
    branch: float,
    shift: float = 0.0,
    ends: tuple[float, float] = (0.0, TURN),
    tangents: tuple[float, float] = (0.0, 0.0),
) -> Array:
    """A row of the curve table, for directions between two ends, of which some may be tangencies."""
    row = np.zeros(CURVE_REALS)
    write_curve(row, a, b, d, branch, shift)
    row[FROM], row[TO] = ends
    row[TANGENT_FROM], row[TANGENT_TO] = tangents
    return row


def turn_at(a: Array, b: Array, d: float, alpha: float, branch: float) -> float:
    """X, the cross product of the two contact directions."""
    c = compute_chord(a, b, d, alpha, branch)
    return c[2] * c[5] - c[3] * c[4]


def overshoot(row: Array, points: Array) -> Array:
    """How far in mm (N, 2) points of a feature's carrier lie past the feature's ends, negative inside."""
    delta = points - row[1:3]
    if row[0] == 0.0:
        return np.abs(delta @ row[3:5]) - row[5]
    angle = np.angle((delta[:, 0] + 1j * delta[:, 1]) / (row[3] + 1j * row[4]))
    return np.full(len(points), -1.0) if row[5] >= pi else (np.abs(angle) - row[5]) * row[6]


def off_carrier(row: Array, points: Array) -> Array:
    """Distance in mm of (N, 2) points from the line or circle that carries a feature."""
    delta = points - row[1:3]
    if row[0] == 0.0:
        return np.abs(delta[:, 0] * row[4] - delta[:, 1] * row[3])
    return np.abs(np.hypot(delta[:, 0], delta[:, 1]) - row[6])


def solutions(a: Array, b: Array, d: float, alphas: Array) -> list[Array]:
    """All tails of a chord on both carriers, by polynomial roots: one (2 or fewer, 2) array for each direction."""
    out = []
    for alpha in alphas:
        w = d * np.array([cos(alpha), sin(alpha)])
        if a[0] == 0.0 and b[0] == 0.0:
            matrix = np.array([a[3:5], -b[3:5]]).T
            s = np.linalg.solve(matrix, b[1:3] - a[1:3] - w)[0]
            out.append((a[1:3] + s * a[3:5])[None])
            continue
        if a[0] == 0.0 or b[0] == 0.0:
            line, start, arc, center = (
                (a, a[1:3], b, b[1:3] - w) if a[0] == 0.0 else (b, b[1:3] - w, a, a[1:3])
            )
            gap = start - center
            s = np.roots([1.0, 2 * gap @ line[3:5], gap @ gap - arc[6] ** 2])
            points = start + s[np.isreal(s)].real[:, None] * line[3:5]
        else:
            # |z| = R_a and |z - g| = R_b, z = R_a e^it, give a quadratic in e^it.
            g = complex(*(b[1:3] - w - a[1:3]))
            if abs(g) < 1e-9:
                out.append(np.empty((0, 2)))
                continue
            middle = a[6] ** 2 + abs(g) ** 2 - b[6] ** 2
            t = np.roots([a[6] * g.conjugate(), -middle, a[6] * g])
            z = a[6] * t[np.abs(np.abs(t) - 1) < 1e-9]
            points = np.stack([z.real, z.imag], axis=1) + a[1:3]
        out.append(points)
    return out
