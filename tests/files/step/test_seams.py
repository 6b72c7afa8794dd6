"""Bands of round walls wherever their seam lies: the edge on which the surface of a cylinder closes."""

from __future__ import annotations

from math import pi
from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf
from step_shapes import box, cylinder, fused

from workhold import load


def boss_on_an_arm(turned: float) -> Any:
    """A boss 24 mm high at the end of an arm from 8 to 18 mm; its seam lies opposite the arm."""
    turn = gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), turned * pi / 180)
    shape = fused(box(50, 10, 10, (0, -5, 8)), cylinder(11, 24, (50, 0, 0)))
    return BRepBuilderAPI_Transform(shape, turn, True).Shape()


@pytest.mark.parametrize("turned", [0, 80, 180, 270])
@pytest.mark.parametrize(("axis", "arm"), [("z", (8.0, 18.0)), ("-z", (6.0, 16.0))])
def test_a_boss_is_touched_all_round_wherever_its_seam_is(turned: float, axis: str, arm: Any) -> None:
    """Half of the boss had no band, and a part was refused, where the seam pointed to -x of the set-up."""
    solid = load(boss_on_an_arm(turned), name="arm", axis=axis).solid
    assert solid is not None
    rounded = {None if band is None else (round(band[0], 6), round(band[1], 6)) for band in solid.bands}
    assert rounded == {(0.0, 24.0), arm}
