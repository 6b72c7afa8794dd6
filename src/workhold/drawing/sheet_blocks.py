"""The blocks of words and tables on a setup sheet, and their selection: title, settings, steps, quality,
loads.

The block of the pegs gives each peg's hole and the face that it touches. Two jaws have a block about their
opening and how to measure it. A plate with locators and clamps has blocks about the clamps instead. The block
about counting holes also says how far the whole set-up may be moved along them.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from math import isfinite

from workhold.drawing.hardware_table import write_hardware
from workhold.drawing.hold_blocks import list_hold_blocks, list_raw_zero_facts
from workhold.drawing.panel import (
    NUMBERS,
    TextColumn,
    describe_diameter,
    describe_fixture,
    describe_holes,
    describe_move,
    describe_row_offset,
    draw_legend,
    format_count,
    format_value,
    name_pegs,
)
from workhold.drawing.program_picture import write_program
from workhold.drawing.scene import BLACK, LengthUnit, format_degrees, measure_text, shorten_text, wrap_text
from workhold.drawing.seats import write_seating, write_wrong_seats
from workhold.drawing.sheet_facts import choose_caliper_check
from workhold.drawing.sheet_writing import (
    BODY,
    NOTE,
    Block,
    MovingBlocks,
    SetupSheet,
    Writer,
    describe_lie,
    describe_pegs_in_holes,
    make_peg_rows,
    write_dowel,
    write_fact_or_field,
    write_flats,
    write_heading,
)
from workhold.drawing.support_signs import draw_pad, draw_tip
from workhold.drawing.supports_drawn import list_support_steps, write_heights, write_supports
from workhold.drawing.upper_side import write_part, write_side, write_side_up
from workhold.errors import join_words
from workhold.fixels.carrier import Carrier, Measure, make_column_letters, make_hole_name
from workhold.fixels.contacts import WALL_END
from workhold.model.clamps import (
    compute_clamp_force_ratio,
    compute_clamp_shares,
    describe_clamp_freedom,
    describe_tightening_order,
    name_clamps,
)
from workhold.model.moved_setup import count_spare_holes, describe_overhang
from workhold.model.quality import (
    CLAMP_AMPLIFICATION,
    CLOSURE_MARGIN,
    EDGE_DISTANCE,
    FIGURES,
    LOAD_REACTION,
    LOCATION_ERROR,
    WRENCH_RADIUS,
)
from workhold.model.requirements import ANY_DIRECTION, Load
from workhold.model.setup import LengthSetting, name_contacts
from workhold.statics.loads import describe_jaw
from workhold.units import INCH

__all__ = ["make_blocks"]


def write_pegs(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the table of the pegs, and notes on where x and y are measured,
    walls, overhang, forces, flats and dowels.
    """
    toolkit, plates = sheet.toolkit, sheet.toolkit.plates
    first, noun = plates[0], toolkit.moving.noun
    write_heading(column, f"{toolkit.setup_words.standing} {describe_peg_size(sheet, first)}")
    header, rows, per = make_peg_rows(sheet)
    table = [header, *rows]
    if len(plates) > 1:
        stands_on = [first.noun, *(peg.carrier for peg in sheet.fixture.pegs)]
        table = [[row[0], word, *row[1:]] for row, word in zip(table, stands_on, strict=True)]
    column.write_table(table[0], table[1:], BODY)
    of_tips = f" or of {'the' if sheet.is_closed_at_once else 'a'} {noun}'s tip" if toolkit.tip_count else ""
    of_plate = f" of the fixed {first.noun}" if len(plates) > 1 else ""
    column.write_paragraph(
        f"x, y: centre of the {first.peg}{of_tips}, from {sheet.datum.point}{of_plate}"
        f"{'' if sheet.origin_shown else ', which lies beside the plan'}.",
        NOTE,
    )
    for wall in (carrier for carrier in toolkit.carriers if carrier.contact is WALL_END):
        write_flush(column, sheet, wall)
    if words := describe_overhang(sheet.fixture, toolkit, sheet.workpiece, sheet.lengths.format_length):
        column.write_paragraph(words, NOTE, bold=True)
    added = "" if sheet.is_closed_at_once else f"; this force is the sum of both {noun}s, in the ratio below"
    column.write_paragraph(f"{per} of {noun} force{added}, without friction.", NOTE)
    write_flats(column, sheet)
    write_dowel(column, sheet)


