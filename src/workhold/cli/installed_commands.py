"""The commands ``doctor`` and ``schema``: what is installed or missing, and the JSON Schemas of the files.

``doctor`` imports only the library for STEP files, because that may be installed and still lack a system
library. The requirements of the extras are read from the installed package.

``schema`` generates JSON Schemas from the forms that check input and output.
"""

from __future__ import annotations

import json
import platform
import re
import sys
from collections.abc import Iterator
from importlib import metadata
from importlib.util import find_spec
from typing import Annotated, Any

import typer
from attrs import asdict, frozen

from workhold.cli.outputs import JSON, print_json
from workhold.cli.table import Table, print_tables
from workhold.cli.values import read_choice
from workhold.errors import InputError
from workhold.version import __version__

__all__ = ["SCHEMAS", "doctor", "schema", "make_schema"]

# The extras, each with what it is good for.
USES = {
    "numba": "Compiles the kernels, if the package has none for this machine.",
    "step": "Reads parts from STEP files, and writes set-ups as STEP assemblies.",
    "bending": "Says how far clamps and cutters bend a part.",
    "build123d": "Reads parts of build123d, and gives it fixtures as assemblies.",
    "batch": "Writes the tables of batch as Parquet, and finds the fewest set-ups of a family.",
    "tables": "Gives fixtures as tables of pandas and Arrow.",
    "widget": "Steps through fixtures, pushes and closes them in a notebook.",
    "cluster": "Runs batch on a cluster of Dask.",
    "mcp": "Offers tools to an agent over the Model Context Protocol.",
}
BUILT = "compiled in the package"
# Distributions that are imported by another name than their own.
MODULES = {"cadquery-ocp-novtk": "OCP"}
# One requirement of the package's metadata: a distribution, its least version, and its extra.
REQUIREMENT = re.compile(
    r"(?P<name>[\w-]+)\s*(?:>=\s*(?P<least>[\d.]+))?\s*;\s*extra\s*==\s*[\"'](?P<extra>\w+)[\"']"
)
DIALECT = "https://json-schema.org/draft/2020-12/schema"


@frozen
class InstallationRow:
    """One line of the report.

    Parameters
    ----------
    what : part of the installation: ``kernels``, or the name of an extra.
    state : words on the version found, or on what is missing.
    use : what that part is good for.
    remedy : command to type where something is missing; None where nothing is.
    """

    what: str
    state: str
    use: str
    remedy: str | None = None


def doctor(json_: bool = JSON) -> None:
    """Report what is installed, what is missing, and what each missing library would be good for.

    The command changes nothing. A search needs only NumPy and the other libraries of the core; each extra adds
    what the list says.

    Example: workhold doctor
    """
    own = find_kernels()
    findings = [own, *find_extras(own.state == BUILT)]
    machine = f"Python {platform.python_version()} on {platform.system()} {platform.machine()}"
    if json_:
        print_json(
            version=__version__, python=sys.executable, machine=machine, findings=list(map(asdict, findings))
        )
        return
    print_tables(f"workhold {__version__}, {machine}: {sys.executable}", "", tabulate_findings(findings))
    remedies = [f"  {found.what}: {found.remedy}" for found in findings if found.remedy]
    if remedies:
        print_tables("", "To add what is missing:", *remedies)


def tabulate_findings(findings: list[InstallationRow]) -> Table:
    """Return the findings as a table, one row each; rows of what is missing are red on a terminal."""
    rows: list[tuple[str, ...]] = [(found.what, found.state, found.use) for found in findings]
    missing = {number for number, found in enumerate(findings) if found.remedy}
    return Table(("part", "state", "what it does"), rows, missing)


def find_kernels() -> InstallationRow:
    """Return where the compiled kernels come from: the package,
    or numba and its cache on disk; or that they are missing.
    """
    use = "The arithmetic of every search."
    from workhold.kernels.base.libraries import KERNELS, ROOMS, find_in, is_built, make_cache_folder

    if all(find_in(KERNELS, room) for room in ROOMS):
        return InstallationRow("kernels", BUILT, use)
    if find_spec("numba") is None:
        return InstallationRow("kernels", "missing", use, "pip install numba")
    folder = make_cache_folder()
    if folder is None:
        remedy = "set WORKHOLD_CACHE_DIR to a folder that can be written."
        return InstallationRow(
            "kernels", "compiled again in every process: no folder can be written", use, remedy
        )
    state = "compiled on this machine" if is_built() else "to be compiled on the first run"
    return InstallationRow("kernels", f"{state}, kept in {folder}", use)


def find_extras(is_built: bool) -> Iterator[InstallationRow]:
    """Yield a row for each extra, in the order of :data:`USES`, with its state of installation.

    ``is_built`` tells that the package has compiled kernels for this machine, so that numba is not needed.
    """
    asked = list_requirements()
    for extra, use in USES.items():
        if extra == "numba" and is_built:
            yield InstallationRow(extra, "not needed here", use)
            continue
        found = [describe_distribution(name, least) for name, least in asked.get(extra, [])]
        lacking = [state for state, is_usable in found if not is_usable]
        # By the libraries' own names, which are found wherever this copy of workhold came from.
        wanted = [
            name if least == "0" else f"'{name}>={least}'"
            for (name, least), (_, is_usable) in zip(asked.get(extra, []), found, strict=True)
            if not is_usable
        ]
        remedy = f"pip install {' '.join(wanted)}" if lacking else None
        if extra == "step" and found and (fault := find_step_fault()):
            lacking, remedy = lacking or [f"{found[0][0]} does not load"], fault
        states = lacking or [state for state, _ in found]
        unknown = "not known, because this copy was not installed as a package"
        yield InstallationRow(extra, ", ".join(states) or unknown, use, remedy)


