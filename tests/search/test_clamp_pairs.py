"""Two clamps on a plate: complete sets, counts by hand, and the theorems that hold of them."""

from __future__ import annotations

import json
from contextlib import nullcontext
from itertools import combinations, product
from math import atan, atan2, comb, cos, degrees, hypot, inf, pi, sin, tau
from pathlib import Path
from random import Random
from typing import Any

import attrs
import numpy as np
import pytest
from test_plate import plate_of

import workhold
from toolkit_results import MOUTH, NOTCHED, check_and_read_back, checked, part, rectangle
from workhold import InputError, Plate, Query, Restrictions, Result, Workpiece, answer, design
from workhold.kernels.contact import clamp_pairs
from workhold.model.clamps import compute_force_ratios, compute_working_forces
from workhold.search import lattice_shares
from workhold.statics.quality import measure_quality

COMPLETE = sorted((Path(__file__).parent.parent / "data" / "toolkits").glob("clamp2_*.json"))
WAYS = {"-x": (-1.0, 0.0), "+x": (1.0, 0.0), "-y": (0.0, -1.0), "+y": (0.0, 1.0)}
HALF_TURN = {"-x": "+x", "+x": "-x", "-y": "+y", "+y": "-y"}


# It has thousands of pairs; in every run hundreds are counted by hand, and by a slow enumeration below.
@pytest.mark.prove
@pytest.mark.parametrize("path", COMPLETE, ids=lambda path: path.stem)
def test_complete_set_is_reproduced(path: Path, tmp_path: Path) -> None:
    """Every fixture of the set and no other, each by itself beyond reproach; and nothing undecided."""
    truth = json.loads(path.read_text())
    workpiece = Workpiece.from_loops(truth["workpiece"]["name"], truth["workpiece"]["loops"])
    result = design(workpiece, plate_of(truth), listing=truth["listing"])
    assert result.proof is not None and result.proof.undecided == ()
    assert (result.counts, result.pairs, result.seats) == (truth["counts"], truth["pairs"], truth["seats"])
    assert ": 0 missing, 0 extra" in checked(result, tmp_path / "result.json", path)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("listing", ["best", "all"])
@pytest.mark.parametrize(
    ("loop", "fields"),
    [
        (NOTCHED, {"pitch": (20, 16), "columns": 5, "rows": 4, "clamp_radius": 5.0}),
        (NOTCHED, {"pitch": 20, "columns": 4, "rows": 4, "directions": ["-x", "+y"], "travel": (4.0, 30.0)}),
        (
            MOUTH,
            {"pitch": 24, "columns": 3, "rows": 4, "directions": [("-x", "+x"), ("-y", "-y"), ("+y", "-x")]},
        ),
    ],
)
def test_every_fixture_stands_before_the_checker_and_reads_back(
    loop: list[tuple[float, ...]], fields: dict[str, Any], listing: str, tmp_path: Path
) -> None:
    """Also with clamps of another radius than the locators; and the file says the same in JSON and in columns."""
    result = design(part(loop), Plate(peg_radius=3, clamps=2, **fields), listing=listing)
    assert len(result) > 3
    check_and_read_back(result, tmp_path)
    again = workhold.open(tmp_path / "result.json")
    figures = measure_quality(again.table, again.workpiece, again.toolkit)
    # What is derived from the rounded places of a file agrees with what the search told.
    assert np.nanmax(np.abs(figures[:, :4] - result.table.quality[:, :4])) < 1e-6


def counted(n: int) -> int:
    """Q of the manual: the sum of squares of the numbers below n."""
    return (n - 1) * n * (2 * n - 1) // 6


