"""The forces of a tool on the part on every cutting move: a force in the plane, a torque and an axial force.

The force F acts at the tool's periphery. It is given, or follows from a power P in kW at S revolutions per
minute, F = 60 000 P / (pi D S) with D in m. Or it is the sum over the teeth in the cut of Kienzle's kc1.1
h^(1 - mc) b. A tooth at the angle a takes a chip of thickness h = f sin a, where f is the feed per tooth. The
sum is taken at the angle at which it is largest (H. El-Hofy, *Fundamentals of Machining Processes*, 2013,
6.3.1).

Drilling is a drill cycle, or a straight move down of a tool that its table calls a drill. The forces on both
sides of the axis cancel, and a torque remains. With kc of the chip h = f sin(point / 2), the power of a drill
corresponds to F = f D kc / 4 at its periphery, with the feed f per turn. It presses down with 0.7 (D / 2) f
kc = 1.4 F ("Common Drilling Formulas", a sheet of tool makers). Any other tool that moves straight down
plunges: its milling force presses down, with its torque. A move straight up cuts nothing.

A program feeds through air as well, down to the work and into a cut from beside it. Forces act along the
stretches of moves on which a tool meets the stock, see ``model.stock``.

Glossary
--------
torque : greatest moment about the tool's axis, either way round; of a force at the periphery F D / 2.
axial : force along -z: positive pressing down, negative where a helix pulls the part up with F tan(helix).
"""

from __future__ import annotations

from collections.abc import Mapping
from math import acos, floor, pi, radians, sin, tan
from typing import Any

import numpy as np
from attrs import Factory, cmp_using, evolve, field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.limits import convert_real, refuse_strong
from workhold.model.cutting_tool import ANY, DIRECTIONS, CuttingData, CuttingDirection, Tool
from workhold.model.moves import Moves, MoveStretches, to_floats, to_integers

__all__ = [
    "CUT_KINDS",
    "DRILLING",
    "MILLING",
    "NO_CUT",
    "PLUNGING",
    "CuttingForces",
    "compute_cutting_forces",
]

Floats = NDArray[np.float64]
SAME = cmp_using(eq=np.array_equal)
# Of a twist drill where nobody says otherwise: its lips, and the angle of its point in degrees.
LIPS, POINT = 2.0, 118.0
# Degrees, of an end mill of which nothing is known.
HELIX = 30.0
# A drill presses down with this times the force at its periphery.
THRUST = 1.4
# Places of the teeth in a pitch at which their forces are added up.
STEPS = 360
# What a move does, by its number.
NO_CUT, MILLING, DRILLING, PLUNGING = range(4)
CUT_KINDS = ("", "milling", "drilling", "plunging")


def copy_words(values: Mapping[int, str]) -> dict[int, str]:
    """Return a copy as a dict: sentences by the numbers of tools."""
    return dict(values)


