"""A family of parts in one toolkit: its members, the excluded parts, the curve, and its file.

The file has the members, the curve, and the plan at every point of it, as JSON. Its bytes depend only on the
family. Lengths are rounded to 1e-9 mm, angles to 1e-10 degree; figures and losses have twelve significant
digits. A loss that is not finite is null.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from datetime import date
from functools import cached_property
from math import isfinite
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
from attrs import define, evolve, frozen

from workhold.errors import InputError
from workhold.errors import join_words as words_listed
from workhold.family.covering import LossTable, Point, compute_curve, make_loss_table
from workhold.family.jaw_members import PartInVise, choose_hold_figure, judge_holds, make_jaw_members
from workhold.family.members import (
    OTHER_SIDE,
    RANKINGS,
    FigureThreshold,
    Member,
    make_member,
    make_other_side_query,
    make_threshold,
    mirror_zero,
)
from workhold.family.plan import FamilyPlan, Holding, SetUp, make_plan
from workhold.family.solver import load_solver
from workhold.files.atomic import write_bytes
from workhold.files.replacing import refuse_output
from workhold.files.result.fixture_text import LENGTH_STEPS, round_degrees, round_to_steps
from workhold.files.result.writer import make_toolkit_fields
from workhold.fixels.contacts import CLAMP_TIP
from workhold.fixels.toolkit import Toolkit
from workhold.model.first_choice import has_house_order
from workhold.model.fixture import Fixture, Peg
from workhold.model.jaw_hold import HOLD_FIGURES
from workhold.model.quality import FIGURES, Figure, find_figure_number
from workhold.model.query import Query
from workhold.model.setup import PartZero, choose_part_zero, list_length_settings
from workhold.model.workpiece import Workpiece
from workhold.search.design import answer
from workhold.units import find_unit
from workhold.version import __version__

__all__ = [
    "FORMAT",
    "MemberRequest",
    "Family",
    "ExcludedPart",
    "make_family",
    "format_family_json",
    "plan_family",
]

# The share of the searches in the work, for the progress.
SEARCHES = 0.95


@frozen
class MemberRequest:
    """A part to be added to a family.

    Parameters
    ----------
    name : unique name of the part in the family.
    query : query for the complete list of its fixtures.
    path, digest : its file and the file's SHA-256, "" where there is none.
    zero : its part zero; None for the usual one.
    """

    name: str
    query: Query
    path: str = ""
    digest: str = ""
    zero: PartZero | None = None

    def turn_over(self, read: Workpiece | None) -> MemberRequest:
        """Return the request for the other side of the part.

        ``read`` is the workpiece of a solid's other side, read from its file with the opposite axis up; None
        for a part from a drawing.

        Raises
        ------
        InputError
            See :func:`workhold.family.members.make_other_side_query`.
        """
        zero = choose_part_zero(self.query.workpiece) if self.zero is None else self.zero
        name = f"{self.name}, {OTHER_SIDE}"
        return evolve(self, name=name, query=make_other_side_query(self.query, read), zero=mirror_zero(zero))


@frozen
class ExcludedPart:
    """A part that is not a member.

    Parameters
    ----------
    name, path : of the part.
    reason : why, one sentence.
    """

    name: str
    path: str
    reason: str


@define(frozen=True, slots=False, eq=False)
class Family:
    """A family of parts in one toolkit.

    Parameters
    ----------
    toolkit : in which all members are held.
    figure : the figure of quality of which losses are computed.
    members : the parts that some pattern holds.
    left_out : the parts that no pattern holds.
    points : of the curve, fewest set-ups first; empty if there is no member.
    table : the losses of patterns on members; None if there is no member.
    """

    toolkit: Toolkit
    figure: Figure
    members: tuple[Member, ...]
    left_out: tuple[ExcludedPart, ...]
    points: tuple[Point, ...]
    table: LossTable | None

    @property
    def setup_noun(self) -> str:
        """What holds parts and is counted: "pattern" of pegs, or "set-up" of a plain vise."""
        return "pattern" if self.toolkit.flat_jaws is None else "set-up"

    @property
    def setup_count(self) -> int:
        """Number of patterns, or of parallels with a work stop, that hold at least one member."""
        if self.toolkit.flat_jaws is None:
            return 0 if self.table is None else len(self.table.words)
        return len({(hold.parallels, hold.stop) for member in self.members for hold in member.holds})

    @cached_property
    def plans(self) -> tuple[FamilyPlan, ...]:
        """The plan at each point of the curve, fewest set-ups first."""
        if self.table is None:
            return ()
        return tuple(make_plan(point, self.table, self.members) for point in self.points)

    def save(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write curve and plans into a JSON file.

        ``overwrite`` says whether a file that workhold has not written may be replaced.

        Raises
        ------
        InputError
            When the file cannot be written or replaced.
        """
        refuse_output(path, (), overwrite)
        write_bytes(path, format_family_json(self).encode("utf-8"))

    def save_sheets(
        self, path: str | Path, setups: int | None = None, *, unit: str = "mm", overwrite: bool = False
    ) -> None:
        """Write the sheets of a plan, one for each set-up.

        Parameters
        ----------
        path : its name ends in .pdf, .svg or .png.
        setups : largest number of set-ups; None for the fewest that hold all members.
        unit : of the lengths written: "mm", "cm", "m" or "inch".
        overwrite : whether a file that workhold has not written may be replaced.

        Raises
        ------
        InputError
            For another ending, where there is no such plan, and when the file cannot be written or replaced.
        """
        from workhold.family.pages import draw_setups
        from workhold.presenting.papers import PAPER_ENDINGS, make_pages_file

        ending, day = Path(path).suffix.lower(), date.today()
        if ending not in PAPER_ENDINGS:
            raise InputError(f"{path} names no kind of sheet: let the name end in .pdf, .svg or .png.")
        refuse_output(path, (), overwrite)
        pages = draw_setups(self.plan(setups), self.figure, day, find_unit(unit))
        write_bytes(path, make_pages_file(pages, ending, day))

    def plan(self, setups: int | None = None) -> FamilyPlan:
        """Return the plan with at most ``setups`` set-ups and the least loss; with None the plan with the
        fewest set-ups.

        Raises
        ------
        InputError
            When so few set-ups cannot hold all members, or there are no members.
        """
        if not self.plans:
            raise InputError(f"there is no plan: no {self.setup_noun} holds any of the parts.")
        fitting = [plan for plan in self.plans if setups is None or plan.point.setups <= setups]
        if not fitting:
            fewest = self.points[0]
            proven = "at least" if fewest.at_least == fewest.setups else "so far as is known"
            raise InputError(f"{setups} set-ups cannot hold all parts: {proven} {fewest.setups} are needed.")
        return fitting[0 if setups is None else -1]


