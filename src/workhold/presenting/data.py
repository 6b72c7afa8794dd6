"""Fixtures and results as plain data for JSON, and all fixtures of a result as a table of pandas or Arrow.

Lengths are in mm, angles in degrees, forces in N. A number that JSON does not have, such as an infinite
force, is None. The page has separate answers (``web.answers``), which also have coordinates for drawing. A
table has the columns of the CSV form and a row for each fixture; only tables need pandas and Arrow, which are
imported then.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from importlib import import_module
from math import acos, ceil, cos, degrees, inf, isfinite, pi, sin
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import asdict, fields
from attrs.filters import exclude

from workhold.errors import InputError
from workhold.files.result.fixture_text import (
    list_bending_columns,
    list_bending_values,
    list_column_names,
    list_fixture_rows,
    list_seating_values,
)
from workhold.files.result.hold_text import make_hold_entry
from workhold.files.result.writer import (
    convert_to_json_value,
    make_load_entry,
    make_proof_entry,
    make_toolkit_fields,
)
from workhold.fixels.carrier import Carrier
from workhold.fixels.contacts import FLAT_PIN
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.loop import Face
from workhold.geometry.segment import Arc, Point, Segment
from workhold.limits import convert_real
from workhold.model.clamps import describe_tightening_order
from workhold.model.fixture import Fixture
from workhold.model.quality import SEATING_FIGURES
from workhold.model.search_report import Explanation, ProofReport
from workhold.model.setup import list_length_settings
from workhold.model.solid import SolidOutline
from workhold.model.straps import StrappedHold
from workhold.model.workpiece import Workpiece
from workhold.seating.clamping import plan_hand_loading
from workhold.statics.why_first import explain_why_first

if TYPE_CHECKING:
    import pyarrow
    from pandas import DataFrame

    from workhold.files.toolkit_file import LoadedToolkit
    from workhold.listing.identity import ShownEntries
    from workhold.model.result import Result
    from workhold.search.design import ToolkitOutcome
    from workhold.statics.loads import LoadCase, WorstLoad
    from workhold.verification import Verification

__all__ = [
    "describe_explanation",
    "describe_explored",
    "convert_finite",
    "describe_fixture",
    "describe_helps",
    "describe_load_case",
    "describe_part",
    "describe_result",
    "describe_solid",
    "to_arrow",
    "to_pandas",
    "to_shapely",
    "describe_toolkit",
    "describe_verification",
]


def convert_finite(value: float) -> float | None:
    """Return a number unchanged, or None for inf and NaN, which JSON does not have."""
    return float(value) if isfinite(value) else None


def describe_part(workpiece: Workpiece, remarks: Sequence[str] = ()) -> dict[str, Any]:
    """Return a part and its faces as plain data.

    ``remarks`` are sentences on how its file was read.
    """
    first, loop_of = 0, {}
    for index, loop in enumerate(workpiece.loops):
        loop_of.update(dict.fromkeys(range(first, first + len(loop)), index))
        first += len(loop)
    return {
        "name": workpiece.name,
        "bounds": list(workpiece.bounds),
        "departure": workpiece.departure,
        "holes": len(workpiece.hole_segments),
        "faces": [
            {"number": face.number, "loop": loop_of[face.number], **describe_face(face)}
            for face in workpiece.faces
        ],
        "remarks": list(remarks),
        **describe_solid(workpiece.solid),
    }


def describe_solid(solid: SolidOutline | None) -> dict[str, Any]:
    """Return {"solid": ...} for a part read from a solid: its position and the heights at each segment;
    otherwise {}.
    """
    return {} if solid is None else {"solid": asdict(solid, filter=exclude(fields(SolidOutline).low))}


def describe_face(face: Face) -> dict[str, Any]:
    """Return a face as plain data: a line or an arc, lengths in mm, the arc's sweep in degrees."""
    segment = face.segment
    ends = {"from": list(segment.start), "to": list(segment.end)}
    if not isinstance(segment, Arc):
        return {"kind": "line", "length": segment.length, **ends}
    sweep = degrees(min(2 * segment.half_sweep, 2 * pi))
    circle = {"radius": segment.radius, "center": list(segment.center), "sweep_deg": sweep}
    return {"kind": "arc", "concave": segment.sign < 0, **circle, **ends}


