"""Descent paths: the shortest step out of what is entered, and that they lead through what is free to what is known."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
from scipy.optimize import nnls

from seating_examples import equilibria_of
from sharpness import changed
from workhold import Fixture, Peg, Pose, Vise, Workpiece
from workhold.kernels.seating.closing import AT_THE_STOP, GAVE_UP
from workhold.kernels.seating.columns import CONFIG, SECOND, DescentWorkSpace
from workhold.kernels.seating.descent_paths import OUTSIDE, STOP
from workhold.kernels.seating.linear_program import add_normal, write_shortest_step_out
from workhold.kernels.seating.obstacles import write_clearances_of_points
from workhold.seating.closing import find_descent_starts
from workhold.seating.join_tree import JoinTree
from workhold.seating.pattern import ClosingFrame, Pattern
from workhold.seating.solver import SeatingSolver

# In which a part is moved that is said not to get away.
DIRECTIONS = 144
NOTCH = Workpiece.from_loops(
    "notch",
    [
        [[0, 0, 0], [70, 0, 0], [70, 22, 0], [40, 26, 0], [30, 55, 0], [0, 55, 0]],
        [[30, 12, -1], [14, 12, -1]],
    ],
)
VISE = Vise(pitch=10, columns=2, peg_radius=3)
PEGS = (("left", 10.0, 20.0, 5), ("left", 10.0, 50.0, 5), ("right", 52.38024723796786, 0.0, 0))
PEGS = (*PEGS, ("right", 52.38024723796786, 40.0, 3))


@pytest.fixture(scope="module")
def ways():
    """The jaws about the notch as drawn and turned over, with starts of the ways down of all passes, and the trees."""
    pegs = tuple(Peg(jaw, 0, 0, x, y, face, 0.3) for jaw, x, y, face in PEGS)
    fixture = Fixture("I", pegs, Pose(0, 13, 3), 42.38024723796786, {})
    solver, pattern, out = SeatingSolver(NOTCH, VISE), Pattern.from_fixture(fixture, VISE), []
    for turned_over in (False, True):
        closing = solver.make_closing(pattern, turned_over)
        found = equilibria_of(closing)
        starts = find_descent_starts(found.passes, closing.size)[0]
        out.append((closing, starts, JoinTree.from_equilibria(found, closing)))
    return out


def test_a_fifth_normal_is_none():
    """There are four unknowns; a fifth that rounding leaves something of would be written past the basis."""
    work, adds = DescentWorkSpace.allocate(1), changed(add_normal)
    work.near[0, :4], work.basis[:] = (0.0, 1.0, 0.0, 0.0), 0.0
    assert [adds(0, 1, place, work) for place in (3, 4)] == [True, False]


def test_two_pegs_on_one_face_against_a_third_on_an_arc_make_a_seat(ways):
    """Both jaws' pegs on the long side, the left jaw's other one at the notch, 20 across: forces are parallel, and with the
    left pegs 30 apart sin(theta) is 2/3. Descent paths end there, and none anywhere that is not known."""
    seats = ways[0][2].seats
    theta = np.pi - np.arcsin(2.0 / 3.0)
    [seat] = seats[np.abs(seats[:, 0] - theta) < 1e-9]
    # The right jaw's peg is 20 higher; at separation 0 it is above the left one.
    assert seat[3] == pytest.approx(-20.0 * np.tan(theta), abs=1e-9)
    assert seat[4] == 3.0 and seat[SECOND] > 0.0
    assert [len(tree.doubtful) for _, _, tree in ways] == [0, 0]


def least_clearance(closing, configs):
    """Least distance in mm of pegs from the boundary in configurations (N, 4), below 0 in the part."""
    (first, end), out = closing.boundary.parts[0].tolist(), np.empty(4 * len(configs))
    write_clearances_of_points(
        closing.pattern.place_pegs(configs).reshape(-1, 2), closing.boundary.rows, first, end, out
    )
    return out.min()


def shortest(slopes, least):
    """The shortest step d with slopes @ d >= least (C. L. Lawson and R. J. Hanson, 1974); None where there is none."""
    told = np.vstack([slopes.T, least])
    left = told @ nnls(told, np.eye(5)[4])[0] - np.eye(5)[4]
    return None if abs(left[4]) < 1e-9 else -left[:4] / left[4]


def test_the_way_out_is_the_shortest():
    """Also where one of those that were met on the way is let go, and where normals are the same."""
    steps_out = changed(write_shortest_step_out, add_normal=changed(add_normal))
    generator, met = np.random.default_rng(4), 0
    for count in (1, 2, 3, 4, 6) * 12:
        work = DescentWorkSpace.allocate(0)
        slopes, off = generator.normal(size=(count, 4)), generator.normal(size=count) * 1e-3
        if count == 3:
            slopes[2] = slopes[0]
        work.near[:count, :4], work.near[:count, 4] = slopes, off
        best = shortest(slopes, 2e-12 - off)
        if best is not None and off.min() < 0.0:
            steps_out(count, work)
            assert work.step == pytest.approx(best, abs=1e-9)
            met += int((np.abs(slopes @ best + off) < 1e-9).sum() < (off < 0.0).sum())
    assert met > 5


def test_ways_lead_through_narrow_valleys_to_their_seats(ways):
    """In them pegs press on faces that are nearly parallel; nothing is left where it was on its way."""
    for closing, starts, _ in ways:
        assert (closing.close_from(starts, 0.005)[1] != GAVE_UP).all()
    tree = ways[1][2]
    joins = [(join, seat) for k, seat in enumerate(tree.seats) if (join := tree.find_first_join(k))]
    assert any(abs(join.separation - seat[3] - 12.022505562) < 1e-8 for join, seat in joins)


def test_a_way_does_not_depend_on_those_before_it(ways):
    """What was near to the pegs there is not near here."""
    for closing, starts, _ in ways:
        ends, how = closing.close_from(starts, 0.005)
        alone = [closing.close_from(start[None], 0.005) for start in starts]
        assert np.array_equal(ends, np.concatenate([end for end, _ in alone]))
        assert np.array_equal(how, np.concatenate([end for _, end in alone]))


def test_no_peg_is_in_the_part_on_its_way(ways):
    for closing, starts, _ in ways:
        for level in np.linspace(starts[:, 3].min() - 20.0, starts[:, 3].max(), 12):
            above = starts[starts[:, 3] >= level]
            assert least_clearance(closing, closing.close_from(above, 0.005, level=level)[0]) > -2e-8


@pytest.mark.thorough
def test_a_part_leaves_where_no_peg_meets_it_on_the_way(ways):
    """Told by small steps along the direction that is told or, where none is, along many, of where ways down begin and
    end."""
    seen, every = set(), np.arange(DIRECTIONS) * tau / DIRECTIONS
    for closing, starts, _ in ways:
        configs = np.concatenate([closing.close_from(starts[::4], 0.005)[0], starts[1::12]])
        for config, told in zip(configs, closing.find_escape_directions(configs), strict=True):
            free = []
            for angle in every if np.isnan(told) else [told]:
                # Pegs that move along a direction of the part's frame: the part moves the other way.
                way = angle + config[0]
                steps = np.concatenate([np.linspace(0.0, 6.0, 60), np.linspace(6.5, 120.0, 200)])
                moved = np.repeat(config[None], len(steps), axis=0)
                moved[:, 1] -= np.cos(way) * steps
                moved[:, 2] -= np.sin(way) * steps
                free.append(least_clearance(closing, moved))
            # Steps may be too long to see a corner that is grazed; where a way begins a peg may be in the part by a little.
            entered = min(least_clearance(closing, config[None]), 0.0)
            assert max(free) < 1e-3 if np.isnan(told) else free[0] > entered - 1e-6
            seen.add(bool(np.isnan(told)))
    assert seen == {True, False}


def test_what_leaves_at_the_end_of_a_way_or_at_its_start_is_outside(ways):
    seen = set()
    for closing, _, tree in ways:
        off_passes = np.flatnonzero(tree.passes[:, SECOND] < 0.0)
        rows, joined = tree.passes[off_passes], tree.joined[off_passes]
        (every, lengths), how_far = find_descent_starts(rows, closing.size), 0.005
        for side in (0, 1):
            starts = every[side::2]
            for k in np.flatnonzero(lengths[side::2, 0] == how_far).tolist():
                ends, how = closing.close_from(
                    starts[k : k + 1], how_far, np.ascontiguousarray(tree.seats[:, CONFIG])
                )
                at_end, at_start = closing.find_escaping(np.concatenate([ends, starts[k : k + 1]])).tolist()
                if how[0] == AT_THE_STOP:
                    assert joined[k, side] == (OUTSIDE if at_end or at_start else STOP)
                    seen.add((at_end, at_start))
    assert (False, False) in seen and len(seen) > 1, seen


def test_a_seat_joins_at_the_lowest_pass_that_leads_elsewhere(ways):
    for _, _, tree in ways:
        joins = [tree.make_join(number) for number in range(len(tree.passes))]
        for place in range(len(tree.seats) + len(tree.loose)):
            out = [
                join for join in joins if tree.own[place] in join.places and join.places[0] != join.places[1]
            ]
            assert tree.find_first_join(place) == (
                min(out, key=lambda join: join.separation) if out else None
            )


def test_a_closing_frame_leads_back():
    for quarters in range(4):
        for frame in (ClosingFrame(quarters, 1.0), ClosingFrame(quarters, -1.0)):
            config = np.array([0.3, 4.0, -5.0, 6.0])
            assert frame.map_to_toolkit(frame.map_from_toolkit(config)) == pytest.approx(config, abs=1e-12)
            assert np.array_equal(frame.map_to_toolkit(config[None])[0], frame.map_to_toolkit(config))


def test_pegs_that_a_part_does_not_fit_between_get_nowhere():
    """Two of a jaw, 20 mm apart inside, over and under a bar a little thicker: there is no way out of it. A bar a little
    thinner goes to where the other jaw's peg stops it."""
    pegs = tuple(
        Peg(jaw, 0, 0, x, y, 0, 0.3)
        for jaw, x, y in (("left", 0, 0), ("left", 0, 26), ("right", 109, 13), ("right", 109, 113))
    )
    for thick, expected in ((20.02, True), (19.98, False)):
        bar = Workpiece.from_loops("bar", [[[-90, 0, 0], [60, 0, 0], [60, thick, 0], [-90, thick, 0]]])
        closing = SeatingSolver(bar, VISE).make_closing(
            Pattern.from_fixture(Fixture("I", pegs, Pose(0, 0, 0), 100.0, {}), VISE), False
        )
        # The place is that of its middle.
        start = np.array([[0.0, -15.0, 13.0, 80.0]])
        [how] = closing.close_from(start, 0.005)[1]
        assert (how == GAVE_UP) == expected
