"""Loops of a workpiece (outer ones before holes), and one numbering for the segments of all outlines of a
part.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set
from typing import Protocol, TypeVar

import numpy as np
from attrs import evolve, frozen

from workhold.errors import InputError
from workhold.geometry.loop import ComparisonBudget, Face, LoopShape, encloses, find_near_pairs
from workhold.geometry.segment import Arc, Point, Segment
from workhold.model.solid import Band, RunRows, SolidOutline, interpolate_run

__all__ = ["NumberedOutlines", "count_outer_loops", "refuse_misplaced_holes", "drop_equal_values"]

Value = TypeVar("Value")


class OutlineOfPart(Protocol):
    """An outline with segments, faces and perhaps a solid, such as a workpiece."""

    @property
    def segments(self) -> tuple[Segment, ...]:
        """All segments; a segment's index is its number."""

    @property
    def faces(self) -> tuple[Face, ...]:
        """All faces, in the order of their numbers."""

    @property
    def outer_count(self) -> int:
        """Number of segments of the outer loops; these segments come first."""

    @property
    def solid(self) -> SolidOutline | None:
        """Solid that the outline belongs to; None for a prism."""


@frozen(eq=False)
class NumberedOutlines:
    """Segments and faces of a workpiece and of the own outlines of carriers, in one numbering.

    Parameters
    ----------
    segments : all segments; a segment's index is its number.
    faces : ordered by their numbers.
    bands : for each segment the band of heights that may be touched, or None where none may; () without a
        solid.
    runs : for each segment the run of heights that holds its band, see ``SolidOutline``; () without a solid.
    over : for each segment the numbers of the solid's faces over it; () where these are not known.
    marks : for each face the index of its outline; 0 is the workpiece itself.
    inside : numbers of the faces of holes.
    """

    segments: tuple[Segment, ...]
    faces: tuple[Face, ...]
    bands: tuple[Band | None, ...]
    runs: tuple[RunRows, ...]
    over: tuple[tuple[int, ...], ...]
    marks: tuple[int, ...]
    inside: frozenset[int]

    @classmethod
    def from_outlines(cls, outlines: Sequence[OutlineOfPart]) -> NumberedOutlines:
        """Return the segments and faces of several outlines, the part's own first, in one numbering.

        The numbers of each outline follow those of the outline before it.
        """
        segments, faces, bands = list[Segment](), list[Face](), list[Band | None]()
        over, inside, runs = list[tuple[int, ...]](), set[int](), list[RunRows]()
        for one in outlines:
            first = len(segments)
            inside.update(first + face.number for face in one.faces if face.number >= one.outer_count)
            faces += [
                evolve(face, number=first + face.number, segments=tuple(first + k for k in face.segments))
                for face in one.faces
            ]
            segments += one.segments
            if one.solid is not None:
                bands += one.solid.bands
                over += one.solid.faces
                runs += one.solid.runs or ((),) * len(one.segments)
        marks = tuple(number for number, one in enumerate(outlines) for _ in one.faces)
        known = len(over) == len(segments)
        solids = tuple(over) if known else ()
        return cls(tuple(segments), tuple(faces), tuple(bands), tuple(runs), solids, marks, frozenset(inside))

    def find_pressed_band(self, number: int, point: Point) -> Band | None:
        """Return the heights (low, high) in mm at which a peg can press on a face at a point; None where it
        may not touch.

        The band is the solid's run at that point, widened so that it holds the segment's band. Without runs
        it is the segment's band.

        Parameters
        ----------
        number : number of any segment of the face.
        point : (x, y) in mm of the contact, or of the peg's centre.
        """
        face = next(one for one in self.faces if number in one.segments)
        if not self.runs or not any(self.runs[k] for k in face.segments):
            return self.bands[number] if self.bands else None

        def measure_distance_past_end(k: int) -> float:
            """Return how far the point lies beyond the nearer end of segment k,
            along its parameter; negative inside.
            """
            return abs(self.segments[k].find_parameter(point)) - self.segments[k].half_extent

        touched = min(face.segments, key=measure_distance_past_end)
        rows, segment = self.runs[touched], self.segments[touched]
        if not rows:
            return self.bands[touched]
        place = segment.find_parameter(point)
        if isinstance(segment, Arc) and segment.sign < 0:
            place = -place
        low, high = interpolate_run(rows, (place / segment.half_extent + 1.0) / 2.0)
        own = self.bands[touched] or (low, high)
        return max(min(low, own[0]), 0.0), max(high, own[1])

    def list_faces_over(self, segments: Iterable[int]) -> set[int]:
        """Return the numbers of the solid's faces over these segments; an empty set if they are not known."""
        return {face for segment in segments for face in self.over[segment]} if self.over else set()

    def list_segments_under(self, faces: Set[int]) -> list[int]:
        """Return the numbers, ascending, of the segments under any of these faces of the solid."""
        return [segment for segment, over in enumerate(self.over) if not faces.isdisjoint(over)]


def drop_equal_values(values: Iterable[Value]) -> Iterator[Value]:
    """Yield the values in order, leaving out each that is equal to an earlier one."""
    known = list[Value]()
    for value in values:
        if value not in known:
            known.append(value)
            yield value


def count_outer_loops(name: str, shapes: Sequence[LoopShape]) -> int:
    """Return the number of outer loops, which lie inside an even number of other loops.

    The loops must not meet each other. Raises InputError where an outer loop comes after a hole.
    """
    boxes = np.array([shape.box for shape in shapes])
    around = [
        [
            other
            for _, other in find_near_pairs(boxes[k : k + 1], boxes)
            if other != k and encloses(shapes[other], one)
        ]
        for k, one in enumerate(shapes)
    ]
    outer = [len(others) % 2 == 0 for others in around]
    first_hole = outer.index(False) if False in outer else len(outer)
    if any(outer[first_hole:]):
        raise InputError(
            f"{name}: loop {first_hole} is a hole before an outer loop: give all outer loops first."
        )
    return first_hole


def refuse_misplaced_holes(name: str, shapes: Sequence[LoopShape], comparisons: ComparisonBudget) -> None:
    """Raise InputError for a hole outside the first loop or inside another hole.

    The loops must not meet each other. Each pair tested takes one from ``comparisons``, which raises an error
    once its budget is used up.
    """
    boxes = np.array([shape.box for shape in shapes])
    for index, hole in enumerate(shapes[1:], start=1):
        x, y = hole.segments[0].start
        if not encloses(shapes[0], hole):
            raise InputError(
                f"{name}: loop {index}, at ({x:.6g}, {y:.6g}), lies outside the outer loop: the first loop "
                "must be the outline that encloses all the others."
            )
        for _, other in find_near_pairs(boxes[index : index + 1], boxes):
            comparisons.spend(1)
            if other not in (0, index) and encloses(shapes[other], hole):
                raise InputError(
                    f"{name}: loop {index}, at ({x:.6g}, {y:.6g}), lies inside the hole of loop {other}: "
                    "holes may not overlap; load the inner piece as a part of its own."
                )
