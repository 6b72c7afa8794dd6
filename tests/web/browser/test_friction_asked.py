"""What is asked where friction holds the part: the force that is closed with, and the safety factor, on the page."""

from __future__ import annotations

import os

import pytest
from walking import EXAMPLES, Walk

LOADED = """async () => {
  const { change } = await import("/static/state.js");
  change({ loads: [{ points: [[30, 20]], force: 150, directions: [0, 0] }], sheet: { thickness: 12 } });
}"""


@pytest.mark.parametrize(("preset", "at"), [("strap-plate-20mm", "at each tip"), ("plain-vise-4-inch", "")])
def test_the_force_given_is_asked_and_answered(walk: Walk, preset: str, at: str) -> None:
    """Only where friction holds; with pegs neither is shown nor sent."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "plate.json")
    walk.seen("#faces button")
    assert page.locator("#friction-box").is_hidden() and page.locator("#seating-box").is_visible()
    page.select_option("#preset", preset)
    if preset.startswith("strap"):
        for name in ("#pitch-x", "#pitch-y"):
            page.fill(name, "10")
            page.press(name, "Tab")
    assert page.locator("#friction-box").is_visible() and page.locator("#seating-box").is_hidden()
    page.fill("#search-jaw-force", "2000")
    page.press("#search-jaw-force", "Tab")
    page.fill("#search-safety", "1.5")
    page.press("#search-safety", "Tab")
    page.evaluate(LOADED)
    page.click("#search")
    page.wait_for_selector('body[data-search="done"]')
    page.wait_for_selector("#list .row:not(.coming)")
    page.wait_for_selector("#quality tr")
    if shot := os.environ.get("SHOT"):
        page.screenshot(path=f"{shot}-{preset}.png", full_page=True)
    row = walk.shown()
    assert row["quality"]["safety_reached"] == pytest.approx(3000 / row["quality"]["clamp_needed"])
    words = page.inner_text("#pose-words")
    assert ("With 2000 N at each tip" in words) if at else ("Close the jaws with" in words)
    listed = page.locator("#list .row").first.inner_text()
    assert "holds times" in listed and "needs" in listed and "Type" not in listed
    figures = page.inner_text("#quality")
    assert "clamp needed" in figures and "safety reached" in figures
    assert page.locator("#pegs").is_visible() == bool(at)
    page.select_option("#preset", "plate-20mm")
    assert page.locator("#friction-box").is_hidden()
    asked = page.evaluate("async () => (await import('/static/state.js')).request()")
    assert "safety" not in asked and "jaw_force" not in asked


def test_a_plain_vise_has_a_work_stop_or_none(walk: Walk) -> None:
    """Its fields are read, and a set-up is drawn and told, with the opening as its one length."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "plate.json")
    walk.seen("#faces button")
    page.select_option("#preset", "plain-vise-4-inch")
    stops = page.locator("#stop option").all_inner_texts()
    assert stops == ["none", "at the left end", "at the right end", "left and right, each a set-up"]
    assert page.locator("#stop").evaluate("(one) => one.selectedOptions[0].textContent") == "none"
    page.evaluate(LOADED)
    titles = []
    for chosen in ("at the right end", "none"):
        page.select_option("#stop", label=chosen)
        page.click("#search")
        page.wait_for_selector('body[data-search="done"]')
        page.wait_for_selector("#list .row:not(.coming)")
        titles.append(walk.shown()["title"])
    assert titles[0].endswith("stop right") and "stop" not in titles[1]
    assert "from the left end of the fixed jaw" in page.inner_text("#pose-words")
    walk.seen("#drawing-fixture .travel")
