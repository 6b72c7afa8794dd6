"""The outline of a workpiece as balls, for one precision."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import frozen

from workhold.model.workpiece import Workpiece
from workhold.verification.balls import Point
from workhold.verification.rules import TANGENT
from workhold.verification.sides import Side, vertex_side, whole_face

__all__ = ["Outline"]


@frozen(eq=False)
class Outline:
    """All sides of a workpiece.

    Parameters
    ----------
    segments : by number.
    faces : whole faces by their numbers.
    others : for each face, by its number, the numbers and sides of all segments that are not of it.
    smooth : whether each face, by its number, meets its neighbours tangentially at its start and at its end.
    """

    segments: tuple[Side, ...]
    faces: Mapping[int, Side]
    others: Mapping[int, tuple[tuple[int, Side], ...]]
    smooth: Mapping[int, tuple[bool, bool]]

    @classmethod
    def of(cls, workpiece: Workpiece) -> Outline:
        """The outline at the precision in force."""
        segments: list[Side] = []
        before: list[int] = []
        for loop in workpiece.loops:
            first, count = len(segments), len(loop)
            vertices = [(float(x), float(y), float(bulge)) for x, y, bulge in loop]
            segments += [vertex_side(a, b) for a, b in zip(vertices, vertices[1:] + vertices[:1], strict=True)]
            before += [first + (k - 1) % count for k in range(count)]
        after = {neighbour: k for k, neighbour in enumerate(before)}
        faces = {f.number: whole_face([segments[k] for k in f.segments]) for f in workpiece.faces}
        others = {
            f.number: tuple((k, side) for k, side in enumerate(segments) if k not in f.segments)
            for f in workpiece.faces
        }
        smooth = {
            f.number: (
                is_smooth(segments[before[f.segments[0]]], faces[f.number], faces[f.number].start),
                is_smooth(faces[f.number], segments[after[f.segments[-1]]], faces[f.number].end),
            )
            for f in workpiece.faces
        }
        return cls(tuple(segments), faces, others, smooth)


def is_smooth(one: Side, two: Side, joint: Point) -> bool:
    """Whether two sides meet tangentially at a joint."""
    (ax, ay), (bx, by) = one.outward(joint), two.outward(joint)
    return bool(abs(ax - bx) < TANGENT and abs(ay - by) < TANGENT)
