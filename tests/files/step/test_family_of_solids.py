"""Families of solids in toolkits with heights of their own: either side up, each fixture as bodies against the solid."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")
pytest.importorskip("scipy", reason="the extra [batch] is not installed")

from step_shapes import box, cut, cylinder, fused, write_step
from typer.testing import CliRunner

from solid_truth import fixture_faults
from workhold import Fence, FlatJaw, Plate, Query, Vise, answer, load
from workhold.cli.main import app
from workhold.family.members import RANKINGS
from workhold.files.step.library import turn_axis_up
from workhold.fixels.toolkit import Toolkit


def flanged() -> Any:
    """A foot, a flange, and a stem with a bore, of which no height from below is one from above."""
    foot, flange, stem = box(60, 40, 8), box(70, 50, 4, (-5, -5, 8)), box(46, 30, 18, (8, 5, 12))
    return cut(fused(foot, flange, stem), cylinder(5, 40, (20, 20, -1)))


def corner() -> Any:
    """A foot with a cut corner, and a lower stem with a round end."""
    foot, stem = cut(box(64, 44, 9), box(30, 30, 40, (50, 30, -1))), box(34, 20, 12, (6, 6, 9))
    return fused(foot, stem, cylinder(14, 12, (40, 18, 9)))


SOLIDS = {"flanged": flanged(), "corner": corner()}
HELD: dict[str, tuple[Toolkit, tuple[str, ...]]] = {
    "plate": (
        Plate(pitch=14, columns=7, rows=7, peg_radius=3, clamp_heights=(1, 7)),
        ("plate", "--clamp-heights", "1,7"),
    ),
    "vise": (
        Vise(pitch=14, columns=2, peg_radius=3, left_heights=(0, 5), right_heights=(1, 7)),
        ("vise", "--columns", "2", "--left-heights", "0,5", "--right-heights", "1,7"),
    ),
    "fence": (
        Fence(pitch=14, peg_radius=3, wall_offset=8, wall_heights=(0, 4)),
        ("fence", "--wall-offset", "8", "--wall-heights", "0,4"),
    ),
    "flat jaw": (
        FlatJaw(pitch=14, peg_radius=3, wall_heights=(0, 5), jaw_heights=(1, 7)),
        ("flat-jaw", "--wall-heights", "0,5", "--jaw-heights", "1,7"),
    ),
}


@pytest.mark.parametrize("name", HELD)
def test_each_part_of_a_plan_lies_as_its_own_list_says(name: str, tmp_path: Path) -> None:
    """A part's number in the plan is that of its fixture in the whole list of its side; as bodies it is held there."""
    toolkit, words = HELD[name]
    files = [str(write_step(tmp_path / f"{called}.step", shape)) for called, shape in SOLIDS.items()]
    sizes = (
        "--pitch",
        "14",
        "--peg-radius",
        "3",
        *(("--columns", "7", "--rows", "7") if name == "plate" else ()),
    )
    asked = ["family", *files, "--toolkit", *words, *sizes, "--peg-height", "7", "--both-sides", "--json"]
    shown = CliRunner().invoke(app, [*asked, "--threads", "1"])
    assert shown.exit_code == 0, shown.stderr
    found = json.loads(shown.stdout)["family"]
    called = [f"{one}.step{side}" for one in SOLIDS for side in ("", ", side 2")]
    assert [one["name"] for one in found["parts"]] == called
    lists = []
    for (solid, shape), axis in [(one, axis) for one in SOLIDS.items() for axis in ("z", "-z")]:
        part = load(tmp_path / f"{solid}.step", axis=axis, peg_height=7, heights=toolkit.heights)
        result = answer(Query(part, toolkit, rank_by=RANKINGS[toolkit.travel_count]), threads=1)
        lists.append((turn_axis_up(shape, axis), part, result))
    assert [one["fixtures"] for one in found["parts"]] == [len(result) for _, _, result in lists]
    held = [one for plan in found["curve"] for setup in plan["plan"] for one in setup["parts"]]
    assert held
    for one in held:
        shape, part, result = lists[one["part"]]
        fixture = result[one["fixture"] - 1]
        assert list(fixture_faults(lowered(shape), part, fixture, toolkit)) == []
        if not one["turned"]:
            assert fixture.pose.theta_deg == pytest.approx(one["pose"]["theta_deg"], abs=1e-6)


def lowered(shape: Any) -> Any:
    """A solid moved so that its lowest point is at z = 0."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Trsf, gp_Vec

    from workhold.files.step.library import compute_bounding_box

    move = gp_Trsf()
    move.SetTranslation(gp_Vec(0, 0, -compute_bounding_box(shape)[0][2]))
    return BRepBuilderAPI_Transform(shape, move, True).Shape()
