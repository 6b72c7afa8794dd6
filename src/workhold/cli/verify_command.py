"""``workhold verify``: proof or refutation of every fixture of a result file."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from workhold.cli.progress import progress_bar
from workhold.cli.values import whole_number

if TYPE_CHECKING:
    from workhold.verification import Verification

__all__ = ["verify"]

REFUTED = 2


def verify(
    result_file: Annotated[
        str, typer.Argument(metavar="RESULT", help="A result file (JSON) written by workhold design.")
    ],
    list_: Annotated[
        str,
        typer.Option("--list", metavar="N", help="How many fixtures that are not proven to list on the terminal."),
    ] = "5",
) -> None:
    """Prove or refute every fixture of a result, and every number written with it.

    Each fixture is derived again from workpiece, vise, pegs and faces alone, in arithmetic whose rounding errors are
    bounded, with nothing of the search. Coincidences such as a jaw separation of just the smallest gap are decided: the
    edge of every rule stands 1e-9 mm off them. What lies exactly on such an edge is undecided. The exit code is 0 when
    nothing is refuted and 2 otherwise.

    Example: workhold verify part.json
    """
    listed = whole_number("--list", list_)

    from workhold.cli.tables import print_tables
    from workhold.verification import verify_file

    start = perf_counter()
    with progress_bar("Verifying", "not proven") as progress:
        outcome = verify_file(result_file, progress)
    seconds = perf_counter() - start
    print_tables(*unproven_sentences(outcome, listed), f"{summary(outcome)}; {seconds:.1f} s")
    if not outcome.holds:
        raise typer.Exit(REFUTED)


def summary(outcome: Verification) -> str:
    """How many fixtures are proven, refuted and undecided."""
    from workhold.cli.tables import plural

    return (
        f"{plural(outcome.fixtures, 'fixture')}: {outcome.proven} proven, {outcome.refuted} refuted, "
        f"{outcome.undecided} undecided at {outcome.bits} bits"
    )


def unproven_sentences(outcome: Verification, count: int) -> list[str]:
    """What is wrong with the file, and with the first fixtures that are not proven, the refuted ones first."""
    sentences = [f"The file: {fault}." for fault in outcome.faults]
    unproven = sorted(outcome.unproven, key=lambda fixture: fixture.verdict != "refuted")
    for fixture in unproven[: max(count, 0)]:
        sentences.append(f"Fixture {fixture.index + 1} is {fixture.verdict}: {fixture.reason}.")
    return sentences
