"""The page behind a reverse proxy that serves it below a path of its own."""

from __future__ import annotations

from typing import Any

from reverse_proxy import reverse_proxy
from running_server import RunningServer
from walking import SEARCH_PATIENCE, Walk


def test_the_whole_way_works_below_a_path(server: RunningServer, browser: Any) -> None:
    """A search begins, is watched and shown, and nothing is asked for outside the path."""
    with reverse_proxy(str(server.client.base_url).rstrip("/"), "/shop/pegs") as address:
        context = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
        walk, failed = Walk(context.new_page(), server), []
        walk.page.on("response", lambda answer: failed.append(answer.url) if answer.status >= 400 else None)
        walk.open(f"{address}/")
        walk.take("widget", None)
        walk.page.click("#search")
        walk.seen("#list .row:not(.coming)", SEARCH_PATIENCE)
        walk.page.wait_for_selector('body[data-search="done"]', timeout=SEARCH_PATIENCE)
        sheet = walk.page.get_attribute("#take-sheet", "href")
        context.close()
    assert walk.troubles == [] and failed == []
    assert sheet is not None and not sheet.startswith("/")
    assert all(asked.startswith((f"{address}/", "data:", "blob:")) for asked in walk.asked)
