"""A family's file says where every peg stands, in the words of the carrier that it stands on."""

from __future__ import annotations

import json

import pytest

from workhold import Fence, Plate, Vise
from workhold.family.family import peg_entry
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Peg

BOLTED = Plate(pitch=20, peg_radius=3, travel=(5, 30))
FENCE = Fence(pitch=20, peg_radius=3, wall_offset=8)


@pytest.mark.parametrize(
    ("toolkit", "carrier", "written"),
    [
        (Vise(pitch=10, columns=2, peg_radius=3), "right", '{"jaw": "right", "column": 4, "row": 1}'),
        (FENCE, "plate", '{"role": "locator", "column": 4, "row": 1}'),
        (FENCE, "wall", '{"role": "locator", "column": 4, "row": 1}'),
        (FENCE, "clamp -x", '{"role": "clamp", "direction": "-x", "row": 1, "hole": null}'),
        (FENCE, "clamp +y", '{"role": "clamp", "direction": "+y", "column": 4, "hole": null}'),
        (BOLTED, "clamp -x", '{"role": "clamp", "direction": "-x", "row": 1, "hole": [4, 1]}'),
    ],
)
def test_a_peg_is_written_by_its_carrier(toolkit: Toolkit, carrier: str, written: str) -> None:
    """The ends of a wall have the role of locators, and a clamp its line, and its hole where that is known."""
    assert json.dumps(peg_entry(Peg(carrier, 4, 1, 0.0, 0.0, 0, 1.0), toolkit)) == written
