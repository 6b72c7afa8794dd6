"""The fence: complete sets, a separate slow search, fixtures counted by hand, and the theorems that hold of it."""

from __future__ import annotations

import json
from math import cos, pi, sin, sqrt
from pathlib import Path
from threading import Event
from typing import Any

import attrs
import numpy as np
import pytest

import workhold
from slow_fence import slow_fence
from toolkit_results import NOTCHED, check_and_read_back, checked, part
from workhold import Fence, InputError, Query, Restrictions, Result, Workpiece, answer, circle_zone, design
from workhold.listing import results
from workhold.listing.ranking import find_usual_errors, make_table_keys
from workhold.search import wall_search
from workhold.verification import verify

TESTS = Path(__file__).parent.parent
COMPLETE = sorted((TESTS / "data" / "toolkits").glob("edge_*.json"))
KITE = [(0, 0, 0), (56, 6, 0), (48, 44, 0), (10, 37, 0.2)]
# Two feet beside a gap on the wall, a rounded shoulder, and a mouth.
FEET = [
    (0, 0, 0),
    (14, 0, 0),
    (14, 6, 0),
    (40, 6, 0),
    (40, 0, 0),
    (52, 0, 0.4),
    (60, 24, 0),
    (38, 30, 0),
    (30, 22, 0),
    (4, 40, 0),
]
L = [(0, 0, 0), (60, 0, 0), (60, 20, 0), (20, 20, 0), (20, 50, 0), (0, 50, 0)]


def seen(result: Result, flipped: bool = False) -> set[tuple[Any, ...]]:
    """Fixtures by direction, faces, row and line, and places from the left end of the contact, or the right if flipped."""
    out = set()
    for fixture in result:
        locator, left, right, tip = fixture.pegs
        way = str(fixture.direction)
        line = tip.row if way[1] == "x" else tip.column - locator.column
        u, x = locator.x - left.x, tip.x - left.x
        if flipped:
            u, x = right.x - locator.x, right.x - tip.x
            line = line if way[1] == "x" else -line
            way = {"-x": "+x", "+x": "-x"}.get(way, way)
        places = (round(value, 3) + 0.0 for value in (u, x, tip.y))
        out.add((way, locator.face, tip.face, locator.row, line, *places))
    return out


def faceless(fixtures: set[tuple[Any, ...]]) -> set[tuple[Any, ...]]:
    """The same without the numbers of faces."""
    return {(way, *rest) for way, _, _, *rest in fixtures}


@pytest.mark.thorough
@pytest.mark.parametrize("path", COMPLETE, ids=lambda path: path.stem)
def test_complete_set_is_reproduced(path: Path, tmp_path: Path) -> None:
    """Every fixture of the set and no other, each by itself beyond reproach; and nothing undecided."""
    truth = json.loads(path.read_text())
    fields = dict(truth["toolkit"])
    assert fields.pop("kind") == Fence.kind
    workpiece = Workpiece.from_loops(truth["workpiece"]["name"], truth["workpiece"]["loops"])
    result = design(workpiece, Fence(**fields))
    assert result.proof is not None and result.proof.undecided == ()
    assert result.counts == truth["counts"]
    assert "0 missing, 0 extra" in checked(result, tmp_path / "result.json", path)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("loop", "fence"),
    [
        (KITE, Fence(pitch=(14, 12), peg_radius=3, wall_offset=7, clamp_radius=4)),
        (NOTCHED, Fence(pitch=(20, 13), peg_radius=2, wall_offset=4, columns=3)),
        (FEET, Fence(pitch=(17, 11), peg_radius=2.5, wall_offset=3, rows=3)),
    ],
    ids=["kite", "notched", "feet"],
)
def test_a_separate_slow_search_finds_the_same(loop: list[tuple[float, ...]], fence: Fence) -> None:
    """Also over arcs, gaps, and with tips of another radius than the locator's."""
    result = design(part(loop), fence)
    assert seen(result) == slow_fence(part(loop), fence)
    assert len(seen(result)) == len(result) > 10