@frozen
class CuttingForces:
    """The forces on the M moves of a program, in its order.

    Parameters
    ----------
    force : (M,) force in the plane, in N; 0 for moves that do not cut, and for moves that drill or plunge.
    torque : (M,) in N mm.
    axial : (M, 2) least and greatest, in N.
    height : (M,) height above the tip at which the force acts, in mm.
    direction : ``any``, or ``feed`` for a force within 60 degrees of the direction opposite to the feed.
    reasons : by tool number, a sentence that gives the basis of the tool's force.
    kind : (M,) kind of cut of each move, numbers of :data:`CUT_KINDS`.
    stretches : the stretches of moves along which forces act; None if they act all along their moves.

    Raises
    ------
    InputError
        For impossible numbers.
    """

    force: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)
    torque: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)
    axial: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)
    height: Floats = field(converter=to_floats, eq=SAME, hash=False, repr=False)
    direction: CuttingDirection = ANY
    reasons: Mapping[int, str] = field(factory=dict, converter=copy_words, hash=False)
    kind: NDArray[np.int64] = field(
        default=Factory(lambda self: classify_moves(self.force, self.torque), takes_self=True),
        converter=to_integers,
        eq=SAME,
        hash=False,
        repr=False,
    )
    stretches: MoveStretches = field(
        default=Factory(lambda self: MoveStretches.from_whole_moves(self.acts), takes_self=True), repr=False
    )

    def __attrs_post_init__(self) -> None:
        count = len(self.force)
        if self.axial.shape != (count, 2) or not (
            len(self.torque) == len(self.height) == len(self.kind) == count
        ):
            raise InputError("forces of a program lack something: give four numbers for each of its moves.")
        if self.direction not in DIRECTIONS:
            raise InputError(f"cutting forces are in {' or '.join(DIRECTIONS)} direction: give one of them.")
        ends = np.abs(np.column_stack([self.force, self.torque, self.axial, self.height]))
        least = np.column_stack([self.force, self.torque, self.height]).min(initial=0.0)
        if not (np.isfinite(ends).all() and least >= 0.0):
            raise InputError("a force of the program is not a number, or negative: give 0 or more.")
        refuse_strong("a force of the program", float(ends.max(initial=0.0)))
        own, first, last = self.stretches.move, self.stretches.first, self.stretches.last
        is_one = (first >= 0.0) & (first < last) & (last <= 1.0)
        rise = (own[1:] > own[:-1]) | ((own[1:] == own[:-1]) & (first[1:] >= last[:-1]))
        if not (is_one.all() and rise.all() and ((own >= 0) & (own < count)).all()):
            raise InputError(
                "a stretch of a cut cannot be used: give shares from 0 to 1, the lower one first."
            )

    @property
    def acts(self) -> NDArray[np.bool_]:
        """(M,) True where a force or a torque of a move is positive."""
        return np.asarray((self.force > 0.0) | (self.torque > 0.0))

    def make_entry(self, move: int) -> dict[str, Any]:
        """Return the forces on the move with this index as plain data under "cutting"; {} if it does not cut."""
        if self.force[move] == 0.0 and self.torque[move] == 0.0:
            return {}
        axial = self.axial[move].tolist()
        force, torque, height = (float(one[move]) for one in (self.force, self.torque, self.height))
        return {
            "cutting": {
                "kind": CUT_KINDS[self.kind[move]],
                "force": force,
                "torque": torque,
                "axial": axial,
                "height": height,
                "stretches": self.stretches.list_shares(move),
            }
        }

    def keep_stretches(self, stretches: MoveStretches) -> CuttingForces:
        """Return forces that act along these stretches only, and are 0 on moves without a stretch.

        Return the object itself where the stretches are its own.
        """
        if stretches == self.stretches:
            return self
        gone = np.ones(len(self.force), np.bool_)
        gone[stretches.move] = False
        force, torque, height = (np.where(gone, 0.0, one) for one in (self.force, self.torque, self.height))
        axial, kind = np.where(gone[:, None], 0.0, self.axial), np.where(gone, NO_CUT, self.kind)
        return evolve(
            self, force=force, torque=torque, axial=axial, height=height, kind=kind, stretches=stretches
        )

    @classmethod
    def from_entries(cls, rows: list[Mapping[str, Any] | bytes], said: Mapping[str, Any]) -> CuttingForces:
        """Return the forces read from a result file.

        Parameters
        ----------
        rows : one entry for each move; a packed entry (bytes), or one without "cutting", has no force.
        said : the result file's "direction", and "tools": sentences by tool number.

        Raises
        ------
        InputError, LookupError, TypeError, ValueError
            For entries that lack something, or hold impossible values.
        """
        none: dict[str, Any] = {"force": 0.0, "torque": 0.0, "axial": [0.0, 0.0], "height": 0.0}
        taken = [none if isinstance(row, bytes) else row.get("cutting", none) for row in rows]
        force, torque, height = (
            [convert_real(one[name]) for one in taken] for name in ("force", "torque", "height")
        )
        axial = np.array([[convert_real(value) for value in one["axial"]] for one in taken]).reshape(-1, 2)
        # What stands before the words that follow the number says how large it is.
        reasons = {int(key): str(words).partition(" N ")[2] for key, words in said["tools"].items()}
        usual = classify_moves(np.array(force), np.array(torque)).tolist()
        kind = [
            CUT_KINDS.index(one["kind"]) if "kind" in one else number
            for one, number in zip(taken, usual, strict=True)
        ]
        each = [
            one.get("stretches", [[0.0, 1.0]] if number else [])
            for one, number in zip(taken, kind, strict=True)
        ]
        shares = [(convert_real(one), convert_real(other)) for rows in each for one, other in rows]
        move = np.repeat(np.arange(len(each)), [len(rows) for rows in each])
        first, last = np.array(shares).reshape(-1, 2).T
        return cls(
            force, torque, axial, height, said["direction"], reasons, kind, MoveStretches(move, first, last)
        )

    def to_dict(self, moves: Moves, tools: Mapping[int, Tool]) -> dict[str, Any]:
        """Return the direction, and the sentence of each tool, as plain data.

        The forces on moves are left out; :meth:`make_entry` makes their data.
        """
        return {
            "direction": self.direction,
            "tools": {str(k): v for k, v in self.describe_tools(moves, tools).items()},
        }

    def describe_tools(self, moves: Moves, tools: Mapping[int, Tool]) -> dict[int, str]:
        """Return for each tool number a sentence with the tool's largest force at the periphery in N, and
        what that force follows from.
        """
        found = {}
        for number, words in self.reasons.items():
            most = float(self.torque[moves.tool == number].max(initial=0.0)) * 2 / tools[number].diameter
            found[number] = f"T{number}: up to {most:.0f} N {words}"
        return found


