"""The command ``workbench``: what FreeCAD's workbench orders, and what it finds in the folder."""

from __future__ import annotations

import json
import os
from pathlib import Path
from threading import Event
from typing import Any

import pytest

from workhold import Workpiece, errors
from workhold.cli.workbench_command import (
    WorkbenchOrder,
    convert_body_to_prisms,
    find_rank_in_file,
    identify_fixture,
    list_avoided_segments,
    watch_for_cancel,
)
from workhold.geometry.segment import Arc
from workhold.model.bodies import BodyKind, FixtureBody, Slab


def listed(
    angle: float, row: int = 1, kind: str = "clamp2", ways: tuple[str, str] = ("-x", "-y")
) -> dict[str, Any]:
    pegs = [{"column": 0, "row": row}, {"jaw": "left", "column": 1, "row": 0}]
    return {"type": kind, "directions": list(ways), "pegs": pegs, "pose": {"theta_deg": angle}}


def test_a_fixture_is_known_by_its_holes_and_how_the_part_lies() -> None:
    """Turned by half a turn in the same holes is another one; a few degrees are not."""
    marks = identify_fixture(listed(178.0))
    others = [
        listed(357.0),
        listed(190.0),
        listed(-179.0),
        listed(178.0, row=2),
        listed(178.0, ways=("-x", "y")),
    ]
    assert find_rank_in_file(others, marks) == 3
    assert find_rank_in_file(others[:2], marks) == 2
    assert find_rank_in_file([listed(357.0), *others[3:], listed(178.0, kind="clamp")], marks) is None
    assert find_rank_in_file([], marks) is None
    assert find_rank_in_file(others, "") is None


def test_an_order_of_another_version_is_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(errors.InputError, match="install the add-on that came with workhold"):
        WorkbenchOrder.read(tmp_path)
    (tmp_path / "order.json").write_text(json.dumps({"part": "part.step", "colour": "red"}))
    with pytest.raises(errors.InputError, match="not an order of this version"):
        WorkbenchOrder.read(tmp_path)
    (tmp_path / "order.json").write_text(json.dumps({"part": "part.step", "best": 3}))
    order = WorkbenchOrder.read(tmp_path)
    assert (order.part, order.best, order.supports) == ("part.step", 3, False)


def test_faces_of_no_solid_cannot_be_named() -> None:
    plate = Workpiece.from_points("plate", [(0, 0), (30, 0), (30, 20), (0, 20)])
    assert list_avoided_segments(WorkbenchOrder(), plate) == []
    with pytest.raises(errors.InputError, match="has no faces of its solid"):
        list_avoided_segments(WorkbenchOrder(avoid={"Face1": 0}), plate)


def test_a_search_ends_when_the_workbench_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is written; the pipe ends."""
    reader, writer = os.pipe()
    os.close(writer)
    with os.fdopen(reader) as stream:
        monkeypatch.setattr("sys.stdin", stream)
        cancel = Event()
        watch_for_cancel(cancel)
    assert cancel.is_set()


def test_bodies_are_prisms_with_their_holes() -> None:
    """A line by its ends, an arc by its centre, radius and angles, counted counter-clockwise however it runs."""
    square = Workpiece.from_points("plate", [(0, 0), (30, 0), (30, 20), (0, 20)]).loop_segments[0]
    hole = (Arc((10.0, 8.0), 2.0, 0.5, 0.25, -1.0),)
    body = FixtureBody("plate", BodyKind.PLATE, (Slab(square, (hole,), -10.0, 0.0),))  # type: ignore[arg-type]
    data = convert_body_to_prisms(body)
    (slab,) = data["slabs"]
    assert (data["name"], slab["low"], slab["high"]) == ("plate", -10.0, 0.0)
    outer, inner = slab["borders"]
    assert sorted(map(tuple, outer)) == [(0, 0, 30, 0), (0, 20, 0, 0), (30, 0, 30, 20), (30, 20, 0, 20)]
    assert inner == [[10.0, 8.0, 2.0, 0.25, 0.75]]
