"""Members of a family in a plain vise: which parallels and which work stop hold a part, and how well.

Every way to hold the part between the jaws is known. One may be used where the part lies flat on both jaws, they
press all over what they touch, and the vise is strong enough. Of these only the fittest count, as a machinist
would take no other: something stands above the jaws, the jaws leave as much of a raw block's finished sides free as
any parallels do, and the part is square to its drawing. A part that has none such is held as well as it can be.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, nan

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.family.jaw_setups import JawSetUp, StopRange, is_stop_clear, measure_stop_range
from workhold.family.members import FigureThreshold, Member, compute_losses
from workhold.family.patterns import encode_places
from workhold.listing.canonical_form import mark_changes
from workhold.model.first_choice import has_house_order
from workhold.model.jaw_hold import HOLD_FIGURES, HOLD_RANKING, JawHold
from workhold.model.pose import Pose
from workhold.model.quality import Figure, round_number_coarsely
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.setup import PartZero
from workhold.search.jaw_search import is_square, make_fitness_key, weigh_force

__all__ = ["PartInVise", "choose_hold_figure", "judge_holds", "make_jaw_members"]

BY_KEY = {figure.key: figure for figure in HOLD_FIGURES}
# Figures that count to two digits, as in the list: nobody takes a part the other way round for one percent.
COARSE = ("clamp_needed", "contact_area", "max_pressure")
# N. Nobody closes a vise with less, so less force needed counts as this.
LEAST_FORCE = 500.0
# How many of the first entries of a fitness key say that a hold is not to be used at all.
UNUSABLE = 3


def choose_hold_figure(queries: Sequence[Query]) -> Figure:
    """Return the figure of which the losses of parts in a plain vise are computed.

    It is the first figure by which they are ranked. In the usual order it is the jaw force needed where all parts
    have loads or a program with forces, else the height of the grip.

    Raises
    ------
    InputError
        Where losses of the jaw force are asked for, and a part has no loads.
    """
    ranking = queries[0].rank_by
    asked = None if ranking == HOLD_RANKING or has_house_order(ranking) else ranking[0]
    loaded = [query.is_loaded for query in queries]
    if asked in ("clamp_needed", "slip_reserve", "safety_reached", "max_pressure") and not all(loaded):
        name = queries[loaded.index(False)].workpiece.name
        raise InputError(
            f"{name} has no loads, and all parts are to be compared by the {BY_KEY[asked].words}: give it loads or a "
            "program with cutting forces, or rank by another figure."
        )
    if asked in BY_KEY:
        return BY_KEY[asked]
    return BY_KEY["clamp_needed" if all(loaded) else "grip"]


@frozen(eq=False)
class PartInVise:
    """A part with every way to hold it in a plain vise.

    Parameters
    ----------
    name, path, digest, zero : as of a :class:`workhold.family.members.Member`.
    result : the complete result of its query.
    loss : (N,) loss of each fixture; inf where it is not to be used.
    used : (U,) indices of the fixtures that may be used and keep every threshold.
    best : the best value of the figure of which losses are computed; NaN where none may be used.
    reason : why no fixture may be used, words after "it"; "" where one may.
    """

    name: str
    path: str
    digest: str
    zero: PartZero
    result: Result
    loss: NDArray[np.float64]
    used: NDArray[np.int64]
    best: float
    reason: str = ""

    def get_hold(self, number: int) -> JawHold:
        """Return the hold of a fixture by its index."""
        hold = self.result.holds[number]
        assert isinstance(hold, JawHold)
        return hold

    def get_pose(self, number: int) -> Pose:
        """Return the pose of a fixture by its index."""
        table = self.result.table
        return Pose(float(np.degrees(table.theta[number])), *map(float, table.position[number]))

    def measure_stop_ranges(self) -> dict[int, StopRange]:
        """Return by index of the used fixtures the range in which a work stop's tip can stop the part."""
        query = self.result.query
        jaws = query.toolkit.flat_jaws
        assert jaws is not None
        held = ((number, self.get_hold(number), self.get_pose(number)) for number in self.used.tolist())
        return {number: measure_stop_range(query, jaws, hold, pose) for number, hold, pose in held}


def judge_holds(
    name: str,
    result: Result,
    figure: Figure,
    thresholds: Sequence[FigureThreshold] = (),
    unfit: bool = False,
    path: str = "",
    digest: str = "",
    zero: PartZero | None = None,
) -> PartInVise:
    """Return a part with the losses of the ways to hold it, from the complete result of its query.

    Parameters
    ----------
    figure : of which losses are computed.
    thresholds : limits that a hold must keep to be used.
    unfit : whether every hold may be used, fit or not.
    zero : part zero; None for the usual one.
    """
    from workhold.model.setup import choose_part_zero

    query = result.query
    holds = [hold for hold in result.holds if isinstance(hold, JawHold)]
    keys = [
        (*make_fitness_key(hold, query), not is_square(theta))
        for hold, theta in zip(holds, result.table.theta.tolist(), strict=True)
    ]
    usable = [key for key in keys if unfit or not any(key[:UNUSABLE])]
    good = np.array([unfit or key == min(usable, default=None) for key in keys], np.bool_)
    values = np.array([read_value(hold, figure) for hold in holds], np.float64)
    ranked = [
        get_value_for_loss(value, figure, theta)
        for value, theta in zip(values.tolist(), result.table.theta.tolist(), strict=True)
    ]
    loss = np.full(len(holds), inf)
    loss[good] = compute_losses(np.array(ranked)[good], figure)
    best = float(values[good][np.argmin(loss[good])]) if good.any() else nan
    kept = good.copy()
    for one in thresholds:
        kept &= one.find_reaching(np.array([read_value(hold, one.figure) for hold in holds], np.float64))
    reason = ""
    if not good.any():
        reason = explain_no_hold(result, holds)
    elif not kept.any():
        reason = f"none of its {len(holds)} fixtures in this vise keeps the limits"
    used = np.flatnonzero(kept)
    at = choose_part_zero(query.workpiece.as_finished) if zero is None else zero
    return PartInVise(name, path, digest, at, result, loss, used, best, reason)