def classify_moves(force: Floats, torque: Floats) -> NDArray[np.int64]:
    """Return (M,) kinds guessed from the forces:
    MILLING with a force, DRILLING with a torque alone, else NO_CUT.
    """
    return np.where(force > 0.0, MILLING, np.where(torque > 0.0, DRILLING, NO_CUT))


def compute_cutting_forces(
    moves: Moves, tools: Mapping[int, Tool], job: CuttingData, within: MoveStretches | None = None
) -> CuttingForces | None:
    """Return the forces on moves.

    Returns None if neither ``job`` nor a tool gives a force, a power or a material.

    Parameters
    ----------
    job : data for tools that have none of their own.
    within : stretches of moves on which a tool may cut; None if each cutting move may cut all along.

    Raises
    ------
    InputError
        If a tool, or the program on a line, does not give the data for a force.
    """
    if not (job.asks_for_forces or any(tool.cutting.asks_for_forces for tool in tools.values())):
        return None
    count = len(moves)
    force, torque, axial, height = np.zeros(count), np.zeros(count), np.zeros((count, 2)), np.zeros(count)
    sideways = (moves.start != moves.end)[:, :2].any(axis=1)
    down = moves.end[:, 2] < moves.start[:, 2]
    cuts = moves.cutting & (sideways | down)
    if within is not None:
        meets = np.zeros(count, np.bool_)
        meets[within.move] = True
        cuts &= meets
    drill = np.isin(moves.tool, [number for number, tool in tools.items() if tool.is_drill])
    kind = np.where(sideways, MILLING, np.where(moves.cycle | drill, DRILLING, PLUNGING)) * cuts
    reasons = {}
    for number, tool in tools.items():
        own = cuts & (moves.tool == number)
        if not own.any():
            continue
        known, radius = tool.cutting.complete_with(job), tool.diameter / 2
        for which in (MILLING, DRILLING, PLUNGING):
            rows = np.flatnonzero(own & (kind == which))
            if not len(rows):
                continue
            found = compute_peripheral_forces(moves, rows, tool, known, which == DRILLING)
            torque[rows] = found * radius
            if which != MILLING:
                axial[rows, 1] = found * (THRUST if which == DRILLING else 1.0)
                continue
            force[rows], height[rows] = found, (known.cut_depth or 0.0) / 2
            helix = HELIX if known.helix_angle is None else known.helix_angle
            axial[rows, 0] = -found * tan(radians(helix))
            axial[rows, 1] = np.where(down[rows], found, 0.0)
        reasons[number] = describe_force_reason(known)
    kind = np.where(torque > 0.0, kind, NO_CUT)
    whole = CuttingForces(force, torque, axial, height, job.direction or ANY, reasons, kind)
    if within is None:
        return whole
    acts = whole.acts[within.move]
    return whole.keep_stretches(MoveStretches(within.move[acts], within.first[acts], within.last[acts]))


def describe_force_reason(known: CuttingData) -> str:
    """Return the words that give the basis of a tool's force, such as "as given."; they follow the force in a
    sentence.
    """
    if known.cutting_force is not None:
        return "as given."
    if known.power is not None:
        return f"from {known.power:g} kW at the spindle."
    assert known.material is not None
    kc, mc = known.material.kc, known.material.mc
    return f"by Kienzle, {known.material.name} with kc1.1 {kc:g} N/mm2 and mc {mc:g}."


