"""What every lattice of holes is held to, and how its numbers are taken."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, isfinite, isnan, nan
from typing import Any

from workhold.errors import InputError
from workhold.limits import MOST_HOLES
from workhold.real import real

__all__ = ["optional_length", "pair", "refuse_lattice", "refuse_many_holes", "whole"]


def pair(value: float | Iterable[float]) -> tuple[float, float]:
    """One pitch for both directions, or one for x and one for y."""
    numbers = tuple(value) if isinstance(value, Iterable) else (value, value)
    if len(numbers) != 2:
        raise InputError(f"pitch {value} is not one number or two: give one pitch, or X,Y.")
    return real(numbers[0]), real(numbers[1])


def whole(value: Any) -> Any:
    """A whole number as an int; None and anything else as it is, to be looked at later."""
    return int(value) if isfinite(real(value)) and value == int(value) else value


def optional_length(value: float | None) -> float:
    """A length, or NaN (which the vise resolves) for None."""
    return nan if value is None else inf if isnan(real(value)) else real(value)


def refuse_lattice(
    pitch: tuple[float, float], columns: int | None, rows: int | None, peg_radius: float, noun: str, peg: str
) -> None:
    """Refuse a lattice that cannot be, and pegs too fat for neighbouring holes.

    Parameters
    ----------
    noun, peg : what the lattice and what stands in its holes are called.

    Raises
    ------
    InputError
        Naming the value.
    """
    for value in pitch:
        if not (isfinite(value) and value > 0):
            raise InputError(f"pitch {value} is not a positive length: give the distance between holes in mm.")
    for name, count in (("columns", columns), ("rows", rows)):
        if count is not None and (not isinstance(count, int) or count < 1):
            raise InputError(f"{name} {count} is not a positive whole number: a {noun} needs at least one.")
    if not (isfinite(peg_radius) and peg_radius >= 0):
        raise InputError(f"peg radius {peg_radius} is not a length: give 0 or more, in mm.")
    if 2 * peg_radius > min(pitch):
        raise InputError(
            f"{peg}s of radius {peg_radius:g} overlap in neighbouring holes {min(pitch):g} apart: use a smaller {peg} or a "
            "larger pitch."
        )


def refuse_many_holes(columns: int | None, rows: int | None, noun: str) -> None:
    """Refuse more holes than can be looked through.

    Raises
    ------
    InputError
        With their number and the limit.
    """
    holes = (columns or 1) * (rows or 1)
    if holes > MOST_HOLES:
        raise InputError(
            f"a {noun} of {holes:,} holes is beyond the {MOST_HOLES:,} this program takes: give fewer columns or rows, as "
            "many as the part can reach."
        )
