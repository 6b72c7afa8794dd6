"""A program of the machine as what its tools sweep: pieces of the plane, each with heights and a radius.

Glossary
--------
tool : upright cylinders on one axis, their heights above the tip; corners and points are taken as flat ends.
swept piece : a cylinder of a tool on one move: its axis runs along a path, at heights of the tip + [l, u].
rapid : a move at full speed (G0), at which nothing may be hit either; all others cut.
box : a rapid move of which any way inside the box of its ends counts; its path returns and is filled.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from math import inf, isfinite
from pathlib import Path
from typing import Any, Literal

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.delegates import delegate
from workhold.errors import InputError
from workhold.limits import real, refuse_long
from workhold.model.cutting_data import CuttingData
from workhold.model.cutting_forces import CuttingForces
from workhold.model.cutting_tool import Cylinder, Tool
from workhold.model.moves import Moves, along, shares_between

__all__ = ["Cylinder", "MoveKind", "Program", "SweptPiece", "Tool"]

MoveKind = Literal["rapid", "cut"]
RAPID: MoveKind = "rapid"
CUT: MoveKind = "cut"
WAYS = ("straight", "box")
UNITS = ("mm", "inch")
# x, y in mm, and the bulge of the span to the next vertex.
PathVertex = tuple[float, float, float]


def tools_of(values: Mapping[int, Tool]) -> dict[int, Tool]:
    """Tools by their numbers, in a table of its own."""
    return dict(values)


def lines_of(values: Iterable[int]) -> tuple[int, ...]:
    """Numbers of lines as a tuple."""
    return tuple(values)


def notes_of(values: Iterable[str]) -> tuple[str, ...]:
    """Sentences as a tuple."""
    return tuple(values)


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


@frozen(repr=False)
class Program:
    """A program as it was understood, in the part's coordinates and mm; z is 0 where the part lies.

    Parameters
    ----------
    name : of its file.
    sha256 : of the file's bytes, in hexadecimal.
    unit : in which it begins, ``mm`` or ``inch``.
    zero : where its X0 Y0 is on the part.
    z_zero : height of its Z0.
    clearance : kept between every cylinder of a tool and everything that holds the part, in mm.
    rapid : ``straight``, or ``box`` where a control may go another way from end to end.
    tools : by their numbers; at least those that the program uses.
    moves : in its order.
    skipped : lines with a move that was left out, such as one to a place of the machine's own.
    notes : sentences on what was read in one way where another is thinkable.
    forces : of the tools on the part, on every move; None where nobody asks for them.

    Raises
    ------
    InputError
        For a tool that is not known, and numbers that cannot be.
    """

    name: str
    sha256: str
    unit: str
    zero: tuple[float, float]
    z_zero: float = field(converter=real)
    clearance: float = field(default=1.0, converter=real)
    rapid: Literal["straight", "box"] = "straight"
    tools: Mapping[int, Tool] = field(factory=dict, converter=tools_of, hash=False)
    moves: Moves = field(factory=lambda: Moves.of_rows(()))
    skipped: tuple[int, ...] = field(default=(), converter=lines_of)
    notes: tuple[str, ...] = field(default=(), converter=notes_of)
    forces: CuttingForces | None = None

    def __attrs_post_init__(self) -> None:
        if self.unit not in UNITS or self.rapid not in WAYS:
            raise InputError(f"a program is in {' or '.join(UNITS)}, its rapid moves {' or '.join(WAYS)}.")
        for what, value in (("zero", self.zero[0]), ("zero", self.zero[1]), ("z_zero", self.z_zero)):
            if not isfinite(value):
                raise InputError(f"{what} of the program is no place: give a length in mm.")
            refuse_long(f"{what} of the program", value)
        if not 0.0 <= self.clearance < inf:
            raise InputError(f"the clearance {self.clearance:g} is none: give 0 or more, in mm.")
        missing = set(np.unique(self.moves.tool).tolist()) - set(self.tools)
        if missing:
            raise InputError(f"the program uses T{min(missing)}, which is not among its tools.")
        if self.forces is not None and len(self.forces.force) != len(self.moves):
            raise InputError("the program has other forces than moves: give one for each.")

    def __repr__(self) -> str:
        tools = f"{len(self.tools)} tool{'' if len(self.tools) == 1 else 's'}"
        return f"<Program {self.name}: {len(self.moves)} moves of {tools}>"

    @classmethod
    def read(
        cls,
        path: str | Path,
        tools: str | Path | Mapping[int, Any] | None = None,
        zero: tuple[float, float] = (0.0, 0.0),
        z_zero: float | Literal["top", "bottom"] = "top",
        thickness: float | None = None,
        clearance: float = 1.0,
        rapid: Literal["straight", "box"] = "straight",
        unit: str | None = None,
        cutting: CuttingData | Mapping[str, Any] | None = None,
    ) -> Program:
        """Reads a program of RS-274 (G-code).

        Parameters
        ----------
        tools : file of a tool table, or a diameter or a :class:`Tool` for each number; what the program
            itself says of its tools if None.
        zero : where the program's X0 Y0 is on the part, in mm.
        z_zero : height of its Z0 in mm, or which side of the part that is.
        thickness : of the part in mm, where Z0 is its top.
        clearance : in mm.
        rapid : whether rapid moves are straight.
        unit : ``mm`` or ``inch`` where the program does not say.
        cutting : how tools cut of which the table does not say it, for the forces on the part:
            :class:`workhold.model.cutting_data.CuttingData`, or its fields by name.

        Raises
        ------
        InputError
            With the line of what cannot be read, and with tools that are called and not known. With what is
            lacking for forces that are asked for, too.
        """
        read: Program = delegate("read_program")(
            path,
            tools,
            zero=zero,
            z_zero=z_zero,
            thickness=thickness,
            clearance=clearance,
            rapid=rapid,
            unit=unit,
            cutting=cutting,
        )
        return read

    @property
    def pieces(self) -> tuple[SweptPiece, ...]:
        """All that is swept: for each move a piece for each cylinder of its tool."""
        return self.swept(-inf, inf)

    def swept(self, low: float, high: float) -> tuple[SweptPiece, ...]:
        """What is swept at heights in a closed interval: every piece cut to where its cylinder reaches it.

        A piece is cut where tip + l is ``high`` and where tip + u is ``low``; boxes are not cut.

        Parameters
        ----------
        low, high : in mm above the plane on which the part lies.
        """
        return tuple(self.iter_swept(low, high))

    def iter_swept(self, low: float, high: float) -> Iterator[SweptPiece]:
        """The pieces of :meth:`swept`, one by one."""
        moves = self.moves
        row, cylinder = self.pairs()
        if not len(row):
            return
        first_low, last_high = low - cylinder[:, 1], high - cylinder[:, 0]
        start, end, bulge = moves.start[row], moves.end[row], moves.bulge[row]
        box = self.boxed()[row]
        first, last = shares_between(start[:, 2], end[:, 2], first_low, last_high)
        inside = first <= last
        first, last = np.where(box, 0.0, first), np.where(box, 1.0, last)
        kept = np.flatnonzero(inside)
        row, cylinder, box = row[kept], cylinder[kept], box[kept]
        start, end, bulge, first, last = start[kept], end[kept], bulge[kept], first[kept], last[kept]
        one = along(start[:, :2], end[:, :2], bulge, first)
        other = along(start[:, :2], end[:, :2], bulge, last)
        part = np.where(last - first == 1.0, bulge, np.tan((last - first) * np.arctan(bulge)))
        rise = end[:, 2] - start[:, 2]
        tip_first = np.where(first == 0.0, start[:, 2], start[:, 2] + first * rise)
        tip_last = np.where(last == 1.0, end[:, 2], start[:, 2] + last * rise)
        columns = (moves.line[row], moves.tool[row], moves.cutting[row], one, other, part)
        rows = zip(
            *(one.tolist() for one in (*columns, tip_first, tip_last, cylinder, box)),
            strict=True,
        )
        for line, tool, cutting, (x, y), (to_x, to_y), span, tip, to_tip, (
            lower,
            upper,
            radius,
        ), filled in rows:
            path: tuple[PathVertex, ...]
            if filled:
                path = box_path((x, y), (to_x, to_y))
            elif (x, y) == (to_x, to_y):
                path = ((x, y, 0.0),)
            else:
                path = ((x, y, span), (to_x, to_y, 0.0))
            yield SweptPiece(
                line, tool, CUT if cutting else RAPID, path, (tip, to_tip), radius, (lower, upper)
            )

    def pairs(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Every move with every cylinder of its tool: (N,) numbers of moves, (N, 3) low, high and radius."""
        rows, cylinders = [np.zeros(0, np.int64)], [np.zeros((0, 3))]
        for number, tool in self.tools.items():
            moved = np.flatnonzero(self.moves.tool == number)
            table = np.array([(one.low, one.high, one.radius) for one in tool.cylinders])
            rows.append(np.repeat(moved, len(table)))
            cylinders.append(np.tile(table, (len(moved), 1)))
        row = np.concatenate(rows)
        order = np.argsort(row, kind="stable")
        return row[order], np.concatenate(cylinders)[order]

    def boxed(self) -> NDArray[np.bool_]:
        """(M,) whether everything inside the box of a move's ends counts."""
        if self.rapid != "box":
            return np.zeros(len(self.moves), dtype=bool)
        moved = self.moves.start != self.moves.end
        boxed: NDArray[np.bool_] = ~self.moves.cutting & (moved.sum(axis=1) > 1)
        return boxed

    def to_dict(self) -> dict[str, Any]:
        """Plain data as in a result file."""
        pieces = [piece.to_dict() for piece in self.iter_swept(-inf, inf)]
        if self.forces is not None:
            moved = self.pairs()[0].tolist()
            pieces = [piece | self.forces.entry(move) for piece, move in zip(pieces, moved, strict=True)]
        return {**self.head(), "pieces": pieces}

    def head(self) -> dict[str, Any]:
        """Plain data as in a result file, without the pieces."""
        return {
            "name": self.name,
            "sha256": self.sha256,
            "unit": self.unit,
            "zero": list(self.zero),
            "z_zero": self.z_zero,
            "clearance": self.clearance,
            "rapid": self.rapid,
            "tools": {str(number): tool.to_dict() for number, tool in self.tools.items()},
            "skipped": list(self.skipped),
            "notes": list(self.notes),
            **({} if self.forces is None else {"forces": self.forces.to_dict()}),
        }

    @classmethod
    def of_entries(cls, entries: Mapping[str, Any]) -> Program:
        """A program of a file's entries; feeds and speeds are not known of it.

        Raises
        ------
        InputError, LookupError, TypeError, ValueError
            For entries that lack something, or hold what cannot be.
        """
        tools = {int(key): Tool.of_entries(int(key), value) for key, value in entries["tools"].items()}
        x, y = (real(value) for value in entries["zero"])
        pieces = [SweptPiece.of_entries(one) for one in entries["pieces"]]
        moves, said = Moves.of_rows(list(moves_of(pieces, tools))), entries.get("forces")
        # A move has a piece for each cylinder of its tool, all with the same force.
        each = np.array([len(tools[number].cylinders) for number in moves.tool.tolist()], np.int64)
        first = [entries["pieces"][place] for place in (np.cumsum(each) - each).tolist()]
        return cls(
            name=str(entries["name"]),
            sha256=str(entries["sha256"]),
            unit=entries["unit"],
            zero=(x, y),
            z_zero=entries["z_zero"],
            clearance=entries["clearance"],
            rapid=entries["rapid"],
            tools=tools,
            moves=moves,
            skipped=[int(line) for line in entries["skipped"]],
            notes=[str(note) for note in entries.get("notes", ())],
            forces=None if said is None else CuttingForces.of_entries(first, said),
        )


