"""Carriers that travel: how far jaws open and close, and the stroke and bodies of clamps bolted in a hole.

A jaw has holes of its own and slides. Its separation is counted from a wall, or from the column of the other
jaw next to the opening. So no peg is nearer to the fixed carrier.

A clamp travels along a line of holes. A clamp with a stroke is bolted in the nearest suitable hole behind its
tip. Its body consists of all points within its radius of the segment from hole to tip, so it contains the
body for a nearer hole. If it clears locators and part, the body for a nearer hole does so as well. So a
nearer hole is skipped only because it is off the plate or too near.

The distance of a straight piece from a side is least at an end of either or at a crossing. Outside an arc it
may also be least at the foot of the perpendicular from the arc's centre. Inside a circle it has no minimum
between the ends of a piece.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from attrs import evolve, frozen
from flint import arb

from workhold.fixels.carrier import make_column_letters, make_hole_name
from workhold.fixels.toolkit import Carrier
from workhold.model.fixture import Fixture, Peg
from workhold.verification.ball_geometry import (
    ArcSide,
    BallOutline,
    LineSide,
    Point,
    Side,
    compute_dot_product,
    compute_norm,
    compute_square_root,
    cross,
    make_exact_point,
    make_line_side,
)
from workhold.verification.contacts import BallContact, BallPose
from workhold.verification.tolerances import BODY_SLACK, HAIR, Finding, format_middle, judge_slack

__all__ = [
    "OPPOSITE",
    "WAYS",
    "ClampStroke",
    "name_clamp_place",
    "find_direction",
    "list_directions",
    "is_along_x",
    "find_clamp_line",
    "judge_nearest_rows",
    "judge_opening",
    "measure_piece_distance",
    "count_quarter_turns",
    "turn_hole_back",
    "measure_travel",
]


def judge_opening(jaw: Carrier, separation: arb) -> Iterator[Finding]:
    """Yield a finding where a jaw's proven separation in mm is below its
    smallest gap or above its largest opening.

    Limits may be missed by ``HAIR``.
    """
    assert jaw.travel is not None
    gap, limit = jaw.travel.least, jaw.travel.most
    yield from judge_slack(
        separation - gap + HAIR,
        f"the opening of {format_middle(separation)} mm is below the smallest gap of {gap:g} mm",
        "the opening is exactly at the edge of the smallest gap",
    )
    if limit is not None:
        yield from judge_slack(
            limit - separation + HAIR,
            f"the opening of {format_middle(separation)} mm is above the largest opening of {limit:g} mm",
            "the opening is exactly at the edge of the largest opening",
        )


def judge_nearest_rows(jaw: Carrier, lowest: int, separation: arb) -> Iterator[Finding]:
    """Yield a finding if a jaw that slides along its rows could have its pegs one row nearer to the part.

    ``lowest`` is the first row in use and ``separation`` is in mm. With the pegs one row nearer, the jaw
    would stand one pitch farther from the wall.
    """
    assert jaw.travel is not None
    if lowest > 0:
        limit, wider = jaw.travel.most, separation + jaw.pitch[1]
        words = (
            f"its lowest row is {lowest}, and an opening of {format_middle(wider)} mm would take one nearer"
        )
        if limit is None:
            yield Finding(True, words)
        else:
            yield from judge_slack(
                wider - limit - HAIR, words, "one row nearer the opening would be exactly at its edge"
            )


# The directions in which a clamp may move when it clamps, in the order of a list, each with the way of its
# travel, which grows as it opens.
WAYS = {"-x": (1, 0), "+x": (-1, 0), "-y": (0, 1), "+y": (0, -1)}
OPPOSITE = {"-x": "+x", "+x": "-x", "-y": "+y", "+y": "-y"}


def list_directions(fixture: Fixture) -> tuple[str, ...]:
    """Return the directions of a fixture's clamps, () if it has none."""
    return tuple((fixture.direction or "").split())


def find_direction(clamp: Peg) -> str:
    """Return the direction in which a clamp moves when it clamps ("-x" and the
    like); "" for a peg that is not a clamp.
    """
    direction = clamp.carrier.rpartition(" ")[2]
    return direction if direction in WAYS else ""


def is_along_x(clamp: Peg) -> bool:
    """Return whether a clamp moves along x; False for one along y and for a peg that is not a clamp."""
    return find_direction(clamp).endswith("x")


