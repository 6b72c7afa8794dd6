"""The blocks of a setup sheet that tell of a plate with locators and clamps, in place of those that tell of a vise."""

from __future__ import annotations

from functools import partial

from workhold.drawing.panel import NUMBERS, Column, diameter_words
from workhold.drawing.sheet_pegs import put_words, touch_words
from workhold.drawing.sheet_writing import (
    BODY,
    NOTE,
    MovingBlocks,
    Sheet,
    Writer,
    fact_or_field,
    heading,
    inside_words,
    lies_words,
)
from workhold.model.setting import Setting
from workhold.model.tightening import clamp_names, clamp_shares, freedom_words, order_words, second_over_first
from workhold.plain import listed

__all__ = ["CLAMPS"]


def clamp_writers(sheet: Sheet) -> list[Writer]:
    """The blocks about the clamp, or about each of two and the order in which they are tightened."""
    shares = clamp_shares(sheet.fixture)
    each: list[Writer] = [
        partial(write_clamp, setting=one, share=share) for one, share in zip(sheet.settings, shares, strict=True)
    ]
    return each if sheet.is_closed_at_once else [*each, write_order]


def write_clamp(column: Column, sheet: Sheet, setting: Setting, share: float) -> None:
    """Write where a clamp is bolted, which way it pushes, how far its tip is out and with what share of the force."""
    clamp, lengths = setting.carrier, sheet.lengths
    heading(column, f"{setting.label} {setting.place}")
    column.words(lengths.words(setting.length), 28 if sheet.is_closed_at_once else 22, bold=True, gap=0.4)
    how = setting.mounting.how.format(place=setting.place, title=setting.caption)
    column.paragraph(f"{how}, once it touches.", NOTE)
    column.y += 3
    direction = clamp.direction.replace("-", "−")
    column.fact("pushes", f"{clamp.towards}, {direction}", bold=True)
    column.fact("round tip", diameter_words(clamp, lengths), bold=True)
    if clamp.travel is not None and clamp.travel.most is not None:
        least, most = sorted((abs(clamp.travel.least), abs(clamp.travel.most)))
        column.fact("stroke it has", f"{lengths.short_number(least)} to {lengths.short(most)}")
    force, unit = sheet.details.jaw_force, lengths.unit
    fact_or_field(column, f"{clamp.noun} force", None if force is None else unit.force_words(share * force))
    if sheet.details.loads:
        needed = share * needed_force(sheet)
        column.fact("the loads need at least", f"{unit.force_above(needed)} {unit.force}", bold=True)
    fact_or_field(column, "torque of its screw", None)


def needed_force(sheet: Sheet) -> float:
    """The clamp force, of two clamps added up, that the loads need, in N."""
    return max(case.needed.value for case in sheet.details.loads)


def write_order(column: Column, sheet: Sheet) -> None:
    """Write in which order two clamps are tightened, and in which ratio."""
    fixture, (first, second) = sheet.fixture, clamp_names(sheet.fixture)
    heading(column, "Order of tightening")
    column.paragraph(order_words(fixture), BODY, bold=True)
    ratio = second_over_first(fixture)
    freedom = fixture.quality["clamp_freedom"]
    column.fact("clamp freedom, of 90°", f"{freedom:.1f}°", bold=True)
    column.paragraph(
        f"{freedom_words(freedom).capitalize()}. Forces here are told for {second} with {ratio:.2f} times the force of "
        f"{first}, the middle of what holds.",
        NOTE,
    )


def clamp_steps(sheet: Sheet) -> list[str]:
    """What to do, one or two sentences each."""
    toolkit, lengths, alone = sheet.toolkit, sheet.lengths, sheet.is_closed_at_once
    plate, noun = toolkit.plates[0], toolkit.moving.noun
    bolts, ups = [], []
    for setting, tip in zip(sheet.settings, sheet.fixture.pegs[-len(sheet.settings) :], strict=True):
        put = setting.mounting.put.format(clamp=f"{'the' if alone else 'a'} {noun}", place=setting.place)
        bolts.append(f"{put}, pushing {setting.carrier.towards}, and draw it back.")
        one = f"the {noun}" if alone else tip.hole
        what = setting.mounting.then.format(name=setting.name, title=setting.title)
        ups.append(
            f"Bring {one} up until its tip touches face {tip.face}. {what} is then {lengths.words(setting.length)}"
            f"{'; if not, the part lies another way.' if alone else '.'}"
        )
    if not alone:
        ups.append("If a length is not as told, the part lies another way.")
    count = sum(peg.carrier == plate.name for peg in sheet.fixture.pegs)
    against = toolkit.setup_words.against.format(count=NUMBERS[count], peg=plate.peg)
    return [
        f"{put_words(sheet)} {' '.join(bolts)}",
        f"Lay the part in as drawn, {lies_words(sheet)}, {against}.{inside_words(sheet)}",
        " ".join(ups),
        f"{clamping_words(sheet)} They touch: {touch_words(sheet)}",
    ]


def clamping_words(sheet: Sheet) -> str:
    """How to clamp, and with what force where that is known."""
    fixture, force, unit = sheet.fixture, sheet.details.jaw_force, sheet.lengths.unit
    if sheet.is_closed_at_once:
        return f"Clamp{'' if force is None else f' with {unit.force_words(force)}'}."
    if force is None:
        return order_words(fixture)
    shares = zip(clamp_names(fixture), clamp_shares(fixture), strict=True)
    each = [f"{unit.force_words(share * force)} at {name}" for name, share in shares]
    return f"{order_words(fixture)} {listed(each)} make the {unit.force_words(force)} given."


CLAMPS = MovingBlocks(clamp_writers, clamp_steps)
