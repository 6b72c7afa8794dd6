"""The picture that is pushed and closed: arrows are forces, forces are those of the statics, closing comes home."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

import pytest

import workhold
from workhold import Load
from workhold.errors import InputError
from workhold.presenting.closing_shown import show_closing
from workhold.presenting.live_picture import USUAL, LivePicture, TriedForce
from workhold.statics.loads import compute_load_cases

WEDGE = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
VISE = workhold.design(WEDGE, workhold.Vise(pitch=15, columns=1, peg_radius=2))
PLATE = workhold.design(
    WEDGE, workhold.Plate(pitch=15, peg_radius=2, columns=6, rows=6, travel=(5, 30)), best=3
)
TWO = workhold.design(WEDGE, workhold.Plate(pitch=15, peg_radius=2, columns=6, rows=6, clamps=2), best=3)
ANY = pytest.mark.parametrize("result", [VISE, PLATE, TWO], ids=["vise", "plate", "two clamps"])


def live(result: workhold.Result, index: int = 0) -> LivePicture:
    """The picture of a fixture, with 200 N as the usual force."""
    return LivePicture.from_result(result, index, 200.0)


@ANY
def test_an_arrow_is_the_force_that_it_shows(result: workhold.Result) -> None:
    """There and back it is the same, and a force turns with the part."""
    picture = live(result)
    push = TriedForce(12.0, 9.0, 150.0, 240.0)
    arrow = picture.compute_push_arrow(push)
    assert math.hypot(arrow[2] - arrow[0], arrow[3] - arrow[1]) == pytest.approx(0.75 * USUAL)
    assert picture.read_push(arrow).numbers == pytest.approx(push.numbers)
    # On the page y runs down: a force along the part's x axis points where that axis is turned to.
    x, y, to_x, to_y = picture.compute_push_arrow(TriedForce(0.0, 0.0, 200.0, 0.0))
    angle = math.radians(picture.fixture.pose.theta_deg)
    assert (to_x - x, y - to_y) == pytest.approx((USUAL * math.cos(angle), USUAL * math.sin(angle)))


@ANY
def test_contact_forces_are_those_of_the_statics(result: workhold.Result) -> None:
    """With as much force as is needed, and with too little, when the peg that lets go is named."""
    picture, push = live(result), TriedForce(12.0, 9.0, 150.0, 240.0)
    load = Load(points=[(12.0, 9.0)], force=150.0, directions=(240.0, 240.0))
    (case,) = compute_load_cases(picture.fixture, WEDGE, result.toolkit, [load])
    answer = picture.answer(push, None, "screw")
    assert answer["holds"] is True and "Forces are for that" in answer["words"]
    # 200 N are 100 units, unless the largest would be longer than 170.
    factor = min(0.5, 170.0 / max(case.largest))
    for force, one in zip(case.largest, answer["forces"], strict=True):
        assert one["words"] == f"{max(force, 0.0):,.0f} N" and not one["pulls"]
        x, y, to_x, to_y = one["arrow"]
        assert math.hypot(to_x - x, to_y - y) == pytest.approx(factor * abs(force), abs=1e-6)
    weak = picture.answer(push, case.needed.value / 2, "screw")
    assert weak["holds"] is False and "a peg lets go" in weak["words"]
    assert f"must press with {math.ceil(case.needed.value):,} N" in weak["words"]
    loose = picture.fixture.pegs[case.needed.peg].hole
    assert f"below that {loose} does" in weak["words"]
    assert loose in [one["hole"] for one in weak["forces"] if one["pulls"] and one["words"] == "lets go"]


def test_contact_forces_point_into_the_part() -> None:
    """Pushed by a peg, away where it would have to pull."""
    picture = live(VISE)
    for number, (_, (nx, ny)) in enumerate(picture.bench.contacts):
        for force, way in ((50.0, -1), (-50.0, 1)):
            x, y, to_x, to_y = picture.compute_force_arrow(number, force)
            assert (to_x - x) * nx - (to_y - y) * ny == pytest.approx(way * 50.0)


def test_what_is_no_force_asks_for_one() -> None:
    """Too short an arrow, and no arrow."""
    picture = live(VISE)
    push = picture.read_push([100.0, 100.0, 102.0, 101.0])
    assert push.size == 0 and picture.answer(push, None, "screw")["holds"] is None
    for bad in ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0, "x"], [0.0, 0.0, math.nan, 0.0], [0.0, 0.0, math.inf, 1.0]):
        with pytest.raises(InputError, match="four"):
            picture.read_push(bad)  # type: ignore[arg-type]


@ANY
def test_what_moves_stands_in_groups_of_its_own(result: workhold.Result) -> None:
    """Every peg has its name, the part is one group, and the ways are those of what clamps."""
    picture = live(result)
    root = ET.fromstring(picture.draw_svg().encode())
    assert len(root.findall("{*}g[@class='part']")) == 1
    names = {text.text for text in root.iter("{http://www.w3.org/2000/svg}text")}
    assert names >= {peg.hole for peg in picture.fixture.pegs}
    moving = root.findall("{*}g[@class='moves']")
    ways = {tuple(round(float(one), 6) for one in group.get("data-way", "").split()) for group in moving}
    scale, seen = picture.view.scale, picture.bench.shown
    clamping = [one.clamping for one in (*seen.carriers, *seen.clamps) if one.clamping is not None]
    assert ways == {(round(x * scale, 6), round(-y * scale, 6)) for x, y in clamping} != set()


def test_names_stay_on_the_page() -> None:
    for index in range(min(len(VISE), 40)):
        root = ET.fromstring(live(VISE, index).draw_svg().encode())
        for text in root.iter("{http://www.w3.org/2000/svg}text"):
            assert 10 < float(text.get("x", "")) < 630 and 0 < float(text.get("y", "")) < 480


@pytest.mark.thorough
def test_a_closing_comes_home() -> None:
    """It ends in the fixture's place with nothing open, begins off it, and what is read is said."""
    shown = 0
    for index in range(8):
        picture = live(VISE, index)
        closing = show_closing(picture)
        assert closing["keyframes"][-1] == pytest.approx([0.0] * 4, abs=2e-3)
        assert closing["keyframes"][0][3] > 0 and len(closing["keyframes"]) <= 121
        if len(closing["keyframes"]) > 2:
            shown += 1
            assert f"S = {picture.fixture.travel:.3f} mm" in closing["words"]
            assert any(abs(value) > 0.1 for value in closing["keyframes"][0][:3])
            opened = [one[3] for one in closing["keyframes"]]
            assert opened == sorted(opened, reverse=True)
    assert shown > 0


