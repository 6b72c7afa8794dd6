"""Set-ups on supports in STEP and GLB: every body in place with its name and colour, none inside another."""

from __future__ import annotations

import json
from math import pi
from pathlib import Path

import pytest
from attrs import evolve

from files.step_bodies import assert_apart, named_bodies, volume
from files.step_shapes import box, fused
from workhold import Result, Vise, design, load
from workhold.errors import InputError
from workhold.files.supports_file import read_supports, write_supports
from workhold.model.support_bodies import list_bodies_with_supports
from workhold.model.support_triples import ChosenSupports, Supports
from workhold.presenting.assembly import Assembly
from workhold.verification.supports import verify_supports_file

LOW, HIGH = 20.0, 34.0
VISE = Vise(pitch=10, columns=8, peg_radius=3)


@pytest.fixture(scope="module")
def result() -> Result:
    """Fixtures of a plate with a step, higher over a third of it."""
    stepped = fused(box(90, 60, LOW), box(30, 60, HIGH))
    return design(load(stepped, name="stepped", peg_height=12), VISE, best=4)


def on_face(result: Result, at: tuple[float, float], tip_radius: float = 5.0) -> ChosenSupports:
    """The best supports with the clamp at a point of the part."""
    asked = result.supports(best=4, point=at, inside=1, tip_radius=tip_radius, head_radius=tip_radius)
    found = next(one for one in asked if one.triples)
    return ChosenSupports.from_supports(
        evolve(found, triples=tuple(t for t in found.triples if t.given is not None))
    )


def assembled(chosen: ChosenSupports) -> Assembly:
    """The bodies of a set-up on chosen supports."""
    fixture = chosen.supports.fixture
    return Assembly.from_fixture(fixture, fixture.listing.result, {}, chosen)


@pytest.mark.parametrize(
    ("at", "tip", "room"), [((60, 30), 5, 25 * pi), ((20, 30), 5, 0), ((60, 30), 30, 90 * 60)]
)
def test_no_body_is_inside_another(result: Result, at: tuple[float, float], tip: float, room: float) -> None:
    """Above a lower face the part has room for the clamp: a well, or all where the tip reaches to its border."""
    chosen = on_face(result, at, tip)
    bodies = named_bodies(assembled(chosen).make_file_content(".step"))
    assert_apart(bodies)
    assert [body[:2] for body in bodies] == [
        ("stepped", "part"),
        *((f"peg {peg.hole}", "peg") for peg in chosen.recounted.fixture.pegs),
        ("left jaw", "plate"),
        ("right jaw", "plate"),
        *((f"support {pad.hole}", "support") for pad in chosen.pads),
        ("clamp on top", "clamp"),
    ]
    assert volume(bodies[0][2]) == pytest.approx(90 * 60 * HIGH - room * (HIGH - LOW))
    low = chosen.supports.fixture.listing.result.query.toolkit.peg_radius**2 * pi
    pad = chosen.supports.request.pad_radius**2 * pi
    pads = [volume(shape) for _, kind, shape in bodies if kind == "support"]
    assert pads == pytest.approx([10 * low + 10 * pad] * 3)


def test_python_writes_supports_into_step_and_sheets(result: Result, tmp_path: Path) -> None:
    """``save_sheet`` has them in a .step as in the command's file, and on paper; a .dxf has none."""
    chosen = on_face(result, (60, 30))
    found = chosen.supports
    for name in ("a.step", "a.svg"):
        found.fixture.save_sheet(tmp_path / name, supports=found)
    assert (tmp_path / "a.step").read_bytes() == assembled(chosen).make_file_content(".step")
    assert "clamp" in (tmp_path / "a.svg").read_text(encoding="utf-8").lower()
    with pytest.raises(InputError, match=r"a\.dxf has no supports: let the name end in"):
        found.fixture.save_sheet(tmp_path / "a.dxf", supports=found)
    with pytest.raises(InputError, match="there is no set 99"):
        found.fixture.save_sheet(tmp_path / "a.step", supports=found, best=99)


@pytest.mark.parametrize(("at", "height"), [((60, 30), LOW), ((20, 30), HIGH)])
def test_the_clamp_stands_on_the_face_at_its_place(
    result: Result, at: tuple[float, float], height: float, tmp_path: Path
) -> None:
    """Its tip ends on the face under it, above which the knob is free of everything; a file keeps that."""
    chosen = on_face(result, at)
    write_supports(chosen.supports, tmp_path / "supports.json")
    again = ChosenSupports.from_supports(read_supports(tmp_path / "supports.json"))
    for one in (chosen, again):
        clamp = list_bodies_with_supports(one)[-1]
        assert clamp.name == "clamp on top"
        assert clamp.slabs[0].low == pytest.approx(height)
        assert clamp.slabs[-1].low > HIGH
    assert again.supports.request.top_heights == chosen.supports.request.top_heights


def test_heights_of_upper_faces_are_one_for_each_loop(result: Result) -> None:
    """Where a file has more or fewer, it says so; without any the clamp stands on top of the part."""
    request = on_face(result, (60, 30)).supports.request
    with pytest.raises(InputError, match=r"2 loops of upper faces and 1 heights"):
        evolve(request, top_heights=(20.0,))
    assert evolve(request, top_heights=None).find_clamped_height((60, 30)) == HIGH


def test_a_file_of_supports_has_the_solid_and_is_verified(tmp_path: Path) -> None:
    """Two faces of one line, told apart by their bands, keep their numbers; sheets of the file have the heights."""
    stepped = load(fused(box(90, 60, LOW), box(30, 60, HIGH)), name="stepped", peg_height=25)
    found = next(
        one for one in design(stepped, VISE, best=40).supports(best=40) if one.triples and split(one)
    )
    path = tmp_path / "supports.json"
    write_supports(found, path)
    judged = verify_supports_file(path)
    assert judged.faults == () and judged.proven == len(found.triples) > 0
    again = read_supports(path)
    assert again.query.workpiece.solid == found.query.workpiece.solid
    again.fixture.save_sheet(tmp_path / "a.svg", supports=again)
    assert "+25.000 top of the pegs" in (tmp_path / "a.svg").read_text(encoding="utf-8")
    entry = json.loads(path.read_text())
    del entry["solid"]
    path.write_text(json.dumps(entry))
    assert any("its planar fixture is refuted" in fault for fault in verify_supports_file(path).faults)


def split(one: Supports) -> bool:
    """Whether a peg touches a face that is not a face of the outline without bands."""
    workpiece = one.query.workpiece
    alone = {face.number for face in evolve(workpiece, solid=None).faces}
    return any(peg.face not in alone for peg in one.fixture.pegs)
