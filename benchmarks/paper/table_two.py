"""Table 2: the degrees as printed, of the paper's own elimination done exactly, and the true numbers of roots."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from paper.document import Block, Figures, Heading, Inline, Marked, Paragraph, Table
from paper.elimination import CASES, factors, random_system
from workhold.algebra.table_two import tabulate_root_counts

NAME, TITLE = "table-two", "Degrees of the resultants"
SECONDS, QUICK_SECONDS = 15.0, 4.0

SYSTEMS, QUICK_SYSTEMS = 100, 10
# Small whole numbers may be special by accident, so that a factor splits; these are not.
SEEDS = (1, 2, 3)
# Rows of Table 2 as printed: type, left lines and arcs, right lines and arcs, degree.
PRINTED = (
    ("I", 2, 0, 2, 0, 4), ("I", 1, 1, 2, 0, 12), ("I", 0, 2, 2, 0, 12), ("I", 1, 1, 1, 1, 24), ("I", 1, 1, 0, 2, 24),
    ("I", 0, 2, 0, 2, 24), ("II", 3, 0, 1, 0, 2), ("II", 3, 0, 0, 1, 2), ("II", 2, 1, 1, 0, 4), ("II", 2, 1, 0, 1, 4),
    ("II", 1, 2, 1, 0, 6), ("II", 1, 2, 0, 1, 6), ("II", 0, 3, 1, 0, 8), ("II", 0, 3, 0, 1, 8),
)  # fmt: skip


def case_of(kind: str, left: int, right: int) -> tuple[int, int]:
    """The system of a row: the jaw with more arcs is called the left one; of Type II the right peg takes no part."""
    return (left, -1) if kind == "II" else (max(left, right), min(left, right))


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Eliminate exactly in three systems for each case, then isolate all complex roots of random ones."""
    yield 0.0, "exact elimination"
    exact: dict[tuple[int, int], list[dict[str, Any]]] = {}
    data |= {"systems": [], "rows": []}
    for case in CASES:
        exact[case] = []
        for seed in SEEDS:
            system = random_system(case, seed)
            exact[case].append({"system": system, **factors(system)})
        data["systems"] += exact[case]
    yield 0.2, "all complex roots"
    counted = {
        (row.left, -1 if row.type == "II" else row.right): row
        for row in tabulate_root_counts(count=QUICK_SYSTEMS if quick else SYSTEMS)
    }
    for kind, *contacts, degree in PRINTED:
        case = case_of(kind, contacts[1], contacts[3])
        data["rows"].append(row_of(case, exact[case], counted[case]) | {
            "type": kind, "left_lines": contacts[0], "left_arcs": contacts[1],
            "right_lines": contacts[2], "right_arcs": contacts[3], "printed": degree,
        })  # fmt: skip
    data["disagreeing"] = sum(row["printed"] != row["poses"] for row in data["rows"])
    data["all_agree"] = all(row["agrees"] for row in data["rows"])
    data["most"] = {"I": most(data["rows"], "I"), "II": most(data["rows"], "II")}


def most(rows: list[dict[str, Any]], kind: str) -> int:
    """The largest number of poses of a type."""
    return max(row["poses"] for row in rows if row["type"] == kind)


def row_of(case: tuple[int, int], exact: list[dict[str, Any]], counted: Any) -> dict[str, Any]:
    """What was found of a case."""
    holding = [[f for f in one["factors"] if f["holds_poses"]] for one in exact]
    degrees = {sum(f["degree"] * f["power"] for f in several) for several in holding}
    poses = max(degrees)
    return {
        "eliminated": max(one["degree"] for one in exact),
        "poses": poses,
        "factors": max(map(len, holding)),
        "systems": counted.systems,
        "roots": counted.roots,
        "real": counted.real,
        "real_poses": counted.poses,
        # One factor in each system, of one degree, that of the numerical count, and a pose for each real root.
        "agrees": degrees == {counted.ours}
        and all(len(several) == 1 and several[0]["power"] == 1 for several in holding)
        and counted.roots == counted.systems * poses
        and counted.real == counted.poses,
    }


def render(figures: Figures) -> list[Block]:
    """Table 2."""
    rows: list[list[Inline]] = []
    for k in figures.every("rows"):
        path = f"rows/{k}"
        rows.append(
            [figures.value(f"{path}/type")]
            + [figures.count(f"{path}/{n}") for n in ("left_lines", "left_arcs", "right_lines", "right_arcs")]
            + [
                figures.count(f"{path}/{n}")
                for n in ("printed", "eliminated", "poses", "systems", "roots", "real", "real_poses")
            ]
        )
    agree = (
        "In every system exactly one factor holds poses, it cannot be split over the rationals, and its "
        "degree is the number of "
        "isolated roots: so the counts in the column of poses are not bounds but the numbers themselves."
        if figures.value("all_agree")
        else "The exact and the numerical counts differ somewhere: see the data file."
    )
    return [
        Heading(TITLE),
        Paragraph(
            (
                "For each row equations ", Marked("reference", "(1) to (5)"), " of the paper were "
                "eliminated exactly, in systems of small whole numbers, and "
                "the resultant in t was factored over the rationals. A factor counts as holding no pose "
                "when it divides what "
                "the substitution itself makes vanish, ", Marked("formula", "1 + t²"), " or what is "
                "left of a contact where ",
                Marked("formula", "u² = −1"), ". ",
                agree,
                " They are those that the shape of the equations allows ",
                Marked("reference", "[6]"),
                ". Of the printed rows ",
                figures.count("disagreeing"),
                " give a degree above that number; the largest true ones are ",
                figures.count("most/I"),
                " for Type I and ",
                figures.count("most/II"),
                " for Type II. The systems, their factors and their coefficients are in ",
                Marked("code", "witnesses/degrees.json"),
                "; ",
                Marked("code", "python benchmarks/paper/elimination.py paper/witnesses/degrees.json"),
                " derives them again, with nothing of workhold.",
            )
        ),
        Table(
            "Table 2",
            (
                "Printed: the paper's δ. Whole: the resultant of the paper's equations. Poses: the "
                "degree of "
                "its one factor that holds poses, which is the number of complex poses of a general "
                "system. The last four columns "
                "count all complex roots of random systems, isolated in ball arithmetic, the real ones "
                "among them, and the poses "
                "that these lead to."
            ),
            ("type", "lines", "arcs", "lines", "arcs", "printed", "whole", "poses", "systems", "roots",
                "real", "their poses"),
            rows, groups=(("", 1), ("left jaw", 2), ("right jaw", 2), ("degree in t", 3), ("roots of "
            "random systems", 4)),
        ),
    ]  # fmt: skip


def files(figures: Figures) -> dict[str, str]:
    """The systems, as a witness by the name of its file."""
    return {"degrees.json": json.dumps({"systems": figures.value("systems") or []}, indent=1) + "\n"}
