"""A fixture of every kind of toolkit, for tests of bodies in space."""

from __future__ import annotations

from functools import cache

from workhold import Fence, Fixture, FlatJaw, OpeningVise, Plate, Vise, Workpiece, design
from workhold.fixels.toolkit import Toolkit

# A block with slanted sides, a round corner, and a window that pegs may stand in.
BLOCK = Workpiece.from_loops(
    "block",
    [
        [(0, 0, 0), (62, 3, 0), (66, 40, 0.3), (56, 52, 0), (4, 47, 0)],
        [(18, 14, 0), (16, 36, 0), (46, 38, 0), (48, 15, 0)],
    ],
)
TOOLKITS: dict[str, Toolkit] = {
    "vise": Vise((10, 9), 3, 2.5),
    "flats": Vise((10, 9), 3, 2.5, flat=1.5),
    "touching holes": Vise((10, 10), 3, 5.0),
    "opening-vise": OpeningVise((5, 6), 3, 1.5),
    "plate": Plate((12, 10), 3, columns=9, rows=9, travel=(5, 30)),
    "two clamps": Plate((12, 10), 3, columns=9, rows=9, travel=(5, 30), clamps=2),
    "fence": Fence((12, 10), 3, wall_offset=6, columns=9, rows=9, travel=(5, 30)),
    "flat-jaw": FlatJaw((10, 9), 2.5),
}


@cache
def held(name: str) -> tuple[Fixture, Workpiece, Toolkit]:
    """The best fixture of a toolkit of :data:`TOOLKITS`."""
    return design(BLOCK, TOOLKITS[name], best=1)[0], BLOCK, TOOLKITS[name]
