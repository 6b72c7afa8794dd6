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
from workhold.fixels.strap_set import StrapSet
from workhold.limits import convert_real, refuse_long
from workhold.model.first_choice import has_house_order
from workhold.model.jaw_hold import ProgramJawForce
from workhold.model.quality import Figure

__all__ = [
    "MOST_STRAPS",
    "STRAP_FIGURES",
    "USUAL_SEATS",
    "HandPush",
    "Strap",
    "StrapHardware",
    "StrappedHold",
    "choose_strap_ranking",
]

MOST_STRAPS = 4
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
    Figure("slip_reserve", "", True, "What a strap is rated for, over the force needed.", 2),
)
# What seats are ranked by, those that no hand's push seats last.
STRAP_RANKING = ("square", "clamp_needed", "location_error", "edge_distance")
# Further figures of seats that they can be ranked by.
SEAT_FIGURES = ("end_distance", "smallest_face")


def choose_strap_ranking(names: Sequence[str] | None) -> tuple[str, ...]:
    """Return the figures that rank seats under straps, from a user's names; the usual order for None.

    An order that fixtures with clamps have stands for the usual one.

    >>> choose_strap_ranking(["location-error"])
    ('location_error',)
    """
    keys = [name.strip().lower().replace("-", "_").replace(" ", "_") for name in names or STRAP_RANKING]
    if has_house_order(keys) or keys == ["warnings"]:
        return STRAP_RANKING
    known = (*STRAP_RANKING, *SEAT_FIGURES)
    for key, name in zip(keys, names or STRAP_RANKING, strict=True):
        if key not in known:
            words = ", ".join(one.replace("_", "-") for one in known)
            raise InputError(f"{name!r} is no figure of straps to rank by: choose among {words}.")
    if len(set(keys)) < len(keys):
        raise InputError(f"the figures to rank by, {', '.join(names or ())}, name one twice: name each once.")
    return tuple(keys)


@frozen
class StrapHardware:
    """The straps that there are; lengths in mm.

    Parameters
    ----------
    count : how many press on the part, 1 to 4.
    tip_radius : of a strap's round tip.
    reach : the least and the greatest distance of the tip from the middle of the bolt's hole.
    max_force : that a strap is rated for, in N; None where nobody says.

    Raises
    ------
    InputError
        For numbers that cannot be.
    """

    count: int = 2
    tip_radius: float = field(default=6.0, converter=convert_real)
    reach: tuple[float, float] = (20.0, 60.0)
    max_force: float | None = None

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
        refuse_long("the reach of a strap", most)
        refuse_long("the tip radius of a strap", self.tip_radius)

    @classmethod
    def from_straps(cls, straps: StrapSet) -> StrapHardware:
        """Return the hardware of a plate's straps."""
        return cls(straps.count, straps.tip_radius, straps.reach, straps.max_force)


@frozen
class Strap:
    """Where a strap presses.

    Parameters
    ----------
    hole : column and row of its bolt, as the fixture's pegs count them, or in a lattice of bolts' own.
    at : of its tip, in mm in the plate's frame.
    height : of the face on which it presses above the plate, in mm, as high as its heel stands; above the
        supports where nobody says how high these are.
    over : column and row of the support below it; None where the part lies on the plate.
    """

    hole: tuple[int, int]
    at: tuple[float, float]
    height: float
    over: tuple[int, int] | None = None

    @property
    def written_over(self) -> list[int] | str:
        """What is below it, as files name it."""
        return "plate" if self.over is None else list(self.over)


@frozen
class HandPush:
    """A push by hand that presses the part against all locators.

    Parameters
    ----------
    at : a place on the outline, in mm in the plate's frame.
    direction_deg : in degrees counter-clockwise from the plate's x axis.
    shares : how hard each locator is pressed, as parts of the push.
    """

    at: tuple[float, float]
    direction_deg: float
    shares: tuple[float, ...]


@frozen
class StrappedHold:
    """How straps hold a part against locators.

    Parameters
    ----------
    straps : in order of their holes; none where they find no places.
    push : by hand; None where none presses the part against all locators.
    places : how many places for a strap there are, or holes that may hold a support where these are under it;
        None where none was sought.
    clamp_needed_each : the force in N of each strap that each load asks for; None where none is enough.
    max_force : that a strap is rated for, in N; None where nobody says.
    is_looked_at : whether a push was sought, and straps where there are loads; only for the best seats they are.
    supports : columns and rows of the three supports that the part lies on; none where it lies on the plate.
    program_need : what the tools of the program ask of each strap; None without their forces.
    """

    straps: tuple[Strap, ...]
    push: HandPush | None
    places: int | None
    clamp_needed_each: tuple[float | None, ...] = ()
    max_force: float | None = None
    is_looked_at: bool = True
    supports: tuple[tuple[int, int], ...] = ()
    program_need: ProgramJawForce | None = None

    @property
    def needs(self) -> tuple[float | None, ...]:
        """The force in N of each strap that each load, and the program, ask for; None where none is enough."""
        of_program = () if self.program_need is None else (self.program_need.force,)
        return (*self.clamp_needed_each, *of_program)

    @property
    def clamp_needed(self) -> float | None:
        """The force in N of each strap that the worst load asks for; None without loads, and where none is enough."""
        each = [one for one in self.needs if one is not None]
        return max(each) if each and len(each) == len(self.needs) else None

    @property
    def is_unfit(self) -> bool:
        """Whether no hand's push seats the part."""
        return self.is_looked_at and self.push is None

    @property
    def slip_reserve(self) -> float | None:
        """What a strap is rated for over what is needed; None where one of both is not known."""
        if self.max_force is None or self.clamp_needed is None:
            return None
        return self.max_force / self.clamp_needed if self.clamp_needed > 0 else inf

    @property
    def holds_nothing(self) -> bool:
        """Whether straps were sought, and found no places, or hold not all loads with any force."""
        if not self.is_looked_at or self.places is None:
            return False
        return not self.straps or None in self.needs

    @property
    def is_beyond_rating(self) -> bool:
        """Whether the loads ask for more than a strap is rated for."""
        return self.slip_reserve is not None and self.slip_reserve < 1

    @property
    def figures(self) -> dict[str, float]:
        """The figures that are known, by their keys."""
        named = {figure.key: getattr(self, figure.key) for figure in STRAP_FIGURES}
        return {key: float(value) for key, value in named.items() if value is not None and value != inf}

    def to_data(self) -> dict[str, Any]:
        """Return what files and other programs are given."""
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
            },
        }
