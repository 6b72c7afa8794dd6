"""Makes the examples of the page that explains the method: ``python building/lessons.py`` writes them anew.

They are lessons of parts that come with the program, so that the page shows something without a server, in the manual.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import workhold
from workhold.presenting.lesson import compute_lesson

ROOT = Path(__file__).parent.parent
PLACE = ROOT / "src" / "workhold" / "web" / "static" / "method" / "examples.js"
# A bracket, a plate of many sides, one with arcs, and one that is symmetric.
PARTS = (str(ROOT / "examples" / "bracket.dxf"), "8Handle", "widget", "flange")
HEAD = '"use strict";\n/* Lessons of parts that come with the program, written by building/lessons.py. */\n'


def make_examples() -> list[dict[str, Any]]:
    """The lessons of the examples."""
    return [compute_lesson(workhold.load(name)) for name in PARTS]


def write_script(lessons: list[dict[str, Any]]) -> str:
    """The lessons as a script, numbers to 12 digits: more than a picture or a comparison needs."""
    return f"{HEAD}const EXAMPLES = {json.dumps([round_numbers(one) for one in lessons], separators=(',', ':'))};\n"


def round_numbers(value: Any) -> Any:
    """Plain data with its numbers rounded."""
    if isinstance(value, dict):
        return {key: round_numbers(one) for key, one in value.items()}
    if isinstance(value, list):
        return [round_numbers(one) for one in value]
    if isinstance(value, float):
        return int(value) if value == int(value) else float(f"{value:.13g}")
    return value


if __name__ == "__main__":
    PLACE.write_text(write_script(make_examples()), encoding="utf-8")
