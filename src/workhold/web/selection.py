"""Selection and order of the fixtures of a table that a request asks for."""

from __future__ import annotations

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.listing.identity import ShownEntries, find_first_of_each, number_near_duplicates
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import FIGURES, find_figure_number, select_figure_column
from workhold.model.requirements import lie_in_angle_ranges
from workhold.model.result import Result
from workhold.statics.judging import are_unfit

__all__ = ["ListSelection", "read_angle_range"]


@frozen
class ListSelection:
    """Selection and order of the fixtures to show of a list.

    Parameters
    ----------
    sort : "rank" or the key of a figure of quality; fixtures with equal values stay in the order of ranks.
    descending : largest first; fixtures without the figure are last either way.
    type : name of an arrangement, or the title of several; None for all.
    face : only fixtures that touch this face.
    angle : only fixtures whose part's angle lies in this range (from, to), in degrees, counter-clockwise from
        the first to the second.
    together : list only the first of fixtures that are alike (``listing.identity``).
    unfit : also list fixtures that are unfit for a workshop; if there are no others, they are listed anyway.
    """

    sort: str = "rank"
    descending: bool = False
    type: str | None = None
    face: int | None = None
    angle: tuple[float, float] | None = None
    together: bool = False
    unfit: bool = True

    def choose_entries(self, result: Result) -> ShownEntries:
        """Return the chosen fixtures of a result in order, each with the number of similar fixtures that are
        left out.
        """
        found = self.choose_indices(result.table, result.toolkit)
        chosen, bad = found, are_unfit(result.table.quality, result.query.tolerance)
        if not (self.unfit or bad.all()):
            chosen = found[~bad[found]]
        like = np.zeros(len(chosen), np.int64)
        if self.together:
            first, like = find_first_of_each(
                number_near_duplicates(result.table, result.workpiece, result.toolkit)[chosen]
            )
            chosen = chosen[first]
        return ShownEntries(chosen, like, int(bad[found].sum()) if not (self.unfit or bad.all()) else 0)

    def choose_indices(self, table: FixtureTable, toolkit: Toolkit) -> NDArray[np.intp]:
        """Return the indices of the chosen fixtures of a table, in order, without regard to ``together`` and
        ``unfit``.

        Raises
        ------
        InputError
            For an unknown figure to sort by, and an unknown arrangement.
        """
        column = None if self.sort == "rank" else find_figure_number(self.sort)
        if column is None and self.sort != "rank":
            known = ", ".join(figure.key for figure in FIGURES)
            raise InputError(f"{self.sort[:40]!r} is nothing to sort by: choose rank or one of {known}.")
        chosen = np.ones(len(table), np.bool_)
        if self.type is not None:
            titles = [(one.name, one.title) for one in toolkit.arrangements]
            wanted = [number for number, names in enumerate(titles) if self.type in names]
            if not wanted:
                raise InputError(
                    f"type {self.type[:40]} is unknown: choose {' or '.join(title for _, title in titles)}."
                )
            chosen &= np.isin(table.arrangement, wanted)
        if self.face is not None:
            chosen &= (table.face == self.face).any(axis=1)
        if self.angle is not None:
            chosen &= lie_in_angle_ranges(np.degrees(table.theta), (self.angle,))
        found = np.flatnonzero(chosen)
        if column is None:
            return found[::-1] if self.descending else found
        values = select_figure_column(table.quality, FIGURES[column])[found]
        keys = np.where(np.isnan(values), np.inf, -values if self.descending else values)
        return np.asarray(found[np.argsort(keys, kind="stable")])


def read_angle_range(text: str) -> tuple[float, float]:
    """Return (from, to) in degrees from text such as ``-10..10``; raise InputError for anything else."""
    low, dots, high = text.partition("..")
    try:
        ends = float(low), float(high)
    except ValueError:
        ends = (1.0, 0.0)
    if not dots or not ends[0] <= ends[1] or max(abs(ends[0]), abs(ends[1])) > 1e6:
        raise InputError(
            f"{text[:40]!r} is not a range of angles: give it in degrees, the smaller first, such as -10..10."
        )
    return ends
