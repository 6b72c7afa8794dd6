"""The documentation's Python examples run and print what they say; its links lead somewhere."""

from __future__ import annotations

import inspect
import io
import re
import subprocess
import sys
import tomllib
from contextlib import redirect_stdout
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml

from workhold.errors import InputError
from workhold.files.result.parts import columns_of
from workhold.fixels.kinds import KINDS
from workhold.fixels.vise import OpeningVise
from workhold.version import __version__

ROOT = Path(__file__).parent.parent
PAGES = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md"))]
# What says that a library is missing.
OPTIONAL = (ModuleNotFoundError, InputError)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_python_examples_print_what_they_say(page: Path) -> None:
    """Every printed line equals the comment behind its print call; examples of libraries that are not there are left out."""
    left_out = []
    for block in re.findall(r"```python\n(.*?)```", page.read_text(), flags=re.S):
        said = re.findall(r"^print\(.*\)\s+# (.*)$", block, flags=re.M)
        output = io.StringIO()
        try:
            with redirect_stdout(output):
                exec(compile(block, str(page), "exec"), {})
        except OPTIONAL as error:
            if "not installed" in str(error) or "No module named" in str(error):
                left_out.append(str(error))
                continue
            raise
        assert output.getvalue().splitlines() == said
    if left_out:
        pytest.skip("; ".join(left_out))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    """Every relative link names a file of the project."""
    for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
        if not target.startswith("http"):
            assert (page.parent / target).exists(), target


def test_the_benchmarks_page_shows_the_figures_kept() -> None:
    """What the page says between its words is what the last bench kept."""
    subprocess.run([sys.executable, ROOT / "benchmarks" / "page.py", "--check"], check=True)


def test_every_benchmark_has_a_place_on_the_page() -> None:
    """The page has one place for each section a benchmark keeps, and no other."""
    scripts = (ROOT / "benchmarks").glob("*.py")
    sections = {name for path in scripts for name in re.findall(r'Section\(\s*"([a-z-]+)"', path.read_text())}
    places = re.findall(r"<!-- figures: (\S+) -->", (ROOT / "docs" / "benchmarks.md").read_text())
    assert sorted(places) == sorted(sections | {"machine", "plot", "targets"})


def test_each_term_with_a_source_has_one() -> None:
    """The terms of the glossary's sources are named once each, with a year or the paper."""
    text = (
        (ROOT / "docs" / "glossary.md")
        .read_text()
        .partition("## Where the terms come from")[2]
        .partition("\n## ")[0]
    )
    rows = re.findall(r"^\| ([^|]+) \| ([^|]+) \|$", text, flags=re.M)[2:]
    terms = [term for names, _ in rows for term in names.split(", ")]
    assert len(terms) == len(set(terms)) > 20
    assert all(
        re.search(r"\b(?:18|19|20)\d\d\b", source) or source.startswith("the paper") for _, source in rows
    )


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_make_that_a_page_names_is_there(page: Path) -> None:
    """``make wheel-test`` in a page is a target of the Makefile."""
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), flags=re.M)
    assert set(re.findall(r"(?:`|^ {4})make ([a-z-]+)", page.read_text(), flags=re.M)) <= set(targets)


def layers_checked() -> list[set[str]]:
    """The layers of the import-linter from the highest to the lowest, each with its rooms."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    return [
        {name.strip().removeprefix("workhold.") for name in row.split("|")} for row in contracts[0]["layers"]
    ]


def test_the_layers_listed_are_those_that_are_checked() -> None:
    """The table for contributors has each layer in its place of the import-linter's order."""
    layers = layers_checked()
    rows = re.findall(r"^\| ((?:`[a-z]+`(?:, )?)+) \|", (ROOT / "CONTRIBUTING.md").read_text(), flags=re.M)
    listed = [name for row in rows for name in re.findall(r"`([a-z]+)`", row)]
    heights = [
        next(height for height, names in enumerate(reversed(layers)) if name in names) for name in listed
    ]
    assert len(listed) > 15
    assert heights == sorted(heights)


