"""Kernels compiled when the package was built: one shared library that needs neither numba nor Python.

The library holds each kernel under its name, as a function of an array of words. These are those of its
result, one for a failure, and those of its arguments, with all records taken apart. It describes in
``DESCRIPTION`` what each is called with (written by ``building/compile_kernels.py``). It is called through
ctypes, which releases the interpreter lock. Kernels trust what they are given, so every call is checked. The
word of an array is where NumPy keeps its header, in which the library itself looks up and checks what it is.
Seating calls small kernels often, and most of a call is spent on describing its arrays.

The library belongs to the sources of which it holds the hash: code compiled from others is never run.

Glossary
--------
checked kernel : what Python calls: a kernel of the library behind its checks.
argument : a number, as "int64", "float64" or "bool"; an array, as its element type and how many dimensions it
    has; or a record, as the list of its fields.
header : NumPy's record of an array in memory, of which its C interface fixes the layout
    (``PyArrayObject_fields``).
"""

from __future__ import annotations

import ctypes
import json
import sys
from collections.abc import Callable, Sequence
from functools import partial
from hashlib import sha256
from inspect import signature
from pathlib import Path
from struct import Struct
from sysconfig import get_platform
from typing import Any

import numpy as np

# Names that the library exports besides those of its kernels.
DESCRIPTION, RELEASE, KNOWN = "workhold_description", "workhold_release", "workhold_known"
# Elements of arrays. The library needs to know where Python keeps the types of arrays and of these.
ELEMENTS = ("f8", "i8", "i1")
LIBRARY_NAME = "kernels.{platform}.so"
# Appends the words of a value, and says whether it is taken.
Taker = Callable[[Any, list[Any]], bool]
# What a kernel returns: done, or done with nothing to hand back; that it was called with another array than
# those it was compiled for. All else means that it had no memory.
DONE, REFUSED = (0, -2), -100
SCALARS: dict[str, tuple[type[Any], tuple[type[Any], ...]]] = {
    "int64": (ctypes.c_int64, (int, np.integer)),
    "float64": (ctypes.c_double, (float, int, np.floating, np.integer)),
    "bool": (ctypes.c_bool, (bool, np.bool_)),
}
WORD = 8
# Where an array's header holds what, in bytes, and flags of ordered, aligned elements (``ndarraytypes.h``).
HEADER = {"type": 8, "data": 16, "dimensions": 24, "shape": 32, "strides": 40, "element": 56, "flags": 64}
HEADER_BYTES, ORDERED = 68, 0x0001 | 0x0100
# Words before the shape of an array handed back: two owners, number of elements, bytes of one, address.
ARRAY_WORDS, ADDRESS = 5, 4


class Library:
    """A shared library of kernels.

    Raises
    ------
    OSError
        When the file is missing or no library for this machine and this Python.
    """

    def __init__(self, path: Path) -> None:
        if sys.implementation.name != "cpython" or not are_headers_known():
            raise OSError("This Python keeps arrays in another way.")
        self.code = ctypes.CDLL(str(path))
        described: Any = json.loads(
            ctypes.string_at(ctypes.addressof(ctypes.c_char.in_dll(self.code, DESCRIPTION)))
        )
        self.source_hash: str = described["source_hash"]
        self.kernels: dict[str, Any] = described["kernels"]
        known = (ctypes.c_void_p * (1 + len(ELEMENTS))).in_dll(self.code, KNOWN)
        known[:] = [id(np.ndarray), *(id(np.dtype(element)) for element in ELEMENTS)]
        self.release = getattr(self.code, RELEASE)
        self.release.argtypes, self.release.restype = [ctypes.c_void_p], None

    def checked(self, function: Callable[..., Any]) -> CheckedKernel:
        """The kernel of a function, behind its checks.

        Raises
        ------
        KeyError
            When there is none of its name.
        """
        return CheckedKernel(self, function, **self.kernels[function.__name__])


class CheckedKernel:
    """A kernel that checks what it is called with: places, element types, dimensions and layout of all
    arguments.

    Raises
    ------
    TypeError
        For a call with anything else than the kernel was compiled for.
    """

    def __init__(
        self, library: Library, function: Callable[..., Any], arguments: list[Any], result: Any
    ) -> None:
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
        words = self.called(values)
        if words is None:
            words = self.called(self.plain(values))
        if words is None:
            raise TypeError(f"{self.__name__} was called with an array that is none of NumPy's own.")
        return None if self.result is None else self.handed_back(self.result, words, 0)

    def called(self, values: Sequence[Any]) -> bytearray | None:
        """The words after a call with some values; None where one of them is not taken."""
        if len(values) != len(self.takers):
            raise TypeError(f"{self.__name__} takes {len(self.takers)} arguments, not {len(values)}.")
        taken: list[Any] = []
        for take, value in zip(self.takers, values, strict=True):
            if not take(value, taken):
                return None
        words = bytearray(self.before + self.words.pack(*taken))
        done = self.code(ctypes.addressof(ctypes.c_char.from_buffer(words)))
        if done == REFUSED:
            return None
        if done not in DONE:
            raise MemoryError(f"{self.__name__} found no memory for its result.")
        return words

    def plain(self, values: tuple[Any, ...]) -> list[Any]:
        """Values of which one was not taken, with arrays as NumPy makes them: of a class of their own, say,
        they are not.

        Raises
        ------
        TypeError
            When one of the values is none that the kernel was compiled for.
        """
        given = zip(self.arguments, values, strict=True)
        refused = (refusal(name, kind, value) for (name, kind), value in given)
        words = next((words for words in refused if words is not None), None)
        if words is not None:
            raise TypeError(f"{self.__name__}: {words}.")
        return [plain(kind, value) for (_, kind), value in zip(self.arguments, values, strict=True)]

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


