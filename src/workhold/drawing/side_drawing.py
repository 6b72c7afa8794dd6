"""A view of a set-up from the side, to scale, with its heights and the names of pegs, clamps and supports.

The drawing extends across the top of a page. At its left are dimensions, at its right the heights of all
levels above the lying plane, below it the names of pegs, clamps and supports. Names are moved apart so that
none covers another, each as near to its place as possible.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from attrs import frozen

from workhold.drawing.annotation import draw_dimension_line
from workhold.drawing.bench import PART_FILL, PEG_FILL, TOUCHED
from workhold.drawing.carriers import FENCE, SLIDING, STILL
from workhold.drawing.panel import TextColumn
from workhold.drawing.scene import BLACK, GREY, UNITS_PER_MM, Box, LengthUnit, Scene, View, measure_text
from workhold.drawing.sheet_writing import NOTE
from workhold.drawing.side_view import SideContact, SideView
from workhold.drawing.support_signs import SUPPORT

__all__ = ["SideFigure", "move_apart"]

TITLE, TITLE_ROOM, NOTE_GAP = 14.0, 34.0, 8.0
# Room above the part without and with a clamp on top, and below the plates for names, page units.
ABOVE, CLAMP_ROOM, NAMES_ROOM = 16.0, 74.0, 48.0
# Size of the words of levels and dimensions, and of names; the least distance of names in a row.
WORDS, NAMES, NAME_GAP = 12.0, 12.5, 10.0
# From what is drawn to the first dimension line, between dimension lines, and from these to their words or
# from what is drawn to the heights at the right.
OUT, BETWEEN, BEND = 20.0, 18.0, 24.0
# Thinner than this, page units, nothing is drawn.
THINNEST = 2.5
# Of a dimension line shorter than this the arrows are outside.
TIGHT, OUTSIDE = 26.0, 15.0
LEVEL = "#aab2bc"
# The view's scale is at most so many times that of the plan.
LARGER = 2.0
HEIGHT_OF_LINE = 15.0
STEM, HEAD = 44.0, 12.0


@frozen
class SideFigure:
    """A side view with its lettering.

    Parameters
    ----------
    view : the view to draw.
    lengths : format of lengths.
    plates : the noun of the pegs' carriers, such as "jaws".
    """

    view: SideView
    lengths: LengthUnit
    plates: str = "plate"

    @property
    def levels(self) -> list[tuple[float, str]]:
        """(height in mm, words) of each level to mark, from the lowest to the highest."""
        heights, number = self.view.heights, self.lengths.format_number
        marks: dict[float, list[str]] = {0.0: ["the part lies here"]}
        marks.setdefault(heights.thickness, []).append("top of the part")
        marks.setdefault(heights.peg_top, []).append("top of the pegs")
        if self.is_clamped_lower:
            marks.setdefault(self.view.clamped_height, []).append("clamp on top presses")
        if heights.head_room and heights.known_up_to < heights.thickness:
            room = number(heights.head_room)
            marks.setdefault(heights.known_up_to, []).append(f"head room {room}")
        if heights.supported_by:
            marks.setdefault(-heights.supported_by, []).append(f"top of the {self.plates}")
        return [
            (height, f"{'+' if height > 0 else ''}{number(height)} {', '.join(words)}")
            for height, words in sorted(marks.items())
        ]

    @property
    def is_clamped_lower(self) -> bool:
        """Whether the clamp on top presses on a face that is lower than the top of the part."""
        return self.view.clamp is not None and self.view.clamped_height < self.view.heights.thickness

    @property
    def highest(self) -> float:
        """The height in mm of the part's or the pegs' top, whichever is higher."""
        return max(self.view.heights.thickness, self.view.heights.peg_top)

    @property
    def dimensions(self) -> list[tuple[float, float, str]]:
        """(from, to, words) of each dimension at the left, heights in mm; the last of them is outermost."""
        heights, words = self.view.heights, self.lengths.format_length
        low, found = -heights.supported_by, list[tuple[float, float, str]]()
        if heights.supported_by:
            found.append((low, 0.0, f"supports {words(heights.supported_by)}"))
        found.append((low, heights.peg_top, f"pegs {words(heights.above_plate)}"))
        found.append((0.0, heights.thickness, f"part {words(heights.thickness)}"))
        return found

    @property
    def left_room(self) -> float:
        """The width of the room for the dimensions at the left, page units."""
        lines = self.dimensions
        return OUT + BETWEEN * len(lines) + BEND + max(measure_text(words, WORDS) for _, _, words in lines)

    @property
    def right_room(self) -> float:
        """The width of the room for the words of levels at the right, page units."""
        return BEND + 8 + max(measure_text(words, WORDS) for _, words in self.levels)

    @property
    def top_room(self) -> float:
        """The height of the room above the drawing for the title and the clamp on top, page units."""
        return TITLE_ROOM + (ABOVE if self.view.clamp is None else CLAMP_ROOM)

    @property
    def title(self) -> str:
        """The title of the view, without the scale."""
        return f"Side view {self.view.way.words}, along {self.view.way.seen_along}"

    @property
    def notes(self) -> list[str]:
        """The sentences below the view."""
        heights, words = self.view.heights, self.lengths.format_length
        notes = [
            "Heights above the plane on which the part lies, in "
            f"{'inches' if self.lengths.sign == 'in' else self.lengths.sign}."
        ]
        if heights.head_room is None:
            notes.append("The part is drawn as a prism of its outline.")
        elif heights.known_up_to < heights.thickness:
            notes.append(
                f"Up to {words(heights.known_up_to)} the part is drawn as wide as everything that pegs "
                "can meet. Above, in pale colour, its true shape may be less: only its height and its "
                "level upper faces (dashed) are known."
            )
        else:
            notes.append(
                "The part is drawn as wide as its outline at every height; its true shape may be less."
            )
        notes.append("Thick lines on the part show where pegs press, over the heights of their faces.")
        if any(one.is_hidden for one in self.view.contacts):
            notes.append("Things with grey names are behind the part.")
        assumed = [
            f"{name} {words(value)}"
            for key, name, value in (
                ("supported_by", "height of the supports", heights.supported_by),
                ("plate_thickness", f"thickness of the {self.plates}", heights.plate_thickness),
                ("peg_top", "pegs as high as the part,", heights.peg_top),
            )
            if key in heights.assumed
        ]
        if assumed:
            notes.append(f"Assumed, because no value is given: {'; '.join(assumed)}.")
        return notes

    def compute_largest_scale(self, width: float, most: float, plan: float) -> float:
        """Return the largest scale factor, mm on paper per mm, at which the view fits.

        It is at most ``LARGER`` times the plan's.

        Parameters
        ----------
        width, most : width and largest height on the page, page units.
        plan : scale factor of the plan.
        """
        extent = self.view.extent
        across = (width - self.left_room - self.right_room) / extent.width
        high = (most - self.top_room - NAMES_ROOM) / extent.height
        return min(LARGER * plan, across / UNITS_PER_MM, high / UNITS_PER_MM)

    def compute_height(self, width: float, factor: float) -> float:
        """Return the height in page units of the view with its lettering, drawn ``width`` page units wide.

        ``factor`` is the scale factor, mm on paper per mm.
        """
        notes = TextColumn(Scene.make_page((1.0, 1.0), ""), 0.0, 0.0, width)
        notes.write_paragraph(" ".join(self.notes), NOTE)
        drawn = self.view.extent.height * factor * UNITS_PER_MM
        return self.top_room + drawn + NAMES_ROOM + (notes.y + NOTE_GAP)

    def draw(self, scene: Scene, box: Box, name: str, factor: float) -> None:
        """Draw the view with its lettering into a page box.

        ``name`` is that of the scale, such as "1:2", and ``factor`` its mm on paper per mm.
        """
        head = TextColumn(scene.group("words"), box.x0, box.y0, box.width)
        head.draw_rule(1.4)
        head.write_line(f"{self.title}, scale {name}", TITLE, bold=True)
        scale, extent = factor * UNITS_PER_MM, self.view.extent
        room = box.width - self.left_room - self.right_room
        left = box.x0 + self.left_room + (room - scale * extent.width) / 2
        page = View(scale, left - scale * extent.x0, box.y0 + self.top_room + scale * extent.y1)
        drawn = page.map_box(extent)
        self.draw_levels(scene.group("levels"), page, drawn)
        self.draw_bodies(scene.group("side", page), page)
        self.draw_dimensions(scene.group("heights"), page, drawn)
        self.draw_names(scene.group("names"), page, Box(box.x0, drawn.y0, box.x1, drawn.y1))
        foot = TextColumn(scene.group("words"), box.x0, drawn.y1 + NAMES_ROOM, box.width)
        foot.write_paragraph(" ".join(self.notes), NOTE)

    def draw_bodies(self, scene: Scene, page: View) -> None:
        """Draw plates, pegs, supports, the part, clamps and walls, those hidden by the part first.

        ``page`` is the map from mm to the page.
        """
        view, heights = self.view, self.view.heights
        low = -heights.supported_by
        for span in view.plates:
            fill, edge = STILL
            scene.add_rectangle(
                page.map_box(Box(span[0], low - heights.plate_thickness, span[1], low)), fill, edge, 1.4
            )
        for one in view.contacts:
            if one.is_hidden:
                self.draw_contact(scene, page, one)
        for pad in view.pads:
            box = page.map_box(Box(pad.at - view.pad_radius, low, pad.at + view.pad_radius, 0.0))
            scene.add_rectangle(box, SUPPORT, BLACK, 1.0)
        self.draw_part(scene, page)
        for one in view.contacts:
            if not one.is_hidden:
                self.draw_contact(scene, page, one)
        for span in view.walls:
            begin, top = view.wall_heights or (0.0, heights.peg_top)
            box = page.map_box(Box(span[0], begin or low, span[1], top))
            scene.add_path(
                make_box_path(box), FENCE[1], 1.2, FENCE[0], fill_opacity="0.5", **{"class": "fence"}
            )
        for one in view.contacts:
            self.draw_band(scene, page, one)
        if view.clamp is not None:
            self.draw_top_clamp(scene, page)

    def draw_part(self, scene: Scene, page: View) -> None:
        """Draw the part up to the height up to which its outline is known.

        Above that height it is drawn pale, with its level faces dashed.
        """
        view, heights = self.view, self.view.heights
        known = page.map_box(Box(view.part[0], 0.0, view.part[1], heights.known_up_to))
        scene.add_path(
            make_box_path(known), BLACK, 1.8, PART_FILL, fill_opacity="0.82", **{"class": "part-side"}
        )
        if heights.known_up_to < heights.thickness:
            rest = page.map_box(Box(view.upper[0], heights.known_up_to, view.upper[1], heights.thickness))
            # Without a border: of a dome nothing stands in the corners.
            scene.add_path(
                make_box_path(rest), PART_FILL, 0.0, PART_FILL, fill_opacity="0.4", **{"class": "unknown"}
            )
            for (low, high), height in view.tops:
                ends = [page((low, height)), page((high, height))]
                scene.add_line(ends, BLACK, 1.4, stroke_dasharray="7 4", **{"class": "upper-face"})
        for low, high in view.feet:
            scene.add_line([page((low, 0.0)), page((high, 0.0))], BLACK, 3.4, **{"class": "foot-face"})

    def draw_contact(self, scene: Scene, page: View, one: SideContact) -> None:
        """Draw a peg with its dashed foot in the plate, or a clamp."""
        heights = self.view.heights
        begin, top = one.heights or (0.0, heights.peg_top)
        low = begin or -heights.supported_by
        radius = max(one.radius, THINNEST / page.scale / 2)
        if one.is_clamp:
            ends = [one.at] if one.hole is None else [one.at, one.hole]
            box = page.map_box(Box(min(ends) - radius, low, max(ends) + radius, top))
            scene.add_rectangle(box, SLIDING[0], SLIDING[1], 1.2, 2.0)
            middle = page.map_box(Box(one.at - radius, low, one.at + radius, top)).center[0]
            scene.add_line([(middle, box.y0), (middle, box.y1)], SLIDING[1], 0.8, stroke_dasharray="8 2 2 2")
            return
        box = page.map_box(Box(one.at - radius, low, one.at + radius, top))
        scene.add_rectangle(box, PEG_FILL, BLACK, 1.0)
        foot = page.map_box(Box(one.at - radius, heights.peg_top - heights.peg_length, one.at + radius, low))
        if not begin and foot.y1 > foot.y0:
            scene.add_path(
                make_box_path(foot), PEG_FILL, 0.9, stroke_dasharray="4 2.5", **{"class": "peg-foot"}
            )

    def draw_band(self, scene: Scene, page: View, one: SideContact) -> None:
        """Draw the heights at which a peg presses as a thick line on the part; nothing if they are unknown."""
        if one.band is None:
            return
        ends = [page((one.touches, height)) for height in one.band]
        scene.add_line(ends, TOUCHED, 6.0, **{"class": "band"})
        scene.add_line(ends, BLACK, 1.2)

    def draw_top_clamp(self, scene: Scene, page: View) -> None:
        """Draw the clamp on top as an arrow with a tip."""
        assert self.view.clamp is not None
        x, y = page((self.view.clamp, self.view.clamped_height))
        stem = page((self.view.clamp, self.highest))[1] - HEAD
        half = max(self.view.tip_radius * page.scale, 4.0)
        scene.add_arrow((x, min(stem, y - HEAD) - STEM), (x, y - HEAD), SUPPORT, 3.0, 14)
        scene.add_rectangle(Box(x - half, y - HEAD, x + half, y), "#ffffff", SUPPORT, 1.8, 2.0)

    def draw_levels(self, scene: Scene, page: View, drawn: Box) -> None:
        """Draw the lines of the levels with their words at the right."""
        levels = self.levels
        wanted = [page((0.0, height))[1] for height, _ in levels]
        low, high = drawn.y0 - ABOVE - HEIGHT_OF_LINE, drawn.y1 + NAMES_ROOM - 12
        places = move_apart(wanted, [HEIGHT_OF_LINE] * len(levels), 1.0, low, high)
        for (_, words), y, at in zip(levels, wanted, places, strict=True):
            right = drawn.x1 + 8
            scene.add_line([(drawn.x0 - OUT - 6, y), (right, y), (right + BEND - 6, at)], LEVEL, 0.7)
            scene.add_text((right + BEND - 2, at), words, WORDS)

    def draw_dimensions(self, scene: Scene, page: View, drawn: Box) -> None:
        """Draw the heights as dimensions at the left."""
        lines = self.dimensions
        wanted = [page((0.0, (start + end) / 2))[1] for start, end, _ in lines]
        places = move_apart(
            wanted, [HEIGHT_OF_LINE] * len(lines), 1.0, drawn.y0 - CLAMP_ROOM, drawn.y1 + NAMES_ROOM
        )
        left = drawn.x0 - OUT - BETWEEN * len(lines)
        for number, ((start, end, words), middle, at) in enumerate(zip(lines, wanted, places, strict=True)):
            x = drawn.x0 - OUT - BETWEEN * number
            low, high = page((0.0, start))[1], page((0.0, end))[1]
            for y in (low, high):
                scene.add_line([(drawn.x0 - 4, y), (x - 4, y)], BLACK, 0.6)
            draw_dimension_line(scene, (x, low), (x, high), TIGHT, OUTSIDE, 9)
            scene.add_line([(x, middle), (left, middle), (left - BEND + 8, at)], BLACK, 0.6)
            scene.add_circle((x, middle), 1.8, BLACK)
            scene.add_text((left - BEND + 4, at), words, WORDS, "end")

    def draw_names(self, scene: Scene, page: View, row: Box) -> None:
        """Write the names of pegs, clamps and supports below the plates, each with a leader.

        Names of things at the same horizontal place are joined to one.
        """
        view = self.view
        found: dict[tuple[float, str], list[str]] = {}
        for one in view.contacts:
            at = round(page((one.at, 0.0))[0], 1)
            found.setdefault((at, GREY if one.is_hidden else BLACK), []).append(one.name)
        for pad in view.pads:
            found.setdefault((round(page((pad.at, 0.0))[0], 1), SUPPORT), []).append(pad.name)
        named = sorted(found.items())
        words = [", ".join(names) for _, names in named]
        wanted = [at for (at, _), _ in named]
        sizes = [measure_text(name, NAMES, bold=True) for name in words]
        places = move_apart(wanted, sizes, NAME_GAP, row.x0, row.x1)
        y = row.y1 + 30
        for ((at, colour), _), name, middle in zip(named, words, places, strict=True):
            scene.add_line([(at, row.y1 + 2), (at, row.y1 + 8), (middle, y - 9)], colour, 0.8)
            scene.add_text((middle, y), name, NAMES, "middle", bold=True, fill=colour)
        if view.clamp is not None:
            x, top = page((view.clamp, self.highest))
            scene.add_text((x + 12, top - STEM), "clamp on top", NAMES, bold=True, fill=SUPPORT, halo=2.5)


def make_box_path(box: Box) -> str:
    """Return SVG path data of a box's outline."""
    corners = ((box.x0, box.y0), (box.x1, box.y0), (box.x1, box.y1), (box.x0, box.y1))
    return "M" + "L".join(f"{x:.3f} {y:.3f}" for x, y in corners) + "Z"


