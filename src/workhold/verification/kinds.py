"""The rules of each kind of toolkit that a verification knows."""

from __future__ import annotations

from workhold.errors import InputError
from workhold.model.fence import Fence
from workhold.model.plate import Plate
from workhold.model.toolkit import Toolkit
from workhold.model.vise import Vise
from workhold.verification.fence import FenceRules
from workhold.verification.hardware import Hardware
from workhold.verification.pair_fence import FencePairRules
from workhold.verification.pair_plate import PairRules
from workhold.verification.plate import PlateRules
from workhold.verification.vise import ViseRules

__all__ = ["hardware_of"]


def hardware_of(toolkit: Toolkit, listing: str | None = None) -> Hardware:
    """The rules of a toolkit; of two clamps with all pairs listed or, unless said otherwise, the best of each seat.

    Raises
    ------
    InputError
        For a kind whose rules are not known.
    """
    if isinstance(toolkit, Vise):
        return ViseRules(toolkit)
    if isinstance(toolkit, Fence) and toolkit.clamps == 2:
        return FencePairRules(toolkit, every=listing == "all")
    if isinstance(toolkit, Fence):
        return FenceRules(toolkit)
    if isinstance(toolkit, Plate) and toolkit.clamps == 2:
        return PairRules(toolkit, every=listing == "all")
    if isinstance(toolkit, Plate):
        return PlateRules(toolkit)
    raise InputError(f"a result in a {toolkit.kind} cannot be verified: its rules are not known.")
