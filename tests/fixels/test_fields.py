"""The table of fields says what constructors take, and each form of a toolkit that is made from it gives the same one."""

from __future__ import annotations

import json
from typing import Any

import pytest
from attrs import NOTHING, fields, fields_dict

import manual
from toolkit_values import VALUES, given
from workhold.cli.catalogue_commands import list_own_figures
from workhold.cli.toolkit_options import ToolkitListOptions, ToolkitOptions, list_toolkits_to_try
from workhold.errors import InputError
from workhold.files.input_forms import check_toolkit_entries
from workhold.files.toolkit_file import list_preset_names, load_toolkit, make_described_toolkit
from workhold.fixels.fields import OPTIONS
from workhold.fixels.kinds import KINDS, TABLES, USUAL, find_owner, find_table, make_toolkit
from workhold.fixels.support_hardware import HARDWARE
from workhold.units import MILLIMETRE, find_unit
from workhold.web.forms import FORMS
from workhold.web.toolkits import list_page_fields


def typed(**words: Any) -> ToolkitOptions:
    """What the command hands on where only these words were typed."""
    return ToolkitOptions(**{one.name: None for one in fields(ToolkitOptions)} | words)


def typed_of(kind: str) -> dict[str, Any]:
    """The words for a kind with a value of each of its fields."""
    return {"toolkit": kind} | {row.name: VALUES[row.name][1] for row in find_table(kind).fields}


def test_every_kind_has_a_table_of_its_constructors_fields() -> None:
    """Names, and which must be given; what may be left out is what the constructor takes for nothing given. Beside them and
    the hardware there is only the tolerance, which makes no other toolkit."""
    assert TABLES.keys() == KINDS.keys() and USUAL in KINDS
    for kind, table in TABLES.items():
        taken = fields_dict(KINDS[kind])  # type: ignore[arg-type]
        rows = {row.name: row for row in table.fields}
        others = HARDWARE.keys() | {"tolerance"}
        assert rows.keys() | others == taken.keys() and not rows.keys() & others
        assert [name for name, one in taken.items() if not one.eq] == ["tolerance"]
        assert {name for name, row in rows.items() if row.is_required} == {
            name for name, one in taken.items() if one.default is NOTHING
        }
        needed = {name: VALUES[name][0] for name, row in rows.items() if row.is_required}
        defaults = {name: row.default for name, row in rows.items() if not row.is_required}
        assert make_toolkit(kind, needed | defaults) == make_toolkit(kind, needed)
        assert all(row.missing for row in table.fields if row.is_required)


def test_every_field_is_an_option_and_belongs_to_a_part_unless_all_have_it() -> None:
    """An option for each, and a word for what other kinds lack."""
    every = {row.name for table in TABLES.values() for row in table.fields}
    assert [row.name for row in OPTIONS] == list(dict.fromkeys(row.name for row in OPTIONS))
    assert {row.name for row in OPTIONS} == every == VALUES.keys()
    for row in OPTIONS:
        lacking = [table for table in TABLES.values() if row.name not in {one.name for one in table.fields}]
        assert bool(lacking) == bool(row.belongs_to), row.name


@pytest.mark.parametrize("kind", KINDS)
def test_all_forms_of_a_toolkit_say_the_same(kind: str) -> None:
    """Of a TOML file, in two units; of a result file; of a request; and of the command's options."""
    toolkit = make_toolkit(kind, given(kind))
    entries = json.loads(json.dumps(given(kind)))
    assert (
        make_described_toolkit("x", check_toolkit_entries({"unit": "mm", "kind": kind, **entries})).toolkit
        == toolkit
    )
    inch = find_unit("inch").to_mm(1.0)
    halved = {
        row.name: [one / inch for one in value] if isinstance(value, list) else value / inch
        for row in find_table(kind).fields
        if row.form in ("length", "pitch", "span", "flat", "lengths")
        for value in [entries[row.name]]
    }
    again = make_described_toolkit(
        "x", check_toolkit_entries({"unit": "inch", "kind": kind, **entries, **halved})
    ).toolkit
    for row in find_table(kind).fields:
        one, other = getattr(again, row.name), getattr(toolkit, row.name)
        if row.form in ("length", "pitch", "span"):
            assert one == pytest.approx(other, abs=1e-12)
    assert FORMS[find_table(kind).noun].model_validate({"kind": kind, **entries}).to_toolkit() == toolkit
    assert typed(**typed_of(kind)).read_toolkit(MILLIMETRE)[0] == toolkit


