"""What a search reports besides its fixtures and notes: its proof, and why there is no fixture.

A proof shows what was examined, and what could not be decided. An explanation says what each rule took away,
the nearest miss, and what would help.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from attrs import field, frozen

from workhold.errors import join_words
from workhold.model.fixture import Fixture
from workhold.model.notes import Note

__all__ = [
    "AT_AN_EDGE",
    "GIVEN_UP",
    "NEARLY_DOUBLE",
    "UNBOUNDED",
    "Explanation",
    "HelpfulChange",
    "NearestMiss",
    "ProofReport",
    "RuleRemoval",
    "UndecidedCandidate",
]

# Why something is undecided.
GIVEN_UP = "two pegs on these faces fit in so many nearly equal ways that they cannot be distinguished"
UNBOUNDED = "the pegs slide so easily along these faces that their places cannot be stated"
NEARLY_DOUBLE = "the contacts are a double solution, or so nearly that its clamping force is not decided"
AT_AN_EDGE = "a rule is met exactly at its edge"


@frozen
class UndecidedCandidate:
    """A candidate that is left undecided: four contacts, five with two clamps, or a pair of chords.

    Parameters
    ----------
    type : of the arrangement, with the direction in which a clamp moves, such as "II" or "clamp -x".
    faces : the four faces (a pair of chords names the tail and the head of each).
    columns, rows : the four pegs on their jaws' lattices; columns are counted from each jaw's first peg, rows
        from the first left peg. A clamp has the number of its line from the first locator's, and 0.
    theta_deg : orientation of the workpiece in degrees, about which it would be.
    reason : why it is not decided, in one sentence without a full stop.
    reach_deg : how far in degrees the orientation may be from there; None where that is not bounded, and of a
        pair of chords, which exist there.
    """

    type: str
    faces: tuple[int, ...]
    columns: tuple[int, ...]
    rows: tuple[int, ...]
    theta_deg: float
    reason: str
    reach_deg: float | None = None


@frozen
class ProofReport:
    """The account of a proven search; ``candidates`` are those discarded, verified and left undecided.

    Parameters
    ----------
    cells : ranges of orientation examined, for each type apart.
    candidates : sets of four contacts that the bounds of the chord curves allow.
    discarded_by_bound : candidates that break a rule everywhere within their error.
    verified : candidates proven to be fixtures, before rows and the largest opening are asked; one found from
        two sides, as at a joint, counts twice.
    escalated : candidates that their certificates left open: they went on to interval arithmetic, or were
        given up.
    undecided : what that could not decide either.
    """

    cells: int
    candidates: int
    discarded_by_bound: int
    verified: int
    escalated: int
    undecided: tuple[UndecidedCandidate, ...] = field(default=())


@frozen
class RuleRemoval:
    """Numbers of candidates before and after one rule.

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
        """Number of sets that the rule took away."""
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
class HelpfulChange:
    """A change of what was asked for, and how many fixtures there are with it.

    Parameters
    ----------
    change : in a few words, such as "without avoiding faces 1, 4".
    fixtures : how many there are then.
    complete : False when there are more, because the search for them was ended.
    fields : those of the toolkit that it changes; None when it changes something else.
    rules : what was asked for that it leaves out, see ``Query.asked``; all of these have to be.
    """

    change: str
    fixtures: int
    complete: bool = True
    fields: Mapping[str, Any] | None = None
    rules: tuple[str, ...] = ()


@frozen
class Explanation:
    """Explanation of why there is no fixture.

    Parameters
    ----------
    contacts : sets of four pegs of the two jaws that touch the part at the same time, before any rule.
    removals : what each rule took away, in the order they were asked; the last one left nothing.
    nearest : the nearest miss, if four pegs can touch the part at all.
    helps : changes that were tried and with which there are fixtures, the most first.
    no_contacts : why there are no such sets; None where there are.
    """

    contacts: int
    removals: tuple[RuleRemoval, ...]
    nearest: NearestMiss | None
    helps: tuple[HelpfulChange, ...]
    no_contacts: Note | None = None

    @property
    def last_rule(self) -> str | None:
        """Rule that took the last candidates away; None where four pegs cannot touch the part at all."""
        return self.removals[-1].rule if self.removals else None

    @property
    def taken_by(self) -> tuple[str, ...]:
        """Rules asked for without which there are fixtures, each once, in the order of ``helps``.

        So the part is not to blame, whichever rule was the last one applied.
        """
        return tuple(dict.fromkeys(rule for help in self.helps for rule in help.rules))

    @property
    def asked_words(self) -> str:
        """Sentence that names the rules of :attr:`taken_by`;
        "" where there are none, or only the last rule.
        """
        if self.taken_by in ((), (self.last_rule,)):
            return ""
        alone = all(len(help.rules) < 2 for help in self.helps)
        rules = " or ".join(self.taken_by) if alone else f"{join_words(self.taken_by)} together"
        return f"What was asked for rules out the last fixtures: {rules}."
