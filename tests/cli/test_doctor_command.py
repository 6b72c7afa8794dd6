"""What the command says of an installation, whatever is missing from it."""

from __future__ import annotations

import json
import platform
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from typer.testing import CliRunner

from workhold.cli import installed_commands
from workhold.cli.main import app
from workhold.kernels.base import libraries
from workhold.version import __version__

HAVE = {"pyarrow": "26.0", "scipy": "1.2", "numba": "0.68.1", "cadquery-ocp-novtk": "8.0.1"}
# What can be imported: OCP is the module of its distribution, and fsspec came with another one.
MODULES = {"pyarrow", "scipy", "numba", "OCP", "fsspec"}
REQUIRES = [
    "numpy>=2.0",
    'numba>=0.61; extra == "numba"',
    'pyarrow>=18; extra == "batch"',
    'scipy>=1.13; extra == "batch"',
    'mcp; extra == "mcp"',
    'cadquery-ocp-novtk>=8; extra == "step"',
    'pyarrow>=17; extra == "tables"',
    'numba>=0.61; extra == "tables"',
    'fsspec>=2024.6; extra == "cluster"',
]


@pytest.fixture
def installation(monkeypatch: pytest.MonkeyPatch) -> None:
    """An installation with the libraries of :data:`HAVE`, and an Open CASCADE that lacks libGL."""

    def version(name: str) -> str:
        if name not in HAVE:
            raise metadata.PackageNotFoundError(name)
        return HAVE[name]

    monkeypatch.setattr(metadata, "requires", lambda _: REQUIRES)
    monkeypatch.setattr(metadata, "version", version)
    monkeypatch.setattr(installed_commands, "find_spec", lambda name: name if name in MODULES else None)
    monkeypatch.setattr(installed_commands, "find_step_fault", lambda: "apt install libgl1")


def findings() -> dict[str, tuple[str, str | None]]:
    """State and remedy of each line, as the command prints them for other programs."""
    outcome = CliRunner().invoke(app, ["doctor", "--json"])
    assert outcome.exit_code == 0, outcome.stderr
    return {one["what"]: (one["state"], one["remedy"]) for one in json.loads(outcome.stdout)["findings"]}


def test_every_extra_is_looked_at(installation: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """A version that is too old, a library that does not load, and one that is missing each have a remedy."""
    monkeypatch.setattr(libraries, "find_in", lambda folder, room: None)
    found = findings()
    assert found["numba"] == ("numba 0.68.1", None)
    assert found["batch"] == ("scipy 1.2, older than 1.13", "pip install 'scipy>=1.13'")
    assert found["tables"] == ("pyarrow 26.0, numba 0.68.1", None)
    assert found["cluster"] == ("fsspec of another package", None)
    assert found["mcp"] == ("mcp missing", "pip install mcp")
    assert found["step"] == ("cadquery-ocp-novtk 8.0.1 does not load", "apt install libgl1")
    assert found["build123d"][0].startswith("not known")


def test_the_report_is_read_by_people(installation: None) -> None:
    outcome = CliRunner().invoke(app, ["doctor"], env={"COLUMNS": "80"})
    assert outcome.exit_code == 0
    lines = outcome.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    assert "To add what is missing:" in lines
    assert "  mcp: pip install mcp" in lines


def test_what_is_missing_is_red_on_a_terminal(installation: None) -> None:
    """And nothing else is."""
    shown = installed_commands.tabulate_findings(
        [
            installed_commands.InstallationRow("a", "1.0", "x"),
            installed_commands.InstallationRow("b", "missing", "y", "pip install b"),
        ]
    )
    assert shown.red == {1}


def test_kernels_that_are_missing_have_a_remedy(installation: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where there are neither libraries nor numba to make them with."""
    monkeypatch.setattr(libraries, "find_in", lambda folder, room: None)
    monkeypatch.setattr(installed_commands, "find_spec", lambda name: None)
    assert findings()["kernels"] == ("missing", "pip install numba")


def test_the_python_that_is_looked_at_is_named() -> None:
    outcome = CliRunner().invoke(app, ["doctor", "--json"])
    told = json.loads(outcome.stdout)
    assert told["python"] == sys.executable and told["version"] == __version__
    assert platform.python_version() in told["machine"]


def test_nothing_is_to_add_where_all_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installed_commands, "find_extras", lambda is_built: iter(()))
    monkeypatch.setattr(libraries, "find_in", lambda folder, room: folder)
    assert "To add" not in CliRunner().invoke(app, ["doctor"]).stdout


def test_kernels_say_where_they_come_from(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, installation: None
) -> None:
    monkeypatch.setattr(libraries, "find_in", lambda folder, room: folder)
    assert findings()["kernels"] == ("compiled in the package", None)
    assert findings()["numba"] == ("not needed here", None)
    monkeypatch.setattr(libraries, "find_in", lambda folder, room: None)
    monkeypatch.setattr(libraries, "make_cache_folder", lambda: tmp_path)
    monkeypatch.setattr(libraries, "is_built", lambda: False)
    assert findings()["kernels"] == (f"to be compiled on the first run, kept in {tmp_path}", None)
    monkeypatch.setattr(libraries, "is_built", lambda: True)
    assert findings()["kernels"] == (f"compiled on this machine, kept in {tmp_path}", None)
    monkeypatch.setattr(libraries, "make_cache_folder", lambda: None)
    state, remedy = findings()["kernels"]
    assert state.startswith("compiled again in every process") and "WORKHOLD_CACHE_DIR" in str(remedy)


def test_a_copy_that_was_not_installed_says_so(installation: None, monkeypatch: pytest.MonkeyPatch) -> None:
    def requires(name: str) -> list[str]:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "requires", requires)
    assert findings()["mcp"] == ("not known, because this copy was not installed as a package", None)


def test_what_is_said_of_the_extras_is_what_the_package_asks_for() -> None:
    """Every extra for users has a line; those for developers and the manual have none."""
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
    assert set(installed_commands.USES) == set(project["project"]["optional-dependencies"]) - {"dev", "docs"}