def make_family(
    asked: Sequence[MemberRequest],
    *,
    thresholds: Sequence[FigureThreshold] = (),
    unfit: bool = False,
    most_loss: float | None = None,
    seconds: float | None = None,
    same_zero: bool = False,
    threads: int | None = None,
    left_out: Sequence[ExcludedPart] = (),
    progress: Callable[[float, int], None] = lambda fraction, found: None,
) -> Family:
    """Return the family of some parts: search the fixtures of each part, then compute the curve.

    Parameters
    ----------
    asked : at least one part; all with the same toolkit and the same first figure of the ranking.
    thresholds, unfit : which fixtures may be used, see ``family.members.are_usable``.
    most_loss : larger losses are not accepted; None accepts any.
    seconds : time limit, after which the curve known so far is returned; None runs until it is fully proven.
    same_zero : whether all parts of a set-up must have their zeros at the same place and the same turn.
    left_out : parts that the caller has already excluded, to be listed in the result.
    progress : called with the fraction done and the number of fixtures found.

    Raises
    ------
    InputError
        When SciPy is not installed, a loss below 1 is asked for, parts are asked for in different toolkits, for
        different figures, with straps, or with a program beside pegs, and as ``search.design.answer``.

    Examples
    --------
    >>> from workhold import Query, Vise, Workpiece
    >>> vise, by = Vise(pitch=10, columns=1, peg_radius=3), ("location_error",)
    >>> def triangle(width, height):
    ...     return Workpiece.from_loops("", [[[0, 0, 0], [width, 0, 0], [width / 3, height, 0]]])
    >>> sizes = (40, 35), (50, 40), (62, 31)
    >>> parts = [MemberRequest(str(size), Query(triangle(*size), vise, rank_by=by)) for size in sizes]
    >>> [(point.setups, round(point.loss, 2)) for point in make_family(parts).points]
    [(1, 1.06), (2, 1.03), (3, 1.0)]
    """
    load_solver()
    if most_loss is not None and not most_loss >= 1.0:
        raise InputError(f"a largest loss of {most_loss:g} cannot be: every loss is 1 or more.")
    first = asked[0].query
    refuse_unlike(asked)
    refuse_other_figures(thresholds, first.toolkit)
    in_vise = first.toolkit.flat_jaws is not None
    if in_vise:
        figure = choose_hold_figure([one.query for one in asked])
    else:
        figure = FIGURES[find_figure_number(first.rank_by[0]) or 0]
    members, out, found = list[Member](), list(left_out), 0
    between_jaws = list[PartInVise]()
    if in_vise:
        refuse_unknown_heights(asked)
    for place, one in enumerate(asked):

        def share(fraction: float, count: int, place: int = place, found: int = found) -> None:
            """Report the progress of the search for one part."""
            progress(SEARCHES * (place + fraction) / len(asked), found + count)

        # A plan is made of all fixtures: of two clamps every pair counts.
        query = evolve(one.query, best=None, listing=None if one.query.toolkit.closes_at_once else "all")
        result = answer(query, threads=threads, progress=share)
        found += len(result)
        if in_vise:
            part = judge_holds(one.name, result, figure, thresholds, unfit, one.path, one.digest, one.zero)
            reason = part.reason
            if not reason and most_loss is not None and part.loss[part.used].min() > most_loss:
                reason = BEYOND_LOSS
            if not reason:
                between_jaws.append(part)
        else:
            member = make_member(
                one.name, result, thresholds, unfit, one.path, one.digest, one.zero, same_zero
            )
            is_member = len(member.words) and (most_loss is None or member.loss.min() <= most_loss)
            reason = "" if is_member else explain_missing_member(member, bool(len(member.words)))
            if is_member:
                members.append(member)
        if reason:
            out.append(ExcludedPart(one.name, one.path, reason))
    if between_jaws:
        members += make_jaw_members(between_jaws, figure, same_zero)
    if not members:
        return Family(first.toolkit, figure, (), tuple(out), (), None)
    table = make_loss_table(members)
    deadline = None if seconds is None else monotonic() + seconds

    def report_curve(fraction: float) -> None:
        """Report the progress of the curve."""
        progress(SEARCHES + (1.0 - SEARCHES) * fraction, found)

    points = compute_curve(table, float("inf") if most_loss is None else most_loss, deadline, report_curve)
    return Family(first.toolkit, figure, tuple(members), tuple(out), points, table)


