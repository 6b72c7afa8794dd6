"""Moves of a tool's tip as arrays, and the space that a cylinder of the tool sweeps on one of them.

A program of 100,000 lines has some 300,000 swept pieces. When read from a file, each is packed into bytes as
soon as its entries are complete, so that only few exist as objects at a time.

Glossary
--------
tip : middle of the tool's lower end; its height is z, in mm above the plane on which the part lies.
bulge : tan(sweep / 4) of a move's path in the plane, 0 for a straight one, positive counter-clockwise.
share : position along a move, from 0 at its start to 1 at its end, by length on a line and by sweep on an
    arc.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from struct import Struct
from typing import Any, Literal

import numpy as np
from attrs import Factory, cmp_using, field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.limits import MOST_LENGTH, convert_real
from workhold.model.cutting_tool import Tool

__all__ = [
    "CUT",
    "PIECE_KEYS",
    "RAPID",
    "MoveKind",
    "Moves",
    "PathVertex",
    "MoveStretches",
    "SweptPiece",
    "compute_path_points",
    "make_box_path",
    "compute_bulges_of_shares",
    "unpack_moves",
    "pack_piece",
    "find_shares_between_heights",
]

Floats = NDArray[np.float64]
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


def to_integers(values: Any) -> NDArray[np.int64]:
    """Return a read-only copy as an int64 array."""
    array = np.array(values, dtype=np.int64)
    array.setflags(write=False)
    return array


def to_booleans(values: Any) -> NDArray[np.bool_]:
    """Return a read-only copy as a boolean array."""
    array = np.array(values, dtype=np.bool_)
    array.setflags(write=False)
    return array


def to_floats(values: Any) -> Floats:
    """Return a read-only copy as a float64 array."""
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
    cutting : (M,) True for a move at a feed, False for a rapid one.
    start, end : (M, 3) tip in mm, in the part's coordinates; on the way its height is linear in the share.
    bulge : (M,) of the path in the plane.
    feed : (M,) along the path in mm/min, 0 for rapid moves and where none is given.
    spindle : (M,) revolutions per minute, 0 where none are given.
    cycle : (M,) whether a drill cycle makes the move; False where unknown, as for moves of a result file.

    Raises
    ------
    InputError
        For columns of different lengths, and impossible places.
    """

    line: NDArray[np.int64] = field(converter=to_integers, eq=SAME, hash=False, repr=False)
    tool: NDArray[np.int64] = field(converter=to_integers, eq=SAME, hash=False, repr=False)
    cutting: NDArray[np.bool_] = field(converter=to_booleans, eq=SAME, hash=False, repr=False)
    start: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)
    end: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)
    bulge: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)
    feed: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)
    spindle: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)
    cycle: NDArray[np.bool_] = field(
        default=Factory(lambda self: np.zeros(len(self.line), np.bool_), takes_self=True),
        converter=to_booleans,
        eq=SAME,
        hash=False,
        repr=False,
    )

    def __attrs_post_init__(self) -> None:
        count = len(self.line)
        flat = (self.tool, self.cutting, self.bulge, self.feed, self.spindle, self.cycle)
        if any(one.shape != (count,) for one in flat) or not (self.start.size == self.end.size == 3 * count):
            raise InputError("moves of a program lack something: give line, tool, ends and bulge of each.")
        if not count:
            return
        if not np.abs(np.concatenate([self.start, self.end])).max() <= MOST_LENGTH:
            raise InputError(f"a move of the program ends nowhere within {MOST_LENGTH:g} mm: correct it.")
        if not np.isfinite(self.bulge).all():
            raise InputError("a move of the program has a bulge that is not a number: correct it.")

    def __len__(self) -> int:
        return len(self.line)

    @classmethod
    def from_rows(cls, rows: Sequence[tuple[Any, ...]]) -> Moves:
        """Return moves from rows (line, tool, cutting, start, end, bulge, feed, spindle[, cycle]),
        fields as documented on the class.

        Raises
        ------
        InputError
            As for the class.
        """
        columns = list(zip(*rows, strict=True)) if rows else [()] * 8
        ends = [np.array(columns[k], dtype=float).reshape(-1, 3) for k in (3, 4)]
        return cls(*columns[:3], *ends, *columns[5:])

    def cut_into_stretches(self, stretches: MoveStretches) -> Moves:
        """Return K moves, one for each stretch, which run along that stretch only.

        Each has the line, tool and speeds of the move it is a part of.
        """
        move, first, last = stretches.move, stretches.first, stretches.last
        start, end, bulge = self.start[move], self.end[move], self.bulge[move]
        places = []
        for share in (first, last):
            height = start[:, 2] + share * (end - start)[:, 2]
            height = np.where(share == 0.0, start[:, 2], np.where(share == 1.0, end[:, 2], height))
            places.append(
                np.column_stack([compute_path_points(start[:, :2], end[:, :2], bulge, share), height])
            )
        return Moves(
            self.line[move],
            self.tool[move],
            self.cutting[move],
            places[0],
            places[1],
            compute_bulges_of_shares(bulge, last - first),
            self.feed[move],
            self.spindle[move],
            self.cycle[move],
        )

    @property
    def length(self) -> Floats:
        """(M,) length of each move's path in mm, its rise included: a helix is measured along the helix."""
        chord = np.hypot(*(self.end - self.start).T[:2])
        half = 2.0 * np.arctan(self.bulge)
        with np.errstate(divide="ignore", invalid="ignore"):
            flat = np.where(half == 0.0, chord, chord * half / np.sin(half))
        length: Floats = np.hypot(flat, (self.end - self.start)[:, 2])
        return length