def box_path(one: tuple[float, float], other: tuple[float, float]) -> tuple[PathVertex, ...]:
    """The border of the rectangle between two corners, back to the first; there and back where it is flat."""
    (x, y), (to_x, to_y) = one, other
    corners = [(x, y), (to_x, y), (to_x, to_y), (x, to_y)] if x != to_x and y != to_y else [one, other]
    return tuple((a, b, 0.0) for a, b in (*corners, one))


def moves_of(pieces: list[SweptPiece], tools: Mapping[int, Tool]) -> Iterator[tuple[Any, ...]]:
    """Rows of moves of which these are the pieces.

    Raises
    ------
    InputError
        Where a move lacks a piece of its tool, or has one too many.
    """
    place = 0
    while place < len(pieces):
        first = pieces[place]
        cylinders = tools[first.tool].cylinders if first.tool in tools else ()
        found = pieces[place : place + max(len(cylinders), 1)]
        shapes = [(*one.heights, one.radius) for one in found]
        same = {(one.line, one.tool, one.kind, one.path, one.tip) for one in found}
        if len(same) != 1 or shapes != [(one.low, one.high, one.radius) for one in cylinders]:
            raise InputError(f"the pieces of line {first.line} of the program are not those of its tool.")
        x, y, bulge = first.path[0]
        to_x, to_y, _ = first.path[len(first.path) // 2]
        start, end = (x, y, first.tip[0]), (to_x, to_y, first.tip[1])
        yield first.line, first.tool, first.kind == CUT, start, end, bulge, 0.0, 0.0
        place += len(cylinders)
