"""Toolkits whose fields are varied: every number of every kind's field table, and refusals in a sentence."""

from __future__ import annotations

from typing import Any

import pytest

from workhold.cli.toolkit_options import LISTED, ToolkitListOptions, list_toolkits_to_try
from workhold.errors import InputError
from workhold.files.toolkit_file import list_preset_names, load_toolkit
from workhold.fixels.fields import OPTIONS
from workhold.fixels.kinds import KINDS, TABLES, make_toolkit
from workhold.units import INCH, MILLIMETRE

# A list that each form of field can have, and what becomes of it in mm.
TYPED = {
    "pitch": ("20,25x30", [(20.0, 20.0), (25.0, 30.0)]),
    "count": ("1,2", [1, 2]),
    "length": ("50,60", [50.0, 60.0]),
    "span": ("10:35,15:50", [(10.0, 35.0), (15.0, 50.0)]),
    "flat": ("2.5,2.5:1.5", [(2.5,), (2.5, 1.5)]),
}
NEEDED = {"pitch": "40", "jaw_width": "152", "columns": "2", "peg_radius": "3", "wall_offset": "10"}
VARIED = [(kind, row) for kind, table in TABLES.items() for row in table.fields if row.form in TYPED]


def has_pitch(kind: str) -> bool:
    """Whether toolkits of a kind have holes at a pitch."""
    return any(row.name == "pitch" for row in TABLES[kind].fields)


def lists(kind: str, **more: str) -> ToolkitListOptions:
    """Lists that make toolkits of a kind."""
    needed = {row.name: NEEDED[row.name] for row in TABLES[kind].fields if row.is_required}
    pitch = {"pitch": NEEDED["pitch"]} if has_pitch(kind) else {}
    return ToolkitListOptions(**{**pitch, **needed, **more})


def test_every_number_of_every_kind_can_be_varied() -> None:
    """Only names of holes, directions, sides, sets of parallels and forces cannot."""
    # A part is read once, and so for one pair of heights.
    heights = {row.name for row in OPTIONS if row.form == "heights"}
    assert {row.name for row in OPTIONS} - {row.name for row in LISTED} == {
        "blocked",
        "directions",
        "parallels",
        "stop",
        "over",
        "max_force",
        *heights,
    }
    assert {row.name for _, row in VARIED} == {row.name for row in LISTED}


@pytest.mark.parametrize(("kind", "row"), VARIED, ids=[f"{kind} {row.name}" for kind, row in VARIED])
def test_a_field_of_a_kind_is_varied(kind: str, row: Any) -> None:
    """Each entry makes a toolkit that differs from the others in this field and in its name.

    Of a kind without holes it makes one of each preset.
    """
    text, values = TYPED[row.form]
    tried = list_toolkits_to_try(None, kind, lists(kind, **{row.name: text}), MILLIMETRE)
    bases = 1 if has_pitch(kind) else sum(load_toolkit(name).kind == kind for name in list_preset_names())
    assert [one.fields[row.name] for one in tried] == bases * values
    assert len({one.name for one in tried}) == 2 * bases > 0 and {one.kind for one in tried} == {kind}


@pytest.mark.parametrize(
    ("kind", "more"), [("edge", {"wall_offset": "8,12"}), ("translating-clamp", {"clamps": "1,2"})]
)
def test_what_is_varied_makes_toolkits(kind: str, more: dict[str, str]) -> None:
    """A fence with two offsets of its wall, and a plate with one clamp and with two."""
    tried = list_toolkits_to_try(None, kind, lists(kind, clamp_radius="3,5", **more), MILLIMETRE)
    assert len({make_toolkit(one.kind, one.fields) for one in tried}) == 4


def test_lengths_have_the_unit_that_is_asked() -> None:
    """Half an inch is 12.7 mm."""
    (one,) = list_toolkits_to_try(["fence-20mm"], None, ToolkitListOptions(wall_offset="0.5"), INCH)
    assert one.fields["wall_offset"] == pytest.approx(12.7) and one.name == "fence-20mm, wall offset 0.5"


def test_presets_without_a_varied_field_are_not_tried() -> None:
    """A wall's offset is varied of the fence among the presets alone."""
    tried = list_toolkits_to_try(None, None, ToolkitListOptions(wall_offset="8,10"), MILLIMETRE)
    assert [one.name for one in tried] == ["fence-20mm, wall offset 8", "fence-20mm, wall offset 10"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_field_that_a_kind_does_not_have_is_refused(kind: str) -> None:
    """In one sentence that names the option, for a kind that is made of lists and for one that is named."""
    known = {row.name for row in TABLES[kind].fields}
    for row in LISTED:
        if row.name not in known:
            with pytest.raises(InputError, match=rf"^{row.option} is of \w.*{TABLES[kind].noun} has no \w"):
                list_toolkits_to_try(None, kind, lists(kind, **{row.name: TYPED[row.form][0]}), MILLIMETRE)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--toolkit", "fence", "--pitch", "20"), "makes no fence: give --peg-radius and --wall-offset too"),
        (("--vise", "plate-20mm", "--wall-offset", "8"), "--wall-offset is of fences: a vise has no wall"),
        (("--toolkit", "vise", "--clamps", "2"), "--clamps is of plates: a vise has no clamp"),
        (("--clamps", "3"), "--clamps 3 is not known: give 1 or 2"),
        (("--travel", "10,20"), "the least and the most with a colon"),
        (("--wall-offset", "8,x"), "--wall-offset 'x' is not a length"),
        (("--clamps", "1", "--max-opening", "50"), "with all of the fields to vary"),
        (("--row-offset", "1,,2"), "has an empty entry"),
    ],
)
def test_explore_refuses_lists_in_a_sentence(run: Any, words: tuple[str, ...], message: str) -> None:
    """Exit code 2 before any search."""
    outcome = run("explore", "widget", *words)
    assert outcome.exit_code == 2
    assert message in outcome.stderr and outcome.stderr.count("\n") == 1
