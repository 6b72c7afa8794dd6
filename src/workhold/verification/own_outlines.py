"""The outlines of a workpiece in balls: its own, and those that carriers with heights of their own meet.

Segments of further outlines are numbered on; those of equal outlines have the same numbers. So a face's
number says of which outline it is, and whoever looks up a face by its number finds those of all outlines.
What a peg keeps from is its own carrier's outline.
"""

from __future__ import annotations

from typing import Any

from attrs import evolve

from workhold.model.workpiece import Workpiece
from workhold.verification.ball_geometry import BallOutline

__all__ = ["every_outline", "met_by"]


def every_outline(workpiece: Workpiece) -> BallOutline:
    """The outline of a workpiece at the precision in force, with the faces of all outlines in its tables."""
    whole = BallOutline.of(workpiece)
    if not workpiece.outlines:
        return whole
    first, own, known = len(whole.segments), dict[str, BallOutline](), list[tuple[Workpiece, BallOutline]]()
    for role, part in workpiece.outlines:
        same = next((outline for one, outline in known if one == part), None)
        if same is None:
            known.append((part, same := BallOutline.of(part, first)))
            first += len(same.segments)
        own[role] = same
    tables: dict[str, Any] = {
        name: {face: value for one in (whole, *own.values()) for face, value in getattr(one, name).items()}
        for name in ("faces", "others", "smooth", "turns", "neighbours")
    }
    return evolve(whole, **tables, own=own)


def met_by(outline: BallOutline, carrier: str) -> BallOutline:
    """What the pegs of a carrier of a name keep from; a clamp's name ends with its direction."""
    if not outline.own:
        return outline
    role = carrier.split(" ")[0]
    return outline.own[role] if role in outline.own else alone(outline)


def alone(outline: BallOutline) -> BallOutline:
    """The outline without the faces of others."""
    count = len(outline.segments)
    tables: dict[str, Any] = {
        name: {face: value for face, value in getattr(outline, name).items() if face < count}
        for name in ("faces", "others", "smooth", "turns", "neighbours")
    }
    return evolve(outline, **tables, own={})
