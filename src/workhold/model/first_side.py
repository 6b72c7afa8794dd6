"""Two set-ups of one solid: the turn of the part between them, and the faces that are cut or touched in both.

A face of the outline belongs to faces of the solid, whose numbers do not depend on the side that is up. So a
face that the first set-up cut or used for locating can be identified in the second.
"""

from __future__ import annotations

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.solid import SolidOutline
from workhold.model.workpiece import Workpiece

__all__ = ["FirstSide", "compare_with_first_side", "describe_turn"]

# Which coordinates of a file become x, y and z of the outline, by the axis that points up.
SOURCES = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
NAMES = "xyz"


@frozen
class FirstSide:
    """Relation of a set-up to the previous one, in which another side of the part was up.

    Parameters
    ----------
    up, up_before : axes of the file that point up, in this set-up and in the previous one.
    turned : sentence on how to turn the part after the previous set-up.
    cut : numbers of faces of this outline that were cut in the previous set-up and that pegs do not touch
        now.
    cut_of_solid : numbers of the solid's faces that were cut in the previous set-up.
    shared : numbers of the solid's faces that pegs touch in both set-ups.
    """

    up: str
    up_before: str
    turned: str
    cut: tuple[int, ...]
    cut_of_solid: tuple[int, ...]
    shared: tuple[int, ...]


def compare_with_first_side(
    fixture: Fixture, query: Query, before: Query, located: Fixture | None
) -> FirstSide:
    """Return the relation of a fixture's set-up to the previous set-up: the turn of the part and the shared
    faces.

    Parameters
    ----------
    query, before : queries of this set-up and of the previous one.
    located : the fixture of the previous set-up, to find shared faces; None if it had none.

    Raises
    ------
    InputError
        For parts whose faces have no numbers of a solid.
    """
    own, other = get_solid(query.workpiece), get_solid(before.workpiece)
    cut = before.workpiece.numbered.list_faces_over(before.restrictions.avoid)
    avoided = [
        face.number
        for face in query.workpiece.faces
        if own.bands[face.number] is not None and not cut.isdisjoint(own.faces[face.number])
    ]
    here = find_touched_faces(fixture, query.workpiece)
    there = set[int]() if located is None else find_touched_faces(located, before.workpiece)
    return FirstSide(
        up=own.axis,
        up_before=other.axis,
        turned=describe_turn(other.axis, own.axis),
        cut=tuple(avoided),
        cut_of_solid=tuple(sorted(cut)),
        shared=tuple(sorted(here & there)),
    )


def get_solid(workpiece: Workpiece) -> SolidOutline:
    """Return the solid of a part; raise InputError if it has none, or one whose faces have no numbers."""
    if workpiece.solid is None or not workpiece.solid.faces:
        raise InputError(f"{workpiece.name} has no faces of a solid: read both set-ups from the STEP file.")
    return workpiece.solid


def find_touched_faces(fixture: Fixture, workpiece: Workpiece) -> set[int]:
    """Return the numbers of the solid's faces that pegs and clamps of a fixture touch."""
    numbers = {peg.face for peg in fixture.pegs} | {
        peg.beside for peg in fixture.pegs if peg.beside is not None
    }
    every = workpiece.numbered
    return every.list_faces_over(
        k for face in every.faces if numbers.intersection(face.segments) for k in face.segments
    )


def compute_standing_rotation(axis: str) -> NDArray[np.float64]:
    """Return the rotation matrix (3, 3) from a file's coordinates to those of the outline with this axis up.

    ``axis`` is "x", "-x", …, "z" or "-z". The matrices of "z" and "-z" differ in the signs of the first and
    the last row, because the part lies on its other side. The same holds for x and y.
    """
    signs = (-1.0, 1.0, -1.0) if axis.startswith("-") else (1.0, 1.0, 1.0)
    turn = np.zeros((3, 3))
    for row, (sign, source) in enumerate(zip(signs, SOURCES[axis.lstrip("-")], strict=True)):
        turn[row, source] = sign
    return turn


def describe_turn(before: str, now: str) -> str:
    """Return a phrase that tells how a part is turned between two set-ups; axes in it are those of the first
    set-up's drawing.

    Parameters
    ----------
    before, now : axes of the file that point up, such as "z" or "-x".

    Examples
    --------
    >>> describe_turn("z", "-z")
    'turned over about the y axis of the first drawing, by half a turn'
    >>> describe_turn("z", "z")
    'the same side up'
    >>> describe_turn("z", "x")
    'turned by 120° about the line x = y = z of the first drawing'
    """
    turn = compute_standing_rotation(now) @ compute_standing_rotation(before).T
    angle = round(float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1.0, 1.0)))))
    if angle == 0:
        return "the same side up"
    # The axis is what the turn leaves where it is.
    values, vectors = np.linalg.eig(turn)
    axis = np.real(vectors[:, int(np.argmin(np.abs(values - 1.0)))])
    main = [k for k in range(3) if abs(axis[k]) > 1e-9]
    if len(main) == 1:
        by = "over" if angle == 180 else f"by {angle}°"
        half = ", by half a turn" if angle == 180 else ""
        return f"turned {by} about the {NAMES[main[0]]} axis of the first drawing{half}"
    signs = [1.0 if axis[k] * axis[main[0]] > 0 else -1.0 for k in main]
    line = " = ".join(f"{'−' if sign < 0 else ''}{NAMES[k]}" for k, sign in zip(main, signs, strict=True))
    return f"turned by {angle}° about the line {line} of the first drawing"
