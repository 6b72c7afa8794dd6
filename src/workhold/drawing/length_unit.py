"""Lengths in words on pictures: in a unit, with decimals that suit the size of what is drawn."""

from __future__ import annotations

from attrs import frozen

from workhold.drawing.scene import decimals_for
from workhold.units import MILLIMETRE, Unit

__all__ = ["LengthUnit"]


@frozen
class LengthUnit:
    """How a picture writes lengths.

    Parameters
    ----------
    unit : what they are written in.
    decimals : of a length.

    Examples
    --------
    >>> from workhold.units import INCH
    >>> LengthUnit.mm().words(24.125), LengthUnit.suiting(INCH, 10.0).words(-25.4), LengthUnit.mm().number(-0.0)
    ('24.125 mm', '−1.0000 in', '0.000')
    """

    unit: Unit
    decimals: int

    @classmethod
    def mm(cls, decimals: int = MILLIMETRE.decimals) -> LengthUnit:
        """Millimetres."""
        return cls(MILLIMETRE, decimals)

    @classmethod
    def suiting(cls, unit: Unit, length: float) -> LengthUnit:
        """A unit with decimals that suit a picture whose typical length is ``length`` mm, such as a vise's pitch."""
        return cls(unit, unit.decimals + decimals_for(length) - decimals_for(1.0))

    @property
    def sign(self) -> str:
        """What stands behind a number."""
        return self.unit.abbreviation

    def number(self, length: float) -> str:
        """A length in mm as a number of this unit, with a real minus sign and no negative zero."""
        return self.unit.number(length, self.decimals).replace("-", "−")

    def words(self, length: float) -> str:
        """A length in mm with the sign of the unit."""
        return f"{self.number(length)} {self.sign}"

    def short(self, length: float, digits: int = 6) -> str:
        """A length in mm, such as a pitch, with as few decimals as it has and at most so many digits.

        >>> LengthUnit.mm().short(12.7), LengthUnit.mm().short(10.0)
        ('12.7 mm', '10 mm')
        """
        return f"{self.short_number(length, digits)} {self.sign}"

    def short_number(self, length: float, digits: int = 6) -> str:
        """As `short`, without the sign of the unit."""
        return f"{length / self.unit.millimetres:.{digits}g}"
