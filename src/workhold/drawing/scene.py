"""A page of SVG: typeface, lengths in words, the map from millimetres to the page, and shapes.
Glossary
--------
page unit : a quarter of a millimetre on A4 paper; a page is 1188 by 840 units, or 840 by 1188. Line widths
    and text sizes are page units, so a part of half a millimetre and one of two metres look alike. y runs
    down the page.
model : a frame in millimetres whose y runs up: the vise frame, or that of the workpiece.
view : the map from a model frame to the page, a scale and a shift.
"""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from bisect import bisect_right
from collections.abc import Sequence
from functools import cache, lru_cache
from math import atan2, cos, hypot, log10, sin
from pathlib import Path

from attrs import frozen

from workhold.errors import make_printable
from workhold.geometry.segment import Box, Point
from workhold.units import MILLIMETRE, Unit

__all__ = [
    "BLACK",
    "FAMILY",
    "GREY",
    "LANDSCAPE",
    "PORTRAIT",
    "UNITS_PER_MM",
    "Box",
    "LengthUnit",
    "Scene",
    "View",
    "format_degrees",
    "list_font_files",
    "has_character",
    "format_number",
    "shorten_text",
    "measure_text",
    "wrap_text",
]

FAMILY = "DejaVu Sans, Verdana, Arial, sans-serif"

FOLDER = Path(__file__).resolve().parent.parent / "data" / "fonts"

# Width in ems given to a character the bundled typeface does not have.
UNKNOWN_WIDTH = 1.0


def format_degrees(turn: float, decimals: int) -> str:
    """Return a turn in degrees as text with ``decimals`` decimals and the sign °.

    It has a true minus sign (−) and no negative zero.

    >>> format_degrees(-0.31, 1), format_degrees(-0.01, 1)
    ('−0.3°', '0.0°')
    """
    return f"{turn:z.{decimals}f}°".replace("-", "−")


def list_font_files() -> list[str]:
    """Return the paths of the bundled fonts, regular and bold."""
    return [str(FOLDER / "DejaVuSans.ttf"), str(FOLDER / "DejaVuSans-Bold.ttf")]


@cache
def load_advance_widths() -> dict[str, dict[str, float]]:
    """Return the width in ems of every character of the bundled typeface, by weight ("regular", "bold")."""
    widths: dict[str, dict[str, float]] = json.loads(
        (FOLDER / "advance_widths.json").read_text(encoding="ascii")
    )
    return widths


@lru_cache(maxsize=1 << 14)
def measure_text(content: str, size: float, bold: bool = False) -> float:
    """Return the width of a line of text in page units, for a font size in page units.

    >>> measure_text("i", 10) < measure_text("W", 10) < measure_text("W", 10, bold=True)
    True
    """
    widths = load_advance_widths()["bold" if bold else "regular"]
    return size * sum(widths.get(character, UNKNOWN_WIDTH) for character in content)


def has_character(character: str) -> bool:
    """Return whether the bundled typeface has a glyph for a character.

    >>> has_character("Ø"), has_character("樂")
    (True, False)
    """
    return character in load_advance_widths()["regular"]


def shorten_text(content: str, size: float, width: float, bold: bool = False) -> str:
    """Return the text, cut off and with an ellipsis at its end where it is wider than ``width`` page units.

    >>> shorten_text("a plate", 10, 200), shorten_text("a very long plate", 10, 50)
    ('a plate', 'a very l…')
    """
    if measure_text(content, size, bold) <= width:
        return content
    return content[: count_fitting_letters(content, size, width, bold, "…")].rstrip() + "…"


def count_fitting_letters(content: str, size: float, width: float, bold: bool, behind: str = "") -> int:
    """Return the number of letters from the start of ``content`` that, followed by ``behind``, fit in
    ``width`` page units.

    Takes little time even for a long text.
    """
    most = 1
    while most < len(content) and measure_text(content[:most] + behind, size, bold) <= width:
        most *= 2
    return bisect_right(
        range(1, min(most, len(content)) + 1),
        width,
        key=lambda count: measure_text(content[:count] + behind, size, bold),
    )


