"""The outline of a workpiece as balls, for one precision."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import frozen
from flint import arb

from workhold.model.workpiece import Workpiece
from workhold.verification.balls import Point
from workhold.verification.sides import ArcSide, Side, vertex_side, whole_face
from workhold.verification.tolerances import TANGENT

__all__ = ["BallOutline"]


@frozen(eq=False)
class BallOutline:
    """All sides of a workpiece.

    Parameters
    ----------
    segments : by number.
    faces : whole faces by their numbers.
    others : for each face, by its number, the numbers and sides of all segments that are not of it.
    smooth : whether each face, by its number, meets its neighbours tangentially at its start and at its end.
    turns : by how much the normals differ at these two joints, the larger component.
    neighbours : those of each face, by its number, segments at its start and at its end.
    """

    segments: tuple[Side, ...]
    faces: Mapping[int, Side]
    others: Mapping[int, tuple[tuple[int, Side], ...]]
    smooth: Mapping[int, tuple[bool, bool]]
    turns: Mapping[int, tuple[arb, arb]]
    neighbours: Mapping[int, tuple[Side, Side]]

    @classmethod
    def of(cls, workpiece: Workpiece) -> BallOutline:
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
        neighbours = {
            f.number: (segments[before[f.segments[0]]], segments[after[f.segments[-1]]]) for f in workpiece.faces
        }
        turns = {
            number: (
                turn_at(one, faces[number], faces[number].start),
                turn_at(faces[number], two, faces[number].end),
            )
            for number, (one, two) in neighbours.items()
        }
        smooth = {number: (bool(one < TANGENT), bool(two < TANGENT)) for number, (one, two) in turns.items()}
        return cls(tuple(segments), faces, others, smooth, turns, neighbours)

    def smooth_ends(self, face: int, has_flat: bool) -> tuple[bool, bool]:
        """Whether a face meets its neighbours tangentially at its start and end, as pegs that touch it feel it.

        One with a flat changes over from flat to round between a line and an arc.
        """
        one, other = self.smooth[face]
        if not has_flat:
            return one, other
        first, last = (
            isinstance(side, ArcSide) and isinstance(self.faces[face], ArcSide) for side in self.neighbours[face]
        )
        return one and first, other and last


def turn_at(one: Side, two: Side, joint: Point) -> arb:
    """By how much the normals of two sides differ at a joint, the larger component; they are tangent below ``TANGENT``."""
    (ax, ay), (bx, by) = one.outward(joint), two.outward(joint)
    return abs(ax - bx).max(abs(ay - by))
