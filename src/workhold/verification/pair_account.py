"""Whether the numbers that a result with two clamps gives about itself agree.

- where the best pair of each seat is listed: found = seats, and pairs = the sum of what those listed stand for, where all
  are;
- where every pair is: found = pairs, and seats = how many there are among those listed; at each there are as many as are
  derived, once the search is complete;
- each seat and pair of directions needs two contacts of locators, or wall and locator, and a clamp, each pair of clamps two
  of its own.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator

from flint import ctx

from workhold.model.notes import no_fixture_notes, no_pair_note
from workhold.model.plate import Plate
from workhold.model.proof import Proof
from workhold.verification.balls import PRECISIONS
from workhold.verification.kinds import hardware_of
from workhold.verification.listing import Listing
from workhold.verification.outline import Outline
from workhold.verification.pair_plate import PairRules
from workhold.verification.pair_proof import pairs_at
from workhold.verification.repeats import Seen

__all__ = ["no_pair_notes", "pair_count_faults", "seat_faults", "too_few_contacts"]


def pair_count_faults(listing: Listing) -> Iterator[str]:
    """Contradictions among pairs, seats and what is listed."""
    found, listed = sum(listing.found.values()), len(listing.fixtures)
    pairs, seats = listing.pairs, listing.seats
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


def seat_faults(listing: Listing, refuted: Collection[int]) -> Iterator[str]:
    """Where every pair of clamps is listed: another number of seats, or of pairs at one of them, than is derived."""
    toolkit, query = listing.query.toolkit, listing.query
    if not isinstance(toolkit, Plate) or query.listing != "all" or sum(listing.found.values()) != len(listing.fixtures):
        return
    rules = hardware_of(toolkit)
    assert isinstance(rules, PairRules)
    seen, at_seat = Seen(rules), Counter[int]()
    for index, fixture in enumerate(listing.fixtures):
        if index not in refuted:
            first = seen.add(index, fixture)
            at_seat[index if first is None else first] += 1
    if listing.seats not in (None, len(at_seat)) and not refuted:
        yield f"seats says {listing.seats}, but the fixtures listed are at {len(at_seat)}"
    if not listing.complete or refuted:
        return
    with ctx.workprec(PRECISIONS[0]):
        outline = Outline.of(query.workpiece)
        for index, count in sorted(at_seat.items()):
            limits = pairs_at(listing.fixtures[index], query, rules, outline)
            if limits is not None and not limits[0] <= count <= limits[1]:
                yield f"there are {limits[0]} pairs of clamps at the seat of fixture {index + 1}, and {count} are listed"
                return


def too_few_contacts(listing: Listing, proof: Proof) -> bool:
    """Whether so many fixtures cannot come from so many contacts of locators, or wall and locator, and a clamp."""
    toolkit, found = listing.query.toolkit, sum(listing.found.values())
    assert isinstance(toolkit, Plate)
    if 2 * (listing.seats or 0) > len(toolkit.directions) * proof.verified:
        return True
    return 2 * max(found, listing.pairs or 0) > proof.verified * (proof.verified - 1)


def no_pair_notes(listing: Listing, verified: int) -> tuple[str, ...]:
    """The sentences of which one says why nothing is listed: how many seats were looked at is known to the search alone."""
    toolkit, numbers_of = listing.query.toolkit, listing.statistics
    if toolkit.wall is not None:
        never, no_locator, *_ = no_fixture_notes(toolkit.wording)
        if not (numbers_of.get("hull_edges") and numbers_of.get("locator_places")):
            return (no_locator if numbers_of.get("hull_edges") else never,)
    if verified == 0:
        return (no_pair_note(0, 0),)
    numbers = [int(word) for note in listing.notes for word in note.split() if word.isdecimal()]
    return (no_pair_note(0, verified), *(no_pair_note(seats, verified) for seats in numbers))
