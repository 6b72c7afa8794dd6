"""Fixtures that rotations of the part carry into each other are one set."""

from __future__ import annotations

from math import cos, pi, sin, tau

import numpy as np
import pytest
from attrs import evolve

from workhold import Query, Vise, Workpiece
from workhold.contact.problem import Problem
from workhold.conventions import SAME_POSE
from workhold.geometry.rotation import rotated
from workhold.listing.canonical_form import Candidates, canonical_form, joined
from workhold.listing.finish import finish
from workhold.listing.identity import PartRotations
from workhold.search.cells import run_blocks
from workhold.search.toolkit_search import ToolkitSearch


def polygon(corners: int) -> Workpiece:
    """A regular polygon about the origin, one corner on the x axis."""
    loop = [[30 * cos(tau * k / corners), 30 * sin(tau * k / corners), 0.0] for k in range(corners)]
    return Workpiece.from_loops("polygon", [loop])


def found(problem: Problem) -> Candidates:
    """All fixtures of a problem, listed once."""
    search = ToolkitSearch.of(problem)
    records, _ = run_blocks(search.blocks(problem.query.arrangements), 1, None, None)
    return finish(records, problem)[0]


@pytest.mark.parametrize("corners", [3, 4, 5, 6])
def test_what_is_turned_has_the_same_smallest_form(corners: int) -> None:
    """Whatever rotation a fixture is carried by: the set it makes is the same, and so is the number of sets."""
    problem = Problem.of(Query(polygon(corners), Vise(pitch=9, columns=2, peg_radius=2)))
    turns, c = PartRotations.of(problem), found(problem)
    assert len(turns.rotations) == corners and len(c.standing) > 100
    words, pose, kind = turns.smallest(c)
    sets = turns.count((*words, *pose.T, kind))
    faces = {int(face): feature for feature, face in enumerate(problem.faces)}
    assert len(faces) == len(problem.faces) == corners
    everything = [c]
    for rotation in turns.rotations[1:]:
        carried = [faces[int(rotation.image[face])] for face in problem.faces]
        point = np.stack(rotated(*np.moveaxis(c.point - turns.kept, 2, 0), rotation.angle), axis=2) + turns.kept
        turned = evolve(c, theta=c.theta - rotation.angle, feature=np.array(carried)[c.feature], point=point)
        everything.append(canonical_form(turned, problem.frame.swapped))
        again = turns.smallest(everything[-1])
        np.testing.assert_array_equal(again[0], words)
        np.testing.assert_allclose(again[1], pose, atol=SAME_POSE)
    words, pose, kind = turns.smallest(joined(everything))
    np.testing.assert_array_equal(turns.count((*words, *pose.T, kind)), sets)
    # Each fixture of Type II is one of as many as there are rotations; one of Type I may be its own half turn.
    listed = np.bincount(kind[: len(c.standing)], minlength=2)
    assert sets[1] * corners == listed[1]
    assert listed[0] / corners <= sets[0] <= listed[0] / corners * 2
    assert corners % 2 == 0 or sets[0] * corners == listed[0]
    assert (c.theta < 2 * pi).all()
