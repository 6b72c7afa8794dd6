"""Numbers, lengths and angles of SVG, and the viewports in which they are measured.

They are given by attributes and CSS properties of an element. A drawing, a nested drawing or a symbol has a
viewport with its ``viewBox``, and a window that cuts off what is outside.

Glossary
--------
viewport : the width and height in user units that percentages of lengths refer to.
window : a convex polygon that hides what is outside: the edge of a nested drawing or of a symbol, or a clip
    path.
"""

from __future__ import annotations

import re
from itertools import pairwise
from math import atan2, hypot, pi, sqrt
from typing import Literal
from xml.etree.ElementTree import Element

from attrs import frozen

from workhold.errors import InputError
from workhold.files.budget import Budget
from workhold.files.outline.chain import Chain, Placement
from workhold.files.svg.document import GEOMETRY, DeclaredValue, shorten_text
from workhold.geometry.segment import Point

__all__ = [
    "ANGLES",
    "LARGEST",
    "LENGTH",
    "NUMBER",
    "ShapeElement",
    "ViewBox",
    "Viewport",
    "ClipPolygon",
    "read_absolute_length",
    "is_convex",
    "fit_viewbox",
    "read_numbers",
    "is_physical_length",
    "read_viewbox",
]

# Without ways back, so that no text takes longer than its length.
NUMBER = r"(?>[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
LENGTH = re.compile(rf"\s*({NUMBER})([a-zA-Z]*|%)\s*$")
LISTED = re.compile(rf"\s*({NUMBER})\s*(?:,\s*(?=[-+.0-9]))?")
# Numbers of a drawing beyond this are none: products of a few are still numbers of the computer.
LARGEST = 1e30
# CSS Values 4, 6.2: 96 px to the inch.
PIXELS = {
    "": 1.0,
    "px": 1.0,
    "in": 96.0,
    "cm": 96 / 2.54,
    "mm": 96 / 25.4,
    "q": 96 / 101.6,
    "pt": 96 / 72,
    "pc": 16.0,
}
ANGLES = {"deg": pi / 180, "rad": 1.0, "grad": pi / 200, "turn": 2 * pi}
HEIGHTS = {"y", "height", "cy", "ry", "y1", "y2"}

# Width and height of what percentages are of, in user units; None where they are not known.
Viewport = tuple[float | None, float | None]


def read_absolute_length(text: str, *, unitless: bool = True) -> float | None:
    """Return a length in CSS pixels; None unless it is a number with an absolute unit.

    A number without a unit counts as pixels, but only 0 does where ``unitless`` is False.
    """
    match = LENGTH.match(text)
    if match is None or match.group(2).lower() not in PIXELS:
        return None
    value = float(match.group(1)) * PIXELS[match.group(2).lower()]
    return None if abs(value) > LARGEST or (value and not match.group(2) and not unitless) else value


def is_physical_length(text: str) -> bool:
    """Return whether a length is in a unit of paper, such as mm, not in pixels."""
    match = LENGTH.match(text)
    return match is not None and match.group(2).lower() in PIXELS and match.group(2).lower() not in ("", "px")


