"""The outcome of a design: all fixtures as arrays, with :class:`Fixture` objects made on demand."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from attrs import define, evolve, field
from numpy.typing import ArrayLike, NDArray

from workhold.errors import InputError, quote_value, refuse_kind
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture, ListPlace
from workhold.model.fixture_table import BLOCK, FixtureTable, make_fixture_of_row, make_fixtures
from workhold.model.jaw_hold import JawHold
from workhold.model.notes import AskedFor, ChosenOnly, Cut, FittedOutline, KeptBest, Note, make_notes
from workhold.model.part_bending import BendingFigures, find_bending_figure
from workhold.model.query import Query
from workhold.model.search_report import ProofReport
from workhold.model.seating import Seating
from workhold.model.straps import StrappedHold
from workhold.model.workpiece import Workpiece

if TYPE_CHECKING:
    import pyarrow
    from pandas import DataFrame

    from workhold.model.elastic_material import ElasticMaterial
    from workhold.model.requirements import Load, Zone
    from workhold.model.support_request import Faces, SpatialLoad
    from workhold.model.support_triples import Supports
    from workhold.presenting.notebook import NoFixtureNote, StillPicture
    from workhold.presenting.papers import Picture
    from workhold.presenting.widget import FixtureWidget

__all__ = ["Result"]


# What an editor need not offer: other rooms use it.
INTERNAL = frozenset(
    {
        "add_bending",
        "attach_seating",
        "find_list_place",
        "mark_cut_short",
        "reasons",
        "renumber_bending",
        "slice_rows",
        "words",
    }
)


@define(frozen=True, repr=False)
class Result:
    """All fixtures that a query asks for, best first, or the best of them.

    A result is a sequence: ``len(result)``, ``result[0]``, ``for fixture in result``. ``Fixture`` objects are
    made on access; the arrays behind them are in ``table``. Results with equal contents are equal. A
    selection of the fixtures is a result again, see :meth:`choose`: ``result[:3]``, ``result[[4, 7]]``,
    ``result[mask]``, ``result.where(...)``.

    Parameters
    ----------
    query : the query that the result answers.
    table : the fixtures listed, best first.
    found : number of fixtures found of each arrangement, by its name. Fewer are listed when only the best
        were kept, or when the search was stopped while they were sorted or written.
    distinct : number of fixtures found; fixtures that a symmetry of the part carries into each other count
        once.
    complete : False when the search was interrupted; the listed fixtures are valid nevertheless.
    notes : notes for the user, see ``model.notes``: each prints as a sentence, and has data. A string given
        becomes a note. Where the outline departs from the drawn one, a note on that is added.
    statistics : how much work the search was. It counts contact features, chord curves, sliding pairs, pairs
        of curves compared and those whose crossings were sought. It also counts simultaneous contacts
        examined (all four inside their features).
    proof : the account of the search, see :class:`workhold.model.search_report.ProofReport`; None for a
        result that came without.
    pairs, seats : with two clamps, number of pairs of clamps that hold the part, and number of seats with
        their pairs of directions. None for other toolkits, and where only the best were sought.
    seating : where else the pegs can hold the part, for the first fixtures, as many as there are entries.
    holds : for each fixture between flat jaws or under straps, how it holds the part; () for other toolkits.
    bending : how far fixtures bend their part, by index; only of those that were bent, see :meth:`bend`.
    bent_by : key of the figure of bending by which those with ``bending`` are listed first,
        "clamp_distortion" or "give"; None where they stand in the order of the search.
    least_effective_error : least effective location error in mm among the fixtures that are fit and without
        warning, or among those that come nearest to that; steps of error count from it
        (``model.first_choice``). None where the order has no steps, and in results older than these.
    """

    query: Query
    table: FixtureTable
    found: Mapping[str, int] = field(hash=False)
    distinct: Mapping[str, int] = field(hash=False)
    complete: bool = True
    notes: tuple[Note, ...] = field(default=(), converter=make_notes)
    statistics: Mapping[str, int] = field(factory=dict, hash=False)
    proof: ProofReport | None = None
    pairs: int | None = None
    seats: int | None = None
    seating: tuple[Seating, ...] = field(default=(), hash=False)
    least_effective_error: float | None = None
    holds: tuple[JawHold | StrappedHold, ...] = field(default=(), hash=False)
    bending: Mapping[int, BendingFigures] = field(factory=dict, hash=False)
    bent_by: str | None = None

    def __attrs_post_init__(self) -> None:
        refuse_kind(self.query, Query, "the query", "give a Query, such as workhold.Query(part, toolkit)")
        notes, asked = self.reasons, self.query.restricted_by
        if asked and self.complete and notes and not any(self.found.values()):
            notes = (*(note for note in notes if not isinstance(note, AskedFor)), AskedFor(asked))
        if self.workpiece.departure > 0:
            notes = (*notes, FittedOutline(self.workpiece.departure))
        object.__setattr__(self, "notes", notes)

    @property
    def reasons(self) -> tuple[Note, ...]:
        """Notes without the one on an outline that differs from the drawn one."""
        return tuple(note for note in self.notes if not isinstance(note, FittedOutline))

    @property
    def workpiece(self) -> Workpiece:
        """Part that is held, from the query."""
        return self.query.workpiece

    @property
    def toolkit(self) -> Toolkit:
        """Toolkit that the part is held in, from the query."""
        return self.query.toolkit

    @property
    def counts(self) -> dict[str, int]:
        """Number of listed fixtures of each arrangement, by its name."""
        return self.toolkit.count_arrangements(self.table.arrangement)

    def __len__(self) -> int:
        return len(self.table)

    def __iter__(self) -> Iterator[Fixture]:
        for start in range(0, len(self), BLOCK):
            block = self.table.take(slice(start, start + BLOCK))
            where = map(self.find_list_place, range(start, start + len(block)))
            made = make_fixtures(block, self.toolkit, self.workpiece, where)
            yield from map(self.attach_seating, made, range(start, start + len(block)))

    @overload
    def __getitem__(self, index: int) -> Fixture: ...

    @overload
    def __getitem__(self, index: slice | Sequence[int] | NDArray[Any]) -> Result: ...

    def __getitem__(self, index: int | slice | Sequence[int] | NDArray[Any]) -> Fixture | Result:
        if isinstance(index, slice):
            return self.choose(range(len(self))[index])
        if not isinstance(index, int | np.integer):
            return self.choose(index)
        if not -len(self) <= index < len(self):
            raise IndexError(f"fixture {index} of {len(self)}")
        index %= len(self)
        index = int(index)
        made = make_fixture_of_row(
            self.table, self.toolkit, index, self.workpiece, self.find_list_place(index)
        )
        return self.attach_seating(made, index)

    def attach_seating(self, made: Fixture, index: int) -> Fixture:
        """Return the fixture with the seating, or with the hold by jaws or straps, and with the bending that this
        result has at an index.
        """
        if index in self.bending:
            made = evolve(made, bent=self.bending[index])
        if index < len(self.holds):
            hold = self.holds[index]
            return evolve(made, hold=hold, quality={**made.quality, **hold.figures})
        return evolve(made, seating=self.seating[index]) if index < len(self.seating) else made

    def choose(self, rows: ArrayLike) -> Result:
        """Return the result with some of the fixtures only, in the same order, each once.

        It can be saved as any other result. ``found`` stays as it is, and a note says that only some are
        listed. If all rows are chosen, the result itself is returned.

        Parameters
        ----------
        rows : a mask (N,) of booleans, one for each fixture, or indices from 0, negative ones from the end.

        Raises
        ------
        InputError
            For a mask of another length, and for rows that are neither.
        IndexError
            For a number without a fixture.

        Examples
        --------
        >>> import workhold
        >>> wedge = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
        >>> result = workhold.design(wedge, workhold.Vise(pitch=15, columns=1, peg_radius=2))
        >>> len(result[:3]), len(result[[4, 7]]), result[[4, 7]][0].pegs == result[4].pegs
        (3, 2, True)
        """
        given = np.asarray(rows)
        if given.dtype == np.bool_:
            if given.shape != (len(self),):
                raise InputError(
                    f"a mask has one truth for each of the {len(self)} fixtures, not the form {given.shape}."
                )
            chosen = np.flatnonzero(given)
        elif given.ndim != 1 or not (np.issubdtype(given.dtype, np.integer) or not given.size):
            raise InputError(
                f"fixtures cannot be chosen by {quote_value(rows)}: give their numbers from 0, or a mask of booleans."
            )
        else:
            away = (given < -len(self)) | (given >= len(self))
            if away.any():
                raise IndexError(f"fixture {given[away][0]} of {len(self)}")
            chosen = np.unique(given.astype(np.int64) % max(len(self), 1))
        if len(chosen) == len(self):
            return self
        found = sum(self.found.values())
        gone = [told(found, len(self)) for told in (ChosenOnly, KeptBest, Cut)]
        kept = (note for note in self.reasons if note not in gone)
        return evolve(
            self,
            table=self.table.take(chosen),
            seating=tuple(self.seating[row] for row in chosen if row < len(self.seating)),
            holds=tuple(self.holds[row] for row in chosen if row < len(self.holds)),
            bending=self.renumber_bending(chosen.tolist()),
            notes=(*kept, ChosenOnly(found, len(chosen))),
        )

    def where(self, condition: Callable[[Fixture], bool] | ArrayLike) -> Result:
        """Return the result with the fixtures for which a condition holds, see :meth:`choose`.

        Parameters
        ----------
        condition : function called with each fixture; or a mask (N,) of booleans, such as a column of
            :meth:`to_pandas` compared with a number.

        Examples
        --------
        >>> import workhold
        >>> wedge = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
        >>> result = workhold.design(wedge, workhold.Vise(pitch=15, columns=1, peg_radius=2))
        >>> three_left = result.where(lambda fixture: fixture.type == "II")
        >>> len(three_left) == result.counts["II"], three_left.counts["I"]
        (True, 0)
        """
        if callable(condition):
            return self.choose(np.array([bool(condition(fixture)) for fixture in self], np.bool_))
        return self.choose(condition)

    def slice_rows(self, rows: slice) -> Result:
        """Return the result with the fixtures of a slice, notes unchanged."""
        holds, places = self.holds[rows], range(len(self))[rows]
        bending = self.renumber_bending(places) if self.bending else {}
        return evolve(
            self, table=self.table.take(rows), seating=self.seating[rows], holds=holds, bending=bending
        )

    def renumber_bending(self, order: Sequence[int]) -> dict[int, BendingFigures]:
        """Return the bending of the fixtures at some rows, by their indices in ``order``."""
        return {
            number: self.bending[row]
            for number, row in enumerate(order if self.bending else ())
            if row in self.bending
        }

    def add_bending(self, found: Mapping[int, BendingFigures], rank_by: str | None = None) -> Result:
        """Return the result with how far some of its fixtures bend their part.

        Parameters
        ----------
        found : figures by the index of a fixture, from 0.
        rank_by : "clamp_distortion" or "give": those that were bent are then listed first, the least first, and the
            others after them in their order. None for the order that the result has.

        Raises
        ------
        InputError
            Where a fixture has no such figure, or the first fixtures have their seating and others would come before
            them.
        """
        bending = {**self.bending, **found}
        rank_by = rank_by or self.bent_by
        if rank_by is None:
            return evolve(self, bending=dict(sorted(bending.items())))
        key = find_bending_figure(rank_by).key
        if any(key not in one.figures for one in bending.values()):
            raise InputError(
                "there is nothing to rank by the give: the result has neither loads nor a program with forces."
            )
        first = sorted(bending, key=lambda row: (bending[row].figures[key], row))
        order = [*first, *(row for row in range(len(self)) if row not in bending)]
        if any((row < len(self.seating)) != (place < len(self.seating)) for place, row in enumerate(order)):
            raise InputError(
                f"the first {len(self.seating)} fixtures are in the order of their seating: bend no others than these."
            )
        whole = evolve(self, bending=bending)
        return evolve(
            self,
            table=self.table.take(np.array(order, np.int64)),
            seating=tuple(self.seating[row] for row in order[: len(self.seating)]),
            holds=tuple(self.holds[row] for row in order if row < len(self.holds)),
            bending=whole.renumber_bending(order),
            bent_by=key,
        )

    def mark_cut_short(self, listed: int) -> Result:
        """Return the result as incomplete,
        with a note that only the best ``listed`` of those found are in it.
        """
        others = (note for note in self.notes if not isinstance(note, Cut))
        return evolve(self, complete=False, notes=(Cut(sum(self.found.values()), listed), *others))

    def find_list_place(self, index: int) -> ListPlace:
        """Return the place in this result of the fixture with an index; ranks count from 1."""
        return ListPlace(self, index, index + 1, len(self))

    @property
    def words(self) -> str:
        """Phrase with the number of listed fixtures, the part and the toolkit."""
        kinds = ", ".join(f"{count:,} of type {kind}" for kind, count in self.counts.items())
        whole = "" if self.complete else ", interrupted"
        only = "the best " if len(self) < sum(self.found.values()) or self.query.best is not None else ""
        count = f"{only}{len(self):,} fixture{'s' * (len(self) != 1)}"
        where = f"{self.toolkit.wording.inside.partition(' ')[0]} a {self.toolkit.noun}"
        bent = f", {len(self.bending):,} with how far they bend the part" if self.bending else ""
        seated = f", with the seating of the first {len(self.seating):,}" if self.seating else ""
        return f"{count} of {self.workpiece.name} {where} ({kinds}){seated}{bent}{whole}"

    def __dir__(self) -> list[str]:
        return sorted(set(object.__dir__(self)) - INTERNAL)

    def __repr__(self) -> str:
        return f"<Result: {self.words}>"

    def _repr_html_(self) -> str:
        from workhold.presenting.notebook import render_result_html

        return render_result_html(self)

    def draw(self, path: str | Path | None = None, *, unit: str = "mm", overwrite: bool = False) -> Picture:
        """Return the best twelve fixtures, near duplicates once,
        as SVG text, which a notebook shows; write it if asked.

        Parameters
        ----------
        path : also write it into this file, whose name ends in .svg or .png.
        unit : of the lengths written: "mm", "cm", "m" or "inch".
        overwrite : whether a file that workhold has not written may be replaced.

        Raises
        ------
        InputError
            For a result without a fixture, and when the file cannot be written or replaced.
        """
        from workhold.presenting.papers import draw_and_save_result

        return draw_and_save_result(self, path, unit=unit, overwrite=overwrite)

    def widget(
        self,
        rank: int = 1,
        *,
        usual: float = 200.0,
        jaw_force: float | None = None,
        jaw: str | float = "screw",
        supports: Mapping[str, Any] | None = None,
    ) -> FixtureWidget | StillPicture:
        """Return a notebook widget that steps through the fixtures,
        lets a force push the part, and opens and closes the jaws.

        Without the extra ``widget`` it is a picture of the fixture.

        Parameters
        ----------
        rank : rank of the fixture shown first.
        usual : force in N whose arrow is drawn at the usual length.
        jaw_force : force of the jaw or the clamps in N; None for the force needed.
        jaw : kind of the jaw: "screw", "constant", or the ratio of the jaw's stiffness to that of one
            contact.
        supports : keywords of :meth:`Fixture.supports`, such as ``{"thickness": 12}``, to show the best three
            supports of each fixture with the clamp on top; None for none.

        Raises
        ------
        InputError
            For a result without a fixture, and impossible values.
        """
        from workhold.presenting.notebook import make_result_widget

        return make_result_widget(self, rank, usual=usual, jaw_force=jaw_force, jaw=jaw, supports=supports)

    def why_none(self) -> NoFixtureNote:
        """Return why there is no fixture: the number that each rule removes, the nearest miss, and changes
        that would help.

        A notebook shows it as tables; it takes longer than the search did.

        Raises
        ------
        InputError
            For a result that has fixtures, or whose search was stopped.
        """
        from workhold.presenting.notebook import explain_no_fixtures

        return explain_no_fixtures(self)

    def to_pandas(self) -> DataFrame:
        """Return all fixtures as a DataFrame, best first, with the columns of the CSV form, in mm and degrees.

        Raises
        ------
        InputError
            Where pandas is not installed.
        """
        from workhold.presenting.data import to_pandas

        return to_pandas(self)

    def to_arrow(self) -> pyarrow.Table:
        """Return all fixtures as a ``pyarrow.Table``, as :meth:`to_pandas` has them.

        Raises
        ------
        InputError
            Where pyarrow is not installed.
        """
        from workhold.presenting.data import to_arrow

        return to_arrow(self)

    def bend(
        self,
        material: str | ElasticMaterial = "aluminium-6061",
        *,
        best: int = 20,
        rank_by: str | None = None,
        thickness: float | None = None,
        jaw_force: float | None = None,
        jaw: str | float = "screw",
        faces: Sequence[int | str] = (),
        part: str | Path | None = None,
    ) -> Result:
        """Return the result with how far its best fixtures bend their part, as ``fixture.bent`` of each.

        Saved, it has these figures. Needs the extra ``bending``, and takes some seconds.

        Parameters
        ----------
        best : how many of the first fixtures to bend; seats for which no straps were found are left out.
        rank_by : "clamp_distortion" or "give": those that were bent come first, the least first. None leaves the
            order.
        material, thickness, jaw_force, jaw, faces, part : see :meth:`Fixture.bending`.

        Raises
        ------
        InputError
            As :meth:`Fixture.bending`; also for a result without fixtures, without a figure to rank by, and where
            other fixtures would come before those whose seating is known.
        """
        from workhold.presenting.bent import bend_result

        return bend_result(
            self,
            material,
            best=best,
            rank_by=rank_by,
            thickness=thickness,
            jaw_force=jaw_force,
            jaw=jaw,
            faces=faces,
            part=part,
        )

    def supports(
        self,
        thickness: float | None = None,
        *,
        best: int = 20,
        each: int = 3,
        loads: Sequence[Load | SpatialLoad] | None = None,
        jaw_force: float | None = None,
        pad_radius: float | None = None,
        tip_radius: float | None = None,
        pad_margin: float | None = None,
        tip_margin: float | None = None,
        head_radius: float | None = None,
        inside: float | None = None,
        band: tuple[float, float] | None = None,
        bottom: Faces | None = None,
        top: Faces | None = None,
        bottom_zones: Sequence[Zone] | None = None,
        top_zones: Sequence[Zone] | None = None,
        reach: Sequence[tuple[float, float, float, float]] | None = None,
        point: tuple[float, float] | None = None,
    ) -> tuple[Supports, ...]:
        """Return the supports and clamps on top for each of the ``best`` first fixtures, in their order.

        Parameters
        ----------
        best : number of fixtures.
        each : number of sets of three for each of them. All other parameters are those of
            :meth:`Fixture.supports`.

        Raises
        ------
        InputError
            As :meth:`Fixture.supports`.
        """
        from workhold.supports.asking import find_result_supports

        return find_result_supports(
            self,
            thickness,
            best=best,
            each=each,
            loads=loads,
            jaw_force=jaw_force,
            pad_radius=pad_radius,
            tip_radius=tip_radius,
            pad_margin=pad_margin,
            tip_margin=tip_margin,
            head_radius=head_radius,
            inside=inside,
            band=band,
            bottom=bottom,
            top=top,
            bottom_zones=bottom_zones,
            top_zones=top_zones,
            reach=reach,
            point=point,
        )
