"""A query is one value: it refuses what cannot be asked, equals its like, and goes from one process to another."""

from __future__ import annotations

import pickle
from multiprocessing import get_context
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from workhold import (
    InputError,
    Load,
    OpeningVise,
    Query,
    Restrictions,
    Tolerance,
    Vise,
    Workpiece,
    answer,
    circle_zone,
    design,
    polygon_zone,
)


def part(corner: float = 9.0) -> Workpiece:
    """Part of no symmetry with an arc, small enough to be searched at once."""
    return Workpiece.from_loops("part", [[[0, 0, 0], [41, 0, 0.3], [44, 20, 0], [corner, 37, 0]]])


def full(**changes: Any) -> Query:
    """A query in which everything is asked."""
    fields: dict[str, Any] = {
        "workpiece": part(),
        "toolkit": Vise(pitch=(10, 12.5), columns=2, peg_radius=2, rows=6, blocked=["L-A2", "R-B"]),
        "types": ["II"],
        "contact_margin": 0.25,
        "restrictions": Restrictions(
            [3], [circle_zone(1, 2, 3), polygon_zone([(0, 0), (4, 0), (0, 5)])], [[-10, 40.5]]
        ),
        "rank_by": ["load-reaction", "closure margin"],
        "tolerance": Tolerance(0.02, 0.0),
        "loads": [Load([(1, 2), (3, 4)], force=5, directions=(10, 30), moment=-7, name="drill")],
        "best": 12,
    }
    return Query(**fields | changes)


OTHERS: list[dict[str, Any]] = [
    {"workpiece": part(9.5)},
    {"toolkit": OpeningVise(pitch=(10, 12.5), columns=2, peg_radius=2, rows=6, blocked=["L-A2", "R-B"])},
    {"toolkit": Vise(pitch=(10, 12.5), columns=2, peg_radius=2, rows=6, blocked=["L-A2", "R-B1"])},
    {"types": None},
    {"contact_margin": 0.0},
    {"restrictions": Restrictions([3], [circle_zone(1, 2, 3.5)], [[-10, 40.5]])},
    {"restrictions": None},
    {"rank_by": None},
    {"tolerance": None},
    {"loads": [Load(moment=1.0)]},
    {"best": None},
]


def test_equal_queries_are_equal() -> None:
    """Made twice of the same words they are one, and of one hash; any other word makes another."""
    assert full() == full() and hash(full()) == hash(full())
    for change in OTHERS:
        assert full(**change) != full(), change


@pytest.mark.parametrize("change", [{}, *OTHERS])
def test_a_query_survives_pickling(change: dict[str, Any]) -> None:
    """It comes back equal; its arrays cannot be written to, and what was worked out of the part stays behind."""
    query = full(**change)
    assert query.workpiece.faces
    again = pickle.loads(pickle.dumps(query))
    assert again == query
    assert "faces" not in vars(again.workpiece)
    for loop in (*again.workpiece.loops, *(zone.loop for zone in again.restrictions.zones)):
        assert not loop.flags.writeable


def test_a_result_survives_pickling() -> None:
    """Every number of every fixture, and what was asked."""
    result = design(part(), Vise(pitch=10, columns=1, peg_radius=2), loads=[Load(moment=1.0)])
    again = pickle.loads(pickle.dumps(result))
    assert len(result) > 0 and list(again) == list(result)
    for name in ("query", "found", "distinct", "complete", "notes", "statistics", "proof", "counts"):
        assert getattr(again, name) == getattr(result, name)
    assert not again.table.theta.flags.writeable
    assert np.array_equal(again.table.null_vector, result.table.null_vector)


@pytest.mark.thorough
def test_a_query_is_answered_in_another_process() -> None:
    """A process started anew gives the answer that this one gives."""
    query = full(restrictions=None, types=None)
    with get_context("spawn").Pool(1) as pool:
        there = pool.apply(answer, [query])
    here = answer(query)
    assert len(here) > 0 and list(there) == list(here) and there.query == here.query == query


def test_one_word_is_not_taken_for_its_letters() -> None:
    """Of types and of figures, by Query and by design."""
    query = full(types="II", rank_by="wrench-radius")
    assert query.types == ("II",) and query.rank_by == ("wrench_radius",)
    assert set(design(part(), Vise(pitch=10, columns=1, peg_radius=2), types="II").query.types) == {"II"}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"types": ["III"]}, "type III is unknown: choose I or II"),
        ({"types": []}, "no type to seek"),
        ({"contact_margin": -1.0}, "contact margin -1 is not a length"),
        ({"contact_margin": "1"}, "contact margin cannot be '1'"),
        ({"best": 0}, "best 0 is not a positive whole number"),
        ({"best": 1.5}, "best 1.5 is not a positive whole number"),
        ({"rank_by": ["load-reaction"], "loads": []}, "there is no load to rank by"),
        ({"rank_by": ["beauty"]}, "'beauty' is not a figure to rank by"),
        ({"rank_by": 5}, "the names are not a list, but 5"),
        ({"workpiece": "widget"}, "the workpiece cannot be 'widget': give a Workpiece"),
        ({"toolkit": {"pitch": 10}}, "the toolkit cannot be .*: give a toolkit, such as workhold.Vise"),
        ({"restrictions": [3]}, "the restrictions cannot be .3.: give Restrictions"),
        ({"tolerance": 0.02}, "the tolerance cannot be 0.02: give a Tolerance"),
        ({"loads": ["x"]}, "a load cannot be 'x': give Load objects"),
        ({"loads": 200}, "the loads are not a list, but 200"),
    ],
)
def test_what_cannot_be_asked_is_refused(change: dict[str, Any], words: str) -> None:
    """In one sentence that names no command-line flag."""
    with pytest.raises(InputError, match=words) as caught:
        full(**change)
    assert "--" not in str(caught.value)
    with pytest.raises(InputError, match=words):
        evolve(full(), **change)
