"""Sentences about straps: how they are set up, what they are reckoned with, and what to beware of."""

from __future__ import annotations

from workhold.model.fixture import Fixture
from workhold.model.friction import COEFFICIENTS, COUNTED_BY_STRAPS, find_friction_coefficient
from workhold.model.straps import StrappedHold
from workhold.supports.straps import StrapQuestion
from workhold.units import Unit

__all__ = ["list_steps", "list_warnings", "reckoned_with"]


def list_steps(found: StrappedHold, fixture: Fixture, asked: StrapQuestion, unit: Unit) -> list[str]:
    """The steps of a set-up, without full stops."""
    steps = []
    plate = asked.plate(fixture)
    holes = [
        plate.place_name(peg.column, peg.row) for peg in asked.locators(fixture) if peg.carrier == plate.name
    ]
    steps.append(f"Locators stand in {', '.join(holes)}; the part lies on the plate")
    if found.push is not None:
        x, y = (unit.number(value) for value in found.push.at)
        steps.append(
            f"Push the part by hand at ({x}, {y}) {unit.abbreviation} of the plate, towards "
            f"{found.push.direction_deg:g} degrees from its x axis, so that it touches all locators"
        )
    if found.straps:
        bolts = asked.bolts(fixture)
        where = [
            f"{bolts.place_name(*one.hole)} with the tip at ({unit.number(one.at[0])}, {unit.number(one.at[1])})"
            for one in found.straps
        ]
        steps.append(f"Bolt the straps in {' and in '.join(where)}, in {unit.abbreviation} of the plate")
        steps.append(
            "Set the heels "
            f"{' and '.join(unit.format_length(one) for one in sorted({one.height for one in found.straps}))} high, as "
            "high as the face under each tip, and tighten the straps while the hand pushes"
        )
    if found.clamp_needed is not None:
        steps.append(
            f"Each strap presses with {found.clamp_needed / unit.newtons:.0f} {unit.force} or more at its tip"
        )
    if found.straps:
        steps.append(
            f"The straps are the best of {found.places} places: points of the rings about the bolts' holes, every 30 degrees"
        )
    return steps


def reckoned_with(asked: StrapQuestion) -> str:
    """The coefficients of friction and the safety factor, in a sentence."""
    given = dict(asked.friction or ())
    named = (
        f"{find_friction_coefficient(asked.friction, name):g} between {COEFFICIENTS[name].between}"
        f" ({'as given' if name in given else 'usual'})"
        for name in COUNTED_BY_STRAPS
    )
    return f"Friction {' and '.join(named)}; loads times {asked.safety:g}."


def list_warnings(found: StrappedHold, asked: StrapQuestion, unit: Unit) -> list[str]:
    """What to beware of, sentences with a full stop."""
    out = []
    if not found.is_looked_at:
        return [
            "no push and no straps were looked for at this seat, as it is not among the best: ask for more of them."
        ]
    if not found.straps and found.places is not None:
        out.append(
            f"there are no places where {asked.straps.count} of these straps press the part flat on the plate: take another "
            "number, smaller tips or a longer reach."
        )
    if found.push is None:
        out.append("unfit: no push by hand presses the part against all three locators.")
    for number, need in enumerate(found.clamp_needed_each, 1):
        if need is None:
            out.append(f"no force of the straps holds load {number}.")
    most, need = found.max_force, found.clamp_needed
    if most is not None and need is not None and need > most:
        out.append(f"the loads ask for {need:.0f} N, and a strap is rated for {most:g} N.")
    return out
