"""Families of parts on which rounding or a missed case would show: each with its expected answer."""

from __future__ import annotations

from math import cos, radians, sin, sqrt
from pathlib import Path

import pytest

from fixture_sets import Judge, assert_same, listed, missing, turned
from workhold import InputError, Query, Vise, Workpiece, design, load
from workhold.algebra import find_fixtures_by_algebra
from workhold.geometry import loop

DRAWINGS = Path(__file__).parent.parent / "data" / "drawings"


def disc(radius: float, x: float = 0.0, y: float = 0.0) -> list[list[float]]:
    """A whole circle as two halves."""
    return [[x + radius, y, 1.0], [x - radius, y, 1.0]]


@pytest.mark.parametrize("pitch", [7.0, 10.0, 13.37])
def test_a_disc_has_no_fixture(pitch: float) -> None:
    """All normals of a circle meet in its centre, so nothing resists a turn: no fixture, whatever rounding pretends."""
    result = design(Workpiece.from_loops("disc", [disc(20.0)]), Vise(pitch=pitch, columns=3, peg_radius=3))
    assert result.counts == {"I": 0, "II": 0}
    assert result.distinct == {"I": 0, "II": 0}


def test_a_concentric_ring_has_no_fixture() -> None:
    """Pegs inside and outside a ring of two concentric circles still push through one point."""
    ring = Workpiece.from_loops("ring", [disc(30.0), disc(21.0)])
    assert len(design(ring, Vise(pitch=10, columns=2, peg_radius=3))) == 0


def test_equal_arcs_one_peg_step_apart() -> None:
    """Two left pegs on two equal arcs whose centres are exactly one step apart: the part slides around both at once, and
    two right pegs in a wedge stop it. By symmetry the forces of each jaw are equal."""
    outline = [[0, 14, 1], [0, 6, 0], [0, 4, 1], [0, -4, 0], [20, -4, 0], [30, 5, 0], [20, 14, 0]]
    part = Workpiece.from_loops("two bumps", [outline])
    vise = Vise(pitch=10, columns=1, peg_radius=1)
    # The upper right edge runs from (30, 5) to (20, 14); a peg in row 1 touches it where its centre is at x.
    x = 30 - (10 - 5) * 10 / 9 + sqrt(181) / 9
    planted = {
        "type": "I",
        "pegs": [
            {"jaw": "left", "column": 0, "row": 0, "x": -5.0, "y": 0.0, "segment": 2},
            {"jaw": "left", "column": 0, "row": 1, "x": -5.0, "y": 10.0, "segment": 0},
            {"jaw": "right", "column": 0, "row": 0, "x": x, "y": 0.0, "segment": 4},
            {"jaw": "right", "column": 0, "row": 1, "x": x, "y": 10.0, "segment": 5},
        ],
        "pose": {"theta_deg": 0.0, "x": 0.0, "y": 0.0},
        "jaw_separation": x + 5,
    }
    judge = Judge(part, vise)
    assert judge.check(planted)[0] == []
    assert missing(listed(design(part, vise)), [planted], judge) == []


@pytest.mark.thorough
@pytest.mark.parametrize("turn", [0.0, 1e-13, 1e-7, 0.3])
def test_a_bar_with_parallel_faces_at_any_angle(turn: float) -> None:
    """A rectangle is held the same however it is drawn: its sliding pair chords do not depend on being aligned."""
    from math import cos, sin

    corners = [(0.0, 0.0), (62.0, 0.0), (62.0, 34.0), (0.0, 34.0)]
    straight = Workpiece.from_loops("bar", [[[x, y, 0.0] for x, y in corners]])
    slanted = Workpiece.from_loops(
        "bar", [[[x * cos(turn) - y * sin(turn), x * sin(turn) + y * cos(turn), 0.0] for x, y in corners]]
    )
    vise = Vise(pitch=10, columns=2, peg_radius=3)
    assert_same(
        listed(design(slanted, vise)), turned(listed(design(straight, vise)), turn), Judge(slanted, vise)
    )