def find_clamp_line(clamp: Peg) -> int:
    """Return the index, from 0, of a clamp's line: its row if it moves along x, its column if along y."""
    return clamp.row if is_along_x(clamp) else clamp.column


def count_quarter_turns(direction: str) -> int:
    """Return the number, 0 to 3, of counter-clockwise quarter turns that carry the direction -x to
    ``direction``.
    """
    return ("-x", "-y", "+x", "+y").index(direction)


def turn_hole_back(turns: int, column: int, row: int) -> tuple[int, int]:
    """Return (column, row) of a hole after the plate is turned clockwise by ``turns`` quarter turns, 0 to 3.

    Both may become negative.
    """
    return ((column, row), (row, -column), (-column, -row), (-row, column))[turns]


def name_clamp_place(on: str, direction: str, column: int, row: int, is_bolted: bool) -> str:
    """Return the name of a clamp's place: its hole on the carrier ``on`` if bolted, else its row or
    column.
    """
    if is_bolted:
        return f"clamp {make_hole_name(on, column, row)}"
    return (
        f"clamp row {row + 1}" if direction.endswith("x") else f"clamp column {make_column_letters(column)}"
    )


def measure_travel(peg: Peg, carrier: Carrier) -> float:
    """Return the distance in mm between the written place of a peg and its hole, along its carrier's
    direction.
    """
    (x, y), (pitch_x, pitch_y) = carrier.offset, carrier.pitch
    along, across = (0.0, 0.0) if carrier.travel is None else carrier.travel.unit
    return (peg.x - x - peg.column * pitch_x) * along + (peg.y - y - peg.row * pitch_y) * across


@frozen
class ClampStroke:
    """The rules of a clamp whose tip moves along a line of holes.

    Parameters
    ----------
    span : (least, most) distance in mm from its hole to its tip; None for a clamp that consists of its tip
        alone.
    wall : name of the wall that the clamp must keep clear of; empty if there is none.
    """

    span: tuple[float, float] | None
    wall: str

    def judge(
        self,
        name: str,
        locators: Sequence[tuple[str, BallContact]],
        clamp: BallContact,
        pose: BallPose,
        outline: BallOutline,
    ) -> Iterator[Finding]:
        """Yield a finding where a clamp's stroke is out of range, or the clamp's body enters the wall, a
        locator or the part.

        ``locators`` are (name, contact); ``name`` is the clamp's name in messages.
        """
        tip, stroke = clamp.compute_point(pose), -pose.travels[clamp.travel]
        if self.wall:
            above = tip[1] - clamp.radius
            words = f"{name} enters the {self.wall} by {format_middle(-above)} mm"
            at = f"{name} touches the {self.wall} exactly at the edge of what is allowed"
            yield from judge_slack(above + HAIR, words, at)
        hole = tip if self.span is None else clamp.hole
        for other, locator in locators:
            apart = (
                measure_piece_distance((locator.hole, locator.hole), (tip, hole))
                - locator.clear_radius
                - clamp.radius
            )
            yield from judge_slack(
                apart + HAIR,
                f"{name} meets {other}: they overlap by {format_middle(-apart)} mm",
                f"{name} touches {other} exactly at the edge of what is allowed",
            )
        if self.span is None:
            return
        least, most = self.span
        yield from judge_slack(
            stroke - least + HAIR,
            f"{name} is bolted {format_middle(stroke)} mm behind its tip, nearer than the {least:g} mm of its "
            "stroke",
            f"{name} is bolted exactly at the edge of the least of its stroke",
        )
        yield from judge_slack(
            most - stroke + HAIR,
            f"{name} is bolted {format_middle(stroke)} mm behind its tip, beyond the {most:g} mm of its stroke",
            f"{name} is bolted exactly at the edge of the most of its stroke",
        )
        if stroke > 0:
            start, end = (
                clamp.compute_center_in_part(pose),
                evolve(clamp, way=make_exact_point(0.0, 0.0)).compute_center_in_part(pose),
            )
            clear = compute_capsule_clearance(start, end, clamp.radius, outline.segments, enough=1.0)
            yield from judge_slack(
                clear + BODY_SLACK,
                f"{name} enters the workpiece between its hole and its tip by {format_middle(-clear)} mm",
                f"{name} touches the workpiece between its hole and its tip exactly at the edge of what is "
                "allowed",
            )

    def judge_nearest_hole(self, name: str, stroke: arb, pitch: float) -> Iterator[Finding]:
        """Yield a finding where the clamp could be bolted one hole nearer to its tip.

        It could where its ``stroke`` less one ``pitch``, both in mm, is still in range.
        """
        assert self.span is not None
        yield from judge_slack(
            self.span[0] - HAIR - (stroke - pitch),
            f"{name} could be bolted one hole nearer, {format_middle(stroke - pitch)} mm behind its tip",
            f"one hole nearer {name} would be bolted exactly at the edge of the least of its stroke",
        )

    def judge_clearance_between(
        self, one: BallContact, other: BallContact, pose: BallPose
    ) -> Iterator[Finding]:
        """Yield a finding where two clamps overlap; each is the strip from hole to tip, out to the clamp's
        radius.
        """
        tips = one.compute_point(pose), other.compute_point(pose)
        holes = tips if self.span is None else (one.hole, other.hole)
        apart = measure_piece_distance(*zip(tips, holes, strict=True)) - one.radius - other.radius
        yield from judge_slack(
            apart + HAIR,
            f"the clamps meet: they overlap by {format_middle(-apart)} mm",
            "the clamps touch exactly at the edge of what is allowed",
        )


