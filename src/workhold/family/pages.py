"""The pages of a family: its curve drawn, and the sheets of a plan, a page for each set-up.

On the curve the number of set-ups grows to the right and the worst loss upward. The page of a set-up has at
the left its plan, the pegs with their holes or the vise, holding its first part. At the right it has every part as it
lies, to one scale, above a table of what is set and programmed for each. More parts than ``MOST_BESIDE`` go
on further pages.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import date
from itertools import pairwise
from math import ceil, floor, isfinite, log10

from attrs import evolve, frozen

from workhold.drawing.annotation import draw_scale_bar
from workhold.drawing.bench import BenchDrawing, draw_bench, draw_zero, make_bench
from workhold.drawing.panel import format_count
from workhold.drawing.plan import BOTTOM, LEFT, RIGHT, TOP, draw_plan
from workhold.drawing.scene import (
    BLACK,
    GREY,
    LANDSCAPE,
    Box,
    LengthUnit,
    Scene,
    View,
    measure_text,
    shorten_text,
    wrap_text,
)
from workhold.family.covering import Point
from workhold.family.family import Family
from workhold.family.jaw_setups import describe_changes, describe_jaw_setup
from workhold.family.members import describe_loss, format_loss
from workhold.family.plan import FamilyPlan, Holding, SetUp
from workhold.model.hold_words import describe_coefficients, describe_parallel_places, describe_touched_faces
from workhold.model.jaw_hold import HOLD_FIGURES
from workhold.model.quality import Figure
from workhold.model.setup import list_length_settings
from workhold.units import MILLIMETRE, Unit
from workhold.version import __version__

__all__ = ["draw_curve", "draw_setups"]

EDGE, CURVE_HEADER = 32.0, 84.0
CURVE_LINE, CHOSEN, GRID = "#0b3a82", "#b3122a", "#d5d9de"
# Room for numbers and words at the axes, page units.
AT_LEFT, BELOW = 84.0, 70.0
# Losses that have a line, as far as the curve reaches.
MOST_LINES = 9


def draw_curve(family: Family, chosen: Point | None = None) -> str:
    """Return the curve of a family drawn on A4, as SVG text.

    Parameters
    ----------
    chosen : the point whose plan was picked, which is marked.
    """
    held = f"{format_count(len(family.members), 'part')} {family.toolkit.wording.inside}"
    scene = Scene.make_page(LANDSCAPE, f"{held}: set-ups and loss")
    width, height = LANDSCAPE
    group = scene.group("heading")
    group.add_text((EDGE, EDGE + 12), held, 26, bold=True)
    words = f"{describe_loss(family.figure, family.toolkit.wording.inside)} At each point it is that of the worst part."
    group.add_text((EDGE, EDGE + 44), words, 15, fill=GREY)
    room = Box(EDGE + AT_LEFT, EDGE + CURVE_HEADER, width - EDGE - 30, height - EDGE - BELOW)
    points = [point for point in family.points if isfinite(point.loss)]
    if not points:
        group.add_text(room.center, "No number of set-ups has a loss that is finite.", 16, "middle")
        return scene.to_svg()
    draw_axes_and_points(scene, room, points, chosen)
    return scene.to_svg()


def draw_axes_and_points(scene: Scene, room: Box, points: list[Point], chosen: Point | None) -> None:
    """Draw axes, steps and points of the curve into a page box; points that are not proven are hollow.

    ``chosen`` is marked; None marks no point.
    """
    last, most = points[-1].setups, points[0].loss
    step = choose_axis_step(max(most - 1.0, 0.02) / MOST_LINES)
    top = 1.0 + step * max(ceil((most - 1.0) / step - 1e-9), 1)
    first = points[0].setups

    def place_point(setups: float, loss: float) -> tuple[float, float]:
        """Return the page point of a number of set-ups and a loss."""
        across = (setups - first + 0.5) / (last - first + 1)
        return room.x0 + across * room.width, room.y1 - (loss - 1.0) / (top - 1.0) * (room.height - 30)

    axes = scene.group("axes")
    decimals = max(0, -floor(log10(step) + 1e-9))
    for k in range(round((top - 1.0) / step) + 1):
        y = place_point(first, 1.0 + k * step)[1]
        axes.add_line([(room.x0, y), (room.x1, y)], GRID if k else BLACK, 1.0)
        axes.add_text((room.x0 - 10, y), f"{1.0 + k * step:.{max(decimals, 1)}f}", 14, "end")
    every = next(k for k in (1, 2, 5, 10, 20, 50, 100, 1000) if room.width / (last - first + 1) * k >= 26)
    for setups in range(first, last + 1):
        if (setups - first) % every == 0 or setups == last:
            x = place_point(setups, 1.0)[0]
            axes.add_line([(x, room.y1), (x, room.y1 + 6)], BLACK, 1.0)
            axes.add_text((x, room.y1 + 20), str(setups), 14, "middle")
    axes.add_text((room.center[0], room.y1 + 48), "set-ups", 15, "middle", bold=True)
    axes.add_text((room.x0 - 62, room.center[1]), "worst loss", 15, "middle", bold=True, turned=90)
    curve = scene.group("curve")
    for one, other in pairwise(points):
        # Numbers of set-ups in between lose as much as the smaller one.
        corner = place_point(other.setups, one.loss)
        curve.add_line([place_point(one.setups, one.loss), corner], CURVE_LINE, 2.0)
        curve.add_line(
            [corner, place_point(other.setups, other.loss)], CURVE_LINE, 1.2, stroke_dasharray="3 4"
        )
    taken: list[Box] = []
    for point in points:
        here, is_chosen = place_point(point.setups, point.loss), point == chosen
        proven = point.is_least and point.at_least == point.setups
        curve.add_circle(
            here,
            8.0 if is_chosen else 5.5,
            CHOSEN if is_chosen else CURVE_LINE if proven else "#ffffff",
            CURVE_LINE,
            1.6,
        )
        words = format_loss(point.loss) + ("" if proven else " or less")
        box = Box(
            here[0] + 6, here[1] - 24, here[0] + 10 + measure_text(words, 13, bold=is_chosen), here[1] - 8
        )
        if is_chosen or all(box.compute_overlap_area(other) == 0 for other in taken):
            taken.append(box)
            curve.add_text((box.x0, here[1] - 16), words, 13, bold=is_chosen, halo=2.5)


def choose_axis_step(least: float) -> float:
    """Return the smallest of 1, 2 or 5 times a power of ten that is at least ``least``.

    >>> choose_axis_step(0.07), choose_axis_step(0.2), choose_axis_step(3)
    (0.1, 0.2, 5.0)
    """
    power = 10.0 ** floor(log10(least))
    return float(next(round(k * power, 12) for k in (1, 2, 5, 10) if k * power >= least * (1 - 1e-9)))


MOST_BESIDE, MOST_ALONE = 12, 18
HEADER, FOOTER, GAP = 92.0, 34.0, 12.0
# Of the page, the share of the plan.
PLAN = 0.42
# Sizes of words, heights of a line, of a row of the table and of the name under a part, page units.
NAME, WORDS, SMALL = 13.0, 12.0, 11.0
# The narrowest column of names, page units, and in how many lines a name may stand there.
NARROWEST_NAME, MOST_NAME_LINES = 60.0, 3
# Of the room beside the plan, what the table may take before names are cut off.
MOST_TABLE = 0.5
LINE, ROW, CAPTION = 15.0, 17.0, 22.0
RULE = "#dfe3e8"


@frozen
class PageTitles:
    """The words common to all pages of a plan."""

    count: int
    figure: Figure
    lengths: LengthUnit
    day: date


def draw_setups(plan: FamilyPlan, figure: Figure, day: date, unit: Unit = MILLIMETRE) -> tuple[str, ...]:
    """Return the sheets of a plan, as SVG text of every page.

    Parameters
    ----------
    figure : the figure of which losses are computed.
    day : the date written on the sheets.
    """
    first = plan.setups[0].holdings[0].member.query.toolkit.carriers[0]
    titles = PageTitles(len(plan.setups), figure, LengthUnit.from_typical_length(unit, min(first.pitch)), day)
    pages: list[Scene] = []
    before: SetUp | None = None
    for number, setup in enumerate(plan.setups, 1):
        pages += draw_setup_pages(setup, before, number, titles)
        before = setup
    for place, page in enumerate(pages, 1):
        draw_foot(page, titles, f"page {place} of {len(pages)}")
    return tuple(page.to_svg() for page in pages)


def draw_setup_pages(setup: SetUp, before: SetUp | None, number: int, titles: PageTitles) -> Iterator[Scene]:
    """Yield the pages of a set-up without their feet.

    ``before`` is the set-up before it, None for the first one; ``number`` is its own, from 1.
    """
    benches = [(one, make_setup_bench(one, setup)) for one in setup.holdings]
    beside, rest = benches[:MOST_BESIDE], benches[MOST_BESIDE:]
    width, height = LANDSCAPE
    whole = Box(EDGE, EDGE + HEADER, width - EDGE, height - EDGE - FOOTER)
    split = whole.x0 + PLAN * whole.width
    scene = begin_page(setup, before, number, titles)
    draw_pegs_plan(scene, setup, Box(whole.x0, whole.y0, split - 2 * GAP, whole.y1), titles.lengths)
    draw_parts(scene, beside, Box(split, whole.y0, whole.x1, whole.y1), titles)
    yield scene
    for some in (rest[k : k + MOST_ALONE] for k in range(0, len(rest), MOST_ALONE)):
        scene = begin_page(setup, before, number, titles)
        draw_parts(scene, some, whole, titles)
        yield scene


def make_setup_bench(one: Holding, setup: SetUp) -> BenchDrawing:
    """Return a part as it lies in a set-up, with the work stop of a plain vise where the set-up has it."""
    bench = make_bench(one.fixture, one.member.query.workpiece, one.member.query.toolkit)
    jaws = bench.shown.jaws
    if jaws is None or jaws.stop is None or setup.jaws is None:
        return bench
    stop, half = jaws.stop, jaws.stop.height / 2
    moved = evolve(stop, y0=setup.jaws.level - half, y1=setup.jaws.level + half)
    return evolve(bench, shown=evolve(bench.shown, jaws=evolve(jaws, stop=moved)))


def begin_page(setup: SetUp, before: SetUp | None, number: int, titles: PageTitles) -> Scene:
    """Return a page with its heading: the set-up's number, the holes of its pegs, and which pegs are moved
    for it.

    Of a plain vise it has the parallels and the work stop instead.
    """
    heading = f"Set-up {number} of {titles.count}: {format_count(len(setup.holdings), 'part')}"
    scene = Scene.make_page(LANDSCAPE, heading)
    group = scene.group("heading")
    group.add_text((EDGE, EDGE + 12), heading, 26, bold=True)
    if setup.jaws is None:
        lines = [f"Pegs in {', '.join(list_holes(setup))}.", *describe_heights(setup, titles.lengths)]
        lines += describe_moves(setup, before)
    else:
        toolkit, unit = setup.standing.member.query.toolkit, titles.lengths.unit
        words = describe_jaw_setup(setup.jaws, toolkit, unit)
        lines = [f"{words[:1].upper()}{words[1:]}."]
        if before is not None:
            lines.append(f"After the set-up before: {describe_changes(setup.jaws, before.jaws)}.")
    for k, line in enumerate(lines):
        group.add_text((EDGE, EDGE + 42 + 20 * k), shorten_text(line, LINE, LANDSCAPE[0] - 2 * EDGE), LINE)
    return scene


def list_holes(setup: SetUp) -> list[str]:
    """Return the names of the holes in which the pegs of a set-up stand."""
    return [peg.hole for peg in setup.standing.fixture.placed]


def describe_heights(setup: SetUp, lengths: LengthUnit) -> Iterator[str]:
    """Yield sentences on the heights at which carriers touch, for carriers with heights of their own.

    Yields nothing unless some part is a solid.
    """
    toolkit = setup.standing.member.query.toolkit
    if all(one.member.query.workpiece.solid is None for one in setup.holdings):
        return
    for elements, (low, high) in {
        one.elements: one.heights for one in toolkit.carriers if one.heights
    }.items():
        heights = f"{lengths.format_number(low)} and {lengths.format_length(high)}"
        yield f"{elements.capitalize()}: touch between {heights} above the plane on which the parts lie."


def describe_moves(setup: SetUp, before: SetUp | None) -> Iterator[str]:
    """Yield a sentence on the pegs to remove and to place after the set-up ``before``.

    Yields nothing for the first set-up, whose ``before`` is None.
    """
    if before is None:
        return
    here, there = Counter(list_holes(setup)), Counter(list_holes(before))
    placed, taken = sorted((here - there).elements()), sorted((there - here).elements())
    if placed:
        yield (
            f"After the set-up before: take out {', '.join(taken)}, place {', '.join(placed)}; the rest "
            "stays."
        )
    else:
        yield "After the set-up before: all pegs stay."


def draw_pegs_plan(scene: Scene, setup: SetUp, room: Box, lengths: LengthUnit) -> None:
    """Draw the plan of a set-up's pegs into a page box, holding one of its parts."""
    one = setup.standing
    workpiece = one.member.query.workpiece
    bench = make_setup_bench(one, setup)
    inner = Box(room.x0 + LEFT, room.y0 + TOP, room.x1 - RIGHT, room.y1 - BOTTOM)
    view = View.fit_box(bench.extent, inner)
    draw_plan(scene, bench, view, workpiece, room, lengths)
    words = f"The plan shows {one.member.name}."
    scene.add_text((room.x0, room.y1 - 4), shorten_text(words, 12, room.width), 12, fill=GREY)


