"""The part of a STEP file in three dimensions: its own shape, by name, closed while it is played, on both sides."""

from __future__ import annotations

import pytest
from step_shapes import box, cut, cylinder, filleted, fused, upright, write_step
from test_in_space import BODIES, OPEN_WIDE
from test_solids_shown import held
from walking import Walk

from glb_reading import read_glb

# The volume in mm³ of the body of a number, of its triangles where they are drawn.
VOLUME = """async (number) => {
  const { view } = await import("/static/space-dialog.js");
  const { positions, triangles } = view.shown[number];
  let sum = 0;
  for (let k = 0; k < triangles.length; k += 3) {
    const corner = (at) => [...positions.slice(3 * triangles[k + at], 3 * triangles[k + at] + 3)];
    const [[a, b, c], [d, e, f], [g, h, i]] = [0, 1, 2].map(corner);
    sum += a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g);
  }
  return (sum / 6) * 1e9;
}"""
# Places of the canvas where a body is seen, by its number.
SEEN_AT = """async () => {
  const { view } = await import("/static/space-dialog.js");
  view.render();
  const box = view.canvas.getBoundingClientRect();
  const found = {};
  for (let x = 2; x < box.width; x += 4) {
    for (let y = 2; y < box.height; y += 4) {
      const number = view.bodyAt(x, y);
      // Where all about is of the same body no edge is near.
      const near = [-4, 0, 4].flatMap((dx) => [-4, 0, 4].map((dy) => view.bodyAt(x + dx, y + dy)));
      if (number !== null && near.every((other) => other === number)) found[number] ??= [box.left + x, box.top + y];
    }
  }
  return Object.entries(found).map(([number, place]) => [Number(number), place]);
}"""
SOLID = 100 * 70 * 12 - 12 * (4 - 3.14159265) * 64 + 60 * 40 * 18 - 3.14159265 * 81 * 30


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A base of 100 x 70 x 12 mm with a boss of 60 x 40 x 18 mm on it and a bore through both."""
    base = filleted(box(100, 70, 12), 8, upright)
    shape = cut(fused(base, box(60, 40, 18, (20, 15, 12))), cylinder(9, 40, (50, 35, -1)))
    return str(write_step(tmp_path_factory.mktemp("solids") / "block.step", shape))


def in_space(walk: Walk) -> None:
    """Open the view, and wait for what is said of the part's shape."""
    walk.page.click("#in-space")
    walk.seen("#space-kinds li")
    walk.seen("#space[aria-busy=false]")


def volume(walk: Walk) -> float:
    """Of the part that is drawn, in mm³."""
    return float(walk.page.evaluate(VOLUME, 0))


def test_the_part_is_drawn_as_its_file_has_it(walk: Walk, block: str) -> None:
    """Its volume is the solid's, also in what is saved; where the file is not at hand a prism is told."""
    held(walk, block)
    in_space(walk)
    assert walk.page.inner_text("#space-shape") == ""
    assert volume(walk) == pytest.approx(SOLID, rel=1e-3)
    assert read_glb(walk.saved("#space-save"))[1][0].volume == pytest.approx(SOLID, rel=1e-3)
    walk.page.click("#space .primary")
    sent = [address for address in walk.asked if "parts/shape" in address]
    in_space(walk)
    assert volume(walk) == pytest.approx(SOLID, rel=1e-3)
    assert [address for address in walk.asked if "parts/shape" in address] == sent and len(sent) == 1
    walk.page.click("#space .primary")
    walk.reload()
    walk.page.select_option("#preset", "gripper-one-column")
    walk.search()
    in_space(walk)
    assert "open its STEP file again" in walk.page.inner_text("#space-shape")
    assert volume(walk) > 1.5 * SOLID


def test_bodies_are_named_where_they_are_pointed_at(walk: Walk, block: str) -> None:
    """The name under the mouse is that of the body that is seen there; beside all of them there is none."""
    held(walk, block)
    in_space(walk)
    names = [name for name, _ in walk.page.evaluate(BODIES)]
    places = walk.page.evaluate(SEEN_AT)
    assert len(places) > 5
    for number, (x, y) in places:
        walk.page.mouse.move(x, y)
        assert names[number] in walk.page.inner_text("#space-name")
    corner = walk.page.locator("#space-canvas").bounding_box()
    walk.page.mouse.move(corner["x"] + 3, corner["y"] + 3)
    assert walk.page.inner_text("#space-name") == ""


def test_both_set_ups_are_played_one_after_the_other(walk: Walk, block: str) -> None:
    """Open, closed, then the part turned over, open and closed; each side with the solid that way up."""
    held(walk, block)
    walk.page.click("#second-side")
    walk.until("state.part?.solid.axis === '-z' && state.sides?.shown === 1")
    walk.searched()
    in_space(walk)
    assert volume(walk) == pytest.approx(SOLID, rel=1e-3)
    script = """() => {
      window.seen = [];
      const words = (id) => document.querySelector(`#space-${id}`).textContent;
      const note = () => window.seen.push([words("title"), words("opened")]);
      new MutationObserver(note).observe(document.querySelector("#space-opened"), { childList: true });
      document.querySelector("#space-play").click();
    }"""
    walk.page.evaluate(script)
    walk.page.wait_for_function(
        "() => window.seen.length > 3 && window.seen.at(-1)[0].startsWith('Second') && window.seen.at(-1)[1] === 'closed' "
        "&& window.seen.at(-2)[1] !== 'closed'"
    )
    seen = [tuple(each) for each in walk.page.evaluate("() => window.seen")]
    steps = [(title.split(" ")[0], opened != "closed") for title, opened in seen]
    wanted = [(side, is_open) for side in ("First", "Second") for is_open in (False, True, False)]
    assert [step for k, step in enumerate(steps) if k == 0 or step != steps[k - 1]] == wanted
    walk.page.evaluate(OPEN_WIDE)
    moved = dict(walk.page.evaluate(BODIES))
    assert any(any(place) for place in moved.values())
