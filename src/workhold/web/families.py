"""Families of parts over HTTP: the request, the family that a worker finds, and its files."""

from __future__ import annotations

from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from attrs import evolve, frozen
from pydantic import Field

from workhold.asking.declaring import list_declarations
from workhold.asking.search import RULING_OUT, SearchQuestion
from workhold.errors import InputError
from workhold.files.declared_forms import add_declared_fields, collect_given_values
from workhold.model.quality import read_asked_ranking
from workhold.model.query import Query
from workhold.presenting.data import convert_finite
from workhold.web.forms import HeldIn, ToleranceForm
from workhold.web.request_forms import LARGEST, Form, Name, WorkpieceForm
from workhold.web.searching import AskedQueries
from workhold.web.worker import TaskContext

if TYPE_CHECKING:
    from workhold.family.family import Family
    from workhold.family.plan import FamilyPlan

__all__ = ["PAPERS", "FamilyForm", "FoundFamily", "FamilyPaper", "find_family", "make_family_paper"]

MOST_PARTS = 50
OF_FAMILY = list_declarations(SearchQuestion, [RULING_OUT])
# Of the time for a search, the share in which the proof must end.
PROOF = 0.25
# What can be made of a family: its content type.
PAPERS = {
    "curve.svg": "image/svg+xml",
    "sheets.svg": "image/svg+xml",
    "sheets.pdf": "application/pdf",
    "plans.json": "application/json",
}


@add_declared_fields(OF_FAMILY, LARGEST)
class FamilyForm(Form):
    """Parts to be held in one toolkit with few set-ups.

    ``thicknesses`` are those of drawn parts in mm, in the order of the parts, for what flat jaws grip.
    """

    workpieces: Annotated[list[WorkpieceForm], Field(min_length=1, max_length=MOST_PARTS)]
    thicknesses: Annotated[
        list[Annotated[float, Field(gt=0, le=LARGEST)] | None], Field(max_length=MOST_PARTS)
    ] = Field(default=[])
    toolkit: HeldIn
    types: list[Name] | None = Field(default=None, max_length=10)
    ranking: list[Name] | None = Field(default=None, max_length=10)
    prefer: Name | None = None
    tolerance: ToleranceForm | None = None

    def to_queries(self, most_segments: int) -> tuple[tuple[str, Query], ...]:
        """Return (name, query) of each part in order; raise InputError where the solver is not installed."""
        from workhold.family.members import RANKINGS
        from workhold.family.solver import load_solver

        load_solver()
        toolkit = self.toolkit.to_toolkit()
        usual = None if toolkit.holds_by_friction else RANKINGS[toolkit.travel_count]
        ranking = read_asked_ranking(self.ranking, self.prefer, ()) or usual
        tolerance = None if self.tolerance is None else self.tolerance.to_tolerance()
        parts = [form.to_workpiece(most_segments) for form in self.workpieces]
        asked = collect_given_values(self, OF_FAMILY) | {"rank_by": ranking, "tolerance": tolerance}
        high = [*self.thicknesses, *[None] * len(parts)][: len(parts)]
        return tuple(
            (part.name, Query(part, toolkit, self.types, thickness=thick, **asked))
            for part, thick in zip(parts, high, strict=True)
        )


@frozen(eq=False)
class FoundFamily:
    """A family with its plans, and those fixtures of its members that the plans use.

    Parameters
    ----------
    family : the family without its table, its members without patterns.
    plans : plan at each point of the curve.
    text : content of the family's file.
    """

    family: Family
    plans: tuple[FamilyPlan, ...]
    text: str

    def answer(self) -> dict[str, Any]:
        """Return the curve as plain data: its points, the parts, and those left out with reasons."""
        family = self.family
        points = []
        for plan in self.plans:
            worst = max((one for setup in plan.setups for one in setup.holdings), key=lambda one: one.loss)
            points.append(
                {
                    "setups": plan.point.setups,
                    "loss": convert_finite(plan.point.loss),
                    "at_least": plan.point.at_least,
                    "is_least": plan.point.is_least,
                    ("pegs_moved" if family.toolkit.flat_jaws is None else "changes"): plan.moved,
                    "worst": worst.member.name,
                    "figure": convert_finite(worst.figure),
                }
            )
        return {
            "figure": family.figure.key,
            "parts": [one.name for one in family.members],
            "left_out": [{"name": one.name, "reason": one.reason} for one in family.left_out],
            "points": points,
        }

    def choose_plan(self, setups: int | None) -> FamilyPlan:
        """Return the plan with the most set-ups, but at most ``setups``; for None the plan with the fewest.

        Raises InputError if there is none.
        """
        fitting = [plan for plan in self.plans if setups is None or plan.point.setups <= setups]
        if not fitting:
            raise InputError("there is no plan with so few set-ups: ask for more.")
        return fitting[0 if setups is None else -1]


def find_family(payload: AskedQueries, order: TaskContext) -> FoundFamily:
    """Return the family of the queries' parts; progress is reported as ("progress", fraction, found)."""
    from workhold.family.family import MemberRequest, format_family_json, make_family

    def report_progress(fraction: float, found: int) -> None:
        order.report(("progress", fraction, found))

    queries = payload.queries
    names = number_repeated_names([name for name, _ in queries])
    asked = [MemberRequest(name, query) for name, (_, query) in zip(names, queries, strict=True)]
    family = make_family(asked, seconds=PROOF * order.seconds, progress=report_progress)
    text, plans = format_family_json(family), family.plans
    small = {
        id(one): evolve(
            one,
            words=one.words[:0],
            loss=one.loss[:0],
            number=one.number[:0],
            turned=one.turned[:0],
            table=one.table.take(slice(0, 0)),
            holds=(),
            stop_ranges=(),
        )
        for one in family.members
    }
    slim = tuple(
        evolve(
            plan,
            setups=tuple(
                evolve(
                    setup, holdings=tuple(evolve(one, member=small[id(one.member)]) for one in setup.holdings)
                )
                for setup in plan.setups
            ),
        )
        for plan in plans
    )
    return FoundFamily(evolve(family, members=tuple(small.values()), table=None), slim, text)


def number_repeated_names(names: list[str]) -> list[str]:
    """Return the names in order; a name that occurred before gets " (2)", then " (3)", … at its end.

    >>> number_repeated_names(["a", "b", "a"])
    ['a', 'b', 'a (2)']
    """
    return [
        name if names.index(name) == place else f"{name} ({names[: place + 1].count(name)})"
        for place, name in enumerate(names)
    ]


@frozen(eq=False)
class FamilyPaper:
    """An order of one of :data:`PAPERS` for a plan with at most a given number of set-ups, with unit and
    date.
    """

    kind: str
    found: FoundFamily
    setups: int | None
    unit: str
    day: date


def make_family_paper(payload: FamilyPaper, order: TaskContext) -> bytes:
    """Return a paper of a family, one of :data:`PAPERS`, as bytes."""
    from workhold.family.pages import draw_curve, draw_setups
    from workhold.presenting.papers import make_pages_file
    from workhold.units import find_unit

    found = payload.found
    if payload.kind == "plans.json":
        return found.text.encode("utf-8")
    if payload.kind == "curve.svg":
        chosen = None if payload.setups is None else found.choose_plan(payload.setups).point
        return draw_curve(found.family, chosen).encode("utf-8")
    pages = draw_setups(
        found.choose_plan(payload.setups), found.family.figure, payload.day, find_unit(payload.unit)
    )
    return make_pages_file(pages, Path(payload.kind).suffix, payload.day)