@pytest.mark.thorough
def test_pegs_in_round_holes_a_whole_number_of_steps_apart() -> None:
    """A plate with four equal holes on the vise's own lattice: every listed fixture stands up to the checker."""
    holes = [disc(6.0, x, y) for x in (15.0, 35.0) for y in (15.0, 35.0)]
    plate = Workpiece.from_loops("plate", [[[0, 0, 0], [50, 0, 0], [50, 50, 0], [0, 50, 0]], *holes])
    vise = Vise(pitch=20, columns=2, peg_radius=4)
    judge = Judge(plate, vise)
    fixtures = listed(design(plate, vise))
    assert any(peg["segment"] >= 4 for fixture in fixtures for peg in fixture["pegs"])
    assert all(judge.check(fixture)[0] == [] for fixture in fixtures)


def test_a_contact_exactly_at_a_tangent_joint_is_listed_once() -> None:
    """Where a line runs over into an arc a contact at the joint is on both faces; the fixture is one and is listed once."""
    bulge = sqrt(2) - 1  # a quarter circle
    outline = [[0, -10, 0], [20, -10, 0], [35, 5, 0], [24, 16, 0], [6, 16, bulge], [0, 10, 0]]
    part = Workpiece.from_loops("rounded", [outline])
    result = design(part, Vise(pitch=10, columns=1, peg_radius=1), types=["I"])
    straight = [
        fixture
        for fixture in result
        if abs(fixture.pose.theta_deg) < 1e-6
        and abs(fixture.pose.x - 1) < 1e-6
        and [peg.row for peg in fixture.pegs] == [0, 1, 0, 1]
        and [peg.face for peg in fixture.pegs[2:]] == [1, 2]
    ]
    assert len(straight) == 1
    assert {peg.face for peg in straight[0].pegs[:2]} <= {4, 5}


@pytest.mark.thorough
def test_a_seam_of_a_whole_circle_is_nowhere() -> None:
    """Where the angle of a whole circle begins to count is nobody's business: turned holes have the same fixtures."""
    plate = [[-40, -30, 0], [40, -28, 0.2], [38, 30, 0], [-42, 25, 0]]
    holes = [disc(7, -20, -10), disc(9, 5, 3)]
    part = Workpiece.from_loops("plate", [plate, *holes])
    vise = Vise(pitch=16, columns=2, peg_radius=1)
    here = listed(design(part, vise))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(loop, "SEAM_ANGLE", 1.0)
        there = listed(design(Workpiece.from_loops("plate", [plate, *holes]), vise))
    assert len(here) > 100
    assert_same(here, there, Judge(part, vise))


def test_antipodal_pegs_in_a_hole_hold_nothing() -> None:
    """Two pegs across a hole, as far apart as they fit, share one line of action: rounding must not make them a grip."""
    part = Workpiece.from_loops(
        "plate",
        [[[-40, -30, 0], [40, -28, 0.2], [38, 30, 0], [-42, 25, 0]], disc(9, 5, 3), disc(7, -20, -10)],
    )
    result = design(part, Vise(pitch=8, columns=2, peg_radius=1), types=["II"])
    assert len(result) > 100
    assert result.table.force.max() < 1e6
    assert result.proof is not None
    assert result.proof.undecided == ()


@pytest.mark.thorough
def test_a_circle_drawn_in_many_pieces_is_one_face() -> None:
    """Joints inside a face are nothing a peg could notice: a slot drawn with split sides has the same fixtures."""
    whole = Workpiece.from_loops("slot", [[[0, 0, 0], [40, 0, 1], [40, 20, 0], [5, 21, 0.8]]])
    split = Workpiece.from_loops(
        "slot",
        [[[0, 0, 0], [13, 0, 0], [40, 0, sqrt(2) - 1], [50, 10, sqrt(2) - 1], [40, 20, 0], [5, 21, 0.8]]],
    )
    assert [face.number for face in split.faces] == [0, 2, 4, 5]
    vise = Vise(pitch=9, columns=2, peg_radius=2)
    names = {0: 0, 1: 2, 2: 4, 3: 5}
    here = turned(listed(design(whole, vise)), 0.0, names.__getitem__)
    assert_same(listed(design(split, vise)), here, Judge(split, vise))


