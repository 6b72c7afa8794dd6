"""Two set-ups of one solid: how the part is turned between them, and which of its faces play a part in both.

A face of the outline stands for faces of the solid, which keep their numbers whichever side is up. So a face
that the first set-up cut, or located on, is found again in the second.
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

__all__ = ["FirstSide", "first_side", "turn_words"]

# Which coordinates of a file become x, y and z of the outline, by the axis that points up.
SOURCES = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
NAMES = "xyz"


@frozen
class FirstSide:
    """What a set-up shares with the one before it.

    Parameters
    ----------
    up, up_before : directions of the file that point up, now and before.
    turned : how the part is turned from the set-up before, in words.
    cut : numbers of the outline's faces that were cut before and are not touched now.
    cut_of_solid : numbers of the solid's faces that were cut before.
    shared : numbers of the solid's faces that pegs touch in both.
    """

    up: str
    up_before: str
    turned: str
    cut: tuple[int, ...]
    cut_of_solid: tuple[int, ...]
    shared: tuple[int, ...]


def first_side(fixture: Fixture, query: Query, before: Query, located: Fixture | None) -> FirstSide:
    """What the set-up of a fixture shares with one before it.

    Parameters
    ----------
    query, before : of this set-up and of the one before.
    located : the fixture of the set-up before; None where it had none.

    Raises
    ------
    InputError
        For parts whose faces have no numbers of a solid.
    """
    own, other = solid_of(query.workpiece), solid_of(before.workpiece)
    cut = before.workpiece.numbered.faces_over(before.restrictions.avoid)
    avoided = [
        face.number
        for face in query.workpiece.faces
        if own.bands[face.number] is not None and not cut.isdisjoint(own.faces[face.number])
    ]
    here = touched(fixture, query.workpiece)
    there = set[int]() if located is None else touched(located, before.workpiece)
    return FirstSide(
        up=own.axis,
        up_before=other.axis,
        turned=turn_words(other.axis, own.axis),
        cut=tuple(avoided),
        cut_of_solid=tuple(sorted(cut)),
        shared=tuple(sorted(here & there)),
    )


def solid_of(workpiece: Workpiece) -> SolidOutline:
    """The solid of a part; refuses a part without one, and one whose faces have no numbers."""
    if workpiece.solid is None or not workpiece.solid.faces:
        raise InputError(f"{workpiece.name} has no faces of a solid: read both set-ups from the STEP file.")
    return workpiece.solid


def touched(fixture: Fixture, workpiece: Workpiece) -> set[int]:
    """Numbers of the solid's faces that pegs and clamps touch."""
    numbers = {peg.face for peg in fixture.pegs} | {
        peg.beside for peg in fixture.pegs if peg.beside is not None
    }
    every = workpiece.numbered
    return every.faces_over(
        k for face in every.faces if numbers.intersection(face.segments) for k in face.segments
    )


def compute_standing_rotation(axis: str) -> NDArray[np.float64]:
    """The rotation (3, 3) from a file's coordinates to those of an outline whose axis points up.

    With a minus the part lies on its other side, turned over like a page: x and z change their signs.
    """
    signs = (-1.0, 1.0, -1.0) if axis.startswith("-") else (1.0, 1.0, 1.0)
    turn = np.zeros((3, 3))
    for row, (sign, source) in enumerate(zip(signs, SOURCES[axis.lstrip("-")], strict=True)):
        turn[row, source] = sign
    return turn


def turn_words(before: str, now: str) -> str:
    """How a part is turned from one standing to another, about axes of the first drawing.

    Examples
    --------
    >>> turn_words("z", "-z")
    'turned over about the y axis of the first drawing, by half a turn'
    >>> turn_words("z", "z")
    'the same side up'
    >>> turn_words("z", "x")
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
