"""The boundary on which the centres of pegs lie, and the discs by which its pieces are left out."""

from __future__ import annotations

from itertools import product
from math import cos, pi, sin

import numpy as np
import pytest
from attrs import evolve

import workhold
from seating_examples import LEFT, RIGHT, STEP, held, moved, solved
from workhold import Vise, Workpiece
from workhold.contact.curves import LatticeSteps, make_curve_table
from workhold.kernels.base.feature import HALF_EXTENT, IS_ARC, RADIUS
from workhold.kernels.base.tables import HEAD, TAIL
from workhold.model.seating import SeatContact
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern

# Corners of these polygons turn by an eighth of a circle, and by a hundredth.
POLYGONS = [
    Workpiece.from_points(str(n), [(30 * cos(2 * k * pi / n), 30 * sin(2 * k * pi / n)) for k in range(n)])
    for n in (8, 100)
]


@pytest.mark.parametrize("number", range(3))
def test_pieces_lie_in_their_discs_and_reach_their_edges(number):
    boundary = next(iter(solved(number)[0].boundaries.values()))
    for row, (x, y, radius) in zip(boundary.rows, boundary.discs, strict=True):
        ts = np.linspace(-row[HALF_EXTENT], row[HALF_EXTENT], 41)
        if row[IS_ARC] == 0.0:
            points = row[1:3] + ts[:, None] * row[3:5]
        else:
            turned = np.stack(
                [row[3] * np.cos(ts) - row[4] * np.sin(ts), row[4] * np.cos(ts) + row[3] * np.sin(ts)], axis=1
            )
            points = row[1:3] + row[RADIUS] * turned
        away = np.hypot(*(points - [x, y]).T).max()
        assert radius - 1e-3 <= away <= radius + 1e-9


@pytest.mark.thorough
def test_rolled_corners_make_up_a_turn():
    """Around a convex part the pegs' boundary is its outline and one circle (J. Steiner, 1840), blunt corners included."""
    for part in (*POLYGONS, workhold.load("oblongPart")):
        rows = ObstacleBoundary.from_workpiece(part, (2.5, 2.5)).rows
        outer = sum(2.0 * row[HALF_EXTENT] * (row[RADIUS] if row[IS_ARC] != 0.0 else 1.0) for row in rows)
        around = sum(
            2.0 * s.half_extent * getattr(s, "radius", 1.0) for s in (face.segment for face in part.faces)
        )
        assert outer == pytest.approx(around + 2.0 * pi * 2.5, abs=1e-9)
    corners = [
        row[HALF_EXTENT]
        for row in ObstacleBoundary.from_workpiece(POLYGONS[0], (2.5, 2.5)).rows
        if row[IS_ARC] != 0.0
    ]
    assert corners == pytest.approx([pi / 8.0] * 8)


def test_contacts_are_told_by_their_pegs_and_pieces() -> None:
    """Whatever pairs of pegs and pieces, or none, come before others: no two are taken for one another."""
    boundary = ObstacleBoundary.from_workpiece(STEP, (3.0, 3.0))
    touches, every = boundary.all_touches, [(-1, -1), *product(range(4), range(len(boundary.all_touches)))]
    pairs = np.array(list(product(every, repeat=2)))
    none = np.full((len(pairs), 2), -1)
    told = boundary.make_contacts(*(np.concatenate([pairs[:, :, k], none], axis=1) for k in range(2)))
    for contacts, pair in zip(told, pairs.tolist(), strict=True):
        right = [SeatContact(peg, touches[at].face, touches[at].corner) for peg, at in pair if peg >= 0]
        assert list(contacts) == right
    assert boundary.corners.tolist() == [touch.corner for touch in touches]


def test_curves_of_each_jaw_are_those_of_its_pieces():
    """Of pegs of two radii, on a part with arcs of one centre, whatever was asked before."""
    boundary = ObstacleBoundary.from_workpiece(workhold.load("oblongPart"), (2.5, 4.0))
    steps = LatticeSteps(
        np.array([15.0]), np.array([0, 1]), np.array([[1, 0]], dtype=np.int64), np.array([0.0])
    )
    for side, (first, end) in enumerate(boundary.parts.tolist()):
        boundary.find_chord_curves(10.0, side)
        told, known = (
            boundary.find_chord_curves(15.0, side),
            make_curve_table(boundary.loose[first:end], steps),
        )
        assert len(set(boundary.centers[first].tolist())) < end - first
        for one, two in ((told.curves, known.curves), (told.sliding_pairs, known.sliding_pairs)):
            assert len(one.integers) > 0 and np.array_equal(one.reals, two.reals)
            assert np.array_equal(one.integers[:, [TAIL, HEAD]] - first, two.integers[:, [TAIL, HEAD]])


# What patterns share that are one: neither where pegs stand, nor how they are numbered, nor where S is counte
VISE = Vise(pitch=10, columns=3, peg_radius=3)
FIXTURE = held(
    [(LEFT, 10.0, 0.0), (LEFT, 0.0, 30.0), (RIGHT, 60.0, 10.0), (RIGHT, 50.0, 20.0)], (0.0, 0.0, 0.0), 40.0
)


def test_patterns_that_differ_by_names_places_and_the_zero_of_the_separation_are_one():
    key = Pattern.from_fixture(FIXTURE, VISE).make_key()
    assert Pattern.from_fixture(moved(FIXTURE, [2, 1, 3, 0], False, (20.0, -30.0)), VISE).make_key() == key
    assert Pattern.from_fixture(evolve(FIXTURE, travel=33.0), VISE).make_key() == key
    other = evolve(FIXTURE, pegs=(*FIXTURE.pegs[:3], evolve(FIXTURE.pegs[3], x=40.0)))
    assert Pattern.from_fixture(other, VISE).make_key() != key


def test_pegs_that_stand_still_come_first_each_from_left_to_right():
    pattern = Pattern.from_fixture(moved(FIXTURE, [2, 0, 1, 3], False, (0.0, 0.0)), VISE)
    assert pattern.order.tolist() == [2, 1, 3, 0]
    assert (np.diff(pattern.right[pattern.order]) >= 0).all()
