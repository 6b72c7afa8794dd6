"""Which loops of a workpiece lie in which: outer loops, and holes directly in them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workhold.errors import InputError
from workhold.geometry.loop import LoopShape, encloses, near_pairs

__all__ = ["outer_count", "refuse_misplaced_holes"]


def outer_count(name: str, shapes: Sequence[LoopShape]) -> int:
    """How many loops lie in no other, or in a hole (loops are known not to meet).

    Raises
    ------
    InputError
        Where they do not come before the others.
    """
    boxes = np.array([shape.box for shape in shapes])
    around = [
        [
            other
            for _, other in near_pairs(boxes[k : k + 1], boxes)
            if other != k and encloses(shapes[other], one)
        ]
        for k, one in enumerate(shapes)
    ]
    outer = [len(others) % 2 == 0 for others in around]
    first_hole = outer.index(False) if False in outer else len(outer)
    if any(outer[first_hole:]):
        raise InputError(
            f"{name}: loop {first_hole} is a hole before an outer loop: give all outer loops first."
        )
    return first_hole


def refuse_misplaced_holes(name: str, shapes: Sequence[LoopShape]) -> None:
    """Refuses holes outside the outer loop and holes inside one another (loops are known not to meet).

    Raises
    ------
    InputError
        Naming the hole.
    """
    boxes = np.array([shape.box for shape in shapes])
    for index, hole in enumerate(shapes[1:], start=1):
        x, y = hole.segments[0].start
        if not encloses(shapes[0], hole):
            raise InputError(
                f"{name}: loop {index}, at ({x:.6g}, {y:.6g}), lies outside the outer loop: the first loop "
                "must be the outline that encloses all the others."
            )
        for _, other in near_pairs(boxes[index : index + 1], boxes):
            if other not in (0, index) and encloses(shapes[other], hole):
                raise InputError(
                    f"{name}: loop {index}, at ({x:.6g}, {y:.6g}), lies inside the hole of loop {other}: "
                    "holes may not overlap; load the inner piece as a part of its own."
                )
