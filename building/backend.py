"""The package's build: setuptools', with the kernels compiled into the wheel (PEP 517).

A wheel holds one library of all kernels, ``workhold/kernels/kernels.<platform>.so``, and fits every Python 3 on machines of
that kind. An editable installation compiles its kernels on first use. ``WORKHOLD_WHEEL=pure`` builds a wheel without the
library, for machines without a linker; it needs numba (``workhold[numba]``).
"""

from __future__ import annotations

import os
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

from compile_kernels import SOURCES, build

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


def is_pure() -> bool:
    """Whether a wheel without the library is asked for."""
    return os.environ.get("WORKHOLD_WHEEL") == "pure"


def get_requires_for_build_wheel(config_settings: Any = None) -> list[str]:
    """What building a wheel needs: the compiler, in an environment that is thrown away."""
    return [*build_meta.get_requires_for_build_wheel(config_settings), *([] if is_pure() else COMPILER)]


def build_wheel(
    wheel_directory: str, config_settings: Any = None, metadata_directory: str | None = None
) -> str:
    """Builds a wheel with the kernels of these sources in it."""
    if is_pure():
        return build_meta.build_wheel(wheel_directory, config_settings, metadata_directory)
    build(SOURCES / "workhold" / "kernels")
    platform = get_platform().replace("-", "_").replace(".", "_")
    settings = {**(config_settings or {}), "--build-option": [f"--plat-name={platform}", "--python-tag=py3"]}
    return build_meta.build_wheel(wheel_directory, settings, metadata_directory)
