"""A field that is declared once appears wherever the question is asked."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from workhold.asking.declaring import collect_declared_values, list_declarations
from workhold.asking.search import SEATING, SearchQuestion
from workhold.asking.sheet import SheetQuestion
from workhold.errors import InputError


@pytest.mark.thorough
def test_one_declaration_more_is_known_everywhere(tmp_path: Path) -> None:
    """In Python, the command and its help, files, requests, families, agents, schemas, and on the page."""
    program = Path(__file__).with_name("pretended_field.py")
    done = subprocess.run([sys.executable, program, tmp_path], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout.splitlines()[-1])
    assert (told["query"], told["design"], told["request"]) == (3.0, 2.5, 4.5)
    assert told["refusal"] == "pretended -1 is not a length: give more than 0, in mm."
    assert told["help"]
    assert (told["file"], told["read"], told["faults"]) == (12.7, 12.7, [])
    assert told["schemas"] == ["Pretended for a test."] * 3
    assert told["of results"] and told["page"] == ["Pretended"]


@pytest.mark.parametrize(
    ("name", "value", "refusal"),
    [
        ("clearance", -1.0, "clearance -1 is not a length: give 0 or more, in mm."),
        ("clearance", 1e9, "clearance 1e+09 is beyond 1e+06 mm: check the number and its unit."),
        ("thickness", 0.0, "thickness 0 is not a length: give more than 0, in mm."),
        ("jaw_force", -5.0, "jaw force -5 cannot be used: give more than 0, in N."),
        ("friction", float("nan"), "friction nan cannot be used: give more than 0."),
        ("paper", "a3", "the paper cannot be 'a3': choose a4 or letter."),
    ],
)
def test_a_constructor_refuses_what_its_declaration_does(name: str, value: object, refusal: str) -> None:
    with pytest.raises(InputError) as caught:
        SheetQuestion(**{name: value})
    assert str(caught.value) == refusal


def test_values_are_converted_and_none_is_left() -> None:
    asked = SheetQuestion(thickness=12, clearance=0)
    assert (asked.thickness, asked.clearance, asked.friction) == (12.0, 0.0, None)
    assert isinstance(asked.thickness, float)
    assert collect_declared_values(SearchQuestion(best=3.0))["best"] == 3


def test_a_section_has_its_fields_in_their_order() -> None:
    rows = list_declarations(SearchQuestion, [SEATING])
    assert [(row.option, row.metavar, row.needs) for row in rows] == [
        ("--seating", "K", ""),
        ("--opening", "LENGTH", "seating"),
        ("--foolproof", "", "seating"),
    ]
