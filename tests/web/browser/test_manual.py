"""The manual's site, opened as files: nothing in it comes from elsewhere, its search finds, and the code is in it."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import workhold
from workhold.cli.main import COMMANDS

ROOT = Path(__file__).parents[3]
# What a page loads by itself; links that a reader follows may lead elsewhere.
LOADED = re.compile(r'(?:\bsrc="|<link [^>]*href="|url\(["\']?|@import ["\'])(?:https?:)?//[^"\')]+')


@pytest.fixture(scope="module")
def site(tmp_path_factory: Any) -> Path:
    """The site, built as ``make docs`` does it; whatever is doubtful is an error."""
    if importlib.util.find_spec("material") is None:
        pytest.skip("the extra docs is not installed")
    folder = tmp_path_factory.mktemp("manual")
    build = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", folder]
    told = subprocess.run(
        build, cwd=ROOT, env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}, capture_output=True, text=True
    )
    assert told.returncode == 0, told.stderr
    return folder


def test_nothing_is_fetched_from_elsewhere(site: Path) -> None:
    """No page and no style names a script, a style, a picture or a typeface of another address."""
    pages = [*site.rglob("*.html"), *site.rglob("*.css")]
    assert len(pages) > 30
    assert [found for page in pages for found in LOADED.findall(page.read_text())] == []


def test_every_page_is_found(site: Path) -> None:
    """Each is in the order that every page shows, those that mkdocs.yml does not name last."""
    home = (site / "index.html").read_text()
    assert [
        path.stem
        for path in (ROOT / "docs").glob("*.md")
        if f'href="{path.stem}.html" class="md-nav' not in home
    ] == []


def test_the_reference_has_every_public_name(site: Path) -> None:
    """Functions and classes with their members, parameters as a list, sessions as code."""
    page = (site / "reference.html").read_text()
    assert [name for name in workhold.__all__ if f'<h2 id="{name}">' not in page] == []
    assert '<h3 id="result-counts">' in page
    assert "<li><code>join_tolerance</code>: largest gap" in page
    assert "----" not in re.sub(r"<[^>]+>", "", page)
    assert not re.search(r"^:::", page, flags=re.M)


def test_the_command_page_has_every_help(site: Path) -> None:
    """With the options of each."""
    page = (site / "command.html").read_text()
    assert [name for name in COMMANDS if f"workhold {name} [OPTIONS]" not in page] == []
    assert "--jaw-force" in page


def test_search_works_without_a_server(site: Path, browser: Any) -> None:
    """Words typed find their pages, though the page was opened as a file, and nothing is asked of any address."""
    page = browser.new_page()
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto((site / "index.html").as_uri())
    page.click("input.md-search__input")
    page.keyboard.type("clamp freedom")
    found = page.locator(".md-search-result__link", has_text="Plates")
    found.first.wait_for(state="attached")
    page.close()
    assert [address for address in asked if not address.startswith(("file:", "data:"))] == []


def test_the_pictures_of_the_method_open_as_files(site: Path, browser: Any) -> None:
    """The manual has the page of the server, whole, with links to its own pages."""
    page = browser.new_page()
    troubles: list[str] = []
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.on("console", lambda line: troubles.append(line.text) if line.type == "error" else None)
    page.goto((site / "explained" / "index.html").as_uri())
    page.wait_for_selector("body.manual[data-ready]")
    links = page.locator("a:visible").evaluate_all("(all) => all.map((one) => one.href)")
    page.close()
    assert troubles == []
    assert len(links) >= 3
    assert [link for link in links if not Path(link.removeprefix("file://")).exists()] == []
    for name in ("method.html", "index.html"):
        assert 'href="explained/index.html"' in (site / name).read_text()