def list_requirements() -> dict[str, list[tuple[str, str]]]:
    """Return for each extra the (distribution, least version) that it asks for, "0" for any version.

    The dict is empty for a copy that was not installed as a package.
    """
    try:
        lines = metadata.requires("workhold") or []
    except metadata.PackageNotFoundError:
        return {}
    asked: dict[str, list[tuple[str, str]]] = {}
    for line in lines:
        if match := REQUIREMENT.fullmatch(line.strip()):
            asked.setdefault(match["extra"], []).append((match["name"], match["least"] or "0"))
    return asked


def describe_distribution(name: str, least: str) -> tuple[str, bool]:
    """Return (words, usable) for a distribution.

    The words give its version, or say that it is missing or older than ``least``. ``usable`` is False in the
    latter cases.
    """
    if find_spec(MODULES.get(name, name)) is None:
        return f"{name} missing", False
    try:
        version = metadata.version(name)
    except metadata.PackageNotFoundError:
        # Another distribution may bring the same module.
        return f"{name} of another package", True
    if split_version(version) < split_version(least):
        return f"{name} {version}, older than {least}", False
    return f"{name} {version}", True


def split_version(version: str) -> list[int]:
    """Return the numbers in a version, to compare versions by.

    >>> split_version("8.0.1rc2") < split_version("8.1")
    True
    """
    return [int(number) for number in re.findall(r"\d+", version)]


def find_step_fault() -> str | None:
    """Return why STEP files cannot be read, with a remedy; None where they can."""
    from workhold.files.step.library import load_step_library

    try:
        load_step_library()
    except InputError as error:
        return str(error)
    return None


def make_toolkit_schema() -> dict[str, Any]:
    """Return the JSON Schema of a toolkit's TOML file: one of the schemas of the kinds."""
    from pydantic import TypeAdapter

    from workhold.files.input_forms import FORMS, join_forms
    from workhold.fixels.kinds import ALIASES, KINDS, USUAL, find_table, resolve_kind

    schema = TypeAdapter(join_forms(FORMS)).json_schema()
    for noun, form in FORMS.items():
        names = [name for name in (*KINDS, *ALIASES) if find_table(resolve_kind(name)[0]).noun == noun]
        schema["$defs"][form.__name__]["properties"]["kind"] = {"enum": names, "title": "Kind"}
        if USUAL not in names:
            schema["$defs"][form.__name__]["required"].append("kind")
    return schema


# What each schema is of.
SCHEMAS = {
    "part": "a part in JSON",
    "toolkit": "a vise, a plate or a fence, as its TOML file gives it",
    "loads": "a loads file, TOML or JSON",
    "query": "a search, as a client sends it over HTTP",
    "result": "a result file in JSON",
}


def make_schema(name: str) -> dict[str, Any]:
    """Return the JSON Schema with a name of :data:`SCHEMAS`.

    Where a word in the file chooses one of several forms, the schema accepts any one of them.
    """
    from workhold.files.input_forms import LoadsFile, WorkpieceFile
    from workhold.files.result.fixture_forms import ResultFile
    from workhold.web.forms import JobForm

    forms: dict[str, Any] = {
        "part": WorkpieceFile,
        "loads": LoadsFile,
        "query": JobForm,
        "result": ResultFile,
    }
    made = make_toolkit_schema() if name == "toolkit" else forms[name].model_json_schema()
    return {
        "$schema": DIALECT,
        **loosen_schema(made),
        "title": f"workhold {name}",
        "description": f"The shape of {SCHEMAS[name]}.",
    }


def loosen_schema(schema: Any) -> Any:
    """Return a schema with "oneOf" replaced by "anyOf" at all depths."""
    if isinstance(schema, dict):
        return {("anyOf" if key == "oneOf" else key): loosen_schema(value) for key, value in schema.items()}
    return [loosen_schema(one) for one in schema] if isinstance(schema, list) else schema


def schema(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="part, toolkit, loads, query or result.")
    ] = None,
    json_: bool = JSON,
) -> None:
    """Print the JSON Schema of a part, a toolkit, loads, a query or a result, or list them.

    TOML files have the same shape as JSON.

    Example: workhold schema result > result.schema.json
    """
    if name is not None:
        text = json.dumps(make_schema(read_choice("the schema", name, tuple(SCHEMAS))), indent=2)
        sys.stdout.write(text + "\n")
        sys.stdout.flush()
    elif json_:
        print_json(schemas=[{"name": one, "of": words} for one, words in SCHEMAS.items()])
    else:
        print_tables(Table(("name", "of"), list(SCHEMAS.items())))
