"""Rotations that carry an outline onto itself."""

from __future__ import annotations

from math import cos, sin, tau

import numpy as np
import pytest
from hypothesis import given, settings

import workhold
from strategies import outlines
from workhold import Workpiece
from workhold.geometry.symmetry import find_rotations_onto_itself


def group(*loops):
    """Rotations of a workpiece of some loops."""
    return find_rotations_onto_itself([face.segment for face in Workpiece.from_loops("part", loops).faces])


def circle(x, y, radius):
    """A circle in two halves."""
    return [[x - radius, y, -1], [x + radius, y, -1]]


def ngon(count, radius, bulge=0.0, turn=0.3):
    """A regular polygon, its sides bulged alike."""
    angles = [turn + tau * k / count for k in range(count)]
    return [[5 + radius * cos(a), -7 + radius * sin(a), bulge] for a in angles]


@pytest.mark.parametrize("count", [3, 4, 5, 6, 12])
@pytest.mark.parametrize("bulge", [0.0, 0.1, -0.05])
def test_a_regular_polygon_has_the_cyclic_group(count, bulge):
    """n equal sides: rotations by whole multiples of a turn / n, each carrying side k to k + j."""
    rotations = group(ngon(count, 20, bulge))
    assert [r.angle for r in rotations] == pytest.approx([tau * k / count for k in range(count)])
    for k, rotation in enumerate(rotations):
        assert rotation.image.tolist() == [(j + k) % count for j in range(count)]


def test_known_parts():
    """Rectangle 2, square 4, ring 1 (it turns freely; none is singled out), a hole off the middle of a square 1."""
    square = [[0, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, 0]]
    assert len(group([[0, 0, 0], [30, 0, 0], [30, 20, 0], [0, 20, 0]])) == 2
    assert len(group(square)) == 4
    assert len(group(square, circle(10, 10, 3))) == 4
    assert len(group(square, circle(9, 10, 3))) == 1
    assert len(group(circle(0, 0, 20), circle(0, 0, 8))) == 1
    assert len(group(circle(0, 0, 20), circle(0, 10, 4), circle(0, -10, 4))) == 2
    assert (
        len(
            group(circle(0, 0, 20), *(circle(12 * cos(a), 12 * sin(a), 3) for a in (0, tau / 3, 2 * tau / 3)))
        )
        == 3
    )


def test_parallelograms_turn_but_kites_do_not():
    """A mirror symmetry is not a rotation."""
    assert len(group([[0, 0, 0], [30, 0, 0], [40, 20, 0], [10, 20, 0]])) == 2
    assert len(group([[0, 0, 0], [10, -5, 0], [30, 0, 0], [10, 5, 0]])) == 1


@pytest.mark.parametrize(
    "name, order",
    [("widget", 1), ("8Handle", 8), ("large4Handle", 4), ("small4Handle", 4), ("thin4Handle", 4)],
)
def test_built_in_parts(name, order):
    """The handles turn onto themselves as their names say, the widget does not."""
    part = workhold.load(name)
    assert len(find_rotations_onto_itself([face.segment for face in part.faces])) == order


@settings(max_examples=60)
@given(outlines())
def test_images_are_permutations_that_form_a_group(part):
    """The identity comes first; images are permutations; rotations compose to rotations; images are where they say."""
    segments = [face.segment for face in part.faces]
    rotations = find_rotations_onto_itself(segments)
    assert rotations[0].angle == 0.0 and rotations[0].image.tolist() == list(range(len(segments)))
    known = {tuple(r.image) for r in rotations}
    for one in rotations:
        assert sorted(one.image) == list(range(len(segments)))
        for two in rotations:
            assert tuple(one.image[two.image]) in known
        for k, segment in enumerate(segments):
            assert np.isclose(segment.length, segments[one.image[k]].length)


def test_a_bump_is_never_carried_onto_a_notch():
    """A square with half-round bumps to the right and the left and notches of the same size above and below: a quarter turn
    carries every circle onto a circle, and its ends onto ends, but material onto air. Only the half turn is its own."""
    side = [[20, -20, 0], [20, -5, 1], [20, 5, 0], [20, 20, 0], [5, 20, -1], [-5, 20, 0]]
    bumps_and_notches = side + [[-x, -y, bulge] for x, y, bulge in side]
    assert [r.angle for r in group(bumps_and_notches)] == pytest.approx([0.0, tau / 2])
    all_bumps = [[x, y, abs(bulge)] for x, y, bulge in bumps_and_notches]
    assert len(group(all_bumps)) == 4


def test_holes_of_different_sizes_are_not_carried_onto_each_other():
    """A square with a hole in every corner has four rotations, with one of them larger it has one, with two opposite two."""
    square = [[-30, -30, 0], [30, -30, 0], [30, 30, 0], [-30, 30, 0]]

    def order(*radii):
        places = ((15, 15), (-15, 15), (-15, -15), (15, -15))
        return len(
            group(square, *(circle(x, y, radius) for (x, y), radius in zip(places, radii, strict=True)))
        )

    assert (order(3, 3, 3, 3), order(3, 5, 3, 5), order(3, 3, 5, 5), order(5, 3, 3, 3)) == (4, 2, 1, 1)
