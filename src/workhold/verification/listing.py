"""What a result claims, number for number as its file writes it.

The result reader drops what it can work out again, such as the pegs' x and y, and refuses files that contradict themselves.
A verification has to see every number, so this module reads the file by itself. Fixtures become compact objects while the
JSON is parsed.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any, NoReturn

from attrs import field, frozen

from workhold.errors import InputError
from workhold.model.fixture import Fixture, Peg, Pose
from workhold.model.holes import holes_named
from workhold.model.quality import FIGURES
from workhold.model.result import Result
from workhold.model.vise import OpeningVise, Vise
from workhold.model.workpiece import Workpiece
from workhold.verification.asked import Asked, asked_in, asked_of

__all__ = ["Listing", "listing_of", "read_listing"]

FORMAT = "workhold-result/1"
KINDS = ("I", "II")
TOOLKITS: Mapping[Any, type[Vise]] = {toolkit.kind: toolkit for toolkit in (Vise, OpeningVise)}


@frozen(eq=False)
class Listing:
    """A result as it is written.

    Parameters
    ----------
    workpiece, vise, contact_margin : what was asked.
    fixtures : as listed.
    counts, found, distinct : numbers of fixtures by type, as written.
    faults : contradictions in the head of the file, one sentence each.
    asked : what was asked for beyond fixtures.
    """

    workpiece: Workpiece
    vise: Vise
    contact_margin: float
    fixtures: Sequence[Fixture]
    counts: Mapping[str, int]
    found: Mapping[str, int]
    distinct: Mapping[str, int]
    faults: tuple[str, ...] = ()
    asked: Asked = field(factory=Asked)


class UnusableError(Exception):
    """A value of the wrong kind; the message goes behind the place."""


@frozen
class Unusable:
    """Stands for a fixture or a part of one that cannot be used."""

    reason: str


def listing_of(result: Result) -> Listing:
    """What a result claims that is not in a file."""
    return Listing(
        result.workpiece,
        result.vise,
        result.query.contact_margin,
        list(result),
        result.counts,
        result.found,
        result.distinct,
        asked=asked_of(result),
    )


def read_listing(path: str | Path) -> Listing:
    """Read what a result file claims.

    Raises
    ------
    InputError
        When the file cannot be read, is no result file, or describes no usable workpiece or vise.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not a result file: it is not text.") from error
    try:
        data = json.loads(text, object_hook=compact, parse_constant=refuse_constant)
        return checked(data)
    except (ValueError, UnusableError) as error:
        # An InputError about workpiece or vise is a ValueError, too.
        raise InputError(f"{path} cannot be verified: {str(error).rstrip('.')}.") from error
    except RecursionError as error:
        raise InputError(f"{path} is not a result file: its brackets are nested too deeply.") from error


def refuse_constant(name: str) -> NoReturn:
    """Refuse a constant that JSON does not have."""
    raise ValueError(f"{name} is not a number")


def compact(item: dict[str, Any]) -> Any:
    """A JSON object as a peg, a pose or a fixture when it has the keys of one, otherwise as it is."""
    try:
        if "jaw" in item:
            if item["jaw"] not in ("left", "right"):
                raise UnusableError(f"a peg's jaw is {item['jaw']!r}, not 'left' or 'right'")
            column, row, segment = (whole(item, key) for key in ("column", "row", "segment"))
            return Peg(item["jaw"], column, row, real(item, "x"), real(item, "y"), segment, real(item, "force"))
        if "theta_deg" in item:
            return Pose(real(item, "theta_deg"), real(item, "x"), real(item, "y"))
        if "pegs" in item:
            return fixture_from(item)
    except UnusableError as error:
        return Unusable(str(error))
    return item


def fixture_from(item: dict[str, Any]) -> Fixture:
    """A fixture from its JSON object, whose pegs and pose are objects already.

    Raises
    ------
    UnusableError
        Saying what is missing.
    """
    kind, pegs, pose = item.get("type"), item["pegs"], item.get("pose")
    if kind not in KINDS:
        raise UnusableError(f"its type is {kind!r}, not 'I' or 'II'")
    for part in (*(pegs if isinstance(pegs, list) else ()), pose):
        if isinstance(part, Unusable):
            raise UnusableError(part.reason)
    if not isinstance(pegs, list) or len(pegs) != 4 or not all(isinstance(peg, Peg) for peg in pegs):
        raise UnusableError("it does not have four pegs")
    if not isinstance(pose, Pose):
        raise UnusableError("it has no pose")
    quality = item.get("quality", {})
    if not isinstance(quality, dict):
        raise UnusableError("its quality is no object")
    figures = {figure.key: real(quality, figure.key) for figure in FIGURES if figure.key in quality}
    return Fixture(kind, (pegs[0], pegs[1], pegs[2], pegs[3]), pose, real(item, "jaw_separation"), figures)


