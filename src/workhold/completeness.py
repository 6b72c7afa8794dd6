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

from workhold.errors import InputError
from workhold.files.part.finding import read_bytes
from workhold.fixels.carrier import Carrier
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.notes import KeptBest
from workhold.model.result import Result
from workhold.model.search_report import ProofReport, UndecidedCandidate
from workhold.model.straps import StrappedHold
from workhold.verification.account import is_by_algebra
from workhold.verification.listing import WrittenListing, collect_claims, read_listing
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
    part: str | Path | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    cancel: Event | None = None,
) -> Verification:
    """Prove or refute every fixture of a result or a result file, and every number written with it.

    Parameters
    ----------
    source : the result, or the path of its file.
    complete : also answer the query again, and compare the fixtures, their number, and the account of the
        search.
    part : the STEP file that the part was read from, with which it is computed again how far fixtures bend it.
    threads, cancel : for this second search, see :func:`workhold.answer`; when it is cancelled, nothing is
        compared.
    progress : called as ``progress(fraction done, count)``. The count is that of fixtures not proven, and
        during the second search that of fixtures found.

    Raises
    ------
    InputError
        When a file cannot be read, is not a result file, or describes no usable workpiece or toolkit.

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
    kept = read_kept_shape(part, listing)
    if not complete:
        return verify_listing(listing, report, kept)
    outcome = verify_listing(listing, lambda fraction, count: report(fraction / 2, count), kept)
    return complete_verification(
        outcome,
        listing,
        threads=threads,
        cancel=cancel,
        progress=lambda done, count: report((1 + done) / 2, count),
    )


def read_kept_shape(part: str | Path | None, listing: WrittenListing) -> str | None:
    """Return the part's solid from its STEP file, in Open CASCADE's own form; None without a file.

    Raises InputError when the file cannot be read, or holds another part.
    """
    if part is None:
        return None
    from workhold.files.step.part_shape import make_part_shape

    path = Path(part)
    try:
        return make_part_shape(read_bytes(path), listing.query.workpiece).kept
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from error


def complete_verification(
    outcome: Verification, listing: WrittenListing, *, threads: int | None = None, **watching: Any
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


def find_differences(listing: WrittenListing, result: Result) -> Iterator[str]:
    """Yield the differences between a listing and a new search
    of its query, one sentence each, without a full stop.

    In a listing that says it is incomplete, missing fixtures and too small counts are not differences.
    """
    if listing.query.toolkit.strap_set is not None:
        yield from find_seat_differences(listing, result)
        return
    if listing.query.toolkit.flat_jaws is not None:
        yield from find_hold_differences(listing, result)
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
            other = find_first_difference(claim.fields, fixture.seating.to_fields())
            if other:
                yield f"a search finds another {other} of the seating of fixture {(match or 0) + 1}"
                break
    lacking = [note for note in result.notes if note not in listing.notes]
    if lacking:
        yield f'the note is missing that says "{lacking[0]}"'


def find_hold_differences(listing: WrittenListing, result: Result) -> Iterator[str]:
    """Yield the differences that :func:`find_differences` yields, for fixtures of flat jaws.

    Two such fixtures are the same when angle, parallels and stop agree.
    """
    listed, found = index_fixtures_by_key(listing.fixtures), index_fixtures_by_key(result)
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


def find_seat_differences(listing: WrittenListing, result: Result) -> Iterator[str]:
    """Yield the differences that :func:`find_differences` yields, for seats under strap clamps.

    Seats are matched by :func:`make_seat_key`. The clamping force that the best straps of each seat need is
    compared, too.
    """
    plate = listing.query.toolkit.plates[0]
    mine, theirs = ({make_seat_key(one, plate): one for one in some} for some in (result, listing.fixtures))
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


def make_seat_key(fixture: Fixture, plate: Carrier) -> tuple[float, tuple[int, ...], float, float]:
    """Return a key that is equal for two seats that differ only by a
    movement along the plate by whole pitches.

    The key has the angle in degrees in [0, 360); the holes of the pegs as (column, row), flattened into one
    tuple; and x and y in mm of the part's pose. Columns and rows count from the least column and the least
    row used, x and y from the centre of the hole there.
    """
    column, row = (min(getattr(peg, name) for peg in fixture.pegs) for name in ("column", "row"))
    holes = sorted((peg.column - column, peg.row - row) for peg in fixture.pegs)
    x, y = plate.compute_hole_center(column, row)
    place = round(fixture.pose.x - x, 4) + 0.0, round(fixture.pose.y - y, 4) + 0.0
    return round(fixture.pose.theta_deg, 4) % 360, tuple(v for hole in holes for v in hole), *place


def index_fixtures_by_key(fixtures: Iterable[Fixture]) -> dict[tuple[float, float, str | None], int]:
    """Return the index of each flat-jaw fixture in ``fixtures`` by its key
    (angle in degrees, parallels in mm, stop).

    If several fixtures have the same key, the index is that of the last one. Fixtures with other holds are
    skipped, but counted in the index.
    """
    return {
        (round(one.pose.theta_deg, 4) % 360, round(one.hold.parallels, 6), one.hold.stop): place
        for place, one in enumerate(fixtures)
        if isinstance(one.hold, JawHold)
    }


def find_first_difference(written: Any, derived: Any, key: str = "") -> str:
    """Return the outermost key under which a value of ``derived`` differs from that of ``written``, or is
    missing there; "" for no difference.

    Parameters
    ----------
    written, derived : nested dicts and lists of values; numbers that differ by at most ``SAME_SEATING``
        agree, and keys that only ``written`` has are ignored.
    key : key under which these values were found, for recursive calls; "" at the outermost level.
    """
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
    """Return a count of fixtures in words: "1 fixture", "2 fixtures"."""
    return f"{number} fixture{'s' * (number != 1)}"


def describe_fixture(fixture: Fixture) -> str:
    """Return the type, the direction, the holes and the angle of a fixture in
    words that can follow "the first of them".
    """
    holes = ", ".join(peg.hole for peg in fixture.pegs)
    direction = "" if fixture.direction is None else f" {fixture.direction}"
    return f"of type {fixture.type}{direction} in {holes} at {fixture.pose.theta_deg:.6f} degrees"


def list_proof_numbers(proof: ProofReport) -> dict[str, int]:
    """Return the numbers of a proof report by field name: all fields except ``undecided``."""
    names = (attribute.name for attribute in fields(ProofReport) if attribute.name != "undecided")
    return {name: getattr(proof, name) for name in names}


def find_other_numbers(name: str, written: Any, derived: Any) -> Iterator[str]:
    """Yield a sentence for each key of ``derived`` under which ``written`` has another number or none.

    ``name`` is what the sentence calls the mapping.
    """
    for key, number in derived.items():
        if written.get(key) != number:
            yield f"{name} says {written.get(key)} for {key}, and a search comes to {number}"


def find_other_entries(written: ProofReport, derived: ProofReport) -> Iterator[str]:
    """Yield one sentence if the undecided candidates of two proofs differ, otherwise nothing.

    Two candidates are the same when all fields except the last agree; orientations agree if they differ by
    less than about ``SAME_ORIENTATION``.
    """

    def make_key(entry: UndecidedCandidate) -> tuple[Any, ...]:
        """Return all fields of an entry except the last, with the orientation as a whole number of steps of
        ``SAME_ORIENTATION``.
        """
        *whole, theta, reason, _ = astuple(entry)
        return *whole, round(theta / SAME_ORIENTATION) % round(360 / SAME_ORIENTATION), reason

    one, other = ({make_key(entry) for entry in proof.undecided} for proof in (written, derived))
    if one != other:
        yield (
            f"the proof names {len(one - other)} undecided candidates that a search decides, and lacks "
            f"{len(other - one)}"
        )
