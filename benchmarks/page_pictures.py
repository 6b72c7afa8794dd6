"""The pictures of the page in the manual, by ``python benchmarks/page_pictures.py ADDRESS`` of a running ``workhold serve``.

Needs Playwright for Python and a Chromium, as the tests of the page do.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
IMAGES, BRACKET = HERE.parent / "docs" / "images", HERE.parent / "examples" / "bracket.dxf"
DESK, PHONE = {"width": 1360, "height": 850}, {"width": 390, "height": 800}
# A drawing that does not say its unit, with three parts on it.
ASKING = {
    "name": "three parts.svg",
    "mimeType": "image/svg+xml",
    "buffer": b"""<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H120V60A20 20 0 0 1 100 80H0Z"/>
<circle cx="95" cy="25" r="8"/><path d="M140 0H200V40H140Z"/><path d="M140 55H170V80H140Z"/></svg>""",
}


def found(page: Any) -> None:
    """Wait until the search is over and its first fixture is shown."""
    page.wait_for_selector('body[data-search="done"]', timeout=120_000)
    page.wait_for_selector("#list .row:not(.coming)")


def on_a_plate(page: Any) -> None:
    """The bracket on the plate that comes first."""
    page.set_input_files("#file", BRACKET)
    page.wait_for_selector("#faces button", state="attached")
    page.click("#search-here" if page.is_visible("#search-here") else "#search")
    found(page)


def fixture(page: Any) -> None:
    """A fixture with all that there is to take away."""
    on_a_plate(page)
    page.wait_for_selector("#warnings-card, #pegs tr")


def force(page: Any) -> None:
    """A force pushed on the part."""
    on_a_plate(page)
    page.click("#push")
    page.fill("#force-size", "300")
    page.fill("#force-direction", "200")
    page.press("#force-direction", "Tab")
    page.wait_for_selector("#resist-words button")


def tried(page: Any) -> None:
    """A part in the hand that came to rest in a wrong seat."""
    on_a_plate(page)
    page.click("#try")
    page.click("#seats .seat >> nth=3")
    page.fill("#try-opening", "0.05")
    page.click("#try-close")
    page.wait_for_selector("#try-words.bad:has-text('wrong')")


def compare(page: Any) -> None:
    """Two fixtures in a vise, side by side."""
    page.select_option("#preset", "plate-20mm")
    on_a_plate(page)
    page.click("#pin")
    page.click("#list .row >> nth=2")
    page.wait_for_selector("#board-title:has-text('Shown')")


def none(page: Any) -> None:
    """Why there is no fixture on a plate that is too small."""
    page.fill("#columns", "2")
    page.fill("#rows", "2")
    page.press("#rows", "Tab")
    page.set_input_files("#file", BRACKET)
    page.wait_for_selector("#faces button")
    page.click("#search")
    page.wait_for_selector("#why .helps", timeout=120_000)


def question(page: Any) -> None:
    """A file that leaves its unit and its part open."""
    page.set_input_files("#file", ASKING)
    page.click("#file-asks [data-unit=mm]")
    page.wait_for_selector("#drawing-part .other-part")


def phone(page: Any) -> None:
    """The drawing on a phone."""
    on_a_plate(page)
    page.click("#list .row >> nth=0")
    page.wait_for_selector("#drawing-fixture .peg")


PICTURES = {
    "page-fixture": (fixture, DESK, "light"),
    "page-force": (force, DESK, "light"),
    "page-try": (tried, DESK, "light"),
    "page-compare-dark": (compare, DESK, "dark"),
    "page-none": (none, DESK, "light"),
    "page-question": (question, DESK, "light"),
    "page-phone": (phone, PHONE, "light"),
}


def main(address: str) -> None:
    """Make all pictures of the page at an address."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for name, (act, size, scheme) in PICTURES.items():
            context = browser.new_context(viewport=size, color_scheme=scheme, reduced_motion="reduce")
            page = context.new_page()
            page.goto(address)
            page.wait_for_selector("body[data-ready]")
            act(page)
            # What is asked of the server after a moment of quiet.
            page.wait_for_load_state("networkidle")
            page.mouse.move(5, 5)
            page.screenshot(path=IMAGES / f"{name}.png")
            context.close()
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1])
