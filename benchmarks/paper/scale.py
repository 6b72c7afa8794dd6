"""A catalogue of a million parts on a cluster: what it costs by measured rates, what breaks first, and what was run here."""

from __future__ import annotations

import os
import random
from collections.abc import Iterator
from math import sqrt
from pathlib import Path
from statistics import fmean, stdev
from tempfile import TemporaryDirectory
from typing import Any

from batch_estimate import PRESETS, measured_runs
from batch_simulation import SEED, finished
from paper.catalogue_runs import BEST, TOOLKITS, killed_and_resumed, make_records, run_batch, write_parts
from paper.document import Block, Figures, Heading, Inline, Marked, Paragraph, Table
from report import kept_figures, measured

NAME, TITLE = "scale", "A million parts"
SECONDS, QUICK_SECONDS = 480.0, 25.0

MEASURED_PARTS, QUICK_PARTS = 2000, 12
# A part of the catalogue that is asked for again when all is known, to see what a known job costs.
TENTH = 10
ESTIMATED, QUICK_ESTIMATED = 32, 4
QUEUE_TASKS, QUICK_QUEUE_TASKS = 3000, 100
# The catalogue: parts, and the kinds of toolkit in which each is tried.
PARTS, KINDS = 1_000_000, ("vise", "plate", "fence")
WORKERS = (16, 64, 256, 1024)
QUICK_SHARE = 100
QUICK_PRESETS = ("plate-20mm", "clamp-plate-20mm", "fence-20mm")
# The load from which times by the clock say little on two processors.
BUSY = 3.5
HOUR, DAY = 3600.0, 86400.0
# What we take as the end of what is useful: bytes of memory for who asks, of disk, and
# seconds before a run that goes on begins.
MEMORY, DISK, START = 16e9, 1e12, 3600.0


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Run a catalogue in three ways, measure tasks and queues, then reckon."""
    count = QUICK_PARTS if quick else MEASURED_PARTS
    with TemporaryDirectory() as name:
        for share, words in run_catalogue(data, Path(name), count):
            yield 0.62 * share, words
    yield 0.62, "seconds of a search"
    runs = measured_runs(QUICK_ESTIMATED if quick else ESTIMATED, QUICK_PRESETS if quick else PRESETS)
    seconds: dict[str, list[float]] = {}
    for law, _, _, spent, _ in runs:
        seconds.setdefault(law, []).append(spent)
    data["kinds"] = [kind_row(law, values) for law, values in sorted(seconds.items())]
    yield 0.8, "the queue"
    data["queue"] = queue_costs(QUICK_QUEUE_TASKS if quick else QUEUE_TASKS)
    yield 0.88, "simulation"
    reckon(data, seconds, PARTS // (QUICK_SHARE if quick else 1))


def run_catalogue(data: dict[str, Any], folder: Path, count: int) -> Iterator[tuple[float, str]]:
    """One worker, two workers, and two that are killed and resumed; then what a known job costs."""
    yield 0.0, "one worker"
    parts = write_parts(folder / "parts", count)
    alone = run_batch(parts, folder / "one", 1)
    records = make_records(folder / "one")
    jobs = count * len(TOOLKITS)
    data |= {"parts": count, "jobs": jobs, "best": BEST, "records": len(records)}
    data["one"] = {"seconds": alone.seconds, "processor": alone.processor}
    yield 0.4, "two workers"
    pair = run_batch(parts, folder / "two", 2)
    data["two"] = {"seconds": pair.seconds, "processor": pair.processor}
    data["gain"] = alone.seconds / pair.seconds
    # Above the number of processors, something else was at work.
    data["load"] = os.getloadavg()[0]
    yield 0.65, "two workers, killed and resumed"
    data["killed"] = killed_and_resumed(parts, folder / "killed", len(records))
    others = {name: make_records(folder / name) for name in ("two", "killed")}
    data["same_two"], data["same_killed"] = others["two"] == records, others["killed"] == records
    data["unlike"] = sum(
        found.get(path) != told for found in others.values() for path, told in records.items()
    )
    yield 0.9, "what is known"
    fewer = write_parts(folder / "fewer", max(count // TENTH, 1))
    known, few = run_batch(parts, folder / "one", 1), run_batch(fewer, folder / "two", 1)
    more = jobs - max(count // TENTH, 1) * len(TOOLKITS)
    # What a run has once is nothing in a large catalogue, so only growth counts; the page has a most of rows.
    data["each"] = {
        "processor": alone.processor / jobs,
        "record": sum(size for size, _ in records.values()) / jobs,
        "tables": (grown_by(folder, "results.*") + grown_by(folder, "best.*")) / more,
        "memory": max(known.memory - few.memory, 0) / more,
        "known": max(known.processor - few.processor, 0.0) / more,
    }


def grown_by(folder: Path, pattern: str) -> int:
    """Bytes that files of the run over all parts have more than those of the run over some."""
    all_parts, some = (
        sum(path.stat().st_size for path in (folder / name).glob(pattern)) for name in ("one", "two")
    )
    return max(all_parts - some, 0)


def kind_row(law: str, values: list[float]) -> dict[str, Any]:
    """Mean seconds of a search in a kind of toolkit, with its standard error, and what a million take."""
    error = stdev(values) / sqrt(len(values)) if len(values) > 1 else 0.0
    mean = fmean(values)
    return {
        "kind": law,
        "searches": len(values),
        "mean": mean,
        "error": error,
        "largest": max(values),
        "core_hours": PARTS * mean / HOUR,
        "core_hours_error": PARTS * error / HOUR,
        # Of the work, with each worker lost once a day in the middle of a search.
        "redone": fmean([v * v for v in values]) / (2.0 * mean) / DAY,
    }


def queue_costs(count: int) -> dict[str, Any]:
    """Seconds that each queue takes for a task; Dask's from the figures kept where it is not installed."""
    told = measured("batch_queue.costs", count)
    is_measured = "Dask" in told
    if not is_measured:
        told["Dask"] = kept_figures()["sections"]["batch-queue"]["data"]["Dask"]
    costs = {"processes": told["processes"], "dask": told["Dask"]}
    return {**costs, "dask_measured": is_measured, "tasks": count}


