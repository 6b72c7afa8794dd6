"""Supports as they are asked of fixtures: by names of what is wanted, and of sizes that fall until some hold.

Parts with thin walls below, slots or small bosses have no room for the usual pads, and narrow ones none for
a clamp so far inside its triangle. Ends of dowels as thick as those that locate do for such a part.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

from attrs import evolve, fields

from workhold.errors import InputError
from workhold.fixels.support_hardware import SupportPads, TopClamp
from workhold.limits import check_count
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.model.result import Result
from workhold.model.solid import BESIDE_TOP
from workhold.model.support_request import OUTLINE, SpatialLoad, SupportRequest, compute_usual_head
from workhold.model.support_triples import Supports
from workhold.supports.choosing import Stop
from workhold.supports.listing import supports_of, yield_supports

__all__ = [
    "SMALLER",
    "make_request",
    "fixture_supports",
    "try_smaller_requests",
    "result_supports",
    "support_with_smaller_sizes",
]

Loads = Sequence[Load | SpatialLoad] | None
USUAL = ("thickness", "pad_radius", "tip_radius")
# What else may be asked, by its name.
FURTHER = tuple(one.name for one in fields(SupportRequest) if one.name not in USUAL)
# Who asks for one of these is given no other sizes.
SIZES = {"pad_radius", "tip_radius", "pad_margin", "inside", "tip_margin", "head_radius"}
# Radii of pads and of the tip that goes with them, in mm, where the usual ones find no place.
SMALLER = ((3.0, 4.0), (2.0, 3.0))


def make_request(query: Query, thickness: float | None, asked: Mapping[str, Any]) -> SupportRequest:
    """What is usual for a part, with what else is asked by name.

    Parameters
    ----------
    thickness : of the part in mm; that of its solid if None.

    Raises
    ------
    InputError
        For a name that there is none of, values that cannot be, and where nobody says how thick the part is.
    """
    if query.toolkit.flat_jaws is not None:
        raise InputError(
            "between flat jaws the part lies on parallels: supports are found under fixtures with pegs."
        )
    unknown = next((name for name in asked if name not in (*USUAL, *FURTHER)), None)
    if unknown is not None:
        known = ", ".join((*USUAL[1:], *FURTHER))
        raise InputError(f"supports have no {unknown!r}: give some of {known}.")
    sizes = {name: asked.get(name) for name in USUAL[1:]}
    usual = SupportRequest.of(query.workpiece, thickness, toolkit=query.toolkit, **sizes)
    further = {name: value for name, value in asked.items() if name in FURTHER}
    if "top" in further:
        # Of another face nobody says how high it is, nor what is beside or under it.
        further = {"top_heights": None, **dict.fromkeys(BESIDE_TOP, ()), **further}
    return evolve(usual, **further)


def try_smaller_requests(
    query: Query, thickness: float | None, asked: Mapping[str, Any] | None = None
) -> Iterator[SupportRequest]:
    """What is asked, and where no size is, the same with smaller pads and tips, but not than the toolkit has.

    Parameters
    ----------
    thickness, asked : as of :func:`make_request`.
    """
    usual = last = make_request(query, thickness, asked or {})
    yield usual
    if asked and not SIZES.isdisjoint(asked):
        return
    pads, clamp = query.toolkit.supports or SupportPads(), query.toolkit.top_clamp or TopClamp()
    for pad, tip in SMALLER:
        tip = min(tip, usual.tip_radius) if clamp.tip_radius is None else usual.tip_radius
        smaller = evolve(
            usual,
            pad_radius=min(pad, usual.pad_radius) if pads.pad_radius is None else usual.pad_radius,
            tip_radius=tip,
            inside=tip if clamp.inside is None else clamp.inside,
            head_radius=compute_usual_head(tip) if clamp.head_radius is None else clamp.head_radius,
        )
        if (smaller.pad_radius, smaller.tip_radius) != (last.pad_radius, last.tip_radius):
            yield smaller
        last = smaller


def support_with_smaller_sizes(
    fixtures: Sequence[Fixture],
    query: Query,
    requests: Iterable[SupportRequest],
    loads: Loads = None,
    jaw_force: float | None = None,
    each: int | None = 1,
    *,
    first_only: bool = False,
    drops_weak_force: bool = False,
    cancel: Stop | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[tuple[Supports, ...], tuple[Supports, ...]]:
    """The best supports of some fixtures, of the first request of which any fixture has some.

    Parameters
    ----------
    requests : to be tried in turn, see :func:`try_smaller_requests`.
    each, drops_weak_force, cancel, progress : see :func:`workhold.supports.listing.yield_supports`;
        once ``cancel`` is set no further request is tried.
    first_only : whether fixtures behind the first that has some are passed over.

    Returns
    -------
    These, or those of the last request where none has any, and those of the first request.
    """
    usual = found = tuple[Supports, ...]()
    for request in requests:
        every = yield_supports(
            fixtures,
            query,
            request,
            loads,
            jaw_force,
            each,
            drops_weak_force=drops_weak_force,
            cancel=cancel,
            progress=progress,
        )
        found = tuple(list_up_to_first_supported(every) if first_only else every)
        usual = usual or found
        if any(one.triples or one.stopped for one in found):
            break
    return found, usual


def list_up_to_first_supported(every: Iterable[Supports]) -> Iterator[Supports]:
    """The supports of fixtures up to the first that has some."""
    for one in every:
        yield one
        if one.triples:
            return


def given(asked: Mapping[str, Any]) -> dict[str, Any]:
    """What of keywords is not None; faces that are to be the outline are None for a request."""
    named = {name: value for name, value in asked.items() if value is not None}
    return {
        name: None if isinstance(value, str) and value == OUTLINE else value for name, value in named.items()
    }


def fixture_supports(
    fixture: Fixture,
    thickness: float | None = None,
    *,
    best: int | None = 3,
    loads: Loads = None,
    jaw_force: float | None = None,
    **asked: Any,
) -> Supports:
    """The supports of a fixture, see :meth:`workhold.Fixture.supports`."""
    query = fixture.listing.result.query
    request = make_request(query, thickness, given(asked))
    return supports_of(fixture, query, request, loads, jaw_force, check_count("best", best))


def result_supports(
    result: Result,
    thickness: float | None = None,
    *,
    best: int = 20,
    each: int = 3,
    loads: Loads = None,
    jaw_force: float | None = None,
    **asked: Any,
) -> tuple[Supports, ...]:
    """The supports of the best fixtures of a result.

    Parameters
    ----------
    best : how many fixtures.
    each : how many sets of three for each of them; the rest as in :meth:`workhold.Fixture.supports`.
    """
    count, sets = check_count("best", best), check_count("each", each)
    request, sets = make_request(result.query, thickness, given(asked)), 3 if sets is None else sets
    return tuple(yield_supports(list(islice(result, count)), result.query, request, loads, jaw_force, sets))