def real(item: Mapping[str, Any], key: str) -> float:
    """A finite number of a JSON object.

    Raises
    ------
    UnusableError
        When it is missing or no number.
    """
    value: Any = item.get(key)
    if type(value) not in (int, float) or abs(value) > 1e300 or not isfinite(value):
        raise UnusableError(f"{key} is {value!r}, not a number" if key in item else f"the key {key} is missing")
    return float(value)


def whole(item: Mapping[str, Any], key: str) -> int:
    """A whole number of a JSON object.

    Raises
    ------
    UnusableError
        When it is missing or no whole number of a sensible size.
    """
    value = item.get(key)
    if type(value) is not int or abs(value) > 2**31:
        raise UnusableError(f"{key} is {value!r}, not a whole number" if key in item else f"the key {key} is missing")
    return value


def optional(read: Any, item: Mapping[str, Any], key: str) -> Any:
    """A number that may be missing or null."""
    return None if item.get(key) is None else read(item, key)


def part_of(data: Mapping[str, Any], key: str, kind: type) -> Any:
    """An object or a list within a JSON object.

    Raises
    ------
    UnusableError
        When it is missing or something else.
    """
    value = data.get(key)
    if not isinstance(value, kind):
        raise UnusableError(f"the key {key} is missing or cannot be used")
    return value


def checked(data: Any) -> Listing:
    """The listing from the JSON of a file.

    Raises
    ------
    UnusableError, InputError
        When something is missing or cannot be used.
    """
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise UnusableError(f"it is not a result file of the form {FORMAT}")
    part = part_of(data, "workpiece", dict)
    loops = part_of(part, "loops", list)
    if part.get("units") != "mm":
        raise UnusableError("the workpiece's units are not mm")
    workpiece = Workpiece.from_loops(str(part.get("name", "workpiece")), loops)
    vise = vise_from(part_of(data, "toolkit" if "toolkit" in data else "vise", dict))
    margin = optional(real, data, "contact_margin") or 0.0
    if margin < 0:
        raise UnusableError("contact_margin is negative")
    counts = counts_from(data, "counts", None)
    return Listing(
        workpiece,
        vise,
        margin,
        fixtures_from(data, "fixtures"),
        counts,
        counts_from(data, "found", counts),
        counts_from(data, "distinct", counts),
        turned_loops(loops, workpiece),
        asked_in(data),
    )


def turned_loops(loops: Sequence[Any], workpiece: Workpiece) -> tuple[str, ...]:
    """A fault for every loop that does not run with the material on its left, which makes its numbers ambiguous."""
    return tuple(
        f"loop {index} does not have the material on its left"
        for index, (written, used) in enumerate(zip(loops, workpiece.loops, strict=True))
        if [list(map(float, vertex)) for vertex in written] != used.tolist()
    )


def vise_from(jaws: Mapping[str, Any]) -> Vise:
    """The vise from its JSON object, that of a closing one where it names no kind.

    Raises
    ------
    UnusableError, InputError
        When a number is missing or cannot be used.
    """
    kind = jaws.get("kind", Vise.kind)
    if not isinstance(kind, str) or kind not in TOOLKITS:
        raise UnusableError(f"the toolkit's kind is {kind!r}, which cannot be verified")
    pitch = part_of(jaws, "pitch", list)
    if len(pitch) != 2:
        raise UnusableError("the vise's pitch is not a pair of lengths")
    pitch_x, pitch_y = (real({"pitch": value}, "pitch") for value in pitch)
    return TOOLKITS[kind](
        pitch=(pitch_x, pitch_y),
        columns=whole(jaws, "columns"),
        peg_radius=real(jaws, "peg_radius"),
        rows=optional(whole, jaws, "rows"),
        min_gap=optional(real, jaws, "min_gap"),
        max_opening=optional(real, jaws, "max_opening"),
        row_offset=optional(real, jaws, "row_offset") or 0.0,
        body_radius=optional(real, jaws, "body_radius"),
        blocked=tuple(holes_named(str(name)) for name in jaws.get("blocked") or ()),
    )


def counts_from(data: Mapping[str, Any], key: str, default: Mapping[str, int] | None) -> Mapping[str, int]:
    """Numbers of fixtures by type.

    Raises
    ------
    UnusableError
        When they are missing or no whole numbers.
    """
    if data.get(key) is None and default is not None:
        return default
    counts = part_of(data, key, dict)
    return {kind: whole(counts, kind) for kind in KINDS}


def fixtures_from(data: Mapping[str, Any], key: str) -> list[Fixture]:
    """A list of fixtures.

    Raises
    ------
    UnusableError
        Naming the first one that cannot be used, counted from 1.
    """
    fixtures: list[Any] = part_of(data, key, list)
    for position, fixture in enumerate(fixtures, 1):
        if not isinstance(fixture, Fixture):
            reason = fixture.reason if isinstance(fixture, Unusable) else "it is no fixture"
            raise UnusableError(f"number {position} in {key}: {reason}")
    return fixtures