def reckon(data: dict[str, Any], seconds: dict[str, list[float]], parts: int) -> None:
    """Cost of the catalogue, its end for each number of workers, and what breaks first."""
    chance = random.Random(SEED)
    tasks = [one for kind in KINDS if kind in seconds for one in chance.choices(seconds[kind], k=parts)]
    tasks.sort(reverse=True)
    whole = sum(tasks)
    rows = [row for row in data["kinds"] if row["kind"] in KINDS]
    jobs = PARTS * len(rows)
    each = data["each"]
    data["catalogue"] = {
        "parts": PARTS,
        "simulated": parts,
        "kinds": len(rows),
        "jobs": jobs,
        "core_hours": sum(row["core_hours"] for row in rows),
        "error": sqrt(sum(row["core_hours_error"] ** 2 for row in rows)),
        "records": jobs * each["record"],
        "tables": jobs * each["tables"],
        "memory": jobs * each["memory"],
        "start_hours": jobs * each["known"] / HOUR,
        "mean": whole / len(tasks),
        "most_workers": whole / len(tasks) / data["queue"]["dask"],
    }
    data["simulation"] = []
    for workers in WORKERS:
        row: dict[str, Any] = {"workers": workers}
        for name in ("processes", "dask"):
            end = finished(tasks, workers, data["queue"][name])
            row |= {f"{name}_hours": end * PARTS / parts / HOUR, f"{name}_share": whole / (workers * end)}
        data["simulation"].append(row)
    data["breaks"] = sorted(breaking(data, len(rows)), key=lambda one: one["parts"])


def breaking(data: dict[str, Any], kinds: int) -> Iterator[dict[str, Any]]:
    """Each bound, what a job takes of it, and the number of parts at which it is reached."""
    each = data["each"]
    for name, used, bound in (
        ("memory of who asks", each["memory"], MEMORY),
        ("records on one disk", each["record"], DISK),
        ("the start of a run that goes on", each["known"], START),
        ("Dask's one scheduler for a day", data["queue"]["dask"], DAY),
    ):
        if used > 0.0:
            yield {"name": name, "each": used, "bound": bound, "parts": bound / used / kinds}


def render(figures: Figures) -> list[Block]:
    """What was run, what it would cost, and what breaks."""
    blocks: list[Block] = [Heading(TITLE)]
    if figures.value("each"):
        blocks += run_here(figures)
    if figures.value("catalogue"):
        blocks += reckoned(figures)
    return blocks if len(blocks) > 1 else []


def run_here(figures: Figures) -> list[Block]:
    """The runs of this machine."""
    same = "with the same bytes, every one" if not figures.value("unlike") else "and they are not all "
    "alike"
    return [
        Paragraph(
            (
                "Run here: ",
                figures.count("parts"),
                " parts of a made catalogue, each in ",
                Marked("code", ", ".join(TOOLKITS)),
                ", ",
                figures.count("jobs"),
                " searches. One worker took ",
                figures.significant("one/seconds"),
                " s by the clock and ",
                figures.significant("one/processor"),
                " s of the processor, two workers ",
                figures.significant("two/seconds"),
                " s and ",
                figures.significant("two/processor"),
                " s: ",
                figures.fixed("gain", 2),
                " times as fast. In a third run ",
                figures.count("killed/workers_killed"),
                " workers were killed at work, and then the run itself when it had ",
                figures.count("killed/records_when_killed"),
                " of ",
                figures.count("records"),
                " records; the same command again went on from there. All three left the same records, ",
                same,
                " (",
                figures.count("unlike"),
                " differ).",
                *busy(figures),
            )
        )
    ]


