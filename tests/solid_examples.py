"""Solids as they come out of CAD for the proof of outlines by height, made with Open CASCADE.

Each is a mechanical part of some kind with steps, flanges, fillets, chamfers, draft, holes, or faces that lean.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, pi, sin
from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from attrs import frozen
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.GC import GC_MakeSegment
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopLoc import TopLoc_Location
from step_shapes import at_height, box, chamfered, cut, cylinder, filleted, fused, prism, upright

from workhold.files.step.library import compute_bounding_box, turn_axis_up

__all__ = ["EXAMPLES", "SolidExample"]


@frozen
class SolidExample:
    """A solid with the heights of pegs at which it is looked at.

    Parameters
    ----------
    name : of the part.
    make : makes Open CASCADE's solid.
    heights : of pegs, in mm.
    prismatic : whether it has level and upright faces only.
    """

    name: str
    make: Callable[[], Any]
    heights: tuple[float, ...]
    prismatic: bool = False


def polygon(points: Sequence[tuple[float, float]], height: float) -> Any:
    """A prism over a polygon, from z = 0 up."""
    ends = [gp_Pnt(x, y, 0.0) for x, y in points]
    return prism(
        [GC_MakeSegment(a, b).Value() for a, b in zip(ends, [*ends[1:], ends[0]], strict=True)], height
    )


def tilted(at: Sequence[float], up: Sequence[float], along: Sequence[float]) -> Any:
    """A large box of which one side is a plane about a point, square to a direction that leads into it."""
    frame = gp_Ax2(gp_Pnt(*at), gp_Dir(*up), gp_Dir(*along))
    middle = gp_Vec(frame.XDirection()) + gp_Vec(frame.YDirection())
    return BRepPrimAPI_MakeBox(frame.Translated(middle * -200.0), 400, 400, 400).Shape()


def cone(low: float, high: float, height: float, at: Sequence[float]) -> Any:
    """A cone about an upright axis, of a radius below and one above."""
    return BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(*at), gp_Dir(0, 0, 1)), low, high, height).Shape()


def stepped() -> Any:
    """A plate with a block and a boss on it."""
    return fused(box(80, 50, 6), box(40, 30, 14, (10, 10, 6)), cylinder(8, 12, (66, 25, 6)))


def bearing_housing() -> Any:
    """A round housing on a square flange, bored in two steps, with counterbored bolt holes."""
    body = fused(filleted(box(80, 80, 12), 10, upright), cylinder(28, 34, (40, 40, 0)))
    bolts = [
        tool
        for x in (12, 68)
        for y in (12, 68)
        for tool in (cylinder(3.3, 30, (x, y, -1)), cylinder(5.5, 30, (x, y, 6)))
    ]
    return cut(body, cylinder(14, 60, (40, 40, -1)), cylinder(20, 60, (40, 40, 20)), *bolts)


def inner_foot(low: Any, high: Any) -> bool:
    """Whether an edge lies level at height 8, away from the plate's border."""
    return at_height(8.0)(low, high) and low[0] > 1 and high[0] < 69 and low[1] > 1 and high[1] < 49


def filleted_foot() -> Any:
    """A block on a plate with a fillet around its foot."""
    return filleted(fused(box(70, 50, 8), box(40, 26, 20, (15, 12, 8))), 3.0, inner_foot)


def rounded_top() -> Any:
    """A plate with all edges rounded."""
    return filleted(box(60, 40, 20), 4.0, lambda low, high: True)


def chamfered_block() -> Any:
    """A block with round corners and chamfers above and below."""
    block = filleted(box(64, 44, 18), 6.0, upright)
    return chamfered(block, 1.5, lambda low, high: at_height(0.0)(low, high) or at_height(18.0)(low, high))


def casting() -> Any:
    """A body with draft on all sides on a machined foot, with a round boss with draft."""
    sides = [
        tilted((0, 0, 8), (-1, 0, 0.08), (0, 1, 0)),
        tilted((80, 0, 8), (1, 0, 0.08), (0, 1, 0)),
        tilted((0, 0, 8), (0, -1, 0.08), (1, 0, 0)),
        tilted((0, 60, 8), (0, 1, 0.08), (1, 0, 0)),
    ]
    return fused(box(80, 60, 8), cut(box(80, 60, 22, (0, 0, 8)), *sides), cone(14, 11, 8, (40, 30, 30)))


def blind_holes() -> Any:
    """A plate with blind holes from both sides, one above the other, and one through."""
    holes = [
        cylinder(6, 8, (18, 20, -1)),
        cylinder(4, 30, (18, 20, 14)),
        cylinder(5, 30, (45, 14, 9)),
        cylinder(4, 40, (62, 30, -1)),
        cylinder(7, 12, (40, 32, -1)),
    ]
    return cut(box(76, 44, 22), *holes)


def slanted() -> Any:
    """A block whose top slopes, with a slanted end and an upright slanted corner."""
    body = cut(box(70, 40, 24), tilted((0, -50, 12), (-0.15, 0, 1), (1, 0, 0.15)))
    body = cut(body, tilted((50, 60, -1), (1, 1, 0), (0, 0, 1)))
    return cut(body, tilted((0, -50, 4), (-1, 0, 0.7), (0.7, 0, 1)))


