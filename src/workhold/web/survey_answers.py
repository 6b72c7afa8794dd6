"""Descriptions of a file with a part for the page: what it holds and leaves open."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from attrs import asdict

from workhold.web.answers import place_in

if TYPE_CHECKING:
    from workhold.files.outline.chain import Chain
    from workhold.files.part.survey import Survey

__all__ = ["solids_in", "survey_answer"]

# Segments of a drawing or a layer, parts, gaps and layers of a file that are sent to be shown.
MOST_STROKES, MOST_PARTS, MOST_GAPS, MOST_LAYERS = 20_000, 200, 500, 60
# A solid in a remark, as ``files.step.solids.Solid`` writes it.
SOLID = re.compile(r"solid (\d+) is ([\d.e+-]+) x ([\d.e+-]+) x ([\d.e+-]+) mm ")


def solids_in(remarks: Iterable[str]) -> list[dict[str, Any]]:
    """Finds the solids that a remark on several lists, with their sizes in mm.

    >>> solids_in(["The file holds 2 solids: solid 1 is 9 x 8 x 7.5 mm at (0, 0, 0); solid 2 is ..."])
    [{'number': 1, 'size': [9.0, 8.0, 7.5]}]
    """
    found = (match for remark in remarks for match in SOLID.finditer(remark))
    return [{"number": int(one[1]), "size": [float(one[k]) for k in (2, 3, 4)]} for one in found]


def strokes_answer(chains: Iterable[Chain]) -> list[list[list[float]]]:
    """Describes chains as lists of x, y in mm and bulge, as many as are shown."""
    strokes, room = [], MOST_STROKES
    for chain in chains:
        room -= len(chain.bulges)
        if room < 0:
            break
        strokes.append(
            [[*point, bulge] for point, bulge in zip(chain.points, (*chain.bulges, 0.0), strict=True)]
        )
    return strokes


def survey_answer(seen: Survey, part: dict[str, Any] | None, refusal: str) -> dict[str, Any]:
    """Describes what a file holds and leaves open; strokes and outlines are chains of x, y in mm, bulge.

    ``heights`` is what other heights of the pegs offer of a solid, and ``solids`` are those of a file with
    several.
    """
    return {
        "part": part,
        "error": refusal or None,
        "place": place_in(refusal) if refusal else None,
        "asked": list(seen.asked),
        "size": None if seen.size is None else list(seen.size),
        "strokes": strokes_answer(seen.chains),
        "layers": [
            {"name": one.name, "hidden": one.hidden, "strokes": strokes_answer(one.chains)}
            for one in seen.layers[:MOST_LAYERS]
        ],
        "parts": [
            {
                "number": one.number,
                "loops": [loop.vertices.tolist() for loop in one.loops],
                "bounds": list(one.bounds),
                "holes": len(one.loops) - 1,
            }
            for one in seen.parts[:MOST_PARTS]
        ],
        "gaps": list(seen.gaps[:MOST_GAPS]),
        "heights": [] if seen.loaded is None else [asdict(row) for row in seen.loaded.heights],
        "solids": [] if seen.loaded is None else solids_in(seen.loaded.remarks),
    }
