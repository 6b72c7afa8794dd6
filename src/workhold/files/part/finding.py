"""Part files, the user's or built-in ones: how they are found, read as bytes, and told apart by kind.

Built in are the seven parts of the paper, as models: their real dimensions were never published (Wallack &
Canny 1996).
"""

from __future__ import annotations

import os
from difflib import get_close_matches
from importlib.resources import files
from os import PathLike
from pathlib import Path

from attrs import frozen

from workhold.errors import InputError
from workhold.files.budget import PART_BYTES
from workhold.files.text import read_at_most

__all__ = [
    "BuiltinPart",
    "list_builtin_parts",
    "find_builtin_path",
    "find_part_file",
    "detect_file_kind",
    "read_bytes",
]


@frozen
class BuiltinPart:
    """A part that comes with the program.

    Parameters
    ----------
    name : the name to load it by.
    description : one line.
    """

    name: str
    description: str


PARTS = (
    BuiltinPart("8Handle", "round knob with eight lobes, all arcs"),
    BuiltinPart("flange", "two-eared flange of lines and arcs, symmetrical left to right only"),
    BuiltinPart("large4Handle", "four-lobed handle, large lobes"),
    BuiltinPart("oblongPart", "slot-like part of two slanted lines and two unequal ends"),
    BuiltinPart("small4Handle", "four-lobed handle, small"),
    BuiltinPart("thin4Handle", "four-lobed handle, narrow lobes"),
    BuiltinPart("widget", "irregular part of eight lines and eight arcs, without symmetry"),
)


def list_builtin_parts() -> tuple[BuiltinPart, ...]:
    """Return the names and one-line descriptions of the built-in parts.

    They are models of the paper's parts, whose dimensions were never published.

    Examples
    --------
    >>> [part.name for part in list_builtin_parts()][-1]
    'widget'
    """
    return PARTS


def find_builtin_path(name: str) -> Path | None:
    """Return the file of a built-in part by its name in any mixture of capitals; None when there is none."""
    for part in PARTS:
        if part.name.lower() == name.strip().lower():
            return Path(str(files("workhold") / "data" / "parts" / f"{part.name}.json"))
    return None


def find_part_file(part: str | PathLike[str]) -> Path:
    """Return the path of an existing file, or else of the built-in part with that name.

    Raises InputError where there is neither, listing built-in names that are close.
    """
    path = Path(part)
    try:
        if path.exists() or path.is_symlink():
            return path
    except (OSError, ValueError):
        pass
    builtin = find_builtin_path(str(part))
    if builtin is not None:
        return builtin
    known = {one.name.lower(): one.name for one in PARTS}
    close = get_close_matches(str(part).strip().lower(), known, n=3, cutoff=0.5) or known
    names = ", ".join(known[one] for one in close)
    raise InputError(
        f"{str(part)[:200]!r}: file not found, and no built-in part has that name (try {names})."
    )


def read_bytes(path: Path) -> bytes:
    """Return the content of a part file.

    Raises
    ------
    InputError
        When it is a folder, empty, larger than ``PART_BYTES`` or not readable.
    """
    try:
        if path.is_dir():
            if not os.access(path, os.R_OK | os.X_OK):
                raise InputError("this is a folder that cannot be looked into: allow reading it.")
            raise InputError("this is a folder: give a .json, .dxf, .svg or .step file in it.")
        if path.is_symlink() and not path.exists():
            raise InputError("this is a link that leads to no file: give the file itself.")
        if not path.is_file():
            raise InputError("this is not a regular file: give a .json, .dxf, .svg or .step file.")
        content = read_at_most(path, PART_BYTES)
        if len(content) > PART_BYTES:
            raise InputError(
                f"the file is larger than {PART_BYTES // 1_000_000} MB: save a drawing of the part's "
                "outline only."
            )
    except OSError as error:
        raise InputError(f"the file cannot be read ({(error.strerror or str(error)).lower()}).") from error
    if not content.strip():
        raise InputError("the file is empty: give a .json, .dxf, .svg or .step file of the part.")
    return content


def detect_file_kind(path: Path, content: bytes) -> str:
    """Return "json", "dxf", "svg" or "step", by the file's ending or else by its first bytes.

    Raises InputError if neither shows the kind.
    """
    ending = path.suffix.lower().lstrip(".")
    if ending in ("json", "dxf", "svg", "step"):
        return ending
    if ending == "stp":
        return "step"
    start = content[:4096].lstrip(b"\xef\xbb\xbf \t\r\n")
    if start.startswith(b"{"):
        return "json"
    if start.startswith(b"<") and b"<svg" in content[:65536]:
        return "svg"
    if start.startswith(b"AutoCAD Binary DXF") or (
        start.startswith((b"0", b"999")) and b"SECTION" in content[:65536]
    ):
        return "dxf"
    if start.startswith(b"ISO-10303-21"):
        return "step"
    raise InputError(
        "this is neither a JSON, a DXF, an SVG nor a STEP file: export the part's outline as one of these."
    )
