"""Checks that the numbers a result gives about itself agree with each other and with its list.

The identities, which hold for each type separately if a number is given for each type:

- counts = fixtures listed; counts <= found; 0 < distinct where 0 < found; distinct <= found <= distinct *
  rotations of the part onto itself.
- If more are found than listed, the query asks for that number of best ones, or a note says that some were
  not kept. No more are listed than the query asks for.
- All fixtures found have a type that the query asks for.
- candidates = discarded_by_bound + verified + undecided; escalated <= candidates, and escalated > 0 where
  undecided > 0.
- found <= verified, since every fixture comes from a different candidate.
- Every undecided entry is a possible place (``verification.undecided``).
- A search has crossings_sought <= curve_pairs. A complete one has cells, and contacts_examined <= candidates.
- The algebra has no cells. Once it is complete candidates <= simultaneous_contacts.
- Beside a wall cells = hull_edges, candidates = contacts_examined.
- features >= faces touched.
- With two clamps and a note that not all was counted, pairs and seats are not given, and found = listed.
- Otherwise, with two clamps and the best pair of each seat listed, found = seats. Where all are listed, pairs
  = the sum of the numbers of pairs that the listed fixtures stand for.
- With two clamps and every pair listed, found = pairs, and seats = the number of seats among the listed
  fixtures. Once the search is complete each seat has as many pairs as are derived.
- Each seat and pair of directions needs two contacts of locators, or wall and locator, and a clamp. Each pair
  of clamps needs two contacts of its own.
- Where seating rules fixtures out, a note says how many of how many are listed, and each of these has its
  seating stated. Without such rules as many have it as were asked for.
- The notes are those that follow from these numbers.

Whatever else became of the candidates, and how much work it was, only the search knows.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping

from flint import ctx

from workhold.fixels.contacts import WALL_END
from workhold.model.notes import (
    STAGES,
    AskedFor,
    BestOnly,
    ChosenOnly,
    Cut,
    FittedOutline,
    KeptBest,
    LeftUndecided,
    Many,
    MoreSystems,
    NoFixture,
    NoPair,
    NoPlace,
    Note,
    PushedByHand,
    Seated,
    Stopped,
    UndecidedSystem,
)
from workhold.model.program import Program
from workhold.model.search_report import ProofReport
from workhold.verification.ball_geometry import PRECISIONS
from workhold.verification.contacts import make_joint_outline
from workhold.verification.listing import WrittenListing
from workhold.verification.repeats import KnownFixtures
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.seat_clamps import count_pairs_at_seat
from workhold.verification.undecided import find_undecided_faults

__all__ = ["find_account_faults", "is_by_algebra", "find_seat_faults", "has_too_few_contacts"]

SEARCH = ("features", "chord_curves", "sliding_pairs", "curve_pairs", "crossings_sought", "contacts_examined")
# Counts besides, where only the best were sought up to a limit of the location error.
LIMITED = ("boxes", "boxes_ruled_out")
FENCE = ("features", "hull_edges", "locator_places", "contacts_examined")
ALGEBRA = ("features", "systems", "orientations", "simultaneous_contacts", "undecided")
# The algebra names so many undecided systems, and counts the others in one note more.
MOST_NAMED = 20


def find_account_faults(listing: WrittenListing, rotations: int) -> Iterator[str]:
    """Yield one sentence for each contradiction among a result's own numbers,
    and between them and its fixtures.

    ``rotations`` is the largest possible number of rotations that carry the part onto itself, with the
    identity.
    """
    yield from find_contradictions_of_counts(listing, rotations)
    yield from find_seating_count_faults(listing)
    if listing.query.toolkit.travel_count > 1:
        yield from find_pair_count_faults(listing)
    if listing.proof is None:
        yield "it has no proof, the account of the search"
    else:
        yield from find_proof_faults(listing, listing.proof)
    yield from find_statistics_faults(listing)
    yield from find_note_faults(listing)


def find_contradictions_of_counts(listing: WrittenListing, rotations: int) -> Iterator[str]:
    """Yield one sentence for each contradiction among the listed fixtures, ``counts``, ``found`` and
    ``distinct``.

    ``rotations`` is the largest possible number of rotations of the part onto itself; found <= distinct ·
    rotations must hold.
    """
    for kind, counts in listing.counts.items():
        listed = sum(fixture.type == kind for fixture in listing.fixtures)
        found, distinct = listing.found[kind], listing.distinct[kind]
        if counts != listed:
            yield f"counts say {counts} fixtures of type {kind}, but {listed} are listed"
        if found < listed:
            yield f"found says {found} fixtures of type {kind}, but {listed} are listed"
        if not (distinct <= found <= distinct * rotations):
            yield f"distinct says {distinct} fixtures of type {kind}, which {found} cannot form"
        if found and kind not in listing.query.types:
            yield f"found says {found} fixtures of type {kind}, which is not asked for"
    listed, found, best = len(listing.fixtures), sum(listing.found.values()), listing.query.best
    if best is not None and listed > best:
        yield f"the best {best} are asked for, but {listed} are listed"
    is_said = listing.query.has_seating_rules or any(
        note in (KeptBest(found, listed), Cut(found, listed)) for note in listing.notes
    )
    if found > listed != best and not (is_said or listing.is_chosen):
        yield f"found says {found} fixtures, but {listed} are listed, and nothing says why"


def find_seating_count_faults(listing: WrittenListing) -> Iterator[str]:
    """Yield one sentence if the number of fixtures with a stated seating is not the number that should have
    one.
    """
    query, listed = listing.query, len(listing.fixtures)
    # With two clamps there is none to state.
    first = listing.fixtures[: (query.seating or 0) if query.toolkit.closes_at_once else 0]
    stated = sum(fixture.seating is not None for fixture in first)
    if query.has_seating_rules and (stated < listed or listed > len(first)):
        yield f"{listed} fixtures are listed for their seating, but it is stated of {stated}"
    elif listing.complete and stated < len(first) and not listing.is_chosen:
        yield f"the seating of {len(first)} fixtures is asked for, but it is stated of {stated}"
    if any(fixture.seating is not None for fixture in listing.fixtures[len(first) :]):
        yield f"the seating of more fixtures is stated than of the {len(first)} that it is asked of"


def find_proof_faults(listing: WrittenListing, proof: ProofReport) -> Iterator[str]:
    """Yield one sentence for each contradiction in the proof report's counts of candidates.

    They are compared with each other, with the undecided entries, and with the number of fixtures found.
    """
    undecided, found = len(proof.undecided), sum(listing.found.values())
    accounted = proof.discarded_by_bound + proof.verified + undecided
    if accounted != proof.candidates:
        yield (
            f"the proof says {proof.candidates} candidates, but {accounted} are discarded, verified or "
            "undecided"
        )
    yield from find_undecided_faults(proof.undecided, listing.query)
    if proof.escalated > proof.candidates:
        yield f"the proof says {proof.escalated} of {proof.candidates} candidates were escalated"
    # Of two clamps whether they close may be in doubt where neither was.
    single = sum(len(entry.faces) < listing.query.toolkit.peg_count for entry in proof.undecided)
    pairs = listing.query.toolkit.travel_count > 1
    if (single if pairs else undecided) and not proof.escalated:
        yield f"the proof says that {undecided} candidates are undecided, but none was escalated"
    if has_too_few_contacts(listing, proof) if pairs else found > proof.verified:
        yield f"the proof says {proof.verified} candidates were verified, but {found} fixtures were found"


def find_statistics_faults(listing: WrittenListing) -> Iterator[str]:
    """Yield one sentence for each contradiction in the work counts (``listing.statistics``).

    Their keys must be those of one engine (search, wall or algebra) and must agree with the proof and the
    faces touched.
    """
    numbers, proof = listing.statistics, listing.proof
    is_flush = WALL_END in listing.query.toolkit.contacts
    known = [FENCE] if is_flush else [SEARCH, ALGEBRA]
    if listing.query.best is not None and set(LIMITED) <= set(numbers):
        if numbers["boxes_ruled_out"] > numbers["boxes"]:
            yield "the statistics say that more boxes were ruled out than were looked at"
        numbers = {name: count for name, count in numbers.items() if name not in LIMITED}
    if set(numbers) not in map(set, known) or min(numbers.values()) < 0:
        yield f"the statistics are not {', '.join(known[0])}, each a number from 0"
        return
    # Of a wall with an outline of its own the search has no features.
    own = bool(listing.query.workpiece.outlines)
    touched = len({p.face for one in listing.fixtures for p in (one.placed if own else one.pegs)})
    if numbers["features"] < touched:
        yield f"the statistics say {numbers['features']} features, but the fixtures touch {touched} faces"
    if is_flush:
        if proof is not None and (proof.cells, proof.candidates) != (
            numbers["hull_edges"],
            numbers["contacts_examined"],
        ):
            yield (
                "the proof has other cells or candidates than the statistics have hull edges or contacts "
                "examined"
            )
        return
    by_algebra = is_by_algebra(numbers)
    if not by_algebra and numbers["crossings_sought"] > numbers["curve_pairs"]:
        yield "the statistics say that more crossings were sought than there are pairs of curves"
    if proof is None:
        return
    if by_algebra == (proof.cells > 0) and listing.complete:
        yield f"the proof says {proof.cells} cells, which does not go with the statistics"
    if listing.complete and by_algebra and proof.candidates > numbers["simultaneous_contacts"]:
        yield "the proof has more candidates than the statistics have simultaneous contacts"
    if listing.complete and not by_algebra and numbers["contacts_examined"] > proof.candidates:
        yield "the statistics have more contacts examined than the proof has candidates"


def is_by_algebra(statistics: Mapping[str, int]) -> bool:
    """Return whether the keys of a result's statistics are those of the algebra engine, not of the search."""
    return set(statistics) == set(ALGEBRA)


