"""A dowel plate: locators in its holes, and one clamp or two that push along lines of holes.

One clamp is the fixture of Brost & Goldberg 1996. With two clamps five pegs hold the part (a shop's 3-2-1).
The locators alone fix its pose; only both clamps together press it against all of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from itertools import combinations_with_replacement
from math import inf
from typing import TYPE_CHECKING, Any, ClassVar

from workhold.errors import InputError
from workhold.fixels import fields
from workhold.fixels.carrier import Heights
from workhold.fixels.contacts import DIRECTIONS
from workhold.fixels.making import (
    complete_and_check,
    make_class_from_table,
    make_lattice_carrier,
    suggest_half_pitch,
)
from workhold.fixels.pegs import PegFlat
from workhold.fixels.setup_words import PageWords, SetupWords
from workhold.fixels.table import FieldTable
from workhold.fixels.toolkit import Arrangement, Carrier, Toolkit, ToolkitChange, ToolkitWording, Travel
from workhold.units import Unit

__all__ = ["Plate"]


# What half a turn of the plate makes of a direction.
TURNED = {"-x": "+x", "+x": "-x", "-y": "+y", "+y": "-y"}


@make_class_from_table
class Plate(Toolkit):
    """A plate with a lattice of holes: three locators in any of them, and clamps along rows and columns.

    Parameters
    ----------
    pitch : distance between neighbouring columns and rows in mm, one number or (x, y).
    peg_radius : of the locators in mm; 0 is allowed.
    columns, rows : of holes, or None for as many as needed.
    clamp_radius : of the clamp's round tip in mm; None means the peg radius.
    travel : smallest and largest distance in mm from the clamp's hole to its tip. None for any distance; then
        only the clamp's tip is considered, not its body.
    directions : directions in which the clamp may push, among "-x", "+x", "-y" and "+y". None for all that no
        turn of the plate makes equal. For two clamps give pairs, such as [("-x", "-y")]; single directions
        stand for all pairs of them.
    clamps : 1, or 2 that are needed together.
    flat : of the locators, which lies on straight faces: its distance from a locator's centre, and half its
        width, in mm; None for round locators. A clamp's tip is always round.
    locator_heights, clamp_heights : lower and upper end in mm, above the plane on which the part lies, of the
        locators, and of the clamps with their tips. None where they reach up to the peg height.
    supports, top_clamp, pins : the owner's supports under the part, clamp on top and limits of pins, as mappings
        of figures in mm and MPa (see ``fixels.support_hardware``); None for the usual ones.
    tolerance : how far these pegs and the faces that they touch may be off; None where not known.

    Raises
    ------
    InputError
        For values that are not finite and positive, and for locators too thick for neighbouring holes.

    Examples
    --------
    >>> from workhold import Plate
    >>> Plate(pitch=20, peg_radius=3).directions, Plate(pitch=20, peg_radius=3, columns=8, rows=6).directions
    (('-x',), ('-x', '-y'))
    >>> Plate(pitch=20, peg_radius=3, clamps=2).directions
    (('-x', '-y'),)
    """

    kind = "translating-clamp"
    table = FieldTable(
        "plate",
        "A plate with locators and a clamp",
        (
            *fields.ON_A_PLATE,
            fields.CLAMP_RADIUS,
            fields.TRAVEL,
            fields.CLAMPS,
            fields.DIRECTION,
            fields.FLAT,
            fields.LOCATOR_HEIGHTS,
            fields.CLAMP_HEIGHTS,
        ),
    )
    noun = "plate"
    locked = "a screw clamp,"
    # What fixtures with one clamp and with two are called, and the contacts that hold the part beside them.
    names = ("clamp", "clamp2")
    locating: ClassVar[tuple[int, ...]] = (3,)
    wording = ToolkitWording(
        two="two locators",
        four="three locators and a clamp",
        inside="on this plate",
        within=(
            "their places as asked: with the columns, rows and angles given, and clear of the clamp with its "
            "stroke"
        ),
        rules="closes and is pressed together by the clamp",
        backwards="the clamp pulls, not when it pushes",
        holes="holes that the plate does not have",
    )
    setup_words = SetupWords(
        standing="Locators",
        located_by="Three locators",
        put="Put {peg}s in {holes} of the {plate}.",
        against="against all {count} {peg}s",
        touching="four pegs",
    )
    page = PageWords(
        "Plate with one clamp or two",
        "Close clamp",
        {fields.PITCH.name: [20.0, 20.0], fields.PEG_RADIUS.name: 3.0, fields.CLAMPS.name: 1},
    )

    pitch: tuple[float, float]
    peg_radius: float
    columns: int | None
    rows: int | None
    clamp_radius: float
    travel: tuple[float, float] | None
    directions: tuple[Any, ...]
    clamps: int
    flat: PegFlat | None
    locator_heights: Heights | None
    clamp_heights: Heights | None

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
        ) -> None: ...

    def __attrs_post_init__(self) -> None:
        complete_and_check(self, noun=self.noun, peg="locator")
        object.__setattr__(self, "directions", self.list_asked_directions())

    @property
    def is_paired(self) -> bool:
        """Whether two clamps are needed together."""
        return self.clamps == 2

    def list_asked_directions(self) -> tuple[Any, ...]:
        """Return the directions in which the clamp may push, or the pairs of directions of two clamps, with
        defaults filled in.

        Raises
        ------
        InputError
            For pairs although there is one clamp.
        """
        are_names = all(isinstance(one, str) for one in self.directions)
        if not self.is_paired and not are_names:
            raise InputError(
                "the directions are pairs, but there is one clamp: give two clamps, or no pairs."
            )
        if self.is_paired and are_names and self.directions:
            return tuple(combinations_with_replacement(self.directions, 2))
        return self.directions or self.usual_directions

    @property
    def usual_directions(self) -> tuple[Any, ...]:
        """The default directions.

        For one clamp: "-x", and also "-y" unless rows and columns are alike in pitch and number. For two
        clamps, pairs of perpendicular directions: ("-x", "-y"), and also ("-x", "+y") unless rows and columns
        are alike. The other single directions, and the other perpendicular pairs, are equal to these after a
        turn of the plate.
        """
        holes = make_lattice_carrier(self, "plate")
        is_square = holes.pitch[0] == holes.pitch[1] and holes.columns == holes.rows
        every = (("-x", "-y"), ("-x", "+y")) if self.is_paired else ("-x", "-y")
        return every[:1] if is_square else every

    @property
    def pushes(self) -> tuple[tuple[str, ...], ...]:
        """The directions of the clamps of each arrangement, such as (("-x",), ("-y",)).

        Of two that half a turn of the plate makes equal, only the first is kept.
        """
        kept: list[tuple[str, ...]] = []
        for push in self.asked_pushes:
            if not any(sorted(TURNED[name] for name in push) == sorted(other) for other in kept):
                kept.append(push)
        return tuple(kept)

    @property
    def asked_pushes(self) -> tuple[tuple[str, ...], ...]:
        """The entries of ``directions``, each as a tuple with a direction for each clamp."""
        return self.directions if self.is_paired else tuple((name,) for name in self.directions)

    @property
    def clamp_directions(self) -> tuple[str, ...]:
        """All directions in which some clamp pushes, each once, in the order of ``DIRECTIONS``."""
        return tuple(name for name in DIRECTIONS if any(name in push for push in self.pushes))

    @property
    def arrangements(self) -> tuple[Arrangement, ...]:  # type: ignore[override]
        """One arrangement for each of ``pushes``: the numbers of contacts on the plate and on each clamp."""
        name, every = self.names[self.is_paired], self.clamp_directions
        return tuple(
            Arrangement(name, (*self.locating, *map(push.count, every)), " ".join(push))
            for push in self.pushes
        )

    @cached_property
    def carriers(self) -> tuple[Carrier, ...]:
        """The plate, and one clamp for each direction, whose travel grows as the clamp is opened."""
        return self.make_plate_and_clamps((0.0, 0.0))

    def make_plate_and_clamps(self, offset: tuple[float, float]) -> tuple[Carrier, ...]:
        """Return the plate, whose first hole is at ``offset`` (x, y) in mm, and one clamp for each
        direction.
        """
        plate = make_lattice_carrier(
            self, "plate", offset=offset, noun="plate", peg="locator", heights=self.locator_heights
        )
        least, most = (-inf, None) if self.travel is None else (-self.travel[1], -self.travel[0])
        clamps = (
            make_lattice_carrier(
                self,
                f"clamp {name}",
                peg_radius=self.clamp_radius,
                body_radius=self.clamp_radius,
                offset=offset,
                travel=Travel(DIRECTIONS[name], least, most),
                noun="clamp",
                peg="clamp",
                on="plate",
                flat=None,
                heights=self.clamp_heights,
            )
            for name in self.clamp_directions
        )
        return plate, *clamps

    @property
    def ways(self) -> tuple[Plate, ...]:
        """Toolkits with one clamp and otherwise the same fields, one for each direction of the clamp."""
        return tuple(
            self.with_fields({fields.CLAMPS.name: 1, fields.DIRECTION.name: (name,)})
            for name in self.clamp_directions
        )

    @property
    def law(self) -> str:  # type: ignore[override]
        """The key in ``batch.durations`` of the law for the duration of a search, for one clamp or for
        two.
        """
        return "two clamps" if self.is_paired else "plate"

    @property
    def half_turned(self) -> tuple[int, ...] | None:
        """For each carrier the index of the carrier onto which half a turn carries it.

        The plate is carried onto itself, a clamp onto the clamp with the opposite direction; -1 where there
        is none.
        """
        names = self.clamp_directions
        ahead = [TURNED[name] for name in names]
        return (0, *(1 + names.index(name) if name in names else -1 for name in ahead))

    def list_further_changes(self, unit: Unit) -> Iterator[ToolkitChange]:
        """Yield the changes that apply: another number of clamps, more directions, half the pitch."""
        if self.is_paired:
            yield ToolkitChange("with one clamp", {fields.CLAMPS.name: 1, fields.DIRECTION.name: None})
            if len(self.pushes) == 1:
                pairs = ("-x", "-y"), ("-x", "+y")
                yield ToolkitChange(
                    "with the clamps along rows and columns either way", {fields.DIRECTION.name: pairs}
                )
        if not self.is_paired:
            yield ToolkitChange("with a second clamp", {fields.CLAMPS.name: 2, fields.DIRECTION.name: None})
            if len(self.pushes) == 1:
                yield ToolkitChange(
                    "with the clamp along the columns as well", {fields.DIRECTION.name: ("-x", "-y")}
                )
        yield from suggest_half_pitch(self)
