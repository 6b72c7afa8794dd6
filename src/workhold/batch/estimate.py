"""How long a task will take: what puts the longest first, so that no worker is left alone with one at the end.

The estimate is a power law: a search grows with the number of faces and with the number of steps that the lattice offers
between two pegs on a part of that size. Constants and exponents come from a fit to measured runs
(``benchmarks/batch_estimate.py``); docs/benchmarks.md says how near it comes. Only the order and the shares count: how fast
a machine is shows while it runs.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import exp, hypot, log

from workhold.fixels.toolkit import Toolkit

__all__ = ["answering_seconds", "measures", "reading_seconds"]

# Seconds are exp(constant) * faces ** first * steps ** second.
LAWS: Mapping[str, tuple[float, float, float]] = {
    "vise": (-9.35, 0.83, 1.33),
    "plate": (-10.94, 0.93, 1.32),
    "two clamps": (-19.51, 0.07, 3.86),
    "fence": (-3.9, 0.39, -0.02),
}
# Of a drawing: seconds for the first byte, and for a million of them.
READING: Mapping[str, tuple[float, float]] = {".step": (2.0, 10.0), ".stp": (2.0, 10.0), ".dxf": (0.02, 4.0)}
OTHER_READING = (0.005, 1.0)


def reading_seconds(ending: str, size: int) -> float:
    """Seconds to read a drawing of so many bytes."""
    first, million = READING.get(ending.lower(), OTHER_READING)
    return first + million * size / 1e6


def measures(faces: int, size: tuple[float, float], toolkit: Toolkit) -> tuple[str, float, float]:
    """The law that holds for a toolkit, and the logarithms of what it grows with: faces and steps.

    Parameters
    ----------
    size : width and height of the part in mm.
    """
    carrier = toolkit.plates[0]
    diameter = hypot(*size) + 2.0 * carrier.peg_radius
    across, along = (
        diameter / pitch if count is None else min(count - 1.0, diameter / pitch)
        for pitch, count in zip(carrier.pitch, (carrier.columns, carrier.rows), strict=True)
    )
    return toolkit.law, log(faces), log((2.0 * across + 1.0) * (2.0 * along + 1.0))


def answering_seconds(faces: int, size: tuple[float, float], toolkit: Toolkit) -> float:
    """Seconds to find all fixtures of a part in a toolkit."""
    law, of_faces, of_steps = measures(faces, size, toolkit)
    constant, first, second = LAWS[law]
    return exp(constant + first * of_faces + second * of_steps)
