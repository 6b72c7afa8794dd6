"""What patterns share that are one: neither where pegs stand, nor how they are numbered, nor where S is counted from."""

from __future__ import annotations

import numpy as np
from attrs import evolve

from seating_examples import LEFT, RIGHT, held, moved
from workhold import Vise
from workhold.seating.pattern import Pattern

VISE = Vise(pitch=10, columns=3, peg_radius=3)
FIXTURE = held(
    [(LEFT, 10.0, 0.0), (LEFT, 0.0, 30.0), (RIGHT, 60.0, 10.0), (RIGHT, 50.0, 20.0)], (0.0, 0.0, 0.0), 40.0
)


def test_patterns_that_differ_by_names_places_and_the_zero_of_the_separation_are_one():
    key = Pattern.of(FIXTURE, VISE).key()
    assert Pattern.of(moved(FIXTURE, [2, 1, 3, 0], False, (20.0, -30.0)), VISE).key() == key
    assert Pattern.of(evolve(FIXTURE, jaw_separation=33.0), VISE).key() == key
    other = evolve(FIXTURE, pegs=(*FIXTURE.pegs[:3], evolve(FIXTURE.pegs[3], x=40.0)))
    assert Pattern.of(other, VISE).key() != key


def test_pegs_that_stand_still_come_first_each_from_left_to_right():
    pattern = Pattern.of(moved(FIXTURE, [2, 0, 1, 3], False, (0.0, 0.0)), VISE)
    assert pattern.order.tolist() == [2, 1, 3, 0]
    assert (np.diff(pattern.right[pattern.order]) >= 0).all()
