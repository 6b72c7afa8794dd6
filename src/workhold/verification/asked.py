"""What the user asked for beyond a fixture: restrictions, and what figures of quality are for.

Restrictions are no claims of existence, so the pose as it is written is enough: one is broken when it is missed by more than
``rules.AGREEMENT``.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from math import hypot
from typing import Any

from attrs import field, frozen
from flint import arb

from workhold.errors import InputError
from workhold.model.fixture import Fixture, Peg
from workhold.model.load import Load
from workhold.model.quality import figure_number
from workhold.model.restrictions import Restrictions, zone_of
from workhold.model.result import Result
from workhold.model.tolerance import Tolerance
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece
from workhold.verification.balls import Point, exact_point, turned
from workhold.verification.rules import AGREEMENT
from workhold.verification.zones import zone_distance

__all__ = ["Asked", "asked_in", "asked_of", "broken_restriction"]


@frozen
class Asked:
    """What a result says was asked for.

    Parameters
    ----------
    restrictions, tolerance, loads : see ``Result``.
    ranking : keys of the figures ranked by; empty when the result does not say.
    """

    restrictions: Restrictions = field(factory=Restrictions)
    tolerance: Tolerance = field(factory=Tolerance)
    loads: tuple[Load, ...] = ()
    ranking: tuple[str, ...] = ()


def asked_of(result: Result) -> Asked:
    """What a result says was asked for."""
    query = result.query
    return Asked(query.restrictions, query.tolerance, query.loads, query.ranking)


def asked_in(data: Mapping[str, Any]) -> Asked:
    """What the head of a file says was asked for.

    Raises
    ------
    InputError
        When it cannot be understood.
    """
    try:
        limits, off = data.get("restrictions") or {}, data.get("tolerance")
        return Asked(
            Restrictions(
                avoid=tuple(int(face) for face in limits.get("avoid", ())),
                zones=tuple(zone_of(loop) for loop in limits.get("zones", ())),
                angles=tuple((float(low), float(high)) for low, high in limits.get("angles", ())),
            ),
            Tolerance() if off is None else Tolerance(off["peg"], off["face"]),
            tuple(load_from(item) for item in data.get("loads", ())),
            tuple(str(key) for key in data.get("ranking", ()) if figure_number(str(key)) is not None),
        )
    except (TypeError, ValueError, KeyError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"its restrictions, tolerance or loads cannot be used: {error}.") from error


def load_from(item: Mapping[str, Any]) -> Load:
    """A load as a file writes it."""
    points = tuple((float(x), float(y)) for x, y in item["points"])
    low, high = item["directions"]
    return Load(points, item["force"], (float(low), float(high)), item["moment"], str(item.get("name", "")))


def broken_restriction(fixture: Fixture, workpiece: Workpiece, vise: Vise, restrictions: Restrictions) -> str:
    """The restriction that a fixture breaks, in one sentence without a full stop; empty when it keeps all."""
    avoided = {face.number for face in workpiece.faces if set(face.segments) & set(restrictions.avoid)}
    for position, peg in enumerate(fixture.pegs, 1):
        if peg.face in avoided:
            return f"peg {position} touches face {peg.face}, which is to be avoided"
        if any((h.jaw, h.column) == (peg.jaw, peg.column) and h.row in (None, peg.row) for h in vise.blocked):
            return f"peg {position} stands in {peg.hole}, which is blocked"
        for zone in restrictions.zones:
            if zone_distance(zone, in_part(fixture, peg)) < vise.body_radius - AGREEMENT:
                return f"peg {position} stands over a keep-out zone"
    for (i, one), (k, other) in combinations(enumerate(fixture.pegs, 1), 2):
        if hypot(one.x - other.x, one.y - other.y) < 2 * vise.body_radius - AGREEMENT:
            return f"the bodies of pegs {i} and {k} overlap"
    theta = fixture.pose.theta_deg
    inside = ((theta - low + AGREEMENT) % 360.0 <= high - low + 2 * AGREEMENT for low, high in restrictions.angles)
    if restrictions.angles and not any(inside):
        return f"the part lies at {theta:g} degrees, which is outside the angles asked for"
    return ""


def in_part(fixture: Fixture, peg: Peg) -> Point:
    """A peg's centre in the part's frame; in balls, and not by ``Pose``, which is what is checked."""
    sine, cosine = (arb(fixture.pose.theta_deg) / 180).sin_cos_pi()
    return turned(exact_point(peg.x - fixture.pose.x, peg.y - fixture.pose.y), cosine, -sine)
