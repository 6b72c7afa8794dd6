"""What loads do to one fixture: peg forces, and the jaw force that keeps every peg in contact.

Contacts are without friction and bodies are rigid, so the peg forces are known exactly once the force on what moves is:
f = f0 + F h, where F is that force, of a vise the jaw force, h the peg forces per unit of it, and f0 balances the load
without pushing that carrier. That is for a jaw that keeps its force; a screw vise locks its jaw, and f0 is then what
``statics.jaw`` makes of it. Friction can only be told as what it would make possible, see ``statics.friction``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import permutations
from math import atan2, cos, degrees, hypot, isfinite, radians, sin

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import NO_FORCE
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.limits import MOST_FRICTION, refuse_strong
from workhold.model.fixture import Fixture
from workhold.model.load import Load
from workhold.model.workpiece import Workpiece
from workhold.real import real
from workhold.statics.contact_matrix import Touched
from workhold.statics.friction import contacts_on_part, possible_motions
from workhold.statics.jaw import jaw_stiffness, shared_forces

__all__ = ["LoadCase", "Worst", "largest_value", "load_cases"]

Array = NDArray[np.float64]


@frozen
class Worst:
    """Where and in which direction a load is worst.

    Parameters
    ----------
    value : how bad it is there, in N.
    peg : index of the peg concerned, in the fixture's order.
    point : where the load acts, in mm in the part's coordinates; the part's centre for a moment alone.
    direction : in degrees in the part's frame, in [0, 360).
    """

    value: float
    peg: int
    point: tuple[float, float]
    direction: float


@frozen
class LoadCase:
    """What one load does to a fixture; forces in N, for the worst point and direction of the load.

    Parameters
    ----------
    load : the load.
    jaw_stiffness : of the closed jaw, in that of one contact: infinite for a screw, 0 for a jaw that keeps its force.
    jaw_force : force on the moving carrier, before the load comes, that ``smallest`` and ``largest`` are told for.
    smallest, largest : of each peg's force, in the fixture's order. Where a force is negative the peg would have to pull: it
        lets go, and the forces told are no longer those that act.
    reaction : the largest peg force with as little clamping as keeps all forces from being negative (the figure of quality
        ``load_reaction``).
    needed : the jaw force above which no peg lets go, and the peg that does below it; never negative.
    needed_with_friction : the jaw force above which Coulomb friction could hold the part, None where no friction was given.
        Optimistic: with friction the forces are not determined by statics, and this tells what the best of all possible
        forces would need, of a jaw that keeps its force; a locked one does with no more. Pegs may let go.
    """

    load: Load
    jaw_stiffness: float
    jaw_force: float
    smallest: tuple[float, ...]
    largest: tuple[float, ...]
    reaction: Worst
    needed: Worst
    needed_with_friction: float | None

    @property
    def keeps_contact(self) -> bool:
        """Whether every peg presses on the part at this jaw force, or just touches it within rounding."""
        return min(self.smallest) >= -NO_FORCE * max(self.largest)


def load_cases(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    loads: Sequence[Load],
    jaw_force: float | None = None,
    friction: float | None = None,
    jaw: str | float = "screw",
) -> tuple[LoadCase, ...]:
    """What each of some loads does to a fixture; each acts by itself.

    Parameters
    ----------
    fixture, workpiece, toolkit : the fixture, of what and in what.
    loads : see :class:`workhold.model.load.Load`.
    jaw_force : force in N that pushes the moving carrier; by default the one needed so that no peg lets go under any load.
    friction : Coulomb's coefficient of friction between peg and part, to tell what it could add.
    jaw : "screw", "constant", or how many times as stiff as one contact the jaw is; see ``statics.jaw``.

    Raises
    ------
    InputError
        For a jaw force or a coefficient that is negative or not finite, and a jaw that is not known.
    """
    for name, value in (("jaw force", jaw_force), ("friction", friction)):
        if value is not None and not (isfinite(real(value)) and value >= 0):
            raise InputError(f"{name} {real(value):g} cannot be used: give 0 or more.")
    refuse_strong("jaw force", jaw_force or 0.0)
    if friction is not None and friction > MOST_FRICTION:
        raise InputError(f"friction {friction:g} is beyond {MOST_FRICTION:g}: give the coefficient, such as 0.15.")
    stiffness, touched = jaw_stiffness(jaw), Touched.of(workpiece, toolkit)
    contact_matrices = touched.of_fixture(fixture, toolkit)
    # Rows: force of each peg per unit of (g_x, g_y, moment, jaw force); see kernels.statics.contact_matrix.
    forces = contact_matrices.inverses[0].T / np.array([1.0, 1.0, touched.length, 1.0])
    forces = shared_forces(forces, contact_matrices.closing[0], stiffness)
    motions = None
    if friction is not None:
        on_part = contacts_on_part(fixture, workpiece, toolkit, touched, contact_matrices)
        motions = possible_motions(*on_part, friction, touched.length)
    center = (float(touched.center[0]), float(touched.center[1]))
    needs = [needed(forces, load, center) for load in loads]
    if jaw_force is None:
        jaw_force = max((worst.value for worst in needs), default=0.0)
    jaw_force = float(jaw_force)
    return tuple(
        LoadCase(
            load=load,
            jaw_stiffness=stiffness,
            jaw_force=jaw_force,
            smallest=forces_of(
                -largest_of(-forces[i], load, center).value + jaw_force * forces[i, 3] for i in range(len(forces))
            ),
            largest=forces_of(
                largest_of(forces[i], load, center).value + jaw_force * forces[i, 3] for i in range(len(forces))
            ),
            reaction=reaction(forces, load, center),
            needed=need,
            needed_with_friction=None if motions is None else with_friction(motions, load, center, need, stiffness),
        )
        for load, need in zip(loads, needs, strict=True)
    )


def forces_of(values: Iterator[float]) -> tuple[float, ...]:
    """Numbers as a tuple of floats."""
    return tuple(float(value) for value in values)


def largest_value(x: float, y: float, directions: tuple[float, float]) -> tuple[float, float]:
    """Largest value of x cos + y sin over a range of directions in degrees, and the direction in [0, 360) it is at."""
    low, high = directions
    peak = low + (degrees(atan2(y, x)) - low) % 360.0
    candidates = [low, high, peak] if peak <= high else [low, high]
    value, direction = max((x * cos(radians(angle)) + y * sin(radians(angle)), angle) for angle in candidates)
    return (hypot(x, y) if direction == peak else value), direction % 360.0


def largest_of(coefficients: Array, load: Load, center: tuple[float, float]) -> Worst:
    """Where a load makes a (g_x, g_y, moment) . coefficients largest; the value tells how large, the peg is 0."""
    a, b, c = (float(value) for value in coefficients[:3])
    worst: Worst | None = None
    for x, y in load.points or (center,):
        dx, dy = x - center[0], y - center[1]
        value, direction = largest_value(a - dy * c, b + dx * c, load.directions)
        total = load.force * value + load.moment * c
        if worst is None or total > worst.value:
            worst = Worst(total, 0, (x, y), direction)
    assert worst is not None
    return worst


def needed(forces: Array, load: Load, center: tuple[float, float]) -> Worst:
    """The jaw force needed so that no peg lets go: the largest -f0_i / h_i over pegs, points and directions."""
    worst = max(
        (of_peg(-forces[i] / forces[i, 3], i, load, center) for i in range(len(forces))), key=lambda worst: worst.value
    )
    return Worst(max(worst.value, 0.0), worst.peg, worst.point, worst.direction)


def reaction(forces: Array, load: Load, center: tuple[float, float]) -> Worst:
    """The largest peg force with the least clamping (Brost & Goldberg 1996, see ``kernels.statics.reactions``)."""
    pairs = permutations(range(len(forces)), 2)
    return max(
        (of_peg(forces[j] - forces[i] * forces[j, 3] / forces[i, 3], j, load, center) for j, i in pairs),
        key=lambda worst: worst.value,
    )


def of_peg(coefficients: Array, peg: int, load: Load, center: tuple[float, float]) -> Worst:
    """As :func:`largest_of`, said of a peg."""
    worst = largest_of(coefficients, load, center)
    return Worst(worst.value, peg, worst.point, worst.direction)


def with_friction(motions: Array, load: Load, center: tuple[float, float], need: Worst, stiffness: float) -> float:
    """The jaw force that friction leaves needed; no more than without it, which a locked jaw may need less of."""
    least = resisted(motions, load, center)
    return min(least, need.value) if stiffness else least


def resisted(motions: Array, load: Load, center: tuple[float, float]) -> float:
    """The jaw force that friction leaves needed: the largest work of a load on the possible motions, never negative."""
    return max([0.0, *(largest_of(motion, load, center).value for motion in motions)])
