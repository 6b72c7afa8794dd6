"""Parts one number away from a degenerate case, and fixtures carried from one part to another that is nearly like it."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from math import cos, degrees, pi, radians, sin, sqrt, tan
from random import Random

from attrs import evolve, frozen
from flint import arb, ctx

from fixture_sets import Listed
from workhold import Fixture, Pose, Query, Vise, Workpiece
from workhold.verification import Judge
from workhold.verification.ball_geometry import BallOutline, compute_dot_product
from workhold.verification.contacts import BallContact, compute_minors, evaluate_contact_system
from workhold.verification.contacts import BallPose as Balls
from workhold.verification.placing import enclose_zero

__all__ = [
    "Carried",
    "bracket_with_fillet",
    "carried_over",
    "crowned",
    "cut_circle",
    "disc",
    "held_in_notch",
    "lug",
    "notched",
    "redrawn",
    "regular",
    "resized",
    "ring",
    "slotted",
    "stepped",
    "strip",
    "two_bumps",
    "workpiece",
]

Loop = list[list[float]]
Point = tuple[float, float]
QUARTER = sqrt(2) - 1  # bulge of a quarter circle


@frozen
class Carried:
    """A fixture of one part, solved anew on another part.

    Parameters
    ----------
    fixture : with the pose, jaw separation and forces it has there.
    verdict, reason : what verification in ball arithmetic says of it; "missing" when the contacts have no solution near.
    moved : how far the pose or the jaw separation moved, in radians or mm.
    """

    fixture: Fixture
    verdict: str
    reason: str
    moved: float


def carried_over(fixtures: Iterable[Fixture], part: Workpiece, vise: Vise) -> list[Carried]:
    """Fixtures of a part, solved anew with the same pegs and faces on a part nearly like it.

    A fixture is a simple root of the contact equations, so it moves little when the part changes little. Nothing of the
    search is used: roots are enclosed by Krawczyk's theorem, the rules are decided in ball arithmetic.
    """
    judge = Judge(Query(part, vise))
    out = []
    for fixture in fixtures:
        start = [radians(fixture.pose.theta_deg), fixture.pose.x, fixture.pose.y, fixture.travel]
        with ctx.workprec(256):
            faces = BallOutline.from_workpiece(part).faces
            contacts = [judge.hardware.make_contact(peg, faces[peg.face]) for peg in fixture.pegs]
            zero = enclose_zero(partial(evaluate_contact_system, contacts), start)
            if zero is None:
                out.append(Carried(fixture, "missing", "", 0.0))
                continue
            solved = solved_fixture(fixture, contacts, zero)
        ruling = judge.rule_on(solved)
        moved = max(abs(float(a.mid()) - b) for a, b in zip(zero, start, strict=True))
        out.append(Carried(solved, ruling.verdict, ruling.reason, moved))
    return out


def solved_fixture(fixture: Fixture, contacts: list[BallContact], zero: list[arb]) -> Fixture:
    """A fixture with the pose, jaw separation and forces of an enclosed root of its contact equations."""
    pose = Balls.from_turn_and_place(*zero)
    points = [contact.compute_center_in_part(pose) for contact in contacts]
    normals = [
        contact.side.compute_outward_normal(point) for contact, point in zip(contacts, points, strict=True)
    ]
    vector = compute_minors(points, normals)
    across = pose.cosine, -pose.sine
    push = -sum(
        (vector[k] * compute_dot_product(across, normals[k]) for k in range(4) if not contacts[k].way[0] > 0),
        arb(0),
    )
    theta, x, y, separation = (float(entry.mid()) for entry in zero)
    opened = separation - fixture.travel
    first, second, third, fourth = (
        evolve(peg, x=peg.x + opened * (peg.carrier == "right"), force=float((entry / push).mid()))
        for peg, entry in zip(fixture.pegs, vector, strict=True)
    )
    return Fixture(
        fixture.type, (first, second, third, fourth), Pose(degrees(theta), x, y), separation, quality={}
    )


def workpiece(name: str, loops: list[Loop]) -> Workpiece:
    """A workpiece of loops written with whole numbers where they are whole."""
    return Workpiece.from_loops(name, loops)


def redrawn(
    part: Workpiece, turn: float = 0.0, x: float = 0.0, y: float = 0.0, scale: float = 1.0
) -> Workpiece:
    """A part scaled, turned by an angle in radians and moved by (x, y) mm."""
    c, s = scale * cos(turn), scale * sin(turn)
    loops = [
        [[c * px - s * py + x, s * px + c * py + y, b] for px, py, b in loop.tolist()] for loop in part.loops
    ]
    return workpiece(part.name, loops)


def resized(fixtures: Iterable[Listed], scale: float) -> list[Listed]:
    """Fixtures with all lengths multiplied."""
    return [
        fixture
        | {
            "pegs": [peg | {"x": peg["x"] * scale, "y": peg["y"] * scale} for peg in fixture["pegs"]],
            "pose": fixture["pose"] | {"x": fixture["pose"]["x"] * scale, "y": fixture["pose"]["y"] * scale},
            "jaw_separation": fixture["jaw_separation"] * scale,
        }
        for fixture in fixtures
    ]


def disc(radius: float, x: float = 0.0, y: float = 0.0) -> Loop:
    """A whole circle as two halves."""
    return [[x + radius, y, 1.0], [x - radius, y, 1.0]]


def crowned(bulge: float) -> Workpiece:
    """A plate with a hole, one edge of which has a bulge."""
    outline: Loop = [[0, 0, bulge], [61.3, 0, 0], [61.3, 38.7, 0], [0, 38.7, 0]]
    return workpiece("crowned", [outline, disc(8.2, 23.1, 17.9)])


def cut_circle(count: int, off: float) -> Workpiece:
    """A circle as a tool path has it: arcs between places on it, each with a sweep that is off by up to ``off`` radians."""
    random, step = Random(7), 2 * pi / count
    return workpiece(
        "circle",
        [
            [
                [20 * cos(k * step), 20 * sin(k * step), tan((step + off * random.uniform(-1, 1)) / 4)]
                for k in range(count)
            ]
        ],
    )


def stepped(tilt: float = 0.0) -> Workpiece:
    """A stepped plate: faces 0 and 2 look the same way and are parallel but for a tilt in radians."""
    far = [20.0 + 24.0 * cos(tilt), 7.0 + 24.0 * sin(tilt), 0.0]
    outline: Loop = [[0, 0, 0], [18, 0, 0], [20, 7, 0], far, [50, 30, 0], [12, 36, 0], [-4, 18, 0]]
    return redrawn(workpiece("stepped", [outline]), turn=0.83)


def strip(tilt: float = 0.0) -> Workpiece:
    """A trapezium with one crooked side: faces 0 and 2 look opposite ways and are parallel but for a tilt in radians."""
    near = [47.0 - 31.0 * cos(tilt), 20.0 - 31.0 * sin(tilt), 0.0]
    outline: Loop = [[0, 0, 0], [52, 0, 0], [47, 20, 0], near, [-4, 9, 0.3]]
    return redrawn(workpiece("strip", [outline]), turn=2.1)


def two_bumps(radius_change: float = 0.0, center_change: float = 0.0) -> Workpiece:
    """Half circles of radius 4 about (0, 0) and (0, 10): faces 2 and 0. The upper one may be larger, or farther off."""
    y, radius = 10.0 + center_change, 4.0 + radius_change
    left: Loop = [[0, y + radius, 1], [0, y - radius, 0], [0, 4, 1], [0, -4, 0]]
    return workpiece("two bumps", [[*left, [21, -5.5, 0], [30.5, 5, 0], [19, 16, 0]]])


def lug(change: float = 0.0) -> Workpiece:
    """An end of radius 8 tangent to a side: with pegs of radius 2 in holes 10 apart a chord can stand square to the side
    at the far side of the arc. The radius may be changed."""
    y = 8.0 + change
    return workpiece("lug", [[[0, -y, 0], [30, -11, 0], [36, 9, 0], [0, y, 1]]])


def bracket_with_fillet(radius: float) -> Workpiece:
    """A bracket whose inside corner is rounded with a radius in mm: face 3."""
    corner: Loop = [[18 + radius, 16, -QUARTER], [18, 16 + radius, 0]]
    return workpiece("bracket", [[[0, 0, 0], [47, -4, 0], [44, 16, 0], *corner, [18, 40, 0], [-5, 36, 0]]])


def slotted(radius: float) -> Workpiece:
    """A block with a slot that ends in a half circle of a radius in mm: faces 3 (side), 4 (end) and 5 (side)."""
    slot: Loop = [[radius, 16, 0], [radius, 4, -1], [-radius, 4, 0], [-radius, 16, 0]]
    return workpiece("slotted", [[[-25, -14, 0], [27, -11, 0], [24, 16, 0], *slot, [-20, 19, 0]]])


def notched(radius: float) -> Workpiece:
    """A block with a half circle cut out of one side, its corners sharp: face 3."""
    return workpiece(
        "notched",
        [[[-25, -14, 0], [27, -11, 0], [24, 16, 0], [radius, 16, -1], [-radius, 16, 0], [-20, 16, 0]]],
    )


def held_in_notch(play: float) -> tuple[Workpiece, Vise, Listed]:
    """A part, a vise and a fixture whose first peg sits in the middle of a concave arc of radius 3 + play, itself 3.

    The outline is drawn from the fixture: every face is tangent to its peg. The arc's feature has the radius ``play``.
    """

    def tangent(x: float, y: float, angle: float) -> tuple[Point, Point]:
        """A point and the direction of the line that a peg at (x, y) pushes in a direction in degrees."""
        c, s = cos(radians(angle)), sin(radians(angle))
        return (x + 3.0 * c, y + 3.0 * s), (-s, c)

    def meeting(one: tuple[Point, Point], two: tuple[Point, Point]) -> list[float]:
        """Where two lines meet, as the start of a straight segment."""
        (p, d), (q, e) = one, two
        along = ((q[0] - p[0]) * e[1] - (q[1] - p[1]) * e[0]) / (d[0] * e[1] - d[1] * e[0])
        return [p[0] + along * d[0], p[1] + along * d[1], 0.0]

    half = radians(40.0)
    x, y = (3.0 + play) * cos(half) - play, (3.0 + play) * sin(half)
    left, low, high = tangent(0, 10, 12), tangent(30, 0, 200), tangent(30, 10, 166)
    top, bottom, shelf = ((0.0, 17.0), (1.0, 0.1)), ((0.0, -8.0), (1.0, 0.0)), ((0.0, -4.5), (1.0, 0.0))
    under = meeting(((x, -y), (sin(half), cos(half))), shelf)
    corners = [[under[0] - 0.5, -8.0, 0.0], meeting(low, bottom), meeting(low, high), meeting(high, top)]
    corners += [meeting(left, top), meeting(((x, y), (-sin(half), cos(half))), left)]
    part = workpiece("notch", [[*corners, [x, y, -tan(half / 2)], [x, -y, 0.0], under]])
    places = (("left", 0, 0.0, 6), ("left", 1, 0.0, 4), ("right", 0, 30.0, 1), ("right", 1, 30.0, 2))
    pegs = [
        {"jaw": jaw, "column": 0, "row": row, "x": at, "y": 10.0 * row, "segment": face}
        for jaw, row, at, face in places
    ]
    planted = {
        "type": "I",
        "pegs": pegs,
        "pose": {"theta_deg": 0.0, "x": 0.0, "y": 0.0},
        "jaw_separation": 30.0,
    }
    return part, Vise(pitch=10, columns=1, peg_radius=3), planted


def regular(sides: int, radius: float) -> Workpiece:
    """A regular polygon with a corner at (radius, 0)."""
    angles = [2 * pi * k / sides for k in range(sides)]
    return workpiece(f"{sides}-gon", [[[radius * cos(a), radius * sin(a), 0.0] for a in angles]])


def ring(off: float) -> Workpiece:
    """A disc of radius 30 (face 0) with a hole of radius 15 (face 2) whose centre is off its own in mm."""
    return workpiece("ring", [disc(30.0), disc(15.0, 0.9 * off, sqrt(1 - 0.9**2) * off)])
