"""Why there is no fixture: what each rule took away, the nearest miss, and what would help."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from attrs import frozen

from workhold.model.fixture import Fixture

__all__ = ["Explanation", "Help", "NearestMiss", "Removal"]


@frozen
class Removal:
    """What one rule took away.

    Parameters
    ----------
    rule : the rule in a few words.
    before, after : sets of four simultaneous contacts before and after it.
    """

    rule: str
    before: int
    after: int

    @property
    def removed(self) -> int:
        """How many it took away."""
        return self.before - self.after


@frozen
class NearestMiss:
    """Four simultaneous contacts that came nearest to being a fixture.

    Parameters
    ----------
    fixture : where the pegs and the part would be; a peg with a negative force would have to pull.
    words : what is wrong with it, in one sentence.
    """

    fixture: Fixture
    words: str


@frozen
class Help:
    """A change of what was asked for, and how many fixtures there are with it.

    Parameters
    ----------
    change : in a few words, such as "without avoiding faces 1, 4".
    fixtures : how many there are then.
    complete : False when there are more, because the search for them was ended.
    fields : those of the toolkit that it changes; None when it changes something else.
    """

    change: str
    fixtures: int
    complete: bool = True
    fields: Mapping[str, Any] | None = None


@frozen
class Explanation:
    """Why there is no fixture.

    Parameters
    ----------
    contacts : sets of four pegs of the two jaws that touch the part at the same time, before any rule.
    removals : what each rule took away, in the order they were asked; the last one left nothing.
    nearest : the nearest miss, if four pegs can touch the part at all.
    helps : changes that were tried and with which there are fixtures, the most first.
    """

    contacts: int
    removals: tuple[Removal, ...]
    nearest: NearestMiss | None
    helps: tuple[Help, ...]

    @property
    def last_rule(self) -> str | None:
        """The rule that took the last candidates away; None when four pegs cannot touch the part to begin with."""
        return self.removals[-1].rule if self.removals else None
