"""One fixture as an interactive picture, in which the part can be pushed and the jaws closed: moving elements
are in separate groups.

Supports under it, and the clamp on top, are drawn if requested.

Glossary
--------
push : a trial force at a point of the part.
keyframe : one moment of closing: the part's turn in degrees and shift in page units, and the opening of the
    jaw or clamp in mm.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import atan2, ceil, cos, degrees, hypot, isfinite, radians, sin
from typing import Any

from attrs import evolve, frozen

from workhold.drawing.bench import BenchDrawing, make_bench
from workhold.drawing.panel import describe_fixture
from workhold.drawing.scene import Box, Scene, View, measure_text
from workhold.drawing.support_signs import SUPPORT, draw_pad, draw_tip
from workhold.drawing.supports_drawn import PlannedSupports, compute_drawn_radius, draw_triangle
from workhold.errors import InputError
from workhold.geometry.segment import Point
from workhold.model.fixture import Fixture
from workhold.model.pose import Pose
from workhold.model.requirements import Load
from workhold.model.result import Result
from workhold.model.setup import list_length_settings
from workhold.model.support_triples import ChosenSupports, Supports
from workhold.presenting.figure_words import (
    find_edgeless_distance,
    format_figure,
    list_shown_figures,
    make_fixture_title,
    mark_edgeless,
)
from workhold.presenting.moving_picture import (
    add_moving_group,
    draw_ground,
    draw_peg,
    find_clamping_directions,
    measure_draw_back,
)
from workhold.statics.loads import compute_load_cases, describe_jaw
from workhold.supports.asking import find_fixture_supports
from workhold.supports.words import explain_no_set
from workhold.units import MILLIMETRE

__all__ = ["LivePicture", "TriedForce"]

# Size of the page and the room at its rim for names and arrows, page units.
PAGE, RIM = (640.0, 480.0), 44.0
# Of the names of pegs, and how far they stand off them, page units.
NAME, OFF = 13.0, 14.0
# How long the arrow of the usual push is, page units, shorter than what a push is none, and how long the
# longest arrow of a contact is.
USUAL, SHORTEST, LONGEST = 100.0, 6.0, 170.0
# Of the pitch, and of the width of what shows, how far jaws stand open before they close.
OPEN_PITCHES, OPEN_SHARE = 1.5, 0.16
# A peg lets go when its force is negative and larger than this part of the largest.
NOTHING = 1e-6
# Of the name of a support, page units.
PAD_NAME = 12.0


@frozen
class TriedForce:
    """A force on the part that is tried out.

    Parameters
    ----------
    x, y : where it acts, in mm in the part's coordinates.
    size : in N.
    direction : in degrees in the part's frame, counter-clockwise from its x axis.
    """

    x: float
    y: float
    size: float
    direction: float

    @classmethod
    def from_numbers(cls, numbers: Sequence[float]) -> TriedForce:
        """Return a force from four numbers, in the order of its fields.

        Raises
        ------
        InputError
            When they are not four finite numbers.
        """
        try:
            x, y, size, direction = map(float, numbers)
        except (TypeError, ValueError) as error:
            raise InputError("a force is four numbers: x and y in mm, its size in N, degrees.") from error
        if not all(map(isfinite, (x, y, size, direction))):
            raise InputError("a force is four finite numbers: x and y in mm, its size in N, degrees.")
        return cls(x, y, size, direction)

    @property
    def numbers(self) -> list[float]:
        """x, y, size and direction."""
        return [self.x, self.y, self.size, self.direction]

    @property
    def load(self) -> Load:
        """The force as a load."""
        ways = (self.direction, self.direction)
        return Load(points=[(self.x, self.y)], force=self.size, directions=ways, name="pushed")


@frozen(eq=False)
class LivePicture:
    """A fixture of a result, ready to be pushed and closed.

    Parameters
    ----------
    result, fixture : the result, and the fixture of it that is shown.
    bench, view : the visible parts of the set-up, and the map from mm to the page.
    usual : size in N of the push whose arrow is :data:`USUAL` page units long.
    under : supports under the part, to show as well; None for none.
    """

    result: Result
    fixture: Fixture
    bench: BenchDrawing
    view: View
    usual: float
    under: Supports | None = None

    @classmethod
    def from_result(
        cls, result: Result, index: int, usual: float, asked: Mapping[str, Any] | None = None
    ) -> LivePicture:
        """Return the picture of the fixture at an index, from 0.

        Parameters
        ----------
        usual : size in N of the push whose arrow has the usual length.
        asked : keywords of :meth:`workhold.Fixture.supports`, to show supports; None shows none.
        """
        fixture = result[index]
        under = None if asked is None else find_fixture_supports(fixture, **{"best": 1, **asked})
        if under is not None and under.triples:
            # With supports all may stand further on, so that each hole is there.
            stands = ChosenSupports.from_supports(under).recounted.fixture
            fixture = fixture if stands.pegs == fixture.pegs else evolve(stands, seating=None)
        bench = make_bench(fixture, result.workpiece, result.toolkit)
        view = View.fit_box(bench.extent, Box(0.0, 0.0, *PAGE).grow(-RIM))
        return cls(result, fixture, bench, view, usual, under)

    @property
    def title(self) -> str:
        """The fixture's name, its kind of hold, and the lengths to set, in words."""
        toolkit = self.result.toolkit
        set_to = ", ".join(
            f"{one.sign} = {MILLIMETRE.format_length(one.length)}"
            for one in list_length_settings(self.fixture, toolkit)
        )
        under = "" if self.under is None else f" {describe_support_set(self.under)}"
        return (
            f"{make_fixture_title(self.fixture)}. {describe_fixture(self.fixture, toolkit)}; {set_to}.{under}"
        )

    @property
    def figures(self) -> list[list[str]]:
        """[name, value with unit] of the figures that a table of the result shows."""
        unit, part = MILLIMETRE, self.result.workpiece
        known = mark_edgeless(self.fixture.figures, find_edgeless_distance(part, self.result.toolkit))
        return [
            [one.words, format_figure(one, known[one.key], unit)]
            for one in list_shown_figures(self.result)[0]
            if one.key in known
        ]

    @property
    def center(self) -> Point:
        """The page point of the part's centre."""
        x, y = self.view(self.fixture.pose.apply(*self.result.workpiece.center))
        return float(x), float(y)

    def draw_svg(self) -> str:
        """Return the picture as SVG text, with its groups as in ``presenting.moving_picture``."""
        bench, view = self.bench, self.view
        scene = Scene.make_page(PAGE, make_fixture_title(self.fixture))
        draw_ground(scene, bench, view)
        ways = find_clamping_directions(bench)
        if self.under is not None and self.under.triples:
            self.draw_set(scene, ChosenSupports.from_supports(self.under), ways)
        for number in bench.placed:
            group = add_moving_group(scene, view, ways.get(self.fixture.pegs[number].carrier))
            draw_peg(group, bench, view, number)
            self.write_name(group, number)
        return scene.to_svg()

    def draw_set(self, scene: Scene, chosen: ChosenSupports, ways: Mapping[str, Point | None]) -> None:
        """Draw a set of three supports with the names of its holes; each support moves with the jaw on which
        it stands.

        ``ways`` has, by carrier name, the direction in which the carrier clamps, or None for a fixed carrier.
        """
        planned, view = PlannedSupports.from_chosen(chosen), self.view
        corners, radius = (
            [view(place) for place in planned.places],
            compute_drawn_radius(planned.pad_radius, view),
        )
        draw_triangle(scene.group("stands"), corners)
        for pad, (x, y) in zip(chosen.pads, corners, strict=True):
            group, below = add_moving_group(scene, view, ways.get(pad.carrier)), (x, y + radius + PAD_NAME)
            draw_pad(group, (x, y), radius)
            group.add_text(below, pad.hole, PAD_NAME, "middle", bold=True, fill=SUPPORT, halo=3.0)
        draw_tip(scene.group("stands"), view(planned.clamp), compute_drawn_radius(planned.tip_radius, view))

    def write_name(self, scene: Scene, number: int) -> None:
        """Write the name of the hole of peg ``number``, an index from 0, beside the peg.

        The name is placed away from the part and within the page; the name of a clamp is beside the clamp's
        body.
        """
        peg, (_, (nx, ny)) = self.fixture.pegs[number], self.bench.contacts[number]
        (x, y), radius = self.view((peg.x, peg.y)), self.bench.get_page_radius(self.view, number)
        half = measure_text(peg.hole, NAME, bold=True) / 2
        dx, dy = (nx, ny) if self.result.toolkit.find_carrier(peg.carrier).has_lattice else (-ny, nx)
        aside = radius + OFF + abs(dx) * (half - NAME / 2)
        along = 0.0 if (dx, dy) == (nx, ny) else half * nx
        at = min(max(x + aside * dx + along, half), PAGE[0] - half), y - aside * dy
        scene.add_text(at, peg.hole, NAME, "middle", bold=True, halo=3.0)

    def compute_push_arrow(self, push: TriedForce) -> list[float]:
        """Return the arrow of a force on the page: x and y of the point where it acts, then of its tip."""
        (x, y), length = self.view(self.fixture.pose.apply(push.x, push.y)), push.size * USUAL / self.usual
        angle = radians(push.direction + self.fixture.pose.theta_deg)
        return [float(x), float(y), float(x + length * cos(angle)), float(y - length * sin(angle))]

    def read_push(self, arrow: Sequence[float]) -> TriedForce:
        """Return the force that an arrow (x, y, tip x, tip y) on the page stands for, in whole newtons.

        A very short arrow gives 0 N.

        Raises
        ------
        InputError
            When the arrow is not four finite numbers.
        """
        x, y, to_x, to_y = TriedForce.from_numbers(arrow).numbers
        view, pose = self.view, self.fixture.pose
        at = pose.inverse.apply((x - view.left) / view.scale, (view.top - y) / view.scale)
        length = hypot(to_x - x, to_y - y)
        size = 0.0 if length < SHORTEST else float(round(length * self.usual / USUAL))
        turn = degrees(atan2(y - to_y, to_x - x)) - pose.theta_deg
        return TriedForce(float(at[0]), float(at[1]), size, turn % 360.0)

    def answer(self, push: TriedForce, jaw_force: float | None, jaw: str | float) -> dict[str, Any]:
        """Return as plain data the effect of a force: contact forces as arrows and shares, whether the
        fixture holds, and words.

        Parameters
        ----------
        jaw_force : force in N with which the moving carrier presses; None for the force that is needed.
        jaw : as in :func:`workhold.statics.loads.load_cases`.

        Raises
        ------
        InputError
            As that function.
        """
        mover = self.result.toolkit.moving.noun
        if push.size <= 0:
            return {
                "arrow": None,
                "forces": [],
                "holds": None,
                "words": "Press on the part and drag to push it with a force.",
            }
        (case,) = compute_load_cases(
            self.fixture, self.result.workpiece, self.result.toolkit, [push.load], jaw_force, None, jaw
        )
        needed, loose = case.needed.value, self.fixture.pegs[case.needed.peg].hole
        most = max(*map(abs, case.largest), 1e-9)
        # All arrows are shorter where the largest would cover the picture.
        length = min(USUAL / self.usual, LONGEST / most)
        # A whole number of newtons that is enough.
        enough = f"{ceil(needed):,} N so that no peg lets go; below that {loose} does."
        words = [
            f"No peg lets go, however little the {mover} presses."
            if needed <= 0
            else f"The {mover} must press with {enough}"
        ]
        if case.keeps_contact:
            given = f"that {mover} force" if jaw_force is None and needed > 0 else f"{case.jaw_force:,.0f} N"
            words.append(
                f"Forces are for {given} of {describe_jaw(case.jaw_stiffness, self.result.toolkit)}."
            )
        else:
            words.append(f"With {case.jaw_force:,.0f} N a peg lets go.")
        return {
            "arrow": self.compute_push_arrow(push),
            "size": f"{push.size:,.0f} N",
            "forces": [
                {
                    "hole": peg.hole,
                    "words": "lets go" if force < -NOTHING * most else f"{max(force, 0.0):,.0f} N",
                    "share": abs(force) / most,
                    "pulls": force < -NOTHING * most,
                    "arrow": self.compute_force_arrow(number, length * force),
                }
                for number, (peg, force) in enumerate(zip(self.fixture.pegs, case.largest, strict=True))
            ],
            "holds": case.keeps_contact,
            "words": " ".join(words),
        }

    def compute_force_arrow(self, number: int, length: float) -> list[float]:
        """Return the arrow of a contact force: x and y of the contact, then x and y of the tip, in page
        units.

        ``number`` is the contact's index, from 0. The arrow points into the part, or away from it where
        ``length`` is negative.
        """
        contact, (nx, ny) = self.bench.contacts[number]
        x, y = self.view(contact)
        return [float(x), float(y), float(x - length * nx), float(y + length * ny)]

    @property
    def opened(self) -> float:
        """The distance in mm by which the moving carrier is opened at the start of a closing."""
        extent = self.bench.extent
        far = max(OPEN_PITCHES * self.bench.shown.pitch, OPEN_SHARE * extent.width)
        for clamp in self.bench.shown.clamps:
            # A clamp is drawn back no farther than to its least stroke.
            back = measure_draw_back(clamp)
            far = far if back is None else min(far, back)
        return max(far, 0.0)

    def describe_closing(self, keyframes: Sequence[Sequence[float]] = (), words: str = "") -> dict[str, Any]:
        """Return a closing as plain data.

        Without ``keyframes`` the part stays in its place, and only the moving carrier moves.
        """
        plain = [[0.0, 0.0, 0.0, self.opened], [0.0, 0.0, 0.0, 0.0]]
        return {"center": list(self.center), "keyframes": list(keyframes) or plain, "words": words}

    def make_keyframe(self, pose: Pose, opened: float) -> list[float]:
        """Return the keyframe of a pose: turn in degrees, shift x and y in page units, and opening in mm.

        Turn and shift are relative to the fixture's own pose.
        """
        x, y = self.view(pose.apply(*self.result.workpiece.center))
        turned = (pose.theta_deg - self.fixture.pose.theta_deg + 180.0) % 360.0 - 180.0
        numbers = turned, x - self.center[0], y - self.center[1], opened
        return [round(float(value), 3) for value in numbers]


def describe_support_set(found: Supports) -> str:
    """Return a sentence on the best set of three supports with the clamp on top, or on why there is none."""
    if not found.triples:
        return explain_no_set(found, MILLIMETRE)
    chosen, number = ChosenSupports.from_supports(found), MILLIMETRE.format_number
    x, y = chosen.clamp.at
    holes = ", ".join(pad.hole for pad in chosen.pads)
    return f"Supports in {holes}; the clamp on top presses at ({number(x)}, {number(y)})."
