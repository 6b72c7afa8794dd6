"""Descent paths of a few pegs, followed once for many patterns, end where those of all pegs do."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from seating_examples import STEP, equilibria_of, held
from workhold import Vise, Workpiece
from workhold.kernels.seating.closing import AT_REST, AT_THE_STOP
from workhold.kernels.seating.columns import (
    CONFIG,
    CONTACTS,
    COSINE,
    FORCE,
    MOVED,
    NODE_LENGTH,
    PEG,
    PIECE,
    SINE,
    TURNED,
)
from workhold.kernels.seating.descent_paths import write_last_free_nodes
from workhold.kernels.seating.free_space import RANGES, write_escape_directions
from workhold.kernels.seating.obstacles import write_clearances_of_points
from workhold.seating.closing import ClosingMotion, DescentCache, find_descent_starts
from workhold.seating.join_tree import compute_subset_shifts, follow_pass_descents, select_free_paths
from workhold.seating.pattern import Pattern
from workhold.seating.solver import SeatingSolver

VISE = Vise(pitch=10, columns=2, peg_radius=3)
PEGS = (("left", 10.0, 10.0), ("left", 10.0, 30.0), ("right", 50.0, 0.0), ("right", 50.0, 40.0))


def pattern_of(lifted: float = 0.0, wider: float = 0.0) -> Pattern:
    """Four pegs, the last one lifted by some mm, and the second one farther to the left by some."""
    places = [(jaw, x - wider * (k == 1), y + lifted * (k == 3)) for k, (jaw, x, y) in enumerate(PEGS)]
    return Pattern.from_fixture(held(places, (0.0, 0.0, 0.0), 40.0), VISE)


PATTERNS = [pattern_of(), pattern_of(lifted=-10.0), pattern_of(lifted=10.0, wider=10.0)]


def followed(solver, pattern, turned_over=False):
    """The jaws, what was found, the strict seats, and where the ways down begin and end, and how."""
    closing = solver.make_closing(pattern, turned_over)
    found = equilibria_of(closing)
    seats = np.ascontiguousarray(found.seats[:, CONFIG])
    return closing, found, seats, follow_pass_descents(found, closing, seats)


@pytest.fixture(scope="module")
def ways():
    """The same of all patterns, both sides, by one solver."""
    solver = SeatingSolver(STEP, VISE)
    return [followed(solver, pattern, side) for pattern in PATTERNS for side in (False, True)]


def clearance(closing, configs, pegs):
    """Least distance in mm of some pegs from the boundary in configurations (N, 4): (N,)."""
    (first, end), out = closing.boundary.parts[0].tolist(), np.empty(len(configs) * len(pegs))
    points = np.ascontiguousarray(closing.pattern.place_pegs(configs)[:, pegs].reshape(-1, 2))
    write_clearances_of_points(points, closing.boundary.rows, first, end, out)
    return out.reshape(len(configs), len(pegs)).min(axis=1, initial=np.inf)


@pytest.mark.thorough
def test_they_end_as_ways_that_are_followed_with_all_pegs(ways):
    seen = set()
    for closing, found, seats, (starts, ends, how) in ways:
        assert starts[::2] + starts[1::2] == pytest.approx(2.0 * found.passes[:, CONFIG], abs=1e-9)
        known, ended = closing.close_from(starts, find_descent_starts(found.passes, closing.size)[1], seats)
        assert np.array_equal(how, ended)
        assert ends[:, 3] == pytest.approx(known[:, 3], abs=1e-5)
        assert (clearance(closing, ends, [0, 1, 2, 3]) > -2e-8).all()
        stopped = how == AT_THE_STOP
        assert np.array_equal(closing.find_escaping(ends[stopped]), closing.find_escaping(known[stopped]))
        seen |= set(how.tolist())
    assert seen == {AT_REST, AT_THE_STOP}


@pytest.mark.thorough
def test_a_way_of_a_group_is_one_of_the_pattern_as_far_as_no_other_peg_is_in_the_part(ways):
    """Up to the last node that is told all are free and above the stop, and the next is not."""
    cut = whole = 0
    for closing, found, _, _ in ways:
        cache = found.subsets[0][1].cache
        chosen, whose, lasts = select_free_paths(
            found, np.arange(len(found.passes)), closing, compute_subset_shifts(found)
        )
        for way, group, last in zip(chosen.tolist(), whose.tolist(), lasts.tolist(), strict=True):
            first, end = cache.begins[way : way + 2]
            nodes = cache.nodes[first:end, :4] + found.subsets[group][0].shift
            free = clearance(closing, nodes, [0, 1, 2, 3]) > -2e-8
            free &= nodes[:, 3] > closing.pattern.stop + 1e-6
            count = last - first + 1
            assert free[:count].all()
            # Between nodes a peg may be in the part, too.
            apart = np.abs(np.diff(nodes[count - 1 : count + 1], axis=0)).max(initial=0.0)
            assert count == len(nodes) or not free[count] or apart > 0.35
            cut, whole = cut + (0 < count < len(nodes)), whole + (count == len(nodes))
    assert cut > 20 and whole > 20


def test_a_part_is_not_taken_away_through_a_wall():
    """Between pegs at three of its sides it leaves along the fourth, unless a wall is there; one elsewhere keeps nothing."""
    part = Workpiece.from_loops("bar", [[[0, 0, 0], [60, 0, 0], [60, 20, 0], [0, 20, 0]]])
    vise = Vise(pitch=10, columns=2, peg_radius=0.5)
    places = [("left", -0.7, 10.0), ("left", 20.0, 20.7), ("right", 60.7, 10.0), ("right", 40.0, 20.7)]
    pattern = Pattern.from_fixture(held(places, (0.0, 0.0, 0.0), 40.0), vise)
    obstacles = SeatingSolver(part, vise).make_closing(pattern, False).obstacles
    lying = np.array([[0.0, *part.center, 40.0]])
    for wall, is_free in (((0.0, 0.0, 0.0), 1), ((0.0, 1.0, 0.0), 0), ((0.0, -1.0, 0.0), 1)):
        out, room = np.zeros(1), RANGES * len(obstacles.pegs) * len(obstacles.rows) + 1
        axes = np.empty(len(obstacles.rows))
        write_escape_directions(
            lying, obstacles._replace(half_plane=np.array(wall)), axes, np.empty((room, 2)), out
        )
        assert np.isfinite(out[0]) == is_free


def test_a_long_step_is_looked_at_between_its_ends():
    """A peg that goes through a thin fin is free before and behind it; shorter steps are looked at where they end."""
    fin = [
        [0, 0, 0],
        [60, 0, 0],
        [60, 20, 0],
        [30.5, 20, 0],
        [30.5, 40, 0],
        [29.5, 40, 0],
        [29.5, 20, 0],
        [0, 20, 0],
    ]
    part, vise = Workpiece.from_loops("fin", [fin]), Vise(pitch=10, columns=2, peg_radius=0.5)
    # Pegs far off, but for the second one, beside the fin.
    places = [("left", -90.0, 0.0), ("left", 28.0, 30.0), ("right", 190.0, 0.0), ("right", 190.0, 40.0)]
    pattern = Pattern.from_fixture(held(places, (0.0, 0.0, 0.0), 40.0), vise)
    obstacles = SeatingSolver(part, vise).make_closing(pattern, False).obstacles
    x, y = part.center
    nodes = np.zeros((2, NODE_LENGTH))
    nodes[:, 1:4] = [[x, y, 40.0], [x - 4.0, y, 40.0]]
    nodes[:, COSINE], nodes[1, MOVED] = 1.0, 4.0
    one, others = np.zeros(1, np.int64), np.ones((1, 4), np.int8)
    for most, last in ((10.0, 1), (0.3, 0)):
        lasts = np.empty(1, np.int64)
        write_last_free_nodes(
            one,
            one,
            nodes,
            np.array([0, 2]),
            np.zeros((1, 4)),
            others,
            most,
            obstacles,
            np.empty((4, 4)),
            lasts,
        )
        assert lasts[0] == last


@pytest.mark.thorough
def test_nodes_say_how_far_their_way_has_come(ways):
    """All of it counted, and what the orientation's cosine and sine are."""
    cache = ways[0][1].subsets[0][1].cache
    _, _, count = cache.counts
    assert count > 100
    for first, end in pairwise(cache.begins[: count + 1].tolist()):
        nodes = cache.nodes[first:end]
        steps = np.abs(np.diff(nodes[:, :4], axis=0))
        assert nodes[:, COSINE] == pytest.approx(np.cos(nodes[:, 0]), abs=1e-15)
        assert nodes[:, SINE] == pytest.approx(np.sin(nodes[:, 0]), abs=1e-15)
        assert nodes[0, [TURNED, MOVED]].tolist() == [0.0, 0.0]
        assert nodes[1:, TURNED] == pytest.approx(np.cumsum(steps[:, 0]), abs=1e-12)
        assert nodes[1:, MOVED] == pytest.approx(np.cumsum(steps[:, 1:].sum(axis=1)), abs=1e-9)


