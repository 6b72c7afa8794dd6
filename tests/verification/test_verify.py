"""What a search lists is proven, exact coincidences too."""

from __future__ import annotations

import sys
from math import cos, radians, sin, sqrt
from pathlib import Path

import attrs
import pytest
from flint import ctx
from hypothesis import given, settings

from fixture_sets import SETS, complete_set
from strategies import outlines, vises
from workhold import Fixture, Peg, Pose, Result, Vise, Workpiece, design, load, save
from workhold.verification import verify, verify_file, verify_fixture

RING = [
    [[30.0, 0.0, 1.0], [-30.0, 0.0, 1.0]],
    [[-20.0, -9.0, 0.0], [-20.0, 9.0, 0.0], [4.0, 9.0, -1.0], [4.0, -9.0, 0.0]],
]
RECTANGLE = [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]]
# An outline with concave corners between lines and arcs.
NOTCHED = [
    [
        [0, 0, 0],
        [21, 0, 0],
        [25, 12, -0.4],
        [38, 10, 0],
        [40, 1, 0],
        [61, 3, 0.3],
        [55, 37, 0],
        [33, 29, 0],
        [20, 39, 0],
    ]
]
WEDGE = [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]]


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("part", "vise"),
    [
        ("widget", Vise(pitch=8, columns=1, peg_radius=3)),
        ("oblongPart", Vise(pitch=10, columns=10, peg_radius=3)),
        ("small4Handle", Vise(pitch=10, columns=2, peg_radius=3)),
        ("flange", Vise(pitch=8, columns=2, peg_radius=3, rows=9, max_opening=20, row_offset=1.5)),
        (RING, Vise(pitch=12, columns=2, peg_radius=2)),
        (WEDGE, Vise(pitch=15, columns=1, peg_radius=0)),
    ],
)
def test_everything_a_search_lists_is_proven(
    part: str | list[list[list[float]]], vise: Vise, tmp_path: Path
) -> None:
    workpiece = load(part) if isinstance(part, str) else Workpiece.from_loops("part", part)
    result = design(workpiece, vise)
    save(result, tmp_path / "result.json")
    outcome = verify_file(tmp_path / "result.json")
    assert len(result) > 0
    assert outcome.proven == outcome.fixtures == len(result)
    assert outcome.holds
    assert verify(result) == outcome


@pytest.mark.thorough
def test_contact_margins_are_proven() -> None:
    """Also along arcs and beside tangent joints, where a peg comes near to the next face only slowly."""
    outcome = verify(design(load("widget"), Vise(pitch=8, columns=1, peg_radius=3), contact_margin=0.5))
    assert outcome.fixtures > 100
    assert outcome.proven == outcome.fixtures
    assert outcome.bits == 128


@pytest.mark.thorough
@pytest.mark.parametrize("wide", [0.01, 1.25])
@pytest.mark.parametrize("loops", [None, NOTCHED])
def test_a_margin_that_was_not_asked_for(loops: list[list[list[float]]] | None, wide: float) -> None:
    """With a larger margin than the search's, exactly the fixtures are proven that a search with that margin lists; also
    where features end because the peg comes to touch another face."""
    part = load("widget") if loops is None else Workpiece.from_loops("notched", loops)
    vise = Vise(pitch=8, columns=1, peg_radius=3)
    result = design(part, vise)
    outcome = verify(attrs.evolve(result, query=attrs.evolve(result.query, contact_margin=wide)))
    assert outcome.undecided == 0
    assert outcome.refuted > 0
    assert outcome.proven == len(design(part, vise, contact_margin=wide))


@pytest.mark.thorough
def test_a_separation_of_exactly_the_smallest_gap_is_proven() -> None:
    """A rectangle aligned with the lattice: two faces are as far apart as two holes, whatever the precision."""
    vise = Vise(pitch=10, columns=2, peg_radius=3)
    result = design(Workpiece.from_loops("rectangle", RECTANGLE), vise)
    outcome = verify(result)
    assert outcome.proven == outcome.fixtures > 500
    assert outcome.bits == 128
    assert sum(abs(fixture.travel - vise.min_gap) < 1e-12 for fixture in result) >= 2


