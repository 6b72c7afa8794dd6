"""Dowels on sale: the lengths of each diameter, and the standout of each above its plate.

A dowel sits in its hole at least 1.5 diameters deep (``conventions.DOWEL_DEPTH``), so the standout of a dowel
of length L is at most L - 1.5 d. Lengths and their sources are in ``data/dowels.toml``.
"""

from __future__ import annotations

import tomllib
from fractions import Fraction
from functools import cache
from importlib.resources import files

from attrs import frozen

from workhold.conventions import DOWEL_DEPTH, SAME_HEIGHT, SAME_SIZE
from workhold.units import INCH, Unit, find_unit

__all__ = ["DowelLengths", "SoldDowel", "find_shortest_dowel", "find_dowel_lengths", "list_standouts"]

# Inches are sold in sixteenths; diameters have thirty-seconds as well.
FINEST = 32


@frozen
class DowelLengths:
    """The lengths in which dowels of a diameter are sold.

    Parameters
    ----------
    standard : such as "ISO 8734".
    unit : unit in which the sizes are named.
    diameter, lengths : in mm, the lengths rising.
    """

    standard: str
    unit: Unit
    diameter: float
    lengths: tuple[float, ...]


@cache
def list_sold_dowels() -> tuple[DowelLengths, ...]:
    """Return one entry for each standard and diameter sold, standard by standard; read from
    ``data/dowels.toml``.
    """
    text = (files("workhold") / "data" / "dowels.toml").read_text(encoding="utf-8")
    found = []
    for entry in tomllib.loads(text)["lengths"]:
        unit = find_unit(entry["unit"])
        for diameter, shortest, longest in entry["sizes"]:
            lengths = tuple(unit.to_mm(one) for one in entry["steps"] if shortest <= one <= longest)
            found.append(DowelLengths(entry["name"], unit, unit.to_mm(diameter), lengths))
    return tuple(found)


def find_dowel_lengths(diameter: float) -> DowelLengths | None:
    """Return the lengths in which dowels of a diameter (mm) are sold; None if the diameter is not sold.

    >>> find_dowel_lengths(6.0).lengths[:4], find_dowel_lengths(6.35).standard, find_dowel_lengths(7.0)
    ((14.0, 16.0, 18.0, 20.0), 'ASME B18.8.2', None)
    """
    return next((one for one in list_sold_dowels() if abs(one.diameter - diameter) < SAME_SIZE), None)


def list_standouts(diameter: float) -> tuple[float, ...]:
    """Return, for each length in which a diameter (mm) is sold, the greatest standout in mm; ascending.

    Lengths that could not stand out are left out. The result is empty for a diameter that is not sold.

    >>> list_standouts(6.0)[:4]
    (5.0, 7.0, 9.0, 11.0)
    """
    known = find_dowel_lengths(diameter)
    deep = DOWEL_DEPTH * diameter
    every = () if known is None else (round(length - deep, 9) for length in known.lengths)
    return tuple(one for one in every if one > 0)


@frozen
class SoldDowel:
    """A dowel that is sold, with its standout above its plate.

    Parameters
    ----------
    standard, unit : as of :class:`DowelLengths`.
    diameter, length, standout : in mm.
    """

    standard: str
    unit: Unit
    diameter: float
    length: float
    standout: float

    @property
    def depth(self) -> float:
        """Depth in mm to which the dowel sits in its hole."""
        return self.length - self.standout

    @property
    def name(self) -> str:
        """Name under which to order the dowel: diameter x length, inches as fractions.

        >>> find_shortest_dowel(6.0, 11.0).name, find_shortest_dowel(6.35, 15.0).name, find_shortest_dowel(12.7, 30.0).name
        ('6 × 20 mm', '1/4 × 1 in', '1/2 × 2 in')
        """
        sizes = (format_dowel_size(size, self.unit) for size in (self.diameter, self.length))
        return f"{' × '.join(sizes)} {self.unit.abbreviation}"


def format_dowel_size(size: float, unit: Unit) -> str:
    """Return a size in mm as catalogues print it in the unit: inches as a fraction.

    >>> format_dowel_size(38.1, INCH), format_dowel_size(6.35, INCH)
    ('1-1/2', '1/4')
    """
    if unit is not INCH:
        return unit.format_short_length(size)
    inches = Fraction(size / unit.millimetres).limit_denominator(FINEST)
    whole, rest = divmod(inches, 1)
    return "-".join([*([str(whole)] if whole or not rest else []), *([str(rest)] if rest else [])])


def find_shortest_dowel(diameter: float, standout: float) -> SoldDowel | None:
    """Return the shortest dowel sold of a diameter that can stand out by ``standout``, both in mm.

    Return None where none is long enough, or the diameter is not sold.

    >>> dowel = find_shortest_dowel(6.0, 10.0)
    >>> dowel.length, dowel.depth
    (20.0, 10.0)
    """
    known = find_dowel_lengths(diameter)
    if known is None:
        return None
    least = standout + DOWEL_DEPTH * diameter - SAME_HEIGHT
    length = next((one for one in known.lengths if one >= least), None)
    return None if length is None else SoldDowel(known.standard, known.unit, diameter, length, standout)
