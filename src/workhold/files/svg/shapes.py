"""SVG shapes as chains of lines, arcs and Bézier curves, path data included.

svgelements resolves relative and shortened commands of path data.

Glossary
--------
shape : the outline that one SVG element draws, as a chain in its own user units (y down).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from math import asin, cos, hypot, pi, sin, tan
from typing import Any, NamedTuple

import numpy as np
from attrs import field, frozen

from workhold.conventions import CIRCULAR, HALF_CIRCLE
from workhold.errors import InputError
from workhold.files.outline.chain import list_arc_bulges
from workhold.files.svg.document import shorten_text
from workhold.files.svg.viewport import LARGEST, NUMBER, ShapeElement, read_numbers
from workhold.geometry.rational import Pieces, make_bezier_piece, split_ellipse
from workhold.geometry.segment import Point

__all__ = ["SHAPES", "SvgShape"]

COUNTS = {"M": 2, "Z": 0, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7}
SEPARATOR = r"\s*(?:,\s*(?=[-+.0-9]))?"
COMMAND = re.compile(r"\s*([MmZzLlHhVvCcSsQqTtAa])\s*")
ARGUMENT = re.compile(rf"({NUMBER}){SEPARATOR}")
FLAG = re.compile(rf"([01]){SEPARATOR}")
CSS_PATH = re.compile(r"""path\(\s*(?:(?:nonzero|evenodd)\s*,\s*)?(?:"([^"]*)"|'([^']*)')\s*\)$""")


@frozen
class SvgShape:
    """N + 1 points in user units, N bulges and N labels;
    ``curved`` has the segments that are curves, by their index.
    """

    points: tuple[Point, ...]
    bulges: tuple[float, ...]
    labels: tuple[str, ...]
    curved: Mapping[int, Pieces] = field(factory=dict)

    def close(self) -> SvgShape:
        """Return the shape with a line added from its end to its start; unchanged if it ends at its start."""
        if are_equal_points(self.points[0], self.points[-1]):
            return self
        label = (
            f"{self.labels[0].rpartition(' segment ')[0] or self.labels[0]} segment {len(self.labels) + 1}"
        )
        return SvgShape(
            (*self.points, self.points[0]), (*self.bulges, 0.0), (*self.labels, label), self.curved
        )


def are_equal_points(p: Point, q: Point) -> bool:
    """Return whether two points are equal within rounding."""
    return hypot(p[0] - q[0], p[1] - q[1]) <= 1e-12 * (1 + abs(p[0]) + abs(p[1]))


def read_path(figure: ShapeElement) -> Iterator[SvgShape]:
    """Yield the subpaths of a <path>, each as one shape; labels number the path's commands."""
    label = figure.label
    start: Point = (0.0, 0.0)
    steps: list[PathStep] = []
    for number, segment in enumerate(list_path_segments(figure)):
        kind = type(segment).__name__
        if kind == "Move":
            if steps:
                yield make_subpath(start, steps)
            start, steps = read_point(segment.end, label), []
            continue
        last = steps[-1].end if steps else start
        found = convert_path_command(segment, kind, f"{label} segment {number}")
        # Closing a path that is back at its start adds nothing.
        steps += [step for step in found if not (kind == "Close" and are_equal_points(step.end, last))]
        if kind == "Close" and steps:
            yield make_subpath(start, steps)
            start, steps = steps[-1].end, []
    if steps:
        yield make_subpath(start, steps)


# Commands that are resolved at a time.
BATCH = 256


def list_path_segments(figure: ShapeElement) -> Iterator[Any]:
    """Yield the segments of a path as svgelements resolves them.

    Raises InputError for path data that cannot be read, or needs more than the budget has.
    """
    from svgelements import Move, Path

    data = read_path_data(figure).rstrip()
    commands = split_path_commands(data)
    held: list[Any] = []
    while True:
        # What follows depends on the last segment, and closing on where the subpath begins.
        move = next((one for one in reversed(held) if isinstance(one, Move)), None)
        seeds = [] if move is None else [move] if held[-1] is move else [move, held[-1]]
        resolved = Path(*seeds)
        try:
            batch = list(islice(commands, BATCH))
            resolved.parse(" ".join(batch))
            held = list(resolved)
        except Exception as error:  # svgelements raises many kinds for wrong path data
            raise InputError(
                f"{figure.label} has path data that cannot be read ('{shorten_text(data)}'): correct it."
            ) from error
        figure.budget.spend(len(batch))
        yield from held[len(seeds) :]
        if len(batch) < BATCH:
            return


class PathStep(NamedTuple):
    """A segment of a path: its last point, bulge and label, and its Bézier pieces if it is a curve."""

    end: Point
    bulge: float
    label: str
    curve: Pieces | None = None


def make_subpath(start: Point, steps: Sequence[PathStep]) -> SvgShape:
    """Return the shape of consecutive steps from a start point."""
    ends, bulges, labels, curves = zip(*steps, strict=True)
    return SvgShape((start, *ends), bulges, labels, {k: c for k, c in enumerate(curves) if c is not None})


