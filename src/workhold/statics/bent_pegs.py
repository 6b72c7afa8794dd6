"""How far the pegs of one fixture bend, peg by peg, in figures and in sentences (docs/quality.md, "Pins
bend")."""

from __future__ import annotations

from math import isnan

import numpy as np
from attrs import frozen

from workhold.conventions import STATED_FORCE
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.statics.judging import is_beyond
from workhold.statics.pins import PinRuns, compute_bent_pins, get_limits
from workhold.statics.quality import find_silhouette_extremes
from workhold.units import Unit

__all__ = ["BentPeg", "BentPegs", "describe_force", "compute_bent_pegs"]


@frozen
class BentPeg:
    """How far one peg bends; lengths in mm, forces in N, stresses in MPa.

    Parameters
    ----------
    hole : name of the peg's hole.
    peg : kind of peg, such as "locator".
    diameter : diameter of the peg.
    height : middle of the range of heights above the plate at which the part can press on the peg.
    top : height above the plate of the top of this range.
    force : force on the peg.
    deflection, stress : deflection and bending stress with the force at ``height``.
    worst_deflection, worst_stress : the same with the force at ``top``.
    """

    hole: str
    peg: str
    diameter: float
    height: float
    top: float
    force: float
    deflection: float
    stress: float
    worst_deflection: float
    worst_stress: float


@frozen
class BentPegs:
    """How far the pegs of a fixture bend.

    Parameters
    ----------
    pegs : the pegs that stand in holes of a plate.
    movement : largest movement of a point of the part by bending, in mm, with the forces at the pegs' middle
        heights.
    worst_movement : the same with the forces at the tops of the ranges of heights.
    jaw_force : jaw force in N; None if not given: the figures are then for 1 kN.
    stress_limit, movement_limit : limits of the toolkit, in MPa and mm.
    """

    pegs: tuple[BentPeg, ...]
    movement: float
    worst_movement: float
    jaw_force: float | None
    stress_limit: float
    movement_limit: float

    @property
    def most(self) -> BentPeg:
        """Peg with the largest deflection, forces at the middle heights."""
        return max(self.pegs, key=lambda peg: peg.deflection)

    @property
    def hardest(self) -> BentPeg:
        """Peg with the largest stress, forces at the middle heights."""
        return max(self.pegs, key=lambda peg: peg.stress)

    @property
    def is_overbent(self) -> bool:
        """Whether a peg's stress is above the limit at the given jaw force; False without one."""
        return self.jaw_force is not None and bool(is_beyond(self.hardest.stress, self.stress_limit))

    @property
    def gives_way(self) -> bool:
        """Whether the part's movement is above the limit at the given jaw force; False without one."""
        return self.jaw_force is not None and bool(is_beyond(self.movement, self.movement_limit))

    def describe_force(self, mover: str, unit: Unit) -> str:
        """Return the force that the figures hold for, in words; see :func:`describe_force`."""
        return describe_force(self.jaw_force, mover, unit)

    def describe_bending(self, mover: str, unit: Unit, location_error: float | None = None) -> str:
        """Return a sentence on the largest deflection, the largest stress and the movement of the part.

        ``mover`` is the name of the carrier that presses, such as "jaw"; a ``location_error`` in mm is
        mentioned as well if given.
        """
        most, hardest = self.most, self.hardest
        beside = (
            ""
            if location_error is None
            else f", on top of its location error of {unit.format_length(location_error)}"
        )
        at = self.describe_force(mover, unit)
        return (
            f"{at[0].upper()}{at[1:]} {most.hole} gives way most, by "
            f"{unit.format_length(most.deflection)} "
            f"(at worst {unit.format_length(self.worst.worst_deflection)}), and {hardest.hole} "
            f"is bent hardest, to {unit.format_stress(hardest.stress)}; that moves the part by up to "
            f"{unit.format_length(self.movement)}{beside}."
        )

    @property
    def worst(self) -> BentPeg:
        """Peg with the largest deflection, forces at the tops of the ranges of heights."""
        return max(self.pegs, key=lambda peg: peg.worst_deflection)

    def list_cautions(self, mover: str, unit: Unit) -> list[str]:
        """Return a sentence for each limit that is exceeded; none without a given jaw force."""
        found = []
        if self.is_overbent:
            peg = self.hardest
            found.append(
                f"{peg.hole} is bent to {unit.format_stress(peg.stress)} by {unit.format_force(peg.force)} "
                f"{unit.format_length(peg.height, 1 if unit.millimetres == 1 else 2)} above its plate, more than the "
                f"{unit.format_stress(self.stress_limit)} that a pin should take: use thicker or shorter pegs, or a smaller "
                f"{mover} force."
            )
        if self.gives_way:
            found.append(
                f"Pegs that bend let the part move by {unit.format_length(self.movement)}: use thicker or shorter ones, or "
                "probe the part after clamping."
            )
        return found

    def to_dict(self) -> dict[str, object]:
        """Return the figures as plain data: lengths in mm, forces in N, stresses in MPa."""
        names = ("height", "top", "force", "deflection", "stress", "worst_deflection", "worst_stress")
        return {
            "jaw_force": self.jaw_force,
            "stated_force": STATED_FORCE if self.jaw_force is None else self.jaw_force,
            "movement": self.movement,
            "worst_movement": self.worst_movement,
            "stress_limit": self.stress_limit,
            "movement_limit": self.movement_limit,
            "pegs": [
                {"hole": one.hole, "diameter": one.diameter} | {name: getattr(one, name) for name in names}
                for one in self.pegs
            ],
        }


