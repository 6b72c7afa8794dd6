"""The task of workers that finds supports under a fixture and a clamp on top, and its answer.

Glossary
--------
set : three supports with the clamp over them.
box : the extents of a body in mm in the toolkit's frame, to draw it from the front and from the right.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from attrs import evolve, frozen

from workhold.errors import InputError
from workhold.geometry.segment import compute_bounding_box
from workhold.model.bodies import BodySizes
from workhold.model.fixture import Fixture
from workhold.model.moved_setup import find_move_to_middle, move_fixture_by_holes
from workhold.model.query import Query
from workhold.model.requirements import make_zone
from workhold.model.support_bodies import list_bodies_on_supports, size_supported_bodies
from workhold.model.support_triples import ChosenSupports, Supports, Triple, recount_holes
from workhold.units import find_unit
from workhold.web.request_forms import OF_HARDWARE, SupportsForm
from workhold.web.worker import TaskContext

__all__ = ["SupportsOrder", "choose_supports", "find_supports"]

# What keeps pads and the clamp off places, as the page calls it.
KEEP_OFF = ('"Keep pads off"', '"Keep the clamp off"')
# What of a form a request has by the same names.
OWN = ("band", "point", *(row.name for row in OF_HARDWARE))


@frozen(eq=False)
class SupportsOrder:
    """An order to find supports under a fixture.

    Parameters
    ----------
    fixture : the planar fixture.
    query : part and toolkit of the fixture, with the loads of its search.
    form : the request.
    """

    fixture: Fixture
    query: Query
    form: SupportsForm


def find_supports(payload: SupportsOrder, order: TaskContext) -> dict[str, Any]:
    """Return the best sets of three supports as plain data, with the boxes to draw from the front and the
    right.
    """
    return describe_supports(find_asked_supports(payload), payload.form.unit)


def find_asked_supports(asked: SupportsOrder) -> Supports:
    """Return the supports under a fixture that an order asks for."""
    from workhold.supports.asking import make_request
    from workhold.supports.listing import find_supports

    form = asked.form
    own = {name: getattr(form, name) for name in OWN if getattr(form, name) is not None}
    zones = {
        name: [make_zone(loop) for loop in getattr(form, name)] for name in ("bottom_zones", "top_zones")
    }
    request = make_request(asked.query, form.thickness, own | zones)
    loads = None if form.loads is None else [load.to_load() for load in form.loads]
    return find_supports(asked.fixture, asked.query, request, loads, form.jaw_force, form.best)


def choose_supports(asked: SupportsOrder, number: int) -> ChosenSupports | None:
    """Return the set with this number, from 1, among the best supports found; None where no set holds the
    part.

    Raises InputError for a number without a set.
    """
    found = find_asked_supports(asked)
    return ChosenSupports.from_supports(found, number) if found.triples else None


def describe_supports(found: Supports, unit: str) -> dict[str, Any]:
    """Return the best sets as plain data; places are in mm in the toolkit's frame.

    ``positions`` is the number of holes that may hold a support, ``count`` the number of sets, None if not
    all were examined. ``bands`` are the heights at which each peg may press. ``notes`` are sentences with
    lengths in ``unit``.
    """
    request, listed = found.request, found.triples
    sizes = size_supported_bodies(found)
    return {
        "thickness": request.thickness,
        "peg_height": sizes.top,
        "pad_radius": request.pad_radius,
        "tip_radius": request.tip_radius,
        "jaw_force": found.jaw_force if found.loads else None,
        "with_loads": bool(found.loads),
        "positions": found.positions,
        "count": found.count,
        "bands": request.list_peg_bands(len(found.fixture.pegs)).tolist(),
        "sets": [describe_set(found, triple) for triple in listed],
        "boxes": [list(list_boxes(found, triple, sizes)) for triple in listed],
        "notes": list_support_notes(found, unit),
    }


def describe_set(found: Supports, triple: Triple) -> dict[str, Any]:
    """Return one set of three as plain data; forces are None without loads.

    ``travel`` is the jaw opening that the set needs if it is more than the fixture alone needs, else None.
    ``nearest`` is the point of the triangle's border that is nearest to the clamp. ``built`` has the holes of
    pegs and supports in plates with enough holes, as on the sheet; None if these are the holes shown.
    """
    fixture, clamp, loaded = found.fixture, triple.clamp, bool(found.loads)
    corners = np.array([(pad.x, pad.y) for pad in triple.supports])
    moves = triple.travel is not None and abs(triple.travel - fixture.travel) > 1e-6

    def map_to_toolkit(x: float, y: float) -> list[float]:
        """Return a point of the part in the toolkit's frame."""
        return [float(value) for value in fixture.pose.apply(x, y)]

    return {
        "holes": list_standing_holes(found, triple)[1],
        "carriers": found.query.toolkit.find_carrier_numbers(pad.carrier for pad in triple.supports),
        "pads": [map_to_toolkit(pad.x, pad.y) for pad in triple.supports],
        "at": map_to_toolkit(*clamp.at),
        "clamped_height": found.request.find_clamped_height(clamp.at),
        "at_part": list(clamp.at),
        "nearest": map_to_toolkit(*find_nearest_on_border(corners, np.array(clamp.at))),
        "clamp_force": clamp.clamp_needed if loaded else None,
        "support_force": clamp.support_force if loaded else None,
        "arm": clamp.arm,
        "standing": triple.standing,
        "stands": triple.stands,
        "overhang": triple.overhang,
        "travel": triple.travel if moves else None,
        "marginal": triple.marginal,
        "built": describe_built_holes(found, triple),
    }


