"""The problem that every engine starts from: a query prepared for arithmetic, in a frame common to all
toolkits.

In this frame a toolkit is turned so that its moving carrier slides along +x. Quarter turns alone are used,
and fixtures found in the frame are carried back. Everything between contact features and placed fixtures
works there; a vise needs no turning.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property
from math import inf, pi
from typing import Any

import numpy as np
from attrs import define, evolve, frozen
from numpy.typing import NDArray

from workhold.contact.features import (
    ContactFeature,
    find_allowed_features,
    list_features_met,
    make_feature_rows,
    measure_end_slacks,
)
from workhold.contact.swept import SweptSpans, find_swept_at_pegs, list_swept_clearances
from workhold.errors import InputError
from workhold.fixels.carrier import HoleSelection
from workhold.fixels.toolkit import Carrier, Toolkit, Travel
from workhold.geometry.segment import make_segment_rows
from workhold.kernels.base.feature import IS_ARC, RADIUS, REST_X, REST_Y, X, Y
from workhold.kernels.base.tables import Lattice, Limits, Setting
from workhold.limits import refuse_many_steps
from workhold.model.own_outlines import measure_outline_diameter
from workhold.model.query import Query
from workhold.model.requirements import Restrictions
from workhold.model.workpiece import Workpiece

__all__ = ["SearchFrame", "Problem", "Progress"]

IntArray = NDArray[np.int64]

# Cosine and sine of so many quarter turns.
QUARTERS = ((1, 0), (0, 1), (-1, 0), (0, -1))
# A direction this near to a quarter turn, in quarter turns, is one.
ROUNDING = 1e-12


@frozen
class SearchFrame:
    """A toolkit in the frame of the search: one carrier is fixed, one slides along its rows, in direction +x.

    Requirements of other toolkits. Both carriers need one pitch only where both hold two pegs: Type I asks
    for heights that differ by whole row pitches (``kernels.base.tables.Lattice``). Chords are made of the
    steps of one lattice alone: a carrier of another pitch needs lattice steps and curves of its own
    (``search.toolkit_search``, ``CurveTable.joined``), and ``record.read_record`` its pitch. A single moving
    peg, such as a clamp on a line of holes of the locators' own plate, needs the pitch of its rows and their
    offset only.

    Parameters
    ----------
    toolkit : the toolkit of the query.
    quarters : number of quarter turns, counter-clockwise, from the frame back to the toolkit.
    standing, moving : its carriers in the frame; places in mm relative to the toolkit's origin.
    """

    toolkit: Toolkit
    quarters: int
    standing: Carrier
    moving: Carrier

    @classmethod
    def from_toolkit(cls, toolkit: Toolkit, farthest: float) -> SearchFrame:
        """Return the frame of a toolkit; two pegs on the part are at most ``farthest`` mm apart.

        Raises
        ------
        InputError
            When the toolkit has straps, the lattices are not alike, or the moving carrier slides neither
            along its rows nor along its columns.
        """
        if toolkit.strap_set is not None:
            raise InputError(
                "this is not worked out with straps, under which nothing moves: design for the plate with straps, or take "
                "a plate with clamps."
            )
        moving = toolkit.moving
        still = (plate for plate in toolkit.plates if plate.travel is None)
        # Beside a wall a lattice that slides may be all there is.
        standing = next(still, moving)
        assert moving.travel is not None
        turns = moving.travel.direction / (pi / 2)
        if abs(turns - round(turns)) > ROUNDING or standing.pitch != moving.pitch:
            raise InputError(
                f"the {moving.name} carrier of a {toolkit.kind} does not slide along the rows or columns of "
                f"a lattice like that of the {standing.name} one: give both one pitch, and a direction of "
                "whole quarter turns."
            )
        quarters = round(turns) % 4
        return cls(
            toolkit,
            quarters,
            turn_carrier(standing, quarters, farthest),
            turn_carrier(moving, quarters, farthest),
        )

    @property
    def carriers(self) -> tuple[Carrier, Carrier]:
        """Both carriers in the frame, the fixed one first."""
        return self.standing, self.moving

    @property
    def lattice(self) -> Lattice:
        """The lattice of holes in the frame, common to both carriers."""
        return Lattice(*self.standing.pitch, self.moving.offset[1] - self.standing.offset[1])

    @property
    def gap(self) -> float:
        """The smallest distance in mm along x from a standing to a moving
        peg, -inf when there is no such rule.
        """
        return -inf if self.toolkit.gap is None else self.toolkit.gap

    @property
    def swapped_peg_count(self) -> int:
        """The number of pegs on each carrier of the arrangement that a half turn of the toolkit maps to
        itself; 0 for none.

        The half turn swaps the carriers.
        """
        swaps = any(s.half_turns % 2 and s.carriers == (1, 0) for s in self.toolkit.symmetries)
        return next((a.pegs[0] for a in self.toolkit.arrangements if swaps and a.pegs == a.pegs[::-1]), 0)

    @property
    def travel_at_rest(self) -> float:
        """The travel in mm at which the moving carrier's first column lies at the x of the standing carrier's
        last column."""
        (x, _), (first, _) = (
            self.standing.compute_hole_center(self.standing.column_count - 1, 0),
            self.moving.offset,
        )
        return float(x - first)

    def map_step_to_toolkit(self, column: IntArray, row: IntArray) -> tuple[IntArray, IntArray]:
        """Return differences of columns and of rows in the toolkit's numbering, given those in the
        frame's."""
        cosine, sine = QUARTERS[self.quarters]
        return cosine * column - sine * row, sine * column + cosine * row

    def map_holes_to_toolkit(
        self, standing: NDArray[np.bool_], column: IntArray, row: IntArray
    ) -> tuple[IntArray, IntArray]:
        """Return columns and rows (N, 4) of holes in the toolkit's numbering, given those in the frame's.

        ``standing`` (N, 4) is True for holes of the fixed carrier. If the carriers are endless across the
        travel, the lowest number in that direction is 0.
        """
        if self.quarters == 0:
            return column, row
        places = [map_hole_to_toolkit(carrier, self.quarters, column, row) for carrier in self.carriers]
        out = [np.where(standing, one, other) for one, other in zip(*places, strict=True)]
        if self.standing.rows is None:
            across = self.quarters % 2 == 0
            out[across] = out[across] - out[across].min(axis=1, keepdims=True, initial=0)
        return out[0], out[1]


