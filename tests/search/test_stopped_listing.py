"""A search of many fixtures that is stopped while they are put in order lists the best of them, soon, and says so."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from threading import Event
from typing import Any

import attrs
import numpy as np
import pytest

import workhold
from workhold import Query, Result, Vise
from workhold.cli import outputs
from workhold.cli.ending import Interrupted
from workhold.files.result.writer import make_notes_entry
from workhold.listing import collector, runs
from workhold.listing.collector import ResultCollector
from workhold.listing.results import MEASURED
from workhold.model.notes import Cut, KeptBest
from workhold.search.design import SEARCH
from workhold.search.seated import SEARCHED
from workhold.verification import verify, verify_file
from workhold.web import jobs
from workhold.web.searching import SearchOutcome

MOST = 41
SYMMETRIC = Query(workhold.load("small4Handle"), Vise(pitch=10, columns=2, peg_radius=3))
PLATE = workhold.Plate(pitch=25, peg_radius=3, columns=4, rows=4, directions=("-x", "-y"))
WAYS = Query(workhold.load("widget"), PLATE)
# Fractions that are told when all is measured and while it is listed.
ALL_MEASURED = SEARCH + (1.0 - SEARCH) * MEASURED - 1e-9
LISTING = (1.0 + ALL_MEASURED) / 2


@pytest.fixture(autouse=True)
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few are many."""
    monkeypatch.setattr(collector, "LISTED_LATE", MOST)
    for name, value in (("PART", 30), ("STRIDE", 5)):
        monkeypatch.setattr(runs, name, value)


def in_memory(query: Query, folder: Path, **watching: Any) -> Result:
    return workhold.answer(query, threads=1, **watching)


def in_a_file(query: Query, folder: Path, **watching: Any) -> Result:
    return workhold.answer_to_file(query, folder / "a.npz", threads=1, **watching)


def stopped_at(fraction: float) -> dict[str, Any]:
    """A cancel that is set once that much is done."""
    cancel = Event()

    def progress(done: float, found: int) -> None:
        if done >= fraction:
            cancel.set()

    return {"cancel": cancel, "progress": progress}


def cut(listed: int, query: Query = SYMMETRIC) -> Result:
    """What a search that is stopped after all is found lists."""
    return workhold.answer(query).slice_rows(slice(listed)).mark_cut_short(listed)


@pytest.mark.thorough
@pytest.mark.parametrize("answer", [in_memory, in_a_file])
def test_the_best_are_listed_and_all_are_counted(answer: Callable[..., Result], tmp_path: Path) -> None:
    """Stopped once all are measured. The file is whole, too, with less in it than it had room for."""
    result = answer(SYMMETRIC, tmp_path, **stopped_at(ALL_MEASURED))
    whole = answer(SYMMETRIC, tmp_path / "..")
    assert len(whole) > 3 * MOST
    assert list(result) == list(whole)[:MOST] and not result.complete
    assert (result.found, result.distinct, result.proof) == (whole.found, whole.distinct, whole.proof)
    (note,) = result.notes
    assert str(note) == (
        f"Stopped with {len(whole)} fixtures found: the best 41 of them are listed; more would have taken long."
    )
    outcome = verify(result)
    assert (outcome.proven, outcome.faults) == (MOST, ())


@pytest.mark.thorough
def test_what_is_listed_before_somebody_asks_to_stop_stays(tmp_path: Path) -> None:
    """In a file it is written by then; what follows is not."""
    result, whole = (
        in_a_file(SYMMETRIC, tmp_path, **stopped_at(LISTING)),
        in_a_file(SYMMETRIC, tmp_path / ".."),
    )
    assert MOST < len(result) < len(whole)
    assert list(result) == list(whole)[: len(result)]
    assert result.notes == (Cut(len(whole), len(result)),)
    with np.load(tmp_path / "a.npz") as columns:
        assert len(columns["theta"]) == len(result)
    assert len(in_memory(SYMMETRIC, tmp_path, **stopped_at(LISTING))) == MOST


