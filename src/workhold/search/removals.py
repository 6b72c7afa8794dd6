"""What rules take away of contacts until no fixture is left, in one direction of the clamp or in several."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from attrs import field, frozen

from workhold.model.explanation import NearestMiss, Removal

__all__ = ["SECOND_CLAMP", "Removals"]

# What is asked last of locators and a clamp, where two clamps are needed.
SECOND_CLAMP = "a second clamp that holds the part together with the first, and is needed for it"


def with_some_before(removals: Iterable[Removal]) -> tuple[Removal, ...]:
    """Removals without those of rules for which no contact was left."""
    return tuple(removal for removal in removals if removal.before > 0)


@frozen
class Removals:
    """What rules take away, one after the other.

    Parameters
    ----------
    first : how many contacts there are before any rule.
    removals : of the rules for which contacts were left, in the order in which they are asked.
    nearest : what comes nearest to a fixture, if anything is near.
    """

    first: int
    removals: tuple[Removal, ...] = field(converter=with_some_before)
    nearest: NearestMiss | None

    @classmethod
    def together(cls, found: Sequence[Removals]) -> Removals:
        """The removals of several directions as one, with what came nearest where the most was left
        longest."""
        # A rule may be asked twice in one direction, early where that saves work and again at its place.
        counts: dict[tuple[str, int], tuple[int, int]] = {}
        for one in found:
            rules = [removal.rule for removal in one.removals]
            for number, removal in enumerate(one.removals):
                asked = removal.rule, rules[:number].count(removal.rule)
                before, after = counts.get(asked, (0, 0))
                counts[asked] = before + removal.before, after + removal.after
        nearest = max(found, key=lambda one: len(one.removals)).nearest
        removals = tuple(Removal(rule, *numbers) for (rule, _), numbers in counts.items())
        return cls(sum(one.first for one in found), removals, nearest)