def describe_force(jaw_force: float | None, mover: str, unit: Unit) -> str:
    """Return the force that pegs bend at as a phrase, such as "at a jaw force of 5 kN".

    Parameters
    ----------
    jaw_force : in N; None for the phrase "for each kN of …".
    mover : name of the carrier that presses, such as "jaw".
    """
    if jaw_force is not None:
        return f"at a {mover} force of {unit.format_force(jaw_force)}"
    return f"for each {'kN' if unit.newtons == 1 else unit.format_force(STATED_FORCE)} of {mover} force"


def compute_bent_pegs(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    *,
    pressed_top: float | None = None,
    jaw_force: float | None = None,
    lift: float = 0.0,
) -> BentPegs | None:
    """Return how far the pegs of a fixture bend.

    None without pegs in holes of plates, and if heights or forces on them are not known.

    Parameters
    ----------
    pressed_top : height in mm up to which pegs press on a prism; not needed for a solid.
    jaw_force : in N; None for figures at a jaw force of 1 kN.
    lift : height of the part above the plates, in mm.
    """
    if workpiece.solid is None and pressed_top is None:
        return None
    touched = TouchableFeatures.from_workpiece(workpiece, toolkit)
    contacts = touched.compute_for_fixture(fixture, toolkit)
    carriers = np.array([toolkit.find_carrier_numbers(peg.carrier for peg in fixture.pegs)])
    faces = np.array([[peg.face for peg in fixture.pegs]])
    runs = PinRuns.from_fixtures(faces, carriers, workpiece, toolkit, contacts.points, pressed_top, lift)
    silhouette = find_silhouette_extremes(workpiece)
    middle, worst = (
        compute_bent_pins(contacts, runs.diameter, heights, jaw_force, touched.length, silhouette)
        for heights in (runs.middle, runs.high)
    )
    force = (STATED_FORCE if jaw_force is None else jaw_force) * np.abs(contacts.inverses[0, 3])
    rows = [
        BentPeg(peg.hole, toolkit.find_carrier(peg.carrier).peg, *map(float, values))
        for peg, *values in zip(
            fixture.pegs,
            runs.diameter[0],
            runs.middle[0],
            runs.high[0],
            force,
            middle.deflection[0],
            middle.stress[0],
            worst.deflection[0],
            worst.stress[0],
            strict=True,
        )
        if not isnan(values[0])
    ]
    if not rows or any(isnan(peg.deflection) for peg in rows):
        return None
    moved = float(middle.movement[0]), float(worst.movement[0])
    return BentPegs(tuple(rows), *moved, jaw_force, *get_limits(toolkit))
