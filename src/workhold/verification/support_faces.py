"""Faces that supports and a clamp touch, by their segments: how large a disc lies on them; their centre."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import atan2, ceil, hypot, inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.geometry.loop import loop_segments, signed_area
from workhold.geometry.segment import Arc, Segment, distance_to_segment
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.support_request import SupportRequest

__all__ = ["area_center", "band_faults", "room_on"]

Array = NDArray[np.float64]
Loop = tuple[Segment, ...]
# How far beside a segment a point is looked at, in mm.
PROBE = 1e-4
# Written heights agree with those of the solid to this, in mm.
SAME_HEIGHT = 1e-6


def turns_about(segments: Loop, point: tuple[float, float]) -> int:
    """How often a loop runs around a point off it."""
    turned = 0.0
    for one in segments:
        places = [one.start, one.end]
        if isinstance(one, Arc):
            near = abs(hypot(point[0] - one.center[0], point[1] - one.center[1]) - one.radius)
            # A chord passes nearer to its arc than the point does.
            steps = min(4096, 8 + ceil(2 * one.half_sweep / sqrt(max(near / one.radius, 1e-8))))
            low = -one.sign * one.half_sweep
            places = [one.at(low * (1 - 2 * k / steps)) for k in range(steps + 1)]
        angles = [atan2(y - point[1], x - point[0]) for x, y in places]
        turned += sum((b - a + pi) % (2 * pi) - pi for a, b in pairwise(angles))
    return round(turned / (2 * pi))


def room_on(loops: Sequence[Array], zones: Sequence[Array], point: tuple[float, float]) -> float:
    """How large a disc about a point lies on a face and over no zone, in mm; negative off it."""
    faces = faces_by_size([tuple(loop_segments(np.asarray(loop))) for loop in loops])
    room = max(min(side * reach(one, point) for one, side in face) for face in faces)
    off = (reach(tuple(loop_segments(np.asarray(zone))), point) for zone in zones)
    return min(room, *(-one for one in off), inf)


def reach(loop: Loop, point: tuple[float, float]) -> float:
    """Distance of a point from a loop in mm, negative outside it."""
    near = min(distance_to_segment(point, one) for one in loop)
    return near if turns_about(loop, point) else -near


def faces_by_size(loops: Sequence[Loop]) -> list[list[tuple[Loop, int]]]:
    """Loops of each face with 1 for its border, which comes first, and -1 for its openings.

    The first loop is a border. Of the others a loop is an opening where there is a face on its left. That is
    within a loop that runs counter-clockwise; one that runs the other way is never a border.
    """
    faces: list[list[tuple[Loop, int]]] = []
    sizes = [signed_area(loop) for loop in loops]
    for number in sorted(range(len(loops)), key=lambda k: (-abs(sizes[k]), sizes[k])):
        loop = loops[number]
        (x, y), (nx, ny) = loop[0].middle, loop[0].normal()
        probe = (x - PROBE * nx, y - PROBE * ny)
        under = [face for face in faces if all(side * reach(one, probe) > 0 for one, side in face)]
        if number and under:
            under[-1].append((loop, -1))
        elif number == 0 or sizes[number] > 0:
            faces.append([(loop, 1)])
    return faces


def area_center(loops: Sequence[Sequence[Segment]]) -> tuple[float, float]:
    """The centre of area of the part, from integrals along its border (Gauss-Legendre along each segment)."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    area = first = second = 0.0
    for one in (segment for loop in loops for segment in loop):
        if isinstance(one, Arc):
            low = one.mid_angle - one.sign * one.half_sweep
            sweep = 2 * one.sign * one.half_sweep
            angle = low + sweep * (nodes + 1) / 2
            x, y = one.center[0] + one.radius * np.cos(angle), one.center[1] + one.radius * np.sin(angle)
            dx, dy = -one.radius * np.sin(angle) * sweep / 2, one.radius * np.cos(angle) * sweep / 2
        else:
            (x0, y0), (x1, y1) = one.start, one.end
            x, y = x0 + (x1 - x0) * (nodes + 1) / 2, y0 + (y1 - y0) * (nodes + 1) / 2
            dx, dy = np.full(len(nodes), (x1 - x0) / 2), np.full(len(nodes), (y1 - y0) / 2)
        area += float(weights @ (x * dy))
        first += float(weights @ (x * x * dy)) / 2
        second -= float(weights @ (y * y * dx)) / 2
    return first / area, second / area


def band_faults(query: Query, fixture: Fixture, request: SupportRequest) -> Iterator[str]:
    """A fault for each peg whose band is not that of the faces of the solid that it touches."""
    bands, by_segment = request.bands, query.workpiece.numbered.bands
    if query.workpiece.solid is None or bands is None:
        return
    for peg, written in zip(fixture.pegs, bands, strict=True):
        faces = [by_segment[number] for number in (peg.face, peg.beside) if number is not None]
        known = [band for band in faces if band is not None]
        own = [min(low for low, _ in known), max(high for _, high in known)] if known else []
        own = [min(height, request.thickness) for height in own]
        if len(own) != len(written or ()) or any(
            abs(a - b) > SAME_HEIGHT for a, b in zip(written or (), own, strict=True)
        ):
            has = "no band" if written is None else f"the band {written[0]:g} to {written[1]:g}"
            solids = f"{own[0]:g} to {own[1]:g}" if own else "none"
            yield f"a peg on face {peg.face} has {has}, and that of the solid is {solids}"
