"""Deciding reports how far it is, stops when asked, and then lists nothing that is not decided."""

from __future__ import annotations

from threading import Event
from time import sleep

import numpy as np
import pytest
from numpy.typing import NDArray

from workhold import Vise, load
from workhold.contact.problem import Problem
from workhold.listing import collector as finish_module
from workhold.listing.results import Work, listed_result
from workhold.model.result import Result
from workhold.proof import deciding
from workhold.proof import interval_newton as settling
from workhold.proof.deciding import Course, decided, merged
from workhold.search import design as design_module


@pytest.fixture(scope="module")
def found() -> tuple[Problem, list[NDArray[np.float64]], Result]:
    """The oblong part with many nearly double contacts: problem, records and result."""
    kept: list[tuple[Problem, list[NDArray[np.float64]]]] = []

    def keep(problem: Problem, records: list[NDArray[np.float64]], work: Work, **options: object) -> Result:
        kept.append((problem, records))
        return listed_result(problem, records, work, **options)  # type: ignore[arg-type]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(design_module, "listed_result", keep)
        result = design_module.design(load("oblongPart"), Vise(pitch=8, columns=2, peg_radius=3))
    return *kept[0], result


def test_progress_of_the_listing_rises_to_its_end(
    found: tuple[Problem, list[NDArray[np.float64]], Result],
) -> None:
    """Every record is counted once, whatever stage decides it, and what is kept are the fixtures."""
    problem, records, _ = found
    seen: list[tuple[float, int]] = []
    together = np.concatenate(records)
    course = Course(len(together), lambda fraction, kept: seen.append((fraction, kept)))
    proven, _ = decided(together, problem, course)
    assert seen == sorted(seen)
    assert course.done == len(together)
    assert seen[-1] == (1.0, len(proven))


def test_a_cancel_leaves_what_takes_long(found: tuple[Problem, list[NDArray[np.float64]], Result]) -> None:
    """Fixtures that a certificate proves are listed; the others are neither listed nor undecided, and the result says that
    it is incomplete."""
    problem, records, result = found
    cancel = Event()
    cancel.set()
    part = listed_result(problem, records, Work(True, {}), cancel=cancel)
    assert not part.complete
    assert part.proof is not None and result.proof is not None
    assert part.proof.undecided == ()
    assert 0 < len(part) <= len(result)
    assert part.proof.candidates < sum(map(len, records))
    assert part.proof.escalated < result.proof.escalated
    proof = part.proof
    assert proof.candidates == proof.discarded_by_bound + proof.verified
    everything = listed_result(problem, records, Work(True, {}), cancel=Event())
    assert everything.complete
    assert len(everything) == len(result)


def test_a_cancel_on_the_way_stops_ball_arithmetic(
    found: tuple[Problem, list[NDArray[np.float64]], Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Boxes that doubles give up go to ball arithmetic one by one; a cancel there leaves the rest."""
    problem, records, _ = found
    monkeypatch.setattr(deciding, "interval_newton_in_doubles", lambda block, *_: (block[:0], block))
    monkeypatch.setattr(deciding, "hold_nothing", lambda records, _: np.zeros(len(records), np.bool_))
    cancel = Event()
    looked_at = []
    original = deciding.record_in_balls

    def one(*arguments: object) -> object:
        looked_at.append(arguments)
        if len(looked_at) == 3:
            cancel.set()
        return original(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(deciding, "record_in_balls", one)
    together = np.concatenate(records)
    _, account = decided(together, problem, Course(len(together), cancel=cancel))
    assert len(looked_at) == 3
    assert account.left > 0
    assert account.records + account.left == len(together)


def test_both_kinds_of_interval_arithmetic_decide_alike(
    found: tuple[Problem, list[NDArray[np.float64]], Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With everything open sent to ball arithmetic the same records are proven."""
    problem, records, result = found
    monkeypatch.setattr(deciding, "interval_newton_in_doubles", lambda block, *_: (block[:0], block))
    other = listed_result(problem, records, Work(True, {}))
    assert np.array_equal(other.table.column, result.table.column)
    assert np.array_equal(other.table.row, result.table.row)
    assert np.abs(other.table.theta - result.table.theta).max() < 1e-12
    assert other.proof is not None and result.proof is not None
    assert other.proof.verified == result.proof.verified
    assert set(other.query.arrangements) == set(other.found)


def test_overlapping_boxes_of_the_same_pegs_are_one(
    found: tuple[Problem, list[NDArray[np.float64]], Result],
) -> None:
    """The box of both holds both; another place, or other pegs, stay apart."""
    problem, records, _ = found
    first = np.concatenate(records)[0]
    near, far, other = first.copy(), first.copy(), first.copy()
    for row in (first, near, far, other):
        row[17:] = 1e-6
    near[14] += 1e-6
    far[14] += 1.0
    other[1] += 1
    rows = merged(np.array([first, near, far, other]), problem)
    assert len(rows) == 3
    together = rows[(rows[:, 1] == first[1]) & (rows[:, 14] < first[14] + 0.5)][0]
    assert together[14] - together[18] <= first[14] - 1e-6
    assert together[14] + together[18] >= near[14] + 1e-6


def test_one_thread_at_a_time_works_with_balls(monkeypatch: pytest.MonkeyPatch) -> None:
    """The precision of ball arithmetic belongs to the whole process: with every open record sent there, from small blocks
    on many threads, no two boxes are decided at the same time, and the outcome is the same as on one thread."""
    inside, most = [0], [0]
    solutions_in = settling.solutions_in

    def watched(*arguments: object) -> object:
        inside[0] += 1
        most[0] = max(most[0], inside[0])
        sleep(1e-3)
        try:
            return solutions_in(*arguments)  # type: ignore[arg-type]
        finally:
            inside[0] -= 1

    monkeypatch.setattr(settling, "solutions_in", watched)
    monkeypatch.setattr(deciding, "interval_newton_in_doubles", lambda block, *_: (block[:0], block))
    monkeypatch.setattr(finish_module, "BLOCK", 8)
    part, vise = load("oblongPart"), Vise(pitch=8, columns=2, peg_radius=3)
    one, many = (design_module.design(part, vise, threads=threads) for threads in (1, 8))
    assert most == [1]
    assert one.proof is not None and one.proof.escalated > 0 and one.proof == many.proof
    assert np.array_equal(one.table.theta, many.table.theta)
