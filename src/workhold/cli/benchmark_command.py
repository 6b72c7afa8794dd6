"""The command ``benchmark``: lists the sets, makes their complete lists, and compares another program's."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer
from attrs import frozen

from workhold.cli.commands import make_flag, make_option, spread_option_groups
from workhold.cli.ending import INTERRUPTED, set_event_on_interrupt
from workhold.cli.outputs import FORCE, JSON, print_json, refuse_output_folder
from workhold.cli.progress import show_progress
from workhold.cli.table import Table, format_count, print_tables
from workhold.cli.values import read_choice, read_optional_count, read_positive_number
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.benchmark.catalogue import SetEntry
    from workhold.benchmark.making import MadeSet
    from workhold.benchmark.matching import Comparison

__all__ = ["benchmark"]

# The name of a file, its set, and the comparison with it.
ComparedFile: TypeAlias = "tuple[str, str, Comparison]"
ACTIONS = ("list", "run", "check", "checker")
DIFFERS = 2
# mm: how far another program's pegs may be from where the complete list has them.
TOLERANCE = "0.001"


@frozen
class BenchmarkOptions:
    """The options of all actions, as typed."""

    out: str | None = make_option(None, "DIR", "For run: the folder into which the sets are written.")
    parquet: bool = make_flag(None, "For run: write sets of 5,000 fixtures or more as Parquet.", "--parquet")
    set_: str | None = make_option(
        None, "NAME", "For check: the set to which the files belong, if they do not say it.", "--set"
    )
    tolerance: str = make_option(
        None,
        "MM",
        "For check: how far a peg may be from its place in the complete list.",
        default=TOLERANCE,
    )
    symmetric: bool = make_flag(
        None,
        "For check: count one fixture for all those that a rotation of the part carries into each other.",
        "--symmetric",
    )
    threads: str | None = make_option(None, "N", "Threads to use; all processors if not given.")
    force: bool = FORCE
    json_: bool = JSON


@frozen
class BenchmarkTask:
    """An action of the benchmark.

    Parameters
    ----------
    names : names of sets, or paths of files with another program's fixtures.
    tolerance : tolerance in mm when another program's fixtures are compared.
    """

    action: str
    names: Sequence[str]
    words: BenchmarkOptions
    threads: int | None
    tolerance: float


@spread_option_groups
def benchmark(
    action: Annotated[str, typer.Argument(metavar="ACTION", help="list, run, check or checker.")],
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAMES]...",
            help="For list and run: sets, workpieces, or words that a set's name contains; all if not "
            "given. For check: files with another program's fixtures, JSON or CSV.",
        ),
    ] = None,
    *,
    words: BenchmarkOptions,
) -> None:
    """List the sets of the benchmark, make their complete lists, or compare another program's with them.

    A set is a workpiece, a toolkit and the complete list of its fixtures. The lists are made on this machine
    in less than a minute and compared with the checksums that come with workhold. The last action prints a
    program that checks a set's file with NumPy alone.

    Example: workhold benchmark run kite --out sets
    """
    asked = parse(action, names or [], words)
    if asked.action == "checker":
        print_checker()
    elif asked.action == "list":
        list_sets(choose_sets(asked.names), words.json_)
    elif asked.action == "run":
        chosen = choose_sets(asked.names)
        report_made(asked, chosen, make_sets(asked, chosen))
    else:
        report_compared(asked, compare(asked))


def parse(action: str, names: Sequence[str], words: BenchmarkOptions) -> BenchmarkTask:
    """Return what was typed as a task, with its numbers read and checked."""
    asked = read_choice("the action", action, ACTIONS)
    threads = read_optional_count("--threads", words.threads)
    tolerance = read_positive_number("--tolerance", words.tolerance)
    if words.out is not None and asked != "run":
        raise InputError(f"--out belongs to run: leave it out, or say run instead of {asked}.")
    return BenchmarkTask(asked, names, words, threads, tolerance)


def print_checker() -> None:
    """Write the program that checks a set's file to stdout."""
    from workhold.benchmark.catalogue import read_benchmark_file

    sys.stdout.write(read_benchmark_file("check.py").decode("utf-8"))


def choose_sets(words: Sequence[str]) -> list[SetEntry]:
    """Return the sets that match any of the words, in the benchmark's order; all sets without words.

    A word matches a set of that name, else all sets of a workpiece of that name, else all sets whose name
    contains it. Raises InputError for a word that matches none.
    """
    from workhold.benchmark.catalogue import find_set, load_sets

    every, chosen = load_sets(), set[str]()
    for word in words:
        called = [one.name for one in every if one.name == word]
        of_part = [one.name for one in every if one.part == word]
        holding = [one.name for one in every if word in one.name]
        chosen |= set(called or of_part or holding or [find_set(word).name])
    return [one for one in every if not words or one.name in chosen]


def list_sets(chosen: Sequence[SetEntry], as_json: bool) -> None:
    """Print the sets with sizes and reasons, as a table or as JSON."""
    if as_json:
        entries = [
            {
                "name": one.name,
                "workpiece": one.part,
                "toolkit": dict(one.toolkit),
                "reason": one.reason,
                "counts": dict(one.counts),
            }
            for one in chosen
        ]
        print_json(sets=entries)
        return

    table = Table(("set", ">fixtures", "reason"))
    for one in chosen:
        table.add_row(one.name, f"{one.size:,}", one.reason)
    total = sum(one.size for one in chosen)
    print_tables(table, f"{format_count(len(chosen), 'set')}, {format_count(total, 'fixture')}.")


