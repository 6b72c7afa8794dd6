"""The forces that the tools of a program require of a fixture: the jaw force that keeps all contacts, and the
peg forces.

The peg forces are those of ``statics.loads``: f = f0 + F h, with f0 linear in the load. So the jaw force
below which peg i lets go, -f0_i / h_i, is linear in the load as well. ``statics.list_path_forces`` has the
worst place of the path for both.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import ceil, floor, inf, log10
from typing import Any

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.fixels.toolkit import Toolkit
from workhold.model.cutting_forces import CUT_KINDS, MILLING
from workhold.model.fixture_table import FixtureTable, compute_peg_places
from workhold.model.moves import MoveStretches
from workhold.model.program import Program
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import ContactMatrices, TouchableFeatures
from workhold.statics.loads import compute_forces_with_jaw_stiffness, read_jaw_stiffness
from workhold.statics.path_forces import list_path_forces
from workhold.statics.program_clearance import name_element, rename_element
from workhold.units import Unit

__all__ = ["AskedForce", "CuttingNeed", "compute_cutting_figures", "find_cutting_need", "find_cutting_needs"]

Array = NDArray[np.float64]
# Fixtures looked at together.
BLOCK = 1 << 12


@frozen
class CutStretch:
    """The cutting part of one move; lengths in mm.

    Parameters
    ----------
    kind : kind of cut, one of ``model.cutting_forces.CUT_KINDS``.
    start, end : positions of the tool's tip at the beginning and the end of the cut, from the program's own
        zero.
    length : length over which the move cuts, all stretches together.
    whole : length of the move.
    name : name of the tool; empty without one.
    """

    kind: str
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    length: float
    whole: float
    name: str = ""

    def describe(self, unit: Unit) -> str:
        """Return a phrase that describes the cut and its place, to follow the tool's number.

        Examples
        --------
        >>> from workhold.units import MILLIMETRE
        >>> CutStretch("milling", (-11, 20, -2), (131, 20, -2), 142, 200, "face mill").describe(MILLIMETRE)
        'face mill, milling from X-11 Y20 Z-2 to X131 Y20 Z-2, 142 of 200 mm'
        >>> CutStretch("drilling", (20, 20, 5), (20, 20, -17), 22, 24).describe(MILLIMETRE)
        'drilling at X20 Y20 from Z5 to Z-17, 22 of 24 mm'
        """

        def format_place(axes: str, values: Sequence[float]) -> str:
            """Return coordinates as words of a program, such as "X20 Y20 Z5"."""
            numbers = (format_length(value, unit) for value in values)
            return " ".join(f"{axis}{number}" for axis, number in zip(axes, numbers, strict=True))

        upright = self.start[:2] == self.end[:2]
        if upright and self.kind != CUT_KINDS[MILLING]:
            x_y, (low, high) = (
                format_place("XY", self.start[:2]),
                (format_place("Z", one[2:]) for one in (self.start, self.end)),
            )
            where = f"at {x_y} from {low} to {high}"
        else:
            where = f"from {format_place('XYZ', self.start)} to {format_place('XYZ', self.end)}"
        far = f"{format_length(self.length, unit)} of {format_length(self.whole, unit)} {unit.abbreviation}"
        if self.length >= self.whole * (1.0 - 1e-9):
            far = f"all {format_length(self.whole, unit)} {unit.abbreviation}"
        return f"{self.name + ', ' if self.name else ''}{self.kind} {where}, {far}"


def format_length(value: float, unit: Unit) -> str:
    """Return a length in mm as a number in the given unit, without trailing zeros, as programs write it.

    >>> from workhold.units import INCH, MILLIMETRE
    >>> format_length(20.0, MILLIMETRE), format_length(-0.00001, MILLIMETRE), format_length(25.4, INCH)
    ('20', '0', '1')
    """
    return f"{round(value / unit.millimetres, 2 if unit.millimetres == 1 else 3) + 0.0:.10g}"


@frozen
class AskedForce:
    """A force that a program requires, and where.

    Parameters
    ----------
    force : in N.
    line, tool : line and tool number of the program's move that requires the force; None where the force is
        the same without any tool.
    element : the contact concerned, such as "peg L-A1"; None where no tool pushes the part off a contact.
    done : the cutting part of the move that requires the force; None where not known.
    """

    force: float
    line: int | None
    tool: int | None
    element: str | None
    done: CutStretch | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return force, line, tool and element as plain data, as in a result file."""
        return {name: getattr(self, name) for name in ("force", "line", "tool", "element")}

    def describe_place(self, unit: Unit) -> str:
        """Return a phrase with line and tool, and with the cut if it is known."""
        done = "" if self.done is None else f" ({self.done.describe(unit)})"
        return f"line {self.line}, T{self.tool}{done}"


