"""Fixtures that touch what is asked, and are as precise: of the whole list just those, in any toolkit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from attrs import evolve

import workhold
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture

PART = workhold.load("widget")
TOOLKITS: dict[str, Toolkit] = {
    "vise": workhold.Vise(pitch=8, columns=1, peg_radius=3),
    "plate": workhold.Plate.preset("clamp-plate-20mm", columns=8, rows=6),
    "fence": workhold.Fence.preset("fence-20mm"),
    "flat jaw": workhold.FlatJaw(pitch=20, peg_radius=3, columns=3),
    "two clamps": workhold.Plate.preset("two-clamp-plate-20mm", columns=6, rows=5),
}


def touched(fixture: Fixture) -> set[int | None]:
    return {face for peg in fixture.pegs for face in (peg.face, peg.beside)}


def seen(fixtures: Any) -> list[Any]:
    """Fixtures without where they are listed."""
    return [evolve(fixture, listed=None) for fixture in fixtures]


@pytest.mark.thorough
@pytest.mark.parametrize("kind", TOOLKITS)
def test_the_precise_ones_of_the_whole_list_are_listed(kind: str) -> None:
    """Also where only the best are sought; the account, a new search and the file agree with it."""
    whole = workhold.design(PART, TOOLKITS[kind])
    errors = np.array([fixture.quality["location_error"] for fixture in whole])
    most = float(np.median(errors))
    sifted = workhold.design(PART, TOOLKITS[kind], max_location_error=most)
    assert seen(sifted) == seen(whole[errors <= most]) and 0 < len(sifted) < len(whole)
    assert workhold.verify(sifted, complete=True).holds
    best = workhold.design(PART, TOOLKITS[kind], max_location_error=most, best=3)
    assert seen(best) == seen(sifted[:3])


@pytest.mark.thorough
@pytest.mark.parametrize("kind", [kind for kind in TOOLKITS if kind != "two clamps"])
def test_those_of_the_whole_list_are_listed_that_touch_all_the_faces(kind: str) -> None:
    """Of each face one contact is enough."""
    whole = workhold.design(PART, TOOLKITS[kind])
    middle = whole[len(whole) // 2]
    for faces in (middle.pegs[0].face, [peg.face for peg in middle.pegs][1:]):
        asked = workhold.Restrictions(touch=faces)
        sifted = workhold.design(PART, TOOLKITS[kind], restrictions=asked)
        wanted = [fixture for fixture in whole if touched(fixture) >= set(asked.touch)]
        # Steps of the order count from the least error of what is listed.
        assert sorted(map(repr, seen(sifted))) == sorted(map(repr, seen(wanted))) and wanted
        assert workhold.verify(sifted, complete=True).holds


@pytest.mark.thorough
def test_a_corner_on_a_wall_touches_both_of_its_faces() -> None:
    """Also the one that a table of fixtures does not name."""
    corners = [(0, 0), (20, 9), (41, 0), (45, 20), (20, 37), (-5, 20)]
    arrow = workhold.Workpiece.from_points("arrow", corners)
    fence = workhold.Fence(10, 2, clamp_radius=3, travel=(6, 40), wall_offset=10, columns=6, rows=6)
    whole, hidden = workhold.design(arrow, fence), 0
    for face in {peg.beside for fixture in whole for peg in fixture.pegs if peg.beside is not None}:
        sifted = workhold.design(arrow, fence, restrictions=workhold.Restrictions(touch=face))
        wanted = [fixture for fixture in whole if face in touched(fixture)]
        assert sorted(map(repr, seen(sifted))) == sorted(map(repr, seen(wanted)))
        assert workhold.verify(sifted).holds
        hidden += sum(face not in {peg.face for peg in fixture.pegs} for fixture in wanted)
    assert hidden


@pytest.mark.thorough
def test_the_file_carries_what_was_asked(tmp_path: Any) -> None:
    """And says nothing of it where nothing was asked, as ever."""
    asked = {"restrictions": workhold.Restrictions(touch=(1, 3)), "max_location_error": 0.07}
    sifted = workhold.design(PART, TOOLKITS["vise"], **asked)
    for name in ("a.json", "a.npz"):
        workhold.save(sifted, tmp_path / name)
        assert workhold.open(tmp_path / name).query == sifted.query
        assert workhold.verify(tmp_path / name).holds
    workhold.save(workhold.design(PART, TOOLKITS["vise"]), tmp_path / "b.json")
    text = (tmp_path / "b.json").read_text()
    assert '"touch"' not in text and "max_location_error" not in text


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["vise", "plate", "fence"])
def test_a_fixture_that_is_not_as_asked_is_refuted(kind: str) -> None:
    """The verifier asks each by itself."""
    whole = workhold.design(PART, TOOLKITS[kind])
    least = min(fixture.quality["location_error"] for fixture in whole)
    faces = [face.number for face in PART.faces if any(face.number not in touched(one) for one in whole)][:1]
    for changed in (
        evolve(whole.query, max_location_error=1.01 * least),
        evolve(whole.query, restrictions=workhold.Restrictions(touch=faces)),
    ):
        outcome = workhold.verify(evolve(whole, query=changed))
        assert outcome.refuted and not outcome.holds
        words = "location error is" if changed.max_location_error else "which is to be touched"
        assert all(words in one.reason for one in outcome.unproven)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["vise", "plate", "fence"])
def test_where_none_is_left_it_says_so(kind: str) -> None:
    """The note names what was asked, the explanation the rule, and what would help."""
    far = next(face.number for face in PART.faces if face.number == 8)
    for asked, rule in (
        ({"max_location_error": 1e-4}, "largest location error"),
        ({"restrictions": workhold.Restrictions(touch=(far, 9, 10, 11))}, "faces to touch"),
    ):
        none = workhold.design(PART, TOOLKITS[kind], **asked)
        assert not len(none) and rule in str(none.notes[-1]) and workhold.verify(none).holds
        why = none.why_none()
        assert why.explanation.last_rule == rule and rule in why.words
        assert any(rule in help.rules for help in why.explanation.helps)


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"max_location_error": 0}, "largest location error 0 is not a length"),
        ({"max_location_error": "0.1"}, "largest location error cannot be '0.1': give a number"),
        ({"restrictions": workhold.Restrictions(touch=99)}, "face 99 of widget does not exist"),
        ({"restrictions": workhold.Restrictions(touch=range(5))}, "5 faces are to be touched, and a fixture"),
    ],
)
def test_what_cannot_be_asked_is_refused(asked: dict[str, Any], words: str) -> None:
    with pytest.raises(workhold.InputError, match=words):
        workhold.Query(PART, TOOLKITS["vise"], **asked)


def test_what_contradicts_itself_is_refused() -> None:
    """A face to touch and to avoid; and faces to touch with two clamps, of which one pair stands for others."""
    with pytest.raises(workhold.InputError, match="face 3 is to be touched and to be avoided"):
        workhold.Restrictions(avoid=(3, 4), touch=3)
    with pytest.raises(workhold.InputError, match="cannot be asked for with two clamps"):
        workhold.Query(PART, TOOLKITS["two clamps"], restrictions=workhold.Restrictions(touch=3))