def test_a_keyframe_is_where_the_part_lies() -> None:
    """Turned about its middle and shifted, every point of the part is where its pose puts it."""
    picture = live(VISE)
    pose = workhold.Pose(picture.fixture.pose.theta_deg + 7.0, 3.0, -2.0)
    turned, dx, dy, _ = picture.make_keyframe(pose, 1.0)
    cx, cy = picture.center
    for point in ((0.0, 0.0), (41.0, 0.0), (13.0, 37.0)):
        x, y = picture.view(picture.fixture.pose.apply(*point))
        c, s = math.cos(math.radians(-turned)), math.sin(math.radians(-turned))
        there = cx + dx + c * (x - cx) - s * (y - cy), cy + dy + s * (x - cx) + c * (y - cy)
        assert there == pytest.approx(picture.view(pose.apply(*point)), abs=0.01)


def test_two_clamps_say_in_which_order_they_are_tightened() -> None:
    closing = show_closing(live(TWO))
    assert "clamp" in closing["words"] and closing["keyframes"][0][3] > 0


def test_a_clamp_is_drawn_back_no_farther_than_it_goes() -> None:
    """Its stroke of at least 5 mm stays."""
    for index in range(len(PLATE)):
        picture = live(PLATE, index)
        (clamp,) = picture.bench.shown.clamps
        assert clamp.hole is not None
        stroke = math.hypot(clamp.tip.x - clamp.hole[0], clamp.tip.y - clamp.hole[1])
        assert 0 <= picture.opened <= stroke - 5.0 + 1e-9