def test_a_peg_that_fits_nowhere_is_refused() -> None:
    """A part whose faces are all hidden from the peg is refused with a remedy: here a peg as large as can be still
    touches, so every part has a feature; the message is for outlines of concave arcs alone."""
    star = [[10.0, 0.0, -0.2], [0.0, 10.0, -0.2], [-10.0, 0.0, -0.2], [0.0, -10.0, -0.2]]
    part = Workpiece.from_loops("star", [star])
    with pytest.raises(InputError, match=r"a peg of radius 40 mm fits nowhere along star.*smaller peg"):
        design(part, Vise(pitch=100, columns=1, peg_radius=40))


@pytest.mark.thorough
@pytest.mark.parametrize("shift", [0.0, 1e4])
@pytest.mark.parametrize("scale", [0.01, 1.0])
def test_far_from_the_origin_and_very_small(shift: float, scale: float) -> None:
    """Where the drawing puts its origin, and the size of the part, do not change what is found."""
    outline = [[0, 0, 0], [50, 4, 0.3], [48, 30, 0], [20, 36, -0.4], [2, 25, 0]]
    near = Workpiece.from_loops("near", [[[x * scale, y * scale, b] for x, y, b in outline]])
    far = Workpiece.from_loops("far", [[[x * scale + shift, y * scale - shift, b] for x, y, b in outline]])
    vise = Vise(pitch=10 * scale, columns=2, peg_radius=2.5 * scale)
    here, there = listed(design(near, vise)), listed(design(far, vise))
    assert len(here) > 0
    for fixture in there:
        # The pose of the same part drawn about the origin.
        pose, angle = fixture["pose"], radians(fixture["pose"]["theta_deg"])
        pose["x"] += shift * (cos(angle) + sin(angle))
        pose["y"] += shift * (sin(angle) - cos(angle))
    assert_same(there, here, Judge(near, vise))


@pytest.mark.thorough
def test_slots_on_the_lattice_of_the_vise() -> None:
    """A plate and a bar whose sizes are whole pitches make chords run through coincidences (equal arcs a step apart, a chord
    square to a line at an arc's far side): the counts are those of the paper's algebra, an engine without chords."""
    bar = Workpiece.from_loops("bar", [[[0, -8, 0], [30, -8, 1], [30, 8, 0], [0, 8, 1]]])
    slots = [[[10, 20, 1], [20, 20, 1]], [[30, 20, 1], [40, 20, 1]]]
    plate = Workpiece.from_loops("plate", [[[0, 0, 0], [50, 0, 0], [50, 40, 0], [0, 40, 0]], *slots])
    for part, columns in ((bar, 2), (plate, 1)):
        vise = Vise(pitch=10, columns=columns, peg_radius=2)
        ours, theirs = listed(design(part, vise)), listed(find_fixtures_by_algebra(Query(part, vise)))
        assert len(ours) > 100
        assert_same(ours, theirs, Judge(part, vise))


@pytest.mark.thorough
def test_a_drawing_turned_and_saved_is_decided() -> None:
    """A part with a slot, turned by an odd angle and saved with a dozen digits: its parallel lines are so to 1e-13 only.
    Three pegs on such lines leave the fourth no share, wherever along them the exact contact may be."""
    turned_part = load(DRAWINGS / "bracket_turned.json")
    result = design(turned_part, Vise(pitch=20, columns=2, peg_radius=3))
    assert len(result) > 2000
    assert result.proof is not None and result.proof.undecided == ()
