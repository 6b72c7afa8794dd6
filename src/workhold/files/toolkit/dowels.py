"""Dowel pins of the standards, looked up by nominal diameter; the figures and their sources are in ``data/dowels.toml``."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files

from attrs import frozen

from workhold.conventions import SAME_SIZE
from workhold.errors import InputError
from workhold.model.dowel import DowelSize
from workhold.units import Unit, unit_named

__all__ = ["DowelSeries", "dowel_series", "dowel_size"]


@frozen
class DowelSeries:
    """The pins of one standard.

    Parameters
    ----------
    name : the standard, and its tolerance class where it has several.
    unit : in which the standard gives its sizes.
    source : where the figures are from.
    sizes : by increasing diameter, in mm.
    """

    name: str
    unit: Unit
    source: str
    sizes: tuple[DowelSize, ...]


@cache
def dowel_series() -> tuple[DowelSeries, ...]:
    """The standards whose pins are known.

    Examples
    --------
    >>> [series.name for series in dowel_series()]
    ['ASME B18.8.5M', 'ASME B18.8.2', 'ISO 2338 m6', 'ISO 2338 h8']
    """
    text = (files("workhold") / "data" / "dowels.toml").read_text(encoding="utf-8")
    found = []
    for entry in tomllib.loads(text)["series"]:
        unit = unit_named(entry["unit"])
        sizes = []
        for row in entry["sizes"]:
            nominal, *limits = (unit.length(number) for number in row)
            hole = (limits[2], limits[3]) if len(limits) == 4 else None
            sizes.append(DowelSize(nominal, (limits[0], limits[1]), hole))
        found.append(DowelSeries(entry["name"], unit, entry["source"], tuple(sizes)))
    return tuple(found)


def dowel_size(standard: str, diameter: float) -> DowelSize:
    """A standard's pin of a nominal diameter in mm.

    Raises
    ------
    InputError
        For a standard that is not known, and a diameter that it does not have.

    Examples
    --------
    >>> dowel_size("ASME B18.8.5M", 6.0).pin
    (6.003, 6.009)
    """
    for series in dowel_series():
        if series.name.lower() == " ".join(standard.lower().split()):
            for size in series.sizes:
                if abs(size.nominal - diameter) < SAME_SIZE:
                    return size
            sizes = ", ".join(series.unit.figure(size.nominal) for size in series.sizes)
            raise InputError(
                f"{series.name} has no dowel of {series.unit.figure(diameter)} {series.unit.abbreviation}: its sizes "
                f"are {sizes} {series.unit.abbreviation}."
            )
    names = ", ".join(series.name for series in dowel_series())
    raise InputError(f'dowel "{standard[:40]}" is not known: the standards are {names}.')
