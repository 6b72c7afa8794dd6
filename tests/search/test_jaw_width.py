"""A flat jaw with ends: which fixtures of the endless one hold, and from which column, by arithmetic of this file.

It takes the loops of the part and the pegs of the endless wall's fixtures, and of the program nothing else: where the
part touches the jaw's line, what the jaw reaches of it in each column, and which of them is the best.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from math import atan2, cos, degrees, hypot, isclose, pi, radians, sin
from pathlib import Path
from random import Random
from typing import Any

import pytest
from attrs import evolve
from flint import arb

import workhold
from judged import rules_in
from strategies import outline
from toolkit_results import assert_all_proven, part, verify_edited
from workhold import Fixture, FlatJaw, InputError, Load, Query, Result, Workpiece
from workhold.fixels.kinds import make_toolkit
from workhold.search.design import ToolkitOutcome, choose_first_toolkit, explore
from workhold.search.explaining import explain
from workhold.verification.ball_geometry import BallOutline
from workhold.verification.contacts import BallPose

KITE = [(0, 0, 0), (56, 6, 0), (48, 44, 0), (10, 37, 0)]
# Two feet, arcs outside and inside.
ROCKER = [(0, 0, 0), (14, 0, 0), (20, 8, 0), (40, 8, 0), (46, 0, 0), (60, 0, 0.5), (60, 40, 0.2), (0, 40, 0)]
# Round feet, a corner between them that reaches down as far, and sloping sides.
FEET = [
    *[(0, 6, 1), (12, 6, 0), (22, 6, 0), (30, 0, 0), (38, 6, 0), (50, 6, 1), (62, 6, 0)],
    *[(52, 50, 0), (31, 58, 0), (10, 44, 0)],
]
PARTS = {"kite": KITE, "rocker": ROCKER, "feet": FEET}
Point = tuple[float, float]
EDGE, NEAR = 1e-6, 1e-7


def segments(workpiece: Workpiece, fixture: Fixture) -> Iterator[tuple[Point, Point, float]]:
    """The segments of the outer loop as the part lies in a fixture: both ends, and the bulge."""
    turn, pose = radians(fixture.pose.theta_deg), fixture.pose
    rows = workpiece.loops[0].tolist()
    laid = [
        (cos(turn) * x - sin(turn) * y + pose.x, sin(turn) * x + cos(turn) * y + pose.y, bulge)
        for x, y, bulge in rows
    ]
    for k, (x, y, bulge) in enumerate(laid):
        u, v, _ = laid[(k + 1) % len(laid)]
        yield (x, y), (u, v), bulge


def lowest_of_arc(one: Point, other: Point, bulge: float) -> Point | None:
    """The lowest point of a convex arc's circle, where it is on the arc."""
    chord = hypot(other[0] - one[0], other[1] - one[1])
    half = 2 * atan2(bulge, 1.0)
    radius = chord / 2 / sin(half)
    away = radius * cos(half)
    ux, uy = (other[0] - one[0]) / chord, (other[1] - one[1]) / chord
    center = (one[0] + other[0]) / 2 - uy * away, (one[1] + other[1]) / 2 + ux * away
    first = atan2(one[1] - center[1], one[0] - center[0])
    inside = (-pi / 2 - first) % (2 * pi) <= 2 * half + 1e-9 or (first + pi / 2) % (2 * pi) <= 1e-9
    return (center[0], center[1] - radius) if inside else None


def touched(workpiece: Workpiece, fixture: Fixture) -> list[tuple[float, float]]:
    """K: from which x to which the part touches the jaw's line, piece by piece."""
    found = []
    for one, other, bulge in segments(workpiece, fixture):
        found += [(x, x) for x, y in (one, other) if abs(y) < EDGE]
        if bulge == 0 and abs(one[1]) < EDGE and abs(other[1]) < EDGE:
            found.append((min(one[0], other[0]), max(one[0], other[0])))
        if bulge > 0 and (low := lowest_of_arc(one, other, bulge)) is not None and abs(low[1]) < EDGE:
            found.append((low[0], low[0]))
    return found


