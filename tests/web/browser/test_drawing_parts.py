"""A part drawn by hand, keep-out zones, and files that are refused."""

from __future__ import annotations

from pathlib import Path

import ezdxf
import pytest
from walking import Walk


def corners(walk: Walk) -> list[list[float]]:
    """The outline that the page has."""
    return list(walk.page.evaluate("async () => (await import('/static/state.js')).state.part.loops[0]"))


def test_a_part_is_drawn_with_the_mouse(walk: Walk) -> None:
    """Lines and an arc on the grid; an edge that would cross is refused and shown; a step is undone."""
    page = walk.page
    page.click("#draw-part")
    walk.seen("#draw-bar")
    for x, y in ((0, 0), (80, 0), (80, 40)):
        walk.click_at(x, y)
    page.click("#draw-arc")
    walk.click_at(40, 40)
    walk.click_at(60, 60)
    page.click("#draw-line")
    walk.click_at(60, -5)
    assert "cross" in walk.seen("#draw-words.bad").inner_text()
    walk.seen("#drawing-part .trouble")
    walk.click_at(20, 40)
    page.click("#draw-undo")
    walk.click_at(0, 40)
    walk.click_at(0, 0)
    page.click("#draw-done")
    walk.seen("#faces button")
    assert corners(walk) == [
        [0, 0, 0],
        [80, 0, 0],
        [80, 40, pytest.approx(1, abs=0.01)],
        [40, 40, 0],
        [0, 40, 0],
    ]
    assert "80.00 mm" in page.inner_text("#part-words")


def test_a_part_is_drawn_with_the_keys_and_typed_lengths(walk: Walk) -> None:
    """The cursor steps by the grid, and a typed length runs towards it."""
    page = walk.page
    page.click("#draw-part")
    walk.seen("#draw-bar")
    page.keyboard.press("Enter")
    page.keyboard.press("ArrowRight")
    page.fill("#draw-size", "42.5")
    page.press("#draw-size", "Enter")
    page.focus("#drawing-part")
    for _ in range(4):
        page.keyboard.press("ArrowUp")
    page.keyboard.press("Enter")
    for _ in range(4):
        page.keyboard.press("ArrowLeft")
    page.keyboard.press("Enter")
    page.click("#draw-close")
    page.click("#draw-done")
    walk.seen("#faces button")
    assert corners(walk) == [[0, 0, 0], [42.5, 0, 0], [42.5, 20, 0], [22.5, 20, 0]]


def test_a_typed_radius_bends_the_arc(walk: Walk) -> None:
    """Half a circle of radius 20 over 40 mm; a smaller radius cannot reach and is refused."""
    page = walk.page
    page.click("#draw-part")
    walk.seen("#draw-bar")
    walk.click_at(0, 0)
    walk.click_at(40, 0)
    page.click("#draw-arc")
    walk.click_at(0, 0)
    page.mouse.move(*walk.point(20, 15))
    page.fill("#draw-size", "19")
    page.press("#draw-size", "Enter")
    assert "too small" in walk.seen("#draw-words.bad").inner_text()
    page.fill("#draw-size", "20")
    page.press("#draw-size", "Enter")
    page.click("#draw-done")
    walk.seen("#faces button")
    assert corners(walk) == [[0, 0, 0], [40, 0, pytest.approx(1)]]


def test_an_outline_that_crosses_itself_is_never_sent(walk: Walk) -> None:
    """An edge across another one is refused, and leaving takes nothing over."""
    page = walk.page
    page.click("#draw-part")
    walk.seen("#draw-bar")
    for x, y in ((0, 0), (40, 40), (40, 0), (0, 25)):
        walk.click_at(x, y)
    assert "cross" in walk.seen("#draw-words.bad").inner_text()
    assert not any(address.endswith("/check") for address in walk.asked)
    page.click("#draw-cancel")
    walk.seen("#stage-empty")
    assert page.locator("#faces button").count() == 0


def test_a_file_is_refused_at_its_place(walk: Walk, tmp_path: Path) -> None:
    """The error of an open outline is marked where the file is open, on a picture of it."""
    drawing = ezdxf.new(units=4)
    for start, end in (((10, 5), (60, 5)), ((60, 5), (60, 35)), ((60, 35), (10, 9))):
        drawing.modelspace().add_line(start, end)
    drawing.saveas(tmp_path / "open.dxf")
    walk.page.set_input_files("#file", tmp_path / "open.dxf")
    assert "(10, 5)" in walk.seen("#part-trouble").inner_text()
    circle = walk.seen("#drawing-part .trouble").bounding_box()
    assert walk.page.locator("#drawing-part .stray").get_attribute("d").count("M") == 3
    x, y = walk.point(10, 5)
    assert circle["x"] + circle["width"] / 2 == pytest.approx(x, abs=1.5)
    assert circle["y"] + circle["height"] / 2 == pytest.approx(y, abs=1.5)
    assert walk.page.is_disabled("#search")
    walk.troubles = [line for line in walk.troubles if "400" not in line]


def test_zones_are_drawn_and_kept_clear_of(walk: Walk) -> None:
    """A dragged circle and a clicked polygon become zones of the search; without them all fixtures are back."""
    page = walk.page
    walk.take()
    walk.search()
    free = walk.count()
    page.click("#zone-circle")
    walk.drag(walk.point(-30, -15), walk.point(-24, -15))
    walk.seen("#zones button:has-text('circle')")
    walk.searched()
    assert walk.count() < free
    page.click("#zone-polygon")
    for x, y in ((15, 5), (28, 5), (28, 15), (15, 5)):
        walk.click_at(x, y)
    walk.seen("#zones button:has-text('polygon of 3')")
    walk.searched()
    circle, polygon = page.evaluate(
        "async () => (await import('/static/state.js')).request().restrictions.zones"
    )
    assert circle[1][0] - circle[0][0] == pytest.approx(12, abs=0.5)
    assert [vertex[2] for vertex in polygon] == [0, 0, 0]
    page.click("#zones button >> nth=0")
    page.click("#zones button >> nth=0")
    page.wait_for_selector(f"#count:has-text('{free} fixtures')")
