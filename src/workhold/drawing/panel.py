"""The block of words and numbers beside a fixture: settings, holes, and a legend.

The legend explains the symbols common to all plans, those of moving carriers, and those of the part's rest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from workhold.drawing.bench import ARROW, PEG_FILL, TOUCHED
from workhold.drawing.carriers import draw_block_arrow, draw_sign, draw_wall
from workhold.drawing.scene import (
    BLACK,
    GREY,
    Box,
    LengthUnit,
    Scene,
    View,
    format_degrees,
    measure_text,
    shorten_text,
    wrap_text,
)
from workhold.fixels.carrier import Carrier, Measure
from workhold.fixels.contacts import CLAMP_TIP, FLAT_PIN, ROUND_PIN, WALL_END, Arrangement, ContactKind
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Point
from workhold.model.clamps import describe_tightening_order
from workhold.model.fixture import Fixture
from workhold.model.setup import list_length_settings, name_contacts
from workhold.model.workpiece import Workpiece

__all__ = [
    "FACT_NAME",
    "NUMBERS",
    "TextColumn",
    "describe_arrangement",
    "format_closure_margin",
    "describe_diameter",
    "draw_legend",
    "draw_peg_table",
    "draw_settings",
    "draw_title",
    "format_value",
    "describe_fixture",
    "describe_holes",
    "describe_move",
    "describe_row_offset",
    "name_pegs",
    "format_count",
]

# Size of the name of a fact, and the least room between it and the value.
FACT_NAME, FACT_GAP = 13.0, 8.0
# The least size of the type of a table.
SMALLEST = 7.0
# The size of that of the pegs.
TABLE = 13.5
NUMBERS = ("no", "one", "two", "three", "four", "five")


class TextColumn:
    """A column of text on a page, written line by line from the top.

    Parameters
    ----------
    scene : the scene to write on.
    x, y : upper left corner, page units; ``y`` moves down with every line.
    width : page units.
    """

    def __init__(self, scene: Scene, x: float, y: float, width: float) -> None:
        self.scene, self.x, self.y, self.width = scene, x, y, width

    def write_line(
        self, content: str, size: float, bold: bool = False, fill: str = BLACK, gap: float = 0.55
    ) -> None:
        """Write one line, shortened to fit the width; leave a gap of ``gap`` times ``size`` below it."""
        self.y += 0.75 * size
        content = shorten_text(content, size, self.width, bold)
        self.scene.add_text((self.x, self.y), content, size, bold=bold, fill=fill, middle=False)
        self.y += gap * size

    def write_paragraph(
        self, content: str, size: float, bold: bool = False, fill: str = BLACK, indent: float = 0.0
    ) -> None:
        """Write a text wrapped to the column's width, all its lines indented by ``indent`` page units."""
        for line in wrap_text(content, size, self.width - indent, bold):
            self.y += 0.75 * size
            self.scene.add_text((self.x + indent, self.y), line, size, bold=bold, fill=fill, middle=False)
            self.y += 0.55 * size

    def write_item(self, mark: str, content: str, size: float) -> None:
        """Write a paragraph behind a bold mark, such as the number of a step."""
        self.scene.add_text((self.x, self.y + 0.75 * size), mark, size, bold=True, middle=False)
        self.write_paragraph(content, size, indent=18)
        self.y += 2

    def write_fact(self, name: str, value: str, size: float = 14.0, bold: bool = False) -> None:
        """Write a name at the left and its value at the right of one line; a long value gets smaller type."""
        self.y += 0.75 * size
        self.scene.add_text((self.x, self.y), name, FACT_NAME, fill=GREY, middle=False)
        room = self.width - measure_text(name, FACT_NAME) - FACT_GAP
        fitting = min(size, size * room / measure_text(value, size, bold))
        self.scene.add_text((self.x + self.width, self.y), value, fitting, "end", bold=bold, middle=False)
        self.y += 0.62 * size

    def draw_rule(self, width: float = 1.0) -> None:
        """Draw a horizontal line across the column, ``width`` page units thick."""
        self.y += 4
        self.scene.add_line([(self.x, self.y), (self.x + self.width, self.y)], BLACK, width)
        self.y += 9

    def write_row(self, cells: Sequence[str], ends: Sequence[float], size: float, bold: bool = False) -> None:
        """Write a table row: the first cell at the left, the others right-aligned.

        ``ends`` gives their right ends as shares of the column's width.
        """
        self.y += 0.75 * size
        self.scene.add_text((self.x, self.y), cells[0], size, bold=True, middle=False)
        for cell, end in zip(cells[1:], ends, strict=True):
            self.scene.add_text(
                (self.x + end * self.width, self.y), cell, size, "end", bold=bold, middle=False
            )
        self.y += 0.7 * size

    def write_table(self, header: Sequence[str], rows: Sequence[Sequence[str]], size: float) -> None:
        """Write a table, its first column left-aligned, the others right-aligned; type
        shrinks until it fits, to ``SMALLEST``.
        """
        while True:
            widths = [
                max(
                    measure_text(header[k], size, bold=True),
                    *(measure_text(row[k], size, bold=k == 0) for row in rows),
                )
                for k in range(len(header))
            ]
            gap = (self.width - sum(widths)) / (len(header) - 1)
            if gap >= 0.6 * size or size <= SMALLEST:
                break
            size -= 0.5
        ends, x = [], widths[0]
        for width in widths[1:]:
            x += gap + width
            ends.append(x / self.width)
        self.write_row(header, ends, size, bold=True)
        for row in rows:
            self.write_row(row, ends, size)


