"""STEP files of a small plate with one parameter, reference or entity replaced."""

from __future__ import annotations

import random
import tempfile
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from damaged_step import damaged

__all__ = ["FILES"]


@cache
def plate() -> bytes:
    """The file of a plate with a hole."""
    from step_shapes import box, cut, cylinder, write_step

    shape = cut(box(60, 40, 20), cylinder(6, 40, (20, 20, -5)))
    with tempfile.TemporaryDirectory() as folder:
        return write_step(Path(folder) / "plate.step", shape).read_bytes()


def make_step(chance: random.Random) -> bytes:
    """A damaged one."""
    return damaged(plate(), chance.randrange(1 << 30))


# The library is an extra that may be missing.
FILES = {"part.step": make_step} if find_spec("OCP") else {}
