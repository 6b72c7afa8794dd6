"""The page and the lesson in the browser of all tests of the server."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from lesson_page import STATIC, LessonPage
from running_server import RunningServer
from walking import Walk

WIDE = {"width": 1440, "height": 900}


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
