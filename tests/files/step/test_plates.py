"""Jaw plates as STEP: solids of the right volume, in their places."""

from __future__ import annotations

from math import pi

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from workhold import Vise
from workhold.errors import InputError
from workhold.files.step.solids import read_solids
from workhold.files.step.writer import make_plates_step
from workhold.model.dowels import Bolts, list_jaw_plates

PLATES = list_jaw_plates(
    Vise(pitch=(10, 12), columns=3, peg_radius=3, rows=4),
    hole_diameter=6.01,
    bolts=Bolts(4.0, ((5.0, 6.0), (15.0, 30.0))),
)


def test_volumes_are_those_of_drilled_plates() -> None:
    """A box of 30 by 48 by 8 mm less twelve dowel holes and two bolt holes, its upper side at z = 0."""
    content = make_plates_step(PLATES, 8.0)
    assert content == make_plates_step(PLATES, 8.0)
    expected = 8 * (30 * 48 - 12 * pi * 3.005**2 - 2 * pi * 4)
    solids = read_solids(content)
    assert [solid.volume for solid in solids] == pytest.approx([expected] * 2, rel=1e-9)
    assert {(round(solid.low[2], 9), round(solid.high[2], 9)) for solid in solids} == {(-8.0, 0.0)}
    assert b"left jaw plate" in content and b"right jaw plate" in content


def test_a_plate_has_a_thickness() -> None:
    """None below zero."""
    with pytest.raises(InputError, match="thickness -1"):
        make_plates_step(PLATES, -1.0)
