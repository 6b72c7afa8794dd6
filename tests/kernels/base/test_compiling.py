"""Kernels are called with what their annotations say, and refuse all else."""

from __future__ import annotations

import pickle
import re
import sys
from math import pi
from pathlib import Path
from struct import Struct
from threading import Thread
from typing import Any, NamedTuple

import numpy as np
import pytest

import workhold
from workhold.kernels.base import compiling, distance
from workhold.kernels.base.compiling import Kernel, Matrix, Vector, make_format_letters, make_taker
from workhold.kernels.base.libraries import ROOMS
from workhold.kernels.base.tables import Features, Setting

KERNELS = Path(workhold.__file__).parent / "kernels"
SIDES = ((0, -10), (10, 0), (0, 10), (-10, 0))
SQUARE = np.array([[0.0, x, y, -y / 10, x / 10, 10.0, 0.0, 1.0, 0.0, 0.0] for x, y in SIDES])
POINTS = np.random.default_rng(1).uniform(-20.0, 20.0, (200, 2))


class Pair(NamedTuple):
    """A record of a number and an array."""

    x: float
    rows: Matrix


def test_every_kernel_is_in_a_room_that_is_built() -> None:
    """One that is not would be missing in all libraries."""
    rooms = {
        path.parent.name for path in KERNELS.rglob("*.py") if re.search("^@compiled$", path.read_text(), re.M)
    }
    assert rooms == set(ROOMS)


def test_every_signature_is_one_of_words() -> None:
    """Of numbers, arrays with so many dimensions, and records of them."""
    for path in KERNELS.rglob("*.py"):
        if re.search("^@compiled$", path.read_text(), re.M):
            __import__(".".join(("workhold", *path.relative_to(KERNELS.parent).with_suffix("").parts)))
    kernels = [kernel for room in Kernel.all.values() for kernel in room.values()]
    assert len(kernels) > 50
    for kernel in kernels:
        assert kernel.words.size % 8 == 0 and len(kernel.takers) == len(kernel.arguments)
        assert kernel.__doc__


def test_nothing_private_of_numba_or_python_is_used() -> None:
    """No inner module or option of numba, and no address of a Python object."""
    private = re.compile(
        r"numba\.core|numba\._|numba import _|\b_nrt\b|no_cpython_wrapper|pipeline_class|from_address|\._cache\b"
    )
    for path in [*KERNELS.rglob("*.py"), KERNELS.parents[2] / "building" / "backend.py"]:
        assert not private.search(path.read_text()), path


def test_answers_are_those_of_python() -> None:
    """Numbers, truths and arrays that are written to: the functions themselves say what is right."""
    out = np.empty(len(POINTS))
    distance.write_outline_distances(POINTS, SQUARE, out)
    assert out.tobytes() == distance.measure_outline_distances(POINTS, SQUARE).tobytes()
    assert distance.measure_outline_distances(POINTS[:0], SQUARE).shape == (0,)
    for (x, y), away in zip(POINTS, out, strict=True):
        assert away == pytest.approx(
            abs(max(abs(x), abs(y)) - 10)
            if max(abs(x), abs(y)) < 10 or min(abs(x), abs(y)) <= 10
            else np.hypot(abs(x) - 10, abs(y) - 10)
        )
        assert distance.is_inside(x, y, SQUARE) is bool(max(abs(x), abs(y)) < 10)
        turned = distance.measure_winding(x, y, SQUARE)
        assert type(turned) is float and turned == pytest.approx(
            2 * pi if max(abs(x), abs(y)) < 10 else 0.0, abs=1e-9
        )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((0.0, 0.0), "takes 3 arguments, not 2"),
        ((0.0, 0.0, SQUARE, SQUARE), "takes 3 arguments, not 4"),
        ((0.0, "0", SQUARE), "y must be float, not str"),
        ((0.0, 0.0, SQUARE.tolist()), "rows must be a C-contiguous array of float64 with 2 dimensions"),
        ((0.0, 0.0, SQUARE[0]), "rows must be"),
        ((0.0, 0.0, SQUARE[:, ::2]), "rows must be"),
        ((0.0, 0.0, np.asfortranarray(SQUARE)), "rows must be"),
        ((0.0, 0.0, SQUARE.astype(np.float32)), "rows must be"),
        ((0.0, 0.0, SQUARE.astype(np.int64)), "rows must be"),
        ((0.0, 0.0, SQUARE.astype(">f8")), "rows must be"),
        (
            (0.0, 0.0, np.frombuffer(b"0" + SQUARE.tobytes(), np.float64, offset=1).reshape(SQUARE.shape)),
            "rows must be",
        ),
        ((0.0, 0.0, None), "rows must be"),
    ],
)
def test_what_a_kernel_was_not_compiled_for_is_refused(arguments: tuple[Any, ...], words: str) -> None:
    with pytest.raises(TypeError, match="measure_winding") as caught:
        distance.measure_winding(*arguments)
    assert words in str(caught.value)