@pytest.mark.thorough
@pytest.mark.parametrize(("size", "pitch"), [((100.0, 60.0), (20, 20)), ((57.0, 45.0), (16, 14))])
def test_a_square_rectangle_is_counted_by_hand(size: tuple[float, float], pitch: tuple[float, float]) -> None:
    """Two locators below, one beside, clamps opposite, and every other way; without limits of the plate."""
    result = design(rectangle(*size), Plate(pitch, 3, clamps=2, directions=[("-x", "-y")]), listing="all")
    square = [f for f in result if abs((f.pose.theta_deg + 45) % 90 - 45) < 1e-9]
    expected_pairs = expected_seats = 0
    for width, height in (size, size[::-1]):
        n, m = holes_below(width, pitch[0]), holes_below(height, pitch[1])
        # Each of the two orientations with these sides along x and y.
        expected_seats += 2 * (comb(n, 2) * m + n * comb(m, 2))
        pairs = comb(m, 2) * 2 * counted(n) + m * comb(n, 3) + comb(n, 2) * 2 * counted(m) + n * comb(m, 3)
        expected_pairs += 2 * pairs
    seats = {(round(fixture.pose.theta_deg) % 360, seat_of(fixture)) for fixture in square}
    assert (len(square), len(seats)) == (expected_pairs, expected_seats)
    assert all(f.quality["closure_margin"] <= 1 / 5 for f in result)
    # Where no locator is lifted by either clamp, any two forces do.
    for fixture in square:
        assert fixture.pair is not None
        lifted = any(force < -1e-9 for pair in fixture.pair.reactions for force in pair)
        assert (fixture.quality["clamp_freedom"] == pytest.approx(90)) == (not lifted)


def holes_below(side: float, pitch: float) -> int:
    """How many lines of holes can pass a side of a square rectangle clear of its corners, whatever its place."""
    return sum(3 < k * pitch < side + 3 for k in range(99))


def seat_of(fixture: workhold.Fixture) -> tuple[Any, ...]:
    """What tells seats of one orientation apart."""
    column, row = (min(getattr(peg, name) for peg in fixture.pegs[:3]) for name in ("column", "row"))
    return tuple(sorted((peg.column - column, peg.row - row, peg.face) for peg in fixture.pegs[:3]))


def in_part(result: Result, mirrored: bool = False) -> set[tuple[Any, ...]]:
    """Fixtures as seen from the part: places of the locators, and of each tip with the way it pushes, to 0.001 mm."""
    seen = set()
    for fixture in result:
        back, flip = fixture.pose.inverse, -1 if mirrored else 1
        locators = [back.apply(peg.x, peg.y) for peg in fixture.pegs[:3]]
        clamps = []
        for peg in fixture.pegs[3:]:
            push = back.turn(*WAYS[peg.carrier.removeprefix("clamp ")])
            clamps.append((*back.apply(peg.x, peg.y), *push))
        rounded = [
            sorted(
                tuple(round(flip * v if k % 2 == 0 else v, 3) + 0.0 for k, v in enumerate(one))
                for one in many
            )
            for many in (locators, clamps)
        ]
        seen.add((tuple(rounded[0]), tuple(rounded[1])))
    return seen


@pytest.mark.thorough
def test_moving_and_turning_the_part_and_mirroring_it() -> None:
    """Poses change only; the mirror image has the mirrored set, with the other of the two usual pairs of directions."""
    plate = Plate(20, 3, clamps=2, columns=4, rows=4)
    one = design(part(NOTCHED), plate, listing="all")
    angle = 0.3
    turned = [
        (cos(angle) * x - sin(angle) * y + 7, sin(angle) * x + cos(angle) * y - 4, b) for x, y, b in NOTCHED
    ]
    other = design(part(turned), plate, listing="all")
    assert len(one) == len(other) > 100
    key = sorted(tuple(sorted((p.face, p.column, p.row) for p in f.pegs)) for f in one)
    assert key == sorted(tuple(sorted((p.face, p.column, p.row) for p in f.pegs)) for f in other)
    mirrored = [(-x, y, b) for x, y, b in [NOTCHED[0], *NOTCHED[:0:-1]]]
    # A bulge belongs to the edge that begins at its vertex.
    loop = [(-x, y, NOTCHED[k - 1][2]) for k, (x, y, _) in list(enumerate(NOTCHED))[::-1]]
    assert len(mirrored) == len(loop)
    swapped = design(part(loop), attrs.evolve(plate, directions=[("-x", "+y")]), listing="all")
    assert in_part(swapped, mirrored=True) == in_part(one)


@pytest.mark.thorough
def test_a_quarter_turn_swaps_pitch_limits_and_the_usual_pairs() -> None:
    """["-x", "-y"] on one pitch is ["-x", "+y"] on the other, with columns and rows swapped."""
    upright = Plate((14, 20), 3, columns=5, rows=4, clamps=2, directions=[("-x", "-y")], travel=(3, 40))
    lying = Plate((20, 14), 3, columns=4, rows=5, clamps=2, directions=[("-x", "+y")], travel=(3, 40))
    one, other = (design(part(NOTCHED), plate, listing="all") for plate in (upright, lying))
    assert in_part(one) == in_part(other) and len(one) > 10


