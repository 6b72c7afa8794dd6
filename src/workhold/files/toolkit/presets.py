"""Toolkits that people own, by name; each file in ``data/toolkits`` says where its figures are from.

A preset of a vise is a plate on each jaw, as in the paper: no vise that comes with a lattice of dowel holes on both jaws
is known to us. How many columns a jaw has is for its owner to say; a preset's number is only a usual one.
"""

from __future__ import annotations

import tomllib
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from pathlib import Path

from workhold.errors import InputError
from workhold.files.toolkit.reader import LoadedToolkit, described_toolkit, read_toolkit_file

__all__ = ["LoadedToolkit", "is_sold", "load_toolkit", "preset", "preset_names"]

ENDING = ".toml"


@cache
def preset_names() -> tuple[str, ...]:
    """The names of the presets, what is sold first, of that plates before vises, then by kind and by pitch.

    Examples
    --------
    >>> preset_names()[0]
    'clamp-plate-20mm'
    """
    found = [entry.name for entry in (files("workhold") / "data" / "toolkits").iterdir() if entry.name.endswith(ENDING)]
    presets = [preset(name.removesuffix(ENDING)) for name in found]
    presets.sort(key=lambda one: (one.name.split("-")[0], one.fields["pitch"], one.fields.get("columns", 0)))
    presets.sort(key=lambda one: (not is_sold(one.name), one.toolkit.moving.has_lattice))
    return tuple(one.name for one in presets)


def is_sold(name: str) -> bool:
    """Whether what a preset is named after can be bought or drilled; the paper's grippers cannot.

    >>> is_sold("table-50mm"), is_sold("gripper-one-column, radius 2")
    (True, False)
    """
    return not name.startswith("gripper-")


def preset(name: str) -> LoadedToolkit:
    """The preset of a name that exists."""
    text = (files("workhold") / "data" / "toolkits" / f"{name}{ENDING}").read_text(encoding="utf-8")
    return described_toolkit(name, tomllib.loads(text))


def load_toolkit(name: str | Path) -> LoadedToolkit:
    """Load a toolkit by the name of a preset or from a TOML file; a file wins.

    Parameters
    ----------
    name : a preset's name in any mixture of capitals, or the path of a file.

    Raises
    ------
    InputError
        For a toolkit that cannot be found, with the names that are close, and for a file that cannot be used.

    Examples
    --------
    >>> from workhold import Vise
    >>> loaded = load_toolkit("plate-20mm")
    >>> Vise(**loaded.fields | {"columns": 2}).pitch
    (20.0, 20.0)
    """
    path = Path(name)
    try:
        is_path = path.exists()
    except (OSError, ValueError):
        is_path = False
    names = preset_names()
    asked = str(name).strip().lower()
    if is_path and asked and not (path.is_dir() and asked in names):
        return read_toolkit_file(path)
    if asked in names:
        return preset(asked)
    close = get_close_matches(asked, names, n=3, cutoff=0.5) or names
    raise InputError(f"{str(name)[:200]!r}: file not found, and no toolkit has that name (try {', '.join(close)}).")