def test_records_are_taken_apart_and_counted() -> None:
    """A record is as many words as its fields are; one of another length, or of another kind, is refused."""
    assert make_format_letters(Pair) == "dqqq" and make_format_letters(tuple[int, bool]) == "q?7x"
    taken: list[Any] = []
    make_taker(Pair, "given")(Pair(2, SQUARE), taken)
    assert taken == [2, SQUARE.ctypes.data, 4, 10]
    for value, words in (
        ((1.0, SQUARE, SQUARE), "given must be a record of 2"),
        (Pair(2, SQUARE[0]), "given.rows must be a C-contiguous array of float64 with 2 dimensions"),
        (Pair("2", SQUARE), "given.x must be float, not str"),  # type: ignore[arg-type]
        ([2, SQUARE], "given must be a record of 2, not list"),
    ):
        with pytest.raises(TypeError, match=re.escape(words)):
            make_taker(Pair, "given")(value, [])


def test_truths_and_numbers_are_words() -> None:
    """Of numpy, too; what is true is 1."""
    for kind, values in (
        (bool, (True, np.True_, False)),
        (int, (-3, np.int64(-3))),
        (float, (2, 2.5, np.float64(2), np.int64(2))),
    ):
        for value in values:
            taken: list[Any] = []
            make_taker(kind, "x")(value, taken)
            packed = Struct("=" + make_format_letters(kind)).pack(*taken)
            assert len(packed) == 8
            assert Struct("=d" if kind is float else "=q").unpack(packed) == (value,)
    for kind, value in ((int, 2.0), (bool, 1), (float, "1")):
        with pytest.raises(TypeError, match="x must be"):
            make_taker(kind, "x")(value, [])


def test_arrays_in_records_are_looked_up_once() -> None:
    """As long as they live: another array in the place of one is another."""
    take = make_taker(Pair, "given")
    for _ in range(3):
        for rows in (SQUARE, SQUARE[1:]):
            taken: list[Any] = []
            take(Pair(1.0, rows), taken)
            assert taken == [1.0, rows.ctypes.data, *rows.shape]
    # One that is gone is forgotten.
    del rows
    assert [*remembered(take)] == [id(SQUARE)]


def remembered(take: Any) -> dict[int, Any]:
    """What the taker of a record of two remembers of the second."""
    (takers,) = [cell.cell_contents for cell in take.__closure__ if isinstance(cell.cell_contents, list)]
    return next(cell.cell_contents for cell in takers[1].__closure__ if isinstance(cell.cell_contents, dict))


class Own(np.ndarray[Any, Any]):
    """Arrays of a class of their own, as those that are mapped from a file are."""


def read_only(array: Any) -> Any:
    """The same that may not be written to."""
    array = array.view()
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    "make",
    [
        np.array,
        read_only,
        lambda array: array.view(Own),
        lambda array: array.astype(np.dtype(np.float64, metadata={"of": "its own"})),
        lambda array: pickle.loads(pickle.dumps(array)),
        lambda array: np.frombuffer(array.tobytes()).reshape(array.shape),
        lambda array: np.concatenate([array, array])[4:],
        lambda array: np.concatenate([array, array])[:4],
    ],
    ids=["array", "read only", "class", "element", "pickled", "of bytes", "end", "begin"],
)
def test_arrays_are_taken_however_they_were_made(make: Any) -> None:
    """Where they are looked at, they are what they are."""
    out = np.empty(len(POINTS))
    distance.write_outline_distances(POINTS, make(SQUARE), out)
    assert out.tobytes() == distance.measure_outline_distances(POINTS, SQUARE).tobytes()


@pytest.mark.thorough
def test_the_interpreter_goes_on_while_a_kernel_runs() -> None:
    """A thread that is never asked to let others run lets them run while it is inside of a kernel."""
    many = np.zeros((500_000, 2))
    before = sys.getswitchinterval()
    sys.setswitchinterval(1.0)
    try:
        # On a busy machine this thread may not get its turn before the kernel is done.
        assert any(
            counted_during(Thread(target=distance.measure_outline_distances, args=(many, SQUARE)))
            for _ in range(20)
        )
    finally:
        sys.setswitchinterval(before)


def counted_during(thread: Thread) -> int:
    """How far one counts while a thread runs."""
    counted = 0
    thread.start()
    while thread.is_alive():
        counted += 1
    return counted


def test_types_name_their_elements_and_dimensions() -> None:
    assert compiling.get_element_type(Matrix) == np.float64 and compiling.count_dimensions(Matrix) == 2
    assert (
        compiling.count_dimensions(Vector) == 1 and compiling.get_element_type(compiling.ByteStack) == np.int8
    )
    assert [name for name, _ in compiling.list_fields(Pair) or ()] == ["x", "rows"]
    assert (
        compiling.list_fields(Features)
        and compiling.list_fields(Setting)
        and compiling.list_fields(float) is None
    )