def flip_hole_numbers(k: Any, count: int | None) -> Any:
    """Return hole numbers counted from the other end: ``count - 1 - k``,
    or ``-k`` where ``count`` is None (endless).
    """
    return -k if count is None else count - 1 - k


def map_hole_to_toolkit(carrier: Carrier, quarters: int, column: Any, row: Any) -> tuple[Any, Any]:
    """Return the column and row of a hole in the toolkit's numbering, given those in the frame's.

    ``quarters`` (0 to 3) is the number of quarter turns, counter-clockwise, from the frame to the toolkit;
    ``carrier`` is the carrier as it is in the frame.
    """
    if quarters == 2:
        return flip_hole_numbers(column, carrier.columns), flip_hole_numbers(row, carrier.rows)
    if quarters == 1:
        return flip_hole_numbers(row, carrier.rows), column
    return (row, flip_hole_numbers(column, carrier.columns)) if quarters else (column, row)


def turn_carrier(carrier: Carrier, quarters: int, farthest: float) -> Carrier:
    """Return a carrier turned by ``quarters`` quarter turns clockwise: from the toolkit to the frame.

    A carrier that is endless along the travel gets as many columns as two pegs on the part can be apart.

    Raises
    ------
    InputError
        When holes are blocked on a carrier that is endless.
    """
    swaps = quarters % 2 == 1
    columns, rows = (carrier.rows, carrier.columns) if swaps else (carrier.columns, carrier.rows)
    if carrier.blocked and (columns is None or (quarters and rows is None)):
        raise InputError(
            f"the {carrier.name} carrier has no end: give the number of its columns and rows of holes."
        )
    pitch = carrier.pitch[::-1] if swaps else carrier.pitch
    if columns is None:
        columns = int(farthest / pitch[0]) + 1
    travel = carrier.travel and Travel(0.0, carrier.travel.least, carrier.travel.most)
    out = evolve(carrier, pitch=pitch, columns=columns, rows=rows, travel=travel)
    x, y = evolve(carrier, travel=None).compute_hole_center(*map_hole_to_toolkit(out, quarters, 0, 0))
    cosine, sine = QUARTERS[quarters]
    offset = (cosine * x + sine * y, cosine * y - sine * x)
    return evolve(out, offset=offset, blocked=tuple(map_blocked_holes_to_frame(carrier, quarters)))


