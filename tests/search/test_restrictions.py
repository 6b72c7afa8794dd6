"""What a user rules out takes away exactly the fixtures that break it, however early the search leaves them out."""

from __future__ import annotations

from functools import cache
from math import hypot

import numpy as np
import pytest

from fixture_sets import Judge, listed
from workhold import (
    Fixture,
    InputError,
    Query,
    Restrictions,
    Result,
    Vise,
    Workpiece,
    answer,
    circle_zone,
    design,
    load,
    polygon_zone,
)
from workhold.algebra import find_fixtures_by_algebra
from workhold.fixels.carrier import parse_hole_name

Key = tuple[object, float]


def vise(**changes: object) -> Vise:
    """A two-column vise with some fields changed."""
    return Vise(**({"pitch": 10.0, "columns": 2, "peg_radius": 3.0} | changes))


@cache
def unrestricted(rows: int | None) -> Result:
    """The widget without restrictions on jaws of so many rows, searched once."""
    return design(load("widget"), vise(rows=rows))


@pytest.fixture
def free() -> Result:
    """The widget without restrictions."""
    return unrestricted(None)


def triangle() -> Workpiece:
    """Three unequal sides."""
    return Workpiece.from_loops("triangle", [[[0, 0, 0], [90, 0, 0], [30, 70, 0]]])


def identities(result: Result, chosen: list[bool] | None = None) -> list[Key]:
    """Identities of the fixtures listed, or of the chosen ones, sorted."""
    judge = Judge(result.workpiece, result.toolkit)
    found = [judge.identity(fixture) for fixture in listed(result)]
    if chosen is not None:
        found = [identity for identity, is_chosen in zip(found, chosen, strict=True) if is_chosen]
    return sorted((key, round(theta, 6)) for key, theta, _ in found)


def peg_places(fixture: Fixture) -> list[tuple[float, float]]:
    """Peg centres in the part's frame."""
    angle = np.radians(fixture.pose.theta_deg)
    c, s = np.cos(angle), np.sin(angle)
    moved = [(peg.x - fixture.pose.x, peg.y - fixture.pose.y) for peg in fixture.pegs]
    return [(c * x + s * y, -s * x + c * y) for x, y in moved]


@pytest.mark.thorough
def test_avoided_faces_are_not_touched_and_nothing_else_is_lost(free: Result) -> None:
    """What is left are exactly the fixtures that never touched them."""
    avoid = (1, 4)
    limited = design(free.workpiece, free.toolkit, restrictions=Restrictions(avoid=avoid))
    chosen = [not any(peg.face in avoid for peg in fixture.pegs) for fixture in free]
    assert 0 < sum(chosen) < len(free)
    assert identities(limited) == identities(free, chosen)
    assert limited.statistics["features"] < free.statistics["features"]


@pytest.mark.thorough
@pytest.mark.parametrize("body", [3.0, 4.5])
def test_no_body_stands_over_a_zone(free: Result, body: float) -> None:
    """The distance from each peg to the zones is at least the body's radius; all such fixtures are there."""
    x0, y0, x1, y1 = free.workpiece.bounds
    middle = ((x0 + x1) / 2, (y0 + y1) / 2)
    corners = [(x1 - 6, y1 - 6), (x1 + 9, y1 - 6), (x1 + 9, y1 + 9), (x1 - 6, y1 + 9)]
    circle = (x0, middle[1], 7.0)
    zones = (polygon_zone(corners[::-1]), circle_zone(*circle))
    limited = design(free.workpiece, vise(body_radius=body), restrictions=Restrictions(zones=zones))
    apart = [
        min(
            min(
                hypot(x - circle[0], y - circle[1]) - circle[2],
                hypot(
                    max(corners[0][0] - x, 0, x - corners[1][0]), max(corners[0][1] - y, 0, y - corners[2][1])
                ),
            )
            for x, y in peg_places(fixture)
        )
        for fixture in free
    ]
    chosen = [gap >= body for gap in apart]
    assert 0 < sum(chosen) < len(free)
    assert identities(limited) == identities(free, chosen)


