"""The wheel, where there is no numba, writes the same files as kernels that are compiled on first use, byte for byte."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

import workhold

ROOT = Path(workhold.__file__).parents[2]
COMPILER = ("numba", "llvmlite", "workhold", "__editable__")
VISE = ("--peg-radius", "3", "--threads")
# A part with arcs, one with many fixtures on two threads, a drawing with loads, and a table.
DESIGNS = (
    ("widget.json", "widget", "--pitch", "10", "--columns", "1", *VISE, "1"),
    ("oblong.json", "oblongPart", "--pitch", "8", "--columns", "5", *VISE, "2"),
    ("bracket.json", "bracket.dxf", "--pitch", "10", "--columns", "1", "--load", "force=200 at=10,5", *VISE, "2"),
    ("flange.csv", "flange", "--pitch", "8", "--columns", "2", *VISE, "1"),
)


@pytest.fixture(scope="module")
def without_numba(tmp_path_factory) -> dict[str, str]:
    """An environment with the wheel unpacked and all it needs, and nothing else."""
    folder = tmp_path_factory.mktemp("wheel")
    source, packages = folder / "source", folder / "packages"
    for name in ("src", "building"):
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("*.so", "*.egg-info", "__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE", "MANIFEST.in"):
        shutil.copy(ROOT / name, source / name)
    build = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", folder, source]
    subprocess.run(build, check=True)
    (wheel,) = folder.glob("workhold-*-py3-none-*.whl")
    packages.mkdir()
    for path in Path(sysconfig.get_paths()["purelib"]).iterdir():
        if not path.name.startswith(COMPILER):
            (packages / path.name).symlink_to(path)
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "installed")
    kept = {key: value for key, value in os.environ.items() if not key.startswith("WORKHOLD")}
    return {**kept, "PYTHONPATH": os.pathsep.join([str(folder / "installed"), str(packages)])}


def run(environment: dict[str, str], folder: Path, *words: str) -> str:
    """What a program writes; with PYTHONPATH as the only place of packages."""
    done = subprocess.run([sys.executable, "-S", *words], env=environment, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.wheel
def test_the_wheel_needs_no_numba(without_numba, tmp_path):
    """There is none, and from Python too a part is designed for."""
    program = """
import importlib.util, workhold
assert importlib.util.find_spec("numba") is None and "installed" in workhold.__file__
print(workhold.design(workhold.load("widget"), workhold.Vise(pitch=8, columns=1, peg_radius=3)).counts)
"""
    assert run(without_numba, tmp_path, "-c", program).strip() == "{'I': 459, 'II': 46}"


@pytest.mark.wheel
@pytest.mark.parametrize("words", DESIGNS, ids=[words[0] for words in DESIGNS])
def test_files_are_the_same_byte_for_byte(without_numba, words, tmp_path):
    """With compiled kernels and with kernels compiled on first use."""
    shutil.copy(ROOT / "examples" / "bracket.dxf", tmp_path)
    out, *design = words
    compiling = {
        **os.environ,
        "WORKHOLD_KERNELS": "numba",
        "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
    }
    for name, environment in (("built", without_numba), ("compiled", compiling)):
        run(environment, tmp_path, "-m", "workhold", "design", *design, "--out", f"{name}-{out}")
    built, compiled = ((tmp_path / f"{name}-{out}").read_bytes() for name in ("built", "compiled"))
    assert len(built) > 1000
    assert built == compiled
