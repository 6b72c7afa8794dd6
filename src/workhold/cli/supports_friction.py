"""What ``supports --friction`` says: a line of its own, which ranks nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.support_triples import Supports

__all__ = ["friction_words", "with_friction"]


def with_friction(found: Supports, count: int | None, friction: float | None) -> list[float]:
    """The least clamp forces in N with friction, of the sets that are listed; none where it is not asked for.

    Raises
    ------
    InputError
        For a coefficient that is too large, and where there is no load.
    """
    if friction is None:
        return []
    if not found.loads:
        raise InputError("--friction is asked of loads, of which there are none: give --load too.")
    return [found.clamp_with_friction(friction, rank) for rank in range(1, len(found.triples[:count]) + 1)]


def friction_words(friction: float, helped: list[float]) -> str:
    """Says what friction could add to the sets that are listed.

    Parameters
    ----------
    friction : its coefficient.
    helped : least clamp forces in N, one for each set.
    """
    forces = ", ".join(f"{force:.0f} N" for force in helped)
    sets = "that set" if len(helped) == 1 else "these sets, in their order,"
    return (
        f"With a friction of {friction:g} at every contact the clamp of {sets} could do with {forces} at "
        "best. With friction the forces are not determined: clamp for the force without it."
    )
