"""The outline of a workpiece as balls, for one precision."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from attrs import frozen

from holdfast.model.workpiece import Workpiece
from holdfast.verification.sides import Side, vertex_side, whole_face

__all__ = ["Outline"]


@frozen(eq=False)
class Outline:
    """All sides of a workpiece.

    Parameters
    ----------
    segments : by number.
    faces : whole faces by their numbers.
    members : the numbers of the segments of each face, by its number.
    """

    segments: tuple[Side, ...]
    faces: Mapping[int, Side]
    members: Mapping[int, frozenset[int]]

    @classmethod
    def of(cls, workpiece: Workpiece) -> Outline:
        """The outline at the precision in force."""
        segments = []
        for loop in workpiece.loops:
            vertices = [(float(x), float(y), float(bulge)) for x, y, bulge in loop]
            segments += [vertex_side(a, b) for a, b in zip(vertices, vertices[1:] + vertices[:1], strict=True)]
        faces = {f.number: whole_face([segments[k] for k in f.segments]) for f in workpiece.faces}
        members = {f.number: frozenset(f.segments) for f in workpiece.faces}
        return cls(tuple(segments), faces, members)

    def others(self, face: int) -> Iterator[tuple[int, Side]]:
        """Number and side of every segment that is not of a face."""
        own = self.members[face]
        return ((k, side) for k, side in enumerate(self.segments) if k not in own)
