"""What a cylinder of a tool sweeps on one move, and whether the move stays clear of the raw block.

A piece is an object, entries of a file, or packed into bytes. A program of 100,000 lines has some 300,000 of
them. Read from a file, each is packed as soon as its entries are complete, so that no more than a few are
objects at a time.

A program feeds through air as well: down to the work, and into a cut from beside it. Nobody says what the raw
part is like, so it is taken as a block: the part's outside dimensions with an allowance on all sides and on
top. A move that stays outside of it wholly presses on nothing. One that enters it counts from end to end.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from struct import Struct
from typing import Any, Literal

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.geometry.segment import Box
from workhold.limits import real
from workhold.model.cutting_tool import Tool
from workhold.model.moves import Moves

__all__ = [
    "ALLOWANCE",
    "CUT",
    "MoveKind",
    "PIECE_KEYS",
    "PathVertex",
    "RAPID",
    "SweptPiece",
    "above_block",
    "beside_block",
    "box_path",
    "moves_of",
    "packed_piece",
]

MoveKind = Literal["rapid", "cut"]
RAPID: MoveKind = "rapid"
CUT: MoveKind = "cut"
# x, y in mm, and the bulge of the span to the next vertex.
PathVertex = tuple[float, float, float]
PIECE_KEYS = frozenset(("line", "tool", "kind", "path", "z", "radius", "heights"))
# Line, tool, whether it cuts, how many vertices; both ends with the bulge; the tip; radius and heights.
PACKED = Struct("<qqBB10d")
FIELDS = np.dtype(
    [
        ("line", "<i8"),
        ("tool", "<i8"),
        ("cutting", "u1"),
        ("vertices", "u1"),
        ("path", "<f8", (5,)),
        ("tip", "<f8", (2,)),
        ("shape", "<f8", (3,)),
    ]
)
# Of the raw block around the part and above it, in mm.
ALLOWANCE = 5.0


@frozen
class SweptPiece:
    """A cylinder of a tool on one move, or on a part of it; in mm, in the part's coordinates.

    Parameters
    ----------
    line : of the program, from 1.
    tool : its number.
    kind : ``rapid`` or ``cut``.
    path : of the axis: vertices x, y and the bulge of the span to the next. One vertex is an upright move,
        two are a segment or an arc; three or more return to the first and are filled, see :attr:`filled`.
    tip : height of the tip at the start and at the end, linear in the share of the span.
    radius : of the cylinder.
    heights : (l, u) of the cylinder above the tip, closed.
    """

    line: int
    tool: int
    kind: MoveKind
    path: tuple[PathVertex, ...]
    tip: tuple[float, float]
    radius: float
    heights: tuple[float, float]

    @property
    def filled(self) -> bool:
        """Whether everything inside the path counts, everywhere at all heights of the move."""
        return len(self.path) > 2

    @property
    def reach(self) -> tuple[float, float]:
        """Least and greatest height that the cylinder covers on the way, in mm."""
        return min(self.tip) + self.heights[0], max(self.tip) + self.heights[1]

    def to_dict(self) -> dict[str, Any]:
        """Plain data as in a result file."""
        return {
            "line": self.line,
            "tool": self.tool,
            "kind": self.kind,
            "path": [list(vertex) for vertex in self.path],
            "z": list(self.tip),
            "radius": self.radius,
            "heights": list(self.heights),
        }

    @classmethod
    def of_entries(cls, entries: Mapping[str, Any]) -> SweptPiece:
        """A piece of a file's entries.

        Raises
        ------
        InputError, LookupError, TypeError, ValueError
            For entries that lack something, or hold what cannot be.
        """
        kind = entries["kind"]
        path = tuple((real(x), real(y), real(bulge)) for x, y, bulge in entries["path"])
        if kind not in (RAPID, CUT) or not path or (len(path) > 2 and path[0][:2] != path[-1][:2]):
            raise InputError(f"a piece of line {entries['line']} of the program is none: leave it out.")
        one, other = (real(value) for value in entries["z"])
        low, high = (real(value) for value in entries["heights"])
        line, tool = int(entries["line"]), int(entries["tool"])
        return cls(line, tool, kind, path, (one, other), real(entries["radius"]), (low, high))


def box_path(one: tuple[float, float], other: tuple[float, float]) -> tuple[PathVertex, ...]:
    """The border of the rectangle between two corners, back to the first; there and back where it is flat."""
    (x, y), (to_x, to_y) = one, other
    corners = [(x, y), (to_x, y), (to_x, to_y), (x, to_y)] if x != to_x and y != to_y else [one, other]
    return tuple((a, b, 0.0) for a, b in (*corners, one))


def packed_piece(entries: Mapping[str, Any]) -> bytes:
    """The entries of a piece as bytes.

    Raises
    ------
    InputError, LookupError, TypeError, ValueError
        For entries that lack something, or hold what cannot be.
    """
    one = SweptPiece.of_entries(entries)
    (x, y, bulge), (to_x, to_y, _) = one.path[0], one.path[len(one.path) // 2]
    is_box = len(one.path) > 2
    if (is_box and one.path != box_path((x, y), (to_x, to_y))) or one.line.bit_length() > 62:
        raise InputError(f"a piece of line {one.line} of the program is none: leave it out.")
    ends, cutting = (x, y, bulge, to_x, to_y), one.kind == CUT
    if not all(map(isfinite, (*ends, *one.tip))):
        raise InputError(f"a move of line {one.line} of the program ends nowhere: correct it.")
    return PACKED.pack(one.line, one.tool, cutting, len(one.path), *ends, *one.tip, *one.heights, one.radius)


def moves_of(pieces: Sequence[bytes], tools: Mapping[int, Tool]) -> Moves:
    """The moves of which these are the packed pieces, one for each cylinder of the tool.

    Raises
    ------
    InputError
        Where a move lacks a piece of its tool, or has one too many.
    """
    table = np.frombuffer(b"".join(pieces), FIELDS)
    shapes = {
        number: np.array([(one.low, one.high, one.radius) for one in tool.cylinders])
        for number, tool in tools.items()
    }
    counts = {number: len(shape) for number, shape in shapes.items()}
    numbers, first, place = table["tool"].tolist(), [], 0
    while place < len(numbers):
        first.append(place)
        place += counts.get(numbers[place], 1)
    start = np.array(first, np.int64)
    known = np.isin(table["tool"], list(shapes))
    own = np.repeat(start, np.diff([*first, place]))[: len(table)]
    fits = known & (place == len(table))
    for name in ("line", "tool", "cutting", "vertices"):
        fits &= table[name] == table[name][own]
    for name in ("path", "tip"):
        fits &= (table[name] == table[name][own]).all(axis=1)
    offset = np.arange(len(table)) - own
    for number, shape in shapes.items():
        mine = np.flatnonzero(fits & (table["tool"] == number))
        fits[mine] = (table["shape"][mine] == shape[offset[mine]]).all(axis=1)
    if not fits.all():
        line = int(table["line"][own[np.argmin(fits)]])
        raise InputError(f"the pieces of line {line} of the program are not those of its tool.")
    moves = table[start]
    path, tip = moves["path"], moves["tip"]
    return Moves(
        moves["line"],
        moves["tool"],
        moves["cutting"],
        np.column_stack([path[:, 0], path[:, 1], tip[:, 0]]),
        np.column_stack([path[:, 3], path[:, 4], tip[:, 1]]),
        path[:, 2],
        np.zeros(len(moves)),
        np.zeros(len(moves)),
    )


def above_block(moves: Moves, thickness: float) -> NDArray[np.bool_]:
    """(M,) whether the tip stays above the block all the way; ``thickness`` of the part in mm."""
    lowest = np.minimum(moves.start[:, 2], moves.end[:, 2])
    return np.asarray(lowest >= thickness + ALLOWANCE)


def beside_block(moves: Moves, tools: Mapping[int, Tool], part: Box) -> NDArray[np.bool_]:
    """(M,) whether the tool's edge stays beside the block all the way.

    Parameters
    ----------
    part : the part's outside dimensions, in mm.

    Segments are clipped by the sides of the block, grown by the tool's radius (Y.-D. Liang and B. A. Barsky,
    *A new concept and method for line clipping*, 1984). Of an arc the box around its circle counts.
    """
    room = np.full(len(moves), ALLOWANCE)
    for number, tool in tools.items():
        room[moves.tool == number] += tool.diameter / 2
    low = np.array([part.x0, part.y0]) - room[:, None]
    high = np.array([part.x1, part.y1]) + room[:, None]
    start, end = moves.start[:, :2], moves.end[:, :2]
    chord = end - start
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (low - start) / chord, (high - start) / chord
    still = chord == 0.0
    within = (start >= low) & (start <= high)
    first = np.where(still, np.where(within, 0.0, 2.0), np.minimum(one, other)).max(axis=1)
    last = np.where(still, np.where(within, 1.0, -1.0), np.maximum(one, other)).min(axis=1)
    misses = np.maximum(first, 0.0) > np.minimum(last, 1.0)
    # The circle of an arc: no point is farther from the middle of the chord than twice its radius.
    bulge = moves.bulge
    round_ = bulge != 0.0
    size = np.hypot(*chord.T)
    safe = np.where(round_, np.abs(bulge), 1.0)
    reach = (size * (1.0 + safe * safe) / (2.0 * safe))[:, None]
    middle = (start + end) / 2
    far = ((middle + reach < low) | (middle - reach > high)).any(axis=1)
    return np.asarray(np.where(round_, far, misses))
