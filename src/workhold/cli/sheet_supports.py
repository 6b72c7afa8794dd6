"""What a setup sheet says in space: supports under the part, and the set-up of its other side before."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.first_side import FirstSide
    from workhold.model.recounted import ChosenSupports
    from workhold.model.requirements import Load
    from workhold.model.result import Result
    from workhold.model.support_request import SupportRequest

__all__ = ["chosen_of_file", "chosen_supports", "first_side_of", "is_of_supports", "supports_under"]


def is_of_supports(path: str) -> bool:
    """Whether a file is one that ``workhold supports`` wrote."""
    from workhold.verification.supports import is_supports_file

    return is_supports_file(path)


def chosen_of_file(
    path: str, number: int, settings: dict[str, Any], loads: Sequence[Load] | None
) -> ChosenSupports:
    """The set of three of a number in a file of supports.

    Raises
    ------
    InputError
        For a file that cannot be used, a number that there is none of, and what the file has decided already.
    """
    from workhold.files.supports.reader import read_supports
    from workhold.model.recounted import ChosenSupports

    for name, key in (("--thickness", "thickness"), ("--jaw-force", "jaw_force")):
        if settings[key] is not None:
            raise InputError(f"{path} says what {name} would: leave it out, or list the supports anew.")
    if loads:
        raise InputError(f"{path} has the loads that its supports are for: leave --load out.")
    return ChosenSupports.of(read_supports(path), number)


def supports_under(
    result: Result,
    rank: int,
    request: SupportRequest,
    loads: Sequence[Load] | None,
    jaw_force: float | None,
) -> ChosenSupports | None:
    """The best three supports of some sizes under a fixture; None where no three hold the part.

    A jaw force under which a load would lift the part off a peg is left out: the sheet warns of it anyway.

    Raises
    ------
    InputError
        For more holes than can be looked at.
    """
    from workhold.model.recounted import ChosenSupports
    from workhold.supports.acting import WeakJawError
    from workhold.supports.listing import supports_of

    try:
        found = supports_of(result[rank - 1], result.query, request, loads, jaw_force, best=1)
    except WeakJawError:
        found = supports_of(result[rank - 1], result.query, request, loads, best=1)
    return ChosenSupports.of(found) if found.triples else None


def chosen_supports(
    result: Result,
    rank: int,
    thickness: float | None,
    loads: Sequence[Load] | None,
    jaw_force: float | None,
) -> ChosenSupports:
    """The best three supports under a fixture, of the usual sizes or else of smaller ones.

    Raises
    ------
    InputError
        Where there are none, and where nobody knows how thick the part is.
    """
    from workhold.supports.sizes import requests_by_size

    if thickness is None and result.workpiece.solid is None:
        raise InputError("how thick the part is, is not known: give --thickness.")
    for request in requests_by_size(result.workpiece, thickness, result.toolkit):
        chosen = supports_under(result, rank, request, loads, jaw_force)
        if chosen is not None:
            return chosen
    raise InputError(
        f"under fixture {rank} no three supports hold the part: see workhold supports with its --pad-radius, "
        "--tip-radius and --out, or leave --supports out."
    )


def first_side_of(result: Result, rank: int, before: str) -> FirstSide:
    """What a fixture shares with the best fixture of another result, whose part had another side up.

    Raises
    ------
    InputError
        For a file that cannot be used, and parts that are not of one solid.
    """
    from workhold.files.result.reader import read_result
    from workhold.model.first_side import first_side

    other = read_result(before)
    return first_side(result[rank - 1], result.query, other.query, other[0] if len(other) else None)
