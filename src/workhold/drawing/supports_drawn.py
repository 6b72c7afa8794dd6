"""Supports and the clamp on top: on the plan of a set-up with their names, and in blocks of a setup sheet."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import dist, pi

from attrs import frozen

from workhold.drawing.annotation import Label, LabelPlacer, PlacedLabel, make_label_around
from workhold.drawing.panel import TextColumn, describe_move
from workhold.drawing.scene import Box, Scene, View, measure_text
from workhold.drawing.sheet_writing import BODY, NOTE, SetupSheet, write_fact_or_field, write_heading
from workhold.drawing.support_signs import SUPPORT, draw_pad, draw_tip
from workhold.errors import join_words
from workhold.geometry.segment import Point
from workhold.model.support_triples import ChosenSupports
from workhold.units import Unit

__all__ = [
    "PlannedSupports",
    "draw_supports",
    "draw_triangle",
    "describe_supports",
    "compute_drawn_radius",
    "list_support_steps",
    "describe_tipping",
    "write_heights",
    "write_supports",
]

# A sign is at least so large, page units.
SMALLEST = 6.0
NAME, HIGH = 13.0, 19.0
TOP_NAME = "clamp on top"
# Where no load says how much clamp force is wanted, the margin is stated for so many units of force.
ROUND_FORCE = 100.0
FROM_THE_SIDE = (
    "Anything that begins above the plane on which the part lies comes in from the side once "
    "the part is down. The program has not checked that the part passes it on its way."
)

HANGS = (
    "The clamp presses where there is air below the part: put something under the part there, or it bends."
)


@frozen
class PlannedSupports:
    """Three supports on the plan, in mm in the vise frame.

    Parameters
    ----------
    names, places : of the holes of the three supports.
    holes : (carrier, column, row) of each of these holes.
    pad_radius : of the supports' pads.
    clamp, tip_radius : place of the clamp on top, and the radius of its tip.
    """

    names: tuple[str, ...]
    places: tuple[Point, ...]
    holes: tuple[tuple[str, int, int], ...]
    pad_radius: float
    clamp: Point
    tip_radius: float

    @classmethod
    def from_chosen(cls, chosen: ChosenSupports) -> PlannedSupports:
        """Return the chosen supports placed in the vise frame."""
        pose, request = chosen.recounted.fixture.pose, chosen.supports.request
        return cls(
            names=tuple(pad.hole for pad in chosen.pads),
            places=tuple(pose.apply(pad.x, pad.y) for pad in chosen.pads),
            holes=tuple((pad.carrier, pad.column, pad.row) for pad in chosen.pads),
            pad_radius=request.pad_radius,
            clamp=pose.apply(*chosen.clamp.at),
            tip_radius=request.tip_radius,
        )

    def list_holes_on(self, carrier: str) -> set[tuple[int, int]]:
        """Return the (column, row) of the supports' holes on a carrier."""
        return {(column, row) for name, column, row in self.holes if name == carrier}

    def keep_labels_off(self, placer: LabelPlacer, view: View) -> None:
        """Mark the drawing of the supports for the label placer to avoid."""
        corners = [*self.places, self.places[0]]
        for one, other in pairwise(corners):
            placer.avoid_line(view(one), view(other), 1.0)
        pad, tip = (compute_drawn_radius(radius, view) for radius in (self.pad_radius, self.tip_radius))
        for at, radius in (*((place, pad) for place in self.places), (self.clamp, tip)):
            x, y = view(at)
            placer.avoid_box(Box(x, y, x, y).grow(radius))

    def make_labels(self, view: View) -> list[Label]:
        """Return the labels of the three supports' holes, then that of the clamp on top."""
        turns = [2 * pi * k / 24 for k in range(24)]
        found = []
        named = [(name, at, self.pad_radius) for name, at in zip(self.names, self.places, strict=True)]
        for name, at, radius in [*named, (TOP_NAME, self.clamp, self.tip_radius)]:
            size = (measure_text(name, NAME, bold=True) + 8, HIGH)
            gaps = [compute_drawn_radius(radius, view) + gap for gap in (3, 8, 16, 28, 44, 64)]
            found.append(make_label_around(view(at), -pi / 4, size, gaps, turns, turn_cost=1.0))
        return found

    def draw_names(self, scene: Scene, places: Sequence[PlacedLabel], view: View) -> None:
        """Write the names at their places, in the order of :meth:`make_labels`, with leaders."""
        for name, place, radius in zip(
            (*self.names, TOP_NAME), places, (*[self.pad_radius] * 3, self.tip_radius), strict=True
        ):
            leader = place.compute_leader(compute_drawn_radius(radius, view))
            if dist(*leader) > 1.0:
                scene.add_line(leader, SUPPORT, 1.2)
            scene.add_rectangle(place.box, "#ffffff", SUPPORT, 1.2, 3)
            scene.add_text(place.box.center, name, NAME, "middle", bold=True, fill=SUPPORT)


