"""Pictures of a workpiece, a fixture and a result: SVG text that a notebook shows and that saves itself."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from workhold.drawing.features_picture import draw_features
from workhold.drawing.fixture_picture import draw_fixture
from workhold.drawing.render import render
from workhold.drawing.thumbnails import best_at_a_glance
from workhold.errors import InputError
from workhold.files.atomic import write_bytes
from workhold.listing.near_duplicates import entries
from workhold.units import unit_named

if TYPE_CHECKING:
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.model.workpiece import Workpiece

__all__ = ["Picture", "fixture_picture", "result_picture", "workpiece_picture"]


class Picture(str):
    """SVG text. A notebook shows it as the picture it is."""

    __slots__ = ()

    def _repr_svg_(self) -> str:
        return str(self)

    def save(self, path: str | Path) -> Picture:
        """Write the picture; itself again.

        Parameters
        ----------
        path : of a file whose name ends in .svg or .png.

        Raises
        ------
        InputError
            For another ending, and when the file cannot be written.
        """
        write_bytes(path, render(str(self), Path(path).suffix))
        return self


def saved(svg: str, path: str | Path | None) -> Picture:
    """A picture, written where a path is given."""
    picture = Picture(svg)
    return picture if path is None else picture.save(path)


def workpiece_picture(
    workpiece: Workpiece, path: str | Path | None = None, *, peg_radius: float | None = None, unit: str = "mm"
) -> Picture:
    """The workpiece with its faces numbered, see :meth:`workhold.Workpiece.draw`."""
    return saved(draw_features(workpiece, peg_radius=peg_radius, unit=unit_named(unit)), path)


def fixture_picture(
    fixture: Fixture, path: str | Path | None = None, *, title: str | None = None, unit: str = "mm"
) -> Picture:
    """The fixture to set up from, see :meth:`workhold.Fixture.draw`."""
    listed = fixture.listing
    words = f"Fixture {listed.rank} of {listed.count}" if title is None else title
    toolkit = listed.result.toolkit
    return saved(draw_fixture(fixture, listed.result.workpiece, toolkit, title=words, unit=unit_named(unit)), path)


def result_picture(result: Result, path: str | Path | None = None, *, unit: str = "mm") -> Picture:
    """The best fixtures at a glance, see :meth:`workhold.Result.draw`."""
    if not len(result):
        why = f" {result.reasons[0]}" if result.reasons else ""
        raise InputError(f"there is no fixture to draw.{why}")
    return saved(best_at_a_glance(result, entries(result), unit_named(unit)), path)
