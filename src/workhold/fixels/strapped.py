"""A dowel plate with strap clamps: three locators place the part, and straps hold it down by friction.

No clamp pushes the part sideways. A hand seats it against the locators until the straps are tight.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from math import floor, isfinite
from typing import TYPE_CHECKING, Any

from attrs import evolve

from workhold.errors import InputError
from workhold.fixels import fields
from workhold.fixels.carrier import Carrier
from workhold.fixels.making import (
    complete_and_check,
    make_class_from_table,
    make_lattice_carrier,
    suggest_half_pitch,
)
from workhold.fixels.setup_words import PageWords, SetupWords
from workhold.fixels.strap_set import USUAL_STANDOUT, StrapSet
from workhold.fixels.table import FieldTable, PageLabel
from workhold.fixels.toolkit import Arrangement, Toolkit, ToolkitChange, ToolkitWording
from workhold.units import Unit

__all__ = ["StrapPlate"]

# What part of a pitch counts as rounding.
ROUNDING = 1e-9
# A part lies on so many.
SUPPORTS = 3


@make_class_from_table
class StrapPlate(Toolkit):
    """A plate with a lattice of holes: three locators in any of them, and straps over the part.

    Parameters
    ----------
    pitch : distance between neighbouring columns and rows in mm, one number or (x, y).
    peg_radius : radius of the locators in mm, above 0; bolts have the same radius.
    columns, rows : of holes, or None for as many as needed.
    straps : number of straps that press the part down, 1 to 4.
    tip_radius : radius of a strap's round tip in mm.
    reach : least and greatest distance in mm from the middle of a bolt's hole to the tip of its strap.
    strap_height : height in mm of a strap, with nut and stud, above the face that it presses on, for
        collisions with tools; None for six radii of its tip.
    over : "plate" where the part lies on the plate, with its foot under each tip; "supports" where it lies on
        three supports, with each tip over one of them.
    bolt_pitch : distance between holes for bolts in mm, one number or (x, y); the pitch must be a whole
        multiple of it. None where bolts stand in the dowels' holes.
    bolt_offset : from the first dowel hole to the first hole for a bolt in mm, one number or (x, y).
    max_force : rated force of a strap in N; None where not known.
    supports, top_clamp, pins : see :class:`workhold.Plate`.
    tolerance : how far these pegs and the faces that they touch may be off; None where not known.

    Raises
    ------
    InputError
        For values that are not possible, and holes for bolts that do not repeat as the dowels' holes do.

    Examples
    --------
    >>> from workhold import StrapPlate
    >>> plate = StrapPlate(pitch=20, peg_radius=3, columns=8, rows=6, bolt_pitch=20, bolt_offset=10)
    >>> plate.strap_set.bolts.columns, plate.strap_set.bolts.compute_hole_center(0, 0)
    (7, (10.0, 10.0))
    """

    kind = "strapped"
    table = FieldTable(
        "plate with straps",
        "A plate with locators and straps",
        (
            *fields.ON_A_PLATE,
            fields.STRAPS,
            fields.TIP_RADIUS,
            fields.STRAP_REACH,
            fields.STRAP_HEIGHT,
            fields.STRAPS_OVER,
            fields.BOLT_PITCH,
            fields.BOLT_OFFSET,
            fields.MAX_FORCE.relabel(
                PageLabel("Rated force of a strap", "not known"),
                help="What each strap, or the vise, is rated for, in N or with its unit.",
            ),
        ),
    )
    noun = "plate"
    locked = "a strap with its nut,"
    law = "straps"
    arrangements = (Arrangement("strapped", (3,)),)
    wording = ToolkitWording(
        two="two locators",
        four="three locators",
        inside="on this plate",
        within="the plate as asked: with the columns, rows and angles given",
        rules="places the part",
        backwards="the locators pull, not when they push",
        holes="holes that the plate does not have",
        sets="sets of three locators",
        clear="locators clear of the part",
        reasons=(
            "No two locators can touch the part at the same time: the holes are too far apart for it, or none of "
            "its faces is allowed.",
            "No three locators place the part: where three touch it, it can still slide or turn.",
            "Three locators place the part, but not in holes and at angles that are there.",
        ),
    )
    setup_words = SetupWords(
        standing="Locators",
        located_by="Three locators",
        put="Put {peg}s in {holes} of the {plate}.",
        against="against all {count} {peg}s",
        touching="three locators",
        resting="against all three locators",
    )
    page = PageWords(
        "Plate with dowels and straps",
        "Tighten straps",
        {
            fields.PITCH.name: [20.0, 20.0],
            fields.PEG_RADIUS.name: 3.0,
            fields.COLUMNS.name: 8,
            fields.ROWS.name: 6,
            fields.STRAPS.name: 2,
        },
    )

    pitch: tuple[float, float]
    peg_radius: float
    columns: int | None
    rows: int | None
    straps: int
    tip_radius: float
    reach: tuple[float, float]
    strap_height: float | None
    over: str
    bolt_pitch: tuple[float, float] | None
    bolt_offset: tuple[float, float]
    max_force: float | None

    if TYPE_CHECKING:
        # As the table makes it, for editors and mypy; a test compares the two.
        def __init__(
            self,
            pitch: float | Iterable[float],
            peg_radius: float,
            columns: int | None = None,
            rows: int | None = None,
            straps: int = 2,
            tip_radius: float = 6.0,
            reach: Iterable[float] = (20.0, 60.0),
            strap_height: float | None = None,
            over: str = "plate",
            bolt_pitch: float | Iterable[float] | None = None,
            bolt_offset: float | Iterable[float] = 0.0,
            max_force: float | None = None,
            *,
            supports: Any = None,
            top_clamp: Any = None,
            pins: Any = None,
            tolerance: Any = None,
        ) -> None: ...

    def __attrs_post_init__(self) -> None:
        complete_and_check(self, noun=self.noun, peg="locator")
        least, most = self.reach
        if not 0 <= least <= most or most == 0:
            raise InputError(
                f"straps cannot reach from {least:g} to {most:g} mm: give the smaller distance first."
            )
        if self.over == "supports" and self.straps > SUPPORTS:
            raise InputError(
                f"{self.straps} straps do not find a support each, as the part lies on {SUPPORTS}: give 1 to "
                f"{SUPPORTS} straps, or let them press over the plate."
            )
        if self.bolt_pitch is None:
            if self.bolt_offset != (0.0, 0.0):
                raise InputError(
                    "the first hole for a bolt has a distance from the first dowel hole, but bolts have no holes of "
                    "their own: give their pitch, bolt_pitch."
                )
            return
        plate = self.carriers[0]
        for name, pitch, own, offset in zip(
            "xy", plate.pitch, self.bolt_pitch, self.bolt_offset, strict=True
        ):
            if not (isfinite(own) and own > 0):
                raise InputError(
                    f"the bolts' pitch {own:g} in {name} is not a positive length: give it in mm."
                )
            many = pitch / own
            if abs(many - round(many)) > ROUNDING:
                raise InputError(
                    f"holes for bolts every {own:g} mm do not repeat with dowel holes every {pitch:g} mm in {name}: give a "
                    "bolts' pitch of which the dowels' pitch is a whole multiple."
                )
            if not 0 <= offset < own:
                raise InputError(
                    f"the first hole for a bolt lies {offset:g} mm from the first dowel hole in {name}: give 0 or more, "
                    f"less than the bolts' pitch of {own:g} mm."
                )

    @cached_property
    def strap_set(self) -> StrapSet:
        standout = USUAL_STANDOUT * self.tip_radius if self.strap_height is None else self.strap_height
        return StrapSet(
            self.straps, self.tip_radius, self.reach, self.max_force, self.bolts, self.over, standout
        )

    @cached_property
    def carriers(self) -> tuple[Carrier, ...]:
        """The plate as the only carrier, which does not move."""
        return (make_lattice_carrier(self, "plate", noun="plate", peg="locator"),)

    @property
    def moving(self) -> Carrier:
        """A substitute for the moving carrier, with the words for a strap; it has no travel, since a strap
        does not move the part.
        """
        return evolve(self.carriers[0], name="strap", noun="strap", peg="strap")

    @property
    def bolts(self) -> Carrier:
        """The lattice of holes for bolts, no larger than that of the dowels; the plate itself if bolts have
        no separate holes.
        """
        plate = self.carriers[0]
        if self.bolt_pitch is None:
            return plate
        ends = [
            None if count is None else floor(((count - 1) * pitch - offset) / own + ROUNDING) + 1
            for count, pitch, own, offset in zip(
                (plate.columns, plate.rows), plate.pitch, self.bolt_pitch, self.bolt_offset, strict=True
            )
        ]
        return evolve(
            plate,
            name="bolts",
            pitch=self.bolt_pitch,
            columns=ends[0],
            rows=ends[1],
            offset=self.bolt_offset,
            peg="bolt",
        )

    @property
    def half_turned(self) -> tuple[int, ...] | None:
        """(0,) if half a turn maps the plate onto itself; None if it would move the holes for bolts."""
        if self.bolt_pitch is None:
            return (0,)
        twice = [2 * offset / own for offset, own in zip(self.bolt_offset, self.bolt_pitch, strict=True)]
        return (0,) if all(abs(one - round(one)) <= ROUNDING for one in twice) else None

    def list_further_changes(self, unit: Unit) -> Iterator[ToolkitChange]:
        """Yield the change to half the pitch, if the pegs are thin enough and bolts have no separate holes."""
        if self.bolt_pitch is None:
            yield from suggest_half_pitch(self)
