"""The text of fixtures that hold by friction: a line of JSON, or a row of a spreadsheet, for each.

For a fixture without pegs the text has the faces that each jaw touches, as rectangles in the jaw's plane, the
height of the parallels and the side of the work stop. Figures that follow from these are written, too.
:mod:`workhold.files.result.holds` reads the lines; it is a module of its own because pydantic takes long to
import. Straps are written by :mod:`workhold.files.result.strapped_text`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from workhold.files.result.strapped_text import (
    is_strapped,
    iterate_strapped_rows,
    list_strapped_columns,
    make_need_entry,
    make_strapped_entry,
)
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import HOLD_FIGURES, JawHold, JawPatch
from workhold.model.query import Query
from workhold.model.result import Result

__all__ = [
    "list_hold_columns",
    "make_hold_entry",
    "write_hold_lines",
    "list_hold_rows",
    "is_friction_fixture",
    "make_need_entry",
]

DIGITS = 12


def round_length_for_file(value: float) -> float:
    """Return a length in mm rounded to 1e-9, without a negative zero."""
    return round(value, 9) + 0.0


def round_figure_for_file(value: Any) -> Any:
    """Return a number, or nested lists of them, rounded to
    twelve digits; None and bool are returned unchanged.
    """
    if isinstance(value, list):
        return [round_figure_for_file(one) for one in value]
    return value if value is None or isinstance(value, bool) else float(f"{value:.{DIGITS}g}") + 0.0


def make_hold_entry(fixture: Fixture) -> dict[str, Any]:
    """Return the JSON object of a fixture that holds by friction; lengths in mm, angles in degrees."""
    hold, pose = fixture.hold, fixture.pose
    if not isinstance(hold, JawHold):
        return make_strapped_entry(fixture)

    def make_patch_entry(patch: JawPatch) -> dict[str, Any]:
        """Return the JSON object of a patch, which is the area that a jaw touches."""
        rectangles = [[round_length_for_file(end) for end in one] for one in patch.rectangles]
        return {"segments": list(patch.segments), "rectangles": rectangles}

    need, offsets = hold.program_need, hold.parallel_offsets
    moved = {"parallel_offsets": [round_length_for_file(one) for one in offsets]}
    of_program = {} if need is None else {"program_force": make_need_entry(need)}
    return {
        "type": fixture.type,
        "parallels": round_length_for_file(hold.parallels),
        **(moved if hold.has_moved_parallels else {}),
        "stop": hold.stop,
        "fixed": make_patch_entry(hold.fixed),
        "moving": make_patch_entry(hold.moving),
        "pose": {
            "theta_deg": round(pose.theta_deg, 10) % 360.0 + 0.0,
            "x": round_length_for_file(pose.x),
            "y": round_length_for_file(pose.y),
        },
        "jaw_separation": round_length_for_file(hold.opening),
        "warnings": list(hold.warnings),
        "quality": {key: round_figure_for_file(value) for key, value in hold.to_quality().items()},
        **of_program,
    }


def write_hold_lines(result: Result) -> Iterator[str]:
    """Yield the JSON line of each fixture of a result."""
    return (json.dumps(make_hold_entry(fixture)) for fixture in result)


def is_friction_fixture(fixture: Any) -> bool:
    """Return whether a fixture, as parsed from a file, is one that holds by friction."""
    return is_strapped(fixture) or (
        isinstance(fixture, dict) and "moving" in fixture and "pegs" not in fixture
    )


BEFORE_FIGURES = ("number", "type", "theta_deg", "x", "y", "jaw_separation", "parallels", "stop")
AFTER_FIGURES = ("full_contact", "faces_fixed", "faces_moving", "warnings")


def list_hold_columns(query: Query) -> list[str]:
    """Return the column names of :func:`list_hold_rows` for a result of a query."""
    straps = query.toolkit.strap_set
    if straps is not None:
        return list_strapped_columns(query, straps.count)
    return [*BEFORE_FIGURES, *(figure.key for figure in HOLD_FIGURES), *AFTER_FIGURES]


def list_hold_rows(result: Result) -> Iterator[list[Any]]:
    """Yield a row for each fixture, best first: lengths in
    mm, angles in degrees, forces in N; None where not known.
    """
    if result.toolkit.strap_set is not None:
        yield from iterate_strapped_rows(result, result.toolkit.strap_set.count)
        return
    for number, fixture in enumerate(result, 1):
        entry = make_hold_entry(fixture)
        pose, quality = entry["pose"], entry["quality"]
        faces = (" ".join(map(str, entry[jaw]["segments"])) for jaw in ("fixed", "moving"))
        figures = [quality.get(figure.key) for figure in HOLD_FIGURES]
        before = [number, entry["type"], pose["theta_deg"], pose["x"], pose["y"], entry["jaw_separation"]]
        after = [quality["full_contact"], *faces, "; ".join(entry["warnings"])]
        yield [*before, entry["parallels"], entry["stop"], *figures, *after]
