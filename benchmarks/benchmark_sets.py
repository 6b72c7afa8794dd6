"""The sets of the benchmark: which workpiece is held in which toolkit, and why these.

Every workpiece is held in a vise, and in some of the other kinds in turn, so that each kind meets each family. Pitches are
chosen by the size of the part, so that most lists have some hundreds to some thousands of fixtures.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot
from typing import Any

import numpy as np
from attrs import field, frozen

from benchmark_parts import BenchmarkPart

__all__ = ["AskedSet", "asked_sets"]

Fields = dict[str, Any]
# mm; holes are sold and drilled in these distances.
PITCHES = (4.0, 5.0, 8.0, 10.0, 12.5, 16.0, 20.0, 25.0, 32.0, 40.0, 50.0, 80.0)
# Pitches that go into the part's extent.
FEW, SEVERAL = 2.6, 4.0
PEG = 3.0


@frozen
class AskedSet:
    """A set: its name, the workpiece, the toolkit's kind and fields, what else is asked, and the reason."""

    name: str
    part: str
    toolkit: Fields
    reason: str
    options: Fields = field(factory=dict)


def extent(part: BenchmarkPart) -> float:
    """The diagonal of a part's outer loop in mm, by its vertices."""
    points = part.workpiece.loops[0][:, :2]
    return float(hypot(*np.ptp(points, axis=0)))


def pitch_for(part: BenchmarkPart, times: float) -> float:
    """The pitch that goes about so many times into a part's extent over the square root of two."""
    wanted = extent(part) / 1.414 / times
    return min(PITCHES, key=lambda pitch: abs(pitch - wanted))


def holes(pitch: float) -> Fields:
    """Pitch and a peg radius that fits between the holes."""
    return {"pitch": [pitch, pitch], "peg_radius": min(PEG, 0.3 * pitch)}


def vise(pitch: float) -> Fields:
    """A vise with two columns on each jaw."""
    return {"kind": "vise", **holes(pitch), "columns": 2}


def opening(pitch: float) -> Fields:
    """A vise that clamps as it opens, all of whose pegs may stand in one hole of the part."""
    gap = 2 * holes(pitch)["peg_radius"]
    return {"kind": "opening-vise", **holes(pitch), "columns": 2, "min_gap": gap}


def plate(pitch: float) -> Fields:
    """A plate of 5 by 5 holes with a clamp that is its tip alone."""
    return {"kind": "translating-clamp", **holes(pitch), "columns": 5, "rows": 5}


def bolted(pitch: float) -> Fields:
    """A plate with a clamp that is bolted in a hole behind its tip, along rows or columns."""
    travel = [0.5 * pitch, 1.5 * pitch]
    return {"kind": "translating-clamp", **holes(pitch), "columns": 6, "rows": 5, "travel": travel}


def pair(pitch: float) -> Fields:
    """A plate of 4 by 4 holes with two clamps that are needed together."""
    return {"kind": "translating-clamp", **holes(pitch), "columns": 4, "rows": 4, "clamps": 2}


def fence(pitch: float) -> Fields:
    """A fence with a stop and a clamp."""
    return {"kind": "edge", **holes(pitch), "wall_offset": 0.5 * pitch, "columns": 5, "rows": 5}


def fence_pair(pitch: float) -> Fields:
    """A fence with a stop and two clamps."""
    return {**fence(pitch), "rows": 4, "clamps": 2}


def flat(pitch: float) -> Fields:
    """A flat jaw against a plate of pegs."""
    return {"kind": "flat-jaw", **holes(pitch), "columns": 5, "rows": 5}


