"""The visible elements of a toolkit that holds a part: plates, holes, pegs, clamps and walls, and the lengths
to set. Pictures, sheets, DXF drawings, STEP assemblies and the page all draw from this one description.

Glossary
--------
reach : the extent of part, pegs and bolts of straps, widened by one pitch or a fourteenth of the extent, and
    along the travel by the distance that carriers slide. The holes within it are shown. A lattice without a
    number of columns or rows continues before column A and row 1, so that the plate is under the whole part.
    Those holes have no names, and their numbers are negative.
plate : the rectangle around the shown holes, half a pitch wider.
broken side : a side of a plate where the carrier extends beyond the shown area.
facing side : a side towards another carrier; there a plate takes less than half of the gap between the holes.
clamp : a carrier that is bolted to a plate and has no plate of its own; its body extends from its hole to its
    tip.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from itertools import combinations
from math import ceil, floor, inf
from typing import Literal

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.fixels.carrier import Carrier
from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Box, Point
from workhold.geometry.symmetry import rotate_vectors
from workhold.limits import MOST_STEPS
from workhold.model.clamps import ShownClamp, find_clamping_direction, list_shown_clamps
from workhold.model.fixture import Fixture, Peg
from workhold.model.jaw_hold import JawHold
from workhold.model.pose import Pose
from workhold.model.setup import LengthSetting, list_length_settings
from workhold.model.straps import StrappedHold
from workhold.model.vise_bodies import find_stop_level, list_parallel_boxes
from workhold.model.wall_ends import measure_standouts
from workhold.model.workpiece import Workpiece

__all__ = [
    "MOST_HOLES",
    "Axis",
    "ShownHole",
    "ShownSetUp",
    "ShownJaws",
    "ShownCarrier",
    "Side",
    "bound_held_part",
    "bound_placed_part",
    "bound_placed_parts",
    "find_shown",
    "find_shown_beside",
]

Side = Literal["left", "right", "bottom", "top"]

# Relative to the pitch: a hole this little outside the reach is in it.
ROUNDING = 1e-6


def bound_held_part(
    part: Box, fixture: Fixture, clamps: Sequence[ShownClamp], bolts: Sequence[Point] = ()
) -> Box:
    """Return the bounding box in mm of the part's box, the pegs' centres, the backs of clamps and ``bolts``."""
    places = [*((peg.x, peg.y) for peg in fixture.pegs), *(clamp.back for clamp in clamps), *bolts]
    return reduce(Box.unite, (Box(x, y, x, y) for x, y in places), part)


def list_strap_bolts(fixture: Fixture, toolkit: Toolkit) -> list[Point]:
    """Return the centres (x, y) in mm of the bolts of straps; [] without straps."""
    straps, hold = toolkit.strap_set, fixture.hold
    if straps is None or not isinstance(hold, StrappedHold):
        return []
    places = (straps.bolts.compute_hole_center(*one.hole) for one in hold.straps)
    return [(float(x), float(y)) for x, y in places]


def list_strap_holes(fixture: Fixture, toolkit: Toolkit) -> frozenset[tuple[int, int]]:
    """Return (column, row) of the plate's holes that bolts of straps and the supports under the part occupy.

    Bolts count only if they stand in dowel holes. The set is empty without straps.
    """
    straps, hold = toolkit.strap_set, fixture.hold
    if straps is None or not isinstance(hold, StrappedHold):
        return frozenset()
    bolts = [one.hole for one in hold.straps] if straps.is_on_dowel_holes else []
    return frozenset([*bolts, *hold.supports])


def bound_reach(held: Box, fixture: Fixture, carriers: Sequence[Carrier]) -> Box:
    """Return the reach, a box in mm, from the extent of part, pegs, clamps and bolts (``held``); see the
    glossary.
    """
    reach = held
    more = max(reach.width, reach.height) / 14
    more_x, more_y = (max(more, *(carrier.pitch[axis] for carrier in carriers)) for axis in (0, 1))
    reach = Box(reach.x0 - more_x, reach.y0 - more_y, reach.x1 + more_x, reach.y1 + more_y)
    for carrier in carriers:
        if carrier.travel is not None:
            along_x, along_y = carrier.travel.unit
            for x, y in (
                carrier.compute_hole_center(0, 0),
                carrier.compute_hole_center(0, 0, fixture.travel),
            ):
                x, y = x if along_x else reach.x0, y if along_y else reach.y0
                reach = reach.unite(Box(x, y, x, y))
    return reach


def find_cells_in_reach(carrier: Carrier, travelled: float, reach: Box, held: Point) -> tuple[range, range]:
    """Return the columns and the rows of a carrier whose holes lie in the box ``reach``, at least one of
    each.

    A lattice without an end also has negative numbers, for holes that lie under the held part; ``held`` is
    that part's lower left corner in mm, with inf as y for rows that begin at a wall. Raises InputError for
    more than MOST_STEPS holes.
    """
    x, y = carrier.compute_hole_center(0, 0, travelled)
    columns = find_numbers_in_reach(
        reach.x0 - x, reach.x1 - x, carrier.pitch[0], carrier.columns, held[0] - x
    )
    rows = find_numbers_in_reach(reach.y0 - y, reach.y1 - y, carrier.pitch[1], carrier.rows, held[1] - y)
    if (columns.stop - columns.start) * (rows.stop - rows.start) > MOST_STEPS:
        raise InputError(
            f"part and pegs reach over more than {MOST_STEPS:,} holes of the {carrier.title}, too many to "
            "show: check the fixture's pose, its pegs and the pitch."
        )
    return columns, rows


def find_numbers_in_reach(low: float, high: float, pitch: float, count: int | None, held: float) -> range:
    """Return the numbers of columns or rows at distances in [low, high] mm from the first one; at least one.

    ``count`` is the number of columns or rows; None for a lattice without an end. Such a lattice has negative
    numbers if ``held`` (mm) is negative: the range then begins at held / pitch, rounded.
    """
    last, first = max(floor(high / pitch + ROUNDING), 0), max(ceil(low / pitch - ROUNDING), 0)
    if count is not None:
        last, first = min(last, count - 1), min(first, count - 1)
    elif held < 0:
        first = min(first, floor(held / pitch + 0.5 + ROUNDING))
    return range(first, max(last, first) + 1)


def bound_hole_centers(carrier: Carrier, travelled: float, columns: range, rows: range) -> Box:
    """Return the bounding box of the centres of the holes in these columns and rows, in mm."""
    first, last = (carrier.compute_hole_center(columns[end], rows[end], travelled) for end in (0, -1))
    return Box(*first, *last)


def measure_facing_gaps(spans: list[Box]) -> list[dict[Side, float]]:
    """Return for each box a dict from each of its sides that faces another box to the smallest gap there in
    mm.
    """
    gaps: list[dict[Side, float]] = [{} for _ in spans]

    def note_gap(one: int, side: Side, gap: float) -> None:
        """Note the gap at a side of box ``one``, where it is smaller than that known before."""
        gaps[one][side] = min(gap, gaps[one].get(side, inf))

    for i, k in combinations(range(len(spans)), 2):
        for low, high in ((i, k), (k, i)):
            across, upward = spans[high].x0 - spans[low].x1, spans[high].y0 - spans[low].y1
            if across > 0:
                note_gap(low, "right", across)
                note_gap(high, "left", across)
            elif upward > 0 and spans[low].x0 <= spans[high].x1 and spans[high].x0 <= spans[low].x1:
                note_gap(low, "top", upward)
                note_gap(high, "bottom", upward)
    return gaps


Axis = tuple[Point, Point]

# With more holes than this, what cannot leave out holes by their size shows only those near the pegs.
MOST_HOLES = 2_000

# Of the gap between the holes of two carriers, how much a plate may cover from either side: the two do not
# touch.
SHARE_OF_GAP = 0.48
# Holes so many columns and rows from a peg are near it.
NEAR = 3
# Of the pitch: how thick a wall is drawn, whose own thickness nobody knows.
BAR = 0.4
# In mm, what stands for a pitch where there are no holes; how thick jaws are drawn whose thickness nobody knows, of
# their width; and half the length of a work stop, of the width.
USUAL_PITCH, JAW, STOP = 10.0, 0.16, 0.07


@frozen
class ShownHole:
    """A hole that shows; ``center`` in mm, ``used`` by a peg or a clamp, ``blocked`` for all pegs."""

    column: int
    row: int
    center: Point
    used: bool
    blocked: bool


@frozen
class ShownCarrier:
    """A carrier with a plate, for pictures; lengths in mm.

    Parameters
    ----------
    carrier : the carrier in the toolkit.
    travelled : distance in mm that it has slid.
    columns, rows : numbers of the columns and rows whose holes are shown.
    plate : visible rectangle of the plate.
    broken, facing : sides of the plate, see the glossary.
    pegs : pegs of the fixture that stand on it.
    bolted : pegs of clamps that are bolted to it.
    clamping : unit vector along which it slides and pushes when it clamps; None when it does not move.
    """

    carrier: Carrier
    travelled: float
    columns: range
    rows: range
    plate: Box
    broken: frozenset[Side]
    facing: frozenset[Side]
    pegs: tuple[Peg, ...]
    bolted: tuple[ShownClamp, ...]
    clamping: Point | None
    strapped: frozenset[tuple[int, int]] = frozenset()

    @property
    def used(self) -> set[tuple[int, int]]:
        """Holes, (column, row), in which a peg or a clamp stands."""
        clamps = {(clamp.tip.column, clamp.tip.row) for clamp in self.bolted if clamp.hole is not None}
        return clamps | {(peg.column, peg.row) for peg in self.pegs} | self.strapped

    @property
    def used_columns(self) -> set[int]:
        """Columns in which a peg or a clamp stands, or along which a clamp moves."""
        lines = {clamp.tip.column for clamp in self.bolted if clamp.pushes_along_column}
        return lines | {column for column, _ in self.used}

    @property
    def used_rows(self) -> set[int]:
        """Rows in which a peg or a clamp stands, or along which a clamp moves."""
        lines = {clamp.tip.row for clamp in self.bolted if not clamp.pushes_along_column}
        return lines | {row for _, row in self.used}

    @property
    def named_columns(self) -> list[tuple[int, float]]:
        """Columns that show and have a name (number 0 or more), each with its x in mm."""
        return [
            (column, self.carrier.compute_hole_center(column, 0, self.travelled)[0])
            for column in self.columns
            if column >= 0
        ]

    @property
    def named_rows(self) -> list[tuple[int, float]]:
        """Rows that show and have a name (number 0 or more), each with its y in mm."""
        return [
            (row, self.carrier.compute_hole_center(0, row, self.travelled)[1])
            for row in self.rows
            if row >= 0
        ]

    @property
    def names_at(self) -> Side:
        """Side at which rows are named:
        "left", or "right" where another carrier stands on the left or this one slides right.
        """
        slides_right = self.carrier.travel is not None and self.carrier.travel.unit[0] > 0
        return "right" if "left" in self.facing or slides_right else "left"

    @property
    def hole_radius(self) -> float:
        """Radius in mm to draw holes with: that of the pegs, at most 0.42 pitches;
        a seventh of the pitch for very thin pegs.
        """
        pitch, radius = min(self.carrier.pitch), self.carrier.peg_radius
        return min(radius, 0.42 * pitch) if radius > 0.05 * pitch else pitch / 7

    def list_holes(self, most: float = inf) -> list[ShownHole]:
        """Return the visible holes, row by row; if there are more than ``most``, only those near a used one."""
        cells = [(column, row) for row in self.rows for column in self.columns]
        if len(cells) > most:
            near = range(-NEAR, NEAR + 1)
            wanted = {(column + i, row + j) for column, row in self.used for i in near for j in near}
            cells = [cell for cell in cells if cell in wanted]
        return [
            ShownHole(
                *cell,
                self.carrier.compute_hole_center(*cell, self.travelled),
                cell in self.used,
                self.carrier.is_blocked(*cell),
            )
            for cell in cells
        ]


@frozen
class ShownLength:
    """A length to set, and the two axes, square to it, between which it is measured.

    Parameters
    ----------
    setting : the length.
    axes : the two axes, each from left to right or upward. For a sliding plate, one lies across the fixed
        plates, the other across the sliding plate. For a clamp they lead from the clamp to the plate's upper
        or right side.
    is_upright : whether it is measured along y.
    """

    setting: LengthSetting
    axes: tuple[Axis, Axis]
    is_upright: bool


@frozen
class ShownWall:
    """A straight wall along x at y = 0, for pictures; lengths in mm.

    Parameters
    ----------
    carrier : the wall's carrier in the toolkit.
    bar : visible rectangle of the wall; the part lies above it.
    ends : x of both ends of the part's contact with the wall.
    standouts : distances by which the part extends beyond the wall's left and right end; None for an endless
        wall.
    """

    carrier: Carrier
    bar: Box
    ends: tuple[float, float]
    standouts: tuple[float, float] | None = None


@frozen
class ShownJaws:
    """Two flat jaws seen from above, for pictures; lengths in mm.

    Parameters
    ----------
    fixed, moving : the jaws, with their drawn thickness.
    parallels : the two under the part, with their drawn width; none if the part lies on the bed.
    stop : the work stop; None without one.
    """

    fixed: Box
    moving: Box
    parallels: tuple[Box, ...]
    stop: Box | None

    @property
    def extent(self) -> Box:
        """Bounding box of jaws and work stop."""
        boxes = [self.fixed, self.moving, *([] if self.stop is None else [self.stop])]
        return reduce(Box.unite, boxes)


@frozen
class ShownSetUp:
    """A toolkit with a part, for pictures.

    Parameters
    ----------
    carriers : carriers with a plate, the fixed ones first.
    clamps : those that are bolted to a plate.
    measured : the lengths to set, one for each moving carrier.
    part : extent of the part in mm.
    walls : walls that the part lies flush against.
    jaws : two flat jaws that hold it by friction; None for other toolkits.
    """

    carriers: tuple[ShownCarrier, ...]
    clamps: tuple[ShownClamp, ...]
    measured: tuple[ShownLength, ...]
    part: Box
    walls: tuple[ShownWall, ...] = ()
    jaws: ShownJaws | None = None

    @property
    def extent(self) -> Box:
        """Bounding box of all that shows, with room behind each clamp."""
        boxes = [
            *([] if self.jaws is None else [self.jaws.extent]),
            *(one.plate for one in self.carriers),
            *(one.room for one in self.clamps),
            *(one.bar for one in self.walls),
        ]
        return reduce(Box.unite, boxes, self.part)

    @property
    def pitch(self) -> float:
        """Smallest distance between neighbouring holes in mm; :data:`USUAL_PITCH` if there are none."""
        return min((min(shown.carrier.pitch) for shown in self.carriers), default=USUAL_PITCH)


def find_shown(fixture: Fixture, toolkit: Toolkit, workpiece: Workpiece) -> ShownSetUp:
    """Return the visible elements of a toolkit that holds a workpiece; raises InputError as
    :func:`find_shown_beside`.
    """
    if isinstance(fixture.hold, JawHold):
        return find_shown_between_jaws(workpiece, fixture, toolkit)
    return find_shown_beside(bound_placed_part(workpiece, fixture.pose), fixture, toolkit)


def find_shown_between_jaws(workpiece: Workpiece, fixture: Fixture, toolkit: Toolkit) -> ShownSetUp:
    """Return the visible elements of two flat jaws with a workpiece between them."""
    jaws, hold, part = toolkit.flat_jaws, fixture.hold, bound_placed_part(workpiece, fixture.pose)
    assert jaws is not None and isinstance(hold, JawHold)
    width, opening = jaws.width, hold.opening
    thick = JAW * width if jaws.thickness is None else jaws.thickness
    stop, size = None, STOP * width
    if hold.stop is not None:
        is_left = hold.stop == "left"
        x = jaws.stop_offset if is_left else width - jaws.stop_offset
        y, half = find_stop_level(workpiece, jaws, hold, fixture.pose), jaws.stop_width / 2
        low, high = (x - 2 * size, x) if is_left else (x, x + 2 * size)
        stop = Box(low, y - half, high, y + half)
    seen = ShownJaws(
        Box(0.0, -thick, width, 0.0),
        Box(0.0, opening, width, opening + thick),
        tuple(list_parallel_boxes(jaws, hold)),
        stop,
    )
    faces = ((0.0, 0.0), (width, 0.0)), ((0.0, opening), (width, opening))
    measured = tuple(ShownLength(setting, faces, True) for setting in list_length_settings(fixture, toolkit))
    return ShownSetUp((), (), measured, part, jaws=seen)


def bound_placed_part(workpiece: Workpiece, pose: Pose) -> Box:
    """Return the bounding box of a workpiece in a pose, in mm, in the toolkit's frame."""
    (box,) = bound_placed_parts(workpiece, *np.array([[np.radians(pose.theta_deg)], [pose.x], [pose.y]]))
    return Box(*map(float, box))


