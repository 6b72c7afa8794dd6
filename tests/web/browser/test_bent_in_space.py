"""A part whose material is named: in three dimensions it is coloured by how far clamping bends it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from running_server import RunningServer
from walking import Walk

from bent_bodies import need_elements

need_elements()

COLOURS = """async () => {
  const { view } = await import("/static/space-dialog.js");
  view.render();
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [view.canvas.width, view.canvas.height];
  const context = copy.getContext("2d");
  context.drawImage(view.canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  let [yellow, blue] = [0, 0];
  for (let k = 0; k < data.length; k += 4) {
    if (data[k + 3] < 128) continue;
    const [red, green, light] = [data[k], data[k + 1], data[k + 2]];
    yellow += red > 1.4 * light && green > 1.6 * light && red < 1.4 * green;
    blue += light > 1.3 * green && light > red;
  }
  return { yellow, blue };
}"""


@pytest.fixture
def walk(browser: Any, server: RunningServer) -> Iterator[Walk]:
    context = browser.new_context(
        viewport={"width": 1440, "height": 900}, reduced_motion="reduce", accept_downloads=True
    )
    walk = Walk(context.new_page(), server)
    walk.open()
    yield walk
    context.close()
    assert walk.troubles == []


def test_a_part_of_a_material_is_shown_bent(walk: Walk) -> None:
    walk.take()
    walk.search()
    page = walk.page
    page.evaluate(
        """async () => {
          const { change, state } = await import("/static/state.js");
          change({ sheet: { ...state.sheet, material: "aluminium-6061", thickness: 8 } });
        }"""
    )
    page.click("#in-space")
    walk.seen("#space-kinds li")
    page.wait_for_function(
        "() => document.querySelector('#space-shape').textContent.includes('times as far')", timeout=120_000
    )
    told = page.inner_text("#space-shape")
    assert told.startswith("Clamping bends the part by up to ") and "µm" in told
    found = page.evaluate(COLOURS)
    assert found["yellow"] > 20 and found["blue"] > 20
    assert "material=aluminium-6061" in page.get_attribute("#space-save", "href")
