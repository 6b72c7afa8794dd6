"""True fixtures on a dowel plate: a rectangle as a search found it, the clamp in any of the four directions."""

from __future__ import annotations

from math import acos, atan2, cos, degrees, hypot, pi, sin
from typing import TypeVar

import numpy as np

from workhold import Fixture, Peg, Plate, Pose, Workpiece

WAYS = ("-x", "-y", "+x", "+y")
TRAVEL = (10.0, 30.0)
WIDTH, HEIGHT, PITCH, RADIUS = 100.0, 60.0, 20.0, 5.0
# Column, row and face of the locators, and of the clamp's hole, where it pushes to the left.
LOCATORS, CLAMP = ((0, 1, 3), (1, 3, 2), (5, 0, 0)), (7, 1, 1)

FORCES = (1.0087618285561866, 0.2061378947684897, 0.2061378947684897, 1.0087618285561866)
Number = TypeVar("Number", int, float)


def turn_and_tip() -> tuple[float, float, float, float]:
    """The turn in radians and x, y of the rectangle's corner about whose left, upper and lower side the locators stand, and
    how far right the tip is, in mm: each locator is its radius off its side, so that A cos t + B sin t = height + 2 radii
    between the upper and the lower one.
    """
    (ax, ay), (bx, by), (cx, cy) = ((PITCH * column, PITCH * row) for column, row, _ in LOCATORS)
    across, along = by - cy, cx - bx
    size, lag = hypot(across, along), atan2(along, across)
    turn = lag - acos((HEIGHT + 2 * RADIUS) / size)
    normal, side = np.array([-sin(turn), cos(turn)]), np.array([cos(turn), sin(turn)])
    corner = (np.dot((cx, cy), normal) + RADIUS) * normal + (np.dot((ax, ay), side) + RADIUS) * side
    row = PITCH * CLAMP[1]
    tip = (np.dot(corner, side) + WIDTH + RADIUS - row * side[1]) / side[0]
    return float(turn), float(corner[0]), float(corner[1]), float(tip)


def on_plate(
    way: str = "-x", bolted: bool = True, size: float = 1.0, name: str = "rectangle", endless: bool = False
) -> tuple[Fixture, Workpiece, Plate]:
    """The rectangle, magnified by ``size``, on a plate with the clamp pushing one way.

    Parameters
    ----------
    bolted : whether the clamp's hole is known, or only its line.
    endless : whether the plate has as many holes as needed.
    """
    turn, x, y, tip_x = turn_and_tip()
    quarters = WAYS.index(way)
    holes = [quarter_turned((column, row), quarters) for column, row, _ in (*LOCATORS, CLAMP)]
    counted = holes if bolted else holes[:3]
    low = min(hole[0] for hole in counted), min(hole[1] for hole in counted)
    tip, corner = (quarter_turned(point, quarters) for point in ((tip_x, PITCH * CLAMP[1]), (x, y)))

    def placed(point: tuple[float, float]) -> tuple[float, float]:
        return size * (point[0] - PITCH * low[0]), size * (point[1] - PITCH * low[1])

    plate = Plate(
        pitch=size * PITCH,
        peg_radius=size * RADIUS,
        columns=None if endless else 9,
        rows=None if endless else 9,
        travel=(size * TRAVEL[0], size * TRAVEL[1]) if bolted else None,
        directions=(way,),
    )
    pegs = []
    for (column, row), (_, _, face), force in zip(holes, LOCATORS, FORCES, strict=False):
        pegs.append(
            Peg("plate", column - low[0], row - low[1], *placed((PITCH * column, PITCH * row)), face, force)
        )
    column, row = holes[3][0] - low[0], holes[3][1] - low[1]
    if not bolted:
        column, row = (0, row) if way[1] == "x" else (column, 0)
    carrier = plate.carriers[1]
    at = placed(tip)
    travelled = float(np.dot(np.array(at) - carrier.compute_hole_center(column, row), plate.moving_axis))
    pegs.append(Peg(carrier.name, column, row, *at, CLAMP[2], FORCES[3], carrier.name_place(column, row)))
    pose = Pose((degrees(turn) + 90 * quarters) % 360, *placed(corner))
    workpiece = Workpiece.from_loops(
        name, [[[size * u, size * v, 0] for u, v in ((0, 0), (WIDTH, 0), (WIDTH, HEIGHT), (0, HEIGHT))]]
    )
    return Fixture("clamp", tuple(pegs), pose, travelled, {"closure_margin": 0.0848}, way), workpiece, plate


def quarter_turned(point: tuple[Number, Number], quarters: int) -> tuple[Number, Number]:
    """A point turned about the origin by quarters of a turn."""
    for _ in range(quarters):
        point = (-point[1], point[0])
    return point


def towards(way: str) -> tuple[float, float]:
    """The unit vector of a direction."""
    angle = {"+x": 0.0, "+y": pi / 2, "-x": pi, "-y": -pi / 2}[way]
    return round(cos(angle), 12), round(sin(angle), 12)
