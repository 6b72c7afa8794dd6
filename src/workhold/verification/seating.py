"""Whether the seating that a result tells of a fixture is so, from the outline, the pegs and the numbers told alone.

Of a seat its pose, difference and contacts are given. Each contact must touch to ``AGREEMENT``, asked in balls, no peg
may be in the part, and forces h >= 0 along the normals must balance on the part while those of the pegs that move add up to
one along their way. So a seat or a pass that is none is refuted; that none is missing no file shows.

Glossary
--------
local : a place in the part's own frame, as drawn, also where the part is turned over (x to -x).
wrench : of a contact the force on the part along x and y, its moment about the part's centre in parts of its arm, and how
    much of it the pegs that move bear along their way.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import combinations, pairwise
from math import hypot, radians, sin
from typing import Any

import numpy as np
from attrs import define, frozen
from flint import arb
from numpy.typing import NDArray

from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.verification.balls import Point, exact_point, norm, turned
from workhold.verification.claims import Claim
from workhold.verification.outline import Outline
from workhold.verification.part_in_floats import FloatOutline
from workhold.verification.rules import AGREEMENT, SAME_PLACE, SAME_PLACE_SPARE

__all__ = ["Judged", "SeatingJudge"]

Array = NDArray[np.float64]
# Files have nine decimals, of numbers that follow from others that are rounded so.
ROUNDED = 4e-9
# No unit. Balance of forces per unit of clamping force; a force above minus the second presses.
BALANCED, PRESSES = 1e-6, 1e-9
# No unit. Friction at which the part can stick is told to this part of it; where it never can, not below the second.
FRICTION, MOST_FRICTION = 1e-5, 50.0
STRICT = ("fixture", "corner", "pocket", "curved")


@frozen
class Touching:
    """A contact of a seat or a pass.

    Parameters
    ----------
    peg : its number.
    at, normal : in the toolkit's frame, in mm from its origin, where the part is touched, and the outward unit normal there.
    off : how far in mm the peg is from touching, at most.
    is_inside : whether what is touched is the inside of a face, or a corner.
    """

    peg: int
    at: Point
    normal: Point
    off: float
    is_inside: bool


@define(slots=False)
class SeatingJudge:
    """Judges the seating of the fixtures of a query."""

    query: Query

    @cached_property
    def outline(self) -> Outline:
        """The part in balls."""
        return Outline.of(self.query.workpiece)

    @cached_property
    def rough(self) -> FloatOutline:
        """The part in doubles."""
        return FloatOutline.of(self.outline.segments, self.query.workpiece)

    def fault(self, fixture: Fixture) -> str:
        """What is wrong with the seating told of a fixture, one sentence without a full stop; empty where all is so."""
        claim: Claim | None = fixture.seating
        if claim is None:
            return ""
        return next((f"its seating: {words}" for words in Judged(self, fixture, claim).faults()), "")


@define(slots=False)
class Judged:
    """A fixture and what is claimed of its seating."""

    judge: SeatingJudge
    fixture: Fixture
    claim: Claim

    @property
    def fields(self) -> Mapping[str, Any]:
        """As written."""
        return self.claim.fields

    @cached_property
    def moving(self) -> list[bool]:
        """Which pegs move."""
        return [self.judge.query.toolkit.carrier(peg.carrier).travel is not None for peg in self.fixture.pegs]

    @cached_property
    def way(self) -> tuple[float, float]:
        """Along which they move as their travel grows."""
        moving = next(peg for peg, moves in zip(self.fixture.pegs, self.moving, strict=True) if moves)
        travel = self.judge.query.toolkit.carrier(moving.carrier).travel
        assert travel is not None
        return travel.unit

    @property
    def clamping(self) -> int:
        """1 where the travel gets less as it clamps, -1 where it gets more."""
        return self.judge.query.toolkit.clamping

    def faults(self) -> Iterator[str]:
        """Everything that is wrong."""
        seats = self.fields["seats"]
        own = [place for place, seat in enumerate(self.claim.told.seats) if seat.is_own]
        if len(own) != 1:
            yield f"it tells {len(own)} seats in the fixture's own pose"
            return
        mine = seats[own[0]]
        if self.fixture.direction is None and abs(mine["jaw_separation"] - self.fixture.jaw_separation) > AGREEMENT:
            yield "the separation of the fixture's own seat is not the fixture's"
        faces = {peg: face.face for peg, face in enumerate(self.fixture.pegs)}
        told = {contact["peg"]: contact.get("face") for contact in mine["contacts"]}
        if mine["kind"] != "fixture" or told != faces or len(mine["contacts"]) != len(faces):
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
        """What is wrong with a seat."""
        apart = seat["jaw_separation"] - own["jaw_separation"]
        if abs(apart - seat["difference"]) > ROUNDED:
            yield "has a difference that is not that of the separations"
        place = self.covers(seat)
        if place is not None and place != seat["same_place"]:
            yield "does not say rightly whether the part covers the same place"
        stop = self.fields["stop"]
        if stop is not None and self.clamping * (seat["jaw_separation"] - stop) < -ROUNDED:
            yield "lies beyond the stop"
        if seat["kind"] == "unsettled":
            return
        if not self.is_free(seat["pose"], seat["mirrored"], apart):
            yield "has a peg in the part"
        contacts = [self.touching(contact, seat["pose"], seat["mirrored"], apart) for contact in seat["contacts"]]
        yield from touching_faults(contacts)
        if kind_of(seat) != seat["kind"] and seat["kind"] != "loose":
            yield f"is called {seat['kind']}, which its contacts are not"
        if seat["kind"] in STRICT and len(seat["forces"]) != len(contacts):
            yield "does not have a force for each contact"
        elif seat["kind"] in STRICT and not self.balance(contacts, seat["pose"], seat["mirrored"], seat["forces"]):
            yield "is no equilibrium of its forces"
        elif seat["kind"] == "loose" and not self.can_balance(contacts, seat["pose"], seat["mirrored"]):
            yield "is no equilibrium of its contacts"

    def figure_faults(self, own: Mapping[str, Any]) -> Iterator[str]:
        """Figures that do not follow from seats and contacts."""
        fields, told = self.fields, self.claim.told
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
        yield from self.friction_faults(told.sticking_friction, own)
        stop = self.stop
        if stop is not None and not agree(stop, fields["stop"], AGREEMENT):
            yield "stop is not where pegs of both jaws are the smallest gap apart"

    def counts(self, place: int, seat: Mapping[str, Any]) -> bool:
        """Whether a seat is a wrong one that counts."""
        told, query = self.claim.told, self.judge.query
        if told.seats[place].is_own or seat["same_place"]:
            return False
        if query.opening is not None and not self.clamping * seat["difference"] < query.opening:
            return False
        return told.most is None or seat["jaw_separation"] <= told.most

    @property
    def stop(self) -> float | None:
        """The smallest separation of a vise that closes; None of another toolkit, which is not looked at."""
        toolkit = self.judge.query.toolkit
        if toolkit.gap is None or self.clamping < 0:
            return None
        still, moved = ([p.x for p, m in zip(self.fixture.pegs, self.moving, strict=True) if m == s] for s in (0, 1))
        return toolkit.gap + max(still) - min(moved) + self.fixture.jaw_separation

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
        contacts = [self.touching(contact, top["pose"], False, rise) for contact in top["contacts"]]
        if not 2 <= len(contacts) <= 3:
            yield "the pass does not have two or three contacts"
        yield from (f"the pass {words}" for words in touching_faults(contacts))
        if not self.is_free(top["pose"], False, rise):
            yield "the pass has a peg in the part"
        if not self.can_balance(contacts, top["pose"], False):
            yield "the pass is no equilibrium of its contacts"
        center = self.judge.query.workpiece.center
        (x, y), (u, v) = (self.place(center, pose, False) for pose in (top["pose"], own["pose"]))
        turn = (top["pose"]["theta_deg"] - own["pose"]["theta_deg"] + 180.0) % 360.0 - 180.0
        away = hypot(x - u, y - v) + 2.0 * self.judge.rough.arm * sin(abs(radians(turn)) / 2.0)
        if placing is not None and placing > away + AGREEMENT:
            yield "placing is farther than the pass"
        for name, shift in () if cage is None else (("theta_deg", turn), ("x", x - u), ("y", y - v)):
            low, high = cage[name]
            if not low - AGREEMENT <= min(0.0, shift) <= max(0.0, shift) <= high + AGREEMENT:
                yield f"the cage leaves out the seat or its pass in {name}"

    def friction_faults(self, told: float, own: Mapping[str, Any]) -> Iterator[str]:
        """Whether the part can stick below the friction told, or cannot just above."""
        contacts = [self.touching(contact, own["pose"], False, 0.0) for contact in own["contacts"]]
        low, high = told * (1.0 - FRICTION), told * (1.0 + FRICTION) + ROUNDED
        if min(low, MOST_FRICTION) > ROUNDED and self.sticks(contacts, own["pose"], min(low, MOST_FRICTION)):
            yield "the part can stick below the sticking friction"
        if high < MOST_FRICTION and not self.sticks(contacts, own["pose"], high):
            yield "the part cannot stick at the sticking friction"

    def sticks(self, contacts: Sequence[Touching], pose: Mapping[str, float], friction: float) -> bool:
        """Whether three of four contacts balance inside their cones."""
        edges = np.hstack([self.wrenches(contacts, pose, False, sign * friction) for sign in (1.0, -1.0)])
        for three in combinations(range(4), 3):
            columns = [k + 4 * side for k in three for side in (0, 1)]
            if balances(edges[:, columns]):
                return True
        return False

    def place(self, point: Sequence[float], pose: Mapping[str, float], mirrored: bool) -> tuple[float, float]:
        """Where a point of the part lies in a pose, in doubles."""
        x, y = self.judge.rough.placed(np.array([point]), pose, mirrored)[0].tolist()
        return x, y

    def peg(self, number: int, apart: float) -> tuple[float, float]:
        """A peg's centre when what moves has gone on by a length in mm."""
        peg, by = self.fixture.pegs[number], apart * self.moving[number]
        return peg.x + by * self.way[0], peg.y + by * self.way[1]

    def is_free(self, pose: Mapping[str, float], mirrored: bool, apart: float) -> bool:
        """Whether no peg is in the part."""
        pegs = np.array([self.peg(number, apart) for number in range(len(self.moving))])
        carriers = (self.judge.query.toolkit.carrier(peg.carrier) for peg in self.fixture.pegs)
        radii = np.array([carrier.peg_radius for carrier in carriers])
        return self.judge.rough.is_free(pegs, radii - AGREEMENT, pose, mirrored)

    def covers(self, seat: Mapping[str, Any]) -> bool | None:
        """Whether the part in a seat covers the place of its fixture; None where that is nearly so."""
        away = self.judge.rough.farthest(seat["pose"], seat["mirrored"], vars_of(self.fixture))
        return None if SAME_PLACE / SAME_PLACE_SPARE < away < SAME_PLACE * SAME_PLACE_SPARE else away < SAME_PLACE

    def touching(self, contact: Mapping[str, int], pose: Mapping[str, float], mirrored: bool, apart: float) -> Touching:
        """A contact in a pose, in balls."""
        number = contact["peg"]
        x, y = self.peg(number, apart)
        sine, cosine = (arb(pose["theta_deg"]) / 180).sin_cos_pi()
        local = turned(exact_point(x - pose["x"], y - pose["y"]), cosine, -sine)
        local = (-local[0], local[1]) if mirrored else local
        outline = self.judge.outline
        radius = self.judge.query.toolkit.carrier(self.fixture.pegs[number].carrier).peg_radius
        face = contact.get("face")
        side = outline.faces.get(contact["corner"] if face is None else face)
        if side is None:
            return Touching(number, exact_point(x, y), exact_point(0.0, 0.0), float("inf"), False)
        if face is None:
            way, inside = (local[0] - side.start[0], local[1] - side.start[1]), True
            off = abs(norm(way) - radius)
        else:
            way, off = side.outward(local), abs(side.gap(local) - radius)
            inside = bool(abs(side.distance(local) - radius) < AGREEMENT)
        size = norm(way)
        normal = way[0] / size, way[1] / size
        normal = turned((-normal[0], normal[1]) if mirrored else normal, cosine, sine)
        at = arb(x) - radius * normal[0], arb(y) - radius * normal[1]
        return Touching(number, at, normal, float(off.upper()), inside)

    def wrenches(
        self, contacts: Sequence[Touching], pose: Mapping[str, float], mirrored: bool, friction: float = 0.0
    ) -> Array:
        """Wrenches (4, K) of contacts that press along their normals, and by friction along their tangents."""
        cx, cy = self.place(self.judge.query.workpiece.center, pose, mirrored)
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
        self, contacts: Sequence[Touching], pose: Mapping[str, float], mirrored: bool, forces: Sequence[float]
    ) -> bool:
        """Whether the forces told balance, those of the pegs that move adding up to one."""
        left = self.wrenches(contacts, pose, mirrored) @ np.array(forces) - [0.0, 0.0, 0.0, 1.0]
        return bool(np.abs(left).max() < BALANCED * (1.0 + sum(forces)) and min(forces) > -PRESSES)

    def can_balance(self, contacts: Sequence[Touching], pose: Mapping[str, float], mirrored: bool) -> bool:
        """Whether some forces do."""
        return balances(self.wrenches(contacts, pose, mirrored), BALANCED)