def read_path_data(figure: ShapeElement) -> str:
    """Return the path data of an attribute or a CSS property; "" when there is none.

    Raises InputError for a property that is not ``path("...")``.
    """
    given = figure.find_given_value("d")
    if given is None or given.text in ("", "none"):
        return ""
    match = CSS_PATH.match(given.text) if given.css else None
    if given.css and match is None:
        raise InputError(
            f"{figure.label} has the d '{shorten_text(given.text)}' in its style, which is not read: make it an "
            "attribute."
        )
    return given.text if match is None else match.group(1) or match.group(2) or ""


def split_path_commands(data: str) -> Iterator[str]:
    """Yield the commands of path data, each with its letter and one set of arguments (SVG 2, 9.3.9).

    Arcs with a radius of 0 become lines (9.5.1). Raises ValueError for path data that is not of SVG's
    grammar.
    """
    position, first = 0, True
    while position < len(data):
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


def convert_path_command(segment: Any, kind: str, label: str) -> list[PathStep]:
    """Return the steps of one path command: one or two for an arc of a circle, none for a command without
    length, otherwise one.

    ``kind`` is the class name of svgelements' segment. Raises InputError for numbers that are missing or not
    finite.
    """
    end = read_point(segment.end, label)
    if kind in ("Line", "Close"):
        return [PathStep(end, 0.0, label)]
    start = read_point(segment.start, label)
    if kind != "Arc":
        between = [segment.control] if kind == "QuadraticBezier" else [segment.control1, segment.control2]
        curve = make_bezier_piece([start, *(read_point(point, label) for point in between), end])
        return [PathStep(end, 0.0, label, curve)]
    if end == start:
        return []  # SVG 2, 9.5.1
    radius, other = float(segment.rx), float(segment.ry)
    if not max(radius, other) <= LARGEST:
        raise InputError(f"{label} is an arc with a radius that is too large: correct it.")
    if abs(radius - other) > CIRCULAR * max(radius, other):
        cx, cy = read_point(segment.center, label)
        major, minor = (
            (x - cx, y - cy) for x, y in (read_point(segment.prx, label), read_point(segment.pry, label))
        )
        curve = split_ellipse((cx, cy), major, minor, float(segment.get_start_t()), float(segment.sweep))
        curve[0, 0], curve[-1, -1] = (*start, 1.0), (*end, 1.0)
        return [PathStep(end, 0.0, label, curve)]
    sweep = compute_arc_sweep(start, end, radius, float(segment.sweep))
    bulges = list_arc_bulges(sweep)
    if len(bulges) == 1:
        return [PathStep(end, bulges[0], label)]
    cx, cy = read_point(segment.center, label)
    c, s = cos(sweep / 2), sin(sweep / 2)
    dx, dy = start[0] - cx, start[1] - cy
    middle = (cx + c * dx - s * dy, cy + s * dx + c * dy)
    return [PathStep(middle, bulges[0], label), PathStep(end, bulges[1], label)]


def compute_arc_sweep(start: Point, end: Point, radius: float, rough: float) -> float:
    """Return the signed sweep of an arc in radians from chord and radius, more accurate than ``rough``.

    ``rough`` decides the sign, and whether it is more than half a turn.
    """
    half_chord = hypot(end[0] - start[0], end[1] - start[1]) / 2
    ratio = half_chord / radius if radius > 0 else 1.0
    half = pi / 2 if ratio > 1 - HALF_CIRCLE else asin(ratio)
    sweep = 2 * half if abs(rough) <= pi else 2 * (pi - half)
    # Near half a turn the rough sweep may fall on the wrong side; the nearer one is meant.
    if abs(abs(rough) - pi) < 1e-6 and ratio > 1 - 1e-12:
        sweep = pi
    return sweep if rough > 0 else -sweep


def read_point(point: Any, label: str) -> Point:
    """Return a point of svgelements as (x, y); raise
    InputError when it is missing, not finite or too large.
    """
    if point is None or not (abs(point.x) <= LARGEST and abs(point.y) <= LARGEST):
        raise InputError(f"{label} has path data with a number missing, too large or not finite: correct it.")
    return float(point.x), float(point.y)


def read_line(figure: ShapeElement) -> Iterator[SvgShape]:
    """Yield the shape of a <line>."""
    x1, y1, x2, y2 = (figure.read_length(a) for a in ("x1", "y1", "x2", "y2"))
    yield SvgShape(((x1, y1), (x2, y2)), (0.0,), (figure.label,))


def read_circle(figure: ShapeElement) -> Iterator[SvgShape]:
    """Return an iterator over the shape of a <circle>."""
    x, y, r = (figure.read_length(a) for a in ("cx", "cy", "r"))
    return make_oval(figure.label, (x, y), r, r)


