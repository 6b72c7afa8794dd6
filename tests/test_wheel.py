"""The sdist makes the wheel, which installs in an empty environment; there, without numba, it writes the same files as
kernels that are compiled on first use, byte for byte.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import workhold
from workhold.kernels.base.libraries import ROOMS, make_library_name

ROOT = Path(workhold.__file__).parents[2]
VISE = ("--peg-radius", "3", "--threads")
# What of the C library and of libm the kernels may call: musl and glibc have these.
OF_C = {
    *("malloc", "free", "memcpy", "memset", "acos", "asin", "atan", "atan2", "ceil", "cos", "exp2", "floor"),
    *("fmod", "hypot", "sin", "sincos"),
}
# A part with arcs, one with many fixtures on two threads, a drawing with loads, and a table.
DESIGNS = (
    ("widget.json", "widget", "--pitch", "10", "--columns", "1", *VISE, "1"),
    ("oblong.json", "oblongPart", "--pitch", "8", "--columns", "5", *VISE, "2"),
    (
        "bracket.json",
        "bracket.dxf",
        "--pitch",
        "10",
        "--columns",
        "1",
        "--load",
        "force=200 at=10,5",
        *VISE,
        "2",
    ),
    ("seats.json", "widget", "--pitch", "8", "--columns", "1", "--best", "20", "--seating", "2", *VISE, "2"),
    ("flange.csv", "flange", "--pitch", "8", "--columns", "2", *VISE, "1"),
)


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Path:
    """A folder with the sdist of these sources, and the wheel that it makes."""
    folder = tmp_path_factory.mktemp("built")
    source = folder / "source"
    left_out = shutil.ignore_patterns(
        ".*", "*.so", "*.egg-info", "__pycache__", "build", "dist", "demo", "site"
    )
    shutil.copytree(ROOT, source, ignore=left_out)
    program = "import sys; sys.path.insert(0, 'building'); import backend; backend.build_sdist(sys.argv[1])"
    subprocess.run([sys.executable, "-c", program, folder], cwd=source, check=True, capture_output=True)
    (sdist,) = folder.glob("workhold-*.tar.gz")
    make = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "-q",
        "--no-deps",
        "--no-build-isolation",
        "-w",
        folder,
        sdist,
    ]
    subprocess.run(make, check=True)
    return folder


@pytest.fixture(scope="module")
def without_numba(built, tmp_path_factory) -> dict[str, str]:
    """An empty environment with the wheel, what it says that it needs, and nothing else."""
    (wheel,) = built.glob("workhold-*-py3-none-*.whl")
    home = tmp_path_factory.mktemp("environment") / "empty"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", home], check=True)
    (packages,) = home.glob("lib/python3*/site-packages")
    python = str(home / "bin" / "python")
    install = [
        sys.executable,
        "-m",
        "pip",
        "--python",
        python,
        "install",
        "-q",
        "--no-deps",
        "--no-index",
        wheel,
    ]
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("WORKHOLD", "PYTHON"))}
    subprocess.run(install, check=True, env=kept)
    for name in needed_by(metadata.Distribution.at(next(packages.glob("workhold-*.dist-info")))):
        for top in {path.parts[0] for path in metadata.files(name) or () if path.parts[0] != ".."}:
            if not (packages / top).exists():
                (packages / top).symlink_to(Path(sysconfig.get_paths()["purelib"]) / top)
    # No compiler, no linker and no other Python can be found.
    return {**kept, "VIRTUAL_ENV": str(home), "PATH": str(home / "bin")}


def needed_by(distribution: metadata.Distribution) -> set[str]:
    """The names of all distributions that one needs, and those that they need, without extras."""
    found: set[str] = set()
    waiting = [distribution]
    while waiting:
        for words in waiting.pop().requires or ():
            requirement = Requirement(words)
            wanted = requirement.marker is None or requirement.marker.evaluate({"extra": ""})
            if wanted and canonicalize_name(requirement.name) not in found:
                found.add(canonicalize_name(requirement.name))
                waiting.append(metadata.distribution(requirement.name))
    return found


def run(environment: dict[str, str], folder: Path, *words: str) -> str:
    """What a command of the environment writes."""
    program = Path(environment["VIRTUAL_ENV"], "bin", words[0])
    done = subprocess.run([program, *words[1:]], env=environment, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.wheel
def test_the_sdist_has_what_it_takes_to_build_test_and_cite(built):
    """Every file of the sources but what git leaves out, and no compiled code."""
    (sdist,) = built.glob("workhold-*.tar.gz")
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    for name in (
        "LICENSE",
        "CITATION.cff",
        "CONTRIBUTING.md",
        "SECURITY.md",
        "Makefile",
        "Containerfile",
        "constraints.txt",
        "mkdocs.yml",
        "conda/recipe/recipe.yaml",
        "freecad/package.xml",
        "examples/clients/workhold.mjs",
    ):
        assert name in names
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    left = {name for name in tracked.stdout.splitlines() if not name.startswith(".")}
    assert left - names == set()
    for folder, ending in (
        ("docs", "md"),
        ("tests", "py"),
        ("benchmarks", "py"),
        ("src", "py"),
        ("examples", "dxf"),
    ):
        there = {str(path.relative_to(ROOT)) for path in (ROOT / folder).rglob(f"*.{ending}")}
        assert there and there <= names
    assert not [name for name in names if name.endswith((".so", ".pyc"))]


@pytest.mark.wheel
def test_the_wheel_needs_no_numba(without_numba, tmp_path):
    """There is none, and from Python too a part is designed for."""
    program = """
