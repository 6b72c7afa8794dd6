"""A file that leaves something open is asked about beside its drawing, not refused; and the example needs no file at all."""

from __future__ import annotations

import json
from importlib.resources import files
from math import dist
from pathlib import Path
from typing import Any

import ezdxf
import pytest
from running_server import RunningServer
from walking import EXAMPLES, Walk

from workhold import load

PHONE, DESK = {"width": 390, "height": 800}, {"width": 1280, "height": 800}
OVERLAPS = """(svg) => {
  const kinds = ".flag rect, .face-tag rect, .load-text, .axis-name.used";
  const labels = [...document.querySelector(svg).querySelectorAll(kinds)].map((each) => each.getBoundingClientRect());
  const over = (a, b) => Math.min(
    Math.min(a.right, b.right) - Math.max(a.left, b.left), Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));
  return labels.flatMap((a, k) => labels.slice(k + 1).filter((b) => over(a, b) > 1)).length;
}"""


def loops(walk: Walk) -> list[Any]:
    """The outlines of the part that the page has."""
    part = walk.page.evaluate("async () => (await import('/static/state.js')).state.part")
    return [] if part is None else list(part["loops"])


def sheet_of_parts(path: Path, units: int) -> Path:
    """A plate with a hole, and two smaller ones beside it."""
    document = ezdxf.new(units=units)
    document.header["$INSUNITS"] = units
    space = document.modelspace()
    for x, y, wide, high in ((0, 0, 120.65, 80), (150, 0, 60, 40), (150, 60, 30, 20)):
        space.add_lwpolyline([(x, y), (x + wide, y), (x + wide, y + high), (x, y + high)], close=True)
    space.add_circle((20, 20), 5)
    document.saveas(path)
    return path


def with_gaps(path: Path, gaps: tuple[float, ...]) -> Path:
    """A plate of four lines, each as much too short as a gap says, around a hole."""
    corners = [(0.0, 0.0), (100.0, 0.0), (100.0, 60.0), (0.0, 60.0)]
    document = ezdxf.new(units=4)
    for start, end, gap in zip(corners, corners[1:] + corners[:1], gaps, strict=True):
        share = 1 - gap / dist(start, end)
        document.modelspace().add_line(start, [a + share * (b - a) for a, b in zip(start, end, strict=True)])
    document.modelspace().add_circle((30, 30), 8)
    document.saveas(path)
    return path


@pytest.mark.parametrize(("unit", "wide"), [("mm", 120.65), ("inch", 120.65 * 25.4)])
def test_the_unit_is_asked_with_both_sizes(walk: Walk, tmp_path: Path, unit: str, wide: float) -> None:
    """The drawing is seen meanwhile; nothing is called an error; a click on a size leads to the part in that size."""
    page = walk.page
    page.set_input_files("#file", sheet_of_parts(tmp_path / "parts.dxf", 0))
    words = walk.seen("#file-asks").inner_text()
    assert "180.00 × 80.00" not in words and "210.00 × 80.00 mm" in words and "5334 × 2032 mm" in words
    assert page.locator("#part-trouble").is_hidden() and page.is_disabled("#search")
    assert page.locator("#drawing-part .stray").count() == 1
    page.click(f"#file-asks [data-unit={unit}]")
    walk.seen("#faces button")
    assert loops(walk)[0][1][0] == pytest.approx(wide)
    assert page.get_attribute(f"#file-asks [data-unit={unit}]", "aria-pressed") == "true"
    # The answer can be changed, and the list of units is the same question.
    page.select_option("#file-unit", "mm")
    page.wait_for_selector("#file-asks [data-unit=mm][aria-pressed=true]")
    assert loops(walk)[0][1][0] == pytest.approx(120.65)


def test_pixels_are_offered_for_a_drawing_that_has_them(walk: Walk, tmp_path: Path) -> None:
    """With the size that each count to the inch makes of it; a click leads to the part in that size."""
    page, path = walk.page, tmp_path / "plate.svg"
    root = 'width="576px" height="288px" viewBox="0 0 288 144"'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {root}><path d="M9 9h144v72h-144z"/></svg>')
    page.set_input_files("#file", path)
    words = walk.seen("#file-asks").inner_text()
    assert "144.00 × 72.00 mm" in words and "72 pixels to the inch: 101.6 × 50.8 mm" in words
    page.click("#file-asks [data-unit=px96]")
    walk.seen("#faces button")
    xs = [x for x, *_ in loops(walk)[0]]
    assert max(xs) - min(xs) == pytest.approx(76.2)
    assert page.input_value("#file-unit") == "px96"


