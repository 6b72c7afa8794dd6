"""Answers of the server as plain data for JSON: lengths in mm, angles in degrees, forces in N."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from math import isinf
from typing import Any

from attrs import asdict, evolve

from workhold.drawing.bench import make_bench
from workhold.drawing.panel import describe_arrangement
from workhold.files.result.hold_text import make_hold_entry
from workhold.files.result.strapped_text import make_strapped_entry
from workhold.files.result.writer import make_own_outlines_entry, make_proof_entry
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Segment
from workhold.model.clamps import describe_tightening_order
from workhold.model.fixture import Fixture
from workhold.model.fixture_table import FixtureTable, make_fixture_of_row
from workhold.model.hold_words import describe_coefficients, write_setup_sentences
from workhold.model.jaw_hold import HOLD_FIGURES, JawHold
from workhold.model.moved_setup import find_move_to_middle, find_overhangs, move_fixture_by_holes
from workhold.model.quality import FIGURES
from workhold.model.raw_words import list_raw_sentences
from workhold.model.search_report import Explanation, ProofReport
from workhold.model.setup import list_length_settings
from workhold.model.shown import ShownSetUp
from workhold.model.straps import StrappedHold
from workhold.model.workpiece import Workpiece
from workhold.presenting.data import convert_finite, describe_helps, describe_solid
from workhold.presenting.figure_words import find_edgeless_distance, is_edgeless
from workhold.presenting.zoomed_picture import draw_zoomable_picture
from workhold.supports.straps import make_question
from workhold.supports.words_of_straps import describe_assumptions, list_remarks, list_steps, list_warnings
from workhold.units import MILLIMETRE, format_rounded_down

__all__ = [
    "describe_arrangements",
    "describe_explanation",
    "describe_figures",
    "describe_fixture",
    "describe_part",
    "find_first_place",
    "describe_proof",
    "describe_rows",
]

# Undecided candidates of a proof that are listed; the result file has them all.
MOST_UNDECIDED = 50
# Of a picture, in page units, where nobody says how large its frame is.
USUAL_SIZE = (640.0, 480.0)
PLACE = re.compile(r"\((-?\d[\d.eE+-]*), (-?\d[\d.eE+-]*)\)")


def find_first_place(sentence: str) -> dict[str, float] | None:
    """Return the first "(x, y)" that a sentence names as {"x": x, "y": y}; None where it names none.

    >>> find_first_place("loop 0 crosses itself at (1.5, -2): mend it.")
    {'x': 1.5, 'y': -2.0}
    """
    match = PLACE.search(sentence)
    try:
        return None if match is None else {"x": float(match[1]), "y": float(match[2])}
    except ValueError:
        return None


def describe_part(workpiece: Workpiece, remarks: Sequence[str] = ()) -> dict[str, Any]:
    """Return a part as plain data for the page: loops, segments, faces, bounds, solid and own outlines."""
    face_of = map_segments_to_faces(workpiece)
    segments, number = [], 0
    for index, loop in enumerate(workpiece.loop_segments):
        for segment, (_, _, bulge) in zip(loop, workpiece.loops[index].tolist(), strict=True):
            segments.append(
                {"number": number, "face": face_of[number], "loop": index, **describe_segment(segment, bulge)}
            )
            number += 1
    return {
        "name": workpiece.name,
        "loops": [(loop + 0.0).tolist() for loop in workpiece.loops],
        "segments": segments,
        "faces": [describe_face(face.number, face.segment) for face in workpiece.faces],
        "bounds": list(workpiece.bounds),
        "departure": workpiece.departure,
        "remarks": list(remarks),
        "solid": None,
        **describe_solid(workpiece.solid),
        "outlines": describe_own_outlines(workpiece),
        "own_faces": {role: list_own_face_numbers(workpiece, role) for role, _ in workpiece.outlines},
    }


def map_segments_to_faces(workpiece: Workpiece) -> dict[int, int]:
    """Return for each segment, in order of number, the number of the face that it belongs to."""
    return {number: face.number for face in workpiece.faces for number in face.segments}


def list_own_face_numbers(workpiece: Workpiece, role: str) -> list[int]:
    """Return for each segment of the own outline of a role, in order, the number of its face.

    Numbers of own outlines follow those of the part.
    """
    outline, first = workpiece.find_outline(role)
    return [first + face for _, face in sorted(map_segments_to_faces(outline).items())]


def describe_own_outlines(workpiece: Workpiece) -> dict[str, Any]:
    """Return by role the outlines of carriers with heights of their own, as plain data in the form of
    requests.
    """
    entries = make_own_outlines_entry(workpiece).get("outlines", {})
    return {
        role: {"heights": [one.solid.low, one.solid.peg_height], **entries[role]}
        for role, one in workpiece.outlines
        if one.solid is not None
    }


def describe_segment(segment: Segment, bulge: float) -> dict[str, Any]:
    """Return a segment as plain data; "center" and "radius" are None for a line."""
    arc = segment if isinstance(segment, Arc) else None
    return {
        "start": list(segment.start),
        "end": list(segment.end),
        "bulge": bulge,
        "center": None if arc is None else list(arc.center),
        "radius": None if arc is None else arc.radius,
    }


def describe_face(number: int, segment: Segment) -> dict[str, Any]:
    """Return a face as plain data.

    "size" is the length of a line or the radius of an arc in mm; "concave" is True for an arc around which
    the material lies, as around a hole.
    """
    if isinstance(segment, Arc):
        return {"number": number, "kind": "arc", "size": segment.radius, "concave": segment.sign < 0}
    return {"number": number, "kind": "line", "size": segment.length, "concave": False}


def describe_figures() -> list[dict[str, Any]]:
    """Return all figures of quality as plain data, those of parts that friction holds last.

    "sorts" tells whether a list can be sorted by the figure; lists of parts held by friction have a fixed
    order.
    """
    names = ("key", "words", "unit", "more_is_better", "meaning", "decimals")
    known = {figure.key for figure in FIGURES}
    of_friction = [figure for figure in HOLD_FIGURES if figure.key not in known]
    return [
        {**{name: getattr(figure, name) for name in names}, "sorts": figure.key in known}
        for figure in (*FIGURES, *of_friction)
    ]


def describe_rows(
    table: FixtureTable,
    workpiece: Workpiece,
    toolkit: Toolkit,
    ranks: Iterable[int],
    holds: Sequence[JawHold | StrappedHold] = (),
) -> list[dict[str, Any]]:
    """Return the fixtures of a table as rows of plain data, with the given ranks, one for each fixture.

    ``holds`` describes how flat jaws or straps hold the first fixtures; it is () for fixtures with pegs.
    """
    longest = find_edgeless_distance(workpiece, toolkit)
    fixtures = [make_fixture_of_row(table, toolkit, number, workpiece) for number in range(len(table))]
    for number, hold in enumerate(holds):
        fixtures[number] = evolve(
            fixtures[number], hold=hold, quality={**fixtures[number].quality, **hold.figures}
        )
    rows = (describe_row(fixture, workpiece, toolkit, longest) for fixture in fixtures)
    return [{"rank": rank, **row} for rank, row in zip(ranks, rows, strict=True)]


def describe_arrangements(toolkit: Toolkit) -> list[dict[str, str]]:
    """Return the title and the description of each arrangement of a toolkit's fixtures."""
    return [{"title": one.title, "words": describe_arrangement(one, toolkit)} for one in toolkit.arrangements]


