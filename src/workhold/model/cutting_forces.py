"""What a tool does to the part on every cutting move: a force in the plane, a torque and an axial force.

The force F acts at the tool's periphery. It is given, or follows from a power P in kW at S revolutions per
minute, F = 60 000 P / (pi D S) with D in m. Or it is the sum over the teeth in the cut of Kienzle's
kc1.1 h^(1 - mc) b. A tooth at the angle a takes a chip h = f sin a thick, f being the feed per tooth. The sum
is taken where the teeth add up to most (H. El-Hofy, *Fundamentals of Machining Processes*, 2013, 6.3.1).

A move straight down drills: forces on both sides of the axis cancel, and a torque is left. With kc of the
chip h = f sin(point / 2) the power of a drill makes F = f D kc / 4 at its periphery, f per turn. It presses
down with 0.7 (D / 2) f kc = 1.4 F ("Common Drilling Formulas", a sheet of tool makers). A move straight up
cuts nothing.

A program feeds through air as well: down to the work, and into a cut from beside it. Nobody says what the raw
part is like, so it is taken as a block: the part's outside dimensions with an allowance on all sides and on
top. A move that stays outside of it wholly presses on nothing. One that enters it counts from end to end.

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
from attrs import cmp_using, evolve, field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.geometry.segment import Box
from workhold.limits import real, refuse_strong
from workhold.model.cutting_tool import ANY, DIRECTIONS, CuttingData, CuttingDirection, Tool
from workhold.model.moves import Moves, floats

__all__ = ["ALLOWANCE", "CuttingForces", "above_block", "beside_block", "forces_on"]

# Of the raw block around the part and above it, in mm.
ALLOWANCE = 5.0

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


def words_of(values: Mapping[int, str]) -> dict[int, str]:
    """Sentences by the numbers of tools, in a table of its own."""
    return dict(values)


@frozen
class CuttingForces:
    """The forces on the M moves of a program, in its order.

    Parameters
    ----------
    force : (M,) in the plane, in N; 0 where a move does not cut, and where it drills.
    torque : (M,) in N mm.
    axial : (M, 2) least and greatest, in N.
    height : (M,) above the tip at which the force acts, in mm.
    direction : ``any``, or ``feed`` for within 60 degrees of against the feed.
    reasons : for each tool in a sentence what its force is, and from what it follows.

    Raises
    ------
    InputError
        For numbers that cannot be.
    """

    force: Floats = field(converter=floats, eq=SAME, hash=False, repr=False)
    torque: Floats = field(converter=floats, eq=SAME, hash=False, repr=False)
    axial: Floats = field(converter=floats, eq=SAME, hash=False, repr=False)
    height: Floats = field(converter=floats, eq=SAME, hash=False, repr=False)
    direction: CuttingDirection = ANY
    reasons: Mapping[int, str] = field(factory=dict, converter=words_of, hash=False)

    def __attrs_post_init__(self) -> None:
        count = len(self.force)
        if self.axial.shape != (count, 2) or not len(self.torque) == len(self.height) == count:
            raise InputError("forces of a program lack something: give four numbers for each of its moves.")
        if self.direction not in DIRECTIONS:
            raise InputError(f"cutting forces are in {' or '.join(DIRECTIONS)} direction: give one of them.")
        ends = np.abs(np.column_stack([self.force, self.torque, self.axial, self.height]))
        least = np.column_stack([self.force, self.torque, self.height]).min(initial=0.0)
        if not (np.isfinite(ends).all() and least >= 0.0):
            raise InputError("a force of the program is no number, or negative: give 0 or more.")
        refuse_strong("a force of the program", float(ends.max(initial=0.0)))

    def entry(self, move: int) -> dict[str, Any]:
        """What a move does, as plain data; empty where it does nothing."""
        if self.force[move] == 0.0 and self.torque[move] == 0.0:
            return {}
        axial = self.axial[move].tolist()
        force, torque, height = (float(one[move]) for one in (self.force, self.torque, self.height))
        return {"cutting": {"force": force, "torque": torque, "axial": axial, "height": height}}

    def without(self, moves: NDArray[np.bool_]) -> CuttingForces:
        """The forces with none on some moves (M,); itself where none acts there."""
        if not (moves & ((self.force > 0.0) | (self.torque > 0.0))).any():
            return self
        force, torque, height = (np.where(moves, 0.0, one) for one in (self.force, self.torque, self.height))
        axial = np.where(moves[:, None], 0.0, self.axial)
        return evolve(self, force=force, torque=torque, axial=axial, height=height)

    @classmethod
    def of_entries(cls, rows: list[Mapping[str, Any] | bytes], said: Mapping[str, Any]) -> CuttingForces:
        """The forces of entries, one for each move, and what is said of all; packed entries have none.

        Raises
        ------
        InputError, LookupError, TypeError, ValueError
            For entries that lack something, or hold what cannot be.
        """
        none: dict[str, Any] = {"force": 0.0, "torque": 0.0, "axial": [0.0, 0.0], "height": 0.0}
        taken = [none if isinstance(row, bytes) else row.get("cutting", none) for row in rows]
        force, torque, height = ([real(one[name]) for one in taken] for name in ("force", "torque", "height"))
        axial = np.array([[real(value) for value in one["axial"]] for one in taken]).reshape(-1, 2)
        reasons = {int(number): str(words) for number, words in said["tools"].items()}
        return cls(force, torque, axial, height, said["direction"], reasons)

    def to_dict(self) -> dict[str, Any]:
        """What is said of all moves, as plain data."""
        return {"direction": self.direction, "tools": {str(k): words for k, words in self.reasons.items()}}


def forces_on(moves: Moves, tools: Mapping[int, Tool], job: CuttingData) -> CuttingForces | None:
    """The forces on moves of some tools; None where nobody asks for any.

    Parameters
    ----------
    job : what holds for all tools that do not say otherwise.

    Raises
    ------
    InputError
        Naming the tool that lacks something, and the line that does.
    """
    if not (job.asks_for_forces or any(tool.cutting.asks_for_forces for tool in tools.values())):
        return None
    count = len(moves)
    force, torque, axial, height = np.zeros(count), np.zeros(count), np.zeros((count, 2)), np.zeros(count)
    sideways = (moves.start != moves.end)[:, :2].any(axis=1)
    down = moves.end[:, 2] < moves.start[:, 2]
    reasons = {}
    for number, tool in tools.items():
        own = moves.cutting & (moves.tool == number) & (sideways | down)
        if not own.any():
            continue
        known, radius = tool.cutting.over(job), tool.diameter / 2
        mills, drills = np.flatnonzero(own & sideways), np.flatnonzero(own & ~sideways)
        for rows, drilling in ((mills, False), (drills, True)):
            if not len(rows):
                continue
            found = at_periphery(moves, rows, tool, known, drilling)
            torque[rows] = found * radius
            if drilling:
                axial[rows, 1] = THRUST * found
                continue
            force[rows], height[rows] = found, (known.cut_depth or 0.0) / 2
            helix = HELIX if known.helix_angle is None else known.helix_angle
            axial[rows, 0] = -found * tan(radians(helix))
            axial[rows, 1] = np.where(down[rows], found, 0.0)
        most = float(torque[own].max()) / radius
        reasons[number] = f"T{number}: up to {most:.0f} N {reason_words(known)}"
    return CuttingForces(force, torque, axial, height, job.direction or ANY, reasons)


def reason_words(known: CuttingData) -> str:
    """What the force of a tool follows from, in words behind its number."""
    if known.cutting_force is not None:
        return "as given."
    if known.power is not None:
        return f"from {known.power:g} kW at the spindle."
    assert known.material is not None
    kc, mc = known.material.kc, known.material.mc
    return f"by Kienzle, {known.material.name} with kc1.1 {kc:g} N/mm2 and mc {mc:g}."


def at_periphery(
    moves: Moves, rows: NDArray[np.int64], tool: Tool, known: CuttingData, drilling: bool
) -> Floats:
    """The force (R,) at the periphery of a tool on some moves, in N; refuses a tool or a line that lacks
    something.
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
        each = [of_drill(float(turn), tool, known) for turn in turns]
    else:
        each = [of_teeth(float(turn), tool.diameter, known) for turn in turns]
    return np.array(each)[which]


