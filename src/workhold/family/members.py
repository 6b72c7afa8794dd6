"""A member of a family: a part, or its other side, with the best fixture of each pattern that holds it.

A fixture is judged by its loss, and by whether it may be used at all. Turned over about its y axis for the
second operation, a part shows the mirrored outline. All data in the part's coordinates are mirrored too:
faces, zones, loads, and part zero, which stays the same point of the part.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, isfinite
from tempfile import TemporaryFile
from typing import Any

import numpy as np
from attrs import evolve, fields, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import FIGURE_DECIMALS
from workhold.errors import InputError
from workhold.family.jaw_setups import StopRange
from workhold.family.patterns import (
    encode_patterns,
    encode_zeros,
    map_carriers_by_half_turn,
    rotate_fixtures_by_half_turn,
)
from workhold.listing.canonical_form import mark_changes
from workhold.listing.ranking import measure_table
from workhold.model.fixture_table import FixtureTable
from workhold.model.jaw_hold import HOLD_FIGURES, JawHold
from workhold.model.quality import (
    FIGURE_RANKING,
    FIGURES,
    PAIR_FIGURES,
    Figure,
    find_figure_number,
    make_figure_key,
    select_figure_column,
)
from workhold.model.query import Query
from workhold.model.requirements import (
    ANY_DIRECTION,
    Load,
    Restrictions,
    Tolerance,
    lie_in_angle_ranges,
    make_zone,
)
from workhold.model.result import Result
from workhold.model.setup import PartZero, choose_part_zero
from workhold.model.workpiece import Workpiece
from workhold.statics.effective_error import EffectiveErrors
from workhold.statics.judging import are_unfit

__all__ = [
    "OTHER_SIDE",
    "RANKINGS",
    "Member",
    "FigureThreshold",
    "describe_loss",
    "describe_loss_figure",
    "format_loss",
    "compute_losses",
    "are_usable",
    "make_member",
    "make_other_side_query",
    "make_threshold",
    "mirror_zero",
]

# A family is asked for what it loses in location; after that what a machinist looks at counts, by how many
# things move.
LOCATION = "location_error"
RANKINGS = {1: (LOCATION, *FIGURE_RANKING), 2: (LOCATION, *PAIR_FIGURES)}
# Losses are rounded to this number of decimals.
LOSS_DECIMALS = 9


@frozen
class FigureThreshold:
    """A limit of a figure that every fixture in use must keep.

    Parameters
    ----------
    figure : which figure.
    value : the largest allowed value, or the smallest where more is better; in the figure's unit.
    """

    figure: Figure
    value: float

    def find_reaching(self, values: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return (N,) booleans: whether each of the values (N,) of the figure reaches the threshold; NaN does not."""
        rounded = np.round(values, FIGURE_DECIMALS)
        return np.asarray(rounded >= self.value if self.figure.more_is_better else rounded <= self.value)


def make_threshold(name: str, value: float) -> FigureThreshold:
    """Return the threshold of a figure; ``name`` is the figure's name as a user writes it.

    Raises
    ------
    InputError
        For a name that is neither a figure of pegs nor one of flat jaws.
    """
    number, key = find_figure_number(name), make_figure_key(name)
    between_jaws = next((figure for figure in HOLD_FIGURES if figure.key == key), None)
    if number is None and between_jaws is None:
        raise InputError(
            f"{name!r} is not a figure: choose among {', '.join(figure.option for figure in FIGURES)}, or for a plain "
            f"vise among {', '.join(figure.option for figure in HOLD_FIGURES)}."
        )
    return FigureThreshold(between_jaws or FIGURES[number or 0], value)


def describe_loss_figure(figure: Figure) -> str:
    """Return the name of the figure of which losses are computed; "effective location error" for the location
    error.
    """
    return f"effective {figure.words}" if figure.key == LOCATION else figure.words


def describe_loss(figure: Figure, inside: str) -> str:
    """Return a sentence that says what the loss is; ``inside`` are words such as "in this vise".

    >>> describe_loss(FIGURES[0], "in this vise")
    'The loss is the best closure margin that each part has in this vise, divided by the closure margin.'
    """
    words = describe_loss_figure(figure)
    if figure.more_is_better:
        return f"The loss is the best {words} that each part has {inside}, divided by the {words}."
    return f"The loss is the {words} divided by the best that each part has {inside}."


