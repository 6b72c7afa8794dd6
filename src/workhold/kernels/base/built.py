"""Kernels compiled when the package was built: one shared library that needs neither numba nor Python.

The library holds each kernel under its name, as a function of an array of words: those of its result, one for a failure,
and those of its arguments, with all records and arrays taken apart. It tells in ``DESCRIPTION`` what each is called with
(written by ``building/compile_kernels.py``). It is called through ctypes, which releases the interpreter lock. Compiled code
trusts what it is given, so every call is checked here first; both take microseconds, as seating calls small kernels often.

Glossary
--------
door : what Python calls: a kernel of the library behind its checks.
argument : a number, as "int64", "float64" or "bool"; an array, as its element type and how many dimensions it has; or a
    record, as the list of its fields.
"""

from __future__ import annotations

import ctypes
import json
from collections.abc import Callable
from functools import cache, partial
from inspect import signature
from pathlib import Path
from struct import Struct
from typing import Any

import numpy as np

__all__ = ["DESCRIPTION", "LIBRARY_NAME", "Door", "Library"]

# Names that the library exports besides those of its kernels.
DESCRIPTION, RELEASE = "workhold_description", "workhold_release"
LIBRARY_NAME = "kernels.{platform}.so"
# Appends the words of a value, and says whether it is taken.
Taker = Callable[[Any, list[Any]], bool]
# What a kernel returns: done, or done with nothing to hand back. All else means that it had no memory.
DONE = (0, -2)
SCALARS: dict[str, tuple[type[Any], tuple[type[Any], ...]]] = {
    "int64": (ctypes.c_int64, (int, np.integer)),
    "float64": (ctypes.c_double, (float, int, np.floating, np.integer)),
    "bool": (ctypes.c_bool, (bool, np.bool_)),
}
WORD = 8
# Records of one kind of which the words are kept, and bytes of the arrays of each.
MOST_KEPT, MOST_BYTES = 16, 2**18
# Words of an array before its shape: two owners, number of elements, bytes of one, address.
ARRAY_WORDS, ADDRESS = 5, 4


class Library:
    """A shared library of kernels.

    Raises
    ------
    OSError
        When the file is missing or no library for this machine.
    """

    def __init__(self, path: Path) -> None:
        self.code = ctypes.CDLL(str(path))
        described: Any = json.loads(ctypes.string_at(ctypes.addressof(ctypes.c_char.in_dll(self.code, DESCRIPTION))))
        self.source_hash: str = described["source_hash"]
        self.kernels: dict[str, Any] = described["kernels"]
        self.release = getattr(self.code, RELEASE)
        self.release.argtypes, self.release.restype = [ctypes.c_void_p], None

    def door(self, function: Callable[..., Any]) -> Door:
        """The door to the kernel of a function.

        Raises
        ------
        KeyError
            When there is none of its name.
        """
        return Door(self, function, **self.kernels[function.__name__])


class Door:
    """A kernel that checks what it is called with: places, element types, dimensions and layout of all arguments.

    Raises
    ------
    TypeError
        For a call with anything else than the kernel was compiled for.
    """

    def __init__(self, library: Library, function: Callable[..., Any], arguments: list[Any], result: Any) -> None:
        self.library = library
        self.__name__, self.__doc__ = function.__name__, function.__doc__
        self.arguments = tuple(zip(signature(function).parameters, arguments, strict=True))
        self.takers = [taker(argument) for argument in arguments]
        self.result = result
        self.code = getattr(library.code, function.__name__)
        self.code.restype, self.code.argtypes = ctypes.c_int, [ctypes.c_void_p]
        # As many words as are returned, one for what failed, and those of the arguments.
        self.before = bytes(WORD * (words_of(result) + 1))
        self.words = Struct("=" + "".join(letters(argument) for argument in arguments))

    def __call__(self, *values: Any) -> Any:
        if len(values) != len(self.takers):
            raise TypeError(f"{self.__name__} takes {len(self.takers)} arguments, not {len(values)}.")
        taken: list[Any] = []
        for take, value in zip(self.takers, values, strict=True):
            if not take(value, taken):
                raise TypeError(f"{self.__name__}: {self.refused(values)}.")
        words = bytearray(self.before + self.words.pack(*taken))
        if self.code(ctypes.addressof(ctypes.c_char.from_buffer(words))) not in DONE:
            raise MemoryError(f"{self.__name__} found no memory for its result.")
        return None if self.result is None else self.handed_back(self.result, words, 0)

    def refused(self, values: tuple[Any, ...]) -> str:
        """Which of the values is none that the kernel was compiled for."""
        told = (refusal(name, kind, value) for (name, kind), value in zip(self.arguments, values, strict=True))
        return next(words for words in told if words is not None)

    def handed_back(self, result: Any, words: bytearray, start: int) -> Any:
        """The result that begins at a word of what the library returned."""
        if isinstance(result, str):
            return SCALARS[result][0].from_buffer(words, WORD * start).value
        if isinstance(result, dict):
            return self.array(result, memoryview(words).cast("q"), start)
        parts = []
        for part in result:
            parts.append(self.handed_back(part, words, start))
            start += words_of(part)
        return tuple(parts)

    def array(self, result: dict[str, Any], words: Any, start: int) -> Any:
        """An array that the library made, which is given back to it when nobody looks at it any more."""
        shape = start + ARRAY_WORDS
        strides = shape + result["dimensions"]
        end = strides + result["dimensions"]
        owner = Made(partial(self.library.release, words[start]))
        owner.__array_interface__ = {
            "version": 3,
            "typestr": np.dtype(result["array"]).str,
            "shape": tuple(words[shape:strides]),
            "strides": tuple(words[strides:end]),
            "data": (words[start + ADDRESS], False),
        }
        return np.asarray(owner)


