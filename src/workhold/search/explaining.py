"""Why there is no fixture: what each rule takes away of the contacts, what comes nearest, and which single
change helps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from threading import Event, Timer
from typing import Any

import numpy as np
from attrs import evolve

from workhold.contact.problem import Problem
from workhold.errors import InputError
from workhold.fixels.toolkit import Change, Toolkit
from workhold.model.explanation import Explanation, Help
from workhold.model.quality import WARNINGS
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.search.broken_rules import removals_of
from workhold.search.design import answer
from workhold.search.removals import Removals
from workhold.search.wall_rules import removals_beside_wall
from workhold.units import MILLIMETRE, Unit

__all__ = ["explain"]

# Faces to avoid that are given back one by one.
MOST_FACES = 8
# Seconds after which a change has shown that it helps; how many fixtures there are in all is then not known.
HELP_SECONDS = 10.0


def explain(query: Query, threads: int | None = None, unit: Unit = MILLIMETRE) -> Explanation:
    """Explains why there is no fixture that a query asks for.

    Parameters
    ----------
    query : what was asked in vain.
    threads : how many threads share the work; None for one on each processor.
    unit : of the lengths in its words.
    """
    toolkit, alone = query.toolkit, not query.toolkit.needs_pairs
    ways = [held_in(query, way) for way in toolkit.ways]
    if toolkit.wall is not None:
        found = [removals_beside_wall(way, alone) for way in ways]
    else:
        found = [removals_of(Problem.of(way), threads, unit, alone) for way in ways]
    together = Removals.together(found)
    return Explanation(together.first, together.removals, together.nearest, helps(query, threads, unit))


def helps(query: Query, threads: int | None, unit: Unit) -> tuple[Help, ...]:
    """Single changes of what was asked for with which there are fixtures, the most first."""
    out = []
    for words, changed, fields in changes(query, unit):
        enough = Event()
        timer = Timer(HELP_SECONDS, enough.set)
        timer.start()
        try:
            asked = evolve(changed(), ranking="warnings", best=None)
            result = answer(asked, threads=threads, cancel=enough)
        except InputError:
            continue
        finally:
            timer.cancel()
        if any(result.found.values()):
            words += nearest_turn(query, result)
            out.append(Help(words, sum(result.found.values()), result.complete, fields))
    return tuple(sorted(out, key=lambda help: -help.fixtures))


def nearest_turn(query: Query, result: Result) -> str:
    """Where angles were asked for, how far beyond them the part can be held, without warnings if that can
    be."""
    if not query.restrictions.angles or result.query.restrictions.angles:
        return ""
    quality = result.table.quality
    good = quality[:, WARNINGS] == quality[:, WARNINGS].min()
    found = np.degrees(result.table.theta[good])
    # What half a turn leaves in its arrangement lies in the jaws either way round.
    swaps = bool(result.toolkit.symmetries)
    pegs = np.array([swaps and one.pegs[0] == one.pegs[-1] for one in result.toolkit.arrangements])
    found = np.concatenate([found, found[pegs[result.table.arrangement[good]]] + 180.0])
    beyond = np.full(len(found), np.inf)
    for low, high in query.restrictions.angles:
        past = (found - high) % 360.0
        beyond = np.minimum(beyond, np.minimum(past, 360.0 - (past + high - low) % 360.0))
    nearest = int(beyond.argmin())
    return f", the nearest {beyond[nearest]:.1f} degrees farther, at {found[nearest] % 360.0:.2f}"


def changes(query: Query, unit: Unit) -> Iterator[tuple[str, Callable[[], Query], Mapping[str, Any] | None]]:
    """Changes of a query to try, one at a time: in words; what makes the query, or finds that there is none
    such; and the fields of the toolkit that it changes, if it does."""
    asked, toolkit = query.restrictions, query.toolkit
    if asked.avoid:
        if len(asked.avoid) > 1:
            faces = ", ".join(str(number) for number in asked.avoid)
            yield f"touching faces {faces} too", partial(evolve, query, restrictions=evolve(asked, avoid=())), None
        for face in asked.avoid[:MOST_FACES]:
            rest = tuple(number for number in asked.avoid if number != face)
            yield f"touching face {face} too", partial(evolve, query, restrictions=evolve(asked, avoid=rest)), None
    if asked.zones:
        yield "without the keep-out zones", partial(evolve, query, restrictions=evolve(asked, zones=())), None
    if asked.angles:
        yield "at any angle", partial(evolve, query, restrictions=evolve(asked, angles=())), None
    if query.contact_margin > 0:
        yield "without a contact margin", partial(evolve, query, contact_margin=0.0), None
    for change in (*(limit.lifted for limit in toolkit.limits), *toolkit.further_changes(unit)):
        yield change.words, partial(held_in_another, query, change), change.fields


def held_in_another(query: Query, change: Change) -> Query:
    """A query in a changed toolkit.

    Raises
    ------
    InputError
        When there is no such toolkit.
    """
    return held_in(query, query.toolkit.changed(change.fields))


def held_in(query: Query, toolkit: Toolkit) -> Query:
    """A query in another toolkit of the kind, where that has another number of clamps without what only the
    first has."""
    if toolkit.peg_count == query.toolkit.peg_count:
        return evolve(query, toolkit=toolkit)
    return evolve(query, toolkit=toolkit, arrangements=None, ranking=None, listing=None)
