"""A program of the machine as the space that its tools sweep: pieces of the plane, each with heights and a
radius.

Glossary
--------
tool : upright cylinders on one axis, their heights above the tip; corners and points are taken as flat ends.
swept piece : a cylinder of a tool on one move: its axis runs along a path, at heights of the tip + [l, u].
rapid : a move at full speed (G0), which must not collide either; all other moves cut.
box : a rapid move that may take any way inside the box of its ends; its path is the filled border of the box.
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
from workhold.limits import convert_real, name_fields_in_errors, refuse_long
from workhold.model.cutting_forces import CuttingForces
from workhold.model.cutting_tool import CuttingData, Cylinder, Tool
from workhold.model.moves import (
    CUT,
    RAPID,
    MoveKind,
    Moves,
    PathVertex,
    SweptPiece,
    compute_bulges_of_shares,
    compute_path_points,
    find_shares_between_heights,
    make_box_path,
    pack_piece,
    unpack_moves,
)
from workhold.model.stock import Stock, find_stretches_in_stock

__all__ = ["Cylinder", "MoveKind", "PathVertex", "Program", "Stock", "SweptPiece", "Tool"]

WAYS = ("straight", "box")
# Pieces made at a time.
AT_ONCE = 1 << 13
UNITS = ("mm", "inch")


def read_tool_table(values: Mapping[int, Tool]) -> dict[int, Tool]:
    """Return a copy as a dict: tools by their numbers."""
    return dict(values)


def to_lines(values: Iterable[int]) -> tuple[int, ...]:
    """Return numbers of lines as a tuple."""
    return tuple(values)


def to_notes(values: Iterable[str]) -> tuple[str, ...]:
    """Return sentences as a tuple."""
    return tuple(values)


class SweptArrays(NamedTuple):
    """N swept pieces as arrays, see :class:`workhold.model.moves.SweptPiece`.

    Parameters
    ----------
    line, tool, cutting : (N,) line, tool number, and whether it cuts, of each piece's move.
    start, end : (N, 2) ends of the axis's path in mm; of a box two opposite corners.
    bulge, tip_first, tip_last : (N,) bulge of the path, and height of the tip at its start and end in mm.
    cylinder : (N, 3) low and high above the tip, and radius, in mm.
    box : (N,) True if the whole box of the ends counts as swept.
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


