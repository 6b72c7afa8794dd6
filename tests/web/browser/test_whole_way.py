"""From a file to a setup sheet, as a visitor goes; also where a reverse proxy serves the page below a path of its own."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest
from reverse_proxy import reverse_proxy
from running_server import LONG, RunningServer
from walking import EXAMPLES, SEARCH_PATIENCE, Walk


def test_from_a_dxf_to_a_setup_sheet(walk: Walk) -> None:
    """Upload, forbid a face by a click, search, sort, step, take the files away; nothing touches the forbidden face."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "bracket.dxf")
    walk.seen("#faces button")
    x, y = walk.point(60, 0)
    page.mouse.click(x, y)
    walk.seen('#faces button[data-face="0"][aria-pressed="true"]')
    walk.search()
    assert walk.count() > 1000
    assert 0 not in walk.shown()["faces"]

    page.select_option("#sort", "closure_margin")
    walk.seen(".row-figure.sorted")
    page.click("#list .row >> nth=0")
    best = walk.shown()["quality"]["closure_margin"]
    page.keyboard.press("ArrowRight")
    page.wait_for_selector('#list [aria-posinset="2"][aria-selected="true"]')
    walk.seen("#place:has-text('2 of')")
    second = walk.shown()
    assert second["quality"]["closure_margin"] <= best
    assert walk.holes() == second["holes"]

    assert walk.saved("#take-sheet").startswith(b"%PDF")
    assert b"<svg" in walk.saved("#take-svg")
    assert b"LWPOLYLINE" in walk.saved("#take-dxf") or b"LINE" in walk.saved("#take-dxf")
    result = json.loads(walk.saved("#take-json"))
    assert len(result["fixtures"]) == walk.count()
    assert walk.saved("#take-csv").count(b"\n") >= walk.count()


def test_a_reload_and_a_link_restore_everything(walk: Walk) -> None:
    """Search, order, fixture and forbidden faces come back, also where the server has forgotten the search."""
    page = walk.page
    walk.take()
    page.click('#faces button[data-face="3"]')
    walk.search()
    page.select_option("#sort", "wrench_radius")
    page.wait_for_selector(".row-figure.sorted")
    page.click("#list .row >> nth=2")
    walk.seen("#place:has-text('3 of')")
    holes, count, job = walk.holes(), walk.count(), walk.job()
    page.wait_for_url(re.compile("#.{100,}"))

    walk.reload()
    walk.searched()
    walk.seen("#drawing-fixture")
    assert (walk.holes(), walk.count(), walk.job()) == (holes, count, job)
    assert page.input_value("#sort") == "wrench_radius"

    link = page.url
    walk.server.client.delete(f"/api/jobs/{job}")
    page.goto("about:blank")
    walk.open(link)
    walk.searched()
    walk.seen("#drawing-fixture")
    assert (walk.holes(), walk.count()) == (holes, count)
    assert walk.job() != job
    assert page.get_attribute('#faces button[data-face="3"]', "aria-pressed") == "true"
    # The forgotten search was asked for once.
    walk.troubles = [line for line in walk.troubles if "404" not in line]


def test_new_settings_leave_nothing_of_the_old_search(walk: Walk) -> None:
    """A change empties the list, searches anew and has the old job deleted."""
    walk.take()
    walk.search()
    old, count = walk.job(), walk.count()
    with walk.page.expect_request(lambda request: request.method == "DELETE"):
        walk.page.click('#faces button[data-face="0"]')
    assert walk.page.locator("#list .row").count() == 0 or walk.page.locator("#list").is_hidden()
    walk.searched()
    assert walk.job() != old
    assert walk.count() < count
    assert walk.server.client.get(f"/api/jobs/{old}").status_code == 404


def test_a_search_that_the_server_forgot_is_done_again(walk: Walk) -> None:
    """Who comes back late and scrolls on sees the same fixtures."""
    walk.take()
    walk.search()
    old, count = walk.job(), walk.count()
    walk.server.client.delete(f"/api/jobs/{old}")
    with walk.page.expect_request(lambda request: request.url.endswith("/api/jobs")):
        walk.page.select_option("#sort", "end_distance")
    walk.searched()
    assert walk.count() == count
    assert walk.job() != old
    walk.troubles = [line for line in walk.troubles if "404" not in line]


def test_a_search_can_be_cancelled(walk: Walk) -> None:
    """While it runs there is a count and a button; after that the page says that it is not all."""
    page = walk.page
    walk.take("8Handle", None)
    page.select_option("#toolkit", "vise")
    vise = LONG["toolkit"]
    for name, value in (
        ("#peg-radius", vise["peg_radius"]),
        ("#columns", vise["columns"]),
        ("#pitch-x", 3),
        ("#pitch-y", 3),
    ):
        page.fill(name, str(value))
    page.press("#pitch-y", "Tab")
    page.click("#search")
    walk.seen("#progress-row")
    walk.seen("#count:has-text('so far')")
    page.click("#cancel")
    page.wait_for_selector("#progress-row", state="hidden", timeout=SEARCH_PATIENCE)
    assert re.search("not all|cancelled", page.inner_text("#count"))


@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_lengths_are_told_in_the_unit_chosen(walk: Walk, unit: str) -> None:
    """The jaw separation of the drawing and the fields of the vise follow the unit; the search does not."""
    walk.take()
    walk.search()
    walk.page.select_option("#unit", unit)
    size = walk.shown()["jaw_separation"] / (25.4 if unit == "inch" else 1)
    words = f"{size:.4f} in" if unit == "inch" else f"{size:.3f} mm"
    assert words in walk.page.inner_text("#pose-words")
    assert float(walk.page.input_value("#pitch-x")) == pytest.approx(8 / (25.4 if unit == "inch" else 1))
    assert walk.page.locator("#list .row").count() > 0


