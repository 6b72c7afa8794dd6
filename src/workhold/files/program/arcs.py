"""Arcs of a program: from their words to spans of half a turn or less."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, ceil, cos, hypot, pi, sin, sqrt, tan

from attrs import frozen

from workhold.conventions import ARC_RADII
from workhold.errors import InputError

__all__ = ["PlaneArc", "arc_about", "arc_of_radius"]

Point = tuple[float, float]
Place = tuple[float, float, float]


@frozen
class PlaneArc:
    """An arc from a place to another, perhaps over several turns.

    Parameters
    ----------
    center : (x, y) in mm.
    sweep : in radians, positive counter-clockwise.
    """

    center: Point
    sweep: float

    def spans(self, start: Place, end: Place) -> Iterator[tuple[Place, float]]:
        """The end and the bulge of each span; none is more than half a turn.

        Where the ends are not equally far from the centre, the distance changes with the sweep.
        """
        count = max(ceil(abs(self.sweep) / pi - 1e-9), 1)
        (x, y), part = self.center, self.sweep / count
        bulge = tan(part / 4)
        from_x, from_y = start[0] - x, start[1] - y
        angle, radius = atan2(from_y, from_x), hypot(from_x, from_y)
        last = hypot(end[0] - x, end[1] - y)
        for number in range(1, count):
            share, turned = number / count, angle + number * part
            reach = radius + share * (last - radius)
            height = start[2] + share * (end[2] - start[2])
            yield (x + reach * cos(turned), y + reach * sin(turned), height), bulge
        yield end, bulge


def arc_about(center: Point, start: Place, end: Place, clockwise: bool, turns: int) -> PlaneArc:
    """An arc about a centre; where its ends are one place, it is a full circle.

    Raises
    ------
    InputError
        For ends that are not equally far from the centre.
    """
    (x, y), (to_x, to_y) = (
        (start[0] - center[0], start[1] - center[1]),
        (end[0] - center[0], end[1] - center[1]),
    )
    radius, other = hypot(x, y), hypot(to_x, to_y)
    if abs(radius - other) > ARC_RADII or min(radius, other) == 0.0:
        raise InputError(
            f"the arc begins {radius:.4f} mm from its centre and ends {other:.4f} mm from it: correct I and "
            "J, which are distances from the arc's start, or places after G90.1."
        )
    angle = atan2(x * to_y - y * to_x, x * to_x + y * to_y)
    if clockwise:
        angle = -angle
    if angle <= 0.0:
        angle += 2 * pi
    angle += 2 * pi * (turns - 1)
    return PlaneArc(center, -angle if clockwise else angle)


def arc_of_radius(radius: float, start: Place, end: Place, clockwise: bool) -> PlaneArc:
    """An arc of a radius; of more than half a turn where the radius is negative.

    Raises
    ------
    InputError
        For one place as both ends, and ends too far apart.
    """
    x, y = end[0] - start[0], end[1] - start[1]
    chord, size = hypot(x, y), abs(radius)
    if chord == 0.0:
        raise InputError(
            "an arc with R ends where it begins, so that its centre is not known: write I and J."
        )
    if chord / 2 > size + ARC_RADII:
        raise InputError(
            f"the arc's ends are {chord:.4f} mm apart, more than twice its radius of {size:.4f} mm: correct "
            "R."
        )
    away = sqrt(max(size * size - chord * chord / 4, 0.0))
    half = atan2(chord / 2, away)
    sweep = 2 * half if radius > 0 else 2 * pi - 2 * half
    # The centre lies to the left of an arc that is run counter-clockwise and is less than half a turn.
    side = away if (radius > 0) != clockwise else -away
    center = (start[0] + x / 2 - side * y / chord, start[1] + y / 2 + side * x / chord)
    return PlaneArc(center, -sweep if clockwise else sweep)
