"""A dowel plate: locators in its holes, and one clamp or two that push along lines of holes.

One clamp: Brost & Goldberg 1996. With two, five pegs hold the part (a shop's 3-2-1): the locators alone fix its pose, and
the forces of both clamps together press it against them, those of neither alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from itertools import combinations_with_replacement, product
from math import inf, isfinite, isnan
from typing import Any, ClassVar

from attrs import evolve, field, frozen

from workhold.errors import InputError
from workhold.fixels.directions import DIRECTIONS
from workhold.limits import refuse_long
from workhold.model.flat import Flat, flat_of, resolved_flat
from workhold.model.lattice import optional_length, pair, refuse_lattice, refuse_many_holes, whole
from workhold.model.real import real
from workhold.model.setup_words import SetupWords
from workhold.model.toolkit import Arrangement, Carrier, Change, Limit, Symmetry, Toolkit, Travel, Wording
from workhold.model.units import Unit

__all__ = ["Plate"]


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


def direction_names(value: str | Iterable[Any] | None) -> tuple[Any, ...]:
    """Directions in the order in which they are listed, or pairs of them; none for None, which the plate resolves."""
    if value is None:
        return ()
    names = list(value) if isinstance(value, Iterable) and not isinstance(value, str) else [value]
    if not names:
        raise InputError(f"there is no direction for the clamp: choose among {', '.join(DIRECTIONS)}.")
    if any(isinstance(name, str) for name in names):
        for name in names:
            refuse_direction(name)
        return tuple(name for name in DIRECTIONS if name in names)
    pairs = [tuple(one) if isinstance(one, Iterable) else (one,) for one in names]
    for two in pairs:
        if len(two) != 2:
            raise InputError(f"{two} is no pair of directions: give two for the two clamps, such as ('-x', '-y').")
        for name in two:
            refuse_direction(name)
    every = product(DIRECTIONS, repeat=2)
    return tuple(one for one in every if one in {tuple(sorted(two, key=list(DIRECTIONS).index)) for two in pairs})


def refuse_direction(name: Any) -> None:
    """Refuse what is no direction of a clamp.

    Raises
    ------
    InputError
        Naming those that are.
    """
    if not isinstance(name, str) or name not in DIRECTIONS:
        raise InputError(f"direction {name!r} is none in which a clamp moves: choose among {', '.join(DIRECTIONS)}.")


def turned_half(name: str) -> str:
    """What half a turn makes of a direction."""
    return f"{'-' if name[0] == '+' else '+'}{name[1]}"


@frozen
class Plate(Toolkit):
    """A plate with a lattice of holes: three locators anywhere on it, and clamps on rows and columns of holes.

    Parameters
    ----------
    pitch : distance between neighbouring columns and rows in mm, one number or (x, y).
    peg_radius : of the locators in mm; 0 is allowed.
    columns, rows : of holes, or None for as many as needed.
    clamp_radius : of the clamp's round tip in mm; None means the peg radius.
    travel : least and most in mm from the hole that the clamp is bolted in to its tip, or None: then the clamp is its tip
        alone, and nothing is asked of its body.
    directions : in which the clamp may move when it clamps: among "-x", "+x", "-y" and "+y". None means all that differ by
        more than a turn of the plate. Of two clamps pairs, such as [("-x", "-y")]; directions that are no pairs stand for
        all pairs of them.
    clamps : 1, or 2 that are needed together.
    flat : of the locators, which lies on straight faces: its distance from a locator's centre, and half its width, in mm;
        None for round ones. A clamp's tip is round.

    Raises
    ------
    InputError
        For values that are not finite and positive, and for locators too fat for neighbouring holes.

    Examples
    --------
    >>> from workhold import Plate
    >>> Plate(pitch=20, peg_radius=3).directions, Plate(pitch=20, peg_radius=3, columns=8, rows=6).directions
    (('-x',), ('-x', '-y'))
    >>> Plate(pitch=20, peg_radius=3, clamps=2).directions
    (('-x', '-y'),)
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
    setup_words: ClassVar[SetupWords] = SetupWords(
        standing="Locators",
        located_by="Three locators",
        put="Put {peg}s in {holes} of the {plate}.",
        against="against all {count} {peg}s",
        touching="four pegs",
    )

    pitch: tuple[float, float] = field(converter=pair)
    peg_radius: float = field(converter=real)
    columns: int | None = field(default=None, converter=whole)
    rows: int | None = field(default=None, converter=whole)
    clamp_radius: float = field(default=None, converter=optional_length)
    travel: tuple[float, float] | None = field(default=None, converter=travel_pair)
    directions: tuple[Any, ...] = field(default=None, converter=direction_names)
    clamps: int = field(default=1, converter=whole)
    flat: Flat | None = field(default=None, converter=flat_of, kw_only=True)

    def __attrs_post_init__(self) -> None:
        if self.clamps not in (1, 2):
            raise InputError(f"clamps {self.clamps} cannot be: a plate has 1 or 2.")
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
        object.__setattr__(self, "directions", self.resolved_directions())
        object.__setattr__(self, "flat", resolved_flat(self.flat, self.peg_radius))
        lengths = {"pitch": max(self.pitch), "peg radius": self.peg_radius, "clamp radius": self.clamp_radius}
        for name, value in (lengths | {"travel": self.travel[1] if self.travel else 0.0}).items():
            refuse_long(name, value)
        refuse_many_holes(self.columns, self.rows, self.noun)

    @property
    def is_square(self) -> bool:
        """Whether a quarter turn of the plate leaves it as it is."""
        return self.pitch[0] == self.pitch[1] and self.columns == self.rows

    def resolved_directions(self) -> tuple[Any, ...]:
        """The directions, or pairs of them, that are meant.

        Raises
        ------
        InputError
            For pairs where there is one clamp.
        """
        names = self.directions
        if self.clamps == 1:
            if any(not isinstance(name, str) for name in names):
                raise InputError("the directions are pairs, but there is one clamp: give two clamps, or no pairs.")
            return names or self.usual_directions
        if not names:
            return self.usual_pairs
        return tuple(combinations_with_replacement(names, 2)) if isinstance(names[0], str) else names

    @property
    def usual_directions(self) -> tuple[str, ...]:
        """All directions that differ by more than a turn of the plate."""
        return ("-x",) if self.is_square else ("-x", "-y")

    @property
    def usual_pairs(self) -> tuple[tuple[str, str], ...]:
        """Two clamps square to each other, in all ways that differ by more than a turn of the plate."""
        return (("-x", "-y"),) if self.is_square else (("-x", "-y"), ("-x", "+y"))

    @property
    def distinct_directions(self) -> tuple[str, ...]:
        """The directions that clamps have, without those that half a turn of the plate makes of another one."""
        if self.clamps == 2:
            return tuple(name for name in DIRECTIONS if any(name in pair for pair in self.distinct_pairs))
        return tuple(name for name in self.directions if not (name[0] == "+" and f"-{name[1]}" in self.directions))

    @property
    def distinct_pairs(self) -> tuple[tuple[str, str], ...]:
        """The pairs of directions without those that half a turn of the plate makes of another one."""
        out: list[tuple[str, str]] = []
        for one, other in self.directions:
            if {(turned_half(one), turned_half(other)), (turned_half(other), turned_half(one))}.isdisjoint(out):
                out.append((one, other))
        return tuple(out)

    @property
    def arrangements(self) -> tuple[Arrangement, ...]:  # type: ignore[override]
        """Three locators and a clamp, once for each direction; or two clamps, once for each pair of directions."""
        names = self.distinct_directions
        if self.clamps == 1:
            return tuple(Arrangement("clamp", (3, *(int(other == name) for other in names)), name) for name in names)
        return tuple(
            Arrangement("clamp2", (3, *(pair.count(name) for name in names)), " ".join(pair))
            for pair in self.distinct_pairs
        )

    @cached_property
    def carriers(self) -> tuple[Carrier, ...]:
        """The plate, and for each direction the clamp, whose travel grows as it opens."""
        return self.plate_and_clamps((0.0, 0.0))

    def plate_and_clamps(self, offset: tuple[float, float]) -> tuple[Carrier, ...]:
        """The same with the first hole at a place in mm."""
        size = self.pitch, self.columns, self.rows, self.peg_radius, self.peg_radius
        plate = Carrier("plate", *size, offset, noun="plate", peg="locator", flat=self.flat)
        least, most = (-inf, None) if self.travel is None else (-self.travel[1], -self.travel[0])
        size = self.pitch, self.columns, self.rows, self.clamp_radius, self.clamp_radius
        clamp = Carrier("clamp", *size, offset, noun="clamp", peg="clamp", on="plate")
        return (
            plate,
            *(
                evolve(clamp, name=f"clamp {name}", travel=Travel(DIRECTIONS[name], least, most))
                for name in self.distinct_directions
            ),
        )

    @property
    def ways(self) -> tuple[Plate, ...]:
        """The plate with one clamp in one direction each time."""
        return tuple(evolve(self, clamps=1, directions=(name,)) for name in self.distinct_directions)

    @property
    def law(self) -> str:
        """That of one clamp, or of two."""
        return "plate" if self.clamps == 1 else "two clamps"

    @property
    def half_turned(self) -> tuple[int, ...] | None:
        """The plate takes its own place, and each clamp that of the one that pushes the other way."""
        names = [carrier.name for carrier in self.carriers]
        ahead = [f"clamp {turned_half(carrier.direction)}" for carrier in self.carriers[1:]]
        return (0, *(names.index(name) if name in names else -1 for name in ahead))

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
        if self.clamps == 2:
            yield Change("with one clamp", {"clamps": 1, "directions": None})
            if len(self.distinct_pairs) == 1:
                pairs = ("-x", "-y"), ("-x", "+y")
                yield Change("with the clamps along rows and columns either way", {"directions": pairs})
        if self.clamps == 1:
            yield Change("with a second clamp", {"clamps": 2, "directions": None})
            if len(self.distinct_directions) == 1:
                yield Change("with the clamp along the columns as well", {"directions": ("-x", "-y")})
        yield from self.finer()

    def finer(self) -> Iterator[Change]:
        """Half the pitch, where the locators are thin enough."""
        if min(self.pitch) >= 4 * self.peg_radius:
            half = (self.pitch[0] / 2, self.pitch[1] / 2)
            fields: dict[str, Any] = {"pitch": half}
            for name in ("columns", "rows"):
                count = getattr(self, name)
                fields |= {} if count is None else {name: 2 * count - 1}
            yield Change("with half the pitch", fields)
