"""The shape of a part for meshing: a prism over its outline, or a solid as Open CASCADE keeps it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol

from attrs import frozen

from workhold.bending.library import load_elements
from workhold.errors import InputError
from workhold.geometry.loop import LoopShape, compute_signed_area, encloses
from workhold.geometry.segment import Arc, Point, Segment
from workhold.model.workpiece import Workpiece

__all__ = ["KeptShape", "PartToBend", "PrismShape"]


class PartToBend(Protocol):
    """A shape in the part's coordinates, in mm, its lowest point at z = 0."""

    def build(self) -> Any:
        """Return the shape as an object of the meshing library."""


@frozen
class PrismShape:
    """A prism over the outline of a part.

    Parameters
    ----------
    workpiece : the part; for a solid its silhouette is used.
    thickness : in mm.
    """

    workpiece: Workpiece
    thickness: float

    def build(self) -> Any:
        """Return the prism from z = 0 upward; raise InputError for a part in several pieces."""
        part = self.workpiece
        outer, holes = part.loop_segments[: part.pieces], part.hole_segments
        shapes = load_elements().shapes
        pieces = []
        for loop in outer:
            face, around = make_face(loop), LoopShape.from_segments(loop)
            for hole in holes:
                inside = LoopShape.from_segments(hole)
                if encloses(around, inside):
                    face -= make_face(hole)
            pieces.append(face)
        if len(pieces) > 1:
            raise InputError(
                f"{part.name} is seen in {len(pieces)} pieces, so its prism is not the part: give its STEP file."
            )
        return pieces[0].Extrude(self.thickness * shapes.Z)


@frozen
class KeptShape:
    """A solid in Open CASCADE's own form.

    Parameters
    ----------
    text : text of the shape's file in Open CASCADE's format.
    """

    text: str

    def build(self) -> Any:
        """Return the solid as an object of the meshing library."""
        with TemporaryDirectory(prefix="workhold-") as folder:
            path = Path(folder) / "part.brep"
            path.write_text(self.text, encoding="ascii")
            return load_elements().shapes.OCCGeometry(str(path)).shape


def make_face(loop: Sequence[Segment]) -> Any:
    """Return the flat face at z = 0 inside a loop, which may run either way round."""
    if compute_signed_area(loop) < 0:
        loop = [reverse_segment(segment) for segment in reversed(loop)]
    return load_elements().shapes.Face(
        load_elements().shapes.Wire([edge for one in loop for edge in make_edges(one)])
    )


def reverse_segment(segment: Segment) -> Segment:
    """Return the segment with start and end exchanged."""
    if isinstance(segment, Arc):
        return Arc(segment.center, segment.radius, segment.mid_angle, segment.half_sweep, -segment.sign)
    return type(segment)(segment.end, segment.start)


def make_edges(segment: Segment) -> list[Any]:
    """Return the library's edges of a segment at z = 0: one for a line, two halves for an arc, since a circle
    has no ends.
    """
    shapes = load_elements().shapes

    def point(place: Point) -> Any:
        return shapes.Pnt(*place, 0.0)

    if not isinstance(segment, Arc):
        return [shapes.Segment(point(segment.start), point(segment.end))]
    half = segment.sign * segment.half_sweep
    places = [point(segment.compute_point(share * half)) for share in (-1.0, -0.5, 0.0, 0.5)]
    last = places[0] if segment.is_full else point(segment.end)
    return [shapes.ArcOfCircle(*places[:3]), shapes.ArcOfCircle(*places[2:], last)]