@pytest.mark.thorough
def test_thick_bodies_keep_pegs_apart(free: Result) -> None:
    """Bodies may be thicker than the distance between holes; then no two pegs stand in neighbouring holes."""
    limited = design(free.workpiece, vise(body_radius=6.0))
    chosen = [
        min(hypot(a.x - b.x, a.y - b.y) for k, a in enumerate(f.pegs) for b in f.pegs[:k]) >= 12.0
        for f in free
    ]
    assert 0 < sum(chosen) < len(free)
    assert identities(limited) == identities(free, chosen)
    assert limited.statistics["chord_curves"] < free.statistics["chord_curves"]


@pytest.mark.thorough
@pytest.mark.parametrize("angles", [((-20.0, 35.0),), ((0.0, 0.0), (170.0, 200.0)), ((0.0, 360.0),)])
def test_angles_are_kept(free: Result, angles: tuple[tuple[float, float], ...]) -> None:
    """Type I counts when it or its half turn lies in a range, and is listed as it lies there; less is searched."""
    limited = design(free.workpiece, free.toolkit, restrictions=Restrictions(angles=angles))

    def lies(theta: float) -> bool:
        return any((theta - low + 1e-7) % 360 <= high - low + 2e-7 for low, high in angles)

    assert all(lies(fixture.pose.theta_deg) for fixture in limited)
    chosen = [lies(f.pose.theta_deg) or (f.type == "I" and lies(f.pose.theta_deg + 180)) for f in free]
    assert sum(chosen) > 0
    assert identities(limited) == identities(free, chosen)
    assert (limited.statistics["curve_pairs"] < free.statistics["curve_pairs"]) == (sum(chosen) < len(free))
    judge = Judge(limited.workpiece, limited.toolkit)
    assert all(judge.check(fixture)[0] == [] for fixture in listed(limited)[::9])


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("rows", "names"),
    [
        (None, ["L-A"]),
        (12, ["R-A2", "L-B3", "R-B1"]),
        (12, ["L-A", "R-B"]),
        pytest.param(12, ["L-A"], marks=pytest.mark.prove),
        pytest.param(None, ["R-A2", "L-B3", "R-B1"], marks=pytest.mark.prove),
        pytest.param(None, ["L-A", "R-B"], marks=pytest.mark.prove),
    ],
)
def test_no_peg_stands_in_a_blocked_hole(free: Result, rows: int | None, names: list[str]) -> None:
    """A fixture is left exactly when it, or for Type I its half turn, can be shifted to holes that are free."""
    blocked = tuple(parse_hole_name(name, ("left", "right"), "jaw") for name in names)
    limited = design(free.workpiece, vise(rows=rows, blocked=blocked))
    for fixture in limited:
        for peg in fixture.pegs:
            assert not any(
                (peg.carrier, peg.column) == (h.carrier, h.column) and h.row in (None, peg.row)
                for h in blocked
            ), fixture
    unblocked = unrestricted(rows)
    chosen = [can_stand(fixture, unblocked.toolkit, blocked) for fixture in unblocked]
    assert sum(chosen) > 0
    assert identities(limited) == identities(unblocked, chosen)
    judge = Judge(limited.workpiece, limited.toolkit)
    assert all(judge.check(fixture)[0] == [] for fixture in listed(limited)[::9])


def can_stand(fixture: Fixture, vise: Vise, blocked: tuple[object, ...]) -> bool:
    """Whether some shift of a fixture's pegs, by columns on each jaw and by rows, avoids blocked holes."""
    forms = [[(peg.carrier, peg.column, peg.row) for peg in fixture.pegs]]
    if fixture.type == "I":
        other = {"left": "right", "right": "left"}
        forms.append([(other[jaw], -column, -row) for jaw, column, row in forms[0]])
    # Both jaws' columns are counted from the opening outward.
    for form in forms:
        outward = [(jaw, -column if jaw == "left" else column, row) for jaw, column, row in form]
        base = {jaw: min(c for j, c, _ in outward if j == jaw) for jaw in ("left", "right")}
        low = min(row for _, _, row in form)
        pegs = [(jaw, column - base[jaw], row - low) for jaw, column, row in outward]
        highest = max(row for _, _, row in pegs)
        lifts = range(20) if vise.rows is None else range(vise.rows - highest)
        opening = fixture.travel + vise.pitch[0] * (sum_outward(fixture, vise))
        for left in range(vise.columns):
            for right in range(vise.columns):
                if opening - (left + right) * vise.pitch[0] < vise.min_gap - 1e-9:
                    continue
                for lift in lifts:
                    if all(
                        is_free(jaw, c + (left if jaw == "left" else right), r + lift, vise, blocked)
                        for jaw, c, r in pegs
                    ):
                        return True
    return False


