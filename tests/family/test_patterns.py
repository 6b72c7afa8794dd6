"""Patterns are the same after every move that leaves the pegs as they are to each other, and no others are."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import pytest
from attrs import evolve

from family_parts import shop_parts
from workhold import Fence, OpeningVise, Plate, Query, Result, Vise, Workpiece, answer
from workhold.family.patterns import (
    encode_patterns,
    list_holes,
    map_carriers_by_half_turn,
    move_onto_pattern,
    rotate_fixtures_by_half_turn,
    shift_fixture,
)
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture_table import make_fixture_of_row
from workhold.verification import Judge

ELL, BRACKET = shop_parts(2)
RING = Workpiece.from_loops(
    "ring",
    [[[0, 0, 0], [70, 0, 0], [60, 50, 0], [0, 40, 0]], [[15, 10, 0], [50, 12, 0], [48, 32, 0], [12, 30, 0]]],
)
HELD: dict[str, tuple[Workpiece, Toolkit]] = {
    "vise": (ELL, Vise(pitch=10, columns=2, peg_radius=3)),
    "offset rows": (BRACKET, Vise(pitch=(10, 12), columns=2, peg_radius=3, row_offset=4, rows=12)),
    "opening vise": (RING, OpeningVise(pitch=10, columns=1, peg_radius=2, min_gap=4)),
    "plate": (BRACKET, Plate(pitch=20, peg_radius=3, directions=["-x", "-y"])),
    "plate with strokes": (BRACKET, Plate(pitch=20, peg_radius=3, travel=(10, 35))),
    "two clamps": (ELL, Plate(pitch=20, peg_radius=3, clamps=2, directions=[("-x", "+x"), ("-x", "-y")])),
    "fence": (BRACKET, Fence(pitch=10, peg_radius=3, wall_offset=5, travel=(10, 35))),
    "fence, two clamps": (ELL, Fence(pitch=20, peg_radius=3, wall_offset=10, clamps=2)),
}


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    """All fixtures of each part in its toolkit."""
    return {
        name: answer(Query(part, toolkit, listing="all" if toolkit.travel_count > 1 else None), threads=1)
        for name, (part, toolkit) in HELD.items()
    }


def naive(result: Result, row: int) -> tuple[object, ...]:
    """The pattern of a fixture by its definition, from the fixture's own words."""
    fixture, toolkit = result[row], result.toolkit
    places = []
    for peg in fixture.pegs:
        carrier = toolkit.find_carrier(peg.carrier)
        if carrier.is_wall:
            continue
        along = carrier.on is not None and not carrier.has_a_hole
        column = None if along and carrier.is_along_x else peg.column
        places.append((peg.carrier, column, None if along and not carrier.is_along_x else peg.row))
    jaws = isinstance(toolkit, Vise)
    columns, rows = defaultdict[str, list[int]](list), [row for _, _, row in places if row is not None]
    for carrier, column, _ in places:
        if column is not None:
            columns[carrier if jaws else ""].append(column)
    first_row = 0 if toolkit.wall is not None else min(rows)
    told = [
        (c, None if x is None else x - min(columns[c if jaws else ""]), None if y is None else y - first_row)
        for c, x, y in places
    ]
    return fixture.type, fixture.direction, tuple(sorted(told, key=repr))


@pytest.mark.thorough
@pytest.mark.parametrize("name", HELD)
def test_words_are_the_same_where_patterns_are(results: dict[str, Result], name: str) -> None:
    result = results[name]
    count = min(len(result), 400)
    assert count > 0
    words = encode_patterns(result.table.take(slice(0, count)), result.toolkit)
    told = [naive(result, row) for row in range(count)]
    by_words, by_pattern = defaultdict[bytes, set[object]](set), defaultdict[object, set[bytes]](set)
    for row, pattern in enumerate(told):
        by_words[words[row].tobytes()].add(pattern)
        by_pattern[pattern].add(words[row].tobytes())
    assert {len(some) for some in by_words.values()} == {1} == {len(some) for some in by_pattern.values()}


