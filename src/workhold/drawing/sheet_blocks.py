"""The blocks of words and tables on a setup sheet; each writes itself down a column and can be measured beforehand."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence
from math import ceil

from attrs import frozen

from workhold.drawing.fonts import shortened, text_width, wrapped
from workhold.drawing.length_unit import LengthUnit
from workhold.drawing.panel import NUMBERS, Column, arrangement_words, draw_legend, offset_words
from workhold.drawing.scene import BLACK, Scene
from workhold.drawing.sheet_details import SheetDetails
from workhold.drawing.sheet_facts import Caution, caliper_check
from workhold.model.fixture import Fixture
from workhold.model.holes import column_letters, hole_name
from workhold.model.quality import FIGURES
from workhold.model.toolkit import Toolkit
from workhold.model.workpiece import Workpiece

__all__ = ["Block", "Sheet", "blocks_of", "height_of"]

BODY, NOTE, HEADING = 12.5, 11.0, 14.0
NAME_SIZES = (26.0, 22.0, 18.0)
MOST_NAME_LINES = 3
# More loads than this are left to the command line; the hardest are shown.
MOST_LOADS = 6
# Of the width of a column, how much the name of a load may take.
WIDEST_LOAD = 0.3
ROUNDING = 1e-9
KILO = 1000.0

Block = Callable[[Column], None]


@frozen
class Sheet:
    """What the blocks speak of; ``zero_shown`` tells whether the part's zero point lies within the plan."""

    fixture: Fixture
    workpiece: Workpiece
    toolkit: Toolkit
    details: SheetDetails
    lengths: LengthUnit
    cautions: tuple[Caution, ...]
    zero_shown: bool = True

    @property
    def name(self) -> str:
        """The part's name."""
        return self.details.part_name or self.workpiece.name

    @property
    def origin(self) -> str:
        """The name of the hole that places are told from."""
        return hole_name(self.toolkit.carriers[0].name, 0, 0)


def blocks_of(sheet: Sheet) -> tuple[list[Block], list[Block]]:
    """All blocks of a sheet in reading order: those needed beside the plan, and the others."""
    needed, others = [write_title, write_pegs, write_opening, write_zero], [write_quality]
    if sheet.cautions:
        needed.append(write_cautions)
    if sheet.details.loads:
        others.append(write_loads)
    others += [write_steps, write_counting, write_legend]
    return [bound(writer, sheet) for writer in needed], [bound(writer, sheet) for writer in others]


def bound(writer: Callable[[Column, Sheet], None], sheet: Sheet) -> Block:
    """A writer with its sheet."""
    return lambda column: writer(column, sheet)


def height_of(block: Block, width: float) -> float:
    """Height of a block in a column of a width, page units."""
    column = Column(Scene(ET.Element("g")), 0.0, 0.0, width)
    block(column)
    return column.y


def heading(column: Column, words: str) -> None:
    """Write the heading of a block above a line."""
    column.rule(1.4)
    column.words(words, HEADING, bold=True, gap=0.65)


def write_title(column: Column, sheet: Sheet) -> None:
    """Write which fixture of which part this is."""
    size = next((s for s in NAME_SIZES if text_width(sheet.name, s, bold=True) <= column.width), NAME_SIZES[-1])
    lines = wrapped(sheet.name, size, column.width, bold=True)
    if len(lines) > MOST_NAME_LINES:
        rest = " ".join(lines[MOST_NAME_LINES - 1 :])
        lines = [*lines[: MOST_NAME_LINES - 1], shortened(rest + "…", size, column.width, bold=True)]
    for line in lines:
        column.words(line, size, bold=True, gap=0.4)
    column.y += 4
    column.words(f"Fixture {sheet.details.number} of {sheet.details.count}", 16, bold=True, gap=0.5)
    column.words(arrangement_words(sheet.fixture.type, sheet.toolkit), BODY, gap=0.3)


