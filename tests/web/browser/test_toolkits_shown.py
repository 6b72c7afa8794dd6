"""Toolkits other than the vise: their fields, their words, and how they close."""

from __future__ import annotations

from typing import Any

import pytest
from running_server import RunningServer
from walking import CLAMP_ENDS, EXAMPLES, SEARCH_PATIENCE, Walk

STATE = "async () => (await import('/static/state.js')).state"


def held_in(walk: Walk) -> dict[str, Any]:
    """The toolkit that a search would be asked in."""
    return dict(walk.page.evaluate("async () => (await import('/static/state.js')).request().toolkit"))


def fill(walk: Walk, **values: str) -> None:
    """Type values and leave the last field."""
    for name, value in values.items():
        walk.page.fill(f"#{name.replace('_', '-')}", value)
    walk.page.press(f"#{name.replace('_', '-')}", "Tab")


def test_the_fields_are_those_of_the_kind(walk: Walk) -> None:
    """What is typed is what is asked for, in mm, also from inches; a reload brings it back."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "bracket.dxf")
    walk.seen("#faces button")
    page.select_option("#toolkit", "translating-clamp")
    assert page.input_value("#preset") == "own"
    page.click("#more-title")
    fill(walk, columns="9", rows="7", pitch_x="20", pitch_y="24", peg_radius="3", clamp_radius="5")
    fill(walk, travel_least="10", travel_most="44")
    page.get_by_label("downward").check()
    wanted = {
        "kind": "translating-clamp",
        "pitch": [20, 24],
        "columns": 9,
        "rows": 7,
        "peg_radius": 3,
        "clamp_radius": 5,
        "travel": [10, 44],
        "directions": ["-y"],
        "clamps": 1,
        "top_clamp": {"tip_margin": 1},
    }
    assert held_in(walk) == wanted
    page.select_option("#unit", "inch")
    assert float(page.input_value("#travel-most")) == pytest.approx(44 / 25.4)
    fill(walk, travel_most="2")
    # What was not touched is kept to the last digit.
    wanted["travel"] = [10, pytest.approx(50.8)]
    assert held_in(walk) == wanted
    walk.reload()
    walk.seen("#faces button")
    assert held_in(walk) == wanted
    page.click("#more-title")
    assert page.get_by_label("downward").is_checked() and not page.get_by_label("upward").is_checked()
    # An emptied field is left to its usual value, and half a pair is none.
    fill(walk, columns="", travel_least="")
    assert page.get_attribute("#travel-least", "aria-invalid") == "true"
    assert "Stroke" in walk.seen("#toolkit-trouble").inner_text()
    fill(walk, travel_most="")
    page.wait_for_selector("#toolkit-trouble", state="hidden")
    assert not {"travel", "columns"} & set(held_in(walk))


def test_two_clamps_push_in_pairs_of_directions(walk: Walk) -> None:
    """Directions of one clamp are left behind, pairs are offered, and a rectangle is held square; every pair on request."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "plate.json")
    walk.seen("#faces button")
    assert page.locator("#every-pair").is_hidden()
    page.select_option("#preset", "clamp-plate-20mm")
    page.click("#more-title")
    page.get_by_label("downward").check()
    assert held_in(walk)["directions"] == ["-y"]
    page.select_option("#clamps", label="two, needed together")
    walk.seen("label:has-text('to the left and downward')")
    assert held_in(walk)["clamps"] == 2 and "directions" not in held_in(walk)
    page.get_by_label("to the left and downward").check()
    assert held_in(walk)["directions"] == [["-x", "-y"]]
    walk.search()
    assert len(walk.holes()) == 5 and walk.shown()["theta_deg"] % 90 == 0
    # Each clamp's length has its name, and room in the drawing.
    assert page.inner_text("#pose-words").startswith("Clamp ")
    walk.seen("#drawing-fixture .dimension-text")
    # Measured at once: a drawing may be put in the place of another meanwhile.
    frame, *words = page.evaluate(
        """() => [...document.querySelectorAll("#drawing-fixture, #drawing-fixture .dimension-text")]
            .map((one) => one.getBoundingClientRect()).map(({ left, right }) => [left, right])"""
    )
    assert frame[0] < frame[1] and len(words) == 2
    for left, right in words:
        assert left < right and frame[0] <= left and right <= frame[1]
    page.click("#push")
    walk.seen("#bars .bar:nth-child(5)")
    seats = walk.count()
    page.check("#every-pair")
    page.click("#search")
    more = "seats => Number(document.querySelector('#count').innerText.replace(/\\D/g, '')) > seats"
    page.wait_for_function(more, arg=seats, timeout=SEARCH_PATIENCE)
    walk.searched()
    page.select_option("#clamps", label="one")
    page.wait_for_selector("#pairs-box", state="hidden")


