"""The report: whole in one file, harmless whatever parts are called, and sorted by a click."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from batch_helpers import COARSE, IMPOSSIBLE, InlineQueue, reported, run_in
from test_run import square

from workhold.batch import report as module
from workhold.batch.store import FolderStore
from workhold.files.replacing import is_own

HOSTILE = '<script>alert(1)</script>\x1b[31m & ".json'


class Page(HTMLParser):
    """What a page refers to, and its words."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.scripts = 0
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.scripts += tag == "script"
        self.links += [value or "" for name, value in attributes if name in ("href", "src")]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The report of a few parts, with sheets."""
    folder = tmp_path_factory.mktemp("report")
    parts = [square(folder / f"p{side}.json", side) for side in (30, 44, 52)]
    parts.append(square(folder / "other.json", 47))
    hostile = folder / HOSTILE.replace("/", "")
    hostile.write_text("{")
    batch = run_in(folder, *parts, hostile, queue=InlineQueue(), held_in=(COARSE, IMPOSSIBLE))
    summary = "Parts & <tools>", ["It went well."], ["worker 1 ended <by> signal 9."]
    return folder, reported(batch, folder, folder, summary=summary, sheets=folder / "sheets").counts


def test_the_page_needs_nothing_else(written: tuple[Path, str]) -> None:
    folder, counts = written
    text = (folder / "r.html").read_text()
    page = Page(text)
    assert page.scripts == 1 and "\x1b" not in text and "<by>" not in text and "<tools>" not in text
    outside = [link for link in page.links if not link.startswith("data:image/svg+xml;base64,")]
    assert len(page.links) - len(outside) == 4
    assert len(outside) == 8 and all((folder / link).is_file() for link in outside)
    assert not re.search(r"(?:https?:)?//[a-z]", re.sub(r"base64,[^\"]*", "", text))
    assert is_own(folder / "r.html")
    assert counts == "10 jobs: 4 held, 4 that cannot be asked, 2 not readable."
    for words in ("It went well.", "worker 1 ended", "there is no such vise.", "not valid JSON"):
        assert words in text


def test_what_there_is_no_room_for_is_told(
    written: tuple[Path, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MOST_ROWS", 2)
    monkeypatch.setattr(module, "MOST_PICTURES", 1)
    folder = written[0]
    batch = run_in(
        folder, folder / "p30.json", folder / "p44.json", folder / "p52.json", queue=InlineQueue(0)
    )
    reported(batch, folder, tmp_path)
    text = (tmp_path / "r.html").read_text()
    assert "The table of results lists 1 further jobs." in text
    assert text.count("<tr>") == 3 and text.count("<img") == 1
    # The line that makes the sheet.
    assert (
        f"workhold sheet {FolderStore(folder / 'work').get_location(batch.jobs[0].name)} 1 --part-name p30 -o p30.pdf"
        in text
    )


def test_rows_are_sorted_and_chosen_in_a_browser(written: tuple[Path, str], browser: Any) -> None:
    page = browser.new_page()
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda message: errors.append(message.text))
    page.goto((written[0] / "r.html").as_uri())

    def column(place: int) -> list[str]:
        return page.locator(f"#jobs tbody tr:visible td:nth-child({place})").evaluate_all(
            "cells => cells.map(cell => cell.dataset.key ?? cell.textContent)"
        )

    for downward in (False, True):
        page.get_by_role("button", name="fixtures").click()
        numbers = [float(text) for text in column(5) if text]
        assert len(numbers) == 4 and numbers == sorted(numbers, reverse=downward)
        assert column(5)[4:] == [""] * 6
    page.get_by_role("button", name="part", exact=True).click()
    names = [name for text in column(2) if (name := Path(text).name).startswith("p")]
    assert names == ["p30.json"] * 2 + ["p44.json"] * 2 + ["p52.json"] * 2
    page.get_by_label("Only rows with").fill("coarse p4")
    assert [Path(text).name for text in column(2)] == ["p44.json"]
    assert errors == []
    page.close()
