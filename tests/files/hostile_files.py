"""Seeded files that are nearly right: drawings, parts, results, vises and loads with extreme, missing and foreign values."""

from __future__ import annotations

import json
import random
import tempfile
import warnings
from collections.abc import Callable
from copy import deepcopy
from functools import cache
from io import BytesIO, StringIO
from math import cos, radians, sin
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

import ezdxf
import numpy as np

from fakes import fake_result
from workhold.archive import map_archive
from workhold.files.result.columns import write_columns
from workhold.files.result.parts import HEAD, describe_columns
from workhold.files.result.writer import write_result_text

__all__ = ["MAKERS"]

EXTREMES: tuple[Any, ...] = (
    *(
        1e308,
        -1e308,
        1e-308,
        5e-324,
        1e9,
        1e10,
        -1e9,
        1e-9,
        1e-12,
        0,
        -0.0,
        1,
        -1,
        0.5,
        2**31,
        2**63,
        -(2**63),
        10**400,
    ),
    *(
        True,
        False,
        None,
        "",
        "x" * 5000,
        "\x1b]0;owned\x07",
        "a\u202eb",
        "mm",
        "inch",
        "I",
        "left",
        "any",
        "1e999",
    ),
    *([], {}, [[]], [0], [0, 0], [1, 2, 3], [[0, 0, 0]], {"x": 1}, float("inf"), float("nan")),
)

TAG_VALUES = ("1e308", "-1e308", "nan", "inf", "0", "-1", "1e-300", "9" * 400, "\x1b]0;x\x07")


def places_in(value: Any) -> list[tuple[Any, Any]]:
    """Every (container, key) in nested dictionaries and lists."""
    found: list[tuple[Any, Any]] = []
    if isinstance(value, dict | list):
        for key in list(value) if isinstance(value, dict) else range(len(value)):
            found += [(value, key), *places_in(value[key])]
    return found


def upset(content: Any, chance: random.Random) -> Any:
    """A document with up to three of its values made extreme, moved, removed, repeated or slightly changed."""
    for _ in range(chance.randint(0, 3)):
        places = places_in(content)
        if not places:
            break
        container, key = chance.choice(places)
        match chance.randrange(6):
            case 0 | 1:
                container[key] = deepcopy(chance.choice(EXTREMES))
            case 2:
                del container[key]
            case 3:
                other, at = chance.choice(places)
                container[key] = json.loads(json.dumps(other[at])) if at in keys_of(other) else None
            case 4 if isinstance(container, list):
                container.insert(chance.randrange(len(container) + 1), json.loads(json.dumps(container[key])))
            case _ if isinstance(container[key], int | float) and abs(container[key]) < 1e308:
                container[key] = container[key] * chance.choice((-1, 0.5, 1000)) + chance.choice(
                    (0, 1e-9, 0.25)
                )
            case _:
                container[key] = {"more": container[key]} if chance.random() < 0.5 else [container[key]]
    return content


def keys_of(container: Any) -> Any:
    """What a dictionary or list can be asked for."""
    return container if isinstance(container, dict) else range(len(container))


def as_json(content: Any, chance: random.Random) -> bytes:
    """JSON, now and then with a key twice, a byte order mark, or cut short."""
    text = json.dumps(content, indent=chance.choice((None, 1)))
    if chance.random() < 0.1:
        text = text.replace("{", '{"units": "mm", ', 1)
    if chance.random() < 0.1:
        text = text[: chance.randrange(len(text) + 1)]
    return (b"\xef\xbb\xbf" if chance.random() < 0.1 else b"") + text.encode("utf-8", errors="replace")


def toml_value(value: Any) -> str:
    """A value as TOML writes it."""
    if isinstance(value, dict):
        return (
            "{"
            + ", ".join(f"{json.dumps(str(key))} = {toml_value(item)}" for key, item in value.items())
            + "}"
        )
    if isinstance(value, list):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    if isinstance(value, float):
        return repr(value)
    return '""' if value is None else json.dumps(value)


def as_toml(content: Any, chance: random.Random) -> bytes:
    """TOML, now and then with a key twice, a byte order mark, or cut short."""
    entries = content if isinstance(content, dict) else {"load": content}
    lines = [f"{json.dumps(str(key))} = {toml_value(value)}" for key, value in entries.items()]
    if lines and chance.random() < 0.1:
        lines.append(chance.choice(lines))
    text = "\n".join(lines)
    if chance.random() < 0.1:
        text = text[: chance.randrange(len(text) + 1)]
    return (b"\xef\xbb\xbf" if chance.random() < 0.1 else b"") + text.encode("utf-8", errors="replace")


