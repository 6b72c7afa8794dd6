"""The seven parts of the paper, as models: their real dimensions were never published (Wallack & Canny 1996)."""

from __future__ import annotations

from difflib import get_close_matches
from importlib.resources import files
from pathlib import Path

from attrs import frozen

__all__ = ["BuiltinPart", "builtin_parts", "builtin_path", "close_names"]


@frozen
class BuiltinPart:
    """A part that comes with the program.

    Parameters
    ----------
    name : what to load it by.
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


def builtin_parts() -> tuple[BuiltinPart, ...]:
    """Names and one-line descriptions of the built-in parts.

    They are models of the paper's parts, whose dimensions were never published.

    Examples
    --------
    >>> [part.name for part in builtin_parts()][-1]
    'widget'
    """
    return PARTS


def builtin_path(name: str) -> Path | None:
    """File of a built-in part, named in any mixture of capitals; None when there is none."""
    for part in PARTS:
        if part.name.lower() == name.strip().lower():
            return Path(str(files("workhold") / "data" / "parts" / f"{part.name}.json"))
    return None


def close_names(name: str) -> list[str]:
    """Built-in names a mistyped one may have meant."""
    known = {part.name.lower(): part.name for part in PARTS}
    return [known[n] for n in get_close_matches(name.strip().lower(), list(known), n=3, cutoff=0.5)]