def read_ellipse(figure: ShapeElement) -> Iterator[SvgShape]:
    """Return an iterator over the shape of an <ellipse>; a
    radius that is not given equals the other (SVG 2, 10.4).
    """
    x, y = (figure.read_length(a) for a in ("cx", "cy"))
    return make_oval(figure.label, (x, y), *read_radii(figure))


def make_oval(label: str, center: Point, rx: float, ry: float) -> Iterator[SvgShape]:
    """Yield one shape: an ellipse, or a circle as two half circles where the radii are equal; nothing where a
    radius is 0.
    """
    x, y = center
    if not (rx > 0 and ry > 0):
        return
    if abs(rx - ry) > CIRCULAR * max(rx, ry):
        whole = split_ellipse(center, (rx, 0.0), (0.0, ry), 0.0, 2 * pi)
        yield SvgShape(((x + rx, y), (x + rx, y)), (0.0,), (label,), {0: whole})
    else:
        yield SvgShape(((x + rx, y), (x - rx, y), (x + rx, y)), (1.0, 1.0), (label, label))


def read_radii(figure: ShapeElement) -> tuple[float, float]:
    """Return (rx, ry) of a shape. A radius that is not given, or negative, takes the value of the other; both
    are 0 when neither is given.
    """
    rx, ry = (figure.read_length(a, default=-1.0) for a in ("rx", "ry"))
    return max(ry if rx < 0 else rx, 0.0), max(rx if ry < 0 else ry, 0.0)


def read_rectangle(figure: ShapeElement) -> Iterator[SvgShape]:
    """Yield the shape of a <rect> with sharp, round or elliptical
    corners (SVG 1.1, section 9.2); nothing for an empty one.
    """
    x, y, w, h = (figure.read_length(a) for a in ("x", "y", "width", "height"))
    if not (w > 0 and h > 0):
        return
    rx, ry = read_radii(figure)
    rx, ry = min(rx, w / 2), min(ry, h / 2)
    if rx == 0 or ry == 0:
        corners = ((x, y), (x + w, y), (x + w, y + h), (x, y + h), (x, y))
        yield SvgShape(corners, (0.0,) * 4, list_segment_labels(figure.label, 4))
        return
    quarter = tan(pi / 8)
    stations = [
        ((x + rx, y), 0.0),
        ((x + w - rx, y), quarter),
        ((x + w, y + ry), 0.0),
        ((x + w, y + h - ry), quarter),
        ((x + w - rx, y + h), 0.0),
        ((x + rx, y + h), quarter),
        ((x, y + h - ry), 0.0),
        ((x, y + ry), quarter),
    ]
    # A side as long as two radii vanishes between its corners.
    kept = [
        s
        for s, after in zip(stations, stations[1:] + stations[:1], strict=True)
        if s[1] or not are_equal_points(s[0], after[0])
    ]
    points = (*(point for point, _ in kept), kept[0][0])
    curved: dict[int, Pieces] = {}
    if abs(rx - ry) > CIRCULAR * max(rx, ry):
        for k, (point, bulge) in enumerate(kept):
            if bulge:
                # Every second corner is left vertically.
                (px, py), (qx, qy) = point, points[k + 1]
                corner, weight = ((px, qy) if len(curved) % 2 else (qx, py)), cos(pi / 4)
                rows = [(px, py, 1.0), (corner[0] * weight, corner[1] * weight, weight), (qx, qy, 1.0)]
                curved[k] = np.array([rows])
    yield SvgShape(
        points, tuple(bulge for _, bulge in kept), list_segment_labels(figure.label, len(kept)), curved
    )


def read_polyline(figure: ShapeElement, close: bool = False) -> Iterator[SvgShape]:
    """Yield the shape of a <polyline>, or with ``close`` of a
    <polygon>; raise InputError for an odd number of coordinates.
    """
    values = read_numbers(figure.element.get("points", ""), f"{figure.label}: points", figure.budget)
    if len(values) % 2:
        raise InputError(f"{figure.label} has an odd number of coordinates: correct its points.")
    points = list(zip(values[::2], values[1::2], strict=True))
    if close and points and points[0] != points[-1]:
        points.append(points[0])
    if len(points) > 1:
        count = len(points) - 1
        yield SvgShape(tuple(points), (0.0,) * count, list_segment_labels(figure.label, count))


def read_polygon(figure: ShapeElement) -> Iterator[SvgShape]:
    """Return an iterator over the shape of a <polygon>."""
    return read_polyline(figure, close=True)


def list_segment_labels(label: str, count: int) -> tuple[str, ...]:
    """Return the labels of ``count`` segments, numbered from 0."""
    return tuple(f"{label} segment {k}" for k in range(count))


SHAPES: dict[str, Callable[[ShapeElement], Iterator[SvgShape]]] = {
    "line": read_line,
    "circle": read_circle,
    "ellipse": read_ellipse,
    "rect": read_rectangle,
    "polyline": read_polyline,
    "polygon": read_polygon,
    "path": read_path,
}
