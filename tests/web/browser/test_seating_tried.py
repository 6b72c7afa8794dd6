"""Does the part end up there? The part is put between the pegs by hand, and the page says what becomes of it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from running_server import RunningServer
from walking import EXAMPLES, Walk

AXE = Path(__file__).parent / "data" / "axe.min.js"
MIDDLE = """async () => {
  const { state } = await import("/static/state.js");
  const { lyingOf, middleOf } = await import("/static/trial.js");
  return middleOf(state.part, lyingOf(state.part, state.selected, state.trial));
}"""
# The first closing that is asked for has no answer until it is given up.
DEAF = """() => {
  const real = window.fetch;
  window.fetch = (address, options) => {
    if (window.heard || !String(address).endsWith("/closing")) return real(address, options);
    window.heard = options.signal;
    return new Promise((_, fail) => options.signal.addEventListener("abort", () => fail(options.signal.reason)));
  };
}"""
SERIOUS = """async () => (await axe.run(document)).violations
  .filter((rule) => ["serious", "critical"].includes(rule.impact)).map((rule) => rule.id)"""


def begin(walk: Walk) -> dict[str, Any]:
    """Take a fixture into the hand; what the server tells of it."""
    walk.page.click("#try")
    walk.seen("#seats .seat")
    row = walk.shown()
    told = walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures/{row['rank']}/seating").json()
    return dict(told)


def dragged(walk: Walk, dx: float, dy: float) -> None:
    """Drag the part by its middle, so many mm, and let it go."""
    x, y = walk.page.evaluate(MIDDLE)
    walk.drag(walk.point(x, y, "fixtureDrawing"), walk.point(x + dx, y + dy, "fixtureDrawing"))


def verdict(walk: Walk, words: str, kind: str) -> str:
    """What is said at last."""
    return str(walk.seen(f"#try-words.{kind}:has-text('{words}')").inner_text())


def test_a_part_that_is_dragged_and_let_go_is_closed_upon(walk: Walk) -> None:
    """It comes home from beside its place, slips out from far away, is refused where a peg is, and rests in a wrong seat
    where it is put over one; each is said with its reading, and its picture is marked."""
    page = walk.page
    walk.take()
    walk.search()
    told = begin(walk)
    right = f"{told['seats'][told['own']]['jaw_separation']:.3f} mm"
    # Where the part is no longer caught is marked by the pegs that move as they would stand there.
    caught, moving = (
        page.locator("#drawing-fixture .caught"),
        page.locator("#drawing-fixture .moves[data-peg]"),
    )
    assert caught.count() == moving.count() > 0
    ahead = [float(circle.get_attribute("cx")) for circle in caught.all()]
    row = walk.shown()
    stand = [row["pegs"][k][0] for each in row["carriers"] if each["clamping"] for k in each["pegs"]]
    assert max(abs(x - y - told["capture_opening"]) for x, y in zip(ahead, stand, strict=True)) < 1e-6
    page.fill("#try-opening", str(0.5 * told["capture_opening"]))
    assert (
        f", less than the {told['capture_opening']:.2f} mm up to which the part settles"
        in walk.seen("#try-words").inner_text()
    )
    page.fill("#try-opening", str(2.0 * told["capture_opening"]))
    assert ", beyond the" in walk.seen("#try-words").inner_text()
    page.fill("#try-opening", str(max(0.5 * told["capture_opening"], 0.5)))
    dragged(walk, 0.4, 0.0)
    assert right in verdict(walk, "in its place", "good")
    pressed = page.locator('#seats .seat[aria-pressed="true"]')
    assert pressed.get_attribute("data-seat") == str(told["own"])
    dragged(walk, 0.0, -16.0)
    assert re.search("slips out|wrong place|stop|stands? in", verdict(walk, "", "bad"))
    page.click("#try-back")
    page.fill("#try-x", "-12")
    assert "in the part here" in verdict(walk, "in the part here", "bad")
    assert page.locator("#drawing-fixture .entered").count() >= 1
    page.click("#try-close")
    verdict(walk, "put the part elsewhere", "bad")
    number = told["nearest"][0]
    page.click(f'#seats .seat[data-seat="{number}"]')
    seat = told["seats"][number]
    assert f"{seat['jaw_separation']:.3f} mm" in verdict(walk, "", "bad")
    page.fill("#try-opening", str(max(seat["difference"], 0.0) + 0.02))
    page.click("#try-close")
    words = verdict(walk, "wrong place", "bad")
    assert page.locator("#drawing-fixture .entered").count() == 0
    assert f"{abs(seat['difference']):.3f} mm {'more' if seat['difference'] > 0 else 'less'} than" in words
    page.click("#try")
    page.wait_for_selector("#seating", state="hidden")
    assert page.locator("#drawing-fixture .part.put").count() == 0
    # Pegs without a radius have no seating: it is said why, and the part can be moved but nothing closes upon it.
    page.fill("#peg-radius", "0")
    page.press("#peg-radius", "Tab")
    walk.searched()
    page.click("#try")
    assert "radius 0" in walk.seen("#seating-trouble").inner_text()
    assert page.locator("#seating-answer").is_hidden()
    assert page.locator("#drawing-fixture .part.put").count() == 1
    assert page.locator("#try-close").is_disabled()
    # One start was refused, and these pegs.
    walk.troubles = [line for line in walk.troubles if "400" not in line]


def test_keys_and_fields_do_what_the_hand_does(browser: Any, server: RunningServer) -> None:
    """On a phone, in inches, with motion: arrows move the part, comma turns it, Enter closes; who takes hold of it again
    hangs up on what was asked; nothing of it keeps anybody out."""
    context = browser.new_context(viewport={"width": 390, "height": 800}, reduced_motion="no-preference")
    context.add_init_script(path=AXE)
    walk = Walk(context.new_page(), server)
    walk.open()
    page = walk.page
    walk.take()
    page.click("#search")
    walk.searched(shown=False)
    walk.go("stage")
    page.select_option("#unit", "inch")
    begin(walk)
    page.focus("#drawing-fixture .part")
    for key in ("ArrowRight", "ArrowUp", ",", ","):
        page.keyboard.press(key)
    assert [float(page.input_value(f"#try-{name}")) for name in ("x", "y", "turn")] == [0.05, 0.05, 2]
    assert page.evaluate("document.activeElement.classList.contains('part')")
    page.evaluate(DEAF)
    page.keyboard.press("Enter")
    page.wait_for_function("window.heard")
    assert not page.evaluate("window.heard.aborted")
    dragged(walk, 0.2, 0.0)
    assert page.evaluate("window.heard.aborted")
    walk.seen("#try-words.good, #try-words.bad")
    assert re.search(r"S = \d\.\d{4} in", page.inner_text("#try-words"))
    assert page.evaluate(SERIOUS) == []
    page.keyboard.press("Escape")
    page.wait_for_selector("#seating", state="hidden")
    context.close()
    assert [line for line in walk.troubles if "400" not in line] == []


def test_with_two_clamps_it_is_said_what_to_do_by_hand(walk: Walk) -> None:
    """In place of a part to drag; another toolkit's is dragged again, and words follow the unit."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "plate.json")
    walk.seen("#faces button")
    page.select_option("#preset", "two-clamp-plate-20mm")
    walk.search()
    page.click("#try")
    walk.seen("#seating-steps li:nth-child(5)")
    row = walk.shown()
    told = walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures/{row['rank']}/seating").json()["by_hand"]
    assert page.locator("#seating-steps li").all_inner_texts() == told["steps"]
    assert page.inner_text("#try-words") == told["why"]
    assert page.locator("#try-fields").is_hidden() and page.locator("#try-hint").is_hidden()
    assert page.locator("#seats .seat").count() == 0 and page.locator("#seats-more").is_hidden()
    assert page.locator("#drawing-fixture .part.put").count() == 0
    page.select_option("#unit", "inch")
    walk.seen("#seating-steps li:has-text(' in at clamp')")
    page.select_option("#unit", "mm")
    page.click("#try")
    page.select_option("#preset", "plate-20mm")
    walk.search()
    begin(walk)
    assert page.locator("#try-fields").is_visible() and page.locator("#try-hint").is_visible()


