"""The blocks of a setup sheet about the part: which side of it is up, and how it was drawn.

A part turned over shows the mirror image of its outline. Where that is the same outline, nothing
distinguishes the sides. Otherwise two marks do (holes or faces, each unlike any other): on one side only, the
way from one to the other, counter-clockwise about the middle, is less than half a turn. Turning the part in
the plane does not change that. For a solid it is known which side is up, and which faces a set-up before this
one has cut or located on.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import atan2, hypot, pi

from attrs import frozen

from workhold.drawing.bench import LOWEST, draw_inset
from workhold.drawing.panel import TextColumn
from workhold.drawing.scene import Box, LengthUnit
from workhold.drawing.sheet_writing import BODY, SetupSheet, write_fact_or_field, write_heading
from workhold.errors import join_words
from workhold.geometry.segment import Arc, Point
from workhold.geometry.symmetry import find_middle, is_own_mirror_image
from workhold.model.first_side import FirstSide
from workhold.model.fixture import Fixture
from workhold.model.setup import find_hole_centers
from workhold.model.solid import SolidOutline
from workhold.model.workpiece import Workpiece

__all__ = [
    "OutlineMark",
    "find_distinguishing_marks",
    "list_marks",
    "describe_solid_side_up",
    "describe_upper_side",
    "write_part",
    "write_side",
    "write_side_up",
]

# Of the larger one: lengths and radii of two marks that differ by less look the same.
SEEN = 0.025
# The sine of the angle between two marks, seen from the middle, is at least this; and of the part's diagonal
# each is so far from the middle.
APART, AWAY = 0.3, 0.08
# So many of the longest marks are compared.
MOST_MARKS = 60
EIGHTHS = ("right", "upper right", "top", "upper left", "left", "lower left", "bottom", "lower right")
# Height of the picture of the part as drawn by its width, and at most, page units.
TALLEST_INSET, HIGHEST_INSET, INSET_ROOM = 0.75, 150.0, 56.0
ON_NO_FACE = "The part lies on no level face: hold it level, on vee blocks or packing, while it is clamped."


def write_side(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the part's thickness, and which side is up."""
    write_heading(column, "Part and its upper side")
    thickness = sheet.details.thickness if sheet.heights is None else sheet.heights.thickness
    write_fact_or_field(
        column, "thickness", None if thickness is None else sheet.lengths.format_length(thickness)
    )
    column.write_paragraph(describe_upper_side(sheet.workpiece, sheet.fixture, sheet.lengths), BODY)


def write_part(column: TextColumn, sheet: SetupSheet) -> None:
    """Draw the part as it was drawn into the column."""
    x0, y0, x1, y1 = sheet.workpiece.bounds
    height = INSET_ROOM + min(HIGHEST_INSET, column.width * min(TALLEST_INSET, (y1 - y0) / (x1 - x0)))
    height = max(height, LOWEST)
    column.y += 10
    box = Box(column.x, column.y, column.x + column.width, column.y + height)
    draw_inset(column.scene, box, sheet.workpiece, sheet.fixture, sheet.toolkit, sheet.zero.point)
    column.y += height


@frozen
class OutlineMark:
    """A hole or a face of the outer outline; lengths in mm.

    Parameters
    ----------
    hole : number of the hole, from 1; 0 for a face.
    place : its middle, in the part's coordinates, measured from the middle of the part's bounding box.
    length : of its outline.
    radius : radius of a round hole or an arc; 0 for a straight face and a hole with several faces.
    bend : for a face, 1 if it bulges out of the part, -1 if into it, 0 if it is straight; 2 for holes.
    """

    hole: int
    place: Point
    length: float
    radius: float
    bend: int

    def is_like(self, other: OutlineMark) -> bool:
        """Return whether two marks look the same: equal bend, and equal length and radius to within a share
        of ``SEEN``.
        """
        sizes = ((self.length, other.length), (self.radius, other.radius))
        return self.bend == other.bend and all(abs(a - b) <= SEEN * max(a, b) for a, b in sizes)

    def describe(self, lengths: LengthUnit) -> str:
        """Return the mark in words, such as "hole 2, Ø 8 mm,"."""
        if self.hole:
            return f"hole {self.hole}" + (
                f", Ø {lengths.format_short(2 * self.radius, 4)}," if self.radius else ""
            )
        if self.radius:
            shape = "rounding" if self.bend > 0 else "hollow"
            return f"the {shape} of radius {lengths.format_short(self.radius, 4)}"
        return f"the straight edge {lengths.format_short(self.length, 4)} long"


def list_marks(workpiece: Workpiece) -> list[OutlineMark]:
    """Return at most ``MOST_MARKS`` marks: first the holes, then the faces of the outer outline, each longest
    first.
    """
    outer, (x, y) = workpiece.outer_count, workpiece.center
    segments = {face.number: face.segment for face in workpiece.faces}
    holes, number = [], outer
    for count, (loop, at) in enumerate(
        zip(workpiece.hole_segments, find_hole_centers(workpiece), strict=True), 1
    ):
        face = segments.get(number)
        radius = face.radius if isinstance(face, Arc) and face.is_full else 0.0
        holes.append(
            OutlineMark(count, (at[0] - x, at[1] - y), sum(segment.length for segment in loop), radius, 2)
        )
        number += len(loop)
    faces = []
    for segment in (segments[number] for number in segments if number < outer):
        radius, bend = (segment.radius, int(segment.sign)) if isinstance(segment, Arc) else (0.0, 0)
        at = find_middle(segment)
        faces.append(OutlineMark(0, (at[0] - x, at[1] - y), segment.length, radius, bend))
    ordered = [sorted(several, key=lambda mark: -mark.length) for several in (holes, faces)]
    return (ordered[0] + ordered[1])[:MOST_MARKS]


