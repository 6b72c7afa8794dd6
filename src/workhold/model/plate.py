"""A dowel plate: locators in its holes, and a clamp that pushes along a line of holes (Brost & Goldberg 1996)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import inf, isfinite, isnan, pi
from typing import Any, ClassVar

from attrs import evolve, field, frozen

from workhold.errors import InputError
from workhold.limits import refuse_long
from workhold.model.lattice import optional_length, pair, refuse_lattice, refuse_many_holes, whole
from workhold.model.real import real
from workhold.model.toolkit import Arrangement, Carrier, Change, Limit, Symmetry, Toolkit, Travel, Wording
from workhold.model.units import Unit

__all__ = ["DIRECTIONS", "Plate"]

# The ways a clamp may move when it clamps, in the order in which fixtures are listed, and the angle of the line along which
# its travel is counted, which is the other way.
DIRECTIONS = {"-x": 0.0, "+x": pi, "-y": pi / 2, "+y": -pi / 2}


def travel_pair(value: Iterable[float] | None) -> tuple[float, float] | None:
    """The least and the most that a clamp stretches, or None."""
    if value is None:
        return None
    numbers = tuple(value) if isinstance(value, Iterable) else (value,)
    if len(numbers) != 2:
        raise InputError(
            f"travel {value} is not two lengths: give the least and the most that the clamp stretches, in mm."
        )
    return real(numbers[0]), real(numbers[1])


def direction_names(value: str | Iterable[str] | None) -> tuple[str, ...]:
    """Directions in the order in which they are listed; none for None, which the plate resolves."""
    if value is None:
        return ()
    names = [value] if isinstance(value, str) else list(value)
    for name in names:
        if name not in DIRECTIONS:
            raise InputError(
                f"direction {name!r} is none in which a clamp moves: choose among {', '.join(DIRECTIONS)}."
            )
    if not names:
        raise InputError(f"there is no direction for the clamp: choose among {', '.join(DIRECTIONS)}.")
    return tuple(name for name in DIRECTIONS if name in names)


@frozen
class Plate(Toolkit):
    """A plate with a lattice of holes: three locators anywhere on it, and one clamp on a row or a column of holes.

    Parameters
    ----------
    pitch : distance between neighbouring columns and rows in mm, one number or (x, y).
    peg_radius : of the locators in mm; 0 is allowed.
    columns, rows : of holes, or None for as many as needed.
    clamp_radius : of the clamp's round tip in mm; None means the peg radius.
    travel : least and most in mm from the hole that the clamp is bolted in to its tip, or None: then the clamp is its tip
        alone, and nothing is asked of its body.
    directions : in which the clamp may move when it clamps: among "-x", "+x", "-y" and "+y". None means all that differ by
        more than a turn of the plate.

    Raises
    ------
    InputError
        For values that are not finite and positive, and for locators too fat for neighbouring holes.

    Examples
    --------
    >>> from workhold import Plate
    >>> Plate(pitch=20, peg_radius=3).directions, Plate(pitch=20, peg_radius=3, columns=8, rows=6).directions
    (('-x',), ('-x', '-y'))
    """

    kind: ClassVar[str] = "translating-clamp"
    noun: ClassVar[str] = "plate"
    locked: ClassVar[str] = "a screw clamp,"
    clamping: ClassVar[int] = 1
    symmetries: ClassVar[tuple[Symmetry, ...]] = ()
    wording: ClassVar[Wording] = Wording(
        two="two locators",
        four="three locators and a clamp",
        inside="on this plate",
        within="their places as asked: with the columns, rows and angles given, and clear of the clamp with its stroke",
        rules="closes and is pressed together by the clamp",
        backwards="the clamp pulls, not when it pushes",
        holes="holes that the plate does not have",
    )

    pitch: tuple[float, float] = field(converter=pair)
    peg_radius: float = field(converter=real)
    columns: int | None = field(default=None, converter=whole)
    rows: int | None = field(default=None, converter=whole)
    clamp_radius: float = field(default=None, converter=optional_length)
    travel: tuple[float, float] | None = field(default=None, converter=travel_pair)
    directions: tuple[str, ...] = field(default=None, converter=direction_names)

    def __attrs_post_init__(self) -> None:
        if isnan(self.clamp_radius):
            object.__setattr__(self, "clamp_radius", self.peg_radius)
        refuse_lattice(self.pitch, self.columns, self.rows, self.peg_radius, self.noun, "locator")
        if not (isfinite(self.clamp_radius) and self.clamp_radius >= 0):
            raise InputError(f"clamp radius {self.clamp_radius} is not a length: give 0 or more, in mm.")
        if self.travel is not None and not 0 <= self.travel[0] <= self.travel[1] < inf:
            raise InputError(
                f"travel {self.travel[0]:g} to {self.travel[1]:g} is none that a clamp has: give the least and the most "
                "from its hole to its tip, in mm."
            )
        if not self.directions:
            object.__setattr__(self, "directions", ("-x",) if self.is_square else ("-x", "-y"))
        lengths = {"pitch": max(self.pitch), "peg radius": self.peg_radius, "clamp radius": self.clamp_radius}
        for name, value in (lengths | {"travel": self.travel[1] if self.travel else 0.0}).items():
            refuse_long(name, value)
        refuse_many_holes(self.columns, self.rows, self.noun)

    @property
    def is_square(self) -> bool:
        """Whether a quarter turn of the plate leaves it as it is."""
        return self.pitch[0] == self.pitch[1] and self.columns == self.rows

    @property
    def distinct_directions(self) -> tuple[str, ...]:
        """The directions without those that half a turn of the plate makes of another one."""
        return tuple(name for name in self.directions if not (name[0] == "+" and f"-{name[1]}" in self.directions))

    @property
    def arrangements(self) -> tuple[Arrangement, ...]:  # type: ignore[override]
        """Three locators and a clamp, once for each direction."""
        names = self.distinct_directions
        return tuple(Arrangement("clamp", (3, *(int(other == name) for other in names)), name) for name in names)

    @property
    def carriers(self) -> tuple[Carrier, ...]:
        """The plate, and for each direction the clamp, whose travel grows as it opens."""
        size = self.pitch, self.columns, self.rows, self.peg_radius, self.peg_radius
        plate = Carrier("plate", *size, noun="plate", peg="locator")
        least, most = (-inf, None) if self.travel is None else (-self.travel[1], -self.travel[0])
        size = self.pitch, self.columns, self.rows, self.clamp_radius, self.clamp_radius
        clamp = Carrier("clamp", *size, noun="clamp", peg="clamp", on="plate")
        return (
            plate,
            *(
                evolve(clamp, name=f"clamp {name}", travel=Travel(DIRECTIONS[name], least, most))
                for name in self.distinct_directions
            ),
        )

    @property
    def ways(self) -> tuple[Plate, ...]:
        """The plate with one direction each time."""
        return tuple(evolve(self, directions=(name,)) for name in self.distinct_directions)

    @property
    def gap(self) -> None:
        """Locators may stand on any side of the clamp."""
        return None

    @property
    def limits(self) -> tuple[Limit, ...]:
        """The clamp's stroke, columns and rows, where there are any."""
        stroke = Change("with a clamp of any stroke", {"travel": None})
        columns = Change("with as many columns as needed", {"columns": None})
        rows = Change("with as many rows as needed", {"rows": None})
        known = (
            (self.travel is not None, Limit("stroke of the clamp", "travel", stroke)),
            (self.columns is not None, Limit("columns of holes", "holes", columns)),
            (self.rows is not None, Limit("rows of holes", "holes", rows)),
        )
        return tuple(limit for there, limit in known if there)

    def further_changes(self, unit: Unit) -> Iterator[Change]:
        """The clamp along rows and columns, and half the pitch."""
        if len(self.distinct_directions) == 1:
            yield Change("with the clamp along the columns as well", {"directions": ("-x", "-y")})
        if min(self.pitch) >= 4 * self.peg_radius:
            half = (self.pitch[0] / 2, self.pitch[1] / 2)
            fields: dict[str, Any] = {"pitch": half}
            for name in ("columns", "rows"):
                count = getattr(self, name)
                fields |= {} if count is None else {name: 2 * count - 1}
            yield Change("with half the pitch", fields)
