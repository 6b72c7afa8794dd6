"""What the server answers, as plain data for JSON: lengths in mm, angles in degrees, forces in N."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from math import hypot
from typing import Any

from attrs import asdict

from workhold.drawing.panel import arrangement_words
from workhold.files.result.writer import outlines_entry, proof_entry
from workhold.fixels.carrier import Carrier
from workhold.fixels.contacts import WALL_END
from workhold.fixels.pegs import standoff
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Box, Segment
from workhold.model.clamps import ShownClamp, order_words
from workhold.model.fixture import Fixture
from workhold.model.fixture_table import FixtureTable, fixture_at
from workhold.model.moved_setup import middle_move, moved_on, overhangs
from workhold.model.quality import FIGURES
from workhold.model.search_report import Explanation, Proof
from workhold.model.setup import settings_of
from workhold.model.shown import Shown, shown
from workhold.model.workpiece import Workpiece
from workhold.presenting.data import finite, helps_data, solid_data
from workhold.presenting.figure_words import is_edgeless, no_edge

__all__ = [
    "arrangements_answer",
    "contact_answer",
    "explanation_answer",
    "figures_answer",
    "fixture_answer",
    "part_answer",
    "place_in",
    "proof_answer",
    "rows_answer",
]

# Undecided candidates of a proof that are listed; the result file has them all.
MOST_UNDECIDED = 50
PLACE = re.compile(r"\((-?\d[\d.eE+-]*), (-?\d[\d.eE+-]*)\)")


def place_in(sentence: str) -> dict[str, float] | None:
    """Finds the first place (x, y) that a sentence names, if any.

    >>> place_in("loop 0 crosses itself at (1.5, -2): mend it.")
    {'x': 1.5, 'y': -2.0}
    """
    match = PLACE.search(sentence)
    try:
        return None if match is None else {"x": float(match[1]), "y": float(match[2])}
    except ValueError:
        return None


def part_answer(workpiece: Workpiece, remarks: Sequence[str] = ()) -> dict[str, Any]:
    face_of = face_numbers(workpiece)
    segments, number = [], 0
    for index, loop in enumerate(workpiece.loop_segments):
        for segment, (_, _, bulge) in zip(loop, workpiece.loops[index].tolist(), strict=True):
            segments.append(
                {"number": number, "face": face_of[number], "loop": index, **shape(segment, bulge)}
            )
            number += 1
    return {
        "name": workpiece.name,
        "loops": [(loop + 0.0).tolist() for loop in workpiece.loops],
        "segments": segments,
        "faces": [face_answer(face.number, face.segment) for face in workpiece.faces],
        "bounds": list(workpiece.bounds),
        "departure": workpiece.departure,
        "remarks": list(remarks),
        "solid": None,
        **solid_data(workpiece.solid),
        "outlines": own_answer(workpiece),
        "own_faces": {role: own_numbers(workpiece, role) for role, _ in workpiece.outlines},
    }


def face_numbers(workpiece: Workpiece) -> dict[int, int]:
    return {number: face.number for face in workpiece.faces for number in face.segments}


def own_numbers(workpiece: Workpiece, role: str) -> list[int]:
    """Returns the faces of the segments of what carriers of a role meet, numbered on."""
    outline, first = workpiece.outline_of(role)
    return [first + face for _, face in sorted(face_numbers(outline).items())]


def own_answer(workpiece: Workpiece) -> dict[str, Any]:
    """Describes what carriers with heights of their own meet of a part, by role, as a request takes it."""
    entries = outlines_entry(workpiece).get("outlines", {})
    return {
        role: {"heights": [one.solid.low, one.solid.peg_height], **entries[role]}
        for role, one in workpiece.outlines
        if one.solid is not None
    }


def shape(segment: Segment, bulge: float) -> dict[str, Any]:
    arc = segment if isinstance(segment, Arc) else None
    return {
        "start": list(segment.start),
        "end": list(segment.end),
        "bulge": bulge,
        "center": None if arc is None else list(arc.center),
        "radius": None if arc is None else arc.radius,
    }


def face_answer(number: int, segment: Segment) -> dict[str, Any]:
    """Describes a face: its size is the length of a line or the radius of an arc; a hollow arc is concave."""
    if isinstance(segment, Arc):
        return {"number": number, "kind": "arc", "size": segment.radius, "concave": segment.sign < 0}
    return {"number": number, "kind": "line", "size": segment.length, "concave": False}


def figures_answer() -> list[dict[str, Any]]:
    names = ("key", "words", "unit", "more_is_better", "meaning", "decimals")
    return [{name: getattr(figure, name) for name in names} for figure in FIGURES]


def rows_answer(
    table: FixtureTable, workpiece: Workpiece, toolkit: Toolkit, ranks: Iterable[int]
) -> list[dict[str, Any]]:
    """Describes fixtures as rows; ``ranks`` are those of the table's fixtures."""
    longest = no_edge(workpiece, toolkit)
    return [
        {
            "rank": rank,
            **fixture_answer(fixture_at(table, toolkit, number, workpiece), workpiece, toolkit, longest),
        }
        for number, rank in enumerate(ranks)
    ]


