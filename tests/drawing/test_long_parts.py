"""Long parts: they have the length of the page, their own picture, and no leader through a name."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from datetime import date

import numpy as np
import pytest
from sheet_reading import page_of, words_of
from svg_reading import NAMESPACE, by_class, texts

from workhold import Vise, Workpiece, design
from workhold.drawing import SheetDetails, draw_fixture, draw_sheet
from workhold.drawing.annotation import Label, LabelPlacer
from workhold.drawing.scene import Box

DETAILS = SheetDetails(1, 2, date(2026, 3, 31), "", "1")


def struck(svg: str) -> list[str]:
    """The words that a label's leader goes through, other than its own."""
    (labels,) = by_class(svg, "labels")
    found = []
    for path in labels.iter(f"{NAMESPACE}path"):
        numbers = [float(word) for word in re.findall(r"-?\d+\.?\d*", path.attrib["d"])]
        start, end = (numbers[0], numbers[1]), (numbers[2], numbers[3])
        points = [
            (start[0] + k / 200 * (end[0] - start[0]), start[1] + k / 200 * (end[1] - start[1]))
            for k in range(201)
        ]
        for word, box in words_of(svg):
            if box.grow(8).contains(Box(*end, *end)):
                continue
            if any(box.grow(-1).contains(Box(*point, *point)) for point in points):
                found.append(word)
    return found


@pytest.mark.thorough
def test_no_leader_goes_through_a_name() -> None:
    """Along a strip between jaws that all but meet, names of pegs find places without crossing column letters."""
    strip = Workpiece.from_points("strip", [(0, 0), (240, 0), (240, 6), (0, 6)])
    result = design(strip, Vise.preset("gripper-two-columns"), best=8)
    for fixture in list(result)[::2]:
        assert struck(draw_fixture(fixture, strip, result.toolkit, title="F")) == []
        assert struck(draw_sheet(fixture, strip, result.toolkit, DETAILS)[0]) == []


def test_a_leader_takes_a_long_way_round_a_caption() -> None:
    """A place behind a caption is dearer than one a good deal farther off, and cheaper than one on the caption."""
    placer = LabelPlacer(Box(0.0, 0.0, 400.0, 400.0))
    placer.avoid_box(Box(80.0, 90.0, 120.0, 110.0))
    centers = np.array([[200.0, 100.0], [40.0, 300.0], [100.0, 100.0]])
    label = Label(20.0, 10.0, centers, np.tile([40.0, 100.0], (3, 1)), np.array([0.0, 60.0, 0.0]))
    assert placer.place([label])[0].box.center == (40.0, 300.0)
    (far,) = placer.place([Label(20.0, 10.0, centers, label.anchors, np.array([0.0, 150.0, 0.0]))])
    assert far.box.center == (200.0, 100.0)


def test_a_long_part_that_stands_upright_has_an_upright_page() -> None:
    """The words stand beside the plan, which is as high as the page lets it be, and the part is shown as drawn."""
    bar = Workpiece.from_points("bar", [(0, 0), (200, 0), (200, 12), (0, 10)])
    result = design(bar, Vise(pitch=10, columns=1, peg_radius=3), best=1)
    page = draw_sheet(result[0], bar, result.toolkit, DETAILS)[0]
    paper = page_of(page)
    assert paper.height > paper.width
    (cell,) = (word for word in texts(page) if word.endswith(" on A4"))
    assert cell == "1:1.5 on A4"
    whole = draw_sheet(result[0], bar, result.toolkit, DETAILS)
    assert sum(len(by_class(one, "part-as-drawn")) for one in whole) == 1
    assert ET.fromstring(page.encode()) is not None
