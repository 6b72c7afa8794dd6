"""The holes that may hold a support, and the triples of them for which the carriers have room.

Columns and rows are counted as in the planar fixture, also beyond its plates. Two jaws may stand nearer
together for supports between the pegs, so the travel of a triple may differ from the planar fixture's. Pegs
and supports keep their places relative to the part.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK
from workhold.fixels.carrier import Carrier
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.support_request import SupportRequest
from workhold.supports.faces import TouchableFace

__all__ = ["CarrierRoom", "HolesUnderPart", "TripleStanding", "find_holes_under_face"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# More columns or rows than any support can be away.
UNBOUNDED = 1 << 40


@define(frozen=True, eq=False)
class HolesUnderPart:
    """Holes that may hold a support, in the order of carrier, column and row.

    Parameters
    ----------
    carrier : (H,) number of the carrier of each of H holes.
    column, row : (H,) counted as in the planar fixture; may be outside its plates.
    points : (H, 2) centres of the holes, in mm in the part's coordinates.
    spare : (H,) slack in mm of the rules for a pad there, 0 or more within rounding.
    """

    carrier: IntArray
    column: IntArray
    row: IntArray
    points: Array
    spare: Array


def find_holes_under_face(
    fixture: Fixture, toolkit: Toolkit, face: TouchableFace, request: SupportRequest
) -> HolesUnderPart:
    """Return the holes under a face in which a pad keeps clear of the
    face's border, its zones and the pegs.
    """
    low, high = face.box
    corners = np.array(list(product((low[0], high[0]), (low[1], high[1]))))
    x, y = fixture.pose.apply(corners[:, 0], corners[:, 1])
    back, placed = fixture.pose.inverse, fixture.placed
    pegs = np.stack(back.apply(*np.array([(peg.x, peg.y) for peg in placed]).T), axis=1)
    bodies = np.array([toolkit.find_carrier(peg.carrier).body_radius for peg in placed])
    found: list[tuple[Array, ...]] = []
    for number, carrier in enumerate(toolkit.carriers):
        if not carrier.has_lattice:
            continue
        columns, rows = (
            np.arange(np.floor((ends.min() - first) / pitch), np.ceil((ends.max() - first) / pitch) + 1)
            for ends, first, pitch in zip(
                (x, y), carrier.compute_hole_center(0, 0, fixture.travel), carrier.pitch, strict=True
            )
        )
        column, row = (grid.ravel() for grid in np.meshgrid(columns, rows, indexing="ij"))
        hole = carrier.compute_hole_center(column, row, fixture.travel)
        points = np.stack(back.apply(*hole), axis=1)
        spare = face.measure_room(points) - request.pad_radius - request.pad_margin
        apart = np.hypot(*np.moveaxis(points[:, None] - pegs[None], -1, 0))
        spare = np.minimum(spare, (apart - bodies).min(axis=1, initial=np.inf) - request.pad_radius)
        kept = spare >= -GAP_SLACK
        found.append((np.full(kept.sum(), number), column[kept], row[kept], points[kept], spare[kept]))
    carrier_number, column, row, points, spare = map(np.concatenate, zip(*found, strict=True))
    return HolesUnderPart(
        carrier_number.astype(np.int64), column.astype(np.int64), row.astype(np.int64), points, spare
    )


@define(frozen=True, eq=False)
class TripleStanding:
    """The places of N sets of supports on their carriers together with the pegs.

    Parameters
    ----------
    fits : (N,) whether the set has a place.
    travel : (N,) travel of the moving carrier with a lattice, in mm; NaN where no such carrier moves.
    spare : (N,) slack of the smallest gap, in mm; inf where no such carrier moves.
    """

    fits: NDArray[np.bool_]
    travel: Array
    spare: Array


def find_ends(numbers: IntArray, on: NDArray[np.bool_], taken: IntArray) -> tuple[IntArray, IntArray]:
    """Return (the first, the last) column or row of each of N sets, (N,) each.

    ``numbers`` (N, S) are the columns or rows of the S supports of each set; only entries where ``on`` is
    True count. The columns or rows ``taken`` (K,) by pegs count for all sets.
    """
    first = np.where(on, numbers, UNBOUNDED).min(axis=1)
    last = np.where(on, numbers, -UNBOUNDED).max(axis=1)
    if len(taken):
        first, last = np.minimum(first, taken.min()), np.maximum(last, taken.max())
    return first, last


@define(frozen=True, eq=False)
class CarrierRoom:
    """The room that the carriers of a fixture leave for supports beside its pegs.

    Pegs and supports of a carrier must fit its columns and rows and keep the gap. They are as near to the
    opening as possible; they move outward only as far as the largest travel demands.

    Parameters
    ----------
    fixture, toolkit, holes : the fixture, its toolkit, and the holes that may hold a support.
    plates : the carriers with holes, by number.
    taken : columns (K,) and rows (K,) of pegs and clamps on each of these carriers.
    has_blocked : whether there are two carriers with holes, and a hole is blocked.
    """

    fixture: Fixture
    toolkit: Toolkit
    holes: HolesUnderPart
    plates: dict[int, Carrier]
    taken: dict[int, tuple[IntArray, IntArray]]
    has_blocked: bool

    @classmethod
    def from_fixture(cls, fixture: Fixture, toolkit: Toolkit, holes: HolesUnderPart) -> CarrierRoom:
        """Return the room that a fixture leaves."""
        carriers = toolkit.carriers
        plates = {number: one for number, one in enumerate(carriers) if one.has_lattice}
        by_name = {one.name: one for one in carriers}
        own = [(peg, by_name[peg.carrier]) for peg in fixture.pegs]

        def list_taken(plate: Carrier, axis: int) -> IntArray:
            """Return the columns (axis 0) or rows (axis 1) of pegs and clamps on a plate."""
            on = (one for one in own if one[1].stands_on == plate.name and one[1].counted_axes[axis])
            return np.array([(peg.column, peg.row)[axis] for peg, _ in on], np.int64)

        return cls(
            fixture,
            toolkit,
            holes,
            plates,
            {number: (list_taken(plate, 0), list_taken(plate, 1)) for number, plate in plates.items()},
            len(plates) > 1 and any(one.blocked for one in plates.values()),
        )

    def place_sets(self, sets: IntArray) -> TripleStanding:
        """Return the places of sets of supports beside the pegs, clear of blocked holes.

        ``sets`` (N, S) are indices of holes.
        """
        found, at_rest = self.fit_sets(sets)
        return self.move_off_blocked(found, sets, at_rest) if self.has_blocked else found

    def find_compatible_pairs(self) -> NDArray[np.bool_]:
        """Return a symmetric mask (H, H): True for two holes that may both hold a support, without regard to
        blocked holes.

        In a set that fits all pairs are compatible; the converse does not hold.
        """
        count = len(self.holes.row)
        out = np.zeros((count, count), np.bool_)
        first, second = np.triu_indices(count, 1)
        step = 1 << 18
        for k in range(0, len(first), step):
            one, other = first[k : k + step], second[k : k + step]
            out[one, other] = self.fit_sets(np.stack([one, other], axis=1))[0].fits
        return out | out.T

    def fit_sets(self, sets: IntArray) -> tuple[TripleStanding, Array]:
        """Return (places of the sets (N, S) without regard to blocked holes, travel (N,) in mm with all pegs
        nearest the opening).

        A set that does not fit does not fit with more supports either.
        """
        holes = self.holes
        carrier, column, row = holes.carrier[sets], holes.column[sets], holes.row[sets]
        count, together = len(sets), len(self.plates) > 1
        fits = np.ones(count, np.bool_)
        spans: dict[int, list[tuple[IntArray, IntArray]]] = {}
        # Rows of two jaws lie side by side and are shifted together.
        every_row = np.concatenate([rows for _, rows in self.taken.values()])
        for number, plate in self.plates.items():
            on = carrier == number
            columns = find_ends(column, on, self.taken[number][0])
            rows = find_ends(row, np.ones_like(on) if together else on, every_row)
            spans[number] = [columns, rows]
            for (first, last), most in ((columns, plate.columns), (rows, plate.rows)):
                if most is not None:
                    fits &= last - first < most
            if self.toolkit.wall is not None and plate.travel is None:
                # Rows are counted from the wall, and cannot be shifted.
                fits &= (rows[0] >= 0) & (rows[1] < (UNBOUNDED if plate.rows is None else plate.rows))
        moving = [(number, one) for number, one in self.plates.items() if one.travel is not None]
        if not moving:
            nowhere = np.full(count, np.nan)
            return TripleStanding(fits, nowhere, np.full(count, np.inf)), nowhere
        return self.open_carrier(fits, spans, *moving[0])

    def open_carrier(
        self,
        fits: NDArray[np.bool_],
        spans: dict[int, list[tuple[IntArray, IntArray]]],
        number: int,
        plate: Carrier,
    ) -> tuple[TripleStanding, Array]:
        """Return (places of the sets with the moving carrier opened no wider than its travel allows, their
        travel (N,)).

        The travel (N,) in mm is that with all pegs nearest the opening.

        Parameters
        ----------
        fits : (N,) which sets fit so far.
        spans : for each carrier, first and last columns (N,), and first and last rows (N,).
        number, plate : number of the moving carrier, and the carrier.
        """
        travel = plate.travel
        assert travel is not None
        axis = 0 if plate.is_along_x else 1
        pitch, size = plate.pitch[axis], (plate.columns, plate.rows)[axis]
        first, last = spans[number][axis]
        room = np.full(len(first), UNBOUNDED) if size is None else size - 1 - (last - first)
        at_rest = self.fixture.travel + first * pitch
        for other, standing in self.plates.items():
            if other == number:
                continue
            low, high = spans[other][axis]
            size = (standing.columns, standing.rows)[axis]
            assert size is not None
            room = room + size - 1 - (high - low)
            at_rest = at_rest + (size - 1 - high) * pitch
        outward = np.zeros(len(first))
        if travel.most is not None:
            outward = np.maximum(np.ceil((at_rest - travel.most - GAP_SLACK) / pitch), 0.0)
        opened = at_rest - outward * pitch
        spare = opened - travel.least
        fits = fits & (outward <= room) & (spare >= -GAP_SLACK)
        return TripleStanding(fits, opened, spare), np.asarray(at_rest, np.float64)

    def move_off_blocked(self, found: TripleStanding, sets: IntArray, at_rest: Array) -> TripleStanding:
        """Return the places of sets (N, S) whose pegs and supports are moved outward until none is in a
        blocked hole.

        ``at_rest`` (N,) is the travel in mm with all pegs nearest the opening. Sets without such a place do
        not fit.
        """
        holes, plates, numbers = self.holes, list(self.plates.values()), list(self.plates)
        travel = next(one.travel for one in plates if one.travel is not None)
        most = np.inf if travel.most is None else travel.most + GAP_SLACK
        names = [one.name for one in plates]
        pegs = [(names.index(p.carrier), p.column, p.row) for p in self.fixture.pegs if p.carrier in names]
        fits, opened = found.fits.copy(), found.travel.copy()
        for index in np.flatnonzero(found.fits):
            standing = pegs + [
                (numbers.index(int(holes.carrier[h])), int(holes.column[h]), int(holes.row[h]))
                for h in sets[index]
            ]
            widths = (
                at_rest[index] - moved * plates[0].pitch[0]
                for moved in find_first_free_columns(standing, plates)
            )
            width = next((one for one in widths if one <= most), -np.inf)
            fits[index] = width >= travel.least - GAP_SLACK
            opened[index] = width if fits[index] else opened[index]
        return TripleStanding(fits, opened, found.spare)


def find_first_free_columns(standing: list[tuple[int, int, int]], plates: list[Carrier]) -> list[int]:
    """Yield, ascending, the total numbers of columns by which pegs and supports must move outward to be clear
    of blocked holes.

    ``standing`` has (index of the carrier, column, row) of each; there are two plates.
    """
    columns = [[c for k, c, _ in standing if k == number] for number in range(len(plates))]
    lowest = min(row for _, _, row in standing)
    height = max(row for _, _, row in standing) - lowest
    rows = plates[0].rows
    blocked_rows = [one.row for plate in plates for one in plate.blocked if one.row is not None]
    lifts = range(max(blocked_rows, default=-1) + 2) if rows is None else range(rows - height)
    left_room = plates[0].column_count - 1 - (max(columns[0]) - min(columns[0]))
    right_room = plates[1].column_count - 1 - (max(columns[1]) - min(columns[1]))
    found = set()
    for left, right in product(range(left_room + 1), range(right_room + 1)):
        shifts = (plates[0].column_count - 1 - left - max(columns[0]), right - min(columns[1]))
        if left + right not in found and any(
            not any(plates[k].is_blocked(c + shifts[k], r - lowest + lift) for k, c, r in standing)
            for lift in lifts
        ):
            found.add(left + right)
    return sorted(found)
