"""What the command says of supports: their sizes, why there are none, and what friction could add."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.support_triples import Supports
    from workhold.units import Unit

__all__ = ["friction_words", "size_notes", "with_friction"]


def runs_of(numbers: Sequence[int]) -> str:
    """Rising numbers in words, three and more that follow one another as a range.

    Examples
    --------
    >>> runs_of([1, 3, 4, 6, 7, 8, 20])
    '1, 3, 4, 6 to 8, 20'
    """
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = (f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs)
    return ", ".join(words)


def size_notes(
    found: Sequence[Supports], usual: Sequence[Supports], bare: Sequence[int], unit: Unit
) -> list[str]:
    """Says of which sizes the supports of some fixtures are, and why some have none.

    Parameters
    ----------
    found, usual : of each fixture in order; those that are listed, and those of the usual sizes.
    bare : ranks of those without supports among the listed ones.
    """
    from workhold.supports.words import why_no_set

    pad, tip = unit.text(found[0].request.pad_radius), unit.text(found[0].request.tip_radius)
    if len(bare) == len(found):
        larger = unit.text(usual[0].request.pad_radius)
        sizes = f"pads of radius {pad}" if found is usual else f"pads of radius {larger} down to {pad}"
        which = "usual" if found is usual else "least"
        return [
            f"Under {runs_of(bare)} no three hold the part, with {sizes}.",
            f"Under {bare[0]}, with the {which}: {why_no_set(found[0], unit)}",
        ]
    notes = [
        f"Pads of radius {pad} and a tip of radius {tip}; the command supports lists more, with other sizes."
    ]
    if bare:
        notes.append(f"Under {runs_of(bare)} no three hold the part.")
    if found is not usual:
        notes.append(
            f"Larger ones hold the part under none of these, so under 1: {why_no_set(usual[0], unit)}"
        )
    elif bare:
        notes.append(f"Under {bare[0]}: {why_no_set(found[bare[0] - 1], unit)}")
    return notes


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
