"""The verification of a whole result."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from attrs import frozen

from workhold.model.result import Result
from workhold.verification.asked import broken_restriction
from workhold.verification.balls import PRECISIONS
from workhold.verification.fixture_proof import Judge, Verdict
from workhold.verification.listing import KINDS, Listing, listing_of, read_listing
from workhold.verification.order import order_faults
from workhold.verification.repeats import Seen

__all__ = ["Unproven", "Verification", "verify", "verify_file", "verify_listing"]

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
    """

    proven: int
    refuted: int
    undecided: int
    unproven: tuple[Unproven, ...]
    faults: tuple[str, ...]
    bits: int

    @property
    def fixtures(self) -> int:
        """How many fixtures were looked at."""
        return self.proven + self.refuted + self.undecided

    @property
    def holds(self) -> bool:
        """Whether nothing is refuted."""
        return not self.refuted and not self.faults


def no_progress(fraction: float, unproven: int) -> None:
    """Tell nobody."""


def verify(result: Result, progress: Progress = no_progress) -> Verification:
    """Derive every fixture of a result again, in ball arithmetic, from workpiece, vise, pegs and faces alone.

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
        When the file cannot be read, is no result file, or describes no usable workpiece or vise.
    """
    return verify_listing(read_listing(path), progress)


def verify_listing(listing: Listing, progress: Progress = no_progress) -> Verification:
    """Verify what a result claims."""
    judge = Judge(listing.workpiece, listing.vise, listing.contact_margin, listing.asked)
    everything = listing.fixtures
    seen = Seen()
    rulings: list[tuple[Verdict, str]] = []
    bits, doubtful = PRECISIONS[0], 0
    for place, fixture in enumerate(everything):
        ruling = judge.rule_on(fixture)
        verdict, reason = ruling.verdict, ruling.reason
        bits = max(bits, ruling.bits)
        if verdict != "refuted":
            broken = broken_restriction(fixture, listing.workpiece, listing.vise, listing.asked.restrictions)
            verdict, reason = ("refuted", broken) if broken else (verdict, reason)
        first = None if verdict == "refuted" else seen.add(place, fixture)
        if first is not None:
            verdict, reason = "refuted", f"it is the same as fixture {first + 1}"
        rulings.append((verdict, reason))
        doubtful += verdict != "proven"
        progress((place + 1) / len(everything), doubtful)
    unproven = [
        Unproven(place, verdict, reason) for place, (verdict, reason) in enumerate(rulings) if verdict != "proven"
    ]
    tally = {name: sum(verdict == name for verdict, _ in rulings) for name in ("proven", "refuted", "undecided")}
    order = order_faults(listing.fixtures, listing.asked.ranking)
    faults = (*listing.faults, *count_faults(listing), *order)
    return Verification(tally["proven"], tally["refuted"], tally["undecided"], tuple(unproven), faults, bits)


def count_faults(listing: Listing) -> Iterator[str]:
    """Counts of the file that contradict what it lists, or each other."""
    for kind in KINDS:
        listed = sum(fixture.type == kind for fixture in listing.fixtures)
        counts, found, distinct = listing.counts[kind], listing.found[kind], listing.distinct[kind]
        if counts != listed:
            yield f"counts say {counts} fixtures of type {kind}, but {listed} are listed"
        if found < listed:
            yield f"found says {found} fixtures of type {kind}, but {listed} are listed"
        if not (distinct <= found and (distinct > 0) == (found > 0)):
            yield f"distinct says {distinct} fixtures of type {kind}, which {found} cannot form"
