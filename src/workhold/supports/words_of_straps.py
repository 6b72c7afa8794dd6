"""Sentences about straps: how to set them up, assumptions of the computation, and warnings."""

from __future__ import annotations

import numpy as np

from workhold.contact.swept import find_swept_below
from workhold.model.fixture import Fixture
from workhold.model.friction import COEFFICIENTS, find_friction_coefficient
from workhold.model.hold_words import format_set_force
from workhold.model.jaw_hold import ProgramJawForce
from workhold.model.program import Program
from workhold.model.straps import StrappedHold
from workhold.statics.program_forces import AskedForce, find_cut_of_move, round_force_up
from workhold.supports.straps import StrapQuestion
from workhold.supports.straps_over_supports import contain_point, find_middle
from workhold.supports.straps_past_tools import keep_clear
from workhold.units import Unit, format_times

__all__ = [
    "describe_missing_places",
    "describe_program_need",
    "describe_program_safety",
    "list_remarks",
    "list_steps",
    "list_warnings",
    "describe_assumptions",
]


def list_steps(found: StrappedHold, fixture: Fixture, asked: StrapQuestion, unit: Unit) -> list[str]:
    """Return the steps of a set-up, without full stops."""
    steps = []
    plate = asked.find_plate(fixture)
    holes = [
        plate.name_place(peg.column, peg.row)
        for peg in asked.list_locators(fixture)
        if peg.carrier == plate.name
    ]
    steps.append(f"Locators stand in {', '.join(holes)}; {describe_bearing(found, fixture, asked, unit)}")
    if found.push is not None:
        x, y = (unit.format_number(value) for value in found.push.at)
        steps.append(
            f"Push the part by hand at ({x}, {y}) {unit.abbreviation} of the plate, towards "
            f"{found.push.direction_deg:g} degrees from its x axis, so that it touches all locators"
        )
    if found.straps:
        bolts = asked.get_bolt_holes(fixture)
        where = [
            f"{bolts.name_place(*one.hole)} with the tip at "
            f"({unit.format_number(one.at[0])}, {unit.format_number(one.at[1])})"
            for one in found.straps
        ]
        steps.append(f"Bolt the straps in {' and in '.join(where)}, in {unit.abbreviation} of the plate")
        heels = " and ".join(unit.format_length(one) for one in sorted({one.height for one in found.straps}))
        above = " above the supports" if found.supports and asked.support_height is None else ""
        steps.append(
            f"Set the heels {heels} high{above}, as high as the face under each tip, and tighten the straps while the hand "
            "pushes"
        )
    if found.clamp_needed is not None:
        steps.append(
            f"Each strap presses with {format_set_force(found.clamp_needed, unit)} or more at its tip"
        )
    if asked.given_force is not None and found.safety_reached is not None:
        steps.append(
            f"With {unit.format_force(asked.given_force)} at each tip, {name_acting(found)} may press "
            f"{format_times(found.safety_reached)} as hard as given"
        )
    return steps


def describe_bearing(found: StrappedHold, fixture: Fixture, asked: StrapQuestion, unit: Unit) -> str:
    """Return a phrase that names the part's rest: the plate, or supports."""
    if not asked.is_over_supports:
        return "the part lies on the plate"
    if not found.supports:
        return "the part lies on three supports"
    plate, height = asked.find_plate(fixture), asked.support_height
    high = "" if height is None else f" {unit.format_length(height)} high"
    return f"the part lies on supports{high} in {', '.join(plate.name_place(*one) for one in found.supports)}"


def stands_on_supports(found: StrappedHold, fixture: Fixture, asked: StrapQuestion) -> bool:
    """Return whether the centre of the part's area is over the triangle of its three supports."""
    plate = asked.find_plate(fixture)
    corners = np.array([plate.compute_hole_center(*one) for one in found.supports], np.float64)
    return bool(contain_point(find_middle(fixture, fixture.listing.result.workpiece), corners[None])[0])


def list_remarks(found: StrappedHold) -> list[str]:
    """Return a sentence on the finite set of places from which the straps were chosen; empty without straps."""
    if not found.straps:
        return []
    if found.supports:
        return [
            f"The supports and straps are the best of all sets of three among {found.places} holes under the part, with "
            "each tip over a support."
        ]
    return [
        f"The straps are the best of {found.places} places: points of the rings about the bolts' holes, every 30 degrees."
    ]


def describe_program_need(need: ProgramJawForce, program: Program, unit: Unit) -> str:
    """Return a sentence on the force of each strap that a program needs, and its line."""
    where = find_place(need, program, unit)
    if need.force is None:
        return f"No force of the straps holds the part in {where}."
    return f"The program asks for {round_force_up(need.force, unit)} of each strap at its tip, in {where}."


