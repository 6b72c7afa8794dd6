"""A dowel pin in its hole: how far the pin's surface may be from where a design takes it to be.

Glossary
--------
limits : smallest and largest diameter that a maker may deliver, in mm.
position : how far the centre of a hole may be from its place on the lattice, in mm, in any direction.
clearance : how much wider a hole is than the pin in it; a pin wider than its hole is pressed in and has none.

A design takes every peg to be a circle of the peg radius ρ about its place on the lattice. Let the pin have diameter d
in a hole of diameter D whose centre is off by p. The pin can be anywhere in its hole, so its centre is off by at most
p + max(0, D - d)/2, and its surface, along any direction, by at most

    p + max(0, D - d)/2 + |d - 2ρ|/2 .

That grows with D and is convex in d, hence largest at the largest hole and at one of the pin's two limits:
:func:`peg_error`. It is the sum of the worst cases, as drawings add them up (ISO 286-1:2010 defines limits and
clearance).
"""

from __future__ import annotations

from math import isfinite

from attrs import frozen

from workhold.conventions import SAME_SIZE
from workhold.errors import InputError

__all__ = ["DowelSize", "Fit", "Limits", "fit_words", "hole_class", "peg_error", "refuse_limits"]

Limits = tuple[float, float]
# ISO 286-2:2010, class H7: up to this nominal diameter in mm a hole may be so many mm wider and no narrower.
H7 = ((3.0, 0.010), (6.0, 0.012), (10.0, 0.015), (18.0, 0.018), (30.0, 0.021), (50.0, 0.025))
# A pin whose diameter is this far from that of the peg, in proportion, is not the peg: a radius was given for a diameter.
FAR = 0.1


@frozen
class DowelSize:
    """A size of a standard's dowel pins.

    Parameters
    ----------
    nominal : diameter by which the size is called, in mm.
    pin : limits of the pin, in mm.
    hole : limits of the hole recommended with it, in mm; None where the standard recommends none.
    """

    nominal: float
    pin: Limits
    hole: Limits | None = None


@frozen
class Fit:
    """A pin in its hole.

    Parameters
    ----------
    pin, hole : smallest and largest diameters in mm.
    position : how far the centre of a hole may be from its place, in mm.
    position_assumed : whether nobody said so, and it was assumed.
    standard : of the pin, such as "ISO 2338 m6"; empty where none is named.
    """

    pin: Limits
    hole: Limits
    position: float
    position_assumed: bool
    standard: str = ""


def hole_class(nominal: float, hole: Limits) -> str | None:
    """The class of a hole's limits, where it is H7; None for any other.

    >>> hole_class(6.0, (6.0, 6.012)), hole_class(6.0, (5.987, 6.0))
    ('H7', None)
    """
    wider = next((wider for largest, wider in H7 if nominal <= largest), None)
    return None if wider is None or max(abs(hole[0] - nominal), abs(hole[1] - nominal - wider)) > SAME_SIZE else "H7"


def fit_words(fit: Fit, nominal: float) -> str:
    """A pin and how it sits in its hole, in short.

    Parameters
    ----------
    nominal : diameter of the peg, in mm.

    Examples
    --------
    >>> fit_words(Fit((6.004, 6.012), (6.0, 6.012), 0.01, True, "ISO 2338 m6"), 6.0)
    'ISO 2338 m6 in H7'
    >>> fit_words(Fit((6.003, 6.009), (5.987, 6.0), 0.01, True, "ASME B18.8.5M"), 6.0)
    'ASME B18.8.5M, pressed in'
    """
    hole = hole_class(nominal, fit.hole)
    if hole is not None:
        return f"{fit.standard or 'pin'} in {hole}"
    how = (
        "pressed in"
        if fit.pin[0] >= fit.hole[1]
        else "goes in by hand"
        if fit.pin[1] <= fit.hole[0]
        else "tight or loose"
    )
    return f"{fit.standard or 'pin'}, {how}"


def peg_error(peg_radius: float, pin: Limits, hole: Limits, position: float) -> float:
    """How far the surface of a peg may be off along a normal, in mm; the formula is at the head of this file.

    Parameters
    ----------
    peg_radius : the radius designed with, in mm.
    pin, hole : limits of both diameters, in mm.
    position : of the hole, in mm.

    Examples
    --------
    A 6 mm pin of 5.982 to 6.000 mm (h8) in a hole of 6.000 to 6.012 mm (H7), placed to 0.010 mm: the smallest pin in the
    widest hole is 0.015 mm off its hole's centre and its surface 0.009 mm nearer to it.

    >>> round(peg_error(3.0, (5.982, 6.0), (6.0, 6.012), 0.010), 6)
    0.034
    """
    return position + max(max(0.0, hole[1] - diameter) + abs(diameter - 2 * peg_radius) for diameter in pin) / 2


def refuse_limits(name: str, limits: Limits, peg_radius: float) -> None:
    """Refuse limits that are not those of a pin or hole for the peg.

    Parameters
    ----------
    name : what the limits are of, for the message.

    Raises
    ------
    InputError
        For limits that are not positive, the wrong way round, or far from the peg's diameter.
    """
    low, high = limits
    if not (isfinite(low) and isfinite(high) and low > 0):
        raise InputError(f"{name} {low:g} to {high:g} mm is no range of diameters: give two positive lengths.")
    if low > high:
        raise InputError(f"{name} {low:g} to {high:g} mm is the wrong way round: give the smallest diameter first.")
    if max(abs(low - 2 * peg_radius), abs(high - 2 * peg_radius)) > FAR * 2 * peg_radius:
        raise InputError(
            f"{name} {low:g} to {high:g} mm is not that of a peg of radius {peg_radius:g} mm: correct one of them, "
            "and mind that the one is a diameter, the other a radius."
        )
