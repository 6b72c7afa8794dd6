"""What is known of the supports of a planar fixture: triples with their figures, and how many there are."""

from __future__ import annotations

from attrs import evolve, frozen

from workhold.delegates import delegate
from workhold.errors import InputError
from workhold.fixels.carrier import hole_name, letter_of
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.support_request import SpatialLoad, SupportRequest

__all__ = ["ClampFigures", "SupportPad", "Supports", "Triple"]

Point = tuple[float, float]


@frozen
class ClampFigures:
    """The clamp at one point, and how good it is there.

    Parameters
    ----------
    at : where it presses, in mm in the part's coordinates.
    clamp_needed : force in N above which no support loses contact under any load.
    support_force : the largest force on a support at that force, in N; None without loads.
    arm : distance in mm from the nearest side: tipping moment resisted per N.
    share : the smallest share of the clamp force that a support takes.
    lift : clamp force that each N of jaw force asks for when nothing else acts.
    """

    at: Point
    clamp_needed: float
    support_force: float | None
    arm: float
    share: float
    lift: float


@frozen
class SupportPad:
    """A support in a hole.

    Parameters
    ----------
    carrier : name of what it stands on.
    column, row : as the planar fixture counts them; its plates may end before.
    x, y : in mm in the part's coordinates.
    """

    carrier: str
    column: int
    row: int
    x: float
    y: float

    @property
    def hole(self) -> str:
        """The hole's name; one before column A or row 1 by its numbers, where A1 is (1,1).

        >>> SupportPad("left", 2, 3, 0.0, 0.0).hole, SupportPad("plate", -1, 3, 0.0, 0.0).hole
        ('L-C4', '(0,4)')
        """
        if min(self.column, self.row) >= 0:
            return hole_name(self.carrier, self.column, self.row)
        letter = letter_of(self.carrier)
        return f"{letter}{'-' if letter else ''}({self.column + 1},{self.row + 1})"


@frozen
class Triple:
    """Three supports and the clamp over them.

    Parameters
    ----------
    supports : in order of carrier, column and row.
    travel : what the moving jaw is opened to with these supports, in mm; None where no lattice moves.
    marginal : whether a rule is kept by so little that another list may leave it out.
    standing : how far in mm the centre of area is inside the triangle; positive: it stands unclamped.
    overhang : farthest in mm that a load's point lies beyond a side; None without such a point.
    arm, arm_at : the largest tipping arm in mm, and the clamp's point for it.
    best : the clamp where it needs the least force.
    given : the clamp at the point asked for; None where none was asked for or it may not stand there.
    """

    supports: tuple[SupportPad, ...]
    travel: float | None
    marginal: bool
    standing: float
    overhang: float | None
    arm: float
    arm_at: Point
    best: ClampFigures
    given: ClampFigures | None

    @property
    def clamp(self) -> ClampFigures:
        """The clamp at the point asked for, where it may stand there, else at its best.

        Where it needs no force its best place has the largest tipping arm.
        """
        return self.given or self.best


@frozen(repr=False)
class Supports:
    """The supports of one planar fixture.

    Parameters
    ----------
    query : part and toolkit, with what else the planar fixture was asked for.
    fixture : the planar fixture.
    request : what was asked.
    loads : with their heights written out.
    jaw_force : on what moves, in N, that all figures hold for.
    positions : how many holes may hold a support.
    count : how many triples are valid; None where not all were looked at.
    triples : those listed, the best first.
    stopped : whether the search was stopped: then they are the best of those it had looked at.
    """

    query: Query
    fixture: Fixture
    request: SupportRequest
    loads: tuple[SpatialLoad, ...]
    jaw_force: float
    positions: int
    count: int | None
    triples: tuple[Triple, ...]
    stopped: bool = False

    @property
    def words(self) -> str:
        """What is listed, of which part, in a few words."""
        whole = "" if self.count is None else f" of {self.count:,}"
        sets = f"the best {len(self.triples):,}{whole} sets of three" if self.triples else "no set of three"
        return f"{sets} under {self.query.workpiece.name}"

    def __repr__(self) -> str:
        return f"<Supports: {self.words}>"

    def _repr_html_(self) -> str:
        shown: str = delegate("supports_html")(self)
        return shown

    @property
    def complete(self) -> bool:
        """Whether every valid triple is listed."""
        return self.count == len(self.triples)

    def ranked(self, rank: int) -> Triple:
        """The set of three of a rank from 1.

        Raises
        ------
        InputError
            When there is none.
        """
        count = len(self.triples)
        if not 1 <= rank <= count:
            there = f"{count} are listed" if count else "there is no set of three"
            raise InputError(f"there is no set {rank} of supports: {there}.")
        return self.triples[rank - 1]

    def clamp_with_friction(self, friction: float, rank: int = 1) -> float:
        """The least clamp force in N for which friction could balance the loads, if all goes well.

        It is optimistic, ranks nothing and is at most that without friction; see ``supports.friction``.

        Parameters
        ----------
        friction : Coulomb's coefficient of all contacts.
        rank : of the set of three, from 1.

        Raises
        ------
        InputError
            For a coefficient that is none, without loads, and when there is no such set.
        """
        found: float = delegate("clamp_with_friction")(self, self.ranked(rank), friction)
        return found

    def best(self, count: int) -> Supports:
        """A copy with the first triples only."""
        return evolve(self, triples=self.triples[:count])