def list_standing_holes(found: Supports, triple: Triple) -> tuple[list[str], list[str]]:
    """Return (names of the pegs' holes, names of the supports' holes) as the page shows them.

    The set-up stands in the middle of the plate.
    """
    query = found.query
    move = find_move_to_middle(found.fixture, query.toolkit, query.workpiece)
    pegs = [peg.hole for peg in move_fixture_by_holes(found.fixture, query.toolkit, move).pegs]
    pads = [evolve(pad, column=pad.column + move[0], row=pad.row + move[1]) for pad in triple.supports]
    return pegs, [pad.hole for pad in pads]


def describe_built_holes(found: Supports, triple: Triple) -> dict[str, list[str]] | None:
    """Return the holes in which a set is built.

    Returns None if they are those on the page, or if the supports do not fit into the plate's holes.
    """
    query = found.query
    start = find_move_to_middle(found.fixture, query.toolkit, query.workpiece)
    try:
        anew = recount_holes(found.fixture, query.toolkit, triple, start)
    except InputError:
        return None
    pegs = [peg.hole for peg in anew.fixture.pegs]
    pads = [pad.hole for pad in anew.supports]
    if (pegs, pads) == list_standing_holes(found, triple):
        return None
    return {"pegs": pegs, "supports": pads}


def find_nearest_on_border(corners: np.ndarray, point: np.ndarray) -> tuple[float, float]:
    """Return the point of the border of a triangle with corners (3, 2) that is nearest to a point (2,)."""
    starts, ways = corners, np.roll(corners, -1, axis=0) - corners
    shares = ((point - starts) * ways).sum(axis=1) / (ways**2).sum(axis=1)
    feet = starts + np.clip(shares, 0.0, 1.0)[:, None] * ways
    x, y = feet[np.argmin(np.hypot(*(feet - point).T))]
    return float(x), float(y)


def list_support_notes(found: Supports, unit: str) -> list[str]:
    """Return sentences on the sets listed, or why there is none, with lengths in a unit."""
    from workhold.supports.words import explain_no_set, write_listing_notes

    given, listed = find_unit(unit), found.triples
    reasons = [] if listed else [explain_no_set(found, given)]
    return reasons + write_listing_notes(found, listed, given, KEEP_OFF)


def list_boxes(found: Supports, triple: Triple, sizes: BodySizes) -> Iterator[dict[str, Any]]:
    """Yield the box of each slab of each body of a fixture on a set of supports.

    Yields nothing for pegs of radius 0, which have no body.
    """
    try:
        bodies = list_bodies_on_supports(found, triple, found.fixture, triple.supports, sizes)
    except InputError:
        return
    for body in bodies:
        for slab in body.slabs:
            sides = np.array([compute_bounding_box(segment) for segment in slab.outer])
            x0, y0 = sides[:, :2].min(axis=0).tolist()
            x1, y1 = sides[:, 2:].max(axis=0).tolist()
            yield {
                "name": body.name,
                "kind": str(body.kind),
                "x": [x0, x1],
                "y": [y0, y1],
                "z": [slab.low, slab.high],
            }
