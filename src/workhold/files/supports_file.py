"""Files of supports, ``workhold-supports/1``: read from any program, written whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from attrs import asdict

from workhold.errors import InputError
from workhold.files.atomic import write_text_file
from workhold.files.replacing import refuse_other_ending, refuse_output
from workhold.files.result.fixture_text import write_fixture_lines
from workhold.files.result.parts import check_head
from workhold.files.result.reader import add_missing_figures, check_table, collect_columns
from workhold.files.result.writer import (
    make_own_outlines_entry,
    make_solid_entry,
    make_toolkit_entry,
    make_workpiece_entry,
)
from workhold.files.supports_forms import (
    FORMAT,
    ReadFigures,
    ReadTriple,
    SupportsPart,
    read_supports_part,
)
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.requirements import Zone
from workhold.model.result import Result
from workhold.model.support_request import Loops, SupportRequest, compute_usual_head
from workhold.model.support_triples import ClampFigures, SupportPad, Supports, Triple

__all__ = ["make_query", "read_supports", "make_supports_entry", "write_supports"]


def make_query(part: SupportsPart, path: Path) -> Query:
    """Return the query of a file of supports; ``path`` is for
    messages. Raise InputError for an unusable part or toolkit.
    """
    try:
        return check_head(part.to_head(), path).to_query()
    except InputError as error:
        raise InputError(str(error) if str(error).startswith(str(path)) else f"{path}: {error}") from error


def read_supports(path: str | Path) -> Supports:
    """Return the supports in a file.

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
    query = make_query(part, path)
    table = add_missing_figures(check_table(collect_columns([part.fixture], path), query, path), query)
    counts = query.toolkit.count_arrangements(table.arrangement)
    fixture = Result(query, table, found=counts, distinct=counts)[0]
    try:
        request = part.to_request()
        loads = tuple(load.to_load(request.thickness) for load in part.loads)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    pads: dict[tuple[str, int, int], SupportPad] = {}
    triples = []
    # What is made of a triple takes its place in memory.
    part.triples.reverse()
    while part.triples:
        one = part.triples.pop()
        for hole in one.holes:
            if hole not in pads:
                pads[hole] = make_support_pad(hole, fixture, query, path)
        triples.append(make_triple(one, tuple(pads[hole] for hole in one.holes), request.point))
    return Supports(
        query,
        fixture,
        request,
        loads,
        part.jaw_force,
        part.counts.positions,
        part.counts.triples,
        tuple(triples),
    )


def make_support_pad(hole: tuple[str, int, int], fixture: Fixture, query: Query, path: Path) -> SupportPad:
    """Return the support in a hole (carrier, column, row), with its place in the part's frame.

    Raises InputError for a carrier that is not a plate of the toolkit; ``path`` is for the message.
    """
    name, column, row = hole
    plates = {plate.name: plate for plate in query.toolkit.plates}
    if name not in plates:
        raise InputError(f"{path}: a support stands on {name!r}: give {' or '.join(plates)}.")
    x, y = fixture.pose.inverse.apply(*plates[name].compute_hole_center(column, row, fixture.travel))
    return SupportPad(name, column, row, float(x), float(y))


def make_triple(
    part: ReadTriple, supports: tuple[SupportPad, ...], point: tuple[float, float] | None
) -> Triple:
    """Return a triple as an object of the model, from a file's form and its three supports.

    ``point`` is the clamp's point that was asked for, to which the figures ``given`` belong; None if none
    was.
    """
    return Triple(
        supports=supports,
        travel=part.jaw_separation,
        marginal=part.marginal,
        standing=part.standing,
        overhang=part.overhang,
        arm=part.arm,
        arm_at=part.arm_at,
        best=make_clamp_figures(part.best, None),
        given=None if part.given is None else make_clamp_figures(part.given, point),
    )


def make_clamp_figures(part: ReadFigures, point: tuple[float, float] | None) -> ClampFigures:
    """Return the forces and lengths at one point of the clamp, from the file's form.

    The point is the one in the form; without it ``point``, and without both (0, 0).
    """
    at = part.at or point or (0.0, 0.0)
    forces = part.clamp_needed, part.support_force
    return ClampFigures(at, *forces, part.arm, part.share, part.lift, part.hangs)


def write_supports(supports: Supports, path: str | Path, *, overwrite: bool = False) -> None:
    """Write a file of supports, a line for each triple.

    Parameters
    ----------
    overwrite : whether a file that workhold has not written may be replaced.

    Raises
    ------
    InputError
        When the fixture is not one of a result, or the file cannot be written or replaced.
    """
    refuse_other_ending(path, [".json"], "a file of supports")
    refuse_output(path, force=overwrite)
    entry = make_supports_entry(supports)
    triples = entry.pop("triples")
    lines = [f"{json.dumps(key)}: {json.dumps(value)},\n" for key, value in entry.items()]
    with write_text_file(path) as stream:
        stream.write("{" + "".join(lines) + '"triples": [')
        stream.write(",".join(f"\n{json.dumps(triple)}" for triple in triples) + "\n]}\n")


