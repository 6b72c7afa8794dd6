"""``workhold features``: the layers and the parts of a file to choose among, and numbers that are missing."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from reading_helpers import new_dxf, rectangle

Run = Callable[..., Any]


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    """Two plates with holes on two layers, dimensions that nothing closes, and a frozen frame with a text."""
    document, space = new_dxf()
    document.layers.add("Frame").freeze()
    for k in range(2):
        rectangle(space, 70 * k, 0, 60 - 5 * k, 40, layer="Outline")
        space.add_circle((70 * k + 20, 15), 5, dxfattribs={"layer": "Holes"})
    space.add_line((3, 60), (70, 65), dxfattribs={"layer": "Dimensions"})
    rectangle(space, -20, -20, 200, 100, layer="Frame")
    space.add_text("PLATE", dxfattribs={"layer": "Frame"})
    document.saveas(tmp_path / "plates.dxf")
    return tmp_path / "plates.dxf"


def test_layers_are_listed_with_what_is_on_them(run: Run, drawing: Path) -> None:
    """Names, sizes, closed outlines and kinds of entities; hidden layers too."""
    outcome = run("features", drawing, "--layers")
    assert outcome.exit_code == 0
    rows = [re.split(r"  +", line.strip()) for line in outcome.stdout.splitlines()]
    assert ["Dimensions", "67 x 5", "0", "1 LINE"] in rows
    assert ["Holes", "80 x 10", "2", "2 CIRCLE"] in rows
    assert ["Outline", "125 x 40", "2", "8 LINE"] in rows
    assert ["Frame", "200 x 100", "1", "4 LINE, 1 TEXT (hidden: read only when named)"] in rows
    inches = run("features", drawing, "--layers", "--unit", "inch")
    assert "4.9213 x 1.5748" in inches.stdout and "size in" in inches.stdout


def test_layers_are_listed_of_a_drawing_without_a_unit_or_with_faults(run: Run, tmp_path: Path) -> None:
    """Sizes are then as drawn; what cannot be read is counted all the same."""
    document, space = new_dxf(0)
    rectangle(space, layer="A")
    space.add_line((0, 0), (60, 40), dxfattribs={"layer": "A"})
    space.add_line((0, 0, 0), (1, 0, 5), dxfattribs={"layer": "B"})
    document.saveas(tmp_path / "drawn.dxf")
    outcome = run("features", tmp_path / "drawn.dxf", "--layers")
    rows = [re.split(r"  +", line.strip()) for line in outcome.stdout.splitlines()]
    assert "size as drawn" in rows[0]
    assert ["A", "60 x 40", "?", "5 LINE"] in rows and ["B", "0", "1 LINE"] in rows


def test_only_drawings_have_layers(run: Run) -> None:
    """A built-in part has none."""
    outcome = run("features", "widget", "--layers")
    assert outcome.exit_code == 2 and "only DXF files have layers" in outcome.stderr


def test_parts_are_listed_and_drawn_with_their_numbers(run: Run, drawing: Path, tmp_path: Path) -> None:
    """By decreasing area; the one that is used has another colour than the rest."""
    picture = tmp_path / "parts.svg"
    outcome = run("features", drawing, "--parts", "--part", 2, "--draw", picture)
    rows = [line.split() for line in outcome.stdout.splitlines()]
    assert ["1", "60.000", "40.000", "1", "(0.000,", "0.000)"] in rows
    assert ["2", "55.000", "40.000", "1", "(70.000,", "0.000)"] in rows
    text = picture.read_text()
    assert "2 parts, numbered by decreasing area · part 2 is the one that is used" in text
    numbers = text.partition('class="part-numbers"')[2]
    assert re.findall(r">(\d+)</text>", numbers) == ["1", "2"]
    fills = {k: re.search(rf'class="part-{k}".*?fill="(#\w+)"', text, re.S) for k in (1, 2)}
    assert fills[1] and fills[2] and fills[1][1] != fills[2][1]


def test_missing_numbers_of_faces_are_explained(run: Run, drawing: Path, tmp_path: Path) -> None:
    """A circle is two segments and one face; a part of lines only has every number."""
    outcome = run("features", drawing, "--draw", tmp_path / "faces.svg")
    assert "No face has the number 5: that is a further piece of a face drawn in pieces" in outcome.stdout
    assert "a face drawn in pieces has the number of the first" in (tmp_path / "faces.svg").read_text()
    plain = run("features", drawing, "--layer", "Outline", "--draw", tmp_path / "plain.svg")
    assert "No face is called" not in plain.stdout
    assert "in pieces" not in (tmp_path / "plain.svg").read_text()