def draw_parts(
    scene: Scene, benches: Sequence[tuple[Holding, BenchDrawing]], room: Box, titles: PageTitles
) -> None:
    """Draw the parts in their positions in a set-up, each in a cell, all to one scale. Below them draw the
    table of what to set for each.
    """
    rows = [make_table_row(one, titles) for one, _ in benches]
    notes = [
        line
        for note in list_notes([one for one, _ in benches], titles.lengths)
        for line in wrap_text(note, SMALL, room.width)
    ]
    head = make_table_head(benches[0][0], titles)
    widths = compute_column_widths(head, rows, room.width)
    for most in range(MOST_NAME_LINES, 0, -1):
        lines = sum(len(wrap_name(row[0], widths[0], most)) for row in rows)
        high = ROW * (lines + 2) + LINE * len(notes) + GAP
        if high <= MOST_TABLE * room.height:
            break
    draw_table(scene, Box(room.x0, room.y1 - high + GAP / 2, room.x1, room.y1), head, rows, notes, most)
    cells = make_grid(len(benches), Box(room.x0, room.y0, room.x1, room.y1 - high - FOOTER))
    rooms = [Box(cell.x0 + 6, cell.y0 + 6, cell.x1 - 6, cell.y1 - CAPTION) for cell in cells]
    scale = min(
        View.fit_box(bench.extent, inner).scale for (_, bench), inner in zip(benches, rooms, strict=True)
    )
    for (one, bench), cell, inner in zip(benches, cells, rooms, strict=True):
        group = scene.group("part-cell")
        group.add_rectangle(cell, "#ffffff", "#b9bec6", 1.0, 5)
        view = View.fit_box(bench.extent, inner, scale)
        draw_bench(group, bench, view, weight=0.55, longest=24.0, axes=False)
        zero = view(bench.fixture.pose.apply(*one.member.zero.point))
        if inner.grow(4).contains(Box(*zero, *zero)):
            draw_zero(group, zero, 4.0)
        name = shorten_text(one.member.name, NAME, cell.width - 12, bold=True)
        group.add_text((cell.x0 + 6, cell.y1 - CAPTION / 2), name, NAME, bold=True)
    bottom = room.y1 - high - FOOTER + 20
    draw_scale_bar(
        scene, (room.x0, bottom), scale, titles.lengths, more=", all parts to this scale; the disc is X0 Y0"
    )