def describe_fixture(fixture: Fixture, toolkit: Toolkit, rank: int | None = None) -> dict[str, Any]:
    """Return a fixture as plain data.

    ``rank`` is from 1; with None the data has no rank.
    """
    return {
        **({} if rank is None else {"rank": rank}),
        "type": fixture.type,
        "direction": fixture.direction,
        "pegs": [
            {
                "hole": peg.hole,
                "carrier": peg.carrier,
                "stands_on": name_carrier(toolkit.find_carrier(peg.carrier)),
                "column": peg.column,
                "row": peg.row,
                "x": peg.x,
                "y": peg.y,
                "faces": [peg.face] if peg.beside is None else [peg.face, peg.beside],
                "force": convert_finite(peg.force),
            }
            for peg in fixture.pegs
        ],
        "pose": {"theta_deg": fixture.pose.theta_deg, "x": fixture.pose.x, "y": fixture.pose.y},
        "settings": [
            {"name": one.name, "sign": one.sign, "length": one.length}
            for one in list_length_settings(fixture, toolkit)
        ],
        **describe_pair(fixture),
        "quality": {key: convert_finite(value) for key, value in fixture.quality.items()},
        **({} if fixture.hold is None else describe_hold(fixture)),
        **({} if fixture.seating is None else {"seating": fixture.seating.to_fields()}),
        **({} if fixture.bent is None else {"bending": fixture.bent.to_data()}),
        **describe_by_hand(fixture, rank),
    }


def describe_hold(fixture: Fixture) -> dict[str, Any]:
    """Return how flat jaws or straps hold a part as plain data, with the keys of a result file."""
    entry = make_hold_entry(fixture)
    if isinstance(fixture.hold, StrappedHold):
        kept = ("straps", "supports", "push", "places", "looked_at", "program_force", "quality")
        return {name: entry[name] for name in kept if name in entry}
    names = (
        "parallels",
        "parallel_offsets",
        "stop",
        "fixed",
        "moving",
        "jaw_separation",
        "warnings",
        "program_force",
    )
    return {"pegs": [], **{name: entry[name] for name in names if name in entry}, "quality": entry["quality"]}


def describe_pair(fixture: Fixture) -> dict[str, Any]:
    """Return the data of a pair of clamps: number of pairs, force ratio, order of tightening; {} for other
    fixtures.
    """
    if pair := fixture.pair:
        ratio = [convert_finite(one) for one in pair.ratio]
        return {"pairs": pair.count, "ratio": ratio, "order": describe_tightening_order(fixture)}
    return {}


def name_carrier(carrier: Carrier) -> str:
    """Return the noun of a carrier, such as "jaw" or "plate"; "wall" for every wall."""
    return carrier.noun if carrier.contact.is_placed else carrier.contact.name


def describe_by_hand(fixture: Fixture, rank: int | None) -> dict[str, Any]:
    """Return as plain data the steps of putting the part between two clamps by hand.

    Returns {} unless the query asked for the seating of the fixture with this rank.
    """
    result = None if fixture.listed is None else fixture.listed.result
    if result is None or result.toolkit.closes_at_once or rank is None or rank > (result.query.seating or 0):
        return {}
    return {"by_hand": plan_hand_loading(fixture, result.workpiece, result.toolkit).to_fields()}


def describe_load_case(case: LoadCase) -> dict[str, Any]:
    """Return a load case as plain data, forces in N."""
    return {
        "load": make_load_entry(case.load),
        "jaw_force": convert_finite(case.jaw_force),
        "smallest": [convert_finite(value) for value in case.smallest],
        "largest": [convert_finite(value) for value in case.largest],
        "reaction": describe_worst(case.reaction),
        "needed": describe_worst(case.needed),
        "needed_with_friction": None
        if case.needed_with_friction is None
        else convert_finite(case.needed_with_friction),
        "keeps_contact": bool(case.keeps_contact),
    }


def describe_worst(worst: WorstLoad) -> dict[str, Any]:
    """Return as plain data the point and direction at which a load is worst; its peg is an index from 0."""
    x, y = worst.point
    return {
        "value": convert_finite(worst.value),
        "peg": worst.peg,
        "point": [x, y],
        "direction": worst.direction,
    }


