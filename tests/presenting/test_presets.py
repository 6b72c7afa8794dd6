"""Toolkits by name from Python."""

from __future__ import annotations

from pathlib import Path

import pytest

import workhold
from workhold import Query
from workhold.errors import InputError
from workhold.files.toolkit_file import list_preset_names, load_toolkit

CLASSES = (
    workhold.Vise,
    workhold.Plate,
    workhold.Fence,
    workhold.FlatJaw,
    workhold.PlainVise,
    workhold.StrapPlate,
)


def test_every_preset_is_one_of_its_class_alone() -> None:
    """The same toolkit as the command line has by that name."""
    listed = [(kind, name) for kind in CLASSES for name in kind.presets()]
    assert sorted(name for _, name in listed) == sorted(list_preset_names())
    for kind, name in listed:
        assert kind.preset(name) == load_toolkit(name).toolkit
        assert workhold.Tolerance.preset(name) == load_toolkit(name).tolerance


def test_a_preset_brings_its_tolerance_to_a_query() -> None:
    """As the command line has it; pegs of another radius are as good as nobody says, and a tolerance given wins."""
    part = workhold.Workpiece.from_points("plate", [(0, 0), (300, 0), (300, 200), (0, 210)])
    table, own = workhold.Vise.preset("table-50mm"), load_toolkit("table-50mm").tolerance
    assert own.peg > 0.1
    for toolkit in (table, load_toolkit("table-50mm").toolkit, table.with_fields({"columns": 3})):
        assert Query(part, toolkit).tolerance == own
    for toolkit in (
        table.with_fields({"peg_radius": 7.0}),
        workhold.Vise.preset("table-50mm", peg_radius=7.0),
    ):
        assert Query(part, toolkit).tolerance == workhold.Tolerance()
    assert Query(part, table, tolerance=workhold.Tolerance(0.02)).tolerance.peg == 0.02


def test_fields_can_be_changed() -> None:
    assert workhold.Vise.preset("plate-20mm", columns=5, rows=4).rows == 4
    assert workhold.OpeningVise.preset("plate-20mm").clamping == -1
    assert workhold.Fence.preset("clamp-plate-20mm", wall_offset=10).clamp_radius == 5.0


def test_a_file_of_ones_own_is_a_preset_too(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text('unit = "mm"\npitch = 12\ncolumns = 2\npeg_radius = 2\n')
    assert workhold.Vise.preset(str(tmp_path / "mine.toml")).pitch == (12.0, 12.0)


@pytest.mark.parametrize(
    ("kind", "name", "changes", "words"),
    [
        (workhold.Vise, "clamp-plate-20mm", {}, "clamp-plate-20mm is a plate: ask Plate.preset for it"),
        (workhold.Plate, "fence-20mm", {}, "fence-20mm is a fence: ask Fence.preset for it"),
        (workhold.Vise, "plate-20", {}, "no toolkit has that name .try plate-20mm"),
        (workhold.Vise, "plate-20mm", {"colums": 2}, "Vise cannot be made of .*colums"),
        (workhold.Fence, "clamp-plate-20mm", {}, "wall_offset"),
    ],
)
def test_what_is_no_preset_is_told_in_a_sentence(
    kind: type[workhold.Vise], name: str, changes: dict[str, int], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        kind.preset(name, **changes)