# By the end of a set's name: the toolkit, how often its pitch goes into the part, and what it is.
KINDS = {
    "vise": (vise, SEVERAL, "two columns on each jaw"),
    "plate": (plate, FEW, "three locators and a clamp's tip"),
    "fence": (fence, SEVERAL, "a fence, a stop and a clamp"),
    "pair": (pair, FEW, "three locators and two clamps"),
    "flat": (flat, SEVERAL, "a flat jaw and two pegs"),
    "bolted": (bolted, FEW, "a clamp with its body and stroke"),
    "fence-pair": (fence_pair, FEW, "a fence, a stop and two clamps"),
    "opening": (opening, SEVERAL, "pegs that press outwards"),
}
TURNS = ("plate", "fence", "pair", "flat", "bolted", "fence-pair")
# Parts that pegs can hold from within, in a hole or a notch, beside those of which every kind is asked.
FROM_WITHIN = (
    "window",
    "frame",
    "two-bores",
    "u",
    "saddle",
    "tee-plate",
    "spikes",
    "nema-23",
    "cover",
    "clevis",
)
EVERY_KIND = "none in some kinds"
# The rows of Table 1 of the paper, with pegs of 3 mm: part, pitch, columns.
TABLE_ONE = (
    ("thin4Handle", 10, 1),
    ("8Handle", 10, 1),
    ("small4Handle", 10, 1),
    ("small4Handle", 10, 10),
    ("large4Handle", 10, 1),
    ("large4Handle", 10, 10),
    ("oblongPart", 10, 1),
    ("oblongPart", 10, 10),
    ("oblongPart", 8, 10),
    ("widget", 10, 1),
    ("widget", 8, 1),
    ("flange", 10, 1),
)
LARGE = (
    ("nema-34", "plate", plate(20.0), "a large list: 12,000 fixtures with one clamp"),
    ("v-slot", "pair", pair(5.0), "a large list: 18,000 pairs of clamps"),
)
# What single fields do: rows and openings that end, jaws off by half a row, a lattice that is not square, tips of another
# size, holes where no peg can stand, points for pegs.
FIELDS = (
    ("widget", "rows", {**vise(12.5), "rows": 5, "max_opening": 45.0}, "rows and the opening end"),
    ("widget", "offset", {**vise(12.5), "row_offset": 6.25}, "the jaws' rows half a pitch apart"),
    ("kite", "oblong-pitch", {**vise(16.0), "pitch": [16.0, 10.0]}, "a lattice that is not square"),
    ("house", "points", {**vise(16.0), "peg_radius": 0.0}, "points instead of pegs"),
    ("saddle", "gap", {**vise(12.5), "columns": 1, "min_gap": 30.0}, "jaws that cannot close far"),
    ("kite", "small-tip", {**plate(16.0), "clamp_radius": 1.5}, "a tip smaller than the locators"),
    ("house", "wide-tip", {**plate(16.0), "clamp_radius": 5.0}, "a tip larger than the locators"),
    ("el", "both-ways", {**plate(16.0), "directions": ["-x", "+x", "-y", "+y"]}, "directions that turns make equal"),
    ("kite", "oblong-plate", {**plate(16.0), "pitch": [16.0, 12.5]}, "a plate that is not square"),
    ("el", "unlimited", {**plate(25.0), "columns": None, "rows": None}, "a plate without end"),
    ("bar", "six-pairs", {**pair(20.0), "directions": ["-x", "+x", "-y", "+y"]}, "all pairs of directions"),
    ("saddle", "near-fence", {**fence(12.5), "wall_offset": 3.0}, "a row that touches the fence"),
    ("kite", "fence-travel", {**fence(12.5), "travel": [6.0, 20.0]}, "a fence's clamp with its stroke"),
    ("house", "flat-opening", {**flat(12.5), "max_opening": 40.0, "min_gap": 6.0}, "a flat jaw's opening ends"),
)  # fmt: skip


def asked_sets(parts: list[BenchmarkPart]) -> Iterator[AskedSet]:
    """All sets, part by part, then those of the paper, the large ones, and those that show what single fields do."""
    for place, part in enumerate(parts):
        name = part.workpiece.name
        if part.family == EVERY_KIND:
            kinds = tuple(KINDS)
        else:
            kinds = ("vise", TURNS[place % 6], TURNS[(place + 3) % 6], *["opening"] * (name in FROM_WITHIN))
        for kind in kinds:
            make, times, words = KINDS[kind]
            pitch = 20.0 if name == "crumb" else pitch_for(part, times)
            yield AskedSet(f"{name}-{kind}", name, make(pitch), f"{part.family}: {words}", listing(kind))
    for name, pitch, columns in TABLE_ONE:
        fields = {"kind": "vise", "pitch": [float(pitch)] * 2, "peg_radius": PEG, "columns": columns}
        yield AskedSet(f"{name}-row-{pitch}-{columns}", name, fields, "a row of Table 1 of the paper")
    for name, kind, fields, words in LARGE:
        yield AskedSet(f"{name}-large", name, fields, words, listing(kind))
    for name, what, fields, words in FIELDS:
        yield AskedSet(f"{name}-{what}", name, fields, f"single fields: {words}", listing(what))


def listing(kind: str) -> Fields:
    """Every pair of clamps is listed where there are two."""
    return {"listing": "all"} if "pair" in kind else {}
