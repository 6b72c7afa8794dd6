"""What Coulomb friction could add to a fixture's hold.

Every contact may press within its friction cone, that is along -n + mu t and -n - mu t with forces x >= 0. The least jaw
force that allows a balance with a load g is the linear program

    minimize r . x   subject to   W x = -g,  x >= 0,

with r the share of each edge in pushing the carrier that moves. Its dual asks for the motion y of the part that does
the most work -g . y among those with W^T y <= r; these form a polytope, because the wrenches span the space, and its
few corners answer every load. Duality: V. Chvatal, *Linear Programming* (1983), chapter 5; the cones: V.-D. Nguyen,
*Constructing force-closure grasps*, International Journal of Robotics Research 7 (1988).
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import FLAT, OUTSIDE
from workhold.fixels.flat import standoff
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import ContactMatrices, Touched

__all__ = ["cone_edges", "contacts_on_part", "possible_motions"]

Array = NDArray[np.float64]


def contacts_on_part(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, touched: Touched, matrices: ContactMatrices
) -> tuple[Array, Array, Array, Array]:
    """Contacts, normals, what moves, and against which way it clamps, of a fixture as :func:`cone_edges` takes them.

    Parameters
    ----------
    touched, matrices : what the toolkit's pegs touch of the part, and the contact matrix of the fixture.
    """
    carriers = toolkit.carrier_numbers(peg.carrier for peg in fixture.pegs)
    faces = {face.number: face.segment for face in workpiece.faces}
    pegs = zip(fixture.pegs, (toolkit.carriers[number] for number in carriers), strict=True)
    radii = np.array([standoff(one.peg_radius, one.flat, faces[peg.face]) for peg, one in pegs])
    normals = matrices.normals[0]
    against = -np.stack(fixture.pose.inverse.turn(*touched.directions[carriers].T), axis=1)
    return matrices.points[0] - radii[:, None] * normals, normals, touched.moving[carriers], against


def cone_edges(
    contacts: Array, normals: Array, moving: Array, against: Array, friction: float, length: float
) -> tuple[Array, Array]:
    """Wrenches (2 P, 3) of the edges of friction cones, and how much each pushes what moves back (2 P,).

    Parameters
    ----------
    contacts : (P, 2) contact points about c in mm (with friction they are not the peg centres).
    normals : (P, 2) outward unit normals.
    moving : (P,) 1 for pegs on the carrier that moves, 0 for others.
    against : (2,) unit vector in the part's frame against which that carrier clamps, or (P, 2) for each peg.
    friction : the coefficient mu.
    length : L in mm, which moments are divided by.
    """
    tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    edges = np.concatenate([-normals + friction * tangents, -normals - friction * tangents])
    at = np.concatenate([contacts, contacts])
    moments = (at[:, 0] * edges[:, 1] - at[:, 1] * edges[:, 0]) / length
    against = np.broadcast_to(against, normals.shape)
    share = -(edges * np.concatenate([against, against])).sum(axis=1) * np.concatenate([moving, moving])
    return np.column_stack([edges, moments]), share


def possible_motions(
    contacts: Array, normals: Array, moving: Array, against: Array, friction: float, length: float
) -> Array:
    """Corners (M, 3) of the dual polytope as jaw force per unit of (g_x, g_y, moment); parameters as :func:`cone_edges`.

    The jaw force needed for a load is the largest product with it, or 0 if that is negative. There are no corners where
    friction alone could jam the part between pegs of one carrier: then no load needs any jaw force.
    """
    wrenches, share = cone_edges(contacts, normals, moving, against, friction, length)
    corners = []
    for chosen in combinations(range(len(wrenches)), 3):
        planes = wrenches[list(chosen)]
        if abs(np.linalg.det(planes)) > FLAT:
            corner = np.linalg.solve(planes, share[list(chosen)])
            if (wrenches @ corner - share <= OUTSIDE * (1.0 + np.abs(corner).max())).all():
                corners.append(corner)
    return np.asarray(-np.array(corners).reshape(-1, 3) / [1.0, 1.0, length])
