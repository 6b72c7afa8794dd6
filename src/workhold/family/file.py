"""The file of a family: members, curve, and the plan at every point of it, as JSON.

The bytes depend on nothing but the family. Lengths are rounded to 1e-9 mm, angles to 1e-10 degree; figures and losses have
twelve significant digits. A loss that is not finite is null.
"""

from __future__ import annotations

import json
from math import isfinite
from typing import Any

import numpy as np

from workhold.family.family import Family
from workhold.family.plan import Holding, Plan, SetUp
from workhold.files.result.rounding import LENGTH_STEPS, rounded, rounded_degrees
from workhold.files.result.writer import toolkit_fields
from workhold.fixels.contact_kind import CLAMP_TIP
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture, Peg
from workhold.model.setting import settings_of
from workhold.version import __version__

__all__ = ["FORMAT", "family_text"]

FORMAT = "workhold-family/1"


def family_text(family: Family) -> str:
    """The text of a family's file."""
    toolkit = family.toolkit
    head = {
        "toolkit": {"kind": toolkit.kind, **toolkit_fields(toolkit)},
        "figure": family.figure.key,
    }
    parts = [
        {
            "name": one.name,
            "path": one.path,
            "hash": one.digest,
            "zero": [length(value) for value in one.zero.point],
            "fixtures": one.fixtures,
            "patterns": one.patterns,
            "best": significant(one.best),
        }
        for one in family.members
    ]
    out = [{"name": one.name, "path": one.path, "reason": one.reason} for one in family.left_out]
    lines = ",\n".join(plan_text(plan, family) for plan in family.plans)
    # Every part and every set-up has a line of its own.
    return (
        f'{{"format": "{FORMAT}", "program": "workhold {__version__}", "family": {{\n'
        f"{json.dumps(head)[1:-1]},\n"
        f'"parts": {listed(parts)},\n'
        f'"left_out": {listed(out)},\n'
        f'"curve": [\n{lines}\n]}}}}\n'
    )


def listed(entries: list[dict[str, Any]]) -> str:
    """A list with a line for each entry."""
    return "[\n" + ",\n".join(json.dumps(entry) for entry in entries) + "\n]" if entries else "[]"


def plan_text(plan: Plan, family: Family) -> str:
    """A point of the curve with its plan."""
    numbers = {id(member): number for number, member in enumerate(family.members)}
    point = {
        "setups": plan.point.setups,
        "loss": significant(plan.point.loss),
        "lower_bound": plan.point.at_least,
        "is_least": plan.point.is_least,
        "pegs_moved": plan.moved,
    }
    setups = ",\n".join(json.dumps(setup_entry(setup, family.toolkit, numbers)) for setup in plan.setups)
    return f'{json.dumps(point)[:-1]}, "plan": [\n{setups}]}}'


def setup_entry(setup: SetUp, toolkit: Toolkit, numbers: dict[int, int]) -> dict[str, Any]:
    """A set-up as it is written; ``numbers`` are those of members."""
    fixture = setup.standing.fixture
    return {
        "pattern": {
            "type": fixture.type,
            **({"direction": fixture.direction} if toolkit.tips else {}),
            "pegs": [peg_entry(peg, toolkit) for peg in fixture.placed],
        },
        "pegs_to_place": setup.moved,
        "parts": [holding_entry(one, toolkit, numbers[id(one.member)]) for one in setup.holdings],
    }


def peg_entry(peg: Peg, toolkit: Toolkit) -> dict[str, Any]:
    """Where a peg of a pattern stands: its hole, or the line of a clamp of which no more is known."""
    carrier, place = toolkit.carrier(peg.carrier), {"column": peg.column, "row": peg.row}
    key, name = carrier.written_as
    if carrier.contact is not CLAMP_TIP:
        return {key: name, **place}
    hole = [*place.values()] if carrier.measure == "stroke" else None
    return {key: name, "direction": carrier.direction, carrier.line: place[carrier.line], "hole": hole}


def holding_entry(one: Holding, toolkit: Toolkit, number: int) -> dict[str, Any]:
    """How a member lies, as it is written."""
    fixture = one.fixture
    entry = {
        "part": number,
        "fixture": one.number,
        "turned": one.turned,
        "pose": {
            "theta_deg": float(rounded_degrees(fixture.pose.theta_deg)),
            "x": length(fixture.pose.x),
            "y": length(fixture.pose.y),
        },
        **opening_entry(fixture, toolkit),
        "zero": [length(value) for value in fixture.pose.apply(*one.member.zero.point)],
        "figure": significant(one.figure),
        "loss": significant(one.loss),
    }
    if not one.in_place:
        entry["pegs"] = [peg_entry(peg, toolkit) for peg in fixture.pegs]
    return entry


def opening_entry(fixture: Fixture, toolkit: Toolkit) -> dict[str, Any]:
    """What is set for a part: the opening of a vise, or the strokes or places of clamps."""
    lengths = [length(setting.length) for setting in settings_of(fixture, toolkit)]
    return {"opening": lengths[0] if len(lengths) == 1 else lengths}


def length(value: float) -> float:
    """A length as it is written."""
    return float(rounded(np.array([value]), LENGTH_STEPS)[0])


def significant(value: float) -> float | None:
    """A figure as it is written; None where it is not finite."""
    return float(f"{value:.12g}") if isfinite(value) else None
