"""Where the clamp stands best: the point t that makes the largest r_j / beta_j(t) least.

The points with C beta_j(t) >= r_j are a triangle like that of the supports. It shrinks to t* = sum r_j s_j /
sum r_j as C falls to C* = sum r_j (over r_j > 0). So t* is best where the clamp may stand
there. Else the best point lies on the border of where it may: where two of r_j / beta_j are equal, or at a
corner. Or b_j is normal to an arc of the border there. With r_j = |b_j| the value is one over the distance to
the nearest side: the same search then finds the best tipping arm, and t* is the incentre.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import combinations, pairwise

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK
from workhold.supports.faces import Curve, LevelRegions, TouchableFace, offset_curves
from workhold.supports.forces import Triangles

__all__ = ["ClampPlaces", "RankedPlaces"]

Array = NDArray[np.float64]
# How many of the best candidates are held against the face at first; each time after twice as many.
AT_FIRST = 6
# A corner this near to a curve is on it, and a point this near to the end of a piece on that; in mm. What is
# taken for free and is not does no harm.
ON_CURVE, ON_PIECE = 1e-5, 1e-3
# Around all of a circle.
TURN = np.array([0.0, 2 * np.pi])
# How many candidates, of several triangles, are looked at together.
CANDIDATES = 1 << 18


@define(frozen=True, eq=False)
class ClampPlaces:
    """Where a tip may stand on the top of one part.

    Parameters
    ----------
    face : the top less its zones.
    tip_radius : in mm.
    rings : (R, 4) centres, least and greatest distances of the reach in the part's coordinates, or None.
    tip_margin : least distance in mm of the tip from the border of its face.
    kept_off : regions by the heights of the faces, each with the distance in mm that the tip's middle keeps.
    """

    face: TouchableFace
    tip_radius: float
    rings: Array | None
    tip_margin: float = 0.0
    kept_off: tuple[tuple[LevelRegions, float], ...] = ()
    straight: Pieces = field(init=False)
    bent: Pieces = field(init=False)
    corners: Array = field(init=False)

    def __attrs_post_init__(self) -> None:
        levels = dict.fromkeys(self.face.levels) or [None]
        straight, bent, corners = zip(*map(self.borders_on, levels), strict=True)
        object.__setattr__(self, "straight", Pieces.joined(straight))
        object.__setattr__(self, "bent", Pieces.joined(bent))
        object.__setattr__(self, "corners", np.unique(np.concatenate(corners), axis=0))

    def borders_on(self, level: float | None) -> tuple[Pieces, Pieces, Array]:
        """Pieces of lines and circles that border the places on faces of one height, and corners (K, 2)."""
        lines: list[Curve] = []
        circles: list[Curve] = []
        for number, loop in enumerate(self.face.borders.loops):
            face = self.face.face_of(number)
            if face is None or self.face.levels[face] == level:
                radius = self.tip_radius + (0.0 if face is None else self.tip_margin)
                straight, bent = offset_curves(loop, radius, self.face.is_on_left(number))
                lines, circles = lines + straight, circles + bent
        for regions, away in self.kept_off:
            for straight, bent in regions.offset_curves(level, away):
                lines, circles = lines + straight, circles + bent
        for x, y, low, high in () if self.rings is None else self.rings.tolist():
            circles += [(x, y, low), (x, y, high)]
        own = [np.unique(np.array(one).reshape(-1, 3), axis=0) for one in (lines, circles)]
        corners = self.border_corners(own[0], own[1])
        return self.free_pieces(own[0], corners, False), self.free_pieces(own[1], corners, True), corners

    def free_pieces(self, curves: Array, corners: Array, round_: bool) -> Pieces:
        """The pieces of lines or circles (N, 3) on which the tip may stand.

        They run from corner to corner. So the middle between two corners that follow one another decides, or
        any point of a circle without corners.
        """
        kept, spans = list[int](), list[tuple[float, float]]()
        middles, owners = list[Array](), list[tuple[int, float, float]]()
        for number, curve in enumerate(curves):
            places = np.sort(places_on(curve, corners[apart(curve, corners, round_) <= ON_CURVE], round_))
            if round_:
                places = np.append(places, places[:1] + 2 * np.pi) if len(places) else TURN
            for low, high in pairwise(places.tolist()):
                middles.append(find_point_on_curve(curve, (low + high) / 2, round_))
                owners.append((number, low, high))
        free = self.allows(np.array(middles).reshape(-1, 2))
        for (number, low, high), may in zip(owners, free.tolist(), strict=True):
            if may and kept and kept[-1] == number and spans[-1][1] == low:
                spans[-1] = (spans[-1][0], high)
            elif may:
                kept.append(number)
                spans.append((low, high))
        return Pieces(curves[kept].reshape(-1, 3), np.array(spans).reshape(-1, 2))

    def room(self, points: Array) -> Array:
        """The slack (N,) in mm by which a tip at points (N, 2) keeps the rules of the top but its zones."""
        on, _ = self.face.own.rooms(points)
        on = on - self.tip_radius - self.tip_margin
        for regions, away in self.kept_off:
            for level in dict.fromkeys(self.face.levels):
                own = np.array([one == level for one in self.face.levels])
                on[:, own] = np.minimum(on[:, own], (regions.apart(level, points) - away)[:, None])
        room = on.max(axis=1, initial=-np.inf)
        if self.rings is not None:
            apart = np.hypot(*np.moveaxis(points[:, None] - self.rings[None, :, :2], -1, 0))
            ring = np.minimum(apart - self.rings[:, 2], self.rings[:, 3] - apart).max(axis=1, initial=-np.inf)
            room = np.minimum(room, ring)
        return np.asarray(room)

    def allows(self, points: Array) -> NDArray[np.bool_]:
        """Whether a tip may stand at points (N, 2)."""
        found = self.face.off_zones(points, self.tip_radius, GAP_SLACK)
        found[found] = self.room(points[found]) >= -GAP_SLACK
        return found

    @cached_property
    def is_empty(self) -> bool:
        """Whether the tip may stand nowhere."""
        if not self.face.faces:
            return True
        low, high = self.face.box
        # Two triangles that hold all of the box, from whose sides any of its points is far.
        wide = float((high - low).max()) + 10.0
        corners = np.array(
            [low - wide, (high[0] + wide, low[1] - wide), high + wide, (low[0] - wide, high[1] + wide)]
        )
        halves = Triangles.of(np.array([corners[[0, 1, 2]], corners[[0, 2, 3]]]))
        return not np.isfinite(self.best(halves, halves.steepness, 0.0)[1]).any()

    @property
    def candidate_count(self) -> int:
        """How many places on the border can be best inside one triangle."""
        return 6 * len(self.straight) + 14 * len(self.bent) + len(self.corners) + 15

    def border_corners(self, lines: Array, circles: Array) -> Array:
        """Points (K, 2) where two curves of a border cross and the tip may stand."""
        points = [find_crossings_with_lines(lines[None], lines, circles).reshape(-1, 2)]
        first, second = np.triu_indices(len(circles), 1)
        points.append(find_circle_pair_crossings(circles[first], circles[second]))
        every = np.concatenate(points)
        every = every[np.isfinite(every).all(axis=1)]
        every = every[self.allows(every)] if len(every) else every
        return np.unique(np.round(every, 12), axis=0)

    def best(self, triangles: Triangles, reach: Array, inside: float) -> tuple[Array, Array]:
        """The best points (N, 2) of triangles, and the values there; NaN and infinite where none is allowed.

        Parameters
        ----------
        reach : (N, 3) r_j, of which at least one of each triangle is positive.
        inside : smallest distance from a side in mm.
        """
        asked = np.maximum(reach, 0.0)
        total = asked.sum(axis=1)
        points = (asked[..., None] * triangles.corners).sum(axis=1) / total[:, None]
        good = triangles.sides(points).min(axis=1) >= inside - GAP_SLACK
        good[good] = self.allows(points[good])
        value = total.copy()
        rest = np.flatnonzero(~good)
        step = max(1, CANDIDATES // self.candidate_count)
        for first in range(0, len(rest), step):
            some = rest[first : first + step]
            points[some], value[some] = self.on_border(triangles.take(some), asked[some], inside)
        return points, value

    def on_border(self, triangles: Triangles, asked: Array, inside: float) -> tuple[Array, Array]:
        """The best of the points that :meth:`candidates` gives."""
        candidates = self.candidates(triangles, asked, inside)
        count = len(candidates)
        of, which = np.nonzero(np.isfinite(candidates[..., 0]))
        points = candidates[of, which]
        # One column after the other: what numpy does along a short axis takes ten times as long.
        shares = [
            triangles.slopes[of, k, 0] * points[:, 0]
            + triangles.slopes[of, k, 1] * points[:, 1]
            + triangles.constants[of, k]
            for k in range(3)
        ]
        steepness = triangles.steepness
        well = np.ones(len(of), np.bool_)
        value = np.zeros(len(of))
        with np.errstate(invalid="ignore", divide="ignore"):
            for k, share in enumerate(shares):
                well &= share / steepness[of, k] >= inside - GAP_SLACK
                value = np.maximum(value, asked[of, k] / share)
        well &= np.isfinite(value)
        points, value, of = points[well], value[well], of[well]
        order = np.lexsort((value, of))
        points, value, of = points[order], value[order], of[order]
        # How many candidates of the same triangle come before each.
        before = np.arange(len(of)) - np.searchsorted(of, np.arange(count))[of]
        out, least = np.full((count, 2), np.nan), np.full(count, np.inf)
        first, step, rest = 0, AT_FIRST, np.arange(len(of))
        while len(rest):
            now = rest[before[rest] < first + step]
            hits = now[self.allows(points[now])]
            found, place = np.unique(of[hits], return_index=True)
            out[found], least[found] = points[hits[place]], value[hits[place]]
            first, step = first + step, 2 * step
            rest = rest[(before[rest] >= first) & np.isinf(least[of[rest]])]
        return out, least

    def candidates(self, triangles: Triangles, asked: Array, inside: float) -> Array:
        """All points (N, K, 2) that can be best on the border; NaN where two curves do not meet."""
        count = len(triangles.slopes)
        lines = []
        for j, k in combinations(range(3), 2):
            # r_j beta_k = r_k beta_j
            slope = asked[:, j, None] * triangles.slopes[:, k] - asked[:, k, None] * triangles.slopes[:, j]
            constant = asked[:, j] * triangles.constants[:, k] - asked[:, k] * triangles.constants[:, j]
            lines.append(normalised(slope, -constant))
        for j in range(3):
            steep = triangles.steepness[:, j]
            lines.append(normalised(triangles.slopes[:, j], inside * steep - triangles.constants[:, j]))
        every = np.stack(lines, axis=1)
        first, second = np.triu_indices(every.shape[1], 1)
        normals = triangles.slopes / triangles.steepness[..., None]
        straight, circles = self.straight.curves, self.bent.curves
        centers, radii = circles[:, :2], circles[:, 2, None]
        met = find_crossings_with_lines(every, straight, circles)
        first_circle, second_circle = len(straight), len(straight) + len(circles)
        on_circles = [met[:, :, first_circle:second_circle], met[:, :, second_circle:]]
        on_circles += [centers + sign * radii * normals[:, :, None] for sign in (1.0, -1.0)]
        out = [
            self.straight.on_pieces(met[:, :, :first_circle], False),
            *(self.bent.on_pieces(one, True) for one in on_circles),
            find_line_crossings(every[:, first], every[:, second]),
            np.broadcast_to(self.corners, (count, len(self.corners), 2)),
        ]
        return np.concatenate([one.reshape(count, -1, 2) for one in out], axis=1)


@define(frozen=True, eq=False)
class Pieces:
    """Pieces of lines, or of circles.

    Parameters
    ----------
    curves : (P, 3) unit normal and distance, or centre and radius, in mm.
    spans : (P, 2) along the line in mm, or angles in radians, the lower one first.
    """

    curves: Array
    spans: Array

    def __len__(self) -> int:
        return len(self.curves)

    @classmethod
    def joined(cls, parts: Sequence[Pieces]) -> Pieces:
        return cls(
            np.concatenate([one.curves for one in parts]), np.concatenate([one.spans for one in parts])
        )

    def on_pieces(self, points: Array, round_: bool) -> Array:
        """Points (..., P, 2), each of the curve of a piece, and NaN for those that are not on the piece."""
        low, high = self.spans.T
        along = places_on(self.curves, points, round_)
        if round_:
            slack = ON_PIECE / self.curves[:, 2]
            on = (along - low + slack) % (2 * np.pi) <= high - low + 2 * slack
        else:
            on = (along >= low - ON_PIECE) & (along <= high + ON_PIECE)
        return np.where(on[..., None], points, np.nan)


@define(frozen=True, eq=False)
class RankedPlaces:
    """Places of the clamp in classes, the best first: over material that reaches down before such as hang.

    Parameters
    ----------
    classes : places of each class, which hold those of the classes before.
    """

    classes: tuple[ClampPlaces, ...]

    def allows(self, points: Array) -> NDArray[np.bool_]:
        """Whether a tip may stand at points (N, 2)."""
        return self.classes[-1].allows(points)

    def class_of(self, points: Array) -> Array:
        """Of which class places (N, 2) are, from 0."""
        found = np.full(len(points), float(len(self.classes) - 1))
        for number in reversed(range(len(self.classes) - 1)):
            found[self.classes[number].allows(points)] = number
        return found

    @property
    def is_empty(self) -> bool:
        """Whether the tip may stand nowhere."""
        return self.classes[-1].is_empty

    @property
    def candidate_count(self) -> int:
        """How many places on borders can be best inside one triangle, in all classes."""
        return sum(one.candidate_count for one in self.classes)

    def hangs(self, points: Array) -> NDArray[np.bool_]:
        """Whether the material under places (N, 2) does not reach down to where the part lies."""
        last = len(self.classes) - 1
        return np.asarray((self.class_of(points) == last) & (last > 0))

    def best(self, triangles: Triangles, reach: Array, inside: float) -> tuple[Array, Array, Array]:
        """The best points (N, 2) of the first class that has one, the values there, and the classes.

        Parameters
        ----------
        reach, inside : as of :meth:`ClampPlaces.best`.
        """
        count = len(reach)
        points, values = np.full((count, 2), np.nan), np.full(count, np.inf)
        classes, open_ = np.zeros(count), np.arange(count)
        for number, places in enumerate(self.classes):
            classes[open_] = number
            points[open_], values[open_] = places.best(triangles.take(open_), reach[open_], inside)
            open_ = open_[~np.isfinite(values[open_])]
            if not len(open_):
                break
        return points, values, classes


def apart(curve: Array, points: Array, round_: bool) -> Array:
    """Distances (N,) of points (N, 2) from a line or a circle (3,)."""
    if round_:
        return np.asarray(np.abs(np.hypot(*(points - curve[:2]).T) - curve[2]))
    return np.asarray(np.abs(points @ curve[:2] - curve[2]))


def places_on(curves: Array, points: Array, round_: bool) -> Array:
    """Where points (..., 2) lie along lines, in mm, or around circles (..., 3), in radians."""
    x, y = points[..., 0], points[..., 1]
    if round_:
        return np.arctan2(y - curves[..., 1], x - curves[..., 0])
    return np.asarray(curves[..., 0] * y - curves[..., 1] * x)


def find_point_on_curve(curve: Array, place: float, round_: bool) -> Array:
    """The point (2,) of a line or circle (3,) at a place."""
    if round_:
        return np.asarray(curve[:2] + curve[2] * np.array([np.cos(place), np.sin(place)]))
    return np.asarray(curve[2] * curve[:2] + place * np.array([-curve[1], curve[0]]))


def normalised(slope: Array, distance: Array) -> Array:
    """Lines (N, 3) as unit normals and distances; NaN where there is none."""
    size = np.hypot(slope[:, 0], slope[:, 1])
    size = np.where(size > 0.0, size, np.nan)
    return np.column_stack([slope / size[:, None], distance / size])


def find_line_crossings(a: Array, b: Array) -> Array:
    """Crossings (..., 2) of lines (..., 3), NaN of parallel ones."""
    with np.errstate(invalid="ignore", divide="ignore"):
        det = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        det = np.where(np.abs(det) > 1e-12, det, np.nan)
        x = (a[..., 2] * b[..., 1] - b[..., 2] * a[..., 1]) / det
        y = (a[..., 0] * b[..., 2] - b[..., 0] * a[..., 2]) / det
    return np.stack([x, y], axis=-1)


def find_crossings_with_lines(lines: Array, others: Array, circles: Array) -> Array:
    """Where lines (N, L, 3) cross other lines (M, 3) and circles (K, 3), as (N, L, M + 2 K, 2)."""
    straight = find_line_crossings(lines[:, :, None], others[None, None])
    normal, distance = lines[:, :, None, :2], lines[:, :, None, 2]
    off = (normal * circles[:, :2]).sum(axis=-1) - distance
    inner = circles[:, 2] ** 2 - off**2
    with np.errstate(invalid="ignore"):
        # A line that just touches, to within rounding, touches.
        half = np.sqrt(np.where(inner > -1e-9, np.maximum(inner, 0.0), np.nan))
    foot = circles[:, :2] - off[..., None] * normal
    along = np.stack([-normal[..., 1], normal[..., 0]], axis=-1) * half[..., None]
    return np.concatenate([straight, foot + along, foot - along], axis=2)


def find_circle_pair_crossings(a: Array, b: Array) -> Array:
    """Where circles (N, 3) cross others, pair by pair, as (2 N, 2); NaN where they do not."""
    apart = b[:, :2] - a[:, :2]
    distance = np.hypot(apart[:, 0], apart[:, 1])
    safe = np.where(distance > 1e-12, distance, np.nan)
    along = (safe**2 + a[:, 2] ** 2 - b[:, 2] ** 2) / (2 * safe)
    inner = a[:, 2] ** 2 - along**2
    with np.errstate(invalid="ignore"):
        half = np.sqrt(np.where(inner > -1e-9, np.maximum(inner, 0.0), np.nan))
    unit = apart / safe[:, None]
    across = np.stack([-unit[:, 1], unit[:, 0]], axis=1)
    foot = a[:, :2] + along[:, None] * unit
    return np.concatenate([foot + half[:, None] * across, foot - half[:, None] * across])
