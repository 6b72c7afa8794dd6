"""Transforms in the plane: the attribute ``transform`` (SVG 1.1, section 7.6) and CSS Transforms 1 and 2."""

from __future__ import annotations

import re
from math import cos, degrees, radians, sin, tan

from workhold.errors import InputError
from workhold.files.outline.chain import Placement
from workhold.files.svg.document import shorten_text
from workhold.files.svg.viewport import (
    ANGLES,
    LARGEST,
    LENGTH,
    ShapeElement,
    read_absolute_length,
    read_numbers,
)

__all__ = ["read_transform"]

FUNCTION = re.compile(r"\s*(?:,\s*)?(\w+)\s*\(([^()]*)\)")
CSS_FUNCTION = re.compile(r"\s*(\w+)\(([^()]*)\)")
PROPERTIES = ("transform", "translate", "rotate", "scale")
SIDES = {"left": (0, 0.0), "right": (0, 1.0), "top": (1, 0.0), "bottom": (1, 1.0)}
# Functions of the attribute, and how many arguments they have.
ATTRIBUTE = {
    "matrix": (6,),
    "translate": (1, 2),
    "scale": (1, 2),
    "rotate": (1, 3),
    "skewX": (1,),
    "skewY": (1,),
}


def read_transform(figure: ShapeElement) -> Placement:
    """Return the map of an element's transform properties, from its coordinates to those around it.

    Raises InputError for values that cannot be read, or are not in the plane.
    """
    declarations, label = figure.declarations, figure.label
    given = {name: declarations[name][0] for name in PROPERTIES if name in declarations}
    given = {name: one for name, one in given.items() if one.text not in ("", "none", "initial", "unset")}
    if not given:
        return Placement()
    box = declarations.get("transform-box")
    if box and box[0].text != "view-box":
        raise InputError(
            f"{label} has the transform-box '{shorten_text(box[0].text)}', which is not read: use view-box."
        )
    x, y = read_transform_origin(figure)
    placement = Placement(e=x, f=y)
    for name in ("translate", "rotate", "scale"):
        if name in given:
            # The words are the function's arguments, but for commas.
            words = given[name].text.removeprefix("z ")
            placement = placement.compose_after(
                parse_transform_functions(f"{name}({', '.join(words.split())})", True, figure)
            )
    if "transform" in given:
        placement = placement.compose_after(
            parse_transform_functions(given["transform"].text, given["transform"].css, figure)
        )
    return placement.compose_after(Placement(e=-x, f=-y))


def read_transform_origin(figure: ShapeElement) -> tuple[float, float]:
    """Return the fixed point (x, y) of an element's transforms,
    in user units; raise InputError for unsupported values.
    """
    if "transform-origin" not in figure.declarations:
        return 0.0, 0.0
    given = figure.declarations["transform-origin"][0]
    text = given.text
    error = InputError(
        f"{figure.label} has the transform-origin '{shorten_text(text)}', which is not read: write two lengths."
    )
    words = text.lower().split()
    if words in (["initial"], ["unset"]):
        return 0.0, 0.0
    if len(words) == 1:
        words = ["center", *words] if words[0] in ("top", "bottom") else [*words, "center"]
    if len(words) > 1 and (words[0] in ("top", "bottom") or words[1] in ("left", "right")):
        words[:2] = words[1::-1]
    if len(words) not in (2, 3):
        raise error
    place = [0.0, 0.0]
    for axis, word in enumerate(words[:2]):
        if SIDES.get(word, (axis, 0))[0] != axis:
            raise error
        share = SIDES[word][1] if word in SIDES else 0.5 if word == "center" else None
        if share is None and word.endswith("%") and LENGTH.match(word):
            share = float(word[:-1]) / 100
        side = figure.viewport[axis]
        plain = read_absolute_length(word, unitless=not given.css)
        value = plain if share is None else None if side is None else share * side
        if value is None:
            raise error
        place[axis] = value
    return place[0], place[1]


def parse_transform_functions(text: str, css: bool, figure: ShapeElement) -> Placement:
    """Return the map of a list of transform functions; the last one is applied first.

    ``css`` selects CSS's grammar instead of that of the attribute ``transform``. Raises InputError for
    functions that are not supported.
    """
    text, label = text.strip(), figure.label
    placement = Placement()
    position = 0
    while position < len(text):
        figure.budget.count_steps()
        match = (CSS_FUNCTION if css else FUNCTION).match(text, position)
        step = None
        if match is not None:
            name, words = match.group(1), match.group(2)
            values = (
                read_css_arguments(name, words)
                if css
                else read_numbers(words, f"{label}: transform", figure.budget)
            )
            if values is not None and (len(values) in ATTRIBUTE.get(name, ()) or css):
                step = make_single_transform(name, values)
        if match is None or step is None:
            place = shorten_text(match.group(0) if match else text)
            units = ": in CSS, lengths have px, angles deg, and values commas between them" if css else ""
            raise InputError(f"{label} has the transform '{place}', which cannot be read{units}: correct it.")
        placement = placement.compose_after(step)
        position = match.end()
    return placement


def read_css_arguments(name: str, text: str) -> list[float] | None:
    """Return the arguments of a CSS transform function in user units and
    degrees; None when one of them is not valid.
    """
    values: list[float] = []
    for word in text.split(","):
        match = LENGTH.match(word)
        if match is None or abs(float(match.group(1))) > LARGEST:
            return None
        number, unit = float(match.group(1)), match.group(2).lower()
        if number == 0 and not unit:
            value: float | None = 0.0
        elif name.startswith("translate"):
            value = read_absolute_length(word, unitless=False)
        elif name.startswith(("rotate", "skew")):
            value = number * degrees(ANGLES[unit]) if unit in ANGLES else None
        elif name.startswith("scale") and unit == "%":
            value = number / 100
        else:
            value = None if unit else number
        if value is None:
            return None
        values.append(value)
    return None if name == "rotate" and len(values) != 1 else values


def make_single_transform(name: str, v: list[float]) -> Placement | None:
    """Return the map of one transform function, with angles in degrees; None if there is no such function."""
    count = len(v)
    match name, count:
        case "matrix", 6:
            return Placement(*v)
        case ("translate", 1 | 2) | ("translateX", 1):
            return Placement(e=v[0], f=v[1] if count == 2 else 0.0)
        case "translateY", 1:
            return Placement(f=v[0])
        case "scale", 1 | 2:
            return Placement(a=v[0], d=v[-1])
        case "scaleX", 1:
            return Placement(a=v[0])
        case "scaleY", 1:
            return Placement(d=v[0])
        case "rotate", 1 | 3:
            c, s = cos(radians(v[0])), sin(radians(v[0]))
            turn = Placement(c, s, -s, c)
            return (
                turn
                if count == 1
                else Placement(e=v[1], f=v[2]).compose_after(turn).compose_after(Placement(e=-v[1], f=-v[2]))
            )
        case "skewX", 1:
            return Placement(c=tan(radians(v[0])))
        case "skewY", 1:
            return Placement(b=tan(radians(v[0])))
        case "skew", 1 | 2:
            return Placement(c=tan(radians(v[0])), b=tan(radians(v[1])) if count == 2 else 0.0)
    return None