def compute_losses(values: NDArray[np.float64], figure: Figure) -> NDArray[np.float64]:
    """Return the losses (N,), 1 or more, of values (N,) of a figure.

    A loss is the ratio of the value to the best value, or its inverse where more is better. It is 1 for a
    value equal to the best one, and inf for NaN and where the ratio is not finite and positive.
    """
    values = np.round(values, FIGURE_DECIMALS)
    known = values[~np.isnan(values)]
    if len(known) == 0:
        return np.full(len(values), np.inf)
    best = known.max() if figure.more_is_better else known.min()
    bests = np.full(len(values), best)
    above, below = (bests, values) if figure.more_is_better else (values, bests)
    usable = (below > 0.0) & np.isfinite(above) & np.isfinite(below)
    ratio = np.full(len(values), np.inf)
    np.divide(above, below, out=ratio, where=usable)
    return np.where(values == best, 1.0, np.maximum(np.round(ratio, LOSS_DECIMALS), 1.0))


def format_loss(loss: float) -> str:
    """Return a loss as text with three decimals, rounded up so that it is never too small; "any" for inf.

    >>> format_loss(1.0), format_loss(1.1871), format_loss(float("inf"))
    ('1.000', '1.188', 'any')
    """
    return f"{ceil(loss * 1000 - 1e-6) / 1000:.3f}" if isfinite(loss) else "any"


def are_usable(
    table: FixtureTable, thresholds: Sequence[FigureThreshold], tolerance: Tolerance, with_unfit: bool
) -> NDArray[np.bool_]:
    """Return (N,) booleans: whether each fixture reaches every threshold and is fit for a workshop.

    With ``with_unfit`` unfit fixtures pass as well.
    """
    good = np.ones(len(table), np.bool_) if with_unfit else ~are_unfit(table.quality, tolerance)
    for one in thresholds:
        good &= one.find_reaching(select_figure_column(table.quality, one.figure))
    return good


# What stands behind the name of a part that is turned over.
OTHER_SIDE = "side 2"