@pytest.mark.thorough
@pytest.mark.thinned(6)
@pytest.mark.parametrize("loop", [KITE, NOTCHED, FEET, L], ids=["kite", "notched", "feet", "l"])
@pytest.mark.parametrize(
    "fields",
    [
        {"pitch": (10, 8), "wall_offset": 5.5, "clamp_radius": 4.0},
        {"pitch": 10, "wall_offset": 3, "columns": 6, "rows": 5, "travel": (4.0, 24.0)},
        {"pitch": (8, 10), "wall_offset": 4, "columns": 4, "travel": (3.0, 40.0), "clamp_radius": 2.0},
    ],
)
def test_every_fixture_stands_before_the_checker_and_reads_back(
    fields: dict[str, Any], loop: list[tuple[float, ...]], tmp_path: Path
) -> None:
    """With and without a body of the clamp, and in the order of JSON and of columns."""
    result = design(part(loop), Fence(peg_radius=3, **fields))
    assert len(result) > 0
    check_and_read_back(result, tmp_path)
    for fixture in list(result)[:20]:
        assert [peg.carrier for peg in fixture.pegs] == [
            "plate",
            "wall",
            "wall",
            f"clamp {fixture.direction}",
        ]


def test_an_equilateral_triangle_is_counted_by_hand() -> None:
    """Pegs without a size in five rows, w = 5, 10 apart, on a triangle of side 60.

    Locator and clamp at heights h and k on the two free sides push with equal forces, whose lines meet
    30 + (h - k) 2 / sqrt 3 mm from the corner: above the side on the wall where |h - k| < 26. Of the 25 pairs of rows
    those 30 and 40 apart do not hold, 6 of them; so 19 for -x and as many for +x, on each of three sides.
    """
    triangle = part([(0, 0, 0), (60, 0, 0), (30, 30 * sqrt(3), 0)])
    fence = Fence(pitch=10, peg_radius=0, wall_offset=5, directions=["-x"])
    assert design(triangle, fence).counts == {"edge": 57}
    both = design(triangle, attrs.evolve(fence, directions=["-x", "+x"]))
    assert both.counts == {"edge": 114} and both.distinct == {"edge": 38}
    # Each direction counts as a search of its own.
    assert both.statistics["hull_edges"] == 6 and both.proof is not None and both.proof.cells == 6
    # Each set has one fixture for each turn of the triangle: one orientation alone has as many as there are sets.
    alone = design(triangle, fence, restrictions=Restrictions(angles=((-1.0, 1.0),)))
    assert alone.counts == {"edge": 19} == alone.distinct


def test_a_rectangle_has_none_and_is_told_why_and_an_l_lies_on_its_slant_alone() -> None:
    """Locator and clamp would have to cover three directions beside the wall's."""
    result = design(part([(0, 0, 0), (100, 0, 0), (100, 60, 0), (0, 60, 0)]), Fence(20, 3, wall_offset=10))
    assert result.counts == {"edge": 0} and result.complete
    assert len(result.notes) == 1 and "three directions beside the fence's" in str(result.notes[0])
    angles = {round(fixture.pose.theta_deg, 6) for fixture in design(part(L), Fence(10, 3, wall_offset=5))}
    (slanted,) = angles
    assert slanted == pytest.approx(360 - np.degrees(np.arctan2(30, -40)))


def test_round_parts_and_fences_out_of_reach_are_told_why() -> None:
    """A disc has no hull edge; over a flat bar no row of holes reaches; both are complete searches."""
    disc = Workpiece.from_loops("disc", [[(0, 0, 1), (40, 0, 1)]])
    result = design(disc, Fence(10, 3, wall_offset=5))
    assert (
        result.counts == {"edge": 0}
        and result.complete
        and "no straight piece of its convex hull" in str(result.notes[0])
    )
    bar = part([(0, 0, 0), (60, 0, 0), (57, 4, 0), (2, 5, 0)])
    upright = Restrictions(angles=((-5.0, 5.0),))
    result = design(bar, Fence(10, 1, wall_offset=8), restrictions=upright)
    assert "No locator in a row of holes" in str(result.notes[0])


