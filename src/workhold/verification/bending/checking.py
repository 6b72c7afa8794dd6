"""The verification of all that a file says of bending, and what of it was not checked."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence

from attrs import frozen

from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.verification.bending.body import has_elements
from workhold.verification.bending.judge import BendingJudge

__all__ = ["BendingRuling", "list_unchecked", "rule_on_bendings"]

# What the extra asks for.
REQUIREMENT = "ngsolve>=6.2.2608"


@frozen
class BendingRuling:
    """What is wrong with the bending of a fixture, or may be.

    Parameters
    ----------
    index : place of the fixture in the list, from 0.
    is_refuted : whether it is wrong; otherwise it is undecided.
    reason : one sentence, without a full stop.
    """

    index: int
    is_refuted: bool
    reason: str


def find_obstacle(query: Query, kept: str | None) -> str:
    """Return why the bending of a query's fixtures cannot be computed again, as a clause; "" where it can."""
    if query.toolkit.holds_by_friction:
        held = "under straps" if query.toolkit.strap_set is not None else "between flat jaws"
        return f"that of a part {held} is not computed again"
    if not has_elements():
        return f"that takes a library that is not installed: pip install '{REQUIREMENT}'"
    if query.workpiece.solid is not None and kept is None:
        return "that takes the part's STEP file: give it as well"
    return ""


def list_unchecked(query: Query, fixtures: Sequence[Fixture], kept: str | None) -> tuple[str, ...]:
    """Return sentences on what was not checked of the bending that a file states; () where it states none.

    ``kept`` is the solid in Open CASCADE's own form; None for a drawn part, and where it is not there.
    """
    bent = [fixture.bent for fixture in fixtures if fixture.bent is not None]
    if not bent:
        return ()
    if obstacle := find_obstacle(query, kept):
        return (f"How far fixtures bend the part was not checked: {obstacle}.",)
    if any(one.give is not None and one.give.line is not None for one in bent):
        return ("How far the part gives along the program was not checked.",)
    return ()


def rule_on_bendings(
    query: Query,
    fixtures: Sequence[Fixture],
    kept: str | None,
    skipped: Collection[int],
    progress: Callable[[int, int], None],
) -> Iterator[BendingRuling]:
    """Yield a ruling for each fixture whose bending is wrong, or may be; what cannot be checked is passed over.

    Parameters
    ----------
    kept : see :func:`list_unchecked`.
    skipped : indices of fixtures that are refuted already.
    progress : called with how many were looked at, and of how many.
    """
    stated = [
        (place, fixture)
        for place, fixture in enumerate(fixtures)
        if fixture.bent is not None and place not in skipped
    ]
    judge, obstacle = BendingJudge(query, kept), find_obstacle(query, kept) if stated else ""
    for count, (place, fixture) in enumerate(stated, 1):
        assert fixture.bent is not None
        doubt = ""
        for finding in judge.judge(fixture, fixture.bent, is_whole=not obstacle):
            if finding.definite:
                yield BendingRuling(place, True, finding.reason)
                break
            doubt = doubt or finding.reason
        else:
            if doubt:
                yield BendingRuling(place, False, doubt)
        progress(count, len(stated))
