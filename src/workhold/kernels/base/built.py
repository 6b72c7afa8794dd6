"""Kernels compiled when the package was built: one shared library that needs neither numba nor Python.

The library holds each kernel under its name, in numba's calling convention with all records and arrays taken apart, and
tells in ``DESCRIPTION`` what each is called with (written by ``building/compile_kernels.py``). It is called through ctypes,
which releases the interpreter lock. Compiled code trusts what it is given, so every call is checked here first.

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
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["DESCRIPTION", "LIBRARY_NAME", "Door", "Library"]

# Names that the library exports besides those of its kernels.
DESCRIPTION, RELEASE = "workhold_description", "workhold_release"
LIBRARY_NAME = "kernels.{platform}.so"
# What a kernel returns: done, or done with nothing to hand back. All else means that it had no memory.
DONE = (0, -2)
SCALARS: dict[str, tuple[type[Any], tuple[type[Any], ...]]] = {
    "int64": (ctypes.c_int64, (int, np.integer)),
    "float64": (ctypes.c_double, (float, int, np.floating, np.integer)),
    "bool": (ctypes.c_bool, (bool, np.bool_)),
}
WORD = 8
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
        self.result = result
        self.code = getattr(library.code, function.__name__)
        self.code.restype = ctypes.c_int
        self.code.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
        for argument in arguments:
            self.code.argtypes += c_types(argument)
        self.words = words_of(result)

    def __call__(self, *values: Any) -> Any:
        if len(values) != len(self.arguments):
            raise TypeError(f"{self.__name__} takes {len(self.arguments)} arguments, not {len(values)}.")
        taken: list[Any] = []
        for (name, argument), value in zip(self.arguments, values, strict=True):
            self.take(name, argument, value, taken)
        returned, failure = (ctypes.c_int64 * self.words)(), ctypes.c_void_p()
        if self.code(returned, ctypes.byref(failure), *taken) not in DONE:
            raise MemoryError(f"{self.__name__} found no memory for its result.")
        return None if self.result is None else self.handed_back(self.result, returned, 0)

    def take(self, name: str, argument: Any, value: Any, taken: list[Any]) -> None:
        """Check one argument and append what the library is called with in its place."""
        if isinstance(argument, str):
            if not isinstance(value, SCALARS[argument][1]):
                raise TypeError(f"{self.__name__}: {name} must be {argument}, not {told(value)}.")
            taken.append(value)
        elif isinstance(argument, dict):
            self.take_array(name, argument["array"], argument["dimensions"], value, taken)
        else:
            if not isinstance(value, tuple) or len(value) != len(argument):
                raise TypeError(f"{self.__name__}: {name} must be a record of {len(argument)}, not {told(value)}.")
            names = getattr(value, "_fields", range(len(argument)))
            for field, part, item in zip(names, argument, value, strict=True):
                self.take(f"{name}.{field}", part, item, taken)

    def take_array(self, name: str, element: str, dimensions: int, value: Any, taken: list[Any]) -> None:
        """Check an array and append its words."""
        if (
            not isinstance(value, np.ndarray)
            or value.dtype.str[1:] != element
            or value.ndim != dimensions
            or not (value.flags.c_contiguous and value.flags.aligned and value.dtype.isnative)
        ):
            wanted = f"a C-contiguous array of {np.dtype(element)} with {dimensions} dimension{'s' * (dimensions > 1)}"
            raise TypeError(f"{self.__name__}: {name} must be {wanted}, not {told(value)}.")
        taken += (
            None,
            None,
            value.size,
            value.itemsize,
            value.__array_interface__["data"][0],
            *value.shape,
            *value.strides,
        )

    def handed_back(self, result: Any, words: Any, start: int) -> Any:
        """The result that begins at a word of what the library returned."""
        if isinstance(result, str):
            return SCALARS[result][0].from_buffer(words, WORD * start).value
        if isinstance(result, dict):
            return self.array(result, words, start)
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


def c_types(argument: Any) -> list[type[Any]]:
    """The words a kernel takes for an argument."""
    if isinstance(argument, str):
        return [SCALARS[argument][0]]
    if isinstance(argument, dict):
        numbers = [ctypes.c_int64] * (2 * argument["dimensions"])
        return [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p, *numbers]
    return [word for part in argument for word in c_types(part)]


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
