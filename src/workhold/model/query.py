"""A query: everything that is asked of a design, one type from the command line, Python and the page to the result."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite
from typing import Any

from attrs import field, frozen

from workhold.errors import InputError
from workhold.model.load import Load
from workhold.model.quality import CLOSURE_MARGIN, FIGURES, LOAD_REACTION, figure_number
from workhold.model.real import real
from workhold.model.restrictions import Restrictions
from workhold.model.tolerance import Tolerance
from workhold.model.toolkit import Toolkit
from workhold.model.workpiece import Workpiece

__all__ = ["DEFAULT_RANKING", "Query", "counting_number"]

# Repeatable first: a fixture that places every part alike; then strong: one that does not press the part out of shape.
DEFAULT_RANKING = ("location_error", "clamp_amplification", "closure_margin")
LOADED_RANKING = ("location_error", "load_reaction", "closure_margin")


def words(value: Iterable[str] | None) -> tuple[str, ...] | None:
    """Several words as a tuple; one word alone is not taken for its letters."""
    return value if value is None else (value,) if isinstance(value, str) else tuple(value)


def restrictions_of(value: Restrictions | None) -> Restrictions:
    """Restrictions, or none of them for None."""
    return Restrictions() if value is None else value


def tolerance_of(value: Tolerance | None) -> Tolerance:
    """A tolerance, or the usual one for None."""
    return Tolerance() if value is None else value


def loads_of(loads: Iterable[Load]) -> tuple[Load, ...]:
    """Loads as a tuple."""
    return tuple(loads)


@frozen
class Query:
    """What to hold, what to hold it in, and what is asked of the fixtures.

    Parameters
    ----------
    workpiece, toolkit : what to hold and what to hold it in.
    arrangements : names of the toolkit's arrangements to seek, such as "I" or ("I", "II"); None is all.
    contact_margin : smallest distance in mm between a contact and the end of its feature.
    restrictions : faces not to touch, places where no peg may stand, angles of the part; None is no restriction.
    ranking : figures of quality, the first counting most, named as in ``model.quality``; None is location error, then load
        reaction or, without loads, clamp amplification, then closure margin.
    tolerance : how far pegs and faces may be off, for the location error; None is the usual one.
    loads : what the fixture must resist, for the load reaction.
    best : seek and list only this many, the best ones; None lists all.

    Raises
    ------
    InputError
        For an unknown arrangement or figure, one named twice, numbers out of range, and the load reaction without loads.
    """

    workpiece: Workpiece
    toolkit: Toolkit
    arrangements: tuple[str, ...] = field(default=None, converter=words)
    contact_margin: float = 0.0
    restrictions: Restrictions = field(default=None, converter=restrictions_of)
    ranking: tuple[str, ...] = field(default=None, converter=words)
    tolerance: Tolerance = field(default=None, converter=tolerance_of)
    loads: tuple[Load, ...] = field(default=(), converter=loads_of)
    best: int | None = None

    def __attrs_post_init__(self) -> None:
        known = tuple(arrangement.name for arrangement in self.toolkit.arrangements)
        object.__setattr__(self, "arrangements", chosen_arrangements(self.arrangements, known))
        object.__setattr__(self, "ranking", chosen_ranking(self.ranking, self.loads))
        margin = self.contact_margin
        if not (isinstance(margin, int | float) and isfinite(real(margin)) and margin >= 0):
            raise InputError(f"contact margin {margin} is not a length: give 0 or more, in mm.")
        object.__setattr__(self, "contact_margin", float(margin))
        object.__setattr__(self, "best", counting_number("best", self.best))

    @property
    def by_margin_alone(self) -> bool:
        """Whether fixtures are ranked by the closure margin and nothing else, which a search can bound."""
        return self.ranking == (FIGURES[CLOSURE_MARGIN].key,)


def chosen_arrangements(names: Sequence[str] | None, known: Sequence[str]) -> tuple[str, ...]:
    """Names of arrangements in the toolkit's order; None is all of them.

    Raises
    ------
    InputError
        For a name that the toolkit does not have, and for none at all.
    """
    for name in names or ():
        if name not in known:
            raise InputError(f"type {name} is unknown: choose {' or '.join(known)}.")
    if names is not None and not names:
        raise InputError(f"there is no type to seek: choose {' or '.join(known)}.")
    return tuple(name for name in known if names is None or name in names)


def chosen_ranking(names: Sequence[str] | None, loads: Sequence[Load]) -> tuple[str, ...]:
    """Keys of the figures to rank by, from their names as a user writes them; None is the default ranking.

    Raises
    ------
    InputError
        For a name that is no figure, one given twice, none at all, and the load reaction without loads.
    """
    if names is None:
        return LOADED_RANKING if loads else DEFAULT_RANKING
    keys = []
    for name in names:
        number = figure_number(name)
        if number is None:
            raise InputError(f"{name!r} is no figure to rank by: choose among {', '.join(f.option for f in FIGURES)}.")
        if number == LOAD_REACTION and not loads:
            raise InputError("there is no load to rank by the load reaction: give at least one load.")
        keys.append(FIGURES[number].key)
    if not keys:
        raise InputError("there is no figure to rank by: name at least one, such as closure-margin.")
    if len(set(keys)) < len(keys):
        raise InputError(f"the figures to rank by, {', '.join(names)}, name one twice: name each once.")
    return tuple(keys)


def counting_number(name: str, value: Any) -> int | None:
    """A count from 1, or None.

    Raises
    ------
    InputError
        Naming what is counted, for anything else.
    """
    if value is None:
        return None
    try:
        if value == int(value) and value >= 1:
            return int(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{name} {value} is not a positive whole number.")
