"""Kernels of a shared library answer as those compiled on first use, and refuse whatever they were not compiled for."""

from __future__ import annotations

import ctypes
import pickle
import re
import subprocess
import sys
from collections import namedtuple
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from struct import Struct
from threading import Thread
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import workhold
from workhold.errors import InputError
from workhold.kernels.base import built, compiling, distance
from workhold.kernels.chord.coincidences import are_concentric
from workhold.kernels.preparing import PARTS, prepared

BUILDER = Path(workhold.__file__).parents[2] / "building" / "compile_kernels.py"
SIDES = ((0, -10), (10, 0), (0, 10), (-10, 0))
SQUARE = np.array([[0.0, x, y, -y / 10, x / 10, 10.0, 0.0, 1.0, 0.0, 0.0] for x, y in SIDES])
POINTS = np.random.default_rng(1).uniform(-20.0, 20.0, (200, 2))


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> built.Library:
    """A library of the small kernels, built as that of all is."""
    folder = tmp_path_factory.mktemp("library")
    done = subprocess.run(
        [sys.executable, BUILDER, folder, "distances"], capture_output=True, text=True, check=True
    )
    path = Path(done.stdout.strip())
    assert path == folder / built.library_name()
    return built.Library(path)


def checked(library: built.Library, kernel: Any) -> built.CheckedKernel:
    """The library's answer to a kernel of numba."""
    return library.checked(kernel.py_func)


@pytest.mark.thorough
def test_the_library_tells_of_which_sources_it_is(library):
    assert library.source_hash == built.source_hash()
    assert set(library.kernels) == {kernel.__name__ for kernel, _ in PARTS["distances"]()}


def test_every_kernel_that_python_calls_is_compiled_ahead():
    """One that is not would be missing in the library."""
    texts = [path.read_text() for path in built.KERNELS.rglob("*.py")]
    decorated = {
        name for text in texts for name in re.findall(r"^@compiled(?:_making_arrays)?\ndef (\w+)", text, re.M)
    }
    assert decorated == {kernel.__name__ for calls in PARTS.values() for kernel, _ in calls()}


@pytest.fixture(scope="module")
def builder() -> ModuleType:
    """The module that builds a library."""
    spec = spec_from_file_location("compile_kernels", BUILDER)
    made = module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def test_every_kernel_takes_what_a_library_can_be_handed(builder):
    """Those that are called from Python: whole numbers, doubles and truths, and arrays of numbers one after the other."""

    def can_be_handed(signature: Any) -> bool:
        try:
            return bool([builder.described(kind) for kind in signature])
        except AssertionError:
            return False

    # Other tests may have handed over other arrays.
    for kernel in (done for part in PARTS for done in prepared(part)):
        assert any(map(can_be_handed, kernel.signatures)), kernel.__name__


@pytest.mark.thorough
def test_answers_are_the_same_to_the_last_bit(library):
    """Numbers, truths and arrays that the library makes."""
    ours, theirs = checked(library, distance.outline_distances), distance.outline_distances
    assert ours(POINTS, SQUARE).tobytes() == theirs(POINTS, SQUARE).tobytes()
    assert ours(POINTS[:0], SQUARE).shape == (0,)
    for x, y in POINTS:
        for kernel in (distance.turns_around, distance.is_inside):
            answer = checked(library, kernel)(x, y, SQUARE)
            assert answer == kernel(x, y, SQUARE) and type(answer) is type(kernel(x, y, SQUARE))
    circle = np.array([1.0, 0, 0, 1, 0, np.pi, 5, 1, 0, 0])
    assert checked(library, are_concentric)(circle, circle) is True
    assert checked(library, are_concentric)(circle, SQUARE[0]) is False


def test_arrays_that_nobody_looks_at_are_given_back(library):
    """A view keeps an array of the library alive; thousands of large ones do not add up."""
    distances = checked(library, distance.outline_distances)
    last = distances(POINTS, SQUARE)[-1:]
    kept = last.copy()
    many, released = np.zeros((20_000, 2)), []
    release = library.release
    library.release = lambda address: (released.append(address), release(address))
    try:
        for _ in range(50):
            distances(many, SQUARE)
    finally:
        library.release = release
    assert len(released) == 50
    assert last == kept


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((0.0, 0.0), "takes 3 arguments, not 2"),
        ((0.0, 0.0, SQUARE, SQUARE), "takes 3 arguments, not 4"),
        ((0.0, "0", SQUARE), "y must be float64, not str"),
        (
            (0.0, 0.0, SQUARE.tolist()),
            "rows must be a C-contiguous array of float64 with 2 dimensions, not list",
        ),
        ((0.0, 0.0, SQUARE[0]), "not an array of float64 of shape (10,)"),
        ((0.0, 0.0, SQUARE[:, ::2]), "not an array of float64 of shape (4, 5), not contiguous"),
        ((0.0, 0.0, np.asfortranarray(SQUARE)), "not contiguous"),
        ((0.0, 0.0, SQUARE.astype(np.float32)), "not an array of float32"),
        ((0.0, 0.0, SQUARE.astype(np.int64)), "not an array of int64"),
        ((0.0, 0.0, SQUARE.astype(">f8")), "not an array of >f8"),
        ((0.0, 0.0, None), "not NoneType"),
    ],
)
def test_what_a_kernel_was_not_compiled_for_is_refused(library, arguments, words):
    with pytest.raises(TypeError, match="is_inside") as caught:
        checked(library, distance.is_inside)(*arguments)
    assert words in str(caught.value)


