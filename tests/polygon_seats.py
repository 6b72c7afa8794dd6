"""Every seat of three round locators on a part with straight sides, in closed form, for tests.

A side with outward unit normal n is touched where n . q is its level plus the radius, for the locator's centre q. Of
three sides some combination of the normals is zero; the same combination of the three equations has the orientation
alone as its unknown, and reads A cos psi + B sin psi = D. So each triple of holes and of sides has two orientations at
most, with no scan and no start for an iteration.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product

import numpy as np
from attrs import frozen

from workhold.model.workpiece import Workpiece


@frozen
class PolygonSeat:
    """Three locators in holes, the sides that they touch, and the part's angle.

    Parameters
    ----------
    contacts : (column, row, face) of each, the lowest column and row 0, in order.
    theta : of the part, in degrees.
    determinant : of the wrenches, moments over half the diameter of the peg-centre locus.
    room : how far in mm the centres are inside the ends of the sides and clear of other sides; about 0 where a
        locator touches a second one.
    points : of the centres in the part's frame.
    """

    contacts: tuple[tuple[int, int, int], ...]
    theta: float
    determinant: float
    room: float
    points: np.ndarray


@frozen
class Sides:
    """The sides (N,) of a part: starts, unit directions, lengths, outward normals and numbers of their faces."""

    start: np.ndarray
    along: np.ndarray
    long: np.ndarray
    normal: np.ndarray
    face: np.ndarray

    @classmethod
    def of(cls, part: Workpiece) -> Sides:
        ends = np.array([[face.segment.start, face.segment.end] for face in part.faces])
        step = ends[:, 1] - ends[:, 0]
        long = np.hypot(*step.T)
        along = step / long[:, None]
        normal = np.column_stack([along[:, 1], -along[:, 0]])
        return cls(ends[:, 0], along, long, normal, np.array([face.number for face in part.faces]))

    def room(self, points, touched):
        """How far (N,) centres (N, 3, 2) are inside the ends of sides (N, 3), clear of others and out of the part."""
        away = points[:, :, None] - self.start
        at = (away * self.along).sum(axis=3)
        to_ends = np.take_along_axis(np.minimum(at, self.long - at), touched[..., None], 2)[..., 0]
        feet = np.clip(at, 0.0, self.long)[..., None] * self.along
        clear = np.hypot(*np.moveaxis(away - feet, 3, 0))
        np.put_along_axis(clear, touched[..., None], np.inf, 2)
        x, y = points[..., 0], points[..., 1]
        is_inside = np.zeros(x.shape, np.bool_)
        for (x0, y0), (dx, dy) in zip(self.start, self.along * self.long[:, None], strict=True):
            crosses = (y0 > y) != (y0 + dy > y)
            is_inside ^= crosses & (x < x0 + dx * np.divide(y - y0, dy, out=np.zeros_like(y), where=crosses))
        return np.where(is_inside.any(axis=1), -np.inf, to_ends.min(axis=1)), clear.min(axis=(1, 2))


def cross(one, other):
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]


def polygon_seats(part: Workpiece, radius: float, pitch, columns: int, rows: int) -> Iterator[PolygonSeat]:
    """Yield each seat up to steps of the lattice and names of locators, also those at ends and double roots."""
    sides = Sides.of(part)
    across = np.hypot(*(sides.start[:, None] - sides.start).reshape(-1, 2).T).max() + 2 * radius
    level = (sides.normal * sides.start).sum(axis=1) + radius
    trios = np.array(list(product(range(len(level)), repeat=3)))
    normals = sides.normal[trios]
    weights = np.stack([cross(normals[:, k - 2], normals[:, k - 1]) for k in range(3)], axis=1)
    some = np.abs(weights).max(axis=1) > 1e-9
    trios, normals, weights = trios[some], normals[some], weights[some]
    right = (weights * level[trios]).sum(axis=1)
    centre = np.array(part.center)
    steps = [step for step in product(range(columns), range(1 - rows, rows)) if step > (0, 0)]
    for two, three in combinations(steps, 2):
        holes = np.array([(0, 0), two, three])
        apart = (holes[:, None] - holes) * np.array(pitch)
        if (np.ptp(holes, axis=0) >= (columns, rows)).any() or np.hypot(*apart.T).max() > across + 1e-6:
            continue
        arms = holes * np.array(pitch, float)
        straight = (weights * (normals * arms).sum(axis=2)).sum(axis=1)
        sideways = (weights * cross(arms, normals)).sum(axis=1)
        size = np.hypot(straight, sideways)
        solved = np.flatnonzero((size > 1e-9) & (np.abs(right) <= size))
        middle = np.arctan2(sideways[solved], straight[solved])
        off = np.arccos(right[solved] / size[solved])
        for psi in (middle + off, middle - off):
            yield from placed(sides, trios[solved], level, (holes, arms), psi, (radius, centre, across / 2))


def placed(sides, trio, level, holes_and_arms, psi, measures):
    """The seats among orientations (N,) with their trios of sides (N, 3)."""
    (holes, arms), (radius, centre, length) = holes_and_arms, measures
    normal = sides.normal[trio]
    c, s = np.cos(psi)[:, None], np.sin(psi)[:, None]
    turned = np.stack([c * arms[:, 0] - s * arms[:, 1], s * arms[:, 0] + c * arms[:, 1]], axis=2)
    wanted = level[trio] - (normal * turned).sum(axis=2)
    first = np.linalg.solve(
        np.einsum("nij,nik->njk", normal, normal), np.einsum("nij,ni->nj", normal, wanted)[..., None]
    )
    points = first[..., 0][:, None] + turned
    wrenches = np.dstack([normal, cross(points - centre, normal)[..., None] / length])
    determinant = np.abs(np.linalg.det(wrenches))
    inside, clear = sides.room(points, trio)
    room = np.minimum(inside, clear - radius)
    for k in np.flatnonzero(room > -1e-6):
        at = holes - holes.min(axis=0)
        contacts = sorted((int(a), int(b), int(sides.face[f])) for (a, b), f in zip(at, trio[k], strict=True))
        theta = float(np.degrees(-psi[k]) % 360)
        yield PolygonSeat(tuple(contacts), theta, float(determinant[k]), float(room[k]), points[k])
