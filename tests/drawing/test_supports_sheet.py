"""Supports and the clamp on top on the sheet: where they stand, with what force, and what to take for them."""

from __future__ import annotations

from math import ceil, hypot

import pytest
from attrs import evolve
from space_examples import HEIGHT, NAMES, SOLID, chosen, printed, result_of, sheet
from svg_reading import by_class, texts, to_model

from body_examples import BLOCK, TOOLKITS
from workhold import Workpiece, design
from workhold.drawing.hardware_table import list_hardware
from workhold.drawing.scene import LengthUnit
from workhold.drawing.supports_drawn import explain_hole_names
from workhold.drawing.upper_side import describe_solid_side_up
from workhold.model.dowel_lengths import find_shortest_dowel, list_standouts
from workhold.model.first_side import FirstSide
from workhold.model.setup import choose_part_zero
from workhold.model.solid import SolidOutline
from workhold.model.support_triples import ChosenSupports
from workhold.units import INCH, MILLIMETRE


def supports_of_sheet(name: str, loaded: bool = False) -> ChosenSupports:
    """The supports under the block in a toolkit; every kind has some."""
    found = chosen(name, loaded)
    assert found is not None
    return found


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_supports_stand_on_the_plan_in_the_holes_that_are_named(name: str) -> None:
    """Each sign is at the place of a hole, whose name stands on the plan; the clamp is where it presses."""
    found, toolkit = supports_of_sheet(name), result_of(name).toolkit
    page = sheet(result_of(name, False), thickness=HEIGHT, supports=found)[0]
    (group,) = by_class(page, "supports")
    pose, travel = found.recounted.fixture.pose, found.recounted.fixture.travel
    places = [
        to_model(group, float(one.attrib["cx"]), float(one.attrib["cy"])) for one in by_class(page, "support")
    ]
    (labels,) = by_class(page, "labels")
    written = [element.text for element in labels.iter() if element.tag.endswith("text")]
    for pad, place in zip(found.pads, places, strict=True):
        there = toolkit.find_carrier(pad.carrier).compute_hole_center(pad.column, pad.row, travel)
        assert place == pytest.approx(there, abs=2e-3) and pad.hole in written
    (tip,) = by_class(page, "top-clamp")
    at = to_model(group, float(tip.attrib["cx"]), float(tip.attrib["cy"]))
    assert at == pytest.approx(pose.apply(*found.clamp.at), abs=2e-3) and "clamp on top" in written
    # The clamp is within the triangle that is drawn, its arm from the nearest side.
    assert len(by_class(page, "support-triangle")) == 3
    arms = []
    for k in range(3):
        (x0, y0), (x1, y1) = places[k], places[(k + 1) % 3]
        arms.append(abs((x1 - x0) * (at[1] - y0) - (y1 - y0) * (at[0] - x0)) / hypot(x1 - x0, y1 - y0))
    assert min(arms) == pytest.approx(found.clamp.arm, abs=5e-3)
    # Pegs of the sheet stand in the same plates, whose holes all have names.
    pegs = [(peg.x, peg.y) for peg in found.recounted.fixture.placed]
    (own,) = by_class(page, "pegs")
    drawn = [to_model(own, float(one.attrib["cx"]), float(one.attrib["cy"])) for one in own if one.get("cx")]
    for place in drawn:
        assert any(place == pytest.approx(peg, abs=2e-3) for peg in pegs)


