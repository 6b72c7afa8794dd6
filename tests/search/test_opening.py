"""The vise that clamps by opening: the contacts are those of the closing one, and one sign tells the two apart."""

from __future__ import annotations

import numpy as np
import pytest
from attrs import asdict

from workhold import OpeningVise, Query, Vise, Workpiece, design
from workhold.contact.problem import Problem
from workhold.conventions import GAP_SLACK, LEAST_CLAMPING, LEAST_CLOSURE
from workhold.search.broken_rules import find_all_contacts

# A hole and a notch to hold it from inside, and sides to hold it from outside.
WINDOW = Workpiece.from_loops(
    "window",
    [
        [[0, 0, 0], [60, 0, 0], [60, 18, 0], [52, 24, 0], [58, 33, 0], [60, 46, 0], [3, 44, 0]],
        [[11, 12, 0], [14, 35, 0], [44, 36, -0.4], [42, 9, 0]],
    ],
)
RING = Workpiece.from_loops(
    "ring", [[[30, 0, 1], [-30, 0, 1]], [[-19, -9, 0], [-20, 9, 0], [6, 10, -0.8], [5, -11, 0]]]
)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("part", "vise"),
    [
        (WINDOW, Vise(pitch=14, columns=1, peg_radius=3, min_gap=9)),
        (WINDOW, Vise(pitch=15, columns=2, peg_radius=2, min_gap=4, row_offset=4)),
        (RING, Vise(pitch=13, columns=1, peg_radius=3, min_gap=6)),
    ],
    ids=["window", "two columns", "ring"],
)
def test_contacts_that_close_are_clamped_by_closing_or_by_opening_or_are_double_roots(
    part: Workpiece, vise: Vise
) -> None:
    """Of the simultaneous contacts that keep the smallest gap and whose forces close, those with a positive clamping force
    are the fixtures of the closing vise, those with a negative one those of the opening vise."""
    opening = OpeningVise(**asdict(vise, recurse=False))
    contacts = find_all_contacts(Problem.from_query(Query(part, vise)), 1)
    other = find_all_contacts(Problem.from_query(Query(part, opening)), 1)
    assert len(other.clamping) == len(contacts.clamping)
    assert np.array_equal(np.sort(other.clamping), np.sort(-contacts.clamping))
    kept = contacts.take(
        (contacts.candidates.gap >= vise.min_gap - GAP_SLACK) & (contacts.margin > LEAST_CLOSURE)
    )
    pegs = kept.candidates.standing
    for toolkit, clamps in (
        (vise, kept.clamping > LEAST_CLAMPING),
        (opening, kept.clamping < -LEAST_CLAMPING),
    ):
        found = design(part, toolkit).found
        assert found == {"I": int((clamps & (pegs == 2)).sum()), "II": int((clamps & (pegs == 3)).sum())}
        assert sum(found.values()) > 0


def test_forces_of_an_opening_fixture_are_per_unit_of_the_force_that_opens() -> None:
    """The pegs that move push to the right, with a joint force of one along x; every force is positive, and so are those
    that the figures of quality come from."""
    result = design(WINDOW, OpeningVise(pitch=14, columns=1, peg_radius=3, min_gap=9))
    assert len(result) > 0
    assert (result.table.force > 0).all()
    for fixture in result:
        assert fixture.quality["closure_margin"] > 0
        assert fixture.quality["clamp_amplification"] == pytest.approx(max(peg.force for peg in fixture.pegs))
