"""The widget's part in the browser, against a model of the notebook that Python answers, and one that nobody does."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from importlib import resources
from typing import Any

import pytest

import workhold
from workhold.model.quality import FIGURE_RANKING

STATIC = resources.files("workhold.presenting").joinpath("static")
WEDGE = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
RESULT = workhold.design(WEDGE, workhold.Vise(pitch=15, columns=1, peg_radius=2), rank_by=FIGURE_RANKING)
TRAITS = ("rank", "count", "jaw_force", "force", "picture", "answer", "closing", "dragged", "asked_closing")
# A model as anywidget hands it over, whose changes go to Python and come back.
PAGE = """<meta charset="utf-8"><div id="cell"></div><script type="module">
const made = URL.createObjectURL(new Blob([await window.module()], { type: "text/javascript" }));
const { default: widget } = await import(made);
const state = await window.stateNow();
const heard = {};
let changed = {};
const model = {
  get: (name) => state[name],
  set(name, value) { state[name] = value; changed[name] = value; },
  on(name, call) { (heard[name] ??= new Set()).add(call); },
  off(name, call) { heard[name]?.delete(call); },
  save_changes() {
    if (!window.answering) throw new Error("Syncing error: no comm channel defined");
    const sent = changed;
    changed = {};
    window.asked(sent).then((now) => {
      for (const [name, value] of Object.entries(now)) {
        const before = JSON.stringify(state[name]);
        state[name] = value;
        if (JSON.stringify(value) !== before) heard[`change:${name}`]?.forEach((call) => call());
      }
    });
  },
};
window.answering = true;
window.heard = heard;
const style = document.createElement("style");
style.textContent = await window.look();
document.head.append(style);
window.end = widget.render({ model, el: document.getElementById("cell") });
window.ready = true;
</script>"""


@pytest.fixture
def shown(browser: Any) -> Iterator[tuple[Any, Any]]:
    """A page with the widget, and the widget of Python; nothing may have gone wrong at the end."""
    pytest.importorskip("anywidget", reason="the extra 'widget' is not installed")
    widget = RESULT.widget()
    context = browser.new_context(viewport={"width": 820, "height": 900}, reduced_motion="reduce")
    page, troubles = context.new_page(), list[str]()
    page.on("pageerror", lambda error: troubles.append(str(error)))

    def state() -> dict[str, Any]:
        return {name: getattr(widget, name) for name in TRAITS}

    def asked(changed: dict[str, Any]) -> dict[str, Any]:
        for name, value in changed.items():
            setattr(widget, name, value)
        return state()

    for name, call in (
        ("stateNow", state),
        ("asked", asked),
        ("module", lambda: STATIC.joinpath("widget.js").read_text()),
        ("look", lambda: STATIC.joinpath("widget.css").read_text()),
    ):
        page.expose_function(name, call)
    page.set_content(PAGE)
    page.wait_for_function("window.ready")
    yield page, widget
    context.close()
    assert troubles == []


def drag(page: Any, start: tuple[float, float], way: tuple[float, float]) -> None:
    """Presses at a point of the picture, by shares of its size, and drags by pixels."""
    box = page.locator(".workhold-picture svg").bounding_box()
    x, y = box["x"] + start[0] * box["width"], box["y"] + start[1] * box["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + way[0] / 2, y + way[1] / 2, steps=3)
    page.mouse.move(x + way[0], y + way[1], steps=3)
    page.mouse.up()


def words(page: Any, pattern: str) -> None:
    """Waits until the words below the picture are so."""
    page.wait_for_function(
        "(pattern) => new RegExp(pattern).test(document.querySelector('.workhold-words').textContent)",
        arg=pattern,
    )


def test_a_force_is_dragged_and_answered(shown: tuple[Any, Any]) -> None:
    """Arrows and bars are Python's; too little force on the jaw, and a peg lets go."""
    page, widget = shown
    drag(page, (0.5, 0.5), (0, 100))
    words(page, "^Holds")
    page.wait_for_function("document.querySelectorAll('.workhold-force').length >= 3")
    # The picture is 760 pixels wide for 640 units, and 100 units are 200 N.
    assert widget.force[2] == pytest.approx(100 * 640 / 760 * 2, abs=2)
    texts = page.locator(".workhold-bars .workhold-number").all_text_contents()
    assert texts == [one["words"] for one in widget.answer["forces"]]
    page.locator(".workhold-jaw").fill("1")
    page.locator(".workhold-jaw").press("Enter")
    words(page, "^The part is not held")
    assert page.locator(".workhold-pulls").count() == sum(one["pulls"] for one in widget.answer["forces"]) > 0


def test_an_end_of_the_arrow_is_taken_hold_of(shown: tuple[Any, Any]) -> None:
    """The tip turns and stretches the force, the other end carries it along."""
    page, widget = shown
    page.get_by_text("Push", exact=True).click()
    words(page, "^Holds")
    x, y, size, _ = widget.force
    svg = page.locator(".workhold-picture svg").bounding_box()
    tip = page.locator(".workhold-tip").bounding_box()
    at = (
        (tip["x"] + tip["width"] / 2 - svg["x"]) / svg["width"],
        (tip["y"] + tip["height"] / 2 - svg["y"]) / svg["height"],
    )
    drag(page, at, (0, -60))
    page.wait_for_function("!document.querySelector('.workhold-size').textContent.startsWith('200')")
    assert widget.force[:2] == pytest.approx([x, y]) and widget.force[2] < size
    own = page.locator(".workhold-at").bounding_box()
    at = (
        (own["x"] + own["width"] / 2 - svg["x"]) / svg["width"],
        (own["y"] + own["height"] / 2 - svg["y"]) / svg["height"],
    )
    before = list(widget.force)
    drag(page, at, (30, 0))
    page.wait_for_timeout(200)
    assert widget.force[:2] != pytest.approx(before[:2]) and widget.force[2] == before[2]


