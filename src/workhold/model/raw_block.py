"""The raw block of a first operation: a part's bounding box, grown by the allowances that are still to be cut
away.

The jaws touch a saw-cut block; the finished part lies inside it. The block becomes the workpiece of a query,
and keeps the finished part. Its z = 0 is the block's lower side, so the part's heights are raised by the
allowance below the part.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

import numpy as np
from attrs import evolve, field, fields_dict, frozen

from workhold.errors import InputError
from workhold.fixels.jaw_pair import JawPair
from workhold.limits import convert_real, refuse_long
from workhold.model.jaw_hold import JawHold
from workhold.model.program import Program
from workhold.model.requirements import Load
from workhold.model.stock import Stock
from workhold.model.workpiece import Workpiece

__all__ = [
    "RawBlock",
    "enclose_in_block",
    "measure_jaws_over_part",
    "raise_load",
    "raise_program",
    "to_raw_block",
]


@frozen
class RawBlock:
    """How much larger a raw block is than the box around the finished part.

    Parameters
    ----------
    side : on each of the four sides, in mm.
    top, bottom : above and below the part, in mm.

    Raises
    ------
    InputError
        For lengths below 0.

    Examples
    --------
    >>> RawBlock(side=3, bottom=5).compute_height(25)
    30.0
    """

    side: float = field(default=0.0, converter=convert_real)
    top: float = field(default=0.0, converter=convert_real)
    bottom: float = field(default=0.0, converter=convert_real)

    def __attrs_post_init__(self) -> None:
        for name, value in self.to_dict().items():
            if not (isfinite(value) and value >= 0.0):
                raise InputError(f"the raw block's {name} {value:g} is not a length: give 0 or more, in mm.")
            refuse_long(f"the raw block's {name}", value)

    def to_dict(self) -> dict[str, float]:
        """Return side, top and bottom by name, in mm."""
        return {name: getattr(self, name) for name in fields_dict(type(self))}

    def compute_height(self, part_height: float) -> float:
        """Return the height in mm of the block around a part of this height."""
        return part_height + self.top + self.bottom


def to_raw_block(value: RawBlock | Mapping[str, Any] | None) -> RawBlock | None:
    """Return a raw block from a mapping of "side", "top" and "bottom" to mm; a block and None are returned
    unchanged.

    Raises
    ------
    InputError
        For an unknown name, for what is not a mapping, and the errors of the class.

    Examples
    --------
    >>> to_raw_block({"side": 3, "bottom": 5})
    RawBlock(side=3.0, top=0.0, bottom=5.0)
    """
    if value is None or isinstance(value, RawBlock):
        return value
    if not isinstance(value, Mapping):
        raise InputError(f"a raw block cannot be {value!r}: give its side, top and bottom in mm by name.")
    for name in value:
        if name not in fields_dict(RawBlock):
            raise InputError(
                f"a raw block has no '{str(name)[:40]}': give side, top and bottom, how much larger than the "
                "part it is there."
            )
    return RawBlock(**value)


def enclose_in_block(workpiece: Workpiece, raw: RawBlock) -> Workpiece:
    """Return the raw block around a part as a workpiece, in the part's coordinates, with the part as
    ``finished``.

    Its faces are numbered counter-clockwise seen from above, beginning with the face at the least y.

    Raises
    ------
    InputError
        For a solid whose outline is not the same at all its heights.
    """
    solid = workpiece.solid
    if solid is not None and solid.peg_height + solid.head_room < solid.height:
        raise InputError(
            f"the raw block goes around all of {workpiece.name}, and its outline is that of the lowest "
            f"{solid.peg_height:g} mm: read the part without a peg height."
        )
    x0, y0, x1, y1 = np.array(workpiece.bounds) + raw.side * np.array([-1.0, -1.0, 1.0, 1.0])
    corners = np.array([[x0, y0, 0.0], [x1, y0, 0.0], [x1, y1, 0.0], [x0, y1, 0.0]])
    finished = evolve(workpiece, solid=None, outlines=(), remarks=())
    return Workpiece(workpiece.name, (corners,), finished=finished)


def measure_jaws_over_part(hold: JawHold, raw: RawBlock, jaws: JawPair) -> float:
    """Return the height in mm of the jaws' top above the lower side of the finished part in a raw block.

    It is 0 if the jaws stay below, and inf for jaws of any height.
    """
    return max(jaws.compute_top(hold.parallels) - raw.bottom, 0.0)


def raise_load(load: Load, by: float) -> Load:
    """Return a load that acts ``by`` mm higher; one without a height is returned unchanged."""
    return load if load.height is None else evolve(load, height=load.height + by)


def raise_program(program: Program, by: float, height: float) -> Program:
    """Return a program whose heights are raised by ``by`` mm, so that it cuts a raw block with that allowance
    below the part.

    A program that is already raised is raised by the rest.

    Parameters
    ----------
    height : height of the block, in mm.

    Raises
    ------
    InputError
        If another stock than the usual one is given for the program's forces.
    """
    rest, moves = by - program.raised, program.moves
    stock = program.stock
    if program.forces is not None and not program.is_placed:
        usual = Stock()
        if stock is not None and (stock.side, stock.top, stock.shape) != (usual.side, usual.top, usual.shape):
            raise InputError("the raw block says what stock the program cuts: leave the stock out.")
        stock = Stock(0.0, 0.0, height=height)
    up = np.array([0.0, 0.0, rest])
    return evolve(
        program,
        moves=evolve(moves, start=moves.start + up, end=moves.end + up),
        z_zero=program.z_zero + rest,
        stock=stock,
        raised=by,
    )
