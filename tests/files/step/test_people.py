"""STEP files as programs write them: walls as extruded splines, holes without a seam, rings that lie, nuts."""

from __future__ import annotations

from math import pi, sqrt, tan
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeTorus
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from step_shapes import box, cut, cylinder

from solid_examples import polygon, tilted
from workhold import Workpiece, load
from workhold.errors import InputError
from workhold.files.step import bands
from workhold.files.step.bands import Conic
from workhold.files.step.heights import StandingSolid, measure_outline, stand_solid, tabulate_peg_heights
from workhold.files.step.projected import cut_edges, cut_lying_ring
from workhold.files.step.solids import read_solids
from workhold.geometry.loop import compute_signed_area, make_loop_segments

DATA = Path(__file__).parents[2] / "data" / "step"


def area_of(part: Workpiece) -> float:
    """The area within the loops of a part, in mm²."""
    return sum(compute_signed_area(make_loop_segments(loop)) for loop in part.loops)


def test_a_wall_that_is_an_extruded_spline_is_read_by_fit() -> None:
    """The library's volume of it is rough; without a fit one is proposed."""
    path = DATA / "extruded_oval_hole.step"
    with pytest.raises(InputError, match=r"are true curves.*give fit 0\.01"):
        load(path)
    part = load(path, fit=0.01)
    assert len(part.loops) == 2 and part.bounds == pytest.approx((0, 0, 60, 40))
    assert area_of(part) * 8 == pytest.approx(18068.71, rel=1e-4)


def test_a_closed_spline_without_a_seam_is_read() -> None:
    """The library cuts it open itself, and fails over that when asked what it is."""
    part = load(DATA / "seamless_spline_hole.step", fit=0.01)
    assert len(part.loops) == 2 and part.bounds == pytest.approx((0, 0, 60, 40))
    assert 2400 - area_of(part) == pytest.approx(36 * pi, rel=1e-3)


def test_cuts_of_a_lying_ring_are_those_of_the_library() -> None:
    """At many heights, over the fillets of a shaft."""
    (solid,) = read_solids((DATA / "lying_shaft_fillets.step").read_bytes())
    rings = [face for face in stand_solid(solid.shape).faces if face.kind == "rounded rim"]
    assert len(rings) > 8
    for face in rings[:6]:
        for share in (0.1, 0.4, 0.7, 0.93):
            z = face.low + share * (face.high - face.low)
            own = cut_lying_ring(BRepAdaptor_Surface(face.shape), z)
            known = cut_edges(face.shape, z)
            assert len(own) >= 1 and len(known) >= 1
            ours = np.concatenate([one for one in own if isinstance(one, np.ndarray)])
            theirs = np.concatenate([one for one in known if isinstance(one, np.ndarray)])
            off = np.hypot(*np.moveaxis(theirs[:, None] - ours[None], -1, 0)).min(axis=1)
            step = np.hypot(*np.diff(ours, axis=0).T)
            assert off.max() <= float(np.sort(step)[-3])


@pytest.mark.parametrize("high", [20.5, 23.0])
def test_cuts_of_a_lying_ring_run_to_where_its_tube_ends(high: float) -> None:
    """A tube of radius 5 mm about a circle of 20 mm is met, high above the axis, as far along it as its own circle."""
    ring = BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), 20, 5).Face()
    x, y = np.concatenate(cut_lying_ring(BRepAdaptor_Surface(ring), high)).T
    along = sqrt(25 - (high - 20) ** 2)
    assert (x.min(), x.max()) == pytest.approx((-along, along), abs=1e-9)
    assert y[[x.argmin(), x.argmax()]] == pytest.approx(0, abs=1e-4)


def nut(across: float = 40.0, high: float = 18.0) -> object:
    """A hexagon with a bore and a chamfer cone at 30 degrees above that ends a mm within its flats."""
    size = across / sqrt(3)
    corners = [(size * np.cos(k * pi / 3), size * np.sin(k * pi / 3)) for k in range(6)]
    body = polygon([(float(x), float(y)) for x, y in corners], high)
    slope = tan(pi / 6)
    low = across / 2 - 1.0 + high / slope
    cone = BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), low, across / 2 - 1.0, high).Shape()
    return cut(BRepAlgoAPI_Common(body, cone).Shape(), cylinder(9, 60, (0, 0, -1)))


