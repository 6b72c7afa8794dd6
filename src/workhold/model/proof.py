"""What a proven search shows of itself: what was examined, and what could not be decided."""

from __future__ import annotations

from attrs import field, frozen

__all__ = ["AT_AN_EDGE", "GIVEN_UP", "NEARLY_DOUBLE", "UNBOUNDED", "Proof", "Undecided"]

# Why something is undecided.
GIVEN_UP = "two pegs on these faces fit in so many nearly equal ways that they cannot be told apart"
UNBOUNDED = "the pegs slide so easily along these faces that their places cannot be told"
NEARLY_DOUBLE = "the contacts are a double solution, or so nearly that its clamping force is not decided"
AT_AN_EDGE = "a rule is met exactly at its edge"


@frozen
class Undecided:
    """Four contacts, or a pair of chords, of which it is not decided whether they make a fixture; or five, with two clamps.

    Parameters
    ----------
    type : of the arrangement, with the direction in which a clamp moves, such as "II" or "clamp -x".
    faces : the four faces (a pair of chords names the tail and the head of each).
    columns, rows : the four pegs on their jaws' lattices, counted from each jaw's first peg and from the first left peg; of
        a clamp the number of its line from the first locator's, and 0.
    theta_deg : orientation of the workpiece in degrees, about which it would be.
    reason : why it is not decided, in one sentence without a full stop.
    reach_deg : how far in degrees the orientation may be from there; None where that is not bounded, and of a pair of
        chords, which exist there.
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
    """The account of a proven search; ``candidates`` is the sum of what was discarded, verified and left undecided.

    Parameters
    ----------
    cells : ranges of orientation examined, for each type apart.
    candidates : sets of four contacts that the bounds of the chord curves allow.
    discarded_by_bound : candidates that break a rule everywhere within their error.
    verified : candidates proven to be fixtures, before rows and the largest opening are asked; one found from two sides, as
        at a joint, counts twice.
    escalated : candidates that their certificates left open: they went on to interval arithmetic, or were given up.
    undecided : what that could not decide either.
    """

    cells: int
    candidates: int
    discarded_by_bound: int
    verified: int
    escalated: int
    undecided: tuple[Undecided, ...] = field(default=())
