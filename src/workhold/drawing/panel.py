"""The block of words and numbers beside a fixture: what to set, which holes to use, what the signs mean.

The legend explains the signs of every plan, of what moves, and of what the part lies on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from workhold.drawing.bench import ARROW, PEG_FILL, TOUCHED
from workhold.drawing.carriers import block_arrow, draw_sign, draw_wall
from workhold.drawing.scene import (
    BLACK,
    GREY,
    Box,
    LengthUnit,
    Scene,
    View,
    degrees_text,
    shortened,
    text_width,
    wrapped,
)
from workhold.fixels.carrier import Carrier, Measure
from workhold.fixels.contacts import CLAMP_TIP, FLAT_PIN, ROUND_PIN, WALL_END, Arrangement, ContactKind
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Point
from workhold.model.clamps import order_words
from workhold.model.fixture import Fixture
from workhold.model.setup import list_length_settings, name_contacts
from workhold.model.workpiece import Workpiece

__all__ = [
    "FACT_NAME",
    "NUMBERS",
    "TextColumn",
    "arrangement_words",
    "closure_margin",
    "diameter_words",
    "draw_legend",
    "draw_peg_table",
    "draw_settings",
    "draw_title",
    "value_words",
    "fixture_words",
    "holes_words",
    "moved_words",
    "offset_words",
    "pegs_words",
    "plural",
]

# Size of the name of a fact, and the least room between it and the value.
FACT_NAME, FACT_GAP = 13.0, 8.0
# The least size of the type of a table.
SMALLEST = 7.0
# The size of that of the pegs.
TABLE = 13.5
NUMBERS = ("no", "one", "two", "three", "four", "five")


class TextColumn:
    """Writes line after line down a page.

    Parameters
    ----------
    scene : what to write on.
    x, y : upper left corner, page units.
    width : page units.
    """

    def __init__(self, scene: Scene, x: float, y: float, width: float) -> None:
        self.scene, self.x, self.y, self.width = scene, x, y, width

    def words(
        self, content: str, size: float, bold: bool = False, fill: str = BLACK, gap: float = 0.55
    ) -> None:
        """Writes one line, shortened to fit, and leaves ``gap`` ems below it."""
        self.y += 0.75 * size
        content = shortened(content, size, self.width, bold)
        self.scene.text((self.x, self.y), content, size, bold=bold, fill=fill, middle=False)
        self.y += gap * size

    def paragraph(
        self, content: str, size: float, bold: bool = False, fill: str = BLACK, indent: float = 0.0
    ) -> None:
        """Writes as many lines as it takes, ``indent`` page units further in."""
        for line in wrapped(content, size, self.width - indent, bold):
            self.y += 0.75 * size
            self.scene.text((self.x + indent, self.y), line, size, bold=bold, fill=fill, middle=False)
            self.y += 0.55 * size

    def item(self, mark: str, content: str, size: float) -> None:
        """Writes a paragraph behind a bold mark, such as the number of a step."""
        self.scene.text((self.x, self.y + 0.75 * size), mark, size, bold=True, middle=False)
        self.paragraph(content, size, indent=18)
        self.y += 2

    def fact(self, name: str, value: str, size: float = 14.0, bold: bool = False) -> None:
        """Writes a name at the left and its value at the right of one line, in type that fits."""
        self.y += 0.75 * size
        self.scene.text((self.x, self.y), name, FACT_NAME, fill=GREY, middle=False)
        room = self.width - text_width(name, FACT_NAME) - FACT_GAP
        fitting = min(size, size * room / text_width(value, size, bold))
        self.scene.text((self.x + self.width, self.y), value, fitting, "end", bold=bold, middle=False)
        self.y += 0.62 * size

    def rule(self, width: float = 1.0) -> None:
        self.y += 4
        self.scene.line([(self.x, self.y), (self.x + self.width, self.y)], BLACK, width)
        self.y += 9

    def row(self, cells: Sequence[str], ends: Sequence[float], size: float, bold: bool = False) -> None:
        """Writes a row of a table: the first cell at the left, the others ending at shares of the width."""
        self.y += 0.75 * size
        self.scene.text((self.x, self.y), cells[0], size, bold=True, middle=False)
        for cell, end in zip(cells[1:], ends, strict=True):
            self.scene.text((self.x + end * self.width, self.y), cell, size, "end", bold=bold, middle=False)
        self.y += 0.7 * size

    def table(self, header: Sequence[str], rows: Sequence[Sequence[str]], size: float) -> None:
        """Writes a table in type that fits the width, its first column flush left, the others flush right."""
        while True:
            widths = [
                max(
                    text_width(header[k], size, bold=True),
                    *(text_width(row[k], size, bold=k == 0) for row in rows),
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
        self.row(header, ends, size, bold=True)
        for row in rows:
            self.row(row, ends, size)


def closure_margin(fixture: Fixture) -> str:
    """The closure margin in words for a picture, or a dash when it is not known."""
    margin = fixture.quality.get("closure_margin")
    return "–" if margin is None else value_words(margin)


def value_words(value: float) -> str:
    """A figure without a unit: with four decimals, or as a power of ten where these are too few.

    >>> value_words(0.25), value_words(0.00012)
    ('0.2500', '1.20e−04')
    """
    return f"{value:.4f}" if value >= 0.001 else f"{value:.2e}".replace("-", "−")


def arrangement_words(arrangement: Arrangement, toolkit: Toolkit) -> str:
    """A toolkit's arrangement of pegs in words.

    >>> from workhold import Plate, Vise
    >>> vise, plate = Vise(pitch=10, columns=2, peg_radius=3), Plate(pitch=20, peg_radius=5)
    >>> [arrangement_words(one, vise) for one in vise.arrangements]
    ['Type I: two pegs on each jaw', 'Type II: three pegs left, one right']
    >>> arrangement_words(plate.arrangements[0], plate)
    'Three locators, the clamp pushes to the left'
    >>> plate = Plate(pitch=20, peg_radius=5, clamps=2)
    >>> arrangement_words(plate.arrangements[0], plate)
    'Three locators, two clamps push to the left and downward'
    """
    clamps, noun = len(arrangement.directions), toolkit.moving.noun
    if toolkit.flat_jaws is not None:
        return "Flat jaws: one side flush on the fixed jaw, held by friction"
    if clamps:
        pushing = f"the {noun} pushes" if clamps == 1 else f"{plural(clamps, noun, NUMBERS)} push"
        return f"{toolkit.setup_words.located_by}, {pushing} {arrangement.towards}"
    stands = zip(arrangement.pegs, toolkit.carriers, strict=True)
    (count, first), *others = [(count, carrier) for count, carrier in stands if carrier.has_lattice]
    pegs = plural(count, first.peg, NUMBERS)
    if not others:
        return f"Type {arrangement.name}: {pegs} on the {first.title}"
    if all(other == count for other, _ in others):
        return f"Type {arrangement.name}: {pegs} on each {first.noun}"
    words = [f"{pegs} {first.name}", *(f"{NUMBERS[other]} {carrier.name}" for other, carrier in others)]
    return f"Type {arrangement.name}: {', '.join(words)}"


def fixture_words(fixture: Fixture, toolkit: Toolkit) -> str:
    return arrangement_words(toolkit.arrangement(fixture.type, fixture.direction), toolkit)


def moved_words(move: tuple[int, int]) -> str:
    """Columns and rows, not both 0, by which all of a set-up stands further on, in words.

    >>> moved_words((3, -1)), moved_words((0, 2))
    ('3 columns further right and 1 row further down', '2 rows further up')
    """
    ways = zip(move, ("column", "row"), (("right", "left"), ("up", "down")), strict=True)
    return " and ".join(
        f"{plural(abs(count), noun)} further {way[count < 0]}" for count, noun, way in ways if count
    )


def plural(count: int, noun: str, numbers: Sequence[str] = ()) -> str:
    """A count and its noun, the count in words if there are some for it.

    >>> plural(1, "face"), plural(2, "face")
    ('1 face', '2 faces')
    """
    word = numbers[count] if count < len(numbers) else count
    return f"{word} {noun}" if count == 1 else f"{word} {noun}s"


def offset_words(toolkit: Toolkit, lengths: LengthUnit) -> str | None:
    """The offset of the sliding carrier's rows from the first one's, in words; None where they are level."""
    offset = toolkit.moving.offset[1] - toolkit.plates[0].offset[1]
    return f"{lengths.words(abs(offset))} {'above' if offset > 0 else 'below'}" if offset else None


def draw_title(
    column: TextColumn, fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, title: str | None
) -> None:
    """Writes the part's name, the fixture's and its type."""
    fitting = [size for size in (26, 22, 18) if text_width(workpiece.name, size, bold=True) <= column.width]
    column.words(workpiece.name, fitting[0] if fitting else 18, bold=True, gap=0.5)
    column.words(title or "Fixture", 18, gap=0.5)
    column.paragraph(fixture_words(fixture, toolkit), 14, fill=GREY)
    column.rule(2.0)


def draw_settings(column: TextColumn, fixture: Fixture, toolkit: Toolkit, lengths: LengthUnit) -> None:
    first, settings, several = (
        toolkit.plates[0],
        list_length_settings(fixture, toolkit),
        len(fixture.travels) > 1,
    )
    # What moves in this fixture, which of several clamps the toolkit has need not be its first.
    moving = settings[0].carrier
    for setting in settings:
        column.words(setting.caption, 13, fill=GREY, gap=0.8)
        column.words(lengths.words(setting.length), 22 if several else 32, bold=True, gap=0.4)
        if setting.tip is not None:
            pushing = f", pushes {setting.carrier.towards}" if several else ""
            column.fact(setting.label, f"{setting.place}{pushing}")
    if several:
        column.paragraph(order_words(fixture), 13)
        column.y += 3
        column.fact("Clamp freedom", f"{fixture.quality['clamp_freedom']:.1f}°")
    elif moving.towards:
        column.fact(f"{moving.noun.capitalize()} pushes", moving.towards)
    column.fact("Part turned by θ", degrees_text(fixture.pose.written_deg, 3))
    column.fact("Part origin x, y", f"{lengths.number(fixture.pose.x)}, {lengths.words(fixture.pose.y)}")
    column.fact("Closure margin", closure_margin(fixture))
    column.rule()
    pitch = f"pitch {lengths.short_number(first.pitch[0])} × {lengths.short(first.pitch[1])}"
    if len(toolkit.plates) > 1:
        column.fact(f"Each {first.noun}", f"{plural(first.column_count, 'column')}, {pitch}")
    else:
        column.fact(first.title.capitalize(), f"{holes_words(first)}, {pitch}")
    if toolkit.tips:
        column.fact(f"Tip of the {moving.noun}", diameter_words(moving, lengths))
    column.fact(f"{first.peg.capitalize()}s", diameter_words(first, lengths))
    if toolkit.datum.edge is not None:
        column.fact(f"Row 1 from {toolkit.datum.y}", lengths.words(toolkit.datum.edge))
    if offset := offset_words(toolkit, lengths):
        column.fact(f"{moving.letter} rows over {first.letter} rows", offset)
    column.rule()


def holes_words(carrier: Carrier) -> str:
    """How many holes a plate has.

    >>> from workhold import Plate
    >>> [holes_words(Plate(pitch=20, peg_radius=5, columns=c, rows=6).carriers[0]) for c in (8, None)]
    ['8 × 6 holes', '6 rows']
    """
    if carrier.columns is not None and carrier.rows is not None:
        return f"{carrier.columns} × {carrier.rows} holes"
    named = (("column", carrier.columns), ("row", carrier.rows))
    return next((plural(count, noun) for noun, count in named if count is not None), "any size")


def diameter_words(carrier: Carrier, lengths: LengthUnit) -> str:
    return f"Ø {lengths.short(2 * carrier.peg_radius)}" if carrier.peg_radius else "points, no diameter"


def draw_peg_table(column: TextColumn, fixture: Fixture, toolkit: Toolkit, lengths: LengthUnit) -> None:
    """Writes the pegs: hole, face, place and force."""
    first, rows = toolkit.plates[0], []
    for peg, name in zip(fixture.pegs, name_contacts(fixture, toolkit), strict=True):
        carrier, force = toolkit.carrier(peg.carrier), f"{peg.force:z.3f}".replace("-", "−")
        named = name.removeprefix(f"{carrier.noun} ") if carrier.measure == "tip" else name
        rows.append([named, peg.touched, lengths.number(peg.x), lengths.number(peg.y), force])
    where = "Peg in" if first.letter else "In hole"
    column.table([where, "face", f"x {lengths.sign}", f"y {lengths.sign}", "force"], rows, TABLE)
    column.y += 2
    column.words(toolkit.datum.centres(pegs_words(toolkit)), 11, fill=GREY)
    of = "both clamps' force" if len(fixture.travels) > 1 else "clamping force"
    column.words(f"Forces act on the part, for each unit of {of}.", 11, fill=GREY)
    column.rule()


def pegs_words(toolkit: Toolkit) -> str:
    """The nouns of a toolkit's pegs, such as "peg" or "locator or clamp"."""
    return " or ".join(
        dict.fromkeys(carrier.peg for carrier in toolkit.carriers if carrier.contact.is_placed)
    )


