"""Every seat of three round locators on a plate in another and slower way, for tests.

All triples of holes and of faces are gone through. For two locators the part's places follow from the orientation,
which is scanned; where the third comes to its face between two orientations, it is found by Brent's method. Double roots are
not seen so, and seats near to one may not be.
"""

from __future__ import annotations

from itertools import product
from math import hypot, pi

import numpy as np
from scipy.optimize import brentq
from shapely import Polygon

from workhold.geometry.segment import Arc, measure_distance_to_segment
from workhold.model.workpiece import Workpiece

STEPS = 360
# mm. Between two orientations a locator comes no farther than this to its face.
FARTHEST = 10.0
# mm. Contacts so near to the end of a face are left to either side.
NEAR_END = 1e-6


class Face:
    """Where a locator's centre is when it touches a face: along a line, or on a circle."""

    def __init__(self, segment, number, radius, outline, others):
        self.others = others
        self.number, self.is_arc = number, isinstance(segment, Arc)
        self.outline, self.radius = outline, radius
        if self.is_arc:
            self.center, self.sign = np.array(segment.center), segment.sign
            self.reach = segment.radius + segment.sign * radius
            self.mid, self.half = segment.mid_angle, segment.half_sweep
        else:
            start, end = np.array(segment.start), np.array(segment.end)
            self.long = hypot(*(end - start))
            self.along = (end - start) / self.long
            self.normal = np.array([self.along[1], -self.along[0]])
            self.start = start

    def gap(self, points):
        """How far points are from where a centre is; of a circle, from outside."""
        if self.is_arc:
            return np.hypot(*(points - self.center).T) - self.reach
        return (points - self.start) @ self.normal - self.radius

    def normal_at(self, point):
        if not self.is_arc:
            return self.normal
        away = point - self.center
        return self.sign * away / np.hypot(*away)

    def has(self, point):
        """Whether a centre at a point touches the face inside its ends, and enters the part nowhere: -1, 0 or 1."""
        from shapely import Point

        if self.is_arc:
            x, y = point - self.center
            turn = (np.arctan2(y, x) - self.mid + pi) % (2 * pi) - pi
            inside = (self.half - abs(turn)) * self.reach if self.half < pi - 1e-9 else 1.0
        else:
            at = (point - self.start) @ self.along
            inside = min(at, self.long - at)
        free = Point(*point).distance(self.outline) - self.radius
        if inside < -NEAR_END or free < -1e-4:
            return -1
        apart = min(measure_distance_to_segment(tuple(point), other) for other in self.others)
        return int(inside > NEAR_END and apart > self.radius + NEAR_END)


def faces_of(part: Workpiece, radius: float):
    outline = Polygon(*rings(part))
    return [
        Face(
            face.segment, face.number, radius, outline, [one.segment for one in part.faces if one is not face]
        )
        for face in part.faces
    ]


def rings(part: Workpiece):
    loops = []
    for loop in part.loop_segments:
        points = []
        for one in loop:
            many = 400 if isinstance(one, Arc) else 1
            way = one.sign if isinstance(one, Arc) else 1.0
            points += [one.compute_point(way * one.half_extent * (2 * k / many - 1)) for k in range(many)]
        loops.append(points)
    return loops[0], loops[1:]


