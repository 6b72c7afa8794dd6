"""Parts that rotations carry onto themselves, and the sets that these make of fixtures, found by trying each on each.

A fixture is what the part sees of it: where pegs and the ends of a wall stand, about the point that rotations keep, and the
way each pushes. Holes, names of pegs and of faces, and turns of the toolkit are not seen at all.
"""

from __future__ import annotations

from cmath import exp
from collections.abc import Sequence
from math import cos, pi, radians, sin, tan, tau

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold import Fixture, Query, Workpiece

Loop = list[tuple[float, float, float]]
# What moves in these ways, and the fence, pushes the part along them; what stands still pushes nowhere.
PUSHES = {"left": 1, "right": -1, "wall": 1j, "clamp -x": -1, "clamp +x": 1, "clamp -y": -1j, "clamp +y": 1j}
# mm, and millimetres that a unit of direction counts for.
NEAR, REACH = 1e-5, 100.0


@frozen
class Symmetric:
    """A part, how many rotations it has, and the point that they keep."""

    part: Workpiece
    order: int
    kept: complex


def circle(x: float, y: float, radius: float) -> Loop:
    """A round hole."""
    return [(x + radius, y, -1.0), (x - radius, y, -1.0)]


def rounded(corners: Sequence[tuple[float, float]], radius: float) -> Loop:
    """A polygon, counter-clockwise, with round corners that are tangent to its sides."""
    points, loop = [complex(*corner) for corner in corners], Loop()
    for before, point, after in zip(points[-1:] + points[:-1], points, points[1:] + points[:1], strict=True):
        into, out = (point - before) / abs(point - before), (after - point) / abs(after - point)
        turn = float(np.angle(out / into))
        back = abs(radius * tan(turn / 2))
        start, end = point - back * into, point + back * out
        loop += [(start.real, start.imag, tan(turn / 4)), (end.real, end.imag, 0.0)]
    return loop


def ring(order: int, distance: float, start: float = 0.0) -> list[tuple[float, float]]:
    """Points at equal angles about (0, 0)."""
    angles = [start + tau * k / order for k in range(order)]
    return [(distance * cos(angle), distance * sin(angle)) for angle in angles]


def placed(order: int, *loops: Loop, turn: float = 0.0, at: complex = 0j) -> Symmetric:
    """A part of loops about (0, 0), turned by an angle in degrees and moved."""
    moved = []
    for loop in loops:
        points = [complex(x, y) * exp(1j * radians(turn)) + at for x, y, _ in loop]
        moved.append([(p.real, p.imag, row[2]) for p, row in zip(points, loop, strict=True)])
    return Symmetric(Workpiece.from_loops("symmetric", moved), order, at)


def symmetric_parts() -> dict[str, Symmetric]:
    """Slots, plates and links with round corners, tangent joints and concentric holes, of two to six rotations; one without
    a mirror image, one of corners alone, and one of concentric circles, of which every motion is a rotation."""
    box = [(-36.0, -20.0), (36.0, -20.0), (36.0, 20.0), (-36.0, 20.0)]
    slot: Loop = [(-30.0, -15.0, 0.0), (30.0, -15.0, 1.0), (30.0, 15.0, 0.0), (-30.0, 15.0, 1.0)]
    wheel = [(x, y, 0.0) for k in range(4) for x, y in quarter_turned([(30, -6), (30, 14), (14, 14)], k)]
    holes = [(24, 9), (-24, 9), (-24, -9), (24, -9)]
    return {
        "slot": placed(2, slot, circle(30, 0, 6), circle(-30, 0, 6)),
        "box": placed(2, rounded(box, 6.0), *(circle(x, y, 5) for x, y in holes), turn=90.0, at=40 + 7j),
        "parallelogram": placed(
            2, [(-35, -20, 0), (15, -20, 0), (35, 20, 0), (-15, 20, 0)], turn=11.0, at=3 - 5j
        ),
        "three": placed(3, rounded(ring(3, 46.0), 9.0), *(circle(x, y, 6) for x, y in ring(3, 20.0))),
        "square": placed(4, rounded(ring(4, 36.0, pi / 4), 8.0), circle(0, 0, 9), at=12 + 60j),
        "pinwheel": placed(4, wheel, turn=7.0, at=-20 + 4j),
        "six": placed(6, rounded(ring(6, 30.0), 5.0), *(circle(x, y, 4) for x, y in ring(6, 14.0, pi / 6))),
        "disc": placed(1, [(25, 0, 1), (-25, 0, 1)], circle(0, 0, 8)),
    }


def quarter_turned(points: Sequence[tuple[float, float]], turns: int) -> list[tuple[float, float]]:
    """Points after so many quarter turns about (0, 0)."""
    turned = [complex(*point) * 1j**turns for point in points]
    return [(point.real, point.imag) for point in turned]


def as_the_part_sees(fixture: Fixture, kept: complex, query: Query) -> tuple[str, NDArray[np.complex128]]:
    """What no rotation of the part changes, and (P, 3) where each peg stands, along which way it pushes, and whether it does
    so along the toolkit's columns, which only half a turn leaves as they are.

    Of a fixture that stands for all pairs of clamps of its seat only the directions of the clamps count; on a fence nothing
    is the same after a turn of the toolkit.
    """
    backwards = exp(-1j * radians(fixture.pose.theta_deg))
    at = complex(fixture.pose.x, fixture.pose.y)
    stands_for_all = query.toolkit.travel_count > 1 and query.listing == "best"
    rows = []
    for peg in fixture.pegs:
        place = (complex(peg.x, peg.y) - at) * backwards - kept
        place = 0j if stands_for_all and peg.carrier.startswith("clamp") else place
        rows.append(
            (place, REACH * PUSHES.get(peg.carrier, 0) * backwards, REACH * peg.carrier.endswith("y"))
        )
    return f"{fixture.type} {fixture.direction if query.toolkit.wall is not None else ''}", np.array(rows)


def sets_of(fixtures: Sequence[Fixture], case: Symmetric, query: Query) -> list[int]:
    """Of each fixture the first that a rotation of the part carries it to, itself included."""
    seen = [as_the_part_sees(fixture, case.kept, query) for fixture in fixtures]
    places, first = np.array([rows for _, rows in seen]), list[int]()
    for number, (label, rows) in enumerate(seen):
        alike = np.array([other == label for other, _ in seen])
        for k in range(case.order):
            image = rows * np.array([*[exp(1j * tau * k / case.order)] * 2, 1.0])
            near = np.abs(image[None, :, None] - places[:, None]).max(axis=3) < NEAR
            found = np.flatnonzero(alike & near.any(axis=2).all(axis=1) & near.any(axis=1).all(axis=1))
            number = min([number, *found.tolist()])
        first.append(number)
    return first
