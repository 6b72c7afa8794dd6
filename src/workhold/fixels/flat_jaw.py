"""A machine vise with one flat jaw: the part lies flush against it, two pegs on the jaw that moves press it
there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from math import pi
from typing import TYPE_CHECKING, Any

from attrs import evolve

from workhold.errors import InputError
from workhold.fixels import fields
from workhold.fixels.carrier import Heights
from workhold.fixels.making import (
    complete_and_check,
    make_class_from_table,
    make_lattice_carrier,
    make_wall_carrier,
    suggest_half_pitch,
)
from workhold.fixels.pegs import PegFlat
from workhold.fixels.setup_words import Datum, PageWords, SetupWords
from workhold.fixels.table import FieldTable, PageLabel
from workhold.fixels.toolkit import (
    Arrangement,
    Carrier,
    Toolkit,
    ToolkitChange,
    ToolkitLimit,
    ToolkitWording,
    Travel,
)
from workhold.units import Unit

__all__ = ["FlatJaw"]


@make_class_from_table
class FlatJaw(Toolkit):
    """A vise whose fixed jaw is flat, along x at y = 0, with a plate of pegs on the moving jaw, which slides
    along y.

    The part lies flush against the flat jaw, above it, on a hull edge: a straight piece of the boundary of
    its convex hull. Two pegs in holes of one lattice press it down as the jaw closes.

    Parameters
    ----------
    pitch : distance between neighbouring columns and rows in mm, one number or (x, y).
    peg_radius : in mm; 0 is allowed.
    columns, rows : of holes on the jaw that moves, or None for as many as needed.
    min_gap : smallest distance in mm from the flat jaw to the centres of the first row of holes; None means
        the peg radius.
    max_opening : largest distance in mm from the flat jaw to that row, or None for no limit.
    jaw_width : width of the flat jaw in mm, with the columns in its middle; None where it is endless. A width
        needs a number of columns.
    flat : of the pegs, see :class:`workhold.Vise`.
    jaw_heights, wall_heights : lower and upper end in mm, above the plane on which the part lies, of the pegs
        and of the flat jaw. None where they reach up to the peg height.
    supports, top_clamp, pins : the owner's supports under the part, clamp on top and limits of pins, as mappings
        of figures in mm and MPa (see ``fixels.support_hardware``); None for the usual ones.
    tolerance : how far these pegs and the faces that they touch may be off; None where not known.

    Raises
    ------
    InputError
        For values that are not finite and positive, and for pegs too thick for neighbouring holes. Also for a
        width of jaws without a number of columns.

    Examples
    --------
    >>> from workhold import FlatJaw
    >>> FlatJaw(pitch=10, peg_radius=3).min_gap
    3.0
    """

    kind = "flat-jaw"
    table = FieldTable(
        "flat-jaw vise",
        "A vise with one flat jaw, and pegs on the other",
        (
            *fields.ON_A_PLATE[:3],
            fields.PEG_RADIUS,
            fields.MIN_GAP.relabel(
                PageLabel("Smallest opening", "peg radius"),
                follows=fields.PEG_RADIUS.name,
                figure="smallest opening",
                at_least=fields.PEG_RADIUS.name,
                below="min gap {value:g} is less than the peg radius {least:g}: a peg in the first row would "
                "stand in the flat jaw; give the least distance from the flat jaw to that row, in mm.",
            ),
            fields.MAX_OPENING,
            fields.JAW_WIDTH,
            fields.FLAT,
            fields.JAW_HEIGHTS,
            fields.WALL_HEIGHTS.relabel(
                PageLabel("Heights of the flat jaw", "as all pegs"), figure="heights of the flat jaw"
            ),
        ),
    )
    noun = "flat-jaw vise"
    locked = "a screw vise, its jaw"
    law = "fence"
    arrangements = (Arrangement("flat", (2, 2)),)
    wording = ToolkitWording(
        two="two pegs",
        four="flat jaw and two pegs",
        inside="in this vise",
        within="the jaw as asked: with the columns, rows, opening and jaw width given",
        rules="presses the part against the flat jaw",
        backwards="the jaws are pressed apart, not when they close",
        holes="holes that the jaw does not have",
        sets="pairs of pegs",
        clear="smallest gap, and holes that the jaw has then",
        reasons=(
            "The part cannot lie flush against the flat jaw: no straight piece of its convex hull is there "
            "to lie on it, or none at an angle and on faces that are allowed.",
            (
                "No two pegs of the jaw can touch opposed sides of the part while it lies flush against the "
                "flat jaw."
            ),
            "Every face is parallel or square to the side that lies against the flat jaw: two pegs against "
            "two sides, or a side and the top, leave the part free to slide; a fence with two clamps holds "
            "such a part, and so does friction: between two flat jaws, in a plain vise such as plain-vise-6-inch, or under "
            "straps, on a plate such as strap-plate-20mm.",
            "Two pegs can touch the part at the same time, but no such pair presses it against the flat jaw.",
        ),
    )
    setup_words = SetupWords(
        standing="Pegs",
        located_by="The flat jaw",
        put="Put {peg}s in {holes} of the plate on the jaw that moves.",
        against="flush against the flat jaw",
        touching="flush",
        resting="flush against the flat jaw",
    )
    page = PageWords(
        "Vise with one flat jaw", "Close vise", {fields.PITCH.name: [10.0, 10.0], fields.PEG_RADIUS.name: 3.0}
    )

    pitch: tuple[float, float]
    peg_radius: float
    columns: int | None
    rows: int | None
    min_gap: float
    max_opening: float | None
    jaw_width: float | None
    flat: PegFlat | None
    jaw_heights: Heights | None
    wall_heights: Heights | None

    if TYPE_CHECKING:
        # As the table makes it, for editors and mypy; a test compares the two.
        def __init__(
            self,
            pitch: float | Iterable[float],
            peg_radius: float,
            columns: int | None = None,
            rows: int | None = None,
            min_gap: float | None = None,
            max_opening: float | None = None,
            jaw_width: float | None = None,
            *,
            flat: float | Iterable[float] | PegFlat | None = None,
            jaw_heights: Iterable[float] | None = None,
            wall_heights: Iterable[float] | None = None,
            supports: Any = None,
            top_clamp: Any = None,
            pins: Any = None,
            tolerance: Any = None,
        ) -> None: ...

    def __attrs_post_init__(self) -> None:
        complete_and_check(self, noun="jaw", peg="peg")
        if self.jaw_width is not None and self.columns is None:
            raise InputError(
                f"jaw width {self.jaw_width:g} says where the jaws end only beside a plate that ends as "
                "well: give the number of columns, or leave the jaw width out."
            )

    @property
    def limits(self) -> tuple[ToolkitLimit, ...]:
        """The limits that its fields set and that could be lifted.

        Lifting the number of columns also lifts the jaw width, since a width needs a number of columns.
        """
        found = super().limits
        if self.jaw_width is None:
            return found
        words = "with as many columns as needed, and a flat jaw as wide"
        free = {fields.COLUMNS.name: None, fields.JAW_WIDTH.name: None}
        return tuple(
            evolve(limit, lifted=ToolkitChange(words, free))
            if fields.COLUMNS.name in limit.lifted.fields
            else limit
            for limit in found
        )

    @cached_property
    def carriers(self) -> tuple[Carrier, ...]:
        """The flat jaw and the moving jaw. The travel is the distance from the flat jaw to the moving jaw's
        first row of holes.
        """
        travel = Travel(pi / 2, self.min_gap, self.max_opening)
        jaw = make_lattice_carrier(self, "jaw", travel=travel, noun="jaw", heights=self.jaw_heights)
        return make_wall_carrier(self, "flat jaw", self.jaw_width), jaw

    @property
    def datum(self) -> Datum:
        """The origin of places: the point at which column A meets the flat jaw. The rows move with their
        jaw.
        """
        wall, jaw = self.carriers
        return Datum.from_wall(wall, jaw)

    def list_further_changes(self, unit: Unit) -> Iterator[ToolkitChange]:
        """Yield the change to half the pitch, if the pegs are thin enough for it."""
        yield from suggest_half_pitch(self)
