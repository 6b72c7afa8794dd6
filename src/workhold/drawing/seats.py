"""Pictures of the ways in which a part can come to rest on a fixture's pegs, and the blocks of a setup sheet
about them.

The fixture's own seat and the wrong ones are shown side by side, so that they can be recognized by sight. The
blocks say whether the part ends up in its place, and show the wrong places.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

from attrs import frozen

from workhold.drawing.bench import ARROW, PART_FILL, PEG_FILL, make_outline_path
from workhold.drawing.fixture_pictures import MOST_THUMBNAILS, arrange_cells, draw_heading
from workhold.drawing.panel import TextColumn
from workhold.drawing.scene import BLACK, GREY, LANDSCAPE, Box, Scene, View, measure_text
from workhold.drawing.seating_words import SeatingSentences
from workhold.drawing.sheet_writing import BODY, NOTE, SetupSheet, write_heading
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Point, Segment
from workhold.model.fixture import Fixture
from workhold.model.seating import Seat
from workhold.model.workpiece import Workpiece
from workhold.seating.clamping import WHY, Gauge
from workhold.units import MILLIMETRE, Unit

__all__ = ["RIGHT", "PlacedSeat", "draw_seats", "write_seating", "write_wrong_seats"]

# The right seat, and one that no reading distinguishes from it.
RIGHT, ALIKE = "#2e7d32", "#8a6d00"
# The far side of a part that is turned over.
OVER_FILL = "#dfe6ee"
# How thick a fence is drawn, in mm, and its colour.
WALL, WALL_FILL = 4.0, "#b9bec4"


def draw_seats(
    seats: Sequence[Seat],
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    *,
    title: str = "Fixture",
    unit: Unit = MILLIMETRE,
) -> str:
    """Return a picture of up to twelve seats of a fixture's pegs on an A4 sheet, with their readings.

    All seats are drawn to one scale.

    Parameters
    ----------
    seats : in the order in which they are numbered.
    title : name of the fixture.

    Returns
    -------
    str
        SVG text.
    """
    placed = [PlacedSeat.from_seat(seat, fixture, workpiece, toolkit) for seat in seats[:MOST_THUMBNAILS]]
    scene = Scene.make_page(LANDSCAPE, f"{workpiece.name}: seats")
    more = len(seats) - len(placed)
    words = "all to the same scale" if not more else f"{more} more not drawn; all to the same scale"
    draw_heading(scene, f"{workpiece.name}: {title} and its seats", words)
    for number, (one, (cell, view)) in enumerate(
        zip(placed, arrange_cells([one.extent for one in placed]), strict=True), 1
    ):
        draw_seat(scene.group("seat"), one, number, cell, view, unit)
    return scene.to_svg()


@frozen(eq=False)
class PlacedSeat:
    """A seat with its part and pegs placed, in mm in the vise frame.

    Parameters
    ----------
    seat : the seat.
    loops : loops of the placed part.
    pegs : (centre, radius, whether it touches) of each peg.
    reading : (reading in this seat, reading in the fixture's own pose).
    extent : box around part and pegs.
    walls : number of straight walls, which run along x at y = 0.
    touching : two words on the position of the part in the fixture.
    """

    seat: Seat
    loops: Sequence[Sequence[Segment]]
    pegs: list[tuple[Point, float, bool]]
    reading: tuple[float, float]
    extent: Box
    walls: int
    touching: str

    @classmethod
    def from_seat(cls, seat: Seat, fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> PlacedSeat:
        """Return a seat of a fixture with everything placed; a mirrored seat has the part turned over."""
        part = workpiece.turned_over if seat.mirrored else workpiece
        lying = part.apply_pose(seat.pose)
        touching, gauge = {contact.peg for contact in seat.contacts}, Gauge(fixture, toolkit)
        pegs = [
            ((peg.x, peg.y), toolkit.find_carrier(peg.carrier).peg_radius, k in touching)
            for k, peg in enumerate(gauge.place_pegs(seat.jaw_separation))
            if toolkit.find_carrier(peg.carrier).contact.is_placed
        ]
        reading = gauge.compute_reading(seat.jaw_separation), gauge.setting.length
        bounds, walls = Box(*lying.bounds), len(toolkit.ends_on_walls)
        boxes = [bounds, *(Box(*at, *at).grow(radius) for at, radius, _ in pegs)]
        boxes += [Box(bounds.x0, -WALL, bounds.x1, 0.0)] * walls
        extent, lies = reduce(Box.unite, boxes), toolkit.setup_words.touching
        return cls(seat, lying.loop_segments, pegs, reading, extent, walls, lies)


def draw_lying(scene: Scene, placed: PlacedSeat, view: View, weight: float = 1.2) -> None:
    """Draw the part of a seat, and the pegs, those that touch the part filled.

    ``weight`` is the line width in page units.
    """
    for _ in range(placed.walls):
        x0, x1 = placed.extent.x0, placed.extent.x1
        scene.add_polygon([view(at) for at in ((x0, 0.0), (x1, 0.0), (x1, -WALL), (x0, -WALL))], WALL_FILL)
    fill = OVER_FILL if placed.seat.mirrored else PART_FILL
    scene.add_path(make_outline_path(placed.loops, view), BLACK, weight, fill, fill_rule="evenodd")
    for place, radius, touches in placed.pegs:
        scene.add_circle(
            view(place), max(radius * view.scale, 2.0), PEG_FILL if touches else "#ffffff", PEG_FILL, weight
        )


def draw_seat(scene: Scene, placed: PlacedSeat, number: int, cell: Box, view: View, unit: Unit) -> None:
    """Draw a seat with its number, reading and kind into a page cell."""
    seat, (reading, own) = placed.seat, placed.reading
    colour = RIGHT if seat.is_own else ALIKE if seat.same_place else PEG_FILL
    scene.add_rectangle(cell, "#ffffff", colour, 2.0 if seat.is_own else 1.0, 5)
    draw_lying(scene, placed, view)
    side = ", turned over" if seat.mirrored else ""
    words = "right" if seat.is_own else "same place" if seat.same_place else "wrong"
    scene.add_text((cell.x0 + 10, cell.y1 - 30), f"{number}  {words}", 15, bold=True, fill=colour)
    scene.add_text(
        (cell.x1 - 10, cell.y1 - 30), f"reads {unit.format_length(reading)}", 13, "end", fill=ARROW
    )
    kind = seat.kind if seat.kind != "fixture" else placed.touching
    scene.add_text((cell.x0 + 10, cell.y1 - 12), f"{kind}{side}", 12, fill=GREY)
    if not seat.is_own:
        more = "more" if reading >= own else "less"
        scene.add_text(
            (cell.x1 - 10, cell.y1 - 12),
            f"{unit.format_length(abs(reading - own))} {more}",
            12,
            "end",
            fill=GREY,
        )


# Pictures in a row, and at most; the first is the right seat.
ACROSS, MOST = 3, 6
# Room between pictures, height of a picture by its width, and height and sizes of the lines below one, page
# units.
GAP, TALL = 8.0, 0.95
LINE, READING, SMALL = 12.5, 11.0, 9.5


def write_seating(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block on opening the jaws, placing the part and reading the length.

    With two clamps it is on putting the part in by hand.
    """
    write_heading(column, "Does the part end up there?")
    put_in, steps = sheet.details.by_hand, list[str]()
    if sheet.seating is not None:
        steps = sheet.seating.list_steps(sheet.workpiece)
    elif put_in is not None:
        column.write_paragraph(WHY, BODY)
        # The order of tightening has a block of its own.
        steps = put_in.list_steps(sheet.lengths.format_length, with_order=False)
    else:
        column.write_paragraph(sheet.details.not_seated, BODY)
    for number, step in enumerate(steps, 1):
        column.write_item(f"{number}.", step, BODY)


def write_wrong_seats(column: TextColumn, sheet: SetupSheet) -> None:
    """Draw the right seat and the wrong seats with the nearest readings, each with its reading."""
    words = sheet.seating
    assert words is not None
    write_heading(column, "What it looks like")
    for sentence in words.describe_wrong_seats():
        column.write_paragraph(sentence, BODY)
    shown = [words.own, *words.wrong[: MOST - 1]]
    width = (column.width - (ACROSS - 1) * GAP) / ACROSS
    captions = [write_caption(words, seat) for seat in shown]
    below = LINE * max(map(len, captions)) + GAP
    cells = []
    for k in range(len(shown)):
        x, y = (
            column.x + k % ACROSS * (width + GAP),
            column.y + 6 + k // ACROSS * (TALL * width + below + GAP),
        )
        cells.append(Box(x, y, x + width, y + TALL * width))
    placed = [PlacedSeat.from_seat(seat, sheet.fixture, sheet.workpiece, sheet.toolkit) for seat in shown]
    rooms = [cell.grow(-5.0) for cell in cells]
    scale = min(View.fit_box(one.extent, room).scale for one, room in zip(placed, rooms, strict=True))
    group = column.scene.group("seats")
    for one, lines, cell, room in zip(placed, captions, cells, rooms, strict=True):
        seat = one.seat
        group.add_rectangle(cell, "#ffffff", RIGHT if seat.is_own else GREY, 2.0 if seat.is_own else 0.8, 4)
        draw_lying(group, one, View.fit_box(one.extent, room, scale), 0.9)
        for k, line in enumerate(lines):
            size, colour = (READING if k == 0 else SMALL), RIGHT if seat.is_own and k == 1 else BLACK
            size = min(size, size * (width - 2) / measure_text(line, size, bold=k == 0))
            group.add_text(
                (cell.x0 + 2, cell.y1 + 11 + LINE * k), line, size, bold=k == 0, fill=colour, middle=False
            )
    column.y = cells[-1].y1 + below
    rest = len(words.wrong) - (len(shown) - 1)
    if rest:
        which = "one more is" if rest == 1 else f"{rest} more are"
        column.write_paragraph(f"The pictures show the nearest readings; {which} off by more.", NOTE)


def write_caption(words: SeatingSentences, seat: Seat) -> list[str]:
    """Return the lines below a seat's picture: its reading, the difference from the right reading, and the
    fault.
    """
    notes = ["turned over"] * seat.mirrored + ["not located"] * (seat.kind == "loose")
    notes += ["not settled"] * (seat.kind == "unsettled")
    lines = [
        words.format_reading(words.compute_reading(seat)),
        "right" if seat.is_own else words.describe_difference(seat),
    ]
    return [*lines, ", ".join(notes)] if notes else lines
