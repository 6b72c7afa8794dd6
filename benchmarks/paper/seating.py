"""Seating: whether the part ends up in its place as the vise closes, of the best fixtures of each workpiece."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, isfinite
from time import process_time
from typing import Any

import numpy as np

from designs import loaded
from paper.document import Block, Figures, Heading, Inline, Marked, Paragraph, Picture, Table
from report import measured

NAME, TITLE = "seating", "Does the part end up there?"
SECONDS, QUICK_SECONDS = 60.0, 6.0

# Workpiece, pitch, columns, peg radius.
CASES = (
    ("thin4Handle", 10.0, 1, 3.0),
    ("8Handle", 10.0, 1, 3.0),
    ("small4Handle", 10.0, 1, 3.0),
    ("large4Handle", 10.0, 1, 3.0),
    ("oblongPart", 10.0, 1, 3.0),
    ("widget", 10.0, 1, 3.0),
    ("flange", 10.0, 1, 3.0),
)
MANY, QUICK_MANY = 50, 5
# Seats drawn.
DRAWN = 8
# mm. Jaws are opened by hand to about so much.
BY_HAND = 1.0


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """The seats of the best fixtures of each workpiece."""
    cases = CASES[4:5] if quick else CASES
    data |= {"rows": [], "pictures": [], "many": QUICK_MANY if quick else MANY, "by_hand": BY_HAND}
    for number, case in enumerate(cases):
        yield number / len(cases), case[0]
        outcome = measured("paper.seating.seats", *case, data["many"])
        data["pictures"].append({"part": case[0], "svg": outcome.pop("svg")})
        data["rows"].append({"part": case[0], "pitch": case[1], "columns": case[2], **outcome})
    # One is enough to see what a seat is.
    data["pictures"] = sorted(data["pictures"], key=lambda one: one["part"] != "widget")[:1]


def seats(part: str, pitch: float, columns: int, peg_radius: float, many: int) -> dict[str, Any]:
    """Task: figures of the seats of the best fixtures, and a picture of those of the first."""
    import workhold
    from workhold.drawing.seats import draw_seats
    from workhold.seating.solver import SeatingSolver

    workpiece, vise = loaded(part, pitch, columns, peg_radius)
    result = workhold.design(workpiece, vise, best=many)
    fixtures = list(result)
    SeatingSolver(workpiece, vise).solve(fixtures[0])
    solver = SeatingSolver(workpiece, vise)
    start = process_time()
    told = solver.solve_all(fixtures, False, 1)
    spent = process_time() - start
    openings = [inf if one.capture_opening is None else one.capture_opening for one in told]
    wrong = [len(one.list_wrong_seats()) for one in told]
    middle = float(np.median(openings))
    return {
        "fixtures": len(told),
        "patterns": len(solver.solved),
        "seats": sum(len(one.seats) for one in told) / len(told),
        "capture_least": finite(min(openings)),
        "capture_median": finite(middle),
        "capture_most": finite(max(openings)),
        "caught_share": sum(one >= BY_HAND for one in openings) / len(told),
        "alone_share": sum(count == 0 for count in wrong) / len(told),
        "read_share": sum(one.is_foolproof for one in told) / len(told),
        "unsettled": sum(len(one.unsettled) for one in told),
        "ms": 1e3 * spent / len(solver.solved),
        "svg": draw_seats(nearest(told[0].seats), fixtures[0], workpiece, vise, title="fixture 1"),
    }


def nearest(every: Any) -> list[Any]:
    """The right seat, then those whose openings are nearest to its own."""
    return sorted(every, key=lambda seat: (not seat.is_own, abs(seat.difference)))[:DRAWN]


def finite(value: float) -> float | None:
    """A length, or None where there is no end."""
    return value if isfinite(value) else None


def render(figures: Figures) -> list[Block]:
    """The table and one picture."""
    rows: list[list[Inline]] = [
        [
            Marked("label", figures.value(f"rows/{k}/part")),
            *(figures.count(f"rows/{k}/{name}") for name in ("fixtures", "patterns")),
            figures.fixed(f"rows/{k}/seats", 1),
            *(figures.fixed(f"rows/{k}/capture_{name}", 2) for name in ("least", "median", "most")),
            *(figures.percent(f"rows/{k}/{name}_share") for name in ("caught", "alone", "read")),
            figures.fixed(f"rows/{k}/ms", 1),
        ]
        for k in figures.every("rows")
    ]
    blocks: list[Block] = [
        Heading(TITLE),
        Paragraph(
            (
                "The paper says that closing the vise squeezes the workpiece into place. Whether it "
                "does depends on where else closing "
                "can come to rest, and from how wide open the part is still caught. For the best ",
                figures.count("many"),
                " fixtures of each workpiece, in one column, all seats were "
                "computed: the frictionless rests "
                "of the part on these pegs, either side up. Caught: the share that is caught with the "
                "jaws open by ",
                figures.fixed("by_hand", 0),
                " mm. No other: the share with no wrong seat at all. Shown "
                "by a caliper: the share "
                "whose wrong seats differ from the right one in the opening by what a caliper reads.",
            )
        ),
        Table(
            "Table 10",
            "Seats of the best fixtures. Capture opening: by less than this the jaws may stand open "
            "when the part is let go; a dash "
            "means that it has no end. The last column is what a pattern of pegs takes.",
            (
                "workpiece",
                "fixtures",
                "patterns",
                "seats each",
                "least",
                "median",
                "most",
                "caught",
                "no other",
                "by caliper",
                "time (ms)",
            ),
            rows,
            groups=(("", 4), ("capture opening (mm)", 3), ("share of fixtures", 3), ("", 1)),
        ),
    ]
    for picture in figures.value("pictures") or []:
        blocks.append(
            Picture(
                "Figure 5",
                "Seats of the first fixture: the right one first, then those whose openings are nearest to its own.",
                ((picture["svg"], f"{picture['part']}, first fixture"),),
                across=1,
            )
        )
    return blocks
