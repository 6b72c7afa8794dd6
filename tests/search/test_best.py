"""The best K alone: the same as the first K of all, whatever is left out on the way; and the count of contacts."""

from __future__ import annotations

from pathlib import Path
from threading import Event
from time import sleep

import numpy as np
import pytest

from workhold import Query, Vise, Workpiece, count_contacts, design, load, save
from workhold.contact.problem import Problem
from workhold.listing.collector import BestFixtures, InterestLimits
from workhold.listing.ranking import measure_table
from workhold.model.fixture_table import FixtureTable
from workhold.search.toolkit_search import ToolkitSearch

# Parts with ties, equal holes in two places, sliding pairs and coincidences; how many to keep.
CASES = [
    ("widget", Vise(pitch=8, columns=2, peg_radius=3), 7),
    ("flange", Vise(pitch=10, columns=2, peg_radius=3), 40),
    ("oblongPart", Vise(pitch=8, columns=4, peg_radius=3), 25),
    ("small4Handle", Vise(pitch=10, columns=10, peg_radius=3), 1),
    ("small4Handle", Vise(pitch=10, columns=10, peg_radius=3), 300),
    ("large4Handle", Vise(pitch=10, columns=3, peg_radius=3, rows=8, max_opening=60), 20),
    ("thin4Handle", Vise(pitch=10, columns=1, peg_radius=3, row_offset=2.5), 100_000),
]
MARGIN = ["closure-margin"]


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(("name", "vise", "most"), CASES)
@pytest.mark.parametrize(
    ("threads", "rank_by"),
    [(1, ["closure-margin"]), (3, ["closure-margin"]), (2, ["clamp-amplification", "end-distance"])],
)
def test_the_best_are_the_first_of_all(
    name: str, vise: Vise, most: int, threads: int, rank_by: list[str]
) -> None:
    """Ties fall as in the full ranking, on any number of threads and whatever is ranked by."""
    full = design(load(name), vise, rank_by=rank_by)
    best = design(load(name), vise, rank_by=rank_by, best=most, threads=threads)
    assert len(best) == min(most, len(full))
    assert list(best) == list(full[: len(best)])
    assert best.proof is not None and not best.proof.undecided


@pytest.mark.thorough
def test_what_is_left_out_does_not_depend_on_threads(tmp_path: Path) -> None:
    """The file of a search for the best, counts of its work included, is the same byte for byte."""
    files = []
    for threads in (1, 2, 5):
        best = design(
            load("oblongPart"),
            Vise(pitch=8, columns=4, peg_radius=3),
            rank_by=MARGIN,
            best=25,
            threads=threads,
        )
        files.append(tmp_path / f"{threads}.json")
        save(best, files[-1])
    assert len({file.read_bytes() for file in files}) == 1
    assert any("not counted" in str(note) for note in best.notes)


def test_more_than_there_are_is_all_of_them() -> None:
    """When nothing is left out the result counts all, and does not say otherwise."""
    part, vise = load("widget"), Vise(pitch=8, columns=1, peg_radius=3)
    full, best = design(part, vise), design(part, vise, best=10_000)
    assert list(best) == list(full)
    assert best.found == full.found and best.notes == full.notes


@pytest.mark.thorough
def test_work_is_left_out() -> None:
    """Fewer contacts are examined, and fewer crossings sought, for the very best than for all."""
    part, vise = load("oblongPart"), Vise(pitch=4, columns=6, peg_radius=1.5)
    full, best = (design(part, vise, rank_by=MARGIN, best=most, threads=1) for most in (None, 3))
    assert best.statistics["contacts_examined"] < full.statistics["contacts_examined"]
    assert best.statistics["crossings_sought"] < full.statistics["crossings_sought"]


