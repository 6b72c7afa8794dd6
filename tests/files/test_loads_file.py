"""Loads files say what they mean in TOML and JSON alike, and what cannot be used is refused in one sentence."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from workhold import Load
from workhold.errors import InputError
from workhold.files.loads_file import POUND_FORCE, read_loads

TOML = """
[[load]]
name = "side milling"
force = 150
path = [[0, 0], [40, 0.5], [40, 20]]

[[load]]
name = "drill"
force = "0.2 kN"
at = [10, 5]
direction = [-30, 30]
moment = "5 N.m"

[[load]]
moment = -700
"""
LOADS = (
    Load([(0, 0), (40, 0.5), (40, 20)], 150.0, name="side milling"),
    Load([(10, 5)], 200.0, (330, 390), 5000.0, "drill"),
    Load(moment=-700.0),
)


def written(folder: Path, text: str, name: str = "loads.toml") -> Path:
    """A file with some text."""
    path = folder / name
    path.write_text(text)
    return path


def test_toml_and_json_have_the_same_keys(tmp_path: Path) -> None:
    """The same loads, written either way, are read as the same loads."""
    assert read_loads(written(tmp_path, TOML)) == LOADS
    tables = [
        {"name": "side milling", "force": 150, "path": [[0, 0], [40, 0.5], [40, 20]], "direction": "any"},
        {"name": "drill", "force": "200N", "at": "10,5", "direction": "-30..30", "moment": 5000},
        {"moment": "-700 N.mm"},
    ]
    assert read_loads(written(tmp_path, json.dumps({"load": tables}), "loads.json")) == LOADS


def test_units(tmp_path: Path) -> None:
    """Lengths are in the file's unit, or else in the caller's; bare forces and moments stay N and N mm."""
    in_inches = read_loads(written(tmp_path, 'unit = "inch"\n' + TOML), unit_scale=1.0)
    assert in_inches == read_loads(written(tmp_path, TOML), unit_scale=25.4)
    assert (
        in_inches[1].points == ((254.0, 127.0),)
        and in_inches[1].force == 200.0
        and in_inches[1].moment == 5000.0
    )
    assert read_loads(written(tmp_path, 'unit = "mm"\n' + TOML), unit_scale=25.4) == LOADS
    (pounds,) = read_loads(written(tmp_path, '[[load]]\nforce = "45 lbf"\nat = [0, 0]\nmoment = "40 lbf.in"'))
    assert pounds.force == pytest.approx(45 * POUND_FORCE) and pounds.moment == pytest.approx(
        40 * 25.4 * POUND_FORCE
    )
    # 1 lbf in = 0.1129848 N m (NIST SP 811, appendix B.8).
    assert pounds.moment / 40e3 == pytest.approx(0.1129848, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("force = ", "is not valid TOML"),
        ("", "has no loads"),
        ("load = 3", "has no loads"),
        ("[load]\nforce = 3", "has no loads"),
        ('unit = "furlong"\n[[load]]\nmoment = 1', "Unit 'furlong' is not known"),
        ("loads = []", "unknown key 'loads'"),
        ("[[load]]\nmoment = 1\n[[load]]\nforces = 2", "load 2 has an unknown key 'forces'"),
        ("[[load]]\nforce = 3", "needs the point it acts at"),
        ("[[load]]\nforce = -3\nat = [0, 0]", "force -3 cannot be used"),
        ("[[load]]\nforce = nan\nat = [0, 0]", "force nan cannot be used"),
        ("[[load]]\nforce = true\nat = [0, 0]", "force True cannot be used"),
        ('[[load]]\nforce = "3 tons"\nat = [0, 0]', "force '3 tons' cannot be used"),
        ('[[load]]\nforce = "1e999"\nat = [0, 0]', "force inf cannot be used"),
        ("[[load]]\nforce = 3\nat = [0, 0]\npath = [[0, 0], [1, 1]]", "both at and path"),
        ("[[load]]\nforce = 3\nat = [0, 0, 0]", "at [0, 0, 0] is not a point"),
        ("[[load]]\nforce = 3\nat = [0, inf]", "at [0, inf] is not a point"),
        ("[[load]]\nforce = 3\npath = [[0, 0]]", "path [[0, 0]] is not a path"),
        ('[[load]]\nforce = 3\nat = [0, 0]\ndirection = "north"', "direction 'north' cannot be used"),
        ("[[load]]\nforce = 3\nat = [0, 0]\ndirection = [1, 2, 3]", "direction [1, 2, 3] cannot be used"),
        ("[[load]]\nforce = 3\nat = [0, 0]\ndirection = []", "direction [] cannot be used"),
        ("[[load]]\nforce = 3\nat = [0, 0]\ndirection = [0, 400]", "at most 360 degrees"),
        ("[[load]]\nat = [0, 0]\nmoment = 3", "has at but no force"),
        ("[[load]]\nmoment = 0", "does nothing"),
    ],
)
def test_bad_files_are_refused_in_one_sentence(tmp_path: Path, text: str, said: str) -> None:
    """The message names the file, the load, what is wrong and what to write."""
    path = written(tmp_path, text)
    with pytest.raises(InputError) as refused:
        read_loads(path)
    message = str(refused.value)
    assert said in message and message.startswith(str(path)) and message.endswith(".") and "\n" not in message
    assert message.count(str(path)) == 1


def test_files_that_cannot_be_read_are_refused(tmp_path: Path) -> None:
    """A missing file, bytes that are not text, and JSON that is not a table."""
    with pytest.raises(InputError, match=r"there is no file of that name\.$"):
        read_loads(tmp_path / "none.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(
        InputError, match=r"the file is not UTF-8 text \(byte 0, line 1\): save it as UTF-8\.$"
    ):
        read_loads(tmp_path / "bytes.toml")
    with pytest.raises(InputError, match=r"under the key load\.$"):
        read_loads(written(tmp_path, "[]", "list.json"))
    with pytest.raises(InputError, match=r"not valid JSON"):
        read_loads(written(tmp_path, "{", "half.json"))
