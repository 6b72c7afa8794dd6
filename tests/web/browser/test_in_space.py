"""The fixture in three dimensions: drawn, turned by mouse and keys, opened by the slider, and told without WebGL."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from running_server import RunningServer
from walking import Walk

from glb_reading import read_glb

# How many pixels are covered by bodies, and a sum that tells pictures apart.
PICTURE = """async () => {
  const { view } = await import("/static/space-dialog.js");
  view.render();
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [view.canvas.width, view.canvas.height];
  const context = copy.getContext("2d");
  context.drawImage(view.canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  let covered = 0;
  let sum = 0;
  const colours = new Set();
  for (let k = 0; k < data.length; k += 4) {
    if (data[k + 3] < 128) continue;
    covered += 1;
    sum = (sum * 31 + data[k] + 7 * data[k + 1] + 13 * data[k + 2] + k) % 1000000007;
    colours.add((data[k] << 16) | (data[k + 1] << 8) | data[k + 2]);
  }
  return { share: covered / (data.length / 4), sum, colours: colours.size };
}"""
BODIES = """async () => {
  const { view } = await import("/static/space-dialog.js");
  const moved = ({ opens }) => (opens ?? [0, 0, 0]).map((part) => part * view.opened);
  return view.shown.map((one) => (one.mesh ? [one.mesh.name, one.mesh.position.toArray()] : [one.name, moved(one)]));
}"""
HAS_WEBGL = "() => Boolean(document.createElement('canvas').getContext('webgl2'))"
OPEN_WIDE = """() => {
  const slider = document.querySelector("#space-opening");
  slider.value = slider.max;
  slider.dispatchEvent(new Event("input"));
}"""
# The share of pixels that one way of drawing covers and the other does not, and how far colours are apart where most do.
BOTH = """async () => {
  const { view } = await import("/static/space-dialog.js");
  const { PlainView } = await import("/static/space/plain-view.js");
  const { bodiesOf } = await import("/static/space/glb-reading.js");
  const answer = await fetch(document.querySelector("#space-save").href);
  const plain = document.createElement("canvas");
  view.canvas.after(plain);
  plain.style.cssText = `display: block; width: ${view.canvas.clientWidth}px; height: ${view.canvas.clientHeight}px`;
  const other = new PlainView(plain, plain.getContext("2d"));
  other.show(bodiesOf(await answer.arrayBuffer()));
  view.look(0.4, 0.5);
  other.look(0.4, 0.5);
  const pixels = [view, other].map((one) => {
    one.render();
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [400, 240];
    copy.getContext("2d").drawImage(one.canvas, 0, 0, 400, 240);
    return copy.getContext("2d").getImageData(0, 0, 400, 240).data;
  });
  plain.remove();
  let [either, uncovered, both] = [0, 0, 0];
  const apart = [];
  for (let k = 0; k < pixels[0].length; k += 4) {
    const seen = pixels.map((data) => data[k + 3] > 128);
    either += seen[0] || seen[1];
    uncovered += seen[0] !== seen[1];
    if (!seen[0] || !seen[1]) continue;
    both += 1;
    apart.push([0, 1, 2].reduce((sum, c) => sum + Math.abs(pixels[0][k + c] - pixels[1][k + c]), 0) / 765);
  }
  apart.sort((a, b) => a - b);
  return { covered: uncovered / either, colour: apart[Math.floor(0.9 * both)] };
}"""


# With a graphics card, as far as the browser tells; and a browser without WebGL.
WITH_CARD = """const given = WebGL2RenderingContext.prototype.getExtension;
WebGL2RenderingContext.prototype.getExtension = function (name) {
  return name === "WEBGL_debug_renderer_info" ? null : given.call(this, name);
};"""
WITHOUT_WEBGL = """const given = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
  return kind.startsWith("webgl") ? null : given.call(this, kind, ...more);
};"""


@contextmanager
def walking(browser: Any, server: RunningServer, script: str) -> Iterator[Walk]:
    """The page in a browser that runs a script before it."""
    context = browser.new_context(
        viewport={"width": 1440, "height": 900}, reduced_motion="reduce", accept_downloads=True
    )
    context.add_init_script(script)
    walk = Walk(context.new_page(), server)
    walk.open()
    yield walk
    context.close()
    assert walk.troubles == []


def in_space(walk: Walk) -> Walk:
    """The best fixture of the widget in three dimensions."""
    walk.take()
    walk.search()
    walk.page.click("#in-space")
    walk.seen("#space-kinds li")
    return walk


@pytest.fixture(scope="module", params=["card", "slow"])
def searched(browser: Any, server: RunningServer, request: Any) -> Iterator[tuple[Walk, bool]]:
    """Fixtures of the widget on a page that draws by WebGL, and on one where that would be slow; whether it is."""
    with walking(browser, server, WITH_CARD if request.param == "card" else "") as walk:
        if request.param == "card" and not walk.page.evaluate(HAS_WEBGL):
            pytest.skip("this chromium draws no WebGL")
        walk.take()
        walk.search()
        yield walk, request.param == "slow"


@pytest.fixture
def opened(searched: tuple[Walk, bool]) -> Iterator[Walk]:
    """The best fixture in three dimensions."""
    walk, is_slow = searched
    walk.page.click("#in-space")
    walk.seen("#space-kinds li")
    assert ("without WebGL" in walk.page.inner_text("#space-words")) == is_slow
    yield walk
    walk.page.click("#space .primary")
    if walk.shown()["rank"] != 1:
        walk.page.click("#previous")
        walk.until("state.selected.rank === 1")


@pytest.fixture
def carded(browser: Any, server: RunningServer) -> Iterator[Walk]:
    """The same drawn by WebGL only."""
    with walking(browser, server, WITH_CARD) as walk:
        if not walk.page.evaluate(HAS_WEBGL):
            pytest.skip("this chromium draws no WebGL")
        yield in_space(walk)


@pytest.fixture
def without(browser: Any, server: RunningServer) -> Iterator[Walk]:
    """The page in a browser that gives no WebGL."""
    with walking(browser, server, WITHOUT_WEBGL) as walk:
        yield walk


def told(walk: Walk) -> list[Any]:
    """The bodies of the fixture shown, as the server's file has them."""
    answer = walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures/{walk.shown()['rank']}/assembly.glb")
    assert answer.headers["content-type"] == "model/gltf-binary"
    return read_glb(answer.content)[1]


