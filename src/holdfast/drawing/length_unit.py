"""Lengths in words: millimetres or inches, with a number of decimals."""

from __future__ import annotations

from attrs import frozen

from holdfast.drawing.scene import decimals_for

__all__ = ["LengthUnit"]

# Exact by definition (international inch, 1959).
MM_PER_INCH = 25.4


@frozen
class LengthUnit:
    """How lengths in mm are written.

    Parameters
    ----------
    name : "mm" or "inch", as it stands in headings.
    sign : as it stands behind a number.
    millimetres : in one unit.
    decimals : of a length.

    Examples
    --------
    >>> LengthUnit.mm().words(24.125), LengthUnit.inch().words(-25.4), LengthUnit.mm().number(-0.0)
    ('24.125 mm', '−1.0000 in', '0.000')
    """

    name: str
    sign: str
    millimetres: float
    decimals: int

    @classmethod
    def mm(cls, decimals: int = 3) -> LengthUnit:
        """Millimetres."""
        return cls("mm", "mm", 1.0, decimals)

    @classmethod
    def inch(cls, decimals: int = 4) -> LengthUnit:
        """Inches; four decimals are about as fine as three of a millimetre."""
        return cls("inch", "in", MM_PER_INCH, decimals)

    @classmethod
    def for_pitch(cls, name: str, pitch: float) -> LengthUnit:
        """The unit of a name ("mm" or "inch") with decimals that suit a vise of a pitch in mm."""
        decimals = decimals_for(pitch)
        return cls.mm(decimals) if name == "mm" else cls.inch(decimals + 1)

    def number(self, length: float, decimals: int | None = None) -> str:
        """A length in mm as a number of this unit, with a real minus sign and no negative zero."""
        text = f"{length / self.millimetres:.{self.decimals if decimals is None else decimals}f}"
        return text.removeprefix("-") if float(text) == 0 else text.replace("-", "−")

    def words(self, length: float, decimals: int | None = None) -> str:
        """A length in mm with the sign of the unit."""
        return f"{self.number(length, decimals)} {self.sign}"

    def plain(self, length: float, digits: int = 6) -> str:
        """A length in mm, such as a pitch, with as few decimals as it has and at most so many digits.

        >>> LengthUnit.inch().plain(12.7), LengthUnit.mm().plain(10.0)
        ('0.5 in', '10 mm')
        """
        return f"{length / self.millimetres:.{digits}g} {self.sign}"