@frozen
class CuttingNeed:
    """Forces that the tools of a program require of one fixture.

    Parameters
    ----------
    jaw : the jaw force at which no contact lets go along the whole path, and the contact that lets go first
        below it.
    contact : the largest force of a contact at ``jaw_force``, and that contact.
    jaw_force : the given jaw force in N or, where none is given, the required one.
    room : given minus required jaw force, in N; None where none is given.
    """

    jaw: AskedForce
    contact: AskedForce
    jaw_force: float
    room: float | None

    def to_dict(self) -> dict[str, Any]:
        """Return everything as plain data, as in a result file."""
        asked = {"jaw": self.jaw.to_dict(), "contact": self.contact.to_dict()}
        return asked | {"jaw_force": self.jaw_force, "room": self.room}

    def rename_holes(self, before: Sequence[str], after: Sequence[str]) -> CuttingNeed:
        """Return a copy with the holes of elements renamed: ``before[k]`` becomes ``after[k]``."""

        def rename_hole(asked: AskedForce) -> AskedForce:
            """Return a force whose element has its hole renamed."""
            return evolve(asked, element=asked.element and rename_element(asked.element, before, after))

        return evolve(self, jaw=rename_hole(self.jaw), contact=rename_hole(self.contact))

    def list_sentences(self, mover: str, unit: Unit, movers: int = 1) -> list[str]:
        """Return sentences for a machinist on the required forces.

        Parameters
        ----------
        mover : name of the carrier that presses, such as "jaw".
        unit : unit of the forces.
        movers : number of jaws or clamps that press; the force of two is that of both together.

        Examples
        --------
        >>> from workhold.units import MILLIMETRE
        >>> need = CuttingNeed(
        ...     AskedForce(2050.2, 412, 3, "peg R-A1"), AskedForce(3500, 412, 3, "peg L-A1"), 3000, 949.8
        ... )
        >>> for sentence in need.list_sentences("jaw", MILLIMETRE):
        ...     print(sentence)
        Jaw force at least 2.1 kN, asked for by line 412, T3: with less the part leaves peg R-A1.
        The 3000 N given leave 949 N of room.
        With 3000 N peg L-A1 presses with up to 3.5 kN, in line 412, T3.
        """
        if self.jaw.line is None:
            return [f"The tools of the program push the part off nothing, at any {mover} force."]
        name = mover[:1].upper() + mover[1:] + " force" + " of both together" * (movers > 1)
        said = [
            f"{name} at least {round_force_up(self.jaw.force, unit)}, asked for by {self.jaw.describe_place(unit)}: "
            f"with less the part leaves {self.jaw.element}."
        ]
        if self.room is not None:
            given = unit.format_force(self.jaw_force)
            if self.room >= 0.0:
                said.append(
                    f"The {given} given leave {unit.format_force(round_force_down(self.room))} of room."
                )
            else:
                lacking = f"{unit.format_force_rounded_up(-self.room)} {unit.force}"
                said.append(f"The {given} given are {lacking} too little.")
        most = round_force_up(self.contact.force, unit)
        same = (self.contact.line, self.contact.tool) == (self.jaw.line, self.jaw.tool)
        # The cut is described once, with the first force.
        at = f"in {(evolve(self.contact, done=None) if same else self.contact).describe_place(unit)}"
        if self.contact.line is None:
            at = "whatever the tools do"
        with_ = f"With {unit.format_force(self.jaw_force)} {self.contact.element}"
        said.append(f"{with_} presses with up to {most}, {at}.")
        return said


