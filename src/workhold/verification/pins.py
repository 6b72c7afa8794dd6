"""How far pegs bend, in ball arithmetic and from the file alone (docs/quality.md, "Pins bend").

Each peg in a hole of a plate is a cantilever of round section. It is pressed at the middle of the range of
heights over which it can press on its face. Of ``statics.pins`` nothing is used.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, hypot, sin

from attrs import frozen
from flint import arb

from workhold.fixels.contacts import FLAT_PIN, ROUND_PIN
from workhold.geometry.segment import Line, Segment
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.verification.tolerances import ELASTIC_MODULUS, SHEAR_MODULUS, STATED_FORCE

__all__ = ["PegBeam", "make_beams", "find_stated_force"]

Rows = Sequence[tuple[float, float, float]]
# A height that follows from where a peg touches is known no better than the pose of a file, in mm.
FROM_POSE = 1e-8


@frozen(eq=False)
class PegBeam:
    """A peg as a cantilever: its diameter and the height of the force above the plate, in mm."""

    diameter: arb
    height: arb

    def compute_deflection(self, force: arb) -> arb:
        """Return the tip deflection in mm under a force in N, by bending and shear."""
        radius = self.diameter / 2
        second_moment = arb.pi() * radius**4 / 4
        bends = force * self.height**3 / (3 * ELASTIC_MODULUS * second_moment)
        shears = force * self.height / (arb(9) / 10 * SHEAR_MODULUS * arb.pi() * radius**2)
        return bends + shears

    def compute_stress(self, force: arb) -> arb:
        """Return the bending stress in MPa at the root under a force in N: moment over section modulus."""
        return force * self.height / (arb.pi() * (self.diameter / 2) ** 3 / 4)


def make_beams(fixture: Fixture, query: Query) -> list[PegBeam | None] | None:
    """Return a list with a beam for each contact of a fixture, or None for a contact that does not bend.

    Contacts that do not bend are a clamp's tip and a wall. Returns None instead of a list where the pegs'
    heights are unknown, a peg has no radius, or no contact bends.
    """
    if not query.knows_heights:
        return None
    beams = list[PegBeam | None]()
    for peg in fixture.pegs:
        carrier = query.toolkit.find_carrier(peg.carrier)
        if carrier.contact not in (ROUND_PIN, FLAT_PIN):
            beams.append(None)
            continue
        run = find_run(peg.face, fixture.pose.inverse.apply(peg.x, peg.y), query)
        if run is None or carrier.peg_radius == 0.0:
            return None
        beams.append(PegBeam(2 * arb(carrier.peg_radius), (run[0] + run[1]) / 2))
    return beams if any(beams) else None


def find_stated_force(query: Query) -> arb:
    """Return the jaw force in N to which the stated bending belongs."""
    return arb(STATED_FORCE if query.jaw_force is None else query.jaw_force)


def find_run(number: int, point: tuple[float, float], query: Query) -> tuple[arb, arb] | None:
    """Return (from, to), the heights in mm over which a peg can press on a face; None where they are unknown.

    ``number`` is the face's number, ``point`` the peg's centre in the part's frame.
    """
    if query.workpiece.solid is None:
        heights = [one for one in (query.thickness, query.peg_height) if one is not None]
        return arb(0), arb(min(heights))
    every = query.workpiece.numbered
    segments = next(face.segments for face in every.faces if number in face.segments)
    if not any(every.runs[k] for k in segments):
        band = every.bands[number]
        return None if band is None else (arb(band[0]), arb(band[1]))
    # Of the pieces of the face it touches the one past whose ends it is least.
    places = {k: compute_share_along(every.segments[k], point) for k in segments}
    touched = min(segments, key=lambda k: (abs(places[k] - 0.5) - 0.5) * every.segments[k].half_extent)
    rows, band = every.runs[touched], every.bands[touched]
    if not rows:
        return None if band is None else (arb(band[0]), arb(band[1]))
    low, high = (interpolate_cubic(rows, places[touched], end) for end in (1, 2))
    if band is not None:
        low, high = min(low, band[0]), max(high, band[1])
    return arb(max(low, 0.0), FROM_POSE), arb(high, FROM_POSE)


def compute_share_along(segment: Segment, point: tuple[float, float]) -> float:
    """Return a point's position along a segment: 0 at the segment's start, 1 at its end.

    Beyond the start it is below 0, beyond the end above 1.
    """
    x, y = point
    if isinstance(segment, Line):
        (ax, ay), (bx, by) = segment.start, segment.end
        length = hypot(bx - ax, by - ay)
        return ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length**2
    cx, cy = segment.center
    middle, half = segment.mid_angle, segment.half_sweep
    ux, uy = cos(middle), sin(middle)
    angle = atan2(ux * (y - cy) - uy * (x - cx), ux * (x - cx) + uy * (y - cy))
    runs = 1.0 if segment.sign > 0 else -1.0
    return 0.5 + runs * angle / (2 * half)


def interpolate_cubic(rows: Rows, share: float, end: int) -> float:
    """Return the lower (``end`` 1) or upper (``end`` 2) height in mm at a share of a segment.

    Each row is (share, low, high). Every four rows define a cubic, evaluated by Neville's scheme.
    """
    first = 0
    while first + 6 < len(rows) and rows[first + 3][0] < share:
        first += 3
    piece = rows[first : first + 4]
    at = min(max(share, piece[0][0]), piece[-1][0])
    values = [row[end] for row in piece]
    for width in range(1, 4):
        values = [
            ((at - piece[k + width][0]) * values[k] + (piece[k][0] - at) * values[k + 1])
            / (piece[k][0] - piece[k + width][0])
            for k in range(4 - width)
        ]
    return values[0]
