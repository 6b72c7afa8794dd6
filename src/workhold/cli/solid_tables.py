"""Tables of a solid seen at the height of the pegs: which heights are touched, and what others offer."""

from __future__ import annotations

from collections.abc import Sequence

from workhold.cli.table import Table
from workhold.model.solid import FileSolid, HeightRow, other_way_up
from workhold.model.workpiece import Workpiece
from workhold.units import Unit

__all__ = ["band_table", "height_table", "other_heights", "solid_table"]

# So many other heights of the pegs are named.
MOST_NAMED = 3


def solid_table(solids: Sequence[FileSolid], unit: Unit) -> Table:
    """Tabulates the solids of a file, with their names where it has any."""
    short, named = unit.abbreviation, any(solid.name for solid in solids)
    table = Table((">solid", *(("name",) if named else ()), f"size {short}", "lowest corner"))
    for solid in solids:
        size = " x ".join(unit.number(length) for length in solid.size)
        corner = ", ".join(unit.number(value) for value in solid.low)
        table.add_row(str(solid.number), *((solid.name,) if named else ()), size, f"({corner})")
    return table


def band_table(workpiece: Workpiece, unit: Unit) -> list[Table]:
    """Tabulates the heights at which each face is touched; nothing for a part without heights."""
    solid = workpiece.solid
    if solid is None:
        return []
    table = Table((">face", f"touched at heights {unit.abbreviation}", "faces of the solid"))
    for face in workpiece.faces:
        band = solid.bands[face.number]
        words = "never" if band is None else " to ".join(unit.number(end) for end in band)
        over = sorted({number for k in face.segments for number in (solid.faces[k] if solid.faces else ())})
        table.add_row(str(face.number), words, ", ".join(str(number) for number in over))
    return [table]


def height_table(rows: Sequence[HeightRow], unit: Unit) -> list[Table]:
    """Tabulates what the part offers to pegs of other heights; nothing where nobody looked."""
    if not rows:
        return []
    short = unit.abbreviation
    headings = (
        f">pegs above {short}",
        f">up to {short}",
        f">outline {short}",
        f">touchable {short}",
        f">least band {short}",
    )
    table = Table(headings)
    for row in rows:
        lengths = (row.low, row.high, row.border, row.touchable, row.band)
        table.add_row(*(unit.number(length) for length in lengths))
    return [table]


def other_heights(workpiece: Workpiece, rows: Sequence[HeightRow], unit: Unit) -> list[str]:
    """What may help where pegs as high as these hold a solid nowhere: other heights, and the other side up.

    Parameters
    ----------
    rows : what other heights of the pegs offer; those with more to touch are named first.
    """
    solid = workpiece.solid
    if solid is None:
        return []
    others = [row for row in rows if not row.low < solid.peg_height <= row.high and row.touchable > 0]
    longest = sorted(others, key=lambda row: (-row.touchable, -row.high))[:MOST_NAMED]
    named = [f"--peg-height {unit.number(row.high)}" for row in longest]
    turned = other_way_up(solid.axis)
    offers = f"its other side up (--axis={turned}): workhold features shows what each of them offers."
    if not named:
        return [f"What may help is {offers}"]
    return [f"What may help is another outline, that of {', '.join(named)}, or {offers}"]
