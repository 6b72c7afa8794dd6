"""The reports of a search besides its fixtures and notes: its proof, and why there is no fixture.

A proof counts the examined candidates and lists those that could not be decided. An explanation has the
number of candidates that each rule removed, the nearest miss, and changes that would help.
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
    type : name of the arrangement, with the clamping direction if any, such as "II" or "clamp -x".
    faces : the faces touched; for a pair of chords, those of the tail and the head of each chord.
    columns, rows : holes of the pegs; columns are counted from the first peg on the same jaw, rows from the
        first peg on the left jaw. A clamp has two entries: the number of its line from the first locator's
        line, and 0.
    theta_deg : orientation of the workpiece in degrees near which the candidate would be.
    reason : why it is not decided, in one sentence without a full stop.
    reach_deg : largest distance in degrees of the orientation from ``theta_deg``; None if it is unbounded,
        and for a pair of chords, which exists at ``theta_deg``.
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
    cells : number of ranges of orientation examined, summed over the types.
    candidates : number of sets of four contacts that the bounds of the chord curves allow.
    discarded_by_bound : number of candidates that break a rule everywhere within their error bounds.
    verified : number of candidates proven to be fixtures, before rows and the largest opening are checked; a
        candidate found from two sides, as at a joint, counts twice.
    escalated : number of candidates that their certificates did not decide: these were decided by interval
        arithmetic, or given up.
    undecided : number of candidates that interval arithmetic could not decide either.
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
    fixture : the pegs and the part as they would be; a peg with a negative force would have to pull.
    words : reason why it is not a fixture, in one sentence.
    """

    fixture: Fixture
    words: str


@frozen
class HelpfulChange:
    """A change of the request, and the number of fixtures with it.

    Parameters
    ----------
    change : the change in a few words, such as "without avoiding faces 1, 4".
    fixtures : number of fixtures with the change.
    complete : False when there are more fixtures, because their search was cut short.
    fields : fields of the toolkit that the change sets; None when it changes something else.
    rules : requirements that the change leaves out, all at once, named as in ``Query.asked``.
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
    contacts : number of sets of four pegs of the two jaws that touch the part simultaneously, before any
        rule.
    removals : numbers that each rule removes, in the order of application; none is left after the last one.
    nearest : the nearest miss, if four pegs can touch the part at all.
    helps : changes that were tried and that give fixtures, most fixtures first.
    no_contacts : reason why no four pegs can touch the part simultaneously; None if some can.
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
        """Names of the requirements without which there are fixtures, each once, in the order of ``helps``.

        They, and not the part, are to blame, whichever rule was applied last.
        """
        return tuple(dict.fromkeys(rule for help in self.helps for rule in help.rules))

    @property
    def asked_words(self) -> str:
        """Sentence that names the requirements in :attr:`taken_by`.

        It is "" if there are none, or only the rule applied last.
        """
        if self.taken_by in ((), (self.last_rule,)):
            return ""
        alone = all(len(help.rules) < 2 for help in self.helps)
        rules = " or ".join(self.taken_by) if alone else f"{join_words(self.taken_by)} together"
        return f"What was asked for rules out the last fixtures: {rules}."
