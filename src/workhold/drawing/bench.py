"""A fixture as it lies in the vise: jaws, part, pegs and contact forces, without any lettering.

Outlines are SVG paths whose arcs are true arcs. A small picture shows the part as it was drawn, so that its
turn in the vise can be seen.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import reduce
from math import ceil, hypot, pi

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.conventions import AGREEMENT
from workhold.drawing.carriers import (
    draw_clamp,
    draw_flat_jaws,
    draw_holes,
    draw_plate,
    draw_push,
    draw_wall,
    limit_holes_drawn,
)
from workhold.drawing.scene import BLACK, GREY, Box, Scene, View, format_number
from workhold.drawing.straps_drawn import draw_straps
from workhold.fixels.contacts import CLAMP_TIP, FLAT_PIN, ROUND_PIN, WALL_END, ContactKind
from workhold.fixels.pegs import make_peg_outline
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Line, Point, Segment, compute_bounding_box
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.setup import find_hole_centers
from workhold.model.shown import ShownSetUp, find_shown
from workhold.model.straps import StrappedHold
from workhold.model.workpiece import Workpiece

__all__ = [
    "ARROW",
    "LOWEST",
    "PART_FILL",
    "PEG_FILL",
    "TOUCHED",
    "BenchDrawing",
    "make_bench",
    "find_contact",
    "draw_bench",
    "draw_inset",
    "draw_part",
    "draw_pegs",
    "draw_zero",
    "find_face",
    "compute_force_arrow",
    "make_outline_path",
    "sample_segments",
    "sample_loop",
    "make_segment_path",
]

# An SVG arc is given by its ends and radius. With a larger sweep its centre suffers from the rounding of the
# ends, so longer arcs are written in pieces.
LONGEST_SWEEP = 2 * pi / 3


def make_segment_path(segment: Segment, view: View, moved: bool = True) -> str:
    """Return SVG path data of a segment.

    With ``moved`` False the move to its start is left out, to continue a path that ends there.
    """
    start = "M{} {}".format(*map(format_number, view(segment.start))) if moved else ""
    if isinstance(segment, Line):
        return start + "L{} {}".format(*map(format_number, view(segment.end)))
    pieces = ceil(2 * segment.half_sweep / LONGEST_SWEEP - 1e-9)
    radius = format_number(segment.radius * view.scale)
    # y is turned over, so counter-clockwise is SVG's negative direction.
    sweep = "0" if segment.sign > 0 else "1"
    for k in range(1, pieces + 1):
        parameter = segment.sign * segment.half_sweep * (2 * k / pieces - 1)
        x, y = map(format_number, view(segment.compute_point(parameter)))
        start += f"A{radius} {radius} 0 0 {sweep} {x} {y}"
    return start


def make_outline_path(loops: Sequence[Sequence[Segment]], view: View) -> str:
    """Return SVG path data of closed loops, to be filled by the even-odd rule."""
    return " ".join(
        "".join(make_segment_path(segment, view, k == 0) for k, segment in enumerate(loop)) + "Z"
        for loop in loops
    )


def sample_segments(segments: Iterable[Segment], view: View, step: float) -> NDArray[np.float64]:
    """Return (N, 2) page points along segments, about ``step`` page units apart, both ends included.

    A concave arc is sampled from its end to its start; see :func:`sample_loop` for a loop in order.
    """
    points: list[Point] = []
    for segment in segments:
        count = max(1, min(400, ceil(segment.length * view.scale / step)))
        half = segment.half_extent
        points += [view(segment.compute_point(half * (2 * k / count - 1))) for k in range(count + 1)]
    return np.array(points, dtype=np.float64).reshape(-1, 2)


def sample_loop(loop: Sequence[Segment], view: View, step: float) -> NDArray[np.float64]:
    """Return (N, 2) page points around a closed loop in its order, about
    ``step`` apart; the last is the first again.
    """
    runs = []
    for segment in loop:
        points = sample_segments([segment], view, step)
        backwards = isinstance(segment, Arc) and segment.sign < 0
        runs.append(points[::-1] if backwards else points)
    return np.vstack(runs)


def find_face(workpiece: Workpiece, number: int) -> Segment:
    """Return the whole face to which a segment number belongs."""
    return next(face.segment for face in workpiece.numbered.faces if number in face.segments)


def find_contact(kind: ContactKind, center: Point, face: Segment) -> tuple[Point, Point]:
    """Return (point where a contact touches a face, outward unit normal of the face there).

    ``center`` is a peg's centre, or an end of the contact with a wall, in mm in the frame of the face.
    """
    return CONTACTS[kind](center, face)


def find_wall_contact(center: Point, face: Segment) -> tuple[Point, Point]:
    """Return (point, normal) of an end of the contact with a wall below the part.

    The point is ``center`` itself, the normal (0, -1).
    """
    return center, (0.0, -1.0)


def find_pin_contact(center: Point, face: Segment) -> tuple[Point, Point]:
    """Return (point, outward unit normal there), for the point of a face nearest to a pin's centre.

    The point is on the face, at one of its ends if need be.
    """
    half = face.half_extent
    parameter = max(-half, min(half, face.find_parameter(center)))
    return face.compute_point(parameter), face.compute_normal(parameter)


CONTACTS: Mapping[ContactKind, Callable[[Point, Segment], tuple[Point, Point]]] = {
    ROUND_PIN: find_pin_contact,
    FLAT_PIN: find_pin_contact,
    CLAMP_TIP: find_pin_contact,
    WALL_END: find_wall_contact,
}


PART_FILL, RAW_FILL = "#fff7d1", "#e6dcc3"
PEG_FILL = "#b3122a"
TOUCHED = "#e59a00"
ARROW = "#0b3a82"

# Pegs thinner than this on the page, in page units, are drawn this thick.
THINNEST_PEG = 3.5


@frozen
class BenchDrawing:
    """A fixture to draw, in mm in the vise frame.

    Parameters
    ----------
    loops : the placed outline and holes of the part.
    faces : the placed face that each peg touches.
    contacts : (contact point, outward normal) of each peg.
    shown : the visible parts of the carriers.
    own : the placed outlines that carriers at heights of their own touch.
    is_exact : whether pegs are drawn at their true radius; otherwise very small ones are drawn larger.
    gripped : the placed faces that flat jaws touch, by their numbers.
    finished : the placed outline and holes of the finished part in a raw block; empty for no raw block.
    """

    fixture: Fixture
    toolkit: Toolkit
    loops: list[list[Segment]]
    faces: list[Segment]
    contacts: list[tuple[Point, Point]]
    shown: ShownSetUp
    own: list[list[Segment]] = field(factory=list)
    is_exact: bool = False
    gripped: Mapping[int, Segment] = field(factory=dict)
    finished: list[list[Segment]] = field(factory=list)

    @property
    def extent(self) -> Box:
        """The box of all that is shown, in mm."""
        return self.shown.extent

    def sample_outlines(self, view: View, step: float) -> list[NDArray[np.float64]]:
        """Return (N, 2) page points around each loop of the part, about ``step`` page units apart."""
        return [sample_loop(loop, view, step) for loop in self.loops]

    @property
    def touching(self) -> list[int]:
        """The indices of the pegs that touch exactly one face; corners of the part on a wall are left out."""
        return [index for index, peg in enumerate(self.fixture.pegs) if peg.beside is None]

    def find_touched_piece(self, index: int) -> Segment:
        """Return the face that contact ``index`` touches.

        On a wall it is only the piece of the face between the two ends of the contact with the wall.
        """
        face, walls = self.faces[index], self.on_walls
        if index not in walls or isinstance(face, Arc):
            return face
        half = face.half_extent
        places = sorted(face.find_parameter(self.contacts[k][0]) for k in walls)
        low, high = (max(-half, min(half, place)) for place in (places[0], places[-1]))
        return face.cut_part(low, high) if low < high else face

    @property
    def on_walls(self) -> list[int]:
        """The indices of the contacts that are ends of the contact with a wall."""
        pegs = enumerate(self.fixture.pegs)
        return [k for k, peg in pegs if self.toolkit.find_carrier(peg.carrier).contact is WALL_END]

    @property
    def placed(self) -> list[int]:
        """The indices of the pegs and clamps: all contacts but the ends of the contact with a wall."""
        return [index for index, peg in enumerate(self.fixture.pegs) if peg in self.fixture.placed]

    def get_page_radius(self, view: View, index: int) -> float:
        """Return the drawn radius of peg ``index`` in page units, at least
        ``THINNEST_PEG`` unless drawn exactly.
        """
        radius = self.toolkit.find_carrier(self.fixture.pegs[index].carrier).peg_radius * view.scale
        return radius if self.is_exact and radius > 0 else max(radius, THINNEST_PEG)


def make_bench(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> BenchDrawing:
    """Return the drawing of a fixture, with everything placed in the vise frame."""
    pose = fixture.pose
    loops = [[pose.carry(segment) for segment in loop] for loop in workpiece.loop_segments]
    faces = [pose.carry(find_face(workpiece, peg.face)) for peg in fixture.pegs]
    hold = fixture.hold
    gripped = () if not isinstance(hold, JawHold) else (*hold.fixed.segments, *hold.moving.segments)
    contacts = [
        find_contact(toolkit.find_carrier(peg.carrier).contact, (peg.x, peg.y), face)
        for peg, face in zip(fixture.pegs, faces, strict=True)
    ]
    own = [
        [pose.carry(segment) for segment in loop]
        for one in workpiece.every_outline[1:]
        for loop in one.loop_segments
    ]
    held = {number: pose.carry(find_face(workpiece, number)) for number in gripped}
    inside = () if workpiece.finished is None else workpiece.finished.loop_segments
    finished = [[pose.carry(segment) for segment in loop] for loop in inside]
    shown = find_shown(fixture, toolkit, workpiece)
    return BenchDrawing(fixture, toolkit, loops, faces, contacts, shown, own, gripped=held, finished=finished)


def compute_force_arrow(bench: BenchDrawing, index: int, view: View, longest: float) -> tuple[Point, Point]:
    """Return (tail, tip) of a contact force's arrow, as page points; the tail is the contact.

    The largest force is ``longest`` page units long, and none is shorter than 0.36 of that. The arrow of a
    negative (pulling) force points out of the part.
    """
    contact, (nx, ny) = bench.contacts[index]
    forces = [abs(peg.force) for peg in bench.fixture.pegs]
    length = max(0.36, forces[index] / max([*forces, 1e-300])) * longest
    length = -length if bench.fixture.pegs[index].force < 0 else length
    x, y = view(contact)
    return (x, y), (x - length * nx, y + length * ny)


def draw_bench(
    scene: Scene,
    bench: BenchDrawing,
    view: View,
    weight: float = 1.0,
    longest: float = 62.0,
    axes: bool = True,
) -> None:
    """Draw plates, holes, walls, part, touched faces, clamps, forces and pegs, in this order.

    Parameters
    ----------
    weight : factor on line widths.
    longest : length of the longest force arrow in page units.
    axes : whether to draw the axes between which the travel is measured.
    """
    plates = scene.group("jaws")
    for carrier in bench.shown.carriers:
        draw_plate(plates, carrier, view, 5.0 * weight)
    holes = scene.group("holes")
    for carrier in bench.shown.carriers:
        draw_holes(holes, carrier, view, limit_holes_drawn(view, bench.shown))
    for wall in bench.shown.walls:
        draw_wall(scene.group("wall"), wall.bar, view, weight, wall.standouts is not None)
    if axes and bench.shown.measured:
        group = scene.group("axes")
        for low, high in (axis for measured in bench.shown.measured for axis in measured.axes):
            group.add_line([view(high), view(low)], GREY, 0.8 * weight, stroke_dasharray="12 3 2 3")
    for clamp in bench.shown.clamps:
        draw_clamp(scene, clamp, bench.shown.carriers[0], view, weight)
    if bench.shown.jaws is not None:
        draw_flat_jaws(scene.group("jaws"), bench.shown.jaws, view, weight)
    draw_part(scene, bench, view, weight)
    for clamp in bench.shown.clamps:
        draw_push(scene, clamp, view, weight)
    if isinstance(bench.fixture.hold, StrappedHold):
        draw_straps(scene, bench.fixture.hold, bench.toolkit, view, weight)
    arrows = scene.group("forces")
    # Under straps nothing is known of the locators' forces.
    for index in range(len(bench.fixture.pegs) if bench.fixture.hold is None else 0):
        tail, tip = compute_force_arrow(bench, index, view, longest)
        if hypot(tip[0] - tail[0], tip[1] - tail[1]) > 0:
            arrows.add_arrow(tail, tip, "#ffffff", 5.0 * weight, 14 * weight)
            arrows.add_arrow(tail, tip, ARROW, 2.4 * weight, 12 * weight)
    draw_pegs(scene, bench, view, weight)
    if min((bench.get_page_radius(view, index) for index in bench.placed), default=0.0) > 7.0 * weight:
        contacts = scene.group("contacts")
        for contact, _ in bench.contacts:
            contacts.add_circle(view(contact), 2.8 * weight, ARROW, "#ffffff", 1.0 * weight)


def draw_part(scene: Scene, bench: BenchDrawing, view: View, weight: float) -> None:
    """Draw the part and its touched faces; the holes of the plates show faintly through it."""
    part = scene.group("part", view)
    d = make_outline_path(bench.loops, view)
    fill = RAW_FILL if bench.finished else PART_FILL
    part.add_path(d, fill=fill, fill_rule="evenodd", fill_opacity="0.74")
    if bench.finished:
        draw_finished(part, make_outline_path(bench.finished, view), weight)
    for face in dict.fromkeys(bench.find_touched_piece(k) for k in bench.touching):
        part.add_path(
            make_segment_path(face, view),
            TOUCHED,
            8.0 * weight,
            stroke_linecap="butt",
            **{"class": "touched"},
        )
    if isinstance(bench.fixture.hold, JawHold):
        draw_grip(part, bench.fixture.hold, view, weight)
    if bench.own and bench.fixture.hold is None:
        # What clamps and other carriers of their own heights meet, as a thin line beside what pegs meet.
        part.add_path(make_outline_path(bench.own, view), BLACK, 0.8 * weight, **{"class": "own outline"})
    part.add_path(d, BLACK, 2.2 * weight, **{"class": "outline"})


def draw_finished(scene: Scene, outline: str, weight: float = 1.0) -> None:
    """Draw the finished part in its raw block, from the SVG path data of its outline."""
    scene.add_path(outline, BLACK, 1.2 * weight, PART_FILL, fill_rule="evenodd", **{"class": "finished"})


def draw_grip(scene: Scene, hold: JawHold, view: View, weight: float) -> None:
    """Draw where flat jaws touch the part: stretches along the jaws, and single points."""
    for patch, y in ((hold.fixed, 0.0), (hold.moving, hold.opening)):
        for x0, x1, _, _ in patch.rectangles:
            if x1 > x0:
                scene.add_line([view((x0, y)), view((x1, y))], TOUCHED, 8.0 * weight, **{"class": "touched"})
            else:
                scene.add_circle(view((x0, y)), 6.0 * weight, TOUCHED)


def draw_pegs(scene: Scene, bench: BenchDrawing, view: View, weight: float) -> None:
    """Draw the pegs with crosses at their centres; pegs without a diameter get a ring around their hole."""
    pegs = scene.group("pegs", view)
    holes = {carrier.carrier.name: view.scale * carrier.hole_radius for carrier in bench.shown.carriers}
    for index in bench.placed:
        peg = bench.fixture.pegs[index]
        (x, y), radius, hole = (
            view((peg.x, peg.y)),
            bench.get_page_radius(view, index),
            holes.get(peg.carrier, 0.0),
        )
        cross = min(0.55 * radius, 6.0 * weight)
        if bench.toolkit.find_carrier(peg.carrier).peg_radius == 0 and hole > radius:
            pegs.add_circle((x, y), hole, "none", PEG_FILL, 1.6 * weight, **{"class": "ring"})
        flat = bench.toolkit.find_carrier(peg.carrier).flat
        if flat is None or peg.flat_deg is None:
            pegs.add_circle((x, y), radius, PEG_FILL, BLACK, 1.2 * weight, **{"class": "peg"})
        else:
            outline = make_peg_outline((peg.x, peg.y), radius / view.scale, flat, peg.flat_deg)
            pegs.add_path(
                make_outline_path([outline], view), BLACK, 1.2 * weight, PEG_FILL, **{"class": "peg"}
            )
        if cross > 2.0 * weight:
            pegs.add_line([(x - cross, y), (x + cross, y)], "#ffffff", 1.0 * weight)
            pegs.add_line([(x, y - cross), (x, y + cross)], "#ffffff", 1.0 * weight)


# Flatter than this, in page units, there is no room for a picture.
LOWEST = 90.0
# Size of the number of a hole.
NUMBER = 10.0


def draw_inset(
    scene: Scene,
    box: Box,
    workpiece: Workpiece,
    fixture: Fixture,
    toolkit: Toolkit,
    zero: Point | None = None,
) -> None:
    """Draw the part as it was drawn (unturned), with its touched faces and contacts, into a page box.

    ``zero`` is part zero in the part's frame in mm. With a ``zero``, it is marked if it lies within the
    part's extent, and the part's holes are numbered. Draws nothing if the box is lower than ``LOWEST``.
    """
    if box.height < LOWEST:
        return
    group = scene.group("part-as-drawn")
    finished = workpiece.finished
    drawn = "The part" if finished is None else "The part in its raw block,"
    group.add_text((box.x0, box.y0 + 8), f"{drawn} as drawn (θ = 0°)", 13, fill=GREY)
    room = Box(box.x0 + 40, box.y0 + 30, box.x1 - 10, box.y1 - 24)
    bounds = Box(*workpiece.bounds)
    view = View.fit_box(bounds, room)
    d = make_outline_path(workpiece.loop_segments, view)
    group.add_path(d, fill=PART_FILL if finished is None else RAW_FILL, fill_rule="evenodd")
    if finished is not None:
        draw_finished(group, make_outline_path(finished.loop_segments, view))
    hold = fixture.hold
    gripped = () if not isinstance(hold, JawHold) else (*hold.fixed.segments, *hold.moving.segments)
    for face in dict.fromkeys((*(peg.face for peg in fixture.pegs if peg.beside is None), *gripped)):
        group.add_path(make_segment_path(find_face(workpiece, face), view), TOUCHED, 5.0)
    group.add_path(d, BLACK, 1.4)
    for point in find_contacts(workpiece, fixture, toolkit):
        group.add_circle(view(point), 3.0, ARROW, "#ffffff", 1.0)
    if zero is not None:
        number_holes(group, view, workpiece.as_finished)
        if bounds.grow(AGREEMENT).contains(Box(*zero, *zero)):
            draw_zero(group, view(zero))
    corner = (box.x0 + 4, box.y1 - 4)
    group.add_arrow(corner, (corner[0] + 30, corner[1]), GREY, 1.2, 8)
    group.add_arrow(corner, (corner[0], corner[1] - 30), GREY, 1.2, 8)
    group.add_text((corner[0] + 34, corner[1] - 1), "x", 12, fill=GREY)
    group.add_text((corner[0] + 5, corner[1] - 33), "y", 12, fill=GREY)


def number_holes(scene: Scene, view: View, workpiece: Workpiece) -> None:
    """Write numbers, from 1, into the holes of a part that are large enough."""
    for count, (loop, center) in enumerate(
        zip(workpiece.hole_segments, find_hole_centers(workpiece), strict=True), 1
    ):
        extent = reduce(Box.unite, (Box(*compute_bounding_box(segment)) for segment in loop))
        if min(extent.width, extent.height) * view.scale >= NUMBER + 2:
            scene.add_text(view(center), str(count), NUMBER, "middle", fill=GREY)


def draw_zero(scene: Scene, at: Point, radius: float = 5.0) -> None:
    """Draw the sign of a zero point at a page point: a disc with two black quarters."""
    x, y = at
    r = format_number(radius)
    scene.add_circle(at, radius, "#ffffff", BLACK, 1.0)
    for way in (1, -1):
        start, end = (
            f"{format_number(x + way * radius)} {format_number(y)}",
            f"{format_number(x)} {format_number(y - way * radius)}",
        )
        scene.add_path(f"M{format_number(x)} {format_number(y)}L{start}A{r} {r} 0 0 0 {end}Z", fill=BLACK)


def find_contacts(workpiece: Workpiece, fixture: Fixture, toolkit: Toolkit) -> list[Point]:
    """Return the contact point of each peg in the part's frame, in mm."""
    back = fixture.pose.inverse
    return [
        find_contact(
            toolkit.find_carrier(peg.carrier).contact,
            back.apply(peg.x, peg.y),
            find_face(workpiece, peg.face),
        )[0]
        for peg in fixture.pegs
    ]
