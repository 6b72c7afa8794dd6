"""Notes: kinds with data, which print as sentences."""

from __future__ import annotations

import pickle

import attrs
import pytest

from fakes import fake_result
from workhold import Fence, Vise
from workhold.errors import join_words
from workhold.model.notes import (
    KINDS,
    STAGES,
    BestOnly,
    Cut,
    FittedOutline,
    LeftUndecided,
    Many,
    NoFixture,
    NoPair,
    NoPlace,
    Remark,
)

WORDING = Vise(pitch=20, columns=2, peg_radius=3).wording
OWN = Fence(10, 3, wall_offset=5).wording


def test_a_note_prints_as_its_sentence() -> None:
    """Also among others, and in a text; its data have kind and fields."""
    note = Cut(12_345, 40)
    assert f"{note}" == note.words == " ".join(map(str, [note]))
    assert note.words.startswith("Stopped with 12,345 fixtures found: the best 40 of them are listed")
    assert note.data == {"kind": "cut", "found": 12_345, "listed": 40}
    assert "repr" not in repr(note) and repr(note) == "Cut(found=12345, listed=40)"


def test_texts_become_remarks() -> None:
    """Whoever gives a result a sentence gets it back as one; braces in it are not fields."""
    result = fake_result(3, notes=("so {much}", BestOnly(3)))
    assert result.notes == (Remark("so {much}"), BestOnly(3)) and str(result.notes[0]) == "so {much}"
    assert pickle.loads(pickle.dumps(result)).notes == result.notes


def test_who_cuts_again_says_so_once() -> None:
    result = fake_result(5, notes=(BestOnly(9),))
    assert result.mark_cut_short(4).mark_cut_short(2).notes == (Cut(5, 2), BestOnly(9))


def test_what_things_are_called_makes_no_difference() -> None:
    assert NoFixture("hold", WORDING) == NoFixture("hold", OWN) != NoFixture("set", WORDING)
    assert str(NoFixture("hold", WORDING)) != str(NoFixture("hold", OWN))
    assert NoPlace(3, WORDING).data == {"kind": "no_place", "verified": 3, "with_body": False}


@pytest.mark.parametrize("wording", [WORDING, OWN])
def test_each_stage_has_a_sentence(wording: object) -> None:
    """Of its own, with a program's line in it where one is most in the way, and with what was asked for."""
    said = [
        str(NoFixture(stage, wording, line))  # type: ignore[arg-type]
        for stage in STAGES
        for line in (None, 17)
    ]
    assert len(set(said)) == 8 and all(("line 17" in words) == (k % 2 == 1) for k, words in enumerate(said))
    asked = ("faces to avoid", "rows of holes")
    for stage in STAGES[:2]:
        assert join_words(asked) in str(NoFixture(stage, WORDING, asked=asked))


def test_numbers_are_put_as_they_are_read() -> None:
    assert str(LeftUndecided(1)).startswith("1 candidate is ") and str(LeftUndecided(2)).startswith("2 cand")
    assert "0.0012 mm" in str(FittedOutline(0.001_234)) and "4,200,000 fixtures" in str(Many(4_240_000, 30))
    assert len({str(NoPair(*numbers)) for numbers in ((0, 0), (0, 5), (3, 5))}) == 3


def test_every_kind_has_a_name_and_no_two_the_same() -> None:
    assert all(kind.kind == name and attrs.has(kind) for name, kind in KINDS.items()) and len(KINDS) == 18
