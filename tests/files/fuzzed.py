"""All seeded files that are tried on readers: those of ``hostile_files``, and of every module in the folder ``fuzzing``.

A module there makes files of one kind, ``make_...(random.Random) -> bytes``. It names them in ``FILES``; of a module
without that, functions of known names are taken.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

from hostile_files import MAKERS

__all__ = ["ALL_MAKERS"]

Maker = Callable[[random.Random], bytes]
KNOWN = {"make_svg": "made.svg", "make_dxf": "made.dxf", "make_json_part": "made.json"}


def makers_of(path: Path) -> dict[str, Maker]:
    """The makers of a module, by the names of their files."""
    spec = spec_from_file_location(f"fuzzing_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    found: dict[str, Maker] | None = getattr(module, "FILES", None)
    if found is None:
        found = {name: getattr(module, made) for made, name in KNOWN.items() if hasattr(module, made)}
    return found


ALL_MAKERS: dict[str, Maker] = dict(MAKERS)
for each in sorted((Path(__file__).parent / "fuzzing").glob("*.py")):
    ALL_MAKERS |= makers_of(each)