def describe_program_safety(found: StrappedHold, asked: StrapQuestion, unit: Unit) -> str:
    """Return a sentence on how many times the given force holds the program's tools; "" where it is not known."""
    if found.program_need is None or not found.safety_each or asked.given_force is None:
        return ""
    times = format_times(found.safety_each[-1])
    return f"With {unit.format_force(asked.given_force)} at each tip its tools may press {times} as hard."


def find_place(need: ProgramJawForce, program: Program, unit: Unit) -> str:
    """Return a phrase with the line, the tool and the cut at which a program needs the largest force."""
    cut = find_cut_of_move(program, need.move)
    return AskedForce(need.force or 0.0, need.line, need.tool, None, cut).describe_place(unit)


def list_hit_locators(fixture: Fixture, asked: StrapQuestion) -> list[str]:
    """Return the names of the holes whose locators a tool of the program comes too near to.

    It is [] if there are none, or if the tools are known to clear all locators.
    """
    if asked.program is None or asked.peg_height is None:
        return []
    plate = asked.find_plate(fixture)
    pegs = [peg for peg in asked.list_locators(fixture) if peg.carrier == plate.name]
    at = np.array([(peg.x, peg.y) for peg in pegs], np.float64)
    points = np.column_stack(fixture.pose.inverse.apply(at[:, 0], at[:, 1]))
    swept = find_swept_below(asked.program, asked.peg_height)
    clear = keep_clear(swept, asked.program, points, points, plate.body_radius)
    return [
        plate.name_place(peg.column, peg.row)
        for peg, is_clear in zip(pegs, clear, strict=True)
        if not is_clear
    ]


def name_acting(found: StrappedHold) -> str:
    """Return a name for the loads on the part: "the loads", "the tools", or both."""
    names = ("the loads", bool(found.clamp_needed_each)), ("the tools", found.program_need is not None)
    return " and ".join(name for name, is_there in names if is_there)


def describe_assumptions(asked: StrapQuestion) -> str:
    """Return a sentence with the coefficients of friction and the safety factor."""
    given = dict(asked.friction or ())
    named = (
        f"{find_friction_coefficient(asked.friction, name):g} between {COEFFICIENTS[name].between}"
        f" ({'as given' if name in given else 'usual'})"
        for name in asked.counted
    )
    return f"Friction {' and '.join(named)}; loads times {asked.safety:g}."


def list_warnings(found: StrappedHold, fixture: Fixture, asked: StrapQuestion, unit: Unit) -> list[str]:
    """Return warnings about a hold by straps, as sentences with a full stop."""
    out = []
    if not found.is_looked_at:
        return [
            "no push and no straps were looked for at this seat, as it is not among the best: ask for more of them."
        ]
    if not found.straps and found.places is not None:
        out.append(describe_missing_places(asked))
    if found.supports and not stands_on_supports(found, fixture, asked):
        out.append(
            "the part does not stand on these supports by itself: hold it down until the straps are tight."
        )
    hit = list_hit_locators(fixture, asked)
    if hit:
        out.append(f"a tool of the program comes too near to {', '.join(hit)}, where a locator stands.")
    if found.push is None:
        out.append("unfit: no push by hand presses the part against all three locators.")
    for number, need in enumerate(found.clamp_needed_each, 1):
        if need is None:
            out.append(f"no force of the straps holds load {number}.")
    asked_by, program = found.program_need, asked.program
    if asked_by is not None and asked_by.force is None and program is not None:
        out.append(f"no force of the straps holds the part in {find_place(asked_by, program, unit)}.")
    most, need = found.max_force, found.clamp_needed
    if most is not None and need is not None and need > most:
        out.append(f"{name_acting(found)} ask for {need:.0f} N, and a strap is rated for {most:g} N.")
    given, reached = asked.given_force, found.safety_reached
    if most is not None and given is not None and given > most:
        out.append(
            f"{unit.format_force(given)} are to be at each tip, and a strap is rated for {unit.format_force(most)}."
        )
    if given is not None and reached is not None and reached < asked.safety:
        out.append(
            f"{unit.format_force(given)} at each tip hold {name_acting(found)} {format_times(reached)}, and "
            f"{asked.safety:g} times are asked for."
        )
    return out


def describe_missing_places(asked: StrapQuestion) -> str:
    """Return a sentence on why there are no straps, and what to change."""
    free = " clear of the program" if asked.program is not None else ""
    if asked.is_over_supports:
        return (
            f"there are no three supports{free} under the part with {asked.straps.count} of these straps over them: take "
            "another number, smaller pads or tips, a longer reach, or a finer pitch."
        )
    return (
        f"there are no places{free} where {asked.straps.count} of these straps press the part flat on the plate: take "
        "another number, smaller tips or a longer reach."
    )
