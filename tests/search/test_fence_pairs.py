"""Two clamps on a fence: a complete set, counts by hand, and what holds of ratios, turns and larger plates."""

from __future__ import annotations

import json
from math import cos, sin
from pathlib import Path
from threading import Event
from typing import Any

import attrs
import pytest

import workhold
from toolkit_results import MOUTH, NOTCHED, check_and_read_back, checked, part, rectangle
from workhold import Fence, Query, Restrictions, Workpiece, answer, design
from workhold.proof.flush import compute_fence_reactions
from workhold.search import wall_search

COMPLETE = Path(__file__).parent.parent / "data" / "toolkits" / "edge2_saddle_10.json"
ALL = ["-x", "+x", "-y", "+y"]


@pytest.mark.thorough
def test_complete_set_is_reproduced(tmp_path: Path) -> None:
    """Every fixture of the set and no other, each by itself beyond reproach; and nothing undecided."""
    truth = json.loads(COMPLETE.read_text())
    fields = {name: value for name, value in truth["toolkit"].items() if name != "kind"}
    workpiece = Workpiece.from_loops("saddle", truth["workpiece"]["loops"])
    result = design(workpiece, Fence(**fields), listing="all")
    assert result.proof is not None and result.proof.undecided == ()
    assert (result.counts, result.pairs, result.seats) == (truth["counts"], truth["pairs"], truth["seats"])
    assert ": 0 missing, 0 extra" in checked(result, tmp_path / "result.json", COMPLETE)
    best = design(workpiece, Fence(**fields))
    assert (best.pairs, best.seats, len(best)) == (truth["pairs"], truth["seats"], truth["seats"])
    assert "0 missing, 0 extra, 0 with other pairs" in checked(best, tmp_path / "best.json", COMPLETE)


def rows_beside(side: float, pitch: float, offset: float, radius: float) -> int:
    """How many rows of holes meet a side that stands on the fence."""
    return sum(0 < offset + k * pitch < side for k in range(99) if offset + k * pitch >= radius)


@pytest.mark.parametrize(
    ("size", "pitch", "offset"), [((62.0, 34.0), (10, 10), 5.0), ((45.0, 28.0), (13, 9), 7.0)]
)
def test_a_rectangle_is_counted_by_hand(
    size: tuple[float, float], pitch: tuple[float, float], offset: float
) -> None:
    """One face down, every row that meets the side as stop and as clamp, and every column over it; the clamp that pushes
    down may always be tightened first."""
    fence = Fence(pitch, 3, wall_offset=offset, clamps=2, directions=[("-x", "-y")])
    result = design(rectangle(*size), fence, listing="all")
    expected = 0
    for width, height in (size, size[::-1]):
        rows = rows_beside(height, pitch[1], offset, 3)
        columns = sum(3 < k * pitch[0] < width + 3 for k in range(99))
        expected += 2 * rows**2 * columns
    assert len(result) == expected
    for fixture in result:
        assert fixture.pair is not None and fixture.pair.ratio[1] == float("inf")


@pytest.mark.thorough
@pytest.mark.parametrize("listing", ["best", "all"])
@pytest.mark.parametrize(
    ("loop", "fields"),
    [
        (
            NOTCHED,
            {
                "pitch": (16, 12),
                "wall_offset": 6,
                "directions": ALL,
                "columns": 4,
                "rows": 5,
                "clamp_radius": 4.0,
            },
        ),
        (MOUTH, {"pitch": 14, "wall_offset": 8, "travel": (4.0, 30.0), "columns": 7, "rows": 5}),
    ],
)
def test_every_fixture_stands_before_the_checker_and_reads_back(
    loop: list[tuple[float, ...]], fields: dict[str, Any], listing: str, tmp_path: Path
) -> None:
    """Also with other clamps than locators, with arcs, and bolted; JSON and columns say the same."""
    result = design(part(loop), Fence(peg_radius=3, clamps=2, **fields), listing=listing)
    assert len(result) > 3
    check_and_read_back(result, tmp_path)


def seen(result: workhold.Result) -> list[tuple[Any, ...]]:
    """Fixtures without their poses."""
    return sorted(
        (
            f.direction,
            tuple((p.carrier, p.column, p.row, round(p.x - f.pegs[0].x, 4), round(p.y, 4)) for p in f.pegs),
        )
        for f in result
    )


def test_turning_and_moving_the_part_changes_poses_only() -> None:
    fence = Fence((16, 12), 3, wall_offset=6, clamps=2, columns=4, rows=5)
    turned = [(cos(1.1) * x - sin(1.1) * y + 9, sin(1.1) * x + cos(1.1) * y - 3, b) for x, y, b in NOTCHED]
    one, other = (design(part(loop), fence, listing="all") for loop in (NOTCHED, turned))
    assert seen(one) == seen(other) and len(one) > 50