@pytest.mark.thorough
@pytest.mark.parametrize("unit", [MILLIMETRE, INCH])
@pytest.mark.parametrize("zero", [None, "centre", "hole 1"])
def test_clamp_is_told_from_the_zero_that_the_sheet_uses(zero: str | None, unit: object) -> None:
    """X and Y in the PDF are the clamp's place less part zero, beside its place from hole A1."""
    found, result = supports_of_sheet("plate"), result_of("plate", False)
    words = printed(sheet(result, thickness=HEIGHT, supports=found, zero=zero, unit=unit))
    assert unit in (MILLIMETRE, INCH)
    lengths = LengthUnit.from_typical_length(INCH if unit is INCH else MILLIMETRE, 10.0)
    start = choose_part_zero(BLOCK, zero).point
    x, y = (place - origin for place, origin in zip(found.clamp.at, start, strict=True))
    assert f"clamp presses at X {lengths.format_number(x)}, Y {lengths.format_length(y)}" in words
    there = found.recounted.fixture.pose.apply(*found.clamp.at)
    assert f"x {lengths.format_number(float(there[0]))}, y {lengths.format_length(float(there[1]))}" in words
    assert f"press the part down at X {lengths.format_number(x)}, Y {lengths.format_number(y)}" in words
    assert f"tipping arm {lengths.format_length(found.clamp.arm)}" in words


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_clamp_is_drawn_where_it_needs_the_least_force(name: str) -> None:
    """Under loads that is not where its arm is the longest."""
    found = chosen(name, True)
    if found is None:
        pytest.skip("no three hold the part")
    page = sheet(result_of(name, False, True), thickness=HEIGHT, supports=found)[0]
    (group,), (tip,) = by_class(page, "supports"), by_class(page, "top-clamp")
    at = to_model(group, float(tip.attrib["cx"]), float(tip.attrib["cy"]))
    assert at == pytest.approx(found.recounted.fixture.pose.apply(*found.triple.best.at), abs=2e-3)


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_forces_are_those_of_the_loads(name: str) -> None:
    """Clamp force wanted, largest support force and tipping moment stand in the PDF, rounded to the safe side."""
    found = chosen(name, True)
    if found is None:
        pytest.skip("no three hold the part")
    clamp = found.clamp
    assert clamp.support_force is not None and clamp.clamp_needed > 0
    words = printed(sheet(result_of(name, False, True), thickness=HEIGHT, supports=found))
    needed = ceil(clamp.clamp_needed - 1e-6)
    assert f"clamp force wanted at least {needed} N" in words
    assert f"largest force on a support {ceil(clamp.support_force - 1e-6)} N" in words
    assert (
        f"With that force the clamp alone resists a tipping moment of up to {clamp.clamp_needed * clamp.arm:.0f} N mm."
        in words
    )
    assert f"mm with at least {needed} N, inside the triangle" in words