def describe_result(result: Result, shown: ShownEntries, count: int) -> dict[str, Any]:
    """Return a result as plain data with its first ``count`` shown entries."""
    indices, like = (numbers[:count].tolist() for numbers in (shown.index, shown.like))
    return {
        "workpiece": result.workpiece.name,
        "toolkit": {"kind": result.toolkit.kind, **make_toolkit_fields(result.toolkit)},
        **({} if result.query.raw is None else {"raw": result.query.raw.to_dict()}),
        "found": {kind: int(number) for kind, number in result.found.items()},
        "distinct": {kind: int(number) for kind, number in result.distinct.items()},
        "listed": len(result),
        "unfit": shown.unfit,
        **({"pairs": result.pairs, "seats": result.seats} if result.toolkit.travel_count > 1 else {}),
        "complete": bool(result.complete),
        "notes": list(map(str, result.notes)),
        "proof": None if result.proof is None else describe_proof(result.proof),
        "ranking": list(result.query.rank_by),
        "least_effective_error": result.least_effective_error,
        "why_first": explain_why_first(result) or None,
        "fixtures": [
            {**describe_fixture(result[index], result.toolkit, index + 1), "like_it": more}
            for index, more in zip(indices, like, strict=True)
        ],
    }


def describe_proof(proof: ProofReport) -> dict[str, Any]:
    """Return the proof of a search as plain data.

    Keys are those of a result file, except that ``faces`` takes the place of ``segments``.
    """
    entry = make_proof_entry(proof)
    lost = [
        {("faces" if key == "segments" else key): value for key, value in one.items()}
        for one in entry["undecided"]
    ]
    return {**entry, "undecided": lost}


def describe_explanation(explanation: Explanation, toolkit: Toolkit) -> dict[str, Any]:
    """Return as plain data why there is no fixture, and which changes would help."""
    nearest = explanation.nearest
    return {
        "contacts": explanation.contacts,
        "no_contacts": str(explanation.no_contacts or ""),
        "removals": [asdict(removal) for removal in explanation.removals],
        "last_rule": explanation.last_rule,
        "taken_by": list(explanation.taken_by),
        "asked_words": explanation.asked_words,
        "nearest": None
        if nearest is None
        else {"words": nearest.words, "fixture": describe_fixture(nearest.fixture, toolkit)},
        "helps": describe_helps(explanation, "fields"),
    }


def describe_helps(explanation: Explanation, key: str) -> list[dict[str, Any]]:
    """Return the changes that would help as plain data.

    ``key`` is the key, in each of them, of the changed fields of the toolkit; its value is None where no
    field changes.
    """
    return [
        {
            "change": help.change,
            "fixtures": help.fixtures,
            "complete": help.complete,
            key: None
            if help.fields is None
            else {name: convert_to_json_value(value) for name, value in help.fields.items()},
        }
        for help in explanation.helps
    ]


def describe_toolkit(loaded: LoadedToolkit) -> dict[str, Any]:
    """Return a loaded toolkit as plain data."""
    return {
        "name": loaded.name,
        "kind": loaded.kind,
        "title": loaded.title,
        "source": loaded.source,
        "assumed": list(loaded.assumed),
        "fields": make_toolkit_fields(loaded.toolkit),
        "tolerance": asdict(loaded.tolerance),
    }


def describe_explored(found: Iterable[ToolkitOutcome]) -> list[dict[str, Any]]:
    """Return as plain data the outcomes of several toolkits for a part."""
    return [
        {
            "name": item.name,
            "fixtures": item.fixtures,
            "estimated": item.about is not None,
            "found": dict(item.found),
            "fit": bool(item.fit),
            "held_share": round(item.held, 9),
            "figures": {key: convert_finite(value) for key, value in item.figures.items()},
            "reason": item.reason,
        }
        for item in found
    ]


def describe_verification(outcome: Verification) -> dict[str, Any]:
    """Return the outcome of a verification as plain data; fixtures are named by rank, from 1."""
    return {
        "holds": outcome.holds,
        "fixtures": outcome.fixtures,
        "proven": outcome.proven,
        "refuted": outcome.refuted,
        "undecided": outcome.undecided,
        "bits": outcome.bits,
        "is_compared": outcome.is_compared,
        "faults": list(outcome.faults),
        "unchecked": list(outcome.unchecked),
        "unproven": [
            {"rank": one.index + 1, "verdict": one.verdict, "reason": one.reason} for one in outcome.unproven
        ],
    }


# What the extras ``tables``, ``build123d`` and ``widget`` ask for. None asks for CadQuery, whose Open CASCADE
# is older.
REQUIREMENTS = {
    "pandas": "pandas>=2.2",
    "pyarrow": "pyarrow>=17",
    "build123d": "build123d>=0.10",
    "cadquery": "cadquery>=2.5",
    "anywidget": "anywidget>=0.9.13",
    "shapely": "shapely>=2",
}


def to_pandas(result: Result) -> DataFrame:
    """Return all fixtures of a result as a DataFrame, see :meth:`workhold.Result.to_pandas`."""
    frame: DataFrame = import_library("pandas").DataFrame(make_columns(result))
    return frame


