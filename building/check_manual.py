"""Whether what the manual says is true, part of ``make check``: ``python building/check_manual.py`` says where it is not.

Examples print what they say, links lead somewhere, and what is named is there: commands' options, targets of make, files,
modules, the tests of a theorem, layers, columns. Messages, too, name options of the command line only where it is meant.
"""

from __future__ import annotations

import ast
import io
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from contextlib import redirect_stdout
from itertools import pairwise
from pathlib import Path

import numpy as np
import yaml
from typer.main import get_command

from workhold.cli.main import COMMANDS, app
from workhold.errors import InputError
from workhold.files.result.parts import describe_columns
from workhold.version import __version__

ROOT = Path(__file__).resolve().parent.parent
SOURCES, DOCS = ROOT / "src" / "workhold", ROOT / "docs"
PAGES = [*sorted(ROOT.glob("*.md")), *sorted(DOCS.glob("*.md"))]
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+")
# Options of other programs of which the manual speaks: of curl, podman, uv, pipx and Dask, and of benchmarks and checkers.
OF_OTHERS = {"--data-binary", "--from", "--memory-limit", "--nthreads", "--nworkers", "--rm", "--spec"}
OF_OTHERS |= {
    "--keep",
    "--manifest",
    "--only",
    "--quick",
    "--read-only",
    "--render",
    "--seeds",
    "--tmpfs",
    "--truth",
}
# What is part of the command line, or a command by itself.
OF_THE_COMMAND = ("cli/", "__main__.py", "data/benchmark/check.py", "web/serve.py")
# Commands to be typed, quoted as such in messages: another program's, and one in a report.
QUOTED = ("pip install --force-reinstall", "workhold sheet ")
THEOREM_PARTS = ("Statement", "Why", "Used in", "Held by")


def read_project_file(*names: str) -> str:
    """The text of a file of the project."""
    return ROOT.joinpath(*names).read_text(encoding="utf-8")


def find_wrong_examples() -> Iterator[str]:
    """Every printed line equals the comment behind its print call; libraries that are not there are left out."""
    for page in PAGES:
        for block in re.findall(r"```python\n(.*?)```", page.read_text(), flags=re.S):
            said = re.findall(r"^print\(.*\)\s+# (.*)$", block, flags=re.M)
            output = io.StringIO()
            try:
                with redirect_stdout(output):
                    exec(compile(block, str(page), "exec"), {})
            except (ModuleNotFoundError, InputError) as error:
                if "not installed" in str(error) or "No module named" in str(error):
                    sys.stderr.write(f"{page.name}: an example is left out: {error}\n")
                    continue
                raise
            if output.getvalue().splitlines() != said:
                yield f"{page.name}: an example prints {output.getvalue()!r}, and not {said}."


def find_broken_links() -> Iterator[str]:
    """Every relative link names a file of the project."""
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
            if not target.startswith("http") and not (page.parent / target).exists():
                yield f"{page.name} has a link to {target}, which is not there."


def list_command_options() -> set[str]:
    """Every option of every command."""
    group = get_command(app)
    context = group.make_context("workhold", ["design"])
    commands = [group, *(group.get_command(context, name) for name in COMMANDS)]  # type: ignore[attr-defined]
    return {word for one in commands for each in one.params for word in (*each.opts, *each.secondary_opts)}


def find_unknown_options() -> Iterator[str]:
    """Every option that a page names is one of a command."""
    known = list_command_options() | OF_OTHERS | {"--help"}
    for page in PAGES:
        for word in sorted(set(OPTION.findall(page.read_text())) - known):
            yield f"{page.name} names {word}, which no command takes."


def find_unknown_targets() -> Iterator[str]:
    """``make wheel-test`` in a page is a target of the Makefile."""
    targets = set(re.findall(r"^([a-z-]+):", read_project_file("Makefile"), flags=re.M))
    for page in PAGES:
        named = set(re.findall(r"(?:`|^ {4})make ([a-z-]+)", page.read_text(), flags=re.M))
        yield from (
            f"{page.name} names make {word}, which is not a target." for word in sorted(named - targets)
        )


def find_missing_files() -> Iterator[str]:
    """What a page names in a folder of the project is there."""
    for page in PAGES:
        folders = "benchmarks|building|docs|examples|tests"
        for name in re.findall(rf"`(?:python )?((?:{folders})/[\w./-]+)`", page.read_text()):
            if not (ROOT / name).exists():
                yield f"{page.name} names {name}, which is not there."


def find_unknown_modules() -> Iterator[str]:
    """What a page names as a module, or as something in one, is there; rooms of kernels may stand by themselves."""
    roots = [SOURCES, SOURCES / "kernels"]
    rooms = "|".join({path.stem for root in roots for path in root.iterdir() if path.stem[0] not in "_."})
    for page in PAGES:
        found = re.findall(rf"`(?:workhold\.)?((?:{rooms})(?:\.(?!js\b)\w+)+)[`(]", page.read_text())
        for name in sorted(set(found)):
            if not any(is_there(root, name.split(".")) for root in roots):
                yield f"{page.name} names {name}, which is not there."