def map_blocked_holes_to_frame(carrier: Carrier, quarters: int) -> Iterator[HoleSelection]:
    """Yield the blocked holes of a carrier of the toolkit, with columns and rows in the frame's numbering."""
    if quarters == 0:
        yield from carrier.blocked
        return
    for holes in carrier.blocked:
        for k in range(carrier.rows or 0) if holes.row is None else [holes.row]:
            # Turning on by the rest of a whole turn is the way there.
            column, row = map_hole_to_toolkit(carrier, -quarters % 4, holes.column, k)
            yield evolve(holes, column=column, row=row)


Progress = Callable[[float, int], None]
# Roundings of half a unit in the last place in a feature's row, generously counted.
ROUNDINGS = 16.0 * 1.2e-16


@define(frozen=True, eq=False)
class Problem:
    """A query prepared for arithmetic; lengths in mm, coordinates
    about the centre of the part's bounding box.

    Parameters
    ----------
    query : the query.
    loci : for each carrier of the frame the contact features of its pegs, also those that are ruled out,
        ordered by face.
    rows : (F, 12) contact features, with the slack of their ends beside the contact margin
        (``contact.features.end_slacks``).
    faces : (F,) number of each feature's face.
    standing, moving : first and past-the-last number of the features that pegs of each carrier touch. Both
        are equal if their pegs are alike; else features of the fixed carrier come first.
    outlines : (S, 10) the faces that pegs of the standing carrier keep from, and those of the moving one; one
        array where both meet one outline.
    diameter : largest distance in mm between two peg centres that touch the part.
    pairing : whether the clamp is one of two; then one clamp and the locators alone need not hold the part.
    """

    query: Query
    loci: tuple[tuple[ContactFeature, ...], ...]
    rows: NDArray[np.float64]
    faces: NDArray[np.int64]
    standing: tuple[int, int]
    moving: tuple[int, int]
    outlines: tuple[NDArray[np.float64], NDArray[np.float64]]
    diameter: float
    pairing: bool = False

    def __attrs_post_init__(self) -> None:
        for carrier in self.toolkit.carriers:
            refuse_many_steps(carrier.pitch, carrier.columns, carrier.rows, self.diameter, len(self.rows))

    @classmethod
    def from_query(cls, query: Query, pairing: bool = False) -> Problem:
        """Return the problem of a query.

        Raises
        ------
        InputError
            When the peg is too large to touch any face, a face to avoid does not exist, or no face is left to
            touch. Also when there are too many ways to place two pegs (``limits``).
        """
        workpiece, restrictions = query.workpiece, query.restrictions
        radius = max(carrier.peg_radius for carrier in query.toolkit.carriers)
        diameter = measure_outline_diameter(workpiece) + 2 * radius
        carriers = SearchFrame.from_toolkit(query.toolkit, diameter).carriers
        met = [workpiece.find_outline(each.role) for each in carriers]
        one, other = (
            (each.peg_radius, each.body_radius, each.flat, each.heights, first)
            for each, (_, first) in zip(carriers, met, strict=True)
        )
        loci = [list_peg_features(workpiece, carrier) for carrier in carriers[: 1 if one == other else 2]]
        allowed = loci
        if restrictions or workpiece.untouchable or workpiece.outlines or query.program is not None:
            allowed = [
                find_allowed_features(
                    locus, workpiece, restrictions, carrier.body_radius, list_swept_clearances(query, carrier)
                )
                for locus, carrier in zip(loci, carriers, strict=False)
            ]
        features = [feature for part in allowed for feature in part]
        slacks = np.concatenate(
            [
                measure_end_slacks(part, query.contact_margin, locus)
                for part, locus in zip(allowed, loci, strict=True)
            ]
        )
        center = workpiece.center
        rows = {first: make_segment_rows([face.segment for face in own.faces]) for own, first in met}
        rows = {first: move_rows_to_origin(values, center) for first, values in rows.items()}
        return cls(
            query,
            (tuple(loci[0]), tuple(loci[-1])),
            rows=np.concatenate([move_rows_to_origin(make_feature_rows(features), center), slacks], axis=1),
            faces=np.array([feature.face for feature in features], dtype=np.int64),
            standing=(0, len(allowed[0])),
            moving=(len(features) - len(allowed[-1]), len(features)),
            outlines=(rows[met[0][1]], rows[met[1][1]]),
            diameter=diameter,
            pairing=pairing,
        )

    @property
    def workpiece(self) -> Workpiece:
        """The part to hold."""
        return self.query.workpiece

    @property
    def toolkit(self) -> Toolkit:
        """The toolkit of the query."""
        return self.query.toolkit

    @property
    def contact_margin(self) -> float:
        """The smallest distance in mm between a contact and the end of its feature."""
        return self.query.contact_margin

    @property
    def restrictions(self) -> Restrictions:
        """The faces and zones that are ruled out."""
        return self.query.restrictions

    def find_swept_spans(self, carrier: Carrier) -> tuple[SweptSpans, float] | None:
        """Return (the spans that the program sweeps at the heights of a carrier's pegs, the clearance to keep
        from them in mm).

        Return None without a program. The spans are in the part's own coordinates, not about its centre.
        """
        return find_swept_at_pegs(self.query, carrier)

    @property
    def wrench_length(self) -> float:
        """The length L in mm by which moments of wrenches are divided: half the diameter of the peg-centre
        locus."""
        return self.diameter / 2

    @property
    def backward_error(self) -> float:
        """A bound in mm of the distance between the features' rounded rows and the drawing."""
        center = self.workpiece.center
        return ROUNDINGS * (
            abs(center[0]) + abs(center[1]) + float(np.abs(self.rows[:, [X, Y, RADIUS]]).max())
        )

    @cached_property
    def frame(self) -> SearchFrame:
        """The toolkit in the frame of the search."""
        return SearchFrame.from_toolkit(self.toolkit, self.diameter)

    @cached_property
    def limits(self) -> Limits:
        """The rules that bound a fixture, in the form that kernels take."""
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
        """The lattice, limits, peg radii and errors that a proof needs, in the form that kernels take."""
        frame = self.frame
        standing, moving = (carrier.least_standoff for carrier in frame.carriers)
        return Setting(frame.lattice, self.limits, standing, moving, self.backward_error)