def busy(figures: Figures) -> list[Inline]:
    """A caution where the machine had other work."""
    load = figures.value("load")
    if load is None or load < BUSY:
        return []
    words = " Other programs ran at the same time (a load of "
    return [
        words,
        figures.fixed("load", 1),
        "), so times by the clock say little here, those of the processor more.",
    ]


def reckoned(figures: Figures) -> list[Block]:
    """The cost of a million parts."""
    kinds: list[list[Inline]] = [
        [
            figures.value(f"kinds/{k}/kind"),
            figures.count(f"kinds/{k}/searches"),
            figures.fixed(f"kinds/{k}/mean", 3),
            figures.fixed(f"kinds/{k}/error", 3),
            figures.fixed(f"kinds/{k}/largest", 2),
            figures.fixed(f"kinds/{k}/core_hours", 0),
            figures.fixed(f"kinds/{k}/core_hours_error", 0),
        ]
        for k in figures.every("kinds")
    ]
    simulated: list[list[Inline]] = [
        [
            figures.count(f"simulation/{k}/workers"),
            figures.fixed(f"simulation/{k}/processes_hours", 2),
            figures.percent(f"simulation/{k}/processes_share"),
            figures.fixed(f"simulation/{k}/dask_hours", 2),
            figures.percent(f"simulation/{k}/dask_share"),
        ]
        for k in figures.every("simulation")
    ]
    units = {
        "memory": (1.0, "bytes"),
        "records": (1e3, "kB"),
        "start": (1e-3, "ms"),
        "Dask": (1e-3, "ms"),
    }
    bounds = {
        "memory": (1e9, "GB"),
        "records": (1e12, "TB"),
        "start": (3600.0, "h"),
        "Dask": (3600.0, "h"),
    }
    breaks: list[list[Any]] = []
    for k in figures.every("breaks"):
        name = figures.value(f"breaks/{k}/name")
        word = next(word for word in units if word in name)
        (scale, unit), (large, large_unit) = units[word], bounds[word]
        breaks.append(
            [
                name,
                (figures.significant(f"breaks/{k}/each", 2, scale), f" {unit}"),
                (figures.fixed(f"breaks/{k}/bound", 0, large), f" {large_unit}"),
                figures.fixed(f"breaks/{k}/parts", 0),
            ]
        )
    source = (
        "was measured in this run"
        if figures.value("queue/dask_measured")
        else "is that of the benchmarks kept, since Dask is not installed here"
    )
    return [
        Paragraph(
            (
                "Reckoned: ",
                figures.count("catalogue/parts"),
                " parts in a vise, on a plate ",
                Marked("reference", "[3]"),
                " and against a fence ",
                Marked("reference", "[4]"),
                ", ",
                figures.count("catalogue/jobs"),
                " searches whose seconds are drawn from those measured. They cost ",
                figures.fixed("catalogue/core_hours", 0),
                " ± ",
                figures.fixed("catalogue/error", 0),
                " core hours, ",
                figures.significant("catalogue/records", 3, 1e9),
                " GB of records with the best ",
                figures.count("best"),
                " fixtures each, and ",
                figures.significant("catalogue/tables", 2, 1e9),
                " GB of "
                "tables. Two clamps are not in it: they "
                "cost what the table says. The queue hands out a task in ",
                figures.significant("queue/processes", 2, 1e-3),
                " ms on one machine and ",
                figures.significant("queue/dask", 2, 1e-3),
                " ms with Dask, which ",
                source,
                "; so one scheduler of Dask feeds ",
                figures.fixed("catalogue/most_workers", 0),
                " workers with searches of ",
                figures.significant("catalogue/mean", 2),
                " s, and more of them wait. What a worker loses when it is lost is a search at most.",
            )
        ),
        Table(
            "Table 11",
            "Seconds of a search by kind of toolkit, with the standard error of their mean, "
            "and core hours of a million parts.",
            ("kind", "searches", "mean (s)", "± (s)", "largest (s)", "core hours", "±"),
            kinds,
        ),
        Table(
            "Table 12",
            "The catalogue with more and more workers, simulated. At work: the share of the "
            "workers' time that is spent in searches.",
            ("workers", "one machine's queue (h)", "at work", "Dask (h)", "at work"),
            simulated,
            left=(),
        ),
        Table(
            "Table 13",
            (
                "What breaks first. Each row holds what a search takes against a bound that is ours, and "
                "the number of parts, in ",
                figures.count("catalogue/kinds"),
                " toolkits each, at which it is reached.",
            ),
            ("what", "each search", "bound", "parts"),
            breaks,
        ),
    ]
