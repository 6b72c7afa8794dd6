"""The best place of the clamp: the point t that minimizes the largest r_j / beta_j(t).

Here r_j is the force that the clamp must put on support j, beta_j(t) is the share of the clamp force C that
support j takes with the clamp at t (barycentric coordinates), b_j is the gradient of beta_j, and s_j is the
place of support j. The points with C beta_j(t) >= r_j form a triangle similar to that of the supports. It
shrinks to t* = sum r_j s_j / sum r_j as C falls to C* = sum r_j (over r_j > 0). So t* is best if the clamp
may stand there. Otherwise the best point is on the border of the allowed places: where two of the r_j /
beta_j are equal, at a corner, or where b_j is normal to an arc of the border. With r_j = |b_j| the value is
the inverse of the distance to the nearest side of the triangle. Then the same search finds the best tipping
arm, and t* is the incentre.
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
# Number of best candidates that are first tested against the face; it doubles each time.
AT_FIRST = 6
# mm. A corner this near to a curve counts as on it, and a point this near to a piece's end as on the piece.
# Points accepted in excess do no harm.
ON_CURVE, ON_PIECE = 1e-5, 1e-3
# The span of a whole circle.
TURN = np.array([0.0, 2 * np.pi])
# Number of candidates of several triangles that are examined together.
CANDIDATES = 1 << 18


@define(frozen=True, eq=False)
class ClampPlaces:
    """The places where a clamp's tip may stand on the top of a part, bordered by lines and circles.

    Parameters
    ----------
    face : the top, with its keep-out zones.
    tip_radius : radius of the tip in mm.
    rings : (R, 4) rings that the clamp can reach: centre x and y, least and largest radius, in the part's
        coordinates in mm; None for no limit.
    tip_margin : least distance in mm of the tip from the border of its face.
    kept_off : regions by height of the face, each with the least distance in mm of the tip's centre from the
        regions.
    """

    face: TouchableFace
    tip_radius: float
    rings: Array | None
    tip_margin: float = 0.0
    kept_off: tuple[tuple[LevelRegions, float], ...] = ()
    straight: CurvePieces = field(init=False)
    bent: CurvePieces = field(init=False)
    corners: Array = field(init=False)

    def __attrs_post_init__(self) -> None:
        levels = dict.fromkeys(self.face.levels) or [None]
        straight, bent, corners = zip(*map(self.list_borders, levels), strict=True)
        object.__setattr__(self, "straight", CurvePieces.concatenate(straight))
        object.__setattr__(self, "bent", CurvePieces.concatenate(bent))
        object.__setattr__(self, "corners", np.unique(np.concatenate(corners), axis=0))

    def list_borders(self, level: float | None) -> tuple[CurvePieces, CurvePieces, Array]:
        """Return (pieces of lines, pieces of circles, corners (K, 2)) of the border of the places.

        They are those on faces of one height, ``level`` in mm.
        """
        lines: list[Curve] = []
        circles: list[Curve] = []
        for number, loop in enumerate(self.face.borders.loops):
            face = self.face.find_face(number)
            if face is None or self.face.levels[face] == level:
                radius = self.tip_radius + (0.0 if face is None else self.tip_margin)
                straight, bent = offset_curves(loop, radius, self.face.is_on_left(number))
                lines, circles = lines + straight, circles + bent
        for regions, away in self.kept_off:
            for straight, bent in regions.iterate_offset_curves(level, away):
                lines, circles = lines + straight, circles + bent
        for x, y, low, high in () if self.rings is None else self.rings.tolist():
            circles += [(x, y, low), (x, y, high)]
        own = [np.unique(np.array(one).reshape(-1, 3), axis=0) for one in (lines, circles)]
        corners = self.find_border_corners(own[0], own[1])
        return (
            self.find_free_pieces(own[0], corners, False),
            self.find_free_pieces(own[1], corners, True),
            corners,
        )

    def find_free_pieces(self, curves: Array, corners: Array, round_: bool) -> CurvePieces:
        """Return the pieces of curves on which the tip may stand.

        ``curves`` (N, 3) are lines or, with ``round_``, circles. They are cut at the corners (K, 2), and the
        middle of each piece decides.
        """
        kept, spans = list[int](), list[tuple[float, float]]()
        middles, owners = list[Array](), list[tuple[int, float, float]]()
        for number, curve in enumerate(curves):
            places = np.sort(
                compute_parameters(
                    curve, corners[measure_distances(curve, corners, round_) <= ON_CURVE], round_
                )
            )
            if round_:
                places = np.append(places, places[:1] + 2 * np.pi) if len(places) else TURN
            for low, high in pairwise(places.tolist()):
                middles.append(find_point_on_curve(curve, (low + high) / 2, round_))
                owners.append((number, low, high))
        free = self.find_allowed(np.array(middles).reshape(-1, 2))
        for (number, low, high), may in zip(owners, free.tolist(), strict=True):
            if may and kept and kept[-1] == number and spans[-1][1] == low:
                spans[-1] = (spans[-1][0], high)
            elif may:
                kept.append(number)
                spans.append((low, high))
        return CurvePieces(curves[kept].reshape(-1, 3), np.array(spans).reshape(-1, 2))

    def compute_slack(self, points: Array) -> Array:
        """Return the slack in mm of the rules for a tip at points (N,
        2), (N,); negative where a rule is broken.

        The rules are the distances from the border of the face and from ``kept_off``, and the reach; keep-out
        zones are not tested.
        """
        on, _ = self.face.own.measure_rooms(points)
        on = on - self.tip_radius - self.tip_margin
        for regions, away in self.kept_off:
            for level in dict.fromkeys(self.face.levels):
                own = np.array([one == level for one in self.face.levels])
                on[:, own] = np.minimum(
                    on[:, own], (regions.measure_distances(level, points) - away)[:, None]
                )
        room = on.max(axis=1, initial=-np.inf)
        if self.rings is not None:
            apart = np.hypot(*np.moveaxis(points[:, None] - self.rings[None, :, :2], -1, 0))
            ring = np.minimum(apart - self.rings[:, 2], self.rings[:, 3] - apart).max(axis=1, initial=-np.inf)
            room = np.minimum(room, ring)
        return np.asarray(room)

    def find_allowed(self, points: Array) -> NDArray[np.bool_]:
        """Return a mask (N,): True for points (N, 2) at which a tip may stand."""
        found = self.face.find_off_zones(points, self.tip_radius, GAP_SLACK)
        found[found] = self.compute_slack(points[found]) >= -GAP_SLACK
        return found

    @cached_property
    def is_empty(self) -> bool:
        """Whether the tip may stand nowhere."""
        if not self.face.faces:
            return True
        low, high = self.face.box
        # Two triangles that cover the box, with sides far from all its points.
        wide = float((high - low).max()) + 10.0
        corners = np.array(
            [low - wide, (high[0] + wide, low[1] - wide), high + wide, (low[0] - wide, high[1] + wide)]
        )
        halves = Triangles.from_corners(np.array([corners[[0, 1, 2]], corners[[0, 2, 3]]]))
        return not np.isfinite(self.find_best(halves, halves.steepness, 0.0)[1]).any()

    @property
    def candidate_count(self) -> int:
        """Number of candidate points for one triangle, see :meth:`list_candidates`."""
        return 6 * len(self.straight) + 14 * len(self.bent) + len(self.corners) + 15

    def find_border_corners(self, lines: Array, circles: Array) -> Array:
        """Return the allowed points (K, 2) at which two of the curves cross."""
        points = [find_crossings_with_lines(lines[None], lines, circles).reshape(-1, 2)]
        first, second = np.triu_indices(len(circles), 1)
        points.append(find_circle_pair_crossings(circles[first], circles[second]))
        every = np.concatenate(points)
        every = every[np.isfinite(every).all(axis=1)]
        every = every[self.find_allowed(every)] if len(every) else every
        return np.unique(np.round(every, 12), axis=0)

    def find_best(self, triangles: Triangles, reach: Array, inside: float) -> tuple[Array, Array]:
        """Return, for each triangle, (1) the allowed point with the least
        max_j reach_j / beta_j, (N, 2); (2) that value.

        The beta_j are the barycentric coordinates of the point. NaN and inf where no point is allowed.

        Parameters
        ----------
        reach : (N, 3) r_j, at least one positive in each row.
        inside : smallest distance of the point from a side of the triangle, in mm.
        """
        asked = np.maximum(reach, 0.0)
        total = asked.sum(axis=1)
        points = (asked[..., None] * triangles.corners).sum(axis=1) / total[:, None]
        good = triangles.measure_side_distances(points).min(axis=1) >= inside - GAP_SLACK
        good[good] = self.find_allowed(points[good])
        value = total.copy()
        rest = np.flatnonzero(~good)
        step = max(1, CANDIDATES // self.candidate_count)
        for first in range(0, len(rest), step):
            some = rest[first : first + step]
            points[some], value[some] = self.find_best_on_border(triangles.take(some), asked[some], inside)
        return points, value

    def find_best_on_border(self, triangles: Triangles, asked: Array, inside: float) -> tuple[Array, Array]:
        """Return the best of the points of :meth:`list_candidates`, in the form of :meth:`find_best`.

        ``asked`` is ``reach`` of :meth:`find_best` with negative entries set to 0.
        """
        candidates = self.list_candidates(triangles, asked, inside)
        count = len(candidates)
        of, which = np.nonzero(np.isfinite(candidates[..., 0]))
        points = candidates[of, which]
        # One column after the other, as numpy is ten times as slow along a short axis.
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
            hits = now[self.find_allowed(points[now])]
            found, place = np.unique(of[hits], return_index=True)
            out[found], least[found] = points[hits[place]], value[hits[place]]
            first, step = first + step, 2 * step
            rest = rest[(before[rest] >= first) & np.isinf(least[of[rest]])]
        return out, least

    def list_candidates(self, triangles: Triangles, asked: Array, inside: float) -> Array:
        """Return all points that can be best on the border of the places,
        (N, K, 2); NaN where two curves do not meet.
        """
        count = len(triangles.slopes)
        lines = []
        for j, k in combinations(range(3), 2):
            # r_j beta_k = r_k beta_j
            slope = asked[:, j, None] * triangles.slopes[:, k] - asked[:, k, None] * triangles.slopes[:, j]
            constant = asked[:, j] * triangles.constants[:, k] - asked[:, k] * triangles.constants[:, j]
            lines.append(normalize_lines(slope, -constant))
        for j in range(3):
            steep = triangles.steepness[:, j]
            lines.append(normalize_lines(triangles.slopes[:, j], inside * steep - triangles.constants[:, j]))
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
            self.straight.mask_points_off_pieces(met[:, :, :first_circle], False),
            *(self.bent.mask_points_off_pieces(one, True) for one in on_circles),
            find_line_crossings(every[:, first], every[:, second]),
            np.broadcast_to(self.corners, (count, len(self.corners), 2)),
        ]
        return np.concatenate([one.reshape(count, -1, 2) for one in out], axis=1)


@define(frozen=True, eq=False)
class CurvePieces:
    """Pieces of lines, or pieces of circles.

    Parameters
    ----------
    curves : (P, 3) unit normal (x, y) and distance from the origin of a line, or centre (x, y) and radius of
        a circle, in mm.
    spans : (P, 2) begin and end of the piece, along the line in mm, or as angles in radians.
    """

    curves: Array
    spans: Array

    def __len__(self) -> int:
        return len(self.curves)

    @classmethod
    def concatenate(cls, parts: Sequence[CurvePieces]) -> CurvePieces:
        """Return the pieces of several objects in order, as one object."""
        return cls(
            np.concatenate([one.curves for one in parts]), np.concatenate([one.spans for one in parts])
        )

    def mask_points_off_pieces(self, points: Array, round_: bool) -> Array:
        """Return points (..., P, 2) with NaN for those off their piece.

        Point (..., p) must lie on the curve of piece p. ``round_`` tells whether the curves are circles.
        """
        low, high = self.spans.T
        along = compute_parameters(self.curves, points, round_)
        if round_:
            slack = ON_PIECE / self.curves[:, 2]
            on = (along - low + slack) % (2 * np.pi) <= high - low + 2 * slack
        else:
            on = (along >= low - ON_PIECE) & (along <= high + ON_PIECE)
        return np.where(on[..., None], points, np.nan)


@define(frozen=True, eq=False)
class RankedPlaces:
    """Places of the clamp in classes, best first.

    The first classes are places over material that reaches down to the plate; the last one also has places
    over overhangs.

    Parameters
    ----------
    classes : places of each class; each class contains the previous one.
    """

    classes: tuple[ClampPlaces, ...]

    def find_allowed(self, points: Array) -> NDArray[np.bool_]:
        """Return a mask (N,): True for points (N, 2) at which a tip may stand, in any class."""
        return self.classes[-1].find_allowed(points)

    def find_classes(self, points: Array) -> Array:
        """Return the class of each point (N, 2), (N,), counted from 0.

        A point where the tip may not stand is put into the last class.
        """
        found = np.full(len(points), float(len(self.classes) - 1))
        for number in reversed(range(len(self.classes) - 1)):
            found[self.classes[number].find_allowed(points)] = number
        return found

    @property
    def is_empty(self) -> bool:
        """Whether the tip may stand nowhere."""
        return self.classes[-1].is_empty

    @property
    def candidate_count(self) -> int:
        """Number of candidate points for one triangle, summed over all classes."""
        return sum(one.candidate_count for one in self.classes)

    def find_hanging(self, points: Array) -> NDArray[np.bool_]:
        """Return a mask (N,): True for points (N, 2) of the last class, over an overhang.

        All False where there is only one class.
        """
        last = len(self.classes) - 1
        return np.asarray((self.find_classes(points) == last) & (last > 0))

    def find_best(self, triangles: Triangles, reach: Array, inside: float) -> tuple[Array, Array, Array]:
        """Return (1) the best points (N, 2) in the first class that has one,
        (2) their values (N,), (3) the classes (N,).

        Points are NaN and values inf where no class has an allowed point.

        Parameters
        ----------
        reach, inside : see :meth:`ClampPlaces.find_best`.
        """
        count = len(reach)
        points, values = np.full((count, 2), np.nan), np.full(count, np.inf)
        classes, open_ = np.zeros(count), np.arange(count)
        for number, places in enumerate(self.classes):
            classes[open_] = number
            points[open_], values[open_] = places.find_best(triangles.take(open_), reach[open_], inside)
            open_ = open_[~np.isfinite(values[open_])]
            if not len(open_):
                break
        return points, values, classes


def measure_distances(curve: Array, points: Array, round_: bool) -> Array:
    """Return distances (N,) in mm of points (N, 2) from a line or, with ``round_``, a circle (3,)."""
    if round_:
        return np.asarray(np.abs(np.hypot(*(points - curve[:2]).T) - curve[2]))
    return np.asarray(np.abs(points @ curve[:2] - curve[2]))


def compute_parameters(curves: Array, points: Array, round_: bool) -> Array:
    """Return the positions of points (..., 2) along their curves (..., 3), as (...).

    They are in mm on lines. On circles, with ``round_``, they are angles in radians.
    """
    x, y = points[..., 0], points[..., 1]
    if round_:
        return np.arctan2(y - curves[..., 1], x - curves[..., 0])
    return np.asarray(curves[..., 0] * y - curves[..., 1] * x)


def find_point_on_curve(curve: Array, place: float, round_: bool) -> Array:
    """Return the point (2,) at a position of a line or circle (3,),
    the inverse of :func:`compute_parameters`.
    """
    if round_:
        return np.asarray(curve[:2] + curve[2] * np.array([np.cos(place), np.sin(place)]))
    return np.asarray(curve[2] * curve[:2] + place * np.array([-curve[1], curve[0]]))


def normalize_lines(slope: Array, distance: Array) -> Array:
    """Return lines slope . q = distance as rows (N, 3) of unit normal
    and distance; NaN where the slope is zero.
    """
    size = np.hypot(slope[:, 0], slope[:, 1])
    size = np.where(size > 0.0, size, np.nan)
    return np.column_stack([slope / size[:, None], distance / size])


def find_line_crossings(a: Array, b: Array) -> Array:
    """Return the crossings (..., 2) of lines (..., 3); NaN for parallel ones."""
    with np.errstate(invalid="ignore", divide="ignore"):
        det = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        det = np.where(np.abs(det) > 1e-12, det, np.nan)
        x = (a[..., 2] * b[..., 1] - b[..., 2] * a[..., 1]) / det
        y = (a[..., 0] * b[..., 2] - b[..., 0] * a[..., 2]) / det
    return np.stack([x, y], axis=-1)


def find_crossings_with_lines(lines: Array, others: Array, circles: Array) -> Array:
    """Return the crossings of lines (N, L, 3) with M other lines and K
    circles, (N, L, M + 2 K, 2); NaN where none.

    ``others`` is (M, 3), ``circles`` (K, 3). The crossings with the other lines come first, then the first
    crossing with each circle, then the second one.
    """
    straight = find_line_crossings(lines[:, :, None], others[None, None])
    normal, distance = lines[:, :, None, :2], lines[:, :, None, 2]
    off = (normal * circles[:, :2]).sum(axis=-1) - distance
    inner = circles[:, 2] ** 2 - off**2
    with np.errstate(invalid="ignore"):
        # A line that misses a circle by rounding only touches it.
        half = np.sqrt(np.where(inner > -1e-9, np.maximum(inner, 0.0), np.nan))
    foot = circles[:, :2] - off[..., None] * normal
    along = np.stack([-normal[..., 1], normal[..., 0]], axis=-1) * half[..., None]
    return np.concatenate([straight, foot + along, foot - along], axis=2)


def find_circle_pair_crossings(a: Array, b: Array) -> Array:
    """Return the crossings (2 N, 2) of circles (N, 3) pair by pair; NaN where they do not meet.

    Both crossings of pair k are in rows k and N + k.
    """
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