def compute_drawn_radius(radius: float, view: View) -> float:
    """Return the radius in page units at which a pad or tip is drawn, at least ``SMALLEST``.

    ``radius`` is its true radius in mm.
    """
    return max(radius * view.scale, SMALLEST)


def draw_supports(scene: Scene, supports: PlannedSupports, view: View) -> None:
    """Draw the triangle of the supports, their pads, and the tip of the clamp on top."""
    group = scene.group("supports", view)
    corners = [view(place) for place in supports.places]
    draw_triangle(group, corners)
    for at in corners:
        draw_pad(group, at, compute_drawn_radius(supports.pad_radius, view))
    draw_tip(group, view(supports.clamp), compute_drawn_radius(supports.tip_radius, view))


def draw_triangle(scene: Scene, corners: Sequence[Point]) -> None:
    """Draw the dashed triangle of three supports, given as page points."""
    for one, other in pairwise([*corners, corners[0]]):
        scene.add_line(
            [one, other], SUPPORT, 1.1, stroke_dasharray="9 3 2 3", **{"class": "support-triangle"}
        )


def write_supports(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block on supports and the clamp on top: holes, place, height, forces and tipping."""
    chosen, lengths = sheet.details.supports, sheet.lengths
    assert chosen is not None
    request, clamp = chosen.supports.request, chosen.clamp
    write_heading(column, "Supports and the clamp on top")
    column.write_fact("supports in", join_words([pad.hole for pad in chosen.pads]), bold=True)
    column.write_fact("round pads", f"Ø {lengths.format_short(2 * request.pad_radius)}", bold=True)
    at = [place - zero for place, zero in zip(clamp.at, sheet.zero.point, strict=True)]
    column.write_fact(
        "clamp presses at", f"X {lengths.format_number(at[0])}, Y {lengths.format_length(at[1])}", bold=True
    )
    x, y = chosen.recounted.fixture.pose.apply(*clamp.at)
    column.write_fact(
        f"from {sheet.datum.point}", f"x {lengths.format_number(x)}, y {lengths.format_length(y)}"
    )
    if sheet.heights is not None and sheet.heights.clamped_height is not None:
        column.write_fact("at the height", lengths.format_length(sheet.heights.clamped_height), bold=True)
    column.write_fact("its round tip", f"Ø {lengths.format_short(2 * request.tip_radius)}", bold=True)
    if request.rising:
        column.write_fact(
            "its head, at most", f"Ø {lengths.format_short(2 * request.head_radius)}", bold=True
        )
    write_forces(column, sheet, chosen)
    column.write_fact("tipping arm", lengths.format_length(clamp.arm))
    column.write_paragraph(
        f"{describe_tipping(chosen, lengths.unit)} {describe_supports(sheet, chosen)}", NOTE
    )
    if clamp.hangs:
        column.write_paragraph(HANGS, NOTE)
    for sentence in explain_hole_names(sheet, chosen):
        column.write_paragraph(sentence, NOTE)


def write_forces(column: TextColumn, sheet: SetupSheet, chosen: ChosenSupports) -> None:
    """Write the clamp force on top that is wanted, and the largest force on any support."""
    supports, clamp, unit = chosen.supports, chosen.clamp, sheet.lengths.unit
    noun = sheet.toolkit.moving.noun
    if supports.loads:
        wanted = f"at least {unit.format_force_rounded_up(clamp.clamp_needed)} {unit.force}"
        column.write_fact("clamp force wanted", wanted, bold=True)
        largest = f"{unit.format_force_rounded_up(clamp.support_force or 0.0)} {unit.force}"
        column.write_fact("largest force on a support", largest, bold=True)
        at = f"at a {noun} force of {unit.format_force(supports.jaw_force)}"
        column.write_paragraph(f"Under the loads, {at}, without friction.", NOTE)
        return
    if clamp.lift > 0 and sheet.details.jaw_force is not None:
        force = f"at least {unit.format_force_rounded_up(clamp.lift * sheet.details.jaw_force)} {unit.force}"
        column.write_fact("clamp force wanted", force, bold=True)
    else:
        write_fact_or_field(column, "clamp force wanted", None)
    if clamp.lift > 0:
        column.write_paragraph(
            f"The {noun}s may lift the part off a support, because of the heights at which they "
            f"press: at least {clamp.lift:.2f} times their force on top holds it down.",
            NOTE,
        )


def describe_tipping(chosen: ChosenSupports, unit: Unit) -> str:
    """Return a sentence on the largest tipping moment that the clamp on top resists alone.

    This moment is the clamp's force times its distance from the nearest side of the supports' triangle.
    """
    force = chosen.clamp.clamp_needed if chosen.supports.loads else 0.0
    what = "that force" if force > 0 else f"each {ROUND_FORCE:.0f} {unit.force}"
    force = force if force > 0 else ROUND_FORCE * unit.newtons
    moment = force * chosen.clamp.arm
    words = f"{moment:.0f} N mm" if unit.newtons == 1 else unit.format_moment(moment)
    return f"With {what} the clamp alone resists a tipping moment of up to {words}."


def describe_supports(sheet: SetupSheet, chosen: ChosenSupports) -> str:
    """Return a sentence that says whether the part is stable on the supports before it is clamped."""
    triple = chosen.triple
    inside = f"the centre of its area is {sheet.lengths.format_length(triple.standing)} inside their triangle"
    if triple.stands:
        return f"Before it is clamped the part stands on the three supports: {inside}."
    if triple.standing >= 0:
        return (
            f"Before it is clamped the part tips at a touch, because {inside}: hold it down until it "
            "is clamped."
        )
    return (
        "Before it is clamped the part does not stand on the three supports: hold it down until "
        "it is clamped."
    )


def explain_hole_names(sheet: SetupSheet, chosen: ChosenSupports) -> list[str]:
    """Return sentences on why holes have other names here than in the list of fixtures.

    It may be a shift of the set-up, or another opening.
    """
    recounted, sentences = chosen.recounted, list[str]()
    if recounted.move != (0, 0):
        sentences.append(
            f"So that supports have holes near the middle of the {sheet.plates_noun}, the whole "
            f"set-up stands {describe_move(recounted.move)} than in the list."
        )
    travelled = recounted.fixture.travel - chosen.supports.fixture.travel
    if sheet.toolkit.moving.has_lattice and abs(travelled) > 1e-6:
        sentences.append(
            "Supports stand between the pegs, so the opening is "
            f"{sheet.lengths.format_length(abs(travelled))} {('wider' if travelled > 0 else 'narrower')} than "
            "in the list."
        )
    return sentences


def list_support_steps(sheet: SetupSheet, steps: list[str]) -> list[str]:
    """Return the steps of setting up, with those about supports added to ``steps``; without supports
    ``steps`` itself.
    """
    chosen = sheet.details.supports
    if chosen is None:
        return steps
    lengths, unit = sheet.lengths, sheet.lengths.unit
    x, y = (
        lengths.format_number(place - zero)
        for place, zero in zip(chosen.clamp.at, sheet.zero.point, strict=True)
    )
    force = ""
    if chosen.supports.loads:
        force = f" with at least {unit.format_force_rounded_up(chosen.clamp.clamp_needed)} {unit.force}"
    put = f"{steps[0]} Put supports in {join_words([pad.hole for pad in chosen.pads])}."
    where = f"X {x}, Y {y} {lengths.sign}"
    press = f"Then press the part down at {where}{force}, inside the triangle of the supports."
    return [put, *steps[1:], press]


def write_heights(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block of heights: part, pegs, supports, and the heights at which each peg presses."""
    heights, lengths = sheet.heights, sheet.lengths
    assert heights is not None
    noun = sheet.toolkit.plates[0].noun
    write_heading(column, "Heights")
    column.write_fact("height of the part", lengths.format_length(heights.thickness), bold=True)
    column.write_fact(
        f"top of the pegs{heights.note_if_assumed('peg_top')}",
        lengths.format_length(heights.peg_top),
        bold=True,
    )
    own = {one.elements: one.heights for one in sheet.toolkit.carriers if one.heights is not None}
    for elements, (low, high) in own.items():
        column.write_fact(
            f"{elements}, from and to",
            f"{lengths.format_number(low)}, {lengths.format_length(high)}",
            bold=True,
        )
    if any(low > 0 for low, _ in own.values()):
        column.write_paragraph(FROM_THE_SIDE, NOTE)
    if heights.head_room is not None:
        column.write_fact("head room above the pegs", lengths.format_length(heights.head_room))
    if heights.supported_by:
        name = f"height of the supports{heights.note_if_assumed('supported_by')}"
        column.write_fact(name, lengths.format_length(heights.supported_by), bold=True)
        column.write_fact(f"pegs above the {noun}", lengths.format_length(heights.above_plate), bold=True)
    rows = [
        [peg.hole, *((lengths.format_number(end) for end in band) if band else ("?", "?"))]
        for peg, band in zip(sheet.fixture.pegs, heights.bands, strict=True)
    ]
    column.y += 2
    column.write_table(["presses between", f"from {lengths.sign}", f"to {lengths.sign}"], rows, BODY)
