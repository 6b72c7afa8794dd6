"""Fixtures that symmetries carry into each other are one set, and near duplicates are one entry."""

from __future__ import annotations

from math import cos, pi, sin, tau

import numpy as np
import pytest
from attrs import evolve, fields

from workhold import Fence, Plate, Query, Vise, Workpiece, answer, design, load
from workhold.conventions import SAME_POSE
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import find_symmetries, rotate_vectors
from workhold.listing.identity import (
    FixtureIdentity,
    SetCounter,
    find_smallest_face_images,
    make_entries,
    number_near_duplicates,
    order_by_identity,
)
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import TILT
from workhold.statics.judging import are_unfit

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


@pytest.mark.thorough
@pytest.mark.parametrize("corners", [3, 4, 5, 6])
@pytest.mark.parametrize("name", TOOLKITS)
def test_what_is_turned_has_the_same_smallest_image(name: str, corners: int) -> None:
    """Whatever rotation a fixture is carried by: the set it makes is the same, and so is the number of sets."""
    toolkit = TOOLKITS[name]
    query = Query(polygon(corners), toolkit, listing="all" if toolkit.travel_count > 1 else None)
    result = answer(query)
    table, identity = result.table, FixtureIdentity(toolkit, query.workpiece)
    assert len(identity.rotations) == corners
    assert len(table) > 10 or (corners, name) == (4, "wall")
    words, pose = identity.find_smallest_images(table)
    sets, everything = identity.count_sets(words, pose, table.arrangement), SetCounter(identity)
    for rotation in identity.rotations:
        turned = carried(table, rotation.angle)
        everything.add(turned)
        again = identity.find_smallest_images(turned)
        np.testing.assert_array_equal(again[0], words)
        np.testing.assert_allclose(again[1], pose, atol=SAME_POSE)
    np.testing.assert_array_equal(everything.distinct, sets)
    np.testing.assert_array_equal(
        everything.found, np.bincount(table.arrangement, minlength=len(sets)) * corners
    )
    assert everything.count_by_type(sets) == result.distinct
    # Each is one of as many as there are rotations, unless half a turn makes it the same again.
    own_half_turn = corners % 2 == 0 and name in ("vise", "opposed")
    assert len(table) / corners <= sets.sum() <= len(table) / corners * (2 if own_half_turn else 1)


