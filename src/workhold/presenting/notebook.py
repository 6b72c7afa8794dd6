"""What a result and a fixture show of themselves in a notebook: tables with small pictures, as HTML.

Names of columns and figures are those of the command's tables. What is shown is bounded: a result shows its
first entries and says how many there are. A result without a fixture says why there is none.
"""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

from workhold.drawing.fixture_pictures import draw_thumbnail
from workhold.drawing.panel import fixture_words
from workhold.listing.identity import Entries, entries
from workhold.model.quality import RANKED
from workhold.model.setup import settings_of
from workhold.presenting.figure_words import (
    counted_text,
    figure_text,
    figures_shown,
    peg_groups,
    place_of,
    rounded,
    short_heading,
    unit_of,
)
from workhold.presenting.markup import LARGE, Markup, image, paragraph, safe, table
from workhold.presenting.papers import fixture_picture, workpiece_picture
from workhold.units import MILLIMETRE

if TYPE_CHECKING:
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.model.workpiece import Workpiece

__all__ = [
    "MOST_ROWS",
    "fixture_html",
    "fixture_title",
    "none_html",
    "result_html",
    "sentence",
    "thumbnail",
    "workpiece_html",
]

# Entries of a result that are shown, and the width of their pictures in pixels.
MOST_ROWS, SMALL = 6, 200


def result_html(result: Result) -> str:
    """Shows a result, see :class:`workhold.Result`: its first entries with their pictures and figures."""
    if not len(result):
        return none_html(result)
    shown = entries(result)
    if not len(shown.index):
        shown = entries(result, with_unfit=True)
    title = Markup(f"<b>{safe(sentence(result.words))}</b>")
    return "\n".join(
        (paragraph(title), entries_table(result, shown), paragraph(*count_sentences(result, shown)))
    )


def sentence(words: str) -> str:
    """Words that begin with a capital letter."""
    return f"{words[:1].upper()}{words[1:]}"


def none_html(result: Result) -> str:
    """Says why a result has no fixture, and how to find out more."""
    toolkit, found = result.toolkit, sum(result.found.values())
    inside = toolkit.wording.inside.partition(" ")[0]
    title = Markup(f"<b>{safe(f'No fixture of {result.workpiece.name} {inside} a {toolkit.noun}')}</b>")
    more = Markup(
        "<code>result.why_none()</code> says what each rule takes away, what comes nearest, "
        "and what would help."
    )
    if found or not result.complete:
        # What was found was ruled out later, or not all was looked at.
        return "\n".join(map(paragraph, (title, *result.notes)))
    return "\n".join(map(paragraph, (title, *result.notes, more)))


def entries_table(result: Result, shown: Entries) -> Markup:
    """Tabulates the first entries: rank, picture, holes, what to set, and the figures that count."""
    toolkit, unit = result.toolkit, MILLIMETRE
    figures, ranked = figures_shown(result)
    groups = peg_groups(toolkit)
    headings = (
        ">rank",
        "picture",
        ">like it",
        *groups,
        f">{toolkit.moving.measure} {unit.abbreviation}",
        ">angle deg",
        *(f">{short_heading(figure, unit)}" for figure in figures),
        "type",
    )
    rows = []
    for index, like in zip(shown.index[:MOST_ROWS].tolist(), shown.like[:MOST_ROWS].tolist(), strict=True):
        fixture = result[index]
        holes = [
            " ".join(place_of(peg, toolkit) for peg in fixture.pegs if peg.carrier in names)
            for names in groups.values()
        ]
        known = fixture.figures
        rows.append(
            (
                str(index + 1),
                thumbnail(fixture),
                f"+{like:,}" if like else "",
                *holes,
                " ".join(
                    unit.number(setting.length, unit.decimals) for setting in settings_of(fixture, toolkit)
                ),
                rounded(fixture.pose.theta_deg, 3),
                *(
                    (counted_text if figure in ranked[:-1] else figure_text)(
                        figure, known.get(figure.key, nan), unit
                    )
                    for figure in figures
                ),
                toolkit.arrangement(fixture.type, fixture.direction).title,
            )
        )
    return table(headings, rows)


def count_sentences(result: Result, shown: Entries) -> list[str]:
    """Says how many entries are shown of how many, and what the notes of the result say."""
    rows, there, listed = min(MOST_ROWS, len(shown.index)), len(shown.index), len(result)
    out = [f"{rows:,} of {there:,} entries shown; near duplicates stand once, counted under like it."]
    if rows == there:
        out = ["All are shown; near duplicates stand once, counted under like it."] if rows < listed else []
    out.append(
        f"{listed:,} {'fixture is' if listed == 1 else 'fixtures are'} listed, result[0] is the first."
    )
    return [*out, *result.notes]


def thumbnail(fixture: Fixture) -> Markup:
    """The small picture of a fixture of a result."""
    result = fixture.listing.result
    drawn = draw_thumbnail(fixture, result.workpiece, result.toolkit)
    return image(drawn, f"{fixture_title(fixture)}: {fixture_words(fixture, result.toolkit)}", SMALL, False)


def fixture_title(fixture: Fixture) -> str:
    """What a fixture of a result is called, such as "Fixture 2 of 40 of bracket"."""
    listed = fixture.listing
    return f"Fixture {listed.rank:,} of {listed.count:,} of {listed.result.workpiece.name}"


def fixture_html(fixture: Fixture) -> str | None:
    """Shows a fixture: its picture to set it up from and its figures; None for one of no result."""
    if fixture.listed is None:
        return None
    words = f"{fixture_title(fixture)}: {fixture_words(fixture, fixture.listing.result.toolkit)}"
    return "\n".join((paragraph(image(fixture_picture(fixture), words, LARGE)), figures_table(fixture)))


def workpiece_html(workpiece: Workpiece) -> str:
    """Shows a workpiece: the part with its faces numbered."""
    return paragraph(image(workpiece_picture(workpiece), repr(workpiece).strip("<>"), LARGE))


def figures_table(fixture: Fixture) -> Markup:
    """Tabulates the figures of a fixture that are known, with units, and which way each is better."""
    noun, unit, known = fixture.listing.result.toolkit.moving.noun, MILLIMETRE, fixture.figures
    rows = []
    for figure in RANKED:
        if figure.key in known:
            words, meaning = figure.named_for(noun)
            better = "more" if figure.more_is_better else "less"
            value = figure_text(figure, known[figure.key], unit)
            rows.append((words, value, unit_of(figure, unit), better, meaning))
    return table(("figure", ">value", "unit", "better", "meaning"), rows)
