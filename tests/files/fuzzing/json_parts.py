"""Parts in JSON that are nearly right: values replaced, moved and repeated, and outlines that cost much to check."""

from __future__ import annotations

import json
import random
from math import cos, pi, sin
from typing import Any

__all__ = ["make_json_part"]

VALUES: tuple[Any, ...] = (
    *(
        None,
        True,
        "",
        "mm",
        "inch",
        "x" * 3000,
        [],
        {},
        [[]],
        -1,
        0,
        0.5,
        1e9,
        -1e308,
        1e308,
        1e-300,
        10**400,
    ),
    *([0, 0, 0], {"units": "mm"}, "\x1b]0;x\x07"),
)


def make_json_part(chance: random.Random) -> bytes:
    """A part of a few loops, up to three of its values replaced, its text cut short now and then."""
    content: Any = {"name": "p", "units": chance.choice(("mm", "mm", "inch")), "loops": [outline(chance)]}
    for _ in range(chance.randrange(3)):
        x, y, radius = chance.uniform(-20, 20), chance.uniform(-20, 20), chance.uniform(0.1, 9)
        content["loops"].append([[x - radius, y, 1], [x + radius, y, chance.choice((1, 1, -1, 0.5))]])
    if chance.random() < 0.2:
        content["departure"] = chance.choice((0, 0.01, -1, 1e308, "x"))
    if chance.random() < 0.1:
        content = {
            "format": "workhold-result/1",
            "workpiece": content,
            "fixtures": [],
            "solid": chance.choice((None, {})),
        }
    for _ in range(chance.choice((0, 1, 1, 2, 3))):
        container, key = chance.choice(places_in(content))
        if chance.random() < 0.7:
            container[key] = chance.choice(VALUES)
        elif isinstance(container, list):
            container.insert(key, container[key])
        else:
            del container[key]
    text = json.dumps(content)
    if chance.random() < 0.05:
        text = text[: chance.randrange(len(text) + 1)]
    if chance.random() < 0.05:
        text = text.replace("[", "[" * 2000, 1)
    return text.encode("utf-8", "replace")


def outline(chance: random.Random) -> list[Any]:
    """A rectangle, a circle as chords, or a comb whose teeth lie side by side at a slant."""
    match chance.randrange(3):
        case 0:
            bulge = chance.choice((0, 0.2, -0.1, 1e-12, 40))
            return [[-40, -30, bulge], [40, -30, 0], [40, 30, 0], [-40, 30, 0]]
        case 1:
            sides, size = chance.choice((5, 16, 57, 400)), chance.choice((1, 30, 1e5))
            return [[size * cos(2 * pi * k / sides), size * sin(2 * pi * k / sides), 0] for k in range(sides)]
        case _:
            teeth = chance.choice((3, 50, 400))
            slanted = [[0.1 * k + 50 * (k % 2), -0.1 * k + 50 * (k % 2), 0] for k in range(2 * teeth)]
            low = -0.2 * teeth - 60
            return [*slanted, [0.2 * teeth + 60, low + 60, 0], [0.2 * teeth + 60, low, 0], [-10, low, 0]]


def places_in(value: Any) -> list[tuple[Any, Any]]:
    """Every (container, key) in nested dictionaries and lists."""
    found: list[tuple[Any, Any]] = []
    if isinstance(value, dict | list):
        for key in list(value) if isinstance(value, dict) else range(len(value)):
            found += [(value, key), *places_in(value[key])]
    return found
