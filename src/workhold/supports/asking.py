"""Supports as they are asked of a fixture or of a result in Python."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from attrs import evolve, fields

from workhold.errors import InputError
from workhold.limits import counting_number
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.model.result import Result
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.model.support_triples import Supports
from workhold.supports.listing import supports_of, supports_of_best

__all__ = ["fixture_supports", "result_supports"]

Loads = Sequence[Load | SpatialLoad] | None
USUAL = ("thickness", "pad_radius", "tip_radius")
# What else may be asked, by its name.
FURTHER = tuple(one.name for one in fields(SupportRequest) if one.name not in USUAL)


def asked_request(query: Query, thickness: float | None, asked: dict[str, Any]) -> SupportRequest:
    """What is usual for a part, with what else is asked by name.

    Raises
    ------
    InputError
        For a name that there is none of, and values that cannot be.
    """
    unknown = next((name for name in asked if name not in (*USUAL, *FURTHER)), None)
    if unknown is not None:
        known = ", ".join((*USUAL[1:], *FURTHER))
        raise InputError(f"supports have no {unknown!r}: give some of {known}.")
    sizes = {name: asked.get(name) for name in USUAL[1:]}
    usual = SupportRequest.of(query.workpiece, thickness, toolkit=query.toolkit, **sizes)
    further = {name: value for name, value in asked.items() if name in FURTHER}
    if "bottom_zones" in further and "bottom" not in further:
        further["bottom_zones"] = (*usual.bottom_zones, *further["bottom_zones"])
    if "bottom" in further:
        further.setdefault("bottom_zones", ())
    if "top" in further:
        further.setdefault("top_heights", None)
    return evolve(usual, **further)


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
    request = asked_request(query, thickness, asked)
    return supports_of(fixture, query, request, loads, jaw_force, counting_number("best", best))


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

    Raises
    ------
    InputError
        As that method.
    """
    count, sets = counting_number("best", best), counting_number("each", each)
    fixtures = result[:count]
    request = asked_request(result.query, thickness, asked)
    return supports_of_best(fixtures, result.query, request, loads, jaw_force, 3 if sets is None else sets)
