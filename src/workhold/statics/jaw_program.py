"""The jaw force that the tools of a program require, for a part held between two flat jaws by friction.

A tool presses at a place of its path with a force in the plane, a force along its axis, and a torque either
way round. The jaw force is convex in the load (``statics.friction``), and for one force the load is affine in
the place. So for places in a box and directions in a range the worst loads are among finitely many: places at
the corners of the box; forces at both ends of the range, and at the point, a little outside, where the
tangents at these ends meet. Boxes and ranges are halved, the most promising first (branch and bound). This
ends when no corner needs more force than a single straight piece with a narrow range is known to need. Arcs
are cut into short ones, each inside the triangle of its chord and tangents. So no force is understated, and
the overstatement is less than 1 %.

Reference: A. H. Land, A. G. Doig, *An automatic method of solving discrete programming problems*,
Econometrica 28 (1960).
"""

from __future__ import annotations

from functools import cached_property
from heapq import heappop, heappush
from itertools import count, product
from math import ceil, cos, inf, pi, sin
from typing import Protocol

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.model.cutting_tool import ANY
from workhold.model.jaw_hold import ProgramJawForce
from workhold.model.program import Program
from workhold.statics.friction import HeldByFriction, MotionProgram
from workhold.statics.path_forces import EVERY, WITHIN
from workhold.statics.program_forces import AskedForce, find_cut_of_move, round_force_up
from workhold.units import Unit

