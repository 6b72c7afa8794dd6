"""The verification of a whole result."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from attrs import frozen

from workhold.fixels.toolkit import Toolkit
from workhold.model.result import Result
from workhold.verification.account import account_faults, seat_faults
from workhold.verification.balls import PRECISIONS
from workhold.verification.figures import figure_missing
from workhold.verification.fixture_proof import Judge, Verdict
from workhold.verification.listing import Listing, listing_of, read_listing
from workhold.verification.order import order_faults
from workhold.verification.patterns import pattern_faults
from workhold.verification.repeats import Seen, Turning
from workhold.verification.restrictions import broken_restriction
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.seating import SeatingJudge

__all__ = ["Unproven", "Verification", "no_progress", "not_shown", "verify", "verify_file", "verify_listing"]

# What a result in any toolkit alone cannot show, beside what ``not_shown`` says.
NOT_SHOWN = (
    "how many candidates there were and what became of each, beyond what must add up, and which others are undecided",
    "how much work the search was: its cells and statistics, beyond their order",
    "whether a search that says it was interrupted was",
)

# Called with the fraction done and the number of fixtures not proven so far.
Progress = Callable[[float, int], None]


@frozen
class Unproven:
    """A fixture that is not proven.

    Parameters
    ----------
    index : its place in the list, from 0.
    verdict : "refuted" or "undecided".
    reason : one sentence, without a full stop.
    """

    index: int
    verdict: Verdict
    reason: str


@frozen
class Verification:
    """What is shown of a result.

    Parameters
    ----------
    proven, refuted, undecided : numbers of fixtures.
    unproven : those that are not proven, in the order of the file.
    faults : what is wrong with the result as a whole, one sentence each, without a full stop.
    bits : the highest precision that was needed.
    is_compared : whether the query was answered again, and the result compared with that.
    """

    proven: int
    refuted: int
    undecided: int
    unproven: tuple[Unproven, ...]
    faults: tuple[str, ...]
    bits: int
    is_compared: bool = False

    @property
    def fixtures(self) -> int:
        """How many fixtures were looked at."""
        return self.proven + self.refuted + self.undecided

    @property
    def holds(self) -> bool:
        """Whether nothing is refuted."""
        return not self.refuted and not self.faults


def not_shown(toolkit: Toolkit, is_seated: bool = False) -> Iterator[str]:
    """What a result in a toolkit, perhaps with seating, alone cannot show; answering its query again does."""
    left_out = "seats" if toolkit.needs_pairs else "fixtures"
    yield f"whether {left_out} were left out, with all counts adjusted"
    yield f"whether the query was wider: what is listed also meets one with {ToolkitRules(toolkit).wider_words}"
    if is_seated:
        yield "whether a fixture has further seats, or a lower pass, and how far its way out, cage, placing and depths go"
    yield from NOT_SHOWN


def no_progress(fraction: float, unproven: int) -> None:
    """Report nothing."""


def verify(result: Result, progress: Progress = no_progress) -> Verification:
    """Derive every fixture of a result again, in ball arithmetic, from workpiece, toolkit, pegs and faces alone.

    Examples
    --------
    >>> from workhold import Vise, Workpiece, design
    >>> from workhold.verification import verify
    >>> wedge = Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
    >>> outcome = verify(design(wedge, Vise(pitch=15, columns=1, peg_radius=2)))
    >>> outcome.proven == outcome.fixtures, outcome.holds
    (True, True)
    """
    return verify_listing(listing_of(result), progress)


def verify_file(path: str | Path, progress: Progress = no_progress) -> Verification:
    """Derive every fixture of a result file again, as :func:`verify` does, and compare every number written with it.

    Raises
    ------
    InputError
        When the file cannot be read, is no result file, or describes no usable workpiece or toolkit.
    """
    return verify_listing(read_listing(path), progress)


def verify_listing(listing: Listing, progress: Progress = no_progress) -> Verification:
    """Verify what a result claims."""
    query, everything = listing.query, listing.fixtures
    judge, seating = Judge(query), SeatingJudge(query)
    turning = Turning.of(query.workpiece)
    seen = Seen.of(turning, judge.hardware)
    rulings: list[tuple[Verdict, str]] = []
    bits, doubtful = PRECISIONS[0], 0
    for place, fixture in enumerate(everything):
        ruling = judge.rule_on(fixture)
        verdict, reason = ruling.verdict, ruling.reason
        bits = max(bits, ruling.bits)
        if verdict != "refuted":
            broken = broken_restriction(fixture, query, judge.hardware)
            broken = broken or figure_missing(fixture, query.loads) or seating.fault(fixture)
            verdict, reason = ("refuted", broken) if broken else (verdict, reason)
        first = None if verdict == "refuted" else seen.add(place, fixture)
        if first is not None:
            verdict, reason = "refuted", f"{judge.hardware.same_words} fixture {first + 1}"
        rulings.append((verdict, reason))
        doubtful += verdict != "proven"
        progress((place + 1) / len(everything), doubtful)
    unproven = [
        Unproven(place, verdict, reason) for place, (verdict, reason) in enumerate(rulings) if verdict != "proven"
    ]
    tally = {name: sum(verdict == name for verdict, _ in rulings) for name in ("proven", "refuted", "undecided")}
    faults = [
        *listing.faults,
        *account_faults(listing, turning.order),
        *order_faults(everything, query, judge.hardware),
    ]
    faults += pattern_faults(everything, query)
    faults += seat_faults(listing, {place for place, (verdict, _) in enumerate(rulings) if verdict == "refuted"})
    if not tally["refuted"] and turning.is_certain:
        faults += distinct_faults(listing, seen)
    return Verification(tally["proven"], tally["refuted"], tally["undecided"], tuple(unproven), tuple(faults), bits)


def distinct_faults(listing: Listing, seen: Seen) -> Iterator[str]:
    """Numbers of distinct fixtures that are not those of the fixtures listed, or cannot be where more are found: each of
    those that are not listed makes a set of its own, or belongs to one."""
    for kind, counts in listing.counts.items():
        sets, distinct, others = seen.sets.get(kind, 0), listing.distinct[kind], listing.found[kind] - counts
        if others > 0 and not sets <= distinct <= sets + others:
            yield (
                f"distinct says {distinct} fixtures of type {kind}, but those listed form {sets}, "
                f"and {others} more are found"
            )
        elif others == 0 and distinct != sets:
            yield f"distinct says {distinct} fixtures of type {kind}, but those listed form {sets}"
