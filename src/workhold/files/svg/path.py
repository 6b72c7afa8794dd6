"""Paths of lines, arcs and Bézier curves: path data as chains. svgelements resolves relative and shortened commands.

Glossary
--------
shape : what one SVG element draws, as a chain in its own user units (y down).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from math import asin, cos, hypot, isfinite, pi, sin
from typing import Any

from attrs import field, frozen

from workhold.conventions import CIRCULAR, HALF_CIRCLE
from workhold.errors import InputError
from workhold.files.outline.chain import arc_bulges
from workhold.files.svg.document import short
from workhold.files.svg.lengths import NUMBER, ShapeElement
from workhold.geometry.rational import Pieces, ellipse_pieces, polynomial_pieces
from workhold.geometry.segment import Point

__all__ = ["Shape", "near", "path"]

COUNTS = {"M": 2, "Z": 0, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7}
SEPARATOR = r"\s*(?:,\s*(?=[-+.\d]))?"
COMMAND = re.compile(r"\s*([MmZzLlHhVvCcSsQqTtAa])\s*")
ARGUMENT = re.compile(rf"({NUMBER}){SEPARATOR}")
FLAG = re.compile(rf"([01]){SEPARATOR}")
CSS_PATH = re.compile(r"""path\(\s*(?:(?:nonzero|evenodd)\s*,\s*)?(?:"([^"]*)"|'([^']*)')\s*\)$""")


@frozen
class Shape:
    """N + 1 points in user units, N bulges, N labels, and the segments that are curves, by their numbers."""

    points: tuple[Point, ...]
    bulges: tuple[float, ...]
    labels: tuple[str, ...]
    curved: Mapping[int, Pieces] = field(factory=dict)

    def closed(self) -> Shape:
        """The shape with a line from its end to its start, unless it ends there."""
        if near(self.points[0], self.points[-1]):
            return self
        label = f"{self.labels[0].rpartition(' segment ')[0] or self.labels[0]} segment {len(self.labels) + 1}"
        return Shape((*self.points, self.points[0]), (*self.bulges, 0.0), (*self.labels, label), self.curved)


def near(p: Point, q: Point) -> bool:
    """Whether two points are equal but for rounding."""
    return hypot(p[0] - q[0], p[1] - q[1]) <= 1e-12 * (1 + abs(p[0]) + abs(p[1]))


def path(figure: ShapeElement) -> Iterator[Shape]:
    """A <path>; each subpath is a chain.

    Raises
    ------
    InputError
        For path data that cannot be read.
    """
    from svgelements import Path

    label, data = figure.label, path_data(figure)
    try:
        segments = list(Path(" ".join(plain_commands(data))))
    except Exception as error:  # svgelements raises many kinds for wrong path data
        raise InputError(f"{label} has path data that cannot be read ('{short(data)}'): correct it.") from error
    points: list[Point] = []
    bulges: list[float] = []
    labels: list[str] = []
    curved: dict[int, Pieces] = {}
    for number, segment in enumerate(segments):
        kind = type(segment).__name__
        if kind == "Move":
            if bulges:
                yield Shape(tuple(points), tuple(bulges), tuple(labels), curved)
            points, bulges, labels, curved = [xy(segment.end, label)], [], [], {}
            continue
        name = f"{label} segment {number}"
        curve = curve_of(segment, kind, name)
        if curve is not None:
            curved[len(bulges)] = curve
            points.append(xy(segment.end, name))
            bulges.append(0.0)
            labels.append(name)
            continue
        for end, bulge in path_segment(segment, kind, name):
            # Closing a path that is back at its start adds nothing.
            if not (kind == "Close" and near(end, points[-1])):
                points.append(end)
                bulges.append(bulge)
                labels.append(name)
        if kind == "Close":
            if bulges:
                yield Shape(tuple(points), tuple(bulges), tuple(labels), curved)
            points, bulges, labels, curved = [points[-1]], [], [], {}
    if bulges:
        yield Shape(tuple(points), tuple(bulges), tuple(labels), curved)


def path_data(figure: ShapeElement) -> str:
    """The path data, as attribute or as CSS property; empty when there is none.

    Raises
    ------
    InputError
        For a property that is not ``path("...")``.
    """
    given = figure.given("d")
    if given is None or given.text in ("", "none"):
        return ""
    match = CSS_PATH.match(given.text) if given.css else None
    if given.css and match is None:
        raise InputError(
            f"{figure.label} has the d '{short(given.text)}' in its style, which is not read: make it an attribute."
        )
    return given.text if match is None else match.group(1) or match.group(2) or ""


