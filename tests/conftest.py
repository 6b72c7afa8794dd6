"""Settings of the whole suite: property tests draw the same examples every time, alone and after any other test, and know no
deadline; kernels that only kernels call can be called by tests too, and are compiled once before several processes share the
tests. With WORKHOLD_KERNELS=interpreted, as in ``make test``, such kernels run as Python instead and are not compiled."""

from __future__ import annotations

import gc
import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

# Before the first kernel is imported.
os.environ.setdefault("WORKHOLD_KERNELS", "callable")
# Each process that shares the tests has a processor; waiting threads of OpenBLAS would take it from the others.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Commands that tests run have buffered streams, and keep the bytecode of what they import, as a user's do.
os.environ.pop("PYTHONUNBUFFERED", None)
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

from workhold.errors import InputError
from workhold.kernels.base.libraries import ROOMS, build_libraries, find_library_folder, is_built

# Numba keeps the inner kernels that tests call; its own folders would keep those of sources long replaced.
os.environ["NUMBA_CACHE_DIR"] = str(find_library_folder() / "inner")

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture.providers import HypothesisProvider
from hypothesis.internal.constants_ast import Constants

# Ten thousand tests are many objects to look through: seldom, or every fifteenth second goes into it.
gc.set_threshold(20_000, 20, 20)

# And so do the processes that share the tests: to prepare the asserts of all modules takes ten seconds.
sys.dont_write_bytecode = False

settings.register_profile(
    "workhold",
    deadline=None,
    derandomize=True,
    print_blob=False,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("workhold")
# Hypothesis draws numbers from the sources of modules, too, those that the tests before happened to import.
HypothesisProvider._local_constants = Constants()  # type: ignore[assignment]


# The one without windows does the same for two thirds of the processor's time.
CHROMIUM = (
    shutil.which("chromium-headless-shell") or shutil.which("chromium") or shutil.which("chromium-browser")
)
# Rooms of which ``make test`` runs nothing: a browser, FreeCAD, STEP files, many processes, a report of hundreds of figures.
THOROUGH_ROOMS = [
    Path(__file__).parent.joinpath(*room.split("/"))
    for room in ("batch", "bending", "files/step", "paper", "web/browser", "workbench")
]
# What the cases of a law are marked with that are left out, by the marker that says one in how many stays.
LEFT_TO = {"sampled": pytest.mark.prove, "thinned": pytest.mark.thorough}


def pytest_configure(config: pytest.Config) -> None:
    """Compile the kernels once: on a first run each process that shares the tests would compile all of them."""
    if (
        hasattr(config, "workerinput")
        or not config.getoption("numprocesses", None)
        or config.getoption("collectonly")
    ):
        return
    # What cannot be compiled is told by the first test that needs it.
    with suppress(InputError):
        build_libraries([room for room in ROOMS if not is_built((room,))])


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """``make test`` does not even import the rooms of which it runs nothing."""
    return True if collection_path in THOROUGH_ROOMS and "not thorough" in config.option.markexpr else None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests of thorough rooms, and of laws tried on many like cases those that are left to a longer run.

    Those whose places in their lists add up to a multiple of the number stay: of each list every value does.
    """
    for item in items:
        if any(room in item.path.parents for room in THOROUGH_ROOMS):
            item.add_marker(pytest.mark.thorough)
        for name, left_to in LEFT_TO.items():
            if (mark := item.get_closest_marker(name)) and places_of(item) % mark.args[0]:
                item.add_marker(left_to)


def places_of(item: Any) -> int:
    """The sum of the places of a case in the lists that its test is tried on, of which the last changes fastest."""
    if not (lists := [*item.iter_markers("parametrize")]):
        return sum(item.callspec.indices.values())
    first, *others = lists
    names = first.args[0].split(",") if isinstance(first.args[0], str) else first.args[0]
    total, number = 0, item.callspec.indices[names[0]]
    for mark in reversed(others):
        number, place = divmod(number, len(mark.args[1]))
        total += place
    return total + int(number)


def pytest_collection_finish() -> None:
    """Leave what collecting has made out of all later garbage collections: it stays until the end."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium without a window; Playwright can be started once in a process, so all tests share it."""
    api = pytest.importorskip("playwright.sync_api", reason="Playwright for Python is not installed")
    if CHROMIUM is None:
        pytest.skip("no chromium on this machine")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", "--enable-unsafe-swiftshader"]
        )
        yield browser
        browser.close()
