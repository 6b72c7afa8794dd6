"""Requests for supports: values by name, and smaller sizes to try if there is no place for the usual ones.

Parts with thin walls below, slots or small bosses have no room for the usual pads. Narrow parts have no room
for a clamp with the usual distance from the sides of its triangle. For these, ends of dowels as thick as the
locating ones are used.
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
from workhold.supports.listing import find_supports, yield_supports

__all__ = [
    "SMALLER",
    "make_request",
    "find_fixture_supports",
    "try_smaller_requests",
    "find_result_supports",
    "support_with_smaller_sizes",
]

Loads = Sequence[Load | SpatialLoad] | None
USUAL = ("thickness", "pad_radius", "tip_radius")
# What else may be asked, by its name.
FURTHER = tuple(one.name for one in fields(SupportRequest) if one.name not in USUAL)
# If one of these is asked for, no other sizes are tried.
SIZES = {"pad_radius", "tip_radius", "pad_margin", "inside", "tip_margin", "head_radius"}
# Radii of pads and of the tip that goes with them, in mm, where the usual ones find no place.
SMALLER = ((3.0, 4.0), (2.0, 3.0))


def make_request(query: Query, thickness: float | None, asked: Mapping[str, Any]) -> SupportRequest:
    """Return the support request for a part: usual values, except those given by field name.

    Parameters
    ----------
    thickness : thickness of the part in mm; None for that of its solid.
    asked : values of fields of :class:`SupportRequest` by name.

    Raises
    ------
    InputError
        For flat jaws, an unknown name, an invalid value, and an unknown thickness.
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
    usual = SupportRequest.from_workpiece(query.workpiece, thickness, toolkit=query.toolkit, **sizes)
    further = {name: value for name, value in asked.items() if name in FURTHER}
    if "top" in further:
        # For another face neither its height is known nor what is beside or under it.
        further = {"top_heights": None, **dict.fromkeys(BESIDE_TOP, ()), **further}
    return evolve(usual, **further)


def try_smaller_requests(
    query: Query, thickness: float | None, asked: Mapping[str, Any] | None = None
) -> Iterator[SupportRequest]:
    """Yield the request; then, if the user gave no size, requests with smaller pads and tips.

    Sizes that the toolkit prescribes are kept.

    Parameters
    ----------
    thickness, asked : see :func:`make_request`.
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
    """Return the supports of fixtures for the first request with which at least one fixture has a triple.

    The second result is the supports for the very first request of ``requests``.

    Parameters
    ----------
    requests : to be tried in turn, see :func:`try_smaller_requests`.
    each, drops_weak_force, cancel, progress : see :func:`workhold.supports.listing.yield_supports`; once
        ``cancel`` is set no further request is tried.
    first_only : whether to stop each try at the first fixture that has a triple.

    Returns
    -------
    (supports for that request, or for the last one where no fixture has any; supports for the first request)
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
    """Yield the supports of fixtures, up to and including the first fixture that has a triple."""
    for one in every:
        yield one
        if one.triples:
            return


def select_given(asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keyword arguments that are not None; the value :data:`OUTLINE` is replaced by None."""
    named = {name: value for name, value in asked.items() if value is not None}
    return {
        name: None if isinstance(value, str) and value == OUTLINE else value for name, value in named.items()
    }


def find_fixture_supports(
    fixture: Fixture,
    thickness: float | None = None,
    *,
    best: int | None = 3,
    loads: Loads = None,
    jaw_force: float | None = None,
    **asked: Any,
) -> Supports:
    """Return the best sets of three supports under a fixture, see :meth:`workhold.Fixture.supports`.

    ``best`` is how many sets; None for all.
    """
    query = fixture.listing.result.query
    request = make_request(query, thickness, select_given(asked))
    return find_supports(fixture, query, request, loads, jaw_force, check_count("best", best))


def find_result_supports(
    result: Result,
    thickness: float | None = None,
    *,
    best: int = 20,
    each: int = 3,
    loads: Loads = None,
    jaw_force: float | None = None,
    **asked: Any,
) -> tuple[Supports, ...]:
    """Return the supports of each of the best fixtures of a result.

    Parameters
    ----------
    best : number of fixtures.
    each : number of sets of three for each fixture. The other parameters are as in
        :meth:`workhold.Fixture.supports`.
    """
    count, sets = check_count("best", best), check_count("each", each)
    request, sets = make_request(result.query, thickness, select_given(asked)), 3 if sets is None else sets
    return tuple(yield_supports(list(islice(result, count)), result.query, request, loads, jaw_force, sets))
