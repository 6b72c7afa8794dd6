"""What each SVG shape is as chains, in its own user units (y down)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import cos, pi, tan

import numpy as np

from workhold.conventions import CIRCULAR
from workhold.errors import InputError
from workhold.files.svg.lengths import ShapeElement, numbers
from workhold.files.svg.path import Shape, near, path
from workhold.geometry.rational import Pieces, ellipse_pieces

__all__ = ["SHAPES"]


def line(figure: ShapeElement) -> Iterator[Shape]:
    """A <line>."""
    x1, y1, x2, y2 = (figure.length(a) for a in ("x1", "y1", "x2", "y2"))
    yield Shape(((x1, y1), (x2, y2)), (0.0,), (figure.label,))


def circle(figure: ShapeElement) -> Iterator[Shape]:
    """A <circle>, as two halves."""
    x, y, r = (figure.length(a) for a in ("cx", "cy", "r"))
    if r > 0:
        yield Shape(((x + r, y), (x - r, y), (x + r, y)), (1.0, 1.0), (figure.label, figure.label))


def ellipse(figure: ShapeElement) -> Iterator[Shape]:
    """An <ellipse>, a circle where its radii are equal; one that is not given is the other (SVG 2, 10.4)."""
    x, y = (figure.length(a) for a in ("cx", "cy"))
    rx, ry = radii(figure)
    if not (rx > 0 and ry > 0):
        return
    if abs(rx - ry) > CIRCULAR * max(rx, ry):
        whole = ellipse_pieces((x, y), (rx, 0.0), (0.0, ry), 0.0, 2 * pi)
        yield Shape(((x + rx, y), (x + rx, y)), (0.0,), (figure.label,), {0: whole})
        return
    yield Shape(((x + rx, y), (x - rx, y), (x + rx, y)), (1.0, 1.0), (figure.label, figure.label))


def radii(figure: ShapeElement) -> tuple[float, float]:
    """``rx`` and ``ry``: one that is not given, or negative, is the other, and 0 when neither is."""
    rx, ry = (figure.length(a, default=-1.0) for a in ("rx", "ry"))
    return max(ry if rx < 0 else rx, 0.0), max(rx if ry < 0 else ry, 0.0)


def rect(figure: ShapeElement) -> Iterator[Shape]:
    """A <rect>, its corners sharp, round or elliptical (SVG 1.1, section 9.2)."""
    x, y, w, h = (figure.length(a) for a in ("x", "y", "width", "height"))
    if not (w > 0 and h > 0):
        return
    rx, ry = radii(figure)
    rx, ry = min(rx, w / 2), min(ry, h / 2)
    if rx == 0 or ry == 0:
        corners = ((x, y), (x + w, y), (x + w, y + h), (x, y + h), (x, y))
        yield Shape(corners, (0.0,) * 4, segment_labels(figure.label, 4))
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
        s for s, after in zip(stations, stations[1:] + stations[:1], strict=True) if s[1] or not near(s[0], after[0])
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
    yield Shape(points, tuple(bulge for _, bulge in kept), segment_labels(figure.label, len(kept)), curved)


def polyline(figure: ShapeElement, close: bool = False) -> Iterator[Shape]:
    """A <polyline> or <polygon>.

    Raises
    ------
    InputError
        For an odd number of coordinates.
    """
    values = numbers(figure.element.get("points", ""), f"{figure.label}: points")
    if len(values) % 2:
        raise InputError(f"{figure.label} has an odd number of coordinates: correct its points.")
    points = list(zip(values[::2], values[1::2], strict=True))
    if close and points and points[0] != points[-1]:
        points.append(points[0])
    if len(points) > 1:
        count = len(points) - 1
        yield Shape(tuple(points), (0.0,) * count, segment_labels(figure.label, count))


def polygon(figure: ShapeElement) -> Iterator[Shape]:
    """A <polygon>."""
    return polyline(figure, close=True)


def segment_labels(label: str, count: int) -> tuple[str, ...]:
    """Labels of the segments of one element."""
    return tuple(f"{label} segment {k}" for k in range(count))


SHAPES: dict[str, Callable[[ShapeElement], Iterator[Shape]]] = {
    "line": line,
    "circle": circle,
    "ellipse": ellipse,
    "rect": rect,
    "polyline": polyline,
    "polygon": polygon,
    "path": path,
}
