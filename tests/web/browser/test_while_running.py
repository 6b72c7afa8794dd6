"""What the page shows of a search that is not over yet."""

from __future__ import annotations

import json
from pathlib import Path

from walking import EXAMPLES, SEARCH_PATIENCE, Walk

NEW_SEARCH = "state.job?.job && state.job.job !== given"
SAME_FORCE = (
    "() => import('/static/state.js').then(({ change, state }) => change({ force: { ...state.force } }))"
)
# In one go, as somebody quick would.
PUSH_AND_SEARCH = "for (const id of ['push', 'search']) document.getElementById(id).click();"


def search_for_long(walk: Walk) -> None:
    """A search that shows its first fixtures long before its end."""
    page = walk.page
    walk.take("8Handle", None)
    page.select_option("#toolkit", "vise")
    for name, value in (("#peg-radius", "1.4"), ("#columns", "10"), ("#pitch-x", "3"), ("#pitch-y", "3")):
        page.fill(name, value)
    page.press("#pitch-y", "Tab")
    page.click("#search")
    walk.seen("#progress-row")
    walk.seen("#list .row:not(.coming)", SEARCH_PATIENCE)
    walk.seen("#drawing-fixture [data-peg]", SEARCH_PATIENCE)


def test_the_first_fixtures_show_while_the_search_runs(walk: Walk) -> None:
    """Rows and a drawing come before the end; files wait for it; settings changed then leave nothing behind."""
    page = walk.page
    search_for_long(walk)
    assert page.get_attribute("body", "data-search") in ("running", "listing")
    assert page.get_attribute("#take-sheet", "href") is None
    old = walk.job()
    page.fill("#peg-radius", "1.5")
    page.press("#peg-radius", "Tab")
    page.wait_for_selector("#list .row", state="detached")
    assert page.locator("#drawing-fixture [data-peg]").count() == 0
    page.wait_for_selector('body[data-search="running"]', timeout=SEARCH_PATIENCE)
    assert walk.job() != old
    assert walk.server.client.get(f"/api/jobs/{old}").status_code == 404
    page.click("#cancel")
    page.wait_for_selector("#progress-row", state="hidden", timeout=SEARCH_PATIENCE)
    assert page.get_attribute("body", "data-search") == "cancelled"


def test_a_force_waits_for_the_first_fixtures(walk: Walk) -> None:
    """Which fixture resists best is asked once there are some, and again when there are others."""
    page = walk.page
    search_for_long(walk)
    old = walk.job()
    page.evaluate(PUSH_AND_SEARCH)
    walk.until(NEW_SEARCH, old)
    walk.seen("#resist-words button", SEARCH_PATIENCE)
    assert walk.shown()["rank"] == 1
    page.click("#cancel")
    page.wait_for_selector("#progress-row", state="hidden", timeout=SEARCH_PATIENCE)
    with page.expect_request(lambda request: request.url.endswith(f"/api/jobs/{walk.job()}/resist")):
        page.evaluate(SAME_FORCE)
    link = walk.seen("#resist-words button")
    rank = link.inner_text().split(":")[0]
    link.click()
    walk.seen(f"#quality-heads:has-text('Fixture {rank}')")


def test_a_search_that_the_server_has_not_taken_yet_can_be_cancelled(walk: Walk) -> None:
    """It is said that it was, and what the server answers later is dropped."""
    page = walk.page
    walk.take()
    page.evaluate("""() => {
      const real = window.fetch;
      window.fetch = async (address, options) => {
        if (String(address).endsWith("/jobs")) await new Promise((go) => { window.answer = go; });
        return real(address, options);
      };
    }""")
    page.click("#search")
    page.wait_for_function("() => Boolean(window.answer)", timeout=SEARCH_PATIENCE)
    page.click("#cancel")
    assert page.inner_text("#count") == "Search cancelled"
    with page.expect_response(lambda response: response.request.method == "DELETE"):
        page.evaluate("() => window.answer()")
    assert page.inner_text("#count") == "Search cancelled"


