"""Names, for a user, of the systems of contacts that their resultants leave undecided.

A system is undecided when its resultant vanishes at every orientation although no known reason applies
(``sliding_pairs``), or when its roots cannot be separated at 1,024 bits. Only fixtures with these pegs on these faces
may then be missing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from workhold.algebra.quartets import Systems

__all__ = ["undecided_notes"]

# Systems named; the others are counted.
MOST_NAMED = 20


def undecided_notes(undecided: Sequence[Systems], faces: NDArray[np.int64]) -> Iterator[str]:
    """One sentence for each undecided system.

    Parameters
    ----------
    faces : (F,) number of each feature's face.
    """
    sentences = [
        f"Undecided: {in_words(faces[feature].tolist(), column.tolist(), row.tolist())}."
        for systems in undecided
        for feature, column, row in zip(systems.feature, systems.column, systems.row, strict=True)
    ]
    yield from sentences[:MOST_NAMED]
    if len(sentences) > MOST_NAMED:
        yield f"Undecided: {len(sentences) - MOST_NAMED} more systems of pegs and faces."


def in_words(faces: list[int], columns: list[int], rows: list[int]) -> str:
    """Three left pegs, or two left and two right ones, with the faces they touch.

    Columns count from the first peg of the same jaw, rows from the first peg of all.
    """
    jaws = ["left"] * 3 if len(faces) == 3 else ["left", "left", "right", "right"]
    words = [
        f"{jaw} column {column:+d}, row {row:+d} on face {face}"
        for jaw, column, row, face in zip(jaws, columns, rows, faces, strict=True)
    ]
    return "pegs in " + "; ".join(words)
