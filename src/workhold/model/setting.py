"""What a machinist sets on each thing that moves, of which every picture, sheet and table tells.

Of a vise it is the opening. Of a clamp that is bolted in a hole it is the stroke, from the hole to the tip; of one of
which only the line is known, how far its tip is from the first column or row.
"""

from __future__ import annotations

from collections.abc import Mapping

from attrs import frozen

from workhold.fixels.carrier import Carrier, Measure
from workhold.fixels.contact_kind import CLAMP_TIP
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Point
from workhold.model.fixture import Fixture, Peg

__all__ = ["Mounting", "Setting", "contact_names", "settings_of"]


@frozen
class Mounting:
    """How a clamp is put on its plate, in words that take its name for ``{clamp}`` and its hole or line for ``{place}``.

    Parameters
    ----------
    label : above the place.
    there : where the clamp is.
    put : what is done with it.
    how : what is measured, a sentence without the end, which takes the setting's title for ``{title}``.
    then : what is measured once the tip touches, which takes the setting's title and name.
    """

    label: str
    there: str
    put: str
    how: str
    then: str


BOLTED = Mounting(
    "bolted in",
    "bolted in {place}",
    "Bolt {clamp} in {place}",
    "Stroke: from the centre of hole {place} to the centre of the tip",
    "Its {name}",
)
ALONG = Mounting(
    "along", "on {place}", "Set {clamp} so that its tip is on {place}", "{title}, to its centre", "The {title},"
)
MOUNTINGS: Mapping[Measure, Mounting] = {"stroke": BOLTED, "tip": ALONG}


@frozen
class Setting:
    """A length to set.

    Parameters
    ----------
    name : what it is called, such as "opening S".
    title : the same above the length itself.
    sign : what stands before it on a drawing, such as "S".
    length : in mm.
    start, end : the points that it is measured between along the travel, in mm.
    carrier : what moves.
    tip : the peg of a clamp that touches the part; None of what has a lattice of its own.
    """

    name: str
    title: str
    sign: str
    length: float
    start: Point
    end: Point
    carrier: Carrier
    tip: Peg | None = None

    @property
    def short(self) -> str:
        """What it is called over a column of lengths."""
        return self.name if self.carrier.measure == "tip" else self.sign

    @property
    def mounting(self) -> Mounting:
        """How the clamp is put on its plate."""
        return MOUNTINGS[self.carrier.measure]

    @property
    def label(self) -> str:
        """What stands above the clamp's place."""
        return f"{self.carrier.noun.capitalize()} {self.mounting.label}"

    @property
    def place(self) -> str:
        """The clamp's hole, or its line; nothing of what has a lattice of its own."""
        if self.tip is None:
            return ""
        return self.carrier.place_name(self.tip.column, self.tip.row).removeprefix(f"{self.carrier.noun} ")

    @property
    def caption(self) -> str:
        """Its title as a sentence begins."""
        return f"{self.title[0].upper()}{self.title[1:]}"


def settings_of(fixture: Fixture, toolkit: Toolkit) -> tuple[Setting, ...]:
    """What there is to set: of a vise one length, of clamps one each in their order, and nothing where nothing moves.

    Examples
    --------
    >>> from workhold.model.fixture import Pose
    >>> from workhold import Plate
    >>> plate, tip = Plate(pitch=20, peg_radius=3, travel=(10, 30)), Peg("clamp -x", 4, 1, 66.0, 20.0, 2, 1.0)
    >>> (setting,) = settings_of(Fixture("clamp", (tip,), Pose(0, 0, 0), -14.0, {}, "-x"), plate)
    >>> setting.sign, setting.length, setting.start
    ('stroke', 14.0, (80.0, 20.0))
    """
    clamps = [peg for peg in fixture.pegs if toolkit.carrier(peg.carrier).contact is CLAMP_TIP]
    if clamps:
        return tuple(
            clamp_setting(tip, toolkit, travelled, len(clamps))
            for tip, travelled in zip(clamps, fixture.travels, strict=True)
            if toolkit.carrier(tip.carrier).travel is not None
        )
    travelled, name = fixture.jaw_separation, "opening S"
    return tuple(
        Setting(
            name=name,
            title=f"{name} of the {carrier.noun}s",
            sign="S",
            length=travelled,
            start=carrier.place(0, 0),
            end=carrier.place(0, 0, travelled),
            carrier=carrier,
        )
        for carrier in toolkit.carriers
        if carrier.travel is not None and carrier.has_lattice
    )


def clamp_setting(tip: Peg, toolkit: Toolkit, travelled: float, clamps: int) -> Setting:
    """What there is to set on one of some clamps."""
    carrier, end = toolkit.carrier(tip.carrier), (tip.x, tip.y)
    named = f"the {carrier.noun}" if clamps == 1 else carrier.place_name(tip.column, tip.row)
    if carrier.measure == "stroke":
        start, stroke = carrier.place(tip.column, tip.row), 0.0 - toolkit.clamping * travelled
        return Setting("stroke", f"stroke of {named}, from hole to tip", "stroke", stroke, start, end, carrier, tip)
    column, row = toolkit.datum.lines
    if carrier.line == "row":
        sign, first, length, start = "x", column, tip.x, (0.0, tip.y)
    else:
        sign, first, length, start = "y", row, tip.y, (tip.x, 0.0)
    return Setting(f"tip {sign}", f"tip of {named}, {sign} from {first}", sign, length, start, end, carrier, tip)


def contact_names(fixture: Fixture, toolkit: Toolkit) -> list[str]:
    """What the contacts of a fixture are called in a table: by their holes or lines, the only clamp by its name."""
    clamps = [peg for peg in fixture.pegs if toolkit.carrier(peg.carrier).contact is CLAMP_TIP]
    return [toolkit.carrier(peg.carrier).noun if [peg] == clamps else peg.hole for peg in fixture.pegs]
