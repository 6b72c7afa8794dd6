"""The jaw force that a program's tools ask for between two flat jaws, derived by another method than the
search's.

The least jaw force for one load comes with dual prices, and these bound from below what every other load asks
for. So the load along the path with the greatest bound at these prices is found in closed form and answered
itself. Its prices lead on to a harder load, until there is none (an ascent). Ascents start from many prices,
among them those of loads in the line that a file names. So the force that is found is certainly asked for,
but a harder load that no ascent reaches would be missed.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, radians, sin

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import ProgramJawForce
from workhold.model.program import Program
from workhold.verification.jaw_forces import LENGTH, HeldBetweenJaws, UnsettledError, compute_wrenches
from workhold.verification.tool_walk import make_walk

__all__ = ["find_program_force", "find_program_force_faults"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Places of an arc that are looked at, steps of an ascent, and directions of the named line that are tried.
PLACES, MOST_STEPS, TRIED = 33, 40, 8
# Parts of a force by which one that is written may be above or below, and N.
ABOVE, BELOW, HAIR = 0.011, 1e-3, 1e-3
# Radians: half the range of directions about against the feed.
SIXTY = pi / 3


@frozen(eq=False)
class PressingPath:
    """N places of a program's path where tools press on a part, in the frame of the jaws.

    Parameters
    ----------
    move : (N,) the number of the program's move at each place.
    point : (N, 3) in mm, from the point that moments are taken about.
    against : (N,) direction opposite to the feed, in radians.
    force, torque : (N,) in N and N mm, with the safety factor.
    axial : (N, 2) two bounds of the force along -z, in N, with the safety factor.
    spread : half the range of force directions about ``against``, in radians; pi for any direction.
    still : a wrench (6,) added to that of every tool, such as the weight's.
    """

    move: IntArray
    point: Array
    against: Array
    force: Array
    torque: Array
    axial: Array
    spread: float
    still: Array

    @classmethod
    def from_program(
        cls, program: Program, fixture: Fixture, height: float, safety: float, centre: Array, still: Array
    ) -> PressingPath:
        """Return the sampled places of a program's path at which tools press on the part, in the jaws' frame.

        ``height`` is the part's in mm; ``safety`` multiplies forces and torques. ``centre`` (3,) is the point
        that moments are taken about, and ``still`` (6,) a wrench added to that of every tool. The program
        must state forces.
        """
        walk, forces, moves = make_walk(program), program.forces, program.moves
        assert forces is not None
        stretches = forces.stretches
        rows, shares = list[IntArray](), list[Array]()
        for place in np.linspace(0.0, 1.0, PLACES):
            whole = np.flatnonzero(walk.is_round[stretches.move] | (place in (0.0, 1.0)))
            rows.append(stretches.move[whole])
            first, last = stretches.first[whole], stretches.last[whole]
            shares.append(first + place * (last - first))
        move, share = np.concatenate(rows), np.concatenate(shares)
        x, y = walk.compute_places_at(move, share).T
        z = moves.start[move, 2] + share * (moves.end[move, 2] - moves.start[move, 2])
        turn = radians(fixture.pose.theta_deg)
        point = np.column_stack(
            [
                cos(turn) * x - sin(turn) * y + fixture.pose.x,
                sin(turn) * x + cos(turn) * y + fixture.pose.y,
                np.minimum(np.maximum(z + forces.height[move], 0.0), height),
            ]
        )
        chord = moves.end[move, :2] - moves.start[move, :2]
        sweep = np.where(walk.is_round[move], walk.sweep[move], 0.0)
        against = np.arctan2(chord[:, 1], chord[:, 0]) + sweep * (share - 0.5) + pi + turn
        return cls(
            move,
            point - centre,
            against,
            safety * forces.force[move],
            safety * forces.torque[move],
            safety * forces.axial[move],
            SIXTY if forces.direction == "feed" else pi,
            still,
        )

    def select_moves(self, moves: IntArray) -> PressingPath:
        """Return only those places that belong to the given move numbers."""
        own = np.isin(self.move, moves)
        return PressingPath(
            self.move[own],
            self.point[own],
            self.against[own],
            self.force[own],
            self.torque[own],
            self.axial[own],
            self.spread,
            self.still,
        )

    def compute_wrench(self, place: int, turn: float, pull: float, twist: float) -> Array:
        """Return the wrench (6,) of the tool at the place with index ``place``, with the constant wrench
        ``still`` added.

        ``turn`` is the direction of the radial force in radians, ``pull`` the axial force along -z in N, and
        ``twist`` the torque in N mm. Moments are divided by ``LENGTH``.
        """
        force = float(self.force[place])
        x, y, z = self.point[place].tolist()
        row = compute_wrenches(np.array([[x, y, z]]), (force * cos(turn), force * sin(turn), -pull))[0]
        row[5] += twist / LENGTH
        return np.asarray(row + self.still)

    def find_worst_load(self, prices: Array) -> Array:
        """Return the load (6,) along the path with the greatest -prices · load.

        At that load's own prices, or any other, this product is a lower bound of the jaw force in N that it
        needs.
        """
        x, y, z = self.point.T
        a, b, c, k, m, n = -prices / np.array([1.0, 1.0, 1.0, LENGTH, LENGTH, LENGTH])
        along, across = a + z * m - y * n, b - z * k + x * n
        upward = c + y * k - x * m
        turn = np.arctan2(across, along)
        off = np.angle(np.exp(1j * (turn - self.against)))
        turn = self.against + np.clip(off, -self.spread, self.spread)
        pull = np.where(upward > 0.0, self.axial[:, 0], self.axial[:, 1])
        worth = (
            self.force * (along * np.cos(turn) + across * np.sin(turn)) - pull * upward + self.torque * abs(n)
        )
        place = int(worth.argmax())
        twist = float(self.torque[place]) * (1.0 if n > 0.0 else -1.0)
        return self.compute_wrench(place, float(turn[place]), float(pull[place]), twist)

    def find_hardest_force(self, held: HeldBetweenJaws, starts: list[Array]) -> float | None:
        """Return the largest jaw force in N found by ascents, one from each of the dual prices ``starts``.

        An ascent alternates: it finds the dearest load at given prices, then takes that load's own prices.
        Returns None if no jaw force holds some load.
        """
        worst, known = 0.0, set[bytes]()
        for prices in starts:
            for _ in range(MOST_STEPS):
                load = self.find_worst_load(prices)
                # Where an ascent came by before, it goes on as it did then.
                if (key := load.round(9).tobytes()) in known:
                    break
                known.add(key)
                found = held.find_least_force(load)
                if found is None:
                    return None
                force, prices = found
                worst = max(worst, force)
        return worst

    def list_tried_loads(self) -> Iterator[Array]:
        """Yield loads (6,) at the first, middle and last place of the path, in ``TRIED`` directions at each
        place.
        """
        for place in sorted({0, len(self.move) // 2, len(self.move) - 1}):
            for number in range(TRIED):
                turn = float(self.against[place]) + self.spread * (2.0 * number / TRIED - 1.0)
                yield self.compute_wrench(place, turn, float(self.axial[place, 0]), float(self.torque[place]))


def find_program_force(
    program: Program,
    fixture: Fixture,
    held: HeldBetweenJaws,
    height: float,
    safety: float,
    frame: tuple[Array, Array],
) -> float | None:
    """Return the largest force in N that ascents along a program find that its tools need; None where none holds.

    Parameters are as in :func:`find_program_force_faults`.
    """
    path = PressingPath.from_program(program, fixture, height, safety, *frame)
    return path.find_hardest_force(held, [*np.eye(6), *-np.eye(6)])


def find_program_force_faults(
    program: Program,
    need: ProgramJawForce | None,
    fixture: Fixture,
    held: HeldBetweenJaws,
    height: float,
    safety: float,
    frame: tuple[Array, Array] = (np.zeros(3), np.zeros(6)),
    force_name: str = "jaw force",
) -> Iterator[str]:
    """Yield one sentence, without full stop, if the jaw force that a file states for its program is wrong.

    Yields nothing more if the method does not converge.

    Parameters
    ----------
    need : the statement of the file; None if there is none.
    held : the part between the jaws.
    height : height of the part, in mm.
    safety : factor on the loads.
    frame : the point (3,) about which moments are taken, and a wrench (6,) that acts in addition to the
        tools.
    force_name : name of the force in messages.
    """
    path = PressingPath.from_program(program, fixture, height, safety, *frame)
    if (need is None) != (not len(path.move)):
        yield f"the {force_name} of its program is missing, or given where no tool presses on the part"
        return
    if need is None:
        return
    moves = program.moves
    of_line = np.flatnonzero((moves.line == need.line) & (moves.tool == need.tool))
    named = path.select_moves(of_line)
    if not len(named.move):
        yield f"no T{need.tool} presses on the part in line {need.line} of the program"
        return
    try:
        starts = [*np.eye(6), *-np.eye(6)]
        for load in named.list_tried_loads():
            found = held.find_least_force(load)
            if found is None:
                if need.force is not None:
                    yield f"line {need.line} is held by no {force_name}, and {need.force:.9g} N are written"
                return
            starts.append(found[1])
        if need.force is None:
            yield f"no {force_name} is said to hold the part in line {need.line}, and some do"
            return
        worst, there = path.find_hardest_force(held, starts), named.find_hardest_force(held, starts)
    except (UnsettledError, np.linalg.LinAlgError):
        return
    if worst is None or there is None:
        yield f"no {force_name} holds the part along the program, and {need.force:.9g} N are written"
        return
    spare = HAIR + BELOW * worst
    if not -spare <= need.force - worst <= spare + ABOVE * worst:
        yield f"the program asks for {worst:.9g} N, and {need.force:.9g} N are written"
    elif there < worst * (1.0 - ABOVE) - spare:
        yield f"line {need.line} asks for {there:.9g} N, and another for {worst:.9g} N"
