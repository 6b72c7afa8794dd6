"""What objects show of themselves in a notebook: tables with small pictures, as HTML.

Names of columns and figures are those of the command's tables. What is shown is bounded: a result shows its
first entries and says how many there are. A result without a fixture says why there is none: the rules, the
nearest miss, and what would help.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from math import isfinite, nan
from typing import TYPE_CHECKING, Any

from attrs import frozen

from workhold.conventions import STEADY
from workhold.drawing.bench import draw_bench, make_bench
from workhold.drawing.fixture_pictures import draw_thumbnail
from workhold.drawing.panel import describe_fixture
from workhold.drawing.scene import Box, Scene, View
from workhold.drawing.seating_words import capitalize_sentence
from workhold.drawing.supports_drawn import PlannedSupports, draw_supports
from workhold.errors import InputError
from workhold.listing.identity import ShownEntries, make_entries
from workhold.model.quality import RANKED, SEATING_FIGURES
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.search_report import Explanation
from workhold.model.setup import list_length_settings
from workhold.model.support_triples import ChosenSupports
from workhold.presenting.data import REQUIREMENTS
from workhold.presenting.figure_words import (
    find_edgeless_distance,
    find_figure_unit,
    format_figure_number,
    format_ranked_figure,
    format_rounded,
    group_peg_columns,
    list_shown_figures,
    make_fixture_title,
    make_short_heading,
    mark_edgeless,
    name_peg_place,
)
from workhold.presenting.markup import LARGE, Markup, escape_html, make_image, make_paragraph, make_table
from workhold.presenting.papers import draw_and_save_fixture, draw_and_save_workpiece
from workhold.supports.words import explain_no_set, format_set_row, list_set_headings
from workhold.units import MILLIMETRE

if TYPE_CHECKING:
    from workhold.model.fixture import Fixture
    from workhold.model.seating import Seating
    from workhold.model.support_triples import Supports
    from workhold.model.workpiece import Workpiece
    from workhold.presenting.widget import FixtureWidget

__all__ = [
    "MOST_ROWS",
    "StillPicture",
    "NoFixtureNote",
    "render_fixture_html",
    "render_no_fixtures_html",
    "render_result_html",
    "make_result_widget",
    "render_seating_html",
    "render_supports_html",
    "make_thumbnail",
    "explain_no_fixtures",
    "render_workpiece_html",
]

# Entries of a result that are shown, and the width of their pictures in pixels.
MOST_ROWS, SMALL = 6, 200


def render_result_html(result: Result) -> str:
    """Return a result as HTML: its first entries with pictures and figures;
    without a fixture, why there is none.
    """
    if not len(result):
        return render_no_fixtures_html(result)
    shown = make_entries(result)
    if not len(shown.index):
        shown = make_entries(result, with_unfit=True)
    title = Markup(f"<b>{escape_html(capitalize_sentence(result.words))}</b>")
    return "\n".join(
        (
            make_paragraph(title),
            make_entries_table(result, shown),
            make_paragraph(*list_count_sentences(result, shown)),
        )
    )


def render_no_fixtures_html(result: Result) -> str:
    """Return a result without fixtures as HTML: its notes, and how to ask why there are none."""
    toolkit, found = result.toolkit, sum(result.found.values())
    inside = toolkit.wording.inside.partition(" ")[0]
    title = Markup(
        f"<b>{escape_html(f'No fixture of {result.workpiece.name} {inside} a {toolkit.noun}')}</b>"
    )
    more = Markup(
        "<code>result.why_none()</code> says what each rule takes away, what comes nearest, "
        "and what would help."
    )
    # What was found was ruled out later, or not all was looked at.
    is_open = found or not result.complete
    return "\n".join(map(make_paragraph, (title, *map(str, result.notes), *([] if is_open else [more]))))


def make_entries_table(result: Result, shown: ShownEntries) -> Markup:
    """Return the table of the first ``MOST_ROWS`` shown entries with thumbnails and figures."""
    toolkit, unit = result.toolkit, MILLIMETRE
    figures, ranked = list_shown_figures(result)
    longest = find_edgeless_distance(result.workpiece, toolkit)
    groups = group_peg_columns(toolkit)
    headings = (
        ">rank",
        "picture",
        ">like it",
        *groups,
        f">{toolkit.moving.measure} {unit.abbreviation}",
        ">angle deg",
        *(f">{make_short_heading(figure, unit)}" for figure in figures),
        "type",
    )
    rows = []
    for index, like in zip(shown.index[:MOST_ROWS].tolist(), shown.like[:MOST_ROWS].tolist(), strict=True):
        fixture = result[index]
        holes = [
            " ".join(name_peg_place(peg, toolkit) for peg in fixture.pegs if peg.carrier in names)
            for names in groups.values()
        ]
        known = mark_edgeless(fixture.figures, longest)
        rows.append(
            (
                str(index + 1),
                make_thumbnail(fixture),
                f"+{like:,}" if like else "",
                *holes,
                " ".join(
                    unit.format_number(setting.length, unit.decimals)
                    for setting in list_length_settings(fixture, toolkit)
                ),
                format_rounded(fixture.pose.written_deg, 3),
                *(
                    (format_ranked_figure if figure in ranked[:-1] else format_figure_number)(
                        figure, known.get(figure.key, nan), unit
                    )
                    for figure in figures
                ),
                toolkit.find_arrangement(fixture.type, fixture.direction).title,
            )
        )
    return make_table(headings, rows)


def list_count_sentences(result: Result, shown: ShownEntries) -> list[str]:
    """Return sentences on how many entries are shown and fixtures listed, and the result's notes."""
    rows, there, listed = min(MOST_ROWS, len(shown.index)), len(shown.index), len(result)
    out = [f"{rows:,} of {there:,} entries shown; near duplicates stand once, counted under like it."]
    if rows == there:
        out = ["All are shown; near duplicates stand once, counted under like it."] if rows < listed else []
    out.append(
        f"{listed:,} {'fixture is' if listed == 1 else 'fixtures are'} listed, result[0] is the first."
    )
    return [*out, *map(str, result.notes)]


