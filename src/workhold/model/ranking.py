"""Which fixture comes first: the orders of figures that a query knows, by name or by what a user prefers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

from workhold.errors import InputError
from workhold.model.quality import (
    CLAMP_AMPLIFICATION,
    CLAMP_FREEDOM,
    FIGURES,
    JAW_FORCE_NEEDED,
    LOAD_REACTION,
    PROGRAM_FIGURE,
    RANKED,
    SEATING_FIGURES,
    ranked_number,
)
from workhold.model.requirements import Load

__all__ = [
    "DEFAULT_RANKING",
    "PAIR_RANKING",
    "PREFERENCES",
    "Loaded",
    "asked_ranking",
    "chosen_ranking",
    "for_loads",
    "listed",
    "words",
]

T = TypeVar("T")
# The loads, or whether there are any.
Loaded = Sequence[Load] | bool

# docs/quality.md, "Which comes first", says why. With loads the load reaction is in third place.
DEFAULT_RANKING = ("warnings", "penalty", "clamp_amplification", "closure_margin", "edge_distance")
# Of two clamps the one whose forces may differ most: it is set up without a torque wrench.
PAIR_RANKING = (
    "warnings",
    "penalty",
    "clamp_freedom",
    "clamp_amplification",
    "closure_margin",
    "edge_distance",
)
# Orders by what a user wants most.
PREFERENCES = {
    "square": ("warnings", "tilt", "penalty", "clamp_amplification", "closure_margin", "edge_distance"),
    "strong": ("warnings", "clamp_amplification", "closure_margin", "penalty", "edge_distance"),
    "precise": ("warnings", "location_error", "penalty", "clamp_amplification", "closure_margin"),
    "roomy": ("warnings", "edge_distance", "smallest_face", "penalty", "closure_margin"),
}


def words(value: Iterable[str] | None) -> tuple[str, ...] | None:
    """Several words as a tuple; one word alone is not taken for its letters."""
    return value if value is None else (value,) if isinstance(value, str) else listed("names", value)


def listed(name: str, values: Iterable[T]) -> tuple[T, ...]:
    """Some values as a tuple.

    Raises
    ------
    InputError
        When it is something else than several values.
    """
    try:
        return tuple(values)
    except TypeError as error:
        raise InputError(f"the {name} are no list, but {values!r}: give several in a list.") from error


def chosen_ranking(
    names: Sequence[str] | None, loaded: Loaded, pairs: bool = False, seated: bool = False
) -> tuple[str, ...]:
    """Keys of the figures to rank by, from their names as a user writes them; None is the default ranking.

    Raises
    ------
    InputError
        For a name that is no figure, one given twice, and none at all. Also for a figure of loads without
        loads, of two clamps where there is one, and of seating where that is not asked for.
    """
    if names is None:
        return for_loads(PAIR_RANKING if pairs else DEFAULT_RANKING, loaded)
    keys = []
    for name in names:
        number = ranked_number(name)
        if number is None:
            known = (*FIGURES, *(SEATING_FIGURES if seated else ()))
            raise InputError(
                f"{name!r} is no figure to rank by: choose among {', '.join(f.option for f in known)}."
            )
        if RANKED[number] in SEATING_FIGURES and not seated:
            raise InputError(
                f"the {RANKED[number].words} is known of fixtures whose seating is worked out: give of how "
                "many, such as seating 100."
            )
        if number in (LOAD_REACTION, JAW_FORCE_NEEDED) and not loaded:
            raise InputError(
                f"there is no load to rank by the {FIGURES[number].words}: give at least one load."
            )
        if number == CLAMP_FREEDOM and not pairs:
            raise InputError(f"there is one clamp: nothing has a {FIGURES[number].words} to rank by.")
        keys.append(RANKED[number].key)
    if not keys:
        raise InputError("there is no figure to rank by: name at least one, such as closure-margin.")
    if len(set(keys)) < len(keys):
        raise InputError(f"the figures to rank by, {', '.join(names)}, name one twice: name each once.")
    return tuple(keys)


def asked_ranking(
    names: str | Sequence[str] | None,
    preference: str | None,
    loaded: Loaded,
    has_program: bool = False,
) -> tuple[str, ...] | None:
    """The names of figures given, or the keys for a preference; None, the default, where both are None.

    Raises
    ------
    InputError
        For both together, and as :func:`preferred_ranking`.
    """
    if preference is None:
        return words(names)
    if names is not None:
        raise InputError("figures to rank by and a preference are two orders: give one of them.")
    return preferred_ranking(preference, loaded, has_program)


def for_loads(ranking: tuple[str, ...], loaded: Loaded) -> tuple[str, ...]:
    """An order with the load reaction instead of the clamp amplification where there are loads."""
    if not loaded:
        return ranking
    reaction, bare = FIGURES[LOAD_REACTION].key, FIGURES[CLAMP_AMPLIFICATION].key
    return tuple(reaction if key == bare else key for key in ranking)


def preferred_ranking(preference: str, loaded: Loaded, has_program: bool = False) -> tuple[str, ...]:
    """Keys of the figures to rank by for what a user wants most: square, strong, precise or roomy.

    With a program a roomy fixture is first of all one that its tools pass by far.

    Raises
    ------
    InputError
        For any other word.
    """
    word = preference.strip().lower()
    if word not in PREFERENCES:
        raise InputError(f"{preference!r} is nothing to prefer: choose {', '.join(PREFERENCES)}.")
    order = PREFERENCES[word]
    if word == "roomy" and has_program:
        order = (order[0], PROGRAM_FIGURE.key, *order[1:])
    return for_loads(order, loaded)
