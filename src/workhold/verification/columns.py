"""The fixtures of a result file in columns, number for number as it writes them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import degrees, nan
from pathlib import Path
from typing import Any, overload

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.archive import mapped_archive
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.columns import HEAD, columns_said
from workhold.model.fixture import Fixture, Pair, Peg, Pose
from workhold.model.force_ratio import ratios
from workhold.model.quality import FIGURES
from workhold.verification.claims import Claim
from workhold.verification.reading import with_working_forces

__all__ = ["Columns", "FixturesInColumns", "columns_of"]

Columns = Mapping[str, NDArray[Any]]

# Fixtures looked at together.
BLOCK = 1 << 14
LARGEST = 1e300
# Decimals of an angle in degrees.
DECIMALS = 10


def columns_of(path: Path) -> tuple[str, Columns]:
    """Head and columns of a file, all of which is read once to compare its checksums.

    Raises
    ------
    InputError
        When it is damaged.
    OSError
        When it cannot be read.
    """
    return mapped_archive(path, columns_said, HEAD, whole=True)


@frozen(eq=False)
class FixturesInColumns(Sequence[Fixture]):
    """The fixtures of columns; their pegs stand in the order of their type, in the holes of a toolkit.

    Raises
    ------
    InputError
        When one of them is of no type, or has a number that is none.
    """

    columns: Columns
    toolkit: Toolkit
    claims: tuple[Claim, ...] = ()

    def __attrs_post_init__(self) -> None:
        for start in range(0, len(self), BLOCK):
            block = {name: values[start : start + BLOCK] for name, values in self.columns.items()}
            usable = np.isin(block["arrangement"], range(len(self.toolkit.arrangements)))
            for name in ("theta", "position", "jaw_separation", "force"):
                usable &= (np.abs(block[name]).reshape(len(usable), -1) <= LARGEST).all(axis=1)
            usable &= ~np.isinf(block["quality"]).any(axis=1)
            if not usable.all():
                number = start + int(np.argmin(usable)) + 1
                raise InputError(f"number {number} in fixtures: it has no type, or a number that is none.")

    def __len__(self) -> int:
        return len(self.columns["arrangement"])

    def __iter__(self) -> Iterator[Fixture]:
        return (self[place] for place in range(len(self)))

    @overload
    def __getitem__(self, place: int) -> Fixture: ...

    @overload
    def __getitem__(self, place: slice) -> list[Fixture]: ...

    def __getitem__(self, place: int | slice) -> Fixture | list[Fixture]:
        if isinstance(place, slice):
            return [self[k] for k in range(len(self))[place]]
        made = self.made(place)
        # A place from the end is one from the start.
        place %= len(self)
        return evolve(made, seating=self.claims[place]) if place < len(self.claims) else made

    def made(self, place: int) -> Fixture:
        """The fixture of a place, without its seating."""
        numbers = {name: values[place].tolist() for name, values in self.columns.items()}
        arrangement, travelled = self.toolkit.arrangements[numbers["arrangement"]], numbers["jaw_separation"]
        pegs, pairs = [], isinstance(travelled, list)
        carriers = arrangement.carriers
        travels = [0.0] * (len(carriers) - 2) + travelled if pairs else [travelled] * len(carriers)
        each = (numbers[name] for name in ("column", "row", "face", "force"))
        for carrier, along, column, row, face, force in zip(carriers, travels, *each, strict=True):
            one = self.toolkit.carriers[carrier]
            x, y = one.place(column, row, along)
            if one.is_wall:
                # Where the part lies on it follows from the pose, and is not written.
                x = nan
            called = None if one.on is None or min(column, row) < 0 else one.place_name(column, row)
            # Nor which way a flat looks.
            looks = None if one.flat is None else nan
            pegs.append(Peg(one.name, column, row, x, y, face, 0.0 if pairs else force, called, flat_deg=looks))
        pose = Pose(round(degrees(numbers["theta"]), DECIMALS), *numbers["position"])
        figures = zip(FIGURES, numbers["quality"], strict=True)
        known = {figure.key: value for figure, value in figures if value == value}
        if not pairs:
            return Fixture(arrangement.name, tuple(pegs), pose, travelled, known, arrangement.direction)
        # The ends of its ratio follow from the reactions, and are not written.
        low, high = (float(end[0]) for end in ratios(np.array([numbers["force"]])))
        reactions = tuple((one, other) for one, other in numbers["force"])
        pair = Pair((travelled[0], travelled[1]), (low, high), reactions, numbers["pairs"])
        return with_working_forces(
            Fixture(arrangement.name, tuple(pegs), pose, travelled[0], known, arrangement.direction, pair)
        )
