"""Verification of a result, and the search of its query once more, for what a file alone cannot show.

This module stands above both the verification and the engines, which share nothing. Two fixtures are the
same where the verification says so (``verification.repeats``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from pathlib import Path
from threading import Event
from typing import Any

from attrs import astuple, evolve, fields

from workhold.fixels.carrier import Carrier
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.notes import KeptBest
from workhold.model.result import Result
from workhold.model.search_report import Proof, Undecided
from workhold.model.straps import StrappedHold
from workhold.verification.account import is_by_algebra
from workhold.verification.listing import Listing, collect_claims, read_listing
from workhold.verification.repeats import KnownFixtures
from workhold.verification.verify import Verification, ignore_progress, verify_listing

__all__ = ["complete_verification", "verify"]

Progress = Callable[[float, int], None]

# Degrees. Orientations of undecided entries that agree to this are the same.
SAME_ORIENTATION = 1e-6
# mm or degrees. Numbers of a seating that agree to this are the same.
SAME_SEATING = 1e-6
# A part of a force by which the best straps found anew may need another.
SAME_NEED = 1e-3


def verify(
    source: Result | str | Path,
    *,
    complete: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
    cancel: Event | None = None,
) -> Verification:
    """Prove or refute every fixture of a result or a result file, and every number written with it.

    Parameters
    ----------
    source : the result, or the path of its file.
    complete : also answer the query again, and compare which fixtures there are, how many, and the account of
        the search.
    threads, cancel : of that search, see :func:`workhold.answer`; when it is cancelled, nothing is compared.
    progress : called as ``progress(fraction done, count)``: of fixtures not proven, then of fixtures found.

    Raises
    ------
    InputError
        When a file cannot be read, is no result file, or describes no usable workpiece or toolkit.

    Examples
    --------
    >>> import workhold
    >>> wedge = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
    >>> result = workhold.design(wedge, workhold.Vise(pitch=15, columns=1, peg_radius=2))
    >>> outcome = workhold.verify(result, complete=True)
    >>> outcome.holds, outcome.is_compared
    (True, True)
    """
    report = ignore_progress if progress is None else progress
    listing = collect_claims(source) if isinstance(source, Result) else read_listing(source)
    if not complete:
        return verify_listing(listing, report)
    outcome = verify_listing(listing, lambda fraction, count: report(fraction / 2, count))
    return complete_verification(
        outcome,
        listing,
        threads=threads,
        cancel=cancel,
        progress=lambda done, count: report((1 + done) / 2, count),
    )


def complete_verification(
    outcome: Verification, listing: Listing, *, threads: int | None = None, **watching: Any
) -> Verification:
    """Return a verification with the faults that a new search of the listing's query finds.

    When the search is cancelled, the verification is returned unchanged.

    Parameters
    ----------
    watching : ``progress`` and ``cancel``, see :func:`workhold.answer`.
    """
    # The best of a part of the fixtures need not be among the best of all.
    query = listing.query if listing.complete else evolve(listing.query, best=None)
    if is_by_algebra(listing.statistics):
        from workhold.algebra.engine import find_fixtures_by_algebra
        from workhold.search.seated import answer_with_seating

        result = answer_with_seating(query, find_fixtures_by_algebra, **watching)
    else:
        from workhold.search.design import answer

        result = answer(query, threads=threads, **watching)
    if not result.complete:
        return outcome
    return evolve(outcome, faults=(*outcome.faults, *find_differences(listing, result)), is_compared=True)


def find_differences(listing: Listing, result: Result) -> Iterator[str]:
    """Yield the differences between a listing and a new search of its query, one sentence each, without a
    full stop.

    A listing that says it is incomplete may lack fixtures, and its account is that of a part of the work.
    """
    if listing.query.toolkit.strap_set is not None:
        yield from seat_differences(listing, result)
        return
    if listing.query.toolkit.flat_jaws is not None:
        yield from hold_differences(listing, result)
        return
    seen = KnownFixtures(listing.hardware)
    for index, fixture in enumerate(listing.fixtures):
        seen.add(index, fixture)
    listed, found = len(listing.fixtures), sum(listing.found.values())
    # A server may have kept a part: the best of what had been found.
    best_kept = listing.complete and KeptBest(found, listed) in listing.notes
    expected = islice(result, listed) if best_kept else result
    matches = [(fixture, seen.find(fixture)) for fixture in expected]
    surplus = sorted(set(range(listed)) - {match for _, match in matches})
    if surplus:
        yield (
            f"a search does not find {format_count(len(surplus))} of it, the first of them fixture "
            f"{surplus[0] + 1}"
        )
    if not listing.complete:
        for kind, number in result.found.items():
            if listing.found[kind] > number:
                yield f"found says {listing.found[kind]} for {kind}, and there are {number} in all"
        return
    missing = [fixture for fixture, match in matches if match is None and not listing.is_chosen]
    if missing:
        yield (
            f"a search finds {format_count(len(missing))} that it does not list, the first of them "
            f"{describe_fixture(missing[0])}"
        )
    for name in ("found", "distinct"):
        yield from find_other_numbers(name, getattr(listing, name), getattr(result, name))
    for name in ("pairs", "seats"):
        if getattr(listing, name) != getattr(result, name):
            yield f"{name} says {getattr(listing, name)}, and a search comes to {getattr(result, name)}"
    if listing.proof is not None and result.proof is not None:
        yield from find_other_numbers(
            "the proof", list_proof_numbers(listing.proof), list_proof_numbers(result.proof)
        )
        yield from find_other_entries(listing.proof, result.proof)
    yield from find_other_numbers("the statistics", listing.statistics, result.statistics)
    for fixture, match in matches:
        claim = None if match is None else listing.fixtures[match].seating
        if claim is not None and fixture.seating is not None:
            other = find_first_difference(claim.fields, fixture.seating.as_fields())
            if other:
                yield f"a search finds another {other} of the seating of fixture {(match or 0) + 1}"
                break
    lacking = [note for note in result.notes if note not in listing.notes]
    if lacking:
        yield f'the note is missing that says "{lacking[0]}"'


def hold_differences(listing: Listing, result: Result) -> Iterator[str]:
    """Yield the same of what flat jaws hold, which angle, parallels and stop distinguish."""
    listed, found = count_fixture_keys(listing.fixtures), count_fixture_keys(result)
    surplus, missing = sorted(listed[key] for key in listed.keys() - found), found.keys() - listed.keys()
    if surplus:
        yield f"a search does not find {format_count(len(surplus))} of it, the first of them fixture {surplus[0] + 1}"
    if missing and listing.complete and not listing.is_chosen and listing.query.best is None:
        theta, parallels, stop = min(missing, key=str)
        at = f", stop {stop}" if stop else ""
        yield (
            f"a search finds {format_count(len(missing))} that it does not list, "
            f"the first of them at {theta:.4f} degrees on "
            f"parallels of {parallels:g} mm{at}"
        )
    if listing.complete:
        for name in ("found", "distinct"):
            yield from find_other_numbers(name, getattr(listing, name), getattr(result, name))


def seat_differences(listing: Listing, result: Result) -> Iterator[str]:
    """The differences between seats under straps and a new search of their query, as :func:`differences`."""
    plate = listing.query.toolkit.plates[0]
    mine, theirs = ({seat_key(one, plate): one for one in some} for some in (result, listing.fixtures))
    is_cut = len(listing.fixtures) < sum(listing.found.values())
    for key, one in mine.items():
        if key not in theirs:
            if listing.complete and not is_cut:
                yield f"the seat {' '.join(peg.hole for peg in one.pegs)} at {key[0]:g} degrees is missing"
            continue
        hold, written = one.hold, theirs[key].hold
        if isinstance(hold, StrappedHold) and isinstance(written, StrappedHold):
            need, said = hold.clamp_needed, written.clamp_needed
            if (need is None) != (said is None) or (need and said and abs(need - said) > SAME_NEED * need):
                yield (
                    f"the best straps at {' '.join(peg.hole for peg in one.pegs)} need "
                    f"{'no force that holds' if need is None else f'{need:.6g} N'}, not what is written"
                )
    for key, one in theirs.items():
        if key not in mine and not is_cut:
            yield f"the seat {' '.join(peg.hole for peg in one.pegs)} at {key[0]:g} degrees is not found anew"
    if listing.complete:
        for name in ("found", "distinct"):
            yield from find_other_numbers(name, getattr(listing, name), getattr(result, name))


def seat_key(fixture: Fixture, plate: Carrier) -> tuple[float, tuple[int, ...], float, float]:
    """What distinguishes a seat wherever it stands on its plate: angle, holes, and the part's place beside them."""
    column, row = (min(getattr(peg, name) for peg in fixture.pegs) for name in ("column", "row"))
    holes = sorted((peg.column - column, peg.row - row) for peg in fixture.pegs)
    x, y = plate.place(column, row)
    place = round(fixture.pose.x - x, 4) + 0.0, round(fixture.pose.y - y, 4) + 0.0
    return round(fixture.pose.theta_deg, 4) % 360, tuple(v for hole in holes for v in hole), *place


