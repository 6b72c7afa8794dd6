"""A widget for a notebook that shows the fixtures of a result one by one, to push and close; needs the extra
``widget``.

The browser draws and reacts to the mouse; every force is computed here. The last state shown is stored with
the notebook, and is visible without Python. Where widgets are not supported, the fixture's HTML is shown
instead.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import resources
from typing import Any

import anywidget
import traitlets

from workhold.errors import InputError
from workhold.model.result import Result
from workhold.presenting.closing_shown import show_closing
from workhold.presenting.live_picture import LivePicture, TriedForce
from workhold.statics.loads import read_jaw_stiffness

__all__ = ["FixtureWidget"]


def read_browser_file(name: str) -> str:
    """Return the text of a file in ``static`` that goes to the browser."""
    return resources.files("workhold.presenting").joinpath("static", name).read_text(encoding="utf-8")


class FixtureWidget(anywidget.AnyWidget):  # type: ignore[misc]
    """The fixtures of a result, one at a time.

    Traits that may be set are ``rank`` from 1, ``force``, and ``jaw_force`` in N (0 for as much as is
    needed). A force is x, y, size and direction, in mm, N and degrees of the part's frame; empty for none.
    Traits to read are ``answer`` and ``closing``.

    Parameters
    ----------
    result : with a fixture at least.
    rank : of the first one shown.
    usual : size in N of a force whose arrow has the usual length.
    jaw_force : in N; None for as much as is needed.
    jaw : "screw", "constant", or how many times as stiff as one contact it is.
    supports : keywords of :meth:`workhold.Fixture.supports` to show its best set of three; None for none.

    Raises
    ------
    InputError
        For a result without a fixture, and values that cannot be.
    """

    _esm = read_browser_file("widget.js")
    _css = read_browser_file("widget.css")

    rank = traitlets.Int(1).tag(sync=True)
    count = traitlets.Int(1).tag(sync=True)
    jaw_force = traitlets.Float(0.0, min=0.0).tag(sync=True)
    force = traitlets.List(trait=traitlets.Float(), default_value=[]).tag(sync=True)
    # Drawn for the browser: a picture with its words, what the force does, and how it closes.
    picture = traitlets.Dict().tag(sync=True)
    answer = traitlets.Dict().tag(sync=True)
    closing = traitlets.Dict().tag(sync=True)
    # Asked by the browser: an arrow on the page, and a closing; each with a number that the answer repeats.
    dragged = traitlets.List(default_value=[]).tag(sync=True)
    asked_closing = traitlets.Int(0).tag(sync=True)

    def __init__(
        self,
        result: Result,
        rank: int = 1,
        usual: float = 200.0,
        jaw_force: float | None = None,
        jaw: str | float = "screw",
        supports: Mapping[str, Any] | None = None,
    ) -> None:
        if not len(result):
            raise InputError("there is no fixture to show: result.why_none() says why.")
        if not 1 <= rank <= len(result):
            raise InputError(f"there is no fixture {rank}: {len(result)} are listed.")
        if not 0 < usual < float("inf"):
            raise InputError(f"a usual force of {usual:g} N cannot be used: give one above 0.")
        self.result, self.usual, self.jaw, self.supports = result, usual, jaw, supports
        read_jaw_stiffness(jaw)
        super().__init__(rank=rank, count=len(result), jaw_force=jaw_force or 0.0)
        self.update_picture()
        self.observe(self.update_picture, "rank")
        self.observe(self.take_dragged_arrow, "dragged")
        self.observe(self.update_answer, ["force", "jaw_force"])
        self.observe(self.close_jaws, "asked_closing")

    @traitlets.validate("rank")  # type: ignore[untyped-decorator]
    def limit_rank(self, proposal: Any) -> int:
        """Return the proposed rank clamped to the ranks that exist."""
        return min(max(int(proposal["value"]), 1), len(self.result))

    def update_picture(self, _: Any = None) -> None:
        """Set ``picture`` and ``closing`` for the fixture of the current rank, and answer the current force
        again.
        """
        self.live = LivePicture.from_result(self.result, self.rank - 1, self.usual, self.supports)
        with self.hold_sync():
            self.picture = {
                "svg": self.live.draw_svg(),
                "title": self.live.title,
                "figures": self.live.figures,
                "mover": self.result.toolkit.moving.noun,
            }
            self.closing = {**self.live.describe_closing(), "number": self.asked_closing}
            self.update_answer()

    def take_dragged_arrow(self, change: Any) -> None:
        """Set ``force`` from an arrow that was dragged in the browser, and answer that force."""
        *arrow, number = change["new"]
        try:
            pushed = self.live.read_push(arrow)
        except InputError as error:
            self.answer = {**self.empty_answer, "words": str(error), "number": number}
            return
        with self.hold_trait_notifications():
            self.force = pushed.numbers
        self.update_answer(number=number)

    def update_answer(self, _: Any = None, number: int = 0) -> None:
        """Set ``answer`` to the effect of the current force.

        ``number`` is that of the browser's question, returned with the answer.
        """
        try:
            pushed = TriedForce.from_numbers(self.force) if self.force else TriedForce(0.0, 0.0, 0.0, 0.0)
            found = self.live.answer(pushed, self.jaw_force or None, self.jaw)
        except InputError as error:
            found = {**self.empty_answer, "words": str(error)}
        self.answer = {**found, "number": number}

    @property
    def empty_answer(self) -> dict[str, Any]:
        """An answer that has no arrows."""
        return self.live.answer(TriedForce(0.0, 0.0, 0.0, 0.0), None, self.jaw)

    def close_jaws(self, _: Any = None) -> None:
        """Set ``closing`` to the closing of the fixture shown."""
        self.closing = {**show_closing(self.live), "number": self.asked_closing}

    def _repr_mimebundle_(self, **wanted: Any) -> Any:
        """Return the widget's data by MIME type, with the fixture's HTML for viewers without widgets."""
        bundle = super()._repr_mimebundle_(**wanted)
        if bundle is not None:
            bundle[0]["text/html"] = self._repr_html_()
        return bundle

    def _repr_html_(self) -> str:
        """Return the HTML of the fixture shown."""
        return self.result[self.rank - 1]._repr_html_() or ""

    def __repr__(self) -> str:
        return f"<FixtureWidget: fixture {self.rank} of {self.count} of {self.result.workpiece.name}>"