def test_a_contact_exactly_at_a_tangent_joint_is_proven() -> None:
    outline = [[0, -10, 0], [20, -10, 0], [35, 5, 0], [24, 16, 0], [6, 16, sqrt(2) - 1], [0, 10, 0]]
    part = Workpiece.from_loops("rounded", [outline])
    outcome = verify(design(part, Vise(pitch=10, columns=1, peg_radius=1)))
    assert outcome.proven == outcome.fixtures > 0


@pytest.mark.thorough
@pytest.mark.parametrize("name", SETS)
def test_complete_sets_are_proven(name: str) -> None:
    """Everything found for the parts and vises of the complete sets."""
    _, result = complete_set(name)
    outcome = verify(result)
    assert outcome.proven == len(result) > 10
    assert (outcome.refuted, outcome.undecided, outcome.faults) == (0, 0, ())


@pytest.mark.thorough
@settings(max_examples=15)
@given(outlines(max_faces=6), vises(max_columns=2))
def test_nothing_found_on_a_random_part_is_refuted(workpiece: Workpiece, vise: Vise) -> None:
    outcome = verify(design(workpiece, vise, best=60))
    assert outcome.holds, outcome.unproven


def test_opening_the_vise_is_not_closing_it() -> None:
    """Four pegs in a diamond hole push outward: the forces close, and the vise would have to open."""
    angle, radius = radians(50), 1.0
    # Pegs at (+-15, +-5) about the middle; the walls are this far from it.
    far = 15 * cos(angle) + 5 * sin(angle) + radius
    x, y = far / cos(angle), far / sin(angle)
    diamond = [[-x, 0, 0], [0, y, 0], [x, 0, 0], [0, -y, 0]]
    plate = Workpiece.from_loops("plate", [[[-40, -40, 0], [40, -40, 0], [40, 40, 0], [-40, 40, 0]], diamond])
    # Sides of the hole, run clockwise: upper left 4, upper right 5, lower right 6, lower left 7.
    pegs = (
        Peg("left", 0, 0, 0.0, 0.0, 7, 1.0),
        Peg("left", 0, 1, 0.0, 10.0, 4, 1.0),
        Peg("right", 0, 0, 30.0, 0.0, 6, 1.0),
        Peg("right", 0, 1, 30.0, 10.0, 5, 1.0),
    )
    fixture = Fixture("I", pegs, Pose(0.0, 15.0, 5.0), 30.0, {})
    ruling = verify_fixture(fixture, plate, Vise(pitch=10, columns=1, peg_radius=radius))
    assert ruling.verdict == "refuted"
    assert ruling.reason.startswith("closing the vise does not clamp")


def test_a_precision_that_is_too_low_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 20 bits nothing about contacts can be shown, and nothing false is."""
    result = design(Workpiece.from_loops("wedge", WEDGE), Vise(pitch=15, columns=1, peg_radius=2))
    module = sys.modules[verify.__module__]
    monkeypatch.setattr(module, "PRECISIONS", (20,))
    low = verify(result)
    assert (low.proven, low.refuted) == (0, 0)
    monkeypatch.setattr(module, "PRECISIONS", (20, 200))
    high = verify(result)
    assert high.proven == len(result)
    assert high.bits == 200


def test_the_precision_of_others_is_left_alone(widget_result: Result) -> None:
    before = ctx.prec
    verify(widget_result)
    assert ctx.prec == before


def test_progress_runs_to_the_end(widget_result: Result) -> None:
    told: list[tuple[float, int]] = []
    verify(widget_result, lambda fraction, unproven: told.append((fraction, unproven)))
    assert len(told) == len(widget_result)
    assert told[-1] == (1.0, 0)
    assert told == sorted(told)


def test_a_part_with_faces_a_hair_off_square_is_proven() -> None:
    """Which of the two directions counts is one rule, so that the tilts of the file are those of the verification."""
    loop = [[0, 0, 0.05], [64, 1.5, 0.02], [83.1265, 44.4598, 0], [-1.84987, 40.5763, 0]]
    result = design(Workpiece.from_loops("part", [loop]), Vise(pitch=20, columns=1, peg_radius=2))
    assert len(result) > 0
    assert verify(result).proven == len(result)