def find_distinguishing_marks(workpiece: Workpiece) -> tuple[OutlineMark, OutlineMark] | None:
    """Return the two most visible marks that are unlike any other mark; None if there are no two such marks.

    They are the pair that spans the largest triangle with the part's middle. The triangle's area counts twice
    if one of them is a hole, three times if both are.
    """
    marks = list_marks(workpiece)
    x0, y0, x1, y1 = workpiece.bounds
    away = AWAY * hypot(x1 - x0, y1 - y0)
    single = [
        mark
        for mark in marks
        if hypot(*mark.place) >= away and not any(mark.is_like(other) for other in marks if other is not mark)
    ]
    best: tuple[float, tuple[OutlineMark, OutlineMark]] | None = None
    for one, other in combinations(single, 2):
        area = abs(one.place[0] * other.place[1] - one.place[1] * other.place[0])
        if area < APART * hypot(*one.place) * hypot(*other.place):
            continue
        plain = area * (1 + (one.hole > 0) + (other.hole > 0))
        if best is None or plain > best[0]:
            best = plain, (one, other)
    return best and best[1]


def describe_upper_side(workpiece: Workpiece, fixture: Fixture, lengths: LengthUnit) -> str:
    """Return sentences on how to tell which side of the part is up."""
    if is_own_mirror_image([face.segment for face in workpiece.faces]):
        if workpiece.solid is not None:
            up = f"{workpiece.solid.axis.replace('-', '−')} of the file points up"
            return f"Upside down the part would fit the same pegs too: make sure that {up}."
        return (
            "The outline is its own mirror image: the part looks alike and lies in the same pegs "
            "either side up. If the sides differ, mark the upper one first."
        )
    marks = find_distinguishing_marks(workpiece)
    if marks is None:
        return (
            "The outline differs from its mirror image, but the difference is hard to see: mark the "
            "upper side first, and hold the part beside the plan."
        )
    (x, y), places = fixture.pose.apply(*workpiece.center), []
    for mark in marks:
        there = fixture.pose.apply(mark.place[0] + workpiece.center[0], mark.place[1] + workpiece.center[1])
        eighth = round(atan2(there[1] - y, there[0] - x) / (pi / 4)) % 8
        places.append(f"{mark.describe(lengths)} at the {EIGHTHS[eighth]}")
    return (
        f"The right way up, lying as in the plan, the part has {places[0]} and {places[1]}. "
        "Upside down it never has both there."
    )


def write_side_up(column: TextColumn, sheet: SetupSheet) -> None:
    """Write which side of the solid is up, and which of its faces the set-up before this one cut or located
    on.
    """
    solid, before = sheet.workpiece.solid, sheet.details.first_side
    assert solid is not None
    write_heading(column, "Which side is up" if before is None else "Second set-up of the same part")
    for words in describe_solid_side_up(solid, before):
        column.write_paragraph(words, BODY)
    if solid.lies_on_no_face:
        column.write_paragraph(ON_NO_FACE, BODY)


def describe_solid_side_up(solid: SolidOutline, before: FirstSide | None) -> list[str]:
    """Return sentences that name the side of a solid that is up, and relate it to the previous set-up.

    ``before`` is None for the first set-up.
    """
    up = solid.axis.replace("-", "−")
    sentences = [f"{up} of the file points up."]
    if before is None:
        return sentences
    if before.up == before.up_before:
        return [
            f"The same side is up as in the first set-up: {up} of the file.",
            *describe_faces_before(before),
        ]
    was = before.up_before.replace("-", "−")
    return [
        f"This is the second side: {up} of the file points up, and {was} did before. The part is "
        f"{before.turned}.",
        *describe_faces_before(before),
    ]


def describe_faces_before(before: FirstSide) -> list[str]:
    """Return sentences on the faces that the first set-up cuts, and on those that both set-ups touch."""
    cut, found = list_face_numbers(before.cut_of_solid), list[str]()
    if before.cut:
        found.append(
            f"{list_face_numbers(before.cut).capitalize()} of this outline must not be touched: the first "
            f"set-up cuts {cut} of the solid."
        )
    elif before.cut_of_solid:
        found.append(f"The pegs cannot reach the faces that the first set-up cuts ({cut} of the solid).")
    else:
        found.append("The first set-up names no face that it cuts.")
    if before.shared:
        found.append(
            f"{list_face_numbers(before.shared).capitalize()} of the solid "
            f"{'is' if len(before.shared) == 1 else 'are'} touched in both set-ups, in the first by its best "
            "fixture."
        )
    else:
        found.append("No face is touched in both set-ups: they locate on different faces.")
    return found


def list_face_numbers(numbers: Sequence[int]) -> str:
    """Return face numbers in words, such as "faces 1, 2 and 5"; "" if there are none."""
    if not numbers:
        return ""
    return f"{'face' if len(numbers) == 1 else 'faces'} {join_words([str(number) for number in numbers])}"
