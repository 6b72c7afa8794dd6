"""The page that explains the method: its numbers are the program's, and mouse, keys and fingers move its pictures."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from importlib.resources import files
from math import cos, degrees, hypot, pi, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from running_server import RunningServer

import workhold
from workhold.kernels.chord.columns import CURVE_REALS
from workhold.kernels.chord.evaluation import chord_state, write_curve

STATIC = Path(str(files("workhold.web") / "static" / "method"))
AXE = Path(__file__).parent / "data" / "axe.min.js"
BRACKET = Path(__file__).parents[3] / "examples" / "bracket.dxf"
SLIDERS = ("one-peg", "two-pegs", "crossing", "closing", "every-one")
STEPS = (*SLIDERS, "closure")
EXAMPLES = ("bracket", "8Handle", "widget", "flange")
PATIENCE = 120_000.0
CHECK = """async () => {
  const found = await axe.run({ preload: false });
  const bad = found.violations.filter((rule) => ["serious", "critical"].includes(rule.impact));
  return bad.map((rule) => `${rule.id}: ${rule.nodes.map((node) => node.html.slice(0, 100)).join(" | ")}`);
}"""


class LessonPage:
    """The page in a browser.

    Parameters
    ----------
    page : of Playwright.
    troubles : errors of the page, and lines of its console.
    """

    def __init__(self, page: Any, address: str) -> None:
        self.page = page
        self.troubles: list[str] = []
        page.set_default_timeout(PATIENCE)
        page.on("pageerror", lambda error: self.troubles.append(str(error)))
        page.on("console", lambda line: self.troubles.append(line.text) if line.type == "error" else None)
        page.goto(address)
        page.wait_for_selector("body[data-ready]")

    def numbers(self, step: str) -> dict[str, Any]:
        """What stands in a step's picture and sentence, unrounded."""
        return dict(json.loads(self.page.get_attribute(f"#{step}", "data-numbers")))

    def words(self, step: str) -> str:
        """A step's sentence."""
        return str(self.page.inner_text(f"#{step} output"))

    def put(self, step: str, value: float) -> dict[str, Any]:
        """Move a slider to a value; the step's numbers there."""
        self.page.evaluate(
            """([step, value]) => {
              const slider = document.querySelector(`#${step} input`);
              slider.value = value;
              slider.dispatchEvent(new Event("input"));
            }""",
            [step, value],
        )
        return self.numbers(step)

    def range(self, step: str) -> tuple[float, float]:
        """The ends of a slider."""
        slider = self.page.locator(f"#{step} input")
        return float(slider.get_attribute("min")), float(slider.get_attribute("max"))

    def lesson(self, name: str) -> dict[str, Any]:
        """Choose an example; its lesson."""
        self.page.select_option("#example", name)
        self.page.wait_for_selector(f'body[data-lesson="{name}"]')
        found = self.page.evaluate("(name) => EXAMPLES.find((lesson) => lesson.name === name)", name)
        return dict(found)

    def place(self, selector: str, across: float = 0.5, down: float = 0.5) -> tuple[float, float]:
        """Where in the window an element is, by shares of its size."""
        self.page.locator(selector).first.scroll_into_view_if_needed()
        box = self.page.locator(selector).first.bounding_box()
        return box["x"] + across * box["width"], box["y"] + down * box["height"]

    def material(self, selector: str) -> tuple[float, float]:
        """A place in the window on a part that is drawn, towards its right side, where nothing lies over it."""
        self.page.locator(selector).first.scroll_into_view_if_needed()
        x, y = self.page.evaluate(
            """(selector) => {
              const part = document.querySelector(selector);
              const box = part.getBoundingClientRect();
              for (let across = 0.9; across > 0; across -= 0.04) {
                for (let down = 0.1; down < 1; down += 0.04) {
                  const place = [box.left + across * box.width, box.top + down * box.height];
                  if (document.elementFromPoint(...place) === part) return place;
                }
              }
            }""",
            selector,
        )
        return x, y


@pytest.fixture
def shown(browser: Any) -> Iterator[LessonPage]:
    """The page as a file, as in the manual; at the end nothing may have gone wrong unseen."""
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    page = LessonPage(context.new_page(), (STATIC / "index.html").as_uri())
    yield page
    context.close()
    assert page.troubles == []


def state_of(lesson: dict[str, Any], pair: int, theta: float) -> tuple[float, ...]:
    """A chord of the shown fixture at an orientation in radians, as the kernels have it."""
    tail, head, _, shift, length, branch, _, _ = lesson["fixtures"][0]["chords"][pair]
    a, b = (np.array([*lesson["features"][k], 0.0, 0.0]) for k in (tail, head))
    curve = np.zeros(CURVE_REALS)
    write_curve(curve, a, b, length, branch, shift)
    return tuple(chord_state(a, b, curve, -theta, cos(theta), -sin(theta)))


