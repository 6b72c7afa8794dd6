"""A result file that says it is a part is held against the whole by a search of its query: nothing of it is refuted for what
it lacks, and what is not among all there are is."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from threading import Event
from typing import Any

import attrs
import numpy as np
import pytest

from workhold import Query, Result, Vise, Workpiece, answer, load, verify
from workhold.algebra import find_fixtures_by_algebra
from workhold.completeness import find_other_entries
from workhold.files.result.writer import make_notes_entry, write_result
from workhold.model.notes import KeptBest, Stopped
from workhold.model.search_report import ProofReport, UndecidedCandidate
from workhold.search.seated import answer_with_seating
from workhold.verification import Verification

VISE = Vise(pitch=8, columns=1, peg_radius=3)


@pytest.fixture(scope="module")
def whole() -> Result:
    """All 505 fixtures of the widget."""
    return answer(Query(load("widget"), VISE))


@pytest.fixture(scope="module")
def interrupted() -> Result:
    """A part of them, as Ctrl-C leaves it."""
    cancel = Event()

    def stop(fraction: float, found: int) -> None:
        if found > 100:
            cancel.set()

    return answer(Query(load("widget"), VISE), threads=1, progress=stop, cancel=cancel)


def cut_short(whole: Result, kept: int) -> Result:
    """What a server writes that stopped after every third was found, and kept the first of those."""
    found = np.arange(1, len(whole), 3)
    numbers = [int((whole.table.arrangement[found] == kind).sum()) for kind in range(len(whole.found))]
    told = dict(zip(whole.found, numbers, strict=True))
    notes = [Stopped(1.5), *([KeptBest(len(found), kept)] if kept < len(found) else [])]
    table = whole.table.take(found[:kept])
    return attrs.evolve(whole, table=table, complete=False, found=told, distinct=told, notes=tuple(notes))


def compared(result: Result, folder: Path, edit: Callable[[dict[str, Any]], object] = bool) -> Verification:
    """The verification with a search of a result's file, after an edit of its JSON."""
    path = folder / "result.json"
    write_result(result, path)
    data = json.loads(path.read_text())
    edit(data)
    path.write_text(json.dumps(data))
    return verify(path, complete=True)


@pytest.mark.thorough
def test_an_interrupted_search_is_a_part_of_the_whole(interrupted: Result, tmp_path: Path) -> None:
    assert 0 < len(interrupted) < 505 and not interrupted.complete
    outcome = compared(interrupted, tmp_path)
    assert outcome.is_compared and outcome.holds and outcome.proven == len(interrupted)


@pytest.mark.thorough
@pytest.mark.parametrize("kept", [10, 40, 168])
def test_what_a_server_cut_short_is_a_part_of_the_whole(whole: Result, tmp_path: Path, kept: int) -> None:
    """The best of a part need not be among the best of all."""
    outcome = compared(cut_short(whole, kept), tmp_path)
    assert (outcome.is_compared, outcome.faults, outcome.proven) == (True, (), kept)


@pytest.mark.thorough
def test_the_best_that_a_server_kept_are_the_best_of_all(whole: Result, tmp_path: Path) -> None:
    """Of a search that came to its end, another fixture than the best is one too many."""
    kept = attrs.evolve(whole, table=whole.table.take(np.arange(40)), notes=(KeptBest(505, 40),))
    assert compared(kept, tmp_path).holds
    others = attrs.evolve(kept, table=whole.table.take(np.arange(1, 41)))
    assert any(
        "does not find 1 fixture of it, the first of them fixture 40" in x
        for x in compared(others, tmp_path).faults
    )


@pytest.mark.thorough
def test_a_fixture_that_is_none_is_found_in_a_part(interrupted: Result, tmp_path: Path) -> None:
    """Those of a wider query: what a larger contact margin rules out."""

    def narrower(data: dict[str, Any]) -> None:
        data["contact_margin"] = 0.4

    words = {fault.split(",")[0] for fault in compared(interrupted, tmp_path, narrower).faults}
    assert any(word.startswith("a search does not find ") for word in words)


@pytest.mark.thorough
def test_more_found_than_there_are_is_no_part(whole: Result, tmp_path: Path) -> None:
    """Though the file by itself may be right: not all that is found is listed."""
    every = whole.counts["I"]

    def more(data: dict[str, Any]) -> None:
        data["found"]["I"] = data["distinct"]["I"] = every + 1
        data["proof"].update(candidates=9_999, verified=9_999, discarded_by_bound=0)
        data |= make_notes_entry([Stopped(1.5), KeptBest(every + 1 + data["found"]["II"], 40)])

    outcome = compared(cut_short(whole, 40), tmp_path, more)
    assert outcome.faults == (f"found says {every + 1} for I, and there are {every} in all",)


def test_undecided_orientations_go_round(whole: Result) -> None:
    """Just below a turn is just above none; farther off is another candidate."""
    assert whole.proof is not None

    def named(theta: float) -> ProofReport:
        entry = UndecidedCandidate(
            "I", (0, 1, 2, 3), (0, 1, 0, 1), (0, 0, 1, 1), theta, "its rows are parallel", 1e-9
        )
        return ProofReport(1, 1, 0, 0, 1, (entry,))

    assert not list(find_other_entries(named(360 - 1e-9), named(1e-9)))
    assert len(list(find_other_entries(named(0.5), named(0.6)))) == 1


@pytest.mark.thorough
def test_the_best_of_the_algebra_are_chosen_by_their_seating_again() -> None:
    """The search of their query is that of the algebra, and orders the first by their seating, too."""
    wedge, vise = Workpiece.from_loops("wedge", [[[0, 0, 0], [70, 0, 0], [25, 55, 0]]]), Vise(20, 2, 3)
    query = Query(wedge, vise, seating=8, best=3)
    made, plain = (
        answer_with_seating(query, find_fixtures_by_algebra),
        find_fixtures_by_algebra(query.without_seating),
    )
    assert len(made) == 3 and [f.pose for f in made] != [f.pose for f in plain[:3]]
    outcome = verify(made, complete=True)
    assert outcome.holds and outcome.is_compared
