"""What a setup sheet tells beyond the fixture itself: what calipers measure, where contacts end, what to beware of."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, cos, hypot, inf, radians, sin

from attrs import frozen

from workhold.contact.features import contact_features, end_slacks
from workhold.drawing.length_unit import LengthUnit
from workhold.drawing.sheet_details import SheetDetails
from workhold.geometry.segment import Arc
from workhold.model.fixture import Fixture, Peg
from workhold.model.result import LEFT, RIGHT, FixtureTable, hole_position
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece

__all__ = [
    "LARGE_AMPLIFICATION",
    "LARGE_LOCATION_ERROR",
    "NEAR_END",
    "WEAK_CLOSURE",
    "CaliperCheck",
    "Caution",
    "caliper_check",
    "cautions_of",
    "edge_distances",
    "same_holes",
]

# A contact nearer than this to an edge, in mm, is warned of: edges are commonly broken by some tenths of a millimetre.
NEAR_END = 1.0
# Below this closure margin the weakest contact has less than a twelfth of the even share, a quarter.
WEAK_CLOSURE = 0.02
# A peg that pushes with more than so many times the jaw force wedges the part and marks its face.
LARGE_AMPLIFICATION = 3.0
# A location error of more than so many times the sum of the tolerances of peg and face: the contacts guide badly.
LARGE_LOCATION_ERROR = 5.0


@frozen
class Caution:
    """Something to beware of.

    Parameters
    ----------
    kind : "edge", "closure", "amplification", "location", "load" or "pose".
    sentence : for people; lengths in it are in mm or inch as asked for.
    """

    kind: str
    sentence: str


@frozen
class CaliperCheck:
    """Two holes whose distance tells the jaw opening.

    Parameters
    ----------
    left, right : (column, row) of the hole on each jaw.
    distance : between their centres, in mm.
    placed : how many of the two hold a peg of the fixture.
    """

    left: tuple[int, int]
    right: tuple[int, int]
    distance: float
    placed: int


def caliper_check(fixture: Fixture, vise: Vise) -> CaliperCheck:
    """The pair of holes, one in either jaw's column at the opening, to measure the opening between.

    They are as level as possible, so that calipers held square to the jaws span them; among those, with as many pegs of
    the fixture as possible, then the lowest. Columns at the opening are the left jaw's last and the right one's first.
    """
    used = {(peg.jaw, peg.column, peg.row) for peg in fixture.pegs}
    rows = sorted({peg.row for peg in fixture.pegs})
    blocked = {(holes.jaw, holes.column, holes.row) for holes in vise.blocked}
    shift = round(vise.row_offset / vise.pitch[1])
    last = vise.columns - 1
    best: tuple[float, int, int, int] | None = None
    for low, high in {(row + a, row + a + b - shift) for row in [*rows, 0] for a in (-1, 0, 1) for b in (-1, 0, 1)}:
        if min(low, high) < 0 or (vise.rows is not None and max(low, high) >= vise.rows):
            continue
        holes = (("left", last, low), ("right", 0, high))
        if any(hole in blocked or (*hole[:2], None) in blocked for hole in holes):
            continue
        tilt = abs(high * vise.pitch[1] + vise.row_offset - low * vise.pitch[1])
        key = (round(tilt, 9), -sum(hole in used for hole in holes), low, high)
        best = key if best is None else min(best, key)
    if best is None:
        best = (0.0, 0, rows[0], rows[0])
    _, placed, low, high = best
    left = hole_position(vise, LEFT, last, low, fixture.jaw_separation)
    right = hole_position(vise, RIGHT, 0, high, fixture.jaw_separation)
    return CaliperCheck((last, low), (0, high), hypot(right[0] - left[0], right[1] - left[1]), -placed)


def edge_distances(fixture: Fixture, workpiece: Workpiece, vise: Vise) -> list[float]:
    """How far in mm each peg's centre is from the nearer end of its contact feature at which an edge or another face
    waits; infinite where the feature ends in no edge (a whole circle, tangent joints).
    """
    features = contact_features(workpiece, vise.peg_radius)
    smooth = end_slacks(features) > 0
    distances = []
    for peg in fixture.pegs:
        point = in_part(peg, fixture)
        nearest = (inf, inf)
        for feature, joined in zip(features, smooth, strict=True):
            if feature.face != peg.face:
                continue
            segment = feature.segment
            half, parameter = segment.half_extent, segment.parameter(point)
            inside = max(-half, min(half, parameter))
            foot = segment.at(inside)
            unit = segment.radius if isinstance(segment, Arc) else 1.0
            ends = [
                inf if end else unit * max(half + way * inside, 0.0) for end, way in zip(joined, (1, -1), strict=True)
            ]
            if isinstance(segment, Arc) and segment.is_full:
                ends = [inf, inf]
            nearest = min(nearest, (hypot(foot[0] - point[0], foot[1] - point[1]), min(ends)))
        distances.append(nearest[1])
    return distances


def in_part(peg: Peg, fixture: Fixture) -> tuple[float, float]:
    """A peg's centre in the workpiece's frame, in mm."""
    pose = fixture.pose
    c, s = cos(radians(pose.theta_deg)), sin(radians(pose.theta_deg))
    x, y = peg.x - pose.x, peg.y - pose.y
    return c * x + s * y, c * y - s * x


def same_holes(table: FixtureTable, index: int) -> int:
    """How many other fixtures of a table have their pegs in the same holes as the one of an index."""
    same = table.arrangement == table.arrangement[index]
    for holes in (table.column, table.row):
        same &= (holes == holes[index]).all(axis=1)
    return int(same.sum()) - 1


def cautions_of(
    fixture: Fixture, distances: Sequence[float], details: SheetDetails, lengths: LengthUnit
) -> list[Caution]:
    """What to beware of, the contacts first.

    Parameters
    ----------
    distances : of the four contacts from edges, see :func:`edge_distances`.
    """
    found: list[Caution] = []
    for peg, distance in zip(fixture.pegs, distances, strict=True):
        if distance < NEAR_END:
            place = f"{peg.hole} touches face {peg.face} only {lengths.words(distance)} from its end"
            found.append(Caution("edge", f"{place}: a burr or a broken edge there shifts the part."))
    margin = fixture.quality.get("closure_margin", inf)
    if margin < WEAK_CLOSURE:
        weakest = min(fixture.pegs, key=lambda peg: peg.force)
        found.append(
            Caution("closure", f"Weak closure: {weakest.hole} has only {margin:.2%} of the hold (even would be 25%).")
        )
    largest = max(fixture.pegs, key=lambda peg: peg.force)
    if largest.force > LARGE_AMPLIFICATION:
        words = f"{largest.hole} pushes {largest.force:.1f} times as hard as the jaws: tighten gently"
        found.append(Caution("amplification", f"{words}, it may mark face {largest.face}."))
    error, off = fixture.quality.get("location_error", 0.0), details.tolerance.peg + details.tolerance.face
    if error > LARGE_LOCATION_ERROR * off:
        words = f"Pegs and faces within tolerance may still shift the part by {lengths.words(error)}"
        found.append(Caution("location", f"{words}: probe it after clamping."))
    if details.jaw_force is not None:
        for number, case in enumerate(details.loads, 1):
            if not case.keeps_contact:
                name, peg = case.load.name or f"load {number}", fixture.pegs[case.needed.peg]
                words = f"Under {name} {peg.hole} lets go at the {details.jaw_force:.0f} N given"
                found.append(Caution("load", f"{words}: clamp with more than {ceil(case.needed.value)} N."))
    if details.others:
        ways = "one other way" if details.others == 1 else f"{details.others} other ways"
        found.append(Caution("pose", f"The same four holes hold this part in {ways}: make sure of angle and faces."))
    return found
