"""What a search reports besides its fixtures: its proof, why there is no fixture, and remarks for the user.

A proof shows what was examined, and what could not be decided. An explanation says what each rule took away,
the nearest miss, and what would help. Remarks are one sentence each. They follow from the numbers of a
result, so a verification can derive which remarks there must be.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from attrs import field, frozen

from workhold.errors import listed
from workhold.fixels.toolkit import Wording
from workhold.model.fixture import Fixture

__all__ = [
    "round_to_two_digits",
    "AT_AN_EDGE",
    "GIVEN_UP",
    "NEARLY_DOUBLE",
    "UNBOUNDED",
    "Explanation",
    "Help",
    "NearestMiss",
    "Proof",
    "Removal",
    "Undecided",
    "asked_note",
    "best_note",
    "by_hand_note",
    "chosen_note",
    "cut_note",
    "fitted_note",
    "kept_note",
    "many_note",
    "left_notes",
    "no_fixture_notes",
    "no_pair_note",
    "no_place_note",
    "seated_note",
    "stopped_note",
    "undecided_note",
]

# Why something is undecided.
GIVEN_UP = "two pegs on these faces fit in so many nearly equal ways that they cannot be distinguished"
UNBOUNDED = "the pegs slide so easily along these faces that their places cannot be stated"
NEARLY_DOUBLE = "the contacts are a double solution, or so nearly that its clamping force is not decided"
AT_AN_EDGE = "a rule is met exactly at its edge"


@frozen
class Undecided:
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
class Proof:
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
    undecided: tuple[Undecided, ...] = field(default=())


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
    rules : what was asked for that it leaves out, see ``Query.asked``; all of these have to be.
    """

    change: str
    fixtures: int
    complete: bool = True
    fields: Mapping[str, Any] | None = None
    rules: tuple[str, ...] = ()


@frozen
class Explanation:
    """Why there is no fixture.

    Parameters
    ----------
    contacts : sets of four pegs of the two jaws that touch the part at the same time, before any rule.
    removals : what each rule took away, in the order they were asked; the last one left nothing.
    nearest : the nearest miss, if four pegs can touch the part at all.
    helps : changes that were tried and with which there are fixtures, the most first.
    no_contacts : why there are no such sets; empty where there are.
    """

    contacts: int
    removals: tuple[Removal, ...]
    nearest: NearestMiss | None
    helps: tuple[Help, ...]
    no_contacts: str = ""

    @property
    def last_rule(self) -> str | None:
        """The rule that took the last candidates away; None when four pegs cannot touch the part at all."""
        return self.removals[-1].rule if self.removals else None

    @property
    def taken_by(self) -> tuple[str, ...]:
        """What was asked for that takes the last fixtures, each alone or, where one alone does not, together.

        There are fixtures without it, so the part is not to blame, whichever rule is the last.
        """
        return tuple(dict.fromkeys(rule for help in self.helps for rule in help.rules))

    @property
    def asked_words(self) -> str:
        """The sentence that names what was asked for where it takes the last fixtures.

        It is empty where nothing does, and where the last rule is just that.
        """
        if self.taken_by in ((), (self.last_rule,)):
            return ""
        alone = all(len(help.rules) < 2 for help in self.helps)
        rules = " or ".join(self.taken_by) if alone else f"{listed(self.taken_by)} together"
        return f"The last fixtures are taken by what was asked for: {rules}."


def no_fixture_notes(wording: Wording, line: int | None = None) -> tuple[str, ...]:
    """Why a search finds no fixture, in the order of what is asked; a toolkit may have reasons of its own.

    All normals meet in a point, no two pegs of one carrier touch, no four pegs touch, or no four hold the
    part.

    Parameters
    ----------
    line : of the program whose tools take most of the places for pegs away; None where none does.
    """
    if line is not None:
        clear = f"clear of the program's tools, of which line {line} is most in the way."
        return tuple(f"{reason[:-1]}, {clear}" for reason in wording.reasons) or (
            f"Every face that the program's tools leave, of which line {line} takes the most, is an arc about "
            "one centre, so the forces of all pegs meet in that point and nothing keeps the part from turning.",
            f"No {wording.two} can touch the part together {clear}",
            f"No {wording.four} can touch the part at the same time {clear}",
            f"Four pegs can touch the part at the same time, but no such set {wording.rules} {clear}",
        )
    return wording.reasons or (
        "Every face is an arc about one centre, so the forces of all pegs meet in that point and nothing "
        "keeps the part from turning.",
        f"No {wording.two} can touch the part together: the pitch is too large for it.",
        f"No {wording.four} can touch the part at the same time inside their faces.",
        f"Four pegs can touch the part at the same time, but no such set {wording.rules}.",
    )