@pytest.mark.thorough
@pytest.mark.parametrize("pair", [("-x", "-y"), ("-x", "+x"), ("-y", "-y")])
def test_half_a_turn_of_the_plate_lists_nothing_twice(pair: tuple[str, str]) -> None:
    """A pair of directions and what half a turn makes of it are the same fixtures; naming both is naming one."""
    turned = tuple(HALF_TURN[name] for name in pair)
    plates = [
        Plate(20, 3, columns=4, rows=4, clamps=2, directions=asked)
        for asked in ([pair], [turned], [pair, turned])
    ]
    one, other, both = (design(part(NOTCHED), plate, listing="all") for plate in plates)
    assert in_part(one) == in_part(other) == in_part(both)
    assert len(one) == len(in_part(one)) == len(both)


@pytest.mark.thorough
def test_the_best_of_each_seat_is_the_best_of_all() -> None:
    """By clamp freedom, then closure margin, then order; and the numbers of pairs add up."""
    plate = Plate(16, 3, columns=4, rows=4, clamps=2, directions=["-x", "-y"])
    best, every = (design(part(NOTCHED), plate, listing=listing) for listing in ("best", "all"))
    assert best.pairs == every.pairs == len(every) and best.seats == len(best)
    groups: dict[Any, list[workhold.Fixture]] = {}
    for fixture in every:
        groups.setdefault(seat_key(fixture), []).append(fixture)
    assert len(groups) == len(best)
    for fixture in best:
        group = groups[seat_key(fixture)]
        assert fixture.pair is not None and fixture.pair.count == len(group)
        freest = max(one.quality["clamp_freedom"] for one in group)
        margins = [
            one.quality["closure_margin"] for one in group if one.quality["clamp_freedom"] > freest - 1e-4
        ]
        assert fixture.quality["clamp_freedom"] > freest - 1e-4
        assert fixture.quality["closure_margin"] == pytest.approx(max(margins), abs=2e-9)


