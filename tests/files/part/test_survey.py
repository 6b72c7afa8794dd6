"""A survey tells what a file leaves open, and answering it leads to the part."""

from __future__ import annotations

from math import dist
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from attrs import evolve

from workhold.files.budget import LIMITS, Budget
from workhold.files.part.load import read_workpiece
from workhold.files.part.survey import survey_part_file
from workhold.files.questions import name_questions

EXAMPLES = Path(__file__).parents[3] / "examples"
CORNERS = [(0.0, 0.0), (100.0, 0.0), (100.0, 60.0), (40.0, 80.0), (0.0, 60.0)]
CALLED = {"unit": '"Unit"', "join_tolerance": '"Join"', "part_number": '"Part"', "layers": '"Layers"'}


def drawn(path: Path, units: int = 4, gaps: tuple[float, ...] = (0.0,) * 5, hole: bool = True) -> Path:
    """A pentagon of lines, each as much too short at its end as a gap says, with a hole."""
    document = ezdxf.new(units=units)
    space = document.modelspace()
    for start, end, gap in zip(CORNERS, CORNERS[1:] + CORNERS[:1], gaps, strict=True):
        share = 1.0 - gap / dist(start, end)
        space.add_line(start, [a + share * (b - a) for a, b in zip(start, end, strict=True)])
    if hole:
        space.add_circle((30, 30), 8)
    document.saveas(path)
    return path


def test_a_part_that_can_be_read_is_read_as_ever() -> None:
    """The same part, remarks and parts; nothing is asked."""
    seen, loaded = (
        survey_part_file(EXAMPLES / "bracket.dxf", called=CALLED),
        read_workpiece(EXAMPLES / "bracket.dxf", called=CALLED),
    )
    assert seen.loaded is not None
    assert seen.loaded.workpiece == loaded.workpiece and seen.loaded.remarks == loaded.remarks
    assert (seen.refusal, seen.asked) == ("", ())
    assert [part.number for part in seen.parts] == [1]
    # The line outside is drawn too.
    assert seen.size == pytest.approx((132, 70))


@pytest.mark.parametrize("kind", ["dxf", "svg"])
def test_a_drawing_without_a_unit_is_asked_for_it(tmp_path: Path, kind: str) -> None:
    """With its size in its own unit; in the unit answered it is that much larger."""
    path = tmp_path / f"part.{kind}"
    if kind == "dxf":
        drawn(path, units=0)
    else:
        path.write_text('<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H100V80H0Z"/></svg>')
    seen = survey_part_file(path, called=CALLED)
    assert seen.loaded is None and seen.asked == ("unit",)
    assert '"Unit"' in seen.refusal and "<unit>" not in seen.refusal
    assert seen.size == pytest.approx((100, 80))
    for unit, factor in (("mm", 1.0), ("inch", 25.4)):
        answered = survey_part_file(path, unit=unit, called=CALLED)
        assert answered.loaded is not None and answered.asked == ()
        assert answered.size == pytest.approx((100 * factor, 80 * factor))
        x0, y0, x1, y1 = answered.loaded.workpiece.bounds
        assert (x1 - x0, y1 - y0) == pytest.approx((100 * factor, 80 * factor))


def test_gaps_are_those_that_were_left(tmp_path: Path) -> None:
    """Each width once; joining up to the widest gives the pentagon, and up to less does not."""
    gaps = (0.02, 0.15, 0.4, 0.0, 1.2)
    path = drawn(tmp_path / "gaps.dxf", gaps=gaps)
    seen = survey_part_file(path, called=CALLED)
    assert seen.gaps == pytest.approx((0.02, 0.15, 0.4, 1.2), rel=1e-5)
    for join, closed in ((0.5, False), (seen.gaps[-1] * (1 + 1e-5), True)):
        answered = survey_part_file(path, join_tolerance=join, called=CALLED)
        assert answered.gaps == seen.gaps
        loops = [] if answered.loaded is None else answered.loaded.workpiece.loops
        assert (len(loops) == 2) == closed


def test_an_outline_that_is_not_closed_asks_how_far_to_join(tmp_path: Path) -> None:
    """The refusal of the reader, and which question it leaves."""
    seen = survey_part_file(
        drawn(tmp_path / "open.dxf", gaps=(0.0, 0.0, 0.3, 0.0, 0.0), hole=False), called=CALLED
    )
    assert seen.loaded is None and seen.asked == ("join_tolerance",)
    assert '"Join"' in seen.refusal and seen.parts == ()
    assert len(seen.chains) == 5 and seen.gaps == pytest.approx((0.3,), rel=1e-5)


