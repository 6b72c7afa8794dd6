"""Pictures in inches: those in millimetres with every length over 25.4."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable

import pytest
from sheet_reading import collisions
from svg_reading import NAMESPACE, scale_bar_of, texts

from workhold import Fixture, Vise, Workpiece
from workhold.drawing import draw_features, draw_fixture, draw_thumbnails
from workhold.units import INCH, MILLIMETRE, Unit

Held = tuple[Fixture, Workpiece, Vise]
Drawn = Callable[[Held, Unit], str]

NUMBER = r"−?\d+(?:\.\d+)?"
# A number with a unit behind it, or the first of two that share one.
LENGTH = re.compile(rf"(?<![\d.])({NUMBER})(?= (?:mm|in)\b|(?:,| ×) {NUMBER} (?:mm|in)\b)")
UNIT = re.compile(r"\b(?:mm|in)(?= lies| ·|$)")


def fixture_picture(held: Held, unit: Unit) -> str:
    """The picture of the fixture."""
    return draw_fixture(*held, unit=unit)


def faces_picture(held: Held, unit: Unit) -> str:
    """The picture of the part, with where pegs can be."""
    return draw_features(held[1], peg_radius=held[2].peg_radius, unit=unit)


def thumbnails(held: Held, unit: Unit) -> str:
    """A sheet of two small pictures."""
    return draw_thumbnails([held[0]] * 2, *held[1:], ["1", "2"], unit=unit)


PICTURES = [fixture_picture, faces_picture, thumbnails]


def read(svg: str) -> tuple[list[float], list[str]]:
    """The lengths written in a picture, but for its scale, and all other words."""
    page = ET.fromstring(svg.encode())
    for group in list(page.iter()):
        for child in [child for child in group if child.get("class") == "scale"]:
            group.remove(child)
    words = [element.text or "" for element in page.iter(f"{NAMESPACE}text")]
    lengths = []
    if "force" in words:  # the head of the table: hole, face, x, y, force
        first = words.index("force") + 1
        for cell in (first + 5 * row + column for row in range(4) for column in (2, 3)):
            lengths.append(words[cell])
            words[cell] = ""
    for word in words:
        lengths += LENGTH.findall(word)
    others = [UNIT.sub("unit", LENGTH.sub("", word)) for word in words]
    return [float(length.replace("−", "-")) for length in lengths], others


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("drawn", "count"), [*zip(PICTURES, (15, 5, 2), strict=True)])
def test_lengths_in_inches_are_those_in_millimetres_over_25_4(drawn: Drawn, count: int, held: Held) -> None:
    """All of them, to what is lost by rounding; angles, forces, names and all else stay."""
    (millimetres, words), (inches, same_words) = (read(drawn(held, unit)) for unit in (MILLIMETRE, INCH))
    rounding = 2e-3 * min(1.0, held[2].pitch[0])
    assert len(millimetres) == count
    assert [25.4 * length for length in inches] == pytest.approx(millimetres, abs=rounding, rel=1e-5)
    assert words == same_words


@pytest.mark.thorough
@pytest.mark.parametrize("drawn", PICTURES)
def test_pictures_in_inches_name_no_other_unit(drawn: Drawn, held: Held) -> None:
    """No word of millimetres."""
    words = texts(drawn(held, INCH))
    assert [word for word in words if re.search(r"\bmm\b", word)] == []


@pytest.mark.thorough
def test_pictures_are_in_millimetres_where_nothing_is_said(held: Held) -> None:
    """To the byte."""
    fixture, workpiece, vise = held
    assert draw_fixture(*held) == fixture_picture(held, MILLIMETRE)
    assert draw_features(workpiece, peg_radius=vise.peg_radius) == faces_picture(held, MILLIMETRE)
    assert draw_thumbnails([fixture] * 2, workpiece, vise, ["1", "2"]) == thumbnails(held, MILLIMETRE)


@pytest.mark.thorough
@pytest.mark.parametrize("drawn", PICTURES)
@pytest.mark.parametrize("unit", [MILLIMETRE, INCH], ids=lambda unit: unit.name)
def test_the_scale_is_as_long_as_it_says(drawn: Drawn, unit: Unit, held: Held) -> None:
    """A round number of the unit."""
    length, label = scale_bar_of(drawn(held, unit))
    number, sign = label.split()
    assert float(number) * unit.millimetres == pytest.approx(length, rel=1e-3)
    assert sign == unit.abbreviation and number.strip("0.") in {"1", "2", "5"}


@pytest.mark.thorough
@pytest.mark.parametrize("drawn", PICTURES)
def test_nothing_is_covered_in_inches(drawn: Drawn, held: Held) -> None:
    """A metric pitch in inches has many figures, and keeps off what stands before it."""
    assert collisions(drawn(held, INCH)) == []
