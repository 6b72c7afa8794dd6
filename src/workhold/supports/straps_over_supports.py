"""The supports and the straps over some of them that hold a part down with the least force, exact over a finite set.

The part lies on three pads in holes of the plate, by the rules of ``supports.holes``, and each tip presses on it right
over one of them. So straps alone never tip it, and what holds at a force holds at every greater one. Every three pads
that are not on one line, with every choice of those that have a strap over them, make the finite set. Those from which
the part would fall before it is strapped come after those on which it stands.

As for straps over the plate (``supports.straps``) a motion of the part that locators and pads allow bounds the force of
other sets: of those whose pads allow it, too. Motions that all pads allow come first, as they bound every set.
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
from workhold.statics.strapped import StrappedPart, StrapsOnPart
from workhold.supports.choosing import list_triples
from workhold.supports.faces import TouchableFace, compute_area_center
from workhold.supports.holes import find_holes_under_face
from workhold.supports.strap_places import find_bolt_holes, find_top_face
from workhold.supports.straps_past_tools import are_clear, keep_clear

if TYPE_CHECKING:
    from workhold.supports.straps import StrapSearch

__all__ = ["StrappedTriple", "PadPlaces", "SupportedStraps", "find_middle", "stand_on"]

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
    """The holes that may hold a support at a seat, in order of columns and rows; lengths in mm in the plate's frame.

    Parameters
    ----------
    hole : (H, 2) column and row of each.
    at : (H, 2) of each.
    bolts : for each the holes for bolts from which a strap reaches it, the nearest first; none where no tip may stand.
    """

    hole: IntArray
    at: Array
    bolts: tuple[tuple[tuple[int, int], ...], ...]

    def __len__(self) -> int:
        return len(self.hole)

    @classmethod
    def of(cls, search: StrapSearch) -> PadPlaces:
        """The holes under the part of a search.

        Raises
        ------
        InputError
            For more of them than can be looked at.
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
    """For each place (H, 2) the holes for bolts from which a strap reaches it, as many as there are straps."""
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
    straps = query.toolkit.strap_set
    if asked.program is not None and straps is not None:
        one, other = np.nonzero(within)
        heights = search.measure_heights(at)[one]
        within[one, other] = are_clear(asked.program, fixture.pose, at[one], points[other], heights, straps)
    out = []
    for number in range(len(at)):
        near = np.flatnonzero(within[number])
        # Nearest first; of equal ones the first by column and row.
        near = near[np.argsort(apart[number, near].round(6), kind="stable")][: asked.straps.count]
        out.append(tuple((int(column), int(row)) for column, row in holes[near]))
    return tuple(out)


def find_middle(fixture: Fixture, workpiece: Workpiece) -> Array:
    """The middle (2,) of the area of the part of a fixture, in mm in the plate's frame."""
    x, y = compute_area_center(workpiece.loop_segments)
    return np.array(fixture.pose.apply(float(x), float(y)))


def stand_on(middle: Array, corners: Array) -> BoolArray:
    """Whether a point (2,) is over each of some triangles (N, 3, 2), or on a side."""
    along = np.roll(corners, -1, axis=1) - corners
    away = middle - corners
    sides = along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0]
    sides = sides / np.hypot(along[..., 0], along[..., 1])
    return np.asarray((sides >= -AGREEMENT).all(axis=1) | (sides <= AGREEMENT).all(axis=1))


@frozen
class StrappedTriple:
    """Three supports, by their numbers among the places, and those of them with a strap over them.

    Parameters
    ----------
    pads : numbers of the three, in order.
    strapped : numbers of those under straps, in order.
    """

    pads: tuple[int, ...]
    strapped: tuple[int, ...]


