"""What became of every candidate of Table 1, and what an independent verification in ball arithmetic says of the lists."""

from __future__ import annotations

from collections.abc import Iterator
from time import perf_counter
from typing import Any

from designs import ROWS, Design, loaded
from paper.document import Block, Figures, Heading, Inline, Marked, Paragraph, Table
from report import measured

NAME, TITLE = "proofs", "Proof statistics"
SECONDS, QUICK_SECONDS = 170.0, 6.0

QUICK_ROWS = (2, 6)
COUNTED = ("cells", "candidates", "discarded_by_bound", "escalated", "verified", "undecided")


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Search and verify each row."""
    chosen = [ROWS[k] for k in QUICK_ROWS] if quick else list(ROWS)
    whole = sum(row.seconds for row in chosen)
    data["rows"], done = [], 0
    for row in chosen:
        yield done / whole, " ".join(row.design.words)
        done += row.seconds
        data["rows"].append(row_of(row.design))
    names = (*COUNTED, "fixtures", "proven", "refuted", "faults", "verify_seconds")
    data["together"] = {name: sum(row[name] for row in data["rows"]) for name in names}
    data["together"]["ms"] = 1e3 * data["together"]["verify_seconds"] / max(data["together"]["fixtures"], 1)
    data["together"]["discarded_share"] = (
        data["together"]["discarded_by_bound"] / data["together"]["candidates"]
    )
    data["most_bits"] = max(row["bits"] for row in data["rows"])


def row_of(design: Design) -> dict[str, Any]:
    """One row."""
    outcome = measured("paper.proofs.verified", design.part, design.pitch, design.columns, design.peg_radius)
    return {"part": design.part, "pitch": design.pitch, "columns": design.columns, **outcome}


def verified(part: str, pitch: float, columns: int, peg_radius: float) -> dict[str, Any]:
    """Task: the account of a search, and its verification."""
    import workhold

    result = workhold.design(*loaded(part, pitch, columns, peg_radius), threads=1)
    proof = result.proof
    assert proof is not None
    start = perf_counter()
    outcome = workhold.verify(result)
    counts = {name: getattr(proof, name) for name in COUNTED if name != "undecided"}
    return counts | {
        "verify_seconds": perf_counter() - start,
        "undecided": len(proof.undecided),
        "fixtures": outcome.fixtures,
        "proven": outcome.proven,
        "refuted": outcome.refuted,
        "faults": len(outcome.faults),
        "bits": outcome.bits,
    }


def render(figures: Figures) -> list[Block]:
    """The table."""
    names = (*COUNTED, "fixtures", "proven")
    rows: list[list[Inline]] = [
        [
            Marked("label", figures.value(f"rows/{k}/part")),
            figures.fixed(f"rows/{k}/pitch", 0),
            figures.count(f"rows/{k}/columns"),
            *(figures.count(f"rows/{k}/{name}") for name in names),
            figures.fixed(f"rows/{k}/verify_seconds", 2),
        ]
        for k in figures.every("rows")
    ]
    whole = figures.value("together") is not None
    if whole:
        last = [figures.count(f"together/{name}") for name in names]
        rows.append(["together", "", "", *last, figures.fixed("together/verify_seconds", 2)])
    words = Paragraph(
        (
            "A candidate is a set of four contacts that the search could not rule out by a bound on "
            "whole ranges of orientation. "
            "Of all candidates ",
            figures.percent("together/discarded_share"),
            " break a rule wherever rounding may have put them; the others are proven by a certificate ",
            Marked("reference", "[8]"),
            " that exactly one solution lies near, or named as "
            "undecided. A fixture found from "
            "both faces of a joint, or either way round, counts twice among the proven candidates and "
            "once among the fixtures. "
            "The verification derives each listed fixture again in ball arithmetic ",
            Marked("reference", "[7]"),
            " of ",
            figures.count("most_bits"),
            " bits at most, from the drawing alone, in ",
            figures.significant("together/ms", 2),
            " ms on average; it refutes ",
            figures.count("together/refuted"),
            " and finds ",
            figures.count("together/faults"),
            " faults in the lists.",
        )
    )
    return [
        Heading(TITLE),
        words,
        Table(
            "Table 8",
            "The account of each proven search, and its verification by a program that shares no solver "
            "with it.",
            (
                "workpiece",
                "spacing (mm)",
                "columns",
                "cells",
                "candidates",
                "discarded",
                "escalated",
                "proven",
                "undecided",
                "fixtures",
                "verified",
                "time (s)",
            ),
            rows,
            bold_last=whole,
            groups=(("", 3), ("the search", 6), ("the verification", 3)),
        ),
    ]