@frozen
class MoveStretches:
    """K stretches of moves, each from one share of its move to another.

    Parameters
    ----------
    move : (K,) index of each stretch's move, ascending; a move may have several stretches.
    first, last : (K,) shares of the move at which the stretch begins and ends.
    """

    move: NDArray[np.int64] = field(converter=to_integers, eq=SAME, hash=False, repr=False)
    first: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)
    last: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)

    def __len__(self) -> int:
        return len(self.move)

    @classmethod
    def from_whole_moves(cls, moves: NDArray[np.bool_]) -> MoveStretches:
        """Return one stretch, from share 0 to 1, for each move where the mask (M,) is True."""
        rows = np.flatnonzero(moves)
        return cls(rows, np.zeros(len(rows)), np.ones(len(rows)))

    def list_shares(self, move: int) -> list[list[float]]:
        """Return [first, last] share of each stretch of the move with this index; [] if it has none."""
        own = slice(*np.searchsorted(self.move, [move, move + 1]).tolist())
        return [list(pair) for pair in zip(self.first[own].tolist(), self.last[own].tolist(), strict=True)]


def compute_bulges_of_shares(bulge: Floats, part: Floats) -> Floats:
    """Return the bulges (N,) of parts of arcs.

    ``bulge`` (N,) is that of the whole arc, ``part`` (N,) the fraction of its sweep that is kept.
    """
    return np.where(part == 1.0, bulge, np.tan(part * np.arctan(bulge)))


def find_shares_between_heights(
    start: Floats, end: Floats, low: Floats, high: Floats
) -> tuple[Floats, Floats]:
    """Return the first and the last share, (N,) each, of N moves between which the tip's height is in [low,
    high].

    A tip goes from height ``start`` to ``end``; all arguments are (N,) in mm. Where the height is never in
    that range, first > last.
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


def compute_path_points(start: Floats, end: Floats, bulge: Floats, share: Floats) -> Floats:
    """Return the points (N, 2) in mm at one share of each of N paths in the plane; at 0 and 1 exactly the
    ends.

    The chord from the start to the point is the whole chord, shortened and turned. For a sweep t and a share
    s its length is ``sin(s t / 2) / sin(t / 2)`` times that of the whole, and it is turned by ``(1 - s) t /
    2`` against the sweep.

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


@frozen
class SweptPiece:
    """A cylinder of a tool on one move, or on a part of it; in mm, in the part's coordinates.

    Parameters
    ----------
    line : of the program, from 1.
    tool : number of the tool.
    kind : ``rapid`` or ``cut``.
    path : of the axis: vertices x, y and the bulge of the span to the next. One vertex is an upright move,
        two are a segment or an arc; three or more return to the first and are filled, see :attr:`filled`.
    tip : heights of the tip at the start and at the end; linear in the share of the span.
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
        """Whether the path is the border of a box whose whole inside counts as swept, at all heights of the
        move.
        """
        return len(self.path) > 2

    @property
    def reach(self) -> tuple[float, float]:
        """Least and greatest height in mm that the cylinder covers during the move."""
        return min(self.tip) + self.heights[0], max(self.tip) + self.heights[1]

    def to_dict(self) -> dict[str, Any]:
        """Return plain data as in a result file."""
        return {
            "line": self.line,
            "tool": self.tool,
            "kind": self.kind,
            "path": [list(vertex) for vertex in self.path],
            "z": list(self.tip),
            "radius": self.radius,
            "heights": list(self.heights),
        }


def make_box_path(one: tuple[float, float], other: tuple[float, float]) -> tuple[PathVertex, ...]:
    """Return the border of the rectangle between two opposite corners as closed straight spans: the last
    vertex equals the first.

    Where the rectangle has no width or no height, the path goes from ``one`` to ``other`` and back.
    """
    (x, y), (to_x, to_y) = one, other
    corners = [(x, y), (to_x, y), (to_x, to_y), (x, to_y)] if x != to_x and y != to_y else [one, other]
    return tuple((a, b, 0.0) for a, b in (*corners, one))


def pack_piece(entries: Mapping[str, Any]) -> bytes:
    """Return a swept piece, given as the entries of a result file, as bytes in the layout :data:`PACKED`.

    Raises
    ------
    InputError, LookupError, TypeError, ValueError
        For entries that lack something, or hold impossible values.
    """
    line, tool, kind = int(entries["line"]), int(entries["tool"]), entries["kind"]
    path = tuple((convert_real(x), convert_real(y), convert_real(bulge)) for x, y, bulge in entries["path"])
    if kind not in (RAPID, CUT) or not path or line.bit_length() > 62:
        raise InputError(f"a piece of line {line} of the program cannot be used: leave it out.")
    (x, y, bulge), (to_x, to_y, _) = path[0], path[len(path) // 2]
    if len(path) > 2 and path != make_box_path((x, y), (to_x, to_y)):
        raise InputError(f"a piece of line {line} of the program cannot be used: leave it out.")
    ends = (x, y, bulge, to_x, to_y, *to_pair(entries["z"]))
    if not all(map(isfinite, ends)):
        raise InputError(f"a move of line {line} of the program ends nowhere: correct it.")
    shape = (*to_pair(entries["heights"]), convert_real(entries["radius"]))
    return PACKED.pack(line, tool, kind == CUT, len(path), *ends, *shape)


def to_pair(values: Any) -> tuple[float, float]:
    """Return two values as floats; raise InputError or ValueError for anything else."""
    one, other = values
    return convert_real(one), convert_real(other)


def unpack_moves(pieces: Sequence[bytes], tools: Mapping[int, Tool]) -> Moves:
    """Return the moves that packed pieces belong to;
    each move has one piece for each cylinder of its tool, in order.

    Feeds and speeds are 0. Raises InputError, naming the line, where a move lacks a piece or has one too
    many.
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