def get_value_for_loss(value: float, figure: Figure, theta: float) -> float:
    """Return the value of a figure that its loss is computed of, for a part at ``theta`` in radians.

    See :data:`COARSE` and :data:`LEAST_FORCE`; a jaw force counts more where the part is turned, as in the list.
    """
    if figure.key not in COARSE:
        return value
    if figure.key == "clamp_needed":
        return max(round_number_coarsely(weigh_force(value, theta)), LEAST_FORCE)
    return round_number_coarsely(value)


def read_value(hold: JawHold, figure: Figure) -> float:
    """Return a figure of a hold; NaN where it is not known."""
    value = getattr(hold, figure.key)
    return nan if value is None else float(value)


def explain_no_hold(result: Result, holds: Sequence[JawHold]) -> str:
    """Return why none of the ways to hold a part is to be used, as words after the name of the part."""
    if not holds:
        words = next((note.words for note in result.notes), "nothing holds it.").rstrip(".")
        return f"it cannot be held in this vise: {words[:1].lower()}{words[1:]}"
    first = holds[0]
    if first.is_unfit:
        return "a jaw would touch corners of it alone, and mark them"
    if not first.full_contact:
        return "it would lift off a jaw at one end, as the jaws do not press all over what they touch"
    needs = [hold.clamp_needed for hold in holds if hold.clamp_needed is not None]
    acting = "its program" if result.query.program is not None else "its loads"
    if not needs or first.max_force is None:
        return f"no jaw force holds it against {acting}"
    return f"{acting} ask for {min(needs):.0f} N or more, and the vise is rated for {first.max_force:g} N"


def make_jaw_members(
    parts: Sequence[PartInVise], figure: Figure, same_zero: bool = False
) -> tuple[Member, ...]:
    """Return the members for parts in one plain vise; each part must have a fixture that may be used.

    Parameters
    ----------
    figure : of which losses are computed.
    same_zero : whether fixtures count as of one set-up only if part zero and the part's turn agree as well.
    """
    ranges = [part.measure_stop_ranges() for part in parts]
    levels = dict[tuple[float, str | None], set[int]]()
    for part, known in zip(parts, ranges, strict=True):
        for number, one in known.items():
            hold = part.get_hold(number)
            # With a program the least place may be in a tool's way, and the part's own is not.
            more = (one.low,) if part.result.query.program is None else (one.low, one.own)
            levels.setdefault((hold.parallels, hold.stop), set()).update(more)
    return tuple(
        make_jaw_member(part, known, levels, figure, same_zero)
        for part, known in zip(parts, ranges, strict=True)
    )


def make_jaw_member(
    part: PartInVise,
    ranges: dict[int, StopRange],
    levels: dict[tuple[float, str | None], set[int]],
    figure: Figure,
    same_zero: bool,
) -> Member:
    """Return the member of a part.

    ``ranges`` are those of its used fixtures by index. ``levels`` has, by height of the parallels and end of the
    jaws, the places of a work stop's tip to try, in thousandths of a mm.
    """
    query = part.result.query
    jaws = query.toolkit.flat_jaws
    assert jaws is not None
    rows, numbers = list[tuple[int, ...]](), list[int]()
    for number in part.used.tolist():
        hold, pose = part.get_hold(number), part.get_pose(number)
        place = {"left": jaws.stop_offset, "right": jaws.width - jaws.stop_offset, None: 0.0}[hold.stop]
        tried = [0] if hold.stop is None else sorted(levels[hold.parallels, hold.stop])
        for level in tried:
            if hold.stop is not None and not (
                ranges[number].holds(level) and is_stop_clear(query, hold, pose, level / 1000)
            ):
                continue
            rows.append(JawSetUp(hold.parallels, hold.stop, place, level / 1000).words)
            numbers.append(number)
    words, number = np.array(rows, np.int64).reshape(len(rows), 4), np.array(numbers, np.int64)
    patterns = len(np.unique(words[:, :2], axis=0))
    table = part.result.table
    if same_zero:
        zeros = np.array([part.get_pose(one).apply(*part.zero.point) for one in numbers]).reshape(-1, 2)
        turned = np.degrees(table.theta[number])
        words = np.concatenate([words, encode_places(zeros[:, 0], zeros[:, 1], turned)], axis=1)
    cost = part.loss[number]
    order = np.lexsort([cost, *words.T[::-1]])
    first = order[mark_changes(list(words[order].T))]
    chosen = number[first]
    return Member(
        part.name,
        part.path,
        part.digest,
        query,
        part.zero,
        len(part.result),
        patterns,
        part.best,
        words[first],
        cost[first],
        chosen,
        np.zeros(len(chosen), np.bool_),
        table.take(chosen),
        figure,
        tuple(part.get_hold(one) for one in chosen.tolist()),
        tuple(ranges[one] for one in chosen.tolist()),
    )
