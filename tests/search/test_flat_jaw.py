"""The vise with one flat jaw: complete sets, a slow search of its own, and what must hold of any search for it."""

from __future__ import annotations

import json
from math import hypot, isclose, pi, tan
from pathlib import Path
from random import Random
from threading import Event
from typing import Any

import numpy as np
import pytest

import workhold
from own_heights import FOOT, STEM, stepped
from strategies import outline
from toolkit_results import NOTCHED, assert_all_proven, check_and_read_back, checked, part, rectangle
from workhold import FlatJaw, InputError, Pose, Restrictions, Result, Workpiece, circle_zone
from workhold.contact.features import list_contact_features
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Line, Segment
from workhold.search.explaining import explain

TRUTHS = sorted((Path(__file__).parent.parent / "data" / "toolkits").glob("flat_*.json"))
KITE = [(0, 0, 0), (56, 6, 0), (48, 44, 0), (10, 37, 0)]
# Two feet, arcs outside and inside, and a hole.
ROCKER = [(0, 0, 0), (14, 0, 0), (20, 8, 0), (40, 8, 0), (46, 0, 0), (60, 0, 0.5), (60, 40, 0.2), (0, 40, 0)]
Identity = tuple[object, ...]


def seen(result: Result, mirrored: bool = False) -> set[Identity]:
    """What tells fixtures apart: the orientation, holes from the first peg's, and places of both pegs along the wall."""
    found = set()
    for fixture in result:
        (left, _), pegs = fixture.pegs[:2], fixture.pegs[2:]
        right = fixture.pegs[1]
        theta = round(fixture.pose.theta_deg % 360.0, 4)
        step = pegs[1].column - pegs[0].column, pegs[1].row - pegs[0].row
        places = [(round(peg.x - left.x, 5) + 0.0, round(peg.y, 5)) for peg in pegs]
        if mirrored:
            theta, step = round(-fixture.pose.theta_deg % 360.0, 4), (step[0], -step[1]) if step[0] else step
            places = [(round(right.x - peg.x, 5) + 0.0, round(peg.y, 5)) for peg in pegs]
            places = places[::-1] if step[0] else places
        found.add((theta, step, *places))
    return found


@pytest.mark.thorough
@pytest.mark.parametrize("path", TRUTHS, ids=lambda path: path.stem)
def test_complete_set_is_reproduced(path: Path, tmp_path: Path) -> None:
    """None missing, none extra, as the independent checker says, and each proven by the verification."""
    truth = json.loads(path.read_text())
    fields = {name: value for name, value in truth["toolkit"].items() if name != "kind"}
    result = workhold.design(Workpiece.from_loops("part", truth["workpiece"]["loops"]), FlatJaw(**fields))
    assert result.counts == truth["counts"] and result.complete
    assert "0 missing, 0 extra" in checked(result, tmp_path / "result.json", path)
    assert_all_proven(result, tmp_path, search_files=True)


def curve_points(
    first: Segment, second: Segment, shift: tuple[float, float], steps: int = 4000
) -> list[list[float]]:
    """Where one curve crosses another moved back by a shift, by signs of the distance to it at many points."""
    s = np.linspace(0.0, 1.0, steps)
    if isinstance(first, Line):
        (ax, ay), (bx, by) = first.start, first.end
        x, y = ax + s * (bx - ax), ay + s * (by - ay)
    else:
        angle = first.mid_angle + (2 * s - 1) * first.half_sweep
        x, y = first.center[0] + first.radius * np.cos(angle), first.center[1] + first.radius * np.sin(angle)
    u, v = x + shift[0], y + shift[1]
    if isinstance(second, Line):
        (ax, ay), (bx, by) = second.start, second.end
        length = hypot(bx - ax, by - ay)
        off = ((bx - ax) * (v - ay) - (by - ay) * (u - ax)) / length
        inside = ((u - ax) * (bx - ax) + (v - ay) * (by - ay)) / length
        within = (inside >= 0) & (inside <= length)
    else:
        off = np.hypot(u - second.center[0], v - second.center[1]) - second.radius
        turn = np.arctan2(v - second.center[1], u - second.center[0]) - second.mid_angle
        within = np.abs((turn + np.pi) % (2 * np.pi) - np.pi) <= second.half_sweep
    crossed = np.flatnonzero((off[1:] * off[:-1] <= 0) & (within[1:] | within[:-1]))
    share = [float(off[k] / (off[k] - off[k + 1])) if off[k] != off[k + 1] else 0.5 for k in crossed]
    return [
        [float(x[k] + w * (x[k + 1] - x[k])), float(y[k] + w * (y[k + 1] - y[k]))]
        for k, w in zip(crossed, share, strict=True)
    ]