def describe_row(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, longest: float) -> dict[str, Any]:
    """Return a fixture as a row of a list, without its rank; holes and settings are given for the set-up in
    the middle of its plate.

    "edgeless" is True where the edge distance is ``longest`` (mm), which means that the part has no edge.
    """
    stands = move_fixture_by_holes(fixture, toolkit, find_move_to_middle(fixture, toolkit, workpiece))
    return {
        "type": fixture.type,
        "title": make_row_title(fixture, toolkit),
        "settings": [
            {"sign": one.sign, "name": one.name, "length": one.length}
            for one in list_length_settings(stands, toolkit)
        ],
        "holes": [peg.hole for peg in stands.pegs],
        "faces": [peg.face for peg in fixture.pegs],
        "theta_deg": fixture.pose.theta_deg,
        "hold": None if fixture.hold is None else describe_hold(fixture),
        "edgeless": is_edgeless(fixture.quality, longest),
        "quality": {key: convert_finite(value) for key, value in fixture.quality.items()},
    }


def describe_hold(fixture: Fixture) -> dict[str, Any]:
    """Return how flat jaws or straps hold a part, as plain data in the form of result files, with warnings in
    words.

    A listed fixture also has the steps to set it up.
    """
    hold = fixture.hold
    if not isinstance(hold, JawHold):
        return describe_straps(fixture)
    entry, steps = make_hold_entry(fixture), dict[str, Any]()
    if fixture.listed is not None:
        query = fixture.listed.result.query
        steps = {
            "knows_height": query.part_height is not None,
            "steps": [
                *list_raw_sentences(fixture, query, MILLIMETRE),
                *(f"{step}." for step in write_setup_sentences(fixture, query, MILLIMETRE)),
                *([describe_coefficients(query)] if query.is_loaded else []),
            ],
        }
    names = ("parallels", "parallel_offsets", "stop", "fixed", "moving", "warnings")
    return {
        **{name: entry[name] for name in names if name in entry},
        **steps,
        "full_contact": hold.full_contact,
        "unfit": hold.is_unfit,
        "clamp_needed_each": list(hold.clamp_needed_each),
        "safety_each": list_safeties(hold),
    }


