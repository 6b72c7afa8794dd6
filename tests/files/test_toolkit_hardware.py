"""Supports, the clamp on top and limits of pins of a toolkit's file are the usual ones of what is asked, and kept."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from attrs import evolve
from typer.testing import CliRunner
from typer.testing import Result as Outcome

import workhold
from toolkit_values import given
from workhold import Plate, Workpiece
from workhold.cli.main import app
from workhold.errors import InputError
from workhold.files.result.writer import make_toolkit_entry, make_toolkit_fields
from workhold.files.toolkit_file import LoadedToolkit, load_toolkit
from workhold.fixels.kinds import KINDS, find_table, make_toolkit
from workhold.fixels.support_hardware import HARDWARE, PinLimits, SupportPads, TopClamp
from workhold.model.support_request import SupportRequest
from workhold.web.forms import FORMS

Run = Callable[..., Outcome]
KITE = Workpiece.from_loops("kite", [[[0, 0, 0], [70, -8, 0.1], [88, 40, 0], [22, 66, 0]]])
PADS = SupportPads(pad_radius=3, pad_margin=1, height=12)
CLAMP = TopClamp(tip_radius=4, inside=6, reach=[[0, -30, 5, 290]])
HEAD = 'unit = "mm"\nkind = "plate"\npitch = 15\npeg_radius = 3\n'
TABLES = """[supports]
pad_radius = 3
pad_margin = 1
height = 12
[top-clamp]
tip_radius = 4
inside = 6
reach = [[0, -30, 5, 290]]
"""
EQUIPPED = Plate(pitch=15, peg_radius=3, supports=PADS, top_clamp=CLAMP)


def loaded(folder: Path, tables: str, head: str = HEAD) -> LoadedToolkit:
    """The toolkit of a file of some tables."""
    path = folder / "own.toml"
    path.write_text(head + tables)
    return load_toolkit(path)


def usual_of(toolkit: workhold.Plate) -> dict[str, Any]:
    """The figures of what is usual in a toolkit."""
    usual = SupportRequest.from_workpiece(KITE, 12, toolkit=toolkit)
    return {
        "pad_radius": usual.pad_radius,
        "pad_margin": usual.pad_margin,
        "tip_radius": usual.tip_radius,
        "inside": usual.inside,
        "reach": usual.reach,
    }


def test_a_file_says_what_supports_and_clamp_there_are_and_they_are_the_usual_ones(tmp_path: Path) -> None:
    """In mm whatever the file's unit; each figure by itself, and what is asked for comes first."""
    one = loaded(tmp_path, TABLES)
    assert one.toolkit == EQUIPPED
    shown = CliRunner().invoke(app, ["toolkits", str(tmp_path / "own.toml")]).stdout
    assert re.search(r"radius of the supports' pads +3 mm", shown)
    inch = loaded(
        tmp_path,
        "[supports]\nheight = 0.5\n[top-clamp]\nreach = [[0, 1, 1, 2]]\n",
        'unit = "inch"\npitch = 1\npeg_radius = 0.1\ncolumns = 2\n',
    )
    assert inch.toolkit.supports == SupportPads(height=12.7)
    assert inch.toolkit.top_clamp == TopClamp(reach=[[0, 25.4, 25.4, 50.8]])
    assert loaded(tmp_path, "[supports]\n").toolkit.top_clamp is None
    own = {"pad_radius": 3, "pad_margin": 1, "tip_radius": 4, "inside": 6, "reach": ((0, -30, 5, 290),)}
    assert usual_of(EQUIPPED) == own
    bare = {"pad_radius": 4, "pad_margin": 0, "tip_radius": 5, "inside": 5, "reach": None}
    assert usual_of(evolve(EQUIPPED, supports=None, top_clamp=None)) == bare
    only_tip = evolve(EQUIPPED, supports=SupportPads(height=3), top_clamp=TopClamp(tip_radius=2))
    assert usual_of(only_tip) == bare | {"tip_radius": 2, "inside": 2}
    asked = SupportRequest.from_workpiece(KITE, 12, toolkit=EQUIPPED, pad_radius=2, tip_radius=7)
    assert (asked.pad_radius, asked.tip_radius, asked.inside) == (2, 7, 6)


@pytest.mark.parametrize(
    ("tables", "sentence"),
    [
        (
            "[supports]\npad_width = 3\n",
            "supports: there is no 'pad_width': give some of pad_radius, pad_margin, ",
        ),
        (
            "[supports]\npad_radius = '3mm'\n",
            r"supports is not what it should be: write a table of numbers, such as",
        ),
        ("supports = 3\n", "supports is not what it should be: write a table of numbers"),
        ("[supports]\npad_radius = -1\n", "supports: pad radius -1 cannot be used: give 0 or more"),
        ("[supports]\nheight = 0\n", "supports: height 0 cannot be used: give a length above 0"),
        ("[supports]\nheight = 1e300\n", "supports: height"),
        (
            "[supports]\npad_radius = [[1, 2, 3, 4]]\n",
            "supports: pad radius cannot be used: give one num",
        ),
        (
            "[supports]\npad_radius = 8\n",
            "supports: pads of radius 8 mm would overlap in neighbouring holes 15 mm",
        ),
        ("[top-clamp]\ntip_radius = 0\n", "top-clamp: tip radius 0 cannot be used: give a length above 0"),
        ("[top-clamp]\nreach = 5\n", "top-clamp: reach cannot be used: give a list of rings"),
        (
            "[top-clamp]\nreach = [[0, 0, 9, 5]]\n",
            "top-clamp: reach is not a list of rings: give for each ring x, y",
        ),
        ("[top-clamp]\nreach = [[0, 0, 9]]\n", "top-clamp: reach is not a list of rings"),
        ("[top_clamp]\ntip_radius = 4\n", '"top_clamp" is not an entry of a plate: did you mean top-clamp?'),
        ("top-clamp = true\n", "top-clamp is not what it should be: write a table, such as"),
    ],
)
def test_what_cannot_be_is_refused_with_place_and_remedy(tables: str, sentence: str, tmp_path: Path) -> None:
    """One sentence that begins with the file's name."""
    with pytest.raises(InputError, match=f"^own.toml: {sentence}"):
        loaded(tmp_path, tables)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_writes_and_reads_them_and_says_nothing_without(kind: str) -> None:
    """The keys of files and requests; a toolkit without them has the keys of its table alone."""
    plain = make_toolkit(kind, given(kind))
    assert not make_toolkit_fields(plain).keys() & HARDWARE.keys()
    clamp = TopClamp(tip_radius=4, reach=CLAMP.reach, tip_margin=0.5)
    made = evolve(plain, supports=PADS, top_clamp=clamp, pins=PinLimits(movement_limit=0.25))
    entry = json.loads(json.dumps(make_toolkit_fields(made)))
    assert entry["supports"] == {"pad_radius": 3, "pad_margin": 1, "height": 12}
    assert entry["top_clamp"] == {"tip_radius": 4, "tip_margin": 0.5, "reach": [[0, -30, 5, 290]]}
    assert entry["pins"] == {"movement_limit": 0.25}
    assert make_toolkit(kind, entry) == made
    asked = json.loads(json.dumps(given(kind))) | {name: entry[name] for name in HARDWARE}
    assert FORMS[find_table(kind).noun].model_validate({"kind": kind, **asked}).to_toolkit() == made
    assert list(make_toolkit_entry(made)) == list(make_toolkit_entry(plain))
