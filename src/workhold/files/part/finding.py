"""The file that a part is in: where it is, its bytes, and which kind it is of."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from workhold.errors import InputError
from workhold.files.part.builtin import builtin_parts, builtin_path, close_names

__all__ = ["found", "kind_of", "read_bytes"]

# Bytes; a drawing of one part is far smaller, and reading takes about twenty times as much memory.
LARGEST_FILE = 40_000_000


def found(part: str | PathLike[str]) -> Path:
    """The file of a part given by path or built-in name.

    Raises
    ------
    InputError
        When there is neither, listing built-in names that are close.
    """
    path = Path(part)
    try:
        if path.exists():
            return path
    except (OSError, ValueError):
        pass
    builtin = builtin_path(str(part))
    if builtin is not None:
        return builtin
    names = close_names(str(part)) or [p.name for p in builtin_parts()]
    raise InputError(
        f"{str(part)[:200]!r}: file not found, and no built-in part has that name (try {', '.join(names)})."
    )


def read_bytes(path: Path) -> bytes:
    """The file's bytes.

    Raises
    ------
    InputError
        When it is a folder, empty, too large or not readable.
    """
    try:
        if path.is_dir():
            raise InputError("this is a folder: give a .json, .dxf, .svg or .step file in it.")
        if not path.is_file():
            raise InputError("this is not a regular file: give a .json, .dxf, .svg or .step file.")
        if path.stat().st_size > LARGEST_FILE:
            raise InputError(
                f"the file is larger than {LARGEST_FILE // 1_000_000} MB: save a drawing of the part's outline only."
            )
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"the file cannot be read ({(error.strerror or str(error)).lower()}).") from error
    if not content.strip():
        raise InputError("the file is empty: give a .json, .dxf, .svg or .step file of the part.")
    return content


def kind_of(path: Path, content: bytes) -> str:
    """ "json", "dxf", "svg" or "step", by the file's ending or else by its first bytes.

    Raises
    ------
    InputError
        For anything else.
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
    if start.startswith(b"AutoCAD Binary DXF") or (start.startswith((b"0", b"999")) and b"SECTION" in content[:65536]):
        return "dxf"
    if start.startswith(b"ISO-10303-21"):
        return "step"
    raise InputError(
        "this is neither a JSON, a DXF, an SVG nor a STEP file: export the part's outline as one of these."
    )
