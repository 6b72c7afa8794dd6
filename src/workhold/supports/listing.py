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
from workhold.model.own_outlines import numbered_solid
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.model.support_request import Loops, SpatialLoad, SupportRequest
from workhold.model.support_triples import ClampFigures, SupportPad, Supports, Triple
from workhold.statics.contact_matrix import Touched
from workhold.supports.choosing import Stop, TripleChoice, WorkLimit
from workhold.supports.clamp_point import ClampPlaces, RankedPlaces
from workhold.supports.faces import LevelRegions, TouchableFace, area_center
from workhold.supports.forces import (
    Corners,
    PegForces,
    Sides,
    WeakJawError,
    compute_jaw_lift,
    count_worst_cases,
    find_needed_jaw_force,
)
from workhold.supports.holes import CarrierRoom, find_holes_under_face
from workhold.supports.program import add_program_zones, list_acting_loads

__all__ = ["SupportSearch", "yield_supports", "supports_of"]

Array = NDArray[np.float64]
Heights = Sequence[float] | None
# How far in mm from the air beside it the middle of a tip is at least that counts as over material.
OVER = 2e-6
# Sides of triangles, each under one load, that take as long as a place of the clamp.
SIDES_A_PLACE = 5
# More holes than these leave more triples than can be looked at.
MOST_POSITIONS = 1200


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
    free_places: RankedPlaces | None = field(init=False)

    def __attrs_post_init__(self) -> None:
        workpiece, request = self.query.workpiece, self.request
        request.refuse_fat_pads(self.query.toolkit)
        for load in self.loads:
            if load.heights is not None and not 0 <= load.heights[0] <= load.heights[1] <= inf:
                raise InputError("a load acts below the part: give its height above the supports, 0 or more.")

        def face(loops: Loops | None, zones: Iterable[Array], heights: Heights = None) -> TouchableFace:
            return TouchableFace.of(workpiece.loops if loops is None else loops, zones, heights)

        top_zones = (zone.loop for zone in request.top_zones)
        for name, value in (
            ("touched", Touched.of(workpiece, self.query.toolkit)),
            ("bottom", face(request.bottom, (zone.loop for zone in request.bottom_zones))),
            ("top", face(request.top, top_zones, request.top_heights)),
            ("center", area_center(workpiece.loop_segments)),
        ):
            object.__setattr__(self, name, value)
        free = None if request.reach is not None else self.ranked_places(None)
        object.__setattr__(self, "free_places", free)

    def places(self, fixture: Fixture) -> RankedPlaces:
        """Where the tip may stand over a fixture."""
        if self.free_places is not None:
            return self.free_places
        rings = np.array(self.request.reach).reshape(-1, 4)
        x, y = fixture.pose.inverse.apply(rings[:, 0], rings[:, 1])
        return self.ranked_places(np.column_stack([x, y, rings[:, 2:]]))

    @property
    def heads(self) -> tuple[tuple[LevelRegions, float], ...]:
        """What rises above the faces, with the distance in mm that a head keeps its middle away from it."""
        asked = self.request
        return ((LevelRegions.of(asked.rising, asked.rising_heights), asked.head_radius),)

    def ranked_places(self, rings: Array | None) -> RankedPlaces:
        """Where the tip may stand: over material that reaches down, in part over such, and anywhere."""
        asked, heads = self.request, self.heads
        hanging = LevelRegions.of(asked.hanging, asked.hanging_heights)
        kept_off = [(*heads, (hanging, away)) for away in (asked.tip_radius, OVER) if hanging.borders]
        return RankedPlaces(
            tuple(
                ClampPlaces(self.top, asked.tip_radius, rings, asked.tip_margin, regions)
                for regions in (*kept_off, heads)
            )
        )

    def supports(
        self,
        fixture: Fixture,
        jaw_force: float | None,
        best: int | None,
        cancel: Stop | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Supports:
        """The supports of a fixture: all triples, or the best few; see :func:`supports_of`.

        Raises
        ------
        InputError
            For a jaw force too small for a load, and more holes or triples than can be looked at.
        """
        toolkit, workpiece = self.query.toolkit, self.query.workpiece
        pegs = PegForces.of(fixture, toolkit, self.touched)
        force = find_needed_jaw_force(pegs, self.loads, jaw_force)
        solid = numbered_solid(workpiece)
        request = self.request.for_fixture(fixture, solid, self.query.peg_height, workpiece.numbered)
        holes = find_holes_under_face(fixture, toolkit, self.bottom, self.request)
        if len(holes.row) > MOST_POSITIONS:
            raise InputError(
                f"{len(holes.row):,} holes could hold a support, more than {MOST_POSITIONS:,}: give a larger "
                "pad margin, or places that no pad may stand under."
            )
        if isinstance(cancel, WorkLimit):
            cancel.done += len(holes.row) ** 2 * sum(map(count_worst_cases, self.loads)) // SIDES_A_PLACE
        choice = TripleChoice(
            Sides(holes.points, pegs, request.peg_bands(len(fixture.pegs)), self.loads, force),
            CarrierRoom.of(fixture, toolkit, holes),
            self.places(fixture),
            request.inside,
            self.center,
            None if request.point is None else np.array(request.point),
        )
        chosen = choice.chosen(best, cancel, progress)
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


def make_triples(choice: TripleChoice, corners: Corners) -> tuple[Triple, ...]:
    """The triples of a fixture that were chosen, with their figures, in their order."""
    sides, room = choice.sides, choice.room
    if not len(corners.numbers):
        return ()
    arm_at, arm, _ = choice.arms(corners)
    best_at, need, _ = choice.least_forces(corners)
    free = np.isnan(best_at[:, 0])
    best_at[free] = arm_at[free]
    given = choice.given_at(corners)
    standing = sides.distances(corners, choice.center).min(axis=1)
    points = [point for load in sides.loads for point in load.points]
    outside = np.full(len(need), -inf)
    for point in points:
        outside = np.maximum(outside, -sides.distances(corners, np.array(point)).min(axis=1))
    stand = room.standing(corners.numbers)
    spare = np.minimum(room.holes.spare[corners.numbers].min(axis=1), arm - choice.inside)
    spare = np.minimum(spare, stand.spare)
    best = measure_clamp_places(choice, corners, best_at)
    at_point = measure_clamp_places(choice, corners, choice.given_points(corners))
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


def measure_clamp_places(choice: TripleChoice, corners: Corners, points: Array) -> list[ClampFigures]:
    """The figures of triples with the clamp at points (N, 2)."""
    sides = choice.sides
    need, force, arm = choice.figures_at(corners, points)
    shares = sides.distances(corners, points) / corners.heights
    lifted = compute_jaw_lift(sides.lines(corners.sides), sides.pegs, sides.bands) / corners.heights
    with np.errstate(divide="ignore", invalid="ignore"):
        lift = np.maximum((lifted / shares).max(axis=1), 0.0)
    loaded = bool(sides.loads)
    hangs = choice.places.hangs(points)
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
    holes = room.holes
    x, y = holes.points[hole].tolist()
    name = room.toolkit.carriers[holes.carrier[hole]].name
    return SupportPad(name, int(holes.column[hole]), int(holes.row[hole]), x, y)


def spatial(loads: Iterable[Load | SpatialLoad], thickness: float) -> tuple[SpatialLoad, ...]:
    """Loads as they act in space, with their heights written out."""
    every = (load if isinstance(load, SpatialLoad) else SpatialLoad.of(load) for load in loads)
    return tuple(load.at_height(thickness) for load in every)


def check_jaw_force(jaw_force: float | None) -> float | None:
    """A jaw force in N, or None; refuses one that is negative or no number."""
    if jaw_force is None:
        return None
    if not (isfinite(convert_real(jaw_force, "jaw force")) and convert_real(jaw_force) >= 0):
        raise InputError(f"jaw force {convert_real(jaw_force):g} cannot be used: give 0 or more.")
    refuse_strong("jaw force", convert_real(jaw_force))
    return convert_real(jaw_force)


def supports_of(
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
    """The supports of one planar fixture, the best first.

    Parameters
    ----------
    fixture, query : a planar fixture, and the part and toolkit it was asked for.
    request : what supports and clamp are.
    loads : those of the query if None; planar ones act at the top of the part.
    jaw_force : in N; by default the one that keeps all pegs in contact.
    best : how many triples to list; None lists all.
    cancel : when set, the search stops soon, and has the best of those it looked at.
    progress : called with the fraction done.

    Raises
    ------
    InputError
        For pads too large for the holes, and a jaw force too small for a load. For more holes than can be
        looked at, and for all triples where there are too many.
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
    """Yields the supports of each of some fixtures of a query as they are found.

    ``each`` is how many triples of each fixture, None for all; others are as of :func:`supports_of`.
    ``drops_weak_force`` says whether a jaw force that is too small for a load is left out, not refused.
    """
    acting = list_acting_loads(query, request.thickness) if loads is None else loads
    asked = spatial(acting, request.thickness)
    search = SupportSearch(query, add_program_zones(request, query.workpiece, query.program), asked)
    force = check_jaw_force(jaw_force)
    for number, fixture in enumerate(fixtures):

        def share(fraction: float, before: int = number) -> None:
            if progress is not None:
                progress((before + fraction) / len(fixtures))

        try:
            found = search.supports(fixture, force, each, cancel, share)
        except WeakJawError:
            if not drops_weak_force:
                raise
            found = search.supports(fixture, None, each, cancel, share)
        yield found
        if found.stopped:
            return
