"""Standard scales of drawings (ISO 5455:1979): 1, 2 and 5 times powers of ten, up or down."""

from __future__ import annotations

from math import floor, log10

from attrs import frozen

__all__ = ["StandardScale", "standard_scale"]

# A drawing that is larger by rounding alone still fits.
ROUNDING = 1e-9


@frozen
class StandardScale:
    """A scale such as 1:2.

    Parameters
    ----------
    name : "paper:model" in whole numbers.
    factor : millimetres on paper for one of the model.
    """

    name: str
    factor: float


def standard_scale(largest: float) -> StandardScale:
    """The largest standard scale with at most ``largest`` millimetres on paper for one of the model.

    >>> [standard_scale(largest).name for largest in (1.0, 0.99, 0.3, 7.0, 0.011)]
    ['1:1', '1:2', '1:5', '5:1', '1:100']
    """
    power = floor(log10(largest) + ROUNDING)
    steps = [(mantissa, exponent) for exponent in (power + 1, power, power - 1) for mantissa in (5, 2, 1)]
    mantissa, exponent = next(step for step in steps if step[0] * 10.0 ** step[1] <= largest * (1 + ROUNDING))
    if exponent >= 0:
        enlarged = mantissa * 10**exponent
        return StandardScale(f"{enlarged}:1", float(enlarged))
    reduced = 10**-exponent // mantissa
    return StandardScale(f"1:{reduced}", 1 / reduced)
