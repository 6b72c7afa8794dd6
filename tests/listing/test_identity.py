"""Fixtures that rotations of the part, or half a turn of the toolkit, carry into each other are one set."""

from __future__ import annotations

from math import cos, pi, sin, tau

import numpy as np
import pytest
from attrs import evolve

from workhold import Fence, Plate, Query, Vise, Workpiece, answer
from workhold.conventions import SAME_POSE
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import rotated
from workhold.listing.identity import Identity, SetCount, identity_order
from workhold.model.fixture_table import FixtureTable

TOOLKITS: dict[str, Toolkit] = {
    "vise": Vise(pitch=9, columns=2, peg_radius=2),
    "plate": Plate(pitch=(17, 15), peg_radius=2, columns=4, rows=4, directions=["-x", "-y"]),
    "opposed": Plate(
        pitch=(17, 15), peg_radius=2, columns=4, rows=4, clamps=2, directions=[("-x", "+x"), ("-x", "-y")]
    ),
    "wall": Fence(pitch=9, peg_radius=2, wall_offset=5),
    "wall-two": Fence(pitch=(12, 10), peg_radius=2, wall_offset=5, clamps=2, travel=(3, 30)),
}


def polygon(corners: int) -> Workpiece:
    """A regular polygon about the origin, one corner on the x axis."""
    loop = [[30 * cos(tau * k / corners), 30 * sin(tau * k / corners), 0.0] for k in range(corners)]
    return Workpiece.from_loops("polygon", [loop])


def carried(table: FixtureTable, angle: float) -> FixtureTable:
    """Fixtures of a part about the origin after it is turned onto itself; pegs stay where they are."""
    return evolve(table, theta=(table.theta - angle) % tau)


@pytest.mark.parametrize("corners", [3, 4, 5, 6])
@pytest.mark.parametrize("name", TOOLKITS)
def test_what_is_turned_has_the_same_smallest_image(name: str, corners: int) -> None:
    """Whatever rotation a fixture is carried by: the set it makes is the same, and so is the number of sets."""
    toolkit = TOOLKITS[name]
    query = Query(polygon(corners), toolkit, listing="all" if toolkit.travels > 1 else None)
    result = answer(query)
    table, identity = result.table, Identity(toolkit, query.workpiece)
    assert len(identity.rotations) == corners
    assert len(table) > 10 or (corners, name) == (4, "wall")
    words, pose = identity.smallest(table)
    sets, everything = identity.count(words, pose, table.arrangement), SetCount(identity)
    for rotation in identity.rotations:
        turned = carried(table, rotation.angle)
        everything.add(turned)
        again = identity.smallest(turned)
        np.testing.assert_array_equal(again[0], words)
        np.testing.assert_allclose(again[1], pose, atol=SAME_POSE)
    np.testing.assert_array_equal(everything.distinct, sets)
    np.testing.assert_array_equal(
        everything.found, np.bincount(table.arrangement, minlength=len(sets)) * corners
    )
    assert everything.by_type(sets) == result.distinct
    # Each is one of as many as there are rotations, unless half a turn makes it the same again.
    own_half_turn = corners % 2 == 0 and name in ("vise", "opposed")
    assert len(table) / corners <= sets.sum() <= len(table) / corners * (2 if own_half_turn else 1)


def test_half_a_turn_of_everything_makes_a_fixture_of_opposed_clamps_the_same() -> None:
    """Pegs, part and travels turned by 180 degrees, and locators and clamps listed in their order once more."""
    query = Query(polygon(5), TOOLKITS["opposed"], listing="all")
    table, identity = answer(query).table, Identity(query.toolkit, query.workpiece)
    table = table.take(np.flatnonzero(table.arrangement == 0))
    turned, order = (
        rotated(table.position[:, 0], table.position[:, 1], np.full(len(table), pi)),
        [2, 1, 0, 4, 3],
    )
    halfway = evolve(
        table,
        column=-table.column[:, order],
        row=-table.row[:, order],
        theta=(table.theta + pi) % tau,
        position=np.stack(turned, axis=1),
        jaw_separation=table.jaw_separation[:, ::-1],
    )
    one, other = identity.smallest(table), identity.smallest(halfway)
    np.testing.assert_array_equal(one[0], other[0])
    np.testing.assert_allclose(one[1], other[1], atol=SAME_POSE)
    assert len(table) > 10


def test_the_best_of_a_seat_are_named_without_their_clamps() -> None:
    """Of equal seats the clamps that are listed may differ; their directions tell sets apart all the same."""
    query = Query(polygon(6), TOOLKITS["wall-two"])
    table = answer(query).table
    moved = evolve(table, column=table.column + np.array([0, 0, 0, 1, 0], np.int32))
    seats, every = (Identity(query.toolkit, query.workpiece, every) for every in (False, True))
    for identity, differs in ((seats, False), (every, True)):
        (words, pose), (others, other) = identity.smallest(table), identity.smallest(moved)
        same = all(np.array_equal(*pair) for pair in zip(words, others, strict=True)) and np.array_equal(
            pose, other
        )
        assert same != differs and len(table) > 3


def test_what_is_equal_in_holes_and_faces_is_ordered_by_its_place() -> None:
    """In whatever order the fixtures come."""
    query = Query(polygon(5), TOOLKITS["wall"])
    one = answer(query).table.take(np.zeros(1, np.int64))
    moved = [evolve(one, position=one.position + np.array([step, 0.0])) for step in (2.0, 0.0, 1.0)]
    table = FixtureTable.joined(moved)
    assert identity_order(table).tolist() == [1, 2, 0]