def format_closure_margin(fixture: Fixture) -> str:
    """Return the closure margin of a fixture as a number for a picture, "–" if it is not known."""
    margin = fixture.quality.get("closure_margin")
    return "–" if margin is None else format_value(margin)


def format_value(value: float) -> str:
    """Return a figure without a unit: with four decimals, or below 0.001 as a power of ten.

    >>> format_value(0.25), format_value(0.00012)
    ('0.2500', '1.20e−04')
    """
    return f"{value:.4f}" if value >= 0.001 else f"{value:.2e}".replace("-", "−")


def describe_arrangement(arrangement: Arrangement, toolkit: Toolkit) -> str:
    """Return a toolkit's arrangement of pegs and clamps in words.

    >>> from workhold import Plate, Vise
    >>> vise, plate = Vise(pitch=10, columns=2, peg_radius=3), Plate(pitch=20, peg_radius=5)
    >>> [describe_arrangement(one, vise) for one in vise.arrangements]
    ['Type I: two pegs on each jaw', 'Type II: three pegs left, one right']
    >>> describe_arrangement(plate.arrangements[0], plate)
    'Three locators, the clamp pushes to the left'
    >>> plate = Plate(pitch=20, peg_radius=5, clamps=2)
    >>> describe_arrangement(plate.arrangements[0], plate)
    'Three locators, two clamps push to the left and downward'
    """
    if toolkit.strap_set is not None:
        return "Three locators, straps press the part down"
    clamps, noun = len(arrangement.directions), toolkit.moving.noun
    if toolkit.flat_jaws is not None:
        return "Flat jaws: one side flush on the fixed jaw, held by friction"
    if clamps:
        pushing = f"the {noun} pushes" if clamps == 1 else f"{format_count(clamps, noun, NUMBERS)} push"
        return f"{toolkit.setup_words.located_by}, {pushing} {arrangement.direction_words}"
    stands = zip(arrangement.pegs, toolkit.carriers, strict=True)
    (count, first), *others = [(count, carrier) for count, carrier in stands if carrier.has_lattice]
    pegs = format_count(count, first.peg, NUMBERS)
    if not others:
        return f"Type {arrangement.name}: {pegs} on the {first.title}"
    if all(other == count for other, _ in others):
        return f"Type {arrangement.name}: {pegs} on each {first.noun}"
    words = [f"{pegs} {first.name}", *(f"{NUMBERS[other]} {carrier.name}" for other, carrier in others)]
    return f"Type {arrangement.name}: {', '.join(words)}"


def describe_fixture(fixture: Fixture, toolkit: Toolkit) -> str:
    """Return the arrangement of a fixture's pegs and clamps in words."""
    return describe_arrangement(toolkit.find_arrangement(fixture.type, fixture.direction), toolkit)


def describe_move(move: tuple[int, int]) -> str:
    """Return a shift (columns, rows), not both 0, in words.

    >>> describe_move((3, -1)), describe_move((0, 2))
    ('3 columns further right and 1 row further down', '2 rows further up')
    """
    ways = zip(move, ("column", "row"), (("right", "left"), ("up", "down")), strict=True)
    return " and ".join(
        f"{format_count(abs(count), noun)} further {way[count < 0]}" for count, noun, way in ways if count
    )


def format_count(count: int, noun: str, numbers: Sequence[str] = ()) -> str:
    """Return a count and its noun, with a plural s unless the count is 1.

    ``numbers`` are words that replace the counts 0, 1, 2 and so on, as far as given.

    >>> format_count(1, "face"), format_count(2, "face")
    ('1 face', '2 faces')
    """
    word = numbers[count] if count < len(numbers) else count
    return f"{word} {noun}" if count == 1 else f"{word} {noun}s"


