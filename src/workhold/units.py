"""Units of length, each with its unit of force; inside the program all numbers are in mm and N."""

from __future__ import annotations

import re
from math import ceil, floor, inf

from attrs import frozen

from workhold.errors import InputError

__all__ = [
    "INCH",
    "MILLIMETRE",
    "PIXELS",
    "POUND",
    "Unit",
    "find_drawing_unit",
    "find_pixels_per_inch",
    "find_unit",
    "format_rounded_down",
    "format_times",
]

# N in a pound-force: 0.453 592 37 kg under 9.806 65 m/s2, both exact by definition (1959 and 1901).
POUND = 0.45359237 * 9.80665
# MPa in a thousand pound-force to the square inch (25.4 mm).
KSI = 1000 * POUND / 25.4**2
ROUNDING = 1e-9


@frozen
class Unit:
    """A unit of length, and the way in which lengths, forces and stresses are written with it.

    Parameters
    ----------
    name : the unit's name, as users write it.
    abbreviation : text that follows a number.
    millimetres : millimetres in one unit.
    decimals : number of decimals with which a length that has to be set is written: down to 1 µm, or 0.0001
        inch (2.5 µm).
    force, newtons : abbreviation of the unit of force that goes with this unit of length, and the number of
        newtons in one of that unit of force.
    """

    name: str
    abbreviation: str
    millimetres: float
    decimals: int
    force: str = "N"
    newtons: float = 1.0

    def to_mm(self, number: float) -> float:
        """Return a length, given as a number in this unit, in mm; it is rounded to 1e-12 mm.

        Thus 1.5 inch is the 38.1 mm that a metric drawing says, not its neighbour in floating point, and
        coincidences of part and vise stay exact.

        >>> INCH.to_mm(1.5), 1.5 * 25.4
        (38.1, 38.099999999999994)
        """
        return float(number) if self.millimetres == 1 else round(number * self.millimetres, 12)

    def format_number(self, length: float, decimals: int | None = None) -> str:
        """Return a length in mm as a number in this unit, without the unit and without a negative zero.

        Parameters
        ----------
        length : in mm.
        decimals : number of decimals; ``self.decimals`` if None.

        Examples
        --------
        >>> INCH.format_number(12.7), MILLIMETRE.format_number(-0.0001), MILLIMETRE.format_number(12.7, 1)
        ('0.5000', '0.000', '12.7')
        """
        text = f"{length / self.millimetres:.{self.decimals if decimals is None else decimals}f}"
        return text.removeprefix("-") if float(text) == 0 else text

    def format_length(self, length: float, decimals: int | None = None) -> str:
        """Return a length in mm as text with this unit's abbreviation, such as "24.125 mm".

        ``decimals`` is the number of decimals; ``self.decimals`` if None.

        >>> INCH.format_length(12.7), MILLIMETRE.format_length(24.125)
        ('0.5000 in', '24.125 mm')
        """
        return f"{self.format_number(length, decimals)} {self.abbreviation}"

    @property
    def small_name(self) -> str:
        """Abbreviation of the unit for small lengths such as
        errors: "µm", or "thou" (0.001 inch) when this is the inch.
        """
        return "µm" if self.name != INCH.name else "thou"

    def format_small_number(self, length: float) -> str:
        """Return a length in mm as a number in the small unit (µm or thou), without the unit.

        Numbers of 10 and more are whole, those from 1 have one decimal, smaller ones two significant figures.

        >>> [MILLIMETRE.format_small_number(length) for length in (0.01234, 0.00072)]
        ['12', '0.72']
        """
        value = length * (1000.0 / 25.4 if self.name == INCH.name else 1000.0)
        return f"{value:.0f}" if abs(value) >= 10 else f"{value:.1f}" if abs(value) >= 1 else f"{value:.2g}"

    def format_small_length(self, length: float) -> str:
        """Return a length in mm as text with the small unit (µm or thou), such as "8.1 µm".

        >>> MILLIMETRE.format_small_length(0.0081), INCH.format_small_length(0.0254)
        ('8.1 µm', '1.0 thou')
        """
        return f"{self.format_small_number(length)} {self.small_name}"

    def format_short_length(self, length: float, decimals: int | None = None) -> str:
        """Return a length in mm as a number in this unit, without trailing zeros and without the unit.

        ``decimals`` is the largest number of decimals; ``self.decimals`` if None.

        >>> INCH.format_short_length(12.7), MILLIMETRE.format_short_length(20.0)
        ('0.5', '20')
        """
        text = self.format_number(length, decimals)
        return text.rstrip("0").rstrip(".") if "." in text else text

    def format_force(self, force: float) -> str:
        """Return a force in N as text in the unit of force, such as "225 lbf (1000 N)"; newtons follow in
        brackets if that unit is another.

        Forces from 100 units and 0 are whole numbers, smaller ones have three significant figures.

        >>> MILLIMETRE.format_force(1234.5), MILLIMETRE.format_force(0.01234), INCH.format_force(1000.0)
        ('1234 N', '0.0123 N', '225 lbf (1000 N)')
        """
        words = self.format_force_alone(force)
        return words if self.newtons == 1 else f"{words} ({MILLIMETRE.format_force_alone(force)})"

    def format_force_alone(self, force: float) -> str:
        """Return a force in N as text in the unit of force, such as "225 lbf", without newtons in brackets.

        >>> INCH.format_force_alone(1000.0)
        '225 lbf'
        """
        value = force / self.newtons
        return f"{value:.0f} {self.force}" if value >= 100 or value == 0 else f"{value:.3g} {self.force}"

    def format_force_number(self, force: float, decimals: int = 1) -> str:
        """Return a force in N as a number in the unit of force, without the unit and without a negative zero.

        >>> MILLIMETRE.format_force_number(1000.0), INCH.format_force_number(1000.0), INCH.format_force_number(-0.01, 0)
        ('1000.0', '224.8', '0')
        """
        text = f"{force / self.newtons:.{decimals}f}"
        return text.removeprefix("-") if float(text) == 0 else text

    def format_moment(self, moment: float) -> str:
        """Return a moment in N·mm as text in N m; for inches in ft lbf, followed by N m in brackets.

        A negative moment has a typographic minus.

        >>> MILLIMETRE.format_moment(1234.5), INCH.format_moment(1000.0)
        ('1.23 N m', '0.738 ft lbf (1 N m)')
        """
        words = f"{moment / 1000.0:.3g} N m"
        if self.newtons != 1:
            words = f"{moment / (12 * self.newtons * self.millimetres):.3g} ft {self.force} ({words})"
        return words.replace("-", "−")

    @property
    def pressure(self) -> str:
        """Abbreviation of the unit of stress: "MPa", or "ksi" where the unit of force is not the newton."""
        return "MPa" if self.newtons == 1 else "ksi"

    def format_stress_number(self, stress: float) -> str:
        """Return a stress in MPa as a number in MPa or ksi, without the unit.

        >>> MILLIMETRE.format_stress_number(896.2), INCH.format_stress_number(896.2)
        ('896', '130.0')
        """
        return f"{stress:.0f}" if self.newtons == 1 else f"{stress / KSI:.1f}"

    def format_stress(self, stress: float) -> str:
        """Return a stress in MPa as text in MPa, or in ksi followed by MPa in brackets.

        >>> MILLIMETRE.format_stress(896.2), INCH.format_stress(896.2)
        ('896 MPa', '130.0 ksi (896 MPa)')
        """
        beside = "" if self.newtons == 1 else f" ({MILLIMETRE.format_stress(stress)})"
        return f"{self.format_stress_number(stress)} {self.pressure}{beside}"

    def format_force_rounded_up(self, force: float) -> str:
        """Return a force in N as a whole number in the unit of force, rounded up, without the unit.

        >>> MILLIMETRE.format_force_rounded_up(1234.2), INCH.format_force_rounded_up(1000.0)
        ('1235', '225')
        """
        value = force / self.newtons
        return f"{ceil(value - ROUNDING * abs(value)):d}"