@pytest.mark.thorough
def test_without_loads_the_moment_is_told_for_a_round_force() -> None:
    """100 N times the arm; whether the part stands by itself is said, and how much the side clamp lifts."""
    found = supports_of_sheet("plate")
    pages = sheet(result_of("plate", False), thickness=HEIGHT, supports=found, jaw_force=500.0)
    words = printed(pages)
    assert (
        f"With each 100 N the clamp alone resists a tipping moment of up to {100 * found.clamp.arm:.0f} N mm."
        in words
    )
    if found.clamp.lift > 0:
        assert f"clamp force wanted at least {ceil(500 * found.clamp.lift - 1e-6)} N" in words
    standing = found.triple.standing
    sentence = (
        f"its area is {standing:.3f} mm inside"
        if standing > 0
        else "Before it is clamped the part does not stand"
    )
    assert sentence in words
    for inside, said in (
        (
            0.0,
            "Before it is clamped the part tips at a touch, because "
            "the centre of its area is 0.000 mm inside their triangle: hold it",
        ),
        (
            0.5,
            "Before it is clamped the part stands on the three supports: "
            "the centre of its area is 0.500 mm inside their triangle.",
        ),
        (
            -0.1,
            "Before it is clamped the part does not stand on the three supports: hold it down until it is clamped.",
        ),
    ):
        triples = tuple(evolve(one, standing=inside) for one in found.supports.triples)
        moved = evolve(found, supports=evolve(found.supports, triples=triples))
        assert said in printed(sheet(result_of("plate", False), thickness=HEIGHT, supports=moved))
    inches = printed(sheet(result_of("plate", False), thickness=HEIGHT, supports=found, unit=INCH))
    assert (
        f"With each 100 lbf the clamp alone resists a tipping moment of up to {100 * found.clamp.arm / 304.8:.3g} ft lbf"
        in inches
    )


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_hardware_is_counted(name: str) -> None:
    """Pegs, clamps, bolts, supports and walls of the set-up, each with its size, as the PDF has them."""
    result, found = result_of(name, False), chosen(name)
    toolkit, pegs = result.toolkit, result[0].placed
    size = None if found is None else (4.0, 7.0)
    items = list_hardware(result[0], toolkit, 31.0, size, None if found is None else 5.0)
    tips = [peg for peg in pegs if toolkit.find_carrier(peg.carrier).on is not None]
    assert sum(one.count for one in items if one.length == 31.0) == len(pegs) - len(tips)
    assert (
        sum(one.count for one in items if one.note) == len(tips) + (found is not None) + (name == "flats") * 4
    )
    radii = {toolkit.find_carrier(peg.carrier).peg_radius for peg in pegs}
    sizes = {one.diameter for one in items if one.length == 31.0 or one.name in ("clamp", "clamps")}
    assert sizes == {2 * radius for radius in radii}
    assert sum(one.count for one in items if one.name.startswith("bolt")) == len(tips)
    assert sum(one.count for one in items if one.name == "supports") == (3 if found else 0)
    assert any(one.name in ("fence", "flat jaw") for one in items) == (name in ("fence", "flat-jaw"))
    words = printed(sheet(result, thickness=HEIGHT, peg_length=31.0, supports=found, support_height=7.0))
    for one in items:
        diameter = "–" if one.diameter is None else f"{one.diameter:.6g}"
        length = "–" if one.length is None else f"{one.length:.3f}"
        assert f"{one.count} {one.name} {diameter} {length}" in words


@pytest.mark.thorough
@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", ["plate", "vise", "fence", "two clamps"])
@pytest.mark.parametrize(("high", "said"), [(8.5, True), (21.9, True), (22.5, False)])
def test_pegs_as_high_as_the_part_may_be_as_short_as_they_press(name: str, high: float, said: bool) -> None:
    """Where nobody chose their height; a length that is as good is told, if it is shorter by 2 mm or more."""
    assert SOLID.solid is not None
    bands = [None if band is None else (band[0], high) for band in SOLID.solid.bands]
    tall = evolve(SOLID, solid=evolve(SOLID.solid, peg_height=HEIGHT, bands=bands))
    text = printed(sheet(design(tall, TOOLKITS[name], best=1)))
    peg = TOOLKITS[name].plates[0].peg
    shorter = find_shortest_dowel(TOOLKITS[name].peg_diameter, high)
    dowels = "shorter ones" if shorter is None else f"dowels of {shorter.name}"
    words = f"No {peg} is pressed above {high:.3f} mm, so {dowels} are long enough too."
    assert (words in text) is said and ("are long enough too" in text) is said
    if not said:
        return
    chosen_height = evolve(tall, solid=evolve(tall.solid, peg_height=HEIGHT - 0.5))
    assert "are long enough too" not in printed(sheet(design(chosen_height, TOOLKITS[name], best=1)))


@pytest.mark.thorough
def test_a_part_that_lies_on_no_face_is_said_to_do_so() -> None:
    """And a part that would fit turned over is told apart by the file's axis, as its sides may differ."""
    assert SOLID.solid is not None
    words = "The part lies on no level face: hold it level"
    assert words not in printed(sheet(result_of("plate")))
    round_below = evolve(SOLID, solid=evolve(SOLID.solid, bottom=[]))
    assert words in printed(sheet(design(round_below, TOOLKITS["plate"], best=1)))
    square = [(0.0, 0.0, 0.0), (60.0, 0.0, 0.0), (60.0, 44.0, 0.0), (0.0, 44.0, 0.0)]
    own = SolidOutline("-z", 20.0, 20.0, 0.5, 1.0, [(0.0, 20.0)] * 4)
    text = printed(
        sheet(design(Workpiece.from_loops("box", [square], solid=own), TOOLKITS["two clamps"], best=1))
    )
    assert (
        "Upside down the part would fit the same pegs too: make sure that −z of the file points up." in text
    )


