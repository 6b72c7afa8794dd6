"""Marks that tell of measures."""

from __future__ import annotations

import re
from math import atan2, degrees, hypot

import pytest
from attrs import evolve
from held_any_way import HELD
from svg_reading import by_class

from workhold import Pose, Workpiece
from workhold.drawing import draw_fixture
from workhold.drawing.plan import draw_angle_mark
from workhold.drawing.scene import Scene


@pytest.mark.parametrize("theta", [25.0, 90.0, 179.0, 200.0, -20.0])
def test_the_arc_of_an_angle_ends_at_its_arrow_head(theta: float) -> None:
    """It begins on the vise's axis and ends short of the part's by no more than the head is long: turned counter-clockwise
    by the angle and not past it, clockwise where the angle is negative."""
    page, radius = Scene.make_page((200.0, 200.0), "angle"), 40.0
    draw_angle_mark(page, (100.0, 100.0), theta, radius, 60.0)
    (group,) = by_class(page.to_svg(), "pose")
    d = next(element.attrib["d"] for element in group if "A" in element.attrib.get("d", ""))
    ends = [(float(x), float(y)) for x, y in re.findall(r"([-\d.]+) ([-\d.]+)(?=A|$)", d)]
    way = 1.0 if theta > 0.0 else -1.0
    angles = [way * degrees(atan2(100.0 - y, x - 100.0)) % 360.0 for x, y in ends]
    assert angles[0] == pytest.approx(0.0, abs=1e-6)
    assert angles == sorted(angles)
    assert abs(theta) - 12.0 < angles[-1] < abs(theta) - 8.0


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("theta", "words"),
    [
        (20.0, "θ = 20.000°"),
        (340.0, "θ = −20.000°"),
        (330.0, "θ = −30.000°"),
        (320.0, "θ = −40.000°"),
        (359.9999, "θ = 0.000°"),
    ],
)
def test_an_angle_is_written_beside_its_arc(theta: float, words: str) -> None:
    """In front of the arc, whichever way it goes, where nothing else stands near; and nothing is not a turn clockwise."""
    side, held = 300.0, HELD[0]
    part = Workpiece.from_loops("wide", [[[0, 0, 0], [side, 0, 0], [side, side, 0], [0, side, 0]]])
    pegs = tuple(evolve(peg, face=number, beside=None) for number, peg in enumerate(held.fixture.pegs))
    svg = draw_fixture(evolve(held.fixture, pose=Pose(theta, 10.0, 10.0), pegs=pegs), part, held.toolkit)
    (pose,), (labels,) = by_class(svg, "pose"), by_class(svg, "labels")
    (dot,) = (element for element in pose if element.tag.endswith("circle"))
    (label,) = (element for element in labels if element.text == words)
    across = float(label.attrib["x"]) - float(dot.attrib["cx"])
    up = float(dot.attrib["cy"]) - float(label.attrib["y"])
    assert hypot(across, up) < 80.0 and abs(degrees(atan2(up, across))) < 45.0
