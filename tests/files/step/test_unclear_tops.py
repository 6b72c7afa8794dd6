"""Level faces beside which it cannot be told what is free: none of them is taken, and that is what is said."""

from __future__ import annotations

import json
from math import cos, sin
from pathlib import Path
from typing import Any

import pytest

from shown_words import last_paragraph

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from attrs import evolve
from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from step_shapes import box, fused

import workhold
from workhold import Plate, load
from workhold.files.budget import LIMITS
from workhold.presenting.data import describe_solid
from workhold.supports.words import write_flat_faces_notes
from workhold.units import INCH
from workhold.web.request_forms import WorkpieceForm


def plate_with_rings() -> Any:
    """A plate of 100 x 60 x 20 mm on which two tilted rings of 3 mm reach into one another."""
    rings = [
        BRepPrimAPI_MakeTorus(
            gp_Ax2(gp_Pnt(40.0 + 12.0 * k, 30.0, 24.0), gp_Dir(sin(0.3 + 0.2 * k), 0.2, cos(0.3 + 0.2 * k))),
            10.0,
            3.0,
        ).Shape()
        for k in (0, 1)
    ]
    return fused(box(100, 60, 20), *rings)


def test_what_could_not_be_told_is_not_said_to_be_closed_to_the_sky(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The sentence names the height and what helps, in Python, files and requests alike."""
    # As on any machine where the count of places runs out; how much that is changes with the code.
    monkeypatch.setitem(LIMITS, "tops", evolve(LIMITS["tops"], most_elements=50))
    part = load(plate_with_rings(), name="rings", peg_height=11)
    assert part.solid is not None and part.solid.top == () and part.solid.unclear_heights == (20.0,)
    result = workhold.design(part, Plate(pitch=10, peg_radius=3), best=1)
    found = result[0].supports(best=1)
    assert found.triples == ()
    why = last_paragraph(found)
    assert (
        "beside the level face at a height of 20.000 mm" in why
        and "it is not known where a clamp has room" in why
    )
    assert "open upward" not in why and "crowns" not in why
    (note,) = write_flat_faces_notes(part, ("a", "b"), INCH)
    assert "beside the level face at a height of 0.7874 in" in note and note.startswith("So much of the part")
    workhold.save(result, tmp_path / "r.json")
    assert workhold.open(tmp_path / "r.json").workpiece.solid == part.solid
    assert workhold.verify(tmp_path / "r.json").faults == ()
    sent = {"name": part.name, "loops": [loop.tolist() for loop in part.loops], **describe_solid(part.solid)}
    asked = WorkpieceForm.model_validate(json.loads(json.dumps(sent))).to_workpiece(1000).solid
    assert asked is not None and asked.unclear_heights == (20.0,)


def test_other_faces_of_such_a_part_stay_known() -> None:
    """What lies beside them is told as before, and nothing is unclear where all is told."""
    plain = load(box(100, 60, 20), name="plain", peg_height=11)
    assert plain.solid is not None and plain.solid.unclear_heights == () and plain.solid.top
    assert write_flat_faces_notes(plain, ("a", "b")) == []


def test_where_rings_reach_into_one_another_it_is_told_what_is_free() -> None:
    """Between their outlines, where these cross, a gap narrows to a point; tips stay off both, and off that."""
    part = load(plate_with_rings(), name="rings", peg_height=11)
    assert part.solid is not None and part.solid.unclear_heights == ()
    assert part.solid.top and set(part.solid.top_heights) == {20.0}
    result = workhold.design(part, Plate(pitch=10, peg_radius=3), best=1)
    assert result[0].supports(best=1).triples
