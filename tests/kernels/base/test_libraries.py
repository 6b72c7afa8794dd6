"""Libraries of kernels are those of exactly these sources; what is missing is built once, or said in a sentence."""

from __future__ import annotations

import os
from pathlib import Path
from threading import Event

import pytest

from workhold.errors import InputError
from workhold.kernels.base import libraries

# Of these sources; it is built when it is first asked for.
WHOLE = libraries.find_library("base") or libraries.build_library("base")


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package without libraries, and an empty cache."""
    monkeypatch.setattr(libraries, "KERNELS", tmp_path / "package")
    folder = tmp_path / "cache"
    folder.mkdir()
    monkeypatch.setattr(libraries, "make_cache_folder", lambda: folder)
    return folder


def fill(folder: Path, name: str, content: bytes = b"") -> None:
    """Put a file into a folder that may not be there."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content)


def test_a_library_of_the_package_comes_before_that_of_the_cache(elsewhere: Path) -> None:
    name = libraries.make_library_name("base", "so")
    assert libraries.find_library("base") is None and not libraries.is_built(("base",))
    fill(elsewhere, name)
    assert libraries.find_library("base") == elsewhere / name and libraries.is_built(("base",))
    fill(libraries.KERNELS, name)
    assert libraries.find_library("base") == libraries.KERNELS / name
    assert not libraries.is_built(("base", "curves"))


def test_the_package_can_be_left_out(elsewhere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As benchmarks of the first run do."""
    fill(libraries.KERNELS, libraries.make_library_name("base", "so"))
    monkeypatch.setenv("WORKHOLD_KERNELS", "cache")
    assert libraries.find_library("base") is None


def test_a_library_of_other_sources_is_not_used(elsewhere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fill(elsewhere, libraries.make_library_name("base", "so"))
    monkeypatch.setattr(libraries, "compute_source_hash", lambda: "another")
    assert libraries.find_library("base") is None


def test_nothing_to_build_with_is_one_sentence(elsewhere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(libraries, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"no numba to compile them with; install workhold\[numba\]\."):
        libraries.load_entry("base", "measure_winding")


@pytest.mark.thorough
def test_a_kernel_that_cannot_be_compiled_is_told(elsewhere: Path) -> None:
    """The last line of what its process said."""
    with pytest.raises(InputError, match=r"^The kernels could not be compiled: .*Error"):
        libraries.build_libraries(("base",), elsewhere / "missing")


@pytest.mark.thorough
def test_a_library_is_built_in_a_process_that_reports(elsewhere: Path) -> None:
    """And gives the answers of Python's own arithmetic."""
    told: list[float] = []
    libraries.build_libraries(("base",), report=told.append)
    assert told == sorted(told) and told[-1] == 1.0
    assert [path.name for path in elsewhere.iterdir()] == [libraries.make_library_name("base", "so")]
    assert callable(libraries.load_entry("base", "measure_winding"))


@pytest.mark.thorough
def test_without_a_linker_an_object_file_is_loaded(elsewhere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(elsewhere / "nothing"))
    libraries.build_libraries(("base",))
    assert [path.name for path in elsewhere.iterdir()] == [libraries.make_library_name("base", "o")]
    assert callable(libraries.load_entry("base", "measure_winding"))


@pytest.mark.thorough
def test_a_build_that_is_cancelled_leaves_nothing(elsewhere: Path) -> None:
    cancel = Event()
    cancel.set()
    libraries.build_libraries(("base",), cancel=cancel)
    assert not libraries.is_built(("base",))


def test_a_process_that_belongs_to_no_user_does_without_a_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no home folder can be told, libraries go to a folder of this process."""
    for name in ("WORKHOLD_CACHE_DIR", "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)

    def nobody(path: Path) -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "expanduser", nobody)
    monkeypatch.setattr(libraries, "make_cache_folder", libraries.make_cache_folder.__wrapped__)
    assert libraries.make_cache_folder() is None
    assert (
        libraries.find_library_folder() == libraries.make_temporary_folder()
        and libraries.find_library_folder().is_dir()
    )


def test_the_hash_covers_every_kernel_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Any change of any source, and any new source, changes the hash; the same sources give the same hash."""
    package, hash_now = tmp_path / "kernels", libraries.compute_source_hash.__wrapped__
    for name in ("base/compiling.py", "a.py", "other/b.py", "../conventions.py"):
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(f"# {name}")
    monkeypatch.setattr(libraries, "KERNELS", package)
    hashes = [hash_now(), hash_now()]
    assert hashes[0] == hashes[1]
    (package / "other" / "b.py").write_text("# b.py changed")
    hashes.append(hash_now())
    (package / "c.py").write_text("")
    hashes.append(hash_now())
    (package / "c.py").rename(package / "other" / "c.py")
    hashes.append(hash_now())
    (tmp_path / "conventions.py").write_text("# another number that decides")
    hashes.append(hash_now())
    assert len(set(hashes)) == 5


def test_old_folders_are_dropped_and_the_newest_kept(tmp_path: Path) -> None:
    """Besides the current folder the three newest stay; other things in the cache are left alone."""
    current = tmp_path / "kernels-current"
    current.mkdir()
    (tmp_path / "something else").mkdir()
    for age in range(6):
        folder = tmp_path / f"kernels-{age}"
        folder.mkdir()
        os.utime(folder, (1e9 - age, 1e9 - age))
    libraries.drop_old_folders(current)
    left = sorted(path.name for path in tmp_path.iterdir())
    assert left == ["kernels-0", "kernels-1", "kernels-2", "kernels-current", "something else"]


def test_the_cache_is_named_by_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """WORKHOLD_CACHE_DIR comes first, then XDG_CACHE_HOME, then the home folder."""
    monkeypatch.setenv("WORKHOLD_CACHE_DIR", str(tmp_path / "own"))
    assert libraries.find_user_cache() == tmp_path / "own"
    monkeypatch.delenv("WORKHOLD_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert libraries.find_user_cache() == tmp_path / "workhold"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert libraries.find_user_cache() == Path("~/.cache/workhold").expanduser()


def test_a_damaged_library_of_the_package_is_one_sentence(elsewhere: Path) -> None:
    fill(libraries.KERNELS, libraries.make_library_name("base", "so"), b"no library")
    with pytest.raises(InputError, match="library of compiled kernels is damaged; install again"):
        libraries.load_entry("base", "measure_winding")


def test_a_damaged_library_of_the_cache_is_built_anew(
    elsewhere: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a loss of power may leave one; here another whole one takes its place."""
    name = libraries.make_library_name("base", "so")
    fill(elsewhere, name, b"")
    monkeypatch.setattr(libraries, "build_library", lambda room: WHOLE)
    assert callable(libraries.load_entry("base", "measure_winding"))
    assert not (elsewhere / name).exists()