def count_fixture_keys(fixtures: Iterable[Fixture]) -> dict[tuple[float, float, str | None], int]:
    """Return the places of fixtures of flat jaws by what distinguishes them."""
    return {
        (round(one.pose.theta_deg, 4) % 360, round(one.hold.parallels, 6), one.hold.stop): place
        for place, one in enumerate(fixtures)
        if isinstance(one.hold, JawHold)
    }


def find_first_difference(written: Any, derived: Any, key: str = "") -> str:
    """Return the key of the first value that differs by more than ``SAME_SEATING``; empty where all agree."""
    if isinstance(derived, dict):
        pairs = [(key or name, written.get(name), value) for name, value in derived.items()]
        return next((other for name, a, b in pairs if (other := find_first_difference(a, b, name))), "")
    if isinstance(derived, list) and isinstance(written, list) and len(written) == len(derived):
        return next(
            (
                other
                for a, b in zip(written, derived, strict=True)
                if (other := find_first_difference(a, b, key))
            ),
            "",
        )
    if isinstance(derived, float) and isinstance(written, float | int):
        return "" if abs(written - derived) <= SAME_SEATING else key
    return "" if written == derived else key


def format_count(number: int) -> str:
    return f"{number} fixture{'s' * (number != 1)}"


def describe_fixture(fixture: Fixture) -> str:
    holes = ", ".join(peg.hole for peg in fixture.pegs)
    direction = "" if fixture.direction is None else f" {fixture.direction}"
    return f"of type {fixture.type}{direction} in {holes} at {fixture.pose.theta_deg:.6f} degrees"


def list_proof_numbers(proof: Proof) -> dict[str, int]:
    names = (attribute.name for attribute in fields(Proof) if attribute.name != "undecided")
    return {name: getattr(proof, name) for name in names}


def find_other_numbers(name: str, written: Any, derived: Any) -> Iterator[str]:
    """Yield a fault for each number for which a search comes to another one."""
    for key, number in derived.items():
        if written.get(key) != number:
            yield f"{name} says {written.get(key)} for {key}, and a search comes to {number}"


def find_other_entries(written: Proof, derived: Proof) -> Iterator[str]:
    """Yield a fault when other candidates are undecided in a search."""

    def key(entry: Undecided) -> tuple[Any, ...]:
        *whole, theta, reason, _ = astuple(entry)
        return *whole, round(theta / SAME_ORIENTATION) % round(360 / SAME_ORIENTATION), reason

    one, other = ({key(entry) for entry in proof.undecided} for proof in (written, derived))
    if one != other:
        yield (
            f"the proof names {len(one - other)} undecided candidates that a search decides, and lacks "
            f"{len(other - one)}"
        )
