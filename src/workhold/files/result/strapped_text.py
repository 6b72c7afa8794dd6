"""The text of seats under straps: a line of JSON of a result file, or a row of a spreadsheet, for each.

The text of a seat has its three locators, the pose and, if straps were searched, the straps with the push by
hand. :mod:`workhold.files.result.strapped` reads the lines; it is a module of its own because pydantic takes
long to import.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import ProgramJawForce
from workhold.model.quality import (
    EDGE_DISTANCE,
    END_DISTANCE,
    FIGURES,
    LOCATION_ERROR,
    SMALLEST_FACE,
    TILT,
    Figure,
)
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.straps import STRAP_FIGURES, StrappedHold, write_times

__all__ = [
    "SEAT_FIGURES",
    "is_strapped",
    "make_need_entry",
    "list_strapped_columns",
    "make_strapped_entry",
    "iterate_strapped_rows",
]

DIGITS = 12
# The figures of a seat, those of straps besides.
SEAT_FIGURES = tuple(
    FIGURES[number] for number in (LOCATION_ERROR, END_DISTANCE, EDGE_DISTANCE, TILT, SMALLEST_FACE)
)


def round_length(value: float) -> float:
    """Return a length in mm rounded to 1e-9 mm, without a negative zero."""
    return round(value, 9) + 0.0


def round_figure(value: float | None) -> float | None:
    """Return a figure rounded to twelve digits, without a negative zero; None is returned unchanged."""
    return None if value is None else float(f"{value:.{DIGITS}g}") + 0.0


def is_strapped(fixture: Any) -> bool:
    """Return whether a fixture, as parsed from a file, is a seat under straps."""
    return isinstance(fixture, dict) and "straps" in fixture and "push" in fixture


def make_strapped_entry(fixture: Fixture) -> dict[str, Any]:
    """Return the JSON object of a seat with its straps; lengths in mm, angles in degrees, forces in N."""
    hold, pose = fixture.hold, fixture.pose
    assert isinstance(hold, StrappedHold)
    push = hold.push
    seat = {
        one.key: round_figure(fixture.quality[one.key]) for one in SEAT_FIGURES if one.key in fixture.quality
    }
    needs: dict[str, Any] = {}
    if hold.places is not None:
        needs = {
            "full_contact": bool(hold.straps),
            "clamp_needed": round_figure(hold.clamp_needed),
            "clamp_needed_each": [round_figure(one) for one in hold.clamp_needed_each],
            **hold.describe_safety(),
        }
    return {
        "type": fixture.type,
        "pegs": [
            {
                "role": "locator",
                "column": peg.column,
                "row": peg.row,
                "x": round_length(peg.x),
                "y": round_length(peg.y),
                "segment": peg.face,
            }
            for peg in fixture.pegs
        ],
        "pose": {
            "theta_deg": round(pose.theta_deg, 10) % 360.0 + 0.0,
            "x": round_length(pose.x),
            "y": round_length(pose.y),
        },
        "looked_at": hold.is_looked_at,
        "straps": [
            {
                "hole": list(one.hole),
                "at": [round_length(value) for value in one.at],
                "over": one.written_over,
                "heel": round_length(one.height),
            }
            for one in hold.straps
        ],
        "supports": [list(one) for one in hold.supports],
        "places": hold.places,
        "push": None
        if push is None
        else {
            "at": [round_length(value) for value in push.at],
            "direction_deg": round(push.direction_deg, 9),
            "shares": [round_figure(one) for one in push.shares],
        },
        "quality": {**seat, **needs},
        **({} if hold.program_need is None else {"program_force": make_strap_need_entry(hold)}),
    }


def make_need_entry(need: ProgramJawForce) -> dict[str, Any]:
    """Return the JSON object of the clamp force that the program's
    tools need, with its line, tool and move.
    """
    return {"force": round_figure(need.force), "line": need.line, "tool": need.tool, "move": need.move}


def make_strap_need_entry(hold: StrappedHold) -> dict[str, Any]:
    """Return the JSON object of the strap force that the program's tools need.

    Where a force of the straps is given, it also has how many times that force holds the part against them; null
    stands for any number.
    """
    assert hold.program_need is not None
    entry = make_need_entry(hold.program_need)
    return entry if not hold.safety_each else {**entry, "safety_reached": write_times(hold.safety_each[-1])}


def list_row_figures(query: Query) -> tuple[Figure, ...]:
    """Return the figures that a row of a spreadsheet has; the safety only where a force of the straps is given."""
    given = query.jaw_force is not None
    of_straps = (one for one in STRAP_FIGURES if given or one.key != "safety_reached")
    return (*of_straps, *SEAT_FIGURES)


def list_strapped_columns(query: Query, straps: int) -> list[str]:
    """Return the column names of :func:`iterate_strapped_rows` for up to ``straps`` straps in a seat."""
    pegs = [f"{name}_{k}" for k in range(1, 4) for name in ("column", "row", "face")]
    of_straps = [
        f"strap_{name}_{k}" for k in range(1, straps + 1) for name in ("column", "row", "x", "y", "heel")
    ]
    keys = [one.key for one in list_row_figures(query)]
    return ["number", "type", "theta_deg", "x", "y", *keys, *pegs, *of_straps, "push_x", "push_y", "push_deg"]


def iterate_strapped_rows(result: Result, straps: int) -> Iterator[list[Any]]:
    """Yield a row for each seat, best first: lengths in mm, angles in degrees, forces in N; None for unknown
    values.

    ``straps`` is the number of straps for which a row has cells.
    """
    for number, fixture in enumerate(result, 1):
        entry = make_strapped_entry(fixture)
        pose, figures = entry["pose"], fixture.quality
        known = [figures.get(one.key) for one in list_row_figures(result.query)]
        row = [number, entry["type"], pose["theta_deg"], pose["x"], pose["y"], *map(round_figure, known)]
        for peg in entry["pegs"]:
            row += [peg["column"], peg["row"], peg["segment"]]
        for k in range(straps):
            one = entry["straps"][k] if k < len(entry["straps"]) else None
            row += [None] * 5 if one is None else [*one["hole"], *one["at"], one["heel"]]
        push = entry["push"]
        yield row + ([None] * 3 if push is None else [*push["at"], push["direction_deg"]])
