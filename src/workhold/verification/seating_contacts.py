"""What a stated seating is compared with: contacts, the stop, and the part in doubles.

Stated contacts are derived anew from the outline. The stop is where what moves comes to rest without the
part. Doubles suffice to ask whether pegs are clear of the part, and whether it covers the same place.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from math import ceil, cos, inf, pi, radians, sin, sqrt

import numpy as np
from attrs import frozen
from flint import arb
from numpy.typing import NDArray

from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Peg
from workhold.model.workpiece import Workpiece
from workhold.verification.ball_geometry import (
    ArcSide,
    BallOutline,
    LineSide,
    Point,
    Side,
    exact_point,
    minus,
    norm,
    turned,
)
from workhold.verification.tolerances import AGREEMENT

__all__ = [
    "PRESSES",
    "FloatOutline",
    "PartPlacement",
    "StatedContact",
    "balances",
    "stop_of",
    "touching_faults",
    "touching_peg",
    "touching_wall",
]

# mm. A tip may be in a locator by this much: rounding.
APART = 1e-6


Array = NDArray[np.float64]


@frozen
class PartPlacement:
    """How a part lies.

    Parameters
    ----------
    theta_deg, x, y : its pose, in degrees and mm.
    mirrored : whether it is turned over first, x to -x in its own frame.
    """

    theta_deg: float
    x: float
    y: float
    mirrored: bool = False

    @classmethod
    def of(cls, pose: Mapping[str, float], mirrored: bool = False) -> PartPlacement:
        return cls(pose["theta_deg"], pose["x"], pose["y"], mirrored)

    def turned(self, way: Point) -> Point:
        """A vector of the part as it lies, in balls."""
        sine, cosine = (arb(self.theta_deg) / 180).sin_cos_pi()
        return turned((-way[0], way[1]) if self.mirrored else way, cosine, sine)

    def own(self, way: Point) -> Point:
        """A vector of the toolkit's frame as the part sees it, in balls."""
        sine, cosine = (arb(self.theta_deg) / 180).sin_cos_pi()
        x, y = turned(way, cosine, -sine)
        return (-x, y) if self.mirrored else (x, y)

    def placed(self, points: Array) -> Array:
        """Points (N, 2) of the part as they lie, in doubles."""
        c, s = cos(radians(self.theta_deg)), sin(radians(self.theta_deg))
        x, y = points[:, 0] * (-1.0 if self.mirrored else 1.0), points[:, 1]
        return np.stack([c * x - s * y + self.x, s * x + c * y + self.y], axis=1)

    def local(self, points: Array) -> Array:
        """Points (N, 2) of the toolkit's frame as the part sees them, in doubles."""
        c, s = cos(radians(self.theta_deg)), sin(radians(self.theta_deg))
        x, y = points[:, 0] - self.x, points[:, 1] - self.y
        return np.stack([(c * x + s * y) * (-1.0 if self.mirrored else 1.0), c * y - s * x], axis=1)


@frozen
class StatedContact:
    """A contact of a seat or a pass.

    Parameters
    ----------
    peg : its number.
    at, normal : in the toolkit's frame, in mm from its origin, where the part is touched, and the outward
        unit normal there.
    off : how far in mm the peg is from touching, at most.
    is_inside : whether what is touched is the inside of a face, or a corner.
    """

    peg: int
    at: Point
    normal: Point
    off: float
    is_inside: bool


def touching_wall(outline: BallOutline, contact: Mapping[str, int], place: PartPlacement) -> StatedContact:
    """A contact with a wall along x at y = 0: a corner, or the lowest point of a convex arc above it."""
    number, down, is_corner = contact["peg"], exact_point(0.0, -1.0), "corner" in contact
    side = outline.faces.get(contact["corner" if is_corner else "face"])
    if is_corner and side is not None:
        local, off = side.start, arb(0)
    elif isinstance(side, ArcSide) and side.sign > 0:
        x, y = place.own(down)
        local = side.center[0] + side.radius * x, side.center[1] + side.radius * y
        off = side.distance(local)
    else:
        return StatedContact(number, exact_point(0.0, 0.0), down, inf, False)
    x, y = place.turned(local)
    at = x + place.x, y + place.y
    return StatedContact(number, at, down, float(abs(at[1]).upper()), bool(off < AGREEMENT))


def touching_peg(
    outline: BallOutline,
    contact: Mapping[str, int],
    place: PartPlacement,
    center: tuple[float, float],
    radius: float,
) -> StatedContact:
    """A contact with a face or a corner of a round peg about a center, of a radius in mm."""
    number, (x, y), face = contact["peg"], center, contact.get("face")
    local = place.own(exact_point(x - place.x, y - place.y))
    side = outline.faces.get(contact["corner"] if face is None else face)
    if side is None:
        return StatedContact(number, exact_point(x, y), exact_point(0.0, 0.0), inf, False)
    if face is None:
        way, inside = minus(local, side.start), True
        off = abs(norm(way) - radius)
    else:
        way, off = side.outward(local), abs(side.gap(local) - radius)
        inside = bool(abs(side.distance(local) - radius) < AGREEMENT)
    size = norm(way)
    normal = place.turned((way[0] / size, way[1] / size))
    at = arb(x) - radius * normal[0], arb(y) - radius * normal[1]
    return StatedContact(number, at, normal, float(off.upper()), inside)


