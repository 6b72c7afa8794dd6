"""Supports, and straps over some of them, that hold a part down with the least force; exact over a finite
set.

The part lies on three pads in holes of the plate, by the rules of ``supports.holes``, and each tip presses on
it directly over one of the pads. So straps alone never tip the part, and straps that hold at a force hold at
every greater force. The finite set has all triples of pads not on one line, each with every choice of the
pads under a strap. Three pads from which the part would fall before it is strapped come after those on which
it stands.

As for straps over the plate (``supports.straps``), a motion of the part that locators and pads allow bounds
the force of other sets. Here it bounds only sets whose pads allow the motion, too. Motions that all pads
allow come first, since they bound every set.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import combinations, product
from math import inf
from threading import Event
from typing import TYPE_CHECKING

import numpy as np
from attrs import define, evolve, field, frozen
from numpy.typing import NDArray

from workhold.contact.swept import find_swept_below
from workhold.conventions import AGREEMENT, GAP_SLACK
from workhold.errors import InputError
from workhold.model.fixture import Fixture
from workhold.model.workpiece import Workpiece
from workhold.statics.friction import BROKEN
from workhold.statics.strapped import PressingTips, StrappedPart, StrapsOnPart
from workhold.supports.choosing import list_triples
from workhold.supports.faces import TouchableFace, compute_area_center
from workhold.supports.holes import find_holes_under_face
from workhold.supports.strap_places import find_bolt_holes, find_top_face
from workhold.supports.straps_past_tools import keep_clear

if TYPE_CHECKING:
    from workhold.supports.straps import StrapSearch

__all__ = ["StrappedTriple", "PadPlaces", "SupportedStraps", "find_middle", "contain_point"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
PADS = 3
# Holes under a part of which all sets of three are looked at.
MOST_PADS = 120
# By how much, of a force, sets are no better than one another.
ALIKE = 1e-9


@frozen(eq=False)
class PadPlaces:
    """The H holes that may hold a support under the part, in order of columns and rows.

    Lengths are in mm in the plate's frame.

    Parameters
    ----------
    hole : (H, 2) column and row of each hole.
    at : (H, 2) centre of each hole.
    bolts : for each hole the holes (column, row) for bolts from which a strap reaches it, the nearest first;
        empty where no tip may stand over it.
    """

    hole: IntArray
    at: Array
    bolts: tuple[tuple[tuple[int, int], ...], ...]

    def __len__(self) -> int:
        return len(self.hole)

    @classmethod
    def from_search(cls, search: StrapSearch) -> PadPlaces:
        """Return the holes that may hold a support under the part of a search.

        Raises
        ------
        InputError
            For more holes than can be examined.
        """
        fixture, query, asked = search.fixture, search.query, search.asked
        request, plate = asked.request, asked.find_plate(fixture)
        outline = [np.asarray(loop) for loop in query.workpiece.loops]
        if request.bottom is not None and not request.bottom:
            return cls(np.zeros((0, 2), np.int64), np.zeros((0, 2)), ())
        bottom = TouchableFace.from_loops(
            request.bottom or outline, (zone.loop for zone in request.bottom_zones)
        )
        found = find_holes_under_face(fixture, query.toolkit, bottom, request)
        hole = np.column_stack([found.column, found.row])
        most = [np.inf if count is None else count for count in (plate.columns, plate.rows)]
        least = [-np.inf if count is None else 0 for count in (plate.columns, plate.rows)]
        hole = hole[((hole >= least) & (hole < most)).all(axis=1)]
        if len(hole) > MOST_PADS:
            raise InputError(
                f"{len(hole)} holes under the part could hold a support, more than {MOST_PADS}: give supports a larger "
                "pad margin, or the plate a larger pitch."
            )
        at = np.column_stack(plate.compute_hole_center(hole[:, 0], hole[:, 1])).reshape(-1, 2)
        if asked.program is not None:
            below = np.column_stack(fixture.pose.inverse.apply(at[:, 0], at[:, 1]))
            swept = find_swept_below(asked.program, 0.0)
            clear = keep_clear(swept, asked.program, below, below, request.pad_radius)
            hole, at = hole[clear], at[clear]
        return cls(hole, at, list_reaching_bolts(search, at))


def list_reaching_bolts(search: StrapSearch, at: Array) -> tuple[tuple[tuple[int, int], ...], ...]:
    """Return for each place the holes (column, row) for bolts from
    which a strap reaches it, the nearest first.

    ``at`` (H, 2) are the places in mm. Each list has at most as many holes as there are straps; it is empty
    where no tip may stand.
    """
    fixture, query, asked = search.fixture, search.query, search.asked
    top = find_top_face(query.workpiece, asked.request)
    if top is None or not len(at):
        return ((),) * len(at)
    x, y = fixture.pose.inverse.apply(at[:, 0], at[:, 1])
    tip = top.measure_room(np.column_stack([x, y])) >= asked.straps.tip_radius - GAP_SLACK
    holes, points = find_bolt_holes(fixture, query.workpiece, query.toolkit, asked.straps)
    apart = np.hypot(*np.moveaxis(at[:, None] - points[None], 2, 0))
    least, most = asked.straps.reach
    within = (apart >= least - GAP_SLACK) & (apart <= most + GAP_SLACK) & tip[:, None]
    one, other = np.nonzero(within)
    within[one, other] = search.find_clear(at[one], points[other])
    out = []
    for number in range(len(at)):
        near = np.flatnonzero(within[number])
        # Nearest first; of equal ones the first by column and row.
        near = near[np.argsort(apart[number, near].round(6), kind="stable")][: asked.straps.count]
        out.append(tuple((int(column), int(row)) for column, row in holes[near]))
    return tuple(out)


def find_middle(fixture: Fixture, workpiece: Workpiece) -> Array:
    """Return the centre of the part's area (2,), in mm in the plate's frame."""
    x, y = compute_area_center(workpiece.loop_segments)
    return np.array(fixture.pose.apply(float(x), float(y)))


def contain_point(middle: Array, corners: Array) -> BoolArray:
    """Return a mask (N,): True for triangles that contain a point (2,), inside or on a side.

    ``corners`` (N, 3, 2) are those of the triangles, in either sense of rotation.
    """
    along = np.roll(corners, -1, axis=1) - corners
    away = middle - corners
    sides = along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0]
    sides = sides / np.hypot(along[..., 0], along[..., 1])
    return np.asarray((sides >= -AGREEMENT).all(axis=1) | (sides <= AGREEMENT).all(axis=1))


@frozen
class StrappedTriple:
    """Three supports, and those of them that have a strap over them; all given by index among the places.

    Parameters
    ----------
    pads : indices of the three supports, ascending.
    strapped : indices of the supports under straps, ascending.
    """

    pads: tuple[int, ...]
    strapped: tuple[int, ...]


@define(eq=False)
class SupportedStraps:
    """The search for the three supports, and the straps over them, that need the least force.

    A set is three pads, and a choice of those that have a strap over them. Pads are given by index in
    ``places``.

    Parameters
    ----------
    search : the search for straps of the fixture.
    places : the H holes that may hold a support.
    allowed : (H, M) whether each pad allows each of the M motions found so far.
    work : (H, M) work that a strap over each pad does on each motion, friction included, per N of force.
    power : (M,) power, on each motion, of the load that drives it.
    relaxed : choices of strapped pads whose force was already computed with the part on all pads.
    """

    search: StrapSearch
    places: PadPlaces
    allowed: BoolArray = field(init=False)
    work: Array = field(init=False)
    power: Array = field(init=False)
    relaxed: set[tuple[int, ...]] = field(init=False, factory=set)

    def __attrs_post_init__(self) -> None:
        count = len(self.places)
        self.allowed, self.work = np.zeros((count, 0), np.bool_), np.zeros((count, 0))
        self.power = np.zeros(0)

    @cached_property
    def whole(self) -> StrappedPart:
        """The part on all H pads together, without straps."""
        return self.search.make_part_on(self.places.at)

    @cached_property
    def tips(self) -> PressingTips:
        """Tips over all H pads."""
        return self.search.make_tips(self.whole, self.places.at)

    def place_straps(self, chosen: StrappedTriple) -> StrapsOnPart:
        """Return the part on three supports, with straps over some of them."""
        part = evolve(self.whole, below=self.places.at[list(chosen.pads)])
        return self.tips.press(chosen.strapped, part)

    def compute_needs(self, chosen: StrappedTriple) -> tuple[float | None, ...]:
        """Return, for each load, the force in N that each strap needs; None where no force holds the load."""
        return self.search.compute_needs_of(self.place_straps(chosen))

    def find_bolts(self, strapped: Sequence[int]) -> tuple[tuple[int, int], ...] | None:
        """Return holes (column, row) for the bolts of straps over some
        pads, all different and as near as possible.

        None where there are no such holes.
        """
        lists = [list(enumerate(self.places.bolts[number])) for number in strapped]
        ways = [way for way in product(*lists) if len({hole for _, hole in way}) == len(way)]
        if not ways:
            return None
        best = min(ways, key=lambda way: (sum(rank for rank, _ in way), way))
        return tuple(hole for _, hole in best)

    @cached_property
    def combinations(self) -> tuple[tuple[int, ...], ...]:
        """Sets of pads that can have straps over them at the same time: with different bolts, and tips that
        do not overlap.
        """
        count, apart = self.search.asked.straps.count, 2 * self.search.asked.straps.tip_radius
        free = [number for number in range(len(self.places)) if self.places.bolts[number]]
        return tuple(
            some
            for some in combinations(free, count)
            if all(
                np.hypot(*(self.places.at[a] - self.places.at[b])) >= apart - ALIKE
                for a, b in combinations(some, 2)
            )
            and self.find_bolts(some) is not None
        )

    def list_sets(self) -> tuple[IntArray, IntArray]:
        """Return all sets: (1) the three pads (N, 3), and (2) the index
        (N,) in ``combinations`` of the strapped pads.
        """
        index = {some: number for number, some in enumerate(self.combinations)}
        triples = list_triples(len(self.places))
        one, two, three = (self.places.hole[triples[:, k]] for k in range(PADS))
        across, beside = two - one, three - one
        triples = triples[across[:, 0] * beside[:, 1] != across[:, 1] * beside[:, 0]]
        pads, strapped = [np.zeros((0, PADS), np.int64)], [np.zeros(0, np.int64)]
        count = self.search.asked.straps.count
        for places in combinations(range(PADS), count):
            numbers = np.array(
                [index.get(tuple(some), -1) for some in triples[:, list(places)].tolist()], np.int64
            ).reshape(-1)
            pads.append(triples[numbers >= 0])
            strapped.append(numbers[numbers >= 0])
        return np.concatenate(pads), np.concatenate(strapped)

    def find_stable(self, pads: IntArray) -> BoolArray:
        """Return a mask (N,): True for three pads on which the part stands before it is strapped.

        The centre of the part's area must be over their triangle. ``pads`` is (N, 3).
        """
        middle = find_middle(self.search.fixture, self.search.query.workpiece)
        return contain_point(middle, self.places.at[pads])

    def find_least(self, cancel: Event | None = None) -> StrappedTriple | None:
        """Return the supports and straps that need the least force; None if there are no places for them.

        Sets on which the part is stable come first. If no force is enough, the first set is returned.
        """
        pads, strapped = self.list_sets()
        stands = self.find_stable(pads)
        first: StrappedTriple | None = None
        for chosen in (stands, ~stands):
            some, of = pads[chosen], strapped[chosen]
            if not len(some):
                continue
            number, force = self.find_least_of(some, of, cancel)
            found = StrappedTriple(tuple(some[number].tolist()), self.combinations[int(of[number])])
            if force < inf:
                return found
            first = first or found
        return first

    def find_least_of(self, pads: IntArray, strapped: IntArray, cancel: Event | None) -> tuple[int, float]:
        """Return (1) the index of the set that needs the least force, and
        (2) this force in N; inf where none is enough.

        ``pads`` (N, 3) and ``strapped`` (N,) are as :meth:`list_sets` returns them.
        """
        members = np.array(self.combinations, np.int64).reshape(len(self.combinations), -1)[strapped]
        bounds, seen = self.bound_forces(pads, members), len(self.power)
        best, least = 0, inf
        while cancel is None or not cancel.is_set():
            number = int(bounds.argmin())
            if bounds[number] >= least * (1.0 - ALIKE) or bounds[number] == inf:
                break
            chosen = StrappedTriple(tuple(pads[number].tolist()), self.combinations[int(strapped[number])])
            if chosen.strapped not in self.relaxed:
                # On all pads together no more is needed than on three of them.
                self.relaxed.add(chosen.strapped)
                self.search.compute_force(self.tips.press(chosen.strapped), self.keep_motion, inf)
            else:
                need = self.search.compute_force(self.place_straps(chosen), self.keep_motion, least)
                if need < least:
                    best, least = number, need
                bounds[number] = inf
            bounds, seen = np.maximum(bounds, self.bound_forces(pads, members, seen)), len(self.power)
        return best, least

    def bound_forces(self, pads: IntArray, members: IntArray, since: int = 0) -> Array:
        """Return lower bounds in N of the forces that sets need, (N,); inf
        where a motion shows that no force is enough.

        ``pads`` (N, 3) are the supports, ``members`` (N, K) the pads under straps. Only motions from index
        ``since`` on are used.
        """
        out = np.zeros(len(pads))
        for number in range(since, len(self.power)):
            own, allowed = self.work[:, number], self.allowed[:, number]
            done = own[members].sum(axis=1)
            force = np.divide(self.power[number], done, out=np.full(len(out), inf), where=done > 0.0)
            np.maximum(out, np.where(allowed[pads].all(axis=1), force, 0.0), out=out)
        return out

    def keep_motion(self, motion: Array, power: float) -> None:
        """Append a motion (6,) and the power of the load that drives it, for bounds."""
        part = self.whole
        forces = part.pressure_wrenches_below
        rubbed = (part.friction_wrenches_below @ motion).max(axis=1, initial=0.0)
        pressed = forces @ motion + part.friction * rubbed
        size = 1.0 + np.abs(forces * motion).sum(axis=1) + part.friction * np.abs(rubbed)
        self.allowed = np.column_stack([self.allowed, pressed <= 2.0 * BROKEN * size])
        self.work, self.power = (
            np.column_stack([self.work, self.tips.compute_work(motion)]),
            np.append(self.power, power),
        )
