"""What is packaged is what the project says: recipes, wheels for other platforms, and how a wheel is made."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

import backend
from workhold.errors import InputError
from workhold.kernels.base.libraries import make_library_name
from workhold.version import __version__

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
RECIPE = yaml.safe_load((ROOT / "conda" / "recipe" / "recipe.yaml").read_text(encoding="utf-8"))
WHEELS = PROJECT["tool"]["cibuildwheel"]
# What conda packages are called that have another name than on the index of Python.
CONDA_NAMES: dict[str, str] = {}


def asked(lines: list[str]) -> dict[str, SpecifierSet]:
    """Versions by name, of lines such as ``numpy >=2.0`` or ``numpy>=2.0``."""
    found = [Requirement(line) for line in lines if not line.startswith("${{")]
    return {one.name: one.specifier for one in found}


def of_project(lines: list[str]) -> dict[str, SpecifierSet]:
    """The same of the project's own lines, by the names of conda and without extras of its own."""
    return {CONDA_NAMES.get(name, name): which for name, which in asked(lines).items() if name != "workhold"}


def test_the_conda_recipe_asks_for_what_the_project_asks_for() -> None:
    """The same versions of Python and of every library, and of what builds the kernels."""
    python = {"python": SpecifierSet(PROJECT["project"]["requires-python"])}
    needed = RECIPE["requirements"]
    assert asked(needed["run"]) == python | of_project(PROJECT["project"]["dependencies"])
    built = of_project([*PROJECT["build-system"]["requires"], *backend.COMPILER])
    assert asked(needed["host"]) == python | {"pip": SpecifierSet()} | built


def test_the_conda_recipe_knows_the_extras() -> None:
    """Each library of an extra for users, with the highest of the versions that extras ask for, but OCP's, which
    conda has in another package.
    """
    extras = PROJECT["project"]["optional-dependencies"]
    lines = [
        line
        for name, lines in extras.items()
        if name not in ("dev", "docs", "numba")
        for line in lines
        if not line.startswith(("workhold", "cadquery-ocp"))
    ]
    most: dict[str, SpecifierSet] = {}
    for line in lines:
        one = Requirement(line)
        most[one.name] = max(most.get(one.name, one.specifier), one.specifier, key=numbers)
    assert asked(RECIPE["requirements"]["run_constraints"]) == most


def numbers(which: SpecifierSet) -> list[int]:
    """The numbers of a version that is asked for."""
    return [int(number) for number in re.findall(r"\d+", str(which))]


def test_the_conda_recipe_is_of_this_version_and_licence() -> None:
    """And names the command, the sources and the licence's file, which are there."""
    assert RECIPE["schema_version"] == 1
    assert RECIPE["context"] == {"name": PROJECT["project"]["name"], "version": __version__}
    entries = [" = ".join(pair) for pair in PROJECT["project"]["scripts"].items()]
    assert RECIPE["build"]["python"]["entry_points"] == entries
    assert (
        ROOT / "conda" / "recipe" / RECIPE["source"]["path"] / "pyproject.toml"
    ).resolve() == ROOT / "pyproject.toml"
    assert RECIPE["about"]["license"] == PROJECT["project"]["license"]
    assert (ROOT / RECIPE["about"]["license_file"]).exists()
    assert RECIPE["about"]["summary"] == PROJECT["project"]["description"]


def test_one_wheel_of_a_platform_is_built_with_the_oldest_python() -> None:
    """As one fits every Python 3; each platform of the classifiers has its settings."""
    (oldest,) = re.findall(r">=3\.(\d+)", PROJECT["project"]["requires-python"])
    assert WHEELS["build"] == f"cp3{oldest}-*"
    assert {"linux", "macos", "windows"} <= set(WHEELS)
    for images in ("manylinux", "musllinux"):
        assert [name for name in WHEELS["linux"] if name.startswith(images)]
    (musl,) = WHEELS["overrides"]
    assert musl["select"] == "*-musllinux_*" and musl["environment"]["WORKHOLD_WHEEL"] == "built"
    constraints = [WHEELS[name]["environment"]["PIP_CONSTRAINT"] for name in ("linux", "macos", "windows")]
    assert set(constraints) == {"constraints.txt"}


@pytest.mark.thorough
@pytest.mark.parametrize("number", range(2))
def test_what_a_wheel_is_tried_with_ends_well(number: int, tmp_path: Path) -> None:
    """The commands that cibuildwheel runs once a wheel is installed."""
    words = WHEELS["test-command"][number].replace("{project}", str(ROOT)).split()
    assert words[0] in PROJECT["project"]["scripts"]
    command = [sys.executable, "-m", *words]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(find_spec("cibuildwheel") is None, reason="cibuildwheel is not installed")
@pytest.mark.parametrize("platform", ["linux", "macos", "windows"])
def test_cibuildwheel_takes_the_settings(platform: str) -> None:
    command = [sys.executable, "-m", "cibuildwheel", "--print-build-identifiers", "--platform", platform]
    done = subprocess.run([*command, str(ROOT)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What a build of a wheel does: the folder that kernels are compiled into, then what setuptools is asked."""
    done: list[Any] = []
    monkeypatch.setattr(backend, "build_libraries", lambda rooms, folder: done.append(folder))
    monkeypatch.setattr(backend.build_meta, "build_wheel", lambda *words: done.append(words[1]))
    monkeypatch.delenv("WORKHOLD_WHEEL", raising=False)
    return done


@pytest.mark.thorough
def test_a_wheel_has_the_library_and_its_platform(made: list[Any]) -> None:
    backend.build_wheel("dist")
    folder, settings = made
    assert folder == ROOT / "src" / "workhold" / "kernels"
    (platform, tag) = settings["--build-option"]
    assert platform.startswith("--plat-name=") and tag == "--python-tag=py3"
    assert set(backend.COMPILER) <= set(backend.get_requires_for_build_wheel())


@pytest.mark.thorough
def test_a_pure_wheel_compiles_nothing(made: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WORKHOLD_WHEEL", "pure")
    backend.build_wheel("dist")
    assert made == [None]
    assert not set(backend.COMPILER) & set(backend.get_requires_for_build_wheel())


def test_a_wheel_of_what_was_built_needs_no_compiler(
    made: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """And is refused where the library is of other sources."""
    monkeypatch.setenv("WORKHOLD_WHEEL", "built")
    needed = " ".join(backend.get_requires_for_build_wheel())
    assert "numba" not in needed
    monkeypatch.setattr(backend, "are_libraries_built", lambda: False)
    with pytest.raises(SystemExit, match="do not fit these sources"):
        backend.build_wheel("dist")
    assert made == []
    monkeypatch.setattr(backend, "are_libraries_built", lambda: True)
    backend.build_wheel("dist")
    assert len(made) == 2


def test_libraries_of_other_sources_are_removed(
    made: list[Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Those of these sources stay."""
    monkeypatch.setattr(backend, "KERNELS", tmp_path)
    ours = tmp_path / make_library_name("base", "so")
    for path in (ours, tmp_path / "kernels-base-0123.linux_x86_64.so"):
        path.touch()
    backend.compile_kernels()
    assert [*tmp_path.iterdir()] == [ours] and made == [tmp_path]


def test_kernels_that_cannot_be_compiled_end_the_build_in_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(rooms: Any, folder: Any) -> None:
        raise InputError("The kernels could not be compiled: no linker")

    monkeypatch.setattr(backend, "build_libraries", fail)
    with pytest.raises(SystemExit, match="could not be compiled: no linker"):
        backend.compile_kernels()
