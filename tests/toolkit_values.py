"""A value of each field of a toolkit, and the fields of a kind with one."""

from __future__ import annotations

from typing import Any

from workhold.fixels.kinds import find_table

# A value of each field, as the constructor takes it, with the words of its option; no two fields have the same.
VALUES: dict[str, tuple[Any, Any]] = {
    "pitch": ((16.0, 18.0), "16,18"),
    "columns": (3, "3"),
    "peg_radius": (2.5, "2.5"),
    "body_radius": (3.5, "3.5"),
    "flat": ((2.25, 1.0), "2.25,1"),
    "rows": (7, "7"),
    "blocked": (["L-B3", "R-A"], ["L-B3", "R-A"]),
    "min_gap": (13.0, "13"),
    "max_opening": (61.0, "61"),
    "jaw_width": (47.0, "47"),
    "row_offset": (-4.5, "-4.5"),
    "clamps": (2, "2"),
    "clamp_radius": (5.5, "5.5"),
    "travel": ((11.0, 41.0), "11,41"),
    "directions": ([("-x", "-y")], "-x:-y"),
    "wall_offset": (9.5, "9.5"),
    "left_heights": ((0.0, 7.5), "0,7.5"),
    "right_heights": ((2.5, 8.0), "2.5,8"),
    "locator_heights": ((0.0, 6.0), "0,6"),
    "clamp_heights": ((6.0, 14.0), "6,14"),
    "wall_heights": ((0.0, 4.5), "0,4.5"),
    "jaw_heights": ((1.0, 9.0), "1,9"),
    "jaw_height": (48.0, "48"),
    "jaw_thickness": (19.0, "19"),
    "parallels": ((21.0, 26.5), "21,26.5"),
    "least_grip": (4.0, "4"),
    "stop": ("left", "left"),
    "stop_offset": (-1.25, "-1.25"),
    "parallel_thickness": (6.0, "6"),
    "stop_width": (14.0, "14"),
    "max_force": (5200.0, "5200"),
    "screw_lead": (5.0, "5"),
    "straps": (3, "3"),
    "tip_radius": (6.5, "6.5"),
    "reach": ((22.0, 43.0), "22,43"),
    "strap_height": (31.0, "31"),
    "over": ("supports", "supports"),
    "bolt_pitch": ((8.0, 9.0), "8,9"),
    "bolt_offset": ((3.25, 1.75), "3.25,1.75"),
}


def given(kind: str) -> dict[str, Any]:
    """A value for each field of a kind."""
    return {row.name: VALUES[row.name][0] for row in find_table(kind).fields}
