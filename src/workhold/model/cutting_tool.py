"""A tool of the machine as a stack of upright cylinders."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf, isfinite
from typing import Any

from attrs import field, frozen

from workhold.errors import InputError
from workhold.limits import real, refuse_long
from workhold.model.cutting_data import CuttingData

__all__ = ["Cylinder", "Tool"]


def cylinders_of(values: Iterable[Cylinder]) -> tuple[Cylinder, ...]:
    """Cylinders as a tuple."""
    return tuple(values)


@frozen
class Cylinder:
    """An upright cylinder of a tool.

    Parameters
    ----------
    low, high : its heights in mm above the tip, closed.
    radius : in mm.

    Raises
    ------
    InputError
        For heights and a radius that make none.
    """

    low: float = field(converter=real)
    high: float = field(converter=real)
    radius: float = field(converter=real)

    def __attrs_post_init__(self) -> None:
        if not (0.0 <= self.low < self.high and isfinite(self.high) and 0.0 < self.radius < inf):
            raise InputError(
                f"a cylinder of a tool from {self.low:g} to {self.high:g} mm with a radius of "
                f"{self.radius:g} mm is none: give heights above the tip, the lower one first, and a "
                "positive radius."
            )
        refuse_long("a tool's length", self.high)
        refuse_long("a tool's radius", self.radius)


@frozen
class Tool:
    """A tool as a stack of cylinders: the flute, the shank, the holder.

    Parameters
    ----------
    number : as the program calls it, T; 0 is the one that is in the spindle at the start.
    cylinders : in any order; they may overlap.
    diameter : of the flute, in mm.
    name : what the workshop calls it.
    cutting : what is known of how it cuts; a file of a result has the forces instead.

    Raises
    ------
    InputError
        Without a cylinder, and for a number or a diameter that is none.
    """

    number: int
    cylinders: tuple[Cylinder, ...] = field(converter=cylinders_of)
    diameter: float = field(converter=real)
    name: str = ""
    cutting: CuttingData = field(factory=CuttingData, eq=False)

    def __attrs_post_init__(self) -> None:
        if not self.cylinders or not 0.0 < self.diameter < inf or self.number < 0:
            raise InputError(f"tool {self.number} has no diameter: give one in mm.")

    def to_dict(self) -> dict[str, Any]:
        """Plain data as in a result file."""
        rows = [[one.low, one.high, one.radius] for one in self.cylinders]
        return {"name": self.name, "diameter": self.diameter, "cylinders": rows}

    @classmethod
    def of_entries(cls, number: int, entries: Mapping[str, Any]) -> Tool:
        """A tool of a file's entries.

        Raises
        ------
        InputError, LookupError, TypeError, ValueError
            For entries that lack something, or hold what cannot be.
        """
        cylinders = [Cylinder(*row) for row in entries["cylinders"]]
        return cls(number, cylinders, entries["diameter"], str(entries.get("name", "")))
