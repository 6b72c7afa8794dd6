"""Table 1: workpieces, counts and times, the paper's beside ours; what it printed told apart from what is ours alone."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from designs import PEG_RADIUS, ROWS, Design, counted, timed
from paper.document import Block, Figures, Heading, Inline, Marked, Paragraph, Table

NAME, TITLE = "table-one", "Counts and times"
SECONDS, QUICK_SECONDS = 45.0, 10.0

QUICK_ROWS = (0, 2, 6)


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Count and time each row, alone in a process, on one thread."""
    chosen = [ROWS[k] for k in QUICK_ROWS] if quick else list(ROWS)
    data |= {"peg_radius": PEG_RADIUS, "rows": [], "undecided": 0}
    for number, row in enumerate(chosen):
        yield number / len(chosen), " ".join(row.design.words)
        data["rows"].append(row_of(row.design) | printed(row))
        data["rows"][-1]["ratio"] = row.seconds / data["rows"][-1]["seconds"]
        data["undecided"] += data["rows"][-1]["undecided"]
    seconds = sum(row["seconds"] for row in data["rows"])
    paper = sum(row["paper"]["seconds"] for row in data["rows"])
    ratios = [row["ratio"] for row in data["rows"]]
    data["together"] = {"seconds": seconds, "paper_seconds": paper, "ratio": paper / seconds}
    data["ratios"] = {"least": min(ratios), "most": max(ratios)}


def row_of(design: Design) -> dict[str, Any]:
    """What is ours of a row."""
    contacts, ours = counted(design), timed(design)
    return {
        "part": design.part,
        "contacts": contacts,
        "I": ours["found"]["I"],
        "II": ours["found"]["II"],
        "seconds": ours["processor"],
        "undecided": ours["undecided"],
        "proof": ours["proof"],
    }


def printed(row: Any) -> dict[str, Any]:
    """What the paper prints of a row."""
    ours = {"pitch": row.design.pitch, "columns": row.design.columns}
    return {"paper": ours | {"I": row.type_one, "II": row.type_two, "seconds": row.seconds}}


def render(figures: Figures) -> list[Block]:
    """Table 1."""
    rows: list[list[Inline]] = [row_cells(figures, f"rows/{k}") for k in figures.every("rows")]
    whole = figures.value("together") is not None
    if whole:
        rows.append(
            [
                "together",
                *[""] * 4,
                figures.count("together/paper_seconds"),
                *[""] * 3,
                figures.fixed("together/seconds", 4),
                figures.fixed("together/ratio", 0),
            ]
        )
    return [
        Heading(TITLE),
        Paragraph(
            (
                "The paper prints of each workpiece its name, of each vise the spacing of the holes and "
                "the number of columns, "
                "and no unit. It prints neither a dimension of a workpiece nor the radius of a peg. "
                "Ours are models drawn after "
                "the names and the figures; spacings are read as millimetres and pegs have a radius of ",
                figures.fixed("peg_radius", 0),
                " mm throughout. So counts can be of the same order and no more, and the ratio of times "
                "compares two machines, "
                "two programs and two sets of drawings at once. The left half of ",
                Marked("label", "Table 1"),
                " is the paper's, as printed; the right half is ours. The sizes of our models are in ",
                Marked("label", "Table 5"),
                ".",
            )
        ),
        Table(
            "Table 1",
            (
                "Fixtures of Types I and II. A counts simultaneous contacts, before force closure is "
                "asked for. Our times are seconds "
                "of one processor for a complete and proven search, the least of up to five runs; ",
                figures.count("undecided"),
                " candidates are left undecided.",
            ),
            (
                "workpiece",
                "spacing",
                "columns",
                "I",
                "II",
                "time (s)",
                "A",
                "I",
                "II",
                "time (s)",
                "times faster",
            ),
            rows,
            bold_last=whole,
            groups=(("", 1), ("printed in the paper", 5), ("ours", 5)),
        ),
        *([verdict(figures)] if whole else []),
    ]


def row_cells(figures: Figures, path: str) -> list[Inline]:
    """A row of Table 1."""
    return [
        Marked("label", figures.value(f"{path}/part")),
        figures.fixed(f"{path}/paper/pitch", 0),
        figures.count(f"{path}/paper/columns"),
        figures.count(f"{path}/paper/I"),
        figures.count(f"{path}/paper/II"),
        figures.count(f"{path}/paper/seconds"),
        figures.count(f"{path}/contacts"),
        figures.count(f"{path}/I"),
        figures.count(f"{path}/II"),
        figures.fixed(f"{path}/seconds", 4),
        figures.fixed(f"{path}/ratio", 0),
    ]


def verdict(figures: Figures) -> Paragraph:
    """What the table says."""
    return Paragraph(
        (
            "The paper's rows took ",
            figures.count("together/paper_seconds"),
            " s together on its machine and take ",
            figures.fixed("together/seconds", 3),
            " s here; row by row the ratio lies between ",
            figures.significant("ratios/least", 2),
            " and ",
            figures.significant("ratios/most", 2),
            ".",
        )
    )
