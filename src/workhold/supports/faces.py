"""Faces that pads and a tip may touch, and the largest disc about a point that lies on one of them.

A face is the region inside an outer loop and outside its openings; keep-out zones are excluded. The room at a
point is the distance to the nearest border of its face, negative off all faces. Which side of a border a
point is on is decided by the parity of crossings with the chords, corrected between each arc and its chord.

Regions at the height of a face also restrict the clamp on top: its head must keep clear of material that
rises above the face, and its tip presses better away from overhangs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.geometry.loop import compute_signed_area, make_loop_segments
from workhold.geometry.segment import Arc, Segment

__all__ = ["Curve", "FaceBorders", "LevelRegions", "TouchableFace", "compute_area_center", "offset_curves"]

Array = NDArray[np.float64]
Loop = Sequence[Segment]
Curve = tuple[float, float, float]
# mm. A shift of points that is above rounding and below what matters.
HAIR = 1.3e-10
# mm. Distance beside a loop of the point that tells what the loop borders.
BESIDE = 1e-4
# Sine of the turn from one segment into the next below which there is no corner between them.
SMOOTH = 1e-12
# Number of zones in a group; only points near the group are tested against it.
TOGETHER = 16
# Points times segments that are looked at together.
AT_ONCE = 1 << 20


@define(frozen=True, eq=False)
class FaceBorders:
    """B closed loops as arrays of all their S segments; lengths in mm.

    Parameters
    ----------
    loops : the segments of each loop.
    first : (B,) index of each loop's first segment.
    starts, ends : (S, 2) end points of segments.
    straight, curved : indices of the lines, and of the A arcs.
    arcs : (A, 6) centre (x, y), radius, middle angle and half sweep in radians, sign.
    arcs_of : (A, B) 1.0 where the arc belongs to the loop, else 0.0.
    """

    loops: tuple[tuple[Segment, ...], ...]
    first: NDArray[np.int64] = field(init=False)
    starts: Array = field(init=False)
    ends: Array = field(init=False)
    straight: NDArray[np.int64] = field(init=False)
    curved: NDArray[np.int64] = field(init=False)
    arcs: Array = field(init=False)
    arcs_of: Array = field(init=False)

    def __attrs_post_init__(self) -> None:
        every = [one for loop in self.loops for one in loop]
        first = np.cumsum([0, *(len(loop) for loop in self.loops)])
        curved = np.array([k for k, one in enumerate(every) if isinstance(one, Arc)], np.int64)
        rows = [
            (*one.center, one.radius, one.mid_angle, one.half_sweep, one.sign)
            for one in every
            if isinstance(one, Arc)
        ]
        loop_of = np.searchsorted(first, curved, side="right") - 1
        for name, value in (
            ("first", first[:-1]),
            ("starts", np.array([one.start for one in every]).reshape(-1, 2)),
            ("ends", np.array([one.end for one in every]).reshape(-1, 2)),
            ("straight", np.setdiff1d(np.arange(len(every)), curved)),
            ("curved", curved),
            ("arcs", np.array(rows).reshape(-1, 6)),
            ("arcs_of", (loop_of[:, None] == np.arange(len(self.loops))).astype(np.float64)),
        ):
            object.__setattr__(self, name, value)

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Return a mask (N, B): True where a point (N, 2) lies within a loop.

        Points are shifted by 1e-10 mm, since crossings do not decide for points on a chord.
        """
        x, y = points[:, :1] + HAIR, points[:, 1:] + 0.6 * HAIR
        (x0, y0), (x1, y1) = self.starts.T, self.ends.T
        crosses = (y0 > y) != (y1 > y)
        rise = np.where(y1 == y0, 1.0, y1 - y0)
        odd = np.add.reduceat(crosses & (x < x0 + (y - y0) * (x1 - x0) / rise), self.first, axis=1, dtype=int)
        if len(self.arcs):
            cx, cy, radius, _, half, sign = self.arcs.T
            (ax, ay), (bx, by) = self.starts[self.curved].T, self.ends[self.curved].T
            # The thin piece lies to the right of the chord of an arc that runs counter-clockwise.
            side = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
            thin = (np.hypot(x - cx, y - cy) < radius) & ((half >= np.pi) | (side * sign < 0))
            odd = odd + (thin @ self.arcs_of).astype(np.int64)
        return np.asarray(odd % 2 == 1)

    def measure_distances(self, points: Array) -> Array:
        """Return the distance in mm of each point (N, 2) from each loop, (N, B); never negative."""
        out = np.empty((len(points), len(self.starts)))
        x, y = points[:, :1], points[:, 1:]
        if len(self.straight):
            (ax, ay), (bx, by) = self.starts[self.straight].T, self.ends[self.straight].T
            dx, dy = bx - ax, by - ay
            along = np.clip(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0.0, 1.0)
            out[:, self.straight] = np.hypot(x - ax - along * dx, y - ay - along * dy)
        if len(self.arcs):
            cx, cy, radius, middle, half, _ = self.arcs.T
            (ax, ay), (bx, by) = self.starts[self.curved].T, self.ends[self.curved].T
            turned = np.abs((np.arctan2(y - cy, x - cx) - middle + np.pi) % (2 * np.pi) - np.pi)
            to_ends = np.minimum(np.hypot(x - ax, y - ay), np.hypot(x - bx, y - by))
            out[:, self.curved] = np.where(turned <= half, np.abs(np.hypot(x - cx, y - cy) - radius), to_ends)
        return np.asarray(np.minimum.reduceat(out, self.first, axis=1))

    def measure_depths(self, points: Array) -> Array:
        """Return the distance in mm of each point (N, 2) from each loop,
        (N, B); negative outside the loop.
        """
        step = max(1, AT_ONCE // max(1, len(self.starts)))
        blocks = (points[k : k + step] for k in range(0, len(points), step))
        signed = [np.where(self.contains(some), 1.0, -1.0) * self.measure_distances(some) for some in blocks]
        return np.concatenate([np.empty((0, len(self.loops))), *signed])


def compute_box(loops: Sequence[Loop]) -> tuple[Array, Array]:
    """Return (least x and y, largest x and y) of a box around loops; the origin twice without loops.

    Arcs count as whole circles.
    """
    points = [] if loops else [(0.0, 0.0)]
    for one in (one for loop in loops for one in loop):
        points.append(one.start)
        if isinstance(one, Arc):
            (x, y), radius = one.center, one.radius
            points += [(x - radius, y - radius), (x + radius, y + radius)]
    every = np.array(points)
    return every.min(axis=0), every.max(axis=0)


def find_point_beside(loop: Loop) -> tuple[float, float]:
    """Return a point 1e-4 mm to the left of a loop's first segment."""
    (x, y), (nx, ny) = loop[0].middle, loop[0].compute_normal()
    return x - BESIDE * nx, y - BESIDE * ny


def group_by_face(loops: Sequence[Loop]) -> list[list[int]]:
    """Return, for each face, the indices of its loops: its outer border first, then its openings.

    The first loop is an outer border. Another loop is an opening if it runs clockwise or lies directly on a
    face; otherwise it is an outer border, such as that of the top of a boss within the opening that the boss
    leaves.
    """
    areas = [compute_signed_area(loop) for loop in loops]
    within = FaceBorders(tuple(map(tuple, loops))).contains(
        np.array([find_point_beside(loop) for loop in loops]).reshape(-1, 2)
    )
    faces: list[list[int]] = []
    # Largest first; of equal ones the opening before the face that lies in it.
    for number in sorted(range(len(loops)), key=lambda k: (-abs(areas[k]), areas[k])):
        inside = within[number]
        # The last face is the smallest.
        under = [face for face in reversed(faces) if inside[face[0]] and not inside[face[1:]].any()]
        if number and under:
            under[0].append(number)
        elif number == 0 or areas[number] > 0.0:
            faces.append([number])
    return faces


@define(frozen=True, eq=False)
class TouchableFace:
    """Faces side by side or at different heights, with keep-out zones.

    A disc must lie on one face, clear of all zones.

    Parameters
    ----------
    borders : borders in this order: for each face its outer border and its openings; then the zones.
    faces : index in ``borders`` at which each face begins.
    zones : number of borders, the last ones, that are zones.
    levels : height in mm of each face; None where not known.
    """

    borders: FaceBorders
    faces: tuple[int, ...]
    zones: int
    levels: tuple[float | None, ...]

    @classmethod
    def from_loops(
        cls, loops: Sequence[Array], zones: Iterable[Array] = (), heights: Sequence[float] | None = None
    ) -> TouchableFace:
        """Return the faces bordered by loops of (x, y, bulge) vertices, with keep-out zones.

        The outer loop comes first; ``zones`` are loops as well. Without loops there is no face.

        Parameters
        ----------
        heights : height of each loop's face, in mm; loops of different heights border different faces.
        """
        rows = [tuple(make_loop_segments(np.asarray(loop))) for loop in loops]
        kept_out = [tuple(make_loop_segments(np.asarray(zone))) for zone in zones]
        of_loops = [None] * len(rows) if heights is None else list(heights)
        faces: list[list[int]] = []
        for level in dict.fromkeys(of_loops):
            own = [number for number, height in enumerate(of_loops) if height == level]
            faces += [[own[k] for k in face] for face in group_by_face([rows[number] for number in own])]
        first = np.cumsum([0, *(len(face) for face in faces)])[:-1]
        ordered = (rows[number] for face in faces for number in face)
        levels = tuple(of_loops[face[0]] for face in faces)
        return cls(FaceBorders((*ordered, *kept_out)), tuple(first.tolist()), len(kept_out), levels)

    @cached_property
    def own(self) -> TouchableFace:
        """The same faces without keep-out zones."""
        count = len(self.borders.loops) - self.zones
        return TouchableFace(FaceBorders(self.borders.loops[:count]), self.faces, 0, self.levels)

    @cached_property
    def zone_groups(self) -> tuple[tuple[FaceBorders, Array], ...]:
        """Zones in groups, each with the box (x0, y0, x1, y1) around the group."""
        loops = self.borders.loops[len(self.borders.loops) - self.zones :]
        groups = [FaceBorders(loops[k : k + TOGETHER]) for k in range(0, len(loops), TOGETHER)]
        return tuple((one, np.concatenate(compute_box(one.loops))) for one in groups)

    def find_off_zones(self, points: Array, radius: float, slack: float) -> NDArray[np.bool_]:
        """Return a mask (N,): True for discs about points (N, 2) that
        overlap no zone by more than ``slack`` mm.

        ``radius`` is that of the discs in mm.
        """
        out = np.ones(len(points), np.bool_)
        for borders, (x0, y0, x1, y1) in self.zone_groups:
            x, y = points.T
            near = (x > x0 - radius) & (x < x1 + radius) & (y > y0 - radius) & (y < y1 + radius)
            some = np.flatnonzero(out & near)
            off = (-borders.measure_depths(points[some])).min(axis=1, initial=np.inf)
            out[some[off - radius < -slack]] = False
        return out

    def measure_rooms(self, points: Array) -> tuple[Array, Array]:
        """Return radii in mm of the largest discs about points (N, 2): (1)
        on each face, (N, F); (2) clear of zones, (N,).

        Negative off the face, or in a zone; (2) is inf where there is no zone.
        """
        signed = -self.borders.measure_depths(points)
        signed[:, list(self.faces)] *= -1.0
        count = signed.shape[1] - self.zones
        on: Array = np.minimum.reduceat(signed[:, :count], self.faces, axis=1)
        return on, np.asarray(signed[:, count:].min(axis=1, initial=np.inf))

    def measure_room(self, points: Array) -> Array:
        """Return radii in mm of the largest discs about points (N, 2)
        that lie on a face, clear of all zones, (N,).

        Negative off all faces, or in a zone.
        """
        on, off = self.measure_rooms(points)
        return np.asarray(np.minimum(on.max(axis=1, initial=-np.inf), off))

    @property
    def box(self) -> tuple[Array, Array]:
        """Box around the faces: (least x and y, largest x and y); the origin twice without faces."""
        return compute_box([self.borders.loops[number] for number in self.faces])

    def find_face(self, border: int) -> int | None:
        """Return the index of the face that a border belongs to; None for the border of a zone."""
        if border >= len(self.borders.loops) - self.zones:
            return None
        return int(np.searchsorted(self.faces, border, side="right")) - 1

    def is_on_left(self, border: int) -> bool:
        """Return whether the allowed side of a border is on its left; the allowed side is on the face and off
        the zones.
        """
        return (compute_signed_area(self.borders.loops[border]) > 0) == (border in self.faces)


def offset_curves(loop: Loop, radius: float, left: bool) -> tuple[list[Curve], list[Curve]]:
    """Return (1) lines and (2) circles that contain the centres of all discs touching a loop.

    Lines are (unit normal, distance), circles (centre, radius). The discs have a radius in mm, and are on the
    left of the loop if ``left``, else on its right.
    """
    lines: list[Curve] = []
    circles: list[Curve] = []
    grown = [grow_radius(one, radius, left) for one in loop]
    for number, one in enumerate(loop):
        # At a smooth joint a disc that touches the joint touches both segments, so no circle is needed.
        if grown[number] <= 0.0 or grown[number - 1] <= 0.0 or not is_smooth(loop[number - 1], one):
            circles.append((*one.start, radius))
        if isinstance(one, Arc):
            if grown[number] > 0.0:
                circles.append((*one.center, grown[number]))
        else:
            (ax, ay), (bx, by) = one.start, one.end
            length = float(np.hypot(bx - ax, by - ay))
            nx, ny = (ay - by) / length, (bx - ax) / length
            lines.append((nx, ny, nx * ax + ny * ay + (radius if left else -radius)))
    return lines, circles


def grow_radius(one: Segment, radius: float, left: bool) -> float:
    """Return the radius in mm of the circle on which discs that touch a segment have their centres.

    0 or less if there is no such circle; inf for a line.
    """
    if not isinstance(one, Arc):
        return np.inf
    return one.radius - radius if (one.sign > 0) == left else one.radius + radius


def is_smooth(one: Segment, after: Segment) -> bool:
    """Return whether a border has no corner from segment ``one`` to the segment after it."""
    (x, y), (to_x, to_y) = (
        one.compute_normal(find_last_parameter(one)),
        after.compute_normal(-find_last_parameter(after)),
    )
    return abs(x * to_y - y * to_x) < SMOOTH and x * to_x + y * to_y > 0.0


def find_last_parameter(one: Segment) -> float:
    """Return the parameter of a segment's end; the parameter of its start
    is the same with the opposite sign.
    """
    return one.half_extent * (one.sign if isinstance(one, Arc) else 1.0)


def compute_area_center(loops: Sequence[Sequence[Segment]]) -> Array:
    """Return the centre of area (2,) in mm of a region on the left of loops (Green's theorem)."""
    area, moment = 0.0, np.zeros(2)
    for one in (segment for loop in loops for segment in loop):
        (x0, y0), (x1, y1) = one.start, one.end
        cross = x0 * y1 - x1 * y0
        area += cross / 2
        moment += np.array([x0 + x1, y0 + y1]) * cross / 6
        if isinstance(one, Arc):
            half, sweep = one.half_sweep, 2 * one.half_sweep
            thin = one.sign * one.radius**2 * (sweep - np.sin(sweep)) / 2
            outward = np.array([np.cos(one.mid_angle), np.sin(one.mid_angle)])
            area += thin
            moment += thin * np.array(one.center)
            moment += one.sign * one.radius**3 * 2 / 3 * np.sin(half) ** 3 * outward
    return np.asarray(moment / area)


@define(frozen=True, eq=False)
class LevelRegions:
    """Regions by height in mm, each given by its borders.

    Parameters
    ----------
    borders : the borders at each height, with the region on their left.
    turns : for each height (B,), 1 for borders around a region, -1 for openings.
    """

    borders: dict[float, FaceBorders]
    turns: dict[float, Array]

    @classmethod
    def from_loops(cls, loops: Sequence[Array], heights: Sequence[float]) -> LevelRegions:
        """Return the regions that loops of (x, y, bulge) vertices border, each with its height in mm."""
        borders, turns = {}, {}
        for height in dict.fromkeys(heights):
            own = [
                tuple(make_loop_segments(np.asarray(loop)))
                for loop, z in zip(loops, heights, strict=True)
                if z == height
            ]
            borders[height] = FaceBorders(tuple(own))
            turns[height] = np.array([1.0 if compute_signed_area(loop) > 0.0 else -1.0 for loop in own])
        return cls(borders, turns)

    def measure_distances(self, height: float | None, points: Array) -> Array:
        """Return the distance in mm of points (N, 2) from the region at a height, (N,).

        Negative inside the region; inf where there is no region at this height.
        """
        if height is None or height not in self.borders:
            return np.full(len(points), np.inf)
        signed = self.borders[height].measure_depths(points)
        is_in = (signed > 0.0) @ self.turns[height] > 0.5
        return np.asarray(np.where(is_in, -1.0, 1.0) * np.abs(signed).min(axis=1, initial=np.inf))

    def iterate_offset_curves(
        self, height: float | None, radius: float
    ) -> Iterator[tuple[list[Curve], list[Curve]]]:
        """Yield, for each border at a height, the lines and circles of the
        centres of discs that touch it from outside.

        The discs are outside the region; see :func:`offset_curves`.
        """
        if height is not None and height in self.borders:
            for loop in self.borders[height].loops:
                yield offset_curves(loop, radius, left=False)
