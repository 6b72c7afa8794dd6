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
    """Mark a function that only kernels call, and return it: compiled in the modes "building" and "callable",
    else as it is.

    Kernels avoid what is slow to compile: assignments of slices, and long kernels that call other long ones.
    """
    if MODE not in ("building", "callable"):
        return function
    import numba

    INNER.append(numba.njit(**OPTIONS, cache=MODE == "callable")(function))
    return cast(Function, INNER[-1])


def compiled(function: Function) -> Function:
    """Mark a function that Python calls; return its :class:`Kernel`,
    which runs without Python's global lock (GIL).
    """
    return cast(Function, Kernel(function))


class Kernel:
    """A compiled function that Python calls, with positional arguments only.

    The library of its room is loaded at the first call, and built first where there is none.

    Raises
    ------
    TypeError
        At a call whose arguments differ in number or type from the function's annotations.
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
        """The type of each argument, by the argument's name, in the order of the signature."""
        return {name: self.hints[name] for name in signature(self.function).parameters}

    @cached_property
    def hints(self) -> dict[str, Any]:
        """The types in the function's annotations, by the argument's name or "return"."""
        return get_type_hints(self.function, include_extras=True)

    @cached_property
    def results(self) -> tuple[type[Any], ...]:
        """The types of the returned numbers, empty where the function returns None."""
        result = self.hints["return"]
        if result is type(None):
            return ()
        return get_args(result) if get_origin(result) is tuple else (result,)

    @cached_property
    def takers(self) -> list[Taker]:
        """For each argument in order, the function that appends the argument's words (of eight bytes) to a
        list."""
        return [make_taker(kind, f"{self.name}: {name}") for name, kind in self.arguments.items()]

    @cached_property
    def words(self) -> Struct:
        """The layout of a call in memory: first the words of the results, then those of the arguments."""
        return Struct(
            "=" + "".join(make_format_letters(kind) for kind in (*self.results, *self.arguments.values()))
        )

    @cached_property
    def returned(self) -> Struct:
        """The layout of the words of the results."""
        return Struct("=" + "".join(make_format_letters(kind) for kind in self.results))

    @cached_property
    def entry(self) -> Callable[[int], None]:
        """The compiled entry of this kernel, which takes the address of the words of a call."""
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


def list_fields(record: Any) -> list[tuple[str, Any]] | None:
    """Return [(name, type)] of the fields of a named tuple or tuple
    type (names "0", "1", ... there), None for other types.
    """
    if get_origin(record) is tuple:
        return [(str(number), kind) for number, kind in enumerate(get_args(record))]
    return list(get_type_hints(record, include_extras=True).items()) if hasattr(record, "_fields") else None


def make_format_letters(kind: Any) -> str:
    """Return the format letters of :mod:`struct` for the words of a type; an array has the words of its
    address and its shape."""
    if (parts := list_fields(kind)) is not None:
        return "".join(make_format_letters(part) for _, part in parts)
    return LETTERS[kind] if kind in LETTERS else "q" * (1 + count_dimensions(kind))


def count_dimensions(kind: Any) -> int:
    """Return the number of dimensions of an annotated array type, such as 2 for ``Matrix``."""
    return int(get_args(kind)[1])


def get_element_type(kind: Any) -> np.dtype[Any]:
    """Return the NumPy dtype of the elements of an annotated array type, such as float64 for ``Matrix``."""
    return np.dtype(get_args(get_args(get_args(kind)[0])[1])[0])


def make_taker(kind: Any, name: str) -> Taker:
    """Return a function ``take(value, words)`` that checks an argument of the type ``kind`` and appends its
    words to a list.

    ``name`` names the argument in the message of the TypeError that ``take`` raises for a wrong value.
    """
    if (parts := list_fields(kind)) is not None:
        return make_record_taker(parts, name)
    return make_number_taker(kind, name) if kind in LETTERS else make_array_taker(kind, name)


def make_number_taker(kind: type[Any], name: str) -> Taker:
    """Return the taker of a number (int, float or bool), see :func:`make_taker`."""
    wanted = {int: (int, np.integer), float: (float, int, np.floating, np.integer), bool: (bool, np.bool_)}[
        kind
    ]

    def take(value: Any, words: list[Any]) -> None:
        """Append a number to ``words``; raise TypeError for a value of another type."""
        if not isinstance(value, wanted):
            raise TypeError(f"{name} must be {kind.__name__}, not {type(value).__name__}.")
        words.append(value)

    return take


def make_array_taker(kind: Any, name: str) -> Taker:
    """Return the taker of a C-contiguous array of the annotated type ``kind``, see :func:`make_taker`."""
    wanted, count = get_element_type(kind), count_dimensions(kind)

    def take(value: Any, words: list[Any]) -> None:
        """Append the address and the shape of an array to ``words``; raise
        TypeError for another type, layout or dimension.
        """
        is_array = isinstance(value, np.ndarray) and value.ndim == count and value.dtype == wanted
        if not (is_array and value.flags.c_contiguous and value.flags.aligned):
            raise TypeError(f"{name} must be a C-contiguous array of {wanted} with {count} dimensions.")
        words.append(find_address(value))
        words += value.shape

    return take


def find_address(array: np.ndarray[Any, Any]) -> int:
    """Return the memory address of the first element of an array."""
    try:
        return addressof(c_char.from_buffer(array.data))
    except (TypeError, ValueError):
        # What cannot be written to, and what is empty.
        return int(array.ctypes.data)


def remember_arrays(take: Taker) -> Taker:
    """Return a taker like ``take`` that remembers the words of each array object as long as the object lives.

    Arrays in records are handed over again and again, and looking up the address of an array takes most of
    the time.
    """
    known: dict[int, tuple[ref[Any], list[Any]]] = {}

    def take_known(value: Any, words: list[Any]) -> None:
        """Append the words of an array to ``words``: from memory, or else by calling ``take``."""
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


def make_record_taker(kinds: list[tuple[str, Any]], name: str) -> Taker:
    """Return the taker of a named tuple or tuple with fields ``kinds`` [(name, type)], see
    :func:`make_taker`."""
    takers = [
        remember_arrays(take) if get_origin(kind) is Annotated else take
        for kind, take in ((kind, make_taker(kind, f"{name}.{field}")) for field, kind in kinds)
    ]

    def take(value: Any, words: list[Any]) -> None:
        """Append the words of all fields to ``words``; raise TypeError
        for anything but a tuple of as many fields.
        """
        if not isinstance(value, tuple) or len(value) != len(takers):
            raise TypeError(f"{name} must be a record of {len(takers)}, not {type(value).__name__}.")
        for take_part, part in zip(takers, value, strict=True):
            take_part(part, words)

    return take