def normal_at(face: Segment, x: float, y: float) -> tuple[float, float]:
    """The outward normal of an offset curve at a point on it."""
    if isinstance(face, Arc):
        size = hypot(x - face.center[0], y - face.center[1])
        return face.sign * (x - face.center[0]) / size, face.sign * (y - face.center[1]) / size
    (ax, ay), (bx, by) = face.start, face.end
    length = hypot(bx - ax, by - ay)
    return (by - ay) / length, -(bx - ax) / length


def slow_search(
    workpiece: Workpiece, vise: FlatJaw, reach: int, met_by_pegs: Workpiece | None = None
) -> list[tuple[float, int, int, float, float]]:
    """Orientation, step and place of the first peg of every fixture, by sampled curves and a linear solver.

    Parameters
    ----------
    workpiece : what lies against the jaw.
    met_by_pegs : what pegs touch; the same if None.
    """
    found = []
    met = workpiece if met_by_pegs is None else met_by_pegs
    features = [one.segment for one in list_contact_features(met, vise.peg_radius, vise.flat)]
    for theta, ends in zip(workpiece.flush.theta, workpiece.flush.ends, strict=True):
        pose = Pose(float(np.degrees(theta)), 0.0, 0.0)
        low = pose.apply(*ends[0])
        pose = Pose(pose.theta_deg, -low[0], -low[1])
        length = hypot(*(ends[1] - ends[0]))
        laid = [pose.carry(one) for one in features]
        for i in range(reach):
            for j in range(-reach + 1, reach):
                if (i, j) <= (0, 0):
                    continue
                shift = i * vise.pitch[0], j * vise.pitch[1]
                for first in laid:
                    for second in laid:
                        for x, y in curve_points(first, second, shift):
                            u, v = x + shift[0], y + shift[1]
                            a, b = normal_at(first, x, y), normal_at(second, u, v)
                            wrenches = np.array(
                                [
                                    [0.0, 0.0, a[0], b[0]],
                                    [-1.0, -1.0, a[1], b[1]],
                                    [0.0, -length, x * a[1] - y * a[0], u * b[1] - v * b[0]],
                                ]
                            )
                            *_, null = np.linalg.svd(wrenches)[2]
                            null = null / null.sum() if null.sum() else null
                            if null.min() > 1e-4 and min(y, v) >= vise.min_gap + 1e-4:
                                found.append(
                                    (round(pose.theta_deg % 360.0, 3), i, j, round(x, 2), round(y, 2))
                                )
    return found


def places(result: Result) -> list[tuple[float, int, int, float, float]]:
    """The same of a search's fixtures whose closure margin is not tiny."""
    found = []
    for fixture in result:
        left, one, other = fixture.pegs[0], *fixture.pegs[2:]
        if fixture.quality["closure_margin"] > 1e-4:
            step = other.column - one.column, other.row - one.row
            found.append((round(fixture.pose.theta_deg % 360.0, 3), *step, one.x - left.x, one.y))
    return found


