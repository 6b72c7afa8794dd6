"""Faces that pads and a tip may touch, and how large a disc about a point lies wholly on them.

A face is an outer loop less its openings; keep-out zones are taken off. The room at a point is the distance
to the nearest border, negative off the face. Parity of crossings with the chords, changed once between each
arc and its chord, says which side a point is on.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.geometry.loop import loop_segments, signed_area
from workhold.geometry.segment import Arc, Segment

__all__ = ["Border", "TouchableFace", "area_center"]

Array = NDArray[np.float64]
# In mm: less than what decides, and more than rounding.
HAIR = 1.3e-10


@define(frozen=True, eq=False)
class Border:
    """A closed loop as arrays; lengths in mm.

    Parameters
    ----------
    segments : of the loop.
    is_hole : whether what is allowed lies outside it.
    """

    segments: tuple[Segment, ...]
    is_hole: bool
    starts: Array = field(init=False)
    ends: Array = field(init=False)
    arcs: Array = field(init=False)
    arc_numbers: NDArray[np.int64] = field(init=False)

    def __attrs_post_init__(self) -> None:
        arcs = [(k, one) for k, one in enumerate(self.segments) if isinstance(one, Arc)]
        rows = [(*one.center, one.radius, one.mid_angle, one.half_sweep, one.sign) for _, one in arcs]
        object.__setattr__(self, "starts", np.array([one.start for one in self.segments]))
        object.__setattr__(self, "ends", np.array([one.end for one in self.segments]))
        object.__setattr__(self, "arcs", np.array(rows).reshape(-1, 6))
        object.__setattr__(self, "arc_numbers", np.array([k for k, _ in arcs], np.int64))

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Whether points (N, 2) lie within the loop; moved a hair, because on a chord parity says nothing."""
        x, y = points[:, :1] + HAIR, points[:, 1:] + 0.6 * HAIR
        (x0, y0), (x1, y1) = self.starts.T, self.ends.T
        crosses = (y0 > y) != (y1 > y)
        rise = np.where(y1 == y0, 1.0, y1 - y0)
        odd = (crosses & (x < x0 + (y - y0) * (x1 - x0) / rise)).sum(axis=1)
        if len(self.arcs):
            cx, cy, radius, _, half, sign = self.arcs.T
            (ax, ay), (bx, by) = self.starts[self.arc_numbers].T, self.ends[self.arc_numbers].T
            # The thin piece lies to the right of the chord of an arc that runs counter-clockwise.
            side = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
            full = half >= np.pi
            odd = odd + ((np.hypot(x - cx, y - cy) < radius) & (full | (side * sign < 0))).sum(axis=1)
        return np.asarray(odd % 2 == 1)

    def distance(self, points: Array) -> Array:
        """Distances (N,) in mm from points (N, 2)."""
        straight = np.ones(len(self.segments), np.bool_)
        straight[self.arc_numbers] = False
        best = np.full(len(points), np.inf)
        x, y = points[:, :1], points[:, 1:]
        if straight.any():
            (ax, ay), (bx, by) = self.starts[straight].T, self.ends[straight].T
            dx, dy = bx - ax, by - ay
            along = np.clip(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0.0, 1.0)
            best = np.hypot(x - ax - along * dx, y - ay - along * dy).min(axis=1)
        if len(self.arcs):
            cx, cy, radius, middle, half, _ = self.arcs.T
            (ax, ay), (bx, by) = self.starts[self.arc_numbers].T, self.ends[self.arc_numbers].T
            turned = np.abs((np.arctan2(y - cy, x - cx) - middle + np.pi) % (2 * np.pi) - np.pi)
            to_ends = np.minimum(np.hypot(x - ax, y - ay), np.hypot(x - bx, y - by))
            on = np.where(turned <= half, np.abs(np.hypot(x - cx, y - cy) - radius), to_ends)
            best = np.minimum(best, on.min(axis=1))
        return np.asarray(best)

    def room(self, points: Array) -> Array:
        """Distances (N,) to the loop, negative on its forbidden side."""
        return np.where(self.contains(points) != self.is_hole, 1.0, -1.0) * self.distance(points)


@define(frozen=True, eq=False)
class TouchableFace:
    """A face less its keep-out zones.

    Parameters
    ----------
    borders : the outer loop, then openings and zones.
    """

    borders: tuple[Border, ...]

    @classmethod
    def of(cls, loops: Sequence[Array], zones: Iterable[Array] = ()) -> TouchableFace:
        """A face from loops of (x, y, bulge) vertices, the outer one first, and zones as loops."""
        borders: list[Border] = []
        for loop in loops:
            # A loop within another is an opening; one beside it belongs to a further face.
            segments = loop_segments(np.asarray(loop))
            start = np.array([segments[0].start])
            borders.append(
                Border(segments, any(one.contains(start)[0] for one in borders if not one.is_hole))
            )
        return cls((*borders, *(Border(loop_segments(np.asarray(zone)), True) for zone in zones)))

    def room(self, points: Array) -> Array:
        """Radii (N,) of the largest discs about points (N, 2) that lie on a face, negative off all."""
        within = [border.room(points) for border in self.borders if not border.is_hole]
        off = [border.room(points) for border in self.borders if border.is_hole]
        out: Array = np.min([np.max(within, axis=0), *off], axis=0)
        return out

    @property
    def box(self) -> tuple[Array, Array]:
        """The least and the greatest x and y that the outer loop may have."""
        points: list[Array] = []
        for outer in self.borders:
            if not outer.is_hole:
                points += [outer.starts, outer.arcs[:, :2] - outer.arcs[:, 2:3]]
                points += [outer.arcs[:, :2] + outer.arcs[:, 2:3]]
        every = np.concatenate(points)
        return every.min(axis=0), every.max(axis=0)

    def offset_curves(self, radius: float) -> tuple[Array, Array]:
        """Lines (L, 3), unit normal and distance, and circles (M, 3) on which a disc touches the border."""
        lines, circles = [], []
        for border in self.borders:
            left = (signed_area(border.segments) > 0) != border.is_hole
            for one in border.segments:
                circles.append((*one.start, radius))
                if isinstance(one, Arc):
                    grown = one.radius - radius if (one.sign > 0) == left else one.radius + radius
                    if grown > 0:
                        circles.append((*one.center, grown))
                else:
                    (ax, ay), (bx, by) = one.start, one.end
                    length = np.hypot(bx - ax, by - ay)
                    nx, ny = (ay - by) / length, (bx - ax) / length
                    lines.append((nx, ny, nx * ax + ny * ay + (radius if left else -radius)))
        return np.array(lines).reshape(-1, 3), np.array(circles).reshape(-1, 3)


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
