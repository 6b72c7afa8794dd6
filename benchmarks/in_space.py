"""The page's view in three dimensions without a graphics card: 60 bodies turned in Chromium, in frames a second.

Chromium draws WebGL with SwiftShader, on the processor. Every frame is drawn, and read back so that it is whole, one after
the other; the page itself draws a frame only when something changed. Where WebGL would be drawn by the processor, the page
does without it, which is told beside it.
"""

from __future__ import annotations

import argparse
import base64
import functools
import shutil
import threading
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import as_file, files
from math import pi
from pathlib import Path
from typing import Any, ClassVar

from report import Column, Section
from workhold.files.glb import make_bodies_glb
from workhold.geometry.segment import Arc, Box
from workhold.model.bodies import BodyKind, FixtureBody, Slab, make_rectangle

BODIES, LEAST_FRAMES, NUMBER = 60, 30.0, 12
SIZES = ((1000, 500), (390, 480))
TURN = """async ([glb, width, height, plain, count]) => {
  const { bodiesOf } = await import("/space/glb-reading.js");
  const canvas = document.createElement("canvas");
  canvas.style.cssText = `display: block; width: ${width}px; height: ${height}px`;
  document.body.replaceChildren(canvas);
  let view;
  if (plain) {
    const { PlainView } = await import("/space/plain-view.js");
    view = new PlainView(canvas, canvas.getContext("2d"));
  } else {
    const { SpaceView } = await import("/space/space-view.js");
    view = new SpaceView(canvas, canvas.getContext("webgl2", { antialias: true, alpha: true }));
  }
  view.show(bodiesOf(Uint8Array.from(atob(glb), (letter) => letter.charCodeAt(0)).buffer));
  const whole = new Uint8Array(4);
  const times = [];
  for (let k = 0; k < count + 5; k += 1) {
    const begun = performance.now();
    view.look(0.1 * k, 0.6 + 0.3 * Math.sin(0.2 * k));
    view.render();
    if (!plain) {
      const gl = view.renderer.getContext();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, whole);
    }
    times.push(performance.now() - begun);
    await new Promise(requestAnimationFrame);
  }
  const name = plain ? "" : view.renderer.getContext().getParameter(view.renderer.getContext().RENDERER);
  const triangles = view.shown.reduce((sum, one) => sum + (one.triangles ?? one.mesh.geometry.index.array).length / 3, 0);
  return { times: times.slice(5), bodies: view.shown.length, triangles, name };
}"""


def round_slab(x: float, y: float, radius: float, low: float, high: float) -> Slab:
    """A cylinder."""
    return Slab((Arc((x, y), radius, 0.0, pi, 1.0),), (), low, high)


def many_bodies() -> list[FixtureBody]:
    """A part with holes on a drilled plate, with pegs, supports and clamps: 60 bodies."""
    holes = tuple(
        (Arc((20.0 * column, 20.0 * row), 3.0, 0.0, pi, -1.0),) for column in range(16) for row in range(12)
    )
    plate = Slab(make_rectangle(Box(-10, -10, 310, 230)), holes, -10.0, 0.0)
    bores = tuple((Arc((80.0 + 35 * k, 110.0), 12.0, 0.0, pi, -1.0),) for k in range(5))
    part = Slab(make_rectangle(Box(53, 53, 247, 167)), bores, 0.0, 25.0)
    bodies = [FixtureBody("plate", BodyKind.PLATE, (plate,)), FixtureBody("part", BodyKind.PART, (part,))]
    for number in range(BODIES - len(bodies)):
        kind = (BodyKind.PEG, BodyKind.SUPPORT, BodyKind.CLAMP)[number % 3]
        x, y = 20.0 * (number % 15), 20.0 * (number // 15) * 3
        shaft, head = round_slab(x, y, 3.0, -10.0, 12.0), round_slab(x, y, 6.0, 12.0, 16.0)
        bodies.append(FixtureBody(f"{kind} {number}", kind, (shaft, head)))
    return bodies


class Quiet(SimpleHTTPRequestHandler):
    """Serves files and tells nobody."""

    extensions_map: ClassVar = {**SimpleHTTPRequestHandler.extensions_map, ".js": "text/javascript"}

    def log_message(self, format: str, *args: Any) -> None:
        """Tells nothing."""


def measured_frames(folder: Path, count: int) -> list[tuple[tuple[int, int], bool, dict[str, Any]]]:
    """Times in ms of the frames for each size of the canvas, with WebGL and without."""
    from playwright.sync_api import sync_playwright

    glb = base64.b64encode(make_bodies_glb(many_bodies(), "many")).decode()
    server = ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    found = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=chromium,
            args=["--no-sandbox", "--enable-unsafe-swiftshader", "--use-angle=swiftshader"],
        )
        page = browser.new_page(viewport={"width": 1100, "height": 700})
        page.goto(f"http://127.0.0.1:{server.server_port}/space/README.txt")
        for size in SIZES:
            for plain in (False, True):
                found.append((size, plain, page.evaluate(TURN, [glb, *size, plain, count])))
        browser.close()
    server.shutdown()
    return found


def run(quick: bool = False) -> Section:
    """Measure, and tell what was measured."""
    section = Section(
        "in-space",
        "The view in three dimensions, without a graphics card",
        (
            Column("canvas", 12, right=False),
            Column("drawn with", 14, right=False),
            Column("bodies", 6),
            Column("triangles", 9),
            Column("median ms", 9),
            Column("90 % ms", 8),
            Column("frames/s", 8),
        ),
    ).begin()
    slowest = None
    with as_file(files("workhold.web") / "static") as folder:
        for (width, height), plain, told in measured_frames(Path(folder), 20 if quick else 120):
            times = sorted(told["times"])
            median, late = times[len(times) // 2], times[int(0.9 * len(times))]
            if plain:
                slowest = max(slowest or 0.0, median)
            way = "no WebGL" if plain else "SwiftShader"
            row = (
                str(told["bodies"]),
                str(int(told["triangles"])),
                f"{median:.1f}",
                f"{late:.1f}",
                f"{1000 / median:.0f}",
            )
            section.row(f"{width} x {height}", way, *row)
    assert slowest is not None
    section.remark(
        "The page draws without WebGL where no graphics card stands behind it, so that is what counts."
    )
    section.target(
        NUMBER,
        f"{BODIES} bodies at {LEAST_FRAMES:.0f} frames a second on software rendering",
        f"{1000 / slowest:.0f} frames a second",
        1000 / slowest >= LEAST_FRAMES,
    )
    return section


def main() -> None:
    """Run as a script."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="fewer frames; no figures are kept")
    options = parser.parse_args()
    section = run(options.quick)
    if not options.quick:
        section.keep()


if __name__ == "__main__":
    main()