def move_apart(
    wanted: Sequence[float], sizes: Sequence[float], gap: float, low: float, high: float
) -> list[float]:
    """Return the middles of names on a line, at least ``gap`` apart, as near to their wanted middles as
    possible.

    ``wanted`` are the wanted middles and ``sizes`` the names' lengths; the result has the order of
    ``wanted``. Along the line the names are in the order of their wanted middles. They lie between ``low``
    and ``high``, or begin at ``low`` if there is too little room. The sum of squares of the moves is least:
    runs of names that touch move together (pool adjacent violators).

    Examples
    --------
    >>> move_apart([10.0, 10.0, 60.0], [10.0, 10.0, 10.0], 2.0, -9.0, 100.0)
    [4.0, 16.0, 60.0]
    """
    order = sorted(range(len(wanted)), key=lambda k: (wanted[k], k))
    # Distance of each middle from that of the first name, where all of them touch.
    offsets = [0.0]
    for one, other in pairwise(order):
        offsets.append(offsets[-1] + (sizes[one] + sizes[other]) / 2 + gap)
    runs: list[tuple[float, int]] = []
    for k, offset in zip(order, offsets, strict=False):
        runs.append((wanted[k] - offset, 1))
        while len(runs) > 1 and runs[-2][0] > runs[-1][0]:
            (a, m), (b, n) = runs[-2:]
            runs[-2:] = [((a * m + b * n) / (m + n), m + n)]
    starts = [start for start, count in runs for _ in range(count)]
    if not starts:
        return []
    first, last = low + sizes[order[0]] / 2, high - sizes[order[-1]] / 2 - offsets[-1]
    placed = [0.0] * len(wanted)
    for k, offset, start in zip(order, offsets, starts, strict=True):
        placed[k] = max(min(start, last), first) + offset
    return placed