def describe_row_offset(toolkit: Toolkit, lengths: LengthUnit) -> str | None:
    """Return a phrase with the offset of the moving carrier's rows from those of the first plate; None if
    they are level.
    """
    offset = toolkit.moving.offset[1] - toolkit.plates[0].offset[1]
    return f"{lengths.format_length(abs(offset))} {'above' if offset > 0 else 'below'}" if offset else None


def draw_title(
    column: TextColumn, fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, title: str | None
) -> None:
    """Write the part's name, the fixture's title and its arrangement."""
    fitting = [size for size in (26, 22, 18) if measure_text(workpiece.name, size, bold=True) <= column.width]
    column.write_line(workpiece.name, fitting[0] if fitting else 18, bold=True, gap=0.5)
    column.write_line(title or "Fixture", 18, gap=0.5)
    column.write_paragraph(describe_fixture(fixture, toolkit), 14, fill=GREY)
    column.draw_rule(2.0)


def draw_settings(column: TextColumn, fixture: Fixture, toolkit: Toolkit, lengths: LengthUnit) -> None:
    """Write the lengths to set and how to tighten, the part's turn and origin, and the data of plates and
    pegs.
    """
    first, settings, several = (
        toolkit.plates[0],
        list_length_settings(fixture, toolkit),
        len(fixture.travels) > 1,
    )
    # What moves in this fixture, which of several clamps the toolkit has need not be its first.
    moving = settings[0].carrier
    for setting in settings:
        column.write_line(setting.caption, 13, fill=GREY, gap=0.8)
        column.write_line(lengths.format_length(setting.length), 22 if several else 32, bold=True, gap=0.4)
        if setting.tip is not None:
            pushing = f", pushes {setting.carrier.direction_words}" if several else ""
            column.write_fact(setting.label, f"{setting.place}{pushing}")
    if several:
        column.write_paragraph(describe_tightening_order(fixture), 13)
        column.y += 3
        column.write_fact("Clamp freedom", f"{fixture.quality['clamp_freedom']:.1f}°")
    elif moving.direction_words:
        column.write_fact(f"{moving.noun.capitalize()} pushes", moving.direction_words)
    column.write_fact("Part turned by θ", format_degrees(fixture.pose.written_deg, 3))
    column.write_fact(
        "Part origin x, y",
        f"{lengths.format_number(fixture.pose.x)}, {lengths.format_length(fixture.pose.y)}",
    )
    column.write_fact("Closure margin", format_closure_margin(fixture))
    column.draw_rule()
    pitch = f"pitch {lengths.format_short_number(first.pitch[0])} × {lengths.format_short(first.pitch[1])}"
    if len(toolkit.plates) > 1:
        column.write_fact(f"Each {first.noun}", f"{format_count(first.column_count, 'column')}, {pitch}")
    else:
        column.write_fact(first.title.capitalize(), f"{describe_holes(first)}, {pitch}")
    if toolkit.tip_count:
        column.write_fact(f"Tip of the {moving.noun}", describe_diameter(moving, lengths))
    column.write_fact(f"{first.peg.capitalize()}s", describe_diameter(first, lengths))
    if toolkit.datum.edge is not None:
        column.write_fact(f"Row 1 from {toolkit.datum.y}", lengths.format_length(toolkit.datum.edge))
    if offset := describe_row_offset(toolkit, lengths):
        column.write_fact(f"{moving.letter} rows over {first.letter} rows", offset)
    column.draw_rule()


def describe_holes(carrier: Carrier) -> str:
    """Return the number of a plate's holes in words.

    >>> from workhold import Plate
    >>> [describe_holes(Plate(pitch=20, peg_radius=5, columns=c, rows=6).carriers[0]) for c in (8, None)]
    ['8 × 6 holes', '6 rows']
    """
    if carrier.columns is not None and carrier.rows is not None:
        return f"{carrier.columns} × {carrier.rows} holes"
    named = (("column", carrier.columns), ("row", carrier.rows))
    return next((format_count(count, noun) for noun, count in named if count is not None), "any size")


def describe_diameter(carrier: Carrier, lengths: LengthUnit) -> str:
    """Return the peg diameter of a carrier in words."""
    return (
        f"Ø {lengths.format_short(2 * carrier.peg_radius)}" if carrier.peg_radius else "points, no diameter"
    )


def draw_peg_table(column: TextColumn, fixture: Fixture, toolkit: Toolkit, lengths: LengthUnit) -> None:
    """Write the table of the pegs: hole, face, place and force."""
    first, rows = toolkit.plates[0], []
    for peg, name in zip(fixture.pegs, name_contacts(fixture, toolkit), strict=True):
        carrier, force = toolkit.find_carrier(peg.carrier), f"{peg.force:z.3f}".replace("-", "−")
        named = name.removeprefix(f"{carrier.noun} ") if carrier.measure == "tip" else name
        rows.append([named, peg.touched, lengths.format_number(peg.x), lengths.format_number(peg.y), force])
    where = "Peg in" if first.letter else "In hole"
    column.write_table([where, "face", f"x {lengths.sign}", f"y {lengths.sign}", "force"], rows, TABLE)
    column.y += 2
    column.write_line(toolkit.datum.describe_peg_centres(name_pegs(toolkit)), 11, fill=GREY)
    of = "both clamps' force" if len(fixture.travels) > 1 else "clamping force"
    column.write_line(f"Forces act on the part, for each unit of {of}.", 11, fill=GREY)
    column.draw_rule()