def describe_peg_size(sheet: SetupSheet, carrier: Carrier) -> str:
    """Return the diameter of a carrier's pegs, and of their bodies where these are wider, in words."""
    if not carrier.peg_radius:
        return "(points, no diameter)"
    lengths = sheet.lengths
    size = f"Ø {lengths.format_short(2 * carrier.peg_radius)}"
    if carrier.body_radius > carrier.peg_radius:
        size += f", body Ø {lengths.format_short(2 * carrier.body_radius)}"
    return size


def write_flush(column: TextColumn, sheet: SetupSheet, wall: Carrier) -> None:
    """Write the faces on which the part lies flush on a wall."""
    plate, edge = sheet.toolkit.plates[0], sheet.datum.edge
    ends = list(dict.fromkeys(peg.touching for peg in sheet.fixture.pegs if peg.carrier == wall.name))
    lies = f"with {ends[0]}" if len(ends) == 1 else f"from {ends[0]} to {ends[1]}"
    words = f"The part lies flush on the {wall.noun} {lies}."
    if wall.width is not None:
        words += f" The {wall.noun} is {sheet.lengths.format_length(wall.width)} wide."
    if edge is not None:
        words += f" Row 1 of the {plate.noun} is {sheet.lengths.format_length(edge)} from the {wall.noun}."
    column.write_paragraph(words, NOTE)


def write_placing_step(sheet: SetupSheet) -> str:
    """Return the sentence of the step "put the pegs in", with their holes."""
    plates, holes = sheet.toolkit.plates, list[str]()
    for plate in plates:
        there = join_words([peg.hole for peg in sheet.fixture.pegs if peg.carrier == plate.name])
        stands = "fixed" if plate.travel is None else "sliding"
        holes.append(f"{there} of the {stands} {plate.title}" if len(plates) > 1 else there)
    first, edge = plates[0], sheet.datum.edge
    return sheet.toolkit.setup_words.put.format(
        peg=first.peg,
        plate=first.noun,
        holes=join_words(holes),
        edge="" if edge is None else sheet.lengths.format_length(edge),
    )


def describe_touch(sheet: SetupSheet) -> str:
    """Return a sentence with the face that each peg touches, and the way to check it."""
    touch = join_words([f"{peg.touching} at {peg.hole}" for peg in sheet.fixture.pegs])
    return f"{touch}. A strip of paper must not pull out at any of them."