@pytest.mark.parametrize("kind", KINDS)
def test_an_option_of_another_kind_is_refused_by_its_name(kind: str) -> None:
    """With the kind that has it."""
    for row in OPTIONS:
        if row.name in given(kind):
            continue
        with pytest.raises(
            InputError, match=f"{row.option} is of {find_owner(row).noun}s: a .* has no {row.belongs_to}"
        ):
            typed(**typed_of(kind) | {row.name: VALUES[row.name][1]}).read_toolkit(MILLIMETRE)


@pytest.mark.parametrize("kind", KINDS)
def test_what_must_be_given_is_asked_for_in_each_form(kind: str) -> None:
    """A sentence that names the entry or the option."""
    for row in find_table(kind).fields:
        if not row.is_required:
            continue
        entries = json.loads(json.dumps(given(kind)))
        del entries[row.name]
        with pytest.raises(InputError, match=f"{row.name} is missing: write"):
            check_toolkit_entries({"unit": "mm", "kind": kind, **entries})
        with pytest.raises(InputError, match=f"{row.missing} is not given: add {row.option},"):
            typed(**typed_of(kind) | {row.name: None}).read_toolkit(MILLIMETRE)


def test_a_span_is_two_lengths() -> None:
    """Less or more is refused with the option's name."""
    for text in ("10", "10,20,30"):
        with pytest.raises(InputError, match=f"--travel '{text}' is not two lengths"):
            typed(travel=text).read_given_fields(MILLIMETRE)


def test_an_option_that_is_not_given_changes_nothing() -> None:
    """Neither None nor a list of no holes, as the command hands it on."""
    assert typed(blocked=[]).read_given_fields(MILLIMETRE) == {}


def test_the_page_reads_each_form_by_a_field_that_it_has() -> None:
    """A flat is typed as the one length that a page asks for; what has choices is chosen."""
    forms = {row.name: {one.form for one in list_page_fields(row)} for row in OPTIONS}
    assert forms["flat"] == {"length"} and forms["clamps"] == {"one"} and forms["directions"] == {"several"}
    assert set().union(*forms.values()) == {
        "length", "count", "pitch", "span", "holes", "several", "one", "lengths", "force"
    }  # fmt: skip


def test_a_list_of_pitches_makes_toolkits_of_which_all_that_is_needed_is_given() -> None:
    """A gripper's name says its columns, and a plate needs none; a vise without them is refused."""
    varied = ToolkitListOptions(pitch="10", peg_radius="3")
    for kind, said in (("gripper", 1), ("plate", None)):
        (one,) = list_toolkits_to_try(None, kind, varied, MILLIMETRE)
        assert one.fields.get("columns") == said
    with pytest.raises(InputError, match="these lists alone make no vise: give --columns too"):
        list_toolkits_to_try(None, "vise", varied, MILLIMETRE)


def test_a_kind_picks_the_presets_that_have_its_fields() -> None:
    """A vise that opens is made of vises, and of no plate."""
    picked = list_toolkits_to_try(None, "opening-vise", ToolkitListOptions(), MILLIMETRE)
    assert {one.name for one in picked} == {
        name
        for name in list_preset_names()
        if find_table(load_toolkit(name).kind) is find_table("opening-vise")
    }


def test_figures_of_a_toolkit_are_those_that_are_not_usual() -> None:
    """With a word where no source gives them, and one where there is no limit."""
    entries = {"unit": "mm", "kind": "plate", "pitch": 20, "peg_radius": 3, "assumed": ["clamp_radius"]}
    assert list(list_own_figures(make_described_toolkit("x", entries), MILLIMETRE)) == [
        ("radius of the clamp's tip", "3 mm (assumed: no source says)"),
        ("from the clamp's hole to its tip", "any"),
        ("the part is pushed along", "-x"),
    ]


# The manual's tables of fields come from the fields of the kinds.
def test_each_field_of_each_kind_stands_in_the_manual_with_its_option_and_help() -> None:
    """A row for each field below the name of its kind, and a cell for each heading."""
    parts = manual.on_page_markdown("::: toolkits").split("### ")[1:]
    assert len(parts) == len(TABLES)
    tables = {tuple(row.name for row in table.fields): table for table in TABLES.values()}
    for part in parts:
        lines = [line for line in part.splitlines() if line.startswith("|")]
        names = tuple(line.split("`")[1] for line in lines[2:])
        for row, line in zip(tables[names].fields, lines[2:], strict=True):
            cells = [cell.strip() for cell in line.replace("\\|", "/").strip("|").split("|")]
            assert len(cells) == 5 and cells[1] == f"`{row.option}`"
            assert (cells[3] == "must be given") == row.is_required
            assert cells[4].split()[0] == row.help.split()[0] and "{" not in cells[4]
