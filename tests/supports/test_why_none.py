"""Why no three supports hold a part: each reason where it is the one, and what it says would help does."""

from __future__ import annotations

import re

import pytest
from attrs import evolve

from shown_words import last_paragraph
from supports.cases import case
from workhold import Query, Vise
from workhold.model.support_request import SupportRequest
from workhold.model.support_triples import Supports
from workhold.supports.listing import find_supports


def asked(request: SupportRequest, columns: int | None = None) -> Supports:
    """The supports of a bracket in its vise, or in one with other columns."""
    one = case("bracketL")
    toolkit = one.query.toolkit
    assert isinstance(toolkit, Vise)
    query = one.query if columns is None else Query(one.query.workpiece, evolve(toolkit, columns=columns))
    return find_supports(one.fixture, query, request)


def test_smaller_pads_that_are_said_to_help_leave_three_holes() -> None:
    """The radius that is said leaves three holes, and one that is a little larger does not."""
    request = evolve(case("bracketL").request, pad_margin=12.5)
    sentence = last_paragraph(asked(request))
    said = re.search(r"three have it for pads of radius ([\d.]+) mm", sentence)
    assert said is not None, sentence
    radius = float(said[1])
    assert asked(evolve(request, pad_radius=radius)).positions >= 3
    assert asked(evolve(request, pad_radius=radius + 0.011)).positions < 3


def test_pads_too_small_to_be_any_are_not_said_to_help() -> None:
    """Where three holes have room for less than the least pads only, another pitch or fixture is what helps."""
    request = evolve(case("bracketL").request, pad_margin=14.0)
    sentence = last_paragraph(asked(request))
    assert "no three have it for pads of radius 2.000 mm; a finer pitch would help, or another" in sentence
    assert asked(evolve(request, pad_radius=0.1)).positions >= 3


@pytest.mark.parametrize(
    ("change", "columns", "words"),
    [
        ({"pad_margin": 40.0}, None, "lie under the lower face clear of the pegs at all"),
        ({}, 2, "no three of them fit the columns"),
        ({"inside": 60.0}, None, "and 60.000 mm is asked for"),
        ({"reach": [(900.0, 900.0, 0.0, 1.0)]}, None, "or other keep-outs on top or the clamp's reach"),
    ],
)
def test_each_reason_is_said(change: dict[str, object], columns: int | None, words: str) -> None:
    """One sentence with what is in the way."""
    found = asked(evolve(case("bracketL").request, **change), columns)
    sentence = last_paragraph(found)
    assert not found.triples and words in sentence and not sentence.count(". ")
