"""What the server answers, as plain data for JSON: lengths in mm, angles in degrees, forces in N."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from itertools import count
from math import hypot, isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import evolve

from workhold.files.result.writer import fixture_rows, load_entry, proof_entry, toolkit_fields
from workhold.geometry.box import Box
from workhold.geometry.segment import Arc, Segment
from workhold.model.explanation import Explanation
from workhold.model.fixture import Fixture
from workhold.model.holes import hole_name
from workhold.model.proof import Proof
from workhold.model.quality import FIGURES
from workhold.model.result import FixtureTable, fixture_at
from workhold.model.shown import Shown, placed_boxes, shown, shown_beside
from workhold.model.toolkit import Toolkit
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece

if TYPE_CHECKING:
    from workhold.files.toolkit.reader import LoadedVise
    from workhold.statics.loads import LoadCase, Worst

__all__ = [
    "contact_answer",
    "explanation_answer",
    "figures_answer",
    "fixture_answer",
    "load_case_answer",
    "part_answer",
    "place_in",
    "proof_answer",
    "rows_answer",
    "vise_answer",
]

# Undecided candidates told of a proof; the result file has them all.
MOST_UNDECIDED = 50
PLACE = re.compile(r"\((-?\d[\d.eE+-]*), (-?\d[\d.eE+-]*)\)")


def place_in(sentence: str) -> dict[str, float] | None:
    """The first place (x, y) that a sentence names, if any.

    >>> place_in("loop 0 crosses itself at (1.5, -2): mend it.")
    {'x': 1.5, 'y': -2.0}
    """
    match = PLACE.search(sentence)
    try:
        return None if match is None else {"x": float(match[1]), "y": float(match[2])}
    except ValueError:
        return None


def finite(value: float) -> float | None:
    """A number, or None for one that JSON does not have."""
    return float(value) if isfinite(value) else None


def part_answer(workpiece: Workpiece, remarks: Sequence[str] = ()) -> dict[str, Any]:
    """A part with its segments and faces."""
    face_of = {number: face.number for face in workpiece.faces for number in face.segments}
    segments, number = [], 0
    for index, loop in enumerate(workpiece.loop_segments):
        for segment, (_, _, bulge) in zip(loop, workpiece.loops[index].tolist(), strict=True):
            segments.append({"number": number, "face": face_of[number], "loop": index, **shape(segment, bulge)})
            number += 1
    return {
        "name": workpiece.name,
        "loops": [(loop + 0.0).tolist() for loop in workpiece.loops],
        "segments": segments,
        "faces": [face_answer(face.number, face.segment) for face in workpiece.faces],
        "bounds": list(workpiece.bounds),
        "remarks": list(remarks),
    }


def shape(segment: Segment, bulge: float) -> dict[str, Any]:
    """Ends and circle of a segment."""
    arc = segment if isinstance(segment, Arc) else None
    return {
        "start": list(segment.start),
        "end": list(segment.end),
        "bulge": bulge,
        "center": None if arc is None else list(arc.center),
        "radius": None if arc is None else arc.radius,
    }


def face_answer(number: int, segment: Segment) -> dict[str, Any]:
    """A face: its size is the length of a line and the radius of an arc; a hollow arc is concave."""
    if isinstance(segment, Arc):
        return {"number": number, "kind": "arc", "size": segment.radius, "concave": segment.sign < 0}
    return {"number": number, "kind": "line", "size": segment.length, "concave": False}


def vise_answer(loaded: LoadedVise) -> dict[str, Any]:
    """A vise that comes with the program."""
    given = toolkit_fields(loaded.vise)
    return {
        "name": loaded.name,
        "title": loaded.title,
        "source": loaded.source,
        "unit": loaded.unit.name,
        "fields": {key: value for key, value in given.items() if key in loaded.fields},
        "tolerance": {"peg": loaded.tolerance.peg, "face": loaded.tolerance.face},
    }


def figures_answer() -> list[dict[str, Any]]:
    """The figures of quality."""
    return [
        {
            "key": figure.key,
            "words": figure.words,
            "unit": figure.unit,
            "more_is_better": figure.more_is_better,
            "meaning": figure.meaning,
        }
        for figure in FIGURES
    ]


def rows_answer(
    table: FixtureTable, workpiece: Workpiece, toolkit: Toolkit, ranks: Iterable[int]
) -> list[dict[str, Any]]:
    """Fixtures as rows; ``ranks`` are those of the table's fixtures."""
    out: list[dict[str, Any]] = []
    quality, numbers = table.quality.tolist(), iter(ranks)
    boxes = placed_boxes(workpiece, table.theta, *table.position.T).tolist()
    # Figures are told one by one below, so the rows are made without them.
    bare = evolve(table, quality=np.full_like(table.quality, np.nan))
    arrangements = [(one.name, toolkit.carrier_names(one)) for one in toolkit.arrangements]
    for kinds, rows in fixture_rows(bare, toolkit):
        for kind, row in zip(kinds, rows, strict=True):
            name, jaws = arrangements[kind]
            pegs = [row[6 * peg : 6 * peg + 6] for peg in range(4)]
            figures = zip(FIGURES, quality[len(out)], strict=True)
            out.append(
                {
                    "rank": next(numbers),
                    "type": name,
                    "holes": [hole_name(jaw, peg[0], peg[1]) for jaw, peg in zip(jaws, pegs, strict=True)],
                    "faces": [peg[4] for peg in pegs],
                    "theta_deg": row[24],
                    "x": row[25],
                    "y": row[26],
                    "jaw_separation": row[27],
                    "pegs": [[peg[2], peg[3]] for peg in pegs],
                    "forces": [peg[5] for peg in pegs],
                    "carriers": carriers_answer(
                        shown_beside(Box(*boxes[len(out)]), fixture_at(table, toolkit, len(out)), toolkit)
                    ),
                    "quality": {figure.key: finite(value) for figure, value in figures if not np.isnan(value)},
                }
            )
    return out