def test_half_a_turn_of_everything_makes_a_fixture_of_opposed_clamps_the_same() -> None:
    """Pegs, part and travels turned by 180 degrees, and locators and clamps listed in their order once more."""
    query = Query(polygon(5), TOOLKITS["opposed"], listing="all")
    table, identity = answer(query).table, FixtureIdentity(query.toolkit, query.workpiece)
    table = table.take(np.flatnonzero(table.arrangement == 0))
    turned, order = (
        rotate_vectors(table.position[:, 0], table.position[:, 1], np.full(len(table), pi)),
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
    one, other = identity.find_smallest_images(table), identity.find_smallest_images(halfway)
    np.testing.assert_array_equal(one[0], other[0])
    np.testing.assert_allclose(one[1], other[1], atol=SAME_POSE)
    assert len(table) > 10


def test_the_best_of_a_seat_are_named_without_their_clamps() -> None:
    """Of equal seats the clamps that are listed may differ; their directions tell sets apart all the same."""
    query = Query(polygon(6), TOOLKITS["wall-two"])
    table = answer(query).table
    moved = evolve(table, column=table.column + np.array([0, 0, 0, 1, 0], np.int32))
    seats, every = (FixtureIdentity(query.toolkit, query.workpiece, every) for every in (False, True))
    for identity, differs in ((seats, False), (every, True)):
        (words, pose), (others, other) = (
            identity.find_smallest_images(table),
            identity.find_smallest_images(moved),
        )
        same = all(np.array_equal(*pair) for pair in zip(words, others, strict=True)) and np.array_equal(
            pose, other
        )
        assert same != differs and len(table) > 3


def test_what_is_equal_in_holes_and_faces_is_ordered_by_its_place() -> None:
    """In whatever order the fixtures come."""
    query = Query(polygon(5), TOOLKITS["wall"])
    one = answer(query).table.take(np.zeros(1, np.int64))
    moved = [evolve(one, position=one.position + np.array([step, 0.0])) for step in (2.0, 0.0, 1.0)]
    table = FixtureTable.concatenate(moved)
    assert order_by_identity(table).tolist() == [1, 2, 0]


PLATE = Workpiece.from_loops("plate", [[[0, 0, 0], [34, 0, 0], [34, 34, 0], [0, 34, 0]]])
VISE = Vise(pitch=10, columns=2, peg_radius=3)


@pytest.mark.parametrize(
    ("loop", "count"),
    [
        ([[0, 0, 0], [34, 0, 0], [34, 34, 0], [0, 34, 0]], 8),
        ([[0, 0, 0], [60, 0, 0], [60, 34, 0], [0, 34, 0]], 4),
        ([[0, 0, 0], [60, 0, 0], [50, 34, 0], [0, 34, 0]], 1),
        ([[0, 0, 0], [60, 0, 0], [45, 34, 0], [15, 34, 0]], 2),
        ([[-20, -9, 0], [20, -9, 1], [20, 9, 0], [-20, 9, 1]], 4),
    ],
)
def test_rotations_and_mirror_images_are_found(loop: list[list[float]], count: int) -> None:
    """Of a square 8, of a rectangle and a slot 4, of an equal-sided trapezium 2, of a lopsided one 1; each a permutation."""
    part = Workpiece.from_loops("part", [loop])
    found = find_symmetries([face.segment for face in part.faces])
    assert len({tuple(image) for image in found}) == len(found) == count
    assert all(sorted(image) == list(range(len(image))) for image in found)
    assert found[0].tolist() == sorted(found[0])


def test_fixtures_of_a_symmetric_part_fall_together() -> None:
    """In a square plate a group is closed: with a fixture it has those on faces turned or mirrored."""
    result = design(PLATE, VISE)
    group = number_near_duplicates(result.table, PLATE, VISE)
    seen: dict[tuple[object, ...], set[int]] = {}
    for number, fixture, tilt in zip(group.tolist(), result, result.table.quality[:, TILT], strict=True):
        # Up to turns and mirror images, what four faces of a square have in common is how often each is touched and
        # which are opposite.
        jaws = [sorted(peg.face for peg in fixture.pegs if peg.carrier == jaw) for jaw in ("left", "right")]
        images = []
        for turn in range(4):
            for sign in (1, -1):
                turned = [sorted((sign * face + turn) % 4 for face in faces) for faces in jaws]
                images += [turned, turned[::-1]] if fixture.type == "I" else [turned]
        seen.setdefault((fixture.type, tilt > 0, str(min(images))), set()).add(number)
    assert all(len(numbers) == 1 for numbers in seen.values())
    assert len(seen) == len(set(group.tolist())) < len(result)


@pytest.mark.parametrize("clamps", [1, 2])
def test_clamps_keep_their_faces(clamps: int) -> None:
    """On a lopsided part what is alike touches the same faces with its locators, and the same with each of its clamps."""
    part = Workpiece.from_loops("lopsided", [[[0, 0, 0], [70, 0, 0], [58, 44, 0], [0, 36, 0]]])
    plate = Plate(pitch=20, peg_radius=3, columns=6, rows=5, clamps=clamps, directions=["-x", "-y"])
    result = design(part, plate)
    group = number_near_duplicates(result.table, part, plate)
    seen: dict[int, set[object]] = {}
    for number, fixture in zip(group.tolist(), result, strict=True):
        locators = tuple(sorted(peg.face for peg in fixture.pegs[:3]))
        pushed = tuple(sorted((peg.carrier, peg.face) for peg in fixture.pegs[3:]))
        seen.setdefault(number, set()).add((fixture.direction, locators, pushed))
    assert all(len(kinds) == 1 for kinds in seen.values())
    assert 1 < len(seen) < len(result)


@pytest.mark.thorough
@pytest.mark.parametrize("corners", [5, 12])
def test_the_first_image_is_the_first_of_all(corners: int) -> None:
    """Of a regular polygon, of whose many symmetries few are tried, as of one of which all are: no image comes before it,
    and it is one."""
    loop = [[30 * cos(tau * k / corners), 30 * sin(tau * k / corners), 0.0] for k in range(corners)]
    part, random = Workpiece.from_loops("polygon", [loop]), np.random.default_rng(corners)
    keys = np.column_stack([random.integers(0, 2, (300, 2)), random.integers(0, corners, (300, 4))])
    carriers = VISE.find_peg_carriers(keys[:, 0].astype(np.int8))
    keys[:, 2:] = np.take_along_axis(keys[:, 2:], np.lexsort((keys[:, 2:], carriers), axis=-1), axis=1)
    for key, first in zip(keys.tolist(), find_smallest_face_images(keys, part, VISE).tolist(), strict=True):
        images = []
        for image in find_symmetries([face.segment for face in part.faces]):
            a, b, c, d = (int(image[face]) for face in key[2:])
            images += [sorted([a, b]) + sorted([c, d]), sorted([c, d]) + sorted([a, b])]
            if key[0] == 1:
                images[-2:] = [[*sorted([a, b, c]), d]]
        assert first == [*key[:2], *min(images)]


def test_entries_count_every_fixture_once() -> None:
    """Those listed, those like them, and those left out; each entry is the first of its group, and none left out is fit."""
    result = design(load("widget"), Vise(pitch=8, columns=2, peg_radius=3))
    shown = make_entries(result)
    assert len(shown.index) + shown.like.sum() + shown.unfit == len(result)
    assert shown.unfit == are_unfit(result.table.quality, result.query.tolerance).sum() > 0
    assert (np.diff(shown.index) > 0).all()
    everything = make_entries(result, with_unfit=True)
    assert everything.unfit == 0 and len(everything.index) + everything.like.sum() == len(result)
    group = number_near_duplicates(result.table, result.workpiece, result.toolkit)
    assert all(index == np.flatnonzero(group == group[index])[0] for index in everything.index)


def test_what_the_half_turn_swaps_is_alike() -> None:
    """In a part without symmetry the same faces held by the other jaws, of two pegs on each; not of three and one."""
    result = design(load("widget"), Vise(pitch=8, columns=1, peg_radius=3))
    swapped = evolve(result.table, face=np.ascontiguousarray(result.table.face[:, [2, 3, 0, 1]]))
    both = FixtureTable(
        **{
            a.name: np.concatenate([getattr(t, a.name) for t in (result.table, swapped)])
            for a in fields(FixtureTable)
        }
    )
    one, other = np.split(number_near_duplicates(both, result.workpiece, result.toolkit), 2)
    two_and_two = result.table.arrangement == 0
    assert (one == other)[two_and_two].all() and not (one == other)[~two_and_two].all()
