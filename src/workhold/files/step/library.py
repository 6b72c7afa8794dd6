"""Open CASCADE (OCCT), the library that reads and writes STEP files: loaded only when one is read or written.

It is the package ``OCP`` of the distribution that the extra ``step`` asks for, which links to the system's
libGL and libX11.
"""

from __future__ import annotations

import re

from workhold.errors import InputError

__all__ = ["REQUIREMENT", "load_step_library"]

# What the extra asks for; nobody else's distribution can be had by its name.
REQUIREMENT = "cadquery-ocp-novtk>=8"

# Debian's packages of the shared libraries that the wheel expects from the system.
SYSTEM_PACKAGES = {"libGL.so.1": "libgl1", "libX11.so.6": "libx11-6"}


def load_step_library() -> None:
    """Load Open CASCADE and keep it from writing its progress to the terminal, where a result file may go.

    Raises
    ------
    InputError
        When the extra is not installed, or a system library that it needs is missing; with the remedy.
    """
    try:
        from OCP.Message import Message
    except ImportError as error:
        raise InputError(remedy(error)) from error
    Message.DefaultMessenger_s().ChangePrinters().Clear()


def remedy(error: ImportError) -> str:
    """What to install, by why the import failed."""
    if isinstance(error, ModuleNotFoundError):
        return f"STEP files need a library that is not installed: pip install '{REQUIREMENT}'."
    missing = re.match(r"(lib\S+?\.so[.\d]*): cannot open shared object file", str(error))
    if missing:
        name = missing[1]
        package = SYSTEM_PACKAGES.get(name, " ".join(SYSTEM_PACKAGES.values()))
        return f"STEP files need the system library {name}, which is missing: apt install {package}."
    why = " ".join(str(error).split())[:160].rstrip(".")
    return (
        f"the library for STEP files cannot be loaded ({why}): pip install --force-reinstall '{REQUIREMENT}'."
    )
