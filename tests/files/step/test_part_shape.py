"""The shape of a part read again from its STEP file: in place, of the solid's volume, and of no other part."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepExtrema import BRepExtrema_DistShapeShape

from files.step_bodies import assert_apart, named_bodies, volume
from files.step_shapes import at_height, box, cut, cylinder, filleted, fused, write_step
from glb_reading import read_glb
from workhold import Result, Vise, design, load
from workhold.errors import InputError
from workhold.files.step.part_shape import make_part_shape

VISE = Vise(pitch=10, columns=8, peg_radius=3)
BORE = cylinder(8, 50, (60, 30, -5))


@pytest.fixture(scope="module")
def part(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A flanged part with a fillet, a bore and a step, away from its model's origin, beside a small block."""
    body = cut(fused(box(90, 60, 20), box(30, 60, 34), box(98, 60, 6, (-4, 0, 20))), BORE)
    rounded = filleted(body, 2, at_height(34))
    folder = tmp_path_factory.mktemp("parts")
    return write_step(folder / "flanged.step", box(5, 5, 5, (200, 0, 0)), rounded)


@pytest.fixture(scope="module", params=["z", "-z", "x"])
def result(request: pytest.FixtureRequest, part: Path) -> Result:
    """Fixtures of the part with a side up."""
    seen = load(part, axis=request.param, peg_height=9)
    return design(seen, VISE, best=3)


def test_the_shape_stands_where_the_pegs_touch_it(result: Result, part: Path, tmp_path: Path) -> None:
    """In STEP and GLB it has the volume of the solid, pegs touch it and enter it nowhere."""
    solid = volume(load_shape(part))
    result[0].save_sheet(tmp_path / "a.step", part=part)
    bodies = named_bodies((tmp_path / "a.step").read_bytes())
    assert bodies[0][:2] == ("flanged", "part") and len(bodies) == 1 + 4 + 2
    assert volume(bodies[0][2]) == pytest.approx(solid, rel=1e-6)
    assert_apart(bodies)
    for name, kind, shape in bodies:
        if kind == "peg":
            assert BRepExtrema_DistShapeShape(shape, bodies[0][2]).Value() < 1e-6, name
    result[0].save_glb(tmp_path / "a.glb", part=part)
    (own, *others) = read_glb((tmp_path / "a.glb").read_bytes())[1]
    own.assert_closed()
    assert own.volume == pytest.approx(solid, rel=3e-3) and own.kind == "part" and len(others) == 6
    from workhold.files.step.library import compute_bounding_box

    low, high = compute_bounding_box(bodies[0][2])
    assert np.allclose(own.positions.min(axis=0), low, atol=0.06)
    assert np.allclose(own.positions.max(axis=0), high, atol=0.06)


def load_shape(part: Path) -> object:
    """The larger solid of the file."""
    from workhold.files.step.solids import read_solids

    return max(read_solids(part.read_bytes()), key=lambda one: one.volume).shape


def test_another_part_is_refused(result: Result, tmp_path: Path) -> None:
    """One that is lower, one without a bore that shows, and a file that is none; each in a sentence with its name."""
    body = cut(fused(box(90, 60, 20), box(30, 60, 34), box(98, 60, 6, (-4, 0, 20))))
    # Along x the bore is not in the outline.
    seen = result.workpiece.solid is not None and result.workpiece.solid.axis != "x"
    for other in (box(90, 60, 33), *([filleted(body, 2, at_height(34))] if seen else [])):
        path = write_step(tmp_path / "other.step", other)
        with pytest.raises(InputError, match=r"other\.step: no solid of the STEP file gives the outline"):
            result[0].save_glb(tmp_path / "a.glb", part=path)
    # A recess from below or above leaves outline and height; along x no level face and no band shows it.
    for recess in ((15, 12, 2, (33, 3, 0)), (15, 12, 2, (33, 3, 24))) if seen else ():
        path = write_step(
            tmp_path / "cut.step", cut(filleted(cut(body, BORE), 2, at_height(34)), box(*recess))
        )
        with pytest.raises(InputError, match=r"cut\.step: no solid of the STEP file gives the outline"):
            result[0].save_glb(tmp_path / "a.glb", part=path)
    (tmp_path / "none.step").write_text("ISO-10303-21;")
    with pytest.raises(InputError, match=r"none\.step: "):
        result[0].save_glb(tmp_path / "a.glb", part=tmp_path / "none.step")
    with pytest.raises(InputError, match="was not read from a solid"):
        make_part_shape(b"", load("widget"))
    with pytest.raises(InputError, match=r"a\.pdf has no shape of the part"):
        result[0].save_sheet(tmp_path / "a.pdf", part=path)
    assert not (tmp_path / "a.glb").exists()
