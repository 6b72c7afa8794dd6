"""Tasks and answers about seating: whether a part ends up where a fixture wants it, and closings from where it was put."""

from __future__ import annotations

from math import inf
from typing import Annotated, Any, Literal

from attrs import frozen
from pydantic import Field

from workhold.drawing.length_unit import LengthUnit
from workhold.drawing.seating_words import SeatingWords
from workhold.drawing.sheet_seating import caption
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture, Pose
from workhold.model.seating import Seating
from workhold.model.workpiece import Workpiece
from workhold.presenting.data import finite
from workhold.seating.by_hand import ByHand, by_hand
from workhold.seating.pattern import Pattern
from workhold.units import unit_named
from workhold.web.forms import LARGEST, Form, Number
from workhold.web.worker import Order

__all__ = ["ClosingForm", "ClosingOrder", "close", "find_seating", "seating_answer"]

# A fixture and what it is of.
Held = tuple[Fixture, Workpiece, Toolkit]


class ClosingForm(Form):
    """Where the part was put, turned over (x to -x in its own frame) where that is said, and how far the jaws are open
    beyond where they hold the part, or a clamp is drawn back; in mm and degrees. The unit is of lengths in sentences."""

    theta_deg: Number
    x: Number
    y: Number
    opening: Annotated[float, Field(ge=0, le=LARGEST)]
    turned_over: bool = False
    unit: Literal["mm", "inch"] = "mm"


@frozen(eq=False)
class ClosingOrder:
    """What to close from where.

    Parameters
    ----------
    held : the fixture.
    told : its seating.
    form : where the part was put.
    """

    held: Held
    told: Seating
    form: ClosingForm


def words_of(held: Held, told: Seating, unit: str) -> SeatingWords:
    """What a seating means in words."""
    return SeatingWords(told, held[0], held[2], lengths_of(held, unit))


def lengths_of(held: Held, unit: str) -> LengthUnit:
    """How lengths are written in a unit."""
    return LengthUnit.suiting(unit_named(unit), min(min(carrier.pitch) for carrier in held[2].carriers))


def find_seating(held: Held, order: Order) -> Seating | ByHand:
    """The seating of a fixture, worked out where the result has none; with two clamps how the part is put in."""
    from workhold.seating.solver import Solver

    fixture, workpiece, toolkit = held
    if not toolkit.closes_at_once:
        return by_hand(fixture, workpiece, toolkit)
    told: Seating = fixture.seating or Solver(workpiece, toolkit).of(fixture)
    return told


def seating_answer(held: Held, told: Seating | ByHand, unit: str) -> dict[str, Any]:
    """The fields of a seating as a result file has them, with what they mean in words; with two clamps, what to do in
    ``by_hand``.

    ``own`` is the place of the fixture's own seat in ``seats``, ``nearest`` are the places of the wrong ones that the jaws
    open to, those that read most like it first; ``clamping`` is 1 where ``jaw_separation`` falls while the part is clamped,
    -1 where it rises; ``widest`` is how far in mm it can be opened beyond where it holds the part, and ``done`` that it is
    opened, in a word; ``captions`` are lines for each seat.
    """
    if isinstance(told, ByHand):
        return {"by_hand": told.as_fields(lengths_of(held, unit).words)}
    words, seats = words_of(held, told, unit), list(told.seats)
    travel = words.gauge.carrier.travel
    assert travel is not None
    # Of what clamps by opening, pegs that meet are the end.
    end = travel.most if told.clamping > 0 and travel.most is not None else inf
    widest = min(Pattern.of(held[0], held[2]).widest, end) - told.clamping * held[0].jaw_separation
    return {
        **told.as_fields(),
        "own": seats.index(words.own),
        "nearest": [seats.index(seat) for seat in words.wrong],
        "clamping": told.clamping,
        "widest": finite(widest),
        "done": words.gauge.ways.done,
        "captions": [caption(words, seat) for seat in seats],
        "steps": words.steps(held[1]),
        "words": words.wrong_words(),
    }


def close(payload: ClosingOrder, order: Order) -> dict[str, Any] | None:
    """The way of a closing, what it ends in and what is read then; None once nobody wants to know any more."""
    from workhold.seating.closing_simulation import simulate_closing
    from workhold.seating.solver import Solver

    form, told = payload.form, payload.told
    fixture, workpiece, toolkit = payload.held
    pose = Pose(form.theta_deg, form.x, form.y)
    closed = simulate_closing(
        Solver(workpiece, toolkit), fixture, told.seats, pose, form.opening, form.turned_over, order.cancel.is_set
    )
    if order.cancel.is_set():
        return None
    opened = [told.clamping * (travelled - fixture.jaw_separation) for travelled in closed.travels]
    return {
        "way": [[one.theta_deg, one.x, one.y, more] for one, more in zip(closed.poses, opened, strict=True)],
        "ending": closed.ending,
        "seat": None if closed.seat is None else told.seats.index(closed.seat),
        "words": words_of(payload.held, told, form.unit).ended(closed.ending, closed.seat, closed.travels[-1]),
    }
