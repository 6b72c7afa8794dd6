"""Viewports: the ``viewBox`` of a drawing, a nested drawing or a symbol, and windows that cut off what is outside.

Glossary
--------
viewport : what the percentages of lengths are of, in user units.
window : a convex polygon that hides what is outside: the edge of a nested drawing or of a symbol, or a clip path.
"""

from __future__ import annotations

from itertools import pairwise
from math import atan2, hypot, pi
from typing import Literal

from attrs import frozen

from workhold.errors import InputError
from workhold.files.outline.chain import Chain
from workhold.files.outline.placement import Placement
from workhold.files.svg.document import short
from workhold.files.svg.lengths import numbers
from workhold.geometry.segment import Point

__all__ = ["ViewBox", "Window", "convex", "fitted", "viewbox_of"]

# A window's edge and an outline on it, relative to the window's size, may differ by the rounding of a drawing's digits.
ON_EDGE = 1e-6

ViewBox = tuple[float, float, float, float]
ALIGNMENT = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}


def viewbox_of(text: str | None, label: str) -> ViewBox | None:
    """Left, top, width and height of a viewBox; None when there is none.

    Raises
    ------
    InputError
        When it is not four numbers with a positive size.
    """
    if text is None:
        return None
    values = numbers(text, f"the viewBox of {label}")
    if len(values) != 4 or not (values[2] > 0 and values[3] > 0):
        raise InputError(f"the viewBox '{short(text)}' of {label} is not usable: it must be x y width height.")
    return values[0], values[1], values[2], values[3]


def fitted(box: ViewBox, width: float, height: float, aspect: str, label: str) -> Placement:
    """The map from a viewBox to a viewport at the origin (SVG 2, 8.2).

    Raises
    ------
    InputError
        For a ``preserveAspectRatio`` that is not SVG's.
    """
    words = aspect.split() or ["xMidYMid"]
    sx, sy = width / box[2], height / box[3]
    if words[0] == "none":
        return Placement(a=sx, d=sy, e=-sx * box[0], f=-sy * box[1])
    align, way = words[0], words[1] if len(words) > 1 else "meet"
    if len(words) > 2 or way not in ("meet", "slice") or align[:1] + align[4:5] != "xY" or len(align) != 8:
        raise InputError(f"{label} has the preserveAspectRatio '{short(aspect)}', which cannot be read: correct it.")
    scale = max(sx, sy) if way == "slice" else min(sx, sy)
    shares = ALIGNMENT.get(align[1:4]), ALIGNMENT.get(align[5:8])
    if shares[0] is None or shares[1] is None:
        raise InputError(f"{label} has the preserveAspectRatio '{short(aspect)}', which cannot be read: correct it.")
    left, top = shares[0] * (width - scale * box[2]), shares[1] * (height - scale * box[3])
    return Placement(a=scale, d=scale, e=left - scale * box[0], f=top - scale * box[1])


def convex(points: tuple[Point, ...]) -> bool:
    """Whether a closed polygon, its first point repeated at its end, is convex and not crossed by itself."""
    steps = [(x - u, y - v) for (u, v), (x, y) in pairwise(points) if (x, y) != (u, v)]
    if len(steps) < 3:
        return False
    turns = [atan2(a * d - b * c, a * c + b * d) for (a, b), (c, d) in pairwise([*steps, steps[0]])]
    return all(t >= -1e-9 for t in turns) != all(t <= 1e-9 for t in turns) and abs(abs(sum(turns)) - 2 * pi) < 1e-6


@frozen
class Window:
    """A convex polygon in mm that hides what is outside, and what messages call it.

    Parameters
    ----------
    corners : N + 1 points, the last the first.
    label : such as ``the clip-path of g 'a'``.
    """

    corners: tuple[Point, ...]
    label: str

    def shows(self, chain: Chain) -> Literal["all", "some", "nothing"]:
        """How much of a chain is inside, as far as the window's edges, taken one by one, show."""
        area = sum(u * y - v * x for (u, v), (x, y) in pairwise(self.corners))
        size = max(hypot(x - u, y - v) for (u, v), (x, y) in pairwise(self.corners))
        whole, outside = True, False
        for (u, v), (x, y) in pairwise(self.corners):
            side = hypot(x - u, y - v) * (1 if area > 0 else -1)
            if side == 0:
                continue
            outward = ((y - v) / side, (u - x) / side)
            edge = outward[0] * u + outward[1] * v
            outside = outside or -reach(chain, (-outward[0], -outward[1])) >= edge - ON_EDGE * size
            whole = whole and reach(chain, outward) <= edge + ON_EDGE * size
        return "all" if whole else "nothing" if outside else "some"


def reach(chain: Chain, direction: Point) -> float:
    """How far a chain reaches in a direction (a unit vector): the largest product with one of its points."""
    nx, ny = direction
    farthest = max(nx * x + ny * y for x, y in chain.points)
    for k, bulge in enumerate(chain.bulges):
        if bulge:
            (u, v), (x, y) = chain.points[k], chain.points[k + 1]
            # Centre and radius of an arc of bulge b over a chord: half the chord times (1 - b²) / 2b and (1 + b²) / 2b.
            off, radius = (1 - bulge * bulge) / (4 * bulge), hypot(x - u, y - v) * (1 + bulge * bulge) / abs(4 * bulge)
            top = ((u + x) / 2 - off * (y - v) + nx * radius, (v + y) / 2 + off * (x - u) + ny * radius)
            # A counter-clockwise arc is what lies right of its chord.
            if bulge * ((x - u) * (top[1] - v) - (y - v) * (top[0] - u)) < 0:
                farthest = max(farthest, nx * top[0] + ny * top[1])
    return farthest