@pytest.mark.parametrize("loop", [KITE, FEET], ids=["kite", "feet"])
def test_turning_and_moving_the_part_changes_poses_only_and_its_mirror_image_has_the_mirrored_set(
    loop: list[tuple[float, ...]],
) -> None:
    """Mirrored, a clamp that pushes right pushes left."""
    fence = Fence(pitch=(10, 9), peg_radius=2, wall_offset=4, travel=(2, 30))
    here = design(part(loop), fence)
    c, s = cos(0.7), sin(0.7)
    there = design(part([(c * x - s * y + 300, s * x + c * y - 40, b) for x, y, b in full(loop)]), fence)
    assert seen(here) == seen(there) and len(here) > 20
    back = full(loop)[::-1]
    mirrored = [(-x, y, back[(k + 1) % len(back)][2]) for k, (x, y, _) in enumerate(back)]
    assert faceless(seen(design(part(mirrored), fence), flipped=True)) == faceless(seen(here))


def full(loop: list[tuple[float, ...]]) -> list[tuple[float, float, float]]:
    """Vertices with their bulges."""
    return [(x, y, b) for x, y, b in loop]


@pytest.mark.thorough
def test_half_the_pitch_longer_strokes_more_holes_and_directions_keep_all_fixtures() -> None:
    """A pitch that is divided by two lists all the old fixtures when the first row stays; the others are limits only."""

    def places(fence: Fence) -> set[tuple[Any, ...]]:
        """Fixtures without the numbers of rows and columns."""
        return {
            (way, face, other, *rest) for way, face, other, _, _, *rest in seen(design(part(FEET), fence))
        }

    coarse = Fence(pitch=(16, 12), peg_radius=2, wall_offset=5)
    few = places(coarse)
    assert few < places(attrs.evolve(coarse, pitch=(8, 6)))
    small = attrs.evolve(coarse, pitch=(8, 6), columns=4, rows=4, travel=(4, 9), directions=("-x", "-y"))
    held = places(small)
    assert held
    for change in (
        {"columns": 6},
        {"rows": None},
        {"travel": (4, 16)},
        {"travel": (2, 9)},
        {"directions": None},
    ):
        assert held <= places(attrs.evolve(small, **change))


def test_restrictions_hold_of_wall_locator_and_clamp() -> None:
    """Avoided faces are neither pushed nor laid on the wall; zones keep off pegs and wall; angles choose hull edges."""
    fence = Fence(pitch=8, peg_radius=2, wall_offset=4)
    everything = design(part(KITE), fence)
    lengths = []
    for face in range(4):
        kept = design(part(KITE), fence, restrictions=Restrictions(avoid=(face,)))
        wanted = [f for f in everything if all(face != peg.face for peg in f.pegs)]
        assert len(kept) == len(wanted) < len(everything)
        lengths.append(len(kept))
    assert any(lengths)
    turned = {round(fixture.pose.theta_deg, 3) for fixture in everything}
    assert len(turned) >= 3
    one = min(turned)
    chosen = design(part(KITE), fence, restrictions=Restrictions(angles=((one - 1, one + 1),)))
    assert {round(fixture.pose.theta_deg, 3) for fixture in chosen} == {one}
    # A zone that reaches below the long side leaves no room for a wall there, nor for pegs.
    for y in (-4.0, 6.0):
        kept = design(part(KITE), fence, restrictions=Restrictions(zones=(circle_zone(28.0, y, 5.0),)))
        assert 0 < len(kept) < len(everything)
        assert all(0 not in {peg.face for peg in fixture.pegs if peg.is_on_wall} for fixture in kept)


