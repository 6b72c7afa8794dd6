"""Bringing fixtures to one form and listing each once."""

from __future__ import annotations

from math import pi

import numpy as np
from attrs import evolve

from candidate_examples import candidates
from workhold.listing.canonical_form import list_each_once, make_canonical, mark_changes, pack_integers


def test_same_holes_and_pose_on_two_faces_is_listed_once() -> None:
    """A contact at a tangent joint is found on both faces, with rounding between the two: one is kept."""
    twice = candidates(2)
    feature = twice.feature.copy()
    feature[1, 2] = 7
    twice = evolve(
        twice, feature=feature, theta=twice.theta + np.array([0.0, 3e-9]), point=twice.point + 1e-9
    )
    assert len(list_each_once(twice).standing) == 1


def test_same_holes_and_orientation_in_two_places_are_two() -> None:
    """The same holes, faces and orientation with the part elsewhere is another fixture; which comes first does not depend
    on the order in which they were found."""
    both = candidates(2)
    point = both.point.copy()
    point[1] += [1.0, -2.0]
    both = evolve(both, point=point)
    for order in ([0, 1], [1, 0], [1, 0, 1]):
        assert list_each_once(both.take(np.array(order))).point[:, 0].tolist() == [[1.0, -2.0], [0.0, 0.0]]


def test_fixtures_are_in_the_order_of_types_holes_orientation_faces_and_place() -> None:
    """Each of these counts only where those before it are equal."""
    many = candidates(6)
    standing, row, theta, feature, point = (
        getattr(many, name).copy() for name in ("standing", "row", "theta", "feature", "point")
    )
    standing[5], row[4, 0], theta[3], feature[2, 0], point[1] = 3, 1, 0.6, 1, point[1] + 5.0
    # So that each but the first would come first by what counts less.
    point[2:] -= 5.0 * np.arange(1, 5)[:, None, None]
    many = evolve(many, standing=standing, row=row, theta=theta, feature=feature, point=point)
    listed = list_each_once(many.take(np.array([3, 5, 1, 0, 4, 2])))
    assert np.array_equal(listed.point, point)


def test_half_turn_swaps_the_jaws_to_one_form() -> None:
    """Seen from the other side, with rows and columns counted the other way, a Type I fixture has the same form."""
    here = candidates(1)
    there = evolve(
        here,
        feature=here.feature[:, ::-1],
        column=5 - here.column[:, ::-1],
        row=9 - here.row[:, ::-1],
        theta=here.theta + pi,
        point=here.point[:, ::-1],
        null=here.null[:, ::-1],
        force=here.force[:, ::-1],
    )
    one, other = make_canonical(here, 2), make_canonical(there, 2)
    for name in ("standing", "feature", "column", "row", "null"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
    assert np.allclose(one.theta, other.theta)


def test_orientations_at_the_ends_of_the_half_turn_are_one() -> None:
    """An orientation a hair below half a turn and one a hair above 0 are brought to the same side."""
    here = candidates(2)
    turned = evolve(here, theta=np.array([1e-9, 2e-9]))
    assert (np.abs(make_canonical(turned, 2).theta) < 1e-8).all()
    below = evolve(here, theta=np.array([pi - 1e-9, 2 * pi - 1e-9]))
    assert (np.abs(make_canonical(below, 2).theta) < 1e-8).all()


def test_packed_numbers_keep_their_order() -> None:
    """Rows of whole numbers, packed into one number or several, are ordered as they were."""
    random = np.random.default_rng(5)
    for most, width in ((1, 2), (9, 4), (1000, 9), (1 << 40, 3)):
        numbers = random.integers(0, most + 1, (300, width))
        words = pack_integers((numbers[:, :1], most), (numbers[:, 1:], most))
        assert len(words) == -(-width // (63 // int(most).bit_length()))
        order, packed_order = np.lexsort(numbers.T[::-1]), np.lexsort(words[::-1])
        assert np.array_equal(numbers[order], numbers[packed_order])
        fresh = np.ones(300, np.bool_)
        fresh[1:] = (numbers[order][1:] != numbers[order][:-1]).any(axis=1)
        assert np.array_equal(mark_changes([word[order] for word in words]), fresh)