def mirror_loop(loop: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vertices (N, 3) of x, y and bulge mirrored at x = 0, in the same order."""
    return np.asarray(loop * np.array([-1.0, 1.0, -1.0]) + 0.0)


def mirror_load(load: Load) -> Load:
    """Return a load in the frame of the part turned over about its y axis."""
    low, high = load.directions
    directions = ANY_DIRECTION if (low, high) == ANY_DIRECTION else (180.0 - high, 180.0 - low)
    return evolve(
        load, points=[(-x, y) for x, y in load.points], directions=directions, moment=0.0 - load.moment
    )


def renumber_segments(workpiece: Workpiece) -> dict[int, int]:
    """Return the new number of each segment after the part is turned over, which reverses its loops."""
    out, first = dict[int, int](), 0
    for loop in workpiece.loops:
        out |= {first + k: first + len(loop) - 1 - k for k in range(len(loop))}
        first += len(loop)
    return out


def make_other_side_query(query: Query, read: Workpiece | None = None) -> Query:
    """Return the query for the part turned over about its y axis; angles in the vise stay as they are.

    Parameters
    ----------
    read : the other side of a solid, as its file was read with the opposite axis up; None for a drawing.

    Raises
    ------
    InputError
        For an outline taken at the height of the pegs only, because the other side may have another outline.

    Examples
    --------
    >>> from workhold import Vise, Workpiece
    >>> part = Workpiece.from_loops("wedge", [[[0, 0, 0], [40, 0, 0], [10, 30, 0]]])
    >>> vise = Vise(pitch=10, columns=1, peg_radius=3)
    >>> turned = make_other_side_query(Query(part, vise, restrictions=Restrictions(avoid=(1,))))
    >>> turned.workpiece.name, turned.workpiece.loops[0][:, 0].tolist(), turned.restrictions.avoid
    ('wedge, side 2', [0.0, -10.0, -40.0], (1,))
    """
    part, asked, called = query.workpiece, query.restrictions, f"{query.workpiece.name}, {OTHER_SIDE}"
    if read is not None:
        workpiece = evolve(read, name=called)
        avoid, touch = (
            read.numbered.list_segments_under(part.numbered.list_faces_over(faces))
            for faces in (asked.avoid, asked.touch)
        )
    elif part.solid is not None:
        raise InputError(
            f"{part.name} is an outline at the height of pegs, and on its other side it has another: give "
            "both sides as parts of their own."
        )
    else:
        loops = [mirror_loop(loop) for loop in part.loops]
        workpiece = Workpiece.from_loops(called, loops, departure=part.departure)
        numbers = renumber_segments(part)
        # A number that no face has is refused where the part as it is drawn is asked for.
        avoid, touch = (
            [numbers.get(number, number) for number in faces] for faces in (asked.avoid, asked.touch)
        )
    return evolve(
        query,
        workpiece=workpiece,
        restrictions=Restrictions(
            avoid=avoid,
            zones=[make_zone(mirror_loop(zone.loop).tolist()) for zone in asked.zones],
            angles=asked.angles,
            touch=touch,
        ),
        loads=[mirror_load(load) for load in query.loads],
    )


def mirror_zero(zero: PartZero) -> PartZero:
    """Return part zero, the same point of the part, in the frame of the part turned over about its y axis."""
    x, y = zero.point
    return PartZero((0.0 - x, y), zero.words)


IntArray = NDArray[np.int64]

# Bytes of fixtures of one member that are kept in memory; more of them are kept in a file without a name.
IN_MEMORY = 1 << 24


@frozen(eq=False)
class Member:
    """A part of a family.

    Parameters
    ----------
    name : unique name of the part in the family.
    path : its file, "" where there is none.
    digest : SHA-256 of that file in hexadecimal, "" where there is none.
    query : query for its fixtures.
    zero : its part zero.
    fixtures : number of its fixtures.
    patterns : number of patterns that hold it, a pattern and its half turn counted once.
    best : the best value of the figure of which losses are computed; NaN where it has no fixture.
    words : (P, W) the P patterns that hold it, in lexicographic order.
    loss : (P,) of each pattern.
    number : (P,) index, from 0, of the best fixture with each pattern in the list of all fixtures.
    turned : (P,) whether that fixture gets the pattern only by half a turn of everything.
    table : the P fixtures in their patterns: as listed, or after half a turn of everything.
    figure : of which losses are computed.
    holds : how flat jaws hold the part in each of the P fixtures; empty with pegs.
    stop_ranges : where the tip of a work stop can stop the part in each of them; empty with pegs.
    """

    name: str
    path: str
    digest: str
    query: Query
    zero: PartZero
    fixtures: int
    patterns: int
    best: float
    words: IntArray
    loss: NDArray[np.float64]
    number: IntArray
    turned: NDArray[np.bool_]
    table: FixtureTable
    figure: Figure
    holds: tuple[JawHold, ...] = ()
    stop_ranges: tuple[StopRange, ...] = ()


def make_member(
    name: str,
    result: Result,
    thresholds: Sequence[FigureThreshold] = (),
    unfit: bool = False,
    path: str = "",
    digest: str = "",
    zero: PartZero | None = None,
    same_zero: bool = False,
) -> Member:
    """Return the member for a part, from the complete result of its query.

    Parameters
    ----------
    thresholds, unfit : which fixtures may be used, see ``family.members.are_usable``.
    zero : part zero; None for the usual one.
    same_zero : whether fixtures count as of one pattern only if part zero and the part's turn agree as well.

    Raises
    ------
    InputError
        When the disk has no room for its fixtures.
    """
    query = result.query
    figure = FIGURES[find_figure_number(query.rank_by[0]) or 0]
    table, number = add_half_turns(result.table, query)
    values = select_figure_column(table.quality, figure)
    if figure.key == LOCATION:
        # A part that is held to a hundredth, but aslant, is not held well.
        values = EffectiveErrors.from_query(query).compute_errors(table)
    good = are_usable(table, (), query.tolerance, unfit)
    loss = np.full(len(table), np.inf)
    loss[good] = compute_losses(values[good], figure)
    best = float(values[good][np.argmin(loss[good])]) if good.any() else float("nan")
    used = np.flatnonzero(good & are_usable(table, thresholds, query.tolerance, unfit))
    words, cost, turn = encode_patterns(table.take(used), query.toolkit), loss[used], used >= len(result)
    count = count_distinct_patterns(words, number[used], turn)
    zero = choose_part_zero(query.workpiece) if zero is None else zero
    if same_zero:
        words = np.concatenate([words, encode_zeros(table.take(used), query.toolkit, zero)], axis=1)
    # Rows are ranked, and sorting keeps that order: of equal losses the first is the best.
    order = np.lexsort([cost, *words.T[::-1]])
    first = order[mark_changes(list(words[order].T))]
    kept = spill_to_disk(table.take(used[first]))
    chosen = words[first], cost[first], number[used[first]], turn[first], kept
    return Member(name, path, digest, query, zero, len(result), count, best, *chosen, figure)


def count_distinct_patterns(words: IntArray, number: IntArray, turn: NDArray[np.bool_]) -> int:
    """Return the number of distinct patterns among rows (N, W), a pattern and its half turn counted once.

    ``number`` (N,) is the fixture of each row. ``turn`` (N,) says whether the row is the half turn of that
    fixture.
    """
    ahead = np.full((int(number.max(initial=-1)) + 1, words.shape[1]), np.iinfo(np.int64).max)
    # What comes first is the smaller of the two of each fixture, whatever the order in which they are given.
    for some in (~turn, turn):
        one, other = words[some], ahead[number[some]]
        differs = one != other
        place, rows = differs.argmax(axis=1), np.arange(len(one))
        ahead[number[some]] = np.where((one[rows, place] < other[rows, place])[:, None], one, other)
    used = ahead[np.unique(number)]
    order = np.lexsort(used.T[::-1])
    return int(mark_changes(list(used[order].T)).sum())


def add_half_turns(table: FixtureTable, query: Query) -> tuple[FixtureTable, IntArray]:
    """Return (table, indices (N,)): the fixtures followed by their images under half a turn of everything.

    The indices are those of each row's fixture in the given table. A fixture has an image if the half turn
    keeps its arrangement, no hole is blocked, and the image's angle is allowed.
    """
    toolkit = query.toolkit
    tables, numbers = [table], [np.arange(len(table))]
    blocked = any(plate.blocked for plate in toolkit.plates)
    for arrangement in range(len(toolkit.arrangements)):
        places = map_carriers_by_half_turn(toolkit, arrangement)
        if blocked or places is None:
            continue
        kind = table.arrangement == arrangement
        number = np.flatnonzero(kind & are_at_allowed_angle(np.degrees(table.theta) + 180.0, query))
        if len(number):
            after = rotate_fixtures_by_half_turn(table.take(number), toolkit)
            # Where another jaw stands still the location error changes; the locators of a plate stay what
            # they are.
            tables.append(after if places[0] == 0 else measure_table(after, Problem.from_query(query)))
            numbers.append(number)
    return FixtureTable.concatenate(tables), np.concatenate(numbers)


def are_at_allowed_angle(degrees: NDArray[np.float64], query: Query) -> NDArray[np.bool_]:
    """Return (N,) booleans: whether each angle in degrees lies in an allowed range of the query.

    All are True when the query has no ranges.
    """
    return np.asarray(lie_in_angle_ranges(degrees, query.restrictions.angles))


def spill_to_disk(table: FixtureTable) -> FixtureTable:
    """Return the table; for a large one, an equal table whose columns are mapped from a temporary file.

    Raises
    ------
    InputError
        When the disk has no room for temporary files.
    """
    if sum(column.nbytes for column in table.columns) < IN_MEMORY:
        return table
    names = [one.name for one in fields(FixtureTable)]
    kinds: list[tuple[Any, ...]] = [
        (name, column.dtype, column.shape[1:]) for name, column in zip(names, table.columns, strict=True)
    ]
    rows = np.empty(len(table), np.dtype(kinds))
    for name, column in zip(names, table.columns, strict=True):
        rows[name] = column
    try:
        with TemporaryFile() as stream:
            rows.tofile(stream)
            stream.flush()
            mapped = np.memmap(stream, rows.dtype, "r", shape=rows.shape)
    except OSError as error:
        raise InputError(f"there is no room for temporary files: {error.strerror or error}.") from error
    return FixtureTable(*(mapped[name] for name in names))