def list_safeties(hold: JawHold | StrappedHold) -> list[float | None] | None:
    """Return how many times the force given holds each load, rounded down to hundredths; None for any number of
    times, and None in place of the list where no force is given.
    """
    times = hold.safety_each[: len(hold.clamp_needed_each)]
    if not times:
        return None
    return [None if isinf(one) else float(format_rounded_down(one)) for one in times]


def describe_straps(fixture: Fixture) -> dict[str, Any]:
    """Return how straps hold a part, as plain data.

    A listed fixture also has the steps to set it up, and warnings.
    """
    hold = fixture.hold
    assert isinstance(hold, StrappedHold)
    entry, words = make_strapped_entry(fixture), dict[str, list[str]]()
    if fixture.listed is not None:
        asked = make_question(fixture.listed.result.query)
        words = {
            "steps": [
                *(f"{step}." for step in list_steps(hold, fixture, asked, MILLIMETRE)),
                *list_remarks(hold),
                *([describe_assumptions(asked)] if fixture.listed.result.query.is_loaded else []),
            ],
            "warnings": list_warnings(hold, fixture, asked, MILLIMETRE),
        }
    names = ("straps", "supports", "push", "places", "looked_at")
    return {
        **{name: entry[name] for name in names},
        "unfit": hold.is_unfit,
        "clamp_needed_each": list(hold.clamp_needed_each),
        "safety_each": list_safeties(hold),
        **words,
    }


def make_row_title(fixture: Fixture, toolkit: Toolkit) -> str:
    """Return the heading of a fixture in a list.

    It is the fixture's arrangement; between flat jaws, the parallels and the stop; under straps, the holes of
    the bolts.
    """
    hold = fixture.hold
    if isinstance(hold, StrappedHold):
        return make_strapped_title(hold, toolkit)
    if not isinstance(hold, JawHold):
        return toolkit.find_arrangement(fixture.type, fixture.direction).heading
    on = f"On {hold.parallels:g} mm parallels" if hold.parallels else "On the bed"
    return f"{on}, stop {hold.stop}" if hold.stop else on


def make_strapped_title(hold: StrappedHold, toolkit: Toolkit) -> str:
    """Return the heading of a seat under straps in a list: the holes of the bolts, or why there are none."""
    straps = toolkit.strap_set
    assert straps is not None
    if hold.is_unfit:
        return "No push seats it"
    if hold.straps and not hold.holds_nothing:
        return f"Straps in {' '.join(straps.bolts.name_place(*one.hole) for one in hold.straps)}"
    if not hold.is_looked_at:
        return "Seat, not looked at"
    return "Seat" if hold.places is None else "No straps hold it"