def carriers_answer(seen: Shown, fixture: Fixture) -> list[dict[str, Any]]:
    """Describes what is shown of a fixture's carriers, then of each wall and each clamp.

    ``origin`` is the hole in column 0 and row 0, and ``pegs`` are the numbers of the pegs. ``used_columns``
    and ``used_rows`` are those of the pegs and of clamps. ``measured`` are the upper or right ends of the
    axes between which the travel is measured. A clamp has no lattice; its body is under ``clamp``.
    """
    ends = [(one.setting, [list(high) for _, high in one.axes]) for one in seen.measured]
    measured = {setting.carrier.name: axes for setting, axes in ends if setting.tip is None}
    of_clamps = [axes for setting, axes in ends if setting.tip is not None]
    numbers = defaultdict[str, list[int]](list)
    for number, peg in enumerate(fixture.pegs):
        numbers[peg.carrier].append(number)
    # Two clamps that push the same way are one carrier: each takes the next of its tips.
    tips = {name: iter(of) for name, of in numbers.items()}

    lattices: list[dict[str, Any]] = [
        {
            "letter": each.carrier.letter,
            "origin": each.carrier.place(0, 0, each.travelled),
            "pitch": each.carrier.pitch,
            "columns": [each.columns[0], each.columns[-1]],
            "rows": [each.rows[0], each.rows[-1]],
            **body_answer(each.plate),
            "hole_radius": each.hole_radius,
            "names_at": each.names_at,
            "pegs": numbers[each.carrier.name],
            "peg_radius": each.carrier.peg_radius,
            "flat": None if each.carrier.flat is None else each.carrier.flat.distance,
            "flats": [peg.flat_deg for peg in each.pegs],
            "used_columns": sorted(each.used_columns),
            "used_rows": sorted(each.used_rows),
            "clamping": each.clamping,
            "measured": measured.get(each.carrier.name),
            "clamp": None,
        }
        for each in seen.carriers
    ]
    plate = seen.carriers[0]
    walls = [
        {
            **lattice_of_none(each.carrier),
            **body_answer(each.bar),
            "pegs": numbers[each.carrier.name],
            "peg_radius": 0.0,
            "clamping": None,
            "measured": None,
            "clamp": None,
        }
        for each in seen.walls
    ]
    clamps = [
        {
            **lattice_of_none(each.carrier),
            **body_answer(each.room),
            "pegs": [next(tips[each.carrier.name])],
            "peg_radius": each.carrier.peg_radius,
            "clamping": each.clamping,
            "measured": axes if is_reached(each) else None,
            "clamp": {
                # Of four contacts that are no fixture the clamp may reach no hole.
                "hole": each.hole if is_reached(each) else None,
                "tip": [each.tip.x, each.tip.y],
                "draws_back": draws_back(each),
                "bolt_radius": plate.hole_radius,
                "line": corners(plate.plate),
            },
        }
        for each, axes in zip(seen.clamps, of_clamps, strict=True)
    ]
    return lattices + walls + clamps


def body_answer(body: Box) -> dict[str, list[float]]:
    return {"plate": corners(body)}


def corners(box: Box) -> list[float]:
    """Lists x and y of the lower left and the upper right corner of a rectangle."""
    return [box.x0, box.y0, box.x1, box.y1]


def stroke_of(clamp: ShownClamp) -> float:
    """Measures how far in mm the tip is from the hole, in the direction in which it clamps."""
    assert clamp.hole is not None
    (x, y), (dx, dy) = clamp.hole, clamp.clamping
    return (clamp.tip.x - x) * dx + (clamp.tip.y - y) * dy


def is_reached(clamp: ShownClamp) -> bool:
    """Whether the clamp reaches its tip from its hole; always so where only its line is known."""
    travel = clamp.carrier.travel
    if clamp.hole is None or travel is None or travel.most is None:
        return True
    return -travel.most - 1e-6 <= stroke_of(clamp) <= -travel.least + 1e-6


def draws_back(clamp: ShownClamp) -> float | None:
    """Measures how far in mm a clamp can be drawn back from where it clamps; None where only its line is
    known.
    """
    travel = clamp.carrier.travel
    if clamp.hole is None or travel is None or travel.most is None:
        return None
    return max(stroke_of(clamp) + travel.most, 0.0)


def lattice_of_none(carrier: Carrier) -> dict[str, Any]:
    return {
        "letter": "",
        "origin": carrier.place(0, 0),
        "pitch": carrier.pitch,
        "columns": [0, -1],
        "rows": [0, -1],
        "hole_radius": 0.0,
        "names_at": "left",
        "used_columns": [],
        "used_rows": [],
    }