def make_thumbnail(fixture: Fixture) -> Markup:
    """Return the small picture of a listed fixture as an HTML image."""
    result = fixture.listing.result
    drawn = draw_thumbnail(fixture, result.workpiece, result.toolkit)
    return make_image(
        drawn, f"{make_fixture_title(fixture)}: {describe_fixture(fixture, result.toolkit)}", SMALL, False
    )


def render_fixture_html(fixture: Fixture) -> str | None:
    """Return a fixture as HTML: its picture and its figures; None for a fixture of no result."""
    if fixture.listed is None:
        return None
    words = f"{make_fixture_title(fixture)}: {describe_fixture(fixture, fixture.listing.result.toolkit)}"
    return "\n".join(
        (
            make_paragraph(make_image(draw_and_save_fixture(fixture), words, LARGE)),
            make_figures_table(fixture),
        )
    )


def render_workpiece_html(workpiece: Workpiece) -> str:
    """Return a workpiece as HTML: its picture with numbered faces."""
    return make_paragraph(make_image(draw_and_save_workpiece(workpiece), repr(workpiece).strip("<>"), LARGE))


def make_figures_table(fixture: Fixture) -> Markup:
    """Return the table of a listed fixture's figures with their meaning."""
    result, unit = fixture.listing.result, MILLIMETRE
    noun = result.toolkit.moving.noun
    known = mark_edgeless(fixture.figures, find_edgeless_distance(result.workpiece, result.toolkit))
    rows = []
    for figure in RANKED:
        if figure.key in known:
            words, meaning = figure.name_for(noun)
            better = "more" if figure.more_is_better else "less"
            value = format_figure_number(figure, known[figure.key], unit)
            rows.append((words, value, find_figure_unit(figure, unit), better, meaning))
    return make_table(("figure", ">value", "unit", "better", "meaning"), rows)