__all__ = ["CuttingPieces", "PressedPart", "describe_asked_force", "find_worst_move"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Radians: the widest range of directions that is not halved, whose corner is 0.5 % outside, and the longest arc that
# is not cut.
NARROW, SHORT_ARC = pi / 16, pi / 18
# Ranges of direction at first, in a turn.
QUARTERS = 4
# By this part the force that is told may be above the hardest that was found.
GAP = 4e-3
# A climb goes on while a force is above the last by this part.
CLIMBED = 1e-6


@frozen(eq=False)
class CuttingPieces:
    """The N straight pieces of a program's path on which tools press, grouped by tool and kind of cut.

    Parameters
    ----------
    move : (N,) index of the program's move.
    group : (N,) number of the tool and the kind of cut, ascending.
    start, end : (N, 3) ends of the path of the force's point in mm: x and y in the part's coordinates, z
        above its lower side.
    force : (N,) size of the force in the plane, in N.
    torque : (N,) size of the torque about z, in N mm; it may act either way round.
    axial : (N, 2) least and largest force along -z, in N.
    middle, half : (N,) middle and half width of the range of directions of the force, in radians; half at
        most pi.
    """

    move: IntArray
    group: IntArray
    start: Array
    end: Array
    force: Array
    torque: Array
    axial: Array
    middle: Array
    half: Array

    @classmethod
    def from_program(cls, program: Program, thickness: float) -> CuttingPieces:
        """Return the pieces of a program on a part of this thickness in
        mm; none where the program has no forces.
        """
        forces, moves = program.forces, program.moves
        if forces is None:
            none, points = np.zeros(0), np.zeros((0, 3))
            whole = np.zeros(0, np.int64)
            return cls(whole, whole, points, points, none, none, np.zeros((0, 2)), none, none)
        stretches = forces.stretches
        own, parts = stretches.move, moves.cut_into_stretches(stretches)
        height = forces.height[own]
        start, end = (
            np.column_stack([one[:, :2], np.clip(one[:, 2] + height, 0.0, thickness)])
            for one in (parts.start, parts.end)
        )
        which, first, last, middle, half = straighten_moves(start, end, parts.bulge)
        spread = EVERY if forces.direction == ANY else WITHIN
        move = own[which]
        half = np.where(forces.force[move] > 0.0, np.minimum(half + spread, pi), 0.0)
        _, group = np.unique(np.stack([moves.tool[move], forces.kind[move]]), axis=1, return_inverse=True)
        group = group.reshape(-1)
        order = np.argsort(group, kind="stable")
        move = move[order]
        return cls(
            move,
            group[order],
            first[order],
            last[order],
            forces.force[move],
            forces.torque[move],
            forces.axial[move],
            middle[order],
            half[order],
        )

    def __len__(self) -> int:
        return len(self.move)


def straighten_moves(start: Array, end: Array, bulge: Array) -> tuple[IntArray, Array, Array, Array, Array]:
    """Return straight pieces of M moves; the hull of an arc's pieces contains the arc.

    The result is, for N pieces: index of the move (N,), start (N, 3), end (N, 3), and middle (N,) and half
    width (N,) of the range of directions opposite to the feed, in radians. The moves have ends ``start`` and
    ``end`` (M, 3), and bulges (M,): the tangent of a quarter of the arc's sweep, 0 for a straight move.
    """
    chord = end[:, :2] - start[:, :2]
    round_ = (bulge != 0.0) & (chord != 0.0).any(axis=1)
    turn = np.where(round_, 4.0 * np.arctan(bulge), 0.0)
    counts = np.maximum(np.ceil(np.abs(turn) / SHORT_ARC), 1.0).astype(np.int64)
    which = np.repeat(np.arange(len(start)), counts)
    place = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    step = (turn / counts)[which]
    before = np.arctan2(chord[:, 1], chord[:, 0])[which] - turn[which] / 2
    heading = before + place * step
    # The point of an arc after an angle a is 2 r sin(a / 2) from its start, along half that angle.
    size = np.hypot(chord[:, 0], chord[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = np.where(round_, size / (2.0 * np.sin(np.abs(turn) / 2)), 0.0)[which]

    def walk_steps(number: Array) -> Array:
        """Return the points (N, 3) at the end of the first ``number`` (N,) steps of the moves."""
        angle = number * step
        far = 2.0 * radius * np.sin(np.abs(angle) / 2)
        along = before + angle / 2
        share = (number / counts[which])[:, None]
        level = start[which] + share * (end[which] - start[which])
        bent = start[which, :2] + far[:, None] * np.column_stack([np.cos(along), np.sin(along)])
        return np.where(round_[which, None], np.column_stack([bent, level[:, 2]]), level)

    first, last = walk_steps(np.asarray(place, np.float64)), walk_steps(np.asarray(place + 1, np.float64))
    tangent = radius * np.tan(np.abs(step) / 2)
    corner = first.copy()
    corner[:, :2] += tangent[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    corner[:, 2] = (first[:, 2] + last[:, 2]) / 2
    middle, half = heading + step / 2 + pi, np.abs(step) / 2
    bent = np.flatnonzero(round_[which])
    last_of_first = np.where(round_[which, None], corner, last)
    every = np.concatenate([np.arange(len(which)), bent])
    order = np.argsort(every, kind="stable")
    every = every[order]
    return (
        which[every],
        np.concatenate([first, corner[bent]])[order],
        np.concatenate([last_of_first, last[bent]])[order],
        middle[every],
        half[every],
    )


def describe_asked_force(need: ProgramJawForce, program: Program, unit: Unit) -> str:
    """Return a sentence on the jaw force that a program needs, and the place."""
    asked = AskedForce(need.force or 0.0, need.line, need.tool, None, find_cut_of_move(program, need.move))
    if need.force is None:
        return f"No jaw force holds the part in {asked.describe_place(unit)}."
    return f"The program asks for a jaw force of {round_force_up(need.force, unit)}, in {asked.describe_place(unit)}."


class GrippedPart(HeldByFriction, Protocol):
    """A part that is held by friction, with the frame of its wrenches."""

    @property
    def centre(self) -> Array:
        """Point in mm that moments are taken about."""
        ...

    @property
    def length(self) -> float:
        """Length in mm that moments are divided by."""
        ...

    def compute_wrenches(self, points: Array, forces: Array) -> Array:
        """Return wrenches (N, 6) of forces (N, 3) in N at points (N, 3) in mm."""
        ...


@frozen(eq=False)
class PressedPart:
    """The pieces of a program on a part between jaws, and their loads.

    Parameters
    ----------
    pieces : pieces of the program's path, in the part's coordinates.
    grip : pressures, forces and friction that hold the part.
    motions : the linear program that finds jaw forces for the grip.
    theta : angle by which the part is turned, in radians.
    position : vector by which the turned part is then moved, in mm.
    safety : factor on the loads.
    """

    pieces: CuttingPieces
    grip: GrippedPart
    motions: MotionProgram
    theta: float
    position: tuple[float, float]
    safety: float
    still: Array = field(factory=lambda: np.zeros(6))

    def make_loads(self, chosen: IntArray, low: float, high: float) -> Array:
        """Return wrenches (N, 6) whose hull contains the loads of some pieces with a range of directions.

        ``chosen`` are indices of pieces; several are replaced by their bounding box. The directions from
        ``low`` to ``high`` are in radians, in the part's coordinates.
        """
        pieces = self.pieces
        force = pieces.force[chosen]
        if len(chosen) == 1:
            points = np.stack([pieces.start[chosen[0]], pieces.end[chosen[0]]])
        else:
            both = np.concatenate([pieces.start[chosen], pieces.end[chosen]])
            points = np.array(list(product(*zip(both.min(axis=0), both.max(axis=0), strict=True))))
        points = np.unique(points, axis=0)
        most = float(force.max())
        ways = [(0.0, 0.0)]
        if most > 0.0:
            ways = [(cos(low), sin(low)), (cos(high), sin(high))]
            half = (high - low) / 2
            ways.append((cos(low + half) / cos(half), sin(low + half) / cos(half)))
            if float(force.min()) < most:
                ways.append((0.0, 0.0))
        across = most * np.unique(np.array(ways), axis=0)
        torque = float(pieces.torque[chosen].max())
        axial = np.unique([pieces.axial[chosen, 0].min(), pieces.axial[chosen, 1].max()])
        torques = np.unique([-torque, torque])
        number = np.array(
            list(product(range(len(points)), range(len(across)), range(len(axial)), range(len(torques))))
        )
        at, way, press, twist = number.T
        c, s = cos(self.theta), sin(self.theta)
        turn = np.array([[c, s], [-s, c]])
        places = np.column_stack([points[at, :2] @ turn + self.position, points[at, 2]])
        forces = np.column_stack([across[way] @ turn, -axial[press]])
        grip = self.grip
        rows = grip.compute_wrenches(places, forces)
        rows[:, 5] += torques[twist] / grip.length
        return np.asarray(rows * self.safety + self.still)

    @cached_property
    def ends(self) -> tuple[Array, Array, Array, Array, Array, Array]:
        """Both ends of all pieces: places (N, 3), middles and half widths
        of ranges, axial forces, forces, and torques.
        """
        pieces = self.pieces
        c, s = cos(self.theta), sin(self.theta)
        ends = np.concatenate([pieces.start, pieces.end])
        level = ends[:, :2] @ np.array([[c, s], [-s, c]]) + self.position
        middle, half = (np.tile(one, 2) for one in (pieces.middle + self.theta, pieces.half))
        force, torque = (np.tile(one, 2) for one in (pieces.force, pieces.torque))
        places = np.column_stack([level, ends[:, 2]])
        return places, middle, half, np.tile(pieces.axial, (2, 1)), force, torque

    def find_hardest_load(self, motion: Array) -> tuple[Array, int]:
        """Return the load (6,) that does the most work on a motion (6,), and the index of its piece."""
        pieces, grip = self.pieces, self.grip
        places, middle, half, axial, force, torque = self.ends
        # What a force at a place does along the motion: the motion of that place.
        arms = (places - grip.centre) / grip.length
        (a, b, c), (x, y, z) = motion[3:].tolist(), arms.T
        along, across = -motion[0] - (b * z - c * y), -motion[1] - (c * x - a * z)
        upward = -motion[2] - (a * y - b * x)
        moved = np.column_stack([along, across, upward])
        way = np.arctan2(moved[:, 1], moved[:, 0])
        way = middle + np.clip((way - middle + pi) % (2 * pi) - pi, -half, half)
        press = np.where(moved[:, 2] > 0.0, axial[:, 0], axial[:, 1])
        power = force * (moved[:, 0] * np.cos(way) + moved[:, 1] * np.sin(way)) - press * moved[:, 2]
        power += torque * abs(motion[5]) / grip.length
        at = int(power.argmax())
        ahead = force[at] * np.array([cos(way[at]), sin(way[at])])
        row = grip.compute_wrenches(places[at][None], np.array([[*ahead, -press[at]]]))[0]
        row[5] -= torque[at] * (1.0 if motion[5] > 0.0 else -1.0) / grip.length
        return row * self.safety + self.still, at % len(pieces)

    def find_hard_load(self) -> tuple[float, int, Array]:
        """Return (a lower bound in N of the jaw force needed, the index of the piece that needs it, its
        load).

        The force is inf if no jaw force holds. The search starts from twelve motions. It alternates between
        the hardest load on a motion and the motion that this load drives.
        """
        best, at, hardest = -inf, 0, np.zeros(6)
        for start in (*np.eye(6), *-np.eye(6)):
            load, piece = self.find_hardest_load(start)
            reached = -1.0
            while (force := float(self.motions.find_least_forces(load[None])[0])) > max(
                reached * (1.0 + CLIMBED), reached
            ):
                reached = force
                if force > best:
                    best, at, hardest = force, piece, load
                if force == inf:
                    return best, at, hardest
                motion = self.motions.motions[(self.motions.motions @ -load).argmax()]
                load, piece = self.find_hardest_load(motion)
        return best, at, hardest

    def intersect_range(self, piece: int, low: float, high: float) -> tuple[float, float]:
        """Return the intersection (low, high) of a range of directions with that of a piece, in radians.

        It is empty, with low > high, where the two ranges have nothing in common.
        """
        half = float(self.pieces.half[piece])
        if half >= pi:
            return low, high
        off = (float(self.pieces.middle[piece]) - (low + high) / 2 + pi) % (2 * pi) - pi
        middle = (low + high) / 2 + off
        return max(low, middle - half), min(high, middle + half)

    def select_within(self, chosen: IntArray, low: float, high: float) -> IntArray:
        """Return those of the pieces ``chosen`` whose directions meet the
        range from ``low`` to ``high``, in radians.
        """
        half = self.pieces.half[chosen]
        off = np.abs((self.pieces.middle[chosen] - (low + high) / 2 + pi) % (2 * pi) - pi)
        reaches = (off <= half + (high - low) / 2) | (half >= pi)
        return np.asarray(chosen[reaches])

    def halve(self, chosen: IntArray, low: float, high: float) -> list[tuple[IntArray, float, float]]:
        """Return the pieces and the range of directions split in two, as (pieces, low, high) each.

        If the places are coarser than the range, the pieces are split by place. Otherwise the range is split
        in its middle, and a half without pieces is left out.
        """
        pieces = self.pieces
        wide = float(pieces.force[chosen].max()) > 0.0 and high - low > NARROW
        if len(chosen) > 1:
            both = np.concatenate([pieces.start[chosen], pieces.end[chosen]])
            size = float(np.linalg.norm(np.ptp(both, axis=0))) / (2 * self.grip.length)
            if not wide or size >= 1.0 / cos((high - low) / 2) - 1.0:
                # Across the longer side of their box, so that both boxes are small.
                middles = (pieces.start[chosen] + pieces.end[chosen]) / 2
                order = np.argsort(middles[:, np.ptp(middles, axis=0).argmax()], kind="stable")
                half = len(chosen) // 2
                return [(np.sort(chosen[part]), low, high) for part in (order[:half], order[half:])]
        middle_way = (low + high) / 2
        parts = []
        for least, most in ((low, middle_way), (middle_way, high)):
            inside = self.select_within(chosen, least, most)
            if len(inside):
                parts.append((inside, least, most))
        return parts


def find_worst_move(
    grip: GrippedPart,
    pieces: CuttingPieces,
    program: Program,
    theta: float,
    position: tuple[float, float],
    safety: float,
    still: Array | None = None,
) -> ProgramJawForce | None:
    """Return the largest jaw force that a program needs, with its move; None if no tool presses on the part.

    In the returned object the force is None if no jaw force holds. Otherwise the force is never below the
    true one, and less than 1 % above it.

    Parameters
    ----------
    grip : pressures, forces and friction that hold the part.
    pieces : pieces of the program's path.
    theta, position : turn in radians and shift in mm of the part from its drawing.
    safety : factor on the loads.
    still : (6,) wrench of a load that always acts, without the factor; None for none.
    """
    if not len(pieces):
        return None
    motions = MotionProgram(grip)
    weight = np.zeros(6) if still is None else still
    placed = PressedPart(pieces, grip, motions, theta, position, safety, weight)
    queue = list[tuple[float, int, int, IntArray, float, float, Array]]()
    number = count()

    def add(chosen: IntArray, low: float, high: float) -> None:
        if len(chosen) == 1:
            low, high = placed.intersect_range(int(chosen[0]), low, high)
        loads = placed.make_loads(chosen, low, high)
        heappush(queue, (-motions.bound_force(loads), len(chosen), next(number), chosen, low, high, loads))

    for group in np.unique(pieces.group):
        own = np.flatnonzero(pieces.group == group)
        if pieces.force[own].max() == 0.0:
            add(own, 0.0, 0.0)
            continue
        for quarter in range(QUARTERS):
            low, high = (2 * pi / QUARTERS * (quarter + k) for k in (0, 1))
            inside = placed.select_within(own, low, high)
            if len(inside):
                add(inside, low, high)
    # The hardest that a piece asks for, what all that was ruled out asks for at most, and the piece.
    (best, at, _), most = placed.find_hard_load(), 0.0
    while queue and best < inf:
        known, _, _, chosen, low, high, loads = heappop(queue)
        limit = best * (1.0 + GAP) if best > 0.0 else best
        is_piece = len(chosen) == 1 and (high - low <= NARROW + 1e-9 or pieces.force[chosen[0]] == 0.0)
        if is_piece or -known <= limit:
            force = float(np.nanmax(motions.find_least_forces(loads, inf if is_piece else limit)))
            if is_piece and force > best:
                best, at = force, int(chosen[0])
            if is_piece or force <= limit:
                most = max(most, force)
                continue
        for part in placed.halve(chosen, low, high):
            add(*part)
    move = int(pieces.move[at])
    moves = program.moves
    needed = None if best == inf else ceil(max(best, most) * 1e6) / 1e6
    return ProgramJawForce(needed, int(moves.line[move]), int(moves.tool[move]), move)
