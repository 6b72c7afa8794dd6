"""What the tools of a query's program sweep beside a carrier, and what its pegs keep from that."""

from __future__ import annotations

from functools import lru_cache

from workhold.contact.swept import Swept, swept_below
from workhold.fixels.carrier import Carrier
from workhold.model.program import Program
from workhold.model.query import Query

__all__ = ["keeps_of", "swept_beside", "swept_of"]


def keeps_of(query: Query, carrier: Carrier) -> list[tuple[Swept, float]]:
    """What a query's program sweeps at the heights of a carrier's pegs, and what their centres keep besides.

    Where pegs have a shoulder below the part, what is swept there follows, with what that keeps.
    """
    swept = swept_of(query, carrier)
    if swept is None or query.program is None:
        return []
    pieces, clearance = swept
    keeps = [(pieces, clearance + carrier.peg_radius)]
    if carrier.body_radius > carrier.peg_radius:
        keeps.append((swept_below(query.program, 0.0), clearance + carrier.body_radius))
    return keeps


def swept_of(query: Query, carrier: Carrier) -> tuple[Swept, float] | None:
    """What a query's program sweeps at the heights of a carrier's pegs, and the clearance in mm.

    None without a program.
    """
    if query.passed is None:
        return None
    program, height = query.passed
    return swept_beside(program, height, carrier), program.clearance


def swept_beside(program: Program, peg_height: float, carrier: Carrier) -> Swept:
    """What a program sweeps at the heights of what stands on a carrier.

    Parameters
    ----------
    peg_height : up to which a carrier without heights of its own reaches, in mm.
    """
    low, high = carrier.heights or (0.0, peg_height)
    return swept_between(program, low, high) if low > 0.0 else swept_below(program, high)


@lru_cache(maxsize=16)
def swept_between(program: Program, low: float, high: float) -> Swept:
    """What a program sweeps between two heights in mm."""
    return Swept.of(program.iter_swept(low, high))
