"""Why a result has no fixture, as a notebook shows it: rules, the nearest miss, and what would help."""

from __future__ import annotations

from typing import TYPE_CHECKING

from attrs import frozen

from workhold.drawing.fixture_pictures import draw_thumbnail
from workhold.errors import InputError
from workhold.model.query import Query
from workhold.model.search_report import Explanation
from workhold.presenting.markup import Markup, image, paragraph, safe, table

if TYPE_CHECKING:
    from workhold.model.result import Result

__all__ = ["WhyNone", "why_none"]

# Changes that would help of which so many are shown, and the width of the picture in pixels.
MOST_HELPS, WIDE = 6, 320


@frozen(repr=False)
class WhyNone:
    """Why there is no fixture that a query asks for.

    Parameters
    ----------
    query : what was asked in vain.
    explanation : what each rule took away, the nearest miss, and what would help.
    """

    query: Query
    explanation: Explanation

    @property
    def words(self) -> str:
        """The sentence that says which rule took the last contacts away, or that there are none."""
        last, toolkit = self.explanation.last_rule, self.query.toolkit
        if not self.explanation.contacts or last is None:
            return f"No {toolkit.wording.four} can touch the part at the same time."
        return f"The last contacts were removed by: {last}."

    def __repr__(self) -> str:
        return f"<WhyNone: {self.words}>"

    def _repr_html_(self) -> str:
        pieces = [Markup(f"<p><b>{safe(self.words)}</b></p>")]
        explanation, toolkit = self.explanation, self.query.toolkit
        if explanation.removals:
            rows = [
                (one.rule, f"{one.before:,}", f"{one.removed:,}", f"{one.after:,}")
                for one in explanation.removals
            ]
            pieces.append(table(("rule", ">sets of four contacts", ">removed", ">left"), rows))
        if explanation.nearest is not None:
            drawn = draw_thumbnail(explanation.nearest.fixture, self.query.workpiece, toolkit)
            words = f"Nearest miss: {explanation.nearest.words}"
            pieces += [paragraph(words), paragraph(image(drawn, words, WIDE))]
        helps = [
            (one.change, f"{one.fixtures:,}" if one.complete else f"over {one.fixtures:,}")
            for one in explanation.helps[:MOST_HELPS]
        ]
        if helps:
            pieces.append(table(("what would help", ">fixtures"), helps))
        else:
            pieces.append(paragraph("No single change that was tried helps."))
        return "\n".join(pieces)


def why_none(result: Result) -> WhyNone:
    """Explains a result without fixtures, see :meth:`workhold.Result.why_none`."""
    from workhold.search.explaining import explain

    if len(result):
        raise InputError("there are fixtures: why there is none is asked of a result without one.")
    if sum(result.found.values()) or not result.complete:
        raise InputError(f"that there is none, was not found out. {' '.join(result.notes)}".strip())
    return WhyNone(result.query, explain(result.query))