def describe_fixture(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, size: tuple[float, float] = USUAL_SIZE
) -> dict[str, Any]:
    """Return a fixture as plain data without its rank: its row, its geometry, and a picture of ``size`` in
    page units.

    All places are in the frame of the fixture as listed; adding ``placed`` (mm) moves them to the middle of
    its plate. Each entry of "carriers" has the indices of the pegs on it, their radius in mm, and its
    clamping direction.
    """
    move = find_move_to_middle(fixture, toolkit, workpiece)
    stands = move_fixture_by_holes(fixture, toolkit, move)
    pitch = toolkit.plates[0].pitch if toolkit.plates else (0.0, 0.0)
    placed = [steps * apart for steps, apart in zip(move, pitch, strict=True)]
    bench = evolve(make_bench(stands, workpiece, toolkit), is_exact=True)
    dx, dy = placed
    return {
        **describe_row(fixture, workpiece, toolkit, find_edgeless_distance(workpiece, toolkit)),
        "order": describe_tightening_order(stands),
        "pairs": fixture.pair and fixture.pair.count,
        "mover": toolkit.moving.noun,
        "origin": toolkit.datum.name,
        "placed": placed,
        "hangs_over": {one.side: one.length for one in find_overhangs(stands, toolkit, workpiece)},
        "stands_out_of": toolkit.wall_with_ends and toolkit.wall_with_ends.noun,
        "touched": [peg.touched for peg in fixture.pegs],
        "corners": [number for number, peg in enumerate(fixture.pegs) if peg.beside is not None],
        "flush": [number for number, peg in enumerate(fixture.pegs) if peg not in fixture.placed],
        "x": fixture.pose.x,
        "y": fixture.pose.y,
        "jaw_separation": fixture.travel,
        "pegs": [[peg.x, peg.y] for peg in fixture.pegs],
        "contacts": [[x - dx, y - dy] for (x, y), _ in bench.contacts],
        "normals": [list(normal) for _, normal in bench.contacts],
        "forces": [convert_finite(peg.force) for peg in fixture.pegs],
        "carriers": describe_carriers(stands, bench.shown),
        "picture": draw_zoomable_picture(bench, workpiece.name, size, placed),
    }


def describe_carriers(fixture: Fixture, seen: ShownSetUp) -> list[dict[str, Any]]:
    """Return plates, then walls, then clamps as plain data.

    Each has the indices of its pegs, their radius in mm, and its clamping direction or None.
    """
    numbers = defaultdict[str, list[int]](list)
    for number, peg in enumerate(fixture.pegs):
        numbers[peg.carrier].append(number)
    # Two clamps that push the same way are one carrier: each takes the next of its tips.
    tips = {name: iter(of) for name, of in numbers.items()}
    standing = [(one.carrier, one.clamping, numbers[one.carrier.name]) for one in seen.carriers]
    standing += [(one.carrier, None, numbers[one.carrier.name]) for one in seen.walls]
    clamps = [(one.carrier, one.clamping, [next(tips[one.carrier.name])]) for one in seen.clamps]
    return [
        {"pegs": pegs, "peg_radius": carrier.peg_radius, "clamping": clamping}
        for carrier, clamping, pegs in standing + clamps
    ]


def describe_proof(proof: ProofReport) -> dict[str, Any]:
    """Return the proof of a search as plain data.

    It has the first :data:`MOST_UNDECIDED` undecided candidates, and the number of all.
    """
    entry = make_proof_entry(proof)
    return {
        **entry,
        "undecided": entry["undecided"][:MOST_UNDECIDED],
        "undecided_count": len(proof.undecided),
    }


def describe_explanation(explanation: Explanation, workpiece: Workpiece, toolkit: Toolkit) -> dict[str, Any]:
    """Return an explanation of why there is no fixture as plain data."""
    nearest = explanation.nearest
    return {
        "contacts": explanation.contacts,
        "no_contacts": str(explanation.no_contacts or ""),
        "removals": [{**asdict(one), "removed": one.removed} for one in explanation.removals],
        "last_rule": explanation.last_rule,
        "taken_by": list(explanation.taken_by),
        "asked_words": explanation.asked_words,
        "nearest": None
        if nearest is None
        else {
            "row": {"rank": None, **describe_fixture(nearest.fixture, workpiece, toolkit)},
            "words": nearest.words,
        },
        "helps": [
            {**said, "rules": list(help.rules)}
            for said, help in zip(describe_helps(explanation, "toolkit"), explanation.helps, strict=True)
        ],
    }
