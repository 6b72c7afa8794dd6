"""The figures of quality: names, units, which way is better (docs/quality.md), and orders of them.

Fixtures are ranked by an order of figures, which a user gives by names or by a preference. How figures are
computed is in ``statics.quality``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isnan
from typing import TypeVar

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.model.first_choice import HOUSE_ORDER, has_house_order
from workhold.model.requirements import Load

__all__ = [
    "CLAMP_AMPLIFICATION",
    "CLAMP_FREEDOM",
    "CLOSURE_MARGIN",
    "DEFAULT_RANKING",
    "EDGE_DISTANCE",
    "END_DISTANCE",
    "FIGURES",
    "JAW_CONTACT",
    "FIGURE_RANKING",
    "JAW_FORCE_NEEDED",
    "LOAD_REACTION",
    "LOCATION_ERROR",
    "PAIR_FIGURES",
    "PAIR_RANKING",
    "BEFORE_PINS",
    "COARSE_DIGITS",
    "PENALTY",
    "PIN_DEFLECTION",
    "PIN_FIGURES",
    "PIN_KEYS",
    "PIN_MOVEMENT",
    "PIN_STRESS",
    "PREFERENCES",
    "PROGRAM_CLEARANCE",
    "PROGRAM_FIGURE",
    "RANKED",
    "SEATING_FIGURES",
    "SMALLEST_FACE",
    "TILT",
    "WARNINGS",
    "WRENCH_RADIUS",
    "Figure",
    "Loaded",
    "read_asked_ranking",
    "resolve_ranking",
    "select_figure_column",
    "find_figure_number",
    "round_number_coarsely",
    "list_figures_in_columns",
    "adapt_ranking_to_loads",
    "list_known_figures",
    "to_tuple",
    "find_ranked_number",
    "fill_figure_rows",
    "to_words",
    "make_figure_key",
]

# Digits of figures that others come after in an order.
COARSE_DIGITS = 2
T = TypeVar("T")
# The loads, or whether there are any.
Loaded = Sequence[Load] | bool

# docs/quality.md, "Which comes first", says why. With loads the load reaction takes the place of the
# amplification.
FIGURE_RANKING = ("warnings", "penalty", "clamp_amplification", "closure_margin", "edge_distance")
# Of two clamps the one whose forces may differ most: it is set up without a torque wrench.
PAIR_FIGURES = (
    "warnings",
    "penalty",
    "clamp_freedom",
    "clamp_amplification",
    "closure_margin",
    "edge_distance",
)
DEFAULT_RANKING, PAIR_RANKING = (*HOUSE_ORDER, *FIGURE_RANKING), (*HOUSE_ORDER, *PAIR_FIGURES)
# Orders by what a user wants most.
PREFERENCES = {
    "square": ("warnings", "tilt", "penalty", "clamp_amplification", "closure_margin", "edge_distance"),
    "strong": ("warnings", "clamp_amplification", "closure_margin", "penalty", "edge_distance"),
    "precise": ("warnings", "location_error", "penalty", "clamp_amplification", "closure_margin"),
    "roomy": ("warnings", "edge_distance", "smallest_face", "penalty", "closure_margin"),
}


@frozen
class Figure:
    """A figure of quality.

    Parameters
    ----------
    key : name in files.
    unit : "" (a plain number), "mm", "N", "MPa" or "deg".
    more_is_better : whether a larger value is better.
    meaning : what it means, in one sentence.
    decimals : number of decimals shown; lengths have those of their unit.
    """

    key: str
    unit: str
    more_is_better: bool
    meaning: str
    decimals: int = 4

    @property
    def words(self) -> str:
        """Name in sentences: the key with spaces.

        >>> FIGURES[0].words
        'closure margin'
        """
        return self.key.replace("_", " ")

    def name_for(self, mover: str) -> tuple[str, str]:
        """Return (name, meaning) with the word "jaw" replaced by ``mover``.

        >>> FIGURES[1].name_for("clamp")
        ('clamp amplification', 'The largest peg force per unit of clamp force.')
        """
        return self.words.replace("jaw", mover), self.meaning.replace("jaw", mover)

    @property
    def option(self) -> str:
        """Name on the command line: the key with hyphens.

        >>> FIGURES[0].option
        'closure-margin'
        """
        return self.key.replace("_", "-")


FIGURES = (
    Figure("closure_margin", "", True, "The smallest share of a contact in holding the part."),
    Figure("clamp_amplification", "", False, "The largest peg force per unit of jaw force."),
    Figure("wrench_radius", "", True, "The smallest disturbance that a grip of unit forces does not resist."),
    Figure(
        "location_error", "mm", False, "The farthest a point of the part can be off when pegs and faces are."
    ),
    Figure("end_distance", "mm", True, "The smallest distance from a contact to the end of its face."),
    Figure("load_reaction", "N", False, "The largest peg force when the loads act and no peg lets go.", 1),
    Figure("edge_distance", "mm", True, "The smallest distance from a contact to an edge or another face."),
    Figure(
        "jaw_force_needed",
        "N",
        False,
        "The force of a jaw that its screw locks, above which no peg lets go under any load.",
        1,
    ),
    Figure(
        "tilt",
        "deg",
        False,
        "How far the part's main straight faces are from lying square, along x and y.",
        3,
    ),
    Figure(
        "smallest_face",
        "mm",
        True,
        "The smallest face touched: the length of a straight one, the radius of an arc.",
    ),
    Figure("warnings", "", False, "The number of warnings.", 0),
    Figure("penalty", "", False, "Points for location error, tilt, a strong peg and a small face.", 0),
    Figure(
        "clamp_freedom",
        "deg",
        True,
        "How much the forces of two clamps may differ: at 90 any two forces hold the part.",
        1,
    ),
    Figure(
        "jaw_contact",
        "mm",
        True,
        "How long the part lies on a flat jaw that has ends, from the first to the last point of contact.",
    ),
    Figure(
        "pin_deflection",
        "mm",
        False,
        "How far the peg that bends most gives way, at the jaw force or for each kN of it.",
    ),
    Figure(
        "pin_stress",
        "MPa",
        False,
        "The largest bending stress in a peg, at the jaw force or for each kN of it.",
        1,
    ),
    Figure(
        "pin_movement",
        "mm",
        False,
        "The farthest that bending pegs move a point of the part, at the jaw force or for each kN of it.",
    ),
)
CLOSURE_MARGIN, CLAMP_AMPLIFICATION, WRENCH_RADIUS, LOCATION_ERROR, END_DISTANCE, LOAD_REACTION = range(6)
EDGE_DISTANCE, JAW_FORCE_NEEDED, TILT, SMALLEST_FACE, WARNINGS, PENALTY, CLAMP_FREEDOM, JAW_CONTACT = range(
    6, 14
)
PIN_DEFLECTION, PIN_STRESS, PIN_MOVEMENT = range(14, 17)
# Those of how far pegs bend: at the jaw force, for each kN of it where none is known.
PIN_FIGURES = PIN_DEFLECTION, PIN_STRESS, PIN_MOVEMENT
PIN_KEYS = tuple(FIGURES[number].key for number in PIN_FIGURES)
# The figures that files had before there were these.
BEFORE_PINS = PIN_DEFLECTION

# Of the fixtures whose seating is asked for (docs/seating.md).
SEATING_FIGURES = (
    Figure(
        "capture_opening",
        "mm",
        True,
        "How far the jaws may stand open, or the clamp be drawn back, so that the part still "
        "settles in its place.",
    ),
    Figure("drop_room", "mm", True, "The room at every peg when they stand open so far."),
    Figure(
        "way_out",
        "mm",
        True,
        "How far the jaws open, or the clamp is drawn back, before the part can leave all pegs.",
    ),
    Figure(
        "placing",
        "mm",
        True,
        "How near to its place every point of the part must be put so that the part settles there.",
    ),
    Figure("sticking_friction", "", True, "The friction below which the part cannot stick near its place."),
    Figure(
        "wrong_seats", "", False, "The number of other places in which the same pegs can hold the part.", 0
    ),
    Figure(
        "reading",
        "mm",
        True,
        "The difference of opening, or of the clamp, that a measurement must resolve to show a wrong place.",
    ),
)
# Of fixtures that a program is asked to pass; it stands in the last column of their figures.
PROGRAM_FIGURE = Figure(
    "program_clearance", "mm", True, "The least distance of a tool from anything that holds the part."
)
PROGRAM_CLEARANCE = -1
# All figures that fixtures can be ranked by.
RANKED = (*FIGURES, *SEATING_FIGURES, PROGRAM_FIGURE)


def round_number_coarsely(value: float) -> float:
    """Return a number rounded to two significant digits; NaN and inf as they are."""
    return float(f"{value:.{COARSE_DIGITS - 1}e}")


def list_figures_in_columns(columns: int) -> tuple[Figure, ...]:
    """Return the figures in the columns of a table with this number of columns: :data:`FIGURES`, then the
    program clearance if one column is left.

    A table with fewer columns than :data:`FIGURES` has no figures of bending pegs.

    >>> list_figures_in_columns(len(FIGURES) + 1)[PROGRAM_CLEARANCE].words, list_figures_in_columns(BEFORE_PINS)[-1].words
    ('program clearance', 'jaw contact')
    """
    known = FIGURES if columns >= len(FIGURES) else FIGURES[:BEFORE_PINS]
    return known if columns == len(known) else (*known, PROGRAM_FIGURE)


def fill_figure_rows(quality: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return figures (N, F) with a column for each of :data:`FIGURES`; missing figures of bending pegs become
    NaN.

    A column of program clearance, if any, stays the last.
    """
    figures = list_figures_in_columns(quality.shape[1])
    if len(figures) >= len(FIGURES):
        return quality
    unknown = np.full((len(quality), len(PIN_FIGURES)), np.nan)
    return np.hstack([quality[:, :BEFORE_PINS], unknown, quality[:, BEFORE_PINS:]])


