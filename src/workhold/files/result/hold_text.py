"""The text of what friction holds: a line of JSON of a result file, or a row of a spreadsheet, for each fixture.

A fixture without pegs gives what each jaw touches as rectangles in the jaw's plane, the height of the parallels and
the side of the work stop. Figures that follow from these are written, too. :mod:`workhold.files.result.holds` reads
the lines; it is a module of its own because pydantic takes long to import. Of straps
:mod:`workhold.files.result.strapped_text` has the text.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from workhold.files.result.strapped_text import (
    is_strapped,
    make_need_entry,
    strapped_columns,
    strapped_entry,
    strapped_rows,
)
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import HOLD_FIGURES, JawHold, Patch
from workhold.model.result import Result

__all__ = ["hold_columns", "hold_entry", "hold_lines", "hold_rows", "is_hold", "make_need_entry"]

DIGITS = 12


def round_length_for_file(value: float) -> float:
    """Return a length as it is written, to 1e-9 mm."""
    return round(value, 9) + 0.0


def round_figure_for_file(value: Any) -> Any:
    """Return a figure as it is written, to twelve digits; a truth and nothing as they are."""
    if isinstance(value, list):
        return [round_figure_for_file(one) for one in value]
    return value if value is None or isinstance(value, bool) else float(f"{value:.{DIGITS}g}") + 0.0


def hold_entry(fixture: Fixture) -> dict[str, Any]:
    """A fixture that friction holds, as it is written."""
    hold, pose = fixture.hold, fixture.pose
    if not isinstance(hold, JawHold):
        return strapped_entry(fixture)

    def patch_entry(patch: Patch) -> dict[str, Any]:
        rectangles = [[round_length_for_file(end) for end in one] for one in patch.rectangles]
        return {"segments": list(patch.segments), "rectangles": rectangles}

    need = hold.program_need
    of_program = {} if need is None else {"program_force": make_need_entry(need)}
    return {
        "type": fixture.type,
        "parallels": round_length_for_file(hold.parallels),
        "stop": hold.stop,
        "fixed": patch_entry(hold.fixed),
        "moving": patch_entry(hold.moving),
        "pose": {
            "theta_deg": round(pose.theta_deg, 10) % 360.0 + 0.0,
            "x": round_length_for_file(pose.x),
            "y": round_length_for_file(pose.y),
        },
        "jaw_separation": round_length_for_file(hold.opening),
        "warnings": list(hold.warnings),
        "quality": {key: round_figure_for_file(value) for key, value in hold.as_quality().items()},
        **of_program,
    }


def hold_lines(result: Result) -> Iterator[str]:
    """Yield the lines of a result's fixtures."""
    return (json.dumps(hold_entry(fixture)) for fixture in result)


def is_hold(fixture: Any) -> bool:
    """Whether a fixture in a file is one that friction holds."""
    return is_strapped(fixture) or (
        isinstance(fixture, dict) and "moving" in fixture and "pegs" not in fixture
    )


BEFORE_FIGURES = ("number", "type", "theta_deg", "x", "y", "jaw_separation", "parallels", "stop")
AFTER_FIGURES = ("full_contact", "faces_fixed", "faces_moving", "warnings")


def hold_columns(toolkit: Toolkit) -> list[str]:
    """The names of the columns of :func:`hold_rows`, in a toolkit."""
    if toolkit.strap_set is not None:
        return strapped_columns(toolkit.strap_set.count)
    return [*BEFORE_FIGURES, *(figure.key for figure in HOLD_FIGURES), *AFTER_FIGURES]


def hold_rows(result: Result) -> Iterator[list[Any]]:
    """A row for each fixture, best first: lengths in mm, angles in degrees, forces in N; empty where not known."""
    if result.toolkit.strap_set is not None:
        yield from strapped_rows(result, result.toolkit.strap_set.count)
        return
    for number, fixture in enumerate(result, 1):
        entry = hold_entry(fixture)
        pose, quality = entry["pose"], entry["quality"]
        faces = (" ".join(map(str, entry[jaw]["segments"])) for jaw in ("fixed", "moving"))
        figures = [quality.get(figure.key) for figure in HOLD_FIGURES]
        before = [number, entry["type"], pose["theta_deg"], pose["x"], pose["y"], entry["jaw_separation"]]
        after = [quality["full_contact"], *faces, "; ".join(entry["warnings"])]
        yield [*before, entry["parallels"], entry["stop"], *figures, *after]