@pytest.mark.thorough
@pytest.mark.parametrize("name", HELD)
def test_a_shifted_fixture_is_one_of_the_same_pattern(results: dict[str, Result], name: str) -> None:
    result = results[name]
    toolkit, one = result.toolkit, result.table.take(slice(0, 1))
    rows = 0 if toolkit.wall is not None else 2
    columns = {} if isinstance(toolkit, Vise) else {0: 3}
    moved = shift_fixture(one, toolkit, columns, rows)
    assert (encode_patterns(moved, toolkit) == encode_patterns(one, toolkit)).all()
    back = move_onto_pattern(moved, one, toolkit)
    assert back is not None
    assert list_holes(back, toolkit) == list_holes(one, toolkit)
    for mine, theirs in ((back.position, one.position), (back.jaw_separation, one.jaw_separation)):
        assert mine == pytest.approx(theirs, abs=1e-9)
    # Where everything lies after the move is where it lay, moved.
    before, after = (make_fixture_of_row(table, toolkit, 0, result.workpiece) for table in (one, moved))
    pitch = toolkit.carriers[0].pitch
    for peg, other in zip(before.pegs, after.pegs, strict=True):
        assert (other.x - peg.x, other.y - peg.y) == pytest.approx(
            (columns.get(0, 0) * pitch[0], rows * pitch[1])
        )


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["vise", "offset rows", "opening vise", "two clamps"])
def test_half_a_turn_gives_a_fixture_whose_half_turn_is_the_first(
    results: dict[str, Result], name: str
) -> None:
    result = results[name]
    toolkit = result.toolkit
    kind = next(
        k for k in range(len(toolkit.arrangements)) if map_carriers_by_half_turn(toolkit, k) is not None
    )
    rows = np.flatnonzero(result.table.arrangement == kind)[:40]
    assert len(rows)
    table = result.table.take(rows)
    after = rotate_fixtures_by_half_turn(table, toolkit)
    again = rotate_fixtures_by_half_turn(after, toolkit)
    assert (
        (again.column == table.column).all()
        and (again.row == table.row).all()
        and (again.face == table.face).all()
    )
    assert again.position == pytest.approx(table.position, abs=1e-9)
    assert again.jaw_separation == pytest.approx(table.jaw_separation, abs=1e-9)
    judge = Judge(result.query)
    for row in range(len(after)):
        fixture = make_fixture_of_row(after, toolkit, row, result.workpiece)
        # Of a vise the location error alone is another one: another jaw stands still.
        left_out = ("location_error", "penalty", "warnings") if isinstance(toolkit, Vise) else ()
        told = {key: value for key, value in fixture.quality.items() if key not in left_out}
        ruling = judge.rule_on(evolve(fixture, quality=told))
        assert ruling.verdict == "proven", ruling.reason


def test_types_that_a_half_turn_changes_have_none() -> None:
    vise = Vise(pitch=10, columns=2, peg_radius=3)
    assert [map_carriers_by_half_turn(vise, number) for number in (0, 1)] == [(1, 0), None]
    plate = Plate(pitch=20, peg_radius=3, clamps=2, directions=[("-x", "+x"), ("-x", "-y"), ("-x", "-x")])
    turns = {
        one.direction: map_carriers_by_half_turn(plate, k) is not None
        for k, one in enumerate(plate.arrangements)
    }
    assert turns == {"-x -x": False, "-x +x": True, "-x -y": False}
    assert map_carriers_by_half_turn(Plate(pitch=20, peg_radius=3), 0) is None
    assert (
        map_carriers_by_half_turn(
            Fence(pitch=20, peg_radius=3, wall_offset=9, clamps=2, directions=[("-x", "+x")]), 0
        )
        is None
    )


def test_jaws_that_would_stand_too_near_are_not_moved_on(results: dict[str, Result]) -> None:
    result = results["vise"]
    one = result.table.take(slice(0, 1))
    vise = Vise(pitch=10, columns=9, peg_radius=3, min_gap=float(one.jaw_separation[0]) - 15)
    outward = [shift_fixture(one, vise, {0: 4, 1: 4 + steps}, 0) for steps in (0, 1, 2)]
    back = [move_onto_pattern(one, target, vise) for target in outward]
    assert [row is not None for row in back] == [True, True, False]
    assert back[1] is not None
    assert float(back[1].jaw_separation[0]) == pytest.approx(float(one.jaw_separation[0]) - 10)
