"""Strap clamps that press a part down onto the plate, beside locators that place it.

Glossary
--------
strap : a bar that a bolt in one of the plate's holes pulls down; its tip presses on the part, its heel on a block.
seat : the locators that place the part, with its pose.
place : a bolt's hole with the point on which its strap's tip presses.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite
from typing import Any

from attrs import field, frozen

from workhold.errors import InputError
from workhold.fixels.strap_set import USUAL_STANDOUT, StrapSet
from workhold.limits import convert_real, refuse_long
from workhold.model.first_choice import has_house_order
from workhold.model.jaw_hold import ProgramJawForce, find_largest_force
from workhold.model.quality import Figure, make_figure_key

__all__ = [
    "MOST_STRAPS",
    "STRAP_FIGURES",
    "USUAL_SEATS",
    "HandPush",
    "Strap",
    "StrapHardware",
    "StrappedHold",
    "bound_safety",
    "choose_strap_ranking",
    "write_times",
]

MOST_STRAPS = 4
# What a force holds more times than this needs no force but for rounding.
MOST_TIMES = 1e6
# For so many of the best seats straps are sought where nobody says.
USUAL_SEATS = 20
# The figures of straps, in the order in which they are shown.
STRAP_FIGURES = (
    Figure(
        "clamp_needed",
        "N",
        False,
        "The force of each strap at its tip that the worst load asks for, with the safety factor.",
        0,
    ),
    Figure("slip_reserve", "", True, "The rated force of a strap divided by the force needed.", 2),
    Figure(
        "safety_reached",
        "",
        True,
        "How many times as large the loads may be before the straps fail.",
        2,
    ),
)
# What seats are ranked by, those that no hand's push seats last.
STRAP_RANKING = ("square", "clamp_needed", "location_error", "edge_distance")
# Further figures of seats that they can be ranked by.
SEAT_FIGURES = ("end_distance", "smallest_face")


def choose_strap_ranking(names: Sequence[str] | None) -> tuple[str, ...]:
    """Return the keys of the figures that rank seats under straps, from names as a user writes them.

    Return the usual order for None, and for the usual order of fixtures with clamps.

    >>> choose_strap_ranking(["location-error"])
    ('location_error',)
    """
    keys = [make_figure_key(name) for name in names or STRAP_RANKING]
    if has_house_order(keys) or keys == ["warnings"]:
        return STRAP_RANKING
    known = (*STRAP_RANKING, *SEAT_FIGURES)
    for key, name in zip(keys, names or STRAP_RANKING, strict=True):
        if key not in known:
            words = ", ".join(one.replace("_", "-") for one in known)
            raise InputError(f"{name!r} is not a figure of straps to rank by: choose among {words}.")
    if len(set(keys)) < len(keys):
        raise InputError(f"the figures to rank by, {', '.join(names or ())}, name one twice: name each once.")
    return tuple(keys)


def write_times(times: float) -> float | None:
    """Return a number of times for a file, rounded to twelve digits; None for inf."""
    return None if times == inf else float(f"{times:.12g}")


def bound_safety(
    force: float, safety: float, need: float | None, bare: float | None, still: float | None
) -> float:
    """Return a lower bound of the factor by which a load may grow on a part that straps hold with a given
    force.

    Without a weight it is exact. With a weight, which does not grow with the load, it is at most the true
    factor, because the force needed is convex in the factor.

    Parameters
    ----------
    force : given force of each strap, in N.
    safety : factor for which ``need`` is known.
    need : force in N of each strap that this multiple of the load needs, with the weight; None if no force is
        enough.
    bare : force in N that this multiple of the load needs without the weight; None if no force is enough.
    still : force in N that the weight alone needs; None if no force is enough.

    Examples
    --------
    >>> bound_safety(3000, 2, 1500, 1500, 0), bound_safety(3000, 2, 1500, 1600, 0), bound_safety(600, 2, 1500, 1500, 0)
    (4.0, 3.875, 0.8)
    """
    if need is None or still is None:
        return 0.0
    if force < need:
        return safety * max(force - still, 0.0) / (need - still)
    if bare is None:
        return safety
    # More times the load needs at most as much more force as the load alone does.
    times = inf if bare <= 0.0 else safety * (1.0 + (force - need) / bare)
    return times if times <= MOST_TIMES else inf


@frozen
class StrapHardware:
    """The straps available; lengths in mm.

    Parameters
    ----------
    count : number of straps that press on the part, 1 to 4.
    tip_radius : radius of a strap's round tip.
    reach : the least and the greatest distance of the tip from the middle of the bolt's hole.
    max_force : rated force of a strap in N; None if not known.
    height : height of a strap, with nut and stud, above the face that it presses on; None for six radii of
        its tip.

    Raises
    ------
    InputError
        For numbers that cannot be.
    """

    count: int = 2
    tip_radius: float = field(default=6.0, converter=convert_real)
    reach: tuple[float, float] = (20.0, 60.0)
    max_force: float | None = None
    height: float | None = None

    def __attrs_post_init__(self) -> None:
        if not 1 <= self.count <= MOST_STRAPS:
            raise InputError(f"{self.count} straps cannot be reckoned: give 1 to {MOST_STRAPS}.")
        if not (isfinite(self.tip_radius) and self.tip_radius > 0):
            raise InputError(
                f"tip radius {self.tip_radius:g} of a strap cannot be used: give a length above 0."
            )
        least, most = self.reach
        if not (isfinite(most) and 0 <= least <= most and most > 0):
            raise InputError(
                f"straps cannot reach from {least:g} to {most:g} mm: give the smaller distance first."
            )
        if self.max_force is not None and not (isfinite(self.max_force) and self.max_force > 0):
            raise InputError(f"straps rated for {self.max_force:g} N cannot be used: give a force above 0.")
        if self.height is not None and not (isfinite(self.height) and self.height > 0):
            raise InputError(f"straps {self.height:g} mm high cannot be used: give a length above 0.")
        refuse_long("the reach of a strap", most)
        refuse_long("the tip radius of a strap", self.tip_radius)

    @classmethod
    def from_straps(cls, straps: StrapSet) -> StrapHardware:
        """Return the hardware of a plate's straps."""
        return cls(straps.count, straps.tip_radius, straps.reach, straps.max_force, straps.standout)

    @property
    def standout(self) -> float:
        """Height in mm of a strap above the face that it presses on."""
        return USUAL_STANDOUT * self.tip_radius if self.height is None else self.height


