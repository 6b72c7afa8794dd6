"""The picture that the page zooms and closes: all is where the fixture has it; what moves or keeps its size is marked."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from math import dist

import pytest
from attrs import evolve
from held_any_way import AHEAD, HELD, Held
from svg_reading import NAMESPACE, matrix, to_model

from workhold.drawing.bench import make_bench
from workhold.model.setup import list_length_settings
from workhold.presenting.zoomed_picture import draw_small_picture, draw_zoomable_picture

SIZE = (640.0, 480.0)
EVERY = pytest.mark.parametrize("held", HELD, ids=lambda held: held.made)
NUMBER = r"-?\d+(?:\.\d+)?"


def picture_of(
    held: Held, size: tuple[float, float] = SIZE, placed: tuple[float, float] = (0, 0)
) -> ET.Element:
    bench = evolve(make_bench(held.fixture, held.workpiece, held.toolkit), is_exact=True)
    return ET.fromstring(draw_zoomable_picture(bench, "part", size, placed))


def of_class(root: ET.Element, name: str) -> list[ET.Element]:
    return [element for element in root.iter() if name in element.get("class", "").split()]


def numbers(text: str) -> list[float]:
    return [float(word) for word in re.findall(NUMBER, text)]


def middle(peg: ET.Element) -> tuple[float, float]:
    """The centre of a peg on the page: that of its circle, or of the cross in it."""
    circle = next(peg.iter(f"{NAMESPACE}circle"), None)
    if circle is not None:
        return float(circle.attrib["cx"]), float(circle.attrib["cy"])
    cross = [numbers(path.attrib["d"]) for path in peg.iter(f"{NAMESPACE}path") if "class" not in path.attrib]
    return (cross[0][0] + cross[0][2]) / 2, cross[0][1]


@pytest.mark.thinned(4)
@EVERY
@pytest.mark.parametrize("placed", [(0.0, 0.0), (40.0, -16.0)])
def test_pegs_stand_where_the_fixture_has_them(held: Held, placed: tuple[float, float]) -> None:
    """By their numbers, in mm of the list, from which the plate stands on; those on a carrier that slides move with it."""
    root = picture_of(held, placed=placed)
    scale, ways = matrix(root)[0], {f"clamp {name}": way for name, way in AHEAD.items()}
    pegs = {int(element.attrib["data-peg"]): element for element in root if "data-peg" in element.attrib}
    assert sorted(pegs) == list(range(len(held.fixture.pegs)))
    moving = held.toolkit.moving
    for number, peg in enumerate(held.fixture.pegs):
        x, y = to_model(root, *middle(pegs[number]))
        assert (x + placed[0], y + placed[1]) == pytest.approx((peg.x, peg.y), abs=1e-3)
        way = numbers(pegs[number].get("data-way", ""))
        if peg.carrier in ways or peg.carrier == moving.name:
            dx, dy = ways.get(peg.carrier) or (-held.toolkit.clamping, 0)
            assert way == pytest.approx([dx * scale, -dy * scale])
        else:
            assert pegs[number].attrib["class"] == "stands" and not way


@pytest.mark.thinned(4)
@EVERY
def test_words_are_in_the_picture_and_none_lies_on_another(held: Held) -> None:
    """Every hole beside its peg and every touched face by its number, the lengths to set, and columns and rows."""
    root = picture_of(held)
    flags, tags = of_class(root, "flag"), of_class(root, "face-tag")
    words = ["".join(one.itertext()) for one in (*flags, *tags)]
    faces = dict.fromkeys(str(peg.face) for peg in held.fixture.pegs if peg.beside is None)
    assert words == [*(peg.hole for peg in held.fixture.pegs), *faces]
    boxes = []
    for one in (*flags, *tags):
        box = next(one.iter(f"{NAMESPACE}rect")).attrib
        x, y, wide, high = (float(box[name]) for name in ("x", "y", "width", "height"))
        assert min(x, y) >= 0 and x + wide <= SIZE[0] and y + high <= SIZE[1]
        assert not any(x < c and a < x + wide and y < d and b < y + high for a, b, c, d in boxes)
        boxes.append((x, y, x + wide, y + high))
    for word in (*of_class(root, "used"), *of_class(root, "dimension-text")):
        x, y = float(word.attrib["x"]), float(word.attrib["y"])
        assert not any(a < x < c and b < y < d for a, b, c, d in boxes), word.text
    used = {one.text for one in of_class(root, "used")}
    cells = [peg for peg in held.fixture.pegs if held.toolkit.find_carrier(peg.carrier).has_lattice]
    assert {str(peg.row + 1) for peg in cells} | {chr(ord("A") + peg.column) for peg in cells} <= used


@pytest.mark.thinned(4)
@EVERY
def test_lengths_to_set_are_measured_between_what_stands_and_what_moves(held: Held) -> None:
    """The line is as long as the length is, and only its second end moves; its distance from the drawing is kept."""
    root = picture_of(held)
    scale, told = matrix(root)[0], list_length_settings(held.fixture, held.toolkit)
    travels = of_class(root, "travel")
    assert len(travels) == len(told)
    for travel, setting in zip(travels, told, strict=True):
        (text,), (line,) = of_class(travel, "dimension-text"), of_class(travel, "stretches")
        assert (text.attrib["data-sign"], float(text.attrib["data-length"])) == (setting.sign, setting.length)
        assert text.text == f"{setting.sign} = {setting.length:.3f} mm".replace("-", "−")
        x0, y0, x1, y1 = numbers(line.attrib["d"])
        assert dist((x0, y0), (x1, y1)) == pytest.approx(abs(setting.length) * scale, abs=2e-3)
        outer, inner = {"x": ("x", "y"), "y": ("y", "x")}[travel[0].attrib["data-axes"]]
        # What keeps its size within what keeps its distance does so along the other axis alone.
        assert {one.attrib["data-axes"] for one in of_class(travel[0], "kept")} == {outer, inner}
        assert (outer == "y") == (abs(y1 - y0) < 1e-9)


def test_a_clamp_goes_no_farther_back_than_to_its_least_stroke() -> None:
    """One that does not reach its tip from its hole shows its line alone, and no length to set."""
    (held,) = (one for one in HELD if one.made == "plate, bolted, clamp -x")
    (stroke,) = list_length_settings(held.fixture, held.toolkit)
    for travel, bolts in (
        ((5.0, stroke.length + 1), 1),
        ((stroke.length + 1, 60.0), 0),
        ((1.0, stroke.length - 1), 0),
    ):
        root = picture_of(evolve(held, toolkit=evolve(held.toolkit, travel=travel)))  # type: ignore[misc]
        assert len(of_class(root, "bolt")) == len(of_class(root, "travel")) == bolts
        assert len(of_class(root, "clamp-line")) == 1 - bolts
        backs = [float(one.attrib["data-most"]) for one in root if "data-most" in one.attrib]
        assert backs == [pytest.approx(stroke.length - 5.0, abs=1e-3)] * bolts


def test_pegs_are_as_thin_as_they_are() -> None:
    """Also on a page where a line is thicker; a point has a dot all the same."""
    (held,) = (one for one in HELD if one.made == "vise, I")
    for radius, drawn in ((0.05, 0.05), (0.0, None)):
        root = picture_of(evolve(held, toolkit=evolve(held.toolkit, peg_radius=radius)))  # type: ignore[misc]
        radii = {float(one.attrib["r"]) / matrix(root)[0] for one in of_class(root, "peg")}
        assert all(one == pytest.approx(drawn, abs=1e-3) if drawn else one > 0.1 for one in radii)


@pytest.mark.thinned(8)
@EVERY
def test_a_small_picture_has_the_part_and_the_pegs(held: Held) -> None:
    """As they lie, in few bytes."""
    text = draw_small_picture(held.fixture, held.workpiece, held.toolkit)
    root = ET.fromstring(text)
    assert len(text) < 4_000
    circles = [(float(one.attrib["cx"]), float(one.attrib["cy"])) for one in root.iter(f"{NAMESPACE}circle")]
    pegs = [(peg.x, peg.y) for peg in held.fixture.pegs]
    x0, y0 = circles[0]
    scale = dist(circles[0], circles[1]) / dist(pegs[0], pegs[1])
    for (x, y), (px, py) in zip(circles, pegs, strict=True):
        assert (x - x0, y0 - y) == pytest.approx(
            (scale * (px - pegs[0][0]), scale * (py - pegs[0][1])), abs=0.1
        )