@pytest.mark.thorough
@pytest.mark.parametrize("loop", [KITE, ROCKER, NOTCHED], ids=["kite", "rocker", "notched"])
def test_a_slow_search_of_sampled_curves_finds_the_same(loop: list[tuple[float, ...]]) -> None:
    """Apart from pairs at the very ends of curves, which sampling may see or not."""
    vise = FlatJaw(pitch=(13, 11), peg_radius=2.5)
    workpiece = part(loop)
    assert_alike(slow_search(workpiece, vise, 6), places(workhold.design(workpiece, vise)))


@pytest.mark.thorough
def test_a_lower_jaw_meets_its_own_outline() -> None:
    """The part lies flush with one outline, and pegs touch another, as the slow search says."""
    vise = FlatJaw(pitch=(13, 11), peg_radius=2.5, wall_heights=(0, 4), jaw_heights=(10, 18))
    workpiece = stepped({"wall": ((0.0, 4.0), FOOT), "jaw": ((10.0, 18.0), STEM)})
    wall, pegs = (workpiece.find_outline(role)[0] for role in ("wall", "jaw"))
    assert_alike(slow_search(wall, vise, 6, pegs), places(workhold.design(workpiece, vise)))


def assert_alike(
    slow: list[tuple[float, int, int, float, float]], fast: list[tuple[float, int, int, float, float]]
) -> None:
    """Fixtures of the slow search and of the program are the same, but for a few at the ends of curves."""
    near = [f for f in fast if f[1] < 6 and abs(f[2]) < 6]

    def has(
        known: list[tuple[float, int, int, float, float]], one: tuple[float, int, int, float, float]
    ) -> bool:
        return any(o[:3] == one[:3] and hypot(o[3] - one[3], o[4] - one[4]) < 0.05 for o in known)

    assert len(near) > 10
    assert [one for one in near if not has(slow, one)] == []
    lost = [one for one in slow if not has(near, one)]
    assert len(lost) <= len(near) // 10, lost


@pytest.mark.thorough
@pytest.mark.parametrize("limited", [True, pytest.param(False, marks=pytest.mark.prove)])
def test_planted_fixtures_are_found(limited: bool) -> None:
    """Two points of offset curves on a hull edge, with a pitch that makes their difference a step of the lattice.

    A fine pitch on a jaw without limits has very many fixtures beside the planted one: the usual run limits the jaw to
    the holes that the planted one needs.
    """
    random, planted = Random(5), 0
    while planted < 25:
        workpiece = outline(random, random.randint(4, 7), curved=True, pierced=False)
        if workpiece is None or not len(workpiece.flush.theta):
            continue
        radius = random.choice([0.5, 1.0, 2.0])
        try:
            features = [one.segment for one in list_contact_features(workpiece, radius, None)]
        except InputError:
            continue
        edge = random.randrange(len(workpiece.flush.theta))
        theta, ends = workpiece.flush.theta[edge], workpiece.flush.ends[edge]
        pose = Pose(float(np.degrees(theta)), 0.0, 0.0)
        low = pose.apply(*ends[0])
        pose, length = Pose(pose.theta_deg, -low[0], -low[1]), hypot(*(ends[1] - ends[0]))
        two = []
        for face in random.choices([pose.carry(one) for one in features], k=2):
            share = random.uniform(0.05, 0.95)
            if isinstance(face, Line):
                (ax, ay), (bx, by) = face.start, face.end
                x, y = ax + share * (bx - ax), ay + share * (by - ay)
            else:
                angle = face.mid_angle + (2 * share - 1) * face.half_sweep
                x, y = (
                    face.center[0] + face.radius * np.cos(angle),
                    face.center[1] + face.radius * np.sin(angle),
                )
            two.append((float(x), float(y), *normal_at(face, float(x), float(y))))
        (x, y, ax, ay), (u, v, bx, by) = sorted(two)
        wrenches = [
            [0.0, 0.0, ax, bx],
            [-1.0, -1.0, ay, by],
            [0.0, -length, x * ay - y * ax, u * by - v * bx],
        ]
        null = np.linalg.svd(np.array(wrenches))[2][-1]
        null = null * np.sign(null.sum())
        if null.min() < 1e-3 or u - x < 4 * radius or abs(v - y) < 4 * radius or min(y, v) < radius + 0.1:
            continue
        columns, rows = random.randint(1, 2), random.randint(1, 2)
        pitch = (u - x) / columns, abs(v - y) / rows
        if min(pitch) < 2 * radius:
            continue
        size: dict[str, Any] = {"columns": columns + 1, "rows": rows + 1} if limited else {}
        result = workhold.design(workpiece, FlatJaw(pitch=pitch, peg_radius=radius, **size))
        step = columns, rows if v > y else -rows
        assert any(
            one[1:3] == step and isclose(one[3], x, abs_tol=1e-4) and isclose(one[4], y, abs_tol=1e-4)
            for one in places(result)
        )
        planted += 1


