"""Fixtures with supports for the tests of this folder, and complete sets of triples from an independent enumeration.

The sets in ``truth`` come from a slow program that shares no line with this one: every triple of holes, the best
place of the clamp by a grid that is refined."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from attrs import frozen

from workhold import Fixture, Query, Result, Vise, Workpiece, circle_zone
from workhold.files.result.reader import add_missing_figures, check_table, collect_columns
from workhold.model.support_request import SpatialLoad, SupportRequest

TRUTH = Path(__file__).parent / "truth"
NAMES = ("bracketL", "large4Handle", "plate100")


@frozen
class Case:
    """A planar fixture, what is asked of its supports, and the complete set."""

    truth: dict[str, Any]
    query: Query
    fixture: Fixture
    request: SupportRequest
    loads: tuple[SpatialLoad, ...]
    jaw_force: float


def case(name: str) -> Case:
    """A case of the complete sets."""
    return case_of(name, json.loads((TRUTH / f"{name}.json").read_text()))


def case_of(name: str, truth: dict[str, Any]) -> Case:
    """The case that a file of a complete set describes."""
    vise = {**truth["vise"], "pitch": tuple(truth["vise"]["pitch"])}
    query = Query(Workpiece.from_loops(name, truth["workpiece"]["loops"]), Vise(**vise))
    table = add_missing_figures(check_table(collect_columns([truth["fixture"]], TRUTH), query, TRUTH), query)
    counts = query.toolkit.count_arrangements(table.arrangement)
    fixture = Result(query, table, found=counts, distinct=counts)[0]
    heights, pads, clamp = truth["heights"], truth["supports"], truth["clamp"]
    request = SupportRequest(
        heights["thickness"],
        pads["pad_radius"],
        clamp["tip_radius"],
        band=heights["band"],
        pad_margin=pads["pad_margin"],
        bottom_zones=[circle_zone(*zone["circle"]) for zone in pads["zones"]],
        top_zones=[circle_zone(*zone["circle"]) for zone in clamp["zones"]],
        inside=clamp["inside"],
        point=clamp["point"],
    )
    loads = tuple(SpatialLoad(**load) for load in truth["loads"])
    return Case(truth, query, fixture, request, loads, truth["jaw_force"])