def carriers_answer(seen: Shown) -> list[dict[str, Any]]:
    """What shows of each carrier.

    ``origin`` is its hole in column 0 and row 0, ``pegs`` are the numbers of its pegs and ``used`` their holes;
    ``measured`` are the upper or right ends of the axes that its travel is measured between.
    """
    measured = {each.carrier.name: [list(start[1]), list(end[1])] for each, start, end in seen.travels}
    numbers = count()
    return [
        {
            "letter": each.carrier.letter,
            "origin": each.carrier.place(0, 0, each.travelled),
            "pitch": each.carrier.pitch,
            "columns": [each.columns[0], each.columns[-1]],
            "rows": [each.rows[0], each.rows[-1]],
            "plate": [each.plate.x0, each.plate.y0, each.plate.x1, each.plate.y1],
            "hole_radius": each.hole_radius,
            "names_at": each.names_at,
            "pegs": [next(numbers) for _ in each.pegs],
            "used": [[peg.column, peg.row] for peg in each.pegs],
            "clamping": each.clamping,
            "measured": measured.get(each.carrier.name),
        }
        for each in seen.carriers
    ]


def fixture_answer(fixture: Fixture, workpiece: Workpiece, vise: Vise) -> dict[str, Any]:
    """A fixture by itself, without a rank."""
    return {
        "type": fixture.type,
        "holes": [peg.hole for peg in fixture.pegs],
        "faces": [peg.face for peg in fixture.pegs],
        "theta_deg": fixture.pose.theta_deg,
        "x": fixture.pose.x,
        "y": fixture.pose.y,
        "jaw_separation": fixture.jaw_separation,
        "pegs": [[peg.x, peg.y] for peg in fixture.pegs],
        "forces": [finite(peg.force) for peg in fixture.pegs],
        "carriers": carriers_answer(shown(fixture, vise, workpiece)),
        "quality": {key: finite(value) for key, value in fixture.quality.items()},
    }


def contact_answer(fixture: Fixture, workpiece: Workpiece, vise: Vise) -> dict[str, Any]:
    """Outward normals and contacts of a fixture's pegs in the vise frame, and which pegs are on the right jaw."""
    segments = {face.number: face.segment for face in workpiece.faces}
    normals, contacts = [], []
    for peg in fixture.pegs:
        segment = segments[peg.face]
        nx, ny = segment.normal(segment.parameter(fixture.pose.inverse.apply(peg.x, peg.y)))
        x, y = (float(v) / hypot(nx, ny) for v in fixture.pose.turn(nx, ny))
        normals.append([x, y])
        contacts.append([peg.x - vise.peg_radius * x, peg.y - vise.peg_radius * y])
    return {"normals": normals, "contacts": contacts, "right_jaw": [peg.jaw == "right" for peg in fixture.pegs]}


def proof_answer(proof: Proof) -> dict[str, Any]:
    """The account of a search, with how many candidates are undecided and the first of them."""
    entry = proof_entry(proof)
    return {**entry, "undecided": entry["undecided"][:MOST_UNDECIDED], "undecided_count": len(proof.undecided)}


def load_case_answer(case: LoadCase) -> dict[str, Any]:
    """What a load does to a fixture."""
    return {
        "load": load_entry(case.load),
        "jaw_force": finite(case.jaw_force),
        "smallest": [finite(value) for value in case.smallest],
        "largest": [finite(value) for value in case.largest],
        "reaction": worst_answer(case.reaction),
        "needed": worst_answer(case.needed),
        "needed_with_friction": None if case.needed_with_friction is None else finite(case.needed_with_friction),
        "keeps_contact": bool(case.keeps_contact),
    }


def worst_answer(worst: Worst) -> dict[str, Any]:
    """Where and in which direction a load is worst."""
    x, y = worst.point
    return {"value": finite(worst.value), "peg": worst.peg, "point": [x, y], "direction": worst.direction}


def explanation_answer(explanation: Explanation, workpiece: Workpiece, vise: Vise) -> dict[str, Any]:
    """Why there is no fixture."""
    nearest = explanation.nearest
    return {
        "contacts": explanation.contacts,
        "removals": [
            {"rule": removal.rule, "before": removal.before, "after": removal.after, "removed": removal.removed}
            for removal in explanation.removals
        ],
        "last_rule": explanation.last_rule,
        "nearest": None
        if nearest is None
        else {"row": {"rank": None, **fixture_answer(nearest.fixture, workpiece, vise)}, "words": nearest.words},
        "helps": [
            {"change": help.change, "fixtures": help.fixtures, "complete": help.complete} for help in explanation.helps
        ],
    }
