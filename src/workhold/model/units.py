"""Units of length: the program reckons in millimetres; people give and read other units as well."""

from __future__ import annotations

from attrs import frozen

from workhold.errors import InputError

__all__ = ["INCH", "MILLIMETRE", "Unit", "unit_named"]


@frozen
class Unit:
    """A unit of length, and how lengths are written in it.

    Parameters
    ----------
    name : what users call it.
    abbreviation : what stands behind a number.
    millimetres : millimetres in one unit.
    decimals : with which a length that has to be set is written: a micrometre, or a ten-thousandth of an inch (2.5 µm).
    """

    name: str
    abbreviation: str
    millimetres: float
    decimals: int

    def length(self, number: float) -> float:
        """The length in mm that a number of this unit means.

        Rounded at 1e-12 mm, so that 1.5 inch is the 38.1 mm that a metric drawing says, not its neighbour in floating
        point: coincidences of part and vise stay exact.

        >>> INCH.length(1.5), 1.5 * 25.4
        (38.1, 38.099999999999994)
        """
        return float(number) if self.millimetres == 1 else round(number * self.millimetres, 12)

    def number(self, length: float, decimals: int | None = None) -> str:
        """A length in mm as a number of this unit, without a negative zero.

        Parameters
        ----------
        length : in mm.
        decimals : the unit's own if None.

        Examples
        --------
        >>> INCH.number(12.7), MILLIMETRE.number(-0.0001), MILLIMETRE.number(12.7, 1)
        ('0.5000', '0.000', '12.7')
        """
        text = f"{length / self.millimetres:.{self.decimals if decimals is None else decimals}f}"
        return text.removeprefix("-") if float(text) == 0 else text

    def text(self, length: float, decimals: int | None = None) -> str:
        """A length in mm as a number of this unit and the unit behind it.

        >>> INCH.text(12.7), MILLIMETRE.text(24.125)
        ('0.5000 in', '24.125 mm')
        """
        return f"{self.number(length, decimals)} {self.abbreviation}"

    def figure(self, length: float, decimals: int | None = None) -> str:
        """A length in mm as a catalogue would print it: as many decimals as it takes and no more.

        >>> INCH.figure(12.7), MILLIMETRE.figure(20.0), MILLIMETRE.figure(12.7)
        ('0.5', '20', '12.7')
        """
        text = self.number(length, decimals)
        return text.rstrip("0").rstrip(".") if "." in text else text


MILLIMETRE = Unit("mm", "mm", 1.0, 3)
# Exact by definition (international inch, 1959).
INCH = Unit("inch", "in", 25.4, 4)
UNITS = {
    "mm": MILLIMETRE,
    "cm": Unit("cm", "cm", 10.0, 4),
    "m": Unit("m", "m", 1000.0, 6),
    "inch": INCH,
    "in": INCH,
    '"': INCH,
}


def unit_named(name: str) -> Unit:
    """The unit of a name, in any mixture of capitals.

    Raises
    ------
    InputError
        For a unit that is not known.

    Examples
    --------
    >>> unit_named("in").name, unit_named("MM").millimetres
    ('inch', 1.0)
    """
    try:
        return UNITS[name.strip().lower()]
    except KeyError:
        raise InputError(f"Unit '{name[:40]}' is not known: use mm, cm, m or inch.") from None