# The file is read once the test says so.
HELD_BACK = """() => {
  const real = window.fetch;
  window.fetch = async (address, options) => {
    if (String(address).includes("parts/survey")) await new Promise((go) => { window.read = go; });
    return real(address, options);
  };
}"""


def test_a_search_waits_for_the_part_that_is_read(walk: Walk) -> None:
    """Pressed while the file is being read, it begins when it is; it can be cancelled before."""
    page = walk.page
    page.select_option("#preset", "plate-20mm")
    page.evaluate(HELD_BACK)
    page.set_input_files("#file", EXAMPLES / "bracket.dxf")
    page.wait_for_function("() => Boolean(window.read)")
    page.click("#search")
    assert page.get_attribute("body", "data-search") == "waiting"
    assert "bracket.dxf is being read" in page.inner_text("#count-words")
    page.click("#cancel")
    assert page.inner_text("#count") == "Search cancelled"
    page.click("#search")
    page.evaluate("() => window.read()")
    walk.searched()
    assert walk.count() > 0 and walk.page.inner_text("#part-words").startswith("bracket")


def test_a_search_that_waits_for_a_file_that_is_none_is_left(walk: Walk, tmp_path: Path) -> None:
    page, broken = walk.page, tmp_path / "broken.dxf"
    broken.write_text("no drawing")
    page.evaluate(HELD_BACK)
    page.set_input_files("#file", broken)
    page.wait_for_function("() => Boolean(window.read)")
    page.click("#search")
    page.evaluate("() => window.read()")
    walk.seen("#part-trouble")
    walk.until("state.reading === '' && state.job === null")
    assert page.get_attribute("body", "data-search") == "none"


# A search as the server tells it, in a stage of its own.
STAGE = """async (more) => {
  const { change } = await import("/static/state.js");
  const job = { job: null, state: "running", fraction: 0, found: 0, best: 0, revision: 0, notes: [] };
  change({ job: { ...job, ...more } });
  return ["#count", "#count-words"].map((id) => document.querySelector(id).textContent);
}"""


def test_what_is_searched_is_never_said_to_be_all(walk: Walk) -> None:
    """What is known by then is said instead: that it is put in order, or that the best are found."""
    title, words = walk.page.evaluate(STAGE, {"state": "listing", "fraction": 1.0})
    assert title == "Looking for the best" and words == "The fixtures found are being put in order."
    title, words = walk.page.evaluate(STAGE, {"fraction": 0.7})
    assert title == "Looking for the best" and words == "70 % searched."
    title, words = walk.page.evaluate(STAGE, {"fraction": 1.0, "found": 7})
    assert title == "7 fixtures so far" and words == "99 % searched."
    title, words = walk.page.evaluate(STAGE, {"fraction": 0.431, "found": 1234, "best": 20})
    assert title == "The best 20" and "43 % searched; 1,234 fixtures so far" in words.replace("\u202f", ",")


def test_the_best_are_on_show_before_all_are_found(walk: Walk) -> None:
    """The first row of the list is then the first of all, and stays it."""
    page = walk.page
    search_for_long(walk)
    walk.until("state.job?.best === 20 || state.job?.state === 'done'")
    job = f"/api/jobs/{walk.job()}/fixtures"
    first = walk.server.client.get(job, params={"limit": 1}).json()["rows"][0]["holes"]
    # What was found before the best has been shown until their rows come.
    walk.until("JSON.stringify(state.selected?.holes) === given", json.dumps(first, separators=(",", ":")))
    if page.get_attribute("body", "data-search") != "done":
        page.click("#cancel")
        page.wait_for_selector("#progress-row", state="hidden", timeout=SEARCH_PATIENCE)
        # What was found when it was stopped comes after them.
        walk.until("state.selected?.rank === 1")
        assert walk.shown()["holes"] == first
