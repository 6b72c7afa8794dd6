"""Reading supports back: the form ``workhold-supports/1``, from workhold or any program that writes it."""

from __future__ import annotations

from pathlib import Path

from workhold.errors import InputError
from workhold.files.result.parts import checked_head
from workhold.files.result.reader import checked_table, collected, measured
from workhold.files.supports.forms import ClampFiguresPart, SupportsPart, TriplePart, read_supports_part
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.support_triples import ClampFigures, SupportPad, Supports, Triple

__all__ = ["query_of", "read_supports"]


def query_of(part: SupportsPart, path: Path) -> Query:
    """The part and the toolkit of a file of supports.

    Raises
    ------
    InputError
        When they cannot be used.
    """
    try:
        return checked_head(part.head(), path).query()
    except InputError as error:
        raise InputError(str(error) if str(error).startswith(str(path)) else f"{path}: {error}") from error


def read_supports(path: str | Path) -> Supports:
    """Reads a file of supports.

    Raises
    ------
    InputError
        When it cannot be read, or contradicts itself.

    Examples
    --------
    >>> read_supports("no-such-file.json")
    Traceback (most recent call last):
    workhold.errors.InputError: no-such-file.json is not a file of supports: there is no file of that name.
    """
    path = Path(path)
    part = read_supports_part(path)
    query = query_of(part, path)
    table = measured(checked_table(collected([part.fixture], path), query, path), query)
    counts = query.toolkit.arrangements_counted(table.arrangement)
    fixture = Result(query, table, found=counts, distinct=counts)[0]
    try:
        request = part.request()
        loads = tuple(load.load(request.thickness) for load in part.loads)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return Supports(
        query,
        fixture,
        request,
        loads,
        part.jaw_force,
        part.counts.positions,
        part.counts.triples,
        tuple(triple_of(one, fixture, query, request.point, path) for one in part.triples),
    )


def triple_of(
    part: TriplePart, fixture: Fixture, query: Query, point: tuple[float, float] | None, path: Path
) -> Triple:
    """A triple of a file.

    Raises
    ------
    InputError
        When a hole is on no plate of the toolkit.
    """
    plates = {plate.name: plate for plate in query.toolkit.plates}
    supports = []
    for name, column, row in part.holes:
        if name not in plates:
            raise InputError(f"{path}: a support stands on {name!r}: give {' or '.join(plates)}.")
        place = plates[name].place(column, row, fixture.jaw_separation)
        x, y = fixture.pose.inverse.apply(*place)
        supports.append(SupportPad(name, column, row, float(x), float(y)))
    return Triple(
        supports=tuple(supports),
        travel=part.jaw_separation,
        marginal=part.marginal,
        standing=part.standing,
        overhang=part.overhang,
        arm=part.arm,
        arm_at=(part.arm_at[0], part.arm_at[1]),
        best=clamp_of(part.best, None),
        given=None if part.given is None else clamp_of(part.given, point),
    )


def clamp_of(part: ClampFiguresPart, point: tuple[float, float] | None) -> ClampFigures:
    """The figures at one point of the clamp."""
    x, y = part.at if part.at is not None else point or (0.0, 0.0)
    return ClampFigures((x, y), part.clamp_needed, part.support_force, part.arm, part.share, part.lift)
