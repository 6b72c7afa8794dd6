"""The order in which fixtures are preferred, and the factors by which drawbacks of a fixture count against
it.

The order is lexicographic (docs/quality.md, "Which comes first"): unfit; warned or not; steps of the
effective location error above the best; the angle; figures of quality; identity. The effective location error
is the location error times all factors below that apply to the fixture. The factors are data, each with its
reason.
"""

from __future__ import annotations

from collections.abc import Sequence

from attrs import frozen

__all__ = [
    "FACTORS",
    "HOUSE_ORDER",
    "ErrorFactor",
    "list_ranking_figures",
    "has_house_order",
]

# What an order begins with where nobody names another: a warning, k, and the angle as written.
HOUSE_ORDER = ("warned", "error_steps", "angle")


@frozen
class ErrorFactor:
    """A factor by which a drawback of a fixture increases its location error in the ranking.

    Parameters
    ----------
    key : its name.
    times : the factor.
    words : the drawback, as words that follow "it is" or "it has".
    reason : why the drawback counts, in one sentence.
    """

    key: str
    times: float
    words: str
    reason: str


FACTORS = (
    ErrorFactor(
        "quarter_turn",
        1.05,
        "turned by 90°, 180° or 270°",
        "The program has to be turned as well, or the part is put in wrong; equal jaws do not need the turn.",
    ),
    ErrorFactor(
        "other_angle",
        1.5,
        "turned aslant",
        "A square or an indicator along the machine's axes cannot square the part up.",
    ),
    ErrorFactor(
        "face_end",
        1.1,
        "touched near the end of a straight face",
        "Half of a peg stands past the face there, where edges are broken and blanks are sawn.",
    ),
    ErrorFactor(
        "clamp_in_hole",
        1.25,
        "clamped from inside a hole",
        "The clamp stands where the hole is machined, it is hard to reach, and chips collect there.",
    ),
    ErrorFactor(
        "dowel_in_bore",
        1.1,
        "located from inside a hole",
        "The hole must already be there and true, and the part must be threaded over the dowel.",
    ),
    ErrorFactor(
        "hangs_over",
        1.1,
        "hanging over the plate",
        "The overhang is not supported under the tool, and it is in the way beside the plate.",
    ),
)


def has_house_order(ranking: Sequence[str]) -> bool:
    """Return whether an order begins with the keys "warned", "error_steps", "angle" (:data:`HOUSE_ORDER`)."""
    return tuple(ranking[: len(HOUSE_ORDER)]) == HOUSE_ORDER


def list_ranking_figures(ranking: Sequence[str]) -> tuple[str, ...]:
    """Return the keys in an order of figures that follow :data:`HOUSE_ORDER`.

    Where the order does not begin with it, all keys are returned.

    >>> list_ranking_figures(("warned", "error_steps", "angle", "penalty"))
    ('penalty',)
    """
    return tuple(ranking[len(HOUSE_ORDER) :] if has_house_order(ranking) else ranking)
