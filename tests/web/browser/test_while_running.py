"""What the page shows of a search that is not over yet."""

from __future__ import annotations

from walking import SEARCH_PATIENCE, Walk


def test_the_first_fixtures_show_while_the_search_runs(walk: Walk) -> None:
    """Rows and a drawing come before the end; files wait for it; settings changed then leave nothing behind."""
    page = walk.page
    walk.take("8Handle", None)
    page.select_option("#toolkit", "vise")
    for name, value in (("#peg-radius", "1.4"), ("#columns", "7"), ("#pitch-x", "3"), ("#pitch-y", "3")):
        page.fill(name, value)
    page.press("#pitch-y", "Tab")
    page.click("#search")
    walk.seen("#progress-row")
    walk.seen("#list .row:not(.coming)", SEARCH_PATIENCE)
    walk.seen("#drawing-fixture .peg", SEARCH_PATIENCE)
    assert page.get_attribute("body", "data-search") in ("running", "listing")
    assert page.get_attribute("#take-sheet", "href") is None
    old = walk.job()
    page.fill("#peg-radius", "1.5")
    page.press("#peg-radius", "Tab")
    page.wait_for_selector("#list .row", state="detached")
    assert page.locator("#drawing-fixture .peg").count() == 0
    page.wait_for_selector('body[data-search="running"]', timeout=SEARCH_PATIENCE)
    assert walk.job() != old
    assert walk.server.client.get(f"/api/jobs/{old}").status_code == 404
    page.click("#cancel")
    page.wait_for_selector("#progress-row", state="hidden", timeout=SEARCH_PATIENCE)
    assert page.get_attribute("body", "data-search") == "cancelled"
