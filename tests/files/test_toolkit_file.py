"""Vises by name and from files: every figure in mm, every preset with a source, every slip one sentence."""

from __future__ import annotations

import re
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from workhold import Plate, Tolerance, Vise
from workhold.errors import InputError
from workhold.files.input_forms import check_toolkit_entries
from workhold.files.toolkit_file import find_dowel_size, list_preset_names, load_dowel_series, load_toolkit

OWN: dict[str, Any] = {"unit": '"mm"', "pitch": "20", "columns": "2", "peg_radius": "3"}


def write(folder: Path, entries: dict[str, Any]) -> Path:
    """A vise file of entries as they stand in TOML."""
    path = folder / "jaws.toml"
    path.write_text("".join(f"{key} = {value}\n" for key, value in entries.items()))
    return path


@pytest.mark.parametrize("name", list_preset_names())
def test_presets_are_toolkits_with_a_source(name: str) -> None:
    """Each makes a toolkit, has words and a source, and passes the checks that a user's file has to pass."""
    loaded = load_toolkit(name)
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)+", name)
    assert loaded.name == name
    assert loaded.title and loaded.source
    # "plate" in a name does not tell whether jaws or clamps press against its dowels.
    assert isinstance(loaded.toolkit, Vise) == loaded.title.startswith(("vise, ", "the paper's"))
    assert getattr(loaded.toolkit, "rows", None) is None
    content = tomllib.loads((files("workhold") / "data" / "toolkits" / f"{name}.toml").read_text())
    assert check_toolkit_entries(content) == content
    assert 0 < loaded.tolerance.peg < 0.2 or loaded.toolkit.flat_jaws is not None
    assert loaded.tolerance.face == Tolerance().face


def test_figures_of_the_presets() -> None:
    """Pitch, peg diameter and columns as published, in mm; an inch is 25.4 mm."""
    figures = {
        name: load_toolkit(name).fields for name in list_preset_names() if load_toolkit(name).toolkit.plates
    }
    told = {name: (f["pitch"], 2 * f["peg_radius"], f.get("columns")) for name, f in figures.items()}
    assert told == {
        "clamp-plate-20mm": ((20, 20), 6, None),
        "clamp-plate-one-inch": ((25.4, 25.4), 6.35, None),
        "clamp-table-50mm": ((50, 50), 16, None),
        "fence-20mm": ((20, 20), 6, None),
        "gripper-one-column": ((10, 10), 6, 1),
        "gripper-two-columns": ((10, 10), 6, 2),
        "machine-vise-4-inch": ((12.7, 12.7), 6.35, 7),
        "machine-vise-6-inch": ((12.7, 12.7), 6.35, 11),
        "plate-half-inch": ((12.7, 12.7), 6.35, 4),
        "plate-20mm": ((20, 20), 6, 3),
        "plate-25mm": ((25, 25), 6, 3),
        "plate-one-inch": ((25.4, 25.4), 6.35, 3),
        "strap-plate-20mm": ((20.0, 20.0), 6.0, None),
        "strap-plate-one-inch": ((25.4, 25.4), 6.35, None),
        "strap-table-50mm": ((50.0, 50.0), 16.0, None),
        "table-50mm": ((50, 50), 16, 2),
        "table-100mm": ((100, 100), 28, 2),
        "two-clamp-plate-20mm": ((20, 20), 6, None),
        "two-clamp-plate-one-inch": ((25.4, 25.4), 6.35, None),
    }


def test_tolerances_follow_from_pin_and_hole() -> None:
    """By hand: a pressed 6 mm pin at most 0.009 too wide, hole placed to the assumed 0.01; a 16 h7 pin in a D10 hole."""
    assert load_toolkit("plate-20mm").tolerance.peg == pytest.approx(0.009 / 2 + 0.01, abs=1e-12)
    assert load_toolkit("table-50mm").tolerance.peg == pytest.approx((0.138 + 0.018) / 2 + 0.05, abs=1e-12)
    assert load_toolkit("plate-one-inch").tolerance.peg == pytest.approx(0.0003 / 2 * 25.4 + 0.01, abs=1e-12)
    assert load_toolkit("gripper-one-column").tolerance == Tolerance()


