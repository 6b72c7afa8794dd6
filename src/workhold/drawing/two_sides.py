"""The block of a setup sheet about a solid's sides: which one is up, and what the set-up before has done."""

from __future__ import annotations

from workhold.drawing.panel import TextColumn
from workhold.drawing.sheet_writing import BODY, Sheet, heading
from workhold.errors import listed
from workhold.model.first_side import FirstSide
from workhold.model.solid import SolidOutline

__all__ = ["side_up_words", "write_side_up"]

ON_NO_FACE = "The part lies on no level face: hold it level, on vee blocks or packing, while it is clamped."


def write_side_up(column: TextColumn, sheet: Sheet) -> None:
    """Writes which side of the solid is up, and which of its faces the set-up before cut or located on."""
    solid, before = sheet.workpiece.solid, sheet.details.first_side
    assert solid is not None
    heading(column, "Which side is up" if before is None else "Second set-up of the same part")
    for words in side_up_words(solid, before):
        column.paragraph(words, BODY)
    if solid.lies_on_no_face:
        column.paragraph(ON_NO_FACE, BODY)


def side_up_words(solid: SolidOutline, before: FirstSide | None) -> list[str]:
    """Sentences on the side that is up, and on a set-up before."""
    up = solid.axis.replace("-", "−")
    sentences = [f"{up} of the file points up."]
    if before is None:
        return sentences
    if before.up == before.up_before:
        return [f"The same side is up as in the first set-up: {up} of the file.", *face_words(before)]
    was = before.up_before.replace("-", "−")
    return [
        f"Second side up: {up} of the file points up, {was} did before. The part is {before.turned}.",
        *face_words(before),
    ]


def face_words(before: FirstSide) -> list[str]:
    """Sentences on faces that were cut before, and on those that both set-ups touch."""
    found = []
    cut = listed([str(number) for number in before.cut_of_solid]) if before.cut_of_solid else ""
    cut_faces = f"face {cut}" if len(before.cut_of_solid) == 1 else f"faces {cut}"
    if before.cut:
        faces = listed([str(number) for number in before.cut])
        noun = "Face" if len(before.cut) == 1 else "Faces"
        found.append(
            f"{noun} {faces} of this outline must not be touched: the first set-up cuts {cut_faces} of the "
            "solid."
        )
    elif before.cut_of_solid:
        found.append(
            f"What the first set-up cuts ({cut_faces} of the solid) is not in reach of the pegs here."
        )
    else:
        found.append("The first set-up names no face that it cuts.")
    if before.shared:
        faces = listed([str(number) for number in before.shared])
        noun = "Face" if len(before.shared) == 1 else "Faces"
        found.append(
            f"{noun} {faces} of the solid {'is' if len(before.shared) == 1 else 'are'} touched in both "
            "set-ups, in the first by its best fixture."
        )
    else:
        found.append("No face is touched in both set-ups: what one locates on, the other does not.")
    return found
