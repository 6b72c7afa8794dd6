"""Every key of a result file, deleted, emptied, changed by one or of another type: refused, or harmless for a reason."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import attrs
import pytest

from undecided_examples import as_undecided
from workhold import (
    InputError,
    Load,
    Plate,
    Query,
    Restrictions,
    Result,
    Vise,
    Workpiece,
    answer,
    circle_zone,
    save,
)
from workhold.fixels.toolkit import Toolkit
from workhold.model.notes import LeftUndecided
from workhold.verification import verify_file

pytestmark = pytest.mark.thorough

Data = dict[str, Any]
Where = tuple[Any, ...]

VISE = Vise(
    pitch=18, min_gap=15, columns=2, peg_radius=2, rows=9, max_opening=200, body_radius=2.5, blocked=["R-A9"]
)
PLATE = Plate((22, 20), 2, columns=4, rows=4, clamp_radius=2.5, travel=(3, 24), directions=("-x", "-y"))

MISSING = object()
SAID = "a name, from which nothing follows"
ANOTHER = "another query, which what is listed meets as well; a search of it tells what it lacks"
WORK = "how much work the search was, within the order that its numbers keep; a search tells"
LESS = "it claims less"
NONE = "a departure of nothing, which the lack of it says as well"
PLACE = "the clamp would touch that face, or a face from that line, as well"
ONE = "one clamp, which the lack of it says as well"
ORDER = "what is listed stands in this order as well"

Changes = dict[str, dict[str, str]]

# What is done to what place in the file, by the reason why it passes: of every file, of the vise's and of the plate's.
ZONES_AND_ANGLES = {
    "restrictions.zones": "emptied",
    "restrictions.zones.0": "deleted",
    "restrictions.zones.0.0.0": "more less",
    "restrictions.zones.0.0.1": "more less",
    "restrictions.zones.0.0.2": "more less",
    "restrictions.angles": "emptied",
    "restrictions.angles.0": "deleted",
    "restrictions.angles.0.0": "less",
    "restrictions.angles.0.1": "more less",
}
ALWAYS: Changes = {
    SAID: {
        "workpiece.name": "emptied changed text",
        "loads.0.name": "emptied changed text",
        # Files from before notes had data are read by their sentences.
        "note_data": "deleted",
        "tolerance.fit": "deleted",
    },
    NONE: {"workpiece.departure": "deleted", "tolerance.departure": "deleted"},
    LESS: {"complete": "emptied", "proof.undecided.0.reach_deg": "more"},
    ORDER: {"ranking.2": "deleted"},
    ANOTHER: ZONES_AND_ANGLES,
    WORK: {
        "statistics.features": "more",
        "statistics.chord_curves": "more less",
        "statistics.sliding_pairs": "more less",
        "statistics.curve_pairs": "more less",
        "statistics.crossings_sought": "more less",
        "statistics.contacts_examined": "more less",
        "proof.cells": "more less",
        "proof.escalated": "more",
    },
}
OF_VISE: Changes = {
    ANOTHER: {
        "vise.rows": "more emptied",
        "vise.max_opening": "more less emptied",
        "vise.min_gap": "less",
        "vise.body_radius": "more emptied",
        "vise.blocked": "emptied",
        "vise.blocked.0": "deleted",
        "restrictions.angles.0.0": "more",
    },
}
# Of the vise with a dozen fixtures alone, and of the one with four times as many alone.
OF_FEW: Changes = {ORDER: {"ranking.1": "deleted"}}
OF_MANY: Changes = {ANOTHER: {"vise.min_gap": "emptied"}}
OF_PLATE: Changes = {
    ANOTHER: {
        "toolkit.columns": "more less emptied",
        "toolkit.rows": "more less emptied",
        "toolkit.travel.0": "more less",
        "toolkit.travel.1": "more less",
    },
    ONE: {"toolkit.clamps": "deleted"},
    # A tip of another radius has features of its own.
    WORK: {"statistics.features": "less"},
    PLACE: {"proof.undecided.0.columns.3": "less", "proof.undecided.0.segments.3": "less"},
}


def harmless(*several: Changes) -> set[tuple[str, str]]:
    """Places and what is done to them, of several tables."""
    return {
        (place, change)
        for table in several
        for places in table.values()
        for place, changes in places.items()
        for change in changes.split()
    }


def wedge_result(toolkit: Toolkit) -> Result:
    """A few fixtures of a wedge, asked for with everything that can be, and an undecided candidate that is a real place."""
    wedge = Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
    asked = Restrictions((), (circle_zone(200.0, 200.0, 3.0),), ((-170.0, 185.0),))
    loads = [Load(((10.0, 5.0),), 100.0, (20.0, 70.0), 3.0, "cutter")]
    ranking = ("location_error", "load_reaction", "closure_margin")
    result = answer(
        Query(wedge, toolkit, contact_margin=0.25, restrictions=asked, rank_by=ranking, loads=loads)
    )
    assert result.proof is not None and len(result) > 6
    counts = {"candidates": result.proof.candidates + 1, "escalated": max(result.proof.escalated, 1)}
    proof = attrs.evolve(result.proof, undecided=(as_undecided(result[0]),), **counts)
    return attrs.evolve(result, proof=proof, notes=(LeftUndecided(1),))


def places(value: Any, where: Where = ()) -> Iterator[Where]:
    """Every place in nested objects and lists; of fixtures the second, of a zone and a loop the first vertex."""
    if isinstance(value, dict | list):
        for key in list(value) if isinstance(value, dict) else range(len(value)):
            skipped = isinstance(key, int) and (
                (where == ("fixtures",) and key != 1)
                or (where[:1] == ("workpiece",) and len(where) == 3 and key)
                or (where[:2] == ("restrictions", "zones") and len(where) == 3 and key)
            )
            if not skipped:
                yield (*where, key)
                yield from places(value[key], (*where, key))


def changes(value: Any) -> Iterator[tuple[str, Any]]:
    """A value deleted, emptied, changed by one and of another type."""
    yield "deleted", MISSING
    yield "emptied", {dict: {}, list: [], str: "", bool: False}.get(type(value))
    if isinstance(value, int | float) and not isinstance(value, bool):
        yield "more", value + 1
        yield "less", value - 1
    if isinstance(value, str) and value:
        yield "changed", value + "x"
    yield "text", str(value) + "?" if isinstance(value, str) else json.dumps(value)
    yield "boxed", [value]


def changed(data: Data, where: Where, new: Any) -> Data:
    """The file with one value replaced or deleted."""
    out = copy.deepcopy(data)
    container: Any = out
    for key in where[:-1]:
        container = container[key]
    if new is MISSING:
        del container[where[-1]]
    else:
        container[where[-1]] = new
    return out


def holds(content: Data, path: Path) -> bool:
    """Whether a file is read and nothing in it is refuted."""
    path.write_text(json.dumps(content), encoding="utf-8")
    try:
        return verify_file(path).holds
    except InputError:
        return False


@pytest.mark.parametrize(
    ("toolkit", "passes"),
    [
        (VISE, harmless(ALWAYS, OF_VISE, OF_FEW)),
        pytest.param(
            attrs.evolve(VISE, pitch=15), harmless(ALWAYS, OF_VISE, OF_MANY), marks=pytest.mark.prove
        ),
        pytest.param(PLATE, harmless(ALWAYS, OF_PLATE), marks=pytest.mark.prove),
    ],
    ids=["vise", "many", "plate"],
)
def test_every_mutation_is_refused_or_harmless_by_name(
    toolkit: Toolkit, passes: set[tuple[str, str]], tmp_path: Path
) -> None:
    """What passes is just what is listed as harmless: none less, so that the list does not rot, and none more."""
    path = tmp_path / "r.json"
    save(wedge_result(toolkit), path)
    data: Data = json.loads(path.read_text(encoding="utf-8"))
    assert holds(data, path)
    passed = set()
    for where in places(data):
        value: Any = data
        for key in where:
            value = value[key]
        for kind, new in changes(value):
            if new is not MISSING and type(new) is type(value) and new == value:
                continue
            if holds(changed(data, where, new), path):
                passed.add((".".join(map(str, where)), kind))
    assert passed == passes, f"passed besides: {passed - passes}; refused: {passes - passed}"