class Made:
    """The owner of an array that the library made."""

    __array_interface__: dict[str, Any]

    def __init__(self, release: Callable[[], None]) -> None:
        self.release = release

    def __del__(self) -> None:
        self.release()


def taker(argument: Any) -> Taker:
    """What appends the words that a library takes for an argument; it says whether the value is one that it takes."""
    return taker_told(json.dumps(argument))


@cache
def taker_told(text: str) -> Taker:
    """The same of an argument in JSON, one for all kernels: what is known of a record serves them all."""
    argument = json.loads(text)
    if isinstance(argument, str):
        return number_taker(SCALARS[argument][1])
    if isinstance(argument, dict):
        return array_taker(np.dtype(argument["array"]), argument["dimensions"])
    return record_taker([taker(part) for part in argument])


def number_taker(kinds: tuple[type[Any], ...]) -> Taker:
    """See ``taker``, of a number of some kinds."""

    def take(value: Any, taken: list[Any]) -> bool:
        # Truths are words as others are.
        taken.append(bool(value) if bool in kinds else value)
        return isinstance(value, kinds)

    return take


def array_taker(element: np.dtype[Any], dimensions: int) -> Taker:
    """See ``taker``, of an array of elements in their order."""
    width, address_of = element.itemsize, ctypes.addressof
    first_of: Callable[[Any], ctypes.c_char] = ctypes.c_char.from_buffer

    def take(value: Any, taken: list[Any]) -> bool:
        if not isinstance(value, np.ndarray) or value.ndim != dimensions or value.dtype != element:
            return False
        flags, size = value.flags, value.size
        if flags.carray and size:
            # In a sixth of the time of asking for the address.
            address = address_of(first_of(value))
        elif flags.c_contiguous and flags.aligned:
            address = value.__array_interface__["data"][0]
        else:
            return False
        taken += (0, 0, size, width, address, *value.shape, *value.strides)
        return True

    return take


def record_taker(takers: list[Taker]) -> Taker:
    """See ``taker``, of a record; the words of the last few that are small are kept with them, as one is often handed on."""
    kept: dict[int, tuple[Any, list[Any]]] = {}

    def take(value: Any, taken: list[Any]) -> bool:
        known = kept.get(id(value))
        if known is not None and known[0] is value:
            taken += known[1]
            return True
        own: list[Any] = []
        if not isinstance(value, tuple) or len(value) != len(takers):
            return False
        if not all(part(item, own) for part, item in zip(takers, value, strict=True)):
            return False
        taken += own
        if sum(item.nbytes for item in value if isinstance(item, np.ndarray)) < MOST_BYTES:
            if len(kept) >= MOST_KEPT:
                kept.clear()
            kept[id(value)] = value, own
        return True

    return take


def refusal(name: str, argument: Any, value: Any) -> str | None:
    """Why a value is not taken, in words; None where it is."""
    if taker(argument)(value, []):
        return None
    if isinstance(argument, str):
        return f"{name} must be {argument}, not {told(value)}"
    if isinstance(argument, dict):
        dimensions = argument["dimensions"]
        wanted = f"{np.dtype(argument['array'])} with {dimensions} dimension{'s' * (dimensions > 1)}"
        return f"{name} must be a C-contiguous array of {wanted}, not {told(value)}"
    if not isinstance(value, tuple) or len(value) != len(argument):
        return f"{name} must be a record of {len(argument)}, not {told(value)}"
    fields = zip(getattr(value, "_fields", range(len(argument))), argument, value, strict=True)
    words = (refusal(f"{name}.{field}", part, item) for field, part, item in fields)
    return next(one for one in words if one is not None)


def letters(argument: Any) -> str:
    """The words of an argument as ``struct`` calls them."""
    if isinstance(argument, str):
        return "d" if argument == "float64" else "q"
    if isinstance(argument, dict):
        return "q" * words_of(argument)
    return "".join(map(letters, argument))


def words_of(result: Any) -> int:
    """How many words of eight bytes a result takes."""
    if isinstance(result, dict):
        return ARRAY_WORDS + 2 * int(result["dimensions"])
    return sum(map(words_of, result)) if isinstance(result, list) else 1


def told(value: Any) -> str:
    """What a value is, for a message."""
    if isinstance(value, np.ndarray):
        layout = "" if value.flags.c_contiguous else ", not contiguous"
        return f"an array of {value.dtype} of shape {value.shape}{layout}"
    return f"{type(value).__name__} of {len(value)}" if isinstance(value, tuple) else type(value).__name__
