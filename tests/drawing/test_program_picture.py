"""The picture of a program: paths by tool and height where they are, rapid moves dashed, bands as wide as the flutes."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from workhold import Program, load
from workhold.drawing import convert_svg_to_png
from workhold.drawing.path_drawn import COLOURS, shade_colour
from workhold.drawing.program_picture import draw_program
from workhold.units import INCH

HAAS = Path(__file__).parent.parent / "data" / "programs" / "haas.nc"


@pytest.fixture(scope="module")
def program() -> Program:
    """A contour and four holes."""
    return Program.read(HAAS, z_zero=0)


def paths_of(svg: str) -> tuple[list[ET.Element], tuple[float, float, float]]:
    """The paths of tools, and scale, left and top of the map from mm to the page."""
    root = ET.fromstring(svg)
    (group,) = [one for one in root.iter() if one.get("class") == "paths"]
    numbers = re.findall(r"-?[\d.]+(?:e-?\d+)?", group.attrib["data-model-to-page"])
    return list(group), (float(numbers[0]), float(numbers[4]), float(numbers[5]))


def test_paths_are_where_the_tips_go(program: Program) -> None:
    """The contour's corners on the page are those of the program; it runs as one line with five arcs."""
    paths, (scale, left, top) = paths_of(draw_program(program))
    contour = max((one for one in paths if one.get("class") == "cut-1"), key=lambda one: len(one.attrib["d"]))
    d = contour.attrib["d"]
    assert d.count("M") == 1 and d.count("A") == 5 and d.count("L") == 4
    ends = np.array([[float(x), float(y)] for x, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)(?=[MLA]|$)", d)])
    points = np.column_stack([(ends[:, 0] - left) / scale, (top - ends[:, 1]) / scale])
    expected = [
        (-12, -6),
        (-6, 0),
        (-6, 40),
        (0, 46),
        (60, 46),
        (66, 40),
        (66, 0),
        (60, -6),
        (0, -6),
        (-6, 0),
    ]
    assert np.allclose(points, expected, atol=0.05)


def test_arcs_bend_the_way_they_are_cut(program: Program) -> None:
    """An arc to the left has SVG's sweep of 0, since y is turned over; the others go to the right."""
    paths, (scale, _, _) = paths_of(draw_program(program))
    d = max((one.attrib["d"] for one in paths if one.get("class") == "cut-1"), key=len)
    arcs = re.findall(r"A([\d.]+) ([\d.]+) 0 0 ([01])", d)
    assert [sweep for _, _, sweep in arcs] == ["0", "1", "1", "1", "1"]
    assert np.allclose([float(radius) for radius, _, _ in arcs], 6 * scale, atol=0.02)


def test_bands_are_as_wide_as_the_flutes_and_rapid_moves_are_dashed(program: Program) -> None:
    """Each tool has its colour; only rapid moves are dashed, and no upright one is drawn."""
    paths, (scale, _, _) = paths_of(draw_program(program))
    bands = [one for one in paths if one.get("class") == "band"]
    assert [one.get("stroke") for one in bands] == list(COLOURS[:2])
    widths = [float(one.attrib["stroke-width"]) / scale for one in bands]
    assert widths == pytest.approx([10.0, 6.8], abs=0.01)
    dashed = [one for one in paths if one.get("stroke-dasharray")]
    assert [one.get("class") for one in dashed] == ["rapid"]
    assert dashed[0].attrib["d"].count("L") == 3


def test_lower_is_darker(program: Program) -> None:
    """The contour at -12 is darker than the way down to it, and drawn over it."""
    shades = [shade_colour(COLOURS[0], level) for level in range(6)]
    brightness = [sum(int(one[k : k + 2], 16) for k in (1, 3, 5)) for one in shades]
    assert brightness == sorted(brightness) and len(set(brightness)) == 6
    paths, _ = paths_of(draw_program(program))
    order = [shades.index(one.attrib["stroke"]) for one in paths if one.get("class") == "cut-1"]
    assert order == sorted(order, reverse=True) and order[-1] == 0 and len(order) > 1


def test_letters_of_the_zero_stand_beyond_the_tips_of_its_arrows(program: Program) -> None:
    """X to the right of the zero and Y above it, where x and y grow, each on the line of its arrow."""
    root = ET.fromstring(draw_program(program))
    (zero,) = [one for one in root.iter() if one.get("class") == "program-zero"]
    (circle,) = [one for one in zero if one.tag.endswith("circle")]
    x, y = float(circle.attrib["cx"]), float(circle.attrib["cy"])
    lines = {one.text: one.attrib for one in zero if one.tag.endswith("text")}
    places = {word: (float(at["x"]) - x, y - float(at["y"])) for word, at in lines.items()}
    ends = [re.findall(r"[ML]([\d.]+) ([\d.]+)", one.attrib["d"]) for one in zero if one.tag.endswith("path")]
    right = max(float(end[0]) - x for path in ends for end in path)
    up = max(y - float(end[1]) for path in ends for end in path)
    assert places["X"][0] > right > 0 and places["X"][1] == pytest.approx(0, abs=6)
    assert places["Y"][1] > up > 0 and places["Y"][0] == pytest.approx(0, abs=6)


def test_words_and_the_part(program: Program) -> None:
    """Tools, depths and heights are written, in the unit that is asked for; the part lies below the paths."""
    svg = draw_program(program, unit=INCH)
    for words in ("haas.nc", "28 moves of 2 tools", "T1  Ø 0.393701 in", "flat end mill", "rapid move"):
        assert words in svg
    assert "down to z −12.0" in draw_program(program)
    with_part = draw_program(program, workpiece=load("flange"))
    assert with_part.index('class="part"') < with_part.index('class="paths"')
    assert 'class="part"' not in svg


@pytest.mark.thorough
def test_it_can_be_rendered(program: Program) -> None:
    """As PNG."""
    assert convert_svg_to_png(draw_program(program)).startswith(b"\x89PNG")


def test_half_turns_are_drawn_the_right_way(tmp_path: Path) -> None:
    """A half turn to the left from the right of the centre goes over its top."""
    path = tmp_path / "a.nc"
    path.write_text("G21 G90\nT1 M6\nG0 X10 Y0 Z0\nG3 X-10 I-10 F100\n")
    paths, (scale, left, top) = paths_of(draw_program(Program.read(path, {1: 4.0}, z_zero=0)))
    d = next(one.attrib["d"] for one in paths if one.get("class") == "cut-1" and "A" in one.attrib["d"])
    ends = [(float(x), float(y)) for x, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)(?=[MLA]|$)", d)]
    points = [((x - left) / scale, (top - y) / scale) for x, y in ends]
    assert np.allclose(points, [(10, 0), (0, 10), (-10, 0)], atol=0.02)
