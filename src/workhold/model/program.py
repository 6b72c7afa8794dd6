"""A program of the machine as what its tools sweep: pieces of the plane, each with heights and a radius.

Glossary
--------
tool : upright cylinders on one axis, their heights above the tip; corners and points are taken as flat ends.
swept piece : a cylinder of a tool on one move: its axis runs along a path, at heights of the tip + [l, u].
rapid : a move at full speed (G0), at which nothing may be hit either; all others cut.
box : a rapid move of which any way inside the box of its ends counts; its path returns and is filled.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf, isfinite
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from attrs import evolve, field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.limits import convert_real, name_number_fields, refuse_long
from workhold.model.cutting_forces import CuttingForces
from workhold.model.cutting_tool import CuttingData, Cylinder, Tool
from workhold.model.moves import (
    CUT,
    RAPID,
    MoveKind,
    Moves,
    PathVertex,
    SweptPiece,
    along,
    box_path,
    compute_bulges_of_shares,
    find_shares_between_heights,
    moves_of,
    pack_piece,
)
from workhold.model.stock import Stock, find_stretches_in_stock

__all__ = ["Cylinder", "MoveKind", "PathVertex", "Program", "Stock", "SweptPiece", "Tool"]

WAYS = ("straight", "box")
# Pieces made at a time.
AT_ONCE = 1 << 13
UNITS = ("mm", "inch")


def read_tool_table(values: Mapping[int, Tool]) -> dict[int, Tool]:
    """Tools by their numbers, in a table of its own."""
    return dict(values)


def lines_of(values: Iterable[int]) -> tuple[int, ...]:
    return tuple(values)


def notes_of(values: Iterable[str]) -> tuple[str, ...]:
    return tuple(values)


class SweptArrays(NamedTuple):
    """N swept pieces as arrays, see :class:`workhold.model.moves.SweptPiece`.

    Parameters
    ----------
    line, tool, cutting : (N,) of the moves.
    start, end : (N, 2) of the axis; of a box its corners.
    bulge, tip_first, tip_last : (N,).
    cylinder : (N, 3) low, high and radius.
    box : (N,) whether everything inside the box of the ends counts.
    """

    line: NDArray[np.int64]
    tool: NDArray[np.int64]
    cutting: NDArray[np.bool_]
    start: NDArray[np.float64]
    end: NDArray[np.float64]
    bulge: NDArray[np.float64]
    tip_first: NDArray[np.float64]
    tip_last: NDArray[np.float64]
    cylinder: NDArray[np.float64]
    box: NDArray[np.bool_]


@frozen(repr=False, field_transformer=name_number_fields)
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
    stock : what the part is cut from, on which alone forces act; None where a file does not say.
    is_placed : whether forces are those on a part already.

    Raises
    ------
    InputError
        For a tool that is not known, and numbers that cannot be.
    """

    name: str
    sha256: str
    unit: str
    zero: tuple[float, float]
    z_zero: float = field(converter=convert_real)
    clearance: float = field(default=1.0, converter=convert_real)
    rapid: Literal["straight", "box"] = "straight"
    tools: Mapping[int, Tool] = field(factory=dict, converter=read_tool_table, hash=False)
    moves: Moves = field(factory=lambda: Moves.of_rows(()))
    skipped: tuple[int, ...] = field(default=(), converter=lines_of)
    notes: tuple[str, ...] = field(default=(), converter=notes_of)
    forces: CuttingForces | None = None
    stock: Stock | None = field(factory=Stock)
    is_placed: bool = field(default=False, eq=False)

    def __attrs_post_init__(self) -> None:
        if self.unit not in UNITS or self.rapid not in WAYS:
            raise InputError(
                f"the unit of a program is {' or '.join(UNITS)}, and its rapid moves are {' or '.join(WAYS)}."
            )
        for what, value in (("zero", self.zero[0]), ("zero", self.zero[1]), ("z_zero", self.z_zero)):
            if not isfinite(value):
                raise InputError(f"{what} of the program is no place: give a length in mm.")
            refuse_long(f"{what} of the program", value)
        if not 0.0 <= self.clearance < inf:
            raise InputError(f"the clearance {self.clearance:g} cannot be used: give 0 or more, in mm.")
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
        start: Sequence[float] | None = None,
        whole_numbers: Literal["units", "thousandths"] = "units",
        stock: Stock | Mapping[str, Any] | str | None = None,
    ) -> Program:
        """Reads a program of RS-274 (G-code).

        Parameters
        ----------
        path : of the program.
        tools : file of a tool table, or a diameter or a :class:`Tool` for each number; what the program
            itself says of its tools if None.
        zero : where the program's X0 Y0 is on the part, in mm.
        z_zero : height of its Z0 in mm, or which side of the part that is.
        thickness : of the part in mm, where Z0 is its top.
        clearance : in mm.
        rapid : whether rapid moves are straight.
        unit : ``mm`` or ``inch`` where the program does not say.
        cutting : how tools cut of which the table does not say it, for the forces on the part:
            :class:`workhold.model.cutting_tool.CuttingData`, or its fields by name.
        start : where the tip is at the start, X, Y and Z in mm from the program's own zero; None where the
            program says it.
        whole_numbers : what a length without a decimal point counts: ``units``, or ``thousandths``, which are
            0.001 mm or 0.0001 inch.
        stock : what the part is cut from, as a :class:`workhold.model.stock.Stock`, or its ``side``, ``top``
            and ``shape`` by name; 5 mm around the outline and on top if None.

        Raises
        ------
        InputError
            With the line of what cannot be read, and with tools that are called and not known. With what is
            lacking for forces that are asked for, too.
        """
        from workhold.files.program.reader import read_program

        return read_program(
            path,
            tools,
            zero=zero,
            z_zero=z_zero,
            thickness=thickness,
            clearance=clearance,
            rapid=rapid,
            unit=unit,
            cutting=cutting,
            start=start,
            whole_numbers=whole_numbers,
            stock=stock,
        )

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
        row, cylinder = self.pairs()
        for start in range(0, len(row), AT_ONCE):
            part = slice(start, start + AT_ONCE)
            yield from self.pieces_of(row[part], cylinder[part], low, high)

    def pieces_of(
        self, row: NDArray[np.int64], cylinder: NDArray[np.float64], low: float, high: float
    ) -> Iterator[SweptPiece]:
        """The swept pieces of moves (N,) with cylinders (N, 3), see :meth:`pairs`, at some heights."""
        found = self.arrays_of(row, cylinder, low, high)
        rows = zip(*(one.tolist() for one in found), strict=True)
        for line, tool, cutting, (x, y), (to_x, to_y), span, tip, to_tip, shape, filled in rows:
            lower, upper, radius = shape
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

    def arrays_of(
        self, row: NDArray[np.int64], cylinder: NDArray[np.float64], low: float, high: float
    ) -> SweptArrays:
        """What :meth:`pieces_of` yields, as arrays."""
        moves = self.moves
        first_low, last_high = low - cylinder[:, 1], high - cylinder[:, 0]
        start, end, bulge = moves.start[row], moves.end[row], moves.bulge[row]
        box = self.boxed()[row]
        first, last = find_shares_between_heights(start[:, 2], end[:, 2], first_low, last_high)
        inside = first <= last
        first, last = np.where(box, 0.0, first), np.where(box, 1.0, last)
        kept = np.flatnonzero(inside)
        row, cylinder, box = row[kept], cylinder[kept], box[kept]
        start, end, bulge, first, last = start[kept], end[kept], bulge[kept], first[kept], last[kept]
        rise = end[:, 2] - start[:, 2]
        return SweptArrays(
            line=moves.line[row],
            tool=moves.tool[row],
            cutting=moves.cutting[row],
            start=along(start[:, :2], end[:, :2], bulge, first),
            end=along(start[:, :2], end[:, :2], bulge, last),
            bulge=compute_bulges_of_shares(bulge, last - first),
            tip_first=np.where(first == 0.0, start[:, 2], start[:, 2] + first * rise),
            tip_last=np.where(last == 1.0, end[:, 2], start[:, 2] + last * rise),
            cylinder=cylinder,
            box=box,
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

    def pressing_on(self, loops: Sequence[NDArray[np.float64]]) -> Program:
        """The program with forces only on the stretches of moves on which a tool meets the stock of a part.

        Parameters
        ----------
        loops : the part's outer loops, (N, 3) vertices x, y in mm and bulge.
        """
        if self.forces is None or self.stock is None or self.is_placed:
            return self
        border, acts = self.stock.border(loops), self.forces.acts
        forces = self.forces.along(find_stretches_in_stock(self.moves, self.tools, self.stock, border, acts))
        return evolve(self, forces=forces, is_placed=True)

    def to_dict(self) -> dict[str, Any]:
        """Plain data as in a result file."""
        return {**self.head(), "pieces": list(self.iter_entries())}

    def iter_entries(self) -> Iterator[dict[str, Any]]:
        """Yields all swept pieces as in a result file, with the forces of their moves."""
        pieces = (piece.to_dict() for piece in self.iter_swept(-inf, inf))
        if self.forces is None:
            yield from pieces
            return
        for piece, move in zip(pieces, self.pairs()[0].tolist(), strict=True):
            yield piece | self.forces.entry(move)

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
            **self.pressing(),
        }

    def pressing(self) -> dict[str, Any]:
        """What is said of forces on the part, as plain data; nothing without any."""
        if self.forces is None:
            return {}
        stock = {} if self.stock is None else {"stock": self.stock.to_dict()}
        return {**stock, "forces": self.forces.to_dict(self.moves, self.tools)}

    @classmethod
    def of_entries(cls, entries: Mapping[str, Any]) -> Program:
        """A program of a file's entries; feeds and speeds are not known of it.

        Pieces may be entries, or packed as :func:`workhold.model.moves.pack_piece` does.

        Raises
        ------
        InputError, LookupError, TypeError, ValueError
            For entries that lack something, or hold what cannot be.
        """
        tools = {int(key): Tool.of_entries(int(key), value) for key, value in entries["tools"].items()}
        x, y = (convert_real(value) for value in entries["zero"])
        rows, said, stock = entries["pieces"], entries.get("forces"), entries.get("stock")
        moves = moves_of([one if isinstance(one, bytes) else pack_piece(one) for one in rows], tools)
        # A move has a piece for each cylinder of its tool, all with the same force; packed ones have none.
        each = np.array([len(tools[number].cylinders) for number in moves.tool.tolist()], np.int64)
        first = [rows[place] for place in (np.cumsum(each) - each).tolist()]
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
            stock=None if stock is None else Stock.of_entries(stock),
            is_placed=True,
        )
