"""The page that explains the method: mouse, keys and fingers move its pictures, and a part of one's own is taken."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lesson_page import EXAMPLES, STATIC, LessonPage
from running_server import RunningServer

import workhold

AXE = Path(__file__).parent / "data" / "axe.min.js"
SLIDERS = ("one-peg", "two-pegs", "crossing", "closing", "every-one")
STEPS = (*SLIDERS, "closure")
CHECK = """async () => {
  const found = await axe.run({ preload: false });
  const bad = found.violations.filter((rule) => ["serious", "critical"].includes(rule.impact));
  return bad.map((rule) => `${rule.id}: ${rule.nodes.map((node) => node.html.slice(0, 100)).join(" | ")}`);
}"""


def test_every_picture_can_be_dragged(shown: LessonPage) -> None:
    """The thing under the mouse follows it: the peg, the part, the jaw, the centre, and the dot on a curve."""
    drags = {
        "one-peg": ("#one-peg .reach", (90, -30)),
        "two-pegs": ("#two-pegs svg:first-child .part", (10, 40)),
        "crossing": ("#crossing svg:first-child .part", (10, 40)),
        "closing": ("#closing .moving", (-25, 5)),
        "closure": ("#closure .reach", (-40, -50)),
        "every-one": ("#every-one svg", (90, 0)),
    }
    for step, (selector, (across, down)) in drags.items():
        before = shown.numbers(step)
        is_part = selector.endswith(".part")
        down_to = 0.12 if step == "closing" else 0.5
        x, y = shown.material(selector) if is_part else shown.place(selector, 0.5, down_to)
        shown.page.mouse.move(x, y)
        shown.page.mouse.down()
        shown.page.mouse.move(x + across, y + down, steps=4)
        after = shown.numbers(step)
        shown.page.mouse.up()
        assert after != before, step
        shown.page.mouse.move(x, y, steps=2)
        assert shown.numbers(step) == after, step
    before = shown.numbers("two-pegs")["theta"]
    x, y = shown.place("#two-pegs svg:last-child", 0.8)
    shown.page.mouse.click(x, y)
    assert shown.numbers("two-pegs")["theta"] > before


def test_the_dragged_part_stays_under_the_mouse(shown: LessonPage) -> None:
    """Step 2: the point that was taken is as near to the mouse as two pegs let it be, and drags back to the start."""
    first = shown.numbers("two-pegs")["theta"]
    x, y = shown.material("#two-pegs svg:first-child .part")
    shown.page.mouse.move(x, y)
    shown.page.mouse.down()
    shown.page.mouse.move(x + 15, y + 50, steps=4)
    assert abs(shown.numbers("two-pegs")["theta"] - first) > 2
    shown.page.mouse.move(x, y, steps=4)
    assert shown.numbers("two-pegs")["theta"] == pytest.approx(first, abs=0.05)
    shown.page.mouse.up()


def test_arrow_keys_move_every_slider(shown: LessonPage) -> None:
    """One step to either side, and back to the same numbers; the ends are not passed."""
    for step in SLIDERS:
        slider = shown.page.locator(f"#{step} input")
        slider.focus()
        shown.put(step, sum(shown.range(step)) / 2)
        first = shown.numbers(step)
        slider.press("ArrowRight")
        assert shown.numbers(step) != first, step
        slider.press("ArrowLeft")
        assert shown.words(step) == slider.get_attribute("aria-valuetext")
        for _ in range(30):
            slider.press("PageDown")
        lowest = shown.numbers(step)
        slider.press("ArrowDown")
        assert shown.numbers(step) == lowest, step


def test_a_finger_drags_and_still_scrolls(browser: Any) -> None:
    """On a phone a touch that begins on the part moves it and does not scroll; one beside it can scroll."""
    context = browser.new_context(viewport={"width": 380, "height": 800}, has_touch=True, is_mobile=True)
    shown = LessonPage(context.new_page(), (STATIC / "index.html").as_uri())
    touch = context.new_cdp_session(shown.page)
    for step, selector, (across, down) in (
        ("one-peg", "#one-peg .reach", (60, -10)),
        ("two-pegs", "#two-pegs svg:first-child .part", (8, 25)),
        ("closure", "#closure .reach", (-20, -30)),
    ):
        x, y = shown.material(selector) if selector.endswith(".part") else shown.place(selector)
        before, scrolled = shown.numbers(step), shown.page.evaluate("scrollY")
        for kind, points in (
            ("touchStart", [(x, y)]),
            ("touchMove", [(x + across / 2, y + down / 2)]),
            ("touchMove", [(x + across, y + down)]),
            ("touchEnd", []),
        ):
            given = [{"x": px, "y": py} for px, py in points]
            touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": given})
        assert shown.numbers(step) != before, step
        assert shown.page.evaluate("scrollY") == scrolled, step
    actions = shown.page.evaluate(
        """["#two-pegs .grab", "#two-pegs svg"].map((one) => getComputedStyle(document.querySelector(one)).touchAction)"""
    )
    assert actions == ["none", "pan-y"]
    context.close()
    assert shown.troubles == []


# Colours do not depend on the width, nor what is too wide on the colours.
@pytest.mark.parametrize(
    ("width", "scheme"),
    [
        (380, "dark"),
        (1280, "light"),
        pytest.param(380, "light", marks=pytest.mark.prove),
        pytest.param(1280, "dark", marks=pytest.mark.prove),
    ],
)
def test_nothing_serious_is_found(browser: Any, width: int, scheme: str) -> None:
    """axe-core finds no serious fault, and nothing is wider than the window, with any example."""
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
    context.add_init_script(path=AXE)
    shown = LessonPage(context.new_page(), (STATIC / "index.html").as_uri())
    for name in EXAMPLES:
        shown.lesson(name)
        found = shown.page.evaluate(CHECK)
        assert found == []
        assert shown.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        assert "NaN" not in shown.page.content()
    context.close()
    assert shown.troubles == []


def test_a_part_of_ones_own_is_taken(browser: Any, server: RunningServer) -> None:
    """From the server a file becomes a lesson with a true fixture of it, and what cannot be is said in a sentence."""
    home = f"http://127.0.0.1:{server.address[1]}/"
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    shown = LessonPage(context.new_page(), f"{home}method")
    page = shown.page
    assert page.url == f"{home}static/method/index.html"
    plate = {"name": "my plate.json", "mimeType": "application/json", "buffer": PLATE.encode()}
    page.set_input_files("#file", plate)
    page.wait_for_selector('body[data-lesson="my plate"]:not(.busy)')
    assert page.input_value("#example") == ""
    part = workhold.Workpiece.from_loops("my plate", json.loads(PLATE)["loops"])
    found = shown.put("crossing", shown.numbers("crossing")["roots"][0])
    words = re.search(
        r"holes ([\d.]+) mm apart in one column .* radius ([\d.]+) mm", page.inner_text("#about-part")
    )
    assert words is not None
    fixtures = workhold.design(part, workhold.Vise(float(words[1]), 1, float(words[2])), types=["I"])
    assert f"There are {len(fixtures)} ways" in page.inner_text("#about-part")
    assert any(
        abs(one.pose.theta_deg - found["theta"]) < 1e-6
        and np.allclose(found["pose"], [one.pose.x, one.pose.y], atol=1e-6)
        for one in fixtures
    )
    page.select_option("#example", "oblongPart")
    page.wait_for_selector('body[data-lesson="oblongPart"]:not(.busy)')
    disc = {"name": "disc.json", "mimeType": "application/json", "buffer": DISC.encode()}
    page.set_input_files("#file", disc)
    page.locator("#trouble", has_text="choose a part with more sides").wait_for()
    assert page.get_attribute("body", "data-lesson") == "oblongPart"
    context.close()
    assert [line for line in shown.troubles if "400" not in line] == []


def test_what_a_file_leaves_open_is_asked_once(browser: Any, server: RunningServer) -> None:
    """A file with curves to fit is refused with the way to go, and its fitted part comes along from the other page."""
    home = f"http://127.0.0.1:{server.address[1]}/"
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    shown = LessonPage(context.new_page(), f"{home}method")
    page = shown.page
    bow = {"name": "bow.svg", "mimeType": "image/svg+xml", "buffer": BOW}
    page.set_input_files("#file", bow)
    page.locator("#trouble", has_text="asks what a file leaves open").wait_for()
    page.click("text=Find fixtures")
    page.wait_for_selector("body[data-ready=true]")
    page.set_input_files("#file", bow)
    page.click('#file-asks [data-fit="0.05"]')
    page.wait_for_selector("#faces button")
    page.click("#show-method")
    page.wait_for_selector('body[data-lesson="bow"]:not(.busy)')
    assert page.input_value("#example") == ""
    page.reload()
    page.wait_for_selector('body[data-lesson="bow"]:not(.busy)')
    context.close()
    assert [line for line in shown.troubles if "400" not in line] == []


BOW = b"""<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="80mm" viewBox="0 0 120 80">
<path d="M10 10H90C115 10 115 70 90 70H10Z"/></svg>"""
PLATE = json.dumps(
    {
        "name": "part",
        "units": "mm",
        "loops": [[[0, 0, 0], [70, 0, 0], [62, 33, 0.3], [40, 52, 0], [4, 45, 0]]],
    }
)
DISC = json.dumps({"name": "disc", "units": "mm", "loops": [[[0, 0, 1], [30, 0, 1]]]})


def test_each_step_has_few_words_and_files_are_short() -> None:
    """At most 80 words a step; scripts under 400 lines, no markup from text, no other address."""
    html = (STATIC / "index.html").read_text(encoding="utf-8")
    sections = re.findall(
        r'<section class="step" id="([\w-]+)".*?<div class="words">(.*?)</div>', html, flags=re.S
    )
    assert sorted(name for name, _ in sections) == sorted(STEPS)
    for name, words in sections:
        text = re.sub(r"<h2.*?</h2>|<[^>]+>", " ", words, flags=re.S)
        assert len(text.split()) <= 80, name
    assert not re.search(r"\sstyle=|\son\w+=|<style|javascript:|<script(?![^>]*src=)|https?://", html)
    assert set(re.findall(r'src="([\w.-]+)"', html)) == {path.name for path in STATIC.glob("*.js")}
    for path in STATIC.glob("*.js"):
        text = path.read_text(encoding="utf-8")
        assert text.count("\n") < 400, path.name
        assert "innerHTML" not in text, path.name
        assert set(re.findall(r"https?://[^\s\"'`]+", text)) <= {"http://www.w3.org/2000/svg"}, path.name
