"""What a machinist sets on each thing that moves, of which every picture, sheet and table tells.

Of a vise it is the opening. Of a clamp that is bolted in a hole it is the stroke, from the hole to the tip; of one of
which only the line is known, how far its tip is from the first column or row.
"""

from __future__ import annotations

from attrs import frozen

from workhold.geometry.segment import Point
from workhold.model.fixture import Fixture, Peg
from workhold.model.toolkit import Carrier, Toolkit

__all__ = ["Setting", "settings_of"]


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
    clamps = [peg for peg in fixture.pegs if toolkit.carrier(peg.carrier).on is not None]
    if clamps:
        travels = (fixture.jaw_separation,) if fixture.pair is None else fixture.pair.travels
        return tuple(
            clamp_setting(tip, toolkit, travelled, len(clamps))
            for tip, travelled in zip(clamps, travels, strict=True)
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
        if carrier.travel is not None and carrier.on is None
    )


def clamp_setting(tip: Peg, toolkit: Toolkit, travelled: float, clamps: int) -> Setting:
    """What there is to set on one of some clamps."""
    carrier, end = toolkit.carrier(tip.carrier), (tip.x, tip.y)
    named = f"the {carrier.noun}" if clamps == 1 else carrier.place_name(tip.column, tip.row)
    if carrier.has_a_hole:
        start, stroke = carrier.place(tip.column, tip.row), 0.0 - toolkit.clamping * travelled
        return Setting("stroke", f"stroke of {named}, from hole to tip", "stroke", stroke, start, end, carrier, tip)
    if carrier.is_along_x:
        sign, first, length, start = "x", "column A", tip.x, (0.0, tip.y)
    else:
        first = "row 1" if toolkit.wall is None else f"the {toolkit.wall.noun}"
        sign, length, start = "y", tip.y, (tip.x, 0.0)
    return Setting(f"tip {sign}", f"tip of {named}, {sign} from {first}", sign, length, start, end, carrier, tip)
