"""A fixture as it lies in the vise: jaws, part, pegs and contact forces, without any lettering."""

from __future__ import annotations

from math import hypot

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.drawing.clamps import draw_clamp, draw_push
from workhold.drawing.part import contact_of, face_of, outline_path, sampled_loop, segment_path
from workhold.drawing.plates import draw_holes, draw_plate, draw_wall, most_holes
from workhold.drawing.scene import BLACK, GREY, Box, Scene, View
from workhold.fixels.flat import peg_outline
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Point, Segment
from workhold.model.fixture import Fixture
from workhold.model.shown import Shown, shown
from workhold.model.workpiece import Workpiece

__all__ = ["ARROW", "PART_FILL", "PEG_FILL", "TOUCHED", "Bench", "bench_of", "draw_bench", "force_arrow"]

PART_FILL = "#fff7d1"
PEG_FILL = "#b3122a"
TOUCHED = "#e59a00"
ARROW = "#0b3a82"

# Pegs thinner than this on the page, in page units, are drawn this thick.
THINNEST_PEG = 3.5


@frozen
class Bench:
    """What there is to draw, in mm in the vise frame.

    Parameters
    ----------
    loops : the placed outline and holes of the part.
    faces : the placed faces the pegs touch.
    contacts : contact point and outward normal of each peg.
    shown : the carriers as far as they show.
    """

    fixture: Fixture
    toolkit: Toolkit
    loops: list[list[Segment]]
    faces: list[Segment]
    contacts: list[tuple[Point, Point]]
    shown: Shown

    @property
    def extent(self) -> Box:
        """Everything together."""
        return self.shown.extent

    def outlines(self, view: View, step: float) -> list[NDArray[np.float64]]:
        """(N, 2) page points around each loop of the part, about ``step`` page units apart."""
        return [sampled_loop(loop, view, step) for loop in self.loops]

    @property
    def touching(self) -> list[int]:
        """The pegs that touch one face each: all but corners on a wall."""
        return [index for index, peg in enumerate(self.fixture.pegs) if peg.beside is None]

    @property
    def placed(self) -> list[int]:
        """The pegs and clamps themselves: all but the ends of the contact with a wall."""
        return [index for index, peg in enumerate(self.fixture.pegs) if peg in self.fixture.placed]

    def radius(self, view: View, index: int) -> float:
        """Radius of a peg on the page."""
        carrier = self.toolkit.carrier(self.fixture.pegs[index].carrier)
        return max(carrier.peg_radius * view.scale, THINNEST_PEG)


