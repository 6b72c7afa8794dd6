"""What Open CASCADE says of outlines by height and of fixtures of solids; nothing here is the program's word.

Glossary
--------
slab : what a solid has between the plane on which it lies and the height of the pegs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import hypot
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepAlgoAPI import BRepAlgoAPI_Section
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.gp import gp_Ax2, gp_Dir, gp_Pln, gp_Pnt
from step_shapes import cylinder

from workhold import Fixture, Workpiece
from workhold.files.step.library import list_sub_shapes
from workhold.geometry.loop import make_loop_segments
from workhold.geometry.segment import Segment, make_segment_rows
from workhold.kernels.base.distance import is_inside, measure_outline_distances

__all__ = ["NEAR", "border_faults", "fixture_faults", "off_region", "section_faults", "section_points"]

Array = NDArray[np.float64]
# mm. What agrees to this is the same.
NEAR = 1e-6
# How far pegs are drawn smaller where they must not enter, in mm, and how much of that must be left over.
SHRUNK, LEFT = 2e-6, 5e-7


def segments_of(loops: Sequence[Array]) -> list[Segment]:
    """All segments of some loops of vertices."""
    return [segment for loop in loops for segment in make_loop_segments(loop)]


def off_region(points: Array, rows: Array) -> Array:
    """How far points (N, 2) lie outside a region in mm, 0 inside."""
    away = np.asarray(measure_outline_distances(np.ascontiguousarray(points), rows))
    inside = np.array([bool(is_inside(x, y, rows)) for x, y in points.tolist()])
    return np.where(inside, 0.0, away)


def section_points(shape: Any, z: float, along_edge: int = 9) -> Array:
    """Points (N, 2) along all edges in which a level plane cuts a solid."""
    cut = BRepAlgoAPI_Section(shape, gp_Pln(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), False)
    cut.Approximation(False)
    cut.Build()
    points = []
    for edge in list_sub_shapes(cut.Shape(), "EDGE"):
        curve = BRepAdaptor_Curve(edge)
        for t in np.linspace(curve.FirstParameter(), curve.LastParameter(), along_edge):
            value = curve.Value(float(t))
            points.append((value.X(), value.Y()))
    return np.array(points).reshape(-1, 2)


def section_faults(shape: Any, loops: Sequence[Array], top: float, heights: int) -> list[str]:
    """Heights below the top of the pegs at which the section of a solid reaches out of an outline.

    Parameters
    ----------
    loops : of U(0, top), vertices (N, 3).
    heights : how many are looked at.
    """
    rows = make_segment_rows(segments_of(loops))
    faults = []
    for k in range(heights):
        z = top * (k + 0.5) / heights
        points = section_points(shape, z)
        away = off_region(points, rows)
        if len(points) and away.max() > NEAR:
            faults.append(f"at {z:.6g} the section is {away.max():.3g} mm out at {points[away.argmax()]}")
    return faults


def distance(a: Any, b: Any) -> float:
    """Distance of two shapes in mm, 0 where one holds the other."""
    return float(BRepExtrema_DistShapeShape(a, b).Value())


def upright_line(x: float, y: float, low: float, high: float) -> Any:
    """An upright edge, a point where it has no length."""
    if abs(high - low) < 1e-7:
        return BRepBuilderAPI_MakeVertex(gp_Pnt(x, y, low)).Vertex()
    return BRepBuilderAPI_MakeEdge(gp_Pnt(x, y, low), gp_Pnt(x, y, high)).Edge()


def border_faults(shape: Any, loops: Sequence[Array], top: float, prismatic: bool) -> list[str]:
    """Places of an outline's border over which a solid has nothing in the slab, or beside which it has.

    Parameters
    ----------
    loops : of U(0, top), vertices (N, 3).
    prismatic : whether all faces are level or upright; what lies at the very top of the slab then counts not.
    """
    faults = []
    below = top - 1e-4 if prismatic else top
    for segment in segments_of(loops):
        for share in (-0.93, -0.31, 0.0, 0.57, 1.0):
            place = share * segment.half_extent
            (x, y), (nx, ny) = segment.compute_point(place), segment.compute_normal(place)
            if (away := distance(upright_line(x, y, 0.0, below), shape)) > NEAR:
                faults.append(f"nothing over the border at ({x:.6g}, {y:.6g}): {away:.3g} mm")
            # Beside an inner corner another piece of the border may be near.
            beside = min(1e-4, segment.length / 100)
            line = upright_line(x + beside * nx, y + beside * ny, 0.0, top - 1e-3)
            if abs(share) < 0.6 and distance(line, shape) == 0.0:
                faults.append(f"the solid goes on beside the border at ({x:.6g}, {y:.6g})")
    return faults


def fixture_faults(shape: Any, part: Workpiece, fixture: Fixture, toolkit: Any) -> Iterator[str]:
    """What is wrong with the pegs of a fixture, as bodies against the solid.

    Each touches over the ends of its band and nowhere enters, up to the head room above it. It begins at the
    lower of the heights of its carrier, if that has its own.
    """
    assert part.solid is not None
    room = part.solid.head_room
    for peg in fixture.pegs:
        low, top = toolkit.find_carrier(peg.carrier).heights or (0.0, part.solid.peg_height)
        face = next(one for one in part.numbered.faces if peg.face in one.segments)
        band = part.numbered.bands[face.number]
        if band is None:
            yield f"{peg.hole} touches face {peg.face}, which has no band"
            continue
        x, y = fixture.pose.inverse.apply(peg.x, peg.y)
        place = min(
            max(face.segment.find_parameter((x, y)), -face.segment.half_extent), face.segment.half_extent
        )
        (px, py), (nx, ny) = face.segment.compute_point(place), face.segment.compute_normal(place)
        if peg.is_on_wall:
            nx, ny = wall_normal(fixture, (nx, ny))
            body, smaller = wall(px, py, nx, ny, 0.0, top), wall(px, py, nx, ny, SHRUNK, top + room)
            assert low == 0.0
        else:
            radius = hypot(x - px, y - py)
            own = toolkit.find_carrier(peg.carrier).peg_radius
            if abs(radius - own) > NEAR:
                yield f"{peg.hole} stands {radius - own:.3g} mm off its face"
            body = cylinder(own, top - low, (x, y, low))
            above = low + SHRUNK if low else 0.0
            smaller = cylinder(own - SHRUNK, top + room - SHRUNK - above, (x, y, above))
        if (away := distance(body, shape)) > NEAR:
            yield f"{peg.hole} is {away:.3g} mm off the solid"
        if (away := distance(smaller, shape)) < LEFT:
            yield f"{peg.hole} enters the solid below {top + room:g} ({away:.3g})"
        for z in np.linspace(*band, 7).tolist():
            touched = BRepBuilderAPI_MakeVertex(gp_Pnt(px, py, z)).Vertex()
            if (away := distance(touched, shape)) > NEAR:
                yield f"{peg.hole} is {away:.3g} mm off at {z:g}, within its band"
            inside = BRepBuilderAPI_MakeVertex(gp_Pnt(px + 1e-3 * nx, py + 1e-3 * ny, z)).Vertex()
            if distance(inside, shape) == 0.0:
                yield f"{peg.hole} has material before its face at {z:g}"


def wall_normal(fixture: Fixture, rough: tuple[float, float]) -> tuple[float, float]:
    """The direction to a wall from the two places where a part touches it, nearest to a rough one."""
    (ax, ay), (bx, by) = (fixture.pose.inverse.apply(peg.x, peg.y) for peg in fixture.pegs if peg.is_on_wall)
    size = hypot(bx - ax, by - ay)
    nx, ny = (by - ay) / size, (ax - bx) / size
    sign = 1.0 if nx * rough[0] + ny * rough[1] > 0 else -1.0
    return sign * nx, sign * ny


def wall(x: float, y: float, nx: float, ny: float, off: float, top: float) -> Any:
    """A long wall through a point, on the side to which a normal leads, off it by a length in mm."""
    frame = gp_Ax2(gp_Pnt(x + off * nx, y + off * ny, 0.0), gp_Dir(0, 0, 1), gp_Dir(ny, -nx, 0))
    start = frame.Location().XYZ() - frame.XDirection().XYZ() * 500.0
    low = gp_Ax2(gp_Pnt(start), gp_Dir(0, 0, 1), gp_Dir(ny, -nx, 0))
    return BRepPrimAPI_MakeBox(low, 1000.0, 10.0, top - off).Solid()
