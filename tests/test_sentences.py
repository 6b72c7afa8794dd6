"""One wording for each way in: outside the command line no sentence names an option of it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from workhold.cli.main import COMMANDS

SOURCES = Path(__file__).parent.parent / "src" / "workhold"
# An option of the command line; custom properties of style sheets stand in brackets or before a colon.
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+")
# What is part of the command line: the commands, and the starting of the server for one.
# The checker of the benchmark is a command by itself.
OF_THE_COMMAND = {"__main__.py", "data/benchmark/check.py", "web/serve.py"}
# Commands to be typed, quoted as such: another program's, and one in a report.
QUOTED = ("pip install --force-reinstall", "workhold sheet ")


def modules() -> list[Path]:
    """Every module but those of the command line."""
    every = (path.relative_to(SOURCES) for path in sorted(SOURCES.rglob("*.py")))
    return [path for path in every if path.parts[0] != "cli" and path.as_posix() not in OF_THE_COMMAND]


def texts(source: str) -> Iterator[str]:
    """The texts of a module that are no docstrings; those with values in them with a space for each."""
    tree = ast.parse(source)
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    docstrings = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, documented) and is_text(node.body)
    }
    inner: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            inner |= {id(part) for part in node.values}
            yield "".join(part.value if isinstance(part, ast.Constant) else " " for part in node.values)
        elif (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and id(node) not in docstrings | inner
        ):
            yield node.value


def is_text(body: list[ast.stmt]) -> bool:
    """Whether a body begins with a docstring."""
    return bool(body) and isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant)


@pytest.mark.parametrize("module", modules(), ids=str)
def test_no_sentence_outside_the_command_names_an_option(module: Path) -> None:
    """Refusals, notes and remarks of readers, searches, server and Python speak of what is asked for."""
    for text in texts((SOURCES / module).read_text()):
        if not any(quoted in text for quoted in QUOTED):
            assert not OPTION.search(text), text
            for command in COMMANDS:
                assert f"see workhold {command}" not in text, text


@pytest.mark.parametrize(
    "path", sorted((SOURCES / "web" / "static").glob("*.[jh]*")), ids=lambda path: path.name
)
def test_no_sentence_of_the_page_names_an_option(path: Path) -> None:
    """Only names of colours begin with two dashes there."""
    for line in path.read_text().splitlines():
        said = re.sub(r"var\(--[\w-]+|ink\(\"--[\w-]+|<!--.*?-->|\"--[\w-]+\"", "", line)
        assert not OPTION.search(said), line


def test_options_are_found_where_they_are() -> None:
    """In plain and in formatted texts, and in none of the docstrings."""
    source = '"""--doc."""\ndef f():\n    """--own."""\n    raise E(f"give --unit {x}, or --fit")\nA = "see --layer"\n'
    found = [OPTION.findall(text) for text in texts(source)]
    assert sorted(word for words in found for word in words) == ["--fit", "--layer", "--unit"]
