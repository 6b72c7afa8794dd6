"""The package's build: setuptools', with the kernels compiled into the wheel (PEP 517).

A wheel holds one library for each room of kernels, ``workhold/kernels/kernels-<room>-<hash>.<platform>.so``, and fits
every Python 3 on machines of that kind. An editable installation compiles its kernels on first use.
``WORKHOLD_WHEEL=pure`` builds a wheel without the libraries, for machines without a linker; it needs numba
(``workhold[numba]``). ``WORKHOLD_WHEEL=built`` takes the libraries that were compiled before into
``src/workhold/kernels``, where there is no compiler: they call nothing but the C library's mathematics, so that
those of Linux fit every C library.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from sysconfig import get_platform
from typing import Any

from setuptools import build_meta
from setuptools.build_meta import (
    build_editable,
    build_sdist,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

SOURCES = Path(__file__).resolve().parents[1] / "src"
sys.path.insert(0, str(SOURCES))

from workhold.errors import InputError  # noqa: E402 -- found by the line above
from workhold.kernels.base.libraries import (  # noqa: E402
    KERNELS,
    ROOMS,
    build_libraries,
    compute_source_hash,
    find_in,
)

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_editable",
    "prepare_metadata_for_build_wheel",
]

COMPILER = ["numba>=0.61", "numpy>=2.0"]


def is_asked(what: str) -> bool:
    """Whether a wheel of some other kind is asked for: ``pure`` or ``built``."""
    return os.environ.get("WORKHOLD_WHEEL") == what


def list_build_requirements() -> list[str]:
    """Return what a wheel with the libraries needs besides setuptools: the compiler, where they are to be compiled."""
    return [] if is_asked("built") else COMPILER


def are_libraries_built() -> bool:
    """Return whether the package has the libraries of these sources."""
    return all(find_in(KERNELS, room) for room in ROOMS)


def compile_kernels() -> None:
    """Compile what is missing into the package, and remove the libraries of other sources."""
    for path in KERNELS.glob("kernels-*"):
        if compute_source_hash() not in path.name:
            path.unlink()
    try:
        build_libraries(ROOMS, KERNELS)
    except InputError as error:
        sys.exit(str(error))


def get_requires_for_build_wheel(config_settings: Any = None) -> list[str]:
    """What building a wheel needs, in an environment that is thrown away."""
    return [
        *build_meta.get_requires_for_build_wheel(config_settings),
        *([] if is_asked("pure") else list_build_requirements()),
    ]


def build_wheel(
    wheel_directory: str, config_settings: Any = None, metadata_directory: str | None = None
) -> str:
    """Builds a wheel with the kernels of these sources in it."""
    if is_asked("pure"):
        return build_meta.build_wheel(wheel_directory, config_settings, metadata_directory)
    if is_asked("built") and not are_libraries_built():
        sys.exit(
            "The libraries of kernels do not fit these sources: compile them, or leave WORKHOLD_WHEEL out."
        )
    compile_kernels()
    platform = get_platform().replace("-", "_").replace(".", "_")
    settings = {**(config_settings or {}), "--build-option": [f"--plat-name={platform}", "--python-tag=py3"]}
    return build_meta.build_wheel(wheel_directory, settings, metadata_directory)