def make_supports_entry(supports: Supports) -> dict[str, Any]:
    """Return the supports as the file's JSON object; raise
    InputError for a fixture that is not one of a result.
    """
    query, request = supports.query, supports.request
    band = (0.0, request.thickness) if request.band is None else request.band
    return {
        "format": FORMAT,
        **make_solid_entry(query.workpiece.solid),
        "workpiece": make_workpiece_entry(query.workpiece),
        **make_own_outlines_entry(query.workpiece),
        **make_toolkit_entry(query.toolkit),
        "fixture": make_fixture_entry(supports),
        "heights": {"thickness": request.thickness, "band": list(band)},
        "supports": {
            "pad_radius": request.pad_radius,
            "pad_margin": request.pad_margin,
            "bottom": make_loops_entry(request.bottom),
            "zones": [make_zone_entry(zone) for zone in request.bottom_zones],
        },
        "clamp": {
            "tip_radius": request.tip_radius,
            "inside": request.inside,
            **make_tip_surroundings_entry(request),
            "top": make_loops_entry(request.top),
            **({} if request.top_heights is None else {"top_heights": list(request.top_heights)}),
            "zones": [make_zone_entry(zone) for zone in request.top_zones],
            "reach": None if request.reach is None else [list(ring) for ring in request.reach],
            "point": None if request.point is None else list(request.point),
        },
        "loads": [asdict(load) for load in supports.loads],
        "jaw_force": supports.jaw_force,
        "complete": supports.complete,
        "counts": {"positions": supports.positions, "triples": supports.count},
        "triples": [make_triple_entry(triple) for triple in supports.triples],
    }


def make_tip_surroundings_entry(request: SupportRequest) -> dict[str, Any]:
    """Return the entries of a request's tip margin and head radius, where these
    are unusual, and of the regions beside the faces.

    The regions are those that rise above the upper faces, and the hanging parts of these faces, each with the
    height of its face.
    """
    entry: dict[str, Any] = {}
    if request.tip_margin != 0.0:
        entry["tip_margin"] = request.tip_margin
    if request.head_radius != compute_usual_head(request.tip_radius):
        entry["head_radius"] = request.head_radius
    for name in ("rising", "hanging"):
        if loops := getattr(request, name):
            entry |= {
                name: make_loops_entry(loops),
                f"{name}_heights": list(getattr(request, f"{name}_heights")),
            }
    return entry


def make_fixture_entry(supports: Supports) -> dict[str, Any]:
    """Return the JSON object of the planar fixture, as in a result file, with
    the heights at which its pegs may press added.
    """
    listing = supports.fixture.listing
    table = listing.result.table.take(slice(listing.row, listing.row + 1))
    ((line,),) = write_fixture_lines(table, supports.query.toolkit, supports.query.workpiece)
    entry: dict[str, Any] = json.loads(line)
    bands = supports.request.bands
    if bands is not None:
        fixture = supports.fixture
        of_pegs = list(zip(fixture.pegs, bands, strict=True))
        placed = [band for peg, band in of_pegs if peg in fixture.placed]
        walls = [band for peg, band in of_pegs if peg not in fixture.placed]
        for peg, band in zip(entry["pegs"], placed, strict=True):
            if band is not None:
                peg["band"] = list(band)
        if any(walls):
            entry["wall"]["bands"] = [None if band is None else list(band) for band in walls]
    return entry


def make_loops_entry(loops: Loops | None) -> Any:
    """Return the loops of a face as nested lists; None for None, and [[]] for an empty sequence.

    An empty list could be read as a face without limits.
    """
    return None if loops is None else [(loop + 0.0).tolist() for loop in loops] or [[]]


def make_zone_entry(zone: Zone) -> dict[str, Any]:
    """Return the JSON object of a zone: a circle or a polygon if the
    zone is one, otherwise a loop with arcs.
    """
    loop = np.asarray(zone.loop)
    if len(loop) == 2 and (loop[:, 2] == 1.0).all():
        (x0, y0), (x1, y1) = loop[:, :2].tolist()
        return {"circle": [(x0 + x1) / 2, (y0 + y1) / 2, float(np.hypot(x1 - x0, y1 - y0)) / 2]}
    if (loop[:, 2] == 0.0).all():
        return {"polygon": loop[:, :2].tolist()}
    return {"loop": loop.tolist()}


def make_triple_entry(triple: Triple) -> dict[str, Any]:
    """Return a triple as the file's JSON object; lengths are in mm, forces in N."""
    given = None if triple.given is None else drop_unknown_figures(triple.given)
    if given is not None:
        # It is at the point that the request names.
        del given["at"]
    return {
        "holes": [[one.carrier, one.column, one.row] for one in triple.supports],
        "jaw_separation": triple.travel,
        "marginal": triple.marginal,
        "standing": triple.standing,
        "overhang": triple.overhang,
        "arm": triple.arm,
        "arm_at": list(triple.arm_at),
        "best": drop_unknown_figures(triple.best),
        "given": given,
    }


def drop_unknown_figures(figures: ClampFigures) -> dict[str, Any]:
    """Return the fields of some figures by name, without those that are None or False."""
    return asdict(figures, filter=lambda _, value: value is not None and value is not False)