@pytest.mark.thorough
def test_what_is_not_measured_soon_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Asked to stop before, the first parts are measured, and counts are those of what is."""
    monkeypatch.setattr("workhold.proof.deciding.GRACE", 0.0)
    decided = ResultCollector.finish_deciding

    def deciding(self: ResultCollector, progress: Any = None) -> Any:
        account = decided(self, progress)
        if self.cancel is not None:
            self.cancel.set()
        return account

    monkeypatch.setattr(ResultCollector, "finish_deciding", deciding)
    result = workhold.answer(SYMMETRIC, cancel=Event())
    assert not result.complete and 0 < len(result) == sum(result.found.values()) <= MOST
    everything = {fixture.pose.theta_deg for fixture in workhold.answer(SYMMETRIC)}
    assert {fixture.pose.theta_deg for fixture in result} < everything
    outcome = verify(result)
    assert (outcome.proven, outcome.faults) == (len(result), ())


@pytest.mark.thorough
def test_of_several_ways_the_best_of_all_are_listed(tmp_path: Path) -> None:
    """Stopped in the last of the ways, which lists no more than the best of its own."""
    whole, result = (
        workhold.answer(WAYS),
        workhold.answer(
            WAYS,
            threads=1,
            **stopped_at((len(WAYS.toolkit.ways) - 1 + ALL_MEASURED) / len(WAYS.toolkit.ways)),
        ),
    )
    assert len(PLATE.ways) == 2 and list(result) == list(whole)[:MOST] and len(whole) > MOST
    assert result.notes == (Cut(len(whole), MOST),) and not result.complete
    assert verify(result).holds


@pytest.mark.parametrize("answer", [in_memory, in_a_file])
def test_rules_for_the_seating_say_how_many_were_looked_at_instead(
    answer: Callable[..., Result], tmp_path: Path
) -> None:
    query = attrs.evolve(SYMMETRIC, seating=3, opening=1.0)
    result = answer(query, tmp_path, **stopped_at(SEARCHED * ALL_MEASURED))
    assert not result.complete and [str(note).partition(":")[0] for note in result.notes] == [
        "The seating of the first 0 fixtures was worked out"
    ]
    assert verify(result).holds


@pytest.mark.thorough
def test_a_file_that_was_cut_short_must_say_so(tmp_path: Path) -> None:
    """It is incomplete, and its numbers are those of what it lists."""
    workhold.save(cut(MOST), tmp_path / "a.json")
    said = json.loads((tmp_path / "a.json").read_text())
    found = sum(said["found"].values())
    assert verify_file(tmp_path / "a.json").holds
    for wrong in ({"complete": True}, make_notes_entry([]), make_notes_entry([Cut(found, MOST + 1)])):
        (tmp_path / "b.json").write_text(json.dumps(said | wrong))
        assert not verify_file(tmp_path / "b.json").holds
    workhold.save(workhold.answer(SYMMETRIC).mark_cut_short(found), tmp_path / "b.json")
    assert not verify_file(tmp_path / "b.json").holds


def test_a_server_that_keeps_fewer_says_that_alone() -> None:
    """So many were found, and so many are kept; those in between nobody sees."""
    result = cut(MOST)
    job = jobs.ServerJob.__new__(jobs.ServerJob)
    job.task, job.fraction, job.revision, job.orders = None, 0.0, 0, {}
    jobs.JobRegistry.keep_outcome(
        jobs.JobRegistry.__new__(jobs.JobRegistry),
        job,
        SearchOutcome(result.slice_rows(slice(10)), MOST - 10),
    )
    assert job.notes == (KeptBest(sum(result.found.values()), 10),)
    assert verify(job.result).holds


@pytest.mark.thorough
def test_stopped_while_the_file_is_written_the_best_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a result that is small enough nothing else is tried, nor of one that goes to the terminal."""
    whole, write, tries = workhold.answer(SYMMETRIC), outputs.write_output, list[int]()

    def interrupted(result: Result, out: str, form: str) -> None:
        tries.append(len(result))
        if len(tries) == 1:
            raise Interrupted
        write(result, out, form)

    monkeypatch.setattr(outputs, "write_output", interrupted)
    monkeypatch.setattr(outputs, "note_results_to_keep", lambda: None)
    written = outputs.write_found(whole, str(tmp_path / "a.json"), "json")
    assert tries == [len(whole), MOST]
    assert written == cut(MOST) and len(workhold.open(tmp_path / "a.json")) == MOST
    for result, out in ((whole.slice_rows(slice(MOST)), str(tmp_path / "b.json")), (whole, "-")):
        tries.clear()
        with pytest.raises(Interrupted):
            outputs.write_found(result, out, "json")
        assert len(tries) == 1
