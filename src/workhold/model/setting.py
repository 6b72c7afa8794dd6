"""What a machinist sets on the carrier that moves, of which every picture, sheet and table tells.

Of a vise it is the opening. Of a clamp that is bolted in a hole it is the stroke, from the hole to the tip; of one of
which only the line is known, how far its tip is from the first column or row.
"""

from __future__ import annotations

from attrs import frozen

from workhold.geometry.segment import Point
from workhold.model.fixture import Fixture
from workhold.model.toolkit import Carrier, Toolkit

__all__ = ["Setting", "mover_of", "setting_of"]


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
    """

    name: str
    title: str
    sign: str
    length: float
    start: Point
    end: Point


def mover_of(fixture: Fixture, toolkit: Toolkit) -> Carrier:
    """The carrier that moves in a fixture: that of its last peg, where a toolkit has several or none."""
    moving = [carrier for carrier in toolkit.carriers if carrier.travel is not None]
    return moving[0] if len(moving) == 1 else toolkit.carrier(fixture.pegs[-1].carrier)


def setting_of(fixture: Fixture, toolkit: Toolkit) -> Setting | None:
    """What there is to set; None where nothing moves.

    Examples
    --------
    >>> from workhold.model.fixture import Peg, Pose
    >>> from workhold import Plate
    >>> plate, tip = Plate(pitch=20, peg_radius=3, travel=(10, 30)), Peg("clamp -x", 4, 1, 66.0, 20.0, 2, 1.0)
    >>> setting = setting_of(Fixture("clamp", (tip,), Pose(0, 0, 0), -14.0, {}, "-x"), plate)
    >>> setting.sign, setting.length, setting.start
    ('stroke', 14.0, (80.0, 20.0))
    """
    carrier, travelled = mover_of(fixture, toolkit), fixture.jaw_separation
    if carrier.travel is None:
        return None
    if carrier.on is None:
        start, end = carrier.place(0, 0), carrier.place(0, 0, travelled)
        name = "opening S"
        return Setting(name, f"{name} of the {carrier.noun}s", "S", travelled, start, end)
    tip = fixture.pegs[-1]
    end = (tip.x, tip.y)
    if carrier.has_a_hole:
        start, stroke = carrier.place(tip.column, tip.row), 0.0 - toolkit.clamping * travelled
        return Setting("stroke", f"stroke of the {carrier.noun}, from hole to tip", "stroke", stroke, start, end)
    if carrier.is_along_x:
        sign, first, length, start = "x", "column A", tip.x, (0.0, tip.y)
    else:
        first = "row 1" if toolkit.wall is None else f"the {toolkit.wall.noun}"
        sign, length, start = "y", tip.y, (tip.x, 0.0)
    return Setting(f"tip {sign}", f"tip of the {carrier.noun}, {sign} from {first}", sign, length, start, end)