def plan_family(
    queries: Sequence[Query],
    *,
    max_loss: float | None = None,
    limits: Mapping[str, float] | None = None,
    unfit: bool = False,
    same_zero: bool = False,
    seconds: float | None = None,
    threads: int | None = None,
) -> Family:
    """Return with which few set-ups many parts can be held in one toolkit, and what each fewer set-up costs.

    Parameters
    ----------
    queries : one for each part, at least one, all with the same toolkit.
    max_loss : larger losses are not accepted; None accepts any.
    limits : values that no fixture used may exceed by name of the figure, or fall below where more is better, such as
        {"location-error": 0.05}, or {"grip": 6} in a plain vise; in mm, N or degrees.
    unfit : whether fixtures that no workshop can use count as well.
    same_zero : whether in a set-up the zeros of all parts must lie at the same place, and all parts be turned alike.
    seconds : time limit of the proof that no fewer set-ups do; None for none.
    threads : number of threads of a search; None for all processors.

    Raises
    ------
    InputError
        When SciPy is not installed, and where :func:`make_family` raises it.

    Examples
    --------
    >>> import workhold
    >>> vise = workhold.PlainVise(jaw_width=152, jaw_height=44, parallels=[20, 32], stop="left")
    >>> def block(width, depth, thickness):
    ...     corners = [(0, 0), (width, 0), (width, depth), (0, depth)]
    ...     part = workhold.Workpiece.from_points(f"{width} x {depth} x {thickness}", corners)
    ...     return workhold.Query(part, vise, thickness=thickness)
    >>> family = workhold.plan_family([block(100, 60, 40), block(80, 50, 16), block(60, 40, 30)])
    >>> [(point.setups, point.loss) for point in family.points]
    [(1, 2.0), (2, 1.0)]
    >>> [(setup.jaws.parallels, [one.member.name for one in setup.holdings]) for setup in family.plan(2).setups]
    [(20.0, ['100 x 60 x 40', '60 x 40 x 30']), (32.0, ['80 x 50 x 16'])]
    """
    if not queries:
        raise InputError("there are no parts to plan set-ups for: give a query for each.")
    times, asked = Counter[str](), list[MemberRequest]()
    for query in queries:
        name = query.workpiece.name
        times[name] += 1
        usual = None if query.toolkit.holds_by_friction else RANKINGS[query.toolkit.travel_count]
        ranked = evolve(query, rank_by=usual) if usual and has_house_order(query.rank_by) else query
        asked.append(MemberRequest(name if times[name] == 1 else f"{name} ({times[name]})", ranked))
    return make_family(
        asked,
        thresholds=[make_threshold(name, value) for name, value in (limits or {}).items()],
        unfit=unfit,
        most_loss=max_loss,
        seconds=seconds,
        same_zero=same_zero,
        threads=threads,
    )


