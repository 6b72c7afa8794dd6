"""Sizes of supports and of the clamp on top that are tried one after another, where nobody asks for any.

Parts with thin walls below, slots or small bosses have no room for the usual pads, and narrow ones none for
a clamp so far inside its triangle. Ends of dowels as thick as those that locate do for such a part.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from workhold.fixels.support_hardware import SupportPads, TopClamp
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.support_request import SupportRequest
from workhold.model.support_triples import Supports
from workhold.model.workpiece import Workpiece
from workhold.supports.listing import supports_of_best

__all__ = ["SMALLER", "requests_by_size", "supported_by_size"]

# Radii of pads and of the tip that goes with them, in mm, where the usual ones find no place.
SMALLER = ((3.0, 4.0), (2.0, 3.0))


def requests_by_size(
    workpiece: Workpiece, thickness: float | None, toolkit: Toolkit
) -> Iterator[SupportRequest]:
    """What is usual for a part, and then the same with smaller pads and tips, but not than the toolkit has.

    Parameters
    ----------
    thickness : of the part in mm; that of its solid if None.

    Raises
    ------
    InputError
        When nobody says how thick the part is.
    """
    usual = SupportRequest.of(workpiece, thickness, toolkit=toolkit)
    yield usual
    pads, clamp = toolkit.supports or SupportPads(), toolkit.top_clamp or TopClamp()
    last = usual
    for pad, tip in SMALLER:
        smaller = SupportRequest.of(
            workpiece,
            thickness,
            pad_radius=min(pad, usual.pad_radius) if pads.pad_radius is None else None,
            tip_radius=min(tip, usual.tip_radius) if clamp.tip_radius is None else None,
            toolkit=toolkit,
        )
        if (smaller.pad_radius, smaller.tip_radius) != (last.pad_radius, last.tip_radius):
            yield smaller
        last = smaller


def supported_by_size(
    fixtures: Sequence[Fixture], query: Query, thickness: float | None
) -> tuple[tuple[Supports, ...], tuple[Supports, ...]]:
    """The best three supports of each fixture, of the largest sizes of which any has some.

    Parameters
    ----------
    thickness : of the part in mm; that of its solid if None.

    Returns
    -------
    These, or those of the least sizes where none has any, and those of the usual sizes.

    Raises
    ------
    InputError
        When nobody says how thick the part is, and as :func:`workhold.supports.listing.supports_of`.
    """
    usual = found = tuple[Supports, ...]()
    for request in requests_by_size(query.workpiece, thickness, query.toolkit):
        found = supports_of_best(fixtures, query, request, each=1)
        usual = usual or found
        if any(one.triples for one in found):
            break
    return found, usual
