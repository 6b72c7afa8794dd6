"""Solids whose upper faces a clamp may press on in part only, made with Open CASCADE."""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
from OCP.gp import gp_Pnt
from step_shapes import box, cut, cylinder, fused

__all__ = [
    "bolted_plate",
    "clevis",
    "domed_cover",
    "overhang",
    "pillow_block",
    "tee",
    "webbed_cover",
]


def pillow_block(feet: float = 45.0) -> Any:
    """A pillow block 81 high: two feet 14 high, a body with a crown R 36 and a bore R 20 across it."""
    long = 2 * (36 + feet)
    body = fused(box(72, 40, 45, (-36, 0, 0)), cylinder(36, 40, (0, 0, 45), (0, 1, 0)))
    body = fused(body, box(long, 40, 14, (-long / 2, 0, 0)))
    bolts = [cylinder(6, 40, (side * (36 + feet / 2), 20, -10)) for side in (-1, 1)] if feet >= 30 else []
    return cut(body, cylinder(20, 60, (0, -10, 45), (0, 1, 0)), *bolts)


def clevis(slot: float = 16.0) -> Any:
    """A clevis: a base 20 high with two ears 60 high and 15 thick, a slot between them."""
    wide = slot + 30
    return cut(
        fused(box(wide, 60, 20), box(15, 60, 60), box(15, 60, 60, (wide - 15, 0, 0))),
        cylinder(8, 100, (-10, 30, 42), (1, 0, 0)),
    )


def bolted_plate() -> Any:
    """A plate of 120 x 60 x 12 mm under a block, with four holes Ø 10 near the ends of its feet."""
    body = fused(box(120, 60, 12), box(50, 60, 40, (35, 0, 0)))
    holes = [cylinder(5, 40, (x, y, -10)) for x in (14, 106) for y in (14, 46)]
    return cut(body, *holes)


def webbed_cover() -> Any:
    """A cover that stands on a rim: a web 4 mm thick, 12 mm above the plate, within a frame 16 high."""
    return cut(box(100, 70, 16), box(76, 46, 12, (12, 12, 0)))


def tee() -> Any:
    """A T that stands: a stem 30 wide under a bar 90 wide."""
    return fused(box(30, 50, 30, (30, 0, 0)), box(90, 50, 14, (0, 0, 30)))


def overhang() -> Any:
    """A foot of 100 x 60 x 15 mm, half of it under an arm that leaves a post, with a round end."""
    arm = fused(box(40, 30, 10, (0, 15, 35)), cylinder(15, 10, (40, 30, 35)))
    return fused(box(100, 60, 15), box(20, 60, 45), arm)


def domed_cover() -> Any:
    """A cover with a dome of R 50 on a flange 80 x 80 x 10, and a boss with a flat on the dome's side."""
    dome = BRepAlgoAPI_Common(
        BRepPrimAPI_MakeSphere(gp_Pnt(40, 40, -25), 50).Shape(), box(80, 80, 60, (0, 0, 0))
    ).Shape()
    return fused(box(80, 80, 10), dome)
