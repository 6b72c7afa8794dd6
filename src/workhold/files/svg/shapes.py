"""What each SVG shape is as chains, in its own user units (y down), and the reading of lengths and transforms."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from math import asin, cos, hypot, isfinite, pi, radians, sin, tan
from typing import Any
from xml.etree.ElementTree import Element

from attrs import frozen

from workhold.conventions import CIRCULAR
from workhold.errors import InputError
from workhold.files.outline.chain import arc_bulges
from workhold.files.outline.placement import Placement
from workhold.geometry.segment import Point

__all__ = ["SHAPES", "Shape", "length", "local_name", "named", "numbers", "physical_length", "transform_of"]

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
LENGTH = re.compile(rf"\s*({NUMBER})\s*(\w*|%)\s*$")
TRANSFORM = re.compile(r"\s*,?\s*(\w+)\s*\(([^)]*)\)")
# CSS Values 4: 96 px to the inch.
PIXELS = {"": 1.0, "px": 1.0, "in": 96.0, "cm": 96 / 2.54, "mm": 96 / 25.4, "pt": 96 / 72, "pc": 16.0}
# A chord this near the diameter, relatively, is a half circle: its sweep cannot be told from the chord.
HALF = 1e-14


@frozen
class Shape:
    """N + 1 points in user units, N bulges, N labels."""

    points: tuple[Point, ...]
    bulges: tuple[float, ...]
    labels: tuple[str, ...]


def local_name(element: Element) -> str:
    """Tag without its namespace."""
    return str(element.tag).rpartition("}")[2]


def named(element: Element, tag: str, count: int) -> str:
    """How messages call an element: by its id, or else by its number among the elements of its kind."""
    return f"{tag} '{element.get('id')}'" if element.get("id") else f"{tag} number {count} (without id)"


def physical_length(text: str | None) -> float | None:
    """A length in mm; None unless it has a physical unit."""
    match = LENGTH.match(text) if text else None
    if match is None or match.group(2) not in PIXELS or match.group(2) in ("", "px"):
        return None
    return float(match.group(1)) * PIXELS[match.group(2)] * 25.4 / 96


def length(element: Element, attribute: str, label: str, default: float = 0.0) -> float:
    """An attribute's length in user units.

    Raises
    ------
    InputError
        For anything but a number with a plain unit.
    """
    text = element.get(attribute)
    if text is None or text.strip() == "auto":
        return default
    match = LENGTH.match(text)
    if match is None or match.group(2) not in PIXELS:
        raise InputError(f'{label} has {attribute}="{text[:40]}", which is not a plain length: write a number.')
    return float(match.group(1)) * PIXELS[match.group(2)]


def numbers(text: str, what: str) -> list[float]:
    """All numbers of a list separated by blanks and commas.

    Raises
    ------
    InputError
        For anything else in the list.
    """
    rest = re.sub(NUMBER, "", text)
    if rest.replace(",", "").strip():
        raise InputError(f"{what} '{text[:60]}' is not a list of numbers: correct it.")
    values = [float(word) for word in re.findall(NUMBER, text)]
    if not all(map(isfinite, values)):
        raise InputError(f"{what} '{text[:60]}' has a number that is too large: correct it.")
    return values


def transform_of(element: Element, label: str) -> Placement:
    """An element's ``transform``.

    Raises
    ------
    InputError
        For transforms that are not SVG's.
    """
    text = (element.get("transform") or "").strip()
    placement = Placement()
    position = 0
    while position < len(text):
        match = TRANSFORM.match(text, position)
        if match is None:
            raise InputError(f"{label} has the transform '{text[:60]}', which cannot be read: correct it.")
        values = numbers(match.group(2), f"{label}: transform")
        step = single_transform(match.group(1), values)
        if step is None:
            raise InputError(
                f"{label} has the transform '{match.group(0).strip()[:60]}', which cannot be read: correct it."
            )
        placement = placement.after(step)
        position = match.end()
    return placement


def single_transform(name: str, v: list[float]) -> Placement | None:
    """One transform function of SVG 1.1, section 7.6; None when it is none."""
    count = len(v)
    if name == "matrix" and count == 6:
        return Placement(*v)
    if name == "translate" and count in (1, 2):
        return Placement(e=v[0], f=v[1] if count == 2 else 0.0)
    if name == "scale" and count in (1, 2):
        return Placement(a=v[0], d=v[-1])
    if name == "rotate" and count in (1, 3):
        c, s = cos(radians(v[0])), sin(radians(v[0]))
        turn = Placement(c, s, -s, c)
        return turn if count == 1 else Placement(e=v[1], f=v[2]).after(turn).after(Placement(e=-v[1], f=-v[2]))
    if name == "skewX" and count == 1:
        return Placement(c=tan(radians(v[0])))
    if name == "skewY" and count == 1:
        return Placement(b=tan(radians(v[0])))
    return None


def line(element: Element, label: str) -> Iterator[Shape]:
    """A <line>."""
    x1, y1, x2, y2 = (length(element, a, label) for a in ("x1", "y1", "x2", "y2"))
    yield Shape(((x1, y1), (x2, y2)), (0.0,), (label,))


def circle(element: Element, label: str) -> Iterator[Shape]:
    """A <circle>, as two halves."""
    x, y, r = (length(element, a, label) for a in ("cx", "cy", "r"))
    if r > 0:
        yield Shape(((x + r, y), (x - r, y), (x + r, y)), (1.0, 1.0), (label, label))


def ellipse(element: Element, label: str) -> Iterator[Shape]:
    """An <ellipse> whose radii are equal.

    Raises
    ------
    InputError
        When they are not.
    """
    x, y, rx, ry = (length(element, a, label) for a in ("cx", "cy", "rx", "ry"))
    if abs(rx - ry) > CIRCULAR * max(rx, ry):
        raise refused(label, "is an ellipse", (x, y))
    if rx > 0:
        yield Shape(((x + rx, y), (x - rx, y), (x + rx, y)), (1.0, 1.0), (label, label))


def rect(element: Element, label: str) -> Iterator[Shape]:
    """A <rect>, its corners sharp or round (SVG 1.1, section 9.2).

    Raises
    ------
    InputError
        For elliptical corners.
    """
    x, y, w, h = (length(element, a, label) for a in ("x", "y", "width", "height"))
    if not (w > 0 and h > 0):
        return
    rx, ry = (length(element, a, label, default=-1.0) for a in ("rx", "ry"))
    rx, ry = (ry if rx < 0 else rx), (rx if ry < 0 else ry)
    rx, ry = min(max(rx, 0.0), w / 2), min(max(ry, 0.0), h / 2)
    if rx == 0 or ry == 0:
        corners = ((x, y), (x + w, y), (x + w, y + h), (x, y + h), (x, y))
        yield Shape(corners, (0.0,) * 4, segment_labels(label, 4))
        return
    if abs(rx - ry) > CIRCULAR * max(rx, ry):
        raise refused(label, "has elliptical corners", (x, y))
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
        s for s, after in zip(stations, stations[1:] + stations[:1], strict=True) if s[1] or not near(s[0], after[0])
    ]
    points = (*(point for point, _ in kept), kept[0][0])
    yield Shape(points, tuple(bulge for _, bulge in kept), segment_labels(label, len(kept)))


def near(p: Point, q: Point) -> bool:
    """Whether two points are equal but for rounding."""
    return hypot(p[0] - q[0], p[1] - q[1]) <= 1e-12 * (1 + abs(p[0]) + abs(p[1]))


def polyline(element: Element, label: str, close: bool = False) -> Iterator[Shape]:
    """A <polyline> or <polygon>.

    Raises
    ------
    InputError
        For an odd number of coordinates.
    """
    values = numbers(element.get("points", ""), f"{label}: points")
    if len(values) % 2:
        raise InputError(f"{label} has an odd number of coordinates: correct its points.")
    points = list(zip(values[::2], values[1::2], strict=True))
    if close and points and points[0] != points[-1]:
        points.append(points[0])
    if len(points) > 1:
        count = len(points) - 1
        yield Shape(tuple(points), (0.0,) * count, segment_labels(label, count))


def polygon(element: Element, label: str) -> Iterator[Shape]:
    """A <polygon>."""
    return polyline(element, label, close=True)


def path(element: Element, label: str) -> Iterator[Shape]:
    """A <path> of lines and circular arcs; each subpath is a chain.

    Raises
    ------
    InputError
        For Bézier curves, elliptical arcs, and path data that cannot be read.
    """
    from svgelements import Path

    data = element.get("d", "").strip()
    if not data or data == "none":
        return
    if data[0] not in "Mm" or re.sub(rf"{NUMBER}|[MmZzLlHhVvCcSsQqTtAa,\s]", "", data):
        raise InputError(f"{label} has path data that cannot be read ('{data[:40]}'): correct it.")
    try:
        segments = list(Path(data))
    except Exception as error:  # svgelements raises many kinds for wrong path data
        raise InputError(f"{label} has path data that cannot be read ('{data[:40]}'): correct it.") from error
    points: list[Point] = []
    bulges: list[float] = []
    labels: list[str] = []
    for number, segment in enumerate(segments):
        kind = type(segment).__name__
        if kind == "Move":
            if bulges:
                yield Shape(tuple(points), tuple(bulges), tuple(labels))
            points, bulges, labels = [xy(segment.end, label)], [], []
            continue
        steps, name = path_segment(segment, kind, f"{label} segment {number}"), f"{label} segment {number}"
        for end, bulge in steps:
            # Closing a path that is back at its start adds nothing.
            if not (kind == "Close" and near(end, points[-1])):
                points.append(end)
                bulges.append(bulge)
                labels.append(name)
        if kind == "Close":
            if bulges:
                yield Shape(tuple(points), tuple(bulges), tuple(labels))
            points, bulges, labels = [points[-1]], [], []
    if bulges:
        yield Shape(tuple(points), tuple(bulges), tuple(labels))


def path_segment(segment: Any, kind: str, label: str) -> list[tuple[Point, float]]:
    """End points and bulges of one path command.

    Raises
    ------
    InputError
        For Bézier curves and elliptical arcs.
    """
    if kind in ("Line", "Close"):
        return [(xy(segment.end, label), 0.0)]
    start = xy(segment.start, label)
    if kind != "Arc":
        raise refused(label, "is a Bézier curve", start)
    end = xy(segment.end, label)
    radius, other = float(segment.rx), float(segment.ry)
    if not abs(radius - other) <= CIRCULAR * max(radius, other):
        raise refused(label, "is an elliptical arc", start)
    sweep = arc_sweep(start, end, radius, float(segment.sweep))
    bulges = arc_bulges(sweep)
    if len(bulges) == 1:
        return [(end, bulges[0])]
    cx, cy = xy(segment.center, label)
    c, s = cos(sweep / 2), sin(sweep / 2)
    dx, dy = start[0] - cx, start[1] - cy
    return [((cx + c * dx - s * dy, cy + s * dx + c * dy), bulges[0]), (end, bulges[1])]


def arc_sweep(start: Point, end: Point, radius: float, rough: float) -> float:
    """Signed sweep of an arc by chord and radius, more accurate than the rough one, which tells side and direction."""
    half_chord = hypot(end[0] - start[0], end[1] - start[1]) / 2
    ratio = half_chord / radius if radius > 0 else 1.0
    half = pi / 2 if ratio > 1 - HALF else asin(ratio)
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


def refused(label: str, what: str, point: Point) -> InputError:
    """The error for shapes that are no lines and circular arcs."""
    return InputError(
        f"{label} {what} at ({point[0]:.6g}, {point[1]:.6g}), which is not made of lines and circular arcs: export the "
        "drawing with arcs, or redraw it."
    )


def segment_labels(label: str, count: int) -> tuple[str, ...]:
    """Labels of the segments of one element."""
    return tuple(f"{label} segment {k}" for k in range(count))


SHAPES: dict[str, Callable[[Element, str], Iterator[Shape]]] = {
    "line": line,
    "circle": circle,
    "ellipse": ellipse,
    "rect": rect,
    "polyline": polyline,
    "polygon": polygon,
    "path": path,
}