def wrap_text(content: str, size: float, width: float, bold: bool = False) -> list[str]:
    """Return the text as lines no wider than ``width`` page units, broken at
    spaces, or inside words that are too long.

    >>> wrap_text("a plate with holes", 10, 50)
    ['a plate', 'with', 'holes']
    """
    lines: list[str] = []
    for word in content.split():
        if lines and measure_text(f"{lines[-1]} {word}", size, bold) <= width:
            lines[-1] += f" {word}"
            continue
        while len(word) > 1 and measure_text(word, size, bold) > width:
            cut = max(1, min(len(word) - 1, count_fitting_letters(word, size, width, bold)))
            lines.append(word[:cut])
            word = word[cut:]
        lines.append(word)
    return lines


LANDSCAPE = (1188.0, 840.0)
PORTRAIT = (840.0, 1188.0)
UNITS_PER_MM = 4.0

BLACK = "#1a1a1a"
GREY = "#5f6670"

# Height of capitals and figures of the typeface, in ems.
CAP_HEIGHT = 0.729

SVG_NAMESPACE = "http://www.w3.org/2000/svg"

Attributes = dict[str, str]


def format_number(value: float) -> str:
    """Return a page coordinate as text with at most three decimals, without trailing zeros or negative zero.

    >>> format_number(2.0), format_number(-0.0001), format_number(1.23456)
    ('2', '0', '1.235')
    """
    text = f"{value:.3f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def choose_decimals(length: float) -> int:
    """Return the number of decimals for dimensions in mm where ``length`` mm is
    typical: three, more for tiny parts.

    >>> choose_decimals(10.0), choose_decimals(0.05)
    (3, 5)
    """
    return max(3, 3 - int(log10(length) // 1)) if length < 1 else 3


@frozen
class View:
    """The map (x, y) -> (left + scale x, top - scale y) from mm to page units."""

    scale: float
    left: float
    top: float

    @classmethod
    def fit_box(cls, model: Box, page: Box, scale: float | None = None) -> View:
        """Return the view that centres a model box (mm) in a page box.

        Its scale is the largest at which the model box fits, or ``scale`` in page units per mm if given.
        """
        if scale is None:
            scale = min(page.width / model.width, page.height / model.height)
        (mx, my), (px, py) = model.center, page.center
        return cls(scale, px - scale * mx, py + scale * my)

    def __call__(self, point: Point) -> Point:
        """Return the page point of a model point in mm."""
        return self.left + self.scale * point[0], self.top - self.scale * point[1]

    def map_box(self, model: Box) -> Box:
        """Return the page box of a model box in mm."""
        (x0, y1), (x1, y0) = self((model.x0, model.y0)), self((model.x1, model.y1))
        return Box(x0, y0, x1, y1)

    @property
    def matrix(self) -> str:
        """The map as an SVG ``matrix(a b c d e f)``."""
        return f"matrix({self.scale:.12g} 0 0 {-self.scale:.12g} {self.left:.12g} {self.top:.12g})"


class Scene:
    """An SVG page, or a group within one, to which shapes are added in page units.

    Parameters
    ----------
    element : the SVG element to which shapes are added.
    """

    def __init__(self, element: ET.Element) -> None:
        self.element = element

    @classmethod
    def make_page(cls, size: tuple[float, float], title: str) -> Scene:
        """Return an empty white page; ``title`` is for screen readers and window titles."""
        width, height = size
        root = ET.Element(
            "svg",
            {
                "xmlns": SVG_NAMESPACE,
                "width": f"{format_number(width / UNITS_PER_MM)}mm",
                "height": f"{format_number(height / UNITS_PER_MM)}mm",
                "viewBox": f"0 0 {format_number(width)} {format_number(height)}",
                "font-family": FAMILY,
                "fill": "none",
                "stroke-linejoin": "round",
            },
        )
        ET.SubElement(root, "title").text = make_printable(title)
        scene = cls(root)
        scene.add(
            "rect",
            {"width": format_number(width), "height": format_number(height), "fill": "#ffffff"},
        )
        return scene

    def to_svg(self) -> str:
        """Return the page as SVG text, marked by a comment as workhold's own (see ``cli.outputs``)."""
        ET.indent(self.element, " ")
        return (
            '<?xml version="1.0" encoding="UTF-8"?>\n<!-- workhold -->\n'
            + ET.tostring(self.element, encoding="unicode")
            + "\n"
        )

    def add(
        self, tag: str, attributes: Attributes, stroke: str = "none", width: float = 1.0, **more: str
    ) -> ET.Element:
        """Add an SVG element and return it.

        Further attributes are given in ``more``, with ``_`` in their names for ``-``. ``attributes`` may be
        changed in place.
        """
        if stroke != "none":
            attributes |= {"stroke": stroke, "stroke-width": format_number(width)}
        attributes |= {key.replace("_", "-"): value for key, value in more.items()}
        return ET.SubElement(self.element, tag, attributes)

    def group(self, name: str, view: View | None = None, **attributes: str) -> Scene:
        """Add a group of the class ``name`` and return it as a scene.

        With a view, its attribute ``data-model-to-page`` holds the map from mm.
        """
        element = self.add("g", {"class": name}, "none", 1.0, **attributes)
        if view is not None:
            element.set("data-model-to-page", view.matrix)
        return Scene(element)

    def add_path(
        self, d: str, stroke: str = "none", width: float = 1.0, fill: str = "none", **more: str
    ) -> ET.Element:
        """Add a path with SVG path data ``d`` in page units."""
        return self.add("path", {"d": d, "fill": fill}, stroke, width, **more)

    def add_line(
        self, points: Sequence[Point], stroke: str = BLACK, width: float = 1.0, **more: str
    ) -> ET.Element:
        """Add an open polyline through page points."""
        return self.add_path(
            "M" + "L".join(f"{format_number(x)} {format_number(y)}" for x, y in points),
            stroke,
            width,
            **more,
        )

    def add_polygon(
        self, points: Sequence[Point], fill: str, stroke: str = "none", width: float = 1.0
    ) -> ET.Element:
        """Add a closed polygon through page points."""
        d = "M" + "L".join(f"{format_number(x)} {format_number(y)}" for x, y in points) + "Z"
        return self.add_path(d, stroke, width, fill)

    def add_rectangle(
        self, box: Box, fill: str, stroke: str = "none", width: float = 1.0, round_by: float = 0.0
    ) -> ET.Element:
        """Add a rectangle; ``round_by`` is the radius of its corners."""
        attributes = {
            "x": format_number(box.x0),
            "y": format_number(box.y0),
            "width": format_number(box.width),
            "height": format_number(box.height),
            "fill": fill,
        }
        if round_by:
            attributes["rx"] = format_number(round_by)
        return self.add("rect", attributes, stroke, width)

    def add_circle(
        self,
        center: Point,
        radius: float,
        fill: str = "none",
        stroke: str = "none",
        width: float = 1.0,
        **more: str,
    ) -> ET.Element:
        """Add a circle with centre and radius in page units."""
        attributes = {
            "cx": format_number(center[0]),
            "cy": format_number(center[1]),
            "r": format_number(radius),
            "fill": fill,
        }
        return self.add("circle", attributes, stroke, width, **more)

    def add_text(
        self,
        at: Point,
        content: str,
        size: float,
        anchor: str = "start",
        bold: bool = False,
        fill: str = BLACK,
        halo: float = 0.0,
        middle: bool = True,
        turned: float = 0.0,
    ) -> ET.Element:
        """Add a line of text.

        Parameters
        ----------
        at : page point of the text.
        anchor : which point of the text is at ``at``: its "start", "middle" or "end".
        size : font size in page units.
        halo : width of a white rim that keeps it readable over lines, in page units.
        middle : whether ``at`` is at half the height of the figures; otherwise it is on the baseline.
        turned : degrees counter-clockwise.
        """
        x, y = at[0], at[1] + (CAP_HEIGHT * size / 2 if middle else 0.0)
        attributes = {
            "x": format_number(x),
            "y": format_number(y),
            "font-size": format_number(size),
            "fill": fill,
        }
        if anchor != "start":
            attributes["text-anchor"] = anchor
        if bold:
            attributes["font-weight"] = "bold"
        if halo:
            attributes |= {
                "stroke": "#ffffff",
                "stroke-width": format_number(2 * halo),
                "paint-order": "stroke",
            }
        if turned:
            attributes["transform"] = (
                f"rotate({format_number(-turned)} {format_number(at[0])} {format_number(at[1])})"
            )
        element = self.add("text", attributes)
        element.text = make_printable(content)
        return element

    def add_arrow(
        self, tail: Point, tip: Point, stroke: str = BLACK, width: float = 1.0, head: float = 8.0
    ) -> None:
        """Add an arrow from tail to tip; ``head`` is the length of its head, shortened on a shorter arrow."""
        dx, dy = tip[0] - tail[0], tip[1] - tail[1]
        length = hypot(dx, dy)
        head = min(head, length) if length > 0 else head
        if length > 0:
            neck = (tip[0] - 0.9 * head * dx / length, tip[1] - 0.9 * head * dy / length)
            self.add_line([tail, neck], stroke, width)
        self.add_arrow_head(tip, atan2(dy, dx), stroke, head)

    def add_arrow_head(self, tip: Point, angle: float, fill: str, length: float) -> None:
        """Add an arrow head that points along ``angle`` (radians on the page, y down)."""
        c, s = cos(angle), sin(angle)
        half = 0.34 * length
        back = (tip[0] - length * c, tip[1] - length * s)
        self.add_polygon(
            [tip, (back[0] - half * s, back[1] + half * c), (back[0] + half * s, back[1] - half * c)], fill
        )


@frozen
class LengthUnit:
    """The unit and the decimals of lengths in a picture.

    Examples
    --------
    >>> from workhold.units import INCH
    >>> mm, inch = LengthUnit.in_mm(), LengthUnit.from_typical_length(INCH, 10.0)
    >>> mm.format_length(24.125), inch.format_length(-25.4), mm.format_number(-0.0)
    ('24.125 mm', '−1.0000 in', '0.000')
    """

    unit: Unit
    decimals: int

    @classmethod
    def in_mm(cls, decimals: int = MILLIMETRE.decimals) -> LengthUnit:
        """Return the unit millimetre with this number of decimals."""
        return cls(MILLIMETRE, decimals)

    @classmethod
    def from_typical_length(cls, unit: Unit, length: float) -> LengthUnit:
        """Return a unit with the number of decimals for a picture in which ``length`` mm is typical, such as
        the pitch.
        """
        return cls(unit, unit.decimals + choose_decimals(length) - choose_decimals(1.0))

    @property
    def sign(self) -> str:
        """The unit's abbreviation, such as "mm"."""
        return self.unit.abbreviation

    def format_number(self, length: float) -> str:
        """Return a length in mm as text: its number in this unit, without the unit's sign.

        It has a true minus sign (−) and no negative zero.
        """
        return self.unit.format_number(length, self.decimals).replace("-", "−")

    def format_length(self, length: float) -> str:
        """Return a length in mm as text with the unit's sign, such as '24.125 mm'."""
        return f"{self.format_number(length)} {self.sign}"

    def format_short(self, length: float, digits: int = 6) -> str:
        """Return a length in mm as text with the unit's sign, without trailing zeros.

        It has at most ``digits`` significant digits; for lengths such as a pitch.

        >>> LengthUnit.in_mm().format_short(12.7), LengthUnit.in_mm().format_short(10.0)
        ('12.7 mm', '10 mm')
        """
        return f"{self.format_short_number(length, digits)} {self.sign}"

    def format_short_number(self, length: float, digits: int = 6) -> str:
        """Return a length in mm as text like :meth:`format_short`, without the unit's sign."""
        return f"{length / self.unit.millimetres:.{digits}g}"