def arrangements_answer(toolkit: Toolkit) -> list[dict[str, str]]:
    """Lists the arrangements of a toolkit's fixtures: the title of each on the page, and its description."""
    return [{"title": one.title, "words": arrangement_words(one, toolkit)} for one in toolkit.arrangements]


def fixture_answer(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, longest: float | None = None
) -> dict[str, Any]:
    """Describes a fixture, without its rank, on its plate as it stands in the middle of that.

    Holes are named so, and plates lie so under the part. All places are in the frame of the fixture as it is
    listed; ``placed`` is by how much it stands further on. Where ``edgeless``, its edge distance stands for
    none. It is ``longest``, where that is known already.
    """
    longest = no_edge(workpiece, toolkit) if longest is None else longest
    move = middle_move(fixture, toolkit, workpiece)
    stands = moved_on(fixture, toolkit, move)
    placed = [steps * pitch for steps, pitch in zip(move, toolkit.plates[0].pitch, strict=True)]
    return {
        "type": fixture.type,
        "title": toolkit.arrangement(fixture.type, fixture.direction).heading,
        "settings": [
            {"sign": one.sign, "name": one.name, "length": one.length} for one in settings_of(stands, toolkit)
        ],
        "order": order_words(stands),
        "pairs": fixture.pair and fixture.pair.count,
        "mover": toolkit.moving.noun,
        "origin": toolkit.datum.name,
        "placed": placed,
        "hangs_over": {one.side: one.length for one in overhangs(stands, toolkit, workpiece)},
        "stands_out_of": toolkit.reaching and toolkit.reaching.noun,
        "holes": [peg.hole for peg in stands.pegs],
        "faces": [peg.face for peg in fixture.pegs],
        "touched": [peg.touched for peg in fixture.pegs],
        "corners": [number for number, peg in enumerate(fixture.pegs) if peg.beside is not None],
        "flush": [number for number, peg in enumerate(fixture.pegs) if peg not in fixture.placed],
        "theta_deg": fixture.pose.theta_deg,
        "x": fixture.pose.x,
        "y": fixture.pose.y,
        "jaw_separation": fixture.travel,
        "pegs": [[peg.x, peg.y] for peg in fixture.pegs],
        "forces": [finite(peg.force) for peg in fixture.pegs],
        "carriers": moved_back(carriers_answer(shown(stands, toolkit, workpiece), stands), placed),
        "edgeless": is_edgeless(fixture.quality, longest),
        "quality": {key: finite(value) for key, value in fixture.quality.items()},
    }


def moved_back(carriers: list[dict[str, Any]], by: Sequence[float]) -> list[dict[str, Any]]:
    """Carriers with their places moved back by x and y in mm, to where the fixture is listed."""
    dx, dy = by
    if dx == dy == 0.0:
        return carriers

    def back(place: Sequence[float]) -> list[float]:
        return [value - (dx, dy)[k % 2] for k, value in enumerate(place)]

    for carrier in carriers:
        carrier["origin"], carrier["plate"] = back(carrier["origin"]), back(carrier["plate"])
        if carrier["measured"] is not None:
            carrier["measured"] = [back(place) for place in carrier["measured"]]
        if clamp := carrier["clamp"]:
            clamp["tip"], clamp["line"] = back(clamp["tip"]), back(clamp["line"])
            clamp["hole"] = clamp["hole"] and back(clamp["hole"])
    return carriers


def contact_answer(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> dict[str, Any]:
    """Lists outward normals and contacts of a fixture's pegs in the toolkit's frame."""
    segments = {face.number: face.segment for face in workpiece.numbered.faces}
    normals, contacts = [], []
    for peg in fixture.pegs:
        carrier = toolkit.carrier(peg.carrier)
        if carrier.contact is WALL_END:
            normals.append([0.0, -1.0])
            contacts.append([peg.x, peg.y])
            continue
        segment = segments[peg.face]
        nx, ny = segment.normal(segment.parameter(fixture.pose.inverse.apply(peg.x, peg.y)))
        x, y = (float(v) / hypot(nx, ny) for v in fixture.pose.turn(nx, ny))
        normals.append([x, y])
        off = standoff(carrier.peg_radius, carrier.flat, segment)
        contacts.append([peg.x - off * x, peg.y - off * y])
    return {"normals": normals, "contacts": contacts}


def proof_answer(proof: Proof) -> dict[str, Any]:
    """Describes the proof of a search, with how many candidates are undecided and the first of them."""
    entry = proof_entry(proof)
    return {
        **entry,
        "undecided": entry["undecided"][:MOST_UNDECIDED],
        "undecided_count": len(proof.undecided),
    }


def explanation_answer(explanation: Explanation, workpiece: Workpiece, toolkit: Toolkit) -> dict[str, Any]:
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
            "row": {"rank": None, **fixture_answer(nearest.fixture, workpiece, toolkit)},
            "words": nearest.words,
        },
        "helps": [
            {**said, "rules": list(help.rules)}
            for said, help in zip(helps_data(explanation, "toolkit"), explanation.helps, strict=True)
        ],
    }
