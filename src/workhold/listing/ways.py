"""The results of a toolkit's ways, one carrier moving in each, as one result."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
from attrs import evolve

from workhold.listing.identity import Identity, SetCount
from workhold.listing.ranking import rank
from workhold.model.notes import best_note, cut_note, no_fixture_notes, no_place_note, undecided_note
from workhold.model.proof import Proof
from workhold.model.query import Query
from workhold.model.result import FixtureTable, Result

__all__ = ["joined_ways", "summed"]


def joined_ways(results: Sequence[Result], query: Query) -> Result:
    """The results of all ways of a query's toolkit (``Toolkit.ways``), in their order, as that of the
    query."""
    table = joined_tables([result.table for result in results])
    # Of a search that was stopped no more than the best of a way may be listed: of all then, too.
    cut = [] if query.best else [len(result) for result in results if 0 < len(result) < sum(result.found.values())]
    most = min(cut, default=query.best)
    ranked = table.take(rank(table.quality, query.ranking, query.tolerance)[:most])
    proofs = [result.proof for result in results if result.proof is not None]
    found, distinct = (summed(getattr(result, name) for result in results) for name in ("found", "distinct"))
    if query.best is not None and any(best_note(query.best) in result.notes for result in results):
        # Each way left others out than the best of its own, so of all no more are known than the best.
        counted = SetCount(Identity(query.toolkit, query.workpiece))
        counted.add(ranked)
        found, distinct = counted.by_type(counted.found), counted.by_type(counted.distinct)
    joined = Result(
        query=query,
        table=ranked,
        found=found,
        distinct=distinct,
        complete=all(result.complete for result in results),
        notes=tuple(joined_notes(results, query)),
        statistics=summed(result.statistics for result in results),
        proof=joined_proofs(proofs) if len(proofs) == len(results) else None,
    )
    return joined.cut_short(len(ranked)) if cut else joined


def joined_notes(results: Sequence[Result], query: Query) -> Iterator[str]:
    """The remarks of several results as those of all: how many candidates are undecided, or why no result has
    a fixture. Of several reasons it is the one that most candidates got to."""
    proofs = [result.proof for result in results if result.proof is not None]
    verified, undecided = sum(proof.verified for proof in proofs), sum(len(proof.undecided) for proof in proofs)
    reasons = no_fixture_notes(query.toolkit.wording)
    counted = {*reasons, *(no_place_note(proof.verified, query.toolkit.wording) for proof in proofs)}
    counted |= {undecided_note(len(proof.undecided)) for proof in proofs}
    counted |= {cut_note(sum(result.found.values()), len(result)) for result in results}
    notes = dict.fromkeys(note for result in results for note in result.notes)
    yield from (note for note in notes if note not in counted)
    if undecided:
        yield undecided_note(undecided)
    elif not any(result.found[kind] for result in results for kind in result.found):
        said = [reason for reason in reasons if reason in notes]
        yield from [no_place_note(verified, query.toolkit.wording)] if verified else said[-1:]


def joined_tables(tables: Sequence[FixtureTable]) -> FixtureTable:
    """Tables one after the other, each with one arrangement, which are numbered on."""
    numbered = [
        evolve(table, arrangement=(table.arrangement + number).astype(np.int8)) for number, table in enumerate(tables)
    ]
    return FixtureTable.joined(numbered)


def summed(counts: Iterable[Mapping[str, int]]) -> dict[str, int]:
    """Counts by name, summed over several."""
    total: Counter[str] = Counter()
    for one in counts:
        total.update({name: int(count) for name, count in one.items()})
    return dict(total)


def joined_proofs(proofs: Sequence[Proof]) -> Proof:
    """Several accounts as one."""
    return Proof(
        cells=sum(proof.cells for proof in proofs),
        candidates=sum(proof.candidates for proof in proofs),
        discarded_by_bound=sum(proof.discarded_by_bound for proof in proofs),
        verified=sum(proof.verified for proof in proofs),
        escalated=sum(proof.escalated for proof in proofs),
        undecided=tuple(item for proof in proofs for item in proof.undecided),
    )
