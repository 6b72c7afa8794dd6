"""Forces that a program's tools ask of a fixture, by a walk along its moves with bounds.

All moves are walked, not those that remain in the search. A value a g_x + b g_y + c m that is linear in the
load (force g, moment m) has at a place p of the tip, for the worst direction of the force, a largest value
V(p); see :meth:`ForceWalk.evaluate_at`. Moves are grouped in blocks, with a circle around each block. V
changes by at most F |c| per mm, F being the force. Blocks that cannot hold the greatest value are left out.
On an arc of radius r the value of each direction has a second derivative of at most

    M = F (3 |c| r + u)

in the angle, u being the size of the force's coefficients there: the derivatives of the place and of the
direction are at most r and 1. So on a stretch of angle w, V is at most M w^2 / 8 above the greater of its
values at the ends. Stretches are halved until this bound is close enough. Numbers are doubles: the rounding
and the uncertainty of the coefficients are added to the result. The forces that a file states are compared
with these.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from math import pi
from typing import Any

import numpy as np
from attrs import frozen
from flint import arb
from numpy.typing import NDArray

from workhold.model.cutting_forces import CuttingForces
from workhold.model.fixture import Fixture
from workhold.model.program import Program
from workhold.model.query import Query
from workhold.verification.contacts import Balance, bound_relative_error
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.seat import SeatBalance
from workhold.verification.tolerances import Finding, judge_written_number
from workhold.verification.tool_walk import ToolWalk, make_element_name, make_walk

__all__ = ["ForceWalk", "make_force_walk", "judge_program_forces"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Moves in a block, parts of the value to which it is worked out, and of the sizes by which it is rounded.
RUN, FINE, ROUNDED = 64, 1e-10, 1e-13
MOST_HALVINGS = 60
# Radians: half the range of directions about against the feed.
SIXTY = pi / 3


@frozen(eq=False)
class ForceWalk:
    """The R stretches of a program's moves on which tools press on the part, in B blocks of successive
    stretches.

    Parameters
    ----------
    walk : paths of the moves.
    forces : forces on all moves, and the stretches.
    move : (R,) for each stretch, the number of the move that it belongs to.
    first : (B,) for each block, the index of its first stretch.
    center, reach : (B, 2) and (B,) centre and radius of a circle around each block, in mm.
    force, torque : (B,) the largest of each block.
    far : largest distance in mm of a point of the path from the part's origin.
    """

    walk: ToolWalk
    forces: CuttingForces
    move: IntArray
    first: IntArray
    center: Array
    reach: Array
    force: Array
    torque: Array
    far: float

    @classmethod
    def from_program(cls, program: Program, forces: CuttingForces) -> ForceWalk:
        """Return the walk over the stretches that press on the part, grouped
        into blocks of ``RUN`` stretches.
        """
        walk, stretches = make_walk(program), forces.stretches
        move = stretches.move
        first = np.arange(0, len(move), RUN)
        ends = [walk.compute_places_at(move, share) for share in (stretches.first, stretches.last)]
        bulging = np.where(walk.is_round[move], walk.radius[move], 0.0)[:, None]
        middle = np.where(walk.is_round[move, None], walk.center[move], ends[0])
        low = np.minimum(np.minimum(*ends), middle - bulging)
        high = np.maximum(np.maximum(*ends), middle + bulging)
        lows = np.array([low[k : k + RUN].min(axis=0) for k in first]).reshape(-1, 2)
        highs = np.array([high[k : k + RUN].max(axis=0) for k in first]).reshape(-1, 2)
        far = np.maximum(np.abs(lows), np.abs(highs))
        return cls(
            walk,
            forces,
            move,
            first,
            (lows + highs) / 2,
            np.hypot(*(highs - lows).T) / 2,
            np.array([forces.force[move[k : k + RUN]].max() for k in first]),
            np.array([forces.torque[move[k : k + RUN]].max() for k in first]),
            float(np.hypot(*far.T).max(initial=0.0)),
        )

    def find_worst(
        self, a: arb, b: arb, c: arb, known: float = 0.0, line: object = None, tool: object = None
    ) -> arb:
        """Return the largest value of a g_x + b g_y + c m over all tool forces along the path, or ``known``
        if larger.

        (g_x, g_y) is the force of a tool in N, and m its moment about the part's origin in N mm. The result
        is NaN if a, b or c is not finite.

        Parameters
        ----------
        known : a value of 0 or more (0 is that of an idle tool); only larger ones are sought.
        line, tool : the program line and tool number whose moves are searched; ``line`` None searches all
            moves.
        """
        if not all(one.is_finite() for one in (a, b, c)):
            return arb(float("nan"))
        middle = float(a.mid()), float(b.mid()), float(c.mid())
        off = [float(one.rad()) for one in (a, b, c)]
        if line is None:
            found, most = self.find_largest(*middle, known), float(self.force.max(initial=0.0))
        else:
            moves = self.walk.program.moves
            own = (moves.line[self.move] == line) & (moves.tool[self.move] == tool)
            found, most = (
                self.find_largest_on_stretches(np.flatnonzero(own), *middle, known),
                float(self.force.max(initial=0.0)),
            )
        turning = float(self.torque.max(initial=0.0)) + most * self.far
        spare = most * (off[0] + off[1]) + turning * off[2]
        size = most * (abs(middle[0]) + abs(middle[1])) + turning * abs(middle[2])
        return arb(found, spare + ROUNDED * size + FINE * found)

    def find_largest(self, a: float, b: float, c: float, known: float) -> float:
        """Return the largest value of a g_x + b g_y + c m over all blocks, or ``known`` if larger.

        Blocks with the largest bounds are searched first.
        """
        x, y = a - self.center[:, 1] * c, b + self.center[:, 0] * c
        bounds = self.force * (np.hypot(x, y) + abs(c) * self.reach) + abs(c) * self.torque
        found = known
        for block in np.argsort(-bounds):
            if bounds[block] <= found:
                break
            rows = np.arange(self.first[block], min(self.first[block] + RUN, len(self.move)))
            found = self.find_largest_on_stretches(rows, a, b, c, found)
        return found

    def find_largest_on_stretches(self, rows: IntArray, a: float, b: float, c: float, found: float) -> float:
        """Return the largest value of a g_x + b g_y + c m on the stretches with indices ``rows``, or
        ``found`` if larger.

        The relative error of the result is at most ``FINE``.
        """
        moves, low, high = (
            self.move[rows],
            self.forces.stretches.first[rows],
            self.forces.stretches.last[rows],
        )
        ends = [self.evaluate_at(moves, share, a, b, c) for share in (low, high)]
        found = max(found, float(np.maximum(*ends).max(initial=0.0)))
        round_ = self.walk.is_round[moves] & (self.forces.force[moves] > 0.0)
        moves, low, high = moves[round_], low[round_], high[round_]
        before, after = (values[round_] for values in ends)
        for _ in range(MOST_HALVINGS):
            if not len(moves):
                break
            radius, (x, y) = self.walk.radius[moves], self.walk.center[moves].T
            size = np.hypot(a - y * c, b + x * c) + abs(c) * radius
            turned = np.abs(self.walk.sweep[moves]) * (high - low)
            bent = self.forces.force[moves] * (3.0 * abs(c) * radius + size)
            kept = np.maximum(before, after) + bent * turned * turned / 8.0 > found * (1.0 + FINE) + 1e-300
            moves, low, high, before, after = (one[kept] for one in (moves, low, high, before, after))
            middle = (low + high) / 2
            values = self.evaluate_at(moves, middle, a, b, c)
            found = max(found, float(values.max(initial=0.0)))
            moves = np.concatenate([moves, moves])
            low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
            before, after = np.concatenate([before, values]), np.concatenate([values, after])
        return found

    def evaluate_at(self, moves: IntArray, share: Array, a: float, b: float, c: float) -> Array:
        """Return for each of R moves the largest value (R,) of a g_x + b g_y + c m over all allowed load
        directions.

        The tool is at the given share (0 to 1) of each move. At a place p the value is (a - p_y c, b + p_x c)
        times the force vector, so the worst direction is the allowed one nearest to that vector. The torque T
        adds |c| T, because the tool may turn either way.
        """
        x, y = self.walk.compute_places_at(moves, share).T
        x, y = a - y * c, b + x * c
        size, apart = np.hypot(x, y), np.zeros(len(moves))
        if self.forces.direction == "feed":
            move = self.walk.program.moves
            chord = move.end[moves, :2] - move.start[moves, :2]
            heading = np.arctan2(chord[:, 1], chord[:, 0]) + self.walk.sweep[moves] * (share - 0.5)
            off = np.abs(np.angle(np.exp(1j * (np.arctan2(y, x) - heading - pi))))
            apart = np.maximum(off - SIXTY, 0.0)
        return np.asarray(
            self.forces.force[moves] * size * np.cos(apart) + self.forces.torque[moves] * abs(c)
        )


@lru_cache(maxsize=8)
def make_force_walk(program: Program) -> ForceWalk | None:
    """Return the walk along a program with its forces; None if the program has no forces. The result is
    cached.
    """
    return None if program.forces is None else ForceWalk.from_program(program, program.forces)


KEYS = ("jaw", "contact", "jaw_force", "room")
ASKED = ("force", "line", "tool", "element")
# Coefficients of the load (g_x, g_y, moment), and of the jaw force.
Row = tuple[arb, arb, arb]


def judge_program_forces(
    fixture: Fixture,
    query: Query,
    hardware: ToolkitRules,
    balance: Balance | SeatBalance,
) -> Iterator[Finding]:
    """Yield a finding for each program force in a fixture's file entry that differs from the derived one."""
    said, walk = fixture.asking, None if query.program is None else make_force_walk(query.program)
    if walk is None or said is None:
        if said is not None:
            yield Finding(True, "the forces of its program are given, and the program has none")
        return
    if fault := find_entry_fault(said):
        yield Finding(True, f"the forces of its program {fault}")
        return
    if balance.inverse is None:
        return
    locked = [
        [a - k for a, k in zip(row, balance.project_on_closing(row), strict=True)]
        for row in balance.responses
    ]
    each: list[Row] = [(x, y, m) for x, y, m in zip(*locked, strict=True)]
    asked: list[Row] = [
        (-x / force, -y / force, -m / force) for (x, y, m), force in zip(each, balance.forces, strict=True)
    ]
    spare = bound_relative_error(balance.forces)
    names = [make_element_name(peg, hardware) for peg in fixture.pegs]
    need = find_largest_or_zero(walk.find_worst(*row) for row in asked)
    yield from judge_written_number(
        "the jaw force of its program", said["jaw"]["force"], need, spare * abs(need)
    )
    force = need if query.jaw_force is None else arb(query.jaw_force)
    yield from judge_written_number(
        "the jaw force stated with it", said["jaw_force"], force, spare * abs(force)
    )
    if (said["room"] is None) != (query.jaw_force is None):
        yield Finding(True, "the room of its jaw force is given without one, or missing with one")
    elif said["room"] is not None:
        yield from judge_written_number(
            "the room of its jaw force", said["room"], force - need, spare * abs(need)
        )
    share = [force * own for own in balance.forces]
    total = find_largest_or_zero(walk.find_worst(*row) + own for row, own in zip(each, share, strict=True))
    yield from judge_written_number(
        "the largest force of a contact", said["contact"]["force"], total, spare * abs(total)
    )
    none = [arb(0)] * len(names)
    for key, functions, own, worst in (("jaw", asked, none, need), ("contact", each, share, total)):
        yield from judge_place(said[key], walk, names, functions, own, worst, spare)


