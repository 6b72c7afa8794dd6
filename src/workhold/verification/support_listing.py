"""Check that a list of supports is complete: all triples of holes are tried again, and all places of the
clamp are bounded.

If a point moves by 1 mm, its distance inside a triangle changes by at most 1 mm, and so does the room of the
tip. So the smaller of both at the middle of a square cell bounds it over the whole cell. Cells are divided
until some cell has a place for the clamp, or no cell can have one. How large a disc fits on a face is
computed from the face's segments.

Glossary
--------
room : of a hole or a place, the slack in mm of its tightest rule; negative where it breaks a rule.
sure : said of a hole or a triple that satisfies its rules by more than rounding.
possible : said of a hole or a triple that breaks no rule by more than rounding.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from heapq import heappop, heappush
from itertools import combinations, count, pairwise, product
from math import atan2, ceil, floor, hypot, inf, pi, sqrt

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.fixels.toolkit import Toolkit
from workhold.geometry.loop import compute_signed_area, make_loop_segments
from workhold.geometry.segment import Arc, Segment, compute_bounding_box, measure_distance_to_segment
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.support_request import SupportRequest

__all__ = [
    "Hole",
    "SupportPlaces",
    "measure_depth_inside",
    "measure_gap",
    "find_missing_triples",
    "measure_room_on",
    "split_borders",
]

Array = NDArray[np.float64]
Hole = tuple[str, int, int]
# In mm: what is kept or broken by more is not rounding.
AGREEMENT = 1e-6
# Cells looked at for a triple before nobody can say.
MOST_CELLS = 20_000
# Missing triples that are named; one is enough to refute a list.
MOST_NAMED = 3
Loop = tuple[Segment, ...]
# How far beside a segment a point is looked at, in mm.
PROBE = 1e-4


@frozen(eq=False)
class SupportPlaces:
    """Rules on the places of supports and of the tip of their clamp.

    Parameters
    ----------
    query : part and toolkit.
    fixture : the planar fixture.
    request : request for supports and clamp.
    """

    query: Query
    fixture: Fixture
    request: SupportRequest

    @cached_property
    def pegs(self) -> Array:
        """Places (P, 2) of the pegs, and of the ends on a wall, in the part's coordinates."""
        inverse = self.fixture.pose.inverse
        return np.array([inverse.apply(peg.x, peg.y) for peg in self.fixture.pegs])

    @property
    def toolkit(self) -> Toolkit:
        return self.query.toolkit

    def find_hole_place(self, hole: Hole) -> tuple[float, float]:
        """Return the centre of a hole (carrier, column, row) in the part's frame, in mm."""
        name, column, row = hole
        place = self.toolkit.find_carrier(name).compute_hole_center(column, row, self.fixture.travel)
        x, y = self.fixture.pose.inverse.apply(*place)
        return float(x), float(y)

    def compute_pad_room(self, hole: Hole) -> float:
        """Return the slack in mm of the tightest rule for a pad in a hole; negative if the pad breaks a rule."""
        asked, point = self.request, self.find_hole_place(hole)
        loops = self.query.workpiece.loops if asked.bottom is None else asked.bottom
        room = measure_room_on(loops, [zone.loop for zone in asked.bottom_zones], point)
        room -= asked.pad_radius + asked.pad_margin
        for peg, place in zip(self.fixture.pegs, self.pegs, strict=True):
            if peg in self.fixture.placed:
                body = self.toolkit.find_carrier(peg.carrier).body_radius
                room = min(room, hypot(point[0] - place[0], point[1] - place[1]) - asked.pad_radius - body)
        return room

    @cached_property
    def top_levels(self) -> list[TopLevel]:
        """The faces that the tip may press on, grouped by height."""
        asked = self.request
        loops = self.query.workpiece.loops if asked.top is None else asked.top
        heights = (None,) * len(loops) if asked.top_heights is None else asked.top_heights
        beside = [(asked.rising, asked.rising_heights), (asked.hanging, asked.hanging_heights)]
        return [
            TopLevel(
                sort_faces_by_size(
                    [split_borders(one) for one, z in zip(loops, heights, strict=True) if z == level]
                ),
                *(
                    [split_borders(one) for one, z in zip(*pair, strict=True) if z == level]
                    for pair in beside
                ),
            )
            for level in dict.fromkeys(heights)
        ]

    def compute_tip_room(self, point: tuple[float, float]) -> float:
        """Return the slack in mm of the tightest rule for the tip at a point of the part's frame; negative if
        it breaks a rule.
        """
        asked, room = self.request, -inf
        for level in self.top_levels:
            kept = measure_gap(level.rising, point) - asked.head_radius
            for face in level.faces:
                on = (
                    min(side * measure_reach(one, point) for one, side in face)
                    - asked.tip_radius
                    - asked.tip_margin
                )
                room = max(room, min(on, kept))
        off = (measure_reach(split_borders(zone.loop), point) for zone in asked.top_zones)
        room = min(room, *(-one - asked.tip_radius for one in off), inf)
        if asked.reach is not None:
            x, y = self.fixture.pose.apply(*point)
            rings = [
                min(hypot(x - a, y - b) - low, high - hypot(x - a, y - b)) for a, b, low, high in asked.reach
            ]
            room = min(room, max(rings, default=-inf))
        return room

    def classify_hanging_at(self, point: tuple[float, float], slack: float = 0.0) -> int:
        """Return the class of overhang of the tip at a point: 0 not over air, 1 over air at its rim only, 2
        over air at its middle.

        Air nearer than the tip's radius to the middle counts as at the rim; ``slack`` mm are added to that
        distance. Returns 0 if the point is on no upper face.
        """
        for level in self.top_levels:
            if any(
                all(side * measure_reach(one, point) > -AGREEMENT for one, side in face)
                for face in level.faces
            ):
                gap = measure_gap(level.hanging, point) + slack
                return 2 if gap < 0.0 else 1 if gap < self.request.tip_radius else 0
        return 0

    def find_travel(self, holes: Sequence[Hole]) -> tuple[bool, float | None]:
        """Return (fits, opening): whether pegs and supports in these holes fit on their plates, and the
        opening in mm.

        The opening is None if no carrier moves, or if no opening avoids the blocked holes.
        """
        toolkit, plates = self.toolkit, self.toolkit.plates
        taken: dict[str, list[tuple[int, int]]] = {plate.name: [] for plate in plates}
        for name, column, row in holes:
            taken[name].append((column, row))
        lines = {
            name: ([column for column, _ in places], [row for _, row in places])
            for name, places in taken.items()
        }
        for peg in self.fixture.pegs:
            carrier = toolkit.find_carrier(peg.carrier)
            for axis, number in enumerate((peg.column, peg.row)):
                if carrier.stands_on in lines and carrier.counted_axes[axis]:
                    lines[carrier.stands_on][axis].append(number)
        fits = True
        every_row = [row for one in lines.values() for row in one[1]]
        for plate in plates:
            columns = lines[plate.name][0]
            if plate.columns is not None and columns:
                fits &= max(columns) - min(columns) < plate.columns
            if plate.rows is not None:
                fits &= max(every_row) - min(every_row) < plate.rows
            if toolkit.wall is not None and plate.travel is None:
                fits &= min(every_row) >= 0 and (plate.rows is None or max(every_row) < plate.rows)
        moving = next((plate for plate in plates if plate.travel is not None), None)
        if moving is None or moving.travel is None:
            return fits, None
        axis = 0 if len(plates) > 1 else 1
        step, own = moving.pitch[axis], lines[moving.name][axis]
        opened = self.fixture.travel + min(own) * step
        count = (moving.columns, moving.rows)[axis]
        room = inf if count is None else count - 1 - max(own) + min(own)
        for plate in plates:
            if plate is not moving and plate.name != moving.name:
                other = lines[plate.name][axis]
                opened += ((plate.columns or 0) - 1 - max(other)) * step
                room += (plate.columns or 0) - 1 - max(other) + min(other)
        most = moving.travel.most
        back = 0 if most is None else max(ceil((opened - most - 1e-9) / step), 0)
        opened -= back * step
        fits = fits and back <= room and opened >= moving.travel.least - AGREEMENT
        if fits and len(plates) > 1 and any(plate.blocked for plate in plates):
            clear = find_widest_clear_opening(toolkit, self.fixture, [*holes])
            return clear is not None, clear
        return fits, opened


