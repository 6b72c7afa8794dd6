"""Proof of the seating that a result states for a fixture, from the outline, the pegs and its numbers alone.

For each seat (a pose in which the part can come to rest on the pegs) the file gives the pose, the difference
of travel and the contacts. The contacts are derived anew from the outline: each must touch to ``AGREEMENT``
(in ball arithmetic), and no peg may be in the part. Forces h >= 0 along the normals must balance on the part,
and the forces of the moving pegs must sum to one along their way. So a stated seat or pass that is none is
refuted. A missing seat cannot be detected from a file.

The stop is the travel at which the moving carrier comes to rest without the part. Doubles are exact enough to
test whether pegs are clear of the part, and whether the part covers the same place.

Glossary
--------
local : said of a place in the part's own frame, as drawn, even if the part is turned over (x to -x).
wrench : force on the part along x and y, moment about its centre divided by its arm, and share of the moving
    pegs, along their way.
cage : the poses from which the part still settles in its seat.
pass : the pose at which the part first gets out of the cage as the jaws open.
placing : how far from its seat the part may be put in.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import combinations, pairwise
from math import ceil, cos, hypot, inf, pi, radians, sin, sqrt
from typing import Any

import numpy as np
from attrs import define, frozen
from flint import arb
from numpy.typing import NDArray

from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece
from workhold.verification.ball_geometry import (
    ArcSide,
    BallOutline,
    LineSide,
    Point,
    Side,
    compute_norm,
    make_exact_point,
    subtract,
    turn_vector,
)
from workhold.verification.contacts import BallPose
from workhold.verification.listing import SeatingClaim
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.rules.travel import measure_travel
from workhold.verification.tolerances import AGREEMENT, SAME_PLACE, SAME_PLACE_SPARE

__all__ = ["FloatOutline", "PartPlacement", "SeatingJudge", "StatedSeating", "find_stop", "make_wall_contact"]

# mm. A tip may be in a locator by this much: rounding.
APART = 1e-6


Array = NDArray[np.float64]


@frozen
class PartPlacement:
    """The position of a part.

    Parameters
    ----------
    theta_deg, x, y : its pose, in degrees and mm.
    mirrored : whether it is turned over before that, x to -x in its own frame.
    """

    theta_deg: float
    x: float
    y: float
    mirrored: bool = False

    @classmethod
    def from_pose(cls, pose: Mapping[str, float], mirrored: bool = False) -> PartPlacement:
        """Return the placement of a pose as a file writes it, with the keys theta_deg, x and y."""
        return cls(pose["theta_deg"], pose["x"], pose["y"], mirrored)

    def turn_vector(self, way: Point) -> Point:
        """Return a vector of the part's frame in the toolkit's frame, in ball arithmetic.

        Of a mirrored part x becomes -x before the turn.
        """
        sine, cosine = (arb(self.theta_deg) / 180).sin_cos_pi()
        return turn_vector((-way[0], way[1]) if self.mirrored else way, cosine, sine)

    def map_vector_to_part(self, way: Point) -> Point:
        """Return a vector of the toolkit's frame in the part's frame, in ball arithmetic."""
        sine, cosine = (arb(self.theta_deg) / 180).sin_cos_pi()
        x, y = turn_vector(way, cosine, -sine)
        return (-x, y) if self.mirrored else (x, y)

    def place_points(self, points: Array) -> Array:
        """Return points (N, 2) of the part's frame in the toolkit's frame, in mm, in doubles."""
        c, s = cos(radians(self.theta_deg)), sin(radians(self.theta_deg))
        x, y = points[:, 0] * (-1.0 if self.mirrored else 1.0), points[:, 1]
        return np.stack([c * x - s * y + self.x, s * x + c * y + self.y], axis=1)

    def map_points_to_part(self, points: Array) -> Array:
        """Return points (N, 2) of the toolkit's frame in the part's frame, in mm, in doubles."""
        c, s = cos(radians(self.theta_deg)), sin(radians(self.theta_deg))
        x, y = points[:, 0] - self.x, points[:, 1] - self.y
        return np.stack([(c * x + s * y) * (-1.0 if self.mirrored else 1.0), c * y - s * x], axis=1)


@frozen
class StatedContact:
    """A contact of a seat or a pass, as the file states it.

    Parameters
    ----------
    peg : its index among the fixture's pegs.
    at : where the part is touched, in the toolkit's frame in mm.
    normal : the outward unit normal of the part there, in the toolkit's frame.
    off : largest possible distance in mm of the peg from touching.
    is_inside : whether the point touched is inside a face, between its ends, or is a corner.
    """

    peg: int
    at: Point
    normal: Point
    off: float
    is_inside: bool


def make_wall_contact(
    outline: BallOutline, contact: Mapping[str, int], place: PartPlacement
) -> StatedContact:
    """Return a stated contact with a wall along x at y = 0: of a corner, or of the lowest point of a convex
    arc.

    Where ``contact`` names neither a corner nor such an arc, ``off`` is inf.
    """
    number, down, is_corner = contact["peg"], make_exact_point(0.0, -1.0), "corner" in contact
    side = outline.faces.get(contact["corner" if is_corner else "face"])
    if is_corner and side is not None:
        local, off = side.start, arb(0)
    elif isinstance(side, ArcSide) and side.sign > 0:
        x, y = place.map_vector_to_part(down)
        local = side.center[0] + side.radius * x, side.center[1] + side.radius * y
        off = side.compute_distance(local)
    else:
        return StatedContact(number, make_exact_point(0.0, 0.0), down, inf, False)
    x, y = place.turn_vector(local)
    at = x + place.x, y + place.y
    return StatedContact(number, at, down, float(abs(at[1]).upper()), bool(off < AGREEMENT))


def make_peg_contact(
    outline: BallOutline,
    contact: Mapping[str, int],
    place: PartPlacement,
    center: tuple[float, float],
    radius: float,
) -> StatedContact:
    """Return a stated contact of a face or a corner with a round peg.

    ``center`` and ``radius`` are the peg's in the toolkit's frame, in mm. Where ``contact`` names no face of
    the outline, ``off`` is inf.
    """
    number, (x, y), face = contact["peg"], center, contact.get("face")
    local = place.map_vector_to_part(make_exact_point(x - place.x, y - place.y))
    side = outline.faces.get(contact["corner"] if face is None else face)
    if side is None:
        return StatedContact(number, make_exact_point(x, y), make_exact_point(0.0, 0.0), inf, False)
    if face is None:
        way, inside = subtract(local, side.start), True
        off = abs(compute_norm(way) - radius)
    else:
        way, off = side.compute_outward_normal(local), abs(side.compute_gap(local) - radius)
        inside = bool(abs(side.compute_distance(local) - radius) < AGREEMENT)
    size = compute_norm(way)
    normal = place.turn_vector((way[0] / size, way[1] / size))
    at = arb(x) - radius * normal[0], arb(y) - radius * normal[1]
    return StatedContact(number, at, normal, float(off.upper()), inside)


def find_touching_faults(
    contacts: Sequence[StatedContact], on_wall: Sequence[int], wall: str
) -> Iterator[str]:
    """Yield a verb phrase (such as "has a contact twice") for each fault of stated contacts.

    Faults are a contact that does not touch, a contact stated twice, and contacts with a wall that do not
    start with its first end. ``on_wall`` holds the indices of the pegs that are ends of the contact with the
    wall, and ``wall`` is the wall's name.
    """
    ends = [one.peg for one in contacts if one.peg in on_wall]
    if ends != list(on_wall[: len(ends)]):
        yield f"does not name the ends on the {wall} from the first on"
    if len({(one.peg, *(round(float(part.mid()), 5) for part in one.at)) for one in contacts}) < len(
        contacts
    ):
        yield "has a contact twice"
    for one in contacts:
        if not (one.off < AGREEMENT and one.is_inside):
            yield f"has peg {one.peg} not where it is said to touch"


def find_stop(pegs: Sequence[Peg], toolkit: Toolkit, separation: float) -> float | None:
    """Return the travel in mm at which the moving carrier comes to rest when there is no part; None if
    nothing stops it.

    ``separation`` is the travel in mm at which the pegs have their written places.
    """
    moved = [peg for peg in pegs if toolkit.find_carrier(peg.carrier).travel is not None]
    still = [peg for peg in pegs if peg not in moved and toolkit.find_carrier(peg.carrier).contact.is_placed]
    moving, tip = toolkit.find_carrier(moved[0].carrier), moved[0]
    assert moving.travel is not None
    if toolkit.clamping < 0:
        return moving.travel.most
    if toolkit.gap is not None:
        return toolkit.gap + max(peg.x for peg in still) - min(peg.x for peg in moved) + separation
    ends, (ux, uy) = [moving.travel.least], moving.travel.unit
    for peg in still:
        dx, dy = peg.x - tip.x, peg.y - tip.y
        along, across = dx * ux + dy * uy, dx * uy - dy * ux
        square = (moving.peg_radius + toolkit.find_carrier(peg.carrier).peg_radius) ** 2 - across * across
        # It moves against its unit vector, and meets what lies there.
        if square > 0.0 and along <= 0.0:
            ends.append(separation + min(along + sqrt(square), APART))
    if WALL_END in toolkit.contacts and uy > 0.0:
        ends.append(separation + moving.peg_radius - tip.y)
    least = max(ends)
    return None if least == -inf else least


# No unit. A force above minus this, per unit of clamping force, presses.
PRESSES = 1e-9


def can_balance(wrenches: Array, spare: float = 1e-9) -> bool:
    """Return whether wrenches times factors of 0 or more can sum to (0, 0, 0, 1), to within ``spare``.

    ``wrenches`` (4, K) has a column for each; the fourth row is the share of the moving pegs. By
    Caratheodory's theorem it is enough to try sets of at most four independent wrenches.
    """
    target = np.array([0.0, 0.0, 0.0, 1.0])
    if not np.isfinite(wrenches).all():
        # A peg that is said to stand in the centre of an arc has no normal.
        return False
    for size in range(1, min(wrenches.shape[1], 4) + 1):
        for chosen in combinations(range(wrenches.shape[1]), size):
            some = wrenches[:, chosen]
            forces = np.linalg.lstsq(some, target, rcond=None)[0]
            if forces.min() > -PRESSES and np.abs(some @ forces - target).max() < spare * (
                1.0 + forces.sum()
            ):
                return True
    return False


# Places looked at on each segment; corners of the polygon in it for a whole circle, at least.
POINTS, CORNERS = 8, 64


@frozen(eq=False)
class FloatOutline:
    """The segments of a part in doubles: L lines, A arcs.

    Parameters
    ----------
    lines : (L, 4) start x, y and end x, y.
    arcs : (A, 5) centre x, y, radius, direction of the middle and half the sweep, in radians.
    points : (M, 2) points sampled on all segments.
    edges : (E, 4) start and end of the edges of a polygon close to the outline.
    arm : largest distance in mm of a point of the outline from the part's centre.
    """

    lines: Array
    arcs: Array
    points: Array
    edges: Array
    arm: float

    @classmethod
    def from_segments(cls, segments: Sequence[Side], workpiece: Workpiece) -> FloatOutline:
        """Return the outline of segments in doubles; ``arm`` is measured from the workpiece's centre."""
        lines, arcs, points, edges = [], [], list[Array](), list[Array]()
        for side in segments:
            if isinstance(side, LineSide):
                a, b = (np.array([float(v.mid()) for v in end]) for end in (side.start, side.end))
                lines.append((*a, *b))
                run = a + np.linspace(0.0, 1.0, POINTS + 1)[:, None] * (b - a)
                fine = np.stack([a, b])
            else:
                center = np.array([float(v.mid()) for v in side.center])
                radius, half = float(side.radius.mid()), float(side.half_sweep.mid())
                middle = float(np.arctan2(float(side.middle[1].mid()), float(side.middle[0].mid())))
                arcs.append((*center, radius, middle, half))
                # From its start to its end, clockwise on a hollow.
                count = max(ceil(half / pi * CORNERS), POINTS)
                run, fine = (
                    center + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
                    for turn in (
                        middle + side.sign * half * np.linspace(-1.0, 1.0, n + 1) for n in (POINTS, count)
                    )
                )
            points.append(run)
            edges.append(np.hstack([fine[:-1], fine[1:]]))
        every = np.concatenate(points)
        arm = float(np.hypot(*(every - workpiece.center).T).max())
        return cls(
            np.array(lines).reshape(-1, 4), np.array(arcs).reshape(-1, 5), every, np.concatenate(edges), arm
        )

    def compute_lowest_height(self, place: PartPlacement) -> float:
        """Return the least y in mm of the part as placed, in the toolkit's frame."""
        turn = radians(place.theta_deg)
        down = np.array([-sin(turn) * (-1.0 if place.mirrored else 1.0), -cos(turn)])
        x, y, radius, middle, half = self.arcs.T
        away = np.abs((np.arctan2(down[1], down[0]) - middle + pi) % (2.0 * pi) - pi)
        below = np.stack([x, y], axis=1)[away <= half] + radius[away <= half, None] * down
        return float(place.place_points(np.concatenate([self.points, below]))[:, 1].min())

    def measure_distances(self, points: Array) -> Array:
        """Return the distances (N,) in mm of points (N, 2) of the part's frame from the outline, unsigned."""
        found = np.full(len(points), np.inf)
        for ax, ay, bx, by in self.lines:
            t = ((points[:, 0] - ax) * (bx - ax) + (points[:, 1] - ay) * (by - ay)) / (
                (bx - ax) ** 2 + (by - ay) ** 2
            )
            t = np.clip(t, 0.0, 1.0)
            away = np.hypot(points[:, 0] - ax - t * (bx - ax), points[:, 1] - ay - t * (by - ay))
            found = np.minimum(found, away)
        for x, y, radius, middle, half in self.arcs:
            dx, dy = points[:, 0] - x, points[:, 1] - y
            turn = (np.arctan2(dy, dx) - middle + pi) % (2.0 * pi) - pi
            foot = middle + np.clip(turn, -half, half)
            away = np.hypot(dx - radius * np.cos(foot), dy - radius * np.sin(foot))
            found = np.minimum(found, away)
        return found

    def is_free(self, pegs: Array, radii: Array, place: PartPlacement) -> bool:
        """Return whether no peg overlaps the placed part.

        ``pegs`` (N, 2) are the centres in the toolkit's frame and ``radii`` (N,) the radii, in mm.
        """
        points = place.map_points_to_part(pegs)
        return bool((self.measure_distances(points) >= radii).all() and not self.contains(points).any())

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Return (N,) whether the part's polygon contains points (N, 2) of the part's frame."""
        ax, ay, bx, by = self.edges.T
        x, y = points[:, :1], points[:, 1:]
        crosses = (ay <= y) != (by <= y)
        rise = np.where(by == ay, 1.0, by - ay)
        right = ax + (y - ay) / rise * (bx - ax) > x
        return np.asarray((crosses & right).sum(axis=1) % 2 == 1)

    def measure_farthest(self, one: PartPlacement, other: PartPlacement) -> float:
        """Return the largest distance in mm of a point of the outline placed as ``one`` from the outline
        placed as ``other``.
        """
        return float(self.measure_distances(other.map_points_to_part(one.place_points(self.points))).max())


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
        """The outline of the part in ball arithmetic."""
        return BallOutline.from_workpiece(self.query.workpiece)

    @cached_property
    def rough(self) -> FloatOutline:
        """The outline of the part in doubles."""
        return FloatOutline.from_segments(self.outline.segments, self.query.workpiece)

    def find_fault(self, fixture: Fixture) -> str:
        """Return the first fault of a fixture's stated seating as a sentence without full stop.

        Returns "" where there is no fault, or no seating is stated.
        """
        claim: SeatingClaim | None = fixture.seating
        if claim is None:
            return ""
        if len(fixture.travels) > 1:
            return "its seating is stated, and with two clamps there is none"
        return next(
            (f"its seating: {words}" for words in StatedSeating(self, fixture, claim).find_faults()), ""
        )


@define(slots=False)
class StatedSeating:
    """A fixture and the claims about its seating."""

    judge: SeatingJudge
    fixture: Fixture
    claim: SeatingClaim

    @property
    def fields(self) -> Mapping[str, Any]:
        """The fields of the seating, as the file writes them."""
        return self.claim.fields

    @cached_property
    def is_moving_peg(self) -> list[bool]:
        """For each peg of the fixture, whether it moves."""
        return [any(self.judge.hardware.find_way(peg)) for peg in self.fixture.pegs]

    @cached_property
    def way(self) -> tuple[float, float]:
        """The unit vector along which the moving pegs move as their travel grows."""
        return self.judge.hardware.find_way(self.fixture.pegs[self.is_moving_peg.index(True)])

    @cached_property
    def on_wall(self) -> list[int]:
        """The indices of the pegs that are ends of the contact with a wall."""
        carriers = [self.judge.hardware.carriers[peg.carrier] for peg in self.fixture.pegs]
        return [number for number, carrier in enumerate(carriers) if not carrier.contact.is_placed]

    @property
    def travel(self) -> float:
        """The travel in mm of the moving carrier; a clamp's follows from where its tip is written."""
        if self.fixture.direction is None:
            return self.fixture.travel
        tip = self.fixture.pegs[self.is_moving_peg.index(True)]
        return measure_travel(tip, self.judge.hardware.carriers[tip.carrier])

    @property
    def clamping(self) -> int:
        """1 where less travel clamps, -1 where more does."""
        return self.judge.query.toolkit.clamping

    def find_faults(self) -> Iterator[str]:
        """Yield one clause for each fault of the seating: its seats, figures and pass."""
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
            for words in self.find_seat_faults(seat, mine):
                yield f"seat {number} {words}"
        yield from self.find_figure_faults(mine)
        yield from self.find_pass_faults(mine)

    def find_seat_faults(self, seat: Mapping[str, Any], own: Mapping[str, Any]) -> Iterator[str]:
        """Yield a verb phrase (such as "lies beyond the stop") for each fault of a seat.

        ``own`` is the seat in which the part has its pose in the fixture.
        """
        apart = seat["jaw_separation"] - own["jaw_separation"]
        if abs(apart - seat["difference"]) > ROUNDED:
            yield "has a difference that is not that of the separations"
        place = PartPlacement.from_pose(seat["pose"], seat["mirrored"])
        covers = self.covers_own_place(place)
        if covers is not None and covers != seat["same_place"]:
            yield "does not say rightly whether the part covers the same place"
        stop = self.fields["stop"]
        if stop is not None and self.clamping * (seat["jaw_separation"] - stop) < -ROUNDED:
            yield "lies beyond the stop"
        if seat["kind"] == "unsettled":
            return
        yield from self.find_freedom_faults(place, apart)
        contacts = [self.make_contact(contact, place, apart) for contact in seat["contacts"]]
        yield from find_touching_faults(contacts, self.on_wall, self.judge.hardware.wall_noun)
        if self.name_seat(seat) != seat["kind"] and seat["kind"] != "loose":
            yield f"is called {seat['kind']}, which its contacts are not"
        if seat["kind"] in STRICT and len(seat["forces"]) != len(contacts):
            yield "does not have a force for each contact"
        elif seat["kind"] in STRICT and not self.are_forces_balanced(contacts, place, seat["forces"]):
            yield "is not an equilibrium of its forces"
        elif seat["kind"] == "loose" and not can_balance(self.make_wrenches(contacts, place), BALANCED):
            yield "is not an equilibrium of its contacts"

    def is_own(self, contact: Mapping[str, int]) -> bool:
        """Return whether a contact of the fixture's own seat is also a contact of the fixture.

        It is one if it is on the face that the peg touches, or on a wall at the peg's place.
        """
        peg = self.fixture.pegs[contact["peg"]]
        if contact["peg"] not in self.on_wall:
            return contact.get("face") == peg.face
        touched = self.make_contact(contact, self.lying, 0.0).at
        return bool(compute_norm(subtract(touched, self.ends[contact["peg"]])) < AGREEMENT)

    @cached_property
    def lying(self) -> PartPlacement:
        """The placement of the part in the fixture."""
        return PartPlacement(self.fixture.pose.theta_deg, self.fixture.pose.x, self.fixture.pose.y)

    @cached_property
    def ends(self) -> list[Point]:
        """For each peg its centre, or for an end of the contact with a wall the point that touches, in the
        toolkit's frame.
        """
        contacts = self.judge.hardware.make_contacts(self.fixture, self.judge.outline)
        return [contact.compute_point(BallPose.from_written(self.fixture.pose)) for contact in contacts]

    def name_seat(self, seat: Mapping[str, Any]) -> str:
        """Return the kind of a seat as its contacts imply it: "curved", "pocket", "corner" or "fixture"."""
        contacts = seat["contacts"]
        if len(contacts) < 4:
            return "curved"
        if len({contact["peg"] for contact in contacts}) < 4:
            return "pocket"
        # Where a part lies flush on a wall it has corners on it.
        is_corner = any("corner" in one and one["peg"] not in self.on_wall for one in contacts)
        return "corner" if is_corner else "fixture"

    def find_figure_faults(self, own: Mapping[str, Any]) -> Iterator[str]:
        """Yield one clause for each figure that does not follow from the seats and contacts."""
        fields = self.fields
        opening, factor, reading = (fields[key] for key in ("capture_opening", "room_factor", "reading"))
        if abs(sum(own["forces"]) - factor) > BALANCED:
            yield "room_factor is not the sum of the forces"
        drop = None if opening is None else opening / factor
        if not are_equal_figures(drop, fields["drop_room"]):
            yield "drop_room is not the capture opening over room_factor"
        wrong = [seat for place, seat in enumerate(fields["seats"]) if self.counts_as_wrong(place, seat)]
        if len(wrong) != fields["wrong_seats"]:
            yield f"wrong_seats says {fields['wrong_seats']}, and {len(wrong)} of its seats are"
        nearest = min((abs(seat["difference"]) for seat in wrong), default=None)
        if not are_equal_figures(nearest, reading):
            yield "reading is not the least difference of a wrong seat"
        unsettled = any(seat["kind"] == "unsettled" for seat in fields["seats"])
        if unsettled and not fields["unsettled"]:
            yield "a seat is unsettled, and unsettled does not say so"
        out = fields["way_out"]
        if out is not None and (opening is None or out < opening - ROUNDED):
            yield "the way out is nearer than the capture opening"
        yield from self.find_friction_faults(self.claim.seating.sticking_friction, own)
        if not are_equal_figures(
            find_stop(self.fixture.pegs, self.judge.query.toolkit, self.travel), fields["stop"], AGREEMENT
        ):
            yield "stop is not where what moves is stopped without the part"

    def counts_as_wrong(self, place: int, seat: Mapping[str, Any]) -> bool:
        """Return whether the seat with index ``place`` is wrong: the part does not cover the same area there
        as in the fixture.

        Seats beyond the opening that the query asks about, or beyond ``seating.most``, do not count.
        """
        seating, query = self.claim.seating, self.judge.query
        if seating.seats[place].is_own or seat["same_place"]:
            return False
        if query.opening is not None and not self.clamping * seat["difference"] < query.opening:
            return False
        return seating.most is None or seat["jaw_separation"] <= seating.most

    def find_pass_faults(self, own: Mapping[str, Any]) -> Iterator[str]:
        """Yield one clause for each fault of the stated pass, cage and placing.

        Cage: the poses from which the part still settles in its seat. Pass: the pose at which the part first
        gets out of the cage as the jaws open. Placing: the distance from its seat within which the part may
        be put in.
        """
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
        there = PartPlacement.from_pose(top["pose"])
        contacts = [self.make_contact(contact, there, rise) for contact in top["contacts"]]
        if not 2 <= len(contacts) <= 3:
            yield "the pass does not have two or three contacts"
        faults = find_touching_faults(contacts, self.on_wall, self.judge.hardware.wall_noun)
        yield from (f"the pass {words}" for words in faults)
        yield from (f"the pass {words}" for words in self.find_freedom_faults(there, rise))
        if not can_balance(self.make_wrenches(contacts, there), BALANCED):
            yield "the pass is not an equilibrium of its contacts"
        (x, y), (u, v) = (
            self.locate_center(place) for place in (there, PartPlacement.from_pose(own["pose"]))
        )
        turn = (top["pose"]["theta_deg"] - own["pose"]["theta_deg"] + 180.0) % 360.0 - 180.0
        away = hypot(x - u, y - v) + 2.0 * self.judge.rough.arm * sin(abs(radians(turn)) / 2.0)
        if placing is not None and placing > away + AGREEMENT:
            yield "placing is farther than the pass"
        for name, shift in () if cage is None else (("theta_deg", turn), ("x", x - u), ("y", y - v)):
            low, high = cage[name]
            if not low - AGREEMENT <= min(0.0, shift) <= max(0.0, shift) <= high + AGREEMENT:
                yield f"the cage leaves out the seat or its pass in {name}"

    def find_friction_faults(self, stated: float, own: Mapping[str, Any]) -> Iterator[str]:
        """Yield one clause where the part can stick before its seat at less than the stated friction, or
        cannot just above it.
        """
        place = PartPlacement.from_pose(own["pose"])
        contacts = [self.make_contact(contact, place, 0.0) for contact in own["contacts"]]
        low, high = stated * (1.0 - FRICTION), stated * (1.0 + FRICTION) + ROUNDED
        if min(low, MOST_FRICTION) > ROUNDED and self.can_stick(contacts, place, min(low, MOST_FRICTION)):
            yield "the part can stick below the sticking friction"
        if high < MOST_FRICTION and not self.can_stick(contacts, place, high):
            yield "the part cannot stick at the sticking friction"

    def can_stick(self, contacts: Sequence[StatedContact], place: PartPlacement, friction: float) -> bool:
        """Return whether some three of the four contacts can balance with forces inside their friction cones.

        ``friction`` is the coefficient of friction.
        """
        edges = np.hstack([self.make_wrenches(contacts, place, sign * friction) for sign in (1.0, -1.0)])
        for three in combinations(range(4), 3):
            columns = [k + 4 * side for k in three for side in (0, 1)]
            if can_balance(edges[:, columns]):
                return True
        return False

    def locate_center(self, place: PartPlacement) -> tuple[float, float]:
        """Return the part's centre as placed, in the toolkit's frame in mm, in doubles."""
        x, y = place.place_points(np.array([self.judge.query.workpiece.center]))[0].tolist()
        return x, y

    def find_peg_center(self, number: int, apart: float) -> tuple[float, float]:
        """Return the centre of a peg, in the toolkit's frame in mm, with the travel ``apart`` mm larger than
        in the fixture.

        Fixed pegs do not move.
        """
        peg, by = self.fixture.pegs[number], apart * self.is_moving_peg[number]
        return peg.x + by * self.way[0], peg.y + by * self.way[1]

    def find_freedom_faults(self, place: PartPlacement, apart: float) -> Iterator[str]:
        """Yield a verb phrase if a peg overlaps the placed part, or the part enters a wall."""
        numbers = [number for number in range(len(self.is_moving_peg)) if number not in self.on_wall]
        pegs = np.array([self.find_peg_center(number, apart) for number in numbers])
        carriers = self.judge.hardware.carriers
        radii = np.array([carriers[self.fixture.pegs[number].carrier].peg_radius for number in numbers])
        if not self.judge.rough.is_free(pegs, radii - AGREEMENT, place):
            yield "has a peg in the part"
        for wall in self.judge.hardware.walls:
            if self.judge.rough.compute_lowest_height(place) < -AGREEMENT:
                yield f"has the part in the {wall.noun}"

    def covers_own_place(self, place: PartPlacement) -> bool | None:
        """Return whether the part placed at ``place`` covers the same area as in the fixture; None where
        rounding decides.
        """
        away = self.judge.rough.measure_farthest(place, self.lying)
        is_near = SAME_PLACE / SAME_PLACE_SPARE < away < SAME_PLACE * SAME_PLACE_SPARE
        return None if is_near else away < SAME_PLACE

    def make_contact(self, contact: Mapping[str, int], place: PartPlacement, apart: float) -> StatedContact:
        """Return a stated contact of the placed part in ball arithmetic.

        The travel is ``apart`` mm larger than in the fixture.
        """
        number = contact["peg"]
        if number in self.on_wall:
            return make_wall_contact(self.judge.outline, contact, place)
        radius = self.judge.hardware.carriers[self.fixture.pegs[number].carrier].peg_radius
        return make_peg_contact(
            self.judge.outline, contact, place, self.find_peg_center(number, apart), radius
        )

    def make_wrenches(
        self, contacts: Sequence[StatedContact], place: PartPlacement, friction: float = 0.0
    ) -> Array:
        """Return the wrenches (4, K) of K contacts, each of a unit normal force and ``friction`` times it
        along the tangent.

        Rows: force x and y, moment about the part's centre divided by the part's arm, and share of the moving
        pegs along their way.
        """
        cx, cy = self.locate_center(place)
        columns = []
        for one in contacts:
            nx, ny = (float(part.mid()) for part in one.normal)
            fx, fy = -nx - friction * ny, -ny + friction * nx
            x, y = (float(part.mid()) for part in one.at)
            moment = ((x - cx) * fy - (y - cy) * fx) / self.judge.rough.arm
            borne = -self.clamping * (fx * self.way[0] + fy * self.way[1]) * self.is_moving_peg[one.peg]
            columns.append((fx, fy, moment, borne))
        return np.array(columns).reshape(-1, 4).T

    def are_forces_balanced(
        self, contacts: Sequence[StatedContact], place: PartPlacement, forces: Sequence[float]
    ) -> bool:
        """Return whether the stated forces are in balance, none pulls, and those of the moving pegs sum to 1
        along their way.
        """
        left = self.make_wrenches(contacts, place) @ np.array(forces) - [0.0, 0.0, 0.0, 1.0]
        return bool(np.abs(left).max() < BALANCED * (1.0 + sum(forces)) and min(forces) > -PRESSES)


def are_equal_figures(derived: float | None, written: float | None, spare: float = ROUNDED) -> bool:
    """Return whether two figures agree to ``spare``, or are both None."""
    if derived is None or written is None:
        return derived is written
    return abs(derived - written) <= spare
