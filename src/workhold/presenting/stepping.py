"""A result to step through: the widget, or a picture where the extra ``widget`` is not installed."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

from attrs import frozen

from workhold.errors import InputError
from workhold.model.result import Result
from workhold.presenting.data import REQUIREMENTS
from workhold.presenting.markup import paragraph
from workhold.presenting.notebook import fixture_html

__all__ = ["StillPicture", "result_widget"]


@frozen(repr=False)
class StillPicture:
    """A fixture of a result that stands in for its widget.

    Parameters
    ----------
    result, rank : of the fixture, from 1.
    """

    result: Result
    rank: int

    def __repr__(self) -> str:
        return f"<StillPicture: fixture {self.rank} of {len(self.result)} of {self.result.workpiece.name}>"

    def _repr_html_(self) -> str:
        words = f"This picture moves with another library: pip install '{REQUIREMENTS['anywidget']}'."
        return f"{fixture_html(self.result[self.rank - 1])}\n{paragraph(words)}"


def result_widget(result: Result, rank: int = 1, **asked: Any) -> Any:
    """Makes the widget of a result, see :meth:`workhold.Result.widget`."""
    if find_spec("anywidget") is None:
        if not 1 <= rank <= len(result):
            raise InputError(f"there is no fixture {rank}: {len(result)} are listed.")
        return StillPicture(result, rank)
    from workhold.presenting.widget import FixtureWidget

    return FixtureWidget(result, rank, **asked)