def test_the_margin_to_reach_never_exceeds_that_of_the_last_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the kernels are told rises, and stays below the margin of the last fixture listed in the end."""
    told: list[float] = []
    limits_from = ToolkitSearch.make_limits

    def watched(self: ToolkitSearch, margin: float, most: float) -> np.ndarray:
        told.append(margin)
        return limits_from(self, margin, most)

    monkeypatch.setattr(ToolkitSearch, "make_limits", watched)
    best = design(
        load("oblongPart"), Vise(pitch=8, columns=4, peg_radius=3), rank_by=MARGIN, best=25, threads=1
    )
    assert told == sorted(told) and told[-1] > 0.0
    assert told[-1] < np.round(best.table.null_vector[-1].min(), 9)


def test_only_what_is_kept_stays_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    """Between blocks no more candidates are held than the best and those that tie with the last."""
    held: list[int] = []
    decide = BestFixtures.decide

    def watched(self: BestFixtures) -> None:
        decide(self)
        assert self.kept is not None
        held.append(len(self.kept.standing))

    monkeypatch.setattr(BestFixtures, "decide", watched)
    monkeypatch.setattr("workhold.listing.collector.WAITING_LONG", 500)
    design(load("oblongPart"), Vise(pitch=8, columns=10, peg_radius=3), best=50)
    assert len(held) > 3 and max(held) < 50 * 8


@pytest.mark.thorough
def test_a_cancelled_search_keeps_the_best_so_far() -> None:
    """It is incomplete, and what it lists are fixtures."""
    part, vise = load("large4Handle"), Vise(pitch=10, columns=10, peg_radius=3)
    cancel = Event()
    best = design(part, vise, best=5, threads=1, cancel=cancel, progress=lambda fraction, found: cancel.set())
    assert not best.complete
    every = {(f.type, f.pegs) for f in design(part, vise)}
    assert all((f.type, f.pegs) in every for f in best)


def waiting_records(part: str, vise: Vise) -> tuple[Problem, list[np.ndarray]]:
    """A problem of the best five, and what its search hands over, in two shares."""
    problem = Problem.from_query(Query(load(part), vise, best=5))
    search = ToolkitSearch.from_problem(problem, threads=1)
    records = np.concatenate(
        [block.work(InterestLimits()) for block in search.make_blocks(problem.query.types)]
    )
    return problem, np.array_split(records, 2)


def test_nothing_is_decided_long_after_somebody_asked_to_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    """There is one time of grace for all that waits: what comes after it is left, and said to be."""
    monkeypatch.setattr("workhold.proof.deciding.GRACE", 0.01)
    problem, (first, second) = waiting_records("oblongPart", Vise(pitch=8, columns=4, peg_radius=3))
    cancel = Event()
    cancel.set()
    best = BestFixtures(problem, cancel)
    best.waiting.append(first)
    best.decide()
    sleep(0.02)
    best.waiting.append(second)
    before = sum(account.records for account in best.accounts)
    _, account = best.finish()
    assert account.records == before and account.left >= len(second) > 0


@pytest.mark.thorough
def test_what_waits_is_measured_a_share_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """However much waits, and the best are those of all at once."""
    problem, records = waiting_records("oblongPart", Vise(pitch=8, columns=4, peg_radius=3))
    at_once = BestFixtures(problem)
    at_once.waiting.extend(records)
    together, _ = at_once.finish()
    monkeypatch.setattr("workhold.listing.collector.BLOCK", 64)
    seen: list[int] = []

    def watched(table: FixtureTable, problem: Problem) -> FixtureTable:
        seen.append(len(table))
        return measure_table(table, problem)

    monkeypatch.setattr("workhold.listing.collector.measure_table", watched)
    in_shares = BestFixtures(problem)
    in_shares.waiting.extend(records)
    best, _ = in_shares.finish()
    assert len(seen) > 3 and max(seen) < 3 * 64
    assert np.array_equal(best.theta, together.theta) and np.array_equal(best.point, together.point)


def test_contacts_are_counted_before_closure_gap_and_clamping() -> None:
    """There are more contacts than fixtures, as many on one thread as on two, and none where no two pegs fit."""
    part, vise = load("widget"), Vise(pitch=8, columns=1, peg_radius=3)
    contacts = count_contacts(part, vise, threads=1)
    assert contacts == count_contacts(part, vise, threads=2)
    assert contacts > 10 * sum(design(part, vise).found.values())
    small = Workpiece.from_loops("small", [[[0, 0, 0], [4, 0, 0], [2, 3, 0]]])
    assert count_contacts(small, Vise(pitch=40, columns=1, peg_radius=3)) == 0


def test_contacts_of_a_square_by_hand() -> None:
    """The gap and the closure play no part: a wider smallest gap leaves the count as it is."""
    square = Workpiece.from_loops("square", [[[0, 0, 0], [31, 0, 0], [31, 31, 0], [0, 31, 0]]])
    near = count_contacts(square, Vise(pitch=10, columns=2, peg_radius=2))
    far = count_contacts(square, Vise(pitch=10, columns=2, peg_radius=2, min_gap=500))
    assert near == far > 0