def test_all_parts_are_told(tmp_path: Path) -> None:
    """By decreasing area with their loops, whichever is read."""
    document = ezdxf.new(units=4)
    for x, size in ((0, 10), (40, 30), (100, 20)):
        document.modelspace().add_lwpolyline([(x, 0), (x + size, 0), (x + size, size), (x, size)], close=True)
    document.saveas(tmp_path / "parts.dxf")
    for number, size in ((None, 30), (2, 20), (3, 10)):
        seen = survey_part_file(tmp_path / "parts.dxf", part_number=number, called=CALLED)
        assert seen.loaded is not None
        assert seen.loaded.workpiece.bounds[3] == size
        assert [part.bounds[3] for part in seen.parts] == [30, 20, 10]


def test_layers_are_told_with_what_is_on_them(tmp_path: Path) -> None:
    """Those with lines or arcs, hidden or not, whichever are read; a file without layers has none."""
    document = ezdxf.new(units=4)
    document.layers.add("LOOSE").off()
    document.modelspace().add_lwpolyline(
        [(0, 0), (9, 0), (0, 9)], close=True, dxfattribs={"layer": "OUTLINE"}
    )
    document.modelspace().add_line((0, 0), (20, 20), dxfattribs={"layer": "LOOSE"})
    document.modelspace().add_text("note", dxfattribs={"layer": "WORDS"})
    document.saveas(tmp_path / "layers.dxf")
    for layers in (None, ["OUTLINE"]):
        seen = survey_part_file(tmp_path / "layers.dxf", layers=layers, called=CALLED)
        assert [(one.name, one.hidden, len(one.chains)) for one in seen.layers] == [
            ("LOOSE", True, 1),
            ("OUTLINE", False, 1),
        ]
    assert survey_part_file(EXAMPLES / "plate.json", called=CALLED).layers == ()


def test_ends_that_could_go_on_in_two_ways_are_refused_and_drawn(tmp_path: Path) -> None:
    """Three ends at a point: no parts, but a picture of all of it."""
    path = drawn(tmp_path / "three.dxf")
    document = ezdxf.readfile(path)
    document.modelspace().add_line((100, 0), (140, -20))
    document.saveas(path)
    seen = survey_part_file(path, called=CALLED)
    assert seen.loaded is None and "3 ends meet" in seen.refusal
    assert (seen.parts, seen.gaps, len(seen.chains)) == ((), (), 7)


def test_files_that_are_no_drawings_have_no_size(tmp_path: Path) -> None:
    """JSON is read, or refused, and has no strokes."""
    seen = survey_part_file(EXAMPLES / "plate.json", called=CALLED)
    assert seen.loaded is not None and (seen.size, seen.chains) == (None, ())
    (tmp_path / "note.txt").write_text("hello")
    seen = survey_part_file(tmp_path / "note.txt", called=CALLED)
    assert seen.loaded is None and "neither a JSON" in seen.refusal and seen.parts == ()


def test_no_mark_is_left_in_any_sentence(tmp_path: Path) -> None:
    """Refusals and remarks are in the words of whoever asks."""
    for path in (drawn(tmp_path / "a.dxf", units=0), EXAMPLES / "bracket.dxf"):
        seen = survey_part_file(path, called=CALLED)
        words = [seen.refusal, *(seen.loaded.remarks if seen.loaded else ())]
        assert [name_questions(one, None) for one in words] == words
    assert np.isfinite(survey_part_file(path, called=CALLED).size or np.nan).all()


@pytest.mark.parametrize("kind", ["dxf", "svg"])
def test_a_drawing_that_asks_for_too_much_is_read_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    """No second budget is spent on it, nor a third; it is refused as ever."""
    path = tmp_path / f"part.{kind}"
    if kind == "dxf":
        drawn(path)
    else:
        path.write_text('<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm"><g/><g/><g/></svg>')
    monkeypatch.setitem(LIMITS, kind, evolve(LIMITS[kind], most_elements=2))
    begun = []
    usual = Budget.__init__
    monkeypatch.setattr(
        Budget, "__init__", lambda self, *args: (begun.append(args[0].what), usual(self, *args))[1]
    )
    seen = survey_part_file(path, called=CALLED)
    assert seen.loaded is None and "more than the 2" in seen.refusal and seen.size is None
    assert begun.count(LIMITS[kind].what) == 1