def part(chance: random.Random) -> bytes:
    """A plate, some with an arc and a hole."""
    size = chance.choice((1, 10, 60, 1000))
    loops = [[[0, 0, 0], [size, 0, chance.choice((0, 0.2, 1e-12))], [size, size, 0], [0, size, 0]]]
    if chance.random() < 0.5:
        loops.append([[size / 4, size / 2, 1], [size / 2, size / 2, 1]])
    return as_json(
        upset({"name": "p", "units": chance.choice(("mm", "inch")), "loops": loops}, chance), chance
    )


def result(chance: random.Random) -> bytes:
    """A result of two fixtures."""
    return as_json(upset(json.loads("".join(write_result_text(fake_result(2)))), chance), chance)


def vise(chance: random.Random) -> bytes:
    """A vise with most of its entries."""
    content = {
        "unit": chance.choice(("mm", "inch")),
        "pitch": chance.choice((10, 12.5, [10, 12.5])),
        "columns": chance.choice((1, 2, 8)),
        "peg_radius": 2.5,
        "rows": 9,
        "min_gap": 10,
        "max_opening": 200,
        "row_offset": 1.5,
        "body_radius": 3,
        "blocked": ["L-A1", "R-A3"],
        "pin_diameter": [4.99, 5.0],
        "hole_diameter": [5.0, 5.01],
        "hole_position": 0.02,
    }
    for key in chance.sample(list(content), chance.randrange(8)):
        if key not in ("unit", "pitch", "columns", "peg_radius"):
            del content[key]
    return as_toml(upset(content, chance), chance)


def loads(chance: random.Random) -> bytes:
    """Some forces and moments."""
    tables: list[dict[str, Any]] = [
        {
            "name": "mill",
            "force": chance.choice((200, "0.2 kN")),
            "path": [[0, 0], [40, 0]],
            "direction": [30, 60],
        },
        {"force": 5, "at": [1.5, 2], "direction": "any", "moment": "5 N.m"},
        {"moment": -3},
    ]
    return as_toml(upset({"unit": "mm", "load": tables[: chance.randint(1, 3)]}, chance), chance)


def dxf(chance: random.Random) -> bytes:
    """A drawing of an outline with a hole, perhaps in a turned, scaled or mirrored block, some of its tags damaged."""
    document = ezdxf.new("R2000")
    document.header["$INSUNITS"] = chance.choice((1, 4))
    space = document.modelspace()
    if chance.random() < 0.5:
        target = document.blocks.new("B")
        scale = chance.choice((1, -1, 2, 0.5))
        reference = space.add_blockref("B", (chance.uniform(-50, 50), 7))
        reference.dxf.rotation, reference.dxf.xscale = chance.choice((0, 30, 90)), scale
        reference.dxf.yscale = abs(scale) if chance.random() < 0.9 else 3
    else:
        target = space
    width, height = chance.uniform(5, 90), chance.uniform(5, 90)
    corners = [(0, 0), (width, 0), (width, height), (0, height)]
    if chance.random() < 0.5:
        bulge = chance.choice((0, 0.3, -0.2, 1, 1e-9))
        target.add_lwpolyline([(*corner, 0, 0, bulge) for corner in corners], close=True)
    else:
        for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
            target.add_line(start, end)
    radius = min(width, height) / chance.choice((3, 5, 1.5))
    center = (width / 2, height / 2)
    if chance.random() < 0.5:
        target.add_circle(center, radius)
    else:
        low, high = 20.0, 200.0
        ends = [
            (center[0] + radius * cos(radians(a)), center[1] + radius * sin(radians(a))) for a in (low, high)
        ]
        target.add_arc(center, radius, low, high)
        target.add_line(ends[1], ends[0])
    stream = StringIO()
    document.write(stream)
    return with_damaged_tags(stream.getvalue(), chance).encode("utf-8", errors="replace")


