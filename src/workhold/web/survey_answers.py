"""Descriptions of a file with a part for the page: what it holds and leaves open."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from attrs import asdict

from workhold.web.answers import place_in

if TYPE_CHECKING:
    from workhold.files.outline.chain import Chain
    from workhold.files.part.survey import Survey

__all__ = ["survey_answer"]

# Segments of a drawing or a layer, parts, gaps and layers of a file that are sent to be shown.
MOST_STROKES, MOST_PARTS, MOST_GAPS, MOST_LAYERS = 20_000, 200, 500, 60
# Solids of a file that are sent to be shown.
MOST_SOLIDS = 200


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

    ``heights`` is what other heights of the pegs offer of a solid, and ``solids`` are those of the file with
    their names.
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
        "solids": [asdict(solid) for solid in seen.solids[:MOST_SOLIDS]],
    }