def bridge() -> Any:
    """A bridge on two feet with a hole through its deck."""
    deck = fused(box(20, 46, 14), box(24, 46, 14, (56, 0, 0)), box(80, 46, 8, (0, 0, 14)))
    return cut(deck, cylinder(6, 60, (40, 23, -1)), cylinder(4, 60, (10, 23, -1)))


def counterbored() -> Any:
    """A plate with countersunk and counterbored holes."""
    holes = [
        cylinder(4, 40, (15, 15, -1)),
        cylinder(7, 40, (15, 15, 9)),
        cylinder(4, 40, (50, 25, -1)),
        cone(4, 9, 5, (50, 25, 11)),
        cylinder(7, 7, (32, 32, -1)),
    ]
    return cut(box(66, 46, 16), cylinder(3, 40, (32, 32, -1)), *holes)


def pocketed() -> Any:
    """A plate with a pocket with round corners, an island in it, and an open pocket at one side."""
    pocket = filleted(box(50, 30, 20, (10, 10, 6)), 5.0, upright)
    return cut(box(90, 50, 18), cut(pocket, cylinder(6, 40, (35, 25, 0))), box(30, 20, 20, (70, 15, 8)))


def cross_drilled() -> Any:
    """A block with holes across it that open to its sides, and one that meets an upright hole."""
    across = [cylinder(5, 80, (-5, 20, 9), (1, 0, 0)), cylinder(4, 80, (30, -5, 0), (0, 1, 0))]
    return cut(box(60, 40, 20), *across, cylinder(6, 40, (30, 20, -1)))


def extrusion() -> Any:
    """A length of T-slot extrusion that lies, with a milled end."""
    side = [(0, 0), (15, 0), (15, 3), (10, 3), (10, 9), (30, 9), (30, 3), (25, 3), (25, 0), (40, 0)]
    side += [(40, 40), (25, 40), (25, 37), (30, 37), (30, 31), (10, 31), (10, 37), (15, 37), (15, 40)]
    profile = polygon([*side, (0, 40)], 90)
    lying = turn_axis_up(profile, "x")
    low = [float(value) for value in corner(lying)]
    step = box(300, 300, 12, (low[0] + 40 + 30, low[1] - 5, low[2] + 28))
    return cut(lying, box(20, 300, 100, (low[0] - 5, low[1] - 5, low[2] - 5)), step)


def corner(shape: Any) -> tuple[float, float, float]:
    """The lowest corner of a shape's bounding box."""
    return compute_bounding_box(shape)[0]


def lying_shaft() -> Any:
    """A shaft that lies, with two flats and a collar."""
    shaft = fused(cylinder(10, 90, (0, 0, 12), (1, 0, 0)), cylinder(12, 14, (30, 0, 12), (1, 0, 0)))
    return cut(shaft, box(24, 40, 40, (66, 7, -5)), box(24, 40, 40, (66, -47, -5)))


def boss_foot(low: Any, high: Any) -> bool:
    """Whether an edge lies level at height 7, away from the plate's border."""
    return at_height(7.0)(low, high) and low[0] > 1 and high[0] < 59


def boss() -> Any:
    """A bored boss on a plate with a fillet at its foot and a rounded upper edge."""
    shape = filleted(fused(box(60, 60, 7), cylinder(15, 25, (30, 30, 0))), 4.0, boss_foot)
    return filleted(cut(shape, cylinder(7, 60, (30, 30, -1))), 2.0, at_height(25.0))


def ribbed() -> Any:
    """An angle with an upright leg, two ribs and holes in both legs."""
    angle = fused(box(70, 60, 10), box(70, 10, 50))
    for x in (12, 50):
        rib = turn_axis_up(polygon([(0, 0), (40, 0), (0, 30)], 8), "y")
        low, move = corner(rib), gp_Trsf()
        move.SetTranslation(gp_Vec(x - low[0], 10 - low[1], 10 - low[2]))
        angle = fused(angle, rib.Moved(TopLoc_Location(move)))
    return cut(angle, cylinder(5, 40, (35, 40, -1)), cylinder(6, 40, (35, -5, 35), (0, 1, 0)))


def bell_crank() -> Any:
    """A bell crank: three bored eyes of other heights on two thin arms."""
    arms = fused(box(70, 14, 8, (0, -7, 4)), box(14, 60, 8, (-7, 0, 4)))
    eyes = [cylinder(16, 24, (0, 0, 0)), cylinder(12, 16, (70, 0, 0)), cylinder(10, 20, (0, 60, -2))]
    bores = [cylinder(8, 60, (0, 0, -5)), cylinder(6, 60, (70, 0, -5)), cylinder(5, 60, (0, 60, -5))]
    return cut(fused(arms, *eyes), *bores)


