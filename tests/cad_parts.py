"""Random parts as they come out of CAD: whole numbers, concentric bosses and bores, equal radii, symmetry.

Each is one of eleven shapes, drawn with sizes of a few millimetres' steps, so that pitches of presets equal dimensions,
centres lie on one line, and arcs share centres and radii. Random outlines (``strategies``) never have such coincidences.

Glossary
--------
eye : the round end of a rod or link, about a bore.
boss : a convex arc about the centre of a bore.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import hypot, sqrt
from random import Random

from workhold import Workpiece

__all__ = ["SHAPES", "cad_part", "cad_parts"]

Vertex = tuple[float, float, float]
Loop = list[Vertex]
Shape = Callable[[Random], list[Loop]]

HALF_CIRCLE = 1.0
QUARTER = sqrt(2.0) - 1.0


def circle(x: float, y: float, radius: float) -> Loop:
    """A circle of two halves."""
    return [(x - radius, y, HALF_CIRCLE), (x + radius, y, HALF_CIRCLE)]


def size(random: Random, low: int, high: int, step: int = 2) -> float:
    """A whole number between two, in steps."""
    return float(random.randrange(low, high + 1, step))


def rounded(corners: list[tuple[float, float]], radii: list[float]) -> Loop:
    """A polygon with fillets and rounded corners.

    Parameters
    ----------
    corners : of the polygon, counter-clockwise, in mm.
    radii : of each corner, 0 for a sharp one; both its sides must be long enough for it.
    """
    loop: Loop = []
    for k, ((x, y), radius) in enumerate(zip(corners, radii, strict=True)):
        (px, py), (qx, qy) = corners[k - 1], corners[(k + 1) % len(corners)]
        back, on = hypot(px - x, py - y), hypot(qx - x, qy - y)
        cross = (x - px) * (qy - y) - (y - py) * (qx - x)
        # The tangent of half the angle by which the outline turns.
        half = cross / (back * on + (x - px) * (qx - x) + (y - py) * (qy - y))
        if radius == 0.0:
            loop.append((x, y, 0.0))
            continue
        cut = radius * abs(half)
        # The sweep is the angle turned, and a bulge the tangent of a quarter of it.
        bulge = half / (1.0 + sqrt(1.0 + half * half))
        loop.append((x + (px - x) * cut / back, y + (py - y) * cut / back, bulge))
        loop.append((x + (qx - x) * cut / on, y + (qy - y) * cut / on, 0.0))
    return loop


def plate(random: Random) -> list[Loop]:
    """A rectangular plate with rounded corners, a hole in each corner and a bore."""
    a, b, r = size(random, 60, 140), size(random, 40, 80), random.choice([0.0, 3.0, 5.0, 8.0])
    corners = [(0.0, 0.0), (a, 0.0), (a, b), (0.0, b)]
    hole, at = random.choice([1.8, 3.3, 4.0]), random.choice([6.0, 8.0, 10.0])
    places = [(at, at), (a - at, at), (a - at, b - at), (at, b - at)]
    bores = [circle(a / 2, b / 2, b / 4)] if random.random() < 0.7 else []
    return [rounded(corners, [r] * 4), *(circle(x, y, hole) for x, y in places), *bores]


def tee(random: Random) -> list[Loop]:
    """A T bracket: a foot, fillets, and a stem that ends in a boss about a bore."""
    a, foot, half = size(random, 80, 120), size(random, 10, 18), size(random, 6, 10, 1)
    r = random.choice([4.0, 5.0, 6.0])
    top, middle = foot + size(random, 50, 80), a / 2
    outer: Loop = [(0.0, 0.0, 0.0), (a, 0.0, 0.0), (a, foot, 0.0), (middle + half + r, foot, -QUARTER)]
    outer += [(middle + half, foot + r, 0.0), (middle + half, top, HALF_CIRCLE), (middle - half, top, 0.0)]
    outer += [(middle - half, foot + r, -QUARTER), (middle - half - r, foot, 0.0), (0.0, foot, 0.0)]
    bore = circle(middle, top, half - size(random, 3, 4, 1))
    return [outer, bore, circle(8.0, foot / 2, 3.3), circle(a - 8.0, foot / 2, 3.3)]


def ell(random: Random) -> list[Loop]:
    """An L bracket with equal legs or not, and a fillet in its corner."""
    a, wide = size(random, 60, 120), size(random, 14, 24)
    b = random.choice([a, size(random, 60, 100)])
    corners = [(0.0, 0.0), (a, 0.0), (a, wide), (wide, wide), (wide, b), (0.0, b)]
    r = random.choice([0.0, 5.0, 8.0])
    outer = rounded(corners, [0.0, 0.0, 0.0, r, 0.0, 0.0])
    return [
        outer,
        circle(wide / 2, wide / 2, 4.0),
        circle(a - 8.0, wide / 2, 3.3),
        circle(wide / 2, b - 8.0, 3.3),
    ]


def channel(random: Random) -> list[Loop]:
    """A U of equal walls."""
    a, b, wall = size(random, 60, 120), size(random, 40, 80), size(random, 10, 18)
    corners = [
        (0.0, 0.0),
        (a, 0.0),
        (a, b),
        (a - wall, b),
        (a - wall, wall),
        (wall, wall),
        (wall, b),
        (0.0, b),
    ]
    r = random.choice([0.0, 4.0])
    return [rounded(corners, [0.0, 0.0, 0.0, 0.0, r, r, 0.0, 0.0]), circle(a / 2, wall / 2, 3.3)]


def flange(random: Random) -> list[Loop]:
    """A disc with one or two flats, a bore about its centre, and holes on a bolt circle."""
    r, flats = size(random, 30, 60), random.choice([1, 2])
    chord = r - size(random, 4, 8)
    half = sqrt(r * r - chord * chord)
    # The tangent of a quarter of the sweep of the remaining arcs.
    if flats == 1:
        outer = [(-half, -chord, 0.0), (half, -chord, (r + chord) / half)]
    else:
        bulge = (r - half) / chord
        outer = [(-half, -chord, 0.0), (half, -chord, bulge), (half, chord, 0.0), (-half, chord, bulge)]
    bolt = (r - 10.0) * sqrt(0.5)
    bolts = [circle(x * bolt, y * bolt, 3.3) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    return [outer, circle(0.0, 0.0, r / 2 - 4.0), *bolts]


def rod(random: Random) -> list[Loop]:
    """A rod with an eye at each end, equal or not, each about a bore."""
    length, r = size(random, 80, 140), size(random, 16, 26)
    s = random.choice([r, size(random, 12, 20)])
    half = float(random.randrange(4, int(min(r, s)) - 3))
    x, y = sqrt(r * r - half * half), sqrt(s * s - half * half)
    outer = [
        (x, -half, 0.0),
        (length - y, -half, (s + y) / half),
        (length - y, half, 0.0),
        (x, half, (r + x) / half),
    ]
    return [outer, circle(0.0, 0.0, r / 2), circle(length, 0.0, s / 2)]


def slot(random: Random) -> list[Loop]:
    """A slot of two half circles, each about a bore."""
    half, r = size(random, 20, 70, 5), size(random, 12, 30)
    outer = [(-half, -r, 0.0), (half, -r, HALF_CIRCLE), (half, r, 0.0), (-half, r, HALF_CIRCLE)]
    return [
        outer,
        circle(-half, 0.0, random.choice([r / 2, 8.0])),
        circle(half, 0.0, random.choice([r / 2, 8.0])),
    ]


def link(random: Random) -> list[Loop]:
    """Two discs of different radii joined by their common tangents, each about a bore."""
    length, r = size(random, 60, 120), size(random, 18, 30)
    s = size(random, 10, 16)
    # Tangents turn away from the axis by the angle whose sine is this.
    sine = (r - s) / length
    cosine = sqrt(1.0 - sine * sine)
    # Half the sweeps are a right angle less, and more, that angle.
    small, large = sqrt((1.0 - sine) / (1.0 + sine)), sqrt((1.0 + sine) / (1.0 - sine))
    outer = [(r * sine, -r * cosine, 0.0), (length + s * sine, -s * cosine, small)]
    outer += [(length + s * sine, s * cosine, 0.0), (r * sine, r * cosine, large)]
    return [outer, circle(0.0, 0.0, r / 2), circle(length, 0.0, s / 2)]


def ears(random: Random) -> list[Loop]:
    """A block on a base that ends in two round ears, each about a bore."""
    a, base, high = size(random, 90, 130), size(random, 12, 20), size(random, 40, 80)
    r, side = base / 2, size(random, 20, 30)
    outer: Loop = [
        (0.0, 0.0, 0.0),
        (a, 0.0, HALF_CIRCLE),
        (a, base, 0.0),
        (a - side, base, 0.0),
        (a - side, high, 0.0),
    ]
    outer += [(side, high, 0.0), (side, base, 0.0), (0.0, base, HALF_CIRCLE)]
    return [outer, circle(0.0, r, r / 2), circle(a, r, r / 2)]


def wedge(random: Random) -> list[Loop]:
    """A rectangle with one slanted side, and a bore."""
    a, low, high = size(random, 60, 140), size(random, 20, 30, 5), size(random, 40, 60, 5)
    return [
        [(0.0, 0.0, 0.0), (a, 0.0, 0.0), (a, low, 0.0), (0.0, high, 0.0)],
        circle(low + 4.0, low - 6.0, 8.0),
    ]


def cross(random: Random) -> list[Loop]:
    """A cross of four equal arms, with a bore in its middle and fillets in its corners."""
    arm, half = size(random, 30, 60), size(random, 8, 16)
    r = random.choice([0.0, 4.0])
    quarter = [(arm, -half), (arm, half), (half, half)]
    corners = [point for k in range(4) for point in (turned(p, k) for p in quarter)]
    return [rounded(corners, [0.0, 0.0, r] * 4), circle(0.0, 0.0, half - 2.0)]


def turned(point: tuple[float, float], quarters: int) -> tuple[float, float]:
    """A point turned about the origin by quarter turns."""
    x, y = point
    return [(x, y), (-y, x), (-x, -y), (y, -x)][quarters % 4]


SHAPES: dict[str, Shape] = {
    shape.__name__: shape for shape in (plate, tee, ell, channel, flange, rod, slot, link, ears, wedge, cross)
}


def cad_part(seed: int) -> Workpiece:
    """One part; seeds run through the shapes in turn."""
    name = list(SHAPES)[seed % len(SHAPES)]
    return Workpiece.from_loops(f"{name}-{seed}", SHAPES[name](Random(seed)))


def cad_parts(count: int) -> Iterator[Workpiece]:
    """The first parts."""
    return (cad_part(seed) for seed in range(count))