def are_headers_known() -> bool:
    """Whether the header of an array holds what it should, where it should."""
    array = np.zeros((2, 3), np.int8)
    header = ctypes.string_at(id(array), HEADER_BYTES)

    def word(name: str, letter: str = "q") -> int:
        return int(Struct(f"={letter}").unpack_from(header, HEADER[name])[0])

    found = word("type"), word("data"), word("dimensions", "i"), word("element"), word("flags", "i") & ORDERED
    if found != (id(np.ndarray), array.ctypes.data, 2, id(array.dtype), ORDERED):
        return False
    pair = ctypes.c_int64 * 2
    return all(
        tuple(pair.from_address(word(name))) == known
        for name, known in (("shape", array.shape), ("strides", array.strides))
    )


def taker(argument: Any) -> Taker:
    """What appends the words that a library takes for an argument; it says whether the value is one that it
    takes, but of arrays, of which the library says it."""
    if isinstance(argument, str):
        return number_taker(argument)
    return array_taken if isinstance(argument, dict) else record_taker(argument)


def number_taker(argument: str) -> Taker:
    """The taker of a number, see ``taker``."""
    kinds = SCALARS[argument][1]

    def take(value: Any, taken: list[Any]) -> bool:
        taken.append(value)
        return isinstance(value, kinds)

    return take


def array_taken(value: Any, taken: list[Any]) -> bool:
    """The taker of an array, see ``taker``."""
    # Where Python keeps it.
    taken.append(id(value))
    return True


def record_taker(argument: list[Any]) -> Taker:
    """The taker of a record, see ``taker``."""
    count, takers = len(argument), [taker(part) for part in argument]
    numbers = [(k, SCALARS[part][1]) for k, part in enumerate(argument) if isinstance(part, str)]

    def take_each(value: Any, taken: list[Any]) -> bool:
        if not isinstance(value, tuple) or len(value) != count:
            return False
        return all(part(item, taken) for part, item in zip(takers, value, strict=True))

    def take(value: Any, taken: list[Any]) -> bool:
        if not isinstance(value, tuple) or len(value) != count:
            return False
        start = len(taken)
        taken += map(id, value)
        for k, kinds in numbers:
            if not isinstance(value[k], kinds):
                return False
            taken[start + k] = value[k]
        return True

    # Arrays with few numbers among them, as records mostly are, are taken several times as fast together.
    return take_each if any(isinstance(part, list) for part in argument) else take


def plain(argument: Any, value: Any) -> Any:
    """A value that is taken for an argument, arrays as NumPy makes them."""
    if isinstance(argument, dict):
        return value.view(np.ndarray).view(np.dtype(argument["array"]))
    if isinstance(argument, list):
        return tuple(plain(part, item) for part, item in zip(argument, value, strict=True))
    return value


def refusal(name: str, argument: Any, value: Any) -> str | None:
    """Why a value is not taken, in words; None where it is."""
    if isinstance(argument, str):
        return (
            None
            if isinstance(value, SCALARS[argument][1])
            else f"{name} must be {argument}, not {described(value)}"
        )
    if isinstance(argument, dict):
        element, dimensions = np.dtype(argument["array"]), argument["dimensions"]
        is_such = isinstance(value, np.ndarray) and value.dtype == element and value.ndim == dimensions
        if is_such and value.flags.c_contiguous and value.flags.aligned:
            return None
        wanted = f"{element} with {dimensions} dimension{'s' * (dimensions > 1)}"
        return f"{name} must be a C-contiguous array of {wanted}, not {described(value)}"
    if not isinstance(value, tuple) or len(value) != len(argument):
        return f"{name} must be a record of {len(argument)}, not {described(value)}"
    fields = zip(getattr(value, "_fields", range(len(argument))), argument, value, strict=True)
    words = (refusal(f"{name}.{field}", part, item) for field, part, item in fields)
    return next((one for one in words if one is not None), None)


def letters(argument: Any) -> str:
    """The words of an argument as ``struct`` calls them."""
    if isinstance(argument, str):
        return {"float64": "d", "int64": "q", "bool": "?xxxxxxx"}[argument]
    return "q" if isinstance(argument, dict) else "".join(map(letters, argument))


def words_of(result: Any) -> int:
    """How many words of eight bytes a result takes, with arrays taken apart."""
    if isinstance(result, dict):
        return ARRAY_WORDS + 2 * int(result["dimensions"])
    return sum(map(words_of, result)) if isinstance(result, list) else 1


def described(value: Any) -> str:
    """What a value is, for a message."""
    if isinstance(value, np.ndarray):
        layout = "" if value.flags.c_contiguous else ", not contiguous"
        return f"an array of {value.dtype} of shape {value.shape}{layout}"
    return f"{type(value).__name__} of {len(value)}" if isinstance(value, tuple) else type(value).__name__


# The folder of all kernels.
KERNELS = Path(__file__).resolve().parents[1]


def source_hash() -> str:
    """Hash of the sources of all rooms of the kernels, and of the numbers that decide."""
    digest, package = sha256(), KERNELS.parent
    for path in (package / "conventions.py", *sorted(KERNELS.rglob("*.py"))):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:20]


def library_name() -> str:
    """Name of the file of the library for this kind of machine."""
    return LIBRARY_NAME.format(platform=get_platform().replace(".", "_"))
