"""The fold lemma's balls hold every solution of a box, double ones too."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb

import ladders
from exact_chords import exactly
from holdfast.listing.folds import Fold, fold
from holdfast.listing.polish import Contacts, contacts_at

LENGTH = 20.0
# Rounding of the ends' own coordinates in mm, which ``radius`` and ``near`` do not contain.
ROUNDING = 1e-14
RESTS = [0.0, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-6]


def folded(height: float, aside: float, reach: float) -> tuple[Fold, Contacts]:
    """The fold of a box about the ladders, its middle ``aside`` radians from 45 degrees."""
    psi, x, y, apart = ladders.near(np.pi / 4 + aside, height)
    rows = np.array([ladders.FEATURES])[..., :8]
    places = np.array([ladders.offsets(height)]), np.array([ladders.SLIDES])
    contacts = contacts_at(rows, np.array([psi]), np.array([[x, y]]), np.array([apart]), *places, LENGTH)
    return fold(contacts, np.array([reach]), *places, LENGTH), contacts


def coordinates(contacts: Contacts) -> list[arb]:
    """(L psi, tail x, tail y, apart) of contacts, in mm."""
    numbers = [LENGTH * arb(float(contacts.psi[0])), *(arb(float(v)) for v in contacts.tail[0])]
    return [*numbers, arb(float(contacts.apart[0]))]


def distance(one: list[arb], two: list[arb]) -> arb:
    """Length of the difference of two places."""
    return sum(((a - b) ** 2 for a, b in zip(one, two, strict=True)), arb(0)).sqrt()


def from_segment(place: list[arb], low: list[arb], high: list[arb]) -> arb:
    """Distance of a place from the segment between two others."""
    along = [b - a for a, b in zip(low, high, strict=True)]
    square = sum((v * v for v in along), arb(0))
    if not square > 0:
        return distance(place, low)
    part = sum(((p - a) * v for p, a, v in zip(place, low, along, strict=True)), arb(0)) / square
    part = min(max(part, arb(0)), arb(1))
    return distance(place, [a + part * v for a, v in zip(low, along, strict=True)])


@pytest.mark.parametrize("reach", [1e-7, 1e-5, 1e-3])
@pytest.mark.parametrize("aside", [0.0, 0.3, -0.3])
@pytest.mark.parametrize("rest", RESTS)
def test_all_solutions_are_where_the_fold_says(rest: float, aside: float, reach: float) -> None:
    """Each exact solution in the box is within ``radius`` of the segment, and where the ends are told to be apart, within
    ``near`` of one that may have it."""
    height = -2.5 + rest
    told, contacts = folded(height, aside * reach / LENGTH, reach)
    with exactly():
        middle = coordinates(contacts)
        inside = 0
        for psi in ladders.orientations(height):
            place = ladders.unknowns(psi, height)
            place[0] *= LENGTH
            if not distance(place, middle) <= reach:
                continue
            inside += 1
            low, high = coordinates(told.low), coordinates(told.high)
            assert from_segment(place, low, high) <= float(told.radius[0]) + ROUNDING, (rest, aside, reach)
            if told.apart[0]:
                ends = [end for end, there in ((low, told.at_low[0]), (high, told.at_high[0])) if there]
                assert min(float(distance(place, end)) for end in ends) <= told.near[0] + ROUNDING
            assert told.at_low[0] or told.at_high[0]
    # The box is wide enough for both wherever they are less than about a third of it apart.
    if np.sqrt(rest / 5) * LENGTH < 0.3 * reach:
        assert inside == (1 if height == -2.5 else 2)


@pytest.mark.parametrize("rest", [-1e-6, -1e-8, -1e-10])
def test_a_box_without_solutions_is_empty(rest: float) -> None:
    """A little below the fold nothing touches, and the lemma sees it."""
    told, _ = folded(-2.5 + rest, 0.0, 1e-5)
    assert not told.at_low[0]
    assert not told.at_high[0]


@pytest.mark.parametrize("rest", [1e-10, 1e-9, 1e-8])
def test_solutions_apart_are_told_apart(rest: float) -> None:
    """Two solutions well inside the box, and farther from each other than what is left open, are two small balls."""
    told, _ = folded(-2.5 + rest, 0.0, 1e-2)
    assert told.apart[0]
    assert told.at_low[0] and told.at_high[0]
    assert told.near[0] < 0.3 * LENGTH * np.sqrt(rest / 5)


def test_the_ball_about_a_double_root_is_small() -> None:
    """The nearer solutions are to merging the smaller is the ball about them."""
    radii = [float(folded(-2.5 + rest, 0.0, 1e-3)[0].radius[0]) for rest in (1e-8, 1e-10, 0.0)]
    assert radii[0] > radii[1] > radii[2]
    assert radii[2] < 1e-9
