"""The bench of first choices: for twenty parts what stands first, against the best of each figure, with its picture.

    python benchmarks/first_choice.py            all parts, and docs/first-choice.md with its pictures
    python benchmarks/first_choice.py --only hinge --pictures /tmp
    python benchmarks/first_choice.py --seating 100     the same with seating, and its table on that page

Targets: no warnings wherever a fixture without exists; contacts at least 1 mm from edges wherever one has that; square where
a square fixture is within 25 % of the best location error; a clamp amplification of at most 1.5 where that is attainable
within the same, among square ones where the part is to be square. "The best" is of the fixtures with the fewest warnings.

With --seating K the first choice is that of the first K fixtures ordered by their seating, and a fifth target is that it
catches the part from at least 1 mm of opening where one of the K does that is within 25 % of their best location error.
"""

from __future__ import annotations

import argparse
import sys
from math import inf, isinf
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parent))

import workhold
from shop_parts import PARTS, ShopPart
from workhold.conventions import GENTLE_PEG, NEAR_EDGE
from workhold.drawing.fixture_pictures import draw_fixture
from workhold.drawing.render import render
from workhold.model.quality import (
    CLAMP_AMPLIFICATION,
    CLOSURE_MARGIN,
    EDGE_DISTANCE,
    FIGURES,
    LOCATION_ERROR,
    TILT,
    WARNINGS,
)
from workhold.model.seating import SMALL_CAPTURE
from workhold.presenting.figure_words import find_edgeless_distance

ROOT = Path(__file__).parents[1]
PAGE, PICTURES = ROOT / "docs" / "first-choice.md", ROOT / "docs" / "figures" / "first-choice"
PLACE = "<!-- first choices -->\n", "<!-- end of first choices -->"
SEATED_PLACE = "<!-- with seating -->\n", "<!-- end of with seating -->"
SHOWN = (LOCATION_ERROR, CLAMP_AMPLIFICATION, CLOSURE_MARGIN, EDGE_DISTANCE)
WITHIN = 1.25
TARGETS = ("warnings", "edges", "square", "gentle")


def judged(quality: NDArray[np.float64]) -> dict[str, bool]:
    """Whether the first fixture of a list of figures of quality (N, 12) meets each target."""
    first, fewest = quality[0], quality[:, WARNINGS] == quality[:, WARNINGS].min()
    good = quality[fewest]
    close = good[good[:, LOCATION_ERROR] <= WITHIN * good[:, LOCATION_ERROR].min()]
    square_wanted = bool((close[:, TILT] == 0).any())
    among = close[close[:, TILT] == 0] if square_wanted else close
    gentle_wanted = bool((among[:, CLAMP_AMPLIFICATION] <= GENTLE_PEG).any())
    return {
        "warnings": bool(fewest[0]),
        "edges": bool(first[EDGE_DISTANCE] >= NEAR_EDGE)
        or not bool((quality[:, EDGE_DISTANCE] >= NEAR_EDGE).any()),
        "square": first[TILT] == 0 or not square_wanted,
        "gentle": bool(first[CLAMP_AMPLIFICATION] <= GENTLE_PEG) or not gentle_wanted,
    }


def seated(result: workhold.Result) -> dict[str, Any]:
    """From how far open the first fixture and the best within 25 % catch the part, what wrong seats read otherwise, how many
    there are, and whether that meets the target; nothing without seating."""
    if not result.seating:
        return {}
    error = result.table.quality[: len(result.seating), LOCATION_ERROR]
    caught = np.array([told.figures["capture_opening"] for told in result.seating])
    attainable = float(caught[error <= WITHIN * error.min()].max())
    first = result.seating[0]
    return {
        "caught": float(caught[0]),
        "attainable": attainable,
        "reading": first.figures["reading"],
        "wrong": len(first.list_wrong_seats()),
        "met": bool(caught[0] >= SMALL_CAPTURE) or attainable < SMALL_CAPTURE,
    }


def chosen(part: ShopPart, seating: int | None = None) -> dict[str, Any]:
    """The first choice for a part: its figures, the best of each, what targets it meets, and its picture."""
    result = workhold.design(part.make(), part.vise, restrictions=part.restrictions, seating=seating)
    quality, longest = result.table.quality.copy(), find_edgeless_distance(result.workpiece, part.vise)
    quality[quality[:, EDGE_DISTANCE] >= longest * (1 - 1e-9), EDGE_DISTANCE] = inf
    good = quality[quality[:, WARNINGS] == quality[:, WARNINGS].min()]
    best = {n: float((good[:, n].max if FIGURES[n].more_is_better else good[:, n].min)()) for n in SHOWN}
    first = result[0]
    seating_told = seated(result)
    met = {"caught": seating_told["met"]} if seating_told else {}
    return {
        "seating": seating_told,
        "part": part,
        "count": len(result),
        "first": {n: float(quality[0, n]) for n in (*SHOWN, TILT, WARNINGS)},
        "holes": " ".join(peg.hole for peg in first.pegs),
        "angle": first.pose.theta_deg,
        "best": best,
        "targets": judged(quality) | met,
        "picture": draw_fixture(
            first, result.workpiece, part.vise, title=f"{part.name}: first choice", unit=part.unit
        ),
    }