def test_another_part_of_the_file_is_taken_by_a_click(walk: Walk, tmp_path: Path) -> None:
    """In the drawing or in the list; what was asked about a file is gone with the next."""
    page = walk.page
    page.set_input_files("#file", sheet_of_parts(tmp_path / "parts.dxf", 4))
    walk.seen("#file-asks [data-part]")
    assert page.locator("#drawing-part .other-part").count() == 2 and len(loops(walk)) == 2
    page.click('#drawing-part .other-part[data-part="2"]')
    page.wait_for_selector('#file-asks [data-part="2"][aria-pressed=true]')
    assert loops(walk)[0][1][0] - loops(walk)[0][0][0] == 60
    page.click('#file-asks [data-part="3"]')
    page.wait_for_selector('#file-asks [data-part="3"][aria-pressed=true]')
    assert loops(walk)[0][1][0] - loops(walk)[0][0][0] == 30
    page.set_input_files("#file", EXAMPLES / "bracket.dxf")
    page.wait_for_selector("#drawing-part .other-part", state="detached")
    assert page.locator("#file-asks [data-part]").count() == 0


def test_gaps_are_joined_up_to_the_largest(walk: Walk, tmp_path: Path) -> None:
    """All that is drawn is seen, and the slider ends where the whole outline is closed."""
    page = walk.page
    page.set_input_files("#file", with_gaps(tmp_path / "gaps.dxf", (0.02, 0.3, 0.0, 1.1)))
    slider = walk.seen("#join")
    assert (slider.get_attribute("max"), slider.input_value()) == ("3", "0")
    # The hole in it is closed, and not taken for the part.
    walk.seen("#part-trouble:has-text('is not closed')")
    assert loops(walk) == [] and page.locator("#drawing-part .stray").count() == 1
    page.focus("#join")
    page.keyboard.press("End")
    walk.seen("#part-words:has-text('100.00 mm × 60.00 mm, 5 faces, 1 hole')")
    walk.seen("#file-asks output:has-text('1.100 mm')")
    assert page.input_value("#join") == "3" and len(loops(walk)) == 2
    # With less the outline around the hole is nearly closed: it is not taken for a part, and the slider stays.
    page.focus("#join")
    page.keyboard.press("ArrowLeft")
    walk.seen("#part-trouble:has-text('is not closed')")
    walk.seen("#file-asks output:has-text('0.300 mm')")
    assert loops(walk) == []


def test_an_outline_that_is_open_says_so_beside_the_slider(walk: Walk, tmp_path: Path) -> None:
    """The reader's sentence without a word of a command line, and the answer that it wants."""
    page = walk.page
    path = with_gaps(tmp_path / "open.dxf", (0.0, 0.5, 0.0, 0.0))
    document = ezdxf.readfile(path)
    for circle in document.modelspace().query("CIRCLE"):
        document.modelspace().delete_entity(circle)
    document.saveas(path)
    page.set_input_files("#file", path)
    words = walk.seen("#part-trouble").inner_text()
    assert "Join gaps up to" in words and "--" not in words
    page.focus("#join")
    page.keyboard.press("End")
    walk.seen("#faces button")
    assert page.locator("#part-trouble").is_hidden()


def test_layers_are_a_list_with_pictures(walk: Walk, tmp_path: Path) -> None:
    """Each with what is on it; without the frame around it the plate is the part, and all of them are the usual again."""
    document = ezdxf.new(units=4)
    space = document.modelspace()
    for layer, x0, y0, x1, y1 in (("OUTLINE", 0, 0, 100, 60), ("FRAME", -20, -40, 140, 90)):
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    document.saveas(tmp_path / "layers.dxf")
    page = walk.page
    page.set_input_files("#file", tmp_path / "layers.dxf")
    walk.seen("#part-words:has-text('160.00 mm × 130.00 mm')")
    page.click("#file-asks summary:has-text('Layers: 2 of 2')")
    shapes = page.locator("#file-asks .layer-picture path")
    assert [str(shape.get_attribute("d")).count("M") for shape in shapes.all()] == [1, 1]
    page.uncheck("#file-asks input[value=FRAME]")
    walk.seen("#part-words:has-text('100.00 mm × 60.00 mm')")
    walk.seen("#file-asks summary:has-text('Layers: 1 of 2')")
    page.check("#file-asks input[value=FRAME]")
    walk.seen("#part-words:has-text('160.00 mm × 130.00 mm')")