def test_every_body_is_drawn(opened: Walk) -> None:
    """As many as the file has, by the same names; the picture is not empty, and the legend counts them by kind."""
    bodies = told(opened)
    assert [name for name, _ in opened.page.evaluate(BODIES)] == [body.name for body in bodies]
    picture = opened.page.evaluate(PICTURE)
    assert picture["share"] > 0.1 and picture["colours"] > 20
    assert opened.page.locator("#space-kinds li").all_inner_texts() == ["part: widget", "peg: 4", "plate: 2"]


def test_it_is_turned_by_mouse_and_keys(opened: Walk) -> None:
    """Dragging, arrows, the wheel and plus change the picture; 0 brings the first one back."""
    page = opened.page
    first = page.evaluate(PICTURE)
    box = page.locator("#space-canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    pictures = [first["sum"]]

    def changed() -> None:
        pictures.append(page.evaluate(PICTURE)["sum"])

    opened.drag((x, y), (x + 90, y + 30))
    changed()
    page.mouse.wheel(0, -200)
    changed()
    for key in ("ArrowLeft", "ArrowUp", "+", "Shift+ArrowRight"):
        page.press("#space-canvas", key)
        changed()
    assert len(set(pictures)) == len(pictures)
    rank = opened.shown()["rank"]
    page.press("#space-canvas", "0")
    assert page.evaluate(PICTURE)["sum"] == first["sum"]
    assert opened.shown()["rank"] == rank


def test_the_slider_opens_what_moves(opened: Walk) -> None:
    """The right jaw and its pegs move along its opening by what is said, all else stays; closed again all is as before."""
    page = opened.page
    page.evaluate(OPEN_WIDE)
    by = float(page.inner_text("#space-opened").split()[0])
    assert by > 5
    moved = dict(page.evaluate(BODIES))
    for body in told(opened):
        x, y, z = moved[body.name]
        wanted = (0, 0, 0) if body.opens is None else [1e-3 * by * part for part in body.opens]
        assert (x, -z, y) == pytest.approx(tuple(wanted), abs=1e-4)
    assert any(any(place) for place in moved.values())


def test_the_view_fits_the_next_fixture_too(opened: Walk) -> None:
    """Closed and opened again for another fixture: its bodies, and none of those before."""
    page = opened.page
    page.click("#space .primary")
    page.click("#next")
    opened.until("state.selected.rank === 2")
    page.click("#in-space")
    opened.seen("#space-title:has-text('Fixture 2')")
    opened.seen("#space-kinds li")
    assert [name for name, _ in page.evaluate(BODIES)] == [body.name for body in told(opened)]


def test_without_webgl_a_plainer_picture_is_drawn(without: Walk) -> None:
    """One sentence says so; the bodies are there, turned by keys and opened by the slider; and the page goes on."""
    page = without.page
    in_space(without)
    assert page.inner_text("#space-words").count(".") == 1 and "without WebGL" in page.inner_text(
        "#space-words"
    )
    first = page.evaluate(PICTURE)
    assert first["share"] > 0.1 and first["colours"] > 20
    sums = [first["sum"]]
    for key in ("ArrowLeft", "ArrowUp", "+", "Shift+ArrowRight"):
        page.press("#space-canvas", key)
        sums.append(page.evaluate(PICTURE)["sum"])
    page.press("#space-canvas", "0")
    assert page.evaluate(PICTURE)["sum"] == first["sum"]
    page.evaluate(OPEN_WIDE)
    sums.append(page.evaluate(PICTURE)["sum"])
    assert len(set(sums)) == len(sums)
    assert read_glb(without.saved("#space-save"))[1]
    page.click("#space .primary")
    page.click("#next")
    without.until("state.selected.rank === 2")


def test_both_ways_of_drawing_show_the_same(carded: Walk) -> None:
    """With and without WebGL the bodies cover the same pixels, but for their rims, in nearly the same colours."""
    differ = carded.page.evaluate(BOTH)
    assert differ["covered"] < 0.01 and differ["colour"] < 0.12, differ


# How much of the canvas all bodies take, across and down, when they are seen whole from angles: 1 is all of it.
WHOLE = """async ([low, high, width, height, around, above]) => {
  const { HALF_FIELD, Orbit } = await import("/static/space/orbit.js");
  const canvas = document.createElement("canvas");
  Object.defineProperties(canvas, { clientWidth: { value: width }, clientHeight: { value: height } });
  const view = new Orbit(canvas);
  view.frame([{ positions: [...low, ...high] }], false);
  view.fit(around, above);
  const seen = view.corners.map((corner) => view.axes().map((axis) =>
    axis.reduce((sum, value, k) => sum + value * (corner[k] - view.target[k]), 0)));
  const places = seen.map(([x, y, out]) => [x, y].map((value) => value / (view.far - out) / HALF_FIELD));
  const across = places.map(([x]) => (x * height) / width);
  return [across, places.map(([, y]) => y)].flatMap((all) => [Math.min(...all), Math.max(...all)]);
}"""


@pytest.mark.parametrize("canvas", [(960, 480), (330, 440), (330, 200)], ids=str)
@pytest.mark.parametrize("look", [(-0.6, 0.75), (0.0, 1.57), (0.0, 0.0)], ids=str)
def test_a_long_bar_is_seen_whole_and_large(
    walk: Walk, canvas: tuple[int, int], look: tuple[float, float]
) -> None:
    """On a wide window and on a phone, from each side: nothing is cut off, and one side of the canvas is filled."""
    bar = [[-0.2, 0.0, -0.015], [0.2, 0.025, 0.015]]
    left, right, low, high = walk.page.evaluate(WHOLE, [*bar, *canvas, *look])
    assert -0.98 < left < right < 0.98 and -0.98 < low < high < 0.98
    assert max(right - left, high - low) > 2 * 0.85
    assert abs(left + right) < 0.1 and abs(low + high) < 0.1