def test_pegs_with_a_flat_lie_on_the_part(walk: Walk) -> None:
    """A field of every toolkit; the drawing shows each flat, and round clamps."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "bracket.dxf")
    walk.seen("#faces button")
    page.select_option("#preset", "clamp-plate-20mm")
    page.click("#more-title")
    fill(walk, flat="2")
    assert held_in(walk)["flat"] == 2
    walk.search()
    flats = page.locator("#drawing-fixture path.peg").count()
    assert 0 < flats <= 3 and page.locator("#drawing-fixture .peg").count() == 4
    fill(walk, flat="9")
    page.click("#search")
    walk.seen("text=cannot have a flat")
    walk.troubles.clear()


def test_another_kind_keeps_what_both_have(walk: Walk) -> None:
    """Pitch and pegs stay; a gripper has one column and no field for it; presets bring their kind."""
    page = walk.page
    page.select_option("#preset", "clamp-table-50mm")
    assert page.input_value("#toolkit") == "translating-clamp"
    page.select_option("#toolkit", "gripper")
    page.wait_for_selector("#columns", state="detached")
    vise = page.evaluate(STATE)["toolkit"]
    assert vise == {
        "kind": "gripper",
        "pitch": [50, 50],
        "peg_radius": 8,
        "columns": 1,
        "top_clamp": {"tip_margin": 1},
    }
    assert page.locator("#types input").count() == 2
    page.select_option("#preset", "plate-20mm")
    assert (page.input_value("#toolkit"), page.input_value("#columns")) == ("vise", "3")


def test_the_words_are_those_of_a_plate(walk: Walk) -> None:
    """No jaw and no vise stands for a plate: not in fields, buttons, forces, figures nor what the figures mean."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "bracket.dxf")
    walk.seen("#faces button")
    page.select_option("#preset", "clamp-plate-20mm")
    walk.search()
    page.click("#push")
    walk.seen("#bars .bar")
    texts = page.evaluate(
        """() => {
          const told = [...document.querySelectorAll("#toolkit-usual, #toolkit-more, #more-title, .toolbar, .below, #list")];
          const words = told.map((each) => each.innerText);
          const titles = told.flatMap((each) => [...each.querySelectorAll("[title], [aria-label]")])
            .flatMap((each) => [each.getAttribute("title"), each.getAttribute("aria-label")]);
          titles.push(document.querySelector("#drawing-fixture").getAttribute("aria-label"));
          return [...words, ...titles].filter(Boolean);
        }"""
    )
    told = " ".join(texts)
    assert "lamp force" in told and page.inner_text("#close-vise") == "Close clamp"
    for word in ("jaw", "vise"):
        assert word not in told.lower(), [text for text in texts if word in text.lower()]
    assert page.locator("#types-box").is_hidden() and page.locator("#filter-type-label").is_hidden()
    page.select_option("#toolkit", "vise")
    walk.seen("#close-vise:has-text('Close vise')")
    walk.seen("#types-box")


def test_a_change_that_helps_a_plate_is_a_button(walk: Walk) -> None:
    """A plate that is too small says what it needs, and a click makes it so."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "bracket.dxf")
    walk.seen("#faces button")
    page.select_option("#preset", "clamp-plate-20mm")
    fill(walk, columns="2", rows="2")
    page.click("#search")
    walk.seen("#count:has-text('There is no fixture')", SEARCH_PATIENCE)
    walk.seen("#why .helps button:has-text('columns')", SEARCH_PATIENCE).click()
    walk.searched()
    assert walk.count() > 0
    assert page.input_value("#columns") == ""


def test_the_clamp_closes(browser: Any, server: RunningServer) -> None:
    """Its bolt stays; its tip and its body come from as far back as it goes, and end where it clamps."""
    context = browser.new_context(viewport={"width": 1440, "height": 900}, reduced_motion="no-preference")
    walk = Walk(context.new_page(), server)
    walk.open()
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "bracket.dxf")
    walk.seen("#faces button")
    page.select_option("#preset", "clamp-plate-20mm")
    walk.search()
    row = walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures/1").json()
    travel = walk.server.client.get(f"/api/jobs/{walk.job()}").json()["request"]["toolkit"]["travel"]
    way, tip, stroke = row["carriers"][-1]["clamping"], row["pegs"][-1], row["settings"][0]["length"]
    hole, back = (
        [at - far * to for at, to in zip(tip, way, strict=True)] for far in (stroke, stroke - travel[0])
    )
    # Until then the first one of an earlier stage of the search may be on show.
    walk.until("String(state.selected?.holes) === String(given)", row["holes"])
    moving = "#drawing-fixture .moves[data-peg]"
    page.wait_for_selector(f"{moving}:not([transform])", state="attached")
    begun = page.evaluate(CLAMP_ENDS, True)
    assert begun == pytest.approx([*hole, *back, *hole], abs=1e-3)
    page.wait_for_selector(f"{moving}:not([transform])", state="attached")
    assert page.evaluate(CLAMP_ENDS, False) == pytest.approx([*hole, *tip, *hole], abs=1e-3)
    assert page.locator(moving).count() == 1
    context.close()
    assert walk.troubles == []