def expected(workpiece: Workpiece, fixture: Fixture, vise: FlatJaw) -> Any:
    """The column, ends and forces of an endless wall's fixture; None where none does, "marginal" by a hair."""
    assert vise.columns is not None and vise.jaw_width is not None
    left, right, *pegs = fixture.pegs
    acts = left.force * left.x + right.force * right.x
    pieces, lowest = touched(workpiece, fixture), min(peg.column for peg in pegs)
    assert lowest == 0
    middle = (vise.columns - 1) * vise.pitch[0] / 2
    held = []
    for column in range(vise.columns - max(peg.column for peg in pegs)):
        shift = column * vise.pitch[0]
        first, last = middle - vise.jaw_width / 2, middle + vise.jaw_width / 2
        common = [(max(a + shift, first), min(b + shift, last)) for a, b in pieces]
        common = [(a, b) for a, b in common if a <= b]
        if any(
            abs(end - edge) < NEAR
            for a, b in pieces
            for end in (a + shift, b + shift)
            for edge in (first, last)
        ):
            return "marginal"
        if not common:
            continue
        start, end = min(a for a, _ in common), max(b for _, b in common)
        inside = min(acts + shift - start, end - acts - shift)
        if abs(inside - 1e-6) < NEAR:
            return "marginal"
        if inside > 1e-6:
            held.append((end - start, abs((start + end) / 2 - middle), column, start, end, acts + shift))
    if not held:
        return None
    longest = max(length for length, *_ in held)
    held = [one for one in held if one[0] >= longest - 1e-6]
    nearest = min(one[1] for one in held)
    _, _, column, start, end, at = min(
        (one for one in held if one[1] <= nearest + 1e-6), key=lambda one: one[2]
    )
    return column, start, end, (end - at) / (end - start), (at - start) / (end - start)


def known(fixture: Fixture) -> tuple[Any, ...]:
    """What a fixture is, however wide the jaw: angle, holes from the first, faces of pegs, places from the first peg."""
    one, other = fixture.pegs[2:]
    theta = round(fixture.pose.theta_deg % 360.0, 5) % 360.0
    places = [round(value, 4) + 0.0 for value in (fixture.pose.x - one.x, fixture.pose.y, fixture.travel)]
    return theta, other.column - one.column, one.row, other.row, one.face, other.face, *places


def compare(workpiece: Workpiece, endless: FlatJaw, width: float) -> tuple[int, int, Result]:
    """Holds every fixture of a jaw of a width against what is expected; how many stayed and went."""
    vise = endless.with_fields({"jaw_width": width})
    result = workhold.design(workpiece, vise)
    found, stayed, went = {known(fixture): fixture for fixture in result}, 0, 0
    assert len(found) == len(result)
    for fixture in workhold.design(workpiece, endless):
        wanted, listed = expected(workpiece, fixture, vise), found.pop(known(fixture), None)
        if wanted == "marginal":
            continue
        assert (wanted is None) == (listed is None), (wanted, fixture)
        if listed is None:
            went += 1
            continue
        stayed += 1
        column, start, end, *forces = wanted
        left, right, *pegs = listed.pegs
        assert min(peg.column for peg in pegs) == column
        assert all(isclose(peg.x, peg.column * vise.pitch[0], abs_tol=1e-9) for peg in pegs)
        assert isclose(left.x, start, abs_tol=1e-6) and isclose(right.x, end, abs_tol=1e-6)
        assert [left.force, right.force] == pytest.approx(forces, abs=1e-5)
        assert listed.quality["jaw_contact"] == pytest.approx(end - start, abs=1e-6)
        assert [peg.force for peg in pegs] == pytest.approx([peg.force for peg in fixture.pegs[2:]], abs=1e-7)
    assert found == {}
    return stayed, went, result


