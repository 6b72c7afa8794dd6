"""A raw block on the page: asked for in a plain vise alone, drawn with the part in it, and set up in words."""

from __future__ import annotations

from walking import EXAMPLES, Walk

KNOWN = """async () => {
  const { change } = await import("/static/state.js");
  change({ sheet: { thickness: 12 } });
}"""


def test_a_raw_block_is_asked_for_and_shown(walk: Walk) -> None:
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "plate.json")
    walk.seen("#faces button")
    # Pegs cannot hold one.
    assert page.locator("#search-raw").is_hidden()
    page.select_option("#preset", "plain-vise-6-inch")
    page.evaluate(KNOWN)
    field = page.locator("#search-raw")
    field.evaluate(
        "one => { for (let at = one; at; at = at.parentElement) if (at.tagName === 'DETAILS') at.open = true; }"
    )
    field.fill("3, 2")
    field.press("Tab")
    assert field.get_attribute("aria-invalid") == "true"
    for typed in ("3,2,5", "3, 2, 5"):
        field.fill(typed)
        field.press("Tab")
        page.wait_for_function("document.querySelector('#search-raw').value === '3, 2, 5'")
        assert field.get_attribute("aria-invalid") == "false"
    page.click("#search")
    page.wait_for_selector('body[data-search="done"]')
    page.wait_for_selector("#list .row:not(.coming)")
    walk.until("state.selected?.hold")
    hold = walk.shown()["hold"]
    assert hold["steps"][0].startswith("Raw block of")
    page.wait_for_selector("#drawing-fixture .picture .finished", state="attached", timeout=15000)
    assert "Raw block of" in page.inner_text("#pose-words")
    page.select_option("#preset", "table-50mm")
    assert page.locator("#search-raw").is_hidden()