@pytest.mark.parametrize("loop", [KITE, ROCKER], ids=["kite", "rocker"])
def test_the_mirrored_part_has_the_mirrored_set_and_turning_changes_poses_only(
    loop: list[tuple[float, ...]],
) -> None:
    """Up to the angles, which turn with the part."""
    vise = FlatJaw(pitch=(9, 7), peg_radius=2)
    result = workhold.design(part(loop), vise)
    bulged = [(*one, 0.0)[:3] for one in loop]
    bulges = [bulge for *_, bulge in bulged]
    flipped = [(-x, y, bulges[k - 1]) for k, (x, y, _) in reversed(list(enumerate(bulged)))]
    assert seen(workhold.design(part(flipped), vise)) == seen(result, mirrored=True)
    turn = Pose(37.0, 12.0, -5.0)
    moved = [(*map(float, turn.apply(x, y)), bulge) for x, y, bulge in bulged]
    again = workhold.design(part(moved), vise)

    def turned(found: set[Identity], angle: float) -> set[Identity]:
        return {(round((one[0] + angle) % 360.0, 3), *one[1:2]) for one in found}  # type: ignore[operator]

    # What is seen turns back with the part.
    assert turned(seen(again), 37.0) == turned(seen(result), 0.0)
    assert again.counts == result.counts


def test_finer_lattices_lose_none_and_greater_gaps_add_none() -> None:
    """Half the pitch with twice the columns and rows less one; forces up and down balance."""
    coarse = FlatJaw(pitch=12, peg_radius=2, columns=3, rows=3)
    fine = FlatJaw(pitch=6, peg_radius=2, columns=5, rows=5)
    few, many = (workhold.design(part(ROCKER), vise) for vise in (coarse, fine))
    doubled = {(one[0], (2 * one[1][0], 2 * one[1][1]), *one[2:]) for one in seen(few)}  # type: ignore[index]
    assert len(doubled) > 5 and doubled <= seen(many)
    for fixture in many:
        wall, pegs = fixture.pegs[:2], fixture.pegs[2:]
        assert (
            sum(peg.force for peg in wall) == pytest.approx(1.0, abs=1e-9)
            and min(peg.force for peg in pegs) > 0
        )
    before = seen(many)
    for gap in (3, 9, 15, 27):
        now = seen(
            workhold.design(part(ROCKER), FlatJaw(pitch=6, peg_radius=2, columns=5, rows=5, min_gap=gap))
        )
        assert now <= before
        before = now