import importlib.util, workhold
found = [name for name in ("numba", "pip", "pytest", "scipy") if importlib.util.find_spec(name)]
assert not found and "empty" in workhold.__file__
print(workhold.design(workhold.load("widget"), workhold.Vise(pitch=8, columns=1, peg_radius=3)).counts)
"""
    assert run(without_numba, tmp_path, "python", "-c", program).strip() == "{'I': 459, 'II': 46}"


@pytest.mark.wheel
def test_a_machine_without_a_compiler_makes_the_demo(without_numba, tmp_path):
    """All of ``make demo`` there; ``doctor`` says that nothing of the core is missing."""
    shutil.copy(ROOT / "examples" / "bracket.dxf", tmp_path)
    program = "import shutil; print([name for name in ('cc', 'gcc', 'clang', 'ld') if shutil.which(name)])"
    assert run(without_numba, tmp_path, "python", "-c", program).strip() == "[]"
    jaws = ("--pitch", "10", "--columns", "2", "--peg-radius", "3")
    run(
        without_numba,
        tmp_path,
        "workhold",
        "design",
        "bracket.dxf",
        *jaws,
        "--out",
        "b.json",
        "--draw",
        "drawn",
    )
    run(without_numba, tmp_path, "workhold", "sheet", "b.json", "1", "-o", "setup.pdf", "--jaw-force", "3000")
    assert (tmp_path / "setup.pdf").read_bytes().startswith(b"%PDF")
    assert (tmp_path / "drawn" / "thumbnails.png").stat().st_size > 10_000
    told = json.loads(run(without_numba, tmp_path, "workhold", "doctor", "--json"))
    found = {one["what"]: one for one in told["findings"]}
    assert found["kernels"]["state"] == "compiled in the package" and found["kernels"]["remedy"] is None
    assert found["numba"]["state"] == "not needed here"


@pytest.mark.wheel
@pytest.mark.skipif(sys.platform != "linux" or not shutil.which("readelf"), reason="readelf is not installed")
@pytest.mark.parametrize("room", ROOMS)
def test_libraries_fit_every_c_library_of_linux(without_numba, room):
    """It names no library that it needs, and no version of what it calls: glibc's old ones and musl have it all."""
    folder = next(Path(without_numba["VIRTUAL_ENV"]).glob("lib/python3*/site-packages/workhold/kernels"))
    library = folder / make_library_name(room, "so")
    dynamic = subprocess.run(["readelf", "-dV", library], capture_output=True, text=True, check=True).stdout
    assert "STRTAB" in dynamic
    assert "NEEDED" not in dynamic and "GLIBC" not in dynamic
    symbols = subprocess.run(
        ["readelf", "-W", "--dyn-syms", library], capture_output=True, text=True, check=True
    )
    called = {
        line.split()[-1] for line in symbols.stdout.splitlines() if " UND " in line and len(line.split()) == 8
    }
    assert called <= OF_C


@pytest.mark.wheel
@pytest.mark.parametrize("words", DESIGNS, ids=[words[0] for words in DESIGNS])
def test_files_are_the_same_byte_for_byte(without_numba, words, tmp_path, tmp_path_factory):
    """With compiled kernels and with kernels compiled on first use."""
    shutil.copy(ROOT / "examples" / "bracket.dxf", tmp_path)
    out, *design = words
    run(without_numba, tmp_path, "workhold", "design", *design, "--out", f"built-{out}")
    compiling = {
        **os.environ,
        "WORKHOLD_KERNELS": "cache",
        "WORKHOLD_CACHE_DIR": str(tmp_path_factory.getbasetemp() / "first-use"),
        "PYTHONPATH": str(ROOT / "src"),
    }
    compiled = [sys.executable, "-m", "workhold", "design", *design, "--out", f"compiled-{out}"]
    subprocess.run(compiled, env=compiling, cwd=tmp_path, check=True, capture_output=True)
    built, compiled = ((tmp_path / f"{name}-{out}").read_bytes() for name in ("built", "compiled"))
    assert len(built) > 1000
    assert built == compiled
