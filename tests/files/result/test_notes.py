"""Notes in files: sentences with their data; older files have the sentences alone."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import workhold
from workhold import InputError, Query, Restrictions, Result, Vise, Workpiece, design, verify
from workhold.files.result.notes import recognize_note
from workhold.model.notes import (
    STAGES,
    AskedFor,
    BestOnly,
    Cut,
    FittedOutline,
    KeptBest,
    LeftUndecided,
    MoreSystems,
    NoFixture,
    NoPair,
    NoPlace,
    Note,
    PushedByHand,
    Remark,
    Seated,
    Stopped,
    UndecidedSystem,
)

VISE = Vise(pitch=15, columns=1, peg_radius=2)
WEDGE = Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]], departure=0.001234)
QUERY = Query(WEDGE, VISE, restrictions=Restrictions(avoid=[1]), contact_margin=2.0)
Told = Callable[..., tuple[str, ...]]


@pytest.fixture(scope="module")
def result() -> Result:
    """A result with two notes."""
    return design(WEDGE, VISE, best=2)


@pytest.fixture
def told(result: Result, tmp_path: Path) -> Told:
    """What a verification says of the file with other keys; those that are None are not there."""

    def verified(**changes: Any) -> tuple[str, ...]:
        workhold.save(result, tmp_path / "r.json", overwrite=True)
        content = {**json.loads((tmp_path / "r.json").read_text()), **changes}
        content = {key: value for key, value in content.items() if value is not None or key not in changes}
        (tmp_path / "b.json").write_text(json.dumps(content))
        return verify(tmp_path / "b.json").faults

    return verified


@pytest.mark.parametrize("ending", ["json", "npz"])
def test_both_forms_carry_the_data(result: Result, ending: str, tmp_path: Path) -> None:
    workhold.save(result, tmp_path / f"r.{ending}")
    again = workhold.open(tmp_path / f"r.{ending}")
    assert again.notes == result.notes == (BestOnly(2), FittedOutline(WEDGE.departure))
    assert verify(tmp_path / f"r.{ending}").faults == ()


def test_the_data_stand_beside_the_sentences(result: Result, tmp_path: Path) -> None:
    workhold.save(result, tmp_path / "r.json")
    written = json.loads((tmp_path / "r.json").read_text())
    assert written["notes"] == [str(note) for note in result.notes]
    assert written["note_data"] == [
        {"kind": "best_only", "best": 2},
        {"kind": "fitted_outline", "departure": WEDGE.departure},
    ]


def test_an_older_file_is_read_and_verified(result: Result, told: Told, tmp_path: Path) -> None:
    assert told(note_data=None) == ()
    assert workhold.open(tmp_path / "b.json").notes == result.notes
    (fault,) = told(note_data=None, notes=[str(result.notes[0])])
    assert fault == f'the note is missing that says "{result.notes[1]}"'


def test_a_sentence_that_its_data_do_not_say_is_a_fault(result: Result, told: Told) -> None:
    """The data count, whatever the sentence says; neither may be wrong."""
    sentences, data = [str(note) for note in result.notes], [note.data for note in result.notes]
    (fault,) = told(notes=["Only the best 3.", sentences[1]])
    assert fault.startswith('the note "Only the best 3." is not what its data say, "Only the best 2 were')
    faults = told(note_data=[{"kind": "best_only", "best": 1}, data[1]])
    assert len(faults) == 2 and "is not what its data say" in faults[0] and "does not follow" in faults[1]


def test_a_kind_of_a_newer_program_is_its_sentence(result: Result, told: Told, tmp_path: Path) -> None:
    data = [{"kind": "of_tomorrow", "number": 3}, result.notes[1].data]
    (fault,) = told(note_data=data)
    assert "does not follow" in fault
    assert workhold.open(tmp_path / "b.json").notes[0] == Remark(str(result.notes[0]))


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (None, "note_data has 1 entries beside 2 notes"),
        ({"kind": "best_only", "best": 2.5}, "note_data.0.best cannot be used"),
        ({"kind": "best_only"}, "note_data.0.best cannot be used: it is missing"),
        ({"kind": "stopped", "seconds": "3"}, "note_data.0.seconds cannot be used"),
        ({"kind": "asked_for", "rules": []}, "note_data.0 cannot be used"),
        ({"kind": "asked_for", "rules": [1]}, "note_data.0.rules.0 cannot be used"),
        ({"kind": "no_fixture", "stage": "luck", "line": None, "asked": []}, "note_data.0.stage cannot"),
        (
            {"kind": "undecided_system", "faces": [1, 2, 3], "columns": [0], "rows": [0]},
            "note_data.0 cannot be used",
        ),
        ({"best": 2}, "note_data.0.kind cannot be used|the key note_data.0.kind is missing"),
        (3, "note_data.0 cannot be used"),
    ],
)
def test_data_that_are_none_are_refused(
    entry: Any, words: str, result: Result, told: Told, tmp_path: Path
) -> None:
    rest = [result.notes[1].data]
    with pytest.raises(InputError, match=words):
        told(note_data=rest if entry is None else [entry, *rest])
    with pytest.raises(InputError, match=words):
        workhold.open(tmp_path / "b.json")


ASKED = QUERY.asked_of_places
EVERY: tuple[Note, ...] = (
    AskedFor(QUERY.restricted_by),
    BestOnly(20),
    PushedByHand(),
    Cut(1_234_567, 1_000),
    FittedOutline(WEDGE.departure),
    KeptBest(1_000, 7),
    LeftUndecided(1),
    LeftUndecided(12),
    MoreSystems(7),
    *(NoFixture(stage, VISE.wording, line) for stage in STAGES for line in (None, 12)),
    *(NoFixture(stage, VISE.wording, asked=ASKED) for stage in STAGES[:2]),
    *(NoPair(seats, contacts) for seats, contacts in ((0, 0), (0, 99), (4, 99))),
    NoPlace(99, VISE.wording),
    NoPlace(99, VISE.wording, with_body=True),
    Remark("Look at 3 of them."),
    Seated(2_000, 3),
    Stopped(1.5),
    Stopped(1e7),
    UndecidedSystem((0, 0, 3, 7), (0, -1, 0, 1), (0, 2, -3, 4)),
    UndecidedSystem((1, 2, 3), (0, 1, 0), (0, 0, -2)),
)


@pytest.mark.parametrize("note", EVERY, ids=lambda note: note.kind)
def test_every_note_of_an_older_file_is_recognised(note: Note) -> None:
    assert recognize_note(note.words, QUERY, 99) == note
