"""An argument of another kind than a function of the package takes is refused in one plain sentence."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import workhold
from workhold.errors import InputError

# Functions of one argument that is wrong, and what the sentence says of it.
ASKED: list[tuple[Callable[[Any, str], object], str]] = [
    (workhold.save, "the result cannot be 'x': give a Result"),
    (lambda value, _: workhold.answer(value), "the query cannot be 'x': give a Query"),
    (
        lambda value, path: workhold.answer_to_file(value, f"{path}.npz"),
        "the query cannot be 'x': give a Query",
    ),
    (lambda value, _: workhold.seatings(value), "the result cannot be 'x': give a Result"),
    (lambda value, _: workhold.Result(value, value, {}, {}), "the query cannot be 'x': give a Query"),
    (lambda value, _: workhold.Workpiece("part", value), "a loop cannot be 'x': give an array"),
    (
        lambda value, _: workhold.Workpiece("part", len(value)),
        "the loops cannot be 1: give a tuple of arrays",
    ),
    (lambda value, _: workhold.Workpiece([value], ()), r"the name of a part cannot be \['x'\]: give text"),
]


@pytest.mark.parametrize(("ask", "words"), ASKED)
def test_another_kind_is_refused(tmp_path: Path, ask: Callable[[Any, str], object], words: str) -> None:
    """With what it is, and what to give; nothing is written."""
    with pytest.raises(InputError, match=f"^{words}"):
        ask("x", str(tmp_path / "y.json"))
    assert not list(tmp_path.iterdir())
