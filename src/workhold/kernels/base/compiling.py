"""Mark the functions that are compiled, and call those that Python calls.

Functions marked :func:`compiled` are called by Python, those marked :func:`inner` only by other kernels. A
room of kernels (``base``, ``curves``, ``seating``, ...) is compiled into one shared library by
:mod:`workhold.kernels.base.building`: with the package when a wheel is built, or once into the user's cache.
Numba compiles them; it is not needed where the libraries are there.

Annotations are the signatures: a kernel takes and returns numbers, and takes arrays and named tuples of them.
It makes no array: whoever calls it makes room for what it writes.

Glossary
--------
entry : the function of a library that reads the arguments of a kernel from words of eight bytes, calls the
    kernel, and writes what it returns to the first of these words.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from ctypes import addressof, c_char
from functools import cached_property, update_wrapper
from inspect import signature
from struct import Struct
from typing import Annotated, Any, ClassVar, TypeVar, cast, get_args, get_origin, get_type_hints
from weakref import ref

import numpy as np
from numpy.typing import NDArray

Function = TypeVar("Function", bound=Callable[..., Any])
# Appends the words of an argument to a list.
Taker = Callable[[Any, list[Any]], None]
# Arrays of real numbers, of whole numbers, and of verdicts or flags, of any number of dimensions.
Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
ByteArray = NDArray[np.int8]
# The same of one, two, three and four dimensions, as Python hands them over.
Vector = Annotated[Array, 1]
Matrix = Annotated[Array, 2]
Stack = Annotated[Array, 3]
Stacks = Annotated[Array, 4]
IntVector = Annotated[IntArray, 1]
IntMatrix = Annotated[IntArray, 2]
ByteVector = Annotated[ByteArray, 1]
ByteMatrix = Annotated[ByteArray, 2]
ByteStack = Annotated[ByteArray, 3]

# What numba is told of all kernels: a division by zero gives an infinity or NaN, as in NumPy.
OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True}
# "building" while kernels are compiled into a library; "callable" where tests call inner kernels, too.
MODE = os.environ.get("WORKHOLD_KERNELS", "")
LETTERS = {int: "q", float: "d", bool: "?7x"}
# Where kernels are compiled: all inner functions.
INNER: list[Any] = []


def inner(function: Function) -> Function:
    """Mark a function that only kernels call; it stays a plain function but where kernels are compiled.

    Kernels avoid what is slow to compile: assignments of slices, and long kernels that call other long ones.
    """
    if MODE not in ("building", "callable"):
        return function
    import numba

    INNER.append(numba.njit(**OPTIONS, cache=MODE == "callable")(function))
    return cast(Function, INNER[-1])


def compiled(function: Function) -> Function:
    """Mark a function that Python calls, without the interpreter's lock."""
    return cast(Function, Kernel(function))


class Kernel:
    """A compiled function that Python calls.

    Its library is loaded at the first call, and built before that where there is none.

    Raises
    ------
    TypeError
        At a call with anything else than the function's annotations say.
    """

    # All there are, by room and name.
    all: ClassVar[dict[str, dict[str, Kernel]]] = {}

    def __init__(self, function: Callable[..., Any]) -> None:
        update_wrapper(self, function)
        self.name, self.function = function.__name__, function
        self.room = function.__module__.rpartition(".")[0].rpartition(".")[2]
        Kernel.all.setdefault(self.room, {})[function.__name__] = self

    @cached_property
    def arguments(self) -> dict[str, Any]:
        """The type of each argument, by its name."""
        return {name: self.hints[name] for name in signature(self.function).parameters}

    @cached_property
    def hints(self) -> dict[str, Any]:
        """The types that the function's annotations name."""
        return get_type_hints(self.function, include_extras=True)

    @cached_property
    def results(self) -> tuple[type[Any], ...]:
        """The types of the numbers that are returned."""
        result = self.hints["return"]
        if result is type(None):
            return ()
        return get_args(result) if get_origin(result) is tuple else (result,)

    @cached_property
    def takers(self) -> list[Taker]:
        """Functions that append the words of an argument to a list."""
        return [taker(kind, f"{self.name}: {name}") for name, kind in self.arguments.items()]

    @cached_property
    def words(self) -> Struct:
        """The layout of the words of a call."""
        return Struct("=" + "".join(letters(kind) for kind in (*self.results, *self.arguments.values())))

    @cached_property
    def returned(self) -> Struct:
        """The layout of the words of the result."""
        return Struct("=" + "".join(letters(kind) for kind in self.results))

    @cached_property
    def entry(self) -> Callable[[int], None]:
        """The entry of this kernel in the library of its room."""
        from workhold.kernels.base.libraries import load_entry

        return load_entry(self.room, self.name)

    def __call__(self, *values: Any) -> Any:
        if len(values) != len(self.takers):
            raise TypeError(f"{self.name} takes {len(self.takers)} arguments, not {len(values)}.")
        taken: list[Any] = [0] * len(self.results)
        for take, value in zip(self.takers, values, strict=True):
            take(value, taken)
        words = bytearray(self.words.pack(*taken))
        self.entry(addressof(c_char.from_buffer(words)))
        found = self.returned.unpack_from(words)
        return found if len(found) > 1 else found[0] if found else None


