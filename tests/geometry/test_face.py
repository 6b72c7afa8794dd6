"""Faces: neighbouring segments of one line or circle are one face."""

from __future__ import annotations

from math import cos, pi, sin, tan, tau

import numpy as np
import pytest
from hypothesis import given

from strategies import outlines
from workhold.geometry.segment import Arc, Line
from workhold.model.workpiece import Workpiece


def faces(*loops):
    """Faces of a workpiece of some loops."""
    return Workpiece.from_loops("part", loops).faces


@given(outlines())
def test_faces_partition_the_segments(part):
    """Every segment belongs to one face, a face is named by its smallest segment, and lengths add up."""
    numbers = sorted(n for face in part.faces for n in face.segments)
    assert numbers == list(range(len(part.segments)))
    assert [face.number for face in part.faces] == sorted(min(face.segments) for face in part.faces)
    for face in part.faces:
        assert face.segment.length == pytest.approx(sum(part.segments[n].length for n in face.segments))


@given(outlines())
def test_splitting_segments_changes_no_face(part):
    """Every segment cut in two: twice the segments, the same faces."""
    loops = []
    for vertices, segments in zip(part.loops, part.loop_segments, strict=True):
        loop = []
        for (x, y, bulge), segment in zip(vertices, segments, strict=True):
            half = tan(np.arctan(bulge) / 2)
            loop += [[x, y, half], [*segment.at(0.0), half]]
        loops.append(loop)
    split = Workpiece.from_loops("split", loops)
    assert len(split.faces) == len(part.faces)
    for one, two in zip(part.faces, split.faces, strict=True):
        assert sorted(two.segments) == sorted(2 * n + k for n in one.segments for k in (0, 1))
        assert two.segment.length == pytest.approx(one.segment.length)
        if not (isinstance(one.segment, Arc) and one.segment.is_full):
            assert two.segment.at(0.0) == pytest.approx(one.segment.at(0.0), abs=1e-6)


def test_collinear_segments_are_one_face_across_the_first_vertex():
    """A square begun in the middle of a side has four faces, the first of segments 4 and 0, named 0."""
    found = faces([[10, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, 0], [0, 0, 0]])
    assert [face.number for face in found] == [0, 1, 2, 3]
    assert sorted(found[0].segments) == [0, 4]
    assert isinstance(found[0].segment, Line) and found[0].segment.length == pytest.approx(20)
    assert found[0].segment.start == pytest.approx((0, 0))


@pytest.mark.parametrize("pieces", [2, 3, 5])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_circle_drawn_in_pieces_is_one_face(pieces, sign):
    """k arcs of one circle, either way round, are one whole circle: convex outside, concave as a hole."""
    bulge = sign * tan(tau / pieces / 4)
    circle = [
        [8 * cos(sign * tau * k / pieces), 8 * sin(sign * tau * k / pieces), bulge] for k in range(pieces)
    ]
    (face,) = faces(circle)
    assert face.segment.is_full and face.segment.sign == 1.0 and face.number == 0
    assert face.segment.radius == pytest.approx(8) and face.segment.half_sweep == pi
    square = [[-20, -20, 0], [20, -20, 0], [20, 20, 0], [-20, 20, 0]]
    hole = faces(square, circle)[4]
    assert hole.segment.is_full and hole.segment.sign == -1.0 and hole.number == 4


def test_different_carriers_stay_apart():
    """A bend of 1e-6 rad, and arcs of two radii joined tangentially, are separate faces."""
    assert len(faces([[0, 0, 0], [10, 0, 0], [20, 2e-5, 0], [20, 20, 0], [0, 20, 0]])) == 5
    lens = [[0, 0, tan(pi / 8)], [10, 10, tan(pi / 8)], [-10, 30, 0], [-10, 0, 0]]
    assert len(faces(lens)) == 4
