"""A part between two flat jaws: the contact of each jaw, and the figures of the grip.

The frame is the vise's. The fixed jaw stands at y = 0 with the part above it, the moving jaw at y = S, the
opening. x runs along the jaws from the left end of the fixed one, and z is 0 at the part's lower side.

Glossary
--------
patch : the contact of two flat faces, as rectangles in one plane; the contact of an arc is a line without
    width.
band : the heights between which a face can be touched.
grip : the height that the bands of both jaws have in common.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Any

from attrs import field, frozen

from workhold.errors import InputError
from workhold.model.first_choice import has_house_order
from workhold.model.quality import Figure, make_figure_key

__all__ = [
    "HOLD_FIGURES",
    "HOLD_RANKING",
    "JawHold",
    "JawPatch",
    "ProgramJawForce",
    "Rectangle",
    "choose_hold_ranking",
    "find_largest_force",
]

# Least and greatest x, then least and greatest z, in mm.
Rectangle = tuple[float, float, float, float]
# The figures of a grip, in the order in which they are shown.
HOLD_FIGURES = (
    Figure(
        "clamp_needed",
        "N",
        False,
        "The jaw force that the worst load or tool asks for, with the safety factor.",
        0,
    ),
    Figure("slip_reserve", "", True, "The rated force of the vise divided by the jaw force needed.", 2),
    Figure(
        "safety_reached",
        "",
        True,
        "How many times as large the loads may be before the jaw force fails.",
        2,
    ),
    Figure("grip", "mm", True, "The height that both jaws grip."),
    Figure("above", "mm", True, "How far the part stands out above the jaws."),
    Figure("contact_area", "mm²", True, "The smaller of the two areas that the jaws touch.", 0),
    Figure(
        "max_pressure", "MPa", False, "The least that the largest pressure can be at the jaw force needed.", 2
    ),
)
# What a hold is ranked by, unfit ones last, and such as do not press all over or ask for more than the vise is rated
# for before them: square to the drawing, then figures, of which the area counts to two digits.
HOLD_RANKING = ("square", "contact_area", "clamp_needed", "above", "fixed_area")


def choose_hold_ranking(names: Sequence[str] | None) -> tuple[str, ...]:
    """Return the keys of the figures to rank holds between flat jaws by, from names as a user writes them.

    Return the usual order, :data:`HOLD_RANKING`, for None, and for an order that ranks fixtures with pegs.

    >>> choose_hold_ranking(["clamp-needed", "grip"])
    ('clamp_needed', 'grip')
    """
    keys = [make_figure_key(name) for name in names or HOLD_RANKING]
    if has_house_order(keys) or keys == ["warnings"]:
        return HOLD_RANKING
    figures = {figure.key: figure.option for figure in HOLD_FIGURES}
    for key, name in zip(keys, names or HOLD_RANKING, strict=True):
        if key not in figures and key not in HOLD_RANKING:
            known = ", ".join(figures.values())
            raise InputError(f"{name!r} is not a figure of flat jaws to rank by: choose among {known}.")
    if len(set(keys)) < len(keys):
        raise InputError(f"the figures to rank by, {', '.join(names or ())}, name one twice: name each once.")
    return tuple(keys)


@frozen
class JawPatch:
    """Contact of one flat jaw with the part.

    Parameters
    ----------
    rectangles : contact rectangles in mm, in order; a rectangle without width is a line.
    segments : numbers of the faces that touch; empty where only corners touch.
    is_corner : whether only corners touch, which the jaw would mark.
    """

    rectangles: tuple[Rectangle, ...]
    segments: tuple[int, ...]
    is_corner: bool = False

    @property
    def is_line(self) -> bool:
        """Whether all rectangles have no width."""
        return all(x1 <= x0 for x0, x1, _, _ in self.rectangles)

    @property
    def area(self) -> float:
        """Area in mm²; 0 for lines."""
        return sum((x1 - x0) * (z1 - z0) for x0, x1, z0, z1 in self.rectangles)

    @property
    def ends(self) -> tuple[float, float]:
        """Least and greatest x in mm."""
        return min(one[0] for one in self.rectangles), max(one[1] for one in self.rectangles)

    @property
    def band(self) -> tuple[float, float]:
        """Lower and upper height in mm of the range that all rectangles share; lower > upper if they share
        none.
        """
        return max(one[2] for one in self.rectangles), min(one[3] for one in self.rectangles)


@frozen
class ProgramJawForce:
    """The jaw force needed against the forces of a program's tools.

    Parameters
    ----------
    force : jaw force in N, with the safety factor; None if no jaw force is enough.
    line, tool : line of the program, and tool, for which this force is needed.
    move : index of that move in the program, from 0.
    """

    force: float | None
    line: int
    tool: int
    move: int


def find_largest_force(needs: Sequence[float | None]) -> float | None:
    """Return the largest of some forces in N; None if there are none, and if one of them is None."""
    known = [need for need in needs if need is not None]
    return max(known) if known and len(known) == len(needs) else None


@frozen
class JawHold:
    """Hold of a part between two flat jaws.

    Parameters
    ----------
    parallels : height in mm of the parallels under the part; 0 without parallels.
    stop : end of the jaws at which the work stop is; None without a stop.
    fixed, moving : contacts of the fixed and of the moving jaw.
    opening : S in mm.
    above : height in mm of the part above the jaws; None if its thickness is not known.
    full_contact : whether each jaw can press over its whole contact; if not, loads are not held.
    clamp_needed_each : jaw force in N that each load needs, in the order of loads; None if no force is
        enough.
    program_need : jaw force that the program's tools need; None without their forces.
    max_pressure : largest pressure in MPa at the jaw force needed; None if not known.
    max_force : rated force of the vise in N; None if not known.
    unit_force : given jaw force times the safety factor of the loads, in N; None where no jaw force is given.
    warnings : warnings as sentences.
    parallel_offsets : how far the parallels stand from the fixed and from the moving jaw, in mm; (0, 0) for
        one beside each jaw.
    """

    parallels: float
    stop: str | None
    fixed: JawPatch
    moving: JawPatch
    opening: float
    above: float | None
    full_contact: bool
    clamp_needed_each: tuple[float | None, ...] = ()
    program_need: ProgramJawForce | None = None
    max_pressure: float | None = None
    max_force: float | None = None
    unit_force: float | None = None
    warnings: tuple[str, ...] = field(default=())
    parallel_offsets: tuple[float, float] = (0.0, 0.0)

    @property
    def is_unfit(self) -> bool:
        """Whether a jaw touches corners only."""
        return self.fixed.is_corner or self.moving.is_corner

    @property
    def has_moved_parallels(self) -> bool:
        """Whether a parallel stands away from its jaw because tools come through the part beside the jaw."""
        return self.parallel_offsets != (0.0, 0.0)

    @property
    def parallels_across(self) -> tuple[float, float]:
        """Places y in mm of the outer sides of the parallels under the part."""
        near, far = self.parallel_offsets
        return near, self.opening - far

    @property
    def grip(self) -> float:
        """Height in mm that the bands of both jaws have in common; 0 where none."""
        (low, high), (other_low, other_high) = self.fixed.band, self.moving.band
        return max(min(high, other_high) - max(low, other_low), 0.0)

    @property
    def fixed_area(self) -> float:
        """Area in mm² that the fixed jaw touches."""
        return self.fixed.area

    @property
    def contact_area(self) -> float:
        """Smaller of the areas that the two jaws touch, in mm²."""
        return min(self.fixed.area, self.moving.area)

    @property
    def clamp_needed(self) -> float | None:
        """Jaw force in N that the worst load or tool needs; None without loads and program, and if no force
        is enough.
        """
        return find_largest_force(self.forces_needed)

    @property
    def forces_needed(self) -> tuple[float | None, ...]:
        """Jaw forces in N that each load needs, then the one that the program needs, if any; None if no force
        is enough.
        """
        of_program = () if self.program_need is None else (self.program_need.force,)
        return (*self.clamp_needed_each, *of_program)

    @property
    def slip_reserve(self) -> float | None:
        """Rated jaw force divided by the jaw force needed; inf if no force is needed, None if either is not
        known.
        """
        if self.max_force is None or self.clamp_needed is None:
            return None
        return self.max_force / self.clamp_needed if self.clamp_needed > 0 else inf

    @property
    def safety_reached(self) -> float | None:
        """Factor by which all loads can grow before they need more than the given jaw force.

        It is inf if no force is needed, and None if no jaw force is given or the one needed is not known.
        """
        if self.unit_force is None or self.clamp_needed is None:
            return None
        return self.unit_force / self.clamp_needed if self.clamp_needed > 0 else inf

    @property
    def safety_each(self) -> tuple[float, ...]:
        """Factor by which each load, then the program, can grow before it needs more than the given jaw
        force.

        It is 0 if no force is enough, and inf if none is needed. Empty without a given jaw force.
        """
        given = self.unit_force
        if given is None:
            return ()
        return tuple(
            0.0 if need is None else given / need if need > 0 else inf for need in self.forces_needed
        )

    @property
    def is_beyond_rating(self) -> bool:
        """Whether a load or the program needs more than the rated jaw force, or no force is enough."""
        if None in self.forces_needed:
            return True
        return self.slip_reserve is not None and self.slip_reserve < 1

    @property
    def figures(self) -> dict[str, float]:
        """Figures of :data:`HOLD_FIGURES` by key, without those that are None or inf."""
        named = {figure.key: getattr(self, figure.key) for figure in HOLD_FIGURES}
        return {key: float(value) for key, value in named.items() if value is not None and value != inf}

    def to_quality(self) -> dict[str, Any]:
        """Return the figures as result files have them, and "full_contact" and "clamp_needed_each"."""
        known: dict[str, Any] = {"tilt": 0.0, "full_contact": self.full_contact, **self.figures}
        if self.forces_needed:
            known["clamp_needed"] = self.clamp_needed
        if self.clamp_needed_each:
            known["clamp_needed_each"] = list(self.clamp_needed_each)
        return known