def plain_commands(data: str) -> Iterator[str]:
    """The commands of path data, each with its letter and arguments (SVG 2, 9.3.9); arcs without radius are lines (9.5.1).

    Raises
    ------
    ValueError
        For path data that is not of SVG's grammar.
    """
    position, first = 0, True
    while position < len(data.rstrip()):
        match = COMMAND.match(data, position)
        if match is None or (first and match.group(1) not in "Mm"):
            raise ValueError(data[position : position + 10])
        letter, position, first = match.group(1), match.end(), False
        count, again = COUNTS[letter.upper()], True
        while again:
            words = []
            for k in range(count):
                match = (FLAG if count == 7 and k in (3, 4) else ARGUMENT).match(data, position)
                if match is None:
                    raise ValueError(data[position : position + 10])
                words.append(match.group(1))
                position = match.end()
            if count == 7 and 0.0 in (float(words[0]), float(words[1])):
                yield f"{'L' if letter == 'A' else 'l'} {' '.join(words[5:])}"
            else:
                yield f"{letter} {' '.join(words)}"
            letter = {"M": "L", "m": "l"}.get(letter, letter)
            again = count > 0 and ARGUMENT.match(data, position) is not None


def path_segment(segment: Any, kind: str, label: str) -> list[tuple[Point, float]]:
    """End points and bulges of one path command that is no curve.

    Raises
    ------
    InputError
        For numbers that are missing or not finite.
    """
    if kind in ("Line", "Close"):
        return [(xy(segment.end, label), 0.0)]
    start, end = xy(segment.start, label), xy(segment.end, label)
    if end == start:
        return []  # SVG 2, 9.5.1
    radius = float(segment.rx)
    sweep = arc_sweep(start, end, radius, float(segment.sweep))
    bulges = arc_bulges(sweep)
    if len(bulges) == 1:
        return [(end, bulges[0])]
    cx, cy = xy(segment.center, label)
    c, s = cos(sweep / 2), sin(sweep / 2)
    dx, dy = start[0] - cx, start[1] - cy
    return [((cx + c * dx - s * dy, cy + s * dx + c * dy), bulges[0]), (end, bulges[1])]


def curve_of(segment: Any, kind: str, label: str) -> Pieces | None:
    """A Bézier curve or the arc of an ellipse; None for a line and the arc of a circle.

    Raises
    ------
    InputError
        For numbers that are missing or not finite.
    """
    if kind in ("Line", "Close"):
        return None
    start, end = xy(segment.start, label), xy(segment.end, label)
    if kind == "Arc":
        radius, other = float(segment.rx), float(segment.ry)
        if end == start or abs(radius - other) <= CIRCULAR * max(radius, other):
            return None
        center = xy(segment.center, label)
        major, minor = ((x - center[0], y - center[1]) for x, y in (xy(segment.prx, label), xy(segment.pry, label)))
        pieces = ellipse_pieces(center, major, minor, float(segment.get_start_t()), float(segment.sweep))
        pieces[0, 0], pieces[-1, -1] = (*start, 1.0), (*end, 1.0)
        return pieces
    between = [segment.control] if kind == "QuadraticBezier" else [segment.control1, segment.control2]
    return polynomial_pieces([start, *(xy(point, label) for point in between), end])


def arc_sweep(start: Point, end: Point, radius: float, rough: float) -> float:
    """Signed sweep of an arc by chord and radius, more accurate than the rough one, which gives side and direction."""
    half_chord = hypot(end[0] - start[0], end[1] - start[1]) / 2
    ratio = half_chord / radius if radius > 0 else 1.0
    half = pi / 2 if ratio > 1 - HALF_CIRCLE else asin(ratio)
    sweep = 2 * half if abs(rough) <= pi else 2 * (pi - half)
    # Near half a turn the rough sweep may fall on the wrong side; the nearer one is meant.
    if abs(abs(rough) - pi) < 1e-6 and ratio > 1 - 1e-12:
        sweep = pi
    return sweep if rough > 0 else -sweep


def xy(point: Any, label: str) -> Point:
    """A point of svgelements.

    Raises
    ------
    InputError
        When it is missing or not finite.
    """
    if point is None or not (isfinite(point.x) and isfinite(point.y)):
        raise InputError(f"{label} has path data with a number missing or not finite: correct it.")
    return float(point.x), float(point.y)
