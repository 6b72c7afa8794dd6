"""TOML files of toolkits of every kind, nearly right."""

from __future__ import annotations

import random
import tomllib
from importlib.resources import files

from hostile_files import as_toml, upset

__all__ = ["FILES"]

TOOLKITS = [
    tomllib.loads(entry.read_text(encoding="utf-8"))
    for entry in sorted((files("workhold") / "data" / "toolkits").iterdir(), key=lambda entry: entry.name)
]


def make_toolkit(chance: random.Random) -> bytes:
    """One that comes with the program, with some tables of hardware more."""
    content = {key: value for key, value in chance.choice(TOOLKITS).items() if key != "source"}
    if chance.random() < 0.3:
        content["supports"] = {"pad_radius": 4, "height": 20}
        content["top-clamp"] = {"tip_radius": 5, "reach": [[0, 0, 10, 90]]}
    return as_toml(upset(content, chance), chance)


FILES = {"toolkit.toml": make_toolkit}
