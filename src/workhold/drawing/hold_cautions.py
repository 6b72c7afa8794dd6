"""What a sheet says to beware of where friction holds the part."""

from __future__ import annotations

from workhold.model.fixture import Fixture
from workhold.model.hold_words import list_jaw_cautions
from workhold.model.jaw_hold import JawHold
from workhold.supports.straps import make_question
from workhold.supports.words_of_straps import list_warnings
from workhold.units import MILLIMETRE

__all__ = ["list_hold_cautions"]


def list_hold_cautions(fixture: Fixture) -> list[tuple[str, str]]:
    """Return (kind, sentence) of each caution of a fixture held by friction."""
    hold = fixture.hold
    if isinstance(hold, JawHold):
        return list_jaw_cautions(hold)
    assert hold is not None
    kind = "unfit" if hold.is_unfit or hold.holds_nothing else "load"
    said = list_warnings(hold, fixture, make_question(fixture.listing.result.query), MILLIMETRE)
    return [(kind, f"{words[:1].upper()}{words[1:]}") for words in said]