def measure_piece_distance(one: tuple[Point, Point], other: tuple[Point, Point]) -> arb:
    """Return the distance in mm between two straight segments (start, end), each parallel to x or y."""
    beyond = []
    for a, b, c, d in zip(*one, *other, strict=True):
        beyond.append(arb(0).max(a.min(b) - c.max(d)).max(c.min(d) - a.max(b)))
    return compute_norm((beyond[0], beyond[1]))


def compute_capsule_clearance(
    start: Point, end: Point, radius: arb, sides: Iterable[Side], enough: float
) -> arb:
    """Return the least distance in mm between a capsule and any of the sides; negative where they overlap.

    The capsule is all that is within ``radius`` of the line from ``start`` to ``end``, which must differ.
    Distances of more than ``enough`` mm are returned as ``enough``.
    """
    piece = make_line_side(start, end)
    middle = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    nearest = arb(enough)
    for side in sides:
        if side.compute_distance(middle) - piece.length / 2 - radius > enough:
            continue
        nearest = nearest.min(compute_piece_distance(piece, side) - radius)
    return nearest


def compute_piece_distance(piece: LineSide, side: Side) -> arb:
    """Return the distance in mm between a straight segment and a side."""
    nearest = side.compute_distance(piece.start).min(side.compute_distance(piece.end))
    nearest = nearest.min(piece.compute_distance(side.start)).min(piece.compute_distance(side.end))
    for place, distance in find_nearest_places(piece, side):
        outside = place < 0 or place > piece.length
        inside = place > 0 and place < piece.length
        if not outside:
            nearest = nearest.min(distance) if inside else nearest.union(nearest.min(distance))
    return nearest


def find_nearest_places(piece: LineSide, side: Side) -> Iterator[tuple[arb, arb]]:
    """Yield (place, distance), in mm, for each point of a segment's line that may be nearest to a side.

    The place is measured from the segment's start and may lie beyond its ends. The points are crossings with
    the side's line or circle, and of an arc also the foot of the perpendicular from its centre.
    """
    if isinstance(side, ArcSide):
        ray = side.measure_from_center(piece.start)
        foot, off = -compute_dot_product(ray, piece.tangent), cross(ray, piece.tangent)
        square = side.radius * side.radius - off * off
        half = arb(0) if square < 0 else compute_square_root(square)
        for place in (foot - half, foot + half):
            yield place, side.compute_distance(find_point_along(piece, place))
        return
    slope = cross(piece.tangent, side.tangent)
    if slope > 0 or slope < 0:
        place = cross((side.start[0] - piece.start[0], side.start[1] - piece.start[1]), side.tangent) / slope
        yield place, side.compute_distance(find_point_along(piece, place))


def find_point_along(piece: LineSide, place: arb) -> Point:
    """Return the point ``place`` mm from the segment's start along its line."""
    return piece.start[0] + place * piece.tangent[0], piece.start[1] + place * piece.tangent[1]