@frozen(eq=False)
class TopLevel:
    """Upper faces of one height.

    Parameters
    ----------
    faces : the loops of each, see :func:`sort_faces_by_size`.
    rising : loops around regions where the part rises above the faces.
    hanging : loops around regions of the faces with air below.
    """

    faces: list[list[tuple[Loop, int]]]
    rising: list[Loop]
    hanging: list[Loop]


def split_borders(loop: Array) -> Loop:
    """Return the segments of a closed loop of vertices (N, 3) with rows x, y, bulge."""
    return tuple(make_loop_segments(np.asarray(loop)))


def measure_gap(loops: Sequence[Loop], point: tuple[float, float]) -> float:
    """Return the distance in mm of a point from the region to the left of the loops.

    It is negative inside the region, and inf without loops.
    """
    near = min((measure_distance_to_segment(point, one) for loop in loops for one in loop), default=inf)
    return -near if sum(count_turns_about(loop, point) for loop in loops) > 0 else near


def list_holes_near(rules: SupportPlaces) -> Iterator[Hole]:
    """Yield all holes of the plates under the bounding box of the faces that supports may touch."""
    loops = rules.query.workpiece.loops if rules.request.bottom is None else rules.request.bottom
    boxes = np.array([compute_bounding_box(one) for loop in loops for one in split_borders(loop)])
    if not len(boxes):
        return
    (x0, y0), (x1, y1) = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    corners = np.array([rules.fixture.pose.apply(x, y) for x, y in product((x0, x1), (y0, y1))])
    for plate in rules.query.toolkit.plates:
        first = np.array(plate.compute_hole_center(0, 0, rules.fixture.travel))
        low, high = (corners.min(axis=0) - first) / plate.pitch, (corners.max(axis=0) - first) / plate.pitch
        columns, rows = (range(floor(a) - 1, ceil(b) + 2) for a, b in zip(low, high, strict=True))
        yield from ((plate.name, column, row) for column, row in product(columns, rows))


