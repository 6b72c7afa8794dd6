"""The places for straps: for each hole that can take a bolt, the points around it on which the tip may press.

The tip lies entirely on the part's upper face and off its keep-out zones. The part's foot lies under the
whole tip, so that the strap does not bend the part. The points that a strap can reach form a ring about the
bolt; those at its least, middle and greatest radius are examined, every 30 degrees from the plate's x axis. A
bolt has the diameter of the dowel holes. It stands beside the part or in an opening of the part, in a hole
without a locator. If bolts have separate holes, it stands clear of the locators.
"""

from __future__ import annotations

from math import pi

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.loop import make_loop_segments
from workhold.model.fixture import Fixture
from workhold.model.straps import StrapHardware
from workhold.model.support_request import SupportRequest
from workhold.model.workpiece import Workpiece
from workhold.supports.faces import FaceBorders, TouchableFace
from workhold.supports.straps_beside_part import are_beside_part

__all__ = ["StrapPlaces", "find_bolt_holes", "find_strap_places", "find_top_face"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Points of a ring about a hole: so many radii from its least to its greatest, and directions.
RADII, WAYS = 3, 12


@frozen(eq=False)
class StrapPlaces:
    """The places for straps of a fixture, in order of columns, rows, radii and directions.

    Parameters
    ----------
    hole : (P, 2) column and row of the bolt, for each of P places.
    at : (P, 2) point of the tip, in mm in the plate's frame.
    """

    hole: IntArray
    at: Array

    def __len__(self) -> int:
        return len(self.hole)


def find_strap_places(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, request: SupportRequest, straps: StrapHardware
) -> StrapPlaces:
    """Return the places for straps on the plate of a fixture, on which the part lies.

    There are none where the part has no face above or below.
    """
    top, bottom = find_top_face(workpiece, request), None
    if request.bottom is None or request.bottom:
        bottom = TouchableFace.from_loops(request.bottom or [np.asarray(loop) for loop in workpiece.loops])
    if top is None or bottom is None:
        return StrapPlaces(np.zeros((0, 2), np.int64), np.zeros((0, 2)))
    hole, points = find_bolt_holes(fixture, workpiece, toolkit, straps)
    turns = 2 * pi / WAYS * np.arange(WAYS)
    radii = np.unique(np.linspace(*straps.reach, RADII))
    ring = np.array([(r * np.cos(turn), r * np.sin(turn)) for r in radii for turn in turns])
    at = (points[:, None] + ring).reshape(-1, 2)
    hole = np.repeat(hole, len(ring), axis=0)
    on_part = np.column_stack(fixture.pose.inverse.apply(*at.T))
    room = np.minimum(top.measure_room(on_part), bottom.measure_room(on_part))
    kept = room >= straps.tip_radius - GAP_SLACK
    return StrapPlaces(hole[kept], at[kept])


def find_top_face(workpiece: Workpiece, request: SupportRequest) -> TouchableFace | None:
    """Return the face that tips may press on, without its keep-out zones;
    None where there is no such face.
    """
    if request.top is not None and not request.top:
        return None
    outline = [np.asarray(loop) for loop in workpiece.loops]
    zones = (zone.loop for zone in request.top_zones)
    return TouchableFace.from_loops(request.top or outline, zones, request.top_heights)


def find_bolt_holes(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, straps: StrapHardware
) -> tuple[IntArray, Array]:
    """Return (the holes (B, 2), column and row, in which a bolt has room, their centres (B, 2) in mm).

    Only holes within a strap's reach of the part's bounding box are listed. Centres are in the plate's frame.
    """
    plate = next(carrier for carrier in toolkit.carriers if carrier.has_lattice and carrier.travel is None)
    bolts = plate if toolkit.strap_set is None else toolkit.strap_set.bolts
    part = FaceBorders(tuple(make_loop_segments(np.asarray(loop)) for loop in workpiece.loops))
    x0, y0, x1, y1 = workpiece.bounds
    corners = np.array(fixture.pose.apply(np.array([x0, x1, x0, x1]), np.array([y0, y0, y1, y1])))
    reach = straps.reach[1]
    first, pitch = np.array(bolts.compute_hole_center(0, 0)), np.array(bolts.pitch)
    low = np.floor((corners.min(axis=1) - reach - first) / pitch).astype(np.int64)
    high = np.ceil((corners.max(axis=1) + reach - first) / pitch).astype(np.int64)
    if bolts.columns is not None:
        low[0], high[0] = max(low[0], 0), min(high[0], bolts.columns - 1)
    if bolts.rows is not None:
        low[1], high[1] = max(low[1], 0), min(high[1], bolts.rows - 1)
    if any(not one.has_lattice and one.travel is None for one in toolkit.carriers):
        # Rows count from a fence, and there are none behind it.
        low[1] = max(low[1], 0)
    pegs = [peg for peg in fixture.pegs if peg.carrier == plate.name]
    taken = {(peg.column, peg.row) for peg in pegs if bolts is plate}
    holes = [
        (column, row)
        for column in range(low[0], high[0] + 1)
        for row in range(low[1], high[1] + 1)
        if (column, row) not in taken and not plate.is_blocked(column, row)
    ]
    hole = np.array(holes, np.int64).reshape(-1, 2)
    points = np.column_stack(bolts.compute_hole_center(hole[:, 0], hole[:, 1])).reshape(-1, 2)
    back = fixture.pose.inverse
    beside = np.column_stack(back.apply(*points.T))
    # In the outline, and in no opening of it, a point is within an odd number of loops.
    is_under = part.contains(beside).sum(axis=1) % 2 == 1
    free = ~is_under & (part.measure_distances(beside).min(axis=1) >= plate.peg_radius - GAP_SLACK)
    free &= are_beside_part(workpiece, beside, plate.peg_radius)
    if bolts is not plate:
        at_pegs = np.array([(peg.x, peg.y) for peg in pegs]).reshape(-1, 2)
        apart = np.hypot(*np.moveaxis(points[:, None] - at_pegs[None], 2, 0))
        free &= (apart >= 2 * plate.peg_radius - GAP_SLACK).all(axis=1)
    return hole[free], points[free]