@frozen(repr=False, field_transformer=name_fields_in_errors)
class Program:
    """A program as it was read, in the part's coordinates and mm; z is 0 in the plane on which the part lies.

    Parameters
    ----------
    name : of its file.
    sha256 : of the file's bytes, in hexadecimal.
    unit : unit in which the program begins, ``mm`` or ``inch``.
    zero : (x, y) in mm on the part where the program has X0 Y0.
    z_zero : height in mm at which the program has Z0.
    clearance : distance in mm to keep between every cylinder of a tool and the fixture.
    rapid : ``straight``, or ``box`` if a control may take another way from end to end.
    tools : tools by number; at least those that the program uses.
    moves : in its order.
    skipped : lines with a move that was left out, such as one to a machine position.
    notes : sentences on statements that could be read in more than one way.
    forces : forces of the tools on the part for each move; None if they are not requested.
    stock : raw stock, within which alone forces act; None where a file does not say.
    is_placed : whether ``forces`` are already limited to the stock around a part.
    raised : by so many mm all heights are greater than those above the part, which lies so high in a raw
        block.

    Raises
    ------
    InputError
        For a tool that is not known, and impossible numbers.
    """

    name: str
    sha256: str
    unit: str
    zero: tuple[float, float]
    z_zero: float = field(converter=convert_real)
    clearance: float = field(default=1.0, converter=convert_real)
    rapid: Literal["straight", "box"] = "straight"
    tools: Mapping[int, Tool] = field(factory=dict, converter=read_tool_table, hash=False)
    moves: Moves = field(factory=lambda: Moves.from_rows(()))
    skipped: tuple[int, ...] = field(default=(), converter=to_lines)
    notes: tuple[str, ...] = field(default=(), converter=to_notes)
    forces: CuttingForces | None = None
    stock: Stock | None = field(factory=Stock)
    is_placed: bool = field(default=False, eq=False)
    raised: float = field(default=0.0, converter=convert_real)

    def __attrs_post_init__(self) -> None:
        if self.unit not in UNITS or self.rapid not in WAYS:
            raise InputError(
                f"the unit of a program is {' or '.join(UNITS)}, and its rapid moves are {' or '.join(WAYS)}."
            )
        for what, value in (("zero", self.zero[0]), ("zero", self.zero[1]), ("z_zero", self.z_zero)):
            if not isfinite(value):
                raise InputError(f"{what} of the program is not a place: give a length in mm.")
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
        """Return the program read from a file of RS-274 (G-code).

        Parameters
        ----------
        path : of the program.
        tools : file of a tool table, or a diameter or a :class:`Tool` for each number; if None, the tools
            described in the program's comments.
        zero : (x, y) in mm on the part where the program has X0 Y0.
        z_zero : height of Z0 in mm, or the side of the part, "top" or "bottom", on which Z0 is.
        thickness : thickness of the part in mm, needed if Z0 is its top.
        clearance : distance in mm that tools keep from the fixture.
        rapid : ``straight``, or ``box`` if a rapid move may run anywhere in the box of its ends.
        unit : ``mm`` or ``inch``, if the program does not give its unit.
        cutting : data on how tools cut, for the forces on the part, where the tool table does not have them:
            :class:`workhold.model.cutting_tool.CuttingData`, or its fields by name.
        start : (X, Y, Z) in mm of the tip at the start, from the program's own zero; None where the program
            says it.
        whole_numbers : what a length without a decimal point counts: ``units``, or ``thousandths`` (0.001 mm
            or 0.0001 inch).
        stock : raw stock of the part, as a :class:`workhold.model.stock.Stock`, or its ``side``, ``top`` and
            ``shape`` by name; 5 mm around the outline and on top if None.

        Raises
        ------
        InputError
            For text that cannot be read, with its line, for tools that are called and not known, and where
            something is missing that the forces asked for follow from.
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
        """All swept pieces, move by move: one for each cylinder of the move's tool."""
        return self.list_swept_pieces(-inf, inf)

    def list_swept_pieces(self, low: float, high: float) -> tuple[SweptPiece, ...]:
        """Return the pieces swept at heights in [low, high], each cut to the share of its move on which its
        cylinder is at these heights.

        Pieces never at such a height are left out. With the cylinder from l to u above the tip, a piece is
        cut at tip + l = ``high`` and at tip + u = ``low``; boxes are not cut.

        Parameters
        ----------
        low, high : in mm above the plane on which the part lies.
        """
        return tuple(self.iterate_swept_pieces(low, high))

    def iterate_swept_pieces(self, low: float, high: float) -> Iterator[SweptPiece]:
        """Yield the pieces of :meth:`list_swept_pieces`, making some thousands at a time."""
        row, cylinder = self.pair_moves_with_cylinders()
        for start in range(0, len(row), AT_ONCE):
            part = slice(start, start + AT_ONCE)
            yield from self.iterate_pieces(row[part], cylinder[part], low, high)

    def iterate_pieces(
        self, row: NDArray[np.int64], cylinder: NDArray[np.float64], low: float, high: float
    ) -> Iterator[SweptPiece]:
        """Yield the pieces swept at heights in [low, high] by
        cylinders (N, 3) on the moves with the indices ``row`` (N,).

        Both arrays are as from :meth:`pair_moves_with_cylinders`; pieces never at such a height are left out.
        """
        found = self.make_arrays(row, cylinder, low, high)
        rows = zip(*(one.tolist() for one in found), strict=True)
        for line, tool, cutting, (x, y), (to_x, to_y), span, tip, to_tip, shape, filled in rows:
            lower, upper, radius = shape
            path: tuple[PathVertex, ...]
            if filled:
                path = make_box_path((x, y), (to_x, to_y))
            elif (x, y) == (to_x, to_y):
                path = ((x, y, 0.0),)
            else:
                path = ((x, y, span), (to_x, to_y, 0.0))
            yield SweptPiece(
                line, tool, CUT if cutting else RAPID, path, (tip, to_tip), radius, (lower, upper)
            )

    def make_arrays(
        self, row: NDArray[np.int64], cylinder: NDArray[np.float64], low: float, high: float
    ) -> SweptArrays:
        """Return the pieces that :meth:`iterate_pieces` yields, as arrays, in the same order."""
        moves = self.moves
        first_low, last_high = low - cylinder[:, 1], high - cylinder[:, 0]
        start, end, bulge = moves.start[row], moves.end[row], moves.bulge[row]
        box = self.find_boxed_moves()[row]
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
            start=compute_path_points(start[:, :2], end[:, :2], bulge, first),
            end=compute_path_points(start[:, :2], end[:, :2], bulge, last),
            bulge=compute_bulges_of_shares(bulge, last - first),
            tip_first=np.where(first == 0.0, start[:, 2], start[:, 2] + first * rise),
            tip_last=np.where(last == 1.0, end[:, 2], start[:, 2] + last * rise),
            cylinder=cylinder,
            box=box,
        )

    def pair_moves_with_cylinders(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return (N,) move indices and (N, 3) cylinders: a row for each move and each cylinder of its tool,
        in the order of moves.

        Cylinders are low, high and radius in mm.
        """
        rows, cylinders = [np.zeros(0, np.int64)], [np.zeros((0, 3))]
        for number, tool in self.tools.items():
            moved = np.flatnonzero(self.moves.tool == number)
            table = np.array([(one.low, one.high, one.radius) for one in tool.cylinders])
            rows.append(np.repeat(moved, len(table)))
            cylinders.append(np.tile(table, (len(moved), 1)))
        row = np.concatenate(rows)
        order = np.argsort(row, kind="stable")
        return row[order], np.concatenate(cylinders)[order]

    def find_boxed_moves(self) -> NDArray[np.bool_]:
        """Return a mask (M,): True for rapid moves along two or three axes if ``rapid`` is "box". Their whole
        box counts as swept.
        """
        if self.rapid != "box":
            return np.zeros(len(self.moves), dtype=bool)
        moved = self.moves.start != self.moves.end
        boxed: NDArray[np.bool_] = ~self.moves.cutting & (moved.sum(axis=1) > 1)
        return boxed

    def keep_forces_on(self, loops: Sequence[NDArray[np.float64]]) -> Program:
        """Return the program with forces only on those stretches of moves on which a tool meets the stock.

        Return the program itself if it has no forces or no stock, or if its forces are already limited to a
        part.

        Parameters
        ----------
        loops : the part's outer loops, (N, 3) vertices x, y in mm and bulge.
        """
        if self.forces is None or self.stock is None or self.is_placed:
            return self
        border, acts = self.stock.make_border(loops), self.forces.acts
        forces = self.forces.keep_stretches(
            find_stretches_in_stock(self.moves, self.tools, self.stock, border, acts)
        )
        return evolve(self, forces=forces, is_placed=True)

    def to_dict(self) -> dict[str, Any]:
        """Return plain data as in a result file."""
        return {**self.make_head(), "pieces": list(self.iterate_entries())}

    def iterate_entries(self) -> Iterator[dict[str, Any]]:
        """Yield all swept pieces as entries of a result file, each with the forces of its move."""
        pieces = (piece.to_dict() for piece in self.iterate_swept_pieces(-inf, inf))
        if self.forces is None:
            yield from pieces
            return
        for piece, move in zip(pieces, self.pair_moves_with_cylinders()[0].tolist(), strict=True):
            yield piece | self.forces.make_entry(move)

    def make_head(self) -> dict[str, Any]:
        """Return the program as plain data as in a result file, without the pieces."""
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
            **({"raised": self.raised} if self.raised else {}),
            **self.describe_forces(),
        }

    def describe_forces(self) -> dict[str, Any]:
        """Return the entries "stock" and "forces" of a result file; {} without forces."""
        if self.forces is None:
            return {}
        stock = {} if self.stock is None else {"stock": self.stock.to_dict()}
        return {**stock, "forces": self.forces.to_dict(self.moves, self.tools)}

    @classmethod
    def from_entries(cls, entries: Mapping[str, Any]) -> Program:
        """Return a program from the entries of a result file; its feeds and spindle speeds are 0.

        Pieces may be entries, or packed as :func:`workhold.model.moves.pack_piece` does.

        Raises
        ------
        InputError, LookupError, TypeError, ValueError
            For entries that lack something, or hold impossible values.
        """
        tools = {int(key): Tool.from_entries(int(key), value) for key, value in entries["tools"].items()}
        x, y = (convert_real(value) for value in entries["zero"])
        rows, said, stock = entries["pieces"], entries.get("forces"), entries.get("stock")
        moves = unpack_moves([one if isinstance(one, bytes) else pack_piece(one) for one in rows], tools)
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
            forces=None if said is None else CuttingForces.from_entries(first, said),
            stock=None if stock is None else Stock.from_entries(stock),
            is_placed=True,
            raised=entries.get("raised") or 0.0,
        )