@define(eq=False)
class ClampCells:
    """Square cells over a box, with the slack of the tip at their middles, computed once for all triples.

    Parameters
    ----------
    rules : of the tip.
    low : (2,) the box's corner, in mm.
    size : of the first cell, in mm.
    """

    rules: SupportPlaces
    low: Array
    size: float
    slack: dict[tuple[int, int, int], float] = field(factory=dict, init=False)

    def has_place(self, triangle: Array) -> bool | None:
        """Return whether there is a place inside a triangle (3, 2) where the clamp's tip satisfies all rules
        by more than rounding.

        Returns None where ``MOST_CELLS`` cells do not decide it.
        """
        number = count()
        queue = [(-inf, next(number), (0, 0, 0))]
        while queue:
            bound, order, (level, i, j) = heappop(queue)
            if -bound <= AGREEMENT:
                return False
            if order > MOST_CELLS:
                return None
            width = self.size / 2 ** (level + 1)
            for cell in product((level + 1,), (2 * i, 2 * i + 1), (2 * j, 2 * j + 1)):
                x, y = (float(self.low[k]) + (cell[1 + k] + 0.5) * width for k in (0, 1))
                kept = measure_depth_inside(triangle, x, y) - self.rules.request.inside
                if kept + width / sqrt(2) > AGREEMENT:
                    kept = min(kept, self.compute_tip_slack(cell, x, y))
                if kept > AGREEMENT:
                    return True
                heappush(queue, (-kept - width / sqrt(2), next(number), cell))
        return False

    def compute_tip_slack(self, cell: tuple[int, int, int], x: float, y: float) -> float:
        """Return the tip's slack in mm at (x, y), the middle of the cell (level, i, j); cached by cell."""
        if cell not in self.slack:
            self.slack[cell] = self.rules.compute_tip_room((x, y))
        return self.slack[cell]


