"""Strap clamps that press a part down onto the plate, beside locators that place it.

Glossary
--------
strap : a bar that a bolt in one of the plate's holes pulls down; its tip presses on the part, its heel on a block.
seat : the locators that place the part, with its pose.
place : a bolt's hole with the point on which its strap's tip presses.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

from attrs import field, frozen

from workhold.errors import InputError
from workhold.limits import convert_real, refuse_long

__all__ = ["MOST_STRAPS", "HandPush", "Strap", "StrapHardware", "StrappedHold"]

MOST_STRAPS = 4


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


@frozen
class Strap:
    """Where a strap presses.

    Parameters
    ----------
    hole : column and row of its bolt, as the fixture's pegs count them.
    at : of its tip, in mm in the plate's frame.
    height : of the face on which it presses above the plate, in mm, as high as its heel stands.
    """

    hole: tuple[int, int]
    at: tuple[float, float]
    height: float


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
    places : how many places for a strap there are.
    clamp_needed_each : the force in N of each strap that each load asks for; None where none is enough.
    max_force : that a strap is rated for, in N; None where nobody says.
    """

    straps: tuple[Strap, ...]
    push: HandPush | None
    places: int
    clamp_needed_each: tuple[float | None, ...] = ()
    max_force: float | None = None

    @property
    def clamp_needed(self) -> float | None:
        """The force in N of each strap that the worst load asks for; None without loads, and where none is enough."""
        each = [one for one in self.clamp_needed_each if one is not None]
        return max(each) if each and len(each) == len(self.clamp_needed_each) else None

    def as_data(self) -> dict[str, Any]:
        """What files and other programs are given."""
        push = self.push
        return {
            "straps": [
                {"hole": list(one.hole), "at": list(one.at), "over": "plate", "heel": one.height}
                for one in self.straps
            ],
            "supports": [],
            "push": None if push is None else {"at": list(push.at), "direction_deg": push.direction_deg},
            "places": self.places,
            "quality": {
                "full_contact": bool(self.straps),
                "clamp_needed": self.clamp_needed,
                "clamp_needed_each": list(self.clamp_needed_each),
            },
        }
