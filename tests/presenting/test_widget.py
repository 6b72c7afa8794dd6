"""The widget's traits: what the browser asks is answered, and what a user sets is shown."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest

import workhold
from workhold.errors import InputError
from workhold.model.support_triples import ChosenSupports
from workhold.presenting import notebook

WEDGE = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
RESULT = workhold.design(WEDGE, workhold.Vise(pitch=15, columns=1, peg_radius=2))


@pytest.fixture
def widget() -> Any:
    """A widget of the wedge."""
    pytest.importorskip("anywidget", reason="the extra 'widget' is not installed")
    return RESULT.widget()


def test_stepping_shows_another_fixture_under_the_same_force(widget: Any) -> None:
    """The force keeps its place on the part; a rank that there is none of becomes the nearest."""
    widget.force = [12.0, 9.0, 150.0, 240.0]
    first, arrow = widget.picture["svg"], widget.answer["arrow"]
    widget.rank = 2
    assert widget.picture["svg"] != first and "Fixture 2 of" in widget.picture["title"]
    assert widget.answer["arrow"] != arrow and widget.force == [12.0, 9.0, 150.0, 240.0]
    widget.rank = 10**6
    assert widget.rank == widget.count == len(RESULT)
    widget.rank = -3
    assert widget.rank == 1 and widget.picture["svg"] == first


def test_a_dragged_arrow_becomes_the_force_and_is_answered(widget: Any) -> None:
    """With the number that it was asked under, so that the browser knows which it is."""
    widget.dragged = [320.0, 240.0, 320.0, 340.0, 7]
    assert widget.answer["number"] == 7 and widget.answer["size"] == "200 N"
    assert widget.answer["arrow"] == pytest.approx([320.0, 240.0, 320.0, 340.0])
    assert widget.force[2] == 200.0
    widget.dragged = [0, 0, 0, 0, 8]
    assert widget.answer["number"] == 8 and widget.answer["arrow"] is None


def test_the_force_of_the_jaw_decides_whether_it_holds(widget: Any) -> None:
    widget.force = [12.0, 9.0, 150.0, 240.0]
    assert widget.answer["holds"] is True
    widget.jaw_force = 1.0
    assert widget.answer["holds"] is False
    widget.jaw_force = 1e5
    assert widget.answer["holds"] is True


def test_what_cannot_be_is_said_in_the_widget(widget: Any) -> None:
    """No error reaches the browser, and the next force is answered."""
    widget.dragged = [0, 0, "x", 0, 3]
    assert "four" in widget.answer["words"] and widget.answer["number"] == 3
    widget.force = [1.0, 2.0, -5.0, 0.0]
    assert widget.answer["arrow"] is None
    widget.force = [1.0, 2.0, 1e300, 0.0]
    assert widget.answer["forces"] == [] and widget.answer["words"]
    widget.force = [12.0, 9.0, 150.0, 240.0]
    assert widget.answer["holds"] is True


@pytest.mark.thorough
def test_supports_show_in_the_holes_that_the_sheet_names() -> None:
    """In this vise all stands a column further left with supports; one of the right jaw moves with it."""
    pytest.importorskip("anywidget", reason="the extra 'widget' is not installed")
    corners = [(0, 0), (90, 0), (100, 30), (60, 70), (20, 64)]
    five = workhold.Workpiece.from_points("five", corners)
    result = workhold.design(five, workhold.Vise(pitch=20, columns=2, peg_radius=3), best=3)
    widget = result.widget(supports={"thickness": 12, "best": 2})
    chosen = ChosenSupports.from_supports(result[0].supports(12, best=2))
    holes = [pad.hole for pad in chosen.pads]
    assert f"Supports in {', '.join(holes)}; the clamp on top presses at (" in widget.picture["title"]
    picture = widget.picture["svg"]
    assert picture.count('class="support"') == 3 and picture.count('class="top-clamp"') == 1
    pegs = [peg.hole for peg in chosen.recounted.fixture.pegs]
    assert pegs != [peg.hole for peg in result[0].pegs]
    assert all(f">{name}<" in picture for name in holes + pegs)
    moving = "".join(re.findall(r'<g class="moves".*?</g>', picture, re.DOTALL))
    assert moving.count('class="support"') == sum(hole.startswith("R-") for hole in holes) > 0
    # Forces are of the same pegs, and so are the words of the closing.
    widget.force = [40.0, 30.0, 150.0, 240.0]
    assert [one["hole"] for one in widget.answer["forces"]] == pegs
    widget.asked_closing = 1
    assert f"S = {chosen.recounted.fixture.travel:.3f} mm" in widget.closing["words"]
    assert 'class="support"' not in result.widget().picture["svg"]


def test_supports_that_cannot_be_had_are_a_sentence() -> None:
    pytest.importorskip("anywidget", reason="the extra 'widget' is not installed")
    widget = RESULT.widget(supports={"thickness": 12})
    assert "No three supports hold the part" in widget.picture["title"]
    assert 'class="support"' not in widget.picture["svg"]
    with pytest.raises(InputError, match="the thickness of the part is not known"):
        RESULT.widget(supports={})


def test_a_closing_is_answered(widget: Any) -> None:
    widget.asked_closing = 1
    assert widget.closing["number"] == 1 and len(widget.closing["keyframes"]) > 2 and widget.closing["words"]
    widget.rank = 2
    assert len(widget.closing["keyframes"]) == 2


def test_the_state_is_plain_and_small(widget: Any) -> None:
    """It is stored in the notebook as JSON."""
    widget.force = [12.0, 9.0, 150.0, 240.0]
    widget.asked_closing = 1
    state = {name: value for name, value in widget.get_state().items() if name != "layout"}
    assert len(json.dumps(state)) < 60_000


def test_a_picture_stands_where_widgets_are_not_known(widget: Any) -> None:
    """The bundle has the widget, the fixture as HTML, and short text."""
    widget.rank = 2
    bundle, _ = widget._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in bundle
    assert bundle["text/html"] == widget._repr_html_() == RESULT[1]._repr_html_()
    assert bundle["text/plain"] == f"<FixtureWidget: fixture 2 of {len(RESULT)} of wedge>"


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"rank": 0}, "there is no fixture 0"),
        ({"rank": 10**6}, "there is no fixture 1000000"),
        ({"usual": 0.0}, "give one above 0"),
        ({"usual": float("nan")}, "give one above 0"),
        ({"jaw": "soft"}, "soft"),
    ],
)
def test_values_that_cannot_be_are_refused(asked: dict[str, Any], words: str) -> None:
    pytest.importorskip("anywidget", reason="the extra 'widget' is not installed")
    with pytest.raises(InputError, match=words):
        RESULT.widget(**asked)


def test_without_the_library_there_is_a_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """It shows the fixture and how to get one that moves; a rank of none is refused as well."""
    monkeypatch.setattr(notebook, "find_spec", lambda name: None)
    still = RESULT.widget(2)
    html = still._repr_html_()
    assert html.startswith(str(RESULT[1]._repr_html_())) and "anywidget" in html
    assert repr(still) == f"<StillPicture: fixture 2 of {len(RESULT)} of wedge>"
    with pytest.raises(InputError, match="there is no fixture 0"):
        RESULT.widget(0)


def test_a_result_without_fixtures_has_no_widget() -> None:
    none = RESULT.slice_rows(slice(0, 0))
    with pytest.raises(InputError, match="no fixture"):
        none.widget()