def read_numbers(text: str, what: str, budget: Budget) -> list[float]:
    """Return all numbers of a list separated by blanks and commas.

    Raises InputError for anything else, for numbers that are too large, and for more numbers than ``budget``
    allows; ``what`` begins the message.
    """
    values: list[float] = []
    text, position = text.rstrip(), 0
    while position < len(text):
        match = LISTED.match(text, position)
        if match is None:
            raise InputError(f"{what} '{shorten_text(text)}' is not a list of numbers: correct it.")
        values.append(float(match.group(1)))
        position = match.end()
        if len(values) % budget.PERIOD == 0:
            budget.spend(budget.PERIOD // 2)
    if not all(abs(value) <= LARGEST for value in values):
        raise InputError(f"{what} '{shorten_text(text)}' has a number that is too large: correct it.")
    return values


@frozen
class ShapeElement:
    """An element with all that is needed to read its shape.

    Parameters
    ----------
    element : the element, with its attributes.
    label : its name for messages.
    declarations : its declared values.
    viewport : the size that percentages refer to.
    budget : work that may still be spent on the drawing.
    """

    element: Element
    label: str
    declarations: dict[str, list[DeclaredValue]]
    viewport: Viewport
    budget: Budget

    def find_given_value(self, name: str) -> DeclaredValue | None:
        """Return the strongest value of a geometry property, or an attribute; None when there is none."""
        if name in GEOMETRY:
            return self.declarations[name][0] if name in self.declarations else None
        text = self.element.get(name)
        return None if text is None else DeclaredValue(text.strip(), css=False)

    def read_length(self, name: str, default: float = 0.0) -> float:
        """Return a length in user units, ``default`` where it is not given.

        Raises
        ------
        InputError
            For anything but a number with an absolute unit, or percents of a viewport that is known.
        """
        given = self.find_given_value(name)
        if given is None or given.text in ("auto", "initial"):
            return default
        value = read_absolute_length(given.text, unitless=not given.css)
        if value is None and given.text.endswith("%"):
            value = self.read_percentage(given.text, name)
        if value is None:
            raise InputError(
                f'{self.label} has {name}="{shorten_text(given.text)}", which is not a plain length: write a number'
                f"{' with px' if given.css else ''}."
            )
        return value

    def read_percentage(self, text: str, name: str) -> float | None:
        """Return a percentage of the viewport in user units
        (SVG 2, 8.9); None when the viewport is not known.
        """
        width, height = self.viewport
        match = LENGTH.match(text)
        if name == "r":
            side = None if width is None or height is None else hypot(width, height) / sqrt(2)
        else:
            side = height if name in HEIGHTS else width
        value = None if match is None or side is None else float(match.group(1)) / 100 * side
        return value if value is not None and abs(value) <= LARGEST else None


# A window's edge and an outline on it, relative to the window's size, may differ by the rounding of a
# drawing's digits.
ON_EDGE = 1e-6

ViewBox = tuple[float, float, float, float]
ALIGNMENT = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
ASPECT = re.compile(r"x(Min|Mid|Max)Y(Min|Mid|Max)(?: (meet|slice))?$")


def read_viewbox(text: str | None, label: str, budget: Budget) -> ViewBox | None:
    """Return the left, top, width and height of a viewBox; None when there is none.

    Raises InputError for one that is not four numbers with a positive size.
    """
    if text is None:
        return None
    values = read_numbers(text, f"the viewBox of {label}", budget)
    if len(values) != 4 or not (values[2] > 0 and values[3] > 0):
        raise InputError(
            f"the viewBox '{shorten_text(text)}' of {label} is not usable: it must be x y width height."
        )
    return values[0], values[1], values[2], values[3]


def fit_viewbox(box: ViewBox, width: float, height: float, aspect: str, label: str) -> Placement:
    """Return the map from a viewBox to a viewport at the origin (SVG 2, 8.2).

    ``width`` and ``height`` are the viewport's, ``aspect`` is the text of ``preserveAspectRatio``. Raises
    InputError if that text cannot be read.
    """
    words = aspect.removeprefix("defer").split() or ["xMidYMid"]
    sx, sy = width / box[2], height / box[3]
    if words[0] == "none":
        return Placement(a=sx, d=sy, e=-sx * box[0], f=-sy * box[1])
    match = ASPECT.match(" ".join(words))
    if match is None:
        raise InputError(
            f"{label} has the preserveAspectRatio '{shorten_text(aspect)}', which cannot be read: correct it."
        )
    scale = max(sx, sy) if match[3] == "slice" else min(sx, sy)
    left = ALIGNMENT[match[1]] * (width - scale * box[2])
    top = ALIGNMENT[match[2]] * (height - scale * box[3])
    return Placement(a=scale, d=scale, e=left - scale * box[0], f=top - scale * box[1])


def is_convex(points: tuple[Point, ...]) -> bool:
    """Return whether a closed polygon, its first point
    repeated at its end, is convex and does not cross itself.
    """
    steps = [(x - u, y - v) for (u, v), (x, y) in pairwise(points) if (x, y) != (u, v)]
    if len(steps) < 3:
        return False
    turns = [atan2(a * d - b * c, a * c + b * d) for (a, b), (c, d) in pairwise([*steps, steps[0]])]
    return (
        all(t >= -1e-9 for t in turns) != all(t <= 1e-9 for t in turns)
        and abs(abs(sum(turns)) - 2 * pi) < 1e-6
    )


@frozen
class ClipPolygon:
    """A convex polygon in mm that hides what is outside.

    Parameters
    ----------
    corners : N + 1 points in running order, the last equal to the first.
    label : name for messages, such as ``the clip-path of g 'a'``.
    """

    corners: tuple[Point, ...]
    label: str

    def classify_visibility(self, chain: Chain, budget: Budget) -> Literal["all", "some", "nothing"]:
        """Return "all", "some" or "nothing": how much of a chain is inside the polygon.

        Each edge of the polygon is tested by itself. So "some" may also be returned for a chain that is
        outside near a corner.
        """
        area = sum(u * y - v * x for (u, v), (x, y) in pairwise(self.corners))
        size = max(hypot(x - u, y - v) for (u, v), (x, y) in pairwise(self.corners))
        whole, outside = True, False
        for (u, v), (x, y) in pairwise(self.corners):
            budget.count_steps(len(chain.points))
            side = hypot(x - u, y - v) * (1 if area > 0 else -1)
            if side == 0:
                continue
            outward = ((y - v) / side, (u - x) / side)
            edge = outward[0] * u + outward[1] * v
            outside = outside or -measure_reach(chain, (-outward[0], -outward[1])) >= edge - ON_EDGE * size
            whole = whole and measure_reach(chain, outward) <= edge + ON_EDGE * size
        return "all" if whole else "nothing" if outside else "some"


def measure_reach(chain: Chain, direction: Point) -> float:
    """Return how far a chain reaches in a direction (a unit
    vector): the largest dot product with one of its points.
    """
    nx, ny = direction
    farthest = max(nx * x + ny * y for x, y in chain.points)
    for k, bulge in enumerate(chain.bulges):
        if bulge:
            (u, v), (x, y) = chain.points[k], chain.points[k + 1]
            # Centre and radius of an arc of bulge b: half the chord times (1 - b²) / 2b and (1 + b²) / 2b.
            off = (1 - bulge * bulge) / (4 * bulge)
            radius = hypot(x - u, y - v) * (1 + bulge * bulge) / abs(4 * bulge)
            top = ((u + x) / 2 - off * (y - v) + nx * radius, (v + y) / 2 + off * (x - u) + ny * radius)
            # A counter-clockwise arc is what lies right of its chord.
            if bulge * ((x - u) * (top[1] - v) - (y - v) * (top[0] - u)) < 0:
                farthest = max(farthest, nx * top[0] + ny * top[1])
    return farthest