def name_pegs(toolkit: Toolkit) -> str:
    """Return the nouns of a toolkit's pegs, such as "peg" or "locator or clamp"."""
    return " or ".join(
        dict.fromkeys(carrier.peg for carrier in toolkit.carriers if carrier.contact.is_placed)
    )


# Draws a sign about a page point.
Sign = Callable[[Scene, Point], None]

WORDS = 11.5


def draw_peg_sign(scene: Scene, at: Point) -> None:
    """Draw a peg for the legend."""
    scene.add_circle(at, 7, PEG_FILL, BLACK, 1.2)


def draw_hole_sign(scene: Scene, at: Point) -> None:
    """Draw an empty hole for the legend."""
    scene.add_circle(at, 7, "#ffffff", GREY, 0.9)


def draw_push_sign(scene: Scene, at: Point) -> None:
    """Draw the arrow behind a clamp for the legend."""
    draw_block_arrow(scene, at, (-1.0, 0.0), 0.55)


def draw_line_sign(scene: Scene, at: Point) -> None:
    """Draw, for the legend, the dashed line of holes along which a clamp's tip moves."""
    scene.add_line([(at[0] - 15, at[1]), (at[0] + 16, at[1])], BLACK, 1.0, stroke_dasharray="7 4")


def draw_wall_sign(scene: Scene, at: Point) -> None:
    """Draw a piece of wall for the legend."""
    draw_wall(scene, Box(at[0] - 15, -at[1] - 6, at[0] + 16, -at[1] + 3), View(1.0, 0.0, 0.0))


def draw_force_sign(scene: Scene, at: Point) -> None:
    """Draw a contact with the arrow of its force for the legend."""
    x, y = at
    scene.add_circle((x - 14, y), 2.8, ARROW)
    scene.add_arrow((x - 14, y), (x + 16, y), ARROW, 2.4, 12)


def draw_face_sign(scene: Scene, at: Point) -> None:
    """Draw a touched face for the legend."""
    ends = [(at[0] - 15, at[1]), (at[0] + 16, at[1])]
    scene.add_line(ends, TOUCHED, 8)
    scene.add_line(ends, BLACK, 2.2)


PUSH = draw_push_sign, "which way the clamp pushes"
# The signs of what moves, by what is set on it, and of what else a part touches, by the kind of contact.
OF_MOVING: Mapping[Measure, tuple[tuple[Sign, str], ...]] = {
    "opening": (),
    "stroke": ((draw_sign, "clamp: bolt, body and tip"), PUSH),
    "tip": ((draw_line_sign, "line of holes that the clamp is on"), PUSH),
}
OF_CONTACTS: Mapping[ContactKind, tuple[tuple[Sign, str], ...]] = {
    ROUND_PIN: (),
    FLAT_PIN: (),
    CLAMP_TIP: (),
    WALL_END: ((draw_wall_sign, "{noun} that the part lies flush on"),),
}


def draw_legend(
    column: TextColumn, toolkit: Toolkit, fill: str = GREY, more: Sequence[tuple[Sign, str]] = ()
) -> None:
    """Write the legend of the signs.

    ``more`` are further (sign, words), written last; ``fill`` is the colour of the words.
    """
    first = toolkit.plates[0]
    named = f"{first.noun}, column, row" if first.letter else "column, row"
    signs: list[tuple[Sign, str]] = [
        (draw_peg_sign, f"{first.peg} to place, with its hole: {named}"),
        (draw_hole_sign, "hole, left empty"),
        *OF_MOVING[toolkit.moving.measure],
        *(
            (draw, words.format(noun=one.noun))
            for one in toolkit.carriers
            for draw, words in OF_CONTACTS[one.contact]
        ),
        (draw_force_sign, f"force of the {name_pegs(toolkit)} on the part, longer if larger"),
        (draw_face_sign, "face touched, with its number"),
        *more,
    ]
    for draw, words in signs:
        y = column.y + 8
        draw(column.scene, (column.x + 16, y))
        size = min(WORDS, WORDS * (column.width - 44) / measure_text(words, WORDS))
        column.scene.add_text((column.x + 44, y), words, size, fill=fill)
        column.y += 21