def test_records_are_taken_apart_and_counted():
    """A record is as many words as its fields are; one of another length, or of another kind, is refused."""
    pair = namedtuple("pair", "x rows")
    described = ["float64", {"array": "f8", "dimensions": 2}]
    take, taken = built.taker(described), list[Any]()
    assert take(pair(2, SQUARE), taken) and built.refusal("given", described, pair(2, SQUARE)) is None
    assert taken == [2, id(SQUARE)] and built.letters(described) == "dq"
    assert built.words_of(described) == 1 + 5 + 2 * 2
    for value, words in (
        ((1.0, SQUARE, SQUARE), "given must be a record of 2, not tuple of 3"),
        (pair(2, SQUARE[0]), "given.rows must be a C-contiguous array of float64 with 2 dimensions"),
        (pair("2", SQUARE), "given.x must be float64, not str"),
    ):
        assert built.refusal("given", described, value).startswith(words)
    for value in ((1.0, SQUARE, SQUARE), pair("2", SQUARE), [2, SQUARE]):
        assert not take(value, [])
    arrays = [{"array": "f8", "dimensions": 2}] * 2
    assert not built.taker(arrays)((SQUARE,), []) and not built.taker(arrays)(None, [])


class Own(np.ndarray):
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
def test_arrays_are_taken_however_they_were_made(library, make):
    """Where they are looked at, they are what they are."""
    ours = checked(library, distance.outline_distances)
    for points, square in (
        (POINTS, make(SQUARE)),
        (make(np.tile(POINTS, 5))[:, :2].copy(), SQUARE),
        (POINTS, make(SQUARE)),
    ):
        assert (
            ours(points, square).tobytes()
            == distance.outline_distances(points, square.view(np.ndarray)).tobytes()
        )


def test_an_array_that_is_not_aligned_is_refused(library):
    """Its numbers are between those that a kernel would read."""
    beside = np.frombuffer(b"0" + SQUARE.tobytes(), np.float64, offset=1).reshape(SQUARE.shape)
    with pytest.raises(TypeError, match="rows must be a C-contiguous array"):
        checked(library, distance.is_inside)(0.0, 0.0, beside)


def test_whole_numbers_and_bytes_are_other_elements(library):
    """Each kind of array is taken by kernels of its own: of all three elements."""
    for number, element in enumerate(built.ELEMENTS):
        known = (ctypes.c_void_p * (1 + len(built.ELEMENTS))).in_dll(library.code, built.KNOWN)
        assert known[1 + number] == id(np.zeros(1, element).dtype)
    assert known[0] == id(type(SQUARE))


def test_a_kernel_is_handed_all_that_numba_knows_of_an_array(builder):
    """A kernel that writes down what it is called with: owners, size, bytes of an element, address, shape and strides."""
    import llvmlite.binding as llvm

    element, grid, number = np.arange(7), np.zeros((3, 5), np.int8), 2.5
    told = [
        ({"array": "f8", "dimensions": 2}),
        [{"array": "i8", "dimensions": 1}, "bool"],
        {"array": "i1", "dimensions": 2},
    ]
    kinds = ["ptr", "ptr", "i64", "i64", "ptr", *["i64"] * 4]
    kinds = ["ptr", "ptr", *kinds, *kinds[:7], "i1", *kinds, "double"]
    free = len(kinds)
    text = builder.taking_words("called", [*told, "float64"], kinds, free)
    text = text.replace(f"declare i32 @{builder.OWN}", "declare i32 @unused").replace(
        "external global", "global"
    )
    text = text.replace(
        f"@{built.KNOWN} = global [4 x ptr]", f"@{built.KNOWN} = global [4 x ptr] zeroinitializer"
    )
    lines = [f"define i32 @{builder.OWN}({', '.join(f'{kind} %v{k}' for k, kind in enumerate(kinds))}) {{"]
    for k, kind in enumerate(kinds):
        lines.append(f"  %at{k} = getelementptr i64, ptr %v0, i64 {k}")
        lines += [f"  %w{k} = zext i1 %v{k} to i64", f"  store i64 %w{k}, ptr %at{k}"] if kind == "i1" else []
        lines += [f"  store {kind} %v{k}, ptr %at{k}"] if kind != "i1" else []
    module = llvm.parse_assembly("\n".join([text, *lines, "  ret i32 0", "}"]))
    engine = llvm.create_mcjit_compiler(module, llvm.Target.from_default_triple().create_target_machine())
    engine.finalize_object()
    known = (ctypes.c_void_p * 4).from_address(engine.get_global_value_address(built.KNOWN))
    known[:] = [id(np.ndarray), *(id(np.dtype(one)) for one in built.ELEMENTS)]
    call = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)(engine.get_function_address("called"))
    for is_taken, values in (
        (True, (SQUARE, element, 1, grid, number)),
        (False, (SQUARE, element, 1, grid.astype(np.int64), number)),
        (False, (SQUARE, element[::2], 1, grid, number)),
        (False, (SQUARE.T, element, 1, grid, number)),
        (False, (SQUARE, 7.0, 1, grid, number)),
    ):
        given = [id(value) if isinstance(value, np.ndarray) else value for value in values]
        given[1] = id(values[1])
        words = (ctypes.c_int64 * (free + 6))()
        Struct("=qqqqd").pack_into(words, 8 * (free + 1), *given)
        assert call(ctypes.addressof(words)) == (0 if is_taken else built.REFUSED)
        if is_taken:
            arrays = [
                [0, 0, a.size, a.itemsize, a.ctypes.data, *a.shape, *a.strides]
                for a in (SQUARE, element, grid)
            ]
            assert list(words[2 : free - 1]) == [*arrays[0], *arrays[1], 1, *arrays[2]]
            assert ctypes.c_double.from_buffer(words, 8 * (free - 1)).value == number


