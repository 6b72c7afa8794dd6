"""The height of pegs beside a solid if the user does not give it but the pegs' diameter is known.

A dowel that stands out far bends. So pegs are only as high as needed to touch half of the border that pegs of
the best height could touch. They are dowels that are sold, which sit 1.5 diameters deep (SOLID, "Which
height").
"""

from __future__ import annotations

from collections.abc import Sequence

from attrs import frozen

from workhold.conventions import DOWEL_STANDOUT, SAME_HEIGHT
from workhold.errors import InputError
from workhold.files.questions import PEG_HEIGHT
from workhold.files.step.heights import StandingSolid, measure_outline
from workhold.model.dowel_lengths import find_shortest_dowel, list_standouts
from workhold.model.solid import HeightRow, slides_at_every_height

__all__ = ["UsualPegHeight", "choose_usual_height"]

# The share of what the best height touches.
SHARE = 0.5
# A length of border that is this much shorter, as a share, is as long: it is summed up of many pieces.
ROUNDED = 1e-9


@frozen
class UsualPegHeight:
    """The default height of pegs.

    Parameters
    ----------
    peg_height : height of the pegs in mm.
    height : height of the part in mm.
    diameter : diameter of the pegs in mm.
    decides_numbers : whether the numbers of faces depend on it, as they do unless the part is a prism.
    slides : whether pegs of no height keep the part from sliding.
    """

    peg_height: float
    height: float
    diameter: float
    decides_numbers: bool
    slides: bool = False

    @property
    def is_whole(self) -> bool:
        """Whether pegs are as tall as the part."""
        return self.peg_height >= self.height - SAME_HEIGHT

    @property
    def remarks(self) -> list[str]:
        """A sentence on the pegs' height, its reason, and how to get taller pegs; empty if they are as tall
        as the part.
        """
        if self.is_whole:
            return []
        dowel = find_shortest_dowel(self.diameter, self.peg_height)
        what = "" if dowel is None else f", as dowels of {dowel.name} do that sit {dowel.depth:.6g} mm deep"
        more = (
            "lower ones would touch less than half of what pegs can touch here, and higher ones bend more"
            if self.peg_height > DOWEL_STANDOUT * self.diameter + SAME_HEIGHT
            else "higher ones bend more, and these touch at least half of what pegs can touch here"
        )
        said = f"Pegs are taken to stand out {self.peg_height:.6g} mm{what}: {more}."
        taller = f" For pegs as tall as the part give {PEG_HEIGHT} {self.height:.6g}mm."
        return [said if self.slides else said + taller]


def choose_usual_height(
    solid: StandingSolid,
    rows: Sequence[HeightRow],
    diameter: float,
    room: float,
    least: float,
    is_prism: bool,
) -> UsualPegHeight:
    """Return the height of pegs to take: of those up to twice their diameter the highest that touches enough,
    or else the lowest of the higher ones that does.

    Enough is half of the touchable border of the best height. If no height touches enough, the part's height
    is taken. All lengths are in mm.

    Parameters
    ----------
    rows : ranges of peg heights with their outlines; not used for a prism.
    diameter : diameter of the pegs.
    room : head room kept free above the pegs.
    least : shortest band that may be touched.
    """
    top = solid.height
    enough = SHARE * max((row.touchable for row in rows), default=0.0)

    def touches_enough(height: float) -> bool:
        """Return whether pegs of a height can touch half of what pegs of the best height can."""
        if is_prism:
            return height >= least - SAME_HEIGHT
        try:
            return measure_outline(solid.make_outline(height, room, least))[2] >= enough * (1 - ROUNDED) > 0
        except InputError:
            return False

    # Without dowels of this diameter, the heights at which what pegs meet changes, with that of the part.
    offered = list_standouts(diameter) or sorted({row.high for row in rows} | {top})
    heights = [one for one in offered if one <= top + SAME_HEIGHT]
    usual = min(DOWEL_STANDOUT * diameter, top) + SAME_HEIGHT
    low = [one for one in heights if one <= usual]
    in_order = [*reversed(low), *(one for one in heights if one > usual)]
    found = next((one for one in in_order if touches_enough(one)), top)
    return UsualPegHeight(min(found, top), top, diameter, not is_prism, slides_at_every_height(rows))
