"""Scales of drawings: 1, 2 and 5 times powers of ten, up or down (ISO 5455:1979), and round ones between these, as that
standard allows where a drawing would else be needlessly small."""

from __future__ import annotations

from math import floor, log10

from attrs import frozen

__all__ = ["StandardScale", "standard_scale"]

# A drawing that is larger by rounding alone still fits.
ROUNDING = 1e-9
STEPS = 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0


@frozen
class StandardScale:
    """A scale such as 1:2.

    Parameters
    ----------
    name : "paper:model", the smaller of them 1.
    factor : millimetres on paper for one of the model.
    """

    name: str
    factor: float


def standard_scale(largest: float) -> StandardScale:
    """The largest scale of these with at most ``largest`` millimetres on paper for one of the model.

    >>> [standard_scale(largest).name for largest in (1.0, 0.99, 0.3, 7.0, 0.011)]
    ['1:1', '1:1.5', '1:4', '6:1', '1:100']
    """
    if largest >= 1 - ROUNDING:
        power = 10 ** floor(log10(largest) + ROUNDING)
        enlarged = max(step * power for step in STEPS if step * power <= largest * (1 + ROUNDING))
        return StandardScale(f"{enlarged:g}:1", enlarged)
    power = 10 ** floor(log10(1 / largest) + ROUNDING)
    reduced = min(step * power for step in (*STEPS, 10.0) if step * power >= (1 - ROUNDING) / largest)
    return StandardScale(f"1:{reduced:.12g}", 1 / reduced)