def write_table(column: Column, header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Write a table, its first column from the left and the others flush right, in type that fits the width."""
    size = BODY
    while True:
        widths = [
            max(text_width(header[k], size, bold=True), *(text_width(row[k], size, bold=k == 0) for row in rows))
            for k in range(len(header))
        ]
        gap = (column.width - sum(widths)) / (len(header) - 1)
        if gap >= 0.6 * size or size <= 7.0:
            break
        size -= 0.5
    ends, x = [], widths[0]
    for width in widths[1:]:
        x += gap + width
        ends.append(x / column.width)
    column.row(header, ends, size, bold=True)
    for row in rows:
        column.row(row, ends, size)


def write_pegs(column: Column, sheet: Sheet) -> None:
    """Write the four pegs."""
    heading(column, f"Pegs{peg_size(sheet)}")
    force, unit = sheet.details.jaw_force, sheet.lengths.sign
    first = sheet.toolkit.carriers[0]
    header = ["Hole", first.noun, "face", f"x {unit}", f"y {unit}", "N per kN"]
    if force is not None:
        header.append(f"at {newtons(force)}")
    rows = []
    for peg in sheet.fixture.pegs:
        number = sheet.lengths.number
        row = [peg.hole, peg.jaw, str(peg.face), number(peg.x), number(peg.y), f"{KILO * peg.force:.0f}"]
        rows.append(row if force is None else [*row, newtons(force * peg.force)])
    write_table(column, header, rows)
    column.paragraph(
        f"x, y: centre of the peg, from the centre of hole {sheet.origin} of the fixed {first.noun}.", NOTE
    )
    column.paragraph(
        f"N per kN: force of the peg on the part for each kN of {first.noun} force, without friction.", NOTE
    )


def peg_size(sheet: Sheet) -> str:
    """The size of the pegs, behind a word."""
    carrier, lengths = sheet.toolkit.carriers[0], sheet.lengths
    if not carrier.peg_radius:
        return " (points, no diameter)"
    body = f", body Ø {lengths.plain(2 * carrier.body_radius)}" if carrier.body_radius > carrier.peg_radius else ""
    return f" Ø {lengths.plain(2 * carrier.peg_radius)}{body}"


def write_opening(column: Column, sheet: Sheet) -> None:
    """Write the jaw opening and how to measure it."""
    fixture, toolkit, lengths = sheet.fixture, sheet.toolkit, sheet.lengths
    first, moving = toolkit.carriers[0], toolkit.moving
    heading(column, f"{moving.noun.capitalize()} opening S")
    column.words(lengths.words(fixture.jaw_separation), 28, bold=True, gap=0.4)
    check = caliper_check(fixture, toolkit)
    one, other = (column_letters(hole[0]) for hole in (check.left, check.right))
    column.paragraph(
        f"x from the centres of column {one} of the {first.title} to those of column {other} of the {moving.title}.",
        NOTE,
    )
    left, right = hole_name(first.name, *check.left), hole_name(moving.name, *check.right)
    diameter = 2 * first.peg_radius
    spare = {2: "", 1: " (one of them a spare)", 0: " (both spare)"}[check.placed]
    column.y += 3
    column.paragraph(f"Calipers on pegs in {left} and {right}{spare}:", BODY)
    if diameter == 0:
        column.fact("centre to centre", lengths.words(check.distance), bold=True)
        return
    if check.distance > diameter:
        column.fact("inside, between the pegs", lengths.words(check.distance - diameter), bold=True)
    column.fact("outside, over both pegs", lengths.words(check.distance + diameter), bold=True)


def write_zero(column: Column, sheet: Sheet) -> None:
    """Write where the part's zero point lies and how it is turned."""
    pose, lengths = sheet.fixture.pose, sheet.lengths
    heading(column, "Part zero and angle")
    column.fact(f"x from hole {sheet.origin}", lengths.words(pose.x), bold=True)
    column.fact(f"y from hole {sheet.origin}", lengths.words(pose.y), bold=True)
    column.fact("turned by θ, counter-clockwise", f"{pose.theta_deg:.4f}°", bold=True)
    place = "" if sheet.zero_shown else ", here outside the plan"
    column.paragraph(f"Part zero is (0, 0) of the part's drawing{place}. x runs to the right, y upward.", NOTE)


def write_quality(column: Column, sheet: Sheet) -> None:
    """Write the figures of quality that are known."""
    heading(column, "Quality")
    for figure in FIGURES:
        value = sheet.fixture.quality.get(figure.key)
        if value is None:
            continue
        match figure.unit:
            case "mm":
                words = sheet.lengths.words(value)
            case "N":
                words = newtons(value)
            case _:
                words = f"{value:.4f}" if value >= 0.001 else f"{value:.2e}".replace("-", "−")
        column.fact(figure.words + (" (largest peg force)" if figure.key == "load_reaction" else ""), words)
    tolerance, lengths = sheet.details.tolerance, sheet.lengths
    if "location_error" in sheet.fixture.quality:
        allowed = f"pegs off by up to {lengths.plain(tolerance.peg, 3)}, faces by {lengths.plain(tolerance.face, 3)}"
        column.paragraph(f"Location error: {allowed}.", NOTE)


def write_loads(column: Column, sheet: Sheet) -> None:
    """Write what acts on the part, the jaw force it needs and each peg's largest force, the hardest load first."""
    details = sheet.details
    heading(column, "Loads and reactions, N")
    cases = sorted(enumerate(details.loads, 1), key=lambda numbered: -numbered[1].needed.value)
    friction = [] if details.friction is None else [f"µ {details.friction:g}"]
    header = ["Load", "jaws", *friction, *(peg.hole for peg in sheet.fixture.pegs)]
    rows = []
    for number, case in cases[:MOST_LOADS]:
        name = shortened(case.load.name or f"load {number}", BODY, WIDEST_LOAD * column.width, bold=True)
        more = [] if details.friction is None else [optional_force(case.needed_with_friction)]
        rows.append([name, plain_force(case.needed.value), *more, *map(plain_force, case.largest)])
    write_table(column, header, rows)
    if len(cases) > MOST_LOADS:
        column.paragraph(f"The other {len(cases) - MOST_LOADS} loads need no more jaw force than these.", NOTE)
    at = newtons(cases[0][1].jaw_force)
    column.paragraph("Jaws: the jaw force below which a peg lets go, without friction.", NOTE)
    if details.friction is not None:
        column.paragraph(
            f"µ {details.friction:g}: the least jaw force that could hold at all with that friction.", NOTE
        )
    column.paragraph(f"Under each peg: its largest force on the part at a jaw force of {at}.", NOTE)


def optional_force(force: float | None) -> str:
    """A force, or a dash where it is not known."""
    return "–" if force is None else plain_force(force)


def plain_force(force: float) -> str:
    """A force in N without the sign of the unit, rounded up so that nothing is promised that does not hold.

    >>> plain_force(1234.2), plain_force(0.0)
    ('1235', '0')
    """
    return f"{ceil(force - ROUNDING * abs(force)):d}"


def newtons(force: float) -> str:
    """A force in whole newtons, or with three figures when it is small.

    >>> newtons(1234.5), newtons(0.01234)
    ('1234 N', '0.0123 N')
    """
    return f"{force:.0f} N" if force >= 100 or force == 0 else f"{force:.3g} N"


def write_cautions(column: Column, sheet: Sheet) -> None:
    """Write what to beware of, each behind a sign."""
    heading(column, "Beware")
    for caution in sheet.cautions:
        y = column.y
        column.scene.text((column.x, y + 0.75 * BODY), "▲", BODY, bold=True, middle=False)
        column.paragraph(caution.sentence, BODY, indent=18)
        column.y += 2


def write_steps(column: Column, sheet: Sheet) -> None:
    """Write what to do, in order."""
    heading(column, "Setting up")
    for number, step in enumerate(steps(sheet), 1):
        column.scene.text((column.x, column.y + 0.75 * BODY), f"{number}.", BODY, bold=True, middle=False)
        column.paragraph(step, BODY, indent=18)
        column.y += 2


def steps(sheet: Sheet) -> list[str]:
    """What to do, one or two sentences each."""
    fixture, lengths = sheet.fixture, sheet.lengths
    toolkit, moving = sheet.toolkit, sheet.toolkit.moving
    there, more, back = ("Open", "wider", "Close") if toolkit.clamping > 0 else ("Close", "narrower", "Open")
    put = [
        f"{listed([peg.hole for peg in fixture.pegs if peg.jaw == carrier.name])} of the "
        f"{'fixed' if carrier.travel is None else 'sliding'} {carrier.title}"
        for carrier in toolkit.carriers
    ]
    outer = len(sheet.workpiece.loops[0])
    inside = [peg.hole for peg in fixture.pegs if peg.face >= outer]
    around = (
        f" {listed(inside)} {'stand' if len(inside) > 1 else 'stands'} inside a hole of the part." if inside else ""
    )
    turn = f"turned {fixture.pose.theta_deg:.1f}° counter-clockwise from its drawing"
    touch = listed([f"face {peg.face} at {peg.hole}" for peg in fixture.pegs])
    force = "" if sheet.details.jaw_force is None else f" with {newtons(sheet.details.jaw_force)}"
    return [
        f"Put pegs in {listed(put)}.",
        f"{there} the {moving.noun}s a little {more} than S = {lengths.words(fixture.jaw_separation)} and lay the part in "
        f"as drawn, {turn}.{around}",
        f"{back} the {moving.title} until all {NUMBERS[len(fixture.pegs)]} pegs touch. The opening is then S; if not, the "
        "part lies another way.",
        f"Clamp{force}. The pegs touch: {touch}. A strip of paper at each must not pull out.",
        f"Set the machine's zero by {sheet.origin} or by the part, as given under part zero and angle.",
    ]


def listed(words: Sequence[str]) -> str:
    """Words with commas and a last "and".

    >>> listed(["a"]), listed(["a", "b", "c"])
    ('a', 'a, b and c')
    """
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def write_counting(column: Column, sheet: Sheet) -> None:
    """Write how holes are counted."""
    lengths, first, moving = sheet.lengths, sheet.toolkit.carriers[0], sheet.toolkit.moving
    heading(column, "Counting holes")
    pitch_x, pitch_y = (lengths.plain(pitch) for pitch in first.pitch)
    peg = sheet.fixture.pegs[0]
    size, where = f"one column of holes, {pitch_y} apart", f"A on both {first.noun}s"
    if first.columns > 1:
        size = f"{first.columns} columns of holes, {pitch_x} apart; the rows are {pitch_y} apart"
        where = f"A to {column_letters(first.columns - 1)} from left to right, on each {first.noun}"
    example = f"{peg.hole} is the {first.title}'s column {column_letters(peg.column)}, row {peg.row + 1}"
    column.paragraph(f"{example}. Each {first.noun} has {size}.", BODY)
    rows = f"Row 1 is the lowest; any row of the vise will do, the same for both {first.noun}s."
    if first.rows is not None:
        rows = f"Row 1 is the lowest of {first.rows}."
    column.paragraph(f"Columns: {where}. {rows}", BODY)
    if offset := offset_words(sheet.toolkit, lengths):
        column.paragraph(f"Row 1 of the {moving.title} lies {offset} that of the {first.name}.", BODY)


def write_legend(column: Column, sheet: Sheet) -> None:
    """Explain the signs of the plan."""
    heading(column, "Signs")
    draw_legend(column, BLACK)