def to_arrow(result: Result) -> pyarrow.Table:
    """Return all fixtures of a result as a table of Arrow, see :meth:`workhold.Result.to_arrow`."""
    return import_library("pyarrow").table(make_columns(result))


def to_shapely(workpiece: Workpiece, tolerance: float) -> Any:
    """Return a workpiece as a polygon or multipolygon of shapely, see
    :meth:`workhold.Workpiece.to_shapely`.
    """
    if not 0 < convert_real(tolerance, "the tolerance") < inf:
        raise InputError(
            f"the tolerance {tolerance:g} of an outline is not usable: give a length above 0, in mm."
        )
    polygons = import_library("shapely")
    rings = [
        [point for segment in loop for point in split_into_chords(segment, tolerance)]
        for loop in workpiece.loop_segments
    ]
    outer, holes = rings[: workpiece.pieces], rings[workpiece.pieces :]
    pieces = []
    for ring in outer:
        shell = polygons.Polygon(ring)
        own = [hole for hole in holes if shell.contains(polygons.Point(hole[0]))]
        pieces.append(polygons.Polygon(ring, own))
    return pieces[0] if len(pieces) == 1 else polygons.MultiPolygon(pieces)


def split_into_chords(segment: Segment, tolerance: float) -> list[Point]:
    """Return the starting points, in order, of the equal chords that replace a segment.

    They are the fewest chords that are nowhere more than ``tolerance`` mm from the segment.
    """
    if not isinstance(segment, Arc):
        return [segment.start]
    widest = 2 * acos(max(1.0 - tolerance / segment.radius, 0.5))
    count = max(ceil(2 * segment.half_sweep / widest), 1)
    turns = [segment.sign * segment.half_sweep * (2 * k / count - 1) for k in range(count)]
    (x, y), angles = segment.center, [segment.mid_angle + turn for turn in turns]
    return [segment.start, *((x + segment.radius * cos(a), y + segment.radius * sin(a)) for a in angles[1:])]


def import_library(name: str) -> Any:
    """Return the module of an optional library.

    Raises
    ------
    InputError
        When it is not installed; the message says how to install it.
    """
    try:
        return import_module(name)
    except ImportError as error:
        raise InputError(
            f"this needs a library that is not installed: pip install '{REQUIREMENTS[name]}'."
        ) from error


def make_columns(result: Result) -> dict[str, Any]:
    """Return the columns of a result's table by name, with one entry for each of N fixtures.

    Columns of numbers are arrays (N,), columns of words are lists. Lengths are in mm, angles in degrees.
    """
    toolkit = result.toolkit
    names, count = list_column_names(result), 6 * toolkit.peg_count
    titles = np.array([one.title for one in toolkit.arrangements])
    carriers = [[toolkit.carriers[k] for k in one.carriers] for one in toolkit.arrangements]
    blocks: list[list[Any]] = []
    for kinds, rows in list_fixture_rows(result.table, toolkit, result.workpiece):
        looks: list[Any] = []
        if FLAT_PIN in toolkit.contacts:
            *before, flats = zip(*rows, strict=True)
            rows, looks = zip(*before, strict=True), list(np.array(flats, np.float64).T)
        numbers = [np.array(column) for column in zip(*rows, strict=True)]
        block: list[Any] = [titles[kinds], *numbers[count:]]
        for peg in range(toolkit.peg_count):
            column, row, *others = numbers[6 * peg : 6 * peg + 6]
            jaws = [carriers[kind][peg] for kind in kinds]
            holes = [
                jaw.name_place(a, b) for jaw, a, b in zip(jaws, column.tolist(), row.tolist(), strict=True)
            ]
            block += [np.array(holes), np.array([jaw.name for jaw in jaws]), column, row, *others]
        block += looks
        blocks.append(block)
    seating_count = (len(SEATING_FIGURES) if result.seating else 0) + len(list_bending_columns(result))
    joined = [np.concatenate(parts) for parts in zip(*blocks, strict=True)] or [np.zeros(0)] * (
        len(names) - 1 - seating_count
    )
    columns = [np.arange(1, len(result) + 1), *joined]
    if result.seating:
        columns += list(np.array(list_seating_values(result)).T)
    if result.bending:
        bent = [list_bending_values(result, row) for row in range(len(result))]
        columns += list(np.array(bent, np.float64).T)
    return {
        name: column.tolist() if column.dtype.kind == "U" else column
        for name, column in zip(names, columns, strict=True)
    }
