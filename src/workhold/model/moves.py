"""Moves of a tool's tip as arrays, and which part of each has a cylinder of the tool at given heights.

Glossary
--------
tip : middle of the tool's lower end; its height is z, in mm above the plane on which the part lies.
bulge : tan(sweep / 4) of a move's path in the plane, 0 for a straight one, positive counter-clockwise.
share : how far along a move a moment is, from 0 to 1, by length on a line and by sweep on an arc.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from attrs import cmp_using, field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.limits import MOST_LENGTH

__all__ = ["Moves", "along", "shares_between"]

Floats = NDArray[np.float64]


def integers(values: Any) -> NDArray[np.int64]:
    """A read-only array of whole numbers."""
    array = np.array(values, dtype=np.int64)
    array.setflags(write=False)
    return array


def booleans(values: Any) -> NDArray[np.bool_]:
    """A read-only array of truth values."""
    array = np.array(values, dtype=np.bool_)
    array.setflags(write=False)
    return array


def floats(values: Any) -> Floats:
    """A read-only array of real numbers."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


SAME = cmp_using(eq=np.array_equal)


@frozen
class Moves:
    """The M moves of a program in its order; a full circle is two of them.

    Parameters
    ----------
    line : (M,) line of the program, from 1.
    tool : (M,) number of the tool.
    cutting : (M,) whether it moves at a feed, not rapidly.
    start, end : (M, 3) tip in mm, in the part's coordinates; height is linear in the share.
    bulge : (M,) of the path in the plane.
    feed : (M,) along the path in mm/min, 0 for rapid moves and where none is given.
    spindle : (M,) revolutions per minute, 0 where none are given.

    Raises
    ------
    InputError
        For columns of different lengths, and places that are none.
    """

    line: NDArray[np.int64] = field(converter=integers, eq=SAME, hash=False, repr=False)
    tool: NDArray[np.int64] = field(converter=integers, eq=SAME, hash=False, repr=False)
    cutting: NDArray[np.bool_] = field(converter=booleans, eq=SAME, hash=False, repr=False)
    start: Floats = field(converter=floats, eq=SAME, hash=False, repr=False)
    end: Floats = field(converter=floats, eq=SAME, hash=False, repr=False)
    bulge: Floats = field(converter=floats, eq=SAME, hash=False, repr=False)
    feed: Floats = field(converter=floats, eq=SAME, hash=False, repr=False)
    spindle: Floats = field(converter=floats, eq=SAME, hash=False, repr=False)

    def __attrs_post_init__(self) -> None:
        count = len(self.line)
        flat = (self.tool, self.cutting, self.bulge, self.feed, self.spindle)
        if any(one.shape != (count,) for one in flat) or not (self.start.size == self.end.size == 3 * count):
            raise InputError("moves of a program lack something: give line, tool, ends and bulge of each.")
        if not count:
            return
        if not np.abs(np.concatenate([self.start, self.end])).max() <= MOST_LENGTH:
            raise InputError(f"a move of the program ends nowhere within {MOST_LENGTH:g} mm: correct it.")
        if not np.isfinite(self.bulge).all():
            raise InputError("a move of the program has a bulge that is no number: correct it.")

    def __len__(self) -> int:
        """How many moves there are."""
        return len(self.line)

    @classmethod
    def of_rows(cls, rows: Sequence[tuple[Any, ...]]) -> Moves:
        """Moves from rows of line, tool, cutting, start, end, bulge, feed and spindle.

        Raises
        ------
        InputError
            As for the class.
        """
        columns = list(zip(*rows, strict=True)) if rows else [()] * 8
        ends = [np.array(columns[k], dtype=float).reshape(-1, 3) for k in (3, 4)]
        return cls(*columns[:3], *ends, *columns[5:])

    @property
    def length(self) -> Floats:
        """(M,) length of each move in mm, of helices along the helix."""
        chord = np.hypot(*(self.end - self.start).T[:2])
        half = 2.0 * np.arctan(self.bulge)
        with np.errstate(divide="ignore", invalid="ignore"):
            flat = np.where(half == 0.0, chord, chord * half / np.sin(half))
        length: Floats = np.hypot(flat, (self.end - self.start)[:, 2])
        return length


def shares_between(start: Floats, end: Floats, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """The shares of moves from which and until which their tip is at given heights; (N,) arrays each.

    Parameters
    ----------
    start, end : heights of the tip.
    low, high : the closed interval of heights.

    Returns
    -------
    tuple
        First and last share; the first is larger where the tip is never there.
    """
    rise = end - start
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        one, other = (low - start) / rise, (high - start) / rise
    first, last = np.maximum(np.minimum(one, other), 0.0), np.minimum(np.maximum(one, other), 1.0)
    level = rise == 0.0
    inside = (low <= start) & (start <= high)
    return (
        np.where(level, np.where(inside, 0.0, 1.0), first),
        np.where(level, np.where(inside, 1.0, 0.0), last),
    )


def along(start: Floats, end: Floats, bulge: Floats, share: Floats) -> Floats:
    """Points of paths in the plane at a share; the ends are returned as they are.

    The chord to the point is the whole chord, turned and shortened. For a sweep t and a share s its length is
    ``sin(s t / 2) / sin(t / 2)`` of it, and it is turned by ``(1 - s) t / 2`` against the sweep.

    Parameters
    ----------
    start, end : (N, 2) ends in mm.
    bulge, share : (N,).

    Returns
    -------
    array
        (N, 2) points in mm.
    """
    half = 2.0 * np.arctan(bulge)
    with np.errstate(divide="ignore", invalid="ignore"):
        size = np.where(half == 0.0, share, np.sin(share * half) / np.sin(half))
    angle = (share - 1.0) * half
    chord = end - start
    turned = np.stack(
        [
            np.cos(angle) * chord[:, 0] - np.sin(angle) * chord[:, 1],
            np.sin(angle) * chord[:, 0] + np.cos(angle) * chord[:, 1],
        ],
        axis=1,
    )
    point = start + size[:, None] * turned
    return np.where(share[:, None] == 0.0, start, np.where(share[:, None] == 1.0, end, point))
