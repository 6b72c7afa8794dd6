"""A part in doubles, for what needs no ball: whether pegs are clear of it, and whether it covers the same place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil, cos, pi, radians, sin

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.model.workpiece import Workpiece
from workhold.verification.sides import LineSide, Side

__all__ = ["FloatOutline"]

Array = NDArray[np.float64]
# Places looked at on each segment; corners of the polygon in it for a whole circle, at least.
POINTS, CORNERS = 8, 64


@frozen(eq=False)
class FloatOutline:
    """The segments of a part.

    Parameters
    ----------
    lines : (L, 4) start and end.
    arcs : (A, 5) centre, radius, direction of the middle and half the sweep.
    points : (M, 2) on all of them.
    edges : (E, 4) start and end of the edges of a polygon close to the outline.
    arm : largest distance in mm of a point of the outline from the centre.
    """

    lines: Array
    arcs: Array
    points: Array
    edges: Array
    arm: float

    @classmethod
    def of(cls, segments: Sequence[Side], workpiece: Workpiece) -> FloatOutline:
        """The segments of a part's sides."""
        lines, arcs, points, edges = [], [], list[Array](), list[Array]()
        for side in segments:
            if isinstance(side, LineSide):
                a, b = (np.array([float(v.mid()) for v in end]) for end in (side.start, side.end))
                lines.append((*a, *b))
                run = a + np.linspace(0.0, 1.0, POINTS + 1)[:, None] * (b - a)
                fine = np.stack([a, b])
            else:
                center = np.array([float(v.mid()) for v in side.center])
                radius, half = float(side.radius.mid()), float(side.half_sweep.mid())
                middle = float(np.arctan2(float(side.middle[1].mid()), float(side.middle[0].mid())))
                arcs.append((*center, radius, middle, half))
                # From its start to its end, clockwise on a hollow.
                count = max(ceil(half / pi * CORNERS), POINTS)
                run, fine = (
                    center + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
                    for turn in (middle + side.sign * half * np.linspace(-1.0, 1.0, n + 1) for n in (POINTS, count))
                )
            points.append(run)
            edges.append(np.hstack([fine[:-1], fine[1:]]))
        every = np.concatenate(points)
        arm = float(np.hypot(*(every - workpiece.center).T).max())
        return cls(np.array(lines).reshape(-1, 4), np.array(arcs).reshape(-1, 5), every, np.concatenate(edges), arm)

    def placed(self, points: Array, pose: Mapping[str, float], mirrored: bool) -> Array:
        """Points (N, 2) of the part as they lie in a pose, the part turned over or not."""
        c, s = cos(radians(pose["theta_deg"])), sin(radians(pose["theta_deg"]))
        x, y = points[:, 0] * (-1.0 if mirrored else 1.0), points[:, 1]
        return np.stack([c * x - s * y + pose["x"], s * x + c * y + pose["y"]], axis=1)

    def lowest(self, pose: Mapping[str, float], mirrored: bool) -> float:
        """How high in mm the lowest point of the part is in a pose."""
        turn = radians(pose["theta_deg"])
        down = np.array([-sin(turn) * (-1.0 if mirrored else 1.0), -cos(turn)])
        x, y, radius, middle, half = self.arcs.T
        away = np.abs((np.arctan2(down[1], down[0]) - middle + pi) % (2.0 * pi) - pi)
        below = np.stack([x, y], axis=1)[away <= half] + radius[away <= half, None] * down
        return float(self.placed(np.concatenate([self.points, below]), pose, mirrored)[:, 1].min())

    def local(self, points: Array, pose: Mapping[str, float], mirrored: bool) -> Array:
        """Points (N, 2) of the toolkit's frame as the part in a pose sees them."""
        c, s = cos(radians(pose["theta_deg"])), sin(radians(pose["theta_deg"]))
        x, y = points[:, 0] - pose["x"], points[:, 1] - pose["y"]
        return np.stack([(c * x + s * y) * (-1.0 if mirrored else 1.0), c * y - s * x], axis=1)

    def distances(self, points: Array) -> Array:
        """Distances (N,) of points from the outline."""
        found = np.full(len(points), np.inf)
        for ax, ay, bx, by in self.lines:
            t = ((points[:, 0] - ax) * (bx - ax) + (points[:, 1] - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2)
            t = np.clip(t, 0.0, 1.0)
            away = np.hypot(points[:, 0] - ax - t * (bx - ax), points[:, 1] - ay - t * (by - ay))
            found = np.minimum(found, away)
        for x, y, radius, middle, half in self.arcs:
            dx, dy = points[:, 0] - x, points[:, 1] - y
            turn = (np.arctan2(dy, dx) - middle + pi) % (2.0 * pi) - pi
            foot = middle + np.clip(turn, -half, half)
            away = np.hypot(dx - radius * np.cos(foot), dy - radius * np.sin(foot))
            found = np.minimum(found, away)
        return found

    def is_free(self, pegs: Array, radii: Array, pose: Mapping[str, float], mirrored: bool) -> bool:
        """Whether no disc about centres (N, 2) of radii (N,) in mm is in the part or reaches into it."""
        points = self.local(pegs, pose, mirrored)
        return bool((self.distances(points) >= radii).all() and not self.holds(points).any())

    def holds(self, points: Array) -> NDArray[np.bool_]:
        """Whether the part holds points (N,), as far as its polygon shows."""
        ax, ay, bx, by = self.edges.T
        x, y = points[:, :1], points[:, 1:]
        crosses = (ay <= y) != (by <= y)
        rise = np.where(by == ay, 1.0, by - ay)
        right = ax + (y - ay) / rise * (bx - ax) > x
        return np.asarray((crosses & right).sum(axis=1) % 2 == 1)

    def farthest(self, pose: Mapping[str, float], mirrored: bool, other: Mapping[str, float]) -> float:
        """How far in mm the outline in a pose is from that in another one, in which it is not turned over."""
        there = self.local(self.placed(self.points, pose, mirrored), other, False)
        return float(self.distances(there).max())
