"""Which of the closed chains of one fill bound its paint: a loop inside another may be painted over (SVG 2, 13.4.2)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workhold.errors import InputError
from workhold.files.outline.chain import Chain, cleaned
from workhold.geometry.loop import LoopShape, encloses, loop_segments, refuse_meeting_loops, signed_area

__all__ = ["boundaries"]


def boundaries(chains: Sequence[Chain]) -> list[Chain]:
    """The chains that have paint on one side only, by the nonzero rule.

    How often the loops around a point turn about it, less those that turn the other way, is not zero where there is paint.
    A loop that meets others stays, to be refused with its place.
    """
    clean = [cleaned([chain]).chains for chain in chains]
    known = [k for k, found in enumerate(clean) if found and len(found[0].bulges) > 1]
    shapes, turns = [], []
    for k in known:
        (chain,) = clean[k]
        vertices = np.column_stack([chain.points[:-1], chain.bulges])
        shapes.append(LoopShape.of(loop_segments(vertices)))
        turns.append(int(np.sign(signed_area(shapes[-1].segments))))
    boxes = np.array([shape.box for shape in shapes]).reshape(-1, 4)
    over = set()
    for at, (k, shape) in enumerate(zip(known, shapes, strict=True)):
        x0, y0, x1, y1 = shape.box
        around = (boxes[:, 0] <= x0) & (boxes[:, 1] <= y0) & (boxes[:, 2] >= x1) & (boxes[:, 3] >= y1)
        around[at] = False
        near = np.flatnonzero(around).tolist()
        outer = [m for m in near if encloses(shapes[m], shape)]
        outside = sum(turns[m] for m in outer)
        if outside and outside + turns[at] and not any(meet(shape, shapes[m]) for m in near):
            over.add(k)
    return [chain for k, chain in enumerate(chains) if k not in over]


def meet(one: LoopShape, other: LoopShape) -> bool:
    """Whether two loops cross or touch."""
    try:
        refuse_meeting_loops(one, other, str, str)
    except InputError:
        return True
    return False
