"""Units of length and the force that goes with each; inside, all numbers are in mm and N."""

from __future__ import annotations

import re
from math import ceil

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
]

# N in a pound-force: 0.453 592 37 kg under 9.806 65 m/s2, both exact by definition (1959 and 1901).
POUND = 0.45359237 * 9.80665
# MPa in a thousand pound-force to the square inch (25.4 mm).
KSI = 1000 * POUND / 25.4**2
ROUNDING = 1e-9


@frozen
class Unit:
    """A unit of length, and how lengths are written in it.

    Parameters
    ----------
    name : what users call it.
    abbreviation : what stands behind a number.
    millimetres : millimetres in one unit.
    decimals : with which a length that has to be set is written: a micrometre, or a ten-thousandth of an inch
        (2.5 µm).
    force, newtons : abbreviation of the unit of force on paper of this unit of length, and N in one of it.
    """

    name: str
    abbreviation: str
    millimetres: float
    decimals: int
    force: str = "N"
    newtons: float = 1.0

    def to_mm(self, number: float) -> float:
        """Return the length in mm that a number of this unit means.

        Rounded at 1e-12 mm, so that 1.5 inch is the 38.1 mm that a metric drawing says, not its neighbour in
        floating point: coincidences of part and vise stay exact.

        >>> INCH.to_mm(1.5), 1.5 * 25.4
        (38.1, 38.099999999999994)
        """
        return float(number) if self.millimetres == 1 else round(number * self.millimetres, 12)

    def number(self, length: float, decimals: int | None = None) -> str:
        """Return a length in mm as a number of this unit, without a negative zero.

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

    def format_length(self, length: float, decimals: int | None = None) -> str:
        """Return a length in mm as a number of this unit and the unit behind it.

        >>> INCH.format_length(12.7), MILLIMETRE.format_length(24.125)
        ('0.5000 in', '24.125 mm')
        """
        return f"{self.number(length, decimals)} {self.abbreviation}"

    @property
    def small_name(self) -> str:
        """The unit of lengths that nobody sets but that count: micrometres, or thousandths of an inch."""
        return "µm" if self.name != INCH.name else "thou"

    def format_small_number(self, length: float) -> str:
        """Return a length in mm as a number of the small unit, with two figures or more.

        >>> [MILLIMETRE.format_small_number(length) for length in (0.01234, 0.00072)]
        ['12', '0.72']
        """
        value = length * (1000.0 / 25.4 if self.name == INCH.name else 1000.0)
        return f"{value:.0f}" if abs(value) >= 10 else f"{value:.1f}" if abs(value) >= 1 else f"{value:.2g}"

    def format_small_length(self, length: float) -> str:
        """Return a length in mm in the small unit, with its name.

        >>> MILLIMETRE.format_small_length(0.0081), INCH.format_small_length(0.0254)
        ('8.1 µm', '1.0 thou')
        """
        return f"{self.format_small_number(length)} {self.small_name}"

    def format_short_length(self, length: float, decimals: int | None = None) -> str:
        """Return a length in mm as a catalogue would print it: as many decimals as it takes and no more.

        >>> INCH.format_short_length(12.7), MILLIMETRE.format_short_length(20.0)
        ('0.5', '20')
        """
        text = self.number(length, decimals)
        return text.rstrip("0").rstrip(".") if "." in text else text

    def format_force(self, force: float) -> str:
        """Return a force in N in whole units of force, or with three figures when it is small, and the unit.

        Where that unit is not the newton, newtons stand beside it.

        >>> MILLIMETRE.format_force(1234.5), MILLIMETRE.format_force(0.01234), INCH.format_force(1000.0)
        ('1234 N', '0.0123 N', '225 lbf (1000 N)')
        """
        words = self.format_force_alone(force)
        return words if self.newtons == 1 else f"{words} ({MILLIMETRE.format_force_alone(force)})"

    def format_force_alone(self, force: float) -> str:
        """Return a force in N as of :meth:`format_force` in the unit of force alone, for columns of a table.

        >>> INCH.format_force_alone(1000.0)
        '225 lbf'
        """
        value = force / self.newtons
        return f"{value:.0f} {self.force}" if value >= 100 or value == 0 else f"{value:.3g} {self.force}"

    def format_force_number(self, force: float, decimals: int = 1) -> str:
        """Return a force in N as a number of the unit of force, without a negative zero, for columns of a
        table.

        >>> MILLIMETRE.format_force_number(1000.0), INCH.format_force_number(1000.0), INCH.format_force_number(-0.01, 0)
        ('1000.0', '224.8', '0')
        """
        text = f"{force / self.newtons:.{decimals}f}"
        return text.removeprefix("-") if float(text) == 0 else text

    def format_moment(self, moment: float) -> str:
        """Return a moment in N mm in N m, or in ft lbf with N m beside it.

        >>> MILLIMETRE.format_moment(1234.5), INCH.format_moment(1000.0)
        ('1.23 N m', '0.738 ft lbf (1 N m)')
        """
        words = f"{moment / 1000.0:.3g} N m"
        if self.newtons != 1:
            words = f"{moment / (12 * self.newtons * self.millimetres):.3g} ft {self.force} ({words})"
        return words.replace("-", "−")

    @property
    def pressure(self) -> str:
        """The unit of stress that goes with the unit of force."""
        return "MPa" if self.newtons == 1 else "ksi"

    def format_stress_number(self, stress: float) -> str:
        """Return a stress in MPa as a number of the unit of stress, for columns of a table.

        >>> MILLIMETRE.format_stress_number(896.2), INCH.format_stress_number(896.2)
        ('896', '130.0')
        """
        return f"{stress:.0f}" if self.newtons == 1 else f"{stress / KSI:.1f}"

    def format_stress(self, stress: float) -> str:
        """Return a stress in MPa in the unit of stress; where that is not the MPa, it stands beside.

        >>> MILLIMETRE.format_stress(896.2), INCH.format_stress(896.2)
        ('896 MPa', '130.0 ksi (896 MPa)')
        """
        beside = "" if self.newtons == 1 else f" ({MILLIMETRE.format_stress(stress)})"
        return f"{self.format_stress_number(stress)} {self.pressure}{beside}"

    def format_force_rounded_up(self, force: float) -> str:
        """Return a force in N as a whole number of the unit of force, rounded up to stay on the safe side.

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


def find_unit(name: str) -> Unit:
    """Return the unit of a name, in any mixture of capitals.

    Raises
    ------
    InputError
        For a unit that is not known.

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
    """Return how many pixels make an inch in a unit such as "px96"; None for other names.

    >>> find_pixels_per_inch("px72"), find_pixels_per_inch("mm")
    (72.0, None)
    """
    match = PIXEL.fullmatch((name or "").strip().lower())
    return None if match is None or float(match[1]) < 1 else float(match[1])


def find_drawing_unit(name: str) -> Unit:
    """Return the unit of a drawing: one of length, or pixels of which so many make an inch.

    Raises
    ------
    InputError
        For a unit that is not known.

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
