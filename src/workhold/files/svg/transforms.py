"""Transforms in the plane: the attribute's list (SVG 1.1, section 7.6) and CSS Transforms 1 and 2."""

from __future__ import annotations

import re
from math import cos, degrees, radians, sin, tan

from workhold.errors import InputError
from workhold.files.outline.chain import Placement
from workhold.files.svg.document import short
from workhold.files.svg.viewport import ANGLES, LARGEST, LENGTH, ShapeElement, absolute, numbers

__all__ = ["transform_of"]

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


def transform_of(figure: ShapeElement) -> Placement:
    """The map of an element's transform properties; refuses any that are not SVG's, or not in the plane."""
    declarations, label = figure.declarations, figure.label
    given = {name: declarations[name][0] for name in PROPERTIES if name in declarations}
    given = {name: one for name, one in given.items() if one.text not in ("", "none", "initial", "unset")}
    if not given:
        return Placement()
    box = declarations.get("transform-box")
    if box and box[0].text != "view-box":
        raise InputError(
            f"{label} has the transform-box '{short(box[0].text)}', which is not read: use view-box."
        )
    x, y = origin(figure)
    placement = Placement(e=x, f=y)
    for name in ("translate", "rotate", "scale"):
        if name in given:
            # The words are the function's arguments, but for commas.
            words = given[name].text.removeprefix("z ")
            placement = placement.after(functions(f"{name}({', '.join(words.split())})", True, figure))
    if "transform" in given:
        placement = placement.after(functions(given["transform"].text, given["transform"].css, figure))
    return placement.after(Placement(e=-x, f=-y))


def origin(figure: ShapeElement) -> tuple[float, float]:
    """The point that stays in place, in user units; raises InputError for places that are not read."""
    if "transform-origin" not in figure.declarations:
        return 0.0, 0.0
    given = figure.declarations["transform-origin"][0]
    text = given.text
    error = InputError(
        f"{figure.label} has the transform-origin '{short(text)}', which is not read: write two lengths."
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
        plain = absolute(word, unitless=not given.css)
        value = plain if share is None else None if side is None else share * side
        if value is None:
            raise error
        place[axis] = value
    return place[0], place[1]


def functions(text: str, css: bool, figure: ShapeElement) -> Placement:
    """The map of a list of transform functions; raises InputError for functions that are not read."""
    text, label = text.strip(), figure.label
    placement = Placement()
    position = 0
    while position < len(text):
        figure.budget.work()
        match = (CSS_FUNCTION if css else FUNCTION).match(text, position)
        step = None
        if match is not None:
            name, words = match.group(1), match.group(2)
            values = css_values(name, words) if css else numbers(words, f"{label}: transform", figure.budget)
            if values is not None and (len(values) in ATTRIBUTE.get(name, ()) or css):
                step = single_transform(name, values)
        if match is None or step is None:
            place = short(match.group(0) if match else text)
            units = ": in CSS, lengths have px, angles deg, and values commas between them" if css else ""
            raise InputError(f"{label} has the transform '{place}', which cannot be read{units}: correct it.")
        placement = placement.after(step)
        position = match.end()
    return placement


def css_values(name: str, text: str) -> list[float] | None:
    """The arguments of a CSS transform function in user units and degrees; None when one is not valid."""
    values: list[float] = []
    for word in text.split(","):
        match = LENGTH.match(word)
        if match is None or abs(float(match.group(1))) > LARGEST:
            return None
        number, unit = float(match.group(1)), match.group(2).lower()
        if number == 0 and not unit:
            value: float | None = 0.0
        elif name.startswith("translate"):
            value = absolute(word, unitless=False)
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


def single_transform(name: str, v: list[float]) -> Placement | None:
    """One transform function, angles in degrees; None when it is none."""
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
                else Placement(e=v[1], f=v[2]).after(turn).after(Placement(e=-v[1], f=-v[2]))
            )
        case "skewX", 1:
            return Placement(c=tan(radians(v[0])))
        case "skewY", 1:
            return Placement(b=tan(radians(v[0])))
        case "skew", 1 | 2:
            return Placement(c=tan(radians(v[0])), b=tan(radians(v[1])) if count == 2 else 0.0)
    return None
