"""Curves that are neither line nor arc: whether one is in the outline, and how that is refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.files.step.faces import SLOPING, SolidFace
from workhold.geometry.segment import Point

__all__ = ["FLAT", "Other", "OtherCurveError", "other_curve", "refuse_others"]

# A face's index with points (N, 2) in mm of a curve of its.
Other = tuple[int, NDArray[np.float64]]
# How far beside a curve its two sides are looked at, in mm. All have to show that it is the border, because a
# curve may cross the border near one of its points.
BESIDE = (4e-4, 4e-5, 4e-6)
# Of how many points along a curve one is looked at first.
FEW = 10
# What flat faces are called.
FLAT = ("level plane", "wall", SLOPING)


class OtherCurveError(InputError):
    """An outline that has a curve which is neither line nor arc."""


def refuse_others(
    others: Sequence[Other], faces: Sequence[SolidFace], inside: Callable[[Point], bool]
) -> None:
    """Refuses a curve that is neither line nor arc where material lies on one side of it only.

    The points farthest out are looked at first: where there is such a curve, it is most likely there.

    Parameters
    ----------
    inside : whether a point (x, y) belongs to the outline's region.

    Raises
    ------
    OtherCurveError
        Naming the face.
    """
    if not others:
        return
    every = np.concatenate([points for _, points in others])
    middle = (every.min(axis=0) + every.max(axis=0)) / 2

    def place(one: Other) -> tuple[bool, float]:
        # The face that makes the curve rather than the flat one that it cuts.
        return faces[one[0]].kind in FLAT, -float(np.hypot(*(one[1] - middle).T).max())

    ordered = sorted(others, key=place)
    # A curve of the border is there along much of it: few points of every curve find it before all are asked.
    for each in (FEW, 1):
        for index, points in ordered:
            away = np.hypot(*(points[1:-1] - middle).T)
            looked = np.argsort(-away, kind="stable")[::each].tolist()
            if any(is_border(points, k + 1, inside) for k in looked):
                raise other_curve(faces[index])


def is_border(points: NDArray[np.float64], k: int, inside: Callable[[Point], bool]) -> bool:
    """Whether a curve has the region on one side only at its point of a number, which is no end of it."""
    dx, dy = points[k + 1] - points[k - 1]
    size = float(np.hypot(dx, dy))
    if size < 10 * BESIDE[0]:
        return False
    x, y = points[k]
    nx, ny = float(-dy / size), float(dx / size)
    return all(
        inside((float(x + beside * nx), float(y + beside * ny)))
        != inside((float(x - beside * nx), float(y - beside * ny)))
        for beside in BESIDE
    )


def other_curve(face: SolidFace) -> OtherCurveError:
    """The refusal of a face whose border in the outline is neither line nor arc."""
    return OtherCurveError(
        f"the outline has a curve that is neither line nor arc: a {face.kind} at heights "
        f"{max(round(face.low, 6), 0):.6g} to {face.high:.6g} mm"
    )
