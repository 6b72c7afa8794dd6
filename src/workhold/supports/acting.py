"""What acts on the part in space: loads with their heights, and the jaw force that they ask for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite

import numpy as np

from workhold.conventions import AGREEMENT
from workhold.errors import InputError
from workhold.limits import real, refuse_strong
from workhold.model.requirements import Load
from workhold.model.support_request import SpatialLoad
from workhold.supports.forces import PegForces, largest_over

__all__ = ["WeakJawError", "checked_force", "needed_jaw_force", "spatial"]


class WeakJawError(InputError):
    """A jaw force that is too small for a load."""


def spatial(loads: Iterable[Load | SpatialLoad], thickness: float) -> tuple[SpatialLoad, ...]:
    """Loads as they act in space, with their heights written out."""
    every = (load if isinstance(load, SpatialLoad) else SpatialLoad.of(load) for load in loads)
    return tuple(load.at_height(thickness) for load in every)


def needed_jaw_force(pegs: PegForces, loads: Sequence[SpatialLoad], jaw_force: float | None) -> float:
    """The jaw force asked for, or the one that keeps all pegs in contact under every load.

    Raises
    ------
    WeakJawError
        When the one asked for is too small, naming the load.
    """
    needs = [needed_for(pegs, load) for load in loads]
    if jaw_force is None:
        return max(needs, default=0.0)
    for load, need in zip(loads, needs, strict=True):
        if need > jaw_force * (1 + AGREEMENT):
            name = f"the load '{load.name}'" if load.name else "a load"
            raise WeakJawError(
                f"a jaw force of {jaw_force:g} N lets a peg lose contact under {name}, which takes "
                f"{need:.6g} N: give more, or leave it out."
            )
    return float(jaw_force)


def needed_for(pegs: PegForces, load: SpatialLoad) -> float:
    """The jaw force in N above which no peg lets go under a load, as ``statics.loads`` has it.

    Peg i presses with a_i + F h_i, where a_i balances the load and h_i > 0.
    """
    if load.force == 0.0 and load.moment == 0.0:
        return 0.0
    _, _, moment, closing = pegs.answers.T
    worst = 0.0
    for point in (load.points if load.force else ()) or (tuple(pegs.center),):
        x, y = pegs.at(np.array(point)).T
        asked = load.force * largest_over(-x, -y, load.directions) - load.moment * moment
        worst = max(worst, float((asked / closing).max()))
    return worst


def checked_force(jaw_force: float | None) -> float | None:
    """A jaw force in N, or None.

    Raises
    ------
    InputError
        For one that is negative or no number.
    """
    if jaw_force is None:
        return None
    if not (isfinite(real(jaw_force)) and real(jaw_force) >= 0):
        raise InputError(f"jaw force {real(jaw_force):g} cannot be used: give 0 or more.")
    refuse_strong("jaw force", real(jaw_force))
    return real(jaw_force)