@pytest.mark.thorough
def test_nothing_depends_on_what_was_followed_before(ways, monkeypatch):
    """Nor on what is forgotten: to the last bit."""
    monkeypatch.setattr("workhold.seating.equilibria.MOST_NODES", 0)
    for number in (2, 1):
        again = followed(SeatingSolver(STEP, VISE), PATTERNS[number])[3]
        assert [part.tobytes() for part in again] == [part.tobytes() for part in ways[2 * number][3]]


@pytest.mark.thorough
def test_ways_are_followed_once(ways, monkeypatch):
    """A second time none is; and some serve several patterns."""
    closing, found, seats, _ = ways[0]
    with monkeypatch.context() as patched:
        patched.setattr(ClosingMotion, "trace_paths", None)
        follow_pass_descents(found, closing, seats)
    shared = [down for _, down in found.subsets if any(down is other for _, other in ways[2][1].subsets)]
    known = [down.cache.numbers[down.first : down.first + len(down.candidates)] for down in shared]
    assert len(shared) >= 4 and (np.concatenate(known) >= 0).sum() > 10


def test_what_is_added_while_others_read_stays_where_it_is():
    """Room is made by moving all to where there is more: who has what was there still has it."""
    cache, (rng, read) = DescentCache(), (np.random.default_rng(1), [])
    for _ in range(20):
        count = int(rng.integers(0, 5))
        first = cache.reserve_candidates(count)
        lengths = rng.integers(1, 9, 2 * count)
        nodes, how = rng.random((lengths.sum(), NODE_LENGTH)), rng.integers(0, 3, 2 * count).astype(np.int8)
        cache.add_paths(
            np.arange(first, first + count), nodes, np.concatenate([[0], np.cumsum(lengths)]), how
        )
        read.append((np.arange(first, first + count), cache.nodes, cache.begins, nodes, lengths, how))
    for numbers, nodes, begins, told, lengths, how in read:
        ways = cache.numbers[numbers].ravel()
        assert np.array_equal(cache.how[ways], how)
        for rows, starts in ((nodes, begins), (cache.nodes, cache.begins)):
            assert np.array_equal(starts[ways + 1] - starts[ways], lengths)
            own = [rows[starts[way] : starts[way + 1]] for way in ways]
            assert np.array_equal(np.concatenate([np.zeros((0, NODE_LENGTH)), *own]), told)
    assert cache.counts == (
        len(cache.numbers[: cache.counts[0]]),
        sum(len(one[3]) for one in read),
        sum(len(one[5]) for one in read),
    )