def no_place_note(verified: int, wording: Wording, has_body_to_pass: bool = False) -> str:
    """Why a search finds no fixture though ``verified`` candidates are proven to hold the part.

    Parameters
    ----------
    has_body_to_pass : whether a clamp has a body that a program's tools have to pass as well.
    """
    also = ", and with its body clear of the program's tools" if has_body_to_pass else ""
    within = f"{wording.within}{also}"
    return f"{verified} {wording.sets} would hold the part, but none of them can stand in {within}."


def no_pair_note(seats: int, contacts: int) -> str:
    """Why no two clamps hold the part, from the numbers of seats and of clamps that touch it there."""
    if contacts == 0:
        return "No three locators and a clamp can touch the part at the same time inside their faces."
    if seats == 0:
        return (
            "Three locators and a clamp can touch the part, but there is no place for the second clamp that "
            "is needed."
        )
    return f"No two clamps press the part against all three locators at any of the {seats} seats found."


def asked_note(asked: Sequence[str]) -> str:
    """The remark on a search without a fixture that names what was asked for, if anything was.

    Parameters
    ----------
    asked : see ``Query.restricted_by``; what limits the hardware is named by an explanation.
    """
    return f"So it is with what was asked for: {listed(asked)}." if asked else ""


def left_notes(wording: Wording, asked: Sequence[str]) -> tuple[str, str]:
    """Why what was asked for leaves no fixture of a part with other faces, and of a lattice with other steps.

    They stand for the first two of :func:`no_fixture_notes`, which are about the part and the pitch alone.
    """
    return (
        f"With what was asked for ({listed(asked)}) every place that is left for a peg lies along arcs about "
        "one centre, so the forces of all pegs meet in that point and nothing keeps the part from turning.",
        f"With what was asked for ({listed(asked)}) no {wording.two} can touch the part together.",
    )


def best_note(best: int) -> str:
    """The remark on a search for the best fixtures only."""
    return f"Only the best {best} were sought, so how many fixtures there are in all was not counted."


def cut_note(found: int, listed: int) -> str:
    """The remark on a search that was stopped while its fixtures were sorted or written."""
    return (
        f"Stopped with {found:,} fixtures found: the best {listed:,} of them are listed; more would have "
        "taken long."
    )


def undecided_note(count: int) -> str:
    some = "1 candidate is undecided" if count == 1 else f"{count} candidates are undecided"
    return (
        f"{some}: it cannot be shown whether they are fixtures; the result's proof names them with the "
        "reason."
    )


def fitted_note(departure: float) -> str:
    """The remark on an outline that departs from the drawn one by up to ``departure`` mm."""
    return (
        "All that is claimed, completeness too, holds for the outline of lines and arcs, which is up to "
        f"{departure:.2g} mm off the drawn one."
    )


def kept_note(found: int, kept: int) -> str:
    """The remark on a server that keeps only the best of the fixtures found."""
    return f"{found:,} fixtures were found; this server keeps the best {kept:,} of them."


def chosen_note(found: int, chosen: int) -> str:
    """The remark on a result of which somebody kept some fixtures."""
    return f"Of {found:,} fixtures found, {chosen:,} were chosen to be listed."


def many_note(count: int, listed: int) -> str:
    """The remark on a search for everything that finds too many fixtures to list unasked."""
    return f"There are about {round_to_two_digits(count):,} fixtures: these are the best {listed:,}."


def round_to_two_digits(count: int) -> int:
    """A count of which two digits are known.

    >>> round_to_two_digits(2_247_282)
    2200000
    """
    return int(float(f"{count:.1e}"))


def seated_note(looked_at: int, kept: int) -> str:
    """The remark on a search that lists only fixtures seated as asked: ``kept`` of ``looked_at``."""
    return (
        f"The seating of the first {looked_at:,} fixtures was worked out: {kept:,} of them are as asked, and "
        "no other is listed. Of fixtures beyond these nothing is known, and some may be as asked: look at "
        "more of them to see."
    )


def by_hand_note() -> str:
    """The remark on seating asked for with two clamps, which is no figure to order fixtures by."""
    return (
        "With two clamps the part is pushed against its locators by hand, so fixtures are in the same order "
        "as without seating. How to put the part in is stated for each fixture."
    )


def stopped_note(seconds: float) -> str:
    """The remark on a search that a server ended after its time limit."""
    end = f"The search was stopped after {seconds:g} s, the longest this server allows"
    return f"{end}: this is a part of the fixtures only."
