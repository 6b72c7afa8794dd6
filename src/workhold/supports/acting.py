"""What acts on the part in space: loads with their heights, and the jaw force that they ask for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite

from workhold.conventions import AGREEMENT
from workhold.errors import InputError
from workhold.limits import real, refuse_strong
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.model.support_request import SpatialLoad
from workhold.statics.loads import load_cases

__all__ = ["checked_force", "needed_jaw_force", "spatial"]


def spatial(loads: Iterable[Load | SpatialLoad], thickness: float) -> tuple[SpatialLoad, ...]:
    """Loads as they act in space, with their heights written out."""
    every = (load if isinstance(load, SpatialLoad) else SpatialLoad.of(load) for load in loads)
    return tuple(load.at_height(thickness) for load in every)


def needed_jaw_force(
    fixture: Fixture, query: Query, loads: Sequence[SpatialLoad], jaw_force: float | None
) -> float:
    """The jaw force asked for, or the one that keeps all pegs in contact under every load.

    Raises
    ------
    InputError
        When the one asked for is too small, naming the load.
    """
    planar = [(load, load.planar) for load in loads]
    acting = [(load, flat) for load, flat in planar if flat is not None]
    cases = load_cases(
        fixture, query.workpiece, query.toolkit, [flat for _, flat in acting], jaw_force, jaw="constant"
    )
    needs = [case.needed.value for case in cases]
    if jaw_force is None:
        return max(needs, default=0.0)
    for (load, _), need in zip(acting, needs, strict=True):
        if need > jaw_force * (1 + AGREEMENT):
            name = f"the load '{load.name}'" if load.name else "a load"
            raise InputError(
                f"a jaw force of {jaw_force:g} N lets a peg lose contact under {name}, which takes "
                f"{need:.6g} N: give more, or leave it out."
            )
    return float(jaw_force)


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