def pegs_of(lesson: dict[str, Any], pair: int) -> list[list[float]]:
    """Pegs of a pair of the shown fixture, that of the chord's tail first."""
    fixture = lesson["fixtures"][0]
    pegs = fixture["pegs"][2 * pair : 2 * pair + 2]
    return list(pegs[::-1] if fixture["chords"][pair][2] else pegs)


def turned(point: Any, angle: float) -> tuple[float, float]:
    """A point turned by an angle in radians."""
    c, s = cos(angle), sin(angle)
    return c * point[0] - s * point[1], s * point[0] + c * point[1]


def height_of(state: tuple[float, ...], theta: float) -> float:
    """The height h of a chord's tail."""
    return sin(theta) * state[0] + cos(theta) * state[1]


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_peg_stands_on_the_locus(shown: LessonPage, name: str) -> None:
    """Step 1: its centre is as far from the face as the peg's radius, and the normal points from face to peg."""
    lesson = shown.lesson(name)
    part = workhold.load(str(BRACKET) if name == "bracket" else name)
    segments = {face.number: face.segment for face in part.faces}
    low, high = shown.range("one-peg")
    for share in np.linspace(0.0, 1.0, 23):
        found = shown.put("one-peg", low + share * (high - low))
        segment, point = segments[found["face"]], found["point"]
        normal = segment.normal(segment.parameter(tuple(point)))
        assert np.allclose(found["normal"], normal, atol=1e-9)
        radius = lesson["toolkit"]["peg_radius"]
        contact = np.array(point) - radius * np.array(normal)
        assert np.allclose(contact, segment.at(segment.parameter(tuple(point))), atol=1e-9)
        words = f"x {point[0]:.2f}, y {point[1]:.2f} mm and touches face {found['face']}"
        assert words in shown.words("one-peg").replace("−", "-")


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_instant_centre_is_the_kernels(shown: LessonPage, name: str) -> None:
    """Step 2: tail, head, height and instant centre at any turn equal those of the program's own chord."""
    lesson = shown.lesson(name)
    low, high = shown.range("two-pegs")
    pegs = pegs_of(lesson, 0)
    for share in (0.0, 0.21, 0.5, 0.83, 1.0):
        found = shown.put("two-pegs", low + share * (high - low))
        theta = radians(found["theta"])
        state = state_of(lesson, 0, theta)
        assert np.allclose(found["tail"], state[:2], atol=1e-7)
        assert found["height"] == pytest.approx(height_of(state, theta), abs=1e-7)
        shift = np.subtract(pegs[0][2:4], turned(state[:2], theta))
        expected = np.add(turned(state[6:8], theta), shift)
        assert np.allclose(found["centre"], expected, rtol=1e-6, atol=1e-6)
        assert f"height {found['height']:.2f} mm" in shown.words("two-pegs").replace("−", "-")


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_crossing_is_the_fixture(shown: LessonPage, name: str) -> None:
    """Step 3: beside it pegs miss by the difference of heights; near it the part falls to the pose in the list."""
    lesson = shown.lesson(name)
    fixture = lesson["fixtures"][0]
    theta, x, y = fixture["pose"]
    low, high = shown.range("crossing")
    pitch = lesson["toolkit"]["pitch"][1]
    for share in (0.07, 0.4, 0.9):
        found = shown.put("crossing", low + share * (high - low))
        turn = radians(found["theta"])
        heights = [height_of(state_of(lesson, pair, turn), turn) for pair in (0, 1)]
        assert np.allclose(found["heights"], heights, atol=1e-7)
        rows = (heights[1] - heights[0] - pegs_of(lesson, 1)[0][3] + pegs_of(lesson, 0)[0][3]) / pitch
        assert found["miss"] == pytest.approx((rows - round(rows)) * pitch, abs=1e-6)
        if not found["fits"]:
            assert f"{abs(found['miss']):.2f} mm" in shown.words("crossing")
    nearly = degrees(theta) + min(0.3, (high - low) / 100)
    found = shown.put("crossing", nearly)
    assert found["fits"]
    assert found["theta"] == pytest.approx(degrees(theta), abs=1e-9)
    assert np.allclose(found["pose"], [x, y], atol=1e-7)
    assert "All four pegs touch" in shown.words("crossing")
    assert f"{degrees(theta):.3f}" in shown.words("crossing").replace("−", "-")


def gaps_of(lesson: dict[str, Any], pose: list[float], opened: float) -> list[float]:
    """How far the four pegs are from the faces they touch, in a pose with the right jaw moved."""
    fixture, out = lesson["fixtures"][0], []
    for pair in (0, 1):
        tail, head, swapped = fixture["chords"][pair][:3]
        found = []
        for number, peg in zip((tail, head), pegs_of(lesson, pair), strict=True):
            row = lesson["features"][number]
            px, py = turned((peg[2] + pair * opened - pose[1], peg[3] - pose[2]), -pose[0])
            dx, dy = px - row[1], py - row[2]
            found.append(dx * row[4] - dy * row[3] if not row[0] else row[7] * (hypot(dx, dy) - row[6]))
        out += found[::-1] if swapped else found
    return out