def measure_depth_inside(triangle: Array, x: float, y: float) -> float:
    """Return the signed distance in mm of a point (x, y) from the nearest of a triangle's side lines,
    positive inside.

    The corners (3, 2) may be in either sense of rotation.
    """
    (ax, ay), (bx, by), (cx, cy) = triangle.tolist()
    turn = 1.0 if (bx - ax) * (cy - ay) > (by - ay) * (cx - ax) else -1.0
    sides = (ax, ay, bx, by), (bx, by, cx, cy), (cx, cy, ax, ay)
    far = [((u - s) * (y - t) - (v - t) * (x - s)) / hypot(u - s, v - t) for s, t, u, v in sides]
    return float(min(turn * one for one in far))


def are_large_enough(points: Array, inside: float) -> NDArray[np.bool_]:
    """Return (N,) whether triangles (N, 3, 2) have an incircle larger than
    ``inside`` mm by more than rounding.
    """
    a, b, c = np.moveaxis(points, 1, 0)
    twice = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    around = sum(np.hypot(*(q - p).T) for p, q in ((a, b), (b, c), (c, a)))
    return np.asarray(twice > (inside + AGREEMENT) * around)


def find_missing_triples(
    rules: SupportPlaces, listed: Iterable[Iterable[Hole]], positions: int
) -> tuple[list[str], int]:
    """Return the faults of a list that claims to be complete, and the number of triples that stay undecided.

    ``listed`` holds triples of holes in any order; ``positions`` is the number of usable holes that the list
    states. At most ``MOST_NAMED`` missing triples are named.
    """
    rooms = {hole: rules.compute_pad_room(hole) for hole in list_holes_near(rules)}
    sure = sorted(hole for hole, room in rooms.items() if room > AGREEMENT)
    possible = sum(room > -AGREEMENT for room in rooms.values())
    faults = []
    if not len(sure) <= positions <= possible:
        faults.append(f"counts say that {positions} holes could hold a support, but {len(sure)} could")
    known = {frozenset(triple) for triple in listed}
    undecided = 0
    for triple, triangle, cells in list_possible_triples(rules, sure):
        if frozenset(triple) in known or not rules.find_travel(triple)[0]:
            continue
        has_place = cells.has_place(triangle)
        undecided += has_place is None
        if has_place:
            faults.append(f"the triple of supports in {', '.join(map(describe_hole, triple))} is missing")
            if len(faults) >= MOST_NAMED:
                break
    return faults, undecided


def list_possible_triples(
    rules: SupportPlaces, holes: list[Hole]
) -> Iterator[tuple[list[Hole], Array, ClampCells]]:
    """Yield (holes, corners (3, 2), cells) of each triple whose holes fit on the plates in pairs and span a
    large enough triangle.
    """
    if len(holes) < 3:
        return
    points = np.array([rules.find_hole_place(hole) for hole in holes])
    low = points.min(axis=0)
    cells = ClampCells(rules, low, float(np.ptp(points, axis=0).max()))
    fits = np.zeros((len(holes), len(holes)), bool)
    for i, j in combinations(range(len(holes)), 2):
        fits[i, j] = rules.find_travel([holes[i], holes[j]])[0]
    for i in range(len(holes) - 2):
        others = np.flatnonzero(fits[i])
        first, second = np.triu_indices(len(others), 1)
        pairs = np.column_stack([others[first], others[second]])
        pairs = pairs[fits[pairs[:, 0], pairs[:, 1]]]
        corner = np.broadcast_to(points[i], (len(pairs), 2))
        triangles = np.stack([corner, points[pairs[:, 0]], points[pairs[:, 1]]], axis=1)
        for one in np.flatnonzero(are_large_enough(triangles, rules.request.inside)).tolist():
            yield [holes[i], *(holes[k] for k in pairs[one].tolist())], triangles[one], cells


def describe_hole(hole: Hole) -> str:
    """Return a hole as "carrier (column, row)", counted from 0 as in the file."""
    name, column, row = hole
    return f"{name} ({column}, {row})"