def write_opening(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block of the opening between jaws, with how to measure it by calipers on two pegs."""
    fixture, toolkit, lengths = sheet.fixture, sheet.toolkit, sheet.lengths
    first, moving = toolkit.plates[0], toolkit.moving
    write_heading(column, f"Opening S of the {moving.noun}s")
    column.write_line(lengths.format_length(fixture.travel), 28, bold=True, gap=0.4)
    if first == moving:
        column.write_paragraph(f"From {sheet.datum.y} to the centres of row 1 of the {moving.title}.", NOTE)
        return
    check = choose_caliper_check(fixture, toolkit)
    one, other = (make_column_letters(hole[0]) for hole in (check.left, check.right))
    between = f"column {one} of the {first.title} to those of column {other} of the {moving.title}"
    column.write_paragraph(f"x from the centres of {between}.", NOTE)
    left, right = make_hole_name(first.name, *check.left), make_hole_name(moving.name, *check.right)
    diameter = 2 * first.peg_radius
    spare = {2: "", 1: " (one of them a spare)", 0: " (both spare)"}[check.placed]
    column.y += 3
    column.write_paragraph(f"Calipers on pegs in {left} and {right}{spare}:", BODY)
    if diameter == 0:
        column.write_fact("centre to centre", lengths.format_length(check.distance), bold=True)
        return
    if check.distance > diameter:
        column.write_fact(
            "inside, between the pegs", lengths.format_length(check.distance - diameter), bold=True
        )
    column.write_fact("outside, over both pegs", lengths.format_length(check.distance + diameter), bold=True)


def list_opening_steps(sheet: SetupSheet) -> list[str]:
    """Return the steps of setting up a fixture between sliding jaws, one or two sentences each."""
    fixture, lengths, moving = sheet.fixture, sheet.lengths, sheet.toolkit.moving
    words, force = sheet.toolkit.setup_words, sheet.details.jaw_force
    there, more, back = "Open", "wider", "Close"
    if sheet.toolkit.clamping < 0:
        there, more, back = "Close", "narrower", "Open"
    with_force = "" if force is None else f" with {lengths.unit.format_force(force)}"
    against = f", {words.against}" if words.against else ""
    count = len(fixture.placed)
    pegs = "both" if count == 2 else f"all {NUMBERS[count]}"
    return [
        write_placing_step(sheet),
        f"{there} the {moving.noun}s a little {more} than S = {lengths.format_length(fixture.travel)} and "
        f"lay the part in as drawn, {describe_lie(sheet)}{against}.{describe_pegs_in_holes(sheet)}",
        f"{back} the {moving.title} until {pegs} pegs touch. The opening is then S; if not, the part "
        "lies another way.",
        f"Clamp{with_force}. The pegs touch: {describe_touch(sheet)}",
    ]


OPENING = MovingBlocks(lambda sheet: [write_opening], list_opening_steps)


def list_clamp_blocks(sheet: SetupSheet) -> list[Writer]:
    """Return the functions that write the blocks about clamps.

    There is a block for each clamp, and with two clamps one on the order of tightening.
    """
    shares = compute_clamp_shares(sheet.fixture)
    each: list[Writer] = [
        partial(write_clamp, setting=one, share=share)
        for one, share in zip(sheet.settings, shares, strict=True)
    ]
    return each if sheet.is_closed_at_once else [*each, write_order]


def write_clamp(column: TextColumn, sheet: SetupSheet, setting: LengthSetting, share: float) -> None:
    """Write the block of a clamp: the length to set, direction, tip, stroke and force.

    ``share`` is the clamp's share of the total clamp force.
    """
    clamp, lengths = setting.carrier, sheet.lengths
    write_heading(column, f"{setting.label} {setting.place}")
    column.write_line(
        lengths.format_length(setting.length), 28 if sheet.is_closed_at_once else 22, bold=True, gap=0.4
    )
    how = setting.mounting.how.format(place=setting.place, title=setting.caption)
    column.write_paragraph(f"{how}, once it touches.", NOTE)
    column.y += 3
    direction = clamp.direction.replace("-", "−")
    column.write_fact("pushes", f"{clamp.direction_words}, {direction}", bold=True)
    column.write_fact("round tip", describe_diameter(clamp, lengths), bold=True)
    if clamp.travel is not None and clamp.travel.most is not None:
        least, most = sorted((abs(clamp.travel.least), abs(clamp.travel.most)))
        column.write_fact(
            "stroke it has", f"{lengths.format_short_number(least)} to {lengths.format_short(most)}"
        )
    force, unit = sheet.details.jaw_force, lengths.unit
    write_fact_or_field(
        column, f"{clamp.noun} force", None if force is None else unit.format_force(share * force)
    )
    if sheet.details.loads or sheet.details.cutting is not None:
        needed = share * compute_needed_clamp_force(sheet)
        column.write_fact(
            "the loads need at least", f"{unit.format_force_rounded_up(needed)} {unit.force}", bold=True
        )
    write_fact_or_field(column, "torque of its screw", None)


def compute_needed_clamp_force(sheet: SetupSheet) -> float:
    """Return the clamp force in N that the loads and the program need; with two clamps the sum of both
    forces.
    """
    cutting = sheet.details.cutting
    needs = [case.needed.value for case in sheet.details.loads]
    return max([*needs, 0.0 if cutting is None else cutting.jaw.force])


def write_order(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the order in which to tighten two clamps, and the ratio of their forces."""
    fixture, (first, second) = sheet.fixture, name_clamps(sheet.fixture)
    write_heading(column, "Order of tightening")
    column.write_paragraph(describe_tightening_order(fixture), BODY, bold=True)
    ratio = compute_clamp_force_ratio(fixture)
    freedom = fixture.quality["clamp_freedom"]
    column.write_fact("clamp freedom, of 90°", f"{freedom:.1f}°", bold=True)
    column.write_paragraph(
        f"{describe_clamp_freedom(freedom).capitalize()}. The forces on this sheet are for {second} with "
        f"{ratio:.2f} times the force of {first}, the middle of the range that holds.",
        NOTE,
    )


def list_clamp_steps(sheet: SetupSheet) -> list[str]:
    """Return the steps of setting up with clamps, one or two sentences each."""
    toolkit, lengths, alone = sheet.toolkit, sheet.lengths, sheet.is_closed_at_once
    plate, noun = toolkit.plates[0], toolkit.moving.noun
    bolts, ups = [], []
    for setting, tip in zip(sheet.settings, sheet.fixture.pegs[-len(sheet.settings) :], strict=True):
        put = setting.mounting.put.format(clamp=f"{'the' if alone else 'a'} {noun}", place=setting.place)
        bolts.append(f"{put}, pushing {setting.carrier.direction_words}, and draw it back.")
        one = f"the {noun}" if alone else tip.hole
        what = setting.mounting.then.format(name=setting.name, title=setting.title)
        ups.append(
            f"Bring {one} up until its tip touches face {tip.face}. {what} is then "
            f"{lengths.format_length(setting.length)}{'; if not, the part lies another way.' if alone else '.'}"
        )
    if not alone:
        ups.append("If a length is not as stated, the part lies another way.")
    count = sum(peg.carrier == plate.name for peg in sheet.fixture.pegs)
    against = toolkit.setup_words.against.format(count=NUMBERS[count], peg=plate.peg)
    return [
        f"{write_placing_step(sheet)} {' '.join(bolts)}",
        f"Lay the part in as drawn, {describe_lie(sheet)}, {against}.{describe_pegs_in_holes(sheet)}",
        " ".join(ups),
        f"{describe_clamping(sheet)} They touch: {describe_touch(sheet)}",
    ]


def describe_clamping(sheet: SetupSheet) -> str:
    """Return a sentence on clamping, with those forces that are known."""
    fixture, force, unit = sheet.fixture, sheet.details.jaw_force, sheet.lengths.unit
    if sheet.is_closed_at_once:
        return f"Clamp{'' if force is None else f' with {unit.format_force(force)}'}."
    if force is None:
        return describe_tightening_order(fixture)
    shares = zip(name_clamps(fixture), compute_clamp_shares(fixture), strict=True)
    each = [f"{unit.format_force(share * force)} at {name}" for name, share in shares]
    return f"{describe_tightening_order(fixture)} {join_words(each)} add up to the {unit.format_force(force)} given."


CLAMPS = MovingBlocks(list_clamp_blocks, list_clamp_steps)


def write_counting(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the block on how holes are counted."""
    write_heading(column, "Counting holes")
    several = len(sheet.toolkit.plates) > 1
    (write_jaws if several else write_plate)(column, sheet)


def write_jaws(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the names of the holes of the two jaws, and how they are counted."""
    lengths, first, moving = sheet.lengths, sheet.toolkit.plates[0], sheet.toolkit.moving
    pitch_x, pitch_y = (lengths.format_short(pitch) for pitch in first.pitch)
    peg = sheet.fixture.pegs[0]
    size, where = f"one column of holes, {pitch_y} apart", f"A on both {first.noun}s"
    if first.column_count > 1:
        size = f"{first.column_count} columns of holes, {pitch_x} apart; the rows are {pitch_y} apart"
        where = f"A to {make_column_letters(first.column_count - 1)} from left to right, on each {first.noun}"
    example = f"{peg.hole} is the {first.title}'s column {make_column_letters(peg.column)}, row {peg.row + 1}"
    column.write_paragraph(f"{example}. Each {first.noun} has {size}.", BODY)
    rows = f"Row 1 is the lowest. It can be any row of the vise, the same one on both {first.noun}s."
    if first.rows is not None:
        rows = f"Row 1 is the lowest of {first.rows}."
    column.write_paragraph(f"Columns: {where}. {rows}", BODY)
    if offset := describe_row_offset(sheet.toolkit, lengths):
        column.write_paragraph(f"Row 1 of the {moving.title} lies {offset} that of the {first.name}.", BODY)
    if words := describe_place(sheet):
        column.write_paragraph(words, BODY)


def write_plate(column: TextColumn, sheet: SetupSheet) -> None:
    """Write how the holes of a plate are counted, and how far the set-up may be moved."""
    plate, lengths = sheet.toolkit.plates[0], sheet.lengths
    peg = next(peg for peg in sheet.fixture.pegs if peg.carrier == plate.name)
    pitch_x, pitch_y = plate.pitch
    apart = (
        f"{lengths.format_short(pitch_x)} apart both ways"
        if pitch_x == pitch_y
        else f"{lengths.format_short(pitch_x)} apart along the rows and {lengths.format_short(pitch_y)} along the columns"
    )
    named = f"{peg.hole} is column {make_column_letters(peg.column)}, row {peg.row + 1}"
    column.write_paragraph(f"{named}: columns from left to right, rows from {sheet.datum.rows_from}.", BODY)
    size = "" if plate.columns is None and plate.rows is None else f", {describe_holes(plate)}"
    column.write_paragraph(f"The holes of the {plate.noun} are {apart}{size}.", BODY)
    column.write_paragraph(describe_moving(sheet), BODY)
    if words := describe_place(sheet):
        column.write_paragraph(words, BODY)


def describe_place(sheet: SetupSheet) -> str:
    """Return a sentence with the shift of the whole set-up on its plate from its listed place.

    Returns "" if it is not moved, or if it is on supports.
    """
    if sheet.details.supports is not None or sheet.details.moved == (0, 0):
        return ""
    where = (
        "as asked" if sheet.details.is_asked_place else f"in the middle of the {sheet.toolkit.plates[0].noun}"
    )
    return f"The whole set-up stands {describe_move(sheet.details.moved)} than in the list, {where}."


def describe_moving(sheet: SetupSheet) -> str:
    """Return a sentence on how far the whole set-up may be moved along columns and rows of the plate."""
    ways = []
    spares = count_spare_holes(sheet.fixture, sheet.toolkit)
    words = (("column", "left", "right"), ("row", "down", "up"))
    for (back, ahead), (noun, down, up) in zip(spares, words, strict=True):
        for spare, way in ((ahead, up), (back, down)):
            if spare is None:
                ways.append(f"any {noun}s further {way}")
            elif spare:
                ways.append(f"up to {format_count(spare, noun)} further {way}")
    if not ways:
        return f"The set-up fits the {sheet.toolkit.noun} in this place only."
    return f"The whole set-up may stand {join_words(ways)}; then measure all places from {sheet.datum.substitute}."


ON_THE_SHEET = (
    CLOSURE_MARGIN,
    CLAMP_AMPLIFICATION,
    WRENCH_RADIUS,
    LOCATION_ERROR,
    EDGE_DISTANCE,
    LOAD_REACTION,
)
# More loads than this are left to the command line; the hardest are shown.
MOST_LOADS = 6
# Of the width of a column, how much the name of a load may take.
WIDEST_LOAD = 0.3


def write_quality(column: TextColumn, sheet: SetupSheet) -> None:
    """Write why this fixture is the first choice, and the known figures of quality that
    no other block shows.
    """
    write_heading(column, "Quality")
    for figure in (FIGURES[number] for number in ON_THE_SHEET):
        value = sheet.fixture.quality.get(figure.key)
        if value is None:
            continue
        match figure.unit:
            # The figure is then the length that stands for no edge, which nobody can measure on the part.
            case "mm" if figure.key == FIGURES[EDGE_DISTANCE].key and not any(
                map(isfinite, sheet.edge_distances)
            ):
                words = "no edge there"
            case "mm":
                words = sheet.lengths.format_length(value)
            case "N":
                words = sheet.lengths.unit.format_force(value)
            case _:
                words = format_value(value)
        column.write_fact(
            figure.words + (" (largest peg force)" if figure.key == "load_reaction" else ""), words
        )
    tolerance, lengths = sheet.details.tolerance, sheet.lengths
    if "location_error" in sheet.fixture.quality:
        sizes = (tolerance.peg, tolerance.face, tolerance.departure)
        peg, face, off = (lengths.format_short(size, 3) for size in sizes)
        read = f", of which {off} because the drawing's curves were read as arcs"
        allowed = f"pegs off by up to {peg}, faces by {face}{read if tolerance.departure else ''}"
        column.write_paragraph(f"Location error: {allowed}.", NOTE)
    if sheet.details.why_first:
        column.write_paragraph(sheet.details.why_first, NOTE)


def describe_load(load: Load, lengths: LengthUnit) -> str:
    """Return a load in words: force, place and direction in the part's frame, and moment.

    >>> describe_load(Load(((10, 5),), 200, (30, 30), -500), LengthUnit.in_mm(1))
    '200 N at x 10.0, y 5.0 mm, towards 30°; moment −0.5 N m'
    """
    unit, words = lengths.unit, []
    if load.force:
        x, y = (lengths.format_number(value) for value in load.points[0])
        place = (
            f"x {x}, y {y} {unit.abbreviation}"
            if len(load.points) == 1
            else f"the worst of {len(load.points)} points"
        )
        low, high = load.directions
        towards = f"towards {low:g}°" if low == high else f"towards {low:g}° to {high:g}°"
        any_way = load.directions == ANY_DIRECTION
        words.append(f"{unit.format_force(load.force)} at {place}, {'any direction' if any_way else towards}")
    if load.moment:
        words.append(f"moment {unit.format_moment(load.moment)}")
    return "; ".join(words)


def write_loads(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the table of loads, the hardest first, with the clamping force each load needs and each peg's
    largest force.
    """
    details, unit, moving = sheet.details, sheet.lengths.unit, sheet.toolkit.moving
    write_heading(column, f"Loads and reactions, {unit.force}")
    cases = sorted(enumerate(details.loads, 1), key=lambda numbered: -numbered[1].needed.value)
    friction = [] if details.friction is None else [f"µ {details.friction:g}"]
    names = [name.removeprefix(f"{moving.noun} ") for name in name_contacts(sheet.fixture, sheet.toolkit)]
    header = ["Load", "needs" if sheet.toolkit.tip_count else moving.pushers, *friction, *names]
    rows = []
    for number, case in cases[:MOST_LOADS]:
        name = shorten_text(case.load.name or f"load {number}", BODY, WIDEST_LOAD * column.width, bold=True)
        held = case.needed_with_friction
        more = (
            [] if details.friction is None else ["–" if held is None else unit.format_force_rounded_up(held)]
        )
        rows.append(
            [
                name,
                unit.format_force_rounded_up(case.needed.value),
                *more,
                *map(unit.format_force_rounded_up, case.largest),
            ]
        )
    column.write_table(header, rows, BODY)
    for number, case in cases[:MOST_LOADS]:
        column.write_paragraph(
            f"{case.load.name or f'load {number}'}: {describe_load(case.load, sheet.lengths)}.", NOTE
        )
    if len(cases) > MOST_LOADS:
        column.write_paragraph(
            f"The other {len(cases) - MOST_LOADS} loads need no more {moving.noun} force than these.", NOTE
        )
    at = unit.format_force(cases[0][1].jaw_force)
    what = f"the {moving.noun} force below which a peg lets go in "
    what += describe_jaw(cases[0][1].jaw_stiffness, sheet.toolkit)
    column.write_paragraph(f"{header[1].capitalize()}: {what}, without friction.", NOTE)
    if not sheet.is_closed_at_once:
        column.write_paragraph(
            f"The {moving.noun} force is the sum of both {moving.noun}s, in the ratio above.", NOTE
        )
    if details.friction is not None:
        column.write_paragraph(
            f"µ {details.friction:g}: the least {moving.noun} force that could hold at all with that "
            "friction.",
            NOTE,
        )
    column.write_paragraph(
        f"The column of each {name_pegs(sheet.toolkit)} has its largest force on the part at a "
        f"{moving.noun} force of {at}.",
        NOTE,
    )


def write_bending(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the table of the bending of pegs, and the movement of the part by it."""
    bent, lengths, mover = sheet.details.bent, sheet.lengths, sheet.toolkit.moving.noun
    assert bent is not None
    write_heading(column, f"{sheet.toolkit.plates[0].peg.capitalize()}s bend")
    at = bent.describe_force(mover, lengths.unit)
    header = [
        "",
        f"pressed at {lengths.sign}",
        f"gives way {lengths.sign}",
        f"stress {lengths.unit.pressure}",
    ]
    rows = [
        [
            peg.hole,
            lengths.format_number(peg.height),
            lengths.format_number(peg.deflection),
            lengths.unit.format_stress_number(peg.stress),
        ]
        for peg in bent.pegs
    ]
    column.write_table(header, rows, BODY)
    column.write_fact("moves the part by up to", lengths.format_length(bent.movement))
    column.write_fact("with forces at the top", lengths.format_length(bent.worst_movement))
    column.write_paragraph(
        f"{at[0].upper()}{at[1:]}, on top of the location error. The pegs are taken as built in "
        f"at the {sheet.plates_noun}, Ø {lengths.format_short(bent.most.diameter)}; in a real hole they "
        "give way more.",
        NOTE,
    )


NAME_SIZES = (26.0, 22.0, 18.0)
MOST_NAME_LINES = 3
# What a sheet says of what moves, by what is set on it.
MOVING: Mapping[Measure, MovingBlocks] = {"opening": OPENING, "stroke": CLAMPS, "tip": CLAMPS}


def make_blocks(sheet: SetupSheet) -> tuple[list[Block], list[Block]]:
    """Return (blocks needed beside the plan, other blocks) of a sheet, each in reading order."""
    if sheet.fixture.hold is not None:
        return make_hold_blocks(sheet)
    moving = MOVING[sheet.toolkit.moving.measure]
    needed: list[Writer] = [write_title, write_pegs, *moving.settings(sheet), write_zero]
    others: list[Writer] = [write_side, write_part, write_steps]
    if sheet.cautions:
        needed.append(write_cautions)
    if sheet.details.program is not None:
        needed.append(write_program)
    upright: list[Writer] = [] if sheet.details.supports is None else [write_supports]
    upright += [write_hardware] if sheet.heights is None else [write_heights, write_hardware]
    if sheet.workpiece.solid is not None:
        upright.append(write_side_up)
    others = [*upright, *others]
    if sheet.seating is not None:
        others += [write_seating, write_wrong_seats]
    elif sheet.details.by_hand is not None or sheet.details.not_seated:
        others.append(write_seating)
    if sheet.details.loads:
        others.append(write_loads)
    if sheet.details.bent is not None:
        others.append(write_bending)
    others += [write_quality, write_counting, write_legend]

    def make_block(writer: Writer) -> Block:
        """Return the block that a function writes for this sheet."""
        return lambda column: writer(column, sheet)

    return list(map(make_block, needed)), list(map(make_block, others))


def make_hold_blocks(sheet: SetupSheet) -> tuple[list[Block], list[Block]]:
    """Return (blocks needed beside the plan, other blocks) of a sheet of flat jaws or straps."""
    setting, rest = list_hold_blocks(sheet)
    needed = [write_title, *setting, write_zero, *([write_cautions] if sheet.cautions else [])]
    others = [*rest, *([write_program] if sheet.details.program is not None else []), write_part]

    def make_block(writer: Writer) -> Block:
        """Return the block that a function writes for this sheet."""
        return lambda column: writer(column, sheet)

    return list(map(make_block, needed)), list(map(make_block, others))


def write_title(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the part's name, the fixture's rank, its arrangement and the part's size."""
    size = next(
        (s for s in NAME_SIZES if measure_text(sheet.name, s, bold=True) <= column.width), NAME_SIZES[-1]
    )
    lines = wrap_text(sheet.name, size, column.width, bold=True)
    if len(lines) > MOST_NAME_LINES:
        rest = " ".join(lines[MOST_NAME_LINES - 1 :])
        lines = [*lines[: MOST_NAME_LINES - 1], shorten_text(rest + "…", size, column.width, bold=True)]
    for line in lines:
        column.write_line(line, size, bold=True, gap=0.4)
    column.y += 4
    column.write_line(f"Fixture {sheet.details.number} of {sheet.details.count}", 16, bold=True, gap=0.5)
    column.write_paragraph(describe_fixture(sheet.fixture, sheet.toolkit), BODY)
    if sheet.workpiece.finished is not None:
        return
    x0, y0, x1, y1 = sheet.workpiece.bounds
    outside = f"{sheet.lengths.format_number(x1 - x0)} × {sheet.lengths.format_length(y1 - y0)}"
    column.write_line(f"Size {outside}, as drawn", BODY, gap=0.3)


def write_zero(column: TextColumn, sheet: SetupSheet) -> None:
    """Write where part zero is, the part's angle, and the lines to enter at the control (G54, G68)."""
    zero, lengths = sheet.zero, sheet.lengths
    (x, y), turn = sheet.zero_place, sheet.fixture.pose.written_deg
    write_heading(column, "Part zero X0 Y0 and angle")
    column.write_fact("X0 Y0 is the", zero.words, BODY, bold=True)
    of_block = list_raw_zero_facts(sheet)
    for name, distance in of_block or [(f"x from {sheet.datum.x}", x), (f"y from {sheet.datum.y}", y)]:
        column.write_fact(name, lengths.format_length(distance), bold=True)
    column.write_fact("turned by θ, counter-clockwise", format_degrees(turn, 4), bold=True)
    drawn = ", y ".join(map(lengths.format_length, zero.point))
    place = "" if sheet.zero_shown else " It lies outside the plan."
    column.write_paragraph(
        f"In the part's drawing the zero is at x {drawn}.{place} x runs to the right, y upward.", NOTE
    )
    # Haas takes three places behind the point (Mill Operator's Manual, G68).
    word = f"{turn:z.3f}"
    turning = f"G68 X0 Y0 R{word}" if float(word) else "no G68, as the part is not turned"
    machine = sheet.details.machine_position
    if machine is None:
        words = f"G54: the machine's position over {sheet.datum.point}, plus this x and y; then {turning}."
        if of_block:
            words = f"G54: touch off these faces; then {turning}."
        column.write_paragraph(words, NOTE)
        return
    gx, gy = (
        lengths.format_number(start + way).replace("−", "-")
        for start, way in zip(machine, (x, y), strict=True)
    )
    unit = "G20" if sheet.lengths.unit is INCH else "G21"
    column.write_paragraph(
        f"{sheet.datum.name} is at machine {' and '.join(map(lengths.format_length, machine))}, and x "
        "runs along the machine's X:",
        NOTE,
    )
    column.y += 3
    column.write_line(f"{unit} G10 L2 P1 X{gx} Y{gy}", BODY, bold=True)
    column.write_line(f"G54 {turning}" if float(word) else "G54", BODY, bold=True)


def write_cautions(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the cautions."""
    write_heading(column, "Beware")
    for caution in sheet.cautions:
        column.write_item("▲", caution.sentence, BODY)


def write_steps(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the numbered steps of setting up."""
    write_heading(column, "Setting up")
    given = "as given under part zero X0 Y0, or touch off the part there"
    zero = f"Set the machine's zero, G54, from {sheet.datum.name} {given}."
    steps = list_support_steps(sheet, MOVING[sheet.toolkit.moving.measure].steps(sheet))
    for number, step in enumerate([*steps, zero], 1):
        column.write_item(f"{number}.", step, BODY)


def write_legend(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the legend of the plan's signs."""
    write_heading(column, "Signs")
    of_supports = ((draw_pad, "support below the part"), (draw_tip, "clamp on top, presses down"))
    draw_legend(column, sheet.toolkit, BLACK, of_supports if sheet.details.supports is not None else ())