def value(number: int, found: float, part: ShopPart) -> str:
    """A figure in the part's unit."""
    if isinf(found):
        return "none"
    if FIGURES[number].unit == "mm":
        return part.unit.format_length(found, part.unit.decimals)
    return f"{found:.2f}"


def section(choice: dict[str, Any]) -> str:
    """What the page says of a part."""
    part, first = choice["part"], choice["first"]
    short = [name for name, met in choice["targets"].items() if not met]
    lies = "square" if first[TILT] == 0 else f"tilted by {first[TILT]:.2f}°"
    lines = [
        f"### {part.name}",
        f"{part.words[:1].upper()}{part.words[1:]}. First of {choice['count']:,}: {choice['holes']}, {lies} at "
        f"{choice['angle']:.3f}°, {first[WARNINGS]:.0f} warnings. "
        + (f"**Short of: {', '.join(short)}.**" if short else "All targets met."),
        "",
        "| figure | first choice | best of the list |",
        "|---|---:|---:|",
        *(
            f"| {FIGURES[n].words} | {value(n, first[n], part)} | {value(n, choice['best'][n], part)} |"
            for n in SHOWN
        ),
        "",
        f"![First choice for {part.name}](figures/first-choice/{part.name}.svg)",
    ]
    return "\n".join(lines) + "\n"


def seated_row(choice: dict[str, Any]) -> str:
    """The row of a part in the table of seating."""
    told, unit = choice["seating"], choice["part"].unit

    def length(found: float, endless: str) -> str:
        return endless if np.isinf(found) else f"{unit.format_length(found, unit.decimals)}"

    return (
        f"| {choice['part'].name} | {choice['holes']} | {choice['angle']:.3f}° | {length(told['caught'], 'any')} "
        f"| {length(told['attainable'], 'any')} | {told['wrong']} | {length(told['reading'], 'none')} "
        f"| {'met' if all(choice['targets'].values()) else '**short**'} |"
    )


def seated_table(choices: list[dict[str, Any]], missed: int) -> str:
    """What the page says of first choices with seating."""
    lines = [
        f"{(len(TARGETS) + 1) * len(choices) - missed} of {(len(TARGETS) + 1) * len(choices)} targets are met.",
        "",
        "| part | first choice | angle | caught from | attainable | wrong seats | nearest reads | targets |",
        "|---|---|---:|---:|---:|---:|---:|---|",
        *map(seated_row, choices),
    ]
    return "\n".join(lines) + "\n"


def written(text: str, place: tuple[str, str]) -> None:
    """Put a text into its place on the page."""
    page = PAGE.read_text(encoding="utf-8")
    head, tail = page.partition(place[0])[0], page.partition(place[1])[2]
    PAGE.write_text(head + place[0] + text + place[1] + tail, encoding="utf-8")


def main() -> None:
    """Run the bench."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", action="append", help="a part's name; nothing is written into the docs")
    parser.add_argument("--seating", type=int, help="order the first so many by their seating")
    parser.add_argument("--pictures", type=Path, help="also write pictures as PNG into this folder")
    asked = parser.parse_args()
    choices = list[dict[str, Any]]()
    missed = 0
    for part in PARTS:
        if asked.only and part.name not in asked.only:
            continue
        choice = chosen(part, asked.seating)
        choices.append(choice)
        missed += sum(not met for met in choice["targets"].values())
        sys.stdout.write(section(choice) + (seated_row(choice) + "\n" if asked.seating else "") + "\n")
        sys.stdout.flush()
        if asked.pictures:
            asked.pictures.mkdir(parents=True, exist_ok=True)
            (asked.pictures / f"{part.name}.png").write_bytes(render(choice["picture"], ".png"))
        if not (asked.only or asked.seating):
            PICTURES.mkdir(parents=True, exist_ok=True)
            (PICTURES / f"{part.name}.svg").write_text(choice["picture"], encoding="utf-8")
    targets = len(TARGETS) + (asked.seating is not None)
    targets = (len(TARGETS) + (asked.seating is not None)) * len(choices)
    sys.stdout.write(f"{missed} targets missed of {targets}\n")
    if asked.only:
        return
    if asked.seating:
        written(seated_table(choices, missed), SEATED_PLACE)
    else:
        written(
            f"{targets - missed} of {targets} targets are met.\n\n" + "\n".join(map(section, choices)), PLACE
        )


if __name__ == "__main__":
    main()