def bench_of(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> Bench:
    """Put everything in its place."""
    pose = fixture.pose
    loops = [[pose.carry(segment) for segment in loop] for loop in workpiece.loop_segments]
    faces = [pose.carry(face_of(workpiece, peg.face)) for peg in fixture.pegs]
    contacts = [
        contact_of(toolkit.carrier(peg.carrier).contact, (peg.x, peg.y), face)
        for peg, face in zip(fixture.pegs, faces, strict=True)
    ]
    return Bench(fixture, toolkit, loops, faces, contacts, shown(fixture, toolkit, workpiece))


def force_arrow(bench: Bench, index: int, view: View, longest: float) -> tuple[Point, Point]:
    """Tail (the contact) and tip on the page of a contact force; the largest force is ``longest`` page units long.

    A force that would have to pull points away from the part.
    """
    contact, (nx, ny) = bench.contacts[index]
    forces = [abs(peg.force) for peg in bench.fixture.pegs]
    length = max(0.36, forces[index] / max([*forces, 1e-300])) * longest
    length = -length if bench.fixture.pegs[index].force < 0 else length
    x, y = view(contact)
    return (x, y), (x - length * nx, y + length * ny)


def draw_bench(
    scene: Scene, bench: Bench, view: View, weight: float = 1.0, longest: float = 62.0, axes: bool = True
) -> None:
    """Draw plates, holes, part, touched faces, forces and pegs.

    Parameters
    ----------
    weight : factor on line widths.
    longest : length of the longest force arrow in page units.
    axes : draw the axes that the travel is measured between as well.
    """
    plates = scene.group("jaws")
    for carrier in bench.shown.carriers:
        draw_plate(plates, carrier, view, 5.0 * weight)
    holes = scene.group("holes")
    for carrier in bench.shown.carriers:
        draw_holes(holes, carrier, view, most_holes(view, bench.shown))
    for wall in bench.shown.walls:
        draw_wall(scene.group("wall"), wall.bar, view, weight)
    if axes and bench.shown.measured:
        group = scene.group("axes")
        for low, high in (axis for measured in bench.shown.measured for axis in measured.axes):
            group.line([view(high), view(low)], GREY, 0.8 * weight, stroke_dasharray="12 3 2 3")
    for clamp in bench.shown.clamps:
        draw_clamp(scene, clamp, bench.shown.carriers[0], view, weight)
    draw_part(scene, bench, view, weight)
    for clamp in bench.shown.clamps:
        draw_push(scene, clamp, view, weight)
    arrows = scene.group("forces")
    for index in range(len(bench.fixture.pegs)):
        tail, tip = force_arrow(bench, index, view, longest)
        if hypot(tip[0] - tail[0], tip[1] - tail[1]) > 0:
            arrows.arrow(tail, tip, "#ffffff", 5.0 * weight, 14 * weight)
            arrows.arrow(tail, tip, ARROW, 2.4 * weight, 12 * weight)
    draw_pegs(scene, bench, view, weight)
    if min(bench.radius(view, index) for index in bench.placed) > 7.0 * weight:
        contacts = scene.group("contacts")
        for contact, _ in bench.contacts:
            contacts.circle(view(contact), 2.8 * weight, ARROW, "#ffffff", 1.0 * weight)


def draw_part(scene: Scene, bench: Bench, view: View, weight: float) -> None:
    """Draw the part: its faces, those touched underlaid, and the holes of the jaws faintly visible through it."""
    part = scene.group("part", view)
    d = outline_path(bench.loops, view)
    part.path(d, fill=PART_FILL, fill_rule="evenodd", fill_opacity="0.74")
    for face in dict.fromkeys(bench.faces[k] for k in bench.touching):
        part.path(segment_path(face, view), TOUCHED, 8.0 * weight, stroke_linecap="butt", **{"class": "touched"})
    part.path(d, BLACK, 2.2 * weight, **{"class": "outline"})


def draw_pegs(scene: Scene, bench: Bench, view: View, weight: float) -> None:
    """Draw the pegs with their centres marked."""
    pegs = scene.group("pegs", view)
    holes = {carrier.carrier.name: view.scale * carrier.hole_radius for carrier in bench.shown.carriers}
    for index in bench.placed:
        peg = bench.fixture.pegs[index]
        (x, y), radius, hole = view((peg.x, peg.y)), bench.radius(view, index), holes.get(peg.carrier, 0.0)
        cross = min(0.55 * radius, 6.0 * weight)
        if bench.toolkit.carrier(peg.carrier).peg_radius == 0 and hole > radius:
            pegs.circle((x, y), hole, "none", PEG_FILL, 1.6 * weight, **{"class": "ring"})
        flat = bench.toolkit.carrier(peg.carrier).flat
        if flat is None or peg.flat_deg is None:
            pegs.circle((x, y), radius, PEG_FILL, BLACK, 1.2 * weight, **{"class": "peg"})
        else:
            outline = peg_outline((peg.x, peg.y), radius / view.scale, flat, peg.flat_deg)
            pegs.path(outline_path([outline], view), BLACK, 1.2 * weight, PEG_FILL, **{"class": "peg"})
        if cross > 2.0 * weight:
            pegs.line([(x - cross, y), (x + cross, y)], "#ffffff", 1.0 * weight)
            pegs.line([(x, y - cross), (x, y + cross)], "#ffffff", 1.0 * weight)