def refuse_unlike(asked: Sequence[MemberRequest]) -> None:
    """Raise InputError where parts are asked for in different toolkits, for different figures, with straps, or with
    a program beside pegs.
    """
    first = asked[0].query
    for one in asked:
        if one.query.toolkit != first.toolkit:
            raise InputError(
                f"{one.name} is asked for in another toolkit: the parts of a family share theirs."
            )
        if one.query.toolkit.strap_set is not None:
            raise InputError(
                "a family of parts is not planned with straps: plan one on a plate with clamps, and strap each part to the "
                "locators found."
            )
        if one.query.program is not None and one.query.toolkit.flat_jaws is None:
            raise InputError(f"{one.name} has a program to let pass: a family of parts is planned without.")
        if one.query.rank_by[0] != first.rank_by[0]:
            raise InputError(
                f"{one.name} is ranked by another figure: the losses of a family are of one figure."
            )


def refuse_unknown_heights(asked: Sequence[MemberRequest]) -> None:
    """Raise InputError for a part whose height is not known, as it decides on which parallels the part stands."""
    for one in asked:
        if one.query.part_height is None:
            raise InputError(
                f"{one.name}: how thick it is decides which parallels it stands on: give its thickness."
            )


def refuse_other_figures(thresholds: Sequence[FigureThreshold], toolkit: Toolkit) -> None:
    """Raise InputError for a threshold of a figure that fixtures in this toolkit do not have."""
    known = FIGURES if toolkit.flat_jaws is None else HOLD_FIGURES
    for one in thresholds:
        if one.figure not in known:
            names = ", ".join(figure.option for figure in known)
            raise InputError(f"a {toolkit.noun} has no limit of {one.figure.option}: choose among {names}.")


BEYOND_LOSS = "no fixture of it that may be used is within the largest loss"


def explain_missing_member(member: Member, has_patterns: bool) -> str:
    """Return the reason why a part is not a member.

    ``has_patterns`` tells whether any fixture of the part may be used.
    """
    inside = member.query.toolkit.wording.inside
    if not member.fixtures:
        asked = member.query.asked
        return (
            f"it has no fixture {inside}{f' with what was asked for: {words_listed(asked)}' if asked else ''}"
        )
    if has_patterns:
        return BEYOND_LOSS
    return f"none of its {member.fixtures:,} fixtures {inside} may be used"


FORMAT = "workhold-family/1"


def format_family_json(family: Family) -> str:
    """Return the family's file as JSON text."""
    toolkit = family.toolkit
    head = {
        "toolkit": {"kind": toolkit.kind, **make_toolkit_fields(toolkit)},
        "figure": family.figure.key,
    }
    parts = [
        {
            "name": one.name,
            "path": one.path,
            "hash": one.digest,
            "zero": [round_length_for_file(value) for value in one.zero.point],
            "fixtures": one.fixtures,
            "patterns": one.patterns,
            "best": round_figure_for_file(one.best),
        }
        for one in family.members
    ]
    out = [{"name": one.name, "path": one.path, "reason": one.reason} for one in family.left_out]
    lines = ",\n".join(format_plan_json(plan, family) for plan in family.plans)
    # Every part and every set-up has a line of its own.
    return (
        f'{{"format": "{FORMAT}", "program": "workhold {__version__}", "family": {{\n'
        f"{json.dumps(head)[1:-1]},\n"
        f'"parts": {format_list_json(parts)},\n'
        f'"left_out": {format_list_json(out)},\n'
        f'"curve": [\n{lines}\n]}}}}\n'
    )


def format_list_json(entries: list[dict[str, Any]]) -> str:
    """Return a JSON list with one entry on each line."""
    return "[\n" + ",\n".join(json.dumps(entry) for entry in entries) + "\n]" if entries else "[]"