def test_a_part_in_the_hand_stays_there_after_a_search_begun_by_hand(walk: Walk) -> None:
    """A change of settings searches by itself after a moment, but not once its user has pressed the button."""
    page = walk.page
    walk.take()
    walk.search()
    walk.asked.clear()
    page.evaluate("""() => {
      const press = () => document.getElementById("search").click();
      document.getElementById("peg-radius").addEventListener("change", () => setTimeout(press), { once: true });
    }""")
    page.fill("#peg-radius", "2")
    page.press("#peg-radius", "Tab")
    walk.searched()
    begin(walk)
    page.wait_for_timeout(700)
    assert page.locator("#seating").is_visible() and page.locator("#seats .seat").count() > 0
    assert sum(address.endswith("/api/jobs") for address in walk.asked) == 1


def test_a_search_asks_for_seating(walk: Walk) -> None:
    """Of the first fixtures, and only those that catch the part so far open; the list shows it, and a link keeps it."""
    page = walk.page
    walk.take()
    assert page.is_disabled("#search-opening") and page.is_disabled("#search-foolproof")
    page.fill("#search-seating", "0")
    page.press("#search-seating", "Tab")
    assert page.get_attribute("#search-seating", "aria-invalid") == "true"
    page.fill("#search-seating", "6")
    page.press("#search-seating", "Tab")
    walk.search()
    first = walk.server.client.get(f"/api/jobs/{walk.job()}").json()["request"]
    assert (first["seating"], first["opening"], first["foolproof"]) == (6, None, False)
    assert "caught" in walk.seen(".row .row-figures").inner_text()
    page.fill("#search-opening", "1")
    page.press("#search-opening", "Tab")
    page.check("#search-foolproof")
    walk.search()
    told = walk.server.client.get(f"/api/jobs/{walk.job()}").json()["request"]
    assert (told["seating"], told["opening"], told["foolproof"]) == (6, 1.0, True)
    rows = walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures").json()["rows"]
    assert 0 < len(rows) <= 6 and all(row["caught"]["opening"] > 1.0 for row in rows)
    walk.reload()
    assert (page.input_value("#search-seating"), page.input_value("#search-opening")) == ("6", "1")
    assert page.is_checked("#search-foolproof")