def make_grid(count: int, room: Box) -> list[Box]:
    """Return ``count`` equal cells of a page box, row by row, in as many columns as
    make the cells largest.
    """
    ways = [(across, -(-count // across)) for across in range(1, count + 1)]

    def compute_size(way: tuple[int, int]) -> float:
        """Return the size of a cell for ``way``, a number of columns and a number of rows."""
        return min(room.width / way[0], 1.2 * room.height / way[1])

    across, down = max(ways, key=lambda way: (compute_size(way), -way[0]))
    width, height = (room.width - (across - 1) * GAP) / across, (room.height - (down - 1) * GAP) / down
    corners = [
        (room.x0 + (k % across) * (width + GAP), room.y0 + (k // across) * (height + GAP))
        for k in range(count)
    ]
    return [Box(x, y, x + width, y + height) for x, y in corners]


def make_table_head(one: Holding, titles: PageTitles) -> list[str]:
    """Return the headings of the table of parts."""
    sign = titles.lengths.sign
    settings = list_length_settings(one.fixture, one.member.query.toolkit)
    lengths = [
        f"{name} {sign}"
        for name in (*(f"{one.place} {one.sign}".strip() for one in settings), "X0 at x", "Y0 at y")
    ]
    faces = [] if one.hold is None else ["on the fixed jaw"]
    figures = [format_figure_heading(figure, sign) for figure in list_shown_figures(one)]
    return ["part", *faces, *lengths, "turned θ", *figures, "loss", "fixture"]


def list_shown_figures(one: Holding) -> list[Figure]:
    """Return the figures of a part that a table shows: that of the losses, and between flat jaws also the jaw force,
    the grip and what stands above the jaws, those that are known.
    """
    figure, hold = one.member.figure, one.hold
    if hold is None:
        return [figure]
    more = [other for other in HOLD_FIGURES if other.key in ("clamp_needed", "grip", "above")]
    return [figure, *(other for other in more if other != figure and getattr(hold, other.key) is not None)]


def format_figure_heading(figure: Figure, sign: str) -> str:
    """Return the name of a figure with its unit; ``sign`` is that of lengths."""
    words = "jaw force" if figure.key == "clamp_needed" else figure.words
    return f"{words} {sign if figure.unit == 'mm' else figure.unit}".strip()


def format_figure_value(one: Holding, figure: Figure, lengths: LengthUnit) -> str:
    """Return a figure of a part as text, between flat jaws "-" where it is not known."""
    value = one.figure if one.hold is None else getattr(one.hold, figure.key)
    if value is None:
        return "-"
    if figure.unit != "mm":
        return f"{value:.{figure.decimals}f}"
    return lengths.format_number(value) if one.hold is None else lengths.format_short_number(value, 5)


def make_table_row(one: Holding, titles: PageTitles) -> list[str]:
    """Return the table row of a part: what to set, its zero, angle, figures, loss, and the number of its
    fixture.
    """
    fixture, number = one.fixture, titles.lengths.format_number
    x, y = fixture.pose.apply(*one.member.zero.point)
    return [
        one.member.name,
        *([] if one.hold is None else [describe_touched_faces(one.hold.fixed)]),
        *(number(setting.length) for setting in list_length_settings(fixture, one.member.query.toolkit)),
        number(x),
        number(y),
        f"{fixture.pose.written_deg:z.4f}°",
        *(format_figure_value(one, figure, titles.lengths) for figure in list_shown_figures(one)),
        format_loss(one.loss),
        f"{one.number:,}{'′' if one.turned else ''}{'' if one.in_place else '*'}",
    ]


def list_notes(holdings: Sequence[Holding], lengths: LengthUnit) -> Iterator[str]:
    """Yield the notes below the table: on part zero, on signs, and on parts whose pegs are in other columns."""
    zeros = {one.member.zero.words for one in holdings}
    toolkit = holdings[0].member.query.toolkit
    first = "each part's zero" if len(zeros) > 1 else f"the {next(iter(zeros))}"
    yield (
        f"X0 Y0 is {first}, x and y from {toolkit.datum.origin_words}, θ counter-clockwise. Fixture: its number in "
        "the part's list."
    )
    if any(one.turned for one in holdings):
        swapped = f", which swaps the {toolkit.moving.noun}s" if len(toolkit.plates) > 1 else ""
        yield f"′: that fixture after half a turn of everything{swapped}."
    if any(one.hold is not None for one in holdings):
        yield from list_vise_notes(holdings, lengths)
    for one in holdings:
        if not one.in_place:
            yield f"* {one.member.name}: the same pegs in {', '.join(peg.hole for peg in one.fixture.pegs)}."


def list_vise_notes(holdings: Sequence[Holding], lengths: LengthUnit) -> Iterator[str]:
    """Yield the notes of parts in a plain vise: on what they lie, on parallels that stand away from a jaw, and on
    the jaw force.
    """
    first = holdings[0].hold
    assert first is not None
    on = "the parallels" if first.parallels else "the bed of the vise"
    yield f"All parts lie on {on}: Z of their lower sides is the same."
    if any(one.hold is not None and one.hold.clamp_needed is not None for one in holdings):
        query = holdings[0].member.query
        yield f"Close with the jaw force or more. {describe_coefficients(query)}"
    for one in holdings:
        if one.hold is not None and one.hold.has_moved_parallels:
            places = describe_parallel_places(one.hold, lengths.unit)
            yield f"{one.member.name}: tools come through, so put the parallels {places}."


def compute_column_widths(head: list[str], rows: list[list[str]], width: float) -> list[float]:
    """Return the widths of the table's columns in page units.

    The column of names gets the width that the others leave of ``width``.
    """
    heads = [split_heading(words) for words in head]
    widths = [
        max(
            *(measure_text(words, WORDS, bold=True) for words in heads[k]),
            *(measure_text(row[k], WORDS) for row in rows),
        )
        + 14
        for k in range(len(head))
    ]
    # What is left goes to the names, and they give way where there is too little.
    widths[0] = max(width - sum(widths[1:]), NARROWEST_NAME)
    return widths


def wrap_name(name: str, width: float, most: int) -> list[str]:
    """Return a part's name wrapped to ``width`` page units, in ``most`` lines at most.

    The last line is shortened where the name is longer.
    """
    room = width - 8
    lines = wrap_text(name, WORDS, room, bold=True) or [""]
    if len(lines) > most:
        lines = [*lines[: most - 1], " ".join(lines[most - 1 :])]
    return [shorten_text(line, WORDS, room, bold=True) for line in lines]


def draw_table(
    scene: Scene, room: Box, head: list[str], rows: list[list[str]], notes: list[str], most: int
) -> None:
    """Draw the table of parts, with numbers right-aligned, and the notes below it.

    Names take ``most`` lines at most.
    """
    widths = compute_column_widths(head, rows, room.width)
    heads = [split_heading(words) for words in head]
    ends = [room.x0 + sum(widths[: k + 1]) for k in range(len(widths))]
    group = scene.group("table")
    lines = [[pair[k] for pair in heads] for k in (0, 1)]
    top = room.y0
    for place, row in enumerate([*lines, *rows]):
        bold, names = place < len(lines), wrap_name(row[0], widths[0], most)
        for k, name in enumerate(names):
            group.add_text((room.x0, top + ROW * (k + 0.5)), name, WORDS, bold=True)
        for end, word in zip(ends[1:], row[1:], strict=True):
            group.add_text((end, top + ROW / 2), word, WORDS, "end", bold=bold)
        top += ROW * len(names)
        if not bold:
            group.add_line([(room.x0, top), (room.x1, top)], RULE, 0.6)
    y = room.y0 + ROW * len(lines)
    group.add_line([(room.x0, y), (room.x1, y)], GREY, 0.8)
    y = top + 4
    for k, note in enumerate(notes):
        group.add_text((room.x0, y + LINE * (k + 0.5)), note, SMALL, fill=GREY)


def split_heading(words: str) -> tuple[str, str]:
    """Return a heading in two lines, split so that the longer one is as short as possible.

    The first line is "" for a single word.

    >>> split_heading("part"), split_heading("location error mm")
    (('', 'part'), ('location', 'error mm'))
    """
    some = words.split()
    ways = [(" ".join(some[:k]), " ".join(some[k:])) for k in range(len(some))]
    return min(ways, key=lambda way: max(map(len, way)))


def draw_foot(scene: Scene, titles: PageTitles, page: str) -> None:
    """Write the date, the program's version and the page's number at a page's foot."""
    width, height = LANDSCAPE
    words = f"{titles.day.isoformat()} · workhold {__version__} · {page}"
    scene.add_text((width - EDGE, height - EDGE - 4), words, 11, "end", fill=GREY)