def list_peg_features(workpiece: Workpiece, carrier: Carrier) -> list[ContactFeature]:
    """Return all contact features of a workpiece for the pegs of a carrier, by face.

    Raises
    ------
    InputError
        When such a peg fits nowhere along the part.
    """
    features = list_features_met(workpiece, carrier)
    if not features:
        raise InputError(
            f"a peg of radius {carrier.peg_radius:g} mm fits nowhere along {workpiece.name}: every face is "
            "hidden in corners too narrow for it; use a smaller peg."
        )
    return features


def move_rows_to_origin(rows: NDArray[np.float64], center: tuple[float, float]) -> NDArray[np.float64]:
    """Return a read-only copy of rows (N, 10) of segments, moved so
    that the point ``center`` becomes the origin.

    See ``kernels.base.feature`` for the layout of rows.
    """
    out, is_arc = np.array(rows), rows[:, IS_ARC] != 0.0
    for column, rest, coordinate in ((X, REST_X, center[0]), (Y, REST_Y, center[1])):
        out[:, column] -= coordinate
        # What rounding takes from the difference (D. E. Knuth, The Art of Computer Programming 2, 4.2.2).
        moved = out[:, column] - rows[:, column]
        out[:, rest] += is_arc * ((rows[:, column] - (out[:, column] - moved)) - (coordinate + moved))
    out.setflags(write=False)
    return out