def touching_faults(contacts: Sequence[StatedContact], on_wall: Sequence[int], wall: str) -> Iterator[str]:
    """Contacts that do not touch as stated, are stated twice, or lack the wall's first end.

    The pegs ``on_wall`` are ends of the contact with what is called ``wall``.
    """
    ends = [one.peg for one in contacts if one.peg in on_wall]
    if ends != list(on_wall[: len(ends)]):
        yield f"does not name the ends on the {wall} from the first on"
    if len({(one.peg, *(round(float(part.mid()), 5) for part in one.at)) for one in contacts}) < len(
        contacts
    ):
        yield "has a contact twice"
    for one in contacts:
        if not (one.off < AGREEMENT and one.is_inside):
            yield f"has peg {one.peg} not where it is said to touch"


def stop_of(pegs: Sequence[Peg], toolkit: Toolkit, separation: float) -> float | None:
    """The travel in mm at which what moves is stopped without the part; None where nothing stops it.

    ``separation`` is the travel in mm at which a fixture has its pegs.
    """
    moved = [peg for peg in pegs if toolkit.carrier(peg.carrier).travel is not None]
    still = [peg for peg in pegs if peg not in moved and toolkit.carrier(peg.carrier).contact.is_placed]
    moving, tip = toolkit.carrier(moved[0].carrier), moved[0]
    assert moving.travel is not None
    if toolkit.clamping < 0:
        return moving.travel.most
    if toolkit.gap is not None:
        return toolkit.gap + max(peg.x for peg in still) - min(peg.x for peg in moved) + separation
    ends, (ux, uy) = [moving.travel.least], moving.travel.unit
    for peg in still:
        dx, dy = peg.x - tip.x, peg.y - tip.y
        along, across = dx * ux + dy * uy, dx * uy - dy * ux
        square = (moving.peg_radius + toolkit.carrier(peg.carrier).peg_radius) ** 2 - across * across
        # It moves against its unit vector, and meets what lies there.
        if square > 0.0 and along <= 0.0:
            ends.append(separation + min(along + sqrt(square), APART))
    if WALL_END in toolkit.contacts and uy > 0.0:
        ends.append(separation + moving.peg_radius - tip.y)
    least = max(ends)
    return None if least == -inf else least


# No unit. A force above minus this, per unit of clamping force, presses.
PRESSES = 1e-9


def balances(wrenches: Array, spare: float = 1e-9) -> bool:
    """Whether factors of 0 or more make wrenches (4, K) add up to (0, 0, 0, 1), what moves bearing one.

    If some do, then at most four that are independent do (Caratheodory's theorem).
    """
    target = np.array([0.0, 0.0, 0.0, 1.0])
    if not np.isfinite(wrenches).all():
        # A peg that is said to stand in the centre of an arc has no normal.
        return False
    for size in range(1, min(wrenches.shape[1], 4) + 1):
        for chosen in combinations(range(wrenches.shape[1]), size):
            some = wrenches[:, chosen]
            forces = np.linalg.lstsq(some, target, rcond=None)[0]
            if forces.min() > -PRESSES and np.abs(some @ forces - target).max() < spare * (
                1.0 + forces.sum()
            ):
                return True
    return False


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
                    for turn in (
                        middle + side.sign * half * np.linspace(-1.0, 1.0, n + 1) for n in (POINTS, count)
                    )
                )
            points.append(run)
            edges.append(np.hstack([fine[:-1], fine[1:]]))
        every = np.concatenate(points)
        arm = float(np.hypot(*(every - workpiece.center).T).max())
        return cls(
            np.array(lines).reshape(-1, 4), np.array(arcs).reshape(-1, 5), every, np.concatenate(edges), arm
        )

    def lowest(self, place: PartPlacement) -> float:
        """How high in mm the lowest point of the part is."""
        turn = radians(place.theta_deg)
        down = np.array([-sin(turn) * (-1.0 if place.mirrored else 1.0), -cos(turn)])
        x, y, radius, middle, half = self.arcs.T
        away = np.abs((np.arctan2(down[1], down[0]) - middle + pi) % (2.0 * pi) - pi)
        below = np.stack([x, y], axis=1)[away <= half] + radius[away <= half, None] * down
        return float(place.placed(np.concatenate([self.points, below]))[:, 1].min())

    def distances(self, points: Array) -> Array:
        """Distances (N,) of points from the outline."""
        found = np.full(len(points), np.inf)
        for ax, ay, bx, by in self.lines:
            t = ((points[:, 0] - ax) * (bx - ax) + (points[:, 1] - ay) * (by - ay)) / (
                (bx - ax) ** 2 + (by - ay) ** 2
            )
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

    def is_free(self, pegs: Array, radii: Array, place: PartPlacement) -> bool:
        """Whether no disc about centres (N, 2) of radii (N,) in mm is in the part or reaches into it."""
        points = place.local(pegs)
        return bool((self.distances(points) >= radii).all() and not self.holds(points).any())

    def holds(self, points: Array) -> NDArray[np.bool_]:
        """Whether the part holds points (N,), as far as its polygon shows."""
        ax, ay, bx, by = self.edges.T
        x, y = points[:, :1], points[:, 1:]
        crosses = (ay <= y) != (by <= y)
        rise = np.where(by == ay, 1.0, by - ay)
        right = ax + (y - ay) / rise * (bx - ax) > x
        return np.asarray((crosses & right).sum(axis=1) % 2 == 1)

    def farthest(self, one: PartPlacement, other: PartPlacement) -> float:
        """How far in mm the outline as it lies in one way is from that in another."""
        return float(self.distances(other.local(one.placed(self.points))).max())