@frozen
class Strap:
    """The place of a strap.

    Parameters
    ----------
    hole : (column, row) of its bolt, numbered as the fixture's pegs are, or in the bolts' own lattice.
    at : (x, y) of its tip in mm, in the plate's frame.
    height : height in mm above the plate of the face on which the tip presses, which is also the height of
        the heel's block; above the supports if their height is not known.
    over : (column, row) of the support below its tip; None if the part lies on the plate.
    """

    hole: tuple[int, int]
    at: tuple[float, float]
    height: float
    over: tuple[int, int] | None = None

    @property
    def written_over(self) -> list[int] | str:
        """[column, row] of the support below the tip, or "plate", as files have it."""
        return "plate" if self.over is None else list(self.over)


@frozen
class HandPush:
    """A push by hand that presses the part against all locators.

    Parameters
    ----------
    at : a place on the outline, in mm in the plate's frame.
    direction_deg : in degrees counter-clockwise from the plate's x axis.
    shares : force on each locator, as a fraction of the push.
    """

    at: tuple[float, float]
    direction_deg: float
    shares: tuple[float, ...]


@frozen
class StrappedHold:
    """The straps that hold a part against locators.

    Parameters
    ----------
    straps : straps in the order of their holes; empty where no places for them are found.
    push : the push by hand; None if no push presses the part against all locators.
    places : number of places for a strap or, if straps press over supports, of holes that may hold a support;
        None if straps were not searched.
    clamp_needed_each : force in N of each strap that each load needs; None where no force is enough.
    max_force : rated force of a strap in N; None if not known.
    is_looked_at : whether a push and, with loads, straps were searched; this is done for the best seats only.
    supports : (column, row) of the three supports under the part; empty if it lies on the plate.
    program_need : force of each strap that the program's tools need; None without their forces.
    safety_each : how many times the strap force that the query gives holds each load, then the program; 0
        where no force holds, inf where none is needed. Empty where no force is given.
    tip_radius, pad_radius, support_height : of straps that were asked for a fixture with side clamps, whose toolkit
        has none, in mm; None where the toolkit says it, and without supports.
    """

    straps: tuple[Strap, ...]
    push: HandPush | None
    places: int | None
    clamp_needed_each: tuple[float | None, ...] = ()
    max_force: float | None = None
    is_looked_at: bool = True
    supports: tuple[tuple[int, int], ...] = ()
    program_need: ProgramJawForce | None = None
    safety_each: tuple[float, ...] = ()
    tip_radius: float | None = None
    pad_radius: float | None = None
    support_height: float | None = None

    @property
    def needs(self) -> tuple[float | None, ...]:
        """Forces in N of each strap that each load needs, then the one the program needs; None where no force
        is enough.
        """
        of_program = () if self.program_need is None else (self.program_need.force,)
        return (*self.clamp_needed_each, *of_program)

    @property
    def clamp_needed(self) -> float | None:
        """Force in N of each strap that the worst load needs; None without loads, and if no force is enough."""
        return find_largest_force(self.needs)

    @property
    def is_unfit(self) -> bool:
        """Whether no push by hand presses the part against all locators."""
        return self.is_looked_at and self.push is None

    @property
    def slip_reserve(self) -> float | None:
        """Rated force of a strap over the force needed; inf where none is needed, None where either is
        unknown.
        """
        if self.max_force is None or self.clamp_needed is None:
            return None
        return self.max_force / self.clamp_needed if self.clamp_needed > 0 else inf

    @property
    def safety_reached(self) -> float | None:
        """Safety of the given force against the loads and the program: the least of ``safety_each``.

        It is inf if no force is needed, and None without a given force, and if no force is enough.
        """
        return min(self.safety_each) if self.safety_each and self.clamp_needed is not None else None

    @property
    def holds_nothing(self) -> bool:
        """Whether straps were searched, and either no places were found or no force holds some load."""
        if not self.is_looked_at or self.places is None:
            return False
        return not self.straps or None in self.needs

    @property
    def is_beyond_rating(self) -> bool:
        """Whether the loads need more than the rated force of a strap."""
        return self.slip_reserve is not None and self.slip_reserve < 1

    @property
    def figures(self) -> dict[str, float]:
        """Figures by key, without those that are None or inf."""
        named = {figure.key: getattr(self, figure.key) for figure in STRAP_FIGURES}
        return {key: float(value) for key, value in named.items() if value is not None and value != inf}

    def to_data(self) -> dict[str, Any]:
        """Return the hold as plain data, as result files and other programs get it."""
        push = self.push
        return {
            "straps": [
                {"hole": list(one.hole), "at": list(one.at), "over": one.written_over, "heel": one.height}
                for one in self.straps
            ],
            "supports": [list(one) for one in self.supports],
            "push": None if push is None else {"at": list(push.at), "direction_deg": push.direction_deg},
            "places": self.places,
            "quality": {
                "full_contact": bool(self.straps),
                "clamp_needed": self.clamp_needed,
                "clamp_needed_each": list(self.clamp_needed_each),
                **self.describe_safety(),
            },
        }

    def describe_safety(self) -> dict[str, Any]:
        """Return as plain data the safety of the given force against each load; {} without a given force.

        Null means that the load needs no force.
        """
        if not self.safety_each:
            return {}
        least, count = self.safety_reached, len(self.clamp_needed_each)
        known = {} if least is None else {"safety_reached": write_times(least)}
        return {**known, "safety_reached_each": [write_times(one) for one in self.safety_each[:count]]}