def refuse_lacking(tool: Tool, known: CuttingData, drilling: bool) -> None:
    """Refuses a tool of which too little is known for the force of Kienzle."""
    needed = () if drilling else (("teeth", "teeth"), ("cut_depth", "depth of cut"))
    lacking = [(name, words) for name, words in needed if getattr(known, name) is None]
    if lacking:
        assert known.material is not None
        what = " and ".join(f"its {words}" for _, words in lacking)
        raise InputError(
            f"T{tool.number} lacks {what}, which its force in {known.material.name} follows from: give "
            f"{' and '.join(name for name, _ in lacking)} in the "
            "table of tools or for the whole job, or its cutting_force."
        )


def refuse_unsaid(moves: Moves, rows: NDArray[np.int64], values: Floats, tool: Tool, what: str) -> None:
    """Refuses moves on which the program does not say what the force follows from."""
    if not (values > 0.0).all():
        line = int(moves.line[rows[values <= 0.0][0]])
        raise InputError(
            f"line {line}: T{tool.number} cuts, and the program does not say {what}, which its force follows "
            "from: write it, or give its cutting_force."
        )


def of_drill(turn: float, tool: Tool, known: CuttingData) -> float:
    """The force in N at the periphery of a tool that drills, from the feed per turn in mm.

    How many teeth the tools of the whole job have says nothing of a drill.
    """
    assert known.material is not None
    lips, point = tool.cutting.teeth or LIPS, known.point_angle or POINT
    thickness = turn / lips * sin(radians(point / 2))
    return turn * tool.diameter / 4 * known.material.force(thickness, 1.0) / thickness


def of_teeth(turn: float, diameter: float, known: CuttingData) -> float:
    """The force in N of all teeth in the cut, from the feed per turn in mm."""
    assert known.material is not None and known.teeth is not None and known.cut_depth is not None
    width, exponent = min(known.cut_width or diameter, diameter), 1.0 - known.material.mc
    together = teeth_together(int(known.teeth), acos(1.0 - 2.0 * width / diameter), exponent)
    return known.material.force(turn / known.teeth, known.cut_depth) * together


def teeth_together(teeth: int, engaged: float, exponent: float) -> float:
    """The largest sum of sin^exponent of the angles at which teeth are in the cut at once.

    Parameters
    ----------
    engaged : the angle in radians, from 0, over which a tooth cuts.
    exponent : 1 - mc.

    Examples
    --------
    >>> from math import pi
    >>> teeth_together(2, pi, 0.8), teeth_together(1, pi / 6, 1.0)
    (1.0, 0.5)
    """
    pitch = 2 * pi / teeth
    # As the first tooth goes through a pitch, the sum is smooth but for the moment at which one leaves.
    last = engaged - pitch * floor(engaged / pitch)
    first = np.append(np.linspace(0.0, pitch, STEPS, endpoint=False), last)
    angle = first[:, None] + pitch * np.arange(floor(engaged / pitch) + 1)
    cut = np.where(angle <= engaged * (1 + 1e-12), np.sin(np.clip(angle, 0.0, pi)), 0.0)
    return round(float((np.maximum(cut, 0.0) ** exponent).sum(axis=1).max()), 12)


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
