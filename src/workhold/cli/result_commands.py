"""The commands on a whole result file: ``convert`` and ``verify``.

The first writes the result in another form; the second proves or refutes every fixture of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer
from attrs import frozen

from workhold.cli.commands import make_flag, make_option
from workhold.cli.ending import INTERRUPTED, set_event_on_interrupt
from workhold.cli.options import ResultArgument
from workhold.cli.outputs import (
    FORCE,
    FORMAT,
    JSON,
    STANDARD_OUTPUT,
    choose_output_form,
    print_json,
    print_written,
    refuse_both,
    refuse_result_file,
    write_output,
)
from workhold.cli.progress import show_progress, show_search_progress
from workhold.cli.table import format_count, print_tables
from workhold.cli.values import read_optional_count, read_whole_number
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.verification import Verification
    from workhold.verification.listing import WrittenListing

__all__ = ["convert", "verify"]


def convert(
    result_file: ResultArgument,
    out: Annotated[str, typer.Argument(metavar="FILE", help="The file to write; - is the terminal.")],
    format_: str | None = FORMAT,
    force: bool = FORCE,
    json_: bool = JSON,
) -> None:
    """Write a result file in another form:
    JSON, columns (npz) for a great many fixtures, or CSV for a spreadsheet.

    A file that goes from JSON to columns and back has the same bytes again.

    Example: workhold convert part.npz part.json
    """
    form = choose_output_form(out, format_)
    refuse_both(json_, out)
    if out != STANDARD_OUTPUT:
        refuse_result_file(out, form, (result_file,), force)

    from workhold.files.result.reader import read_result

    result = read_result(result_file)
    write_output(result, out, form)
    if out != STANDARD_OUTPUT:
        print_written(json_, f"{format_count(len(result), 'fixture')} written to {out}.", out)


REFUTED = 2


@frozen
class VerifyTask:
    """A file to verify.

    Parameters
    ----------
    of_supports : whether the file lists supports instead of fixtures.
    listed : number of unproven entries that are listed on the terminal.
    part : STEP file of the part; None where none is given.
    complete, threads : whether a new search looks for fixtures missing from the file, and its number of
        threads.
    """

    path: str
    of_supports: bool
    listed: int
    complete: bool
    part: str | None
    threads: int | None
    as_json: bool


@frozen
class VerifyAnswer:
    """Outcome of a verification, the time it took in words, and sentences on what was not checked."""

    outcome: Verification
    spent: str
    scope: Sequence[str] = ()


def verify(
    result_file: ResultArgument,
    list_: str = make_option(
        None, "N", "Number of fixtures to list on the terminal that are not proven.", "--list", default="5"
    ),
    complete: bool = make_flag(
        None,
        "Also search again, and compare the fixtures, their number, and the account of the search.",
        "--complete",
    ),
    part: str | None = make_option(
        None,
        "FILE",
        "The STEP file that the result was designed from, to compute again how far fixtures bend the part.",
        "--part",
    ),
    threads: str | None = make_option(
        None, "N", "Threads of that search; as many as processors if not given."
    ),
    json_: bool = JSON,
) -> None:
    """Prove or refute every fixture of a result, and every number written with it.

    The command derives each fixture again from the workpiece, the toolkit, the pegs and the faces alone, in
    arithmetic that bounds its rounding errors. It uses nothing of the search. It can decide coincidences,
    such as an opening of exactly the smallest gap, because the limit of every rule is set 1e-9 mm away from
    them. A case exactly at such a limit is undecided. A file alone cannot show, for example, that no fixture
    was left out; --complete checks this with a new search of the file's query. The exit code is 0 if nothing
    is refuted, and 2 otherwise.

    Example: workhold verify part.json
    """
    asked = parse(result_file, list_, complete, part, threads, json_)
    report(asked, run_verification(asked))


def parse(
    path: str, list_: str, complete: bool, part: str | None, threads: str | None, as_json: bool
) -> VerifyTask:
    """Return what was typed as a task."""
    listed, workers = read_whole_number("--list", list_), read_optional_count("--threads", threads)
    from workhold.verification.supports import is_supports_file

    of_supports = is_supports_file(path)
    if of_supports and complete:
        raise InputError(
            "--complete searches for fixtures again, and this file lists supports: leave it out."
        )
    return VerifyTask(path, of_supports, listed, complete, part, workers, as_json)


def run_verification(asked: VerifyTask) -> VerifyAnswer:
    """Return the verification of everything in the file, compared with a new search if that was asked for."""
    from workhold.completeness import read_kept_shape
    from workhold.verification.listing import read_listing
    from workhold.verification.supports import verify_supports_file
    from workhold.verification.verify import verify_listing

    start = perf_counter()
    if asked.of_supports:
        return VerifyAnswer(verify_supports_file(asked.path), f"{perf_counter() - start:.1f} s")
    listing = read_listing(asked.path)
    with show_progress("Verifying", "not proven") as progress:
        outcome = verify_listing(listing, progress, read_kept_shape(asked.part, listing))
    if asked.complete:
        outcome = compare_with_search(outcome, listing, asked.threads)
    spent = f"{perf_counter() - start:.1f} s"
    return VerifyAnswer(outcome, spent, describe_verified_scope(outcome, asked.complete, listing))


def report(asked: VerifyTask, answer: VerifyAnswer) -> None:
    """Print what is not proven.

    Exits with REFUTED where something is refuted, INTERRUPTED where a comparison asked for is missing.
    """
    outcome = answer.outcome
    if asked.as_json:
        from workhold.presenting.data import describe_verification

        print_json(**describe_verification(outcome))
    else:
        unproven, tally = explain_unproven(outcome, asked.listed), summarize_verification(outcome)
        if asked.of_supports:
            unproven = [sentence.replace("Fixture", "Triple", 1) for sentence in unproven]
            of_all = f"{format_count(outcome.fixtures, 'triple')} of supports"
            tally = f"{of_all}: {outcome.proven} proven, {outcome.refuted} refuted"
        print_tables(*unproven, f"{tally}; {answer.spent}", *answer.scope)
    if asked.complete and not outcome.is_compared:
        raise typer.Exit(INTERRUPTED)
    if not outcome.holds:
        raise typer.Exit(REFUTED)


def compare_with_search(outcome: Verification, listing: WrittenListing, workers: int | None) -> Verification:
    """Return the verification with the comparison of the file with a new search of its query.

    After Ctrl-C the verification is returned unchanged.
    """
    from workhold.cli.warming import compile_kernels
    from workhold.completeness import complete_verification

    with set_event_on_interrupt("nothing is compared") as cancel:
        compile_kernels(cancel)
        with show_search_progress() as progress:
            return complete_verification(outcome, listing, threads=workers, progress=progress, cancel=cancel)


def describe_verified_scope(outcome: Verification, asked: bool, listing: WrittenListing) -> list[str]:
    """Return sentences on the comparison that was made, or on what a file alone cannot show."""
    from workhold.verification.verify import list_not_shown

    if outcome.is_compared:
        return [*outcome.unchecked, "A search of the same query was compared with the file."]
    if asked:
        return [*outcome.unchecked, "The search was interrupted, so nothing was compared."]
    points = list_not_shown(listing.query.toolkit, listing.query.seating is not None)
    return [
        *outcome.unchecked,
        "A file alone cannot show this; --complete checks it:",
        *(f"  - {point}" for point in points),
    ]


def summarize_verification(outcome: Verification) -> str:
    """Return a sentence with the numbers of fixtures proven, refuted and undecided."""
    return (
        f"{format_count(outcome.fixtures, 'fixture')}: {outcome.proven} proven, {outcome.refuted} refuted, "
        f"{outcome.undecided} undecided at {outcome.bits} bits"
    )


def explain_unproven(outcome: Verification, count: int) -> list[str]:
    """Return a sentence for each fault of the file and for the
    first ``count`` fixtures not proven, refuted ones first.
    """
    sentences = [f"The file: {fault}." for fault in outcome.faults]
    unproven = sorted(outcome.unproven, key=lambda fixture: fixture.verdict != "refuted")
    for fixture in unproven[: max(count, 0)]:
        sentences.append(f"Fixture {fixture.index + 1} is {fixture.verdict}: {fixture.reason}.")
    return sentences