def test_a_corner_is_avoided_with_both_its_faces_only() -> None:
    """The slant of an L lies on the wall with two corners."""
    fence = Fence(pitch=8, peg_radius=2, wall_offset=4)
    everything = design(part(L), fence)
    (ends,) = {(fixture.pegs[1].touched, fixture.pegs[2].touched) for fixture in everything}
    assert ends == ("1/2", "3/4")
    # Faces 2 and 3 are those of the notch, which lies on the wall's side; the pegs touch others.
    assert len(design(part(L), fence, restrictions=Restrictions(avoid=(2,)))) == len(everything)
    with_both = design(part(L), fence, restrictions=Restrictions(avoid=(1, 2)))
    assert len(with_both) == 0 and with_both.notes


def test_the_contact_margin_is_kept_by_locator_and_clamp() -> None:
    """The wall has none."""
    fence = Fence(pitch=7, peg_radius=2, wall_offset=4)
    everything = design(part(FEET), fence)
    kept = design(part(FEET), fence, contact_margin=4.0)
    assert seen(kept) == {
        key for f, key in zip(everything, map(one_seen, everything), strict=True) if far(f, 4.0)
    }
    assert 0 < len(kept) < len(everything)


def one_seen(fixture: workhold.Fixture) -> tuple[Any, ...]:
    """One fixture as :func:`seen` tells it."""
    (key,) = seen([fixture])  # type: ignore[arg-type]
    return key


def far(fixture: workhold.Fixture, margin: float) -> bool:
    """Whether all contacts of pegs are so far from the ends of their features."""
    return fixture.quality["end_distance"] >= margin


def test_the_best_are_the_first_of_all_and_everything_is_counted() -> None:
    """In the same order, whatever is ranked by."""
    fence = Fence(pitch=7, peg_radius=2, wall_offset=4)
    for ranking in (None, ["closure-margin"], ["location-error"]):
        everything = design(part(KITE), fence, rank_by=ranking)
        best = design(part(KITE), fence, rank_by=ranking, best=7)
        assert best.table == everything.table.take(slice(0, 7))
        assert best.found == everything.found and len(best) == 7


def test_those_equally_good_stand_in_the_order_of_directions() -> None:
    """As those of a part that is its own mirror image do, which the clamp presses from either side."""
    triangle = part([(0, 0, 0), (60, 0, 0), (30, 30 * sqrt(3), 0)])
    result = design(triangle, Fence(pitch=10, peg_radius=0, wall_offset=5, directions=["+x", "-x"]))
    found = make_table_keys(result.table, result.query, find_usual_errors(result.query))
    tied = (np.diff(found.make_order_numbers(found.least_error), axis=0) == 0.0).all(axis=1)
    steps = np.diff(result.table.arrangement.astype(int))[tied]
    assert (steps >= 0).all() and (steps > 0).any()


@pytest.mark.thorough
def test_listing_a_few_at_a_time_lists_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """After every hull edge, of all directions, also of a part that looks alike from three sides, and the best of them."""
    corners = [
        (30 * cos(angle), 30 * sin(angle), bulge)
        for angle, bulge in zip(np.arange(6) * pi / 3, [0.2, 0] * 3, strict=True)
    ]
    for best in (None, 9):
        query = Query(part(corners), Fence(pitch=7, peg_radius=2, wall_offset=4), best=best)
        whole = answer(query)
        with monkeypatch.context() as patched:
            patched.setattr(wall_search, "TOGETHER", 60)
            patched.setattr(results, "WAITING", 0)
            again = answer(query)
        assert again == whole and len(whole) > 8
        assert again.distinct["edge"] == whole.distinct["edge"] == whole.found["edge"] / 3


