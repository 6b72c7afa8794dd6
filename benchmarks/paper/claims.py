"""Printed claims that do not hold as they stand: the sentence, what holds instead, a witness, and how to check it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import workhold
from paper import witnesses as made
from paper.claim_words import claims
from paper.document import (
    Block,
    Figures,
    Heading,
    Inline,
    Line,
    Listing,
    Marked,
    Paragraph,
    Picture,
    Table,
    line_of,
)
from paper.elimination import divisible, factors, random_system

NAME, TITLE = "claims", "Claims that do not hold as printed"
SECONDS, QUICK_SECONDS = 150.0, 20.0

TRIANGLE = [[0, 0, 0], [70, 0, 0], [25, 55, 0]]
CLAMP_PITCH, CLAMP_GAP = 20.0, 6.0
# Workpiece, pitch and columns of which roots are sought in doubles, and of which orientations are sampled.
DOUBLES, QUICK_DOUBLES = (
    (("widget", 8, 1), ("oblongPart", 10, 10), ("small4Handle", 10, 1), ("thin4Handle", 10, 1)),
    (("oblongPart", 10, 1),),
)
SAMPLED, QUICK_SAMPLED = (
    (("widget", 8, 1), ("oblongPart", 8, 2), ("small4Handle", 10, 2)),
    (("small4Handle", 10, 1),),
)
SAMPLES, QUICK_SAMPLES = (256, 1024, 4096), (256,)
SEPARATIONS = 22, 38
# Of the tolerances, the one that a program would try.
EXPECTED_LOST = 1e-6


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Make every witness."""
    data |= {"files": {}, "pictures": {}, "clamp": [], "doubles": [], "sampled": [], "samples": []}
    yield 0.0, "translating clamp"
    data["gap"], data["clamp_pitch"] = CLAMP_GAP, CLAMP_PITCH
    clamp_claim(data, quick)
    yield 0.15, "roots"
    roots_claim(data)
    yield 0.25, "sliding contacts"
    data["sliding"] = [made.sliding_fixture(one) for one in SEPARATIONS]
    data["sliding_listed"] = sum(
        workhold.design(made.bar(), workhold.Vise(pitch=10, columns=2, peg_radius=3)).found.values()
    )
    part = {"name": "bar", "units": "mm", "loops": [made.BAR]}
    data["files"]["bar.json"] = json.dumps(part) + "\n"
    data["pictures"]["bar"] = made.sliding_picture(SEPARATIONS)
    cases = QUICK_DOUBLES if quick else DOUBLES
    for number, case in enumerate(cases):
        yield 0.35 + 0.4 * number / len(cases), f"roots in doubles: {case[0]}"
        doubles_claim(data, *case)
    cases = QUICK_SAMPLED if quick else SAMPLED
    data["samples"] = list(QUICK_SAMPLES if quick else SAMPLES)
    for number, case in enumerate(cases):
        yield 0.75 + 0.25 * number / len(cases), f"samples: {case[0]}"
        data["sampled"].append(made.what_sampling_misses(*case, tuple(data["samples"])))


def clamp_claim(data: dict[str, Any], quick: bool) -> None:
    """How much of a translating clamp's fixtures a vise can hold."""
    parts = [workhold.Workpiece.from_loops("triangle", [TRIANGLE]), workhold.load("widget")]
    for part in parts[:1] if quick else parts:
        counts, result, lost = made.clamp_counts(part, CLAMP_PITCH, CLAMP_GAP)
        data["clamp"].append({"part": part.name, **counts, "held_share": counts["held"] / counts["clamp"]})
        if part.name == "triangle" and lost is not None:
            text, number = made.small_result(result, lost)
            data["files"]["clamp.json"] = text
            data["clamp_number"] = number
            data["clamp_behind"] = max(p.x for p in lost.pegs[:-1]) - lost.pegs[-1].x
            data["pictures"]["clamp"] = made.picture(result, lost, "a translating clamp that is not a vise")


def roots_claim(data: dict[str, Any]) -> None:
    """Degrees and numbers of poses of both types, and what the printed equation can be divided by."""
    for kind, case, printed in (("I", (2, 2), 24), ("II", (3, -1), 8)):
        told = factors(random_system(case, 1))
        poses = sum(one["degree"] for one in told["factors"] if one["holds_poses"])
        data[f"degree_{kind}"] = {"printed": printed, "eliminated": told["degree"], "poses": poses}
    circle, peg, radius = [3, -2, 5], [4, 1], 2
    data["divisible"] = {
        "as_printed": divisible(circle, peg, radius, True),
        "corrected": divisible(circle, peg, radius, False),
    }


