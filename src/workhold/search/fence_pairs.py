"""Every fixture of a workpiece on a fence with two clamps, or the best of them."""

from __future__ import annotations

from threading import Event

from attrs import evolve

from workhold.contact.problem import Problem, Progress
from workhold.listing.listed import Work
from workhold.listing.on_fence import Pressed
from workhold.listing.paired_fence import PairedOnFence, seats_on_fence
from workhold.model.notes import no_fixture_notes, no_pair_note
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.proof.deciding import Account
from workhold.search.fence import entry
from workhold.search.fence_search import FenceSearch, pressed_by, searches_of

__all__ = ["answer_of_pairs_on_fence"]


def answer_of_pairs_on_fence(query: Query, progress: Progress | None, cancel: Event | None) -> Result:
    """The fixtures of a fence with two clamps that a query asks for, see ``search.design.answer``: one hull edge after the
    other lies on the wall."""
    single = evolve(query, arrangements=None, ranking=None, best=None, listing=None, toolkit=query.toolkit.ways[0])
    searches = searches_of(single, query.toolkit.ways, pairing=True)
    kept = PairedOnFence(query, searches[0].problem)
    edges, done = searches[0].edges, 0
    for edge in edges:
        if cancel is not None and cancel.is_set():
            break
        found: dict[FenceSearch, list[Pressed]] = {search: [] for search in searches}
        for search, part in pressed_by(searches, edge):
            found[search].append(part)
        if any(found.values()):
            kept.add(seats_on_fence([of_direction(search, parts) for search, parts in found.items() if parts]))
        done += 1
        if progress is not None:
            progress(done / len(edges), len(kept))
    undecided = tuple(entry(candidate, search.problem) for search in searches for candidate in search.undecided)
    examined, verified, escalated = (
        sum(getattr(search, name) for search in searches) for name in ("examined", "verified", "escalated")
    )
    statistics = {
        "features": len(searches[0].problem.rows),
        "hull_edges": done,
        "locator_places": max(search.locators for search in searches),
        "contacts_examined": examined,
    }
    account = Account(examined, verified, escalated, 0, undecided)
    result = kept.result(account, Work(done == len(edges), statistics, cells=done))
    if not result.complete or len(result) or result.reasons:
        return result
    never, no_locator, _, _ = no_fixture_notes(query.toolkit.wording)
    note = no_pair_note(kept.seats_looked_at, verified)
    return evolve(result, notes=(never if not edges else no_locator if not statistics["locator_places"] else note,))


def of_direction(search: FenceSearch, parts: list[Pressed]) -> tuple[Pressed, Problem, str]:
    """The pairs of a search, at least one part of them, with its problem and the name of its direction."""
    return Pressed.joined(parts), search.problem, search.problem.toolkit.arrangements[0].direction or ""