@pytest.mark.thorough
@pytest.mark.parametrize("name", PARTS)
def test_what_a_jaw_with_ends_holds_is_what_some_column_holds(name: str, tmp_path: Path) -> None:
    """Jaws narrower and wider than the part; each fixture is proven, and a search of the file finds the same."""
    went = 0
    for columns, width in ((6, 200.0), (6, 60.0), (5, 41.0), (7, 23.0), (5, 9.0)):
        endless = FlatJaw(pitch=(11, 9), peg_radius=2.5, columns=columns)
        stays, goes, result = compare(part(PARTS[name]), endless, width)
        went += goes
        assert stays > 0 or width < 20
        if width in (41.0, 23.0):
            assert_all_proven(result, tmp_path, search_files=True)
    assert went > 10


@pytest.mark.thorough
def test_random_parts_with_gaps_and_arcs() -> None:
    """Hull edges that bridge hollows, arcs that touch in a point, jaws of any width."""
    random, stayed, went, looked_at = Random(11), 0, 0, 0
    while looked_at < 40:
        workpiece = outline(random, random.randint(4, 9), curved=random.random() < 0.6, pierced=False)
        if workpiece is None:
            continue
        columns, pitch = random.randint(2, 6), random.choice([9.0, 12.0, (14.0, 8.0)])
        try:
            endless = FlatJaw(pitch=pitch, peg_radius=random.choice([1.0, 2.0]), columns=columns)
            stays, goes, _ = compare(workpiece, endless, random.uniform(4.0, 110.0))
        except InputError:
            continue
        looked_at, stayed, went = looked_at + 1, stayed + stays, went + goes
    assert stayed > 300 and went > 100


def test_a_jaw_wider_than_every_part_changes_columns_alone() -> None:
    """Faces, forces and figures are those of the endless wall, and so is the order."""
    endless = FlatJaw(pitch=10, peg_radius=3, columns=5)
    free, wide = (
        workhold.design(part(ROCKER), one) for one in (endless, endless.with_fields({"jaw_width": 900}))
    )
    assert [known(one) for one in free] == [known(one) for one in wide] and len(free) > 10
    for one, other in zip(free, wide, strict=True):
        assert [peg.touched for peg in one.pegs] == [peg.touched for peg in other.pegs]
        figures = {key: value for key, value in other.quality.items() if key != "jaw_contact"}
        assert figures == pytest.approx(dict(one.quality), abs=1e-9)
        assert other.quality["jaw_contact"] == pytest.approx(other.pegs[1].x - other.pegs[0].x, abs=1e-9)


@pytest.mark.thorough
def test_the_best_are_the_first_of_all_and_may_be_ranked_by_what_the_jaw_holds() -> None:
    """However many are asked for, in any order; without ends of a jaw there is no such figure."""
    vise = FlatJaw(pitch=(11, 9), peg_radius=2.5, columns=7, jaw_width=33)
    for ranking in (None, ("jaw_contact", "closure_margin"), ("warnings", "jaw_contact")):
        everything = workhold.design(part(ROCKER), vise, rank_by=ranking)
        for best in (1, 7, 30):
            few = workhold.design(part(ROCKER), vise, rank_by=ranking, best=best)
            assert list(few) == list(everything)[:best]
    contact = [
        one.quality["jaw_contact"] for one in workhold.design(part(ROCKER), vise, rank_by="jaw-contact")
    ]
    assert contact == sorted(contact, reverse=True) and contact[0] > contact[-1]
    with pytest.raises(InputError, match="there is no jaw contact to rank by"):
        workhold.design(part(ROCKER), vise.with_fields({"jaw_width": None}), rank_by="jaw-contact")


def test_a_width_asks_for_columns_and_a_length() -> None:
    """Said in one sentence each."""
    with pytest.raises(
        InputError, match="jaw width 50 says where the jaws end only beside a plate that ends"
    ):
        FlatJaw(pitch=10, peg_radius=3, jaw_width=50)
    with pytest.raises(InputError, match=r"jaw width 0\.0 is not a positive length"):
        FlatJaw(pitch=10, peg_radius=3, columns=4, jaw_width=0)
    six = workhold.FlatJaw.preset("machine-vise-6-inch")
    four = workhold.FlatJaw.preset("machine-vise-4-inch")
    assert (six.jaw_width, four.jaw_width) == pytest.approx((152.4, 101.6))