def vars_of(fixture: Fixture) -> dict[str, float]:
    """The pose of a fixture by its fields."""
    return {"theta_deg": fixture.pose.theta_deg, "x": fixture.pose.x, "y": fixture.pose.y}


def touching_faults(contacts: Sequence[Touching]) -> Iterator[str]:
    """Contacts that do not touch what they are said to touch, or are told twice."""
    if len({(one.peg, *(round(float(part.mid()), 5) for part in one.at)) for one in contacts}) < len(contacts):
        yield "has a contact twice"
    for one in contacts:
        if not (one.off < AGREEMENT and one.is_inside):
            yield f"has peg {one.peg} not where it is said to touch"


def kind_of(seat: Mapping[str, Any]) -> str:
    """What a seat is called with its contacts."""
    contacts = seat["contacts"]
    if len(contacts) < 4:
        return "curved"
    if len({contact["peg"] for contact in contacts}) < 4:
        return "pocket"
    return "corner" if any("corner" in contact for contact in contacts) else "fixture"


def agree(derived: float | None, written: float | None, spare: float = ROUNDED) -> bool:
    """Whether two numbers, or none, agree."""
    if derived is None or written is None:
        return derived is written
    return abs(derived - written) <= spare


def balances(wrenches: Array, spare: float = 1e-9) -> bool:
    """Whether wrenches (4, K) add up, with factors of which none is below 0, to nothing but what moves bearing one.

    Where any do, then some that are independent: no more than four.
    """
    target = np.array([0.0, 0.0, 0.0, 1.0])
    for size in range(1, min(wrenches.shape[1], 4) + 1):
        for chosen in combinations(range(wrenches.shape[1]), size):
            some = wrenches[:, chosen]
            forces = np.linalg.lstsq(some, target, rcond=None)[0]
            if forces.min() > -PRESSES and np.abs(some @ forces - target).max() < spare * (1.0 + forces.sum()):
                return True
    return False
