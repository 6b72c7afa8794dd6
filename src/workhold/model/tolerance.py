"""How far pegs and faces may be off."""

from __future__ import annotations

from math import isfinite

from attrs import evolve, field, frozen

from workhold.delegates import delegate
from workhold.errors import InputError
from workhold.limits import refuse_long
from workhold.model.dowel import Fit
from workhold.real import real

__all__ = ["Tolerance"]


@frozen
class Tolerance:
    """Largest errors along the normal of a contact, either way.

    Parameters
    ----------
    peg : how far the surface of a peg may be from where it should be, in mm.
    face : how far a face of the part may be from where it should be, in mm; the departure is a part of it.
    fit : of the dowels that are the pegs, which the first follows from; None where it is not known.
    departure : how far the outline as read may be from the drawn one, in mm; a query sets it to its workpiece's.

    Raises
    ------
    InputError
        For lengths that are negative, not finite or beyond the limits.
    """

    peg: float = field(default=0.01, converter=real)
    face: float = field(default=0.01, converter=real)
    fit: Fit | None = None
    departure: float = field(default=0.0, converter=real)

    def __attrs_post_init__(self) -> None:
        for name, value in (("peg", self.peg), ("face", self.face), ("departure in the face", self.departure)):
            if not (isfinite(value) and value >= 0):
                raise InputError(f"{name} tolerance {value} is not a length: give 0 or more, in mm.")
            refuse_long(f"{name} tolerance", value)

    @classmethod
    def preset(cls, name: str) -> Tolerance:
        """The tolerance that follows from the dowels of a toolkit by name, see :meth:`workhold.Vise.preset`.

        Raises
        ------
        InputError
            For a name that is not known.

        Examples
        --------
        >>> from workhold import Tolerance
        >>> round(Tolerance.preset("plate-20mm").peg, 6)
        0.0145
        """
        tolerance: Tolerance = delegate("preset_tolerance")(name)
        return tolerance

    def with_departure(self, departure: float) -> Tolerance:
        """The same tolerance for an outline that departs by so much, in mm, from the drawn one.

        Examples
        --------
        >>> Tolerance(0.01, 0.02).with_departure(0.5).face
        0.52
        >>> round(Tolerance(0.01, 0.02).with_departure(0.5).with_departure(0.1).face, 9)
        0.12
        """
        if departure == self.departure:
            return self
        return evolve(self, face=max(self.face - self.departure, 0.0) + departure, departure=departure)
