"""What a visitor does on the page, in words; everything waits for what can be seen, nothing for time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from attrs import define, field
from running_server import RunningServer

EXAMPLES = Path(__file__).parents[3] / "examples"
# A search may have to wait for kernels to be loaded on a busy machine.
SEARCH_PATIENCE, SEEN_PATIENCE = 120_000.0, 180_000.0

POINT_ON_PAGE = """async ([view, x, y]) => {
  const stage = await import("/static/stage-panel.js");
  const drawing = stage[view];
  const [px, py] = drawing.view.page([x, y]);
  const box = drawing.svg.getBoundingClientRect();
  return [box.left + px, box.top + py];
}"""


# The ends of a clamp's body and the middle of its bolt, in mm; as soon as it begins to close where that is wanted.
CLAMP_ENDS = """async (closes) => {
  const { fixtureDrawing } = await import("/static/stage-panel.js");
  const back = fixtureDrawing.map.inverse();
  if (closes) document.querySelector("#close-vise").click();
  const body = document.querySelector("#drawing-fixture .clamp-body").getAttribute("d");
  const [x0, y0, x1, y1] = body.match(/-?[\\d.]+/g).map(Number);
  const bolt = document.querySelector("#drawing-fixture .bolt");
  const places = [[x0, y0], [x1, y1], [Number(bolt.getAttribute("cx")), Number(bolt.getAttribute("cy"))]];
  return places.flatMap(([x, y]) => {
    const point = back.transformPoint({ x, y });
    return [point.x, point.y];
  });
}"""


@define(eq=False)
class Walk:
    """A page of the browser, and the server behind it.

    Parameters
    ----------
    troubles : errors of the page and lines of its console, but for refusals that a test expects.
    asked : addresses that the page has asked for.
    """

    page: Any
    server: RunningServer
    troubles: list[str] = field(factory=list)
    asked: list[str] = field(factory=list)

    def __attrs_post_init__(self) -> None:
        self.page.set_default_timeout(SEEN_PATIENCE)
        self.page.on("pageerror", lambda error: self.troubles.append(str(error)))
        self.page.on(
            "console", lambda line: self.troubles.append(line.text) if line.type == "error" else None
        )
        self.page.on("request", lambda request: self.asked.append(request.url))

    @property
    def home(self) -> str:
        """The page's address."""
        return f"http://127.0.0.1:{self.server.address[1]}/"

    def open(self, address: str | None = None) -> None:
        """Open the page and wait until it is ready."""
        self.page.goto(address or self.home)
        self.ready()

    def reload(self) -> None:
        """Load the page again, once the address holds the state; it follows it after a moment of quiet."""
        self.page.evaluate("async () => (await import('/static/link.js')).keep()")
        self.page.reload()
        self.ready()

    def ready(self) -> None:
        """Wait until the page has set itself up."""
        self.page.wait_for_selector("body[data-ready]")

    def seen(self, selector: str, patience: float = SEEN_PATIENCE) -> Any:
        """An element, once it is to be seen."""
        element = self.page.locator(selector).first
        element.wait_for(state="visible", timeout=patience)
        return element

    def until(self, condition: str, given: Any = None) -> None:
        """Wait until a condition on the page's state holds; a promise cannot be polled by Playwright itself."""
        script = f"""async (given) => {{
          const {{ state }} = await import("/static/state.js");
          const end = Date.now() + {SEEN_PATIENCE};
          while (!({condition})) {{
            if (Date.now() > end) throw new Error("waited in vain");
            await new Promise(requestAnimationFrame);
          }}
        }}"""
        self.page.evaluate(script, given)

    def go(self, section: str) -> None:
        """Show a section of the page where there is room for one only."""
        tab = self.page.locator(f".sections [data-to={section}]")
        if tab.is_visible():
            tab.click()

    def take(self, part: str = "widget", pitch: str | None = "8") -> None:
        """Take a built-in part and a one-column gripper."""
        self.go("settings")
        self.page.select_option("#builtin", part)
        self.seen("#faces button")
        self.page.select_option("#preset", "gripper-one-column")
        if pitch is not None:
            for name in ("#pitch-x", "#pitch-y"):
                self.page.fill(name, pitch)
                self.page.press(name, "Tab")

    def search(self) -> None:
        """Press the button and wait for the end."""
        self.page.click("#search")
        self.searched()

    def searched(self, shown: bool = True) -> None:
        """Wait for the end of the search and its first row, and until its fixture is on show."""
        self.page.wait_for_selector('body[data-search="done"]', timeout=SEARCH_PATIENCE)
        self.page.wait_for_selector("#list .row:not(.coming)", state="attached")
        self.page.wait_for_selector("#pegs tr", state="visible" if shown else "attached")

    def count(self) -> int:
        """How many fixtures the page tells."""
        return int("".join(c for c in self.page.inner_text("#count") if c.isdigit()))

    def job(self) -> str:
        """The search on show."""
        return str(self.page.evaluate("async () => (await import('/static/state.js')).state.job.job"))

    def arrived(self) -> None:
        """Wait until the fixture that the list marks has come."""
        marked = "document.querySelector('#list [aria-selected=true] b')"
        self.until(f"!{marked} || state.selected?.rank === Number({marked}.textContent)")

    def shown(self) -> dict[str, Any]:
        """The fixture on show, as the server told it."""
        self.arrived()
        return dict(self.page.evaluate("async () => (await import('/static/state.js')).state.selected"))

    def holes(self) -> list[str]:
        """Holes in the table of pegs."""
        self.arrived()
        return list(self.page.locator("#pegs td:first-child").all_inner_texts())

    def point(self, x: float, y: float, drawing: str = "partDrawing") -> tuple[float, float]:
        """Where in the window a point of a drawing (mm) is."""
        px, py = self.page.evaluate(POINT_ON_PAGE, [drawing, x, y])
        return px, py

    def click_at(self, x: float, y: float) -> None:
        """Click a point of the part's drawing."""
        self.page.mouse.click(*self.point(x, y))

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Drag from one point of the window to another."""
        self.page.mouse.move(*start)
        self.page.mouse.down()
        self.page.mouse.move(*end, steps=5)
        self.page.mouse.up()

    def saved(self, selector: str) -> bytes:
        """What a link downloads."""
        with self.page.expect_download() as coming:
            self.page.click(selector)
        return Path(coming.value.path()).read_bytes()