def doubles_claim(data: dict[str, Any], part: str, pitch: float, columns: int) -> None:
    """What is lost when roots are taken in doubles and called real within a tolerance."""
    vise = workhold.Vise(pitch=pitch, columns=columns, peg_radius=3)
    result = workhold.design(workhold.load(part), vise, threads=1)
    row: dict[str, Any] = {"part": part, "pitch": pitch, "columns": columns, "there": len(result), "lost": []}
    for tolerance in made.TOLERANCES:
        lost = made.missing(result, made.found_by_naive_roots(result, tolerance))
        row["lost"].append({"tolerance": tolerance, "lost": len(lost), "share": len(lost) / len(result)})
        if tolerance == EXPECTED_LOST and lost and "doubles.json" not in data["files"]:
            data["files"]["doubles.json"], data["doubles_number"] = made.small_result(result, lost[0])
            data["doubles_part"] = part
            data["pictures"]["doubles"] = made.picture(result, lost[0], "lost by roots in doubles")
    data["doubles"].append(row)


def render(figures: Figures) -> list[Block]:
    """The claims, and the tables of what is lost."""
    blocks: list[Block] = [
        Heading(TITLE),
        Paragraph(
            "Each claim is quoted, then said as it holds, with a witness beside this report and the "
            "command that checks it. None of them "
            "touches what the paper is about: that the set can be enumerated, and how."
        ),
    ]
    for claim in claims(figures):
        blocks += [
            Heading(claim.title, 2),
            Paragraph(
                (
                    Marked("quote", claim.quoted[0]),
                    " (",
                    Marked("reference", claim.quoted[1]),
                    "). ",
                    *claim.ours,
                )
            ),
            Listing(
                (
                    *([("Witness: ", *joined(claim.files))] if claim.files else []),
                    ("Check: ", Marked("code", claim.check)),
                )
            ),
        ]
    pictures = figures.value("pictures") or {}
    if pictures:
        names = {
            "clamp": "no vise holds this",
            "bar": "slides, and closes",
            "doubles": "lost by roots in doubles",
        }
        shown = tuple((pictures[name], words) for name, words in names.items() if name in pictures)
        blocks.append(Picture("Figure 1", "The witnesses.", shown, across=3))
    return [*blocks, *lost_tables(figures)]


def joined(files: tuple[str, ...]) -> list[Inline]:
    """Names of files."""
    out: list[Inline] = []
    for number, name in enumerate(files):
        out += [", " if number else "", Marked("code", f"witnesses/{name}")]
    return out


def lost_tables(figures: Figures) -> list[Block]:
    """What roots in doubles and what samples lose."""
    blocks: list[Block] = []
    for label, name, of, caption, over in (
        (
            "Table 3",
            "doubles",
            "tolerance",
            "Fixtures lost when roots in double precision count as real "
            "within a tolerance, of all "
            "that are proven to be there.",
            "lost with a tolerance of",
        ),
        (
            "Table 4",
            "sampled",
            "samples",
            "Fixtures of Type I on chord curves lost by sampling half a turn.",
            "lost with so many samples",
        ),
    ):
        if not figures.value(name):
            continue
        columns = figures.every(f"{name}/0/lost")
        heads: list[Line] = [
            line_of((figures.power if of == "tolerance" else figures.count)(f"{name}/0/lost/{c}/{of}"))
            for c in columns
        ]
        rows: list[list[Inline]] = [
            [
                Marked("label", figures.value(f"{name}/{k}/part")),
                figures.fixed(f"{name}/{k}/pitch", 0),
                figures.count(f"{name}/{k}/columns"),
                figures.count(f"{name}/{k}/there"),
                *(figures.percent(f"{name}/{k}/lost/{c}/share", 1) for c in columns),
            ]
            for k in figures.every(name)
        ]
        headings = ("workpiece", "spacing (mm)", "columns", "there are", *heads)
        blocks.append(Table(label, caption, headings, rows, groups=(("", 4), (over, len(columns)))))
    return blocks


def files(figures: Figures) -> dict[str, str]:
    """The witnesses by the names of their files."""
    pictures = {f"{name}.svg": svg for name, svg in (figures.value("pictures") or {}).items()}
    return {**(figures.value("files") or {}), **pictures}