@pytest.mark.parametrize("moved", sorted(built.HEADER))
def test_another_python_or_numpy_is_told_apart(library, monkeypatch, moved):
    """One that keeps anything of an array elsewhere uses no library, as one that is no CPython."""
    elsewhere = {
        "shape": built.HEADER["strides"],
        "strides": built.HEADER["shape"],
        "type": built.HEADER["data"],
    }
    monkeypatch.setitem(built.HEADER, moved, elsewhere.get(moved, built.HEADER["type"]))
    with pytest.raises(OSError, match="in another way"):
        built.Library(Path(library.code._name))


def test_a_python_that_is_not_cpython_uses_no_library(library, monkeypatch):
    monkeypatch.setattr(sys, "implementation", SimpleNamespace(name="pypy"))
    with pytest.raises(OSError, match="in another way"):
        built.Library(Path(library.code._name))


def test_truths_and_numbers_are_words():
    """Of numpy, too; what is true is 1."""
    for kind, values in (
        ("bool", (True, np.True_, False)),
        ("int64", (-3, np.int64(-3))),
        ("float64", (2, 2.5, np.float64(2), np.int64(2))),
    ):
        for value in values:
            taken: list[Any] = []
            assert built.taker(kind)(value, taken)
            packed = Struct("=" + built.letters(kind)).pack(*taken)
            assert Struct("=d" if kind == "float64" else "=q").unpack(packed) == (value,)
    assert not built.taker("int64")(2.0, []) and not built.taker("bool")(1, [])


@pytest.mark.thorough
def test_the_interpreter_goes_on_while_a_kernel_runs(library):
    """A thread that is never asked to let others run lets them run while it is inside of a kernel."""
    distances, many = checked(library, distance.outline_distances), np.zeros((500_000, 2))
    before = sys.getswitchinterval()
    sys.setswitchinterval(1.0)
    try:
        # On a busy machine this thread may not get its turn before the kernel is done.
        assert any(counted_during(Thread(target=distances, args=(many, SQUARE))) for _ in range(20))
    finally:
        sys.setswitchinterval(before)


def counted_during(thread):
    """How far one counts while a thread runs."""
    counted = 0
    thread.start()
    while thread.is_alive():
        counted += 1
    return counted


@pytest.mark.parametrize("damage", ["missing", "other sources", "no library"])
def test_a_library_that_does_not_fit_is_not_used(library, damage, tmp_path, monkeypatch):
    """Without numba that is one sentence with a remedy; with it kernels are compiled on first use."""
    monkeypatch.setattr(compiling, "MODE", "")
    monkeypatch.setattr(compiling, "KERNELS", tmp_path)
    path = tmp_path / built.library_name()
    if damage == "no library":
        path.write_text("no library")
    elif damage == "other sources":
        path.write_bytes(Path(library.code._name).read_bytes())
        monkeypatch.setattr(compiling, "source_hash", lambda: "another")
    assert compiling.built_library() is None
    monkeypatch.setattr(compiling, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"install workhold\[numba\]"):
        compiling.built_library()


def test_a_library_that_fits_is_used(library, tmp_path, monkeypatch):
    monkeypatch.setattr(compiling, "MODE", "")
    monkeypatch.setattr(compiling, "KERNELS", Path(library.code._name).parent)
    assert compiling.built_library() is not None
    monkeypatch.setattr(compiling, "MODE", "numba")
    assert compiling.built_library() is None