# Which pegs stand in the part, at the openings that were wished for and that a trial begins with.
BEGINS = """async ([part, row, wish]) => {
  const { entered, lyingOf, openingBeside } = await import("/static/trial.js");
  const opening = openingBeside(part, row, wish);
  const lying = lyingOf(part, row, { x: 0, y: 0, turn: 0, over: false, opening: 0 });
  return [opening, entered(part, row, lying, wish), entered(part, row, lying, opening)];
}"""
LOOP = [[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]
HOLE = [[30, 24, -1], [30, 16, -1]]


def test_a_trial_begins_with_every_peg_beside_the_part(walk: Walk) -> None:
    """A peg in a hole opens no farther than into its wall; one that is a point, as of a flat jaw, stands on its face."""
    segments = [{"loop": 0, "face": k, "number": k} for k in range(4)]
    segments += [{"loop": 1, "face": 4, "number": k} for k in (4, 5)]
    part = {"bounds": [0, 0, 60, 40], "loops": [LOOP, HOLE], "segments": segments}
    still = {"clamping": None, "pegs": [0, 1], "peg_radius": 0}
    moves = {"clamping": [-1, 0], "pegs": [2], "peg_radius": 2}
    # Two points on the left side, off it by rounding, and a peg at the right side of the hole.
    row = {"theta_deg": 0, "x": 0, "y": 0, "flush": [], "carriers": [still, moves]}
    row |= {"pegs": [[1e-9, 10], [0, 30], [28, 20]]}
    opening, wished, begun = walk.page.evaluate(BEGINS, [part, row, 20])
    assert wished == [2] and begun == [] and 0 < opening < 5
    outside = {**row, "pegs": [[0, 10], [0, 30], [62, 20]]}
    opening, wished, begun = walk.page.evaluate(BEGINS, [part, outside, 20])
    assert (opening, wished, begun) == (20, [], [])


def test_pegs_are_drawn_at_their_radius(walk: Walk) -> None:
    """Also thin ones on a coarse pitch: a thicker circle would stand in the part."""
    page = walk.page
    walk.take()
    page.fill("#peg-radius", "0.4")
    page.press("#peg-radius", "Tab")
    walk.search()
    radii = page.eval_on_selector_all(
        "#drawing-fixture .peg",
        "all => all.map(one => one.r.baseVal.value / "
        "Number(one.closest('[data-model-to-page]').dataset.modelToPage.match(/[\\d.]+/)))",
    )
    assert len(radii) == 4 and all(abs(radius - 0.4) < 1e-3 for radius in radii)