def select_figure_column(quality: NDArray[np.float64], figure: Figure) -> NDArray[np.float64]:
    """Return the column (N,) of a figure in figures (N, F); NaN if the table lacks it."""
    figures = list_figures_in_columns(quality.shape[1])
    return quality[:, figures.index(figure)] if figure in figures else np.full(len(quality), np.nan)


def list_known_figures(values: Sequence[float]) -> dict[str, float]:
    """Return the figures of one row of a table by key; those that are NaN are left out.

    >>> list_known_figures([0.25, *[float("nan")] * 16, 4.5])
    {'closure_margin': 0.25, 'program_clearance': 4.5}
    """
    named = zip(list_figures_in_columns(len(values)), values, strict=True)
    return {figure.key: float(value) for figure, value in named if not isnan(value)}


def find_figure_number(name: str) -> int | None:
    """Return the index in :data:`FIGURES` of a figure's name; None where it is not among them.

    Hyphens, underscores and spaces in the name mean the same.

    >>> find_figure_number("location-error")
    3
    """
    number = find_ranked_number(name)
    return None if number is None or number >= len(FIGURES) else number


def make_figure_key(name: str) -> str:
    """Return the key that a figure's name, as a user writes it, stands for.

    Hyphens, underscores and spaces mean the same.

    >>> make_figure_key("Location error")
    'location_error'
    """
    return name.strip().lower().replace("-", "_").replace(" ", "_")


