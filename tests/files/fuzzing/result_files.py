"""Result files of several toolkits with seating, a program and loads, supports, and lists of fixtures, nearly right."""

from __future__ import annotations

import json
import random
from copy import deepcopy
from pathlib import Path
from typing import Any

from hostile_files import as_json, upset

__all__ = ["FILES"]

DATA = Path(__file__).parents[2] / "data" / "hostile"
NAMES = ("result_seating", "result_clamp", "result_fence", "result_program", "longname")
RESULTS = [json.loads((DATA / f"{name}.json").read_text(encoding="utf-8")) for name in NAMES]
SUPPORTS = json.loads((DATA / "supports.json").read_text(encoding="utf-8"))


def in_lines(content: Any) -> bytes:
    """The layout of the program's own files: a fixture on every line."""
    if not isinstance(content, dict) or not isinstance(content.get("fixtures"), list):
        return json.dumps(content).encode("utf-8", errors="replace")
    head = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in content.items() if key != "fixtures"]
    lines = ",\n".join(map(json.dumps, content["fixtures"]))
    text = "{" + ",\n".join(head) + ',\n"fixtures": [\n' + lines + "\n]}\n"
    return text.encode("utf-8", errors="replace")


def make_lines(chance: random.Random) -> bytes:
    """A result with a fixture on every line, now and then with a line cut short or doubled."""
    content = in_lines(upset(deepcopy(chance.choice(RESULTS)), chance))
    lines = content.split(b"\n")
    at = chance.randrange(len(lines))
    match chance.randrange(20):
        case 0:
            lines[at] = lines[at][: len(lines[at]) // 2]
        case 1:
            lines.insert(at, lines[at])
        case 2:
            del lines[at]
        case 3:
            lines[at] += b"\xff" if chance.random() < 0.5 else b"\r"
    return b"\n".join(lines)


def make_whole(chance: random.Random) -> bytes:
    """A result of another layout."""
    return as_json(upset(deepcopy(chance.choice(RESULTS)), chance), chance)


def make_supports(chance: random.Random) -> bytes:
    """A file of supports."""
    return as_json(upset(deepcopy(SUPPORTS), chance), chance)


def make_list(chance: random.Random) -> bytes:
    """Another program's list of fixtures."""
    fixtures = [
        {
            "pegs": [
                {"role": role, "x": x, "y": y}
                for role, x, y in (("left", 0, 0), ("left", 0, 25), ("right", 51.2, 0), ("right", 51.2, 25))
            ],
            "pose": {"theta_deg": 93.01, "x": 40.1, "y": 2.6},
        }
    ]
    return as_json(upset({"set": "bar-plate", "fixtures": fixtures}, chance), chance)


FILES = {
    "lines.json": make_lines,
    "whole.json": make_whole,
    "supports.json": make_supports,
    "list.json": make_list,
}
