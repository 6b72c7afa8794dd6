"""What the Containerfile names is there: no registry of images is at hand to build it from in a test."""

from __future__ import annotations

import json
import re
import shlex
import tomllib
from pathlib import Path

import typer
from typer.main import get_command

from workhold.cli.serving_commands import serve

ROOT = Path(__file__).parent.parent
LINES = re.sub(r"\\\n\s*", "", (ROOT / "Containerfile").read_text()).splitlines()
STEPS = [line.split(" ", 1) for line in LINES if re.match(r"[A-Z]+ ", line)]


def test_every_file_that_is_copied_is_there() -> None:
    """And among them all that the build of the wheel reads."""
    copied = {name for word, rest in STEPS if word == "COPY" for name in rest.split()[:-1]}
    assert [name for name in copied if not (ROOT / name).exists()] == []
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    read = {"pyproject.toml", "src", *project["build-system"]["backend-path"], project["project"]["readme"]}
    assert read | set(project["project"]["license-files"]) <= copied
    runs = " ".join(rest for word, rest in STEPS if word == "RUN")
    assert set(re.findall(r"PIP_CONSTRAINT=(\S+)", runs)) == {"constraints.txt"} <= copied


def test_the_linker_is_the_one_of_the_build() -> None:
    """Installed before the wheel is built, as ``.ci/run`` does it."""
    commands = [rest for word, rest in STEPS if word == "RUN"]
    assert "binutils" in commands[0] and "pip wheel" in commands[1]
    assert "ld >/dev/null || needed+=(binutils)" in (ROOT / ".ci" / "run").read_text()


def test_the_server_is_started_by_a_command_that_there_is() -> None:
    """With options that it takes, listening to others at the port that is told, and not as root."""
    words = json.loads(dict(STEPS)["ENTRYPOINT"])
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert words[0] in project["project"]["scripts"] and words[1] == "serve"
    alone = typer.Typer()
    alone.command()(serve)
    asked = get_command(alone).make_context("serve", words[2:]).params
    assert (asked["host"], asked["port"]) == ("0.0.0.0", dict(STEPS)["EXPOSE"])
    user = int(dict(STEPS)["USER"].split(":")[0])
    assert user > 0


def test_the_command_that_it_tells_runs_it_as_it_was_tried() -> None:
    """Read-only but for a place in memory that the program's home and temporary files are in."""
    (told,) = [line for line in LINES if line.startswith("#   podman run")]
    words = shlex.split(told[1:])
    assert "--read-only" in words and words[words.index("--tmpfs") + 1] == "/tmp"
    assert dict(STEPS)["ENV"] == "HOME=/tmp"
    assert words[words.index("-p") + 1].endswith(":" + dict(STEPS)["EXPOSE"])