# Sets of three, seats, and changes that would help, of which so many are shown; the widths of the pictures of
# a set and of the nearest miss in pixels, and the page of that of a set with a rim.
MOST_SETS, MOST_SEATS, MOST_HELPS = 6, 12, 6
OF_SET, WIDE = 240, 320
PAGE, RIM = (360.0, 270.0), 8.0


def render_supports_html(supports: Supports) -> str:
    """Return the supports of a fixture as HTML: the best sets of three with the
    clamp on top, or why there is none.
    """
    title = make_paragraph(Markup(f"<b>{escape_html(capitalize_sentence(supports.words))}</b>"))
    if not supports.triples:
        return "\n".join((title, make_paragraph(explain_no_set(supports, MILLIMETRE))))
    loaded = bool(supports.loads)
    headings = (">rank", "picture", *list_set_headings(MILLIMETRE, loaded))
    rows = [
        (str(rank), draw_supports_picture(supports, rank), *format_set_row(triple, MILLIMETRE, loaded))
        for rank, triple in enumerate(supports.triples[:MOST_SETS], 1)
    ]
    notes = [
        "The clamp presses at this point of the part's coordinates. If the last figure is at "
        f"least {MILLIMETRE.format_length(STEADY)}, the part stands before it is clamped."
    ]
    if loaded:
        notes.append(f"Forces are for a closing force of {supports.jaw_force:.0f} N, without friction.")
    if len(supports.triples) > MOST_SETS:
        notes.insert(0, f"{MOST_SETS} of {len(supports.triples):,} sets of three shown.")
    return "\n".join((title, make_table(headings, rows), make_paragraph(*notes)))


def draw_supports_picture(supports: Supports, rank: int) -> Markup:
    """Return the picture of the set of supports with this rank, from 1, as an HTML image."""
    chosen = ChosenSupports.from_supports(supports, rank)
    query = supports.query
    bench = make_bench(chosen.recounted.fixture, query.workpiece, query.toolkit)
    scene = Scene.make_page(PAGE, query.workpiece.name)
    view = View.fit_box(bench.extent, Box(0.0, 0.0, *PAGE).grow(-RIM))
    draw_bench(scene, bench, view, weight=0.7, longest=26.0, axes=False)
    draw_supports(scene, PlannedSupports.from_chosen(chosen), view)
    names = ", ".join(pad.hole for pad in chosen.pads)
    return make_image(scene.to_svg(), f"Supports in {names} under {query.workpiece.name}", OF_SET, False)


def render_seating_html(seating: Seating) -> str:
    """Return a seating as HTML: its figures, its seats and its warnings."""
    unit, known = MILLIMETRE, seating.figures
    figures = [
        (one.words, format_figure_number(one, known[one.key], unit), find_figure_unit(one, unit), one.meaning)
        for one in SEATING_FIGURES
    ]
    pieces = [
        make_paragraph(Markup(f"<b>{escape_html(capitalize_sentence(seating.words))}</b>")),
        make_table(("figure", ">value", "unit", "meaning"), figures),
    ]
    own = next((seat for seat in seating.seats if seat.is_own), None)
    rows = []
    for number, seat in enumerate(seating.seats[:MOST_SEATS], 1):
        start = 0.0 if own is None else own.pose.theta_deg
        turned = (
            seat.pose.theta_deg if seat.mirrored else (seat.pose.theta_deg - start + 180.0) % 360.0 - 180.0
        )
        depth = seat.depth
        rows.append(
            (
                str(number),
                unit.format_number(seat.difference),
                format_rounded(turned, 1),
                "over" if seat.mirrored else "up",
                "-" if depth is None or not isfinite(depth) else unit.format_number(depth),
                "right" if seat.is_own else "same place" if seat.same_place else "wrong",
            )
        )
    of = unit.abbreviation
    pieces.append(make_paragraph("Places in which the part can come to rest:"))
    pieces.append(
        make_table((">seat", f">differs {of}", ">turned by", "side", f">held {of}", "how it lies"), rows)
    )
    if len(seating.seats) > MOST_SEATS:
        pieces.append(make_paragraph(f"{MOST_SEATS} of {len(seating.seats):,} seats shown."))
    return "\n".join(
        [*pieces, *map(make_paragraph, (f"{capitalize_sentence(words)}." for words in seating.warnings))]
    )