def valve_body() -> Any:
    """A ball with a lying pipe through it and a flange on a foot below."""
    ball = BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 30), 22).Shape()
    body = fused(ball, cylinder(12, 90, (-45, 0, 30), (1, 0, 0)), cylinder(10, 30, (0, 0, 0)))
    body = fused(body, cylinder(24, 8, (0, 0, 0)), cylinder(20, 6, (-45, 0, 30), (1, 0, 0)))
    return cut(body, cylinder(7, 120, (-60, 0, 30), (1, 0, 0)))


def turned() -> Any:
    """An upright turned part with shoulders, a groove, a cone and a bore."""
    body = fused(
        cylinder(30, 10, (0, 0, 0)),
        cylinder(20, 12, (0, 0, 10)),
        cone(20, 14, 8, (0, 0, 22)),
        cylinder(14, 12, (0, 0, 30)),
    )
    groove = cut(cylinder(40, 3, (0, 0, 14)), cylinder(17, 3, (0, 0, 14)))
    return cut(body, groove, cylinder(6, 60, (0, 0, -1)), box(60, 60, 60, (26, -30, -1)))


def dovetail() -> Any:
    """A slide with a dovetail below and a slot above."""
    across = [(0.0, 0.0), (50.0, 0.0), (44.0, 12.0), (60.0, 12.0), (60.0, 26.0), (-10.0, 26.0), (-10.0, 12.0)]
    return cut(turn_axis_up(polygon([*across, (6.0, 12.0)], 70), "y"), cylinder(4, 200, (30, 25, -100)))


def rim() -> Any:
    """A disc with a full rounded rim and three holes."""
    disc = fused(
        cylinder(30, 10, (0, 0, 0)),
        BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(0, 0, 5), gp_Dir(0, 0, 1)), 30, 5).Shape(),
    )
    holes = [cylinder(4, 40, (18 * cos(k * 2 * pi / 3), 18 * sin(k * 2 * pi / 3), -10)) for k in range(3)]
    return cut(disc, *holes)


def hollow() -> Any:
    """A box with a closed void and a window from the side that does not reach through."""
    return cut(box(60, 40, 30), box(30, 20, 10, (15, 10, 10)), box(20, 12, 8, (50, 14, 4)))


def overlapped() -> Any:
    """Two discs that overlap under a flange with a hole, so that arcs end in arcs."""
    body = fused(cylinder(20, 12, (0, 0, 0)), cylinder(16, 18, (26, 6, 0)))
    flange = fused(cylinder(24, 6, (0, 0, 12)), box(30, 20, 6, (10, -14, 12)))
    return cut(fused(body, flange), cylinder(7, 60, (0, 0, -1)))


def wedge_on_plate() -> Any:
    """A wedge that stands on a plate and leans over its border."""
    wedge = BRepAlgoAPI_Common(
        box(80, 30, 40, (10, 10, 6)), tilted((60, -50, 6), (-1, 0, -0.5), (0, 1, 0))
    ).Shape()
    return fused(
        box(60, 50, 6),
        cut(box(70, 30, 30, (10, 10, 6)), tilted((50, -50, 6), (1, 0, -0.6), (0, 1, 0))),
        wedge,
    )


EXAMPLES = (
    SolidExample("stepped", stepped, (4.0, 10.0, 19.0), True),
    SolidExample("bearing housing", bearing_housing, (8.0, 20.0, 34.0), True),
    SolidExample("filleted foot", filleted_foot, (5.0, 9.0, 20.0)),
    SolidExample("rounded top", rounded_top, (6.0, 12.0, 18.0)),
    SolidExample("chamfered block", chamfered_block, (8.0, 17.0)),
    SolidExample("casting", casting, (6.0, 20.0, 36.0)),
    SolidExample("blind holes", blind_holes, (5.0, 12.0, 22.0), True),
    SolidExample("slanted", slanted, (3.0, 10.0, 20.0)),
    SolidExample("bridge", bridge, (13.0, 18.0), True),
    SolidExample("counterbored", counterbored, (4.0, 10.0, 15.0)),
    SolidExample("pocketed", pocketed, (5.0, 12.0), True),
    SolidExample("cross drilled", cross_drilled, (5.0, 12.0, 20.0)),
    SolidExample("extrusion", extrusion, (8.0, 20.0, 35.0), True),
    SolidExample("lying shaft", lying_shaft, (6.0, 12.0, 20.0)),
    SolidExample("boss", boss, (5.0, 15.0, 24.0)),
    SolidExample("ribbed", ribbed, (8.0, 20.0, 45.0)),
    SolidExample("bell crank", bell_crank, (3.0, 8.0, 20.0), True),
    SolidExample("valve body", valve_body, (6.0, 25.0, 40.0)),
    SolidExample("turned", turned, (8.0, 20.0, 35.0)),
    SolidExample("dovetail", dovetail, (8.0, 11.0, 20.0)),
    SolidExample("rim", rim, (3.0, 7.0)),
    SolidExample("hollow", hollow, (6.0, 25.0), True),
    SolidExample("overlapped", overlapped, (8.0, 16.0), True),
    SolidExample("wedge on plate", wedge_on_plate, (5.0, 14.0, 30.0)),
)