def test_a_search_that_is_stopped_is_incomplete_and_progress_comes_to_its_end() -> None:
    """What was found before stands."""
    stop, told = Event(), list[float]()
    query = Query(part(KITE), Fence(pitch=7, peg_radius=2, wall_offset=4))
    whole = answer(query, progress=lambda done, found: told.append(done))
    assert told == sorted(told) and told[-1] == pytest.approx(1.0)

    def cancel(done: float, found: int) -> None:
        if found:
            stop.set()

    part_of_it = answer(query, progress=cancel, cancel=stop)
    assert not part_of_it.complete and seen(part_of_it) < seen(whole) and len(part_of_it) > 0


def test_a_clamp_that_pushes_away_from_the_fence_is_bolted_in_no_row_below_the_first(tmp_path: Path) -> None:
    """In the mouth of a saddle; with a stroke longer than there is room some fixtures have no hole."""
    saddle = Workpiece.from_loops("saddle", json.loads(COMPLETE[-1].read_text())["workpiece"]["loops"])
    counts = []
    for travel in ((0.0, 60.0), (20.0, 60.0)):
        result = design(saddle, Fence(pitch=8, peg_radius=2, wall_offset=5, travel=travel, directions=["+y"]))
        checked(result, tmp_path / "up.json")
        assert all(fixture.pegs[3].row >= 0 for fixture in result)
        counts.append(len(result))
    assert counts[0] > counts[1]


def test_every_face_length_and_number_that_cannot_be_is_refused() -> None:
    """In one sentence each."""
    for fields, words in (
        ({"wall_offset": 2}, "would stand in the fence"),
        ({"wall_offset": float("nan")}, "not a positive length"),
        ({"wall_offset": 10, "directions": ["up"]}, "a clamp cannot move in the direction"),
        ({"wall_offset": 10, "travel": (5, 3)}, "is not possible"),
    ):
        with pytest.raises(InputError, match=words):
            Fence(pitch=20, peg_radius=3, **fields)  # type: ignore[arg-type]


def test_contacts_at_tangent_joints_are_listed_once(tmp_path: Path) -> None:
    """A row at the very height of a joint of two faces that meet smoothly: one fixture, on the lower face."""
    # A half circle of radius 20 on two upright sides: the joints are 20 high, where the second row is.
    arch = part([(0, 0, 0), (40, 0, 0), (40, 20, 1), (0, 20, 0)])
    fence = Fence(pitch=10, peg_radius=2, wall_offset=10, directions=["-x", "-y"])
    result = design(arch, fence)
    checked(result, tmp_path / "arch.json")
    places = {(round(f.pose.theta_deg, 3), *one_seen(f)[:1], *one_seen(f)[3:]) for f in result}
    assert len(places) == len(result) > 10
    # At the joint of face 1 with the arc, 20 high, the locator is told to touch the lower of the two.
    at_joint = [f for f in result if f.pose.theta_deg == 0.0 and f.pegs[0].row == 1]
    assert at_joint and {f.pegs[0].face for f in at_joint} <= {1, 2}
    assert result.proof is not None and not result.proof.undecided


@pytest.mark.thorough
def test_where_a_row_grazes_an_arc_balls_tell_the_contact() -> None:
    """A locator at the very top of an arc, pressed by next to nothing: its place and forces are finite, and not refuted."""
    result = design(workhold.load("flange"), Fence(2, 1, wall_offset=5, directions=("-y",)), best=2000)
    assert np.isfinite(result.table.force).all() and np.isfinite(result.table.quality[:, 0]).all()
    last = result[-1]
    assert 1e-6 < last.quality["closure_margin"] < 1e-4 and last.quality["warnings"] > 0
    # Few of the contacts beside arcs are left to balls.
    assert result.proof is not None and result.proof.escalated < 0.04 * result.proof.candidates
    few = attrs.evolve(result, table=result.table.take(np.arange(len(result) - 3, len(result))))
    assert verify(few).refuted == 0