def first_places(one: Face, other: Face, arm):
    """Places of the first centre on one face with the second, an arm (N, 2) away, on another: up to two branches."""
    if not one.is_arc and not other.is_arc:
        matrix = np.array([one.normal, other.normal])
        if abs(np.linalg.det(matrix)) < 1e-9:
            return []
        right = np.stack(
            [
                np.full(len(arm), one.normal @ one.start + one.radius),
                other.normal @ other.start + other.radius - arm @ other.normal,
            ]
        )
        return [np.linalg.solve(matrix, right).T]
    if one.is_arc and other.is_arc:
        # The second circle moved back by the arm.
        away = other.center - arm - one.center
        far = np.hypot(*away.T)
        along = (far**2 + one.reach**2 - other.reach**2) / (2 * far)
        with np.errstate(invalid="ignore", divide="ignore"):
            up = np.sqrt(one.reach**2 - along**2)
            unit = away / far[:, None]
        side = np.stack([-unit[:, 1], unit[:, 0]], axis=1)
        return [one.center + along[:, None] * unit + way * up[:, None] * side for way in (1, -1)]
    if one.is_arc:
        return [place - arm for place in first_places(other, one, -arm)]
    # On the line one, the second centre on the circle other.
    base = one.start + one.normal * one.radius
    away = base + arm - other.center
    half = away @ one.along
    with np.errstate(invalid="ignore"):
        root = np.sqrt(half**2 - (away**2).sum(axis=1) + other.reach**2)
    return [base + (way * root - half)[:, None] * one.along for way in (1, -1)]


def turned(step, psi):
    c, s = np.cos(psi), np.sin(psi)
    return np.stack([c * step[0] - s * step[1], s * step[0] + c * step[1]], axis=-1)


def slow_seats(part: Workpiece, radius: float, pitch: float, columns: int, rows: int):
    """Yield (holes, faces, theta in degrees, determinant, whether it is sure) of each seat found."""
    faces, centre = faces_of(part, radius), np.array(part.center)
    length = hypot(part.bounds[2] - part.bounds[0], part.bounds[3] - part.bounds[1]) / 2
    psi = np.linspace(0, 2 * pi, STEPS + 1) + 1e-4
    steps = [(a, b) for a, b in product(range(columns), range(-rows + 1, rows)) if (a, b) > (0, 0)]
    for number, two in enumerate(steps):
        for three in steps[number + 1 :]:
            holes = np.array([(0, 0), two, three])
            span = np.ptp(holes, axis=0)
            if span[0] >= columns or span[1] >= rows:
                continue
            for chosen in product(faces, repeat=3):
                # The two whose places are found must not be parallel.
                for order in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
                    trio = [chosen[k] for k in order]
                    if (
                        trio[0].is_arc
                        or trio[1].is_arc
                        or abs(np.linalg.det([trio[0].normal, trio[1].normal])) > 1e-9
                    ):
                        break
                else:
                    continue
                some = (holes[list(order)] - holes[order[0]]) * pitch
                yield from seats_of(trio, some, psi, holes, chosen, centre, length)


def seats_of(trio, steps, psi, holes, chosen, centre, length):
    def gaps(angle):
        arms = [turned(step, angle) for step in steps]
        return [(place, trio[2].gap(place + arms[2])) for place in first_places(trio[0], trio[1], arms[1])]

    found = gaps(psi)
    for branch, (_, gap) in enumerate(found):
        for k in np.flatnonzero(np.sign(gap[:-1]) * np.sign(gap[1:]) < 0):
            if not min(abs(gap[k]), abs(gap[k + 1])) < FARTHEST:
                continue
            root = brentq(
                lambda at, branch=branch: gaps(np.array([at]))[branch][1][0], psi[k], psi[k + 1], xtol=1e-14
            )
            angle = np.array([root])
            place, off = gaps(angle)[branch]
            if not abs(off[0]) < 1e-7:
                continue
            points = [place[0] + turned(step, angle)[0] for step in steps]
            inside = [face.has(point) for face, point in zip(trio, points, strict=True)]
            if min(inside) < 0:
                continue
            wrenches = []
            for face, point in zip(trio, points, strict=True):
                n, q = face.normal_at(point), point - centre
                wrenches.append([*n, (q[0] * n[1] - q[1] * n[0]) / length])
            size = abs(np.linalg.det(np.array(wrenches)))
            key = tuple(map(tuple, (holes - holes.min(axis=0)).tolist()))
            yield (
                key,
                tuple(face.number for face in chosen),
                float(np.degrees(-angle[0]) % 360),
                size,
                min(inside) > 0,
            )