def find_ranked_number(name: str) -> int | None:
    """Return the index in :data:`RANKED` of a figure's name; None where it is not among them.

    Hyphens, underscores and spaces in the name mean the same.

    >>> RANKED[find_ranked_number("capture opening")].option
    'capture-opening'
    """
    key = make_figure_key(name)
    return next((number for number, figure in enumerate(RANKED) if figure.key == key), None)


def to_words(value: Iterable[str] | None) -> tuple[str, ...] | None:
    """Return words as a tuple: a single string becomes a tuple of one; None stays None."""
    return value if value is None else (value,) if isinstance(value, str) else to_tuple("names", value)


def to_tuple(name: str, values: Iterable[T]) -> tuple[T, ...]:
    """Return the values of an iterable as a tuple; raise InputError if ``values`` is not iterable.

    ``name`` is the name of the values in the message.
    """
    try:
        return tuple(values)
    except TypeError as error:
        raise InputError(f"the {name} are not a list, but {values!r}: give several in a list.") from error


def resolve_ranking(
    names: Sequence[str] | None,
    loaded: Loaded,
    pairs: bool = False,
    seated: bool = False,
    ended: bool = False,
) -> tuple[str, ...]:
    """Return the keys of the figures to rank by, from names as a user writes them; the default ranking for
    None.

    ``loaded`` is the loads, or whether there are any; ``pairs`` says that two clamps press, ``seated`` that
    seating is asked for, ``ended`` that a flat jaw has ends. Names may begin with :data:`HOUSE_ORDER`, as in
    files. Raises InputError for an empty list, an unknown or repeated name, and a figure that is not known
    under these arguments.
    """
    if names is None:
        return adapt_ranking_to_loads(PAIR_RANKING if pairs else DEFAULT_RANKING, loaded)
    if has_house_order(names):
        figures = resolve_ranking(names[len(HOUSE_ORDER) :], loaded, pairs, seated)
        return (*HOUSE_ORDER, *figures)
    keys = []
    for name in names:
        number = find_ranked_number(name)
        if number is None:
            known = (*FIGURES, *(SEATING_FIGURES if seated else ()))
            raise InputError(
                f"{name!r} is not a figure to rank by: choose among {', '.join(f.option for f in known)}."
            )
        if RANKED[number] in SEATING_FIGURES and not seated:
            raise InputError(
                f"the {RANKED[number].words} is known only for fixtures whose seating is worked out: give "
                "their number, such as seating 100."
            )
        if number in (LOAD_REACTION, JAW_FORCE_NEEDED) and not loaded:
            raise InputError(
                f"there is no load to rank by the {FIGURES[number].words}: give at least one load."
            )
        if number == CLAMP_FREEDOM and not pairs:
            raise InputError(f"there is one clamp: nothing has a {FIGURES[number].words} to rank by.")
        if number == JAW_CONTACT and not ended:
            raise InputError(
                f"there is no {FIGURES[number].words} to rank by: give the width of the jaws of a vise with "
                "a flat one, or rank by others."
            )
        keys.append(RANKED[number].key)
    if not keys:
        raise InputError("there is no figure to rank by: name at least one, such as closure-margin.")
    if len(set(keys)) < len(keys):
        raise InputError(f"the figures to rank by, {', '.join(names)}, name one twice: name each once.")
    return tuple(keys)