@pytest.mark.parametrize("name", EXAMPLES)
def test_opening_gives_the_room_that_balance_says(shown: LessonPage, name: str) -> None:
    """Step 4: all four gaps are equal, and for a small opening they are the opening over the sum of forces."""
    lesson = shown.lesson(name)
    fixture = lesson["fixtures"][0]
    forces = [peg[5] for peg in fixture["pegs"]]
    high = shown.range("closing")[1]
    for opened in (0.02 * high, high):
        found = shown.put("closing", opened)
        assert found["opening"] == pytest.approx(fixture["opening"] + opened, abs=1e-9)
        gaps = gaps_of(lesson, found["pose"], opened)
        assert np.allclose(found["gaps"], gaps, atol=1e-8)
        assert np.ptp(gaps) < 1e-8
    first = shown.put("closing", 0.02 * high)["gaps"][0]
    assert first == pytest.approx(0.02 * high / sum(forces), rel=0.1)
    found = shown.put("closing", 0.0)
    assert np.allclose(found["gaps"], 0.0, atol=1e-8)
    assert found["forces"] == forces
    assert shown.page.locator("#closing .arrow.push").count() == 4
    words = ", ".join(f"{force:.2f}" for force in forces)
    assert f"{fixture['opening']:.3f} mm, closed" in shown.words("closing")
    assert words in shown.words("closing")


@pytest.mark.parametrize("name", EXAMPLES)
def test_moments_of_the_forces_cancel_about_any_centre(shown: LessonPage, name: str) -> None:
    """Step 5: arms are those of the wrenches, forces times arms sum to zero, and both senses are stopped."""
    lesson = shown.lesson(name)
    fixture = lesson["fixtures"][0]
    theta = fixture["pose"][0]
    handle = shown.page.locator("#closure .handle")
    handle.focus()
    for key in ("ArrowUp", "ArrowUp", "ArrowLeft", "ArrowDown", "ArrowRight", "ArrowRight", "ArrowRight"):
        before = shown.numbers("closure")["point"]
        handle.press(key)
        found = shown.numbers("closure")
        point = found["point"]
        moved = np.sign(np.subtract(point, before)).tolist()
        assert (
            moved
            == {"ArrowUp": [0, 1], "ArrowDown": [0, -1], "ArrowLeft": [-1, 0], "ArrowRight": [1, 0]}[key]
        )
        arms = []
        for pair in (0, 1):
            state = state_of(lesson, pair, theta)
            rows = [lesson["features"][k] for k in fixture["chords"][pair][:2]]
            normals = [
                turned(np.multiply(n, row[7]), theta)
                for n, row in zip((state[2:4], state[4:6]), rows, strict=True)
            ]
            both = [
                n[1] * (peg[2] - point[0]) - n[0] * (peg[3] - point[1])
                for n, peg in zip(normals, pegs_of(lesson, pair), strict=True)
            ]
            arms += both[::-1] if fixture["chords"][pair][2] else both
        assert np.allclose(found["arms"], arms, atol=1e-7)
        assert found["forces"] == [peg[5] for peg in fixture["pegs"]]
        assert abs(sum(found["moments"])) < 1e-6
        assert found["left"] and found["right"]
        assert sorted(found["left"] + found["right"]) == [1, 2, 3, 4]


@pytest.mark.parametrize("name", EXAMPLES)
def test_sampling_finds_what_numpy_says(shown: LessonPage, name: str) -> None:
    """Step 6: a fixture is seen if its crossing lies between neighbours at which both its chords exist."""
    lesson = shown.lesson(name)
    pitch, every = lesson["toolkit"]["pitch"][1], {one["rank"] for one in lesson["fixtures"]}
    before = -1
    for index in (0, 3, 6, 10, 14):
        found = shown.put("every-one", index)
        count, expected = found["samples"], []
        grid = radians(0.7320508075688772) + pi * np.arange(-2 * count, 2 * count) / count
        for one in lesson["fixtures"]:
            step = int(np.searchsorted(grid, one["pose"][0], side="right")) - 1
            ends = grid[step : step + 2]
            if min(-ends) < max(c[6] for c in one["chords"]) or max(-ends) > min(c[7] for c in one["chords"]):
                continue
            alone = {**lesson, "fixtures": [one]}
            rows = []
            for theta in ends:
                heights = [height_of(state_of(alone, pair, theta), theta) for pair in (0, 1)]
                rows.append(
                    (heights[1] - heights[0] - pegs_of(alone, 1)[0][3] + pegs_of(alone, 0)[0][3]) / pitch
                )
            if rows[0] * rows[1] <= 0:
                expected.append(one["rank"])
        assert sorted(found["found"]) == sorted(expected)
        assert f"{len(expected)} of {len(every)} fixtures found" in shown.words("every-one")
        before = max(before, len(expected))
    assert before > 0
    assert len(shown.put("every-one", 0)["found"]) < len(every)


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


@pytest.mark.parametrize("width", [380, 1280])
@pytest.mark.parametrize("scheme", ["light", "dark"])
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