def test_every_room_is_in_the_architecture() -> None:
    """Each layer has its paragraph once and its place in the picture, where higher ones stand higher."""
    rooms = set().union(*layers_checked())
    described = re.findall(r"\*\*`([a-z]+)`\*\*", (ROOT / "docs" / "architecture.md").read_text())
    assert sorted(described) == sorted(rooms)
    picture = (ROOT / "docs" / "images" / "rooms.svg").read_text()
    places = {
        name: int(y)
        for y, name in re.findall(r'y="(\d+)" font-size="14" font-weight="bold"[^>]*>(\w+)<', picture)
    }
    below = re.search(r'y="(\d+)"[^>]*>and, below these: (.*?)<', picture)
    places |= dict.fromkeys(below[2].split(" · "), int(below[1]))
    assert places.keys() == rooms
    heights = [[places[name] for name in names] for names in layers_checked()]
    for higher, lower in pairwise(heights):
        assert max(higher) <= min(lower)


def test_the_stations_of_the_walk_are_in_the_picture() -> None:
    """The table of the walk and the picture number the same stations."""
    stations = re.findall(r"^\| (\d+) \|", (ROOT / "docs" / "architecture.md").read_text(), flags=re.M)
    picture = (ROOT / "docs" / "images" / "rooms.svg").read_text()
    assert stations == [str(number) for number in range(1, len(stations) + 1)]
    assert sorted(re.findall(r'text-anchor="middle">(\d+)<', picture), key=int) == stations


def test_what_is_to_be_cited_is_this_version() -> None:
    """CITATION.cff is a form of version 1.2, names the version of the sources and names the paper."""
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert {"cff-version", "message", "title", "authors"} <= cited.keys()
    assert cited["cff-version"] == "1.2.0"
    assert cited["version"] == __version__
    assert {"type", "title", "authors"} <= set.intersection(*(set(one) for one in cited["references"]))
    assert cited["references"][0]["title"] == "Modular Fixture Design for Generalized Polyhedra"


def test_the_columns_listed_are_those_written() -> None:
    """Each has a row with its kind of number and its shape; what a fixture takes is the sum."""
    page = (ROOT / "docs" / "columns.md").read_text()
    for name, column in columns_of(1).items():
        number, shape = np.dtype(column.kind).name, ", ".join(map(str, ("N", *column.shape)))
        assert re.search(rf"^\| .*`{name}.npy`.* \| {number} \| {shape} \|", page, flags=re.M), name
    one, two = (sum(column.row_bytes for column in columns.values()) for columns in map(columns_of, (1, 2)))
    assert f"{one} bytes a fixture, {two} with two clamps" in page


def test_the_smallest_toolkit_is_as_small_as_stated() -> None:
    """Its lines are counted, those of the words about it too, and none of the others has fewer."""
    lines = {one: len(inspect.getsource(one).splitlines()) for one in KINDS.values()}
    page = (ROOT / "docs" / "adding-a-toolkit.md").read_text()
    assert min(lines, key=lambda one: lines[one]) is OpeningVise
    stated = (f"## The smallest: {lines[OpeningVise]} lines", f"it has {lines[OpeningVise]} lines")
    assert all(words in page for words in stated)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_named_in_the_documentation_exist(page: Path) -> None:
    """What a page names in a folder of the project is there."""
    named = re.findall(
        r"`(?:python )?((?:benchmarks|building|docs|examples|tests)/[\w./-]+)`", page.read_text()
    )
    assert [name for name in named if not (ROOT / name).exists()] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_modules_named_in_the_documentation_exist(page: Path) -> None:
    """What a page names as a module, or as something in one, is there; rooms of the kernels may stand by themselves."""
    roots = [ROOT / "src" / "workhold", ROOT / "src" / "workhold" / "kernels"]
    rooms = "|".join(
        {path.stem for root in roots for path in root.iterdir() if not path.stem.startswith("_")}
    )
    for name in set(re.findall(rf"`(?:workhold\.)?((?:{rooms})(?:\.(?!js\b)\w+)+)[`(]", page.read_text())):
        assert any(is_there(root, name.split(".")) for root in roots), name


def is_there(root: Path, names: list[str]) -> bool:
    """Whether there is such a package or module, or a module with such a word in it."""
    path = root.joinpath(*names)
    if path.is_dir() or path.with_suffix(".py").exists():
        return True
    within = path.parent.with_suffix(".py")
    return within.exists() and re.search(rf"\b{names[-1]}\b", within.read_text()) is not None