def test_why_a_jaw_holds_nothing_names_its_width() -> None:
    """What it takes away, and that a jaw as wide as the part helps; also where that has no figure to rank by."""
    query = workhold.Query(
        part(KITE), FlatJaw(pitch=40, peg_radius=2, columns=2, jaw_width=1.0), rank_by="jaw-contact"
    )
    result = workhold.design(query.workpiece, query.toolkit)
    assert len(result) == 0 and "with the columns, rows, opening and jaw width given" in str(result.notes[0])
    said = explain(query)
    (removal,) = [one for one in said.removals if one.rule == "width of the jaws"]
    assert removal.before > 0 and removal.after == 0
    helps = {help.change: help for help in said.helps}
    assert helps["with a flat jaw as wide as the part"].fields == {"jaw_width": None}
    assert make_toolkit("flat-jaw", {"pitch": 40, "peg_radius": 2, "columns": 2}).limits[0].lifted.words == (
        "with as many columns as needed"
    )


def moved(data: dict[str, Any], columns: int) -> None:
    """Moves the first fixture so many columns along the jaw."""
    fixture, pitch = data["fixtures"][0], data["toolkit"]["pitch"][0]
    for peg in fixture["pegs"]:
        peg["column"] += columns
        peg["x"] += columns * pitch
    fixture["pose"]["x"] += columns * pitch
    for end in ("from", "to"):
        fixture["wall"][end][0] += columns * pitch


@pytest.mark.thorough
def test_verify_refutes_what_the_jaw_does_not_reach_and_other_columns(tmp_path: Path) -> None:
    """Ends beside the jaw's, a force that acts beyond them, columns that another place beats, and wrong figures."""
    vise = FlatJaw(pitch=10, peg_radius=3, columns=8, jaw_width=50)
    workhold.save(workhold.design(part(ROCKER), vise), tmp_path / "r.json")
    data = json.loads((tmp_path / "r.json").read_text())

    def said(edit: Any) -> str:
        outcome = verify_edited(data, edit, tmp_path)
        return outcome.unproven[0].reason if outcome.unproven else "; ".join(outcome.faults)

    assert said(lambda content: None) == ""
    reason = said(lambda content: moved(content, 1))
    assert "its pegs would stand better from column" in reason or "of the flat jaw at its" in reason
    wall = data["fixtures"][0]["wall"]
    wide = workhold.design(part(ROCKER), vise.with_fields({"jaw_width": 58.0}))
    number = next(
        k for k, one in enumerate(wide) if one.quality["jaw_contact"] > 57.9 and one.pegs[2].column > 0
    )
    jaw, fixture = rules_in(wide.toolkit).jaw, wide[number]
    assert jaw is not None
    outline, pose = BallOutline.from_workpiece(wide.workpiece), BallPose.from_written(fixture.pose)
    columns, left, right = [peg.column for peg in fixture.pegs[2:]], *fixture.pegs[:2]
    acts = arb(left.force * left.x + right.force * right.x)
    assert list(jaw.judge(columns, acts, outline, pose)) == []
    off = evolve(pose, x=pose.x - vise.pitch[0])
    beside = [column - 1 for column in columns]
    reasons = [one.reason for one in jaw.judge(beside, acts - vise.pitch[0], outline, off)]
    assert any("mm of the part there" in reason for reason in reasons), reasons

    def stretched(content: dict[str, Any]) -> None:
        content["fixtures"][0]["wall"]["from"][0] -= 3.0

    assert "of the flat jaw at its left end is 3 mm from where the part touches" in said(stretched)
    assert wall["to"][0] - wall["from"][0] <= 50 + 1e-9

    def narrow(content: dict[str, Any]) -> None:
        content["toolkit"]["jaw_width"] = 2.0

    assert said(narrow) != ""

    def wrong(content: dict[str, Any]) -> None:
        content["fixtures"][0]["quality"]["jaw_contact"] += 1.0

    assert "its jaw contact is" in said(wrong)

    def missing(content: dict[str, Any]) -> None:
        del content["fixtures"][0]["quality"]["jaw_contact"]

    assert "its jaw contact is missing" in said(missing)


