"""The triples of supports of a planar fixture: all of them, or exactly the best few.

Sum max(r_j, 0) bounds the clamp force that a triple needs from below, wherever the clamp stands. So triples
are taken in order of that bound, and the clamp's best point is sought for a block of them at a time. The
search ends where the bound is above the last of the best so far. Without loads the incircle bounds the arm.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations
from math import inf, isfinite

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.conventions import AGREEMENT, FIGURE_DECIMALS, GAP_SLACK
from workhold.errors import InputError
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.model.support_request import Loops, SpatialLoad, SupportRequest
from workhold.model.support_triples import ClampFigures, SupportPad, Supports, Triple
from workhold.statics.contact_matrix import Touched
from workhold.supports.acting import checked_force, needed_jaw_force, spatial
from workhold.supports.clamp_point import ClampPlaces
from workhold.supports.faces import TouchableFace, area_center
from workhold.supports.forces import PegForces, Triangles, lifted_by_jaws, support_forces
from workhold.supports.holes import HolesUnderPart, Standing, holes_under, standing_of

__all__ = ["SupportSearch", "supports_of", "supports_of_best"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BLOCK = 256
# Two supports and a third nearer to their line than this, in mm, are on one line.
ON_ONE_LINE = 1e-6
COARSE = 2


def coarse(value: float) -> float:
    """A figure to two significant digits, as the ranking counts it; a force below 1e-9 is none."""
    return float(f"{value:.{COARSE - 1}e}") if abs(value) > 10.0**-FIGURE_DECIMALS else 0.0


@define(frozen=True, eq=False)
class SupportSearch:
    """What is the same for all fixtures of one part in one toolkit.

    Parameters
    ----------
    query : part and toolkit.
    request : what is asked.
    loads : with their heights written out.
    """

    query: Query
    request: SupportRequest
    loads: tuple[SpatialLoad, ...]
    touched: Touched = field(init=False)
    bottom: TouchableFace = field(init=False)
    top: TouchableFace = field(init=False)
    center: Array = field(init=False)
    free_places: ClampPlaces | None = field(init=False)

    def __attrs_post_init__(self) -> None:
        workpiece, request = self.query.workpiece, self.request
        request.refuse_fat_pads(self.query.toolkit)
        for load in self.loads:
            if load.heights is not None and not 0 <= load.heights[0] <= load.heights[1] <= inf:
                raise InputError("a load acts below the part: give its height above the supports, 0 or more.")

        def face(loops: Loops | None, zones: Iterable[Array]) -> TouchableFace:
            return TouchableFace.of(workpiece.loops if loops is None else loops, zones)

        for name, value in (
            ("touched", Touched.of(workpiece, self.query.toolkit)),
            ("bottom", face(request.bottom, (zone.loop for zone in request.bottom_zones))),
            ("top", face(request.top, (zone.loop for zone in request.top_zones))),
            ("center", area_center(workpiece.loop_segments)),
        ):
            object.__setattr__(self, name, value)
        free = None if request.reach is not None else ClampPlaces(self.top, request.tip_radius, None)
        object.__setattr__(self, "free_places", free)

    def places(self, fixture: Fixture) -> ClampPlaces:
        """Where the tip may stand over a fixture."""
        if self.free_places is not None:
            return self.free_places
        rings = np.array(self.request.reach).reshape(-1, 4)
        x, y = fixture.pose.inverse.apply(rings[:, 0], rings[:, 1])
        return ClampPlaces(self.top, self.request.tip_radius, np.column_stack([x, y, rings[:, 2:]]))

    def supports(self, fixture: Fixture, jaw_force: float | None, best: int | None) -> Supports:
        """The supports of a fixture: all triples, or the best few."""
        force = needed_jaw_force(fixture, self.query, self.loads, jaw_force)
        holes = holes_under(fixture, self.query.toolkit, self.bottom, self.request)
        # Nothing but fewer than three holes leaves no triple to look at.
        numbers = np.array(list(combinations(range(len(holes.row)), 3)), np.int64).reshape(-1, 3)
        standing = standing_of(fixture, self.query.toolkit, holes, numbers)
        corners = holes.points[numbers]
        sides = corners - np.roll(corners, 1, axis=1)
        area = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
        length = np.hypot(sides[..., 0], sides[..., 1])
        # No point is farther inside than the centre of the incircle.
        incircle = area / length.sum(axis=1)
        kept = standing.fits & (area > ON_ONE_LINE * length.max(axis=1, initial=0.0))
        kept &= incircle >= self.request.inside - GAP_SLACK
        rows = np.flatnonzero(kept)
        work = FixtureTriples(
            self, fixture, holes, numbers[rows], standing, rows, force, Triangles.of(corners[rows])
        )
        count, chosen = work.all_ranked() if best is None else work.best(best)
        triples = work.described(chosen)
        return Supports(self.query, fixture, self.request, self.loads, force, len(holes.row), count, triples)


@define(frozen=True, eq=False)
class FixtureTriples:
    """Triples of one fixture that are valid but for the clamp, with what decides between them.

    Parameters
    ----------
    numbers : (N, 3) of their holes.
    standing, rows : how all triples stand in their carriers, and which of them these are.
    jaw_force : in N.
    """

    search: SupportSearch
    fixture: Fixture
    holes: HolesUnderPart
    numbers: IntArray
    standing: Standing
    rows: IntArray
    jaw_force: float
    triangles: Triangles
    places: ClampPlaces = field(init=False)
    pegs: PegForces = field(init=False)
    bands: Array = field(init=False)
    reach: Array = field(init=False)
    most: Array = field(init=False)
    lifted: Array = field(init=False)

    def __attrs_post_init__(self) -> None:
        search = self.search
        pegs = PegForces.within(self.fixture, search.query.toolkit, search.touched)
        bands = search.request.peg_bands(len(self.fixture.pegs))
        lifted = lifted_by_jaws(self.triangles, pegs, bands)
        if search.loads:
            least, most = support_forces(self.triangles, pegs, bands, search.loads, self.jaw_force)
        else:
            least = most = np.zeros(lifted.shape)
        places = search.places(self.fixture)
        for name, value in zip(
            ("places", "pegs", "bands", "reach", "most", "lifted"),
            (places, pegs, bands, -least, most, lifted),
            strict=True,
        ):
            object.__setattr__(self, name, value)

    def arms(self, rows: IntArray) -> tuple[Array, Array]:
        """The best points for the tipping arm (N, 2), and the arms; 0 where the clamp may stand nowhere."""
        some = self.triangles.take(rows)
        points, value = self.places.best(some, some.steepness, self.search.request.inside)
        return points, 1.0 / value

    def least_forces(self, rows: IntArray, arm_at: Array) -> tuple[Array, Array]:
        """The points (N, 2) at which the least clamp force is needed, and that force."""
        points, value = arm_at.copy(), np.zeros(len(rows))
        some = np.flatnonzero((self.reach[rows] > 0).any(axis=1))
        if len(some):
            own = rows[some]
            points[some], value[some] = self.places.best(
                self.triangles.take(own), self.reach[own], self.search.request.inside
            )
        return points, value

    def judged(self, rows: IntArray) -> tuple[IntArray, list[tuple[float, ...]]]:
        """The rows of triples over which the clamp may stand, and the keys that these are ranked by."""
        arm_at, arm = self.arms(rows)
        open_ = arm > 0
        rows, arm_at, arm = rows[open_], arm_at[open_], arm[open_]
        best_at, need = self.least_forces(rows, arm_at)
        standing = self.triangles.take(rows).sides(self.search.center).min(axis=1)
        given = self.given_at(rows)
        keys: list[tuple[float, ...]] = []
        point = self.search.request.point
        forces = self.largest_forces(rows, best_at, need)
        if point is not None and given.any():
            fixed = np.broadcast_to(np.array(point), (len(rows), 2))
            need = np.where(given, self.needed_at(rows, fixed), need)
            arm = np.where(given, self.triangles.take(rows).sides(np.array(point)).min(axis=1), arm)
            forces = np.where(given, self.largest_forces(rows, fixed, need), forces)
        for k, row in enumerate(rows):
            last = (-round(float(standing[k]), FIGURE_DECIMALS), float(row))
            late = float(point is not None and not given[k])
            if self.search.loads:
                figures = (coarse(need[k]), coarse(forces[k]), -round(float(arm[k]), FIGURE_DECIMALS))
                keys.append((late, *figures, *last))
            else:
                keys.append((late, -coarse(arm[k]), *last))
        return rows, keys

    def given_at(self, rows: IntArray) -> NDArray[np.bool_]:
        """Over which triples the clamp may stand at the point asked for; none where none was."""
        point = self.search.request.point
        if point is None or not self.places.allows(np.array([point]))[0]:
            return np.zeros(len(rows), np.bool_)
        sides = self.triangles.take(rows).sides(np.array(point)).min(axis=1)
        return np.asarray(sides >= self.search.request.inside - GAP_SLACK)

    def needed_at(self, rows: IntArray, points: Array) -> Array:
        """The clamp force needed at points (N, 2), one of each triple."""
        shares = self.triangles.take(rows).shares(points[:, None])[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.maximum((self.reach[rows] / shares).max(axis=1), 0.0))

    def largest_forces(self, rows: IntArray, points: Array, need: Array) -> Array:
        """The largest force on a support at the clamp force needed."""
        shares = self.triangles.take(rows).shares(points[:, None])[:, 0]
        return np.asarray(np.maximum((need[:, None] * shares + self.most[rows]).max(axis=1), 0.0))

    def all_ranked(self) -> tuple[int, IntArray]:
        """How many triples are valid, and all of them, the best first."""
        found, keys = [], []
        for first in range(0, len(self.numbers), BLOCK):
            rows, ranks = self.judged(np.arange(first, min(first + BLOCK, len(self.numbers))))
            found += rows.tolist()
            keys += ranks
        order = sorted(range(len(found)), key=keys.__getitem__)
        return len(found), np.array([found[k] for k in order], np.int64)

    def best(self, count: int) -> tuple[int | None, IntArray]:
        """The best triples; their number is None where not all were looked at."""
        if self.search.loads:
            bound = np.maximum(self.reach, 0.0).sum(axis=1)
        else:
            bound = -1.0 / self.triangles.steepness.sum(axis=1)
        late = np.zeros(len(bound))
        if self.search.request.point is not None:
            late = (~self.given_at(np.arange(len(bound)))).astype(np.float64)
        order = np.lexsort((bound, late))
        kept: list[tuple[tuple[float, ...], int]] = []
        looked = 0
        step = max(count, 32)
        while looked < len(order):
            rows, keys = self.judged(np.sort(order[looked : looked + step]))
            looked = min(looked + step, len(order))
            kept = sorted([*kept, *zip(keys, rows.tolist(), strict=True)])[:count]
            if looked < len(order) and len(kept) == count:
                after = order[looked]
                if (late[after], self.coarse_bound(float(bound[after]))) > kept[-1][0][:2]:
                    break
            step = min(2 * step, BLOCK)
        everything = looked == len(order) and len(kept) < count
        return len(kept) if everything else None, np.array([row for _, row in kept], np.int64)

    def coarse_bound(self, bound: float) -> float:
        """The bound as the ranking counts it, a little lower than rounding may have made it."""
        return coarse(bound - GAP_SLACK * abs(bound))

    def figures_at(self, row: int, point: Array) -> ClampFigures:
        """The figures of one triple with the clamp at a point."""
        rows, at = np.array([row]), point[None]
        one = self.triangles.take(rows)
        shares, need = one.shares(point)[0], float(self.needed_at(rows, at)[0])
        loaded = bool(self.search.loads)
        return ClampFigures(
            at=(float(point[0]), float(point[1])),
            clamp_needed=need if loaded else 0.0,
            support_force=float(self.largest_forces(rows, at, np.array([need]))[0]) if loaded else None,
            arm=float(one.sides(point).min()),
            share=float(shares.min()),
            lift=max(0.0, float((self.lifted[row] / shares).max())),
        )

    def described(self, rows: IntArray) -> tuple[Triple, ...]:
        """Triples with their figures."""
        if not len(rows):
            return ()
        search, request = self.search, self.search.request
        arm_at, arm = self.arms(rows)
        best_at, _ = self.least_forces(rows, arm_at)
        given = self.given_at(rows)
        some = self.triangles.take(rows)
        standing = some.sides(search.center).min(axis=1)
        points = [point for load in search.loads for point in load.points]
        outside = np.full(len(rows), -inf)
        for point in points:
            outside = np.maximum(outside, -some.sides(np.array(point)).min(axis=1))
        out = []
        for k, row in enumerate(rows.tolist()):
            place, travel = self.rows[row], float(self.standing.travel[self.rows[row]])
            spare = min(
                float(self.holes.spare[self.numbers[row]].min()),
                float(self.standing.spare[place]),
                float(arm[k]) - request.inside,
            )
            out.append(
                Triple(
                    supports=tuple(self.support(int(hole)) for hole in self.numbers[row]),
                    travel=travel if isfinite(travel) else None,
                    marginal=spare < AGREEMENT,
                    standing=float(standing[k]),
                    overhang=float(outside[k]) if points else None,
                    arm=float(arm[k]),
                    arm_at=(float(arm_at[k, 0]), float(arm_at[k, 1])),
                    best=self.figures_at(row, best_at[k]),
                    given=self.figures_at(row, np.array(request.point)) if given[k] else None,
                )
            )
        return tuple(out)

    def support(self, hole: int) -> SupportPad:
        """One support."""
        holes = self.holes
        x, y = holes.points[hole]
        name = self.search.query.toolkit.carriers[holes.carrier[hole]].name
        return SupportPad(name, int(holes.column[hole]), int(holes.row[hole]), float(x), float(y))


def supports_of(
    fixture: Fixture,
    query: Query,
    request: SupportRequest,
    loads: Sequence[Load | SpatialLoad] | None = None,
    jaw_force: float | None = None,
    best: int | None = None,
) -> Supports:
    """The supports of one planar fixture, the best first.

    Parameters
    ----------
    fixture, query : a planar fixture, and the part and toolkit it was asked for.
    request : what supports and clamp are.
    loads : those of the query if None; planar ones act at the top of the part.
    jaw_force : in N; by default the one that keeps all pegs in contact.
    best : how many triples to list; None lists all.

    Raises
    ------
    InputError
        For pads too large for the holes, and a jaw force too small for a load.
    """
    asked = spatial(query.loads if loads is None else loads, request.thickness)
    return SupportSearch(query, request, asked).supports(fixture, checked_force(jaw_force), best)


def supports_of_best(
    fixtures: Iterable[Fixture],
    query: Query,
    request: SupportRequest,
    loads: Sequence[Load | SpatialLoad] | None = None,
    jaw_force: float | None = None,
    each: int = 3,
) -> tuple[Supports, ...]:
    """The best triples of each of some fixtures of a query; those without any have an empty list.

    Parameters
    ----------
    each : how many triples of each fixture; all other parameters as of :func:`supports_of`.
    """
    asked = spatial(query.loads if loads is None else loads, request.thickness)
    search, force = SupportSearch(query, request, asked), checked_force(jaw_force)
    return tuple(search.supports(fixture, force, each) for fixture in fixtures)
