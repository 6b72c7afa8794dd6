"""Faces that pads and a tip may touch, and how large a disc about a point lies wholly on them.

A face is an outer loop less its openings; keep-out zones are taken off. The room at a point is the distance
to the nearest border of the face that it lies on, negative off all. Parity of crossings with the chords,
changed once between each arc and its chord, says which side a point is on.

Regions that have a height of such a face keep the clamp on top away from places on it. A head keeps off what
rises above the face. A tip presses better where it keeps off what of the face hangs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.geometry.loop import compute_signed_area, loop_segments
from workhold.geometry.segment import Arc, Segment

__all__ = ["Curve", "FaceBorders", "LevelRegions", "TouchableFace", "area_center", "offset_curves"]

Array = NDArray[np.float64]
Loop = Sequence[Segment]
Curve = tuple[float, float, float]
# In mm: less than what decides, and more than rounding.
HAIR = 1.3e-10
# How far beside a loop a point is asked for that says what the loop borders, in mm.
BESIDE = 1e-4
# Sine of the turn from one segment into the next below which there is no corner between them.
SMOOTH = 1e-12
# Zones that are held against points together, and only against those near them.
TOGETHER = 16
# Points times segments that are looked at together.
AT_ONCE = 1 << 20


@define(frozen=True, eq=False)
class FaceBorders:
    """B closed loops as arrays of all their S segments, of which A are arcs; lengths in mm.

    Parameters
    ----------
    loops : their segments.
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
        """Whether points (N, 2) lie within each loop (N, B); moved a hair: on a chord parity says nothing."""
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

    def distance(self, points: Array) -> Array:
        """Distances (N, B) in mm of points (N, 2) from the loops."""
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

    def inside(self, points: Array) -> Array:
        """Distances (N, B) of points (N, 2) from the loops, negative outside them."""
        step = max(1, AT_ONCE // max(1, len(self.starts)))
        blocks = (points[k : k + step] for k in range(0, len(points), step))
        signed = [np.where(self.contains(some), 1.0, -1.0) * self.distance(some) for some in blocks]
        return np.concatenate([np.empty((0, len(self.loops))), *signed])


def box_of(loops: Sequence[Loop]) -> tuple[Array, Array]:
    """The least and the greatest x and y that loops may have; a point where there are none."""
    points = [] if loops else [(0.0, 0.0)]
    for one in (one for loop in loops for one in loop):
        points.append(one.start)
        if isinstance(one, Arc):
            (x, y), radius = one.center, one.radius
            points += [(x - radius, y - radius), (x + radius, y + radius)]
    every = np.array(points)
    return every.min(axis=0), every.max(axis=0)


def beside(loop: Loop) -> tuple[float, float]:
    """A point just to the left of a loop."""
    (x, y), (nx, ny) = loop[0].middle, loop[0].normal()
    return x - BESIDE * nx, y - BESIDE * ny


def grouped(loops: Sequence[Loop]) -> list[list[int]]:
    """Numbers of the loops of each face, its border before its openings; the first loop is a border.

    Of the others those that run clockwise are openings. So are those on a face, however they run; all that
    remain are borders, such as that of the top of a boss within the opening that it leaves.
    """
    areas = [compute_signed_area(loop) for loop in loops]
    within = FaceBorders(tuple(map(tuple, loops))).contains(
        np.array([beside(loop) for loop in loops]).reshape(-1, 2)
    )
    faces: list[list[int]] = []
    # From the largest; of two alike the opening before the face that lies in it.
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
    """Faces side by side or above one another, less their keep-out zones; a disc lies on one of them.

    Parameters
    ----------
    borders : of each face its own before those of its openings, then those of the zones.
    faces : number of the border that each face begins with.
    zones : how many of the borders are those of zones.
    levels : height in mm of each face; None where nobody says.
    """

    borders: FaceBorders
    faces: tuple[int, ...]
    zones: int
    levels: tuple[float | None, ...]

    @classmethod
    def of(
        cls, loops: Sequence[Array], zones: Iterable[Array] = (), heights: Sequence[float] | None = None
    ) -> TouchableFace:
        """Faces from loops of (x, y, bulge) vertices, the outer one first, and zones as loops.

        Without loops there is no face, and no room anywhere.

        Parameters
        ----------
        heights : of the face of each loop in mm; loops of several heights border several faces.
        """
        rows = [tuple(loop_segments(np.asarray(loop))) for loop in loops]
        kept_out = [tuple(loop_segments(np.asarray(zone))) for zone in zones]
        of_loops = [None] * len(rows) if heights is None else list(heights)
        faces: list[list[int]] = []
        for level in dict.fromkeys(of_loops):
            own = [number for number, height in enumerate(of_loops) if height == level]
            faces += [[own[k] for k in face] for face in grouped([rows[number] for number in own])]
        first = np.cumsum([0, *(len(face) for face in faces)])[:-1]
        ordered = (rows[number] for face in faces for number in face)
        levels = tuple(of_loops[face[0]] for face in faces)
        return cls(FaceBorders((*ordered, *kept_out)), tuple(first.tolist()), len(kept_out), levels)

    @cached_property
    def own(self) -> TouchableFace:
        """The faces without their keep-out zones."""
        count = len(self.borders.loops) - self.zones
        return TouchableFace(FaceBorders(self.borders.loops[:count]), self.faces, 0, self.levels)

    @cached_property
    def zone_groups(self) -> tuple[tuple[FaceBorders, Array], ...]:
        """The zones, some at a time, each with the box x0, y0, x1, y1 around these."""
        loops = self.borders.loops[len(self.borders.loops) - self.zones :]
        groups = [FaceBorders(loops[k : k + TOGETHER]) for k in range(0, len(loops), TOGETHER)]
        return tuple((one, np.concatenate(box_of(one.loops))) for one in groups)

    def off_zones(self, points: Array, radius: float, slack: float) -> NDArray[np.bool_]:
        """Whether discs about points (N, 2) keep off all zones, but for a slack in mm."""
        out = np.ones(len(points), np.bool_)
        for borders, (x0, y0, x1, y1) in self.zone_groups:
            x, y = points.T
            near = (x > x0 - radius) & (x < x1 + radius) & (y > y0 - radius) & (y < y1 + radius)
            some = np.flatnonzero(out & near)
            off = (-borders.inside(points[some])).min(axis=1, initial=np.inf)
            out[some[off - radius < -slack]] = False
        return out

    def rooms(self, points: Array) -> tuple[Array, Array]:
        """Radii of the largest discs about points (N, 2) on each face (N, F), and of those off all zones (N,).

        They are negative off the face, and in a zone.
        """
        signed = -self.borders.inside(points)
        signed[:, list(self.faces)] *= -1.0
        count = signed.shape[1] - self.zones
        on: Array = np.minimum.reduceat(signed[:, :count], self.faces, axis=1)
        return on, np.asarray(signed[:, count:].min(axis=1, initial=np.inf))

    def room(self, points: Array) -> Array:
        """Radii (N,) of the largest discs about points (N, 2) that lie on a face, negative off all."""
        on, off = self.rooms(points)
        return np.asarray(np.minimum(on.max(axis=1, initial=-np.inf), off))

    @property
    def box(self) -> tuple[Array, Array]:
        """The least and the greatest x and y that the faces may have; a point where there is no face."""
        return box_of([self.borders.loops[number] for number in self.faces])

    def face_of(self, border: int) -> int | None:
        """The number of the face that a border belongs to; None of a zone's."""
        if border >= len(self.borders.loops) - self.zones:
            return None
        return int(np.searchsorted(self.faces, border, side="right")) - 1

    def is_on_left(self, border: int) -> bool:
        """Whether a disc that keeps to the faces and off the zones is on the left of a border."""
        return (compute_signed_area(self.borders.loops[border]) > 0) == (border in self.faces)


def offset_curves(loop: Loop, radius: float, left: bool) -> tuple[list[Curve], list[Curve]]:
    """Lines, unit normal and distance, and circles on which the middle of a disc is that touches a loop.

    ``left`` says whether the disc is on the left of the loop.
    """
    lines: list[Curve] = []
    circles: list[Curve] = []
    grown = [grow_radius(one, radius, left) for one in loop]
    for number, one in enumerate(loop):
        # Where a border goes on smoothly, a disc that touches the joint touches both pieces of it.
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
    """Radius of the circle on which the middle of a disc is that touches an arc, infinite of a line."""
    if not isinstance(one, Arc):
        return np.inf
    return one.radius - radius if (one.sign > 0) == left else one.radius + radius


def is_smooth(one: Segment, after: Segment) -> bool:
    """Whether a border has no corner between two of its segments."""
    (x, y), (to_x, to_y) = one.normal(find_last_parameter(one)), after.normal(-find_last_parameter(after))
    return abs(x * to_y - y * to_x) < SMOOTH and x * to_x + y * to_y > 0.0


def find_last_parameter(one: Segment) -> float:
    """The parameter of a segment's end; that of its start is the opposite."""
    return one.half_extent * (one.sign if isinstance(one, Arc) else 1.0)


def area_center(loops: Sequence[Sequence[Segment]]) -> Array:
    """The centre of area (2,) within loops that have the part on their left (Green's theorem)."""
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
    """Regions by height in mm, each as its borders with the region on their left.

    Parameters
    ----------
    borders : of each height.
    turns : of each height (B,) 1 for borders around a region, -1 for its openings.
    """

    borders: dict[float, FaceBorders]
    turns: dict[float, Array]

    @classmethod
    def of(cls, loops: Sequence[Array], heights: Sequence[float]) -> LevelRegions:
        """The regions within loops of (x, y, bulge) vertices, each with its height."""
        borders, turns = {}, {}
        for height in dict.fromkeys(heights):
            own = [
                tuple(loop_segments(np.asarray(loop)))
                for loop, z in zip(loops, heights, strict=True)
                if z == height
            ]
            borders[height] = FaceBorders(tuple(own))
            turns[height] = np.array([1.0 if compute_signed_area(loop) > 0.0 else -1.0 for loop in own])
        return cls(borders, turns)

    def apart(self, height: float | None, points: Array) -> Array:
        """Distances (N,) in mm of points (N, 2) from the region of a height, negative in it."""
        if height is None or height not in self.borders:
            return np.full(len(points), np.inf)
        signed = self.borders[height].inside(points)
        is_in = (signed > 0.0) @ self.turns[height] > 0.5
        return np.asarray(np.where(is_in, -1.0, 1.0) * np.abs(signed).min(axis=1, initial=np.inf))

    def offset_curves(self, height: float | None, radius: float) -> Iterator[tuple[list[Curve], list[Curve]]]:
        """Lines and circles of :func:`offset_curves` on which the middle of a disc beside a region is."""
        if height is not None and height in self.borders:
            for loop in self.borders[height].loops:
                yield offset_curves(loop, radius, left=False)