def with_damaged_tags(text: str, chance: random.Random) -> str:
    """A drawing with up to three of the tags of its blocks and entities changed, dropped or repeated."""
    lines = text.split("\n")
    first = next(k for k, line in enumerate(lines) if line == "BLOCKS")
    last = next(k for k, line in enumerate(lines) if line == "OBJECTS")
    for _ in range(chance.randint(0, 3)):
        at = chance.randrange(first + 1, last - 4)
        # A code stands on an even line, counted from 0, its value on the next.
        at -= at % 2
        match chance.randrange(5):
            case 0:
                lines[at + 1] = chance.choice(
                    ("1e308", "-1e308", "nan", "inf", "0", "-1", "1e-300", "9" * 400, "\x1b]0;x\x07")
                )
            case 1:
                lines[at] = chance.choice((" 10", " 42", "  0", "  2", " 41", "230", " 70", "999", "x"))
            case 2:
                lines[at : at + 2] = ["999", "gone"]
            case 3:
                other = chance.randrange(first + 1, last - 4)
                lines[at + 1] = lines[other - other % 2 + 1]
            case _:
                count = 2 * chance.randint(1, 8)
                lines[at:at] = lines[at : at + count]
                last += count
    return "\n".join(lines)


def columns(chance: random.Random) -> bytes:
    """A result of two fixtures in columns: its head upset, its arrays of other types, shapes and values, its members packed,
    missing, doubled or locked, its bytes cut short or changed."""
    text, arrays = written_columns()
    arrays = {name: array.copy() for name, array in arrays.items()}
    head = json.loads(text)
    if chance.random() < 0.5:
        head = upset(head, chance)
    members = {f"{name}.npy": npy(array) for name, array in arrays.items()}
    for _ in range(chance.randint(0, 2)):
        name = chance.choice(list(arrays))
        members[f"{name}.npy"] = odd_array(arrays[name], chance)
    listed = [*members.items(), (HEAD, json.dumps(head).encode("utf-8", errors="replace"))]
    packed = chance.choice((ZIP_STORED,) * 8 + (ZIP_DEFLATED,))
    if chance.random() < 0.15:
        listed.append(chance.choice(listed) if chance.random() < 0.5 else ("more.txt", bytes(10_000_000)))
    if chance.random() < 0.05:
        del listed[chance.randrange(len(listed))]
    stream = BytesIO()
    with ZipFile(stream, "w", packed) as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        for name, content in listed:
            archive.writestr(name, content)
        if chance.random() < 0.5:
            archive.comment = b"workhold-result/1"
    content = bytearray(stream.getvalue())
    if chance.random() < 0.2:
        for _ in range(chance.randint(1, 9)):
            content[chance.randrange(len(content))] = chance.randrange(256)
    if chance.random() < 0.1:
        del content[chance.randrange(len(content)) :]
    return bytes(content)


@cache
def written_columns() -> tuple[str, dict[str, Any]]:
    """The head and the arrays of such a file as it is written."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "result.npz"
        write_columns(fake_result(2), path)
        text, arrays = map_archive(path, describe_columns(1), HEAD)
        return text, {name: np.array(array) for name, array in arrays.items()}


def npy(array: Any) -> bytes:
    """An array as a member; one of objects is a pickle."""
    stream = BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


def odd_array(array: Any, chance: random.Random) -> bytes:
    """A column that is not what it was."""
    match chance.randrange(6):
        case 0:
            kind = chance.choice(("O", "<f4", ">f8", "<i8", "<u4", "|S8", "<c16", "|b1", "<m8[s]"))
            return npy(np.zeros(array.shape, object) if kind == "O" else np.zeros(array.shape, kind))
        case 1:
            shape = chance.choice(((0,), (), (3, *array.shape[1:]), (2, 7), (1, 1, 1, 1), (2, 4, 1)))
            return npy(np.zeros(shape, array.dtype))
        case 2:
            return npy(np.asfortranarray(array) if array.ndim > 1 else array[::-1])
        case 3:
            content = npy(array)
            shape = str(array.shape).encode()
            absurd = str((chance.choice((2**31, 2**62, 10**30, -1)), *array.shape[1:])).encode()
            return content.replace(shape, absurd, 1).replace(b" " * max(len(absurd) - len(shape), 0), b"", 1)
        case _:
            known = np.iinfo(array.dtype) if array.dtype.kind == "i" else None
            extremes = (
                (known.min, known.max, -1, 0, 1, 7)
                if known
                else (np.nan, np.inf, -np.inf, 1e308, -1.0, 0.0, 1e-308)
            )
            array.reshape(-1)[chance.randrange(array.size)] = chance.choice(extremes)
            return npy(array)


MAKERS: dict[str, Callable[[random.Random], bytes]] = {
    "part.json": part,
    "result.json": result,
    "vise.toml": vise,
    "loads.toml": loads,
    "drawing.dxf": dxf,
    "result.npz": columns,
}