def test_pegs_move_back_where_the_jaw_opens_no_wider() -> None:
    """By as few rows as needed; without rows enough there is no such fixture."""
    free = workhold.design(part(KITE), FlatJaw(pitch=10, peg_radius=3))
    tight = workhold.design(part(KITE), FlatJaw(pitch=10, peg_radius=3, max_opening=30))
    assert seen(free) == seen(tight)
    for fixture in tight:
        least = min(peg.row for peg in fixture.pegs[2:])
        assert 3 <= fixture.travel <= 30 + 1e-9
        assert least == 0 or fixture.travel + 10 > 30
    few = workhold.design(part(KITE), FlatJaw(pitch=10, peg_radius=3, max_opening=30, rows=3))
    assert 0 < len(few) < len(tight)
    assert all(max(peg.row for peg in fixture.pegs) <= 2 for fixture in few)
    narrow = workhold.design(part(KITE), FlatJaw(pitch=10, peg_radius=3, columns=2))
    assert seen(narrow) == {one for one in seen(free) if one[1][0] < 2}  # type: ignore[index]


def test_a_rectangle_has_none_and_it_is_said_what_helps() -> None:
    """Two pegs leave a rectangle free to slide; a disc cannot lie flush."""
    result = workhold.design(rectangle(60, 40), FlatJaw(pitch=10, peg_radius=3))
    assert result.counts == {"flat": 0} and result.complete
    assert "a fence with two clamps holds such a part" in str(result.notes[0])
    explained = explain(result.query)
    assert explained.contacts == 0 and explained.nearest is None
    disc = workhold.design(part([(0, 0, 1), (40, 0, 1)]), FlatJaw(pitch=10, peg_radius=3))
    assert "cannot lie flush against the flat jaw" in str(disc.notes[0])


def test_an_explanation_counts_what_each_rule_takes_away() -> None:
    """Down to nothing where angles are left that no hull edge has."""
    query = workhold.Query(
        part(KITE),
        FlatJaw(pitch=10, peg_radius=3, max_opening=12, rows=1),
        restrictions=Restrictions(avoid=(1, 3)),
    )
    assert len(workhold.answer(query)) == 0
    explained = explain(query)
    assert explained.contacts > 0 and explained.removals[-1].after == 0
    assert any(removal.rule == "faces to avoid" for removal in explained.removals)
    assert any("touching face" in one.change for one in explained.helps)


def test_restrictions_and_margins_hold() -> None:
    """Avoided faces are not touched, no peg stands in a zone, contacts keep their margin, angles are those asked for."""
    vise, workpiece = FlatJaw(pitch=8, peg_radius=2), part(ROCKER)
    everything = workhold.design(workpiece, vise)
    shunned = workhold.design(workpiece, vise, restrictions=Restrictions(avoid=(5,)))
    assert seen(shunned) == seen_where(everything, lambda fixture: all(peg.face != 5 for peg in fixture.pegs))
    kept = workhold.design(workpiece, vise, contact_margin=4.0)
    assert 0 < len(kept) < len(everything) and all(one.quality["end_distance"] >= 4.0 - 1e-6 for one in kept)
    level = workhold.design(workpiece, vise, restrictions=Restrictions(angles=((-5.0, 5.0),)))
    assert seen(level) == seen_where(
        everything, lambda fixture: abs((fixture.pose.theta_deg + 180) % 360 - 180) <= 5
    )
    zone = circle_zone(70, 20, 8)
    clear = workhold.design(workpiece, vise, restrictions=Restrictions(zones=(zone,)))
    assert 0 < len(clear) < len(everything) and seen(clear) < seen(everything)


def seen_where(result: Result, keeps: object) -> set[Identity]:
    """What tells those fixtures apart that a rule keeps."""
    rows = [k for k, fixture in enumerate(result) if keeps(fixture)]  # type: ignore[operator]
    every = [next(iter(seen(result.slice_rows(slice(k, k + 1))))) for k in rows]
    return set(every)