def bound_placed_parts(
    workpiece: Workpiece, theta: NDArray[np.float64], x: NDArray[np.float64], y: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the bounding boxes (N, 4), x0, y0, x1, y1 in mm,
    of a workpiece in N poses: theta in radians, x and y in mm.

    The farthest point in a direction is the end of a segment, or the point of an arc whose normal has that
    direction.
    """
    outer = workpiece.segments[: workpiece.outer_count]
    corners = np.array([segment.start for segment in outer])
    arcs = [segment for segment in outer if isinstance(segment, Arc)]
    round_ones = np.array([(*a.center, a.radius, a.mid_angle, a.half_sweep) for a in arcs]).reshape(-1, 5)
    center_x, center_y, radius, middle, half = round_ones.T

    def find_farthest(direction: float) -> NDArray[np.float64]:
        """Return the greatest coordinate (N,) in mm along a direction,
        in radians, of the part turned by theta alone.
        """
        turned = direction - theta[:, None]
        reach = rotate_vectors(corners[:, 0], corners[:, 1], -turned)[0].max(axis=1)
        faces = np.abs((turned - middle + np.pi) % (2 * np.pi) - np.pi) <= half
        bulges = np.where(faces, rotate_vectors(center_x, center_y, -turned)[0] + radius, -np.inf)
        return np.asarray(np.maximum(reach, bulges.max(axis=1, initial=-np.inf)))

    left, bottom, right, top = (find_farthest(angle) for angle in (np.pi, -np.pi / 2, 0.0, np.pi / 2))
    return np.stack([x - left, y - bottom, x + right, y + top], axis=1)


def find_shown_beside(part: Box, fixture: Fixture, toolkit: Toolkit) -> ShownSetUp:
    """Return the visible elements of a toolkit with pegs that holds a part whose bounding box is ``part``.

    Raises InputError if part and pegs are so far apart that too many holes would be shown.
    """
    travelled = fixture.travel
    carriers = toolkit.plates
    clamps = tuple(list_shown_clamps(fixture, toolkit))
    held = bound_held_part(part, fixture, clamps, list_strap_bolts(fixture, toolkit))
    reach, lowest = bound_reach(held, fixture, carriers), inf if toolkit.ends_on_walls else held.y0
    ranges = [find_cells_in_reach(carrier, travelled, reach, (held.x0, lowest)) for carrier in carriers]
    spans = [
        bound_hole_centers(carrier, travelled, *cells)
        for carrier, cells in zip(carriers, ranges, strict=True)
    ]
    gaps = measure_facing_gaps(spans)
    out = []
    for carrier, (columns, rows), holes, facing in zip(carriers, ranges, spans, gaps, strict=True):
        half_x, half_y = carrier.pitch[0] / 2, carrier.pitch[1] / 2
        left, right = (min(half_x, SHARE_OF_GAP * facing.get(side, inf)) for side in ("left", "right"))
        bottom, top = (min(half_y, SHARE_OF_GAP * facing.get(side, inf)) for side in ("bottom", "top"))
        ends: dict[Side, bool] = {
            "left": carrier.columns is None or columns.start > 0,
            "right": carrier.columns is None or columns.stop < carrier.columns,
            "bottom": carrier.rows is None or rows.start > 0,
            "top": carrier.rows is None or rows.stop < carrier.rows,
        }
        out.append(
            ShownCarrier(
                carrier=carrier,
                travelled=travelled,
                columns=columns,
                rows=rows,
                plate=Box(holes.x0 - left, holes.y0 - bottom, holes.x1 + right, holes.y1 + top),
                broken=frozenset(side for side, goes_on in ends.items() if goes_on),
                facing=frozenset(facing),
                pegs=tuple(peg for peg in fixture.pegs if peg.carrier == carrier.name),
                bolted=tuple(clamp for clamp in clamps if clamp.carrier.on == carrier.name),
                clamping=find_clamping_direction(carrier, toolkit),
                strapped=list_strap_holes(fixture, toolkit),
            )
        )
    measured = tuple(make_shown_length(out, setting) for setting in list_length_settings(fixture, toolkit))
    seen = ShownSetUp(tuple(out), clamps, measured, part)
    walls = [carrier for carrier in toolkit.carriers if carrier.contact is WALL_END]
    return reduce(lambda before, wall: add_wall_to_view(before, fixture, wall), walls, seen)


def add_wall_to_view(seen: ShownSetUp, fixture: Fixture, carrier: Carrier) -> ShownSetUp:
    """Return the view with a wall added below the part:
    a bar as long as plate and part, or as the wall where that has ends.

    There is one plate; if it stands still, it is extended below the bar.
    """
    (plate,), thick = seen.carriers, BAR * min(carrier.pitch)
    around = plate.plate.unite(seen.part)
    reach = carrier.reach
    bar = Box(*(around.x0, -thick, around.x1, 0.0) if reach is None else (reach[0], -thick, reach[1], 0.0))
    left, right = (peg.x for peg in fixture.pegs if peg.carrier == carrier.name)
    # What stands still goes on below the bar; rows are counted from the wall, so what slides ends before the
    # first.
    low = -thick if plate.clamping is None else plate.plate.y0
    plate = evolve(plate, plate=evolve(plate.plate, y0=low), broken=plate.broken - {"bottom"})
    beyond = None if reach is None else measure_standouts(seen.part, reach)
    return evolve(seen, carriers=(plate,), walls=(ShownWall(carrier, bar, (left, right), beyond),))


def make_shown_length(seen: Sequence[ShownCarrier], setting: LengthSetting) -> ShownLength:
    """Return a length to set with the two axes that it is measured between."""
    mover = setting.carrier
    assert mover.travel is not None
    along, across = mover.travel.unit
    upright = abs(across) > abs(along)
    still = [one.plate for one in seen if one.clamping is None]
    own = [one.plate for one in seen if one.carrier.name == mover.name]

    def make_axis(at: Point, plates: list[Box]) -> Axis:
        """Return the line through a point, square to the length,
        across these plates; for a clamp it begins at the point.
        """
        first, last = min(plate.x0 for plate in plates), max(plate.x1 for plate in plates)
        low, high = min(plate.y0 for plate in plates), max(plate.y1 for plate in plates)
        if setting.tip is not None:
            first, low = at
        return ((first, at[1]), (last, at[1])) if upright else ((at[0], low), (at[0], high))

    return ShownLength(
        setting, (make_axis(setting.start, still or own), make_axis(setting.end, own or still)), upright
    )
