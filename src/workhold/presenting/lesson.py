"""A lesson: the data of one part for the page that explains the method.

Glossary
--------
lesson : a part with its contact features, and its Type I fixtures whose pegs stand on chord curves.
shown fixture : the fixture in the page's pictures; both of its chords have room to slide.

The vise of a lesson is chosen for the part, with few holes under it, so that a picture shows them all. All
data are in the part's own coordinates, except pegs, which are in the vise's. Lengths are in mm, angles in
radians unless a name says degrees.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot, radians, tau
from threading import Event
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.contact.curves import CurveTable, loosen_rows, make_curve_table
from workhold.contact.problem import Problem
from workhold.errors import InputError
from workhold.files.result.writer import make_toolkit_fields
from workhold.fixels.vise import Vise
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    IS_ARC,
    RADIUS,
    SEGMENT_LENGTH,
    SIGN,
    X,
    Y,
)
from workhold.kernels.base.tables import BRANCH, COLUMN_STEP, FROM, HEAD, LENGTH, ROW_STEP, SHIFT, TAIL, TO
from workhold.kernels.chord.evaluation import compute_chord, find_parameter, measure_end_distance
from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query
from workhold.model.requirements import Restrictions
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece
from workhold.search.design import answer
from workhold.search.toolkit_search import list_lattice_steps

__all__ = ["compute_lesson"]

# Columns of a feature's row that a browser needs.
FEATURE = [IS_ARC, X, Y, AXIS_X, AXIS_Y, HALF_EXTENT, RADIUS, SIGN]
# Faces that are looked at: the longest ones, so that the search of a detailed part ends soon.
MOST_FACES = 40
# Fixtures that a lesson carries at most.
MOST_FIXTURES = 300
# Row pitches that are tried, as shares of the part's smaller extent, with one column and then with two.
PITCHES = (0.42, 0.3, 0.55, 0.22)
# A peg's radius as a share of the pitch.
PEG = 0.25
# A part that can turn by this much either way, in radians, shows how it slides.
ROOM = 0.17
# Tails this near to a peg, in mm, are the peg's.
SAME = 1e-5
# How far a root may lie outside the ends of its chord's range, in radians: those of the ranges are rounded.
END = 1e-6


@frozen
class ChordRange:
    """A chord of a fixture (the step between two holes, with its pegs on two features), and the orientations
    where it exists.

    Parameters
    ----------
    tail, head : numbers of the features touched by its first and its last peg.
    swapped : whether the chord's tail is the second peg of the pair rather than the first.
    shift, length : direction in radians and length in mm of the step between the holes.
    branch : 1 or -1, to select one of two chords.
    low, high : least and greatest orientation psi in radians, an interval around that of the fixture.
    """

    tail: int
    head: int
    swapped: bool
    shift: float
    length: float
    branch: float
    low: float
    high: float


@frozen
class CurveFixture:
    """A Type I fixture on two chord curves, with the chord of its first pair of pegs and of its second pair."""

    fixture: Fixture
    rank: int
    chords: tuple[ChordRange, ChordRange]

    @property
    def psi(self) -> float:
        """The orientation in radians of the pegs as seen from the part: minus the angle of the pose."""
        return -radians(self.fixture.pose.theta_deg)

    @property
    def room(self) -> float:
        """The angle in radians by which the part can turn in either direction with all pegs touching;
        negative for none.
        """
        return min(
            self.psi - max(one.low for one in self.chords), min(one.high for one in self.chords) - self.psi
        )


def compute_lesson(workpiece: Workpiece, cancel: Event | None = None) -> dict[str, Any]:
    """Return the lesson of a part.

    Parameters
    ----------
    cancel : when set, the running search ends.

    Returns
    -------
    dict
        Plain data for JSON: the outline, the vise, features, and fixtures with the shown one first.

    Raises
    ------
    InputError
        When no vise tried has a Type I fixture on two chord curves.
    """
    avoided = list_short_faces(workpiece)
    best: tuple[float, Problem, Result, list[CurveFixture]] | None = None
    for query in make_queries(workpiece, avoided):
        try:
            problem, result = Problem.from_query(query), answer(query, cancel=cancel)
        except InputError:
            # The pegs of this vise fit nowhere along the part.
            continue
        found = sorted(find_fixtures_on_curves(problem, result), key=lambda one: -min(one.room, ROOM))
        if found and (best is None or found[0].room > best[0]):
            best = found[0].room, problem, result, found
        if best is not None and best[0] >= ROOM:
            break
    if best is None:
        raise InputError(
            f"no vise that was tried holds {workpiece.name} with two pegs on each jaw that could slide: "
            "choose a part with more sides, or one that is less round."
        )
    return describe_lesson(*best[1:], len(avoided))


def list_short_faces(workpiece: Workpiece) -> tuple[int, ...]:
    """Return the numbers of all faces except the ``MOST_FACES`` longest."""
    faces = sorted(workpiece.faces, key=lambda face: -face.segment.length)
    return tuple(face.number for face in faces[MOST_FACES:])


def make_queries(workpiece: Workpiece, avoided: tuple[int, ...]) -> Iterator[Query]:
    """Yield the queries to try, one for each vise; vises with one column come first."""
    x0, y0, x1, y1 = workpiece.bounds
    for columns in (1, 2):
        for share in PITCHES:
            pitch = round_to_two_digits(share * min(x1 - x0, y1 - y0))
            vise = Vise(pitch, columns, round_to_two_digits(PEG * pitch))
            yield Query(workpiece, vise, types=("I",), restrictions=Restrictions(avoid=avoided))


def round_to_two_digits(length: float) -> float:
    """Return a length rounded to two significant digits.

    >>> round_to_two_digits(17.3), round_to_two_digits(0.4567)
    (17.0, 0.46)
    """
    return float(f"{length:.2g}")


def find_fixtures_on_curves(problem: Problem, result: Result) -> list[CurveFixture]:
    """Return the fixtures of a result whose two pairs of pegs both stand on chord curves, in the result's
    order.
    """
    frame = problem.frame
    steps = list_lattice_steps(frame.carriers, problem.diameter)
    table = make_curve_table(loosen_rows(problem.rows[:, :SEGMENT_LENGTH]), steps)
    out = []
    for rank, fixture in enumerate(result, 1):
        first, second = (
            find_chord_range(problem, table, fixture, pair)
            or find_chord_range(problem, table, fixture, pair[::-1], True)
            for pair in (fixture.pegs[:2], fixture.pegs[2:])
        )
        if first is not None and second is not None:
            out.append(CurveFixture(fixture, rank, (first, second)))
    return out


def find_chord_range(
    problem: Problem, table: CurveTable, fixture: Fixture, pegs: tuple[Peg, ...], swapped: bool = False
) -> ChordRange | None:
    """Return the chord on which two pegs of a fixture stand.

    Returns None if they are on a pair of features along which they can slide, or in reverse order.
    """
    tail, head = pegs
    inverse, center = fixture.pose.inverse, problem.workpiece.center
    places = [
        (float(x) - center[0], float(y) - center[1]) for x, y in (inverse.apply(peg.x, peg.y) for peg in pegs)
    ]
    ends = [find_feature(problem, peg.face, place) for peg, place in zip(pegs, places, strict=True)]
    step = head.column - tail.column, head.row - tail.row
    psi = -radians(fixture.pose.theta_deg)
    numbers, reals = table.curves.integers, table.curves.reals
    (alike,) = np.nonzero((numbers[:, [TAIL, HEAD, COLUMN_STEP, ROW_STEP]] == (*ends, *step)).all(axis=1))
    for one in alike:
        real = reals[one]
        alpha = real[FROM] - END + (psi + real[SHIFT] - real[FROM] + END) % tau
        ux, uy = compute_chord(
            problem.rows[ends[0]], problem.rows[ends[1]], real[LENGTH], alpha, real[BRANCH]
        )[:2]
        if alpha <= real[TO] + END and hypot(ux - places[0][0], uy - places[0][1]) < SAME:
            low, high = (float(psi + end - alpha) for end in (real[FROM], real[TO]))
            length, branch, shift = (float(real[column]) for column in (LENGTH, BRANCH, SHIFT))
            return ChordRange(ends[0], ends[1], swapped, shift, length, branch, low, high)
    return None


def find_feature(problem: Problem, face: int, place: tuple[float, float]) -> int:
    """Return the number of the feature of a face on which a peg's centre lies.

    If the centre lies on several, it is the feature whose ends are farthest away. ``place`` is the peg's
    centre in mm, relative to the centre of the part's bounding box.
    """
    (own,) = np.nonzero(problem.faces == face)
    return int(
        max(own, key=lambda k: measure_end_distance(problem.rows[k], find_parameter(problem.rows[k], *place)))
    )


def describe_lesson(
    problem: Problem, result: Result, found: list[CurveFixture], avoided: int
) -> dict[str, Any]:
    """Return a lesson as plain data, with at most ``MOST_FIXTURES`` of the fixtures ``found``.

    ``avoided`` is the number of faces that were left out.
    """
    part = problem.workpiece
    features: NDArray[np.float64] = problem.rows[:, FEATURE] + np.array([0, *part.center, 0, 0, 0, 0, 0])
    return {
        "name": part.name,
        "loops": [loop.tolist() for loop in part.loops],
        "toolkit": make_toolkit_fields(result.toolkit),
        "features": features.tolist(),
        "faces": problem.faces.tolist(),
        "faces_left_out": avoided,
        "found": sum(result.found.values()),
        "curves": result.statistics["chord_curves"],
        "pairs": result.statistics["curve_pairs"],
        "on_curves": len(found),
        "fixtures": [describe_curve_fixture(one) for one in found[:MOST_FIXTURES]],
    }


def describe_curve_fixture(one: CurveFixture) -> dict[str, Any]:
    """Return a fixture and its chords as plain data: angles in radians, lengths in mm."""
    fixture = one.fixture
    return {
        "rank": one.rank,
        "pose": [radians(fixture.pose.theta_deg), fixture.pose.x, fixture.pose.y],
        "opening": fixture.travel,
        "pegs": [[peg.column, peg.row, peg.x, peg.y, peg.face, peg.force] for peg in fixture.pegs],
        "chords": [
            [c.tail, c.head, int(c.swapped), c.shift, c.length, c.branch, c.low, c.high] for c in one.chords
        ],
    }