# Draws a sign about a page point.
Sign = Callable[[Scene, Point], None]

WORDS = 11.5


def peg(scene: Scene, at: Point) -> None:
    scene.circle(at, 7, PEG_FILL, BLACK, 1.2)


def hole(scene: Scene, at: Point) -> None:
    scene.circle(at, 7, "#ffffff", GREY, 0.9)


def push(scene: Scene, at: Point) -> None:
    """Draws the arrow behind a clamp."""
    block_arrow(scene, at, (-1.0, 0.0), 0.55)


def line(scene: Scene, at: Point) -> None:
    """Draws the line that the tip of a clamp is on."""
    scene.line([(at[0] - 15, at[1]), (at[0] + 16, at[1])], BLACK, 1.0, stroke_dasharray="7 4")


def wall(scene: Scene, at: Point) -> None:
    draw_wall(scene, Box(at[0] - 15, -at[1] - 6, at[0] + 16, -at[1] + 3), View(1.0, 0.0, 0.0))


def force(scene: Scene, at: Point) -> None:
    """Draws the arrow of a force from its contact."""
    x, y = at
    scene.circle((x - 14, y), 2.8, ARROW)
    scene.arrow((x - 14, y), (x + 16, y), ARROW, 2.4, 12)


def face(scene: Scene, at: Point) -> None:
    ends = [(at[0] - 15, at[1]), (at[0] + 16, at[1])]
    scene.line(ends, TOUCHED, 8)
    scene.line(ends, BLACK, 2.2)


