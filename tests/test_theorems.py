"""The page of theorems: each has its reason, its place in the code, and tests that exist."""

from __future__ import annotations

import ast
import re
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs" / "method-theorems.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^### (.+?)\n(.*?)(?=^##|\Z)", PAGE, flags=re.M | re.S))
PARTS = ("Statement", "Why", "Used in", "Held by")


def anchor(title: str) -> str:
    """The name of a heading in links."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def functions_of(path: Path) -> set[str]:
    """The names of the functions that a file defines."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


@pytest.mark.parametrize("title", SECTIONS)
def test_each_theorem_has_its_parts_and_tests_that_exist(title: str) -> None:
    """Statement, reason, use and tests stand in this order; modules can be imported, and files have the tests named."""
    text = SECTIONS[title]
    places = [text.find(f"**{part}") for part in PARTS]
    assert -1 not in places
    assert places == sorted(places)
    named = re.findall(r"^- `(tests/[\w/]+\.py)::(test_\w+)`$", text[places[-1] :], flags=re.M)
    assert len(named) == text[places[-1] :].count("\n- ") >= 2
    assert len(set(named)) == len(named)
    for path, name in named:
        assert name in functions_of(ROOT / path), (path, name)
    used = re.findall(r"`([a-z_]+(?:\.[a-z_]+)*)`", text[places[2] : places[3]])
    assert used
    for module in used:
        assert module == "distinct" or find_spec(f"workhold.{module}") is not None, module


def test_the_table_leads_to_every_theorem() -> None:
    """Once each, in the order of the page."""
    table = PAGE.partition("## ")[0]
    assert re.findall(r"\]\(#([\w-]+)\)", table) == [anchor(title) for title in SECTIONS]
    assert len(SECTIONS) >= 20


def test_every_source_that_is_cited_is_listed() -> None:
    """Names with a year in the reasons stand under the sources of this page or of that on belief."""
    belief = (ROOT / "docs" / "belief.md").read_text(encoding="utf-8")
    listed = PAGE.partition("## Sources")[2] + belief.partition("## Sources")[2]
    cited = re.findall(
        r"([A-Z]\w+(?: (?:and|den) [A-Z]\w+|, [A-Z]\w+(?: and [A-Z]\w+)?)*)[^.()\n]{0,12}\(?((?:18|19|20)\d\d)\)?",
        PAGE.partition("## Sources")[0],
    )
    assert len(cited) > 8
    for names, year in cited:
        first = re.split(r"[ ,]", names)[0]
        entries = [line for line in listed.split("\n- ") if first in line]
        assert any(year in entry for entry in entries), (names, year)
