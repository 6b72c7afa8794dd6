"""The package's build: setuptools', with the kernels compiled into the wheel (PEP 517).

A wheel holds one library of all kernels, ``workhold/kernels/kernels.<platform>.so``, and fits every Python 3 on machines of
that kind. An editable installation compiles its kernels on first use. ``WORKHOLD_WHEEL=pure`` builds a wheel without the
library, for machines without a linker; it needs numba (``workhold[numba]``). ``WORKHOLD_WHEEL=built`` takes the library
that was compiled before into ``src/workhold/kernels``, where there is no compiler: the library calls nothing but
``malloc`` and ``libm``, so that one of Linux fits every C library.
"""

from __future__ import annotations

import os
import sys
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

from compile_kernels import SOURCES, build, is_built

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


KERNELS = SOURCES / "workhold" / "kernels"


def is_asked(what: str) -> bool:
    """Whether a wheel of some other kind is asked for: ``pure`` or ``built``."""
    return os.environ.get("WORKHOLD_WHEEL") == what


def needed() -> list[str]:
    """What a wheel with the library needs besides setuptools: the compiler, or NumPy to look at what was compiled."""
    return [COMPILER[-1]] if is_asked("built") else COMPILER


def get_requires_for_build_wheel(config_settings: Any = None) -> list[str]:
    """What building a wheel needs, in an environment that is thrown away."""
    return [
        *build_meta.get_requires_for_build_wheel(config_settings),
        *([] if is_asked("pure") else needed()),
    ]


def build_wheel(
    wheel_directory: str, config_settings: Any = None, metadata_directory: str | None = None
) -> str:
    """Builds a wheel with the kernels of these sources in it."""
    if is_asked("pure"):
        return build_meta.build_wheel(wheel_directory, config_settings, metadata_directory)
    if is_asked("built") and not is_built(KERNELS):
        sys.exit(
            "The library of kernels does not fit these sources: compile it, or leave WORKHOLD_WHEEL out."
        )
    build(KERNELS)
    platform = get_platform().replace("-", "_").replace(".", "_")
    settings = {**(config_settings or {}), "--build-option": [f"--plat-name={platform}", "--python-tag=py3"]}
    return build_meta.build_wheel(wheel_directory, settings, metadata_directory)
