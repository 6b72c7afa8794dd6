"""The list, the forces, the comparison, and what is said when there is no fixture."""

from __future__ import annotations

import pytest
from walking import SEARCH_PATIENCE, Walk


def test_the_list_of_ten_thousand_has_few_rows_in_the_page(walk: Walk) -> None:
    """Whatever is scrolled to, some twenty rows exist, and the last one is the last fixture."""
    page = walk.page
    page.select_option("#builtin", "widget")
    walk.seen("#faces button")
    page.select_option("#preset", "gripper-two-columns")
    for name, value in (("#pitch-x", "6"), ("#pitch-y", "6"), ("#columns", "3")):
        page.fill(name, value)
    page.press("#columns", "Tab")
    walk.search()
    count = walk.count()
    assert count > 10_000
    most = page.evaluate(
        """async () => {
          const list = document.querySelector("#list");
          let most = 0;
          for (let share = 0; share <= 1.0001; share += 0.02) {
            list.scrollTop = share * (list.scrollHeight - list.clientHeight);
            await new Promise(requestAnimationFrame);
            most = Math.max(most, list.querySelectorAll(".row").length);
          }
          return most;
        }"""
    )
    assert most < 40
    last = walk.seen(f'#list [aria-posinset="{count}"]:not(.coming)')
    assert last.inner_text().startswith(str(count))


def test_filters_keep_only_what_matches(walk: Walk) -> None:
    """By type, by face and by angle; the count of matches is the server's."""
    page = walk.page
    walk.take()
    walk.search()
    page.select_option("#filter-type", "II")
    walk.seen("#count-words:has-text('match')")
    assert "Type II" in walk.seen("#list .row:not(.coming)").inner_text()
    page.select_option("#filter-face", "4")
    page.fill("#filter-angle", "0..180")
    page.press("#filter-angle", "Enter")
    query = "type=II&face=4&angle=0..180"
    total = walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures?{query}").json()["total"]
    walk.seen(f"#count-words:has-text('{total} match')")


def test_a_dragged_force_is_answered_as_the_server_answers_it(walk: Walk) -> None:
    """Bars and jaw force, solved in the page, are those of statics.loads; the best fixture is the server's."""
    page = walk.page
    walk.take()
    walk.search()
    page.click("#push")
    row = walk.shown()
    x0, y0 = walk.point(row["x"], row["y"], "fixtureDrawing")
    walk.drag((x0 + 12, y0 + 25), (x0 + 70, y0 - 35))
    force = page.evaluate("async () => (await import('/static/state.js')).state.force")
    assert force["size"] > 0
    load = {
        "points": [[force["x"], force["y"]]],
        "force": force["size"],
        "directions": [force["direction"]] * 2,
        "moment": force["moment"],
    }
    url = f"/api/jobs/{walk.job()}"
    case = walk.server.client.post(f"{url}/fixtures/{row['rank']}/loads", json={"loads": [load]}).json()["cases"][0]
    mine = page.evaluate(
        """async () => {
          const { state } = await import("/static/state.js");
          const { reactions } = await import("/static/forces.js");
          return reactions(state.part, state.selected, state.force);
        }"""
    )
    assert mine["forces"] == pytest.approx(case["largest"], abs=1e-6 * force["size"])
    assert mine["needed"] == pytest.approx(case["needed"]["value"], abs=1e-6 * force["size"])
    bars = page.locator("#bars .bar").all_inner_texts()
    assert [bar.split()[0] for bar in bars] == row["holes"]
    best = walk.server.client.post(f"{url}/resist", json={"loads": [load]}).json()["best"][0]
    link = walk.seen("#resist-words button")
    assert link.inner_text().startswith(f"{best['rank']}:")
    link.click()
    walk.seen(f"#quality-heads:has-text('Fixture {best['rank']}')")
    assert walk.shown()["rank"] == best["rank"]
    with page.expect_request(lambda request: request.url.endswith("/api/jobs")):
        page.click("#rank-load")
    walk.searched()
    assert walk.shown()["quality"]["load_reaction"] == pytest.approx(best["load_reaction"])


def test_two_fixtures_side_by_side(walk: Walk) -> None:
    """A pinned fixture stays while others are stepped through, and the better figures are marked."""
    page = walk.page
    walk.take()
    walk.search()
    page.click("#pin")
    first = walk.shown()
    page.keyboard.press("ArrowRight")
    walk.seen("#board-title:has-text('Shown: 2')")
    assert page.locator("#drawing-pinned .peg").count() == page.locator("#drawing-fixture .peg").count() == 4
    assert f"{first['rank']} pinned" in page.inner_text("#quality-heads")
    better = page.locator("#quality td.better").count()
    assert better >= 1
    page.click("#unpin")
    page.wait_for_selector("#board-pinned", state="hidden")


def test_pointing_at_a_peg_tells_its_hole(walk: Walk) -> None:
    """Hole, face and force beside the peg, and its line of the table marked."""
    walk.take()
    walk.search()
    row = walk.shown()
    walk.page.hover("#drawing-fixture .peg >> nth=0")
    words = walk.seen("#peg-words").inner_text()
    index = int(walk.page.locator("#drawing-fixture .peg >> nth=0").get_attribute("data-peg"))
    assert row["holes"][index] in words
    assert f"face {row['faces'][index]}" in words
    assert walk.page.locator("#pegs tr.marked td").first.inner_text() == row["holes"][index]


def test_no_fixture_is_explained_and_helped(walk: Walk) -> None:
    """Rules with what they took, the nearest miss drawn, and a change that helps made by a click."""
    page = walk.page
    walk.take()
    for face in range(13):
        page.click(f'#faces button[data-face="{face}"]')
    page.click("#search")
    walk.seen("#count:has-text('There is no fixture')", SEARCH_PATIENCE)
    walk.seen("#why h3", SEARCH_PATIENCE)
    assert page.inner_text("#why .last td:last-child") == "0"
    assert page.locator("#drawing-fixture .peg").count() == 4
    page.click("#why .helps button >> nth=0")
    walk.searched()
    assert walk.count() > 0
    assert page.locator("#why").is_hidden()


def test_the_sweep_tells_which_vise_suits(walk: Walk) -> None:
    """A line for each preset; one of them is taken by its button."""
    page = walk.page
    walk.take(pitch=None)
    page.click("#sweep")
    page.wait_for_selector("#vises-progress", state="hidden", timeout=SEARCH_PATIENCE)
    presets = [vise["name"] for vise in walk.server.client.get("/api/vises").json()]
    assert sorted(page.locator("#vises-table th[scope=row]").all_inner_texts()) == sorted(presets)
    page.click("#vises-table button[aria-label='Use plate-25mm']")
    assert page.input_value("#preset") == "plate-25mm"
    assert float(page.input_value("#pitch-x")) == 25