@pytest.mark.parametrize("gap", [0.0, *(s * 5 * 10.0**-p for p in range(3, 10) for s in (1, -1))])
def test_a_nut_is_its_hexagon_at_every_height(gap: float) -> None:
    """The cut of the chamfer at the pegs' end touches the flats from within: it is not a border."""
    across, high = 40.0, 18.0
    tangent = high - tan(pi / 6)
    outline = stand_solid(nut(across, high)).make_outline(tangent + gap - 0.5)
    area, border, _, _ = measure_outline(outline)
    assert area == pytest.approx(across**2 * sqrt(3) / 2 - 81 * pi, abs=1e-6)
    assert border == pytest.approx(6 * across / sqrt(3) + 18 * pi, abs=1e-6)
    assert len(outline.loops) == 2


def test_lying_shaft_makes_few_outlines_for_its_table(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of one outline pegs that reach farther touch no less, so not every height of it is looked at."""
    (solid,) = read_solids((DATA / "lying_shaft_fillets.step").read_bytes())
    made: list[float] = []
    whole = StandingSolid.make_outline

    def counted(self: StandingSolid, peg_height: float, *more: object, **named: object) -> object:
        made.append(peg_height)
        return whole(self, peg_height, *more, **named)

    monkeypatch.setattr(StandingSolid, "make_outline", counted)
    (row,) = tabulate_peg_heights(stand_solid(solid.shape), 0.5, 1.0)
    # Cuts less than 0.000001 mm beside the folds of the fillets are one with them, and so a little below the axis.
    assert 8.495 < row.low < 8.5 and row.high == 18.0
    assert len(made) <= 4


@pytest.mark.parametrize(
    "gap", [0.0, 1e-6, 1e-4, 2e-3, 4e-3, 5.6e-3, 7e-3, 0.01, 0.015, 0.02, 0.037, 0.05, 0.5]
)
def test_lying_shaft_is_its_silhouette_from_its_axis_up(gap: float) -> None:
    """Cuts of its fillets just above run nearer beside their folds than can be looked at, and are not a border."""
    (solid,) = read_solids((DATA / "lying_shaft_fillets.step").read_bytes())
    standing_shaft = stand_solid(solid.shape)
    whole = measure_outline(standing_shaft.make_outline(18.0))
    area, border, *_ = measure_outline(standing_shaft.make_outline(8.5 + gap))
    assert (area, border) == pytest.approx(whole[:2], abs=2e-5)


@pytest.mark.parametrize("gap", [0.005, 0.007, 0.01, 0.1, 2.0])
def test_lying_shaft_is_refused_below_its_axis(gap: float) -> None:
    """There the cuts of its fillets are the border, also where they run near beside the folds."""
    (solid,) = read_solids((DATA / "lying_shaft_fillets.step").read_bytes())
    with pytest.raises(InputError, match="rounded rim"):
        stand_solid(solid.shape).make_outline(8.5 - gap)


def test_heights_of_circles_and_ellipses_are_told_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are where the library's curves have them, found without asking these again and again."""
    shaft = cut(cylinder(20, 60, (0, 0, 0), (1, 0, 0)), box(20, 9, 50, (15, 4, -25)))
    pillar = cut(cylinder(12, 50, (0, 0, 0)), tilted((0, 0, 40), (-0.4, 0.2, 1), (1, 0, 0.4)))
    whole = Conic.from_curve
    for shape in (shaft, pillar):
        found, known = [], []
        for told, asked in ((found, False), (known, True)):
            if asked:
                monkeypatch.setattr(Conic, "from_curve", lambda curve: None)
            else:
                monkeypatch.setattr(
                    bands, "find_zero_crossing", lambda *_: pytest.fail("the library is asked")
                )
            outline = stand_solid(shape).make_outline()
            told += [row for rows in outline.runs for row in rows] + list(outline.bands)
            monkeypatch.undo()
        assert Conic.from_curve == whole and len(found) == len(known) > 4
        for one, other in zip(found, known, strict=True):
            assert one == pytest.approx(other, abs=2e-7)