# A note that there must be, or one like it, and whether another will do as well.
Wanted = tuple[Note, Callable[[Note], bool]]


def find_note_faults(listing: WrittenListing) -> Iterator[str]:
    """Yield one sentence for each expected note that is missing, and for each
    note that contradicts the numbers.
    """
    left = list(listing.notes)
    for example, will_do in list_expected_notes(listing):
        said = next((note for note in left if will_do(note)), None)
        if said is None:
            yield f'the note is missing that says "{example}"'
        else:
            left.remove(said)
    for note in left:
        if not may_be_said(note, listing):
            yield f'the note "{note.words[:80]}" does not follow from what the result says'


def expect_note(note: Note) -> Wanted:
    """Return (note, predicate), where the predicate accepts only a note equal to ``note``."""
    return note, lambda other: other == note


def list_expected_notes(listing: WrittenListing) -> Iterator[Wanted]:
    """Yield (example, predicate) for each note that the result must hold; the
    predicate accepts any fitting note.
    """
    query, proof, found = listing.query, listing.proof, sum(listing.found.values())
    if query.workpiece.departure > 0:
        yield expect_note(FittedOutline(query.workpiece.departure))
    undecided = 0 if proof is None else len(proof.undecided)
    if undecided:
        yield expect_note(LeftUndecided(undecided))
    if found and query.has_seating_rules:
        most, listed = min(query.seating or 0, found), len(listing.fixtures)
        yield Seated(most, listed), lambda note: isinstance(note, Seated) and is_as_seated(note, listing)
    if found and query.seating is not None and not query.toolkit.closes_at_once:
        yield expect_note(PushedByHand())
    systems = listing.statistics.get("undecided", 0)
    for _ in range(min(systems, MOST_NAMED)):
        yield MoreSystems(systems), lambda note: isinstance(note, UndecidedSystem)
    if systems > MOST_NAMED:
        yield expect_note(MoreSystems(systems - MOST_NAMED))
    if listing.complete and not found and not undecided and not is_by_algebra(listing.statistics):
        yield expect_reason(listing, 0 if proof is None else proof.verified)


