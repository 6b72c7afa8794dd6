"""Contacts of fixtures with the inverses of their contact matrices, from holes, poses and faces alone.

Glossary
--------
contact matrix : see ``kernels.statics.contact_matrix``; its inverse turns errors into movements and loads into peg forces.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.features import ContactFeature, contact_features, feature_rows
from workhold.kernels.statics.contact_matrix import contact_matrices_of
from workhold.model.diameter import outline_diameter
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece

__all__ = ["ContactMatrices", "Touched"]

Array = NDArray[np.float64]


@define(frozen=True, eq=False)
class ContactMatrices:
    """Contacts of N fixtures in the part's frame; lengths in mm.

    Parameters
    ----------
    points : (N, 4, 2) peg centres about the centre of the part.
    normals : (N, 4, 2) outward unit normals.
    ends : (N, 4) distances along the contact features to their nearer ends.
    inverses : (N, 4, 4) inverses of the contact matrices, NaN where there is none.
    """

    points: Array
    normals: Array
    ends: Array
    inverses: Array


@define(frozen=True, eq=False)
class Touched:
    """What pegs of a vise touch of a workpiece; lengths in mm, everything about the centre of the part.

    Parameters
    ----------
    center : (2,) of the part's bounding box, in the part's coordinates.
    length : L of the wrenches, half the diameter of the peg-centre locus.
    features : (F, 8) rows of the contact features, ordered by face.
    starts : where the features of each face number begin in them, one more than there are segments.
    axis : (2,) unit vector against which the moving pegs clamp, in the toolkit's frame.
    """

    center: Array
    length: float
    features: Array
    starts: NDArray[np.int64]
    axis: Array

    @classmethod
    def of(
        cls,
        workpiece: Workpiece,
        vise: Vise,
        features: Sequence[ContactFeature] | None = None,
        length: float | None = None,
    ) -> Touched:
        """The contact features of a workpiece for a vise's pegs; ``features`` and L in mm where they are known already."""
        features = contact_features(workpiece, vise.peg_radius) if features is None else list(features)
        center = np.array(workpiece.center)
        # A copy of one row more, because the kernel looks at row 0 even where a face has no feature.
        rows = np.zeros((len(features) + 1, 8))
        rows[:-1] = feature_rows(features)
        rows[:, 1:3] -= center
        faces = np.array([feature.face for feature in features], np.int64)
        return cls(
            center=center,
            length=outline_diameter(workpiece) / 2 + vise.peg_radius if length is None else length,
            features=rows,
            starts=np.searchsorted(faces, np.arange(len(workpiece.segments) + 1)).astype(np.int64),
            axis=vise.clamping * np.array(vise.moving_axis, np.float64),
        )

    def contact_matrices(self, pegs: Array, pose: Array, moves: Array, faces: NDArray[np.int64]) -> ContactMatrices:
        """Contact matrices of N fixtures.

        Parameters
        ----------
        pegs : (N, 4, 2) peg centres in the toolkit's frame, in mm.
        pose : (N, 3) orientation in radians and translation in mm.
        moves : (N, 4) 1 for a peg on the moving carrier, 0 for others.
        faces : (N, 4) numbers of the faces touched.
        """
        count = len(pegs)
        out = ContactMatrices(*(np.empty((count, 4, *shape)) for shape in ((2,), (2,), (), (4,))))
        # Copies, because a kernel is compiled anew for arrays that are read-only or laid out otherwise.
        contact_matrices_of(
            np.array(pegs, np.float64, order="C"),
            np.array(pose, np.float64, order="C"),
            np.array(moves, np.float64, order="C"),
            self.axis,
            np.array(faces, np.int64, order="C"),
            self.features,
            self.starts,
            self.center,
            self.length,
            out.points,
            out.normals,
            out.ends,
            out.inverses,
        )
        return out