@define(eq=False)
class SupportedStraps:
    """The search for the supports of a seat and the straps over them.

    Parameters
    ----------
    search : at the seat.
    places : the holes that may hold a support.
    allowed : (H, M) whether each pad allows each motion that was found.
    work : (H, M) that a strap over each pad does on each motion, with its friction, per unit of force.
    power : (M,) of the load that drives each motion.
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
        """The part on all pads together."""
        return self.search.part_on(self.places.at)

    @cached_property
    def heights(self) -> Array:
        """The height (H,) in mm of the face over each pad."""
        return self.search.measure_heights(self.places.at)

    @cached_property
    def down(self) -> Array:
        """Wrenches (H, 6) of the unit force of a tip over each pad."""
        return self.whole.compute_level_wrenches(self.places.at, self.heights, (0.0, 0.0, -1.0))

    @cached_property
    def tip_friction(self) -> Array:
        """Wrenches (H, 16, 6) of unit forces of friction of a tip over each pad."""
        return self.whole.compute_friction_wrenches(self.places.at, self.heights)

    def on(self, chosen: StrappedTriple) -> StrapsOnPart:
        """The part on three supports, with straps."""
        part = evolve(self.whole, below=self.places.at[list(chosen.pads)])
        return self.strap(part, chosen.strapped)

    def strap(self, part: StrappedPart, strapped: Sequence[int]) -> StrapsOnPart:
        numbers = list(strapped)
        return StrapsOnPart(part, self.down[numbers], self.tip_friction[numbers], self.search.coefficient)

    def needs(self, chosen: StrappedTriple) -> tuple[float | None, ...]:
        """The force in N of each strap that each load asks for; None where none is enough."""
        return self.search.needs_of(self.on(chosen))

    def find_bolts(self, strapped: Sequence[int]) -> tuple[tuple[int, int], ...] | None:
        """The holes for the bolts of straps over some pads, the nearest that are all different; None without such."""
        lists = [list(enumerate(self.places.bolts[number])) for number in strapped]
        ways = [way for way in product(*lists) if len({hole for _, hole in way}) == len(way)]
        if not ways:
            return None
        best = min(ways, key=lambda way: (sum(rank for rank, _ in way), way))
        return tuple(hole for _, hole in best)

    @cached_property
    def combinations(self) -> tuple[tuple[int, ...], ...]:
        """Which pads can have straps over them together: with a bolt each, and tips side by side."""
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
        """All sets: three pads (N, 3), and the number (N,) of the combination of those under straps."""
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

    def stands(self, pads: IntArray) -> BoolArray:
        """Whether the part stands on sets of three pads (N, 3) before it is strapped: its centre is over them."""
        middle = find_middle(self.search.fixture, self.search.query.workpiece)
        return stand_on(middle, self.places.at[pads])

    def least(self, cancel: Event | None = None) -> StrappedTriple | None:
        """The supports and straps that need the least force; None where there are no such places.

        Sets on which the part stands come first. Where no force is enough it is the first set.
        """
        pads, strapped = self.list_sets()
        stands = self.stands(pads)
        first: StrappedTriple | None = None
        for chosen in (stands, ~stands):
            some, of = pads[chosen], strapped[chosen]
            if not len(some):
                continue
            number, force = self.least_of(some, of, cancel)
            found = StrappedTriple(tuple(some[number].tolist()), self.combinations[int(of[number])])
            if force < inf:
                return found
            first = first or found
        return first

    def least_of(self, pads: IntArray, strapped: IntArray, cancel: Event | None) -> tuple[int, float]:
        """The number of the set among some that needs the least force, and the force; infinite where none is enough."""
        members = np.array(self.combinations, np.int64).reshape(len(self.combinations), -1)[strapped]
        bounds, seen = self.bounds(pads, members), len(self.power)
        best, least = 0, inf
        while cancel is None or not cancel.is_set():
            number = int(bounds.argmin())
            if bounds[number] >= least * (1.0 - ALIKE) or bounds[number] == inf:
                break
            chosen = StrappedTriple(tuple(pads[number].tolist()), self.combinations[int(strapped[number])])
            if chosen.strapped not in self.relaxed:
                # On all pads together no more is needed than on three of them.
                self.relaxed.add(chosen.strapped)
                grip = self.strap(self.whole, chosen.strapped)
                self.search.reckon(grip, self.keep, inf)
            else:
                need = self.search.reckon(self.on(chosen), self.keep, least)
                if need < least:
                    best, least = number, need
                bounds[number] = inf
            bounds, seen = np.maximum(bounds, self.bounds(pads, members, seen)), len(self.power)
        return best, least

    def bounds(self, pads: IntArray, members: IntArray, since: int = 0) -> Array:
        """The least force (N,) that sets may need, by the motions from one on; infinite where none is enough."""
        out = np.zeros(len(pads))
        for number in range(since, len(self.power)):
            own, allowed = self.work[:, number], self.allowed[:, number]
            done = own[members].sum(axis=1)
            force = np.divide(self.power[number], done, out=np.full(len(out), inf), where=done > 0.0)
            np.maximum(out, np.where(allowed[pads].all(axis=1), force, 0.0), out=out)
        return out

    def keep(self, motion: Array, power: float) -> None:
        """Keeps a motion (6,) that a load drives with a power."""
        part, search = self.whole, self.search
        forces = part.pressing_below
        rubbed = (part.rubbing_below @ motion).max(axis=1, initial=0.0)
        pressed = forces @ motion + part.friction * rubbed
        size = 1.0 + np.abs(forces * motion).sum(axis=1) + part.friction * np.abs(rubbed)
        tips = (self.tip_friction @ motion).max(axis=1, initial=0.0)
        work = self.down @ motion + search.coefficient * tips
        self.allowed = np.column_stack([self.allowed, pressed <= 2.0 * BROKEN * size])
        self.work, self.power = np.column_stack([self.work, work]), np.append(self.power, power)