def is_there(root: Path, names: list[str]) -> bool:
    """Whether there is such a package or module, or a module with such a word in it."""
    path = root.joinpath(*names)
    if path.is_dir() or path.with_suffix(".py").exists():
        return True
    within = path.parent.with_suffix(".py")
    return within.exists() and re.search(rf"\b{names[-1]}\b", within.read_text()) is not None


def find_unknown_names() -> Iterator[str]:
    """What a cell of a table names behind a module is defined in that module."""
    roots = [SOURCES, SOURCES / "kernels"]
    for page in PAGES:
        for module, names in re.findall(r"\| `((?:\w+\.)+\w+)`((?:, `\w+`)+)", page.read_text()):
            paths = [root.joinpath(*module.split(".")).with_suffix(".py") for root in roots]
            text = "".join(path.read_text() for path in paths if path.exists())
            for name in re.findall(r"\w+", names) if text else ():
                if not (SOURCES / name).is_dir() and not re.search(
                    rf"^\s*(?:def |class )?{name}\b *[(:=]", text, flags=re.M
                ):
                    yield f"{page.name} names {name} in {module}, where it is not defined."


def find_incomplete_theorems() -> Iterator[str]:
    """Each has its reason, its place in the code, and tests that exist, and the page's table leads to it."""
    page = read_project_file("docs", "method-theorems.md")
    sections = dict(re.findall(r"^### (.+?)\n(.*?)(?=^##|\Z)", page, flags=re.M | re.S))
    for title, text in sections.items():
        places = [text.find(f"**{part}") for part in THEOREM_PARTS]
        if -1 in places or places != sorted(places):
            yield f"theorem {title}: {', '.join(THEOREM_PARTS)} stand in another order, or not all of them."
            continue
        named = re.findall(r"^- `(tests/[\w/]+\.py)::(test_\w+)`$", text[places[-1] :], flags=re.M)
        if len(named) < text[places[-1] :].count("\n- ") or not named:
            yield f"theorem {title}: something that holds it is not a test."
        for path, name in named:
            if not (ROOT / path).exists() or f"\ndef {name}(" not in read_project_file(path):
                yield f"theorem {title}: there is no {path}::{name}."
        for module in re.findall(r"`([a-z_]+(?:\.[a-z_]+)*)`", text[places[2] : places[3]]):
            if module != "distinct" and not is_there(SOURCES, module.split(".")):
                yield f"theorem {title}: there is no {module}."
    table = re.findall(r"\]\(#([\w-]+)\)", page.partition("## ")[0])
    if table != [re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-") for title in sections]:
        yield "the table of theorems does not lead to each once, in the order of the page."
    yield from find_uncited_names(page)


def find_uncited_names(page: str) -> Iterator[str]:
    """Names with a year stand under the sources of the page of theorems or of that on belief."""
    listed = (
        page.partition("## Sources")[2] + read_project_file("docs", "belief.md").partition("## Sources")[2]
    )
    names = r"([A-Z]\w+(?: (?:and|den) [A-Z]\w+|, [A-Z]\w+(?: and [A-Z]\w+)?)*)"
    for who, year in re.findall(
        rf"{names}[^.()\n]{{0,12}}\(?((?:18|19|20)\d\d)\)?", page.partition("## Sources")[0]
    ):
        first = re.split(r"[ ,]", who)[0]
        if not any(first in line and year in line for line in listed.split("\n- ")):
            yield f"theorems cite {who} {year}, which no list of sources has."


def find_outdated_benchmarks() -> Iterator[str]:
    """The page shows what the last bench kept, and has one place for each section that a benchmark keeps."""
    if subprocess.run([sys.executable, ROOT / "benchmarks" / "page.py", "--check"], check=False).returncode:
        yield "docs/benchmarks.md does not show the figures that were kept."
    scripts = [path.read_text() for path in (ROOT / "benchmarks").glob("*.py")]
    sections = {name for text in scripts for name in re.findall(r'Section\(\s*"([a-z-]+)"', text)}
    places = re.findall(r"<!-- figures: (\S+) -->", read_project_file("docs", "benchmarks.md"))
    if sorted(places) != sorted(sections | {"machine", "plot", "targets"}):
        yield "docs/benchmarks.md has not one place for each section of the benchmarks."


def list_checked_layers() -> list[set[str]]:
    """The layers of the import-linter from the highest to the lowest, each with its rooms."""
    contracts = tomllib.loads(read_project_file("pyproject.toml"))["tool"]["importlinter"]["contracts"]
    rows = contracts[0]["layers"]
    return [{name.strip().removeprefix("workhold.") for name in row.split("|")} for row in rows]


def find_misordered_layers() -> Iterator[str]:
    """Contributors' table, the architecture and its picture have the rooms in the order that is checked."""
    checked = list_checked_layers()
    rows = re.findall(r"^\| ((?:`[a-z]+`(?:, )?)+) \|", read_project_file("CONTRIBUTING.md"), flags=re.M)
    listed = [name for row in rows for name in re.findall(r"`([a-z]+)`", row)]
    heights = [
        next((height for height, names in enumerate(reversed(checked)) if name in names), -1)
        for name in listed
    ]
    if heights != sorted(heights) or len(listed) < len(checked) or -1 in heights:
        yield "CONTRIBUTING.md lists the layers in another order than pyproject.toml."
    rooms = set().union(*checked)
    page, picture = (
        read_project_file("docs", "architecture.md"),
        read_project_file("docs", "images", "rooms.svg"),
    )
    if sorted(re.findall(r"\*\*`([a-z]+)`\*\*", page)) != sorted(rooms):
        yield "docs/architecture.md has not one paragraph for each room."
    drawn = re.findall(r'y="(\d+)" font-size="14" font-weight="bold"[^>]*>(\w+)<', picture)
    places = {name: int(y) for y, name in drawn}
    if below := re.search(r'y="(\d+)"[^>]*>and, below these: (.*?)<', picture):
        places |= dict.fromkeys(below[2].split(" · "), int(below[1]))
    stacked = [[places.get(name, -1) for name in names] for names in checked]
    if places.keys() != rooms or any(max(high) > min(low) for high, low in pairwise(stacked)):
        yield "docs/images/rooms.svg has other rooms than pyproject.toml, or in another order."
    stations = re.findall(r"^\| (\d+) \|", page, flags=re.M)
    if sorted(re.findall(r'text-anchor="middle">(\d+)<', picture), key=int) != stations:
        yield "docs/images/rooms.svg has other stations than the table of docs/architecture.md."


def find_wrong_citation() -> Iterator[str]:
    """CITATION.cff names the version of the sources."""
    if yaml.safe_load(read_project_file("CITATION.cff"))["version"] != __version__:
        yield f"CITATION.cff has another version than {__version__}."


def find_undescribed_columns() -> Iterator[str]:
    """Each column written has a row with its kind of number and its shape; what a fixture takes is the sum."""
    page = read_project_file("docs", "columns.md")
    for name, column in describe_columns(1).items():
        number, shape = np.dtype(column.kind).name, ", ".join(map(str, ("N", *column.shape)))
        if not re.search(rf"^\| .*`{name}.npy`.* \| {number} \| {shape} \|", page, flags=re.M):
            yield f"docs/columns.md has no row of {name}.npy as {number} of shape {shape}."
    one, two = (sum(column.row_bytes for column in describe_columns(count).values()) for count in (1, 2))
    if f"{one} bytes a fixture, {two} with two clamps" not in page:
        yield f"docs/columns.md does not say that a fixture takes {one} bytes, {two} with two clamps."


def find_options_in_messages() -> Iterator[str]:
    """Outside the command line no message names an option of it: Python and the page have none."""
    for path in sorted(SOURCES.rglob("*.py")):
        name = path.relative_to(SOURCES).as_posix()
        if not name.startswith(OF_THE_COMMAND):
            for text in list_texts(path.read_text()):
                if (OPTION.search(text) or "see workhold " in text) and not any(
                    one in text for one in QUOTED
                ):
                    yield f"{name} names an option of the command line in {text!r}."
    for path in sorted((SOURCES / "web" / "static").glob("*.[jh]*")):
        # Names of colours begin with two dashes there, too.
        colours = r"var\(--[\w-]+|ink\(\"--[\w-]+|<!--.*?-->|\"--[\w-]+\""
        for line in path.read_text().splitlines():
            if OPTION.search(re.sub(colours, "", line)):
                yield f"{path.name} names an option of the command line in {line.strip()!r}."


# What a declaration says of its option alone.
OF_OPTIONS = {"spelled", "typed"}


def list_texts(source: str) -> Iterator[str]:
    """The texts of a module that are not docstrings; those with values in them with a space for each.

    What a declaration says of its option alone is left out.
    """
    tree = ast.parse(source)
    inner: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) or (isinstance(node, ast.keyword) and node.arg in OF_OPTIONS):
            inner.add(id(node.value))
        elif isinstance(node, ast.JoinedStr):
            inner |= {id(part) for part in node.values}
            yield "".join(str(part.value) if isinstance(part, ast.Constant) else " " for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in inner:
            yield node.value


CHECKS = (
    find_broken_links,
    find_unknown_options,
    find_unknown_targets,
    find_missing_files,
    find_unknown_modules,
    find_unknown_names,
    find_incomplete_theorems,
    find_outdated_benchmarks,
    find_misordered_layers,
    find_wrong_citation,
    find_undescribed_columns,
    find_options_in_messages,
    find_wrong_examples,
)


def main() -> int:
    """Says what is not true; 1 where there is anything."""
    offences = [sentence for check in CHECKS for sentence in check()]
    sys.stdout.write("".join(f"{sentence}\n" for sentence in offences))
    return int(bool(offences))


if __name__ == "__main__":
    sys.exit(main())
