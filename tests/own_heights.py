"""Parts of which some carriers meet another outline than all pegs, put together by hand without a solid's file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from attrs import evolve

from workhold import Workpiece
from workhold.model.own_outlines import name_outline
from workhold.model.solid import SolidOutline

__all__ = ["BASE", "FOOT", "HEIGHT", "ROOF", "STEM", "stepped", "with_own"]

HEIGHT, PEG_HEIGHT = 30.0, 8.0
# What pegs meet, what a clamp above a flange meets, what reaches over all, and a foot lower than the pegs.
BASE = [(0, 0, 0), (62, 0, 0), (62, 31, 0), (40, 44, 0), (0, 38, 0)]
STEM = [(9, 6, 0), (52, 4, 0), (55, 27, 0), (31, 35, 0), (12, 30, 0)]
ROOF = [(-4, -3, 0), (66, -5, 0), (64, 40, 0), (20, 52, 0), (-6, 41, 0)]
FOOT = [(4, 2, 0), (57, 3, 0), (50, 30, 0), (22, 37, 0)]


def solid_of(
    count: int, low: float, high: float, untouched: Sequence[int] = (), over: Sequence[Sequence[int]] = ()
) -> SolidOutline:
    """A solid whose outline has so many segments; some of which nothing may touch."""
    bands = [None if k in untouched else (low, high) for k in range(count)]
    return SolidOutline("z", HEIGHT, high, 0.5, 1.0, bands=bands, faces=over, low=low)


def with_own(part: Workpiece, own: Mapping[str, tuple[tuple[float, float], Any]], **bare: Any) -> Workpiece:
    """A part with outlines of carriers.

    Parameters
    ----------
    own : by role the heights and the loop.
    bare : by role the segments of its outline that nothing may touch.
    """
    outlines = []
    for role, ((low, high), loop) in own.items():
        solid = solid_of(len(loop), low, high, bare.get(role, ()))
        outlines.append((role, Workpiece.from_loops(name_outline((low, high)), [loop], solid=solid)))
    return evolve(part, outlines=tuple(outlines))


def stepped(
    own: Mapping[str, tuple[tuple[float, float], Any]],
    loop: Sequence[Sequence[float]] = BASE,
    untouched: Sequence[int] = (),
    **bare: Any,
) -> Workpiece:
    """A part of which all pegs meet a loop, and carriers with heights of their own others."""
    solid = solid_of(len(loop), 0.0, PEG_HEIGHT, untouched)
    return with_own(Workpiece.from_loops("part", [loop], solid=solid), own, **bare)