@pytest.mark.thorough
def test_files_say_the_same_again(tmp_path: Path) -> None:
    """In JSON and in columns, with limits; with flats, of which the checker knows nothing, all are proven."""
    limited = FlatJaw(pitch=10, peg_radius=3, columns=6, rows=5, max_opening=60)
    check_and_read_back(workhold.design(part(KITE), limited), tmp_path)
    assert_all_proven(workhold.design(part(KITE), limited), tmp_path)
    flatted = workhold.design(part(KITE), FlatJaw(pitch=10, peg_radius=3, flat=2.5))
    assert len(flatted) > 0 and all(peg.flat_deg is not None for peg in flatted[0].pegs[2:])
    assert_all_proven(flatted, tmp_path)


def test_the_best_are_the_first_of_all_and_cancelling_leaves_a_part() -> None:
    """Also where nothing was looked at."""
    vise = FlatJaw(pitch=5, peg_radius=2)
    everything = workhold.design(part(ROCKER), vise)
    best = workhold.design(part(ROCKER), vise, best=7)
    assert list(seen(best)) and [f.pegs for f in best] == [f.pegs for f in list(everything)[:7]]
    assert best.found == everything.found
    stopped = Event()
    told: list[float] = []

    def cancel(done: float, found: int) -> None:
        told.append(done)
        stopped.set()

    result = workhold.design(part(ROCKER), vise, progress=cancel, cancel=stopped)
    assert not result.complete and len(result) < len(everything) and told == sorted(told)
    assert seen(result) <= seen(everything)


def test_seating_is_refused_in_a_sentence() -> None:
    """No peg stands still for the part to be pushed against."""
    with pytest.raises(InputError, match="the flat jaw stands still, and both pegs move"):
        workhold.design(part(KITE), FlatJaw(pitch=10, peg_radius=3), seating=3)


@pytest.mark.parametrize("name", FlatJaw.presets())
def test_presets_are_vises_that_hold_something(name: str) -> None:
    """A wedge of the size that such a vise holds."""
    vise: Toolkit = FlatJaw.preset(name)
    result = workhold.design(part([(0, 0, 0), (80, 0, 0), (80, 20, 0), (0, 50, 0)]), vise)
    assert len(result) > 0 and workhold.verify(result).holds


def test_a_contact_at_a_tangent_joint_is_listed_once() -> None:
    """The pitch puts a peg exactly where a slope runs into a fillet, which is on both faces."""
    # A slope at 45 degrees that a fillet of radius 10 ends, and a slope on the other side.
    joint, bulge = (30.0 + 10.0 * 0.5**0.5, 30.0 - 10.0 * (1 - 0.5**0.5)), -tan(pi / 16)
    loop = [
        (0, 0, 0),
        (60, 0, 0),
        (joint[0] + 12.0, joint[1] - 12.0, 0),
        (*joint, -bulge),
        (30, 30, 0),
        (20, 30, 0),
    ]
    workpiece = part([(float(x), float(y), float(b)) for x, y, b in loop])
    radius = 2.0
    first = joint[0] + radius * 0.5**0.5, joint[1] + radius * 0.5**0.5
    # The other side runs from (20, 30) to (0, 0); a peg that touches its middle.
    size = hypot(20.0, 30.0)
    other = 10.0 - radius * 30.0 / size, 15.0 + radius * 20.0 / size
    pitch = first[0] - other[0], abs(first[1] - other[1])
    result = workhold.design(workpiece, FlatJaw(pitch=pitch, peg_radius=radius, columns=2, rows=2))
    here = [one for one in places(result) if isclose(one[4], other[1], abs_tol=1e-5) and one[1] == 1]
    assert len(here) == len({one[2:] for one in here}) == 1


def test_it_is_said_where_only_the_vise_is_in_the_way() -> None:
    """Pairs press the part, but the jaw has no rows for them at that opening."""
    vise = FlatJaw(pitch=10, peg_radius=3, rows=1, max_opening=5)
    result = workhold.design(part(KITE), vise)
    assert result.counts == {"flat": 0} and result.complete
    assert "pairs of pegs would hold the part, but none of them can stand in the jaw as asked" in str(
        result.notes[0]
    )