@pytest.mark.thorough
def test_loads_are_borne_at_the_ends_that_the_jaw_reaches(tmp_path: Path) -> None:
    """The same push on a narrow jaw may need far more force than on an endless one, and verify says so as well."""
    load = Load(points=[(30.0, 38.0)], force=100.0)
    endless = FlatJaw(pitch=(11, 9), peg_radius=2.5, columns=7)
    results = [
        workhold.design(part(ROCKER), one, loads=[load])
        for one in (endless, endless.with_fields({"jaw_width": 23}))
    ]
    free, held = ({known(one): one.quality["jaw_force_needed"] for one in result} for result in results)
    both = free.keys() & held.keys()
    assert len(both) > 3 and any(held[one] > 1.5 * free[one] for one in both)
    assert_all_proven(results[1], tmp_path)


def test_turning_and_mirroring_the_part() -> None:
    """The jaw is as wide to either side, so the mirrored part has as many fixtures; a turned one has the same."""
    vise = FlatJaw(pitch=(11, 9), peg_radius=2.5, columns=6, jaw_width=37)
    base = workhold.design(part(FEET), vise)
    bulges = [bulge for *_, bulge in FEET]
    flipped = [(-x, y, bulges[k - 1]) for k, (x, y, _) in reversed(list(enumerate(FEET)))]
    turn = radians(23.0)
    turned = [(cos(turn) * x - sin(turn) * y, sin(turn) * x + cos(turn) * y, bulge) for x, y, bulge in FEET]
    for other in (flipped, turned):
        again = workhold.design(part(other), vise)
        lengths = [sorted(round(one.quality["jaw_contact"], 5) for one in result) for result in (base, again)]
        assert lengths[0] == lengths[1] and len(lengths[0]) > 5
    assert degrees(turn) == pytest.approx(23.0)


def test_the_first_choice_holds_the_part_over_its_length_and_not_the_first_name() -> None:
    """Among those with as few warnings tenths of the length come first, in another order last."""
    figures = {
        "warnings": 0.0,
        "penalty": 6.0,
        "clamp_amplification": 1.0,
        "closure_margin": 0.1,
        "edge_distance": 3.0,
    }
    ranking = ("warnings", "penalty", "clamp_amplification", "closure_margin", "edge_distance")
    short = ToolkitOutcome("a 4-inch vise", {"flat": 1}, figures, fit=True, held=0.25)
    better = ToolkitOutcome("b 4-inch vise", {"flat": 1}, figures | {"penalty": 2.0}, fit=True, held=0.29)
    long = ToolkitOutcome("c 6-inch vise", {"flat": 1}, figures, fit=True, held=0.38)
    warned = ToolkitOutcome("d plate", {"clamp": 1}, figures | {"warnings": 1.0}, fit=True, held=1.0)
    assert choose_first_toolkit([short, better, warned], ranking) is better
    assert choose_first_toolkit([short, better, long, warned], ranking) is long
    assert choose_first_toolkit([short, long, better], ("penalty",)) is better
    assert choose_first_toolkit([short, long], ("penalty",)) is long
    assert choose_first_toolkit([short, long], ranking, lambda name: name == short.name) is short


def test_a_bar_is_held_over_more_of_its_length_by_wider_jaws() -> None:
    """The share between the outermost contacts, as far as the jaws of each vise reach."""
    loop = [
        (0, 0, 0),
        (400, 0, 0),
        (400, 40, 0),
        (260, 40, 0),
        (230, 60, 0),
        (170, 60, 0),
        (140, 40, 0),
        (0, 40, 0),
    ]
    bar = part([(x, y, bulge) for x, y, bulge in loop])
    names = ("machine-vise-4-inch", "machine-vise-6-inch")
    four, six = explore([(name, Query(bar, FlatJaw.preset(name), best=5)) for name in names])
    assert four.held == pytest.approx(101.6 / 400, abs=0.02) and six.held == pytest.approx(
        152.4 / 400, abs=0.02
    )
