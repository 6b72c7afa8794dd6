"""What is said beside a list of supports: the same words on the command line and on the page, each with its remedy."""

from __future__ import annotations

import pytest
from attrs import evolve

import workhold
from own_heights import BASE, stepped
from shown_words import last_paragraph
from workhold import Vise
from workhold.cli.supports_command import list_support_notes as notes_of_command
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.model.support_triples import Supports
from workhold.supports.listing import find_supports
from workhold.supports.words import place_notes, write_flat_faces_notes
from workhold.units import find_unit
from workhold.web.support_tasks import list_support_notes as notes_of_page

LOAD = SpatialLoad(points=[[20, 15]], force=150.0)


@pytest.fixture(scope="module")
def found() -> Supports:
    """The best sets under the first fixture of a vise that stands elsewhere with supports, of a part with no level faces."""
    part = stepped({})
    result = workhold.design(part, Vise(10, 4, 3))
    for fixture in result:
        request = SupportRequest.from_workpiece(part, 30.0, toolkit=result.toolkit)
        some = find_supports(fixture, result.query, request, [LOAD], best=3)
        if some.triples:
            opened = fixture.travel + 20.0
            return evolve(some, triples=tuple(evolve(one, travel=opened) for one in some.triples))
    raise AssertionError("take another part")


@pytest.mark.thorough
def test_both_say_the_same(found: Supports) -> None:
    """Closing force, openings, and what is taken to be flat; in the unit that is asked for."""
    page = notes_of_page(found, "mm")
    command = notes_of_command(found, found.triples, find_unit("mm"))
    assert len(page) == 3 and "closing force" in page[0] and "opened to" in page[1]
    assert command[-3:-1] == page[:2]
    assert (
        command[-1]
        .replace("--keep-out-below", '"Keep pads off"')
        .replace("--keep-out-above", '"Keep the clamp off"')
        == (page[2])
    )
    assert "bottom and top" in page[2]
    assert find_unit("inch").format_length(found.triples[0].travel) in notes_of_page(found, "inch")[1]


def test_nothing_is_said_of_what_is_not_there(found: Supports) -> None:
    """Without loads, openings of their own, or a solid; one known side leaves the other to be named alone."""
    still = tuple(evolve(one, travel=found.fixture.travel) for one in found.triples)
    plain = evolve(found, triples=still, loads=())
    assert [note for note in notes_of_page(plain, "mm") if "are level" not in note] == []
    assert write_flat_faces_notes(workhold.load("widget"), ("a", "b")) == []
    part = stepped({})
    assert part.solid is not None
    known = evolve(part, solid=evolve(part.solid, bottom=[BASE]))
    (note,) = write_flat_faces_notes(known, ("a", "b"))
    assert "at the part's top are level" in note and note.endswith("off the rest with b.")


@pytest.mark.thorough
def test_no_pad_stands_under_a_part_that_lies_on_no_face() -> None:
    """A level face on top and none below: no support, whoever asks and whatever else is kept out, and why."""
    part = stepped({})
    assert part.solid is not None
    lying = evolve(part, solid=evolve(part.solid, bottom=[], top=[BASE]))
    known = evolve(part, solid=evolve(part.solid, bottom=[BASE], top=[BASE]))
    toolkit = workhold.Plate(pitch=10, peg_radius=3)
    for workpiece, held in ((lying, False), (known, True)):
        result = workhold.design(workpiece, toolkit, best=1)
        corner = workhold.circle_zone(0, 0, 1)
        for asked in ({}, {"bottom_zones": [corner]}):
            found = result[0].supports(best=1, pad_radius=2, tip_radius=2, **asked)
            assert bool(found.triples) is held, asked
        assert result[0].supports(best=1, pad_radius=2, tip_radius=2, bottom=[BASE]).triples
    found = workhold.design(lying, toolkit, best=1)[0].supports(best=1, pad_radius=2)
    assert "the part lies on no level face under which a pad could stand" in last_paragraph(found)
    (note,) = write_flat_faces_notes(lying, ("a", "b"))
    assert note.endswith("no support can stand under it: turn another side up.")


def test_a_part_that_tips_at_a_touch_does_not_stand(found: Supports) -> None:
    """Half a millimetre inside the triangle is the least; pages mark the same sets."""
    sets = [evolve(found.triples[0], standing=inside) for inside in (0.5, 0.499, 0.0, -3.0)]
    assert [one.stands for one in sets] == [True, False, False, False]
    (note,) = place_notes({number: one for number, one in enumerate(sets, 1) if not one.clamp.hangs})
    assert note.startswith("On 2, 3 and 4 the part does not stand by itself")