def fields(record: Any) -> list[tuple[str, Any]] | None:
    """Return names and types of the fields of a named tuple or a tuple, None for any other type."""
    if get_origin(record) is tuple:
        return [(str(number), kind) for number, kind in enumerate(get_args(record))]
    return list(get_type_hints(record, include_extras=True).items()) if hasattr(record, "_fields") else None


def letters(kind: Any) -> str:
    """Return the letters of :mod:`struct` for the words of a type; an array is its address and its shape."""
    if (parts := fields(kind)) is not None:
        return "".join(letters(part) for _, part in parts)
    return LETTERS[kind] if kind in LETTERS else "q" * (1 + dimensions(kind))


def dimensions(kind: Any) -> int:
    """Return how many dimensions an annotated array has."""
    return int(get_args(kind)[1])


def element(kind: Any) -> np.dtype[Any]:
    """Return the type of the elements of an annotated array."""
    return np.dtype(get_args(get_args(get_args(kind)[0])[1])[0])


def taker(kind: Any, name: str) -> Taker:
    """Return a function that appends the words of an argument of a type to a list."""
    if (parts := fields(kind)) is not None:
        return record_taker(parts, name)
    return number_taker(kind, name) if kind in LETTERS else array_taker(kind, name)


def number_taker(kind: type[Any], name: str) -> Taker:
    """Return the taker of a number, see :func:`taker`."""
    wanted = {int: (int, np.integer), float: (float, int, np.floating, np.integer), bool: (bool, np.bool_)}[
        kind
    ]

    def take(value: Any, words: list[Any]) -> None:
        if not isinstance(value, wanted):
            raise TypeError(f"{name} must be {kind.__name__}, not {type(value).__name__}.")
        words.append(value)

    return take


def array_taker(kind: Any, name: str) -> Taker:
    """Return the taker of an array, see :func:`taker`."""
    wanted, count = element(kind), dimensions(kind)

    def take(value: Any, words: list[Any]) -> None:
        is_array = isinstance(value, np.ndarray) and value.ndim == count and value.dtype == wanted
        if not (is_array and value.flags.c_contiguous and value.flags.aligned):
            raise TypeError(f"{name} must be a C-contiguous array of {wanted} with {count} dimensions.")
        words.append(find_address(value))
        words += value.shape

    return take


def find_address(array: np.ndarray[Any, Any]) -> int:
    """Return where the elements of an array begin."""
    try:
        return addressof(c_char.from_buffer(array.data))
    except (TypeError, ValueError):
        # What cannot be written to, and what is empty.
        return int(array.ctypes.data)


def remembering(take: Taker) -> Taker:
    """Return a taker of arrays that remembers where they lie: those in records are handed over again and again,
    and looking up an address takes longer than all else."""
    known: dict[int, tuple[ref[Any], list[Any]]] = {}

    def take_known(value: Any, words: list[Any]) -> None:
        found = known.get(id(value))
        if found is not None and found[0]() is value:
            words += found[1]
            return
        own: list[Any] = []
        take(value, own)
        number = id(value)
        known[number] = ref(value, lambda _: known.pop(number, None)), own
        words += own

    return take_known


def record_taker(kinds: list[tuple[str, Any]], name: str) -> Taker:
    """Return the taker of a named tuple or a tuple, see :func:`taker`."""
    takers = [
        remembering(take) if get_origin(kind) is Annotated else take
        for kind, take in ((kind, taker(kind, f"{name}.{field}")) for field, kind in kinds)
    ]

    def take(value: Any, words: list[Any]) -> None:
        if not isinstance(value, tuple) or len(value) != len(takers):
            raise TypeError(f"{name} must be a record of {len(takers)}, not {type(value).__name__}.")
        for take_part, part in zip(takers, value, strict=True):
            take_part(part, words)

    return take
