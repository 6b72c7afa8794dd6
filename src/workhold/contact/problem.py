"""What every engine begins with: a query made ready for arithmetic."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.features import (
    ContactFeature,
    allowed_features,
    contact_features,
    end_slacks,
    feature_rows,
)
from workhold.contact.frame import Frame
from workhold.errors import InputError
from workhold.fixels.toolkit import Carrier, Toolkit
from workhold.geometry.segment import segment_rows
from workhold.kernels.base.feature import IS_ARC, RADIUS, REST_X, REST_Y, X, Y
from workhold.kernels.base.given import Limits, Setting
from workhold.limits import refuse_many_steps
from workhold.model.query import Query
from workhold.model.requirements import Restrictions
from workhold.model.workpiece import Workpiece, outline_diameter

__all__ = ["Problem", "Progress"]

Progress = Callable[[float, int], None]
# Roundings of half a unit in the last place in a feature's row, generously counted.
ROUNDINGS = 16.0 * 1.2e-16


@define(frozen=True, eq=False)
class Problem:
    """A query made ready; lengths in mm, everything about the centre of the part's bounding box.

    Parameters
    ----------
    query : what is asked.
    loci : for each carrier of the frame the contact features of its pegs, also those that are ruled out,
        ordered by face.
    rows : (F, 12) contact features, with the slack of their ends beside the contact margin
        (``contact.features.end_slacks``).
    faces : (F,) number of each feature's face.
    standing, moving : first and past-the-last number of the features that pegs of each carrier touch. Both
        are equal where their pegs are alike; else features of the standing carrier come first.
    outline : (S, 10) the part's faces.
    diameter : largest distance between two peg centres that touch the part.
    pairing : whether the clamp is one of two, so that it need not hold the part with the locators alone.
    """

    query: Query
    loci: tuple[tuple[ContactFeature, ...], ...]
    rows: NDArray[np.float64]
    faces: NDArray[np.int64]
    standing: tuple[int, int]
    moving: tuple[int, int]
    outline: NDArray[np.float64]
    diameter: float
    pairing: bool = False

    def __attrs_post_init__(self) -> None:
        for carrier in self.toolkit.carriers:
            refuse_many_steps(carrier.pitch, carrier.columns, carrier.rows, self.diameter, len(self.rows))

    @classmethod
    def of(cls, query: Query, pairing: bool = False) -> Problem:
        """Makes a query ready.

        Raises
        ------
        InputError
            When the peg fits nowhere along the part, a face to avoid does not exist, or nothing is left to
            touch. Also when two pegs can stand in too many ways (``limits``).
        """
        workpiece, restrictions = query.workpiece, query.restrictions
        radius = max(carrier.peg_radius for carrier in query.toolkit.carriers)
        diameter = outline_diameter(workpiece) + 2 * radius
        carriers = Frame.of(query.toolkit, diameter).carriers
        one, other = ((each.peg_radius, each.body_radius, each.flat) for each in carriers)
        loci = [locus_of(workpiece, carrier) for carrier in carriers[: 1 if one == other else 2]]
        allowed = loci
        if restrictions:
            allowed = [
                allowed_features(locus, workpiece, restrictions, carrier.body_radius)
                for locus, carrier in zip(loci, carriers, strict=False)
            ]
        features = [feature for part in allowed for feature in part]
        slacks = np.concatenate(
            [end_slacks(part, query.contact_margin, locus) for part, locus in zip(allowed, loci, strict=True)]
        )
        center = workpiece.center
        return cls(
            query,
            (tuple(loci[0]), tuple(loci[-1])),
            rows=np.concatenate([centered(feature_rows(features), center), slacks], axis=1),
            faces=np.array([feature.face for feature in features], dtype=np.int64),
            standing=(0, len(allowed[0])),
            moving=(len(features) - len(allowed[-1]), len(features)),
            outline=centered(segment_rows([face.segment for face in workpiece.faces]), center),
            diameter=diameter,
            pairing=pairing,
        )

    @property
    def workpiece(self) -> Workpiece:
        """What to hold."""
        return self.query.workpiece

    @property
    def toolkit(self) -> Toolkit:
        """What to hold it in."""
        return self.query.toolkit

    @property
    def contact_margin(self) -> float:
        """Smallest distance between a contact and the end of its feature."""
        return self.query.contact_margin

    @property
    def restrictions(self) -> Restrictions:
        """What is ruled out."""
        return self.query.restrictions

    @property
    def wrench_length(self) -> float:
        """L of the wrenches: half the diameter of the peg-centre locus."""
        return self.diameter / 2

    @property
    def backward_error(self) -> float:
        """Distance in mm of the features' rows from the drawing, by the rounding of a dozen operations."""
        center = self.workpiece.center
        return ROUNDINGS * (
            abs(center[0]) + abs(center[1]) + float(np.abs(self.rows[:, [X, Y, RADIUS]]).max())
        )

    @cached_property
    def frame(self) -> Frame:
        """The toolkit as the search sees it."""
        return Frame.of(self.toolkit, self.diameter)

    @cached_property
    def limits(self) -> Limits:
        """What bounds a fixture, as kernels take it."""
        frame = self.frame
        return Limits(
            frame.gap,
            self.contact_margin,
            self.wrench_length,
            most_column_steps=frame.standing.column_count - 1.0,
            clamping=float(self.toolkit.clamping),
            least_margin=0.0,
            most_listed=0.0,
            pairing=float(self.pairing),
        )

    @property
    def setting(self) -> Setting:
        """What a proof must know of the problem, as kernels take it."""
        frame = self.frame
        standing, moving = (carrier.least_standoff for carrier in frame.carriers)
        return Setting(frame.lattice, self.limits, standing, moving, self.backward_error)


def locus_of(workpiece: Workpiece, carrier: Carrier) -> list[ContactFeature]:
    """All contact features of a workpiece for the pegs of a carrier.

    Raises
    ------
    InputError
        When such a peg fits nowhere along the part.
    """
    features = contact_features(workpiece, carrier.peg_radius, carrier.flat)
    if not features:
        raise InputError(
            f"a peg of radius {carrier.peg_radius:g} mm fits nowhere along {workpiece.name}: every face is "
            "hidden in corners too narrow for it; use a smaller peg."
        )
    return features


def centered(rows: NDArray[np.float64], center: tuple[float, float]) -> NDArray[np.float64]:
    """Rows (N, 10) of segments moved so that a point becomes the origin; read-only."""
    out, is_arc = np.array(rows), rows[:, IS_ARC] != 0.0
    for column, rest, coordinate in ((X, REST_X, center[0]), (Y, REST_Y, center[1])):
        out[:, column] -= coordinate
        # What rounding takes from the difference (D. E. Knuth, The Art of Computer Programming 2, 4.2.2).
        moved = out[:, column] - rows[:, column]
        out[:, rest] += is_arc * ((rows[:, column] - (out[:, column] - moved)) - (coordinate + moved))
    out.setflags(write=False)
    return out
