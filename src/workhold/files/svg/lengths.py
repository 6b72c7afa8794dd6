"""Numbers, lengths and angles of SVG attributes and CSS properties, and an element with its geometry."""

from __future__ import annotations

import re
from math import hypot, isfinite, pi, sqrt
from xml.etree.ElementTree import Element

from attrs import frozen

from workhold.errors import InputError
from workhold.files.svg.cascade import GEOMETRY, Declared
from workhold.files.svg.document import short

__all__ = ["ANGLES", "NUMBER", "ShapeElement", "Viewport", "absolute", "millimetres", "numbers", "physical"]

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
LENGTH = re.compile(rf"\s*({NUMBER})([a-zA-Z]*|%)\s*$")
NUMBERS = re.compile(rf"\s*(?:(?>{NUMBER})\s*(?:,\s*(?=[-+.\d]))?)*+\s*$")
# CSS Values 4, 6.2: 96 px to the inch.
PIXELS = {"": 1.0, "px": 1.0, "in": 96.0, "cm": 96 / 2.54, "mm": 96 / 25.4, "q": 96 / 101.6, "pt": 96 / 72, "pc": 16.0}
ANGLES = {"deg": pi / 180, "rad": 1.0, "grad": pi / 200, "turn": 2 * pi}
HEIGHTS = {"y", "height", "cy", "ry", "y1", "y2"}

# Width and height of what percentages are of, in user units; None where they are not known.
Viewport = tuple[float | None, float | None]


def absolute(text: str, *, unitless: bool = True) -> float | None:
    """A length in user units of CSS pixels; None unless it is a number with an absolute unit, or with none."""
    match = LENGTH.match(text)
    if match is None or match.group(2).lower() not in PIXELS:
        return None
    value = float(match.group(1)) * PIXELS[match.group(2).lower()]
    return None if not isfinite(value) or (value and not match.group(2) and not unitless) else value


def millimetres(text: str) -> float | None:
    """A length in mm; None unless it is a number with an absolute unit, or with none."""
    value = absolute(text)
    return None if value is None else value * 25.4 / 96


def physical(text: str) -> bool:
    """Whether a length is in a unit of paper, not in pixels."""
    match = LENGTH.match(text)
    return match is not None and match.group(2).lower() in PIXELS and match.group(2).lower() not in ("", "px")


def numbers(text: str, what: str) -> list[float]:
    """All numbers of a list separated by blanks and commas.

    Raises
    ------
    InputError
        For anything else in the list.
    """
    if not NUMBERS.match(text):
        raise InputError(f"{what} '{short(text)}' is not a list of numbers: correct it.")
    values = [float(word) for word in re.findall(NUMBER, text)]
    if not all(map(isfinite, values)):
        raise InputError(f"{what} '{short(text)}' has a number that is too large: correct it.")
    return values


@frozen
class ShapeElement:
    """An element as its shape sees it.

    Parameters
    ----------
    element : what has the attributes.
    label : what messages call it.
    declarations : its declared values.
    viewport : what percentages are of.
    closed : whether only its fill is seen, which closes open subpaths.
    """

    element: Element
    label: str
    declarations: dict[str, list[Declared]]
    viewport: Viewport
    closed: bool = False

    def given(self, name: str) -> Declared | None:
        """The value of a geometry property or attribute; None when there is none."""
        if name in GEOMETRY:
            return self.declarations[name][0] if name in self.declarations else None
        text = self.element.get(name)
        return None if text is None else Declared(text.strip(), css=False)

    def length(self, name: str, default: float = 0.0) -> float:
        """A length in user units.

        Raises
        ------
        InputError
            For anything but a number with an absolute unit, or percents of a viewport that is known.
        """
        given = self.given(name)
        if given is None or given.text in ("auto", "initial"):
            return default
        value = absolute(given.text, unitless=not given.css)
        if value is None and given.text.endswith("%"):
            value = self.percent(given.text, name)
        if value is None:
            raise InputError(
                f'{self.label} has {name}="{short(given.text)}", which is not a plain length: write a number'
                f"{' with px' if given.css else ''}."
            )
        return value

    def percent(self, text: str, name: str) -> float | None:
        """Percents of the viewport in user units (SVG 2, 8.9); None when the viewport is not known."""
        width, height = self.viewport
        match = LENGTH.match(text)
        if name == "r":
            side = None if width is None or height is None else hypot(width, height) / sqrt(2)
        else:
            side = height if name in HEIGHTS else width
        return None if match is None or side is None else float(match.group(1)) / 100 * side
