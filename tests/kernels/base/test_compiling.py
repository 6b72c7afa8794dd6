"""The cache of compiled kernels is never stale and never in the way."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import workhold
from workhold.kernels.base import built, compiling

# What compiling takes of the kernels' base.
BASE = ("__init__", "built", "compiling", "feature", "lean", "storing")
PROGRAM = """
import numpy as np
from workhold.kernels.base.distance import outline_distance
print(outline_distance(3.0, 4.0, np.array([[0.0, 0, 0, 1, 0, 1e-9, 0, 1, 0, 0]])))
"""


def run(root: Path, cache: Path) -> float:
    """Distance from (3, 4) to a point-like segment at (0, 0), by the package in a folder with a cache elsewhere."""
    environment = os.environ | {"PYTHONPATH": str(root), "WORKHOLD_CACHE_DIR": str(cache)}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, cwd=root, capture_output=True, text=True, check=True
    )
    return float(done.stdout)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A copy that a test may change."""
    return copied(tmp_path)


def copied(folder: Path) -> Path:
    """A folder with just enough of the package to compile the distance kernels."""
    source = Path(workhold.__file__).parent
    package = folder / "source" / "workhold"
    room = package / "kernels" / "base"
    room.mkdir(parents=True)
    for name in (
        "__init__.py",
        "version.py",
        "conventions.py",
        "errors.py",
        "limits.py",
        *(f"kernels/{name}.py" for name in ("__init__", *(f"base/{base}" for base in BASE))),
    ):
        shutil.copy(source / name, package / name)
    text = (source / "kernels" / "base" / "distance.py").read_text()
    head, callee = text.split("@inner\ndef segment_distance", 1)
    callee, caller = callee.split("@inner\ndef outline_distance(", 1)
    # The callee moves to a room of its own, so that the caller's file stays as it is when the callee changes.
    (package / "kernels" / "other").mkdir()
    (package / "kernels" / "other" / "callee.py").write_text(head + "@inner\ndef segment_distance" + callee)
    bridge = "from workhold.kernels.other.callee import segment_distance\n\n\n@inner\ndef outline_distance("
    (room / "distance.py").write_text(head + bridge + caller)
    return folder / "source"


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A copy that stays as it is, and its cache, which holds what was compiled."""
    folder = tmp_path_factory.mktemp("filled")
    run(copied(folder), folder / "cache")
    return folder / "source", folder / "cache"


@pytest.mark.thorough
def test_a_changed_callee_gives_the_new_answer_though_its_caller_is_unchanged(copy, tmp_path):
    """Numba alone would serve the caller's old code; the hash of all sources starts a new folder."""
    cache = tmp_path / "cache"
    assert run(copy, cache) == pytest.approx(5.0, abs=1e-8)
    callee = copy / "workhold" / "kernels" / "other" / "callee.py"
    changed = callee.read_text().replace("return hypot(beyond,", "return 10.0 * hypot(beyond,")
    assert changed != callee.read_text()
    callee.write_text(changed)
    assert run(copy, cache) == pytest.approx(50.0, abs=1e-7)
    assert len(list(cache.glob("kernels-*"))) == 2
    assert all(list(folder.rglob("*.nbi")) for folder in cache.glob("kernels-*"))


@pytest.mark.thorough
def test_a_cache_that_cannot_be_written_is_done_without(copy, tmp_path):
    """Where the cache's name is that of a file, kernels are compiled anew and the answer is the same."""
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    assert run(copy, blocked) == pytest.approx(5.0, abs=1e-8)
    assert blocked.read_text() == "not a folder"


@pytest.mark.thorough
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("damage", [lambda old: b"", lambda old: old[: len(old) // 2]], ids=["empty", "half"])
def test_a_damaged_cache_is_thrown_away_and_made_anew(filled, tmp_path, ending, damage):
    """Empty, halved, zeroed and garbled files, as a loss of power leaves them: same answer, and whole files afterwards."""
    (source, full), cache = filled, tmp_path / "cache"
    shutil.copytree(full, cache)
    whole = {path: path.read_bytes() for path in cache.rglob(f"*.{ending}")}
    assert whole
    for path, content in whole.items():
        path.write_bytes(damage(content))
    assert run(source, cache) == pytest.approx(5.0, abs=1e-8)
    assert all(path.read_bytes() != damage(content) for path, content in whole.items())


def test_a_process_that_belongs_to_no_user_does_without_a_cache(monkeypatch):
    """Where no home folder can be told, nothing is stored and nothing fails."""
    for name in ("WORKHOLD_CACHE_DIR", "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)

    def nobody(path: Path) -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "expanduser", nobody)
    assert compiling.cache_folder.__wrapped__() is None


def test_the_hash_covers_every_kernel_file(tmp_path, monkeypatch):
    """Any change of any source, and any new source, changes the hash; the same sources give the same hash."""
    package = tmp_path / "kernels"
    for name in ("base/compiling.py", "a.py", "other/b.py", "../conventions.py"):
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(f"# {name}")
    monkeypatch.setattr(built, "KERNELS", package)
    hashes = [built.source_hash(), built.source_hash()]
    assert hashes[0] == hashes[1]
    (package / "other" / "b.py").write_text("# b.py changed")
    hashes.append(built.source_hash())
    (package / "c.py").write_text("")
    hashes.append(built.source_hash())
    (package / "c.py").rename(package / "other" / "c.py")
    hashes.append(built.source_hash())
    (tmp_path / "conventions.py").write_text("# another number that decides")
    hashes.append(built.source_hash())
    assert len(set(hashes)) == 5


def test_old_folders_are_dropped_and_the_newest_kept(tmp_path):
    """Besides the current folder the three newest stay; other things in the cache are left alone."""
    current = tmp_path / "kernels-current"
    current.mkdir()
    (tmp_path / "something else").mkdir()
    for age in range(6):
        folder = tmp_path / f"kernels-{age}"
        folder.mkdir()
        os.utime(folder, (1e9 - age, 1e9 - age))
    compiling.drop_old_folders(current)
    left = sorted(p.name for p in tmp_path.iterdir())
    assert left == ["kernels-0", "kernels-1", "kernels-2", "kernels-current", "something else"]


def test_the_cache_is_named_by_the_environment(monkeypatch, tmp_path):
    """WORKHOLD_CACHE_DIR comes first, then XDG_CACHE_HOME, then the home folder."""
    monkeypatch.setenv("WORKHOLD_CACHE_DIR", str(tmp_path / "own"))
    assert compiling.user_cache() == tmp_path / "own"
    monkeypatch.delenv("WORKHOLD_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert compiling.user_cache() == tmp_path / "workhold"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert compiling.user_cache() == Path("~/.cache/workhold").expanduser()