def sum_outward(fixture: Fixture, vise: Vise) -> int:
    """Columns that the pegs of a fixture stand away from the opening."""
    left = max(peg.column for peg in fixture.pegs if peg.carrier == "left")
    right = min(peg.column for peg in fixture.pegs if peg.carrier == "right")
    return vise.columns - 1 - left + right


def is_free(jaw: str, outward: int, row: int, vise: Vise, blocked: tuple[object, ...]) -> bool:
    """Whether a hole, its column counted from the opening, exists and is not blocked."""
    if outward >= vise.columns:
        return False
    column = vise.columns - 1 - outward if jaw == "left" else outward
    return not any((h.carrier, h.column) == (jaw, column) and h.row in (None, row) for h in blocked)  # type: ignore[attr-defined]


@pytest.mark.thorough
def test_both_engines_agree_under_restrictions() -> None:
    """The paper's polynomials, given the same features and rules, list the same fixtures."""
    part = triangle()
    limits = Restrictions(zones=(circle_zone(0.0, 0.0, 12.0),), angles=((-30.0, 60.0), (140.0, 170.0)))
    small = Vise(pitch=20, columns=2, peg_radius=3, body_radius=4, blocked=["R-A"])
    query = Query(part, small, restrictions=limits)
    one, other = (engine(query) for engine in (answer, find_fixtures_by_algebra))
    assert len(one) > 0 and identities(one) == identities(other)


def test_restrictions_that_leave_nothing_say_so() -> None:
    """One sentence each."""
    part = triangle()
    with pytest.raises(InputError, match="has no face 17"):
        design(part, vise(), restrictions=Restrictions(avoid=(17,)))
    with pytest.raises(InputError, match="every face of triangle"):
        design(part, vise(), restrictions=Restrictions(avoid=tuple(range(len(part.segments)))))
    with pytest.raises(InputError, match="zones cover every place along triangle"):
        design(part, vise(), restrictions=Restrictions(zones=(circle_zone(0, 0, 1e4),)))
    with pytest.raises(InputError, match="not a range"):
        Restrictions(angles=((20.0, 10.0),))
    with pytest.raises(InputError, match="polygon has 2 corners"):
        polygon_zone([(0, 0), (1, 1)])
    with pytest.raises(InputError, match="cross"):
        polygon_zone([(0, 0), (10, 10), (10, 0), (0, 8)])
    with pytest.raises(InputError, match="not a circle"):
        circle_zone(0, 0, 0)


def test_any_segment_of_a_face_names_it() -> None:
    """A side drawn in two pieces is one face; either number avoids it."""
    square = Workpiece.from_loops("square", [[[0, 0, 0], [30, 0, 0], [60, 0, 0], [60, 50, 0], [0, 50, 0]]])
    for number in (0, 1):
        result = design(square, vise(), restrictions=Restrictions(avoid=(number,)))
        assert len(result) == 0 or not (result.table.face == 0).any()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"body_radius": 2.0}, "body radius 2 is less than the peg radius 3"),
        ({"blocked": ["L-C1"]}, "L-C1 is blocked, but each jaw has only 2 columns"),
        ({"rows": 3, "blocked": ["R-A4"]}, "R-A4 is blocked, but each jaw has only 3 rows"),
        ({"blocked": ["L-A", "L-B"]}, "every column of the left jaw is blocked"),
    ],
)
def test_vises_that_cannot_be(changes: dict[str, object], words: str) -> None:
    """One sentence each."""
    with pytest.raises(InputError, match=words):
        vise(**changes)
