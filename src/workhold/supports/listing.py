"""The triples of supports of planar fixtures: all of one, or exactly the best few of each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import inf, isfinite

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.conventions import AGREEMENT
from workhold.errors import InputError
from workhold.limits import convert_real, refuse_strong
from workhold.model.fixture import Fixture
from workhold.model.own_outlines import number_solid
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.model.support_request import Loops, SpatialLoad, SupportRequest
from workhold.model.support_triples import ClampFigures, SupportPad, Supports, Triple
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.supports.choosing import Stop, TripleChoice, WorkLimit
from workhold.supports.clamp_point import ClampPlaces, RankedPlaces
from workhold.supports.faces import LevelRegions, TouchableFace, compute_area_center
from workhold.supports.forces import (
    CornerTriples,
    HoleSides,
    PegForces,
    WeakJawError,
    compute_jaw_lift,
    count_worst_cases,
    find_needed_jaw_force,
)
from workhold.supports.holes import CarrierRoom, find_holes_under_face
from workhold.supports.program import add_program_zones, list_acting_loads

__all__ = ["SupportSearch", "yield_supports", "find_supports"]

Array = NDArray[np.float64]
Heights = Sequence[float] | None
# mm. A tip whose centre is at least this far from air below counts as partly over material.
OVER = 2e-6
# Number of sides of triangles, each under one load case, that take as long as one place of the clamp.
SIDES_A_PLACE = 5
# Largest number of holes; more would give too many triples.
MOST_POSITIONS = 1200


@define(frozen=True, eq=False)
class SupportSearch:
    """The search for supports under the fixtures of one part in one toolkit, with their common data.

    Parameters
    ----------
    query : query with the part and the toolkit.
    request : sizes and rules of supports and clamp.
    loads : loads whose heights are known.
    """

    query: Query
    request: SupportRequest
    loads: tuple[SpatialLoad, ...]
    touched: TouchableFeatures = field(init=False)
    bottom: TouchableFace = field(init=False)
    top: TouchableFace = field(init=False)
    center: Array = field(init=False)
    free_places: RankedPlaces | None = field(init=False)

    def __attrs_post_init__(self) -> None:
        workpiece, request = self.query.workpiece, self.request
        request.refuse_fat_pads(self.query.toolkit)
        for load in self.loads:
            if load.heights is not None and not 0 <= load.heights[0] <= load.heights[1] <= inf:
                raise InputError("a load acts below the part: give its height above the supports, 0 or more.")

        def make_face(loops: Loops | None, zones: Iterable[Array], heights: Heights = None) -> TouchableFace:
            return TouchableFace.from_loops(workpiece.loops if loops is None else loops, zones, heights)

        top_zones = (zone.loop for zone in request.top_zones)
        for name, value in (
            ("touched", TouchableFeatures.from_workpiece(workpiece, self.query.toolkit)),
            ("bottom", make_face(request.bottom, (zone.loop for zone in request.bottom_zones))),
            ("top", make_face(request.top, top_zones, request.top_heights)),
            ("center", compute_area_center(workpiece.loop_segments)),
        ):
            object.__setattr__(self, name, value)
        free = None if request.reach is not None else self.rank_places(None)
        object.__setattr__(self, "free_places", free)

    def find_places(self, fixture: Fixture) -> RankedPlaces:
        """Return the places at which the clamp's tip may stand over a fixture, in classes."""
        if self.free_places is not None:
            return self.free_places
        rings = np.array(self.request.reach).reshape(-1, 4)
        x, y = fixture.pose.inverse.apply(rings[:, 0], rings[:, 1])
        return self.rank_places(np.column_stack([x, y, rings[:, 2:]]))

    @property
    def heads(self) -> tuple[tuple[LevelRegions, float], ...]:
        """Regions that rise above the top faces, each with the least
        distance in mm of the clamp's centre from it.
        """
        asked = self.request
        return ((LevelRegions.from_loops(asked.rising, asked.rising_heights), asked.head_radius),)

    def rank_places(self, rings: Array | None) -> RankedPlaces:
        """Return the places of the tip in classes: entirely over material that reaches down to the plate,
        partly over it, anywhere.

        ``rings`` (R, 4) is the clamp's reach in the part's coordinates, see :class:`ClampPlaces`; None for no
        limit.
        """
        asked, heads = self.request, self.heads
        hanging = LevelRegions.from_loops(asked.hanging, asked.hanging_heights)
        kept_off = [(*heads, (hanging, away)) for away in (asked.tip_radius, OVER) if hanging.borders]
        return RankedPlaces(
            tuple(
                ClampPlaces(self.top, asked.tip_radius, rings, asked.tip_margin, regions)
                for regions in (*kept_off, heads)
            )
        )

    def find_supports(
        self,
        fixture: Fixture,
        jaw_force: float | None,
        best: int | None,
        cancel: Stop | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Supports:
        """Return the supports of a fixture: all triples, or the best
        ones; see the function :func:`find_supports`.

        ``best`` is the number of triples; None for all.

        Raises
        ------
        InputError
            For a jaw force too small for a load, and more holes or triples than can be examined.
        """
        toolkit, workpiece = self.query.toolkit, self.query.workpiece
        pegs = PegForces.from_fixture(fixture, toolkit, self.touched)
        force = find_needed_jaw_force(pegs, self.loads, jaw_force)
        solid = number_solid(workpiece)
        request = self.request.adapt_to_fixture(fixture, solid, self.query.peg_height, workpiece.numbered)
        holes = find_holes_under_face(fixture, toolkit, self.bottom, self.request)
        if len(holes.row) > MOST_POSITIONS:
            raise InputError(
                f"{len(holes.row):,} holes could hold a support, more than {MOST_POSITIONS:,}: give a larger "
                "pad margin, or places that no pad may stand under."
            )
        if isinstance(cancel, WorkLimit):
            cancel.done += len(holes.row) ** 2 * sum(map(count_worst_cases, self.loads)) // SIDES_A_PLACE
        choice = TripleChoice(
            HoleSides(holes.points, pegs, request.list_peg_bands(len(fixture.pegs)), self.loads, force),
            CarrierRoom.from_fixture(fixture, toolkit, holes),
            self.find_places(fixture),
            request.inside,
            self.center,
            None if request.point is None else np.array(request.point),
        )
        chosen = choice.choose(best, cancel, progress)
        triples = make_triples(choice, chosen.corners)
        return Supports(
            self.query,
            fixture,
            request,
            self.loads,
            force,
            len(holes.row),
            chosen.count,
            triples,
            chosen.stopped,
        )


def make_triples(choice: TripleChoice, corners: CornerTriples) -> tuple[Triple, ...]:
    """Return the chosen triples of a fixture with their figures, in the same order."""
    sides, room = choice.sides, choice.room
    if not len(corners.numbers):
        return ()
    arm_at, arm, _ = choice.find_best_arms(corners)
    best_at, need, _ = choice.find_least_forces(corners)
    free = np.isnan(best_at[:, 0])
    best_at[free] = arm_at[free]
    given = choice.find_allowed_at_given(corners)
    standing = sides.measure_distances(corners, choice.center).min(axis=1)
    points = [point for load in sides.loads for point in load.points]
    outside = np.full(len(need), -inf)
    for point in points:
        outside = np.maximum(outside, -sides.measure_distances(corners, np.array(point)).min(axis=1))
    stand = room.place_sets(corners.numbers)
    spare = np.minimum(room.holes.spare[corners.numbers].min(axis=1), arm - choice.inside)
    spare = np.minimum(spare, stand.spare)
    best = measure_clamp_places(choice, corners, best_at)
    at_point = measure_clamp_places(choice, corners, choice.repeat_given_point(corners))
    return tuple(
        Triple(
            supports=tuple(make_support_pad(room, hole) for hole in numbers),
            travel=float(stand.travel[k]) if isfinite(stand.travel[k]) else None,
            marginal=bool(spare[k] < AGREEMENT),
            standing=float(standing[k]),
            overhang=float(outside[k]) if points else None,
            arm=float(arm[k]),
            arm_at=(float(arm_at[k, 0]), float(arm_at[k, 1])),
            best=best[k],
            given=at_point[k] if given[k] else None,
        )
        for k, numbers in enumerate(corners.numbers.tolist())
    )


def measure_clamp_places(choice: TripleChoice, corners: CornerTriples, points: Array) -> list[ClampFigures]:
    """Return the figures of triples with the clamp at points (N, 2), one point for each triple."""
    sides = choice.sides
    need, force, arm = choice.compute_figures(corners, points)
    shares = sides.measure_distances(corners, points) / corners.heights
    lifted = compute_jaw_lift(sides.make_lines(corners.sides), sides.pegs, sides.bands) / corners.heights
    with np.errstate(divide="ignore", invalid="ignore"):
        lift = np.maximum((lifted / shares).max(axis=1), 0.0)
    loaded = bool(sides.loads)
    hangs = choice.places.find_hanging(points)
    return [
        ClampFigures(
            at=(float(points[k, 0]), float(points[k, 1])),
            clamp_needed=float(need[k]),
            support_force=float(force[k]) if loaded else None,
            arm=float(arm[k]),
            share=float(shares[k].min()),
            lift=float(lift[k]),
            hangs=bool(hangs[k]),
        )
        for k in range(len(need))
    ]


def make_support_pad(room: CarrierRoom, hole: int) -> SupportPad:
    """Return the pad in a hole, given by its index."""
    holes = room.holes
    x, y = holes.points[hole].tolist()
    name = room.toolkit.carriers[holes.carrier[hole]].name
    return SupportPad(name, int(holes.column[hole]), int(holes.row[hole]), x, y)


def to_spatial_loads(loads: Iterable[Load | SpatialLoad], thickness: float) -> tuple[SpatialLoad, ...]:
    """Return loads as loads in space; missing heights are set to the part's thickness in mm."""
    every = (load if isinstance(load, SpatialLoad) else SpatialLoad.from_planar_load(load) for load in loads)
    return tuple(load.with_height(thickness) for load in every)


def check_jaw_force(jaw_force: float | None) -> float | None:
    """Return a jaw force in N as a float; None for None.

    Raises
    ------
    InputError
        For a jaw force that is negative, not finite, too large, or no number.
    """
    if jaw_force is None:
        return None
    if not (isfinite(convert_real(jaw_force, "jaw force")) and convert_real(jaw_force) >= 0):
        raise InputError(f"jaw force {convert_real(jaw_force):g} cannot be used: give 0 or more.")
    refuse_strong("jaw force", convert_real(jaw_force))
    return convert_real(jaw_force)


def find_supports(
    fixture: Fixture,
    query: Query,
    request: SupportRequest,
    loads: Sequence[Load | SpatialLoad] | None = None,
    jaw_force: float | None = None,
    best: int | None = None,
    *,
    cancel: Stop | None = None,
    progress: Callable[[float], None] | None = None,
) -> Supports:
    """Return the supports of one planar fixture, the best first.

    Parameters
    ----------
    fixture, query : a planar fixture, and the query with its part and toolkit.
    request : sizes and rules of supports and clamp.
    loads : loads; None for those of the query. Planar loads act at the top of the part.
    jaw_force : in N; None for the least one that keeps all pegs in contact.
    best : number of triples to list; None for all.
    cancel : when set, the search stops soon, with the best triples examined so far.
    progress : called with the fraction done.

    Raises
    ------
    InputError
        For pads too large for the holes, and a jaw force too small for a load. For more holes than can be
        examined, and for all triples where there are too many.
    """
    asked = (query, request, loads, jaw_force, best)
    return next(yield_supports((fixture,), *asked, cancel=cancel, progress=progress))


def yield_supports(
    fixtures: Sequence[Fixture],
    query: Query,
    request: SupportRequest,
    loads: Sequence[Load | SpatialLoad] | None = None,
    jaw_force: float | None = None,
    each: int | None = 3,
    *,
    drops_weak_force: bool = False,
    cancel: Stop | None = None,
    progress: Callable[[float], None] | None = None,
) -> Iterator[Supports]:
    """Yield the supports of each of some fixtures of a query, in order, as they are found.

    The iteration stops early once cancelled.

    Parameters
    ----------
    each : number of triples of each fixture; None for all.
    drops_weak_force : whether a jaw force too small for a load is replaced by the one needed, instead of an
        error.

    The other parameters are as in :func:`find_supports`.
    """
    acting = list_acting_loads(query, request.thickness) if loads is None else loads
    asked = to_spatial_loads(acting, request.thickness)
    search = SupportSearch(query, add_program_zones(request, query.workpiece, query.program), asked)
    force = check_jaw_force(jaw_force)
    for number, fixture in enumerate(fixtures):

        def share(fraction: float, before: int = number) -> None:
            if progress is not None:
                progress((before + fraction) / len(fixtures))

        try:
            found = search.find_supports(fixture, force, each, cancel, share)
        except WeakJawError:
            if not drops_weak_force:
                raise
            found = search.find_supports(fixture, None, each, cancel, share)
        yield found
        if found.stopped:
            return
