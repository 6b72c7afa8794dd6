"""Straps on the plan: their numbers stand where no label covers them."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest
from svg_reading import NAMESPACE

import workhold
from jaw_examples import ELL, rectangle
from workhold.drawing import draw_fixture


def boxes_and_numbers(svg: str) -> tuple[list[tuple[float, ...]], list[tuple[float, float]]]:
    """The boxes of labels, and the middles of the straps' numbers, in page units."""
    root = ET.fromstring(svg.encode())
    groups = list(root.iter(f"{NAMESPACE}g"))
    labels = [one for one in groups if one.get("class") == "labels"]
    straps = [one for one in groups if one.get("class") == "strap"]
    boxes = []
    for rect in (rect for group in labels for rect in group.iter(f"{NAMESPACE}rect")):
        x, y, width, height = (float(rect.attrib[key]) for key in ("x", "y", "width", "height"))
        boxes.append((x, y, x + width, y + height))
    texts = (text for group in straps for text in group.iter(f"{NAMESPACE}text"))
    return boxes, [(float(text.attrib["x"]), float(text.attrib["y"]) - 4) for text in texts]


@pytest.mark.thorough
@pytest.mark.parametrize("part", [rectangle(60, 40), rectangle(), ELL], ids=["small", "block", "ell"])
def test_no_label_covers_a_strap_s_number(part: workhold.Workpiece) -> None:
    plate = workhold.StrapPlate(pitch=20, peg_radius=3, columns=9, rows=7, straps=3)
    load = workhold.Load(points=(20, 10), force=200, directions=0)
    result = workhold.design(part, plate, loads=[load], thickness=20, strapped=8, best=8)
    held = [one for one in result if one.hold.straps]
    assert held
    for one in held:
        boxes, numbers = boxes_and_numbers(draw_fixture(one, result.workpiece, result.toolkit))
        assert len(numbers) == len(one.hold.straps) and boxes
        for x, y in numbers:
            assert not any(x0 - 4 < x < x1 + 4 and y0 - 4 < y < y1 + 4 for x0, y0, x1, y1 in boxes)