def degrees_between(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The clamp freedom of intervals of ratios."""
    return np.degrees(np.arctan(high) - np.arctan(low))


def seat_key(fixture: workhold.Fixture) -> tuple[Any, ...]:
    """What tells seats and pairs of directions apart."""
    first, pose = fixture.pegs[0], fixture.pose
    place = round(first.x - pose.x, 4), round(first.y - pose.y, 4)
    return fixture.direction, round(pose.theta_deg, 5), place, seat_of(fixture)


@pytest.mark.thorough
def test_larger_plates_longer_strokes_and_more_directions_hold_all_that_smaller_ones_hold() -> None:
    """A superset each time."""
    small = Plate(16, 3, columns=4, rows=4, clamps=2, directions=[("-x", "-y")], travel=(4, 22))
    base = in_part(design(part(NOTCHED), small, listing="all"))
    assert base
    for change in (
        {"columns": 5, "rows": 5},
        {"travel": (2, 40)},
        {"directions": [("-x", "-y"), ("-x", "+x")]},
    ):
        assert base <= in_part(design(part(NOTCHED), attrs.evolve(small, **change), listing="all"))


def test_a_part_of_arcs_about_one_centre_is_held_by_nothing() -> None:
    """Every force passes through one point; and one sentence says what there is."""
    disc = [(-20, 0, 1), (20, 0, 1)]
    result = design(part(disc), Plate(15, 3, clamps=2, columns=4, rows=4))
    assert len(result) == 0 and result.complete and len(result.notes) == 1


def test_forces_at_the_ends_of_the_ratio_have_a_zero_and_none_between() -> None:
    """The open interval in which all locators are pressed."""
    result = design(part(NOTCHED), Plate((20, 16), 3, columns=4, rows=4, clamps=2), listing="all")
    assert len(result) > 100
    low, high = compute_force_ratios(result.table.force)
    locators = result.table.force[:, :3]
    for ratio in (low, np.where(np.isinf(high), 1e15, high)):
        at_end = locators[..., 0] / (1 + ratio[:, None]) + locators[..., 1] * (ratio / (1 + ratio))[:, None]
        assert np.abs(at_end).min(axis=1).max() < 1e-9 and at_end.min() > -1e-9
    assert compute_working_forces(result.table.force).min() > 0
    assert (degrees_between(low, high) > 0).all()


@pytest.mark.thorough
def test_no_clamp_of_a_pair_holds_alone() -> None:
    """A pair that closes is a fixture with two clamps, or one of its clamps makes one by itself, never both."""
    workpiece, fields = part(NOTCHED), {"columns": 4, "rows": 4, "directions": ["-x", "-y"]}
    single = design(workpiece, Plate((20, 16), 3, **fields))
    alone = {(key[0], clamp) for key in in_part_single(single) for clamp in [key[1]]}
    pairs = in_part(design(workpiece, Plate((20, 16), 3, clamps=2, **fields), listing="all"))
    assert pairs and alone
    assert not any((locators, clamp) in alone for locators, clamps in pairs for clamp in clamps)


def in_part_single(result: Result) -> set[tuple[Any, Any]]:
    """As :func:`in_part` of fixtures with one clamp."""
    seen = set()
    for fixture in result:
        back = fixture.pose.inverse
        locators = sorted(
            tuple(round(v, 3) + 0.0 for v in back.apply(peg.x, peg.y)) for peg in fixture.pegs[:3]
        )
        tip, push = fixture.pegs[3], back.turn(*WAYS[fixture.direction or ""])
        clamp = tuple(round(v, 3) + 0.0 for v in (*back.apply(tip.x, tip.y), *push))
        seen.add((tuple(locators), clamp))
    return seen


def convex(random: Random) -> list[tuple[float, float, float]]:
    """A convex polygon of four to six corners, about 40 mm wide."""
    count = random.randint(4, 6)
    angles = sorted((k + random.uniform(0.15, 0.85)) * tau / count for k in range(count))
    return [(random.uniform(18, 26) * cos(a), 20 * sin(a), 0.0) for a in angles]


def enumerated(loop: list[tuple[float, float, float]], plate: Plate) -> dict[tuple[str, str], int]:
    """Pairs of clamps by pair of directions, counted slowly: every three holes on every three sides, the pose in
    closed form, every clamp on every line, and closure by trying ratios of the forces."""
    corners = np.array(loop)[:, :2]
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(*sides.T)
    along = sides / lengths[:, None]
    normals = np.stack([along[:, 1], -along[:, 0]], axis=1)
    far = (normals * corners).sum(axis=1)
    center = (corners.min(axis=0) + corners.max(axis=0)) / 2
    assert plate.columns is not None and plate.rows is not None
    holes = [(i, j) for i in range(plate.columns) for j in range(plate.rows)]
    counts = dict.fromkeys(plate.directions, 0)
    for triple in combinations(holes, 3):
        if min(i for i, _ in triple) or min(j for _, j in triple):
            continue
        pegs = np.array(triple) * plate.pitch
        for chosen in product(range(len(loop)), repeat=3):
            for angle, shift in poses(pegs, normals[list(chosen)], far[list(chosen)] + plate.peg_radius):
                turn = np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
                inside = (pegs - shift) @ turn
                if all(
                    touches(place, side, corners, along, lengths, normals, far, plate.peg_radius)
                    for place, side in zip(inside, chosen, strict=True)
                ):
                    seat = wrenches(inside, normals[list(chosen)], center)
                    if abs(np.linalg.det(seat)) > 1e-4:
                        clamps = clamps_at(
                            pegs, turn, shift, plate, (corners, along, lengths, normals, far, center)
                        )
                        add_pairs(counts, triple, seat, clamps, plate)
    return counts


def poses(pegs: np.ndarray, normals: np.ndarray, far: np.ndarray) -> list[tuple[float, np.ndarray]]:
    """Angles and shifts at which three holes are on three lines of a part."""
    x, y = normals.T
    weights = np.roll(x, -1) * np.roll(y, -2) - np.roll(y, -1) * np.roll(x, -2)
    if np.abs(weights).max() < 1e-9:
        return []
    # R'(p - s) . n = far for each; weighted, s drops out: a cos + b sin = c.
    a = float((weights * (normals * pegs).sum(axis=1)).sum())
    b = float((weights * (normals[:, 0] * pegs[:, 1] - normals[:, 1] * pegs[:, 0])).sum())
    c, size = float(weights @ far), hypot(a, b)
    if size <= abs(c) * (1 + 1e-12):
        return []
    out = []
    for sign in (1, -1):
        angle = atan2(b, a) + sign * float(np.arccos(c / size))
        turn = np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
        shift, *_ = np.linalg.lstsq(normals @ turn.T, ((pegs @ turn) * normals).sum(axis=1) - far, rcond=None)
        if np.abs(((pegs - shift) @ turn * normals).sum(axis=1) - far).max() < 1e-7:
            out.append((angle, shift))
    return out


def touches(
    place: np.ndarray,
    side: int,
    corners: np.ndarray,
    along: np.ndarray,
    lengths: np.ndarray,
    normals: np.ndarray,
    far: np.ndarray,
    radius: float,
) -> bool:
    """Whether a peg at a place touches a side of a convex polygon inside its ends."""
    at = float((place - corners[side]) @ along[side])
    return bool(abs(normals[side] @ place - far[side] - radius) < 1e-7 and 1e-9 < at < lengths[side] - 1e-9)


def wrenches(places: np.ndarray, normals: np.ndarray, center: np.ndarray) -> np.ndarray:
    """Wrenches of contacts, moments over 30 mm."""
    arms = places - center
    return np.column_stack([normals, (arms[:, 0] * normals[:, 1] - arms[:, 1] * normals[:, 0]) / 30])


def clamps_at(
    pegs: np.ndarray, turn: np.ndarray, shift: np.ndarray, plate: Plate, polygon: tuple[np.ndarray, ...]
) -> list[tuple[str, int, np.ndarray, np.ndarray, float]]:
    """Direction, line, tip, wrench and push of every clamp that may push on a part in a pose."""
    corners, along, lengths, normals, far, center = polygon
    found = []
    names = dict.fromkeys(name for pair in plate.directions for name in pair)
    for name, line, side in product(names, range(-12, 13), range(len(corners))):
        way = np.array(WAYS[name])
        start = np.array([0.0, line * plate.pitch[1]]) if way[0] else np.array([line * plate.pitch[0], 0.0])
        push = -float(way @ turn @ normals[side])
        if push <= 1e-6:
            continue
        move = far[side] + plate.clamp_radius - normals[side] @ (turn.T @ (start - shift))
        tip = start + way * float(move / (normals[side] @ (turn.T @ way)))
        place = turn.T @ (tip - shift)
        if not touches(place, side, corners, along, lengths, normals, far, plate.clamp_radius):
            continue
        if np.hypot(*(pegs - tip).T).min() < plate.peg_radius + plate.clamp_radius - 1e-9:
            continue
        found.append((name, line, tip, wrenches(place[None], normals[side : side + 1], center)[0], push))
    return found


def add_pairs(
    counts: dict[tuple[str, str], int],
    triple: tuple[tuple[int, int], ...],
    seat: np.ndarray,
    clamps: list[tuple[str, int, np.ndarray, np.ndarray, float]],
    plate: Plate,
) -> None:
    """Count the pairs of clamps that close at a seat where neither holds alone, and that the plate has room for."""
    forces = [-np.linalg.solve(seat.T, wrench) / push for _, _, _, wrench, push in clamps]
    for i, j in combinations(range(len(clamps)), 2):
        (one, line, tip, *_), (other, across, end, *_) = clamps[i], clamps[j]
        pair = tuple(sorted((one, other), key=list(WAYS).index))
        if pair not in counts:
            continue
        if forces[i].min() > 1e-7 or forces[j].min() > 1e-7:
            continue
        if np.hypot(*(tip - end)) < 2 * plate.clamp_radius - 1e-9:
            continue
        spans = [list(numbers) for numbers in zip(*triple, strict=True)]
        for name, number in ((one, line), (other, across)):
            spans[1 if name[1] == "x" else 0].append(number)
        if any(max(v) - min(v) >= most for v, most in zip(spans, (plate.columns, plate.rows), strict=True)):
            continue
        angles = np.linspace(0, pi / 2, 20_001)[1:-1]
        pressed = forces[i][:, None] * np.cos(angles) + forces[j][:, None] * np.sin(angles)
        if (pressed.min(axis=0) > 1e-9).any():
            counts[pair] += 1


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.prove) for seed in range(2, 14))])
def test_random_polygons_against_a_slow_enumeration(seed: int) -> None:
    """As many pairs as are found by trying every three holes on every three sides."""
    random = Random(seed)
    loop = convex(random)
    pitch = random.choice([(22.0, 18.0), (17.0, 21.0)])
    directions = [("-x", "-y"), ("-x", "+y"), ("-x", "-x")]
    plate = Plate(
        pitch, 3, columns=3, rows=3, clamps=2, clamp_radius=random.choice([3.0, 4.0]), directions=directions
    )
    result = design(part(loop), plate, listing="all")
    found = {pair: sum(f.direction == " ".join(pair) for f in result) for pair in plate.directions}
    assert found == enumerated(loop, plate)
    assert seed > 1 or sum(found.values()) > 5


@pytest.mark.thorough
def test_the_best_are_those_of_the_whole_list_and_threads_change_nothing(tmp_path: Path) -> None:
    """Any ranking; counts stay whole."""
    workpiece, plate = part(NOTCHED), Plate((20, 16), 3, columns=4, rows=4, clamps=2)
    for rank_by in (None, ["location_error"], ["clamp-freedom", "closure-margin"]):
        whole, few = (design(workpiece, plate, rank_by=rank_by, best=best) for best in (None, 7))
        assert few.table == whole.table.take(slice(0, 7))
        assert (few.pairs, few.seats, few.found) == (whole.pairs, whole.seats, whole.found)
    texts = []
    for threads in (1, 3):
        workhold.save(answer(Query(workpiece, plate), threads=threads), tmp_path / "r.json")
        texts.append((tmp_path / "r.json").read_bytes())
    assert texts[0] == texts[1]


@pytest.mark.thorough
@pytest.mark.parametrize("limit", [{"BLOCKS_TOGETHER": 3}, {"WAYS_TOGETHER": 2e4}], ids=str)
def test_ranges_of_orientation_do_not_show(limit: dict[str, float], monkeypatch: pytest.MonkeyPatch) -> None:
    """However many ranges are worked through one after the other, the list is the same."""
    query = Query(part(NOTCHED), Plate((20, 16), 3, columns=4, rows=4, clamps=2))
    whole = answer(query, threads=1)
    for name, value in limit.items():
        monkeypatch.setattr(lattice_shares, name, value)
    with lattice_shares.LatticeShares.open_for_query(query, 1, None) as ranges:
        assert ranges.share_count > 3
    again = answer(query, threads=1)
    assert again.table == whole.table and again.distinct == whole.distinct
    assert (again.pairs, again.seats) == (whole.pairs, whole.seats)


@pytest.mark.thorough
def test_a_part_far_too_large_for_the_pitch_is_refused_with_one_that_does() -> None:
    """The refusal comes before the search; one pitch is named, and it is not refused."""
    large = rectangle(1500, 1400)
    with pytest.raises(InputError, match=r"1500 x 1400 mm large, .* use a pitch of (\d+) mm or more") as told:
        design(large, Plate(20, 3, clamps=2))
    pitch = float(str(told.value).split("pitch of ")[1].split(" mm")[0])
    for apart, is_refused in ((pitch, False), (pitch / 2, True)):
        refusal = pytest.raises(InputError, match="too large for two clamps") if is_refused else nullcontext()
        query = Query(large, Plate(apart, 3, clamps=2))
        with refusal, lattice_shares.LatticeShares.open_for_query(query, 1, None) as ranges:
            assert ranges.share_count >= 1


@pytest.mark.thorough
@pytest.mark.parametrize("pitch", [20.0, (25.0, 10.0)], ids=str)
def test_the_pitch_that_a_refusal_names_is_counted(pitch: float | tuple[float, float]) -> None:
    """Of a panel with many slanted holes, in which more contacts are left than the number of holes lets expect."""
    step, ring = 216 / 7, np.exp(-2j * np.pi * np.arange(5) / 5) * 8
    holes = [ring + step * (1 + i + 1j * (1 + j)) for i in range(6) for j in range(6)]
    corners = [np.array([0, 216, 216 + 216j, 216j]), *holes]
    panel = Workpiece.from_loops("panel", [[[z.real, z.imag, 0] for z in loop] for loop in corners])
    with pytest.raises(InputError, match=r"use a pitch of (\d+) mm or more") as told:
        design(panel, Plate(pitch, 3, clamps=2))
    named = float(str(told.value).split("pitch of ")[1].split(" mm")[0])
    with lattice_shares.LatticeShares.open_for_query(
        Query(panel, Plate(named, 3, clamps=2)), 1, None
    ) as ranges:
        assert ranges.share_count >= 1


@pytest.mark.thorough
def test_restrictions_leave_what_filtering_the_whole_list_leaves() -> None:
    """Faces to avoid and angles act on pairs before the best is taken."""
    workpiece, plate = part(NOTCHED), Plate((20, 16), 3, columns=4, rows=4, clamps=2)
    whole = design(workpiece, plate, listing="all")
    avoid = whole[0].pegs[3].face
    restricted = design(
        workpiece, plate, listing="all", restrictions=Restrictions(avoid=(avoid,), angles=((0, 120),))
    )
    kept = [f for f in whole if avoid not in {p.face for p in f.pegs} and f.pose.theta_deg <= 120]
    assert len(restricted) == len(kept) > 0


@pytest.mark.thorough
def test_a_symmetric_part_counts_its_copies_once() -> None:
    """Half a turn of a rectangle carries every fixture into another one."""
    for directions in (None, [("-x", "+x")]):
        plate = Plate((20, 16), 3, clamps=2, columns=4, rows=4, directions=directions)
        result = design(rectangle(57, 45), plate, listing="all")
        assert result.found == {"clamp2": len(result)} and result.distinct == {"clamp2": len(result) // 2}
        assert len(result) > 10


def test_closure_margin_and_ratio_of_a_square_seat() -> None:
    """The textbook 3-2-1: the margin is a sixth where forces may be shared alike, and any two forces hold."""
    # Locators below at -1 and 1 and beside; clamps opposite the middle and opposite the one beside.
    clamps = np.zeros((1, 2, clamp_pairs.CLAMP_LENGTH))
    clamps[0, 0, :4] = [0.5, 0.5, 0.0, 1.0]
    clamps[0, 1, :4] = [0.0, 0.0, 1.0, 1.0]
    out = np.empty((1, 2))
    clamp_pairs.write_closures(clamps, out)
    assert out[0] == pytest.approx([1 / 6, 90.0])
    low, high = compute_force_ratios(np.array([[[1.0, 0.0], [-0.5, 1.0], [0.5, 0.0]]]))
    assert (low[0], high[0]) == (0.5, inf)
    assert degrees_between(low, high)[0] == pytest.approx(degrees(pi / 2 - atan(0.5)))


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"clamps": 3}, "a plate has 1 or 2"),
        ({"clamps": 1, "directions": [("-x", "-y")]}, "there is one clamp"),
        ({"clamps": 2, "directions": [("-x",)]}, "not a pair of directions"),
        ({"clamps": 2, "directions": [("-x", "up")]}, "a clamp cannot move in the direction"),
        ({"clamps": 2, "directions": 5}, "not a pair of directions"),
        ({"clamps": 2, "directions": [[["-x"], "-y"]]}, "a clamp cannot move in the direction"),
    ],
)
def test_plates_that_cannot_be_are_refused_in_one_sentence(fields: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Plate(20, 3, **fields)


def test_listings_and_rankings_of_two_clamps_are_refused_where_there_is_one() -> None:
    workpiece = rectangle(50, 40)
    with pytest.raises(InputError, match="the listing cannot be 'best'"):
        design(workpiece, Plate(20, 3), listing="best")
    with pytest.raises(InputError, match="choose best or all"):
        design(workpiece, Plate(20, 3, clamps=2), listing="some")
    with pytest.raises(InputError, match="there is one clamp"):
        design(workpiece, Plate(20, 3), rank_by="clamp-freedom")


def test_flat_directions_are_all_pairs_and_the_usual_ones_depend_on_turns() -> None:
    names = Plate(20, 3, clamps=2, directions=["-x", "+x", "-y", "+y"])
    assert len(names.pushes) == 6 and len(names.directions) == 10
    assert Plate(20, 3, clamps=2).directions == (("-x", "-y"),)
    assert Plate((20, 16), 3, clamps=2).directions == (("-x", "-y"), ("-x", "+y"))
    assert Plate(20, 3, clamps=2, directions=[("-y", "-x")]).directions == (("-x", "-y"),)
