"""``workhold batch``: every part with every toolkit, on all processors or on a cluster."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import frozen

from workhold.cli.commands import make_flag, make_option, print_remark, spread_option_groups
from workhold.cli.ending import INTERRUPTED, note_results_to_keep, set_event_on_interrupt
from workhold.cli.options import PartOptions
from workhold.cli.outputs import FORCE, JSON, OUTPUT, print_json, refuse_output_folder
from workhold.cli.program_options import SOLIDS, ProgramOptions
from workhold.cli.progress import show_batch_progress
from workhold.cli.search_options import QueryOptions, SeatingOptions
from workhold.cli.table import format_count, print_tables
from workhold.cli.toolkit_options import (
    SWEEP,
    NamedToolkit,
    ToolkitListOptions,
    collect_carrier_heights,
    find_peg_diameter,
    list_toolkits_to_try,
    make_query,
    split_words,
)
from workhold.cli.values import read_optional_count, read_positive_number, read_unit
from workhold.errors import InputError
from workhold.limits import choose_thread_count

if TYPE_CHECKING:
    from collections.abc import Sequence

    from workhold.batch.cluster import ClusterWorkers
    from workhold.batch.durations import TaskDurations
    from workhold.batch.report import Report
    from workhold.batch.run import BatchState, PartRequest, ToolkitQuery
    from workhold.batch.store import RecordStore
    from workhold.batch.workers import LocalWorkers
    from workhold.cli.progress import BatchProgress

__all__ = ["batch"]

# What is asked of the fixtures, of their seating, and of a program.
AskedWords = tuple[QueryOptions, SeatingOptions, ProgramOptions]

WORK = "The work"
# Fixtures that are kept of each job.
USUAL_BEST = "10"
# Far more than any job of docs/benchmarks.md takes.
USUAL_SECONDS = "3600"
RECORDS, MEASURED, REPORT, SHEETS = "work", "measured.csv", "report.html", "sheets"
# Parts that cannot be read or failed, as named on the terminal; the report names all.
MOST_NAMED = 10

PartsArgument = Annotated[
    list[str],
    typer.Argument(
        metavar="PARTS...",
        help="Parts: files, folders with drawings, built-in names; or files of jobs (.toml, .csv), each "
        "with its part, toolkits, restrictions and loads.",
    ),
]


TRIED = make_option(
    SWEEP,
    "NAMES|FILES",
    "Vises, plates and fences by name or from TOML files, such as plate-20mm,own.toml; or a kind (vise, "
    "plate, fence) with the lists below. May be repeated.",
    "--toolkit",
    "--toolkits",
)


@frozen
class BatchOutputOptions:
    """The options that choose what a batch keeps, as typed."""

    out: str = make_option(
        OUTPUT,
        "DIR",
        "Folder for the tables, the report and the records; the same folder again goes on with the run.",
        default="",
    )
    best: str = make_option(
        OUTPUT, "K", "Number of fixtures to keep of each job; all are counted.", default=USUAL_BEST
    )
    sheets: bool = make_flag(OUTPUT, "Write the setup sheet of each first choice as PDF.", "--sheets")
    force: bool = FORCE
    json_: bool = JSON


@frozen
class WorkerOptions:
    """The options that choose where the work is done, as typed."""

    workers: str | None = make_option(WORK, "N", "Worker processes; one for each processor if not given.")
    seconds: str = make_option(
        WORK,
        "S",
        "Longest time of one job; its row then says so, and the other jobs go on.",
        default=USUAL_SECONDS,
    )
    cluster: str | None = make_option(
        WORK,
        "ADDRESS",
        "Work on a Dask cluster instead; give the address of its scheduler, such as tcp://10.0.0.5:8786.",
    )
    local_cluster: str | None = make_option(
        WORK, "N", "Work on a Dask cluster of N processes on this machine instead."
    )
    records: str | None = make_option(
        WORK,
        "URL|DIR",
        "Folder for the records, if it is not in the folder of --out: a folder that all workers "
        "of a cluster see, or an object store such as s3://bucket/batch. The workers write there "
        "themselves.",
    )

    def read_setting(self) -> WorkerSetting:
        """Return the place of the work: processes of this machine, or a cluster.

        Raises InputError for more than one place, and for a cluster without Dask installed.
        """
        count = read_optional_count("--workers", self.workers)
        processes = read_optional_count("--local-cluster", self.local_cluster)
        if sum(word is not None for word in (self.workers, self.cluster, self.local_cluster)) > 1:
            raise InputError(
                "--workers, --cluster and --local-cluster each choose where the work is done: give only "
                "one of them."
            )
        on_cluster = self.cluster is not None or processes is not None
        if on_cluster and find_spec("distributed") is None:
            raise InputError(
                "a cluster needs Dask, which is not installed: install distributed>=2024.8 and "
                "fsspec>=2024.6."
            )
        longest = read_positive_number("--seconds", self.seconds)
        if on_cluster and self.seconds != USUAL_SECONDS:
            raise InputError(
                "--seconds limits the workers of this machine, and a cluster has no such limit: leave it out."
            )
        return WorkerSetting(count, longest, self.cluster, processes, self.records)


@frozen
class WorkerSetting:
    """Place where the work is done: processes of this machine, or a cluster.

    Parameters
    ----------
    count : number of processes; None for one on each processor.
    seconds : most seconds that a job may take.
    cluster : the address of a cluster's scheduler.
    processes : number of processes of a cluster on this machine.
    records : where records are kept; None for the folder of the results.
    """

    count: int | None
    seconds: float
    cluster: str | None
    processes: int | None
    records: str | None

    def make_queue(self, progress: BatchProgress, store: RecordStore) -> LocalWorkers | ClusterWorkers:
        """Return the queue that runs the jobs: processes of this machine, or a cluster.

        The workers of a cluster write records to ``store`` themselves if a folder for records was named.
        """
        if self.cluster is None and self.processes is None:
            from workhold.batch.workers import LocalWorkers

            return LocalWorkers(self.count or choose_thread_count(None), progress, seconds=self.seconds)
        from workhold.batch.cluster import ClusterWorkers

        kept_there = None if self.records is None else store
        return ClusterWorkers(progress, self.cluster, self.processes or 0, kept_there)


@frozen
class BatchTask:
    """A batch to run: requests for many parts, and the place of the results.

    Parameters
    ----------
    kept : number of fixtures of each job that are kept, the best ones.
    folder, names : folder for tables and report, and the names of these files.
    """

    requests: Sequence[PartRequest]
    kept: int
    place: WorkerSetting
    folder: Path
    names: tuple[str, ...]
    written: BatchOutputOptions


@frozen
class BatchAnswer:
    """Answers of a batch.

    Parameters
    ----------
    store, measured : records of the jobs, and the seconds that each job took.
    spent : seconds that the whole batch took.
    events : sentences on what happened to workers, for the report.
    gone : sentence that says how all workers were lost; empty if they were not.
    """

    done: BatchState
    store: RecordStore
    measured: TaskDurations
    spent: float
    events: list[str]
    gone: str

    @property
    def sentence(self) -> str:
        """Sentence with the number of parts, of jobs answered now and before, and the seconds."""
        before = f"; {self.done.kept:,} were known already" if self.done.kept else ""
        parts, fresh = format_count(len(self.done.parts), "part"), format_count(self.done.fresh, "answer")
        return f"{parts}, {fresh} found in {self.spent:.1f} s{before}."


@spread_option_groups
def batch(
    parts: PartsArgument,
    *,
    toolkit: list[str] | None = TRIED,
    varied: ToolkitListOptions,
    words: QueryOptions,
    seated_by: SeatingOptions,
    machined: ProgramOptions,
    written: BatchOutputOptions,
    work: WorkerOptions,
    reading: PartOptions,
) -> None:
    """Try many parts in many toolkits: every part with every toolkit, into tables, a report and result files.

    Every answer is kept as soon as it is found. After an interruption, the same command continues where it
    stopped. A part that cannot be read becomes a row with the reason.

    Example: workhold batch parts/ --toolkit plate-20mm,clamp-plate-20mm --out results
    """
    asked = parse(parts, toolkit, varied, (words, seated_by, machined), written, work, reading)
    report(asked, run_searches(asked))


def parse(
    parts: list[str],
    toolkit: list[str] | None,
    varied: ToolkitListOptions,
    words: AskedWords,
    written: BatchOutputOptions,
    work: WorkerOptions,
    reading: PartOptions,
) -> BatchTask:
    """Return what was typed as a task, checked before any search.

    Each part is read later, by the worker that needs it.
    """
    if not written.out:
        raise InputError("the folder for the results is not given: name one with --out.")
    kept, place, folder = (
        read_optional_count("--best", written.best) or 1,
        work.read_setting(),
        Path(written.out),
    )
    from workhold.batch.tables import list_table_names

    names = (*list_table_names(), REPORT)
    refuse_output_folder(folder, names, (*parts, words[0].loads, *words[2].files), written.force)
    requests = list_requests(parts, toolkit, varied, words, reading, folder)
    return BatchTask(requests, kept, place, folder, names, written)


def run_searches(asked: BatchTask) -> BatchAnswer:
    """Return the answers of a search for every part and toolkit,
    or those known when the user stops it with Ctrl-C.
    """
    from workhold.batch.durations import TaskDurations
    from workhold.batch.run import BatchRunner, run_batch
    from workhold.batch.store import FolderStore, open_store
    from workhold.cli.warming import compile_kernels, compile_seating

    records = asked.place.records
    store = FolderStore(asked.folder / RECORDS) if records is None else open_store(records)
    measured = TaskDurations(asked.folder / MEASURED)
    start = perf_counter()
    with set_event_on_interrupt(
        "the answers so far are kept, and the tables and the report are written"
    ) as stop:
        note_results_to_keep()
        if asked.place.cluster is None:
            compile_kernels(stop)
            if any(is_seated(held) for request in asked.requests for held in request.held_in):
                compile_seating(stop)
        with show_batch_progress() as progress, asked.place.make_queue(progress, store) as queue:
            done = run_batch(asked.requests, asked.kept, BatchRunner(store, queue, measured, progress, stop))
    spent = perf_counter() - start
    return BatchAnswer(done, store, measured, spent, progress.events, getattr(queue, "gone", ""))


def report(asked: BatchTask, answer: BatchAnswer) -> None:
    """Write tables, report and sheets, and print a summary; exit with INTERRUPTED where not all was searched.

    Raises InputError where all workers were lost.
    """
    from workhold.batch.tables import has_parquet

    done, folder, names = answer.done, asked.folder, asked.names
    found = write_all(asked, answer)
    for part, reason in list(found.bad)[:MOST_NAMED]:
        print_remark(f"{part}: {reason}")
    if len(found.bad) > MOST_NAMED:
        print_remark(f"and {len(found.bad) - MOST_NAMED:,} more, which the report names.")
    if asked.written.json_:
        bad = [{"part": part, "reason": reason} for part, reason in found.bad]
        counts = {"parts": len(done.parts), "found": done.fresh, "known_before": done.kept}
        print_json(
            **counts, complete=done.is_complete, bad=bad, written=[str(folder / name) for name in names]
        )
    else:
        print_tables(found.counts, answer.sentence, f"Written to {folder}: {', '.join(names)}.")
    if not has_parquet():
        print_remark("the tables are comma-separated values; install pyarrow>=18 to get Parquet.")
    if answer.gone:
        raise InputError(answer.gone)
    if not done.is_complete:
        print_remark("interrupted: start the same command again to go on.")
        raise typer.Exit(INTERRUPTED)


def write_all(asked: BatchTask, answer: BatchAnswer) -> Report:
    """Write tables, report and, if asked and all jobs are done,
    setup sheets into the folder; return the report.
    """
    from workhold.batch.report import Summary, write_results
    from workhold.version import __version__

    done, folder = answer.done, asked.folder
    toolkits = len({job.held_in.name for job in done.jobs})
    headline = f"{format_count(len(done.parts), 'part')} in {format_count(toolkits, 'toolkit')}"
    sentences = [
        answer.sentence,
        f"workhold {__version__} has made this page; the tables beside it have every figure.",
    ]
    if not done.is_complete:
        sentences.append("The run was interrupted; the same command again goes on.")
    where = folder / SHEETS if asked.written.sheets and done.is_complete else None
    summary = Summary(headline, sentences, answer.events)
    return write_results(done, answer.store, answer.measured, folder, REPORT, summary, where)


def is_seated(held: ToolkitQuery) -> bool:
    """Whether a query asks for seating that needs compiled kernels: with a vise or one clamp, but not with
    two clamps.
    """
    from workhold.model.query import Query

    return (
        isinstance(held.query, Query) and held.query.seating is not None and held.query.toolkit.closes_at_once
    )


def list_requests(
    parts: Sequence[str],
    toolkit: list[str] | None,
    varied: ToolkitListOptions,
    words: AskedWords,
    reading: PartOptions,
    folder: Path,
) -> list[PartRequest]:
    """Return a request for each part: first the parts named on the command line, then those in files of jobs."""
    from workhold.cli.jobs import JOB_ENDINGS, read_jobs

    lists = varied.has_pitches or toolkit is not None
    named = list_asked_toolkits(toolkit, varied, reading) if lists else None
    make_query_arguments(words, reading)
    requests: list[PartRequest] = []
    plain = [name for name in parts if Path(name).suffix.lower() not in JOB_ENDINGS]
    if plain:
        if named is None:
            raise InputError("no toolkit is given: name one or more with --toolkit (see workhold toolkits).")
        requests += list_requests_in_toolkits(named, plain, words, reading, folder)
    for name in parts:
        if name in plain:
            continue
        for job in read_jobs(Path(name)):
            try:
                own_reading = job.replace_options(reading)
                own_words = (
                    job.replace_options(words[0]),
                    job.replace_options(words[1]),
                    job.replace_options(words[2]),
                )
                own = named
                if job.toolkits is not None:
                    own = list_asked_toolkits(job.toolkits, ToolkitListOptions(), own_reading)
                if own is None:
                    raise InputError(
                        "no toolkit is given: name one or more under toolkit, or for all of them."
                    )
                requests += list_requests_in_toolkits(own, [job.part], own_words, own_reading, folder)
            except InputError as error:
                raise InputError(f"{job.place}: {error}") from error
    return requests


def list_requests_in_toolkits(
    toolkits: Sequence[NamedToolkit],
    parts: Sequence[str],
    words: AskedWords,
    reading: PartOptions,
    folder: Path,
) -> list[PartRequest]:
    """Return one request for each part with all toolkits;
    for a solid whose peg height is not given, one for each peg diameter.
    """
    from workhold.batch.run import ANY_PART, PartRequest, ToolkitQuery
    from workhold.files.part_list import list_parts

    asked = make_query_arguments(words, reading)
    held_in = [ToolkitQuery(one.name, make_query(ANY_PART, one, asked)) for one in toolkits]
    # With a program heights are among what is asked.
    known = (
        words[2].read_heights(read_unit(reading.unit), reading.peg_height) if words[2].program is None else {}
    )
    drawn_in = [ToolkitQuery(one.name, make_query(ANY_PART, one, asked | known)) for one in toolkits]
    listed, heights = list_parts(parts, [folder]), collect_carrier_heights(toolkits)
    of_carriers = {"heights": heights} if heights else {}
    by_pegs: dict[float | None, list[ToolkitQuery]] = {}
    for one, named in zip(held_in, toolkits, strict=True):
        by_pegs.setdefault(find_peg_diameter(named), []).append(one)
    requests = []
    for part in listed:
        options = words[2].adapt_part_options(part.name, reading).to_read_arguments() | of_carriers
        if part.path.suffix.lower() not in SOLIDS:
            requests.append(PartRequest(part, options, drawn_in))
            continue
        if options["peg_height"] is not None:
            requests.append(PartRequest(part, options, held_in))
            continue
        # Pegs of each diameter reach as high as they must, and the outline is what those meet.
        requests += [PartRequest(part, options | {"peg_diameter": d}, some) for d, some in by_pegs.items()]
    return requests


def list_asked_toolkits(
    names: list[str] | None,
    varied: ToolkitListOptions,
    reading: PartOptions,
) -> list[NamedToolkit]:
    """Return the toolkits of the names and files typed, each varied by the lists of figures.

    At most one name may be a kind of toolkit.
    """
    from workhold.fixels.kinds import ALIASES, KINDS

    words = [word for text in names or () for word in split_words("--toolkit", text)]
    kinds = [word for word in words if word.lower() in (*KINDS, *ALIASES)]
    if len(kinds) > 1:
        raise InputError(
            f"{kinds[0]} and {kinds[1]} are two kinds of toolkit: give one, and others by name or file."
        )
    others = [word for word in words if word not in kinds]
    if kinds and not varied.has_pitches and not others:
        raise InputError(
            f"{kinds[0]} is a kind of toolkit: give --pitch and --peg-radius too, or name toolkits."
        )
    kind = kinds[0] if kinds else None
    return list_toolkits_to_try(others or None, kind, varied, read_unit(reading.unit))


def make_query_arguments(words: AskedWords, reading: PartOptions) -> dict[str, Any]:
    """Return the keyword arguments of a query, without part,
    toolkit and types, from options as typed; lengths in mm.
    """
    wishes, seated_by, machined = words
    unit, has_program = read_unit(reading.unit), machined.program is not None
    asked = wishes.read_arguments(unit, has_program, machined.has_forces) | seated_by.read_arguments(unit)
    return asked | machined.read_query_arguments(unit, reading.peg_height)