def read_asked_ranking(
    names: str | Sequence[str] | None,
    preference: str | None,
    loaded: Loaded,
    has_program: bool = False,
) -> tuple[str, ...] | None:
    """Return the names of figures as given, or the keys for a preference; None where both are None.

    Raises
    ------
    InputError
        For both together, and as :func:`find_preferred_ranking`.
    """
    if preference is None:
        return to_words(names)
    if names is not None:
        raise InputError("figures to rank by and a preference are two orders: give one of them.")
    return find_preferred_ranking(preference, loaded, has_program)


def adapt_ranking_to_loads(ranking: tuple[str, ...], loaded: Loaded) -> tuple[str, ...]:
    """Return a ranking with the load reaction in place of the clamp amplification; unchanged without loads."""
    if not loaded:
        return ranking
    reaction, bare = FIGURES[LOAD_REACTION].key, FIGURES[CLAMP_AMPLIFICATION].key
    return tuple(reaction if key == bare else key for key in ranking)


def find_preferred_ranking(preference: str, loaded: Loaded, has_program: bool = False) -> tuple[str, ...]:
    """Return the keys of figures to rank by for one of :data:`PREFERENCES`: square, strong, precise or roomy.

    With a program, "roomy" ranks by the program clearance right after the warnings. Raises InputError for
    another word.
    """
    word = preference.strip().lower()
    if word not in PREFERENCES:
        raise InputError(f"the preference {preference!r} is not known: choose {', '.join(PREFERENCES)}.")
    order = PREFERENCES[word]
    if word == "roomy" and has_program:
        order = (order[0], PROGRAM_FIGURE.key, *order[1:])
    return adapt_ranking_to_loads(order, loaded)