def round_force_up(force: float, unit: Unit) -> str:
    """Return a force in N as text in the given unit, rounded up to two significant figures.

    >>> from workhold.units import INCH, MILLIMETRE
    >>> round_force_up(2050.2, MILLIMETRE), round_force_up(312.0, MILLIMETRE), round_force_up(2050.2, INCH)
    ('2.1 kN', '320 N', '470 lbf')
    """
    value = force / unit.newtons
    if value <= 0.0:
        return f"0 {unit.force}"
    step = 10.0 ** (floor(log10(value)) - 1)
    up = ceil(value / step * (1.0 - 1e-12)) * step
    return f"{up / 1000:.2g} kN" if unit.force == "N" and up >= 1000 else f"{up:.0f} {unit.force}"


def round_force_down(force: float) -> float:
    """Return a force in N rounded down to whole newtons; below 1 N unchanged."""
    return float(floor(force)) if force >= 1.0 else force


def compute_cutting_figures(matrices: ContactMatrices, touched: TouchableFeatures, program: Program) -> Array:
    """Return (load reaction, required jaw force) in N of N fixtures along a program, (N, 2); at least 0.

    NaN where the contact matrix has no inverse.
    """
    known = np.flatnonzero(np.isfinite(matrices.inverses).all(axis=(1, 2)))
    out = np.full((len(matrices.inverses), 2), np.nan)
    inverses, held = matrices.inverses[known], matrices.inverses[known, 3]
    path = list_path_forces(program, get_center(touched))
    for start in range(0, len(known), BLOCK):
        part = slice(start, start + BLOCK)
        rows = known[part]
        free = np.swapaxes(inverses[part, :3], 1, 2) / make_scale(touched)
        out[rows, 0] = path.find_worst(make_reaction_functions(free, held[part])).value
        locked = compute_forces_with_jaw_stiffness(free, matrices.closing[rows], inf)
        out[rows, 1] = path.find_worst(-locked / held[part, :, None]).value
    return out


def get_center(touched: TouchableFeatures) -> tuple[float, float]:
    """Return the centre of the part (x, y) in mm, about which moments are taken."""
    return float(touched.center[0]), float(touched.center[1])


def make_scale(touched: TouchableFeatures) -> Array:
    """Return (1, 1, L): dividing the columns of inverse contact matrices by it makes them apply to moments in
    N mm.
    """
    return np.array([1.0, 1.0, touched.length])


def make_reaction_functions(free: Array, held: Array) -> Array:
    """Return P (P - 1) linear functions of the load for each fixture, (N, P (P - 1), 3).

    The largest of their values is the load reaction.

    Parameters
    ----------
    free : (N, P, 3) peg forces per unit of load with a jaw that keeps its force.
    held : (N, P) peg forces per unit of jaw force.
    """
    count = held.shape[1]
    one, other = np.nonzero(~np.eye(count, dtype=bool))
    ratio = held[:, one] / held[:, other]
    found: Array = free[:, one] - ratio[..., None] * free[:, other]
    return found


