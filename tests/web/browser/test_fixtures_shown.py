"""The list, the forces, the comparison, and what is said when there is no fixture."""

from __future__ import annotations

import base64
import json
import re
import zlib
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from walking import CLAMP_ENDS, SEARCH_PATIENCE, Walk


def test_a_list_of_thousands_has_few_rows_in_the_page(walk: Walk) -> None:
    """Whatever is scrolled to, some twenty rows exist, and the last one is the last fixture."""
    page = walk.page
    page.select_option("#builtin", "widget")
    walk.seen("#faces button")
    page.select_option("#preset", "gripper-two-columns")
    for name, value in (("#pitch-x", "8"), ("#pitch-y", "8"), ("#columns", "3")):
        page.fill(name, value)
    page.press("#columns", "Tab")
    walk.search()
    count = walk.count()
    assert count > 2_000
    page.check("#each")
    page.check("#unfit")
    # A list that comes in later begins at its top again.
    walk.seen(f'#list [aria-setsize="{count}"]:not(.coming)')
    most = page.evaluate(
        """async () => {
          const list = document.querySelector("#list");
          let most = 0;
          for (let share = 0; share <= 1.0001; share += 0.05) {
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


@pytest.mark.parametrize("sort", ["rank", "edge_distance"])
def test_a_fixture_of_an_earlier_stage_of_the_search_does_not_stay(walk: Walk, sort: str) -> None:
    """The list is changed before the last rows have come, so the fixture on show is of the stage before."""
    page = walk.page
    begun = changed = False

    def fixture(route: Any) -> None:
        """Tell the next fixture for the one asked for, until the list is changed."""
        rank = int(urlsplit(route.request.url).path.rpartition("/")[2])
        if not begun or changed:
            return route.continue_()
        response = route.fetch(url=route.request.url.replace(f"/{rank}?", f"/{rank + 1}?"))
        return route.fulfill(response=response, json={**response.json(), "rank": rank})

    def answer(route: Any) -> None:
        """Let the first rows miss the best fixture, and no others arrive until the list is changed."""
        nonlocal begun, changed
        if "together=false" in route.request.url:
            changed = True
            return route.continue_()
        if begun:
            return None
        response = route.fetch()
        told = response.json()
        begun = bool(told["rows"])
        told["rows"] = [{**row, "rank": at + 1} for at, row in enumerate(told["rows"][1:])]
        return route.fulfill(response=response, json=told)

    page.route("**/fixtures?*", answer)
    page.route(re.compile(r"/fixtures/\d+\?width"), fixture)
    walk.take()
    walk.search()
    stale = walk.shown()
    page.select_option("#sort", sort)
    page.check("#each")
    walk.until("String(state.selected.holes) !== String(given)", stale["holes"])
    shown = walk.shown()
    kept = walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures/{shown['rank']}").json()
    assert (
        (shown["holes"], shown["theta_deg"])
        == (kept["holes"], kept["theta_deg"])
        != (stale["holes"], stale["theta_deg"])
    )


def test_near_copies_are_one_row(walk: Walk) -> None:
    """With how many are like it, and what is not a fixture for a workshop is left out; both come when asked for."""
    page = walk.page
    walk.take()
    walk.search()
    # Before the search has come to its end, its best fixtures are told alone.
    walk.until("state.job.state === 'done'")
    walk.seen('#list [aria-posinset="1"]:not(.coming)')
    job = f"/api/jobs/{walk.job()}/fixtures"
    told = walk.server.client.get(job, params={"together": True, "unfit": False, "limit": 1000}).json()
    # Rows of the best that were found first stay until those of the whole search have come.
    entries = int(told["total"])
    walk.seen(f'#list .row[aria-setsize="{entries}"]')
    listed = entries + sum(row["like"] for row in told["rows"]) + told["unfit"]
    assert listed == walk.count()
    # The first entry of several shows how many are like it.
    index, like = next((k, row["like"]) for k, row in enumerate(told["rows"]) if row["like"])
    words = walk.seen(f'#list [aria-posinset="{index + 1}"]:not(.coming)').inner_text()
    assert f"+{like} alike" in words
    page.check("#each")
    page.check("#unfit")
    walk.seen(f'#list [aria-setsize="{walk.count()}"]:not(.coming)')


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
    query = "type=II&face=4&angle=0..180&together=true&unfit=false"
    total = walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures?{query}").json()["total"]
    walk.seen(f"#count-words:has-text('{total} match')")


def test_a_type_that_is_not_ticked_is_not_sought(walk: Walk) -> None:
    """The boxes are the vise's arrangements, the last ticked one stays so, and a reload keeps them."""
    page = walk.page
    walk.take()
    boxes = page.locator("#types input")
    assert boxes.evaluate_all("boxes => boxes.map((box) => box.value)") == ["I", "II"]
    boxes.first.uncheck()
    boxes.last.click()
    assert [box.is_checked() for box in boxes.all()] == [False, True]
    walk.search()
    job = walk.server.client.get(f"/api/jobs/{walk.job()}").json()
    assert job["counts"]["I"] == 0 < job["counts"]["II"]
    walk.reload()
    walk.seen("#types input:not(:checked)")
    assert [box.is_checked() for box in boxes.all()] == [False, True]
    assert page.locator("#filter-type option").all_inner_texts() == ["all", "I", "II"]


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
    case = walk.server.client.post(f"{url}/fixtures/{row['rank']}/loads", json={"loads": [load]}).json()[
        "cases"
    ][0]
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


def test_the_jaw_chosen_counts_in_bars_sheet_and_warnings(walk: Walk) -> None:
    """Locked, keeping its force, or so many times as stiff as a contact: the page reckons as the server does, says which,
    and the sheet's address holds force, jaw force and jaw; what the sheet warns of stands below the drawing."""
    page = walk.page
    walk.take()
    walk.search()
    page.click("#push")
    row = walk.shown()
    page.fill("#force-size", "400")
    page.fill("#force-jaw", "20")
    url = f"/api/jobs/{walk.job()}/fixtures/{row['rank']}"
    for choice, kind in (("constant", "constant"), ("ratio", 2.5)):
        page.select_option("#force-kind", choice)
        if choice == "ratio":
            page.fill("#force-ratio", "2.5")
        force = page.evaluate("async () => (await import('/static/state.js')).state.force")
        assert force["kind"] == kind
        load = {"points": [[force["x"], force["y"]]], "force": 400.0, "directions": [force["direction"]] * 2}
        body = {"loads": [load], "jaw": kind, "jaw_force": 20.0}
        case = walk.server.client.post(f"{url}/loads", json=body).json()["cases"][0]
        mine = page.evaluate(
            """async () => {
              const { state } = await import("/static/state.js");
              const { reactions } = await import("/static/forces.js");
              return reactions(state.part, state.selected, state.force);
            }"""
        )
        assert mine["forces"] == pytest.approx(case["largest"], abs=1e-3)
        assert mine["needed"] == pytest.approx(case["needed"]["value"], abs=1e-3)
        query = parse_qs(urlsplit(str(page.get_attribute("#take-sheet", "href"))).query)
        assert (query["jaw"], query["jaw_force"]) == ([str(kind)], ["20"])
        (sent,) = json.loads(query["loads"][0])
        assert (sent["force"], sent["points"][0]) == (400, [force["x"], force["y"]])
    asked = {name: query[name][0] for name in ("jaw", "jaw_force", "loads")}
    told = walk.server.client.get(f"{url}/warnings", params=asked).json()["warnings"]
    assert "load" in [one["kind"] for one in told]
    # They follow the force after a moment of quiet.
    page.wait_for_function(
        "(told) => String([...document.querySelectorAll('#warnings li')].map((one) => one.innerText)) === String(told)",
        arg=[one["sentence"] for one in told],
    )


def test_two_fixtures_side_by_side(walk: Walk) -> None:
    """A pinned fixture stays while others are stepped through, and the better figures are marked."""
    page = walk.page
    walk.take()
    walk.search()
    page.click("#pin")
    first = walk.shown()
    page.keyboard.press("ArrowRight")
    walk.seen("#board-title:has-text('Shown: 2')")
    assert (
        page.locator("#drawing-pinned [data-peg]").count()
        == page.locator("#drawing-fixture [data-peg]").count()
        == 4
    )
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
    walk.page.hover("#drawing-fixture [data-peg] >> nth=0")
    words = walk.seen("#peg-words").inner_text()
    index = int(walk.page.locator("#drawing-fixture [data-peg] >> nth=0").get_attribute("data-peg"))
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
    assert page.locator("#drawing-fixture [data-peg]").count() == 4
    page.click("#why .helps button >> nth=0")
    walk.searched()
    assert walk.count() > 0
    assert page.locator("#why").is_hidden()


def test_the_sweep_tells_which_vise_suits(walk: Walk) -> None:
    """A line for each preset; one of them is taken by its button."""
    page = walk.page
    walk.take(pitch=None)
    page.click("#sweep")
    page.wait_for_selector("#comparison-progress", state="hidden", timeout=SEARCH_PATIENCE)
    presets = [vise["name"] for vise in walk.server.client.get("/api/presets").json()]
    assert sorted(page.locator("#comparison-table th[scope=row]").all_inner_texts()) == sorted(presets)
    page.click("#comparison-table button[aria-label='Use plate-25mm']")
    assert page.input_value("#preset") == "plate-25mm"
    assert float(page.input_value("#pitch-x")) == 25


@pytest.mark.parametrize(
    ("way", "bolted"),
    [
        ("+y", True),
        ("-x", False),
        pytest.param("-x", True, marks=pytest.mark.prove),
        pytest.param("+y", False, marks=pytest.mark.prove),
    ],
)
def test_a_plate_is_drawn_with_its_clamp(walk: Walk, way: str, bolted: bool) -> None:
    """From a link with a plate: one plate, four pegs where they stand, the clamp from its hole to its tip or its line,
    and the length to set as the server tells it; what is said is not of a vise's opening.
    """
    plate = {
        "kind": "translating-clamp",
        "pitch": [20, 20],
        "peg_radius": 5,
        "columns": 8,
        "rows": 6,
        "directions": [way],
    }
    loop = [[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]]
    kept = {"toolkit": plate | ({"travel": [10, 30]} if bolted else {}), "toolkitName": "own", "types": None}
    kept |= {
        "part": {"name": "rectangle", "loops": [loop]},
        "job": None,
        "searched": False,
        "rank": None,
        "pinned": None,
    }
    packed = zlib.compressobj(wbits=-15)
    text = (
        base64.urlsafe_b64encode(packed.compress(json.dumps(kept).encode()) + packed.flush())
        .decode()
        .rstrip("=")
    )
    walk.page.goto("about:blank")
    walk.open(f"{walk.home}#{text}")
    walk.seen("#faces button")
    walk.search()
    row = walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures/1").json()
    page = walk.page
    walk.seen("#drawing-fixture .clamp-push")
    assert page.locator("#drawing-fixture .picture > :has(> circle)").count() == 1
    assert page.locator("#drawing-fixture [data-peg]").count() == 4
    assert page.locator("#drawing-fixture .clamp-line").count() == int(not bolted)
    page.wait_for_function("() => !document.querySelector('#drawing-fixture [transform^=translate]')")
    if bolted:
        tip, stroke = row["pegs"][-1], row["settings"][0]["length"]
        hole = [at - stroke * to for at, to in zip(tip, row["carriers"][-1]["clamping"], strict=True)]
        assert page.evaluate(CLAMP_ENDS, False) == pytest.approx([*hole, *tip, *hole], abs=1e-3)
    words, number = page.inner_text("#pose-words"), f"{row['settings'][0]['length']:.3f} mm".replace("-", "−")
    assert words.startswith("Stroke" if bolted else f"Tip {way[1]}") and number in words
    assert "hole A1" in words and "clamp force" in words
    dimension = page.locator("#drawing-fixture .dimension-text").inner_html()
    assert dimension.startswith(f"{row['settings'][0]['sign']} = ")