def test_dowels_are_near_their_names_and_grow() -> None:
    """Pins within 0.03 mm of their nominal diameter, limits in order; the metric standards have the ten sizes 3 to 25."""
    for series in load_dowel_series():
        assert series.source
        for size in series.sizes:
            for limits in filter(None, (size.pin, size.hole)):
                assert limits[0] < limits[1]
                assert max(abs(limit - size.nominal) for limit in limits) < 0.034
        nominals = [round(size.nominal, 6) for size in series.sizes]
        assert nominals == sorted(set(nominals))
        if series.unit.name == "mm":
            assert nominals == [3, 4, 5, 6, 8, 10, 12, 16, 20, 25]


def test_widths_of_the_iso_classes() -> None:
    """IT6 and IT8 of ISO 286-1 in micrometres: 6, 8, 9, 11, 13 and 14, 18, 22, 27, 33 by range of diameters."""
    ranges = {3: (6, 14), 6: (8, 18), 10: (9, 22), 16: (11, 27), 25: (13, 33)}
    for diameter, (six, eight) in ranges.items():
        for name, width in (("ISO 2338 m6", six), ("iso  2338 h8", eight)):
            low, high = find_dowel_size(name, diameter).pin
            assert high - low == pytest.approx(width / 1000, abs=1e-9)


def test_a_file_in_inches(tmp_path: Path) -> None:
    """Every length of the file is in its unit, and comes out in mm; holes are blocked by name."""
    path = write(
        tmp_path,
        {
            "title": '"my jaws"',
            "unit": '"inch"',
            "pitch": "[1, 0.5]",
            "columns": "3",
            "rows": "9",
            "peg_radius": "0.125",
            "body_radius": "0.2",
            "min_gap": "0.5",
            "max_opening": "6",
            "row_offset": "-0.25",
            "blocked": '["L-A", "R-B3"]',
            "pin_diameter": "[0.2495, 0.25]",
            "hole_diameter": "[0.25, 0.2505]",
            "hole_position": "0.0005",
            "face_tolerance": "0.002",
        },
    )
    loaded = load_toolkit(path)
    assert loaded.fields == {
        "pitch": (25.4, 12.7),
        "columns": 3,
        "rows": 9,
        "peg_radius": 3.175,
        "body_radius": 5.08,
        "min_gap": 12.7,
        "max_opening": 152.4,
        "row_offset": -6.35,
        "blocked": ("L-A", "R-B3"),
    }
    # The smallest pin in the widest hole: 0.0010 of clearance and 0.0005 of size, halved.
    assert loaded.tolerance.peg == pytest.approx((0.00075 + 0.0005) * 25.4, abs=1e-8)
    assert loaded.tolerance.face == pytest.approx(0.002 * 25.4)
    assert (loaded.name, loaded.title, loaded.unit.name) == ("jaws", "my jaws", "inch")


def test_a_standard_gives_the_pin_and_the_file_the_hole(tmp_path: Path) -> None:
    """ISO 2338 recommends no hole; an entry of the file goes before the standard's; a plain tolerance before both."""
    pin = {**OWN, "dowel": '"iso 2338 H8"', "hole_diameter": "[6.0, 6.012]"}
    fit = load_toolkit(write(tmp_path, pin)).tolerance.fit
    assert fit is not None and (fit.pin, fit.hole) == ((5.982, 6.0), (6.0, 6.012))
    assert load_toolkit(write(tmp_path, {**pin, "peg_tolerance": "0.5"})).tolerance.peg == 0.5


def test_a_file_goes_before_a_preset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Unlike a folder, a file of a preset's name is meant; capitals of a preset do not matter."""
    monkeypatch.chdir(tmp_path)
    Path("table-50mm").mkdir()
    assert load_toolkit("Table-50MM").fields["pitch"] == (50, 50)
    write(tmp_path, OWN).rename("plate-25mm")
    assert load_toolkit("plate-25mm").fields["pitch"] == (20, 20)


