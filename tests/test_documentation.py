"""The documentation's Python examples run and print what they say; its links lead somewhere."""

from __future__ import annotations

import io
import re
import subprocess
import sys
from contextlib import redirect_stdout
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_python_examples_print_what_they_say(page: Path) -> None:
    """Every printed line equals the comment behind its print call."""
    for block in re.findall(r"```python\n(.*?)```", page.read_text(), flags=re.S):
        said = re.findall(r"^print\(.*\)\s+# (.*)$", block, flags=re.M)
        output = io.StringIO()
        with redirect_stdout(output):
            exec(compile(block, str(page), "exec"), {})
        assert output.getvalue().splitlines() == said


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


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_modules_named_in_the_documentation_exist(page: Path) -> None:
    """What a page names as a module, or as something in one, is there; rooms of the kernels may stand by themselves."""
    roots = [ROOT / "src" / "workhold", ROOT / "src" / "workhold" / "kernels"]
    rooms = "|".join({path.stem for root in roots for path in root.iterdir() if not path.stem.startswith("_")})
    for name in set(re.findall(rf"`(?:workhold\.)?((?:{rooms})(?:\.(?!js\b)\w+)+)[`(]", page.read_text())):
        assert any(is_there(root, name.split(".")) for root in roots), name


def is_there(root: Path, names: list[str]) -> bool:
    """Whether there is such a package or module, or a module with such a word in it."""
    path = root.joinpath(*names)
    if path.is_dir() or path.with_suffix(".py").exists():
        return True
    within = path.parent.with_suffix(".py")
    return within.exists() and re.search(rf"\b{names[-1]}\b", within.read_text()) is not None
