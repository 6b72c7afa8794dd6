"""A plate with straps on the page: asked for, listed, drawn with its supports, and how it is set up in words."""

from __future__ import annotations

import pytest
from walking import EXAMPLES, Walk

LOADED = """async () => {
  const { change } = await import("/static/state.js");
  change({ loads: [{ points: [[30, 20]], force: 150, directions: [0, 0] }], sheet: { thickness: 12 } });
}"""


@pytest.mark.parametrize("over", ["the plate", "three supports"])
def test_a_seat_under_straps_is_shown(walk: Walk, over: str) -> None:
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "plate.json")
    walk.seen("#faces button")
    page.select_option("#preset", "strap-plate-20mm")
    for name in ("#pitch-x", "#pitch-y"):
        page.fill(name, "10")
        page.press(name, "Tab")
    page.click("#more-title")
    page.select_option("#over", label=over)
    page.evaluate(LOADED)
    walk.search()
    hold = walk.shown()["hold"]
    assert len(hold["straps"]) == 2 and len(hold["supports"]) == (3 if over == "three supports" else 0)
    walk.seen("#drawing-fixture .strap")
    words = page.inner_text("#pose-words")
    assert words.startswith("Part turned by") and "tighten the straps" in words
    assert page.inner_text("#pegs tr td:last-child") == "–"
    assert page.locator("#drawing-fixture .forces *").count() == 0
    # What only pegs are asked for is not offered.
    for button in ("#push", "#try", "#close-vise"):
        assert page.locator(button).is_hidden()
    page.click("#pin")
    page.locator("#list .row").nth(1).click()
    walk.arrived()
