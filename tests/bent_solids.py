"""Six solids that clamps bend, made with Open CASCADE: each bends in a way of its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from step_shapes import box, cut, cylinder, filleted, fused, upright

__all__ = ["SOLIDS"]


def plate() -> Any:
    """A plate with round corners, two bores and a pocket, which leaves 4 mm of floor."""
    blank = filleted(box(120, 70, 12), 8.0, upright)
    bores = [cylinder(8, 20, (x, 35, -1)) for x in (22, 98)]
    return cut(blank, *bores, filleted(box(44, 44, 20, (38, 13, 4)), 5.0, upright))


def housing() -> Any:
    """An open housing with walls of 2 mm."""
    hollow = filleted(box(116, 66, 30, (2, 2, 4)), 3.0, upright)
    blank = cut(filleted(box(120, 70, 25), 5.0, upright), hollow)
    return cut(blank, *(cylinder(4, 10, (x, 35, -1)) for x in (20, 100)))


def bracket() -> Any:
    """A bracket of sixty faces and more: a foot with bores, a wall with windows, ribs between them, and pockets."""
    foot, wall = filleted(box(110, 70, 10), 6.0, upright), box(110, 8, 42, (0, 62, 0))
    corner = box(110, 20, 10, (0, 50, 0))
    body = fused(foot, corner, wall)
    for x in (14, 52, 90):
        rib = cut(box(6, 30, 24, (x, 36, 8)), tilted_block(x - 1, 36, 10))
        body = fused(body, rib)
    body = cut(body, *(cylinder(3, 20, (x, y, -1)) for x in (10, 34, 76, 100) for y in (10, 26)))
    windows = [filleted(box(18, 20, 14, (x, 55, 20)), 4.0, lying) for x in (26, 66)]
    body = cut(body, *windows, *(cylinder(2.5, 30, (x, 50, 34), (0, 1, 0)) for x in (10, 55, 100)))
    pocket = filleted(box(26, 20, 10, (42, 8, 6)), 4.0, upright)
    return cut(body, pocket)


def tilted_block(x: float, y: float, z: float) -> Any:
    """What a rib loses above its slope, from (y, z) up to the wall."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Pnt, gp_Vec

    corners = [(x, y - 1, z), (x, y - 1, z + 30), (x, y + 26, z + 30), (x, y + 26, z + 22)]
    outline = BRepBuilderAPI_MakePolygon()
    for corner in corners:
        outline.Add(gp_Pnt(*corner))
    outline.Close()
    return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(outline.Wire()).Face(), gp_Vec(8, 0, 0)).Shape()


def lying(low: Any, high: Any) -> bool:
    """Whether an edge's box is a line along y."""
    return bool(high[0] - low[0] < 1e-6 and high[2] - low[2] < 1e-6)


def ring() -> Any:
    """A ring with a wall of 5 mm and a lug."""
    lug = fused(cylinder(45, 16, (0, 0, 0)), box(14, 16, 16, (40, -8, 0)))
    return cut(lug, cylinder(40, 20, (0, 0, -1)))


def angle() -> Any:
    """An L with bores."""
    body = fused(box(110, 24, 15), box(24, 90, 15))
    body = cut(body, *(cylinder(4.5, 20, (x, 12, -1)) for x in (12, 45, 70, 95)))
    return cut(body, *(cylinder(4.5, 20, (12, y, -1)) for y in (40, 75)))


def bored() -> Any:
    """A block with 60 faces: 18 bores, and a wall with six windows along one side."""
    body = cut(
        box(100, 60, 10),
        *(cylinder(3, 20, (12 + 15 * i, 12 + 18 * j, -1)) for i in range(6) for j in range(3)),
    )
    body = fused(body, box(100, 10, 35, (0, 50, 0)))
    return cut(body, *(box(8, 12, 10, (8 + 15 * i, 49, 16)) for i in range(6)))


SOLIDS: dict[str, Callable[[], Any]] = {
    "plate": plate,
    "housing": housing,
    "bracket": bracket,
    "ring": ring,
    "L": angle,
    "block": bored,
}
