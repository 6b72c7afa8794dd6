"""Pictures from Python: SVG text that a notebook shows, and files."""

from __future__ import annotations

from base64 import b64decode
from pathlib import Path
from typing import Any

import attrs
import pytest

from fakes import fake_result, plate
from workhold.drawing import draw_features, draw_fixture
from workhold.errors import InputError
from workhold.presenting.markup import compact_svg
from workhold.units import find_unit

RESULT = fake_result(4)


@pytest.mark.thorough
@pytest.mark.parametrize("thing", [plate(), RESULT, RESULT[1]], ids=["part", "result", "fixture"])
def test_a_picture_shows_itself(thing: Any, tmp_path: Path) -> None:
    """What ``draw`` gives is what a notebook shows and what is written."""
    picture = thing.draw(tmp_path / "picture.svg")
    assert picture.startswith(("<svg", "<?xml"))
    assert picture == (tmp_path / "picture.svg").read_text()
    shown = picture._repr_html_().partition("base64,")[2].partition('"')[0]
    assert b64decode(shown).decode() == compact_svg(picture)
    thing.draw(tmp_path / "picture.PNG")
    assert (tmp_path / "picture.PNG").read_bytes().startswith(b"\x89PNG")


@pytest.mark.thorough
def test_pictures_are_those_of_the_command_line() -> None:
    """With title, unit and peg radius handed on."""
    inch = find_unit("inch")
    one = RESULT[1]
    told = draw_fixture(one, RESULT.workpiece, RESULT.toolkit, title="Fixture 2 of 4", unit=inch)
    assert one.draw(unit="inch") == told
    assert "Left side" in one.draw(title="Left side")
    assert plate().draw(peg_radius=3, unit="inch") == draw_features(plate(), peg_radius=3, unit=inch)


def test_a_result_is_drawn_in_a_unit() -> None:
    assert RESULT.draw(unit="inch") != RESULT.draw()


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (lambda folder: plate().draw(folder / "part.gif"), "not a kind of picture"),
        (lambda folder: plate().draw(unit="ell"), "Unit 'ell' is not known"),
        (lambda folder: plate().draw(folder / "none" / "part.svg"), "cannot be written"),
        (lambda folder: attrs.evolve(RESULT[0], listed=None).draw(), "this fixture is not of a result"),
        (
            lambda folder: fake_result(0, notes=("Nothing fits.",)).draw(),
            "there is no fixture to draw. Nothing fits.",
        ),
    ],
)
def test_what_cannot_be_drawn_is_told_in_a_sentence(draw: Any, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        draw(tmp_path)