def compute_peripheral_forces(
    moves: Moves, rows: NDArray[np.int64], tool: Tool, known: CuttingData, drilling: bool
) -> Floats:
    """Return the force (R,) in N at the periphery of a tool on the moves with the indices ``rows``.

    Raises
    ------
    InputError
        If the tool, or the program on one of these moves, does not give the data for the force.
    """
    if known.cutting_force is not None:
        return np.full(len(rows), known.cutting_force)
    if known.power is None and known.material is None:
        raise InputError(
            f"T{tool.number} has no cutting force: give its cutting_force (0 where it hardly cuts) or its "
            "power in the table of tools, or a force, a power or a material for all tools."
        )
    spindle, feed = moves.spindle[rows], moves.feed[rows]
    if known.power is not None:
        refuse_unsaid(moves, rows, spindle, tool, "the spindle's speed, S")
        found: Floats = 6e7 * known.power / (pi * tool.diameter * spindle)
        return found
    refuse_lacking(tool, known, drilling)
    refuse_unsaid(moves, rows, spindle, tool, "the spindle's speed, S")
    refuse_unsaid(moves, rows, feed, tool, "a feed, F, in a length per minute or turn")
    turns, which = np.unique(feed / spindle, return_inverse=True)
    if drilling:
        each = [compute_drill_force(float(turn), tool, known) for turn in turns]
    else:
        each = [compute_teeth_force(float(turn), tool.diameter, known) for turn in turns]
    return np.array(each)[which]


def refuse_lacking(tool: Tool, known: CuttingData, drilling: bool) -> None:
    """Raise InputError for a tool that mills without a number
    of teeth or a depth of cut, which Kienzle's force needs.
    """
    needed = () if drilling else (("teeth", "teeth"), ("cut_depth", "depth of cut"))
    lacking = [(name, words) for name, words in needed if getattr(known, name) is None]
    if lacking:
        assert known.material is not None
        what = " and ".join(f"its {words}" for _, words in lacking)
        drill_words = "" if tool.is_drill else "; of a drill say type drill"
        raise InputError(
            f"T{tool.number} lacks {what}, which its force in {known.material.name} follows from: give "
            f"{' and '.join(name for name, _ in lacking)} in the "
            f"table of tools or for the whole job, or its cutting_force{drill_words}."
        )


def refuse_unsaid(moves: Moves, rows: NDArray[np.int64], values: Floats, tool: Tool, what: str) -> None:
    """Raise InputError, naming the line, where one of ``values`` (R,),
    read for the moves ``rows``, is not positive.

    ``what`` calls the value in the message, such as "a feed, F".
    """
    if not (values > 0.0).all():
        line = int(moves.line[rows[values <= 0.0][0]])
        raise InputError(
            f"line {line}: T{tool.number} cuts, and the program does not say {what}, which its force follows "
            "from: write it, or give its cutting_force."
        )


def compute_drill_force(turn: float, tool: Tool, known: CuttingData) -> float:
    """Return the force in N at the periphery of a drilling tool, from the feed per turn in mm.

    The number of lips is the tool's own, else 2; a number of teeth given for the whole job is not used.
    """
    assert known.material is not None
    lips, point = tool.cutting.teeth or LIPS, known.point_angle or POINT
    thickness = turn / lips * sin(radians(point / 2))
    return turn * tool.diameter / 4 * known.material.compute_force(thickness, 1.0) / thickness


def compute_teeth_force(turn: float, diameter: float, known: CuttingData) -> float:
    """Return the sum in N of the forces of all teeth in the cut, by Kienzle's formula.

    ``turn`` is the feed per turn and ``diameter`` that of the tool, both in mm.
    """
    assert known.material is not None and known.teeth is not None and known.cut_depth is not None
    width, exponent = min(known.cut_width or diameter, diameter), 1.0 - known.material.mc
    together = compute_engaged_tooth_sum(int(known.teeth), acos(1.0 - 2.0 * width / diameter), exponent)
    return known.material.compute_force(turn / known.teeth, known.cut_depth) * together


def compute_engaged_tooth_sum(teeth: int, engaged: float, exponent: float) -> float:
    """Return the largest sum of sin(a)^exponent over the angles a of the teeth that cut at the same time.

    Parameters
    ----------
    engaged : the angle in radians, from 0, over which a tooth cuts.
    exponent : 1 - mc.

    Examples
    --------
    >>> from math import pi
    >>> compute_engaged_tooth_sum(2, pi, 0.8), compute_engaged_tooth_sum(1, pi / 6, 1.0)
    (1.0, 0.5)
    """
    pitch = 2 * pi / teeth
    # As the first tooth goes through a pitch, the sum is smooth but for the moment at which one leaves.
    last = engaged - pitch * floor(engaged / pitch)
    first = np.append(np.linspace(0.0, pitch, STEPS, endpoint=False), last)
    angle = first[:, None] + pitch * np.arange(floor(engaged / pitch) + 1)
    cut = np.where(angle <= engaged * (1 + 1e-12), np.sin(np.clip(angle, 0.0, pi)), 0.0)
    return round(float((np.maximum(cut, 0.0) ** exponent).sum(axis=1).max()), 12)
