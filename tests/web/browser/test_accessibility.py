"""axe-core finds no serious fault, in light, in dark and on a phone; the page keeps to its own rules."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from running_server import RunningServer
from walking import Walk

AXE = Path(__file__).parent / "data" / "axe.min.js"
STATIC = files("workhold.web") / "static"
# What shows bodies in three dimensions, and the library that draws them, as it came.
OWN = ("edges.js", "glb-reading.js", "orbit.js", "plain-view.js", "playing.js", "space-view.js")
LIBRARY = ("README.txt", "three-LICENSE.txt", "three.module.min.js")
# Its unit, and which of its parts, are open.
ASKING = {
    "name": "two.svg",
    "mimeType": "image/svg+xml",
    "buffer": b'<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H20V10H0Z"/><path d="M50 0H60V5H50Z"/></svg>',
}
CHECK = """async () => {
  const found = await axe.run(document, { resultTypes: ["violations", "passes"] });
  const words = (rule) => `${rule.id} (${rule.impact}): ${rule.nodes.map((node) => node.html.slice(0, 120)).join(" | ")}`;
  return [
    found.passes.length,
    found.violations.filter((rule) => ["serious", "critical"].includes(rule.impact)).map(words),
  ];
}"""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("look", ["desk", "phone"])
def test_nothing_serious_is_found(browser: Any, server: RunningServer, look: str) -> None:
    """Empty, with a file that leaves something open, with the part, and with fixtures compared and pushed at; on a desk
    each of these in light and in dark."""
    size = {"width": 390, "height": 800} if look == "phone" else {"width": 1440, "height": 900}
    schemes = ("light",) if look == "phone" else ("light", "dark")
    context = browser.new_context(viewport=size, color_scheme="light", reduced_motion="reduce")
    context.add_init_script(path=AXE)
    walk = Walk(context.new_page(), server)
    walk.open()
    sections = ("settings", "stage", "results") if look == "phone" else ()

    def check() -> None:
        for section in sections or ("shown",):
            walk.go(section)
            for scheme in schemes:
                walk.page.emulate_media(color_scheme=scheme)
                passed, faults = walk.page.evaluate(CHECK)
                assert passed > 10
                assert faults == []

    check()
    walk.page.set_input_files("#file", ASKING)
    walk.seen("#file-asks [data-unit=mm]").click()
    walk.seen("#file-asks [data-part]")
    check()
    walk.take()
    walk.page.click('#faces button[data-face="3"]')
    check()
    walk.go("settings")
    walk.page.click("#search")
    walk.searched(shown=False)
    walk.go("stage")
    for button in ("#push", "#pin", "#next"):
        walk.page.click(button)
    walk.seen("#board-title:has-text('Shown: 2')")
    check()
    walk.go("stage")
    walk.page.click("#in-space")
    walk.seen("#space-kinds li")
    sections = ()
    check()
    context.close()


def test_motion_is_left_out_for_those_who_want_none(browser: Any, server: RunningServer) -> None:
    """The right jaw stands open for a moment, but not where reduced motion is asked for."""
    slid = {}
    for motion in ("reduce", "no-preference"):
        context = browser.new_context(viewport={"width": 1440, "height": 900}, reduced_motion=motion)
        walk = Walk(context.new_page(), server)
        walk.open()
        walk.take()
        walk.search()
        walk.page.wait_for_selector("#drawing-fixture .moves:not([transform])", state="attached")
        slid[motion] = walk.page.evaluate(
            """async () => {
              document.querySelector("#close-vise").click();
              return document.querySelector("#drawing-fixture .moves").hasAttribute("transform");
            }"""
        )
        walk.page.wait_for_selector("#drawing-fixture .moves:not([transform])", state="attached")
        context.close()
    assert slid == {"reduce": False, "no-preference": True}


def test_the_page_asks_for_all_its_modules_at_once() -> None:
    """index.html preloads every module, so none waits for another, and holds nothing inline that the policy refuses."""
    html = (STATIC / "index.html").read_text(encoding="utf-8")
    modules = {entry.name for entry in STATIC.iterdir() if entry.name.endswith(".js")}
    assert set(re.findall(r'modulepreload" href="static/([\w.-]+)"', html)) == modules - {"main.js"}
    assert not re.search(r"\sstyle=|\son\w+=|<style|javascript:|<script(?![^>]*src=)", html)
    assert not re.search(r"https?://", html)


def test_modules_are_short_and_ask_nobody_else() -> None:
    """A module is one idea, under 400 lines, names no other server and makes no markup from text."""
    space = STATIC / "space"
    assert {entry.name for entry in space.iterdir()} == {*OWN, *LIBRARY}
    for entry in (*STATIC.iterdir(), *(space / name for name in OWN)):
        if entry.name in ("method", "space", "index.html"):
            continue
        text = entry.read_text(encoding="utf-8")
        assert text.count("\n") < 400, entry.name
        if entry.name.endswith(".js"):
            addresses = set(re.findall(r"https?://[^\s\"'`]+", text)) - {"http://www.w3.org/2000/svg"}
            assert addresses == set(), entry.name
            assert "innerHTML" not in text, entry.name
