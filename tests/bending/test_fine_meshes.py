"""Six solids against meshes eight times as fine: what is told lies within the error that is told."""

from __future__ import annotations

from pathlib import Path

import pytest
from step_shapes import write_step

import workhold
from bent_bodies import need_elements, refine_mesh
from bent_solids import SOLIDS
from workhold import Load, Result
from workhold.bending import asking
from workhold.bending.asking import BendingQuestion, find_bendings
from workhold.bending.figures import Bending
from workhold.bending.meshing import make_mesh
from workhold.model.elastic_material import find_material
from workhold.presenting.assembly import read_part_shape
from workhold.presenting.bent import make_shape_to_bend

need_elements()

VISE = workhold.Vise(pitch=10, columns=4, peg_radius=3)
FORCE, BEST = 3000.0, 20


def fixtures_of(path: Path) -> Result:
    """The best fixtures of a solid under a load in its middle and one near a corner."""
    part = workhold.load(path)
    x0, y0, x1, y1 = part.bounds
    places = [((x0 + x1) / 2, (y0 + y1) / 2), (x0 + 0.2 * (x1 - x0), y0 + 0.1 * (y1 - y0))]
    load = Load(points=places, force=150)
    return workhold.design(part, VISE, best=BEST, loads=[load], jaw_force=FORCE)


def bend_all(result: Result, path: Path) -> list[Bending]:
    asked = BendingQuestion(find_material("aluminium-6061"))
    shape = make_shape_to_bend(result.query, asked, read_part_shape(path, result.workpiece))
    return find_bendings(result, range(len(result)), shape, asked)


@pytest.mark.prove
@pytest.mark.parametrize("name", SOLIDS)
def test_figures_lie_within_the_error_told(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_step(tmp_path / f"{name}.step", SOLIDS[name]())
    result = fixtures_of(path)
    told = bend_all(result, path)
    monkeypatch.setattr(asking, "make_mesh", lambda shape: refine_mesh(make_mesh(shape)))
    finer = bend_all(result, path)
    assert len(told) == len(finer) == BEST
    for one, other in zip(told, finer, strict=True):
        assert one.give is not None and other.give is not None
        for usual, fine in ((one.clamp_distortion, other.clamp_distortion), (one.give, other.give)):
            assert abs(usual.value - fine.value) <= usual.error