def make_sets(asked: BenchmarkTask, chosen: Sequence[SetEntry]) -> list[MadeSet]:
    """Write the chosen sets into the folder and return them; after Ctrl-C, return those that are complete."""
    words = asked.words
    if words.out is None:
        raise InputError("run needs a folder for the sets: name one with --out.")
    folder = Path(words.out)
    names = ["manifest.json", "check.py", *(f"{one.name}.json" for one in chosen)]
    refuse_output_folder(folder, names, (), words.force)
    from workhold.benchmark.making import load_arrow, make_and_write_sets, write_common
    from workhold.cli.warming import compile_kernels

    if words.parquet:
        load_arrow()
    write_common(chosen, folder)
    with set_event_on_interrupt("the finished sets are kept") as cancel:
        compile_kernels(cancel)
        with show_progress("Making sets", "fixtures") as progress:
            made = make_and_write_sets(
                chosen, folder, parquet=words.parquet, threads=asked.threads, progress=progress, cancel=cancel
            )
            return list(made)


def report_made(asked: BenchmarkTask, chosen: Sequence[SetEntry], made: Sequence[MadeSet]) -> None:
    """Print how the made sets compare with the manifest.

    Exits with DIFFERS where a set differs, and with INTERRUPTED where some sets were not made.
    """
    other = [one for one in made if not one.is_same]
    if asked.words.json_:
        print_json(
            sets=[
                {"name": one.entry.name, "file": str(one.path), "counts": dict(one.counts)}
                | {"differs": list(one.differs)}
                for one in made
            ]
        )
    else:
        rounded = [one for one in made if one.is_same and "fixtures" in one.differs]
        sentences = [
            f"{one.entry.name}: {one.size:,} fixtures, not the {one.entry.size:,} of the manifest."
            for one in other
        ]
        if rounded:
            few = ", ".join(one.entry.name for one in rounded[:5])
            sentences.append(f"The same fixtures, except that this machine rounds otherwise: {few}.")
        total = sum(one.size for one in made)
        same = "all equal to the manifest" if not other and not rounded else f"{len(other)} of them differ"
        done = f"{format_count(len(made), 'set')} with {format_count(total, 'fixture')} written to {asked.words.out}"
        print_tables(*sentences, f"{done}, {same}.")
    if len(made) < len(chosen):
        raise typer.Exit(INTERRUPTED)
    if other:
        raise typer.Exit(DIFFERS)


def compare(asked: BenchmarkTask) -> list[ComparedFile]:
    """Return, for each file of another program's fixtures, how it compares with the complete list.

    After Ctrl-C, return the comparisons done so far.
    """
    files, words = asked.names, asked.words
    if not files:
        raise InputError("check needs a file with another program's fixtures: name one or more.")
    from workhold.benchmark.catalogue import find_set
    from workhold.benchmark.making import compare_entry
    from workhold.benchmark.matching import read_entry
    from workhold.cli.warming import compile_kernels

    entries = [read_entry(Path(name), words.set_) for name in files]
    for entry in entries:
        find_set(entry.set_name)
    done: list[ComparedFile] = []
    with set_event_on_interrupt("the results so far are printed") as cancel:
        compile_kernels(cancel)
        with show_progress("Comparing", "files") as progress:
            for number, (name, entry) in enumerate(zip(files, entries, strict=True), 1):
                outcome = compare_entry(entry, asked.tolerance, words.symmetric, asked.threads, cancel)
                if outcome is None:
                    break
                done.append((name, entry.set_name, outcome))
                progress(number / len(files), number)
    return done


def report_compared(asked: BenchmarkTask, done: Sequence[ComparedFile]) -> None:
    """Print which fixtures of each set another program found, missed or has too many.

    Exits with INTERRUPTED where some files were not compared.
    """
    if asked.words.json_:
        print_json(files=[convert_comparison_to_json(*one) for one in done])
    else:
        print_comparisons(done)
    if len(done) < len(asked.names):
        raise typer.Exit(INTERRUPTED)


def convert_comparison_to_json(name: str, set_name: str, outcome: Comparison) -> dict[str, Any]:
    """Return a comparison as an object for JSON; fixtures are numbered from 1."""
    data: dict[str, Any] = {"file": name, "set": set_name, "listed": outcome.listed, "theirs": outcome.theirs}
    for key in ("found", "missed", "extra", "repeated"):
        data[key] = [number + 1 for number in getattr(outcome, key)]
    return data | {"share": outcome.share}


def print_comparisons(done: Sequence[ComparedFile]) -> None:
    """Print a table of counts, and sentences that name up to eight missed and extra fixtures of each file."""
    table = Table(("set", ">complete", ">theirs", ">found", ">missed", ">extra", ">repeated", ">share"))
    sentences = []
    for _, set_name, one in done:
        numbers = (one.listed, one.theirs, len(one.found), len(one.missed), len(one.extra), len(one.repeated))
        table.add_row(set_name, *(f"{number:,}" for number in numbers), f"{format_share(one)} %")
        for words, which in (("Missed", one.missed), ("No fixtures of the set", one.extra)):
            if which:
                few = ", ".join(str(number + 1) for number in which[:8])
                more = f" and {len(which) - 8:,} more" if len(which) > 8 else ""
                whose = "of the complete list" if words == "Missed" else "of theirs"
                sentences.append(f"{set_name}: {words}: {few}{more}, {whose}.")
    print_tables(table, *sentences)


def format_share(outcome: Comparison) -> str:
    """Return the share found in percent with one decimal: 100.0 only where nothing is missed."""
    percent = 100 * outcome.share
    return f"{min(percent, 99.9) if outcome.missed else percent:.1f}"
