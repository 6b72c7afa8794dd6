"""The effective location error: the location error times factors for drawbacks that a machinist would avoid.

The factors are data (``FACTORS``); this module determines which of them apply to a fixture.

Glossary
--------
angle class : 0 for a part at 0 degrees, 1 at 90, 180 and 270 degrees, 2 at any other angle. The angle is
    taken as it is written, rounded.
asked for : holding from inside, in holes of the part, is asked for if the query avoids every outer face or
    the toolkit clamps by opening.
hangs over : a part hangs over the plates along a direction if no shift of the set-up by whole holes, with all
    pegs on the plates, brings it within the plates. This needs a known number of columns or rows. Plates
    reach half a pitch beyond their outermost holes.
"""

from __future__ import annotations

from math import cos, pi

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import AGREEMENT, FIGURE_DECIMALS, WRITTEN_ANGLE
from workhold.fixels.contacts import CLAMP_TIP
from workhold.geometry.hull import compute_convex_hull
from workhold.geometry.segment import Arc, Line
from workhold.model.first_choice import FACTORS
from workhold.model.fixture_table import FixtureTable, compute_peg_places
from workhold.model.quality import LOCATION_ERROR
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece

__all__ = ["EffectiveErrors", "classify_angles", "find_unasked_faces", "measure_end_distances"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

KEYS = tuple(factor.key for factor in FACTORS)
TIMES = np.array([factor.times for factor in FACTORS])


def classify_angles(theta: Array, beside: float = WRITTEN_ANGLE) -> IntArray:
    """Return the class of each angle, (N,): 0 as drawn, 1 at another quarter turn, 2 elsewhere.

    Angles are in radians. An angle within ``beside`` degrees of a multiple of a quarter turn counts as that
    multiple.
    """
    turns = np.degrees(theta) / 90.0
    whole = np.rint(turns)
    there = np.abs(turns - whole) * 90.0 <= beside
    return np.where(there, (whole % 4 != 0).astype(np.int64), 2)


def find_unasked_faces(query: Query) -> BoolArray:
    """Return a mask (S,) by face number: True for faces of holes if the query does not ask to hold the part
    from inside.

    All are False if the toolkit clamps by opening, or if every outer face is avoided.
    """
    every = query.workpiece.numbered
    out = np.zeros(len(every.segments), np.bool_)
    outside = {face.number for face in every.faces} - every.inside - query.workpiece.untouchable
    if query.toolkit.clamping > 0 and not outside <= set(query.restrictions.avoid):
        out[sorted(every.inside)] = True
    return out


@frozen(eq=False)
class EffectiveErrors:
    """Computation of the factors on the location error, and of the effective errors, for the fixtures of a
    query.

    Parameters
    ----------
    query : the query.
    unasked : (S,) mask by face number of faces of holes that the query does not ask to use.
    lines : (S, 5) start (x, y), unit direction (x, y) and length of each straight face, by face number; NaN
        for other faces.
    corners : (C, 2) corners of the convex hull of the outline's joints.
    arcs : (A, 6) convex arcs of the outline: centre (x, y), radius, middle direction (x, y), and cosine of
        half the sweep.
    """

    query: Query
    unasked: BoolArray
    lines: Array
    corners: Array
    arcs: Array

    @classmethod
    def from_query(cls, query: Query) -> EffectiveErrors:
        """Prepare the computation for the fixtures of a query."""
        every = query.workpiece.numbered
        lines = np.full((len(every.segments), 5), np.nan)
        for face in every.faces:
            if isinstance(face.segment, Line):
                lines[face.number] = (*face.segment.start, *face.segment.tangent, face.segment.length)
        return cls(query, find_unasked_faces(query), lines, *find_outermost(query.workpiece))

    def compute_errors(self, table: FixtureTable) -> Array:
        """Return effective location errors (N,) in mm of a measured table."""
        factors = np.where(self.find_factors(table), TIMES, 1.0).prod(axis=1)
        return np.asarray(table.quality[:, LOCATION_ERROR] * factors)

    def find_factors(self, table: FixtureTable) -> BoolArray:
        """Return a mask (N, F): which of the F factors apply to each fixture, in the order of ``FACTORS``."""
        toolkit, angle = self.query.toolkit, classify_angles(table.theta)
        carriers = toolkit.find_peg_carriers(table.arrangement)
        is_clamp = np.array([one.contact is CLAMP_TIP for one in toolkit.carriers])[carriers]
        is_placed = np.array([one.contact.is_placed for one in toolkit.carriers])[carriers]
        inside = self.unasked[table.face] & is_placed
        found = {
            "quarter_turn": angle == 1,
            "other_angle": angle == 2,
            "face_end": (self.find_near_face_ends(table, carriers) & is_placed).any(axis=1),
            "clamp_in_hole": (inside & is_clamp).any(axis=1),
            "dowel_in_bore": (inside & ~is_clamp).any(axis=1),
            "hangs_over": self.find_overhanging(table),
        }
        return np.stack([found[key] for key in KEYS], axis=1)

    def find_near_face_ends(self, table: FixtureTable, carriers: NDArray[np.int8]) -> BoolArray:
        """Return a mask (N, P): True for contacts nearer than their
        peg's radius to an end of a straight face.

        ``carriers`` (N, P) are the numbers of the pegs' carriers.
        """
        radius = np.array([one.peg_radius for one in self.query.toolkit.carriers])[carriers]
        x, y = compute_peg_places(table, self.query.toolkit, self.query.workpiece)
        x, y = x - table.position[:, :1], y - table.position[:, 1:]
        cosine, sine = np.cos(table.theta)[:, None], np.sin(table.theta)[:, None]
        points = np.stack([cosine * x + sine * y, cosine * y - sine * x], axis=2)
        return np.asarray(
            measure_end_distances(points, self.lines[table.face]) < np.round(radius, FIGURE_DECIMALS)
        )

    def find_overhanging(self, table: FixtureTable) -> BoolArray:
        """Return a mask (N,): True for fixtures whose part hangs over the plates at every place of the
        set-up.
        """
        toolkit, out = self.query.toolkit, np.zeros(len(table), np.bool_)
        plates, travel = toolkit.plates, table.jaw_separation
        moved = travel if travel.ndim == 1 else np.zeros(len(table))
        for axis, counts in enumerate(([p.columns for p in plates], [p.rows for p in plates])):
            if any(count is None for count in counts) or not len(table):
                continue
            pitch = plates[0].pitch[axis]
            first = np.array(
                [plate.compute_hole_center(0, 0, moved)[axis] + np.zeros(len(table)) for plate in plates]
            )
            last = first + (np.array([count or 0 for count in counts])[:, None] - 1) * pitch
            low, high = first.min(axis=0) - pitch / 2, last.max(axis=0) + pitch / 2
            least, most = self.compute_extent(table, axis)
            back, ahead = self.count_spare_holes(table, axis)
            # Smallest and largest number of holes by which the set-up must be moved for the part to lie
            # within the plates.
            needed = np.ceil((low - least - AGREEMENT) / pitch)
            allowed = np.floor((high - most + AGREEMENT) / pitch)
            if axis == 1 and toolkit.wall is not None:
                # The part lies on the wall, so what is under its lower side does not matter.
                needed = np.full(len(table), -np.inf)
            out |= np.maximum(needed, -back) > np.minimum(allowed, ahead)
        return out

    def compute_extent(self, table: FixtureTable, axis: int) -> tuple[Array, Array]:
        """Return (least, largest) coordinate in mm of each fixture's part along an axis, (N,) each.

        ``axis`` is 0 for x and 1 for y of the toolkit.
        """
        # Direction of the axis in the part's frame.
        turn = (pi / 2) * axis - table.theta
        along = np.stack([np.cos(turn), np.sin(turn)], axis=1)
        low, high = (
            -compute_reach(-along, self.corners, self.arcs),
            compute_reach(along, self.corners, self.arcs),
        )
        return low + table.position[:, axis], high + table.position[:, axis]

    def count_spare_holes(self, table: FixtureTable, axis: int) -> tuple[Array, Array]:
        """Return the numbers of holes by which a set-up can be moved (toward lower numbers, toward higher
        numbers), (N,) each.

        ``axis`` is 0 for columns (x), 1 for rows (y).
        """
        toolkit, none = self.query.toolkit, np.zeros(len(table))
        slides = [plate for plate in toolkit.plates if plate.travel is not None]
        if any(plate.is_along_x == (axis == 0) for plate in slides) or (axis == 1 and toolkit.wall):
            return none, none
        carriers, holes = toolkit.find_peg_carriers(table.arrangement), (table.column, table.row)[axis]
        counted = np.array([one.counted_axes[axis] for one in toolkit.carriers])[carriers]
        ends = {plate.name: (plate.columns, plate.rows)[axis] or 0 for plate in toolkit.plates}
        last = np.array([ends.get(one.stands_on, 0) - 1 for one in toolkit.carriers])[carriers]
        back = np.where(counted, holes, np.iinfo(np.int32).max).min(axis=1)
        ahead = np.where(counted, last - holes, np.iinfo(np.int32).max).min(axis=1)
        return back.astype(np.float64), ahead.astype(np.float64)


def measure_end_distances(points: Array, lines: Array) -> Array:
    """Return the distance of each contact from the nearer end of its
    straight face, in mm to nine decimals, (...).

    Negative beyond an end; NaN for faces that are not straight.

    Parameters
    ----------
    points : (..., 2) centres of the pegs, in the part's coordinates.
    lines : (..., 5) row of the face that each peg touches, see :class:`EffectiveErrors`.
    """
    along = ((points - lines[..., :2]) * lines[..., 2:4]).sum(axis=-1)
    return np.asarray(np.round(np.minimum(along, lines[..., 4] - along), FIGURE_DECIMALS))


def find_outermost(workpiece: Workpiece) -> tuple[Array, Array]:
    """Return the corners (C, 2) and convex arcs (A, 6) of a part's outline, see :class:`EffectiveErrors`."""
    outer = [face.segment for face in workpiece.outer_faces]
    joints = [one.start for one in outer if not (isinstance(one, Arc) and one.is_full)]
    arcs = [
        (*one.to_row()[1:3], one.radius, *one.to_row()[3:5], cos(min(one.half_sweep, pi)))
        for one in outer
        if isinstance(one, Arc) and one.sign > 0
    ]
    return np.array(compute_convex_hull(joints)).reshape(-1, 2), np.array(arcs).reshape(-1, 6)


def compute_reach(along: Array, corners: Array, arcs: Array) -> Array:
    """Return the largest coordinate of a part along each of N directions, in mm, (N,).

    ``along`` (N, 2) are unit vectors; ``corners`` and ``arcs`` are as in :class:`EffectiveErrors`.
    """
    out = np.full(len(along), -np.inf)
    for x, y in corners.tolist():
        np.maximum(out, along[:, 0] * x + along[:, 1] * y, out=out)
    for x, y, radius, ahead, aside, cosine in arcs.tolist():
        there = along[:, 0] * ahead + along[:, 1] * aside >= cosine
        far = along[:, 0] * x + along[:, 1] * y + radius
        np.maximum(out, np.where(there, far, -np.inf), out=out)
    return out