@pytest.mark.parametrize(
    ("unit", "words"),
    [
        ("mm", ["896 MPa", "1000 N", "1000 N", "1000 N"]),
        ("inch", ["130.0 ksi", "225 lbf (1000 N)", "225 lbf (1000 N)", "225 lbf"]),
    ],
)
def test_forces_and_stresses_are_told_in_the_unit_chosen(walk: Walk, unit: str, words: list[str]) -> None:
    """As the sheet tells them: pounds and ksi with inches, newtons beside where there is room."""
    walk.page.select_option("#unit", unit)
    told = walk.page.evaluate(
        """async () => {
            const { figureText, forceAlone, forceText } = await import('/static/units.js');
            return [figureText({ key: "pin_stress", unit: "MPa" }, 896.2), figureText({ key: "load", unit: "N" }, 1000),
                forceText(1000), forceAlone(1000)];
        }"""
    )
    assert told == words


def test_forces_are_typed_in_the_unit_chosen(walk: Walk) -> None:
    """Pounds and foot-pounds with inches; what was not typed stays as it was to the last digit."""
    page = walk.page
    walk.take()
    walk.search()
    page.select_option("#unit", "inch")
    page.click("#push")
    labels = page.eval_on_selector_all(
        "#force-size, #force-moment, #force-jaw, #program-force",
        "fields => fields.map(each => each.closest('label').textContent)",
    )
    assert [label.split()[-2:] for label in labels] == [
        ["force", "lbf"],
        ["Force", "lbf"],
        ["ft", "lbf"],
        ["force", "lbf"],
    ]
    assert page.input_value("#force-size") == "45"
    page.fill("#force-size", "100")
    page.fill("#force-moment", "2")
    page.fill("#force-jaw", "50")
    force = page.evaluate("async () => (await import('/static/state.js')).state.force")
    pound = 4.4482216152605
    assert [force[key] for key in ("size", "moment", "jaw")] == pytest.approx(
        [100 * pound, 2 * 304.8 * pound, 50 * pound], rel=1e-12
    )
    assert "lbf" in page.inner_text("#force-title")
    page.focus("#unit")
    page.select_option("#unit", "mm")
    assert page.input_value("#force-size") == "444.822162"
    page.fill("#force-direction", "30")
    turned = page.evaluate("async () => (await import('/static/state.js')).state.force")
    assert turned == {**force, "direction": 30}


def test_no_edge_is_told_in_words(walk: Walk) -> None:
    """Where a part has no edge the figure is null, and better than any length."""
    told = walk.page.evaluate(
        """async () => {
            const { figureText } = await import('/static/units.js');
            const edge = { key: "edge_distance", unit: "mm" }, end = { ...edge, key: "end_distance" };
            return [figureText(edge, null), figureText(edge, 3), figureText(end, null)];
        }"""
    )
    assert told == ["none", "3.00 mm", "–"]


def test_the_keys_are_enough(walk: Walk) -> None:
    """Part, face, search, list and a peg without the mouse."""
    page = walk.page
    page.focus("#builtin")
    page.keyboard.type("widget")
    walk.seen("#faces button")
    page.select_option("#preset", "gripper-one-column")
    page.focus('#faces button[data-face="2"]')
    page.keyboard.press("Space")
    walk.seen('#faces button[data-face="2"][aria-pressed="true"]')
    page.focus("#search")
    page.keyboard.press("Enter")
    walk.searched()
    for box in ("#each", "#unfit"):
        page.focus(box)
        page.keyboard.press("Space")
    walk.seen(f'#list [aria-setsize="{walk.count()}"]:not(.coming)')
    page.focus("#list")
    page.keyboard.press("End")
    page.wait_for_selector(f'#list [aria-posinset="{walk.count()}"][aria-selected="true"]')
    page.keyboard.press("Home")
    page.wait_for_selector('#list [aria-posinset="1"][aria-selected="true"]')
    page.keyboard.press("ArrowDown")
    walk.seen("#place:has-text('2 of')")
    walk.arrived()
    page.focus("#drawing-fixture [data-peg]")
    assert walk.holes()[0] in walk.seen("#peg-words").inner_text()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.hasAttribute('data-peg')")


def test_a_phone_shows_one_section_at_a_time(walk: Walk) -> None:
    """The way from part to fixture at 390 pixels, and nothing sticks out."""
    page = walk.page
    page.set_viewport_size({"width": 390, "height": 800})
    walk.take()
    page.click("#search")
    walk.searched(shown=False)
    page.click("#list .row >> nth=1")
    walk.seen("#drawing-fixture")
    assert page.locator("#list").is_hidden()
    for section in ("settings", "stage", "results"):
        page.click(f".sections [data-to={section}]")
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        wide = page.evaluate(
            "[...document.querySelectorAll('button, a.button, input, select')].filter(e => e.offsetParent"
            " && e.getBoundingClientRect().right > 391).map(e => e.id)"
        )
        assert wide == []


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
        sheet = walk.page.wait_for_selector("#take-sheet[href]").get_attribute("href")
        context.close()
    assert walk.troubles == [] and failed == []
    assert sheet is not None and not sheet.startswith("/")
    assert all(asked.startswith((f"{address}/", "data:", "blob:")) for asked in walk.asked)
