"""Results of a fence with two clamps: true ones are proven, each rule that is broken is named, and so is a worse pair."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attrs import evolve

import workhold
from judged import faults_of, known_in
from toolkit_results import assert_all_proven, part, verify_edited
from undecided_examples import pairs_undecided
from workhold import Fence, InputError, Load, Restrictions, Result, circle_zone, design
from workhold.model.notes import STAGES, NoFixture, NoPair
from workhold.model.search_report import UndecidedCandidate
from workhold.verification import Verification, verify, verify_fixture

Data = dict[str, Any]
Edit = Callable[[Data], object]

BLOCK = [[0, 0, 0], [46, 0, 0], [46, 30, 0], [0, 30, 0]]
ANGLE = [[0, 0, 0], [60, 0, 0], [60, 20, 0], [22, 20, 0], [22, 58, 0], [0, 58, 0]]
EAR = [[0, 0, 0], [50, 0, 0], [50, 30, 1], [0, 30, 0]]
ALL = [("-x", "-y"), ("+x", "-y"), ("-x", "-x"), ("-y", "-y"), ("-x", "+x"), ("-y", "+y")]


def fence(**fields: Any) -> Fence:
    """A fence with two clamps."""
    given: Data = {"pitch": (20, 16), "peg_radius": 3, "wall_offset": 8, "columns": 6, "rows": 5, "clamps": 2}
    return Fence(**(given | fields))


@pytest.mark.parametrize(
    ("loop", "toolkit", "reason"),
    [
        ([[0, 0, 1], [40, 0, 1]], fence(), 0),
        (BLOCK, fence(wall_offset=60), 1),
    ],
)
def test_a_part_that_is_never_held_has_a_note_that_follows(loop: Any, toolkit: Fence, reason: int) -> None:
    """A disc has no straight piece to lie on, and no locator reaches a part that is lower than the first row."""
    result = design(part(loop), toolkit)
    assert str(result.notes[0]) == toolkit.wording.reasons[reason] and len(result.notes) == 1
    assert verify(result).faults == ()
    for note in (NoFixture(STAGES[1 - reason], toolkit.wording), NoPair(0, 0)):
        assert len(verify(evolve(result, notes=(note,))).faults) == 2


@pytest.mark.thorough
@pytest.mark.thinned(6)
@pytest.mark.parametrize(
    ("loop", "toolkit", "asked"),
    [
        (BLOCK, fence(), {}),
        (BLOCK, fence(rows=None, columns=None), {"listing": "all"}),
        (ANGLE, fence(clamp_radius=5, travel=(4, 30), directions=ALL), {}),
        (ANGLE, fence(travel=(6, 26), rows=3), {"listing": "all", "contact_margin": 0.5}),
        (
            EAR,
            fence(clamp_radius=2, columns=4),
            {"loads": [Load(((25.0, 10.0),), 200.0)], "jaw_force": 300.0},
        ),
        (
            ANGLE,
            fence(),
            {
                "restrictions": Restrictions((3,), (circle_zone(41.3, 23.0, 3.0),), ((-100.0, 95.0),)),
                "best": 12,
            },
        ),
    ],
)
def test_everything_a_search_lists_is_proven(loop: Any, toolkit: Fence, asked: Data, tmp_path: Path) -> None:
    """With how many pairs there are at each seat and that none is better; in files of both forms, and searched again."""
    result = design(part(loop), toolkit, **asked)
    assert len(result) >= 8
    assert_all_proven(result, tmp_path)


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    """Of an L, bolted clamps: the best pair of each seat, and all."""
    toolkit = fence(travel=(4, 40), directions=ALL[:2])
    return {listing: design(part(ANGLE), toolkit, listing=listing) for listing in ("best", "all")}


@pytest.fixture(scope="module")
def data(results: dict[str, Result], tmp_path_factory: pytest.TempPathFactory) -> Data:
    """The JSON of the file of the first."""
    path = tmp_path_factory.mktemp("pairs") / "r.json"
    workhold.save(results["best"], path)
    content: Data = json.loads(path.read_text())
    return content


@pytest.fixture
def edited(data: Data, tmp_path: Path) -> Callable[[Edit], Verification]:
    """Verify the file after an edit of its JSON."""

    return lambda edit: verify_edited(data, edit, tmp_path)


def plus(values: Any, place: Any, by: float) -> None:
    """A number of a list or an object made larger."""
    values[place] += by


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda f: plus(f["pegs"][0]["force"], 1, 1e-5), "the force of the locator under clamp 2"),
        (
            lambda f: plus(f["wall"]["forces"][0], 0, 1e-5),
            "the force of the fence at its left end under clamp 1",
        ),
        (
            lambda f: plus(f["wall"]["forces"][1], 1, 1e-5),
            "the force of the fence at its right end under clamp 2",
        ),
        (lambda f: plus(f["wall"]["from"], 0, 1e-3), "from where the part touches"),
        (
            lambda f: f["wall"]["segments"].reverse() or plus(f["wall"]["segments"], 0, 1),
            "the fence at its left end",
        ),
        (lambda f: plus(f["pose"], "y", 1e-4), "away from touching face"),
        (lambda f: f.update(pairs=f["pairs"] + 1), "pairs of clamps, and there are"),
        (lambda f: f.update(pairs=f["pairs"] - 1), "pairs of clamps, and there are"),
        (lambda f: plus(f["quality"], "clamp_freedom", -1e-4), "its clamp freedom is"),
        (lambda f: plus(f["quality"], "location_error", 1e-6), "its location error is"),
        (lambda f: plus(f["quality"], "smallest_face", 1e-4), "its smallest face is"),
        (lambda f: plus(f["quality"], "wrench_radius", 1e-6), "its wrench radius is"),
        (
            lambda f: f["pegs"].reverse(),
            "its pegs are not one locator, the two ends of the fence and then two clamps",
        ),
        (lambda f: plus(f["pegs"][0], "row", 1), "the y of the locator"),
        (lambda f: f["pegs"][1].update(segment=f["pegs"][0]["segment"]), "clamp 1 is"),
        (lambda f: plus(f["pegs"][2], "y", 3e-6), "clamp 2"),
        (lambda f: f["pegs"][2].update(hole=None), "clamp 2 is not named by the hole in which it is bolted"),
    ],
)
def test_what_is_broken_by_hand_is_named(edited: Any, edit: Edit, words: str) -> None:
    """Of the first fixture; the others stay proven."""
    outcome = edited(lambda content: edit(content["fixtures"][0]))
    (item,) = outcome.unproven
    assert (item.index, item.verdict) == (0, "refuted") and words in item.reason


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda f: f["pegs"].pop(), "it does not have three pegs"),
        (lambda f: f["wall"].pop("forces"), "the forces of its wall are not two pairs"),
        (lambda f: f["wall"].update(forces=[0.5, 0.5]), "forces of its wall is 0.5, not two numbers"),
        (lambda f: f["wall"].update(to=None), "the to of its wall is not two numbers"),
        (lambda f: f.update(wall=[]), "its wall is not given by places"),
        (lambda f: f.pop("wall"), "it does not have five pegs"),
        (lambda f: f.update(type="clamp2"), "its type is not edge2"),
    ],
)
def test_files_with_something_unusable(edited: Any, edit: Edit, words: str) -> None:
    with pytest.raises(InputError, match=words):
        edited(lambda content: edit(content["fixtures"][0]))


@pytest.mark.thorough
def test_the_account_is_held_to_what_is_listed(results: dict[str, Result], edited: Any) -> None:
    """Seats, pairs, repetitions, the order, and what all pairs of a seat are."""

    def told(outcome: Verification) -> str:
        return "; ".join((*outcome.faults, *(item.reason for item in outcome.unproven)))

    assert told(edited(lambda content: None)) == ""
    assert "seats says 3, but found says" in told(edited(lambda content: content.update(seats=3)))
    assert "fixtures were found" in told(edited(lambda content: content["proof"].update(verified=2)))
    again = told(edited(lambda content: content["fixtures"].__setitem__(5, content["fixtures"][0])))
    assert "it has the seat and the directions of fixture 1" in again
    assert "the one before it" in told(edited(lambda content: content["fixtures"].reverse()))
    every = results["all"]
    seen, less = known_in(every.toolkit), len(every) - 1
    second = next(index for index, fixture in enumerate(every) if seen.add(index, fixture) is not None)
    table = every.table.take(np.delete(np.arange(len(every)), second))
    short = evolve(every, table=table, found={"edge2": less}, distinct={"edge2": less}, pairs=less)
    (fault,) = verify(short).faults
    assert "pairs of clamps at the seat of fixture" in fault
    assert verify(every).faults == ()


@pytest.mark.thorough
def test_another_pair_of_the_seat_is_not_the_best(results: dict[str, Result]) -> None:
    """Each pair of a seat in place of its best: proven just where it is as good."""
    best, every = results["best"], results["all"]
    seen, refuted = known_in(best.toolkit), 0
    for index, fixture in enumerate(best):
        seen.add(index, fixture)
    for place in range(0, len(every), 3):
        fixture = every[place]
        there = seen.find(fixture)
        assert there is not None and fixture.pair is not None
        listed = best[there]
        assert listed.pair is not None
        swap = evolve(fixture, pair=evolve(fixture.pair, count=listed.pair.count))
        ruling = verify_fixture(swap, best.workpiece, best.toolkit)
        worse = listed.quality["clamp_freedom"] - fixture.quality["clamp_freedom"] > 1e-3
        worse |= listed.quality["closure_margin"] - fixture.quality["closure_margin"] > 1e-6
        assert ruling.verdict == ("refuted" if worse else "proven"), (place, ruling)
        assert "pair of clamps at its seat has a" in ruling.reason or not worse
        refuted += worse
    assert refuted > 3


def test_rows_count_from_the_wall(results: dict[str, Result]) -> None:
    """A fence with fewer rows has no hole for some, and none below the first."""
    first = max(results["best"], key=lambda fixture: max(peg.row for peg in fixture.pegs))
    highest = max(peg.row for peg in first.pegs)
    assert highest >= 2
    low = evolve(results["best"].toolkit, rows=highest)
    ruling = verify_fixture(first, results["best"].workpiece, low)
    assert (
        ruling.verdict == "refuted" and f"is in row {highest} of a plate with {highest} rows" in ruling.reason
    )
    under = (evolve(first.pegs[0], row=-1), *first.pegs[1:])
    ruling = verify_fixture(evolve(first, pegs=under), results["best"].workpiece, results["best"].toolkit)
    assert ruling.verdict == "refuted" and "the locator is in row -1" in ruling.reason


def test_a_tip_keeps_off_the_wall() -> None:
    """A thicker one beside a part on the first row, which is as far from the wall as a locator's radius."""
    toolkit = fence(wall_offset=3, directions=ALL[:1])
    result = design(part(BLOCK), toolkit, listing="all")
    first = next(fixture for fixture in result if fixture.pegs[3].row == 0)
    clamp, pair = first.pegs[3], first.pair
    assert pair is not None
    pegs = (*first.pegs[:3], evolve(clamp, x=clamp.x + 1.0), evolve(first.pegs[4], y=first.pegs[4].y + 1.0))
    travels = pair.travels[0] + 1.0, pair.travels[1] + 1.0
    thick = evolve(first, pegs=pegs, travel=travels[0], pair=evolve(pair, travels=travels))
    ruling = verify_fixture(thick, result.workpiece, evolve(toolkit, clamp_radius=4.0))
    assert ruling.verdict == "refuted" and "clamp 1 enters the fence by 1 mm" in ruling.reason


def test_an_undecided_pair_is_named_as_it_must_be(results: dict[str, Result]) -> None:
    """By its kind, directions and faces."""
    result = results["best"]
    entries: list[UndecidedCandidate] = pairs_undecided(result.table.take(np.arange(3)), result.toolkit)
    assert faults_of(entries, result.query) == []
    single = f"edge {entries[0].type.split()[1]}"
    four = evolve(entries[0], type=single, faces=entries[0].faces[:4], columns=(0,) * 4, rows=(0,) * 4)
    assert faults_of([four], result.query) == []
    for edit in ({"type": "edge2 -x +x"}, {"type": "clamp2 -x -y"}, {"faces": (99, *entries[0].faces[1:])}):
        assert len(faults_of([evolve(entries[0], **edit)], result.query)) == 1, edit