@pytest.mark.thorough
def test_holes_with_other_names_are_said_to_be_so() -> None:
    """Where jaws stand nearer for supports between the pegs, the sheet has the new opening and says by how much."""
    found = supports_of_sheet("vise")
    listed, new = found.supports.fixture, found.recounted.fixture
    assert new.travel != listed.travel
    words = printed(sheet(result_of("vise", False), thickness=HEIGHT, supports=found))
    less = listed.travel - new.travel
    assert f"the opening is {less:.3f} mm narrower than in the list" in words
    assert f"S = {new.travel:.3f} mm" in words
    assert f"S = {listed.travel:.3f} mm" not in words
    for peg in new.pegs:
        assert (
            f"{peg.hole} {peg.carrier} {peg.touched} {peg.x:.3f} {peg.y:.3f}".replace("-0.000", "0.000")
            in words
        )
    assert explain_hole_names


FIRST = FirstSide(
    "-z", "z", "turned over about the y axis of the first drawing, by half a turn", (0, 3), (4, 7), (2,)
)


@pytest.mark.thorough
def test_second_side_says_what_the_first_did() -> None:
    """Which side is up, how it was turned, which faces are cut and which are touched in both."""
    words = printed(sheet(result_of("plate"), first_side=FIRST))
    for wanted in (
        "Second set-up of the same part",
        "This is the second side: −z of the file points up, and z did before.",
        "The part is turned over about the y axis of the first drawing, by half a turn.",
        "Faces 0 and 3 of this outline must not be touched: the first set-up cuts faces 4 and 7 of the solid.",
        "Face 2 of the solid is touched in both set-ups",
    ):
        assert wanted in words
    assert "−z of the file points up." in printed(sheet(result_of("plate")))
    assert SOLID.solid is not None
    lonely = FirstSide("z", "z", "the same side up", (), (), ())
    assert describe_solid_side_up(SOLID.solid, lonely) == [
        "The same side is up as in the first set-up: −z of the file.",
        "The first set-up names no face that it cuts.",
        "No face is touched in both set-ups: they locate on different faces.",
    ]
    out_of_reach = FirstSide("-z", "z", "turned", (), (5,), (1, 2))
    assert describe_solid_side_up(SOLID.solid, out_of_reach)[1:] == [
        "The pegs cannot reach the faces that the first set-up cuts (face 5 of the solid).",
        "Faces 1 and 2 of the solid are touched in both set-ups, in the first by its best fixture.",
    ]


@pytest.mark.thorough
def test_signs_are_explained_where_they_stand() -> None:
    """The legend has supports and the clamp on top only with them."""
    result = result_of("plate", False)
    bare = [word for page in sheet(result) for word in texts(page)]
    full = [
        word for page in sheet(result, thickness=HEIGHT, supports=chosen("plate")) for word in texts(page)
    ]
    for sign in ("support below the part", "clamp on top, presses down"):
        assert sign not in bare and sign in full


@pytest.mark.thorough
def test_the_drawer_names_the_dowel_that_would_do() -> None:
    """Of a part whose thickness is known and pegs' height is not: what stands beside the pegs stands there, too."""
    result = result_of("plate", False)
    diameter = result.toolkit.peg_diameter
    would_do = find_shortest_dowel(
        diameter, max(one for one in list_standouts(diameter) if one <= min(2 * diameter, HEIGHT))
    )
    assert would_do is not None
    words = [word for page in sheet(result, thickness=HEIGHT) for word in texts(page)]
    row = words.index("3 locators")
    assert words[row + 2] == would_do.name
    assert words.count(would_do.name) == 1
