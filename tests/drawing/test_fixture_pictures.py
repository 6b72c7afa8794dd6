"""The picture of a fixture: true to the model, complete and well-formed at any size."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from attrs import evolve
from drawing_examples import PART_AREA, example, hole_area
from svg_reading import area, by_class, matrix, texts, to_model

from workhold import Fixture, Pose, Vise, Workpiece
from workhold.drawing import draw_fixture, draw_thumbnails
from workhold.drawing.scene import measure_text
from workhold.errors import InputError

Held = tuple[Fixture, Workpiece, Vise]


def test_outline_has_the_area_of_the_part(held: Held) -> None:
    """The path, arcs and all, encloses outer loop minus hole."""
    svg = draw_fixture(*held)
    (part,) = by_class(svg, "part")
    (outline,) = by_class(svg, "outline")
    size = held[1].bounds[2] / 60
    assert area(outline.attrib["d"]) / matrix(part)[0] ** 2 / size**2 == pytest.approx(
        PART_AREA - hole_area(), rel=1e-4
    )


def test_curves_are_arcs_and_never_chords(held: Held) -> None:
    """Three arcs, of which the one beyond half a turn is written in pieces; the straight segments are lines."""
    (outline,) = by_class(draw_fixture(*held), "outline")
    assert outline.attrib["d"].count("A") == 1 + 2 + 3
    assert outline.attrib["d"].count("L") == 6


def test_pegs_stand_where_the_model_says(held: Held) -> None:
    """Four filled pegs, whose centres and radius in mm are those of the fixture."""
    svg = draw_fixture(*held)
    (group,) = by_class(svg, "pegs")
    pegs = by_class(svg, "peg")
    assert len(pegs) == 4
    for peg, circle in zip(held[0].pegs, pegs, strict=True):
        x, y = to_model(group, float(circle.attrib["cx"]), float(circle.attrib["cy"]))
        assert np.hypot(x - peg.x, y - peg.y) < 1e-3 * held[2].peg_radius
        assert float(circle.attrib["r"]) / matrix(group)[0] == pytest.approx(held[2].peg_radius, rel=1e-3)
        assert circle.attrib["fill"] not in ("none", "#ffffff")


def test_everything_a_machinist_needs_is_written(held: Held) -> None:
    """Holes, faces, jaw separation, angle, part and margin."""
    fixture, workpiece, vise = held
    words = texts(draw_fixture(fixture, workpiece, vise, title="Fixture 3 of 8"))
    for wanted in [
        "L-B1",
        "L-B5",
        "R-A2",
        "R-A4",
        "90.000°",
        "θ = 90.000°",
        "0.1250",
        "Fixture 3 of 8",
        "closing",
    ]:
        assert wanted in words
    assert workpiece.name in words
    (separation,) = (word for word in words if word.startswith("S = "))
    assert float(separation.removeprefix("S = ").removesuffix(" mm")) == pytest.approx(fixture.travel)


def test_page_is_all_that_is_used(held: Held) -> None:
    """No text is cut off by the page's edge."""
    root = ET.fromstring(draw_fixture(*held).encode())
    width, height = map(float, root.attrib["viewBox"].split()[2:])
    for element in root.iter("{http://www.w3.org/2000/svg}text"):
        size, x, y = (float(element.attrib[key]) for key in ("font-size", "x", "y"))
        long = measure_text(element.text or "", size, element.get("font-weight") == "bold")
        start = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[element.get("text-anchor", "start")] * long
        assert start >= 0 and start + long <= width
        assert size <= y <= height


def test_names_are_escaped() -> None:
    """Markup and control characters in names are harmless."""
    svg = draw_fixture(*example(name='<b>&"\x00'), title="</svg>&amp;")
    words = texts(svg)
    assert '<b>&"?' in words and "</svg>&amp;" in words


def test_text_is_the_same_every_time() -> None:
    """Two runs give the same bytes."""
    assert draw_fixture(*example()) == draw_fixture(*example())


def test_sheet_stands_upright_for_tall_parts() -> None:
    """A slender upright part is drawn in portrait, the same part lying down in landscape."""
    bar = Workpiece.from_loops("bar", [[[0, 0, 0], [20, 0, 0], [20, 300, 0], [0, 300, 0]]])
    fixture, _, vise = example()
    first, second, third, fourth = (
        evolve(peg, face=3 if peg.carrier == "left" else 1) for peg in fixture.pegs
    )
    fixture = evolve(fixture, pegs=(first, second, third, fourth))
    upright = evolve(fixture, pose=Pose(0.0, 13.0, 0.0))
    lying = evolve(fixture, pose=Pose(90.0, 150.0, 10.0))
    assert 'width="210mm"' in draw_fixture(upright, bar, vise)
    assert 'width="297mm"' in draw_fixture(lying, bar, vise)


@pytest.mark.parametrize(
    "vise",
    [
        Vise(pitch=10, columns=2, peg_radius=0),
        Vise(pitch=0.2, columns=200, peg_radius=0.05),
        Vise(pitch=10, columns=2, peg_radius=3, rows=5, row_offset=-4.0),
        Vise(pitch=(500, 700), columns=1, peg_radius=3),
    ],
    ids=["points", "very fine", "rows and offset", "very coarse"],
)
def test_unusual_vises_are_drawn(vise: Vise) -> None:
    """Any vise gives a well-formed picture of bounded size with four pegs."""
    fixture, workpiece, _ = example()
    pegs = tuple(evolve(peg, column=min(peg.column, vise.columns - 1)) for peg in fixture.pegs)
    svg = draw_fixture(evolve(fixture, pegs=pegs), workpiece, vise)
    assert len(by_class(svg, "peg")) == 4
    assert len(svg) < 1_000_000


def test_margin_may_be_unknown() -> None:
    """A fixture without figures of merit is drawn with a dash for the closure margin."""
    fixture, workpiece, vise = example()
    assert "–" in texts(draw_fixture(evolve(fixture, quality={}), workpiece, vise))


# The sheet of small pictures.
Many = tuple[list[Fixture], Workpiece, Vise]


@pytest.mark.parametrize("count", [1, 2, 5, 12])
def test_each_fixture_has_a_cell_with_its_caption(many: Many, count: int) -> None:
    """As many thumbnails as fixtures, all to one scale, with title, type, margin and four pegs each."""
    fixtures, workpiece, vise = many
    titles = [f"#{k + 1}" for k in range(count)]
    svg = draw_thumbnails(fixtures[:count], workpiece, vise, titles)
    assert len(by_class(svg, "thumbnail")) == count
    assert len(by_class(svg, "peg")) == 4 * count
    assert len({matrix(group)[0] for group in by_class(svg, "pegs")}) == 1
    words = texts(svg)
    assert [word for word in words if word in titles] == titles
    assert words.count("margin 0.1250") == count
    assert [word for word in words if word.startswith("Type ")] == [
        f"Type {f.type}" for f in fixtures[:count]
    ]


def test_a_sheet_has_its_limits(many: Many) -> None:
    """None, thirteen, or titles missing: refused with a sentence."""
    fixtures, workpiece, vise = many
    for chosen, titles in (([], []), ([*fixtures, fixtures[0]], ["x"] * 13), (fixtures, ["x"])):
        with pytest.raises(InputError):
            draw_thumbnails(chosen, workpiece, vise, titles)