def find_cutting_needs(
    table: FixtureTable,
    workpiece: Workpiece,
    toolkit: Toolkit,
    program: Program,
    jaw_force: float | None,
    jaw: str | float = "screw",
) -> list[CuttingNeed | None]:
    """Return the forces that the tools of a program require of each fixture of a table; None if forces are
    not known.

    Parameters
    ----------
    jaw_force : force in N with which the vise is closed; None to take the required one.
    jaw : kind or stiffness of the jaw, see :func:`workhold.statics.loads.read_jaw_stiffness`.
    """
    touched, carriers = (
        TouchableFeatures.from_workpiece(workpiece, toolkit),
        toolkit.find_peg_carriers(table.arrangement),
    )
    pegs = np.stack(compute_peg_places(table, toolkit, workpiece), axis=2)
    pose = np.column_stack([table.theta, table.position])
    matrices = touched.compute_contact_matrices(pegs, pose, carriers, table.face.astype(np.int64))
    path = list_path_forces(program, get_center(touched))
    named = partial(find_asked_force, table, toolkit, program)
    known = np.flatnonzero(np.isfinite(matrices.inverses).all(axis=(1, 2)))
    out: list[CuttingNeed | None] = [None] * len(table)
    for start in range(0, len(known), BLOCK):
        rows = known[start : start + BLOCK]
        held = matrices.inverses[rows, 3]
        free = np.swapaxes(matrices.inverses[rows, :3], 1, 2) / make_scale(touched)
        own = compute_forces_with_jaw_stiffness(free, matrices.closing[rows], read_jaw_stiffness(jaw))
        need = path.find_worst(-own / held[..., None])
        force = need.value if jaw_force is None else np.full(len(rows), float(jaw_force))
        # Each contact by itself, because each has its own share of the jaw force.
        each = path.find_worst(own.reshape(-1, 1, 3))
        total = each.value.reshape(held.shape) + force[:, None] * held
        largest = total.argmax(axis=1)
        at = each.move.reshape(held.shape)[np.arange(len(rows)), largest]

        for k, row in enumerate(rows.tolist()):
            out[row] = CuttingNeed(
                jaw=named(row, float(need.value[k]), int(need.move[k]), int(need.which[k])),
                contact=named(row, float(total[k, largest[k]]), int(at[k]), int(largest[k])),
                jaw_force=float(force[k]),
                room=None if jaw_force is None else float(jaw_force - need.value[k]),
            )
    return out


def find_asked_force(
    table: FixtureTable, toolkit: Toolkit, program: Program, row: int, value: float, move: int, contact: int
) -> AskedForce:
    """Return a force of ``value`` N with the move that requires it and
    the contact concerned, for fixture ``row``.

    Line and tool are None where ``move`` is -1, the element is None where ``contact`` is -1.
    """
    name = None if contact < 0 else name_element(table, toolkit, row, contact)
    if move < 0:
        return AskedForce(value, None, None, name)
    moves = program.moves
    return AskedForce(
        value, int(moves.line[move]), int(moves.tool[move]), name, find_cut_of_move(program, move)
    )


def find_cut_of_move(program: Program, move: int) -> CutStretch | None:
    """Return the cutting part of a move, by its index; None where the program has no forces."""
    forces, moves = program.forces, program.moves
    if forces is None:
        return None
    own = np.flatnonzero(forces.stretches.move == move)
    some = forces.stretches
    parts = moves.cut_into_stretches(MoveStretches(some.move[own], some.first[own], some.last[own]))
    shift = np.array([*program.zero, program.z_zero])

    def map_to_program(point: Array) -> tuple[float, float, float]:
        """Return a point of the part's frame as a position from the program's own zero, in mm."""
        x, y, z = (point - shift).tolist()
        return x, y, z

    return CutStretch(
        CUT_KINDS[forces.kind[move]],
        map_to_program(parts.start[0]),
        map_to_program(parts.end[-1]),
        float(parts.length.sum()),
        float(moves.length[move]),
        program.tools[int(moves.tool[move])].name,
    )


def find_cutting_need(
    result: Result, index: int, jaw_force: float | None = None, jaw: str | float = "screw"
) -> CuttingNeed | None:
    """Return the forces that the tools of a result's program require of fixture ``index``.

    None without cutting forces, and for toolkits that hold by friction.

    Parameters
    ----------
    jaw_force : in N; None for that of the result's query.
    jaw : kind or stiffness of the jaw, see :func:`workhold.statics.loads.read_jaw_stiffness`.
    """
    program = result.query.program
    if program is None or program.forces is None or result.toolkit.holds_by_friction:
        return None
    force = result.query.jaw_force if jaw_force is None else jaw_force
    row = result.table.take(slice(index, index + 1))
    return find_cutting_needs(row, result.workpiece, result.toolkit, program, force, jaw)[0]
