"""Reads setup sheets back: the boxes of all words, where holes are named, and how words may collide."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import combinations
from math import hypot

from svg_reading import NAMESPACE

from workhold.drawing.scene import CAP_HEIGHT, Box, measure_text

# Two boxes of words that share no more than this, in page units, both ways, touch at most.
TOUCHING = 0.5


def words_of(svg: str) -> list[tuple[str, Box]]:
    """Every line of text with the box of its capitals; text that is turned is left out."""
    found = []
    for element in ET.fromstring(svg.encode()).iter(f"{NAMESPACE}text"):
        if element.get("transform"):
            continue
        content = element.text or ""
        size, x, y = (float(element.attrib[key]) for key in ("font-size", "x", "y"))
        width = measure_text(content, size, element.get("font-weight") == "bold")
        x -= {"start": 0.0, "middle": 0.5, "end": 1.0}[element.get("text-anchor", "start")] * width
        found.append((content, Box(x, y - CAP_HEIGHT * size, x + width, y)))
    return found


def collisions(svg: str) -> list[tuple[str, str]]:
    """Pairs of texts one of which covers the other."""
    return [
        (one, other)
        for (one, a), (other, b) in combinations(words_of(svg), 2)
        if min(a.x1, b.x1) - max(a.x0, b.x0) > TOUCHING and min(a.y1, b.y1) - max(a.y0, b.y0) > TOUCHING
    ]


def page_of(svg: str) -> Box:
    """The page, in page units."""
    return Box(*(float(word) for word in ET.fromstring(svg.encode()).attrib["viewBox"].split()))


def distance(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Distance between two points."""
    return hypot(one[0] - other[0], one[1] - other[1])