def find_entry_fault(said: Any) -> str:
    """Return a description of the fault in the form of a program-force entry; "" if there is none.

    The words follow "the forces of its program" in a message.
    """
    if not isinstance(said, dict) or any(key not in said for key in KEYS):
        return f"do not have {', '.join(KEYS)}"
    if any(not isinstance(said[key], dict) or any(one not in said[key] for one in ASKED) for key in KEYS[:2]):
        return f"do not say {', '.join(ASKED)}"
    numbers = [said["jaw"]["force"], said["contact"]["force"], said["jaw_force"]]
    numbers += [] if said["room"] is None else [said["room"]]
    if any(isinstance(one, bool) or not isinstance(one, int | float) for one in numbers):
        return "are not numbers"
    return ""


def judge_place(
    said: dict[str, Any],
    walk: ForceWalk,
    names: Sequence[str],
    functions: Sequence[Row],
    own: Sequence[arb],
    worst: arb,
    spare: arb,
) -> Iterator[Finding]:
    """Yield a finding if the line, tool and contact named in the file do not reach the worst value.

    Parameters
    ----------
    said : the file's entry, with "line", "tool" and "element" (the contact's name).
    names : names of the contacts.
    functions : for each contact the coefficients (a, b, c) of its force per unit of load.
    own : for each contact the value without any load.
    worst : the worst value as derived.
    spare : relative tolerance.
    """
    if said["line"] is None:
        return
    there = find_largest_or_zero(
        walk.find_worst(*row, 0.0, said["line"], said["tool"]) + held
        for name, row, held in zip(names, functions, own, strict=True)
        if name == said["element"]
    )
    if there < worst - spare * (1 + abs(worst)):
        yield Finding(
            True,
            f"T{said['tool']} in line {said['line']} is not where the program asks most of the "
            f"{said['element']}",
        )


def find_largest_or_zero(values: Iterator[arb]) -> arb:
    """Return the largest of some numbers and 0."""
    out = arb(0)
    for value in values:
        out = out.max(value)
    return out
