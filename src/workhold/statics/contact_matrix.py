"""Normals, wrenches and inverse contact matrices of sets of fixtures, from holes, poses and faces alone.

Glossary
--------
contact matrix : see ``kernels.contact.contact_matrix``; its inverse turns errors into movements and loads
    into peg forces.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from typing import Any

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.features import ContactFeature, list_features_met, make_feature_rows, measure_end_slacks
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Line, make_segment_rows
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    FEATURE_LENGTH,
    IS_ARC,
    RADIUS,
    SEGMENT_LENGTH,
    SIGN,
    X,
    Y,
)
from workhold.kernels.contact.contact_matrix import write_contact_matrices
from workhold.model.clamps import LOCATORS, compute_working_forces
from workhold.model.fixture import Fixture
from workhold.model.own_outlines import measure_outline_diameter
from workhold.model.pose import FlushContacts
from workhold.model.workpiece import Workpiece
from workhold.rowwise import find_largest

__all__ = [
    "ContactMatrices",
    "TouchableFeatures",
    "compute_outward_normals",
    "compute_wrench_length",
    "compute_wrenches",
]

Array = NDArray[np.float64]


def compute_outward_normals(rows: Array, points: Array) -> Array:
    """Return the part's outward unit normals at peg centres on features.

    Parameters
    ----------
    rows : (..., 10) feature rows, see ``geometry.segment.make_segment_rows``.
    points : (..., 2) peg centres in mm, each on the feature of its row.

    Returns
    -------
    (..., 2) array
    """
    is_arc, radius, sign = (rows[..., k, None] for k in (IS_ARC, RADIUS, SIGN))
    radial = sign * (points - rows[..., X : Y + 1]) / np.where(radius == 0.0, 1.0, radius)
    straight = np.stack([rows[..., AXIS_Y], -rows[..., AXIS_X]], axis=-1)
    return np.where(is_arc == 0.0, straight, radial)


def compute_wrenches(points: Array, normals: Array, length: float) -> Array:
    """Return wrenches (..., 3) of unit contact forces: x and y of the
    normal, and its moment divided by the length L.

    Parameters
    ----------
    points : (..., 2) peg centres relative to the centre of the part, in mm.
    normals : (..., 2) outward unit normals there.
    length : L in mm.
    """
    moments = (points[..., 0] * normals[..., 1] - points[..., 1] * normals[..., 0]) / length
    return np.concatenate([normals, moments[..., None]], axis=-1)


# Pegs of a fixture whose contact matrix has one inverse; with two clamps there is one more.
PEGS = 4


@define(frozen=True, eq=False)
class ContactMatrices:
    """Contacts of N fixtures in the part's frame; lengths in mm.

    Parameters
    ----------
    points : (N, P, 2) peg centres relative to the centre of the part.
    normals : (N, P, 2) outward unit normals.
    ends : (N, P) distances along the contact features to their nearer ends.
    edges : (N, P) distances along the contact features to the nearest ends that are not tangent joints; inf
        where there is none.
    inverses : (N, 4, P) inverses of the contact matrices, NaN where singular. The first three rows are the
        part's movements in x, in y, and L times its turn, per unit of error of each contact. The last row is
        the pegs' forces per unit of jaw force. With two clamps (P = 5) only the locators move the part, and
        the last row is for the working ratio of the clamps' forces.
    closing : (N, P, M) forces of all pegs per unit of the force of each of M moving carriers.
    """

    points: Array
    normals: Array
    ends: Array
    edges: Array
    inverses: Array
    closing: Array


def compute_wrench_length(workpiece: Workpiece, toolkit: Toolkit) -> float:
    """Return the length L in mm that moments are divided by: half the
    part's diameter plus the largest peg radius.
    """
    return measure_outline_diameter(workpiece) / 2 + max(carrier.peg_radius for carrier in toolkit.carriers)


@define(frozen=True, eq=False)
class TouchableFeatures:
    """The features of a workpiece that pegs of a toolkit can touch.

    Lengths are in mm, relative to the centre of the part.

    Parameters
    ----------
    center : (2,) centre of the part's bounding box, in the part's coordinates.
    length : length L that moments are divided by.
    features : (F, 12) rows of the contact features with slacks of their ends, carrier by carrier, by face in
        each; then the hull edges, for a wall.
    starts : indices in ``features``: where the features of each carrier and face number begin (carrier by
        carrier, by face number in each), where each hull edge begins, and the end.
    segments : number of face numbers.
    moving : (C,) 1 for a moving carrier, 0 for others.
    directions : (C, 2) unit vector along which each carrier clamps, in the toolkit's frame; zero for a fixed
        one.
    lies_flush : (C,) whether the carrier is a wall that the part lies flush on.
    flush : the ways in which the part can lie on a wall.
    """

    center: Array
    length: float
    features: Array
    starts: NDArray[np.int64]
    segments: int
    moving: Array
    directions: Array
    lies_flush: NDArray[np.bool_]
    flush: FlushContacts

    @classmethod
    def from_workpiece(
        cls,
        workpiece: Workpiece,
        toolkit: Toolkit,
        loci: Sequence[Sequence[ContactFeature]] | None = None,
        length: float | None = None,
    ) -> TouchableFeatures:
        """Return the contact features of a workpiece for a toolkit's pegs.

        Parameters
        ----------
        loci : contact features for each carrier with pegs, in order; None to compute them.
        length : L in mm; None to compute it.
        """
        carriers, segments = toolkit.carriers, len(workpiece.numbered.segments)
        if loci is None:
            placed = [one for one in carriers if one.contact.is_placed]
            loci = [list_features_met(workpiece, one) for one in placed]
        lies_flush = np.array([not one.contact.is_placed for one in carriers])
        flush = workpiece.flush if lies_flush.any() else FlushContacts.from_hull_edges((), ())
        before = iter(loci)
        loci = [() if wall else next(before) for wall in lies_flush]
        features = [feature for locus in loci for feature in locus]
        center = np.array(workpiece.center)
        walls = [Line((a, b), (x, y)) for (a, b), (x, y) in flush.ends.tolist()]
        # A copy of one row more, because the kernel looks at row 0 even where a face has no feature.
        rows = np.zeros((len(features) + len(walls) + 1, FEATURE_LENGTH))
        # Slacks of ends are computed for each carrier by itself, since where another's pegs may stand says
        # nothing of a joint; many carriers touch the same features.
        different = {id(locus): list(locus) for locus in loci}
        known = {
            key: np.hstack([make_feature_rows(locus), measure_end_slacks(locus)])
            for key, locus in different.items()
        }
        rows[: len(features)] = np.concatenate([known[id(locus)] for locus in loci])
        rows[len(features) : -1, :SEGMENT_LENGTH] = make_segment_rows(walls)
        rows[:, [X, Y]] -= center
        faces = [number * segments + feature.face for number, locus in enumerate(loci) for feature in locus]
        return cls(
            center=center,
            length=compute_wrench_length(workpiece, toolkit) if length is None else length,
            features=rows,
            starts=np.concatenate(
                [
                    np.searchsorted(faces, np.arange(len(loci) * segments)),
                    np.arange(len(walls) + 1) + len(features),
                ]
            ).astype(np.int64),
            segments=segments,
            moving=np.array([carrier.travel is not None for carrier in carriers], np.float64),
            directions=np.array(
                [(0.0, 0.0) if c.travel is None else c.travel.unit for c in carriers], np.float64
            )
            * -toolkit.clamping,
            lies_flush=lies_flush,
            flush=flush,
        )

    def compute_contact_matrices(
        self, pegs: Array, pose: Array, carriers: NDArray[np.integer[Any]], faces: NDArray[np.int64]
    ) -> ContactMatrices:
        """Return the contact matrices of N fixtures.

        Parameters
        ----------
        pegs : (N, P, 2) peg centres in the toolkit's frame, in mm; P is 3 under straps, 4, or 5 with two
            clamps.
        pose : (N, 3) orientation of the part in radians, and its translation in mm (x, y).
        carriers, faces : (N, P) numbers of the pegs' carriers and of the faces touched.
        """
        on = np.asarray(carriers, np.int64)
        on_wall = self.lies_flush.take(on)
        edge = len(self.starts) - 1 - len(self.flush.theta) + self.flush.find_nearest_edges(pose[:, 0])
        touched = np.where(on_wall, edge[:, None], faces + self.segments * on)
        moves = self.moving.take(on)
        # Each fixture has an axis of its own where a toolkit has several carriers that move.
        mover = find_largest(on * (moves > 0.0))
        known = self.compute_contacts(pegs, pose, moves, -self.directions[mover], touched)
        points, normals, ends, edges, inverses = known
        # The ends of a contact with a wall have no distance to an end or edge that matters.
        for distances in (ends, edges):
            distances[on_wall & ~np.isnan(distances)] = np.inf
        if pegs.shape[1] == PEGS:
            return ContactMatrices(points, normals, ends, edges, inverses, inverses[:, 3, :, None])
        if pegs.shape[1] == LOCATORS:
            # Under straps nothing moves.
            inverses[:, :LOCATORS] = invert_locator_matrices(compute_wrenches(points, normals, self.length))
            return ContactMatrices(points, normals, ends, edges, inverses, np.zeros((*pegs.shape[:2], 0)))
        closing = pair_reactions(points, normals, self.compute_push_directions(pose, carriers), self.length)
        inverses[:, :LOCATORS, :LOCATORS] += invert_locator_matrices(
            compute_wrenches(points, normals, self.length)
        )
        inverses[:, 3] += compute_working_forces(closing)
        return ContactMatrices(points, normals, ends, edges, inverses, closing)

    def compute_contacts(
        self, pegs: Array, pose: Array, moves: Array, against: Array, touched: NDArray[np.int64]
    ) -> tuple[Array, Array, Array, Array, Array]:
        """Return (points, normals, ends, edges, inverses) of N fixtures, see :class:`ContactMatrices`.

        ``pegs`` and ``pose`` are as in :meth:`compute_contact_matrices`.

        Parameters
        ----------
        moves : (N, P) 1 for pegs that move, 0 for others.
        against : (N, 2) unit vector opposite to the clamping direction, in the toolkit's frame.
        touched : (N, P) index in ``starts`` of the face or hull edge touched.
        """
        count, each = pegs.shape[:2]
        points, normals, ends, edges = (np.empty((count, each, *shape)) for shape in ((2,), (2,), (), ()))
        inverses = np.zeros((count, 4, each))
        # A kernel is compiled anew for arrays that are read-only or laid out otherwise.
        write_contact_matrices(
            np.require(pegs, np.float64, ["C", "W"]),
            np.require(pose, np.float64, ["C", "W"]),
            moves,
            against,
            np.require(touched, np.int64, ["C", "W"]),
            self.features,
            self.starts,
            self.center,
            self.length,
            points,
            normals,
            ends,
            edges,
            inverses,
            np.empty((each, 4)),
        )
        return points, normals, ends, edges, inverses

    def compute_locators(self, points: Array, faces: NDArray[np.int64]) -> ContactMatrices:
        """Return the contacts of three locators alone, on the first carrier.

        ``inverses`` are those of the matrices of the locators' wrenches, (N, 3, 3); ``closing`` is empty.

        Parameters
        ----------
        points : (N, 3, 2) peg centres in the part's frame about its centre, in mm.
        faces : (N, 3) numbers of the faces touched.
        """
        count, each = points.shape[:2]
        still = np.zeros((count, 3)), np.zeros((count, each)), np.zeros((count, 2))
        _, normals, ends, edges, inverses = self.compute_contacts(points + self.center, *still, faces)
        inverses[:, :LOCATORS] = invert_locator_matrices(compute_wrenches(points, normals, self.length))
        return ContactMatrices(points, normals, ends, edges, inverses, np.zeros((count, each, 0)))

    def compute_push_directions(self, pose: Array, carriers: NDArray[np.integer[Any]]) -> Array:
        """Return the unit vectors along which the clamps of the last two
        contacts push, in the part's frame, (N, 2, 2).
        """
        along = self.directions[np.asarray(carriers)[:, -2:]]
        return np.stack(rotate_vectors(along[..., 0], along[..., 1], -pose[:, :1]), axis=-1)

    def compute_for_fixture(self, fixture: Fixture, toolkit: Toolkit) -> ContactMatrices:
        """Return the contact matrices of one fixture (N = 1)."""
        pose = fixture.pose
        return self.compute_contact_matrices(
            np.array([[(peg.x, peg.y) for peg in fixture.pegs]]),
            np.array([[radians(pose.theta_deg), pose.x, pose.y]]),
            np.array([toolkit.find_carrier_numbers(peg.carrier for peg in fixture.pegs)]),
            np.array([[peg.face for peg in fixture.pegs]]),
        )


def invert_locator_matrices(all_wrenches: Array) -> Array:
    """Return the inverses of the matrices whose rows are the first
    three wrenches, (N, 3, 3); NaN where singular.
    """
    matrix = all_wrenches[:, :LOCATORS]
    usable = np.isfinite(matrix).all(axis=(1, 2)) & (np.abs(np.linalg.det(matrix)) > 0.0)
    inverse = np.full(matrix.shape, np.nan)
    inverse[usable] = np.linalg.inv(matrix[usable])
    return inverse


def pair_reactions(points: Array, normals: Array, pushes: Array, length: float) -> Array:
    """Return the forces of three locators and two clamps per unit of the force of each clamp, (N, 5, 2).

    Parameters
    ----------
    points : (N, 5, 2) contact points relative to the centre of the part, in mm; locators first.
    normals : (N, 5, 2) outward unit normals there.
    pushes : (N, 2, 2) unit vectors along which the clamps push, in the part's frame.
    length : L in mm.
    """
    each = compute_wrenches(points, normals, length)
    push = -(normals[:, LOCATORS:] * pushes).sum(axis=-1)
    taken = -np.einsum("nij,nki->njk", invert_locator_matrices(each), each[:, LOCATORS:])
    out = np.zeros((len(points), 5, 2))
    out[:, :LOCATORS] = taken / push[:, None]
    out[:, LOCATORS, 0], out[:, LOCATORS + 1, 1] = 1.0 / push[:, 0], 1.0 / push[:, 1]
    return out