@pytest.mark.thorough
def test_larger_plates_and_more_directions_hold_all_that_smaller_ones_hold() -> None:
    small = Fence((16, 12), 3, wall_offset=6, clamps=2, columns=3, rows=4)
    base = set(seen(design(part(NOTCHED), small, listing="all")))
    assert base
    for change in ({"columns": 5}, {"rows": 6}, {"directions": ALL}):
        more = seen(design(part(NOTCHED), attrs.evolve(small, **change), listing="all"))
        held = {(way, tuple(peg[0:1] + peg[3:] for peg in pegs)) for way, pegs in more}
        assert {(way, tuple(peg[0:1] + peg[3:] for peg in pegs)) for way, pegs in base} <= held


@pytest.mark.thorough
def test_no_clamp_of_a_pair_holds_alone_and_the_best_are_the_best_of_all() -> None:
    fields = {"wall_offset": 6, "columns": 4, "rows": 5, "directions": ALL}
    single = design(part(NOTCHED), Fence((16, 12), 3, **fields))
    alone = {(round(f.pose.theta_deg, 4), *(peg_key(f, k) for k in (0, 3))) for f in single}
    every = design(part(NOTCHED), Fence((16, 12), 3, clamps=2, **fields), listing="all")
    assert alone and len(every) > 50
    for fixture in every:
        for k in (3, 4):
            assert (round(fixture.pose.theta_deg, 4), peg_key(fixture, 0), peg_key(fixture, k)) not in alone
    best = design(part(NOTCHED), Fence((16, 12), 3, clamps=2, **fields))
    groups: dict[Any, list[workhold.Fixture]] = {}
    for fixture in every:
        groups.setdefault(
            (fixture.direction, round(fixture.pose.theta_deg, 4), peg_key(fixture, 0)), []
        ).append(fixture)
    assert len(groups) == len(best)
    for fixture in best:
        group = groups[fixture.direction, round(fixture.pose.theta_deg, 4), peg_key(fixture, 0)]
        assert fixture.pair is not None and fixture.pair.count == len(group)
        freest = max(one.quality["clamp_freedom"] for one in group)
        assert fixture.quality["clamp_freedom"] > freest - 1e-4


def peg_key(fixture: workhold.Fixture, k: int) -> tuple[Any, ...]:
    """What tells pegs apart: what they stand on, where they touch the part, and the height above the fence."""
    peg = fixture.pegs[k]
    x, y = fixture.pose.inverse.apply(peg.x, peg.y)
    return peg.carrier, round(x, 3) + 0.0, round(y, 3) + 0.0, round(peg.y, 3)


def test_a_symmetric_part_counts_its_copies_once() -> None:
    result = design(rectangle(57, 45), Fence((20, 16), 3, wall_offset=8, clamps=2), listing="all")
    assert result.distinct == {"edge2": len(result) // 2} and len(result) > 10


def test_a_search_that_is_stopped_within_a_hull_edge_looks_at_no_further_pairs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What was found on the edge before is listed, and the result says that it is incomplete."""
    query = Query(part(NOTCHED), Fence((16, 12), 3, wall_offset=6, clamps=2, columns=4, rows=5))
    whole, stop, looked_at = answer(query), Event(), 0
    closing = wall_search.WallSearch.find_closing_pairs

    def stopping(*given: Any) -> Any:
        nonlocal looked_at
        looked_at += 1
        if looked_at == 12:
            stop.set()
        return closing(*given)

    monkeypatch.setattr(wall_search.WallSearch, "find_closing_pairs", stopping)
    monkeypatch.setattr(wall_search, "TOGETHER", 40)
    stopped = answer(query, cancel=stop)
    assert looked_at == 12 and not stopped.complete and not stopped.notes
    # An edge that was begun is not done, be it the only one.
    stop, looked_at = Event(), 10
    last = answer(attrs.evolve(query, restrictions=Restrictions(angles=((-1, 1),))), cancel=stop)
    assert looked_at == 12 and not last.complete and last.statistics["hull_edges"] == 0
    assert stopped.statistics["hull_edges"] < whole.statistics["hull_edges"]
    assert (
        len(stopped) > 0
        and stopped.pairs is not None
        and whole.pairs is not None
        and stopped.pairs < whole.pairs
    )


def test_what_doubles_leave_open_balls_tell(monkeypatch: pytest.MonkeyPatch) -> None:
    """With every force told by balls the list is the same, and forces agree to the last digits."""
    fence = Fence((16, 12), 3, wall_offset=6, clamps=2, columns=4, rows=4)
    one = design(part(NOTCHED), fence, listing="all")
    asked = []

    def counted(*task: Any) -> Any:
        asked.append(task)
        return compute_fence_reactions(*task)

    monkeypatch.setattr(wall_search, "DOUBTFUL", -1.0)
    monkeypatch.setattr(wall_search, "compute_fence_reactions", counted)
    other = design(part(NOTCHED), fence, listing="all")
    assert seen(one) == seen(other) and len(asked) > 20
    assert abs(one.table.force - other.table.force).max() < 1e-10 * abs(one.table.force).max()