def test_keys_do_what_the_pointer_does(shown: tuple[Any, Any]) -> None:
    """A force by a button, its ends by arrow keys, and the focus stays."""
    page, widget = shown
    page.get_by_text("Push", exact=True).focus()
    page.keyboard.press("Enter")
    words(page, "^Holds")
    x, y, size, direction = widget.force
    page.locator(".workhold-at").focus()
    # The notebook does not hear the arrow keys, which move between its cells.
    page.evaluate("document.addEventListener('keydown', (event) => (window.gone = event.key))")
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    page.wait_for_timeout(200)
    assert page.evaluate("document.activeElement.dataset.end") == "at"
    assert page.evaluate("window.gone") is None
    assert distance((x, y), widget.force[:2]) == pytest.approx(24 / scale_of(widget), rel=1e-6)
    assert widget.force[2:] == pytest.approx([size, direction])
    page.locator(".workhold-tip").focus()
    page.keyboard.press("Shift+ArrowDown")
    page.wait_for_timeout(200)
    assert widget.force[2] == 202.0
    page.get_by_text("No force").click()
    words(page, "^Press on the part")
    assert page.locator(".workhold-push").count() == 0


def distance(one: Any, other: Any) -> float:
    """The distance of two points."""
    return float(((one[0] - other[0]) ** 2 + (one[1] - other[1]) ** 2) ** 0.5)


def scale_of(widget: Any) -> float:
    """Units of the picture for each mm."""
    return float(widget.live.view.scale)


def test_fixtures_are_stepped_through(shown: tuple[Any, Any]) -> None:
    """By buttons and by number, no farther than there are."""
    page, widget = shown
    page.get_by_label("The next fixture").click()
    page.wait_for_function("document.querySelector('.workhold-title').textContent.startsWith('Fixture 2 of')")
    assert page.locator(".workhold-picture title").text_content().startswith("Fixture 2 of")
    page.locator(".workhold-rank").fill("99999")
    page.locator(".workhold-rank").press("Enter")
    last = f"Fixture {len(RESULT)} of"
    page.wait_for_function(
        "(last) => document.querySelector('.workhold-title').textContent.startsWith(last)", arg=last
    )
    assert widget.rank == len(RESULT) and page.locator(".workhold-rank").input_value() == str(len(RESULT))


def test_the_vise_closes(shown: tuple[Any, Any]) -> None:
    """It begins open with the part off its place, and ends with all in place and what is read."""
    page, widget = shown
    page.emulate_media(reduced_motion="no-preference")
    page.evaluate(
        """() => {
          window.seen = [];
          new MutationObserver((all) => all.forEach(({ target }) => window.seen.push(
            [target.getAttribute('class'), target.getAttribute('transform')])))
            .observe(document.querySelector('.workhold-picture'), { subtree: true, attributeFilter: ['transform'] });
        }"""
    )
    page.get_by_text("Close", exact=True).click()
    words(page, "The part is in its place: S = ")
    seen = page.evaluate("window.seen")
    moved = [
        [float(one) for one in re.findall(r"-?\d[\d.e-]*", text)] for kind, text in seen if kind == "moves"
    ]
    turned = [text for kind, text in seen if kind == "part"]
    assert len({tuple(one) for one in moved}) > 3 and moved[0][0] > moved[-1][0] == pytest.approx(0, abs=0.05)
    # The part turns as Python says, and the page's y runs down.
    most = max((one[0] for one in widget.closing["keyframes"]), key=abs)
    angles = [float(re.findall(r"rotate\((-?[\d.e-]+)", text)[0]) for text in turned]
    assert 0.2 * abs(most) < -max(angles, key=abs) * math.copysign(1.0, most) <= abs(most) + 1e-6


def test_without_python_the_stored_picture_stands(shown: tuple[Any, Any]) -> None:
    """What was drawn last is there, closes as far as is stored, and it is said that nobody answers."""
    page, widget = shown
    drag(page, (0.5, 0.5), (0, 100))
    words(page, "^Holds")
    before = page.locator(".workhold-force").count()
    page.evaluate("window.answering = false")
    drag(page, (0.4, 0.4), (50, 0))
    page.wait_for_function("document.querySelector('.workhold-note').textContent.startsWith('No Python')")
    assert page.locator(".workhold-force").count() == before
    assert page.locator(".workhold-size").text_content() == widget.answer["size"]
    page.get_by_text("Close", exact=True).click()
    page.wait_for_function("document.querySelector('.workhold-words').textContent !== '…'")


def test_a_view_that_is_closed_listens_no_more(shown: tuple[Any, Any]) -> None:
    page, _ = shown
    assert page.evaluate("Object.values(window.heard).reduce((sum, one) => sum + one.size, 0)") > 0
    page.evaluate("window.end()")
    assert page.evaluate("Object.values(window.heard).reduce((sum, one) => sum + one.size, 0)") == 0


def test_it_has_no_ids_and_fits_a_narrow_page(shown: tuple[Any, Any]) -> None:
    """Many stand in one notebook, also on a phone and in the dark."""
    page, _ = shown
    assert page.locator("#cell [id]").count() == 0
    page.set_viewport_size({"width": 360, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
