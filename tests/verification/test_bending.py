"""Bending that a file states is computed again: what is true holds, and what was changed is found."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from attrs import evolve
from typer.testing import CliRunner

import workhold
from bent_bodies import need_elements
from workhold import Load
from workhold.bending import asking, holding, meshing, patches, places, stress
from workhold.cli.main import app
from workhold.model.elastic_material import find_material
from workhold.model.part_bending import BendingFigures, PadsBelow
from workhold.model.result import Result
from workhold.verification import verify
from workhold.verification.bending import body, checking, judge, pressed

need_elements()

COARSE = 150
NOTCHED = [(0, 0), (80, 0), (80, 30), (50, 60), (0, 60)]
CLOVER = [[[0, 0, 0], [70, 0, 0.3], [80, 50, 0], [30, 60, -0.2], [0, 45, 0]], [[30, 25, 1], [42, 25, 1]]]


@pytest.fixture(scope="module", autouse=True)
def coarse() -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(meshing, "TETRAHEDRA", COARSE)
        patch.setattr(body, "TETRAHEDRA", COARSE)
        yield


def bend(toolkit: Any, **asked: Any) -> Result:
    part = workhold.Workpiece.from_points("plate", NOTCHED)
    loads = [Load(points=[(60, 20), (20, 40)], force=150), Load(points=[(10, 10)], force=80, moment=900)]
    result = workhold.design(part, toolkit, best=2, loads=loads)
    return result.bend(**{"thickness": 8.0, "jaw_force": 3000.0, "best": 2} | asked)


@pytest.fixture(scope="module")
def bent() -> Result:
    return bend(workhold.Vise(pitch=10, columns=3, peg_radius=3))


def test_numbers_that_define_the_figures_are_the_same_in_both_copies() -> None:
    assert (pressed.WIDE, pressed.BESIDE) == (patches.PEG_WIDTH, patches.BESIDE)
    assert (pressed.ACROSS, pressed.APART) == (patches.ACROSS, patches.ALONG)
    assert (pressed.DISC, pressed.AROUND) == (patches.RINGS, patches.AROUND)
    assert (body.SHARE, body.OF_EXTENT) == (meshing.SHARE, meshing.OF_LEAST_EXTENT)
    assert (body.MOST, body.ROOM) == (meshing.MOST_TETRAHEDRA, meshing.ROOM)
    assert (body.OF_SHEET, body.PER_SQUARE) == (meshing.OF_SHEET, meshing.PER_SQUARE)
    tried = (meshing.FEW, *meshing.MORE)
    assert tuple((one["grading"], one["curvaturesafety"]) for one in tried) == body.GRADED
    assert (judge.LOAD_RADIUS, judge.OF_STRESS) == (asking.CUTTER_RADIUS, asking.OF_STRESS)
    assert (judge.DIRECTIONS, judge.ON_FACE) == (places.DIRECTIONS, asking.ON_FACE)
    assert judge.BESIDE_EDGES == stress.BESIDE_EDGES
    assert np.isclose(judge.SMOOTH, np.cos(np.radians(stress.SHARP)), atol=1e-4)
    assert holding.PEG_WIDTH == pressed.WIDE


@pytest.mark.thorough
def test_what_is_true_holds(bent: Result) -> None:
    outcome = verify(bent)
    assert (outcome.proven, outcome.unproven, outcome.unchecked) == (2, (), ())


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("toolkit", "asked"),
    [
        (workhold.Plate(pitch=20, peg_radius=3), {}),
        (workhold.Plate(pitch=20, peg_radius=3, clamps=2), {"jaw": 0.7}),
        (workhold.Vise(pitch=10, columns=3, peg_radius=3), {"jaw": "constant", "faces": ("top", 2)}),
        (workhold.Vise(pitch=10, columns=3, peg_radius=3), {"jaw": 2.5, "material": "69000,0.3,200"}),
    ],
    ids=["plate", "two clamps", "constant", "stiff"],
)
def test_other_toolkits_hold_as_well(toolkit: Any, asked: Any) -> None:
    outcome = verify(bend(toolkit, **asked))
    assert (outcome.proven, outcome.unproven, outcome.unchecked) == (2, (), ())


@pytest.mark.thorough
def test_round_faces_and_a_hole_hold_as_well() -> None:
    part = workhold.Workpiece.from_loops("clover", CLOVER)
    result = workhold.design(part, workhold.Vise(pitch=10, columns=3, peg_radius=3), best=3)
    outcome = verify(result.bend(thickness=10.0, best=3))
    assert (outcome.proven, outcome.unproven) == (3, ())


@pytest.mark.thorough
def test_pads_below_and_the_clamp_on_top_hold_as_well(bent: Result) -> None:
    first = bent[0]
    found = first.supports(8.0, pad_radius=3, tip_radius=3)
    told = first.bending(thickness=8.0, jaw_force=3000.0, supports=found).to_figures()
    assert isinstance(told.below, PadsBelow)
    assert verify(evolve(bent, bending={0: told})).holds
    softer = evolve(told, below=evolve(told.below, force=3 * told.below.force))
    assert not verify(evolve(bent, bending={0: softer})).holds


def change(place: str, **values: Any) -> Callable[[BendingFigures], BendingFigures]:
    """A change of one of the figures; numbers are factors."""

    def make(told: BendingFigures) -> BendingFigures:
        old = getattr(told, place)
        new = {
            key: getattr(old, key) * value if isinstance(value, float) else value
            for key, value in values.items()
        }
        return evolve(told, **{place: evolve(old, **new)})

    return make


CHANGES: dict[str, Callable[[BendingFigures], BendingFigures]] = {
    "more": change("clamp_distortion", value=1.03),
    "less": change("clamp_distortion", value=0.97),
    "surer": change("clamp_distortion", error=0.8),
    "less sure": change("clamp_distortion", error=1.5),
    "elsewhere": change("clamp_distortion", at=(40.0, 30.0, 8.0)),
    "on a peg": change("clamp_distortion", at=(0.0, 30.0, 4.0)),
    "gives more": change("give", value=1.03),
    "gives less": change("give", value=0.97),
    "gives surely": change("give", error=0.5),
    "gives elsewhere": change("give", at=(33.0, 33.0, 8.0)),
    "another load": change("give", load=9),
    "no give": lambda told: evolve(told, give=None),
    "stressed more": change("stress", value=1.03),
    "stressed less": change("stress", value=0.97),
    "stress is sure": change("stress", error=0.6),
    "stressed elsewhere": change("stress", at=(40.0, 30.0, 8.0)),
    "stressed at no node": change("stress", at=(40.123, 30.456, 8.0)),
    "another material": lambda told: evolve(told, material=find_material("brass")),
    "an alike material": lambda told: evolve(told, material=find_material("aluminium-7075")),
    "stiffer": lambda told: evolve(told, material=evolve(told.material, elastic_modulus=70000.0)),
    "stronger": lambda told: evolve(told, material=evolve(told.material, strength=500.0)),
    "pressed harder": lambda told: evolve(told, jaw_force=3100.0),
    "pressed less": lambda told: evolve(told, jaw_force=2900.0),
    "a convention": lambda told: evolve(told, is_assumed=True),
    "thicker": lambda told: evolve(told, thickness=8.2),
    "another jaw": lambda told: evolve(told, stiffness=0.01),
    "only one face": lambda told: evolve(told, faces=(2,)),
    "a face that is not": lambda told: evolve(told, faces=(77,)),
    "named so": lambda told: evolve(
        told, material=evolve(find_material("68000,0.33"), elastic_modulus=68900.0)
    ),
}


@pytest.mark.thorough
@pytest.mark.parametrize("name", CHANGES)
def test_what_was_changed_is_found(bent: Result, name: str) -> None:
    told = bent.bending[0]
    outcome = verify(evolve(bent, bending={0: CHANGES[name](told)}))
    refuted = [one.index for one in outcome.unproven if one.verdict == "refuted"]
    # A mesh of other elements is not the one that figures are of, whatever they are.
    assert refuted == [0] or (name == "thicker" and outcome.proven != 2), outcome.unproven


@pytest.mark.thorough
def test_another_mesh_leaves_it_undecided_unless_it_is_beyond_its_error(bent: Result) -> None:
    told = evolve(bent.bending[0], elements=77)
    outcome = verify(evolve(bent, bending={0: told}))
    assert (outcome.undecided, outcome.refuted) == (1, 0)
    assert "its mesh has 77 elements" in outcome.unproven[0].reason
    far = change("clamp_distortion", value=1.5)(told)
    beyond = verify(evolve(bent, bending={0: far}))
    assert beyond.refuted == 1 and "on a finer mesh" in beyond.unproven[0].reason


def test_without_the_library_it_says_what_was_not_checked(
    bent: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(checking, "has_elements", lambda: False)
    outcome = verify(bent)
    assert outcome.proven == 2
    (said,) = outcome.unchecked
    assert (
        said.startswith("How far fixtures bend the part was not checked") and "pip install 'ngsolve" in said
    )
    wrong = evolve(bent.bending[0], material=evolve(find_material("brass"), name="aluminium-6061"))
    assert verify(evolve(bent, bending={0: wrong})).refuted == 1
    assert verify(evolve(bent, bending={})).unchecked == ()


def test_flat_jaws_are_not_checked() -> None:
    part = workhold.Workpiece.from_points("block", [(0, 0), (60, 0), (60, 40), (0, 40)])
    result = workhold.design(
        part, workhold.PlainVise(jaw_width=150, max_opening=120, jaw_height=40), thickness=20.0
    )
    held = result.bend(thickness=20.0, best=1, jaw_force=2000.0)
    outcome = verify(held)
    assert outcome.holds and "between flat jaws is not computed again" in outcome.unchecked[0]
    odd = evolve(held.bending[0], faces=(77,))
    assert verify(evolve(held, bending={0: odd})).refuted == 1


@pytest.mark.prove
@pytest.mark.parametrize("name", ["plate", "housing", "bracket", "ring", "L", "block"])
def test_solids_hold_as_well(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from step_shapes import write_step

    from bent_solids import SOLIDS

    for room in (meshing, body):
        monkeypatch.setattr(room, "TETRAHEDRA", 1000)
    path = write_step(tmp_path / f"{name}.step", SOLIDS[name]())
    part = workhold.load(path)
    x0, y0, x1, y1 = part.bounds
    load = Load(
        points=[((x0 + x1) / 2, (y0 + y1) / 2), (0.8 * x0 + 0.2 * x1, 0.9 * y0 + 0.1 * y1)], force=150
    )
    vise = workhold.Vise(pitch=10, columns=4, peg_radius=3)
    result = workhold.design(part, vise, best=3, loads=[load], jaw_force=3000.0)
    bent = result.bend(part=path, best=3)
    told = workhold.verify(bent)
    assert told.proven == 3 and "takes the part's STEP file" in told.unchecked[0]
    outcome = workhold.verify(bent, part=path)
    assert (outcome.proven, outcome.unproven, outcome.unchecked) == (3, (), ())


@pytest.mark.thorough
def test_the_command_says_what_is_refuted_and_what_was_not_checked(
    bent: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    good, bad = tmp_path / "good.json", tmp_path / "bad.npz"
    workhold.save(bent, good)
    workhold.save(evolve(bent, bending={1: CHANGES["stressed more"](bent.bending[1])}), bad)
    assert CliRunner().invoke(app, ["verify", str(good)]).exit_code == 0
    refuted = CliRunner().invoke(app, ["verify", str(bad)])
    assert refuted.exit_code == 2 and "Fixture 2 is refuted: stress is given as" in refuted.stdout
    monkeypatch.setattr(checking, "has_elements", lambda: False)
    unchecked = CliRunner().invoke(app, ["verify", str(bad)])
    assert unchecked.exit_code == 0 and "How far fixtures bend the part was not checked" in unchecked.stdout
    told = json.loads(CliRunner().invoke(app, ["verify", str(bad), "--json"]).stdout)
    assert len(told["unchecked"]) == 1


@pytest.mark.parametrize(("stretches", "faults"), [([], 0), ([3], 1)])
def test_tools_that_touch_nothing_make_nothing_give(bent: Result, stretches: list[int], faults: int) -> None:
    forces = SimpleNamespace(stretches=SimpleNamespace(move=stretches))
    query = SimpleNamespace(
        loads=(), program=SimpleNamespace(forces=forces), jaw_force=None, workpiece=bent.workpiece
    )
    told = evolve(bent.bending[0], give=None)
    found = list(judge.BendingJudge(query).judge_statement(told))  # type: ignore[arg-type]
    assert len(found) == faults


@pytest.mark.thorough
def test_a_place_on_the_edge_of_what_is_cut_counts() -> None:
    vise, heights = workhold.Vise(pitch=10, columns=3, peg_radius=3), []
    for face in range(5):
        wall = bend(vise, faces=(face,), best=1)
        heights.append(wall.bending[0].clamp_distortion.at[2])
        assert verify(wall).proven == 2
    # The largest movement of a wall is mostly at its rim, which belongs to the upper or the lower side as well.
    assert {0.0, 8.0} & set(heights)
    assert not verify(evolve(wall, bending={0: evolve(wall.bending[0], faces=("bottom",))})).holds
