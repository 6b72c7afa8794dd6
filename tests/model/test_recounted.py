"""Set-ups counted anew: every hole has a name and exists, and part, pegs and supports keep their places."""

from __future__ import annotations

from itertools import product

import pytest
from attrs import evolve
from plate_examples import on_plate

from body_examples import BLOCK, TOOLKITS
from workhold import Fixture, Plate, Query, Vise, design
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.support_request import SupportRequest
from workhold.model.support_triples import (
    FARTHEST,
    ChosenSupports,
    RecountedSupports,
    SupportPad,
    Triple,
    iterate_moves,
    recount_holes,
)
from workhold.supports.listing import find_supports

REQUEST = SupportRequest(12, pad_radius=2.0, tip_radius=2.5)
CASES: dict[str, Toolkit] = {
    **{name: kit for name, kit in TOOLKITS.items() if name != "touching holes"},
    "narrow jaws": Vise((10, 9), 3, 2.5, max_opening=40),
    "blocked jaws": Vise((10, 9), 4, 2.5, blocked=("L-D1", "R-A", "L-C2")),
    "small plate": Plate((12, 10), 3, columns=7, rows=7, travel=(5, 30)),
    "endless plate": Plate((12, 10), 3),
    "endless plate, two clamps": Plate((12, 10), 3, clamps=2, travel=(5, 40)),
}


def refuse_moved(fixture: Fixture, toolkit: Toolkit, triple: Triple, found: RecountedSupports) -> None:
    """Checks that everything stands in a hole of its carrier, and relative to the part where it stood."""
    new = found.fixture
    for old, peg in zip(fixture.pegs, new.pegs, strict=True):
        there, before = new.pose.inverse.apply(peg.x, peg.y), fixture.pose.inverse.apply(old.x, old.y)
        assert there == pytest.approx(before, abs=1e-9)
        assert (peg.face, peg.force, peg.flat_deg) == (old.face, old.force, old.flat_deg)
    travels = iter(new.travels)
    for peg in new.pegs:
        carrier = toolkit.find_carrier(peg.carrier)
        if carrier.is_wall:
            assert peg.y == pytest.approx(0.0, abs=1e-9)
            continue
        travelled = next(travels) if carrier.on is not None else new.travel
        assert carrier.compute_hole_center(peg.column, peg.row, travelled) == pytest.approx(
            (peg.x, peg.y), abs=1e-9
        )
        assert peg.place in (None, carrier.name_place(peg.column, peg.row))
        home = toolkit.find_carrier(carrier.stands_on)
        in_column, in_row = carrier.counted_axes
        assert not in_column or 0 <= peg.column < (home.columns or 10**9)
        assert not in_row or 0 <= peg.row < (home.rows or 10**9)
        assert not (in_column and in_row and home.is_blocked(peg.column, peg.row))
    for old, pad in zip(triple.supports, found.supports, strict=True):
        plate = toolkit.find_carrier(pad.carrier)
        assert (pad.x, pad.y) == (old.x, old.y)
        assert plate.compute_hole_center(pad.column, pad.row, new.travel) == pytest.approx(
            new.pose.apply(pad.x, pad.y), abs=1e-9
        )
        assert 0 <= pad.column < (plate.columns or 10**9) and 0 <= pad.row < (plate.rows or 10**9)
        assert not plate.is_blocked(pad.column, pad.row)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", list(CASES))
def test_everything_has_a_hole_and_keeps_its_place(name: str) -> None:
    """Over the supports of the best fixtures of every kind of toolkit, also where jaws have to stand elsewhere."""
    toolkit, moved, count = CASES[name], 0, 0
    result = design(BLOCK, toolkit, best=2)
    for fixture in result:
        found = find_supports(fixture, result.query, REQUEST)
        for triple in found.triples[:20]:
            again = recount_holes(fixture, toolkit, triple)
            refuse_moved(fixture, toolkit, triple, again)
            count += 1
            moved += again.move != (0, 0) or again.fixture.travel != fixture.travel
            if toolkit.travel_count and toolkit.moving.has_lattice and triple.travel is not None:
                assert again.fixture.travel == pytest.approx(triple.travel, abs=1e-9)
    assert count > 0
    if name in ("vise", "narrow jaws"):
        assert moved > 0


@pytest.mark.thorough
@pytest.mark.parametrize("way", ["-x", "-y", "+x", "+y"])
def test_a_clamp_on_a_line_moves_along(way: str) -> None:
    """Where only the clamp's line is known, the tip is measured from the new first column or row."""
    fixture, _, plate = on_plate(way, bolted=False, endless=True)
    corner = fixture.pose.inverse.apply(*plate.carriers[0].compute_hole_center(-2, -1))
    pads = [SupportPad("plate", -2, -1, *map(float, corner))]
    for cell in ((3, 2), (4, 1)):
        x, y = fixture.pose.inverse.apply(*plate.carriers[0].compute_hole_center(*cell))
        pads.append(SupportPad("plate", *cell, float(x), float(y)))
    triple = evolve(any_triple(), supports=tuple(pads))
    again = recount_holes(fixture, plate, triple)
    assert (again.columns, again.rows) == (2, 1)
    refuse_moved(fixture, plate, triple, again)


def any_triple() -> Triple:
    """A triple of the block on the endless plate."""
    result = design(BLOCK, CASES["endless plate"], best=1)
    return find_supports(result[0], result.query, REQUEST, best=1).triples[0]


@pytest.mark.thorough
def test_a_set_that_stands_as_listed_is_not_moved() -> None:
    """Nothing has another name where every support has one."""
    fixture, _, plate = on_plate(endless=True)
    x, y = fixture.pose.inverse.apply(*plate.carriers[0].compute_hole_center(3, 2))
    pads = (SupportPad("plate", 3, 2, float(x), float(y)),) * 3
    again = recount_holes(fixture, plate, evolve(any_triple(), supports=pads))
    assert again.move == (0, 0) and again.fixture == fixture and again.supports == pads


@pytest.mark.thorough
def test_sets_that_there_are_not_are_refused() -> None:
    """A number beyond the list, and supports that fit nowhere, are sentences."""
    toolkit = CASES["endless plate"]
    result = design(BLOCK, toolkit, best=1)
    found = find_supports(result[0], result.query, REQUEST, best=2)
    assert ChosenSupports.from_supports(found, 2).triple == found.triples[1]
    for number in (0, 3):
        with pytest.raises(InputError, match=f"there is no set {number} of supports: 2 are listed"):
            ChosenSupports.from_supports(found, number)
    with pytest.raises(InputError, match="there is no set of three"):
        ChosenSupports.from_supports(evolve(found, triples=()))
    far = evolve(
        found.triples[0],
        supports=tuple(evolve(pad, column=pad.column + 9) for pad in found.triples[0].supports),
    )
    with pytest.raises(InputError, match="have no holes"):
        recount_holes(result[0], evolve(toolkit, columns=5, rows=5), far)
    assert isinstance(found.query, Query)


def test_moves_are_those_with_the_fewest_steps_first() -> None:
    """All columns and rows up to the farthest, in order of steps, and of columns and rows among equal ones."""
    ways = range(-FARTHEST, FARTHEST + 1)
    every = sorted(product(ways, ways), key=lambda move: (abs(move[0]) + abs(move[1]), move))
    assert list(iterate_moves(CASES["endless plate"], (0, 0))) == every
