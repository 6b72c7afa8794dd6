"""Which sources compiled kernels belong to: code compiled from others is never run."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from sysconfig import get_platform

from workhold.kernels.base.built import LIBRARY_NAME

__all__ = ["library_name", "source_hash"]

# The folder of all kernels.
KERNELS = Path(__file__).resolve().parents[1]


def source_hash() -> str:
    """Hash of the sources of all rooms of the kernels, and of the numbers that decide."""
    digest, package = sha256(), KERNELS.parent
    for path in (package / "conventions.py", *sorted(KERNELS.rglob("*.py"))):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:20]


def library_name() -> str:
    """Name of the file of the library for this kind of machine."""
    return LIBRARY_NAME.format(platform=get_platform().replace(".", "_"))
