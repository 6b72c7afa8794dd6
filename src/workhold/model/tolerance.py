"""How far pegs and faces may be off."""

from __future__ import annotations

from math import isfinite

from attrs import field, frozen

from workhold.errors import InputError
from workhold.model.dowel import Fit
from workhold.model.real import real

__all__ = ["Tolerance"]


@frozen
class Tolerance:
    """Largest errors along the normal of a contact, either way.

    Parameters
    ----------
    peg : how far the surface of a peg may be from where it should be, in mm.
    face : how far a face of the part may be from where it should be, in mm.
    fit : of the dowels that are the pegs, which the first follows from; None where it is not known.

    Raises
    ------
    InputError
        For lengths that are negative or not finite.
    """

    peg: float = field(default=0.01, converter=real)
    face: float = field(default=0.01, converter=real)
    fit: Fit | None = None

    def __attrs_post_init__(self) -> None:
        for name, value in (("peg", self.peg), ("face", self.face)):
            if not (isfinite(value) and value >= 0):
                raise InputError(f"{name} tolerance {value} is not a length: give 0 or more, in mm.")
