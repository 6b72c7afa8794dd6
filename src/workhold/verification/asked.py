"""What the user asked for beyond a fixture: restrictions, figures of quality, their order.

These are no claims of existence, so plain numbers are enough: a rule is broken when it is missed by more than
``findings.AGREEMENT``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from math import cos, hypot, radians, sin
from typing import Any

import numpy as np
from attrs import field, frozen

from workhold.errors import InputError
from workhold.geometry.intersect import distance_to_segment
from workhold.geometry.segment import Point, segment_rows
from workhold.kernels.base.distance import is_inside
from workhold.listing.ranking import ranking_keys
from workhold.model.fixture import Fixture, Peg
from workhold.model.load import Load
from workhold.model.quality import CLOSURE_MARGIN, FIGURES, LOAD_REACTION, figure_number
from workhold.model.restrictions import Restrictions, Zone, zone_of
from workhold.model.result import FixtureTable, Result, unknown_quality
from workhold.model.tolerance import Tolerance
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece
from workhold.statics.quality import quality_of
from workhold.verification.findings import AGREEMENT

__all__ = ["Asked", "asked_in", "asked_of", "broken_restriction", "order_faults", "wrong_figures"]


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
    return Asked(result.restrictions, result.tolerance, result.loads, result.ranking)


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
    """A peg's centre in the part's frame."""
    angle, dx, dy = radians(fixture.pose.theta_deg), peg.x - fixture.pose.x, peg.y - fixture.pose.y
    return cos(angle) * dx + sin(angle) * dy, cos(angle) * dy - sin(angle) * dx


def zone_distance(zone: Zone, point: Point) -> float:
    """Distance in mm from a point to a zone, 0 inside."""
    if is_inside(*point, segment_rows(zone.segments)):
        return 0.0
    return min(distance_to_segment(point, segment) for segment in zone.segments)


def wrong_figures(fixtures: Sequence[Fixture], workpiece: Workpiece, vise: Vise, asked: Asked) -> dict[int, str]:
    """For each fixture, by its place, with a figure of quality that is not what it comes to: the first of them in words."""
    if not fixtures:
        return {}
    table = table_of(fixtures, vise)
    derived = quality_of(table, workpiece, vise, asked.tolerance, asked.loads)
    out: dict[int, str] = {}
    for number, figure in enumerate(FIGURES):
        written = np.array([fixture.quality.get(figure.key, np.nan) for fixture in fixtures])
        # The closure margin is proven with the forces; without loads there is no load reaction to compare with.
        if number == CLOSURE_MARGIN or (number == LOAD_REACTION and not asked.loads):
            continue
        wrong = np.abs(written - derived[:, number]) > AGREEMENT * np.maximum(1.0, np.abs(derived[:, number]))
        for place in np.flatnonzero(wrong):
            words = f"its {figure.words} is {written[place]:.9g} in the file and comes to {derived[place, number]:.9g}"
            out.setdefault(int(place), words)
    return out


def table_of(fixtures: Sequence[Fixture], vise: Vise) -> FixtureTable:
    """Fixtures as a table; pegs in the order of their arrangements."""
    names = [arrangement.name for arrangement in vise.arrangements]
    ordered = [sorted(fixture.pegs, key=lambda peg: peg.jaw == "right") for fixture in fixtures]

    def integers(name: str, kind: Any = np.int32) -> Any:
        return np.array([[getattr(peg, name) for peg in pegs] for pegs in ordered], kind)

    force = np.array([[peg.force for peg in pegs] for pegs in ordered])
    null = force / force.sum(axis=1, keepdims=True)
    return FixtureTable(
        arrangement=np.array([names.index(fixture.type) for fixture in fixtures], np.int8),
        column=integers("column"),
        row=integers("row"),
        face=integers("face"),
        theta=np.radians([fixture.pose.theta_deg for fixture in fixtures]),
        position=np.array([[fixture.pose.x, fixture.pose.y] for fixture in fixtures]),
        jaw_separation=np.array([fixture.jaw_separation for fixture in fixtures]),
        null_vector=null,
        force=force,
        quality=unknown_quality(null),
    )


def order_faults(fixtures: Sequence[Fixture], ranking: Sequence[str]) -> Iterator[str]:
    """A fault when fixtures are not in the order of their figures, equal ones apart."""
    if not ranking or any(key not in fixture.quality for fixture in fixtures for key in ranking):
        return
    quality = np.array([[fixture.quality.get(figure.key, np.nan) for figure in FIGURES] for fixture in fixtures])
    keys = np.array(ranking_keys(quality.reshape(-1, len(FIGURES)), ranking)).T
    for place in range(1, len(keys)):
        before, after = keys[place - 1], keys[place]
        differ = np.flatnonzero(np.abs(after - before) > AGREEMENT * np.maximum(1.0, np.abs(before)))
        if len(differ) and after[differ[0]] < before[differ[0]]:
            yield f"fixture {place + 1} is better than the one before it, by {', '.join(ranking)}"
            return
