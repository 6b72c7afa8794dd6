"""A part with lines, convex and concave arcs and a hole, held by four pegs."""

from __future__ import annotations

from math import sqrt, tan
from random import Random

import numpy as np

from workhold import Fixture, Peg, Pose, Vise, Workpiece

QUARTER = tan(np.pi / 8)
PART = [
    # A plate 60 by 40 with one round corner and a half-round notch in the top edge ...
    [[0, 0, 0], [50, 0, QUARTER], [60, 10, 0], [60, 40, 0], [40, 40, -1], [20, 40, 0], [0, 40, 0]],
    # ... and a hole, far more than half of which is one arc.
    [[30, 10, 0], [34, 10, 3.0]],
]
PART_AREA = 60 * 40 - (10 * 10 - np.pi * 10**2 / 4) - np.pi * 10**2 / 2


def hole_area() -> float:
    """Area of the hole: the circle segment of chord 4 and bulge 3."""
    half_sweep = 2 * np.arctan(3.0)
    radius = 4 / (2 * np.sin(half_sweep))
    return float(radius**2 / 2 * (2 * half_sweep - np.sin(2 * half_sweep)))


def example(size: float = 1.0, name: str = "notched plate") -> tuple[Fixture, Workpiece, Vise]:
    """The part magnified by ``size``, turned by a quarter and held between two jaws of two columns each."""
    loops = [[[size * x, size * y, bulge] for x, y, bulge in loop] for loop in PART]
    workpiece = Workpiece.from_loops(name, loops)
    vise = Vise(pitch=10 * size, columns=2, peg_radius=3 * size)
    separation = 36.0 * size
    # The quarter turn maps (x, y) to (-y, x) before the shift: bottom edge right, top edge left.
    holes = [("left", 1, 0, 5), ("left", 1, 4, 3), ("right", 0, 1, 0), ("right", 0, 3, 0)]
    pegs = []
    for jaw, column, row, segment in holes:
        x, y = vise.carriers[int(jaw == "right")].compute_hole_center(column, row, separation)
        pegs.append(Peg("right" if jaw == "right" else "left", column, row, x, y, segment, 0.5))
    pose = Pose(90.0, 43.0 * size, -5.0 * size)
    quality = {"closure_margin": 0.125}
    return Fixture("I", (pegs[0], pegs[1], pegs[2], pegs[3]), pose, separation, quality), workpiece, vise


def any_set_up(seed: int) -> tuple[Fixture, Workpiece, Vise]:
    """One of the two parts in any pose between jaws of any lattice, with pegs anywhere: nothing that holds it, but lettering
    of every kind of crowd, from jaws that all but meet to lattices too fine to be drawn."""
    chance = Random(seed)
    part = chance.choice((example, diamond))()[1]
    pitch = chance.choice((2.5, 5.0, 6.35, 10.0, 12.7, 20.0, 25.0))
    vise = Vise(
        pitch=pitch,
        columns=chance.choice((1, 2, 3, 4, 6)),
        peg_radius=chance.choice((0.2, 0.35, 0.49)) * pitch,
        row_offset=chance.choice((0.0, 0.0, pitch / 3)),
    )
    separation = chance.choice(
        (0.2 * pitch, 0.5 * pitch, pitch, 1.4 * pitch, 5 * pitch, chance.uniform(1, 90))
    )
    pose = Pose(
        chance.choice((0.0, 45.0, 90.0, chance.uniform(0, 360))),
        chance.uniform(-20, 60),
        chance.uniform(-10, 60),
    )
    left, holes = chance.choice((2, 3)), set[tuple[int, int, int]]()
    while len(holes) < 4:
        row = chance.randrange(1 + int(60 / pitch)) + chance.choice((0, 0, 12))
        holes.add((int(len(holes) >= left), chance.randrange(vise.columns), row))
    pegs = []
    for jaw, column, row in sorted(holes):
        x, y = vise.carriers[jaw].compute_hole_center(column, row, separation)
        face = chance.choice(part.faces).number
        pegs.append(Peg("right" if jaw else "left", column, row, x, y, face, chance.uniform(0, 1.2)))
    quality = {"closure_margin": 0.1}
    return (
        Fixture("I" if left == 2 else "II", (pegs[0], pegs[1], pegs[2], pegs[3]), pose, separation, quality),
        part,
        vise,
    )


def diamond(
    size: float = 1.0, rounded: bool = False, name: str = "diamond"
) -> tuple[Fixture, Workpiece, Vise]:
    """A true fixture: a square of side 40 times ``size``, turned by 45 degrees and held by two pegs on either side.

    Every peg touches a side of its own, 20 - (cx - 10) / sqrt(2) from the nearer corner with cx = 23 sqrt(2) - 10 the height
    of the square's centre over the left pegs, and takes 1 / sqrt(2) of the jaw force.

    Parameters
    ----------
    rounded : round the corner between the two left sides, so that these end in tangent joints there.
    """
    corner = [[5, 40, QUARTER], [0, 35, 0]] if rounded else [[0, 40, 0]]
    loop = [[0, 0, 0], [40, 0, 0], [40, 40, 0], *corner]
    workpiece = Workpiece.from_loops(name, [[[size * x, size * y, bulge] for x, y, bulge in loop]])
    vise = Vise(pitch=10 * size, columns=1, peg_radius=3 * size)
    center = 23 * sqrt(2) - 10
    separation = 2 * center * size
    pegs = []
    for jaw, row, segment in [(0, 0, 4 if rounded else 3), (0, 2, 2), (1, 0, 0), (1, 2, 1)]:
        x, y = vise.carriers[jaw].compute_hole_center(0, row, separation)
        pegs.append(Peg("right" if jaw else "left", 0, row, x, y, segment, 1 / sqrt(2)))
    pose = Pose(45.0, center * size, (10 - 20 * sqrt(2)) * size)
    return (
        Fixture("I", (pegs[0], pegs[1], pegs[2], pegs[3]), pose, separation, {"closure_margin": 0.25}),
        workpiece,
        vise,
    )
