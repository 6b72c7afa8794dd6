"""Arcs that lie on one circle but for less than a drawing can mean, made one.

Programs that write tool paths cut a circle into arcs whose sweeps are rounded each by itself, so that each has a centre and
a radius of its own. To a peg they are one face, and the search would have to separate hundreds of nearly equal contacts.

Glossary
--------
chain : as many neighbouring arcs of a loop as there are that turn the same way and are nearly tangent where they meet.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, hypot, pi, sin, tan, tau

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import READING
from workhold.geometry.segment import Arc, Point, Segment

__all__ = ["on_one_circle"]

Array = NDArray[np.float64]


def on_one_circle(vertices: Array, segments: Sequence[Segment]) -> tuple[Array, int]:
    """Puts each chain of arcs that lies within ``READING`` of a circle onto it.

    The ends of a chain stay where they are, unless the whole loop is one. Done twice it changes nothing more.

    Parameters
    ----------
    vertices : (N, 3) of a loop.
    segments : its segments.

    Returns
    -------
    ((N, 3) array, read-only: the loop with one circle for each such chain; how many arcs were changed)
    """
    out, changed = np.array(vertices), 0
    for chain in chains(segments):
        arcs = [segment for k in chain if isinstance(segment := segments[k % len(segments)], Arc)]
        circle = None if is_one_already(arcs) else circle_of(arcs, len(chain) == len(segments))
        if circle is not None:
            write_chain(out, chain, circle, len(segments))
            changed += len(chain)
    out.setflags(write=False)
    return out, changed


def is_one_already(arcs: Sequence[Arc]) -> bool:
    """Whether arcs differ by no more than the rounding of a drawing."""
    first, hair = arcs[0], READING / 100
    return all(
        hypot(arc.center[0] - first.center[0], arc.center[1] - first.center[1]) + abs(arc.radius - first.radius) < hair
        for arc in arcs
    )


def follows(one: Segment, other: Segment) -> bool:
    """Whether two neighbours may be of one circle: arcs that turn the same way and are nearly tangent where they meet.

    An arc within e of a circle is turned against it by no more than some 4 e / chord.
    """
    if not (isinstance(one, Arc) and isinstance(other, Arc)) or one.sign != other.sign:
        return False
    if abs(one.radius - other.radius) > 0.1 * (one.radius + other.radius) or one.is_full or other.is_full:
        return False
    (ax, ay), (bx, by) = one.normal(one.sign * one.half_sweep), other.normal(-other.sign * other.half_sweep)
    chord = min(arc.radius * min(sin(min(arc.half_sweep, pi / 2)), 1.0) * 2 for arc in (one, other))
    return hypot(ax - bx, ay - by) <= 16 * READING / chord + 1e-9


def chains(segments: Sequence[Segment]) -> list[list[int]]:
    """Numbers of the segments of each chain of two arcs and more; those beyond the last vertex are counted on."""
    count = len(segments)
    starts = [k for k in range(count) if not follows(segments[k - 1], segments[k])]
    ends = [*starts[1:], starts[0] + count] if starts else [count]
    found = [list(range(first, last)) for first, last in zip(starts or [0], ends, strict=True) if last - first > 1]
    return [chain for chain in found if isinstance(segments[chain[0] % count], Arc)]


def circle_of(arcs: Sequence[Arc], whole: bool) -> tuple[Point, float] | None:
    """Centre and radius of a circle that arcs lie on to within ``READING``, through both ends unless they are the ``whole``.

    The circle of least squares through ends and middles (I. Kasa, "A circle fitting procedure and its error analysis", IEEE
    Transactions on Instrumentation and Measurement 25 (1976) 8-14), whose centre is moved onto the axis of both ends.
    """
    if len(arcs) < 2 or (whole and abs(sum(arc.half_sweep for arc in arcs) - pi) > 1e-3):
        return None
    points = np.array([point for arc in arcs for point in (arc.start, arc.at(0.0))] + [arcs[-1].end])
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    (a, b, c), *_ = np.linalg.lstsq(np.column_stack([x, y, np.ones(len(x))]), x * x + y * y, rcond=None)
    center, radius = middle + np.array([a, b]) / 2, float(np.sqrt(max(c + (a * a + b * b) / 4, 0.0)))
    if not whole:
        start, end = points[0], points[-1]
        along = end - start
        size = float(np.hypot(*along))
        if size < 1e-3 * radius:
            return None
        center = center - along * float(along @ (center - (start + end) / 2)) / size**2
        radius = float(np.hypot(*(start - center)))
    place = float(center[0]), float(center[1])
    return (place, radius) if all(is_near(arc, place, radius) for arc in arcs) else None


def is_near(arc: Arc, center: Point, radius: float) -> bool:
    """Whether an arc is nowhere farther than ``READING`` from a circle.

    The distance from the centre has its extremes at the arc's ends and on the line through both centres.
    """
    points = [arc.start, arc.end, arc.at(0.0)]
    toward = atan2(arc.center[1] - center[1], arc.center[0] - center[0])
    for angle in (toward, toward + pi):
        parameter = (angle - arc.mid_angle + pi) % tau - pi
        if abs(parameter) <= arc.half_sweep:
            points.append(arc.at(parameter))
    return all(abs(hypot(x - center[0], y - center[1]) - radius) <= READING for x, y in points)


def write_chain(out: Array, chain: Sequence[int], circle: tuple[Point, float], count: int) -> None:
    """Puts the inner vertices of a chain on its circle, and writes the bulges of the arcs between its vertices."""
    (cx, cy), radius = circle
    places = [k % count for k in chain] + [(chain[-1] + 1) % count]
    angles = [atan2(out[k, 1] - cy, out[k, 0] - cx) for k in places]
    sign = 1.0 if out[places[0], 2] > 0 else -1.0
    first = 0 if len(chain) == count else 1
    for k, angle in zip(places[first:-1], angles[first:-1], strict=True):
        out[k, :2] = cx + radius * cos(angle), cy + radius * sin(angle)
    for k, one, other in zip(places[:-1], angles[:-1], angles[1:], strict=True):
        out[k, 2] = sign * tan((sign * (other - one)) % tau / 4)
