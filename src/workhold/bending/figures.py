"""How far one fixture bends its part: the figures, with the movement of every node of the surface."""

from __future__ import annotations

import numpy as np
from attrs import evolve, field, fields, frozen
from numpy.typing import NDArray

from workhold.bending.surface import Surface
from workhold.errors import InputError
from workhold.model.part_bending import BendingFigures, round_force

__all__ = ["Bending"]


@frozen(eq=False, kw_only=True)
class Bending(BendingFigures):
    """How far one fixture bends its part, with what a picture takes.

    Parameters
    ----------
    surface : surface of the mesh, in the part's coordinates.
    moved : (N, 3) movement of each node of the surface by clamping, in mm.
    pressed : (N,) whether something presses at the node; its dent does not count.
    has_own_straps : whether straps hold the part that are not the fixture's own.
    """

    surface: Surface = field(repr=False)
    moved: NDArray[np.float64] = field(repr=False)
    pressed: NDArray[np.bool_] = field(repr=False)
    has_own_straps: bool = False

    def to_figures(self) -> BendingFigures:
        """Return the figures alone, rounded as result files keep them.

        Raises
        ------
        InputError
            Where straps take the place of the fixture's clamps; a result file has no room for these.
        """
        if self.has_own_straps:
            raise InputError(
                "straps in place of clamps have no room in a result file: design the part for a plate with straps."
            )
        alone = BendingFigures(**{one.name: getattr(self, one.name) for one in fields(BendingFigures)})
        return evolve(
            alone,
            jaw_force=round_force(alone.jaw_force),
            clamp_distortion=alone.clamp_distortion.rounded,
            give=None if alone.give is None else alone.give.rounded,
            stress=alone.stress.rounded,
        )
