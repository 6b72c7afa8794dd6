"""Proof of the seating that a result states for a fixture, from the outline, the pegs and its numbers alone.

Of a seat its pose, difference and contacts are given. Each contact must touch to ``AGREEMENT``, checked in
balls, and no peg may be in the part. Forces h >= 0 along the normals must balance on the part, while those of
the pegs that move add up to one along their way. So a stated seat or pass that is none is refuted. That none
is missing cannot be seen from a file.

Glossary
--------
local : a place in the part's own frame, as drawn, also where the part is turned over (x to -x).
wrench : force on the part along x and y, moment about its centre in parts of its arm, and share of the pegs
    that move, along their way.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import combinations, pairwise
from math import hypot, radians, sin
from typing import Any

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.verification.ball_geometry import BallOutline, Point, minus, norm
from workhold.verification.contacts import BallPose
from workhold.verification.listing import Claim
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.rules.travel import travelled
from workhold.verification.seating_contacts import (
    PRESSES,
    FloatOutline,
    PartPlacement,
    StatedContact,
    balances,
    stop_of,
    touching_faults,
    touching_peg,
    touching_wall,
)
from workhold.verification.tolerances import AGREEMENT, SAME_PLACE, SAME_PLACE_SPARE

__all__ = ["SeatingJudge", "StatedSeating"]

Array = NDArray[np.float64]
# Files have nine decimals, of numbers that follow from others that are rounded so.
ROUNDED = 4e-9
# No unit. Balance of forces per unit of clamping force.
BALANCED = 1e-6
# No unit. The relative error of the friction at which the part can stick; it is not below the second number
# where the part never can.
FRICTION, MOST_FRICTION = 1e-5, 50.0
STRICT = ("fixture", "corner", "pocket", "curved")


@define(slots=False)
class SeatingJudge:
    """Judges the seating of the fixtures of a query."""

    query: Query

    @cached_property
    def hardware(self) -> ToolkitRules:
        return ToolkitRules(self.query.toolkit)

    @cached_property
    def outline(self) -> BallOutline:
        """The part in balls."""
        return BallOutline.of(self.query.workpiece)

    @cached_property
    def rough(self) -> FloatOutline:
        """The part in doubles."""
        return FloatOutline.of(self.outline.segments, self.query.workpiece)

    def fault(self, fixture: Fixture) -> str:
        """What is wrong with the seating of a fixture, a sentence without a full stop; empty for nothing."""
        claim: Claim | None = fixture.seating
        if claim is None:
            return ""
        if len(fixture.travels) > 1:
            return "its seating is stated, and with two clamps there is none"
        return next((f"its seating: {words}" for words in StatedSeating(self, fixture, claim).faults()), "")


@define(slots=False)
class StatedSeating:
    """A fixture and what is claimed of its seating."""

    judge: SeatingJudge
    fixture: Fixture
    claim: Claim

    @property
    def fields(self) -> Mapping[str, Any]:
        return self.claim.fields

    @cached_property
    def moving(self) -> list[bool]:
        return [any(self.judge.hardware.way(peg)) for peg in self.fixture.pegs]

    @cached_property
    def way(self) -> tuple[float, float]:
        """Along which they move as their travel grows."""
        return self.judge.hardware.way(self.fixture.pegs[self.moving.index(True)])

    @cached_property
    def on_wall(self) -> list[int]:
        """Which of the pegs are ends of the contact with a wall."""
        carriers = [self.judge.hardware.carriers[peg.carrier] for peg in self.fixture.pegs]
        return [number for number, carrier in enumerate(carriers) if not carrier.contact.is_placed]

    @property
    def travel(self) -> float:
        """How far in mm what moves has gone, of a clamp by where its tip is."""
        if self.fixture.direction is None:
            return self.fixture.jaw_separation
        tip = self.fixture.pegs[self.moving.index(True)]
        return travelled(tip, self.judge.hardware.carriers[tip.carrier])

    @property
    def clamping(self) -> int:
        """1 where the travel gets less as it clamps, -1 where it gets more."""
        return self.judge.query.toolkit.clamping

    def faults(self) -> Iterator[str]:
        seats = self.fields["seats"]
        own = [place for place, seat in enumerate(self.claim.seating.seats) if seat.is_own]
        if len(own) != 1:
            yield f"it has {len(own)} seats in the fixture's own pose"
            return
        mine = seats[own[0]]
        if abs(mine["jaw_separation"] - self.travel) > AGREEMENT:
            yield "the separation of the fixture's own seat is not the fixture's"
        of_peg = {contact["peg"]: contact for contact in mine["contacts"]}
        is_own = len(of_peg) == len(mine["contacts"]) == len(self.fixture.pegs)
        is_own = is_own and all(map(self.is_own, of_peg.values()))
        if mine["kind"] != "fixture" or not is_own:
            yield "the fixture's own seat does not have the fixture's contacts"
        order = [seat["jaw_separation"] for seat in seats]
        if any(one > other + ROUNDED for one, other in pairwise(order)):
            yield "the seats are not in the order of their separations"
        for number, seat in enumerate(seats, 1):
            for words in self.seat_faults(seat, mine):
                yield f"seat {number} {words}"
        yield from self.figure_faults(mine)
        yield from self.pass_faults(mine)

    def seat_faults(self, seat: Mapping[str, Any], own: Mapping[str, Any]) -> Iterator[str]:
        apart = seat["jaw_separation"] - own["jaw_separation"]
        if abs(apart - seat["difference"]) > ROUNDED:
            yield "has a difference that is not that of the separations"
        place = PartPlacement.of(seat["pose"], seat["mirrored"])
        covers = self.covers(place)
        if covers is not None and covers != seat["same_place"]:
            yield "does not say rightly whether the part covers the same place"
        stop = self.fields["stop"]
        if stop is not None and self.clamping * (seat["jaw_separation"] - stop) < -ROUNDED:
            yield "lies beyond the stop"
        if seat["kind"] == "unsettled":
            return
        yield from self.freedom_faults(place, apart)
        contacts = [self.touching(contact, place, apart) for contact in seat["contacts"]]
        yield from touching_faults(contacts, self.on_wall, self.judge.hardware.wall_noun)
        if self.kind_of(seat) != seat["kind"] and seat["kind"] != "loose":
            yield f"is called {seat['kind']}, which its contacts are not"
        if seat["kind"] in STRICT and len(seat["forces"]) != len(contacts):
            yield "does not have a force for each contact"
        elif seat["kind"] in STRICT and not self.balance(contacts, place, seat["forces"]):
            yield "is no equilibrium of its forces"
        elif seat["kind"] == "loose" and not balances(self.wrenches(contacts, place), BALANCED):
            yield "is no equilibrium of its contacts"

    def is_own(self, contact: Mapping[str, int]) -> bool:
        """Whether a contact in the fixture's pose is the fixture's: on its face, or at its end on a wall."""
        peg = self.fixture.pegs[contact["peg"]]
        if contact["peg"] not in self.on_wall:
            return contact.get("face") == peg.face
        touched = self.touching(contact, self.lying, 0.0).at
        return bool(norm(minus(touched, self.ends[contact["peg"]])) < AGREEMENT)

    @cached_property
    def lying(self) -> PartPlacement:
        return PartPlacement(self.fixture.pose.theta_deg, self.fixture.pose.x, self.fixture.pose.y)

    @cached_property
    def ends(self) -> list[Point]:
        """Where each peg of the fixture, or end of its wall, touches; not every file says so of a wall."""
        contacts = self.judge.hardware.contacts(self.fixture, self.judge.outline)
        return [contact.place(BallPose.written(self.fixture.pose)) for contact in contacts]

    def kind_of(self, seat: Mapping[str, Any]) -> str:
        """What a seat is called with its contacts."""
        contacts = seat["contacts"]
        if len(contacts) < 4:
            return "curved"
        if len({contact["peg"] for contact in contacts}) < 4:
            return "pocket"
        # Where a part lies flush on a wall it has corners on it.
        is_corner = any("corner" in one and one["peg"] not in self.on_wall for one in contacts)
        return "corner" if is_corner else "fixture"

    def figure_faults(self, own: Mapping[str, Any]) -> Iterator[str]:
        """Figures that do not follow from seats and contacts."""
        fields = self.fields
        opening, factor, reading = (fields[key] for key in ("capture_opening", "room_factor", "reading"))
        if abs(sum(own["forces"]) - factor) > BALANCED:
            yield "room_factor is not the sum of the forces"
        drop = None if opening is None else opening / factor
        if not agree(drop, fields["drop_room"]):
            yield "drop_room is not the capture opening over room_factor"
        wrong = [seat for place, seat in enumerate(fields["seats"]) if self.counts(place, seat)]
        if len(wrong) != fields["wrong_seats"]:
            yield f"wrong_seats says {fields['wrong_seats']}, and {len(wrong)} of its seats are"
        nearest = min((abs(seat["difference"]) for seat in wrong), default=None)
        if not agree(nearest, reading):
            yield "reading is not the least difference of a wrong seat"
        unsettled = any(seat["kind"] == "unsettled" for seat in fields["seats"])
        if unsettled and not fields["unsettled"]:
            yield "a seat is unsettled, and unsettled does not say so"
        out = fields["way_out"]
        if out is not None and (opening is None or out < opening - ROUNDED):
            yield "the way out is nearer than the capture opening"
        yield from self.friction_faults(self.claim.seating.sticking_friction, own)
        if not agree(
            stop_of(self.fixture.pegs, self.judge.query.toolkit, self.travel), fields["stop"], AGREEMENT
        ):
            yield "stop is not where what moves is stopped without the part"

    def counts(self, place: int, seat: Mapping[str, Any]) -> bool:
        """Whether a seat is a wrong one that counts."""
        seating, query = self.claim.seating, self.judge.query
        if seating.seats[place].is_own or seat["same_place"]:
            return False
        if query.opening is not None and not self.clamping * seat["difference"] < query.opening:
            return False
        return seating.most is None or seat["jaw_separation"] <= seating.most

    def pass_faults(self, own: Mapping[str, Any]) -> Iterator[str]:
        """What is wrong with the pass, the cage and the placing."""
        fields = self.fields
        opening, top, cage, placing = (fields[key] for key in ("capture_opening", "pass", "cage", "placing"))
        if top is None:
            if opening is not None and (opening != 0.0 or not fields["unsettled"]):
                yield "there is a capture opening without a pass"
            if cage is not None or placing is not None:
                yield "there is a cage or a placing without a pass"
            return
        if opening is None:
            yield "there is a pass without a capture opening"
            return
        rise = top["jaw_separation"] - own["jaw_separation"]
        if abs(self.clamping * rise - opening) > ROUNDED:
            yield "the pass is not at the capture opening"
        there = PartPlacement.of(top["pose"])
        contacts = [self.touching(contact, there, rise) for contact in top["contacts"]]
        if not 2 <= len(contacts) <= 3:
            yield "the pass does not have two or three contacts"
        faults = touching_faults(contacts, self.on_wall, self.judge.hardware.wall_noun)
        yield from (f"the pass {words}" for words in faults)
        yield from (f"the pass {words}" for words in self.freedom_faults(there, rise))
        if not balances(self.wrenches(contacts, there), BALANCED):
            yield "the pass is no equilibrium of its contacts"
        (x, y), (u, v) = (self.center(place) for place in (there, PartPlacement.of(own["pose"])))
        turn = (top["pose"]["theta_deg"] - own["pose"]["theta_deg"] + 180.0) % 360.0 - 180.0
        away = hypot(x - u, y - v) + 2.0 * self.judge.rough.arm * sin(abs(radians(turn)) / 2.0)
        if placing is not None and placing > away + AGREEMENT:
            yield "placing is farther than the pass"
        for name, shift in () if cage is None else (("theta_deg", turn), ("x", x - u), ("y", y - v)):
            low, high = cage[name]
            if not low - AGREEMENT <= min(0.0, shift) <= max(0.0, shift) <= high + AGREEMENT:
                yield f"the cage leaves out the seat or its pass in {name}"

    def friction_faults(self, stated: float, own: Mapping[str, Any]) -> Iterator[str]:
        """Whether the part can stick below a friction, or cannot just above."""
        place = PartPlacement.of(own["pose"])
        contacts = [self.touching(contact, place, 0.0) for contact in own["contacts"]]
        low, high = stated * (1.0 - FRICTION), stated * (1.0 + FRICTION) + ROUNDED
        if min(low, MOST_FRICTION) > ROUNDED and self.sticks(contacts, place, min(low, MOST_FRICTION)):
            yield "the part can stick below the sticking friction"
        if high < MOST_FRICTION and not self.sticks(contacts, place, high):
            yield "the part cannot stick at the sticking friction"

    def sticks(self, contacts: Sequence[StatedContact], place: PartPlacement, friction: float) -> bool:
        """Whether three of four contacts balance inside their cones."""
        edges = np.hstack([self.wrenches(contacts, place, sign * friction) for sign in (1.0, -1.0)])
        for three in combinations(range(4), 3):
            columns = [k + 4 * side for k in three for side in (0, 1)]
            if balances(edges[:, columns]):
                return True
        return False

    def center(self, place: PartPlacement) -> tuple[float, float]:
        """Where the part's centre lies, in doubles."""
        x, y = place.placed(np.array([self.judge.query.workpiece.center]))[0].tolist()
        return x, y

    def peg(self, number: int, apart: float) -> tuple[float, float]:
        """A peg's centre when what moves has gone on by a length in mm."""
        peg, by = self.fixture.pegs[number], apart * self.moving[number]
        return peg.x + by * self.way[0], peg.y + by * self.way[1]

    def freedom_faults(self, place: PartPlacement, apart: float) -> Iterator[str]:
        """A peg in the part, or the part in a wall."""
        numbers = [number for number in range(len(self.moving)) if number not in self.on_wall]
        pegs = np.array([self.peg(number, apart) for number in numbers])
        carriers = self.judge.hardware.carriers
        radii = np.array([carriers[self.fixture.pegs[number].carrier].peg_radius for number in numbers])
        if not self.judge.rough.is_free(pegs, radii - AGREEMENT, place):
            yield "has a peg in the part"
        for wall in self.judge.hardware.walls:
            if self.judge.rough.lowest(place) < -AGREEMENT:
                yield f"has the part in the {wall.noun}"

    def covers(self, place: PartPlacement) -> bool | None:
        """Whether the part covers the place that it has in the fixture; None where that is nearly so."""
        away = self.judge.rough.farthest(place, self.lying)
        is_near = SAME_PLACE / SAME_PLACE_SPARE < away < SAME_PLACE * SAME_PLACE_SPARE
        return None if is_near else away < SAME_PLACE

    def touching(self, contact: Mapping[str, int], place: PartPlacement, apart: float) -> StatedContact:
        """A contact of the part as it lies, in balls."""
        number = contact["peg"]
        if number in self.on_wall:
            return touching_wall(self.judge.outline, contact, place)
        radius = self.judge.hardware.carriers[self.fixture.pegs[number].carrier].peg_radius
        return touching_peg(self.judge.outline, contact, place, self.peg(number, apart), radius)

    def wrenches(
        self, contacts: Sequence[StatedContact], place: PartPlacement, friction: float = 0.0
    ) -> Array:
        """Wrenches (4, K) of contacts that press along normals and, by friction, along tangents."""
        cx, cy = self.center(place)
        columns = []
        for one in contacts:
            nx, ny = (float(part.mid()) for part in one.normal)
            fx, fy = -nx - friction * ny, -ny + friction * nx
            x, y = (float(part.mid()) for part in one.at)
            moment = ((x - cx) * fy - (y - cy) * fx) / self.judge.rough.arm
            borne = -self.clamping * (fx * self.way[0] + fy * self.way[1]) * self.moving[one.peg]
            columns.append((fx, fy, moment, borne))
        return np.array(columns).reshape(-1, 4).T

    def balance(
        self, contacts: Sequence[StatedContact], place: PartPlacement, forces: Sequence[float]
    ) -> bool:
        """Whether forces balance, those of the pegs that move adding up to one."""
        left = self.wrenches(contacts, place) @ np.array(forces) - [0.0, 0.0, 0.0, 1.0]
        return bool(np.abs(left).max() < BALANCED * (1.0 + sum(forces)) and min(forces) > -PRESSES)


def agree(derived: float | None, written: float | None, spare: float = ROUNDED) -> bool:
    if derived is None or written is None:
        return derived is written
    return abs(derived - written) <= spare
