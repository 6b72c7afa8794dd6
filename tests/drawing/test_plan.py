"""Marks that tell of measures."""

from __future__ import annotations

import re
from math import atan2, degrees

import pytest
from svg_reading import by_class

from workhold.drawing.plan import angle_mark
from workhold.drawing.scene import Scene


@pytest.mark.parametrize("theta", [25.0, 90.0, 179.0, 200.0, -20.0])
def test_the_arc_of_an_angle_ends_at_its_arrow_head(theta: float) -> None:
    """It begins on the vise's axis and ends short of the part's by no more than the head is long: turned counter-clockwise
    by the angle and not past it, clockwise where the angle is negative."""
    page, radius = Scene.page((200.0, 200.0), "angle"), 40.0
    angle_mark(page, (100.0, 100.0), theta, radius, 60.0)
    (group,) = by_class(page.svg(), "pose")
    d = next(element.attrib["d"] for element in group if "A" in element.attrib.get("d", ""))
    ends = [(float(x), float(y)) for x, y in re.findall(r"([-\d.]+) ([-\d.]+)(?=A|$)", d)]
    way = 1.0 if theta > 0.0 else -1.0
    angles = [way * degrees(atan2(100.0 - y, x - 100.0)) % 360.0 for x, y in ends]
    assert angles[0] == pytest.approx(0.0, abs=1e-6)
    assert angles == sorted(angles)
    assert abs(theta) - 12.0 < angles[-1] < abs(theta) - 8.0