def test_curves_are_fitted_as_asked(walk: Walk) -> None:
    """A Bézier curve that is not an arc is asked about; how far off the arcs are goes into the search and into the link."""
    page = walk.page
    svg = b"""<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="80mm" viewBox="0 0 120 80">
<path d="M10 10H90C115 10 115 70 90 70H10Z"/></svg>"""
    page.set_input_files("#file", {"name": "bow.svg", "mimeType": "image/svg+xml", "buffer": svg})
    assert "Fit curves within" in walk.seen("#part-trouble").inner_text()
    page.click('#file-asks [data-fit="0.05"]')
    walk.seen("#faces button")
    departure = page.evaluate("async () => (await import('/static/state.js')).request().workpiece.departure")
    assert 0 < departure <= 0.05
    assert f"{departure:.4f} mm" in page.inner_text("#file-asks")
    walk.reload()
    walk.seen("#faces button")
    again = page.evaluate("async () => (await import('/static/state.js')).request().workpiece.departure")
    assert again == departure


def test_the_example_is_one_click(walk: Walk) -> None:
    """It is the drawing of the examples, on what people have, and its fixtures are shown."""
    page = walk.page
    page.click("#example")
    walk.searched()
    assert walk.count() > 1000
    assert page.input_value("#preset") == "clamp-plate-20mm"
    kept = json.loads((files("workhold.web") / "static" / "example.json").read_text(encoding="utf-8"))
    assert kept["loops"] == [loop.tolist() for loop in load(EXAMPLES / "bracket.dxf").loops]


def test_the_drawing_is_first_on_a_phone(browser: Any, server: RunningServer, tmp_path: Path) -> None:
    """From an empty page to fixtures without a look at the settings; a question is asked where the drawing is."""
    context = browser.new_context(viewport=PHONE, reduced_motion="reduce")
    walk = Walk(context.new_page(), server)
    walk.open()
    page = walk.page
    walk.seen("#example")
    assert page.locator(".toolbar").first.is_hidden()
    walk.go("settings")
    page.set_input_files("#file", sheet_of_parts(tmp_path / "parts.dxf", 0))
    walk.seen("#file-asks [data-unit=mm]").click()
    walk.seen("#search-here").click()
    walk.searched(shown=False)
    page.click("#list .row >> nth=0")
    walk.seen("#drawing-fixture [data-peg]")
    assert page.locator("#search-here").is_hidden() and page.locator("#file-asks").is_hidden()
    page.click("#view-part")
    walk.seen("#file-asks")
    page.click("#view-fixture")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.click("#push")
    walk.seen("#bars .bar")
    # Nothing scrolls the drawing away.
    stage, tool = (page.locator(name).bounding_box() for name in ("#stage", "#view-fixture"))
    assert tool["y"] >= stage["y"]
    context.close()
    assert walk.troubles == []


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("size", "preset"), [(PHONE, "clamp-plate-20mm"), (DESK, "plate-20mm")], ids=["phone", "desk"]
)
def test_no_label_lies_on_another(
    browser: Any, server: RunningServer, size: dict[str, int], preset: str
) -> None:
    """Holes, faces and the load, in the first fixtures, with and without a force."""
    context = browser.new_context(viewport=size, reduced_motion="reduce")
    walk = Walk(context.new_page(), server)
    walk.open()
    page = walk.page
    page.click("#example")
    walk.searched()
    walk.go("settings")
    page.select_option("#preset", preset)
    walk.searched(shown=False)
    walk.go("stage")
    walk.seen("#drawing-fixture .flag")
    for place in range(2, 10):
        if place == 6:
            page.click("#push")
            walk.seen("#drawing-fixture .load-text")
        page.click("#next")
        walk.seen(f"#place:has-text('{place} of')")
        walk.arrived()
        assert page.evaluate(OVERLAPS, "#drawing-fixture") == 0, walk.holes()
    context.close()
