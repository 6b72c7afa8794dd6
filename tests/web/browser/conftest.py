"""A browser for the tests of the page; they are skipped where there is none."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from typing import Any

import pytest
from lesson_page import STATIC, LessonPage
from running_server import RunningServer
from walking import Walk

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
WIDE = {"width": 1440, "height": 900}


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium without a window."""
    api = pytest.importorskip("playwright.sync_api", reason="Playwright for Python is not installed")
    if CHROMIUM is None:
        pytest.skip("no chromium on this machine")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", "--enable-unsafe-swiftshader"]
        )
        yield browser
        browser.close()


@pytest.fixture
def walk(browser: Any, server: RunningServer) -> Iterator[Walk]:
    """The page just opened; at the end nothing may have gone wrong unseen."""
    context = browser.new_context(viewport=WIDE, reduced_motion="reduce", accept_downloads=True)
    walk = Walk(context.new_page(), server)
    walk.open()
    yield walk
    context.close()
    assert walk.troubles == []
    assert all(address.startswith((walk.home, "data:", "blob:")) for address in walk.asked)


@pytest.fixture
def shown(browser: Any) -> Iterator[LessonPage]:
    """The page as a file, as in the manual; at the end nothing may have gone wrong unseen."""
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    page = LessonPage(context.new_page(), (STATIC / "index.html").as_uri())
    yield page
    context.close()
    assert page.troubles == []
