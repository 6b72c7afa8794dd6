"""Constructors are made from the table of fields: defaults, bounds and limits are those of each row. Kinds have names."""

from __future__ import annotations

from itertools import product
from math import inf, nan
from typing import Any

import pytest
from attrs import fields_dict

from toolkit_values import given
from workhold import Plate, Vise
from workhold.errors import InputError
from workhold.fixels.kinds import KINDS, TABLES, make_toolkit
from workhold.fixels.table import ToolkitField
from workhold.fixels.toolkit import Toolkit
from workhold.limits import MOST_LENGTH

ROWS = [
    pytest.param(kind, row, id=f"{kind}-{row.name}") for kind, table in TABLES.items() for row in table.fields
]
LENGTHS = [one for one in ROWS if one.values[1].form == "length"]


def made(kind: str, **changes: Any) -> Toolkit:
    """A toolkit with a value of every field, some of them changed."""
    return make_toolkit(kind, given(kind) | changes)


@pytest.mark.parametrize(("kind", "row"), LENGTHS)
def test_a_length_out_of_its_bounds_is_refused_by_its_name(kind: str, row: ToolkitField) -> None:
    """No number, infinite, below what the row says, and beyond what can be reckoned with."""
    low = {"above 0": [0.0, -1.0], "0": [-1e-9], "any": []}[row.least]
    # Pegs as fat as that overlap.
    long = [] if row.name == "peg_radius" else [2 * MOST_LENGTH]
    for value in [nan, inf, "many", *low, *long]:
        with pytest.raises(InputError, match=f"^{row.words} "):
            made(kind, **{row.name: value})
    if row.least == "any":
        assert getattr(made(kind, **{row.name: -1.5}), row.name) == -1.5


@pytest.mark.parametrize(("kind", "row"), [one for one in ROWS if one.values[1].at_least])
def test_what_is_below_another_field_is_refused_and_what_meets_it_is_not(
    kind: str, row: ToolkitField
) -> None:
    """The sentence names both values."""
    least = getattr(made(kind), row.at_least)
    assert getattr(made(kind, **{row.name: least}), row.name) == least
    with pytest.raises(InputError) as refusal:
        made(kind, **{row.name: least - 0.25})
    assert f"{least - 0.25:g}" in str(refusal.value) and f"{least:g}" in str(refusal.value)


@pytest.mark.parametrize(("kind", "row"), [one for one in ROWS if one.values[1].follows])
def test_a_length_that_is_not_given_is_the_one_that_it_follows(kind: str, row: ToolkitField) -> None:
    """The pitch in x of a pitch; whatever else is given."""
    leader = getattr(made(kind), row.follows)
    expected = leader[0] if isinstance(leader, tuple) else leader
    assert getattr(made(kind, **{row.name: None}), row.name) == expected != getattr(made(kind), row.name)


@pytest.mark.parametrize("kind", KINDS)
def test_limits_are_those_of_the_rows_and_each_is_lifted_alone(kind: str) -> None:
    """In the order of bodies, travel, reach and holes; without all of them the toolkit has none. Columns without end, beside
    which jaws cannot end, take the width of these away as well."""
    toolkit = made(kind)
    limited = [row for row in TABLES[kind].fields if row.lifted is not None]
    assert {limit.rule for limit in toolkit.limits} == {row.lifted.rule for row in limited if row.lifted}
    order = [("bodies", "travel", "reach", "holes").index(limit.bounds) for limit in toolkit.limits]
    assert order == sorted(order)
    for limit in toolkit.limits:
        (name, *others), lifted = limit.lifted.fields, toolkit.without_limits([limit])
        goes_along = name == "columns" and "jaw_width" in fields_dict(type(toolkit))
        assert others == (["jaw_width"] if goes_along else [])
        gone = {row.lifted.rule for row in limited if row.lifted and row.name in limit.lifted.fields}
        assert limit.rule in gone and len(gone) == 1 + len(others)
        assert [one.rule for one in lifted.limits] == [
            one.rule for one in toolkit.limits if one.rule not in gone
        ]
        assert made(kind, **limit.lifted.fields) == lifted
        # Others stay lifted as they were, but for what went along.
        kept = {one.rule: one.lifted.fields for one in toolkit.limits}
        for one in lifted.limits:
            assert one.lifted.fields == {
                field: value for field, value in kept[one.rule].items() if field not in limit.lifted.fields
            }
    assert toolkit.without_limits(toolkit.limits).limits == ()


