"""The page and the lesson in the browser of all tests of the server."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from lesson_page import STATIC, LessonPage
from running_server import RunningServer
from walking import Walk

WIDE = {"width": 1440, "height": 900}


@pytest.fixture(scope="session")
def profile(browser: Any) -> Iterator[Any]:
    """A profile of the browser; what a page keeps, it keeps in its own tab, so that pages share it."""
    context = browser.new_context(viewport=WIDE, reduced_motion="reduce", accept_downloads=True)
    yield context
    context.close()


@pytest.fixture
def walk(profile: Any, server: RunningServer) -> Iterator[Walk]:
    """The page just opened; at the end nothing may have gone wrong unseen."""
    walk = Walk(profile.new_page(), server)
    walk.open()
    yield walk
    walk.page.close()
    assert walk.troubles == []
    assert all(address.startswith((walk.home, "data:", "blob:")) for address in walk.asked)


@pytest.fixture(scope="session")
def lesson_profile(browser: Any) -> Iterator[Any]:
    """A profile of the browser for the lesson, which all its pages share."""
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    yield context
    context.close()


@pytest.fixture
def shown(lesson_profile: Any) -> Iterator[LessonPage]:
    """The page as a file, as in the manual; at the end nothing may have gone wrong unseen."""
    page = LessonPage(lesson_profile.new_page(), (STATIC / "index.html").as_uri())
    yield page
    page.page.close()
    assert page.troubles == []
