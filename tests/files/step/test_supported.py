"""Set-ups on supports in STEP and GLB: every body in place with its name and colour, none inside another."""

from __future__ import annotations

from pathlib import Path

import pytest
from attrs import evolve

from files.step_shapes import box, fused
from workhold import Result, Vise, design, load
from workhold.errors import InputError
from workhold.files.supports.reader import read_supports
from workhold.files.supports.writer import write_supports
from workhold.model.recounted import ChosenSupports
from workhold.model.support_bodies import bodies_with_supports

LOW, HIGH = 20.0, 34.0
VISE = Vise(pitch=10, columns=8, peg_radius=3)


@pytest.fixture(scope="module")
def result() -> Result:
    """Fixtures of a plate with a step, higher over a third of it."""
    stepped = fused(box(90, 60, LOW), box(30, 60, HIGH))
    return design(load(stepped, name="stepped", peg_height=12), VISE, best=4)


def on_face(result: Result, at: tuple[float, float]) -> ChosenSupports:
    """The best supports with the clamp at a point of the part."""
    found = next(one for one in result.supports(best=4, point=at, inside=1) if one.triples)
    return ChosenSupports.of(evolve(found, triples=tuple(t for t in found.triples if t.given is not None)))


@pytest.mark.parametrize(("at", "height"), [((60, 30), LOW), ((20, 30), HIGH)])
def test_the_clamp_stands_on_the_face_at_its_place(
    result: Result, at: tuple[float, float], height: float, tmp_path: Path
) -> None:
    """Its tip ends on the face under it, above which the knob is free of everything; a file keeps that."""
    chosen = on_face(result, at)
    write_supports(chosen.supports, tmp_path / "supports.json")
    again = ChosenSupports.of(read_supports(tmp_path / "supports.json"))
    for one in (chosen, again):
        clamp = bodies_with_supports(one)[-1]
        assert clamp.name == "clamp on top"
        assert clamp.slabs[0].low == pytest.approx(height)
        assert clamp.slabs[-1].low > HIGH
    assert again.supports.request.top_heights == chosen.supports.request.top_heights


def test_heights_of_upper_faces_are_one_for_each_loop(result: Result) -> None:
    """Where a file has more or fewer, it says so; without any the clamp stands on top of the part."""
    request = on_face(result, (60, 30)).supports.request
    with pytest.raises(InputError, match=r"2 loops of upper faces and 1 heights"):
        evolve(request, top_heights=(20.0,))
    assert evolve(request, top_heights=None).clamped_height((60, 30)) == HIGH