@pytest.mark.parametrize(("kind", "row"), [one for one in ROWS if one.values[1].allowed])
def test_only_the_allowed_counts_are_taken(kind: str, row: ToolkitField) -> None:
    """Others are refused with those that there are."""
    for count in (0, row.allowed[-1] + 1, 1.5, None):
        with pytest.raises(InputError, match=f"^{row.words} {count} cannot be: .* has {row.allowed[0]} or "):
            made(kind, **{row.name: count})


def test_values_of_each_form_are_taken_as_people_write_them() -> None:
    """One pitch for both directions, whole numbers as floats, a flat by its distance, a direction by itself."""
    for pitch, columns in product((20, [20.0, 20.0]), (8, 8.0)):
        plate = make_toolkit(
            "plate", {"pitch": pitch, "peg_radius": 3, "columns": columns, "directions": "+y", "flat": 3}
        )
        assert (plate.pitch, plate.columns, plate.directions) == ((20.0, 20.0), 8, ("+y",))  # type: ignore[attr-defined]
        assert isinstance(plate.columns, int)  # type: ignore[attr-defined]
    with pytest.raises(InputError, match=r"travel .* is not two lengths"):
        made("translating-clamp", travel=10)
    with pytest.raises(InputError, match="travel 41 to 11 is not possible"):
        made("translating-clamp", travel=(41, 11))


def test_blocked_holes_must_be_there_and_leave_some() -> None:
    """Names of columns and rows that the jaws have; at least one column of each jaw is free."""
    for names, words in (
        (["L-D1"], "each jaw has only 3 columns"),
        (["R-A8"], "each jaw has only 7 rows"),
        (["L-A", "L-B", "L-C"], "every column of the left jaw is blocked"),
        (["R-A"] * 20_001, "20,001 blocked holes are more than the 20,000"),
    ):
        with pytest.raises(InputError, match=words):
            made("vise", blocked=names)
    spread = made("vise", blocked=["L-A", "L-B", "R-C"])
    assert [holes.name for holes in spread.blocked] == ["L-A", "L-B", "R-C"]  # type: ignore[attr-defined]


def test_what_is_too_large_to_reckon_with_is_refused() -> None:
    """A pitch, a stroke, and more holes than can be looked through."""
    for changes, words in (
        ({"pitch": (20, 2 * MOST_LENGTH)}, "^pitch"),
        ({"travel": (0, 2 * MOST_LENGTH)}, "^travel"),
        ({"columns": 1000, "rows": 1000}, "a plate of 1,000,000 holes"),
    ):
        with pytest.raises(InputError, match=words):
            made("translating-clamp", **changes)


def test_a_flat_is_as_wide_as_its_peg_lets_it_be_and_given_by_name() -> None:
    """A chord of the peg at its distance; positions are of what all kinds have."""
    vise = KINDS["vise"](10, 2, 5, flat=3)
    assert vise.flat.half_width == 4.0  # type: ignore[attr-defined]
    with pytest.raises(InputError, match="cannot have a flat"):
        KINDS["vise"](10, 2, 5, flat=5.5)
    with pytest.raises(TypeError):
        KINDS["vise"](10, 2, 5, None, 10, None, 0, 5, (), 3)


def test_aliases_are_kinds_with_fields_of_their_own() -> None:
    """A gripper is a vise of one column, and a plate needs no columns."""
    assert make_toolkit("gripper", {"pitch": 10, "peg_radius": 3}) == Vise(pitch=10, columns=1, peg_radius=3)
    assert make_toolkit("plate", {"pitch": 10, "peg_radius": 3}) == Plate(pitch=10, peg_radius=3)


@pytest.mark.parametrize(
    ("kind", "fields", "words"),
    [
        ("plate", {"pitch": 10, "peg_radius": 3, "min_gap": 6}, "has no min gap"),
        ("vise", {"pitch": 10, "peg_radius": 3, "columns": 1, "travel": (1, 2)}, "has no travel"),
        ("vise", {"pitch": 10, "peg_radius": 3}, "the vise's columns is not given"),
        (
            "edge of nowhere",
            {},
            "is not known: choose among vise, opening-vise, translating-clamp, edge, flat-jaw, plain-vise, strapped",
        ),
    ],
)
def test_what_a_kind_does_not_have_is_refused_in_one_sentence(
    kind: str, fields: dict[str, object], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        make_toolkit(kind, fields)