MILLIMETRE = Unit("mm", "mm", 1.0, 3)
# Exact by definition (international inch, 1959).
INCH = Unit("inch", "in", 25.4, 4, "lbf", POUND)
UNITS = {
    "mm": MILLIMETRE,
    "cm": Unit("cm", "cm", 10.0, 4),
    "m": Unit("m", "m", 1000.0, 6),
    "inch": INCH,
    "in": INCH,
    '"': INCH,
}


def format_rounded_down(number: float) -> str:
    """Return a number with two decimals, rounded down unless it is below the next hundredth by rounding alone.

    >>> format_rounded_down(1.999), format_rounded_down(0.3 * 3 - 0.6)
    ('1.99', '0.30')
    """
    return f"{floor(number * 100.0 + ROUNDING) / 100.0:.2f}"


def format_times(times: float) -> str:
    """Return a number of times as words; a number is rounded down to two decimals.

    >>> format_times(2.349), format_times(inf)
    ('2.34 times', 'any number of times')
    """
    return "any number of times" if times == inf else f"{format_rounded_down(times)} times"


def find_unit(name: str) -> Unit:
    """Return the unit called "mm", "cm", "m", "inch", "in" or '"', in upper or lower case.

    Raises
    ------
    InputError
        For any other name.

    Examples
    --------
    >>> find_unit("in").name, find_unit("MM").millimetres
    ('inch', 1.0)
    """
    try:
        return UNITS[name.strip().lower()]
    except KeyError:
        raise InputError(f"Unit '{name[:40]}' is not known: use mm, cm, m or inch.") from None


# Pixels to an inch that programs write drawings with: points of print (Illustrator, CorelDRAW), those of
# Inkscape before 0.92, and those of CSS (CSS Values 4, 6.2).
PIXELS = (72, 90, 96)
PIXEL = re.compile(r"px *([0-9]{1,5}(?:\.[0-9]{1,6})?)")


def find_pixels_per_inch(name: str | None) -> float | None:
    """Return the pixels per inch of a unit such as "px96"; None for other names and for less than 1.

    >>> find_pixels_per_inch("px72"), find_pixels_per_inch("mm")
    (72.0, None)
    """
    match = PIXEL.fullmatch((name or "").strip().lower())
    return None if match is None or float(match[1]) < 1 else float(match[1])


def find_drawing_unit(name: str) -> Unit:
    """Return the unit of a drawing by its name: a name that :func:`find_unit` takes, or pixels such as "px96"
    (96 per inch).

    Raises
    ------
    InputError
        For any other name.

    Examples
    --------
    >>> find_drawing_unit("px72").millimetres == 25.4 / 72, find_drawing_unit("cm").millimetres
    (True, 10.0)
    """
    pixels = find_pixels_per_inch(name)
    if pixels is not None:
        return Unit(f"px{pixels:g}", "px", INCH.millimetres / pixels, 4)
    if name.strip().lower().startswith("px"):
        raise InputError(f"Unit '{name[:40]}' does not say how many make an inch: use px72, px90 or px96.")
    return find_unit(name)
