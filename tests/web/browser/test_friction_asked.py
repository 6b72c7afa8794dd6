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


def test_forces_are_typed_and_answered_one_by_one(walk: Walk) -> None:
    """With the part's thickness and the friction; pegs' own questions are not asked, and wrong numbers are marked."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "plate.json")
    walk.seen("#faces button")
    page.select_option("#preset", "plain-vise-4-inch")
    for left_out in ("#zones-box", "#supports", "#search-contact-margin", "#search-max-location-error"):
        assert page.locator(left_out).is_hidden()
    page.click("#search")
    page.wait_for_selector('body[data-search="done"]')
    page.wait_for_selector("#quality tr")
    assert "How thick the part is, is not known" in page.inner_text("#pose-words")
    assert "grip" not in page.inner_text("#quality") and page.locator("#needs-box").is_hidden()
    page.fill("#part-thickness", "20")
    page.press("#part-thickness", "Tab")
    page.fill("#part-friction", "0.2")
    page.press("#part-friction", "Tab")
    page.fill("#load-force", "-5")
    page.click("#load-add")
    assert page.get_attribute("#load-force", "aria-invalid") == "true"
    assert page.locator("#loads li").count() == 0
    page.fill("#load-force", "300")
    page.click("#load-add")
    for name, value in (
        ("force", "200"),
        ("direction", "90"),
        ("upward", "50"),
        ("x", "30"),
        ("y", "20"),
        ("height", "15"),
    ):
        page.fill(f"#load-{name}", value)
    page.press("#load-height", "Enter")
    assert page.locator("#loads li").count() == 2 and page.locator("#load-words").is_hidden()
    assert "200 N toward 90.0°, 50 N up at (30.0 mm, 20.0 mm), 15.0 mm high" in page.inner_text("#loads")
    asked = page.evaluate("async () => (await import('/static/state.js')).request()")
    assert asked["thickness"] == 20 and asked["friction"] == {"jaw": 0.2}
    assert asked["loads"][1] == {
        "points": [[30, 20]],
        "force": 200,
        "directions": [90, 90],
        "upward": 50,
        "height": 15,
    }
    page.fill("#search-jaw-force", "9000")
    page.press("#search-jaw-force", "Tab")
    page.wait_for_selector("#needs tr:nth-child(2)", state="attached")
    walk.until("state.selected?.hold?.safety_each?.length === 2")
    hold = page.evaluate("async () => (await import('/static/state.js')).state.selected.hold")
    words = page.inner_text("#needs")
    for need, times in zip(hold["clamp_needed_each"], hold["safety_each"], strict=True):
        assert times == pytest.approx(2 * 9000 / need, abs=0.01) and times <= 2 * 9000 / need
        assert f"({times:g} times)" in words
    assert "Friction of the jaws 0.2" in page.inner_text("#pose-words")
    page.click("#loads button[aria-label='Leave out force 1']")
    assert page.locator("#loads li").count() == 1
    # Another part is as thick as it is, and no force of the one before acts on it.
    page.set_input_files("#file", EXAMPLES / "plate.json")
    walk.until("state.loads.length === 0")
    assert page.evaluate("async () => 'thickness' in (await import('/static/state.js')).state.asked") is False
    page.select_option("#preset", "strap-plate-20mm")
    asked = page.evaluate("async () => (await import('/static/state.js')).request()")
    assert asked["friction"] == {"plate": 0.2, "tip": 0.2} and page.locator("#zones-box").is_visible()
