"""Both engines side by side: the paper's algebra and the chord curves, the same lists, and what each takes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from algebra import algebra_result
from designs import ROWS, Design, loaded, timed
from paper.document import Block, Figures, Heading, Inline, Marked, Paragraph, Table
from report import measured

NAME, TITLE = "engines", "Both engines side by side"
SECONDS, QUICK_SECONDS = 240.0, 6.0

QUICK_ROWS = (2, 6)
# Seconds after which a row is given up.
BUDGET = 420.0


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Both engines on the rows of Table 1, the shortest first."""
    chosen = [ROWS[k] for k in QUICK_ROWS] if quick else sorted(ROWS, key=lambda row: row.seconds)
    data["rows"] = []
    whole = sum(row.seconds for row in chosen)
    done = 0
    for row in chosen:
        yield done / whole, " ".join(row.design.words)
        done += row.seconds
        found = row_of(row.design)
        if found is not None:
            data["rows"].append(found)
    ratios = [row["ratio"] for row in data["rows"]]
    data |= {
        "differences": sum(len(row["differences"]) for row in data["rows"]),
        "undecided": sum(row["undecided"] for row in data["rows"]),
        "least_ratio": min(ratios),
        "most_ratio": max(ratios),
        "systems": sum(row["systems"] for row in data["rows"]),
    }


def row_of(design: Design) -> dict[str, Any] | None:
    """One row, or None where the algebra takes too long."""
    arguments = design.part, design.pitch, design.columns, design.peg_radius
    theirs = measured("paper.engines.both", *arguments, limit=BUDGET, OPENBLAS_NUM_THREADS="1")
    if theirs is None:
        return None
    ours = timed(design)
    return theirs | {
        "part": design.part,
        "pitch": design.pitch,
        "columns": design.columns,
        "curves_seconds": ours["processor"],
        "ratio": theirs["processor"] / ours["processor"],
    }


def both(part: str, pitch: float, columns: int, peg_radius: float) -> dict[str, Any]:
    """Task: the algebra's counts and seconds, and every difference from what the chord curves list, in sentences."""
    import workhold
    from workhold.completeness import find_differences
    from workhold.verification.listing import collect_claims

    result, outcome = algebra_result(part, pitch, columns, peg_radius)
    curves = workhold.design(*loaded(part, pitch, columns, peg_radius), threads=1)
    # The accounts of the engines count different things; fixtures are compared one by one.
    told = [
        one
        for one in find_differences(collect_claims(result), curves)
        if not one.startswith(("the proof says", "the statistics says"))
    ]
    return outcome | {
        "I": outcome["found"]["I"],
        "II": outcome["found"]["II"],
        "orientations": result.statistics["orientations"],
        "undecided": result.statistics["undecided"],
        "differences": told,
    }


def render(figures: Figures) -> list[Block]:
    """The table."""
    rows: list[list[Inline]] = []
    for k in figures.every("rows"):
        path = f"rows/{k}"
        rows.append(
            [
                Marked("label", figures.value(f"{path}/part")),
                figures.fixed(f"{path}/pitch", 0),
                figures.count(f"{path}/columns"),
                figures.count(f"{path}/I"),
                figures.count(f"{path}/II"),
                figures.count(f"{path}/systems"),
                figures.fixed(f"{path}/polynomials_processor", 2),
                figures.fixed(f"{path}/processor", 2),
                figures.fixed(f"{path}/curves_seconds", 4),
                figures.fixed(f"{path}/ratio", 0),
            ]
        )
    return [
        Heading(TITLE),
        Paragraph(
            (
                "The paper's way, resultants of quartets of features and holes, is the engine ",
                Marked("code", "algebra"),
                "; the other engine follows chords of two pegs over the orientation and shares no "
                "solver with it. On the rows below "
                "the lists were compared fixture by fixture: ",
                figures.count("differences"),
                " differences, ",
                figures.count("undecided"),
                " systems of ",
                figures.count("systems"),
                " left undecided. On this machine the curves are ",
                figures.significant("least_ratio", 2),
                " to ",
                figures.significant("most_ratio", 2),
                " times faster than the algebra, which is what the method gains; the rest of the ratio in ",
                Marked("label", "Table 1"),
                " lies in machines, programs and drawings.",
            )
        ),
        Table(
            "Table 7",
            "Both engines, seconds of one processor. Systems: polynomials that the algebra solves; "
            "their time alone, resultants and roots "
            "without choosing features and testing poses, stands in the column before its whole time.",
            (
                "workpiece",
                "spacing (mm)",
                "columns",
                "I",
                "II",
                "systems",
                "roots (s)",
                "algebra (s)",
                "curves (s)",
                "ratio",
            ),
            rows,
        ),
    ]