def format_plan_json(plan: FamilyPlan, family: Family) -> str:
    """Return a plan as JSON text with one set-up on each line."""
    numbers = {id(member): number for number, member in enumerate(family.members)}
    point = {
        "setups": plan.point.setups,
        "loss": round_figure_for_file(plan.point.loss),
        "lower_bound": plan.point.at_least,
        "is_least": plan.point.is_least,
        ("pegs_moved" if family.toolkit.flat_jaws is None else "changes"): plan.moved,
    }
    setups = ",\n".join(json.dumps(make_setup_entry(setup, family.toolkit, numbers)) for setup in plan.setups)
    return f'{json.dumps(point)[:-1]}, "plan": [\n{setups}]}}'


def make_setup_entry(setup: SetUp, toolkit: Toolkit, numbers: dict[int, int]) -> dict[str, Any]:
    """Return a set-up as a JSON object; ``numbers`` gives a member's number by the ``id()`` of the member."""
    parts = [make_holding_entry(one, toolkit, numbers[id(one.member)]) for one in setup.holdings]
    if setup.jaws is not None:
        jaws = setup.jaws
        at = [round_length_for_file(jaws.place), round_length_for_file(jaws.level)]
        return {
            "parallels": jaws.parallels,
            "stop": jaws.stop,
            "stop_at": None if jaws.stop is None else at,
            "changes": setup.moved,
            "parts": parts,
        }
    fixture = setup.standing.fixture
    return {
        "pattern": {
            "type": fixture.type,
            **({"direction": fixture.direction} if toolkit.tip_count else {}),
            "pegs": [make_peg_entry(peg, toolkit) for peg in fixture.placed],
        },
        "pegs_to_place": setup.moved,
        "parts": parts,
    }


def make_peg_entry(peg: Peg, toolkit: Toolkit) -> dict[str, Any]:
    """Return a peg's place as a JSON object.

    It names the peg's hole; for an unbolted clamp its row or column, and "hole" is null.
    """
    carrier, place = toolkit.find_carrier(peg.carrier), {"column": peg.column, "row": peg.row}
    key, name = carrier.file_entry
    if carrier.contact is not CLAMP_TIP:
        return {key: name, **place}
    hole = [*place.values()] if carrier.measure == "stroke" else None
    return {key: name, "direction": carrier.direction, carrier.line: place[carrier.line], "hole": hole}


def make_holding_entry(one: Holding, toolkit: Toolkit, number: int) -> dict[str, Any]:
    """Return the JSON object of how a member lies in a set-up, in mm and degrees.

    ``number`` is the member's number. Fixtures are given by their numbers in the members' lists.
    """
    fixture = one.fixture
    entry = {
        "part": number,
        "fixture": one.number,
        "turned": one.turned,
        "pose": {
            "theta_deg": float(round_degrees(fixture.pose.theta_deg)),
            "x": round_length_for_file(fixture.pose.x),
            "y": round_length_for_file(fixture.pose.y),
        },
        **make_opening_entry(fixture, toolkit),
        "zero": [round_length_for_file(value) for value in fixture.pose.apply(*one.member.zero.point)],
        "figure": round_figure_for_file(one.figure),
        "loss": round_figure_for_file(one.loss),
    }
    if one.hold is not None:
        entry |= {
            "fixed": list(one.hold.fixed.segments),
            "moving": list(one.hold.moving.segments),
            "grip": round_length_for_file(one.hold.grip),
            "above": None if one.hold.above is None else round_length_for_file(one.hold.above),
            "clamp_needed": None
            if one.hold.clamp_needed is None
            else round_figure_for_file(one.hold.clamp_needed),
        }
        if one.hold.has_moved_parallels:
            entry["parallel_offsets"] = [round_length_for_file(away) for away in one.hold.parallel_offsets]
    if not one.in_place:
        entry["pegs"] = [make_peg_entry(peg, toolkit) for peg in fixture.pegs]
    return entry


def make_opening_entry(fixture: Fixture, toolkit: Toolkit) -> dict[str, Any]:
    """Return {"opening": ...} with the jaw opening in mm to set for a part; with two clamps a list of both
    openings.
    """
    lengths = [round_length_for_file(setting.length) for setting in list_length_settings(fixture, toolkit)]
    return {"opening": lengths[0] if len(lengths) == 1 else lengths}


def round_length_for_file(value: float) -> float:
    """Return a length in mm rounded to 1e-9 mm, as the file writes it."""
    return float(round_to_steps(np.array([value]), LENGTH_STEPS)[0])


def round_figure_for_file(value: float) -> float | None:
    """Return a figure rounded to twelve significant digits; None where it is not finite."""
    return float(f"{value:.12g}") if isfinite(value) else None
