"""Near copies: one entry for fixtures that a machinist would call one way to hold the part."""

from __future__ import annotations

from math import cos, sin, tau

import numpy as np
import pytest
from attrs import evolve, fields

from workhold import Plate, Vise, Workpiece, design, load
from workhold.geometry.symmetry import symmetries
from workhold.listing.identity import entries, near_duplicates, smallest_images
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import TILT
from workhold.statics.judging import unfit

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
    found = symmetries([face.segment for face in part.faces])
    assert len({tuple(image) for image in found}) == len(found) == count
    assert all(sorted(image) == list(range(len(image))) for image in found)
    assert found[0].tolist() == sorted(found[0])


def test_fixtures_of_a_symmetric_part_fall_together() -> None:
    """In a square plate a group is closed: with a fixture it has those on faces turned or mirrored."""
    result = design(PLATE, VISE)
    group = near_duplicates(result.table, PLATE, VISE)
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
    group = near_duplicates(result.table, part, plate)
    seen: dict[int, set[object]] = {}
    for number, fixture in zip(group.tolist(), result, strict=True):
        locators = tuple(sorted(peg.face for peg in fixture.pegs[:3]))
        pushed = tuple(sorted((peg.carrier, peg.face) for peg in fixture.pegs[3:]))
        seen.setdefault(number, set()).add((fixture.direction, locators, pushed))
    assert all(len(kinds) == 1 for kinds in seen.values())
    assert 1 < len(seen) < len(result)


@pytest.mark.parametrize("corners", [5, 12])
def test_the_first_image_is_the_first_of_all(corners: int) -> None:
    """Of a regular polygon, of whose many symmetries few are tried, as of one of which all are: no image comes before it,
    and it is one."""
    loop = [[30 * cos(tau * k / corners), 30 * sin(tau * k / corners), 0.0] for k in range(corners)]
    part, random = Workpiece.from_loops("polygon", [loop]), np.random.default_rng(corners)
    keys = np.column_stack([random.integers(0, 2, (300, 2)), random.integers(0, corners, (300, 4))])
    carriers = VISE.peg_carriers(keys[:, 0].astype(np.int8))
    keys[:, 2:] = np.take_along_axis(keys[:, 2:], np.lexsort((keys[:, 2:], carriers), axis=-1), axis=1)
    for key, first in zip(keys.tolist(), smallest_images(keys, part, VISE).tolist(), strict=True):
        images = []
        for image in symmetries([face.segment for face in part.faces]):
            a, b, c, d = (int(image[face]) for face in key[2:])
            images += [sorted([a, b]) + sorted([c, d]), sorted([c, d]) + sorted([a, b])]
            if key[0] == 1:
                images[-2:] = [[*sorted([a, b, c]), d]]
        assert first == [*key[:2], *min(images)]


def test_entries_count_every_fixture_once() -> None:
    """Those listed, those like them, and those left out; each entry is the first of its group, and none left out is fit."""
    result = design(load("widget"), Vise(pitch=8, columns=2, peg_radius=3))
    shown = entries(result)
    assert len(shown.index) + shown.like.sum() + shown.unfit == len(result)
    assert shown.unfit == unfit(result.table.quality, result.query.tolerance).sum() > 0
    assert (np.diff(shown.index) > 0).all()
    everything = entries(result, with_unfit=True)
    assert everything.unfit == 0 and len(everything.index) + everything.like.sum() == len(result)
    group = near_duplicates(result.table, result.workpiece, result.toolkit)
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
    one, other = np.split(near_duplicates(both, result.workpiece, result.toolkit), 2)
    two_and_two = result.table.arrangement == 0
    assert (one == other)[two_and_two].all() and not (one == other)[~two_and_two].all()
