"""Where the time of a proven search goes, stage by stage."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from time import perf_counter
from typing import Any

from designs import PEG_RADIUS, ROWS, Design, grown, loaded, warm
from paper.document import Block, Figures, Heading, Inline, Marked, Paragraph, Table
from report import measured

NAME, TITLE = "stages", "Share of time per stage"
SECONDS, QUICK_SECONDS = 25.0, 4.0

STAGES = {
    "reading": "reading the drawing",
    "features": "features",
    "curves": "chord curves",
    "searching": "crossings",
    "deciding": "proving",
    "measuring": "listing once, measuring",
    "ranking": "ranking, table",
    "rest": "rest",
}
REPEATS = 3


def designs(quick: bool) -> list[Design]:
    """Rows of Table 1 of one and of ten columns, and one that is larger by far."""
    rows = {0: ROWS[0], 1: ROWS[8], 2: ROWS[5], 3: ROWS[10]}
    chosen = [row.design for row in rows.values()]
    return chosen[:1] if quick else [*chosen, grown(Design("widget", 8, 5), 2)]


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Time the stages of each design."""
    chosen = designs(quick)
    data["rows"] = []
    for number, design in enumerate(chosen):
        yield number / len(chosen), " ".join(design.words)
        outcome = measured("paper.stages.timed", design.part, design.pitch, design.columns, design.peg_radius)
        data["rows"].append(
            {"part": design.part, "pitch": design.pitch, "columns": design.columns, **outcome}
        )


def timed(part: str, pitch: float, columns: int, peg_radius: float = PEG_RADIUS) -> dict[str, Any]:
    """Task: seconds of a design and the share of each stage, of the fastest of three runs."""
    import workhold
    from workhold.contact.problem import Problem
    from workhold.listing import results
    from workhold.listing.collector import ResultCollector
    from workhold.search import design
    from workhold.search.toolkit_search import ToolkitSearch

    warm()
    spent = dict.fromkeys(STAGES, 0.0)

    def watched(stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, its seconds counted for a stage."""

        def call(*arguments: Any, **named: Any) -> Any:
            begun = perf_counter()
            try:
                return function(*arguments, **named)
            finally:
                spent[stage] += perf_counter() - begun

        return call

    Problem.from_query = watched("features", Problem.from_query)  # type: ignore[method-assign]
    ToolkitSearch.from_problem = watched("curves", ToolkitSearch.from_problem)  # type: ignore[method-assign]
    vars(design)["run_blocks"] = watched("searching", design.run_blocks)
    for stage, name in (
        ("deciding", "take_records"),
        ("deciding", "finish_deciding"),
        ("measuring", "measure"),
    ):
        setattr(ResultCollector, name, watched(stage, getattr(ResultCollector, name)))
    vars(results)["add_table"] = watched("ranking", results.add_table)
    best: dict[str, float] = {}
    for _ in range(REPEATS):
        spent.update(dict.fromkeys(STAGES, 0.0))
        start = perf_counter()
        workpiece, vise = loaded(part, pitch, columns, peg_radius)
        spent["reading"] = perf_counter() - start
        workhold.design(workpiece, vise, threads=1)
        seconds = perf_counter() - start
        spent["rest"] = seconds - sum(spent.values())
        if not best or seconds < best["seconds"]:
            best = {"seconds": seconds, **{stage: took / seconds for stage, took in spent.items()}}
    return best


def render(figures: Figures) -> list[Block]:
    """The table of shares."""
    rows: list[list[Inline]] = [
        [
            Marked("label", figures.value(f"rows/{k}/part")),
            figures.significant(f"rows/{k}/pitch", 1),
            figures.count(f"rows/{k}/columns"),
            figures.fixed(f"rows/{k}/seconds", 4),
            *(figures.percent(f"rows/{k}/{stage}") for stage in STAGES),
        ]
        for k in figures.every("rows")
    ]
    return [
        Heading(TITLE),
        Paragraph(
            "Crossings are found by the search itself; proving is the certificates and what they hand "
            "on; the last stages give each "
            "fixture one form, its holes and its figures of quality, and put all of them in order. One "
            "thread."
        ),
        Table(
            "Table 9",
            "Share of the whole time that each stage takes, from the drawing to the ranked list.",
            ("workpiece", "spacing (mm)", "columns", "time (s)", *STAGES.values()),
            rows,
        ),
    ]
