"""A fence: a straight wall that the part lies flush against, one locator as a stop, and a clamp (Overmars et
al. 1995).

Reference: M. Overmars, A. Rao, O. Schwarzkopf, C. Wentink, *Immobilizing polygons against a wall*, ACM
Symposium on Computational Geometry (1995).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

from workhold.fixels import fields
from workhold.fixels.carrier import Heights
from workhold.fixels.contacts import DIRECTIONS
from workhold.fixels.making import make_class_from_table, make_wall_carrier, suggest_half_pitch
from workhold.fixels.pegs import PegFlat
from workhold.fixels.plate import Plate
from workhold.fixels.setup_words import Datum, PageWords, SetupWords
from workhold.fixels.table import FieldTable, PageLabel
from workhold.fixels.toolkit import Carrier, ToolkitChange, ToolkitWording
from workhold.units import Unit

__all__ = ["Fence"]


@make_class_from_table
class Fence(Plate):
    """A plate with a straight fence along x at y = 0: the part lies flush against it, above it.

    One locator stands in a hole and one clamp on a row or a column of holes, as on a :class:`workhold.Plate`.
    The fence touches the part at both ends of a hull edge, a straight piece of the boundary of the part's
    convex hull.

    Parameters
    ----------
    pitch, peg_radius, columns, rows, clamp_radius, travel : see :class:`workhold.Plate`; rows count from the
        fence.
    directions : directions in which the clamp may push, among "-x", "+x", "-y" and "+y"; None for all four.
    wall_offset : distance in mm from the fence to the first row of holes, the peg radius or more.
    locator_heights, clamp_heights : see :class:`workhold.Plate`.
    wall_heights : lower and upper end of the fence in mm, above the plane on which the part lies; None where
        it reaches up to the peg height.
    supports, top_clamp, pins : the owner's supports under the part, clamp on top and limits of pins, as mappings
        of figures in mm and MPa (see ``fixels.support_hardware``); None for the usual ones.
    tolerance : how far these pegs and the faces that they touch may be off; None where not known.

    Raises
    ------
    InputError
        As of a plate, and for a first row in which a locator would stand in the fence.

    Examples
    --------
    >>> from workhold import Fence
    >>> Fence(pitch=20, peg_radius=3, wall_offset=10).directions
    ('-x', '+x', '-y', '+y')
    """

    kind = "edge"
    table = FieldTable(
        "fence",
        "A fence with a locator and a clamp",
        (
            *fields.ON_A_PLATE,
            fields.WALL_OFFSET,
            fields.CLAMP_RADIUS,
            fields.TRAVEL,
            fields.CLAMPS,
            fields.DIRECTION.relabel(
                PageLabel(
                    "The clamp pushes", "any way", several=True, choices=fields.WAYS, when=fields.ONE_CLAMP
                ),
                PageLabel(
                    "The clamps push",
                    "down and aside",
                    several=True,
                    choices=fields.ALL_PAIRS,
                    when=fields.TWO_CLAMPS,
                ),
            ),
            fields.FLAT,
            fields.LOCATOR_HEIGHTS,
            fields.CLAMP_HEIGHTS,
            fields.WALL_HEIGHTS.relabel(
                PageLabel("Heights of the fence", "as all pegs"), figure="heights of the fence"
            ),
        ),
    )
    noun = "fence"
    law = "fence"
    names = ("edge", "edge2")
    locating = (1, 2)
    wording = ToolkitWording(
        two="fence and locator",
        four="fence, locator and clamp",
        inside="on this fence",
        within=(
            "their places as asked: with the columns and rows given, and clear of the clamp with its stroke"
        ),
        rules="presses the part against the fence and the locator",
        backwards="the clamp pulls, not when it pushes",
        holes="holes that the plate does not have",
        sets="pairs of locator and clamp",
        reasons=(
            "The part cannot lie flush against a fence: no straight piece of its convex hull is there to lie "
            "on it, or none at an angle and on faces that are allowed.",
            (
                "No locator in a row of holes can touch a side of the part while it lies flush against the "
                "fence."
            ),
            "Every face that locator and clamp could touch is parallel or square to the side that lies "
            "against the fence: they would have to cover three directions beside the fence's, which takes a "
            "second clamp, or friction: between two flat jaws, in a plain vise such as plain-vise-6-inch, or under straps, "
            "on a plate such as strap-plate-20mm.",
            "Locator and clamp can touch the part on the fence at the same time, but no such pair presses it "
            "against fence and locator.",
        ),
    )
    setup_words = SetupWords(
        standing="Fence and locator",
        located_by="Fence and locator",
        put=(
            "Fix the fence along the rows, its edge {edge} from the centres of row 1, and put the {peg} in "
            "{holes} of the {plate}."
        ),
        against="flush on the fence and against the {peg}",
        touching="flush",
        resting="flush on the fence",
    )
    page = PageWords(
        "Fence with a stop, one clamp or two",
        "Close clamp",
        {
            fields.PITCH.name: [20.0, 20.0],
            fields.PEG_RADIUS.name: 3.0,
            fields.WALL_OFFSET.name: 10.0,
            fields.CLAMPS.name: 1,
        },
    )

    wall_offset: float
    wall_heights: Heights | None

    if TYPE_CHECKING:
        # As the table makes it, for editors and mypy; a test compares the two.
        def __init__(
            self,
            pitch: float | Iterable[float],
            peg_radius: float,
            columns: int | None = None,
            rows: int | None = None,
            clamp_radius: float | None = None,
            travel: Iterable[float] | None = None,
            directions: str | Iterable[str] | Iterable[tuple[str, str]] | None = None,
            clamps: int = 1,
            *,
            flat: float | Iterable[float] | PegFlat | None = None,
            locator_heights: Iterable[float] | None = None,
            clamp_heights: Iterable[float] | None = None,
            supports: Any = None,
            top_clamp: Any = None,
            pins: Any = None,
            tolerance: Any = None,
            wall_offset: float,
            wall_heights: Iterable[float] | None = None,
        ) -> None: ...

    @property
    def usual_directions(self) -> tuple[Any, ...]:
        """The default directions of the clamp: all four.

        With two clamps they are the pairs of one clamp down onto the fence and one along it, either way.
        """
        return (("-x", "-y"), ("+x", "-y")) if self.is_paired else tuple(DIRECTIONS)

    @property
    def pushes(self) -> tuple[tuple[str, ...], ...]:
        """The directions of the clamps of each arrangement, such as (("-x",), ("-y",)): all that were asked
        for.

        No two are equal by symmetry, since half a turn would move the fence to the other side.
        """
        return self.asked_pushes

    @property
    def datum(self) -> Datum:
        """The origin of places: the point at which column A meets the fence."""
        plate, wall, *_ = self.carriers
        return Datum.from_wall(wall, plate)

    @property
    def half_turned(self) -> None:
        """None, as half a turn would move the fence to the other side."""
        return None

    def list_further_changes(self, unit: Unit) -> Iterator[ToolkitChange]:
        """Yield the changes that apply: a second clamp, a clamp in all four directions, half the pitch."""
        if not self.is_paired:
            yield ToolkitChange("with a second clamp", {fields.CLAMPS.name: 2, fields.DIRECTION.name: None})
        if not self.is_paired and len(self.directions) < len(DIRECTIONS):
            yield ToolkitChange(
                "with the clamp in any of the four directions", {fields.DIRECTION.name: tuple(DIRECTIONS)}
            )
        yield from suggest_half_pitch(self)

    @cached_property
    def carriers(self) -> tuple[Carrier, ...]:
        """The plate, the fence, and one clamp for each direction, in this order."""
        plate, *clamps = self.make_plate_and_clamps((0.0, self.wall_offset))
        return plate, make_wall_carrier(self, "fence"), *clamps