def test_all_passes_of_pegs_that_have_no_group_of_their_own_are_told(ways):
    """Each pass is one of a group, in whose own frame it has the same contacts."""
    for _, found, _, _ in ways:
        for row, (number, own) in zip(found.passes, found.origins.tolist(), strict=True):
            group, down = found.subsets[number]
            there = down.candidates[own - down.first]
            assert there[CONFIG] + group.shift == pytest.approx(row[CONFIG], abs=1e-9)
            assert (
                row[PEG:PIECE].tolist()
                == np.array([*group.numbers, -1.0])[there[PEG:PIECE].astype(int)].tolist()
            )
            assert (
                row[[CONTACTS, *range(PIECE, FORCE)]].tolist()
                == there[[CONTACTS, *range(PIECE, FORCE)]].tolist()
            )


def test_what_leaves_where_a_way_began_or_ended_is_outside(ways):
    """And what was not stopped, or leaves from neither, is not."""
    closing, _, _, (starts, ends, how) = ways[0]
    every = np.concatenate([starts, ends[how == AT_THE_STOP]])
    away = closing.find_escaping(every)
    free, held_there = every[away], every[~away]
    assert len(free) > 1 and len(held_there) > 1
    one = np.stack([free[0], free[1], held_there[0], held_there[1], free[0]])
    two = np.stack([free[1], held_there[0], free[0], held_there[0], free[1]])
    assert closing.find_escaping_at_stop(one, two, np.arange(5) < 4).tolist() == [
        True,
        True,
        True,
        False,
        False,
    ]
    assert closing.find_escaping_at_stop(one, two, np.zeros(5, np.bool_)).tolist() == [False] * 5


def test_runs_of_loose_sets_are_free_and_touch_what_they_are_said_to(ways):
    """All along and at both ends, beyond which they are not free or have come to the end of a face; and in the middle they
    touch with as many pegs as anywhere."""
    count, ended = 0, np.zeros(2)
    for closing, found, _, _ in ways:
        loose = found.loose
        whole = np.split(loose.configs, loose.begins[1:-1]) if len(loose.rows) else []
        for candidate, configs, is_closed in zip(loose.rows, whole, loose.closed != 0, strict=True):
            every = [clearance(closing, configs, [peg]) for peg in range(4)]
            assert np.min(every) > -1e-6
            middle = [float(clearance(closing, candidate[None, CONFIG], [peg])[0]) for peg in range(4)]
            told = {int(peg) for peg in candidate[PEG:PIECE] if peg >= 0}
            assert told == {peg for peg in range(4) if abs(middle[peg]) < 1e-7}
            touching = np.sum(np.abs(every) < 1e-7, axis=0)
            inner = touching if is_closed else touching[1:-1]
            most = np.flatnonzero(inner == inner.max()) + (not is_closed)
            assert np.array_equal(configs[most[len(most) // 2]], candidate[CONFIG])
            # Where another peg ends a run, it goes on from the last step by a part of one.
            steps = np.abs(np.diff(configs, axis=0)).sum(axis=1)
            ended += (steps[[0, -1]] > 0.0) & (steps[[0, -1]] < 0.99 * steps[1])
            count += 1
    assert count > 5 and ended.min() > 0
