"""The page that explains the method, in a browser."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

__all__ = ["BRACKET", "EXAMPLES", "STATIC", "LessonPage"]

STATIC = Path(str(files("workhold.web") / "static" / "method"))
BRACKET = Path(__file__).parents[3] / "examples" / "bracket.dxf"
EXAMPLES = ("bracket", "8Handle", "widget", "flange")
PATIENCE = 120_000.0


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

    def scroll_to(self, selector: str) -> None:
        """Bring an element into the middle of the window, and wait until the pictures have settled."""
        self.page.evaluate(
            """async (selector) => {
              document.querySelector(selector).scrollIntoView({ block: "center" });
              for (let k = 0; k < 3; k += 1) await new Promise(requestAnimationFrame);
            }""",
            selector,
        )

    def place(self, selector: str, across: float = 0.5, down: float = 0.5) -> tuple[float, float]:
        """Where in the window an element is, by shares of its size."""
        self.scroll_to(selector)
        x, y = self.page.evaluate(
            """([selector, across, down]) => {
              const box = document.querySelector(selector).getBoundingClientRect();
              return [box.left + across * box.width, box.top + down * box.height];
            }""",
            [selector, across, down],
        )
        return x, y

    def material(self, selector: str) -> tuple[float, float]:
        """A place in the window on a part that is drawn, towards its right side, where nothing lies over it."""
        self.scroll_to(selector)
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
