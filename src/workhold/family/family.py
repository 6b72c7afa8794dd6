"""A family of parts in one toolkit: its members, what was left out, and the curve."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from time import monotonic

from attrs import define, evolve, frozen

from workhold.errors import InputError
from workhold.family.covering import load_solver
from workhold.family.curve import Point, Table, curve_of, table_of
from workhold.family.losses import Threshold
from workhold.family.members import Member, member_of
from workhold.family.other_side import OTHER_SIDE, other_side, zero_of_other_side
from workhold.family.plan import Plan, plan_of
from workhold.fixels.toolkit import Toolkit
from workhold.model.part_zero import PartZero, part_zero
from workhold.model.quality import FIGURES, Figure, figure_number
from workhold.model.query import Query
from workhold.search.design import answer

__all__ = ["Asked", "Family", "LeftOut", "family_of"]

# The share of the work that the searches are, as progress tells it.
SEARCHES = 0.95


@frozen
class Asked:
    """A part that is to be a member.

    Parameters
    ----------
    name : what it is called among the others.
    query : what is asked for it: the whole list of its fixtures.
    path, digest : its file and the SHA-256 of that, "" where there is none.
    zero : its zero; the usual one of its part if None.
    """

    name: str
    query: Query
    path: str = ""
    digest: str = ""
    zero: PartZero | None = None

    @property
    def turned_over(self) -> Asked:
        """The other side of the part."""
        zero = part_zero(self.query.workpiece) if self.zero is None else self.zero
        name = f"{self.name}, {OTHER_SIDE}"
        return evolve(self, name=name, query=other_side(self.query), zero=zero_of_other_side(zero))


@frozen
class LeftOut:
    """A part that is no member.

    Parameters
    ----------
    name, path : which.
    reason : why, one sentence.
    """

    name: str
    path: str
    reason: str


@define(frozen=True, slots=False, eq=False)
class Family:
    """A family.

    Parameters
    ----------
    toolkit : in which all members are held.
    figure : of which losses are told.
    members : the parts that some pattern holds.
    left_out : the others.
    points : of the curve, fewest set-ups first; none without a member.
    table : which pattern holds which member, None without a member.
    """

    toolkit: Toolkit
    figure: Figure
    members: tuple[Member, ...]
    left_out: tuple[LeftOut, ...]
    points: tuple[Point, ...]
    table: Table | None

    @cached_property
    def plans(self) -> tuple[Plan, ...]:
        """The plan at each point of the curve."""
        return () if self.table is None else tuple(plan_of(point, self.table, self.members) for point in self.points)

    def plan(self, setups: int | None = None) -> Plan:
        """The plan with the least loss that has at most so many set-ups; None asks for as few set-ups as there can be.

        Raises
        ------
        InputError
            When so few set-ups cannot hold all members, or there is none.
        """
        if not self.plans:
            raise InputError("there is no plan: no pattern holds any of the parts.")
        fitting = [plan for plan in self.plans if setups is None or plan.point.setups <= setups]
        if not fitting:
            fewest = self.points[0]
            proven = "at least" if fewest.at_least == fewest.setups else "so far as is known"
            raise InputError(f"{setups} set-ups cannot hold all parts: {proven} {fewest.setups} are needed.")
        return fitting[0 if setups is None else -1]


def family_of(
    asked: Sequence[Asked],
    *,
    thresholds: Sequence[Threshold] = (),
    unfit: bool = False,
    most_loss: float | None = None,
    seconds: float | None = None,
    same_zero: bool = False,
    threads: int | None = None,
    left_out: Sequence[LeftOut] = (),
    progress: Callable[[float, int], None] = lambda fraction, found: None,
) -> Family:
    """The family of some parts.

    Parameters
    ----------
    asked : at least one part; all with the same toolkit and the same first figure of the ranking.
    thresholds, unfit : which fixtures may be used, see ``family.losses.may_be_used``.
    most_loss : larger losses are not accepted; None is any.
    seconds : after which the curve tells what is known until then; None proves all of it.
    same_zero : whether the zeros of all parts of a set-up must lie at one place, and the parts be turned alike.
    left_out : parts that are left out already.
    progress : called with the fraction done and how many fixtures were found.

    Raises
    ------
    InputError
        When SciPy is not installed, a loss below 1 is asked for, parts are asked for in different toolkits or for different
        figures, and as ``search.design.answer``.

    Examples
    --------
    >>> from workhold import Query, Vise, Workpiece
    >>> vise, by = Vise(pitch=10, columns=1, peg_radius=3), ("location_error",)
    >>> def triangle(width, height):
    ...     return Workpiece.from_loops("", [[[0, 0, 0], [width, 0, 0], [width / 3, height, 0]]])
    >>> parts = [Asked(str(size), Query(triangle(*size), vise, ranking=by)) for size in ((40, 35), (50, 40), (62, 31))]
    >>> [(point.setups, round(point.loss, 2)) for point in family_of(parts).points]
    [(1, 1.17), (2, 1.07), (3, 1.0)]
    """
    load_solver()
    if most_loss is not None and not most_loss >= 1.0:
        raise InputError(f"a largest loss of {most_loss:g} cannot be: every loss is 1 or more.")
    first = asked[0].query
    for one in asked:
        if one.query.toolkit != first.toolkit:
            raise InputError(f"{one.name} is asked for in another toolkit: the parts of a family share theirs.")
        if one.query.ranking[0] != first.ranking[0]:
            raise InputError(f"{one.name} is ranked by another figure: the losses of a family are of one figure.")
    members, out, found = list[Member](), list(left_out), 0
    for place, one in enumerate(asked):

        def share(fraction: float, count: int, place: int = place, found: int = found) -> None:
            progress(SEARCHES * (place + fraction) / len(asked), found + count)

        # A plan is made of all fixtures: of two clamps every pair counts.
        query = evolve(one.query, best=None, listing=None if one.query.toolkit.closes_at_once else "all")
        result = answer(query, threads=threads, progress=share)
        found += len(result)
        member = member_of(one.name, result, thresholds, unfit, one.path, one.digest, one.zero, same_zero)
        if len(member.words) and (most_loss is None or member.loss.min() <= most_loss):
            members.append(member)
        else:
            out.append(LeftOut(one.name, one.path, reason_of(member, bool(len(member.words)))))
    figure = FIGURES[figure_number(first.ranking[0]) or 0]
    if not members:
        return Family(first.toolkit, figure, (), tuple(out), (), None)
    table = table_of(members)
    deadline = None if seconds is None else monotonic() + seconds

    def later(fraction: float) -> None:
        progress(SEARCHES + (1.0 - SEARCHES) * fraction, found)

    points = curve_of(table, float("inf") if most_loss is None else most_loss, deadline, later)
    return Family(first.toolkit, figure, tuple(members), tuple(out), points, table)


def reason_of(member: Member, has_patterns: bool) -> str:
    """Why a part is no member."""
    inside = member.query.toolkit.wording.inside
    if not member.fixtures:
        return f"it has no fixture {inside}"
    if has_patterns:
        return "no fixture of it that may be used is within the largest loss"
    return f"none of its {member.fixtures:,} fixtures {inside} may be used"