def expect_reason(listing: WrittenListing, verified: int) -> Wanted:
    """Return (example, predicate) for the note that must say why no fixture is listed.

    ``verified`` is the number of verified candidates. Some contents of that note are known to the search
    only: the number of seats examined, and the program line that blocks most. The predicate accepts any
    possible value there.
    """
    query, numbers, stages = listing.query, listing.statistics, STAGES
    wording, is_walled = query.toolkit.wording, WALL_END in query.toolkit.contacts
    if query.toolkit.travel_count > 1:
        if not is_walled or (numbers.get("hull_edges") and numbers.get("locator_places")):
            return (
                NoPair(0, verified),
                lambda note: (
                    isinstance(note, NoPair)
                    and note.contacts == verified
                    and (verified > 0 or not note.seats)
                ),
            )
        stages = ("pair",) if numbers.get("hull_edges") else ("shape",)
    elif verified:
        return (
            NoPlace(verified, wording),
            lambda note: (
                isinstance(note, NoPlace)
                and note.verified == verified
                and (query.program is not None or not note.with_body)
            ),
        )
    return (
        NoFixture(stages[0], wording),
        lambda note: (
            isinstance(note, NoFixture)
            and note.stage in stages
            and (note.line is None or is_line_of(query.program, note.line))
            and (not note.asked or (note.asked == query.asked_of_places and note.stage in STAGES[:2]))
        ),
    )


def is_line_of(program: Program | None, line: int) -> bool:
    """Return whether some move of the program belongs to this line of its text; False without a program."""
    return program is not None and any(piece.line == line for piece in program.pieces)


def may_be_said(note: Note, listing: WrittenListing) -> bool:
    """Return whether an optional note agrees with the result's numbers; False for notes of any other kind."""
    listed, found, query = len(listing.fixtures), sum(listing.found.values()), listing.query
    match note:
        case BestOnly(best):
            return best == query.best and found >= best
        case Many(count, kept):
            return kept == listed and count > listed
        case Seated():
            return query.has_seating_rules and is_as_seated(note, listing)
        case AskedFor(rules):
            return rules == query.restricted_by and not found
        case KeptBest(every, kept) | ChosenOnly(every, kept):
            return (every, kept) == (found, listed) and found > listed
        case Cut(every, kept):
            return (every, kept) == (found, listed) and found > listed and not listing.complete
        case Stopped():
            return not listing.complete
    return False