WITHOUT = object()
BAD = [
    ({"unit": WITHOUT}, 'unit is missing: write unit = "mm" or unit = "inch"'),
    ({"pitch": WITHOUT}, "pitch is missing: write the distance between holes"),
    ({"unit": '"ell"'}, "Unit 'ell' is not known"),
    ({"unit": '"m"'}, 'the unit of a toolkit is "mm" or "inch"'),
    ({"pitch": '"20"'}, "pitch is not what it should be"),
    ({"pitch": "[20]"}, "pitch is not what it should be"),
    ({"pitch": "nan"}, "pitch is not what it should be"),
    ({"pitch": "-20"}, "pitch -20.0 is not a positive length"),
    ({"columns": "2.5"}, "columns is not what it should be: write how many"),
    ({"rows": '"many"'}, "rows is not what it should be: write a whole number"),
    ({"max_opening": "inf"}, "max_opening is not what it should be: write a finite number"),
    ({"title": "3"}, "title is not what it should be: write text in quotes"),
    ({"peg_radius": "11"}, "pegs of radius 11 overlap"),
    ({"colums": "3"}, '"colums" is not an entry of a vise: did you mean columns?'),
    ({"weight": "3"}, '"weight" is not an entry of a vise: the entries are unit, kind, pitch'),
    ({"blocked": '["B3"]'}, "'B3' names no hole"),
    ({"blocked": '["L-C1"]'}, "hole L-C1 is blocked, but each jaw has only 2 columns"),
    ({"blocked": "[3]"}, "blocked is not what it should be"),
    ({"dowel": '"DIN 1"'}, 'dowel "DIN 1" is not known: the standards are ASME B18.8.5M'),
    ({"dowel": '"ASME B18.8.2"'}, "ASME B18.8.2 has no dowel of 0.2362 in: its sizes are 0.125, "),
    ({"dowel": '"ISO 2338 m6"'}, "the pin is given without its hole"),
    ({"hole_diameter": "[6, 6.012]"}, "hole_diameter is given without the pin"),
    ({"hole_position": "0.02"}, "hole_position is given without the pin"),
    (
        {"pin_diameter": "[3, 3.01]", "hole_diameter": "[6, 6.01]"},
        "pin_diameter 3 to 3.01 mm is not that of a peg",
    ),
    ({"dowel": '"ASME B18.8.5M"', "hole_position": "-1"}, "hole_position -1 is negative"),
    ({"peg_tolerance": "-1"}, "peg tolerance -1.0 is not a length"),
    ({"pitch": ""}, "the file is not valid TOML: invalid value"),
]


@pytest.mark.parametrize(("change", "message"), BAD)
def test_bad_files_are_one_sentence_with_the_file_and_the_entry(
    tmp_path: Path, change: dict[str, Any], message: str
) -> None:
    entries = {key: value for key, value in (OWN | change).items() if value is not WITHOUT}
    with pytest.raises(InputError) as caught:
        load_toolkit(write(tmp_path, entries))
    told = str(caught.value)
    assert told.startswith("jaws.toml: ")
    assert message in told
    assert "\n" not in told and told.endswith((".", "?"))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("plate-20", "'plate-20': file not found, and no toolkit has that name (try plate-20mm, "),
        ("welding", "(try clamp-plate-20mm, clamp-plate-one-inch, clamp-table-50mm, "),
        ("", "'': file not found"),
        ("jaws.toml", "'jaws.toml': file not found"),
        (".", ".: this is not a file"),
    ],
)
def test_unknown_vises_come_with_names_that_are_near(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError) as caught:
        load_toolkit(name)
    assert message in str(caught.value)


def test_binary_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "jaws.toml"
    path.write_bytes(b"pitch = \xff")
    with pytest.raises(InputError, match=r"jaws\.toml: the file is not UTF-8 text \(byte 8, line 1\)"):
        load_toolkit(path)


def test_two_clamps_in_a_file(tmp_path: Path) -> None:
    """Pairs of directions are written as pairs, single ones stand for all pairs; what is neither is refused."""
    path = tmp_path / "own.toml"
    lines = 'unit = "mm"\nkind = "plate"\npitch = 20\npeg_radius = 3\nclamps = {}\ndirections = {}\n'
    for directions, told in (('[["-x", "-y"]]', (("-x", "-y"),)), ('["-x"]', (("-x", "-x"),))):
        path.write_text(lines.format(2, directions))
        toolkit = load_toolkit(path).toolkit
        assert isinstance(toolkit, Plate) and toolkit.directions == told
    for clamps, directions, message in (
        (2, '[["-x"]]', "directions is not what it should be"),
        (1, '[["-x", "-y"]]', "there is one clamp"),
        (3, '["-x"]', "1 or 2"),
        ('"two"', '["-x"]', "clamps is not what it should be: write 1 or 2."),
    ):
        path.write_text(lines.format(clamps, directions))
        with pytest.raises(InputError, match=message):
            load_toolkit(path)