@frozen(repr=False)
class NoFixtureNote:
    """The reason why no fixture answers a query.

    Parameters
    ----------
    query : the query.
    explanation : how much each rule removed, the nearest miss, and what would help.
    """

    query: Query
    explanation: Explanation

    @property
    def words(self) -> str:
        """The sentence that names the rule that removed the last contacts, or says that there were none at
        all.
        """
        last = self.explanation.last_rule
        if not self.explanation.contacts or last is None:
            return str(self.explanation.no_contacts or "")
        return f"The last contacts were removed by: {last}. {self.explanation.asked_words}".rstrip()

    def __repr__(self) -> str:
        return f"<NoFixtureNote: {self.words}>"

    def _repr_html_(self) -> str:
        """Return the rules, the nearest miss and what would help as HTML."""
        pieces = [make_paragraph(Markup(f"<b>{escape_html(self.words)}</b>"))]
        explanation, toolkit = self.explanation, self.query.toolkit
        if explanation.removals:
            rows = [
                (one.rule, f"{one.before:,}", f"{one.removed:,}", f"{one.after:,}")
                for one in explanation.removals
            ]
            pieces.append(make_table(("rule", ">sets of four contacts", ">removed", ">left"), rows))
        if explanation.nearest is not None:
            drawn = draw_thumbnail(explanation.nearest.fixture, self.query.workpiece, toolkit)
            words = f"Nearest miss: {explanation.nearest.words}"
            pieces += [make_paragraph(words), make_paragraph(make_image(drawn, words, WIDE))]
        helps = [
            (one.change, f"{one.fixtures:,}" if one.complete else f"over {one.fixtures:,}")
            for one in explanation.helps[:MOST_HELPS]
        ]
        nothing = make_paragraph("No single change that was tried helps.")
        pieces.append(make_table(("what would help", ">fixtures"), helps) if helps else nothing)
        return "\n".join(pieces)


def explain_no_fixtures(result: Result) -> NoFixtureNote:
    """Return why a result has no fixtures, see :meth:`workhold.Result.why_none`.

    Raises
    ------
    InputError
        For a result with fixtures, and where it is not proven that there are none.
    """
    from workhold.search.explaining import explain

    if len(result):
        raise InputError("there are fixtures: ask a result without fixtures why it has none.")
    if sum(result.found.values()) or not result.complete:
        raise InputError(
            f"it is not proven that there is no fixture. {' '.join(map(str, result.notes))}".strip()
        )
    return NoFixtureNote(result.query, explain(result.query))


@frozen(repr=False)
class StillPicture:
    """A fixture of a result, shown as HTML where its widget cannot be shown.

    Parameters
    ----------
    result, rank : the result, and the fixture's rank in it, from 1.
    """

    result: Result
    rank: int

    def __repr__(self) -> str:
        return f"<StillPicture: fixture {self.rank} of {len(self.result)} of {self.result.workpiece.name}>"

    def _repr_html_(self) -> str:
        """Return the fixture as HTML, with a hint on which library the widget needs."""
        words = f"This picture moves with another library: pip install '{REQUIREMENTS['anywidget']}'."
        return f"{render_fixture_html(self.result[self.rank - 1])}\n{make_paragraph(words)}"


def make_result_widget(
    result: Result,
    rank: int,
    *,
    usual: float,
    jaw_force: float | None,
    jaw: str | float,
    supports: Mapping[str, Any] | None,
) -> FixtureWidget | StillPicture:
    """Return the widget of a result, or where ``anywidget`` is not installed a :class:`StillPicture`.

    See :meth:`workhold.Result.widget`.
    """
    if find_spec("anywidget") is None:
        if not 1 <= rank <= len(result):
            raise InputError(f"there is no fixture {rank}: {len(result)} are listed.")
        return StillPicture(result, rank)
    from workhold.presenting.widget import FixtureWidget

    return FixtureWidget(result, rank, usual, jaw_force, jaw, supports)