def is_as_seated(note: Seated, listing: WrittenListing) -> bool:
    """Return whether both numbers of a ``Seated`` note are possible.

    They are the number of fixtures with a computed seating, and the number of these that satisfy the seating
    rules.
    """
    listed, found, query = len(listing.fixtures), sum(listing.found.values()), listing.query
    most = min(query.seating or 0, found)
    least = most if listing.complete else listed
    # Of those that are as asked no more than the best are listed, or those that somebody chose.
    kept = note.looked_at if listed == query.best or listing.is_chosen else listed
    return least <= note.looked_at <= most and listed <= note.kept <= kept


def find_pair_count_faults(listing: WrittenListing) -> Iterator[str]:
    """Yield one sentence for each contradiction among pairs of clamps, seats and
    listed fixtures of a two-clamp toolkit.
    """
    found, listed = sum(listing.found.values()), len(listing.fixtures)
    pairs, seats = listing.pairs, listing.seats
    if is_uncounted(listing):
        note = "a note says that not all was counted"
        if pairs is not None or seats is not None:
            yield f"{note}, but pairs says {pairs} and seats {seats}"
        if found != listed:
            yield f"{note}, but found says {found} fixtures, and {listed} are listed"
        return
    if pairs is None or seats is None:
        yield "it does not say how many pairs of clamps there are, and at how many seats"
        return
    if listing.query.listing == "all":
        if pairs != found:
            yield f"pairs says {pairs}, but found says {found} fixtures, each of which is one"
        if not (seats <= pairs and (seats > 0) == (pairs > 0)):
            yield f"seats says {seats}, at which there cannot be {pairs} pairs of clamps"
        return
    if seats != found:
        yield f"seats says {seats}, but found says {found} fixtures, each of which is the best of one"
    stood_for = sum(1 if fixture.pair is None else fixture.pair.count for fixture in listing.fixtures)
    if stood_for + found - listed > pairs or (found == listed and stood_for != pairs):
        yield f"pairs says {pairs}, but the fixtures listed stand for {stood_for}"


def is_uncounted(listing: WrittenListing) -> bool:
    """Return whether a note says that fixtures which cannot be among the best were not counted."""
    return BestOnly(listing.query.best or 0) in listing.notes


def find_seat_faults(listing: WrittenListing, refuted: Collection[int]) -> Iterator[str]:
    """Yield one sentence if the number of seats, or of clamp pairs at one seat, differs from the derived
    number.

    Yields nothing unless the toolkit has two clamps, every pair is listed and all was counted. ``refuted``
    holds the indices, from 0, of fixtures to leave out. Stops at the first seat with a wrong number of pairs.
    """
    query, found = listing.query, sum(listing.found.values())
    if query.toolkit.travel_count == 1 or query.listing != "all" or found != len(listing.fixtures):
        return
    if is_uncounted(listing):
        return
    hardware = ToolkitRules(query.toolkit)
    seen, at_seat = KnownFixtures(hardware), Counter[int]()
    for index, fixture in enumerate(listing.fixtures):
        if index not in refuted:
            first = seen.add(index, fixture)
            at_seat[index if first is None else first] += 1
    if listing.seats not in (None, len(at_seat)) and not refuted:
        yield f"seats says {listing.seats}, but the fixtures listed are at {len(at_seat)}"
    if not listing.complete or refuted:
        return
    with ctx.workprec(PRECISIONS[0]):
        outline = make_joint_outline(query.workpiece)
        for index, count in sorted(at_seat.items()):
            limits = count_pairs_at_seat(listing.fixtures[index], query, hardware, outline)
            if limits is not None and not limits[0] <= count <= limits[1]:
                yield (
                    f"there are {limits[0]} pairs of clamps at the seat of fixture {index + 1}, and {count} "
                    "are listed"
                )
                return


def has_too_few_contacts(listing: WrittenListing, proof: ProofReport) -> bool:
    """Return whether the proof verified too few candidate contacts for the stated numbers of seats and
    fixtures.

    For toolkits with two clamps only. A seat needs two verified contacts (each of the locators, or wall and
    locator, with one clamp) for a pair of directions. n contacts form at most n(n - 1)/2 pairs of clamps.
    """
    found, pairs = sum(listing.found.values()), len(listing.query.toolkit.arrangements)
    if 2 * (listing.seats or 0) > pairs * proof.verified:
        return True
    return 2 * max(found, listing.pairs or 0) > proof.verified * (proof.verified - 1)
