"""Deciding reports how far it is, stops when asked, and then lists nothing that is not decided."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, pi, sin
from pathlib import Path
from threading import Event
from time import sleep
from typing import Any

import numpy as np
import pytest
from flint import arb
from numpy.typing import NDArray

from chord_examples import arc_row, line_row
from workhold import Query, Result, Vise, design, load
from workhold.contact.problem import Problem
from workhold.conventions import END_SLACK
from workhold.kernels.contact import record
from workhold.listing import collector as finish_module
from workhold.listing.results import SearchWork, list_result
from workhold.proof import deciding
from workhold.proof import interval_newton as settling
from workhold.proof.ball_contacts import compute_end_slacks
from workhold.proof.deciding import (
    DecidingProgress,
    bound_box,
    decide_by_interval_newton,
    decide_records,
    merge_overlapping_records,
)
from workhold.search import design as design_module


@pytest.fixture(scope="module")
def found() -> tuple[Problem, list[NDArray[np.float64]], Result]:
    """The oblong part with many nearly double contacts: problem, records and result."""
    kept: list[tuple[Problem, list[NDArray[np.float64]]]] = []

    def keep(
        problem: Problem, records: list[NDArray[np.float64]], work: SearchWork, **options: object
    ) -> Result:
        kept.append((problem, records))
        return list_result(problem, records, work, **options)  # type: ignore[arg-type]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(design_module, "list_result", keep)
        result = design_module.design(load("oblongPart"), Vise(pitch=8, columns=2, peg_radius=3))
    return *kept[0], result


def test_progress_of_the_listing_rises_to_its_end(
    found: tuple[Problem, list[NDArray[np.float64]], Result],
) -> None:
    """Every record is counted once, whatever stage decides it, and what is kept are the fixtures."""
    problem, records, _ = found
    seen: list[tuple[float, int]] = []
    together = np.concatenate(records)
    course = DecidingProgress(len(together), lambda fraction, kept: seen.append((fraction, kept)))
    proven, _ = decide_records(together, problem, course)
    assert seen == sorted(seen)
    assert course.done == len(together)
    assert seen[-1] == (1.0, len(proven))


def test_a_cancel_leaves_what_takes_long(found: tuple[Problem, list[NDArray[np.float64]], Result]) -> None:
    """Fixtures that a certificate proves are listed; the others are neither listed nor undecided, and the result says that
    it is incomplete."""
    problem, records, result = found
    cancel = Event()
    cancel.set()
    part = list_result(problem, records, SearchWork(True, {}), cancel=cancel)
    assert not part.complete
    assert part.proof is not None and result.proof is not None
    assert part.proof.undecided == ()
    assert 0 < len(part) <= len(result)
    assert part.proof.candidates < sum(map(len, records))
    assert part.proof.escalated < result.proof.escalated
    proof = part.proof
    assert proof.candidates == proof.discarded_by_bound + proof.verified
    everything = list_result(problem, records, SearchWork(True, {}), cancel=Event())
    assert everything.complete
    assert len(everything) == len(result)


def test_a_cancel_on_the_way_stops_ball_arithmetic(
    found: tuple[Problem, list[NDArray[np.float64]], Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Boxes that doubles give up go to ball arithmetic one by one; a cancel there leaves the rest."""
    problem, records, _ = found
    monkeypatch.setattr(deciding, "decide_by_interval_newton", lambda block, *_: (block[:0], block))
    monkeypatch.setattr(deciding, "cannot_hold", lambda records, _: np.zeros(len(records), np.bool_))
    cancel = Event()
    looked_at = []
    original = deciding.decide_record_in_balls

    def one(*arguments: object) -> object:
        looked_at.append(arguments)
        if len(looked_at) == 3:
            cancel.set()
        return original(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(deciding, "decide_record_in_balls", one)
    together = np.concatenate(records)
    _, account = decide_records(together, problem, DecidingProgress(len(together), cancel=cancel))
    assert len(looked_at) == 3
    assert account.left > 0
    assert account.records + account.left == len(together)


@pytest.mark.parametrize(
    ("slow", "sizes"),
    [
        ((), [16, 32, 64, 128, 256, 512, 1024, 1024, 944]),
        # After a block that takes long few records are looked at again between two looks at the flag.
        ((3, 4), [16, 32, 64, 128, 16, 16, 32, 64, 128, 256, 512, 1024, 1024, 688]),
        (range(300), [16] * 250),
    ],
)
def test_more_open_records_are_looked_at_together_as_long_as_that_is_quick(
    slow: Sequence[int],
    sizes: list[int],
    found: tuple[Problem, list[NDArray[np.float64]], Result],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Twice as many after each quick block, up to a limit; each record once, in order."""
    records = np.arange(4000.0)[:, None] * np.ones(record.RECORD_LENGTH)
    blocks, clock = list[NDArray[np.float64]](), [0.0]

    def look(block: NDArray[np.float64], *_: object) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        clock[0] += 1.0 if len(blocks) in slow else 0.9 * deciding.QUICK
        blocks.append(block)
        return block[:1], block[:0]

    monkeypatch.setattr(deciding, "sift_records", lambda records, *_: (records[:0], records))
    monkeypatch.setattr(deciding, "merge_overlapping_records", lambda records, _: records)
    monkeypatch.setattr(deciding, "decide_by_interval_newton", look)
    monkeypatch.setattr(deciding, "perf_counter", lambda: clock[0])
    course = DecidingProgress(len(records))
    proven, reasons, left = deciding.escalate_records(records, found[0], course)
    assert [len(block) for block in blocks] == sizes[: len(blocks)]
    assert len(blocks) == len(sizes)
    assert np.array_equal(np.concatenate(blocks), records)
    assert proven[:, 0].tolist() == [block[0, 0] for block in blocks]
    assert (reasons, left, course.done) == ([], 0, 4000)


def test_a_stop_between_blocks_leaves_the_others(
    found: tuple[Problem, list[NDArray[np.float64]], Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those that were looked at are decided, and all others are left."""
    records, cancel = np.zeros((100, record.RECORD_LENGTH)), Event()

    def look(block: NDArray[np.float64], *_: object) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        if len(block) == 32:
            cancel.set()
        return block, block[:0]

    monkeypatch.setattr(deciding, "sift_records", lambda records, *_: (records[:0], records))
    monkeypatch.setattr(deciding, "merge_overlapping_records", lambda records, _: records)
    monkeypatch.setattr(deciding, "decide_by_interval_newton", look)
    monkeypatch.setattr(deciding, "QUICK", 1e9)
    proven, _, left = deciding.escalate_records(records, found[0], DecidingProgress(100, cancel=cancel))
    assert (len(proven), left) == (48, 52)


def test_both_kinds_of_interval_arithmetic_decide_alike(
    found: tuple[Problem, list[NDArray[np.float64]], Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With everything open sent to ball arithmetic the same records are proven."""
    problem, records, result = found
    monkeypatch.setattr(deciding, "decide_by_interval_newton", lambda block, *_: (block[:0], block))
    other = list_result(problem, records, SearchWork(True, {}))
    assert np.array_equal(other.table.column, result.table.column)
    assert np.array_equal(other.table.row, result.table.row)
    assert np.abs(other.table.theta - result.table.theta).max() < 1e-12
    assert other.proof is not None and result.proof is not None
    assert other.proof.verified == result.proof.verified
    assert set(other.query.types) == set(other.found)


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
    rows = merge_overlapping_records(np.array([first, near, far, other]), problem)
    assert len(rows) == 3
    together = rows[(rows[:, 1] == first[1]) & (rows[:, 14] < first[14] + 0.5)][0]
    assert together[14] - together[18] <= first[14] - 1e-6
    assert together[14] + together[18] >= near[14] + 1e-6


@pytest.mark.thorough
def test_one_thread_at_a_time_works_with_balls(monkeypatch: pytest.MonkeyPatch) -> None:
    """The precision of ball arithmetic belongs to the whole process: with every open record sent there, from small blocks
    on many threads, no two boxes are decided at the same time, and the outcome is the same as on one thread."""
    inside, most = [0], [0]
    solutions_in = settling.find_solutions

    def watched(*arguments: object) -> object:
        inside[0] += 1
        most[0] = max(most[0], inside[0])
        sleep(1e-3)
        try:
            return solutions_in(*arguments)  # type: ignore[arg-type]
        finally:
            inside[0] -= 1

    monkeypatch.setattr(settling, "find_solutions", watched)
    monkeypatch.setattr(deciding, "decide_by_interval_newton", lambda block, *_: (block[:0], block))
    monkeypatch.setattr(finish_module, "BLOCK", 8)
    part, vise = load("oblongPart"), Vise(pitch=8, columns=2, peg_radius=3)
    one, many = (design_module.design(part, vise, threads=threads) for threads in (1, 8))
    assert most == [1]
    assert one.proof is not None and one.proof.escalated > 0 and one.proof == many.proof
    assert np.array_equal(one.table.theta, many.table.theta)


# The boxes in which the exact contacts of records are, and the ends of features that decide them in balls.
def test_the_separation_is_known_to_what_both_pegs_and_the_turn_allow() -> None:
    """Two pegs 2 L apart across the travel, each off by the radius, in a frame off by the reach, are off by both radii and
    2 L times the reach along it; the box holds that."""
    row, length, radius, reach = np.zeros((1, record.RECORD_LENGTH)), 30.0, 1e-3, 1e-4
    row[0, [record.REACH, record.LARGEST_RADIUS]] = reach, radius
    off = 2 * radius * cos(reach) + 2 * length * sin(reach)
    assert off <= bound_box(row, length)[0, 3] <= 1.01 * off


@pytest.mark.parametrize("row", [line_row(0, 0, 0, 5.0), arc_row(0, 0, 5.0, 0.0, 1.0)], ids=["line", "arc"])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_contact_past_an_end_counts_at_a_tangent_joint_alone(row: np.ndarray, side: int) -> None:
    """Half a hair past an end the rule is kept where the joint is tangent and broken where it is not, at either end, and the
    margin comes on top."""
    past = row[5] + 0.5 * END_SLACK / (row[6] or 1.0)
    place = (side * past, 0.0) if row[6] == 0.0 else (row[6] * cos(side * past), row[6] * sin(side * past))
    for smooth in (-1, 1):
        ends = [-END_SLACK, -END_SLACK]
        ends[(side + 1) // 2] *= -smooth
        slacks = compute_end_slacks([*row, *ends], (arb(place[0]), arb(place[1])), 0.0)
        nearest = min(slacks, key=lambda slack: float(slack.mid()))
        assert (nearest > 0) == (smooth == 1) and (nearest < 0) == (smooth == -1)
        assert (
            min(
                float(slack.mid())
                for slack in compute_end_slacks([*row, *ends], (arb(place[0]), arb(place[1])), 1.0)
            )
            < -0.9
        )
    assert compute_end_slacks([*arc_row(0, 0, 5.0, 0.0, pi), 0.0, 0.0], (arb(5), arb(0)), 9.0) == []


def test_a_wide_box_is_decided_in_doubles() -> None:
    """Three pegs whose curves touch, and a fourth whose row grazes its face: where it stands is known to some 9 mm only.
    Balls take 1.5 s for it and give it up; doubles take as many parts as it needs, and find that no fixture is there."""
    problem = Problem.from_query(Query(load("widget"), Vise(pitch=2, columns=5, peg_radius=0.75)))
    row = np.zeros((1, record.RECORD_LENGTH))
    row[0, : record.PSI] = 3, 12, 14, 13, 2, 0, -4, -1, 0, 0, -4, -1, -2
    row[0, record.PSI :] = -0.4988108, -15.43876, 4.146501, 47.99848, 4.116907e-4, 8.815414
    proven, still_open = decide_by_interval_newton(row, problem, problem.setting._replace(backward_error=0.0))
    assert len(proven) == len(still_open) == 0


@pytest.mark.thorough
def test_an_ordinary_part_leaves_nothing_to_balls(monkeypatch: pytest.MonkeyPatch) -> None:
    """Boxes that are not flat are contracted in the frame of the Jacobian alone; weighed, some of them stay open, and the
    search loads ball arithmetic for them."""
    in_balls: list[int] = []
    monkeypatch.setattr(
        deciding, "decide_records_in_balls", counted(in_balls, deciding.decide_records_in_balls)
    )
    bracket = Path(__file__).resolve().parents[2] / "examples" / "bracket.dxf"
    result = design(load(bracket), Vise(pitch=10, columns=2, peg_radius=3))
    assert result.proof is not None and result.proof.escalated > 500
    assert sum(in_balls) == 0


def counted(counts: list[int], work: Callable[..., Any]) -> Callable[..., Any]:
    """A function of records, with how many it is given noted."""

    def noting(records: NDArray[np.float64], *given: Any) -> Any:
        counts.append(len(records))
        return work(records, *given)

    return noting