PUSH = push, "which way the clamp pushes"
# The signs of what moves, by what is set on it, and of what else a part touches, by the kind of contact.
OF_MOVING: Mapping[Measure, tuple[tuple[Sign, str], ...]] = {
    "opening": (),
    "stroke": ((draw_sign, "clamp: bolt, body and tip"), PUSH),
    "tip": ((line, "line of holes that the clamp is on"), PUSH),
}
OF_CONTACTS: Mapping[ContactKind, tuple[tuple[Sign, str], ...]] = {
    ROUND_PIN: (),
    FLAT_PIN: (),
    CLAMP_TIP: (),
    WALL_END: ((wall, "{noun} that the part lies flush on"),),
}


def draw_legend(
    column: TextColumn, toolkit: Toolkit, fill: str = GREY, more: Sequence[tuple[Sign, str]] = ()
) -> None:
    """Explains the signs, ``more`` of them last; ``fill`` is the colour of the words."""
    first = toolkit.plates[0]
    named = f"{first.noun}, column, row" if first.letter else "column, row"
    signs: list[tuple[Sign, str]] = [
        (peg, f"{first.peg} to place, with its hole: {named}"),
        (hole, "hole, left empty"),
        *OF_MOVING[toolkit.moving.measure],
        *(
            (draw, words.format(noun=one.noun))
            for one in toolkit.carriers
            for draw, words in OF_CONTACTS[one.contact]
        ),
        (force, f"force of the {pegs_words(toolkit)} on the part, longer if larger"),
        (face, "face touched, with its number"),
        *more,
    ]
    for draw, words in signs:
        y = column.y + 8
        draw(column.scene, (column.x + 16, y))
        size = min(WORDS, WORDS * (column.width - 44) / text_width(words, WORDS))
        column.scene.text((column.x + 44, y), words, size, fill=fill)
        column.y += 21
