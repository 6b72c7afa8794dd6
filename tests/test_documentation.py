"""The documentation's Python examples run and print what they say; its links lead somewhere."""

from __future__ import annotations

import io
import re
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


def test_modules_named_in_the_documentation_exist() -> None:
    """The map from the paper to the code names modules that exist."""
    text = (ROOT / "docs" / "index.md").read_text()
    package = ROOT / "src" / "holdfast"
    layers = "geometry|model|contact|kernels|statics|listing|search|algebra|verification|files|drawing|cli"
    for name in set(re.findall(rf"`((?:{layers})\.[a-z_]+)", text)):
        path = package / Path(*name.split("."))
        assert path.with_suffix(".py").exists(), name
