"""The setup sheet from the page is as complete as the command's."""

from __future__ import annotations

import re
from urllib.parse import parse_qs, urlsplit

import pytest
from walking import EXAMPLES, Walk

GIVEN = {
    "zero": "hole 1",
    "thickness": "12",
    "peg-length": "30",
    "peg-height": "8",
    "dowel": "6 mm m6 in H7",
    "clearance": "3",
    "machine-position-x": "-312.5",
    "machine-position-y": "-88",
    "friction": "0.15",
    "part-name": "door handle",
}


def open_sheet(walk: Walk) -> None:
    """Search for a fixture of the bracket on a plate, and open what else stands on its sheet."""
    walk.page.set_input_files("#file", EXAMPLES / "bracket.dxf")
    walk.seen("#faces button")
    walk.search()
    walk.page.click("#sheet-details summary")


def asked(walk: Walk) -> dict[str, str]:
    """What the link to the sheet asks for."""
    query = parse_qs(urlsplit(str(walk.page.get_attribute("#take-sheet", "href"))).query)
    return {name: values[0] for name, values in query.items() if len(values) == 1} | {
        f"{name}_{axis}": value
        for name, values in query.items()
        if len(values) == 2
        for axis, value in zip("xy", values, strict=True)
    }


def test_everything_of_the_sheet_can_be_given(walk: Walk) -> None:
    """All that the command knows, lengths in the unit shown; a link brings it back; it stands on the paper."""
    page = walk.page
    open_sheet(walk)
    for name, value in GIVEN.items():
        page.fill(f"#sheet-{name}", value)
    page.press("#sheet-part-name", "Tab")
    page.check("#sheet-seating")
    page.select_option("#paper", "letter")
    query = asked(walk)
    wanted = {name.replace("-", "_"): value for name, value in GIVEN.items()}
    assert {name: query[name] for name in wanted} == wanted
    assert (query["paper"], query["unit"], query["seating"]) == ("letter", "mm", "true")
    sheet = re.sub(r"<[^>]+>", " ", walk.saved("#take-svg").decode())
    for words in (
        "door handle",
        "centre of hole 1",
        "12.000 mm",
        "30.000 mm",
        "8.000 mm",
        "6 mm m6 in H7",
        "G21 G10 L2 P1 X-267.500 Y-66.000",
        "end up there?",
    ):
        assert words in sheet
    assert walk.saved("#take-sheet").startswith(b"%PDF")
    assert walk.saved("#take-pins").decode().count("6 mm m6 in H7") == 3
    page.select_option("#unit", "inch")
    assert float(asked(walk)["thickness"]) == pytest.approx(12 / 25.4)
    assert float(page.input_value("#sheet-clearance")) == pytest.approx(3 / 25.4)
    page.select_option("#unit", "mm")
    walk.reload()
    walk.searched()
    assert {name: page.input_value(f"#sheet-{name}") for name in GIVEN} == GIVEN
    assert asked(walk) == query and page.is_checked("#sheet-seating")
    assert page.input_value("#paper") == "letter"


def test_the_cutter_keeps_off_the_pegs(walk: Walk) -> None:
    """A circle about each peg, as far from it as is typed, and none where nothing is."""
    page = walk.page
    open_sheet(walk)
    circles = page.locator("#drawing-fixture .keep-out")
    assert circles.count() == 0
    page.fill("#sheet-clearance", "2.5")
    page.press("#sheet-clearance", "Tab")
    walk.seen("#drawing-fixture .keep-out")
    sizes = sorted(float(circle.get_attribute("r") or "nan") for circle in circles.all())
    # Three dowels of 6 mm and a tip of 10 mm.
    assert sizes == [5.5, 5.5, 5.5, 7.5]
    page.fill("#sheet-clearance", "-1")
    page.press("#sheet-clearance", "Tab")
    assert page.get_attribute("#sheet-clearance", "aria-invalid") == "true"
    assert asked(walk)["clearance"] == "2.5"
    page.fill("#sheet-clearance", "")
    page.press("#sheet-clearance", "Tab")
    page.wait_for_selector("#drawing-fixture .keep-out", state="detached")
    assert "clearance" not in asked(walk)


def test_what_the_sheet_is_refused_for_is_told_on_the_page(walk: Walk) -> None:
    """A zero that there is not is a sentence beside the button, gone with the next sheet."""
    page = walk.page
    open_sheet(walk)
    page.fill("#sheet-zero", "hole 9")
    page.press("#sheet-zero", "Tab")
    page.click("#take-sheet")
    assert "holes 1 to 3" in walk.seen("#take-trouble").inner_text()
    page.fill("#sheet-zero", "centre")
    page.press("#sheet-zero", "Tab")
    assert walk.saved("#take-sheet").startswith(b"%PDF")
    assert page.locator("#take-trouble").is_hidden()
    walk.troubles = [line for line in walk.troubles if "400" not in line]
