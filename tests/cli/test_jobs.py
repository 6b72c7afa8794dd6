"""Files of jobs: TOML and CSV say the same, in the words of the command line, and mistakes are named with their place."""

from __future__ import annotations

from pathlib import Path

import pytest

from workhold.cli.jobs import read_jobs
from workhold.cli.options import PartOptions
from workhold.cli.search_options import QueryOptions, SeatingOptions
from workhold.errors import InputError

TOML = """
unit = "inch"
toolkits = ["plate-20mm", "own.toml"]

[[job]]
part = "a.json"
avoid = [3, 7]
keep-out = ["circle=1,2,3"]
load = ["force=200 at=1,0.5", "moment=5000"]
loads = "loads.toml"
tolerance = [0.01, 0.02]
part_number = 2

[[job]]
part = "widget"
toolkit = "fence-20mm"
contact_margin = 0.5
seating = 5
opening = "0.1in"
foolproof = true
"""
CSV = """part;Toolkit;unit;avoid;keep out;load;loads;tolerance;part-number;contact_margin;Seating;opening;foolproof
a.json;plate-20mm|own.toml;inch;3|7;circle=1,2,3;force=200 at=1,0.5|moment=5000;loads.toml;0.01,0.02;2;;;;

widget;fence-20mm;inch;;;;;;;0.5;5;0.1in;Yes
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in (
        ("jobs.toml", TOML),
        ("jobs.csv", CSV),
        ("own.toml", ""),
        ("a.json", ""),
        ("loads.toml", ""),
    ):
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize("name", ["jobs.toml", "jobs.csv"])
def test_words_are_those_of_the_command_line(folder: Path, name: str) -> None:
    first, second = read_jobs(folder / name)
    assert (first.part, first.toolkits) == (str(folder / "a.json"), ["plate-20mm", str(folder / "own.toml")])
    assert first.make_options(PartOptions) == {"unit": "inch", "part_number": "2"}
    assert first.make_options(QueryOptions) == {
        "avoid": ["3", "7"],
        "keep_out": ["circle=1,2,3"],
        "load": ["force=200 at=1,0.5", "moment=5000"],
        "loads": str(folder / "loads.toml"),
        "tolerance": "0.01,0.02",
    }
    assert (second.part, second.toolkits, second.make_options(QueryOptions)) == (
        "widget",
        ["fence-20mm"],
        {"contact_margin": "0.5"},
    )
    assert first.make_options(SeatingOptions) == {}
    assert second.make_options(SeatingOptions) == {"seating": "5", "opening": "0.1in", "foolproof": True}


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("j.toml", "", "has no jobs"),
        ("j.toml", "[[job]]\navoid = [1]\n", "job 1 has no part"),
        (
            "j.toml",
            '[[job]]\npart = "a"\n[[job]]\npart = "b"\nangel = "3"\n',
            "job 2 has an unknown word 'angel': give",
        ),
        ("j.toml", '[[job]]\npart = "a"\navoid = [true]\n', "job 1: avoid is neither text nor a number"),
        (
            "j.toml",
            '[[job]]\npart = "a"\nfoolproof = "maybe"\n',
            "job 1: foolproof is neither true nor false",
        ),
        ("j.toml", "job = 3\n", "its jobs are not tables"),
        ("j.toml", "[[job]\n", "not valid TOML"),
        ("j.csv", "part\n", "has no jobs"),
        ("j.csv", "part,avoid\na,3,7\n", "row 1 has 3 cells under 2 names"),
        ("j.csv", "avoid\n3\n", "job 1 has no part"),
    ],
)
def test_mistakes_are_told_with_their_place(tmp_path: Path, name: str, text: str, message: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        read_jobs(tmp_path / name)
    assert name in str(caught.value)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("jobs.csv", "part\n" + "widget\n" * 20_001, "more than the 20,000 jobs"),
        ("jobs.toml", "[[job]]\npart = 'a'\n" * 20_001, "more than the 20,000 jobs"),
        ("jobs.toml", "".join(f"a{k} = 1\n" for k in range(1001)) + "[[job]]\n", "more than 1,000 entries"),
        ("jobs.csv", "part\n" + " " * 5_000_001, "more than the 5 MB"),
    ],
)
def test_jobs_are_limited(tmp_path: Path, name: str, text: str, words: str) -> None:
    """In number, in bytes, and in what each has a copy of."""
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=words):
        read_jobs(tmp_path / name)