def find_widest_clear_opening(toolkit: Toolkit, fixture: Fixture, holes: list[Hole]) -> float | None:
    """Return the widest opening in mm at which no peg and no support stands in a blocked hole; None where
    there is none.

    All shifts of each jaw by whole columns, and of all rows together, are tried.
    """
    plates = {plate.name: plate for plate in toolkit.plates}
    moving = next(plate for plate in plates.values() if plate.travel is not None)
    travel = moving.travel
    assert travel is not None
    places = [(peg.carrier, peg.column, peg.row) for peg in fixture.pegs if peg.carrier in plates] + holes
    rows = [row for _, _, row in places]
    blocked = [hole.row for plate in plates.values() for hole in plate.blocked if hole.row is not None]
    highest = moving.rows or max(rows) - min(rows) + max(blocked, default=-1) + 2
    widest = None
    shifts = []
    for name, plate in plates.items():
        columns = [column for own, column, _ in places if own == name]
        shifts.append([(name, k) for k in range(-min(columns), plate.column_count - max(columns))])
    for moved in product(*shifts):
        by = dict(moved)
        steps = sum(-k if name == moving.name else k for name, k in moved)
        opening = fixture.travel + steps * moving.pitch[0]
        if opening < travel.least - AGREEMENT or opening > (travel.most or inf) + AGREEMENT:
            continue
        if widest is not None and opening <= widest:
            continue
        lifts = range(-min(rows), highest - max(rows))
        if any(
            not any(plates[name].is_blocked(column + by[name], row + lift) for name, column, row in places)
            for lift in lifts
        ):
            widest = opening
    return widest


def count_turns_about(segments: Loop, point: tuple[float, float]) -> int:
    """Return the winding number of a loop about a point that is not on it."""
    turned = 0.0
    for one in segments:
        places = [one.start, one.end]
        if isinstance(one, Arc):
            near = abs(hypot(point[0] - one.center[0], point[1] - one.center[1]) - one.radius)
            # A chord passes nearer to its arc than the point does.
            steps = min(4096, 8 + ceil(2 * one.half_sweep / sqrt(max(near / one.radius, 1e-8))))
            low = -one.sign * one.half_sweep
            places = [one.compute_point(low * (1 - 2 * k / steps)) for k in range(steps + 1)]
        angles = [atan2(y - point[1], x - point[0]) for x, y in places]
        turned += sum((b - a + pi) % (2 * pi) - pi for a, b in pairwise(angles))
    return round(turned / (2 * pi))


def measure_room_on(loops: Sequence[Array], zones: Sequence[Array], point: tuple[float, float]) -> float:
    """Return the radius in mm of the largest disc about a point that lies on a face and outside all zones.

    ``loops`` are those of the face. Negative if the point is off the face.
    """
    faces = sort_faces_by_size([split_borders(loop) for loop in loops])
    room = max((min(side * measure_reach(one, point) for one, side in face) for face in faces), default=-inf)
    off = (measure_reach(split_borders(zone), point) for zone in zones)
    return min(room, *(-one for one in off), inf)


def measure_reach(loop: Loop, point: tuple[float, float]) -> float:
    """Return the distance of a point from a loop in mm, positive inside it and negative outside."""
    near = min(measure_distance_to_segment(point, one) for one in loop)
    return near if count_turns_about(loop, point) else -near


def sort_faces_by_size(loops: Sequence[Loop]) -> list[list[tuple[Loop, int]]]:
    """Return a list of faces, each a list of (loop, sign): first (outer border, 1), then (opening, -1) for
    each opening.

    Loops are taken from the largest to the smallest. The first one is a border. Each further loop is an
    opening if its left side lies on a face found so far. Otherwise it is a border if it runs
    counter-clockwise, and is left out if it runs clockwise.
    """
    faces: list[list[tuple[Loop, int]]] = []
    sizes = [compute_signed_area(loop) for loop in loops]
    for number in sorted(range(len(loops)), key=lambda k: (-abs(sizes[k]), sizes[k])):
        loop = loops[number]
        (x, y), (nx, ny) = loop[0].middle, loop[0].compute_normal()
        probe = (x - PROBE * nx, y - PROBE * ny)
        under = [face for face in faces if all(side * measure_reach(one, probe) > 0 for one, side in face)]
        if number and under:
            under[-1].append((loop, -1))
        elif number == 0 or sizes[number] > 0:
            faces.append([(loop, 1)])
    return faces
