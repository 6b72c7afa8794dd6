"""Toolkits: carriers of pegs, the places where pegs may stand, what moves, and when that clamps.

A toolkit is data. Whatever searches, proves, lists, draws and writes fixtures takes the data below from the
toolkit and does not depend on its kind. A new kind is a small module with these data, such as
``fixels.vise``.

Glossary
--------
carrier : what pegs stand on, a lattice of holes; it stands still or slides along a line. A vise's jaws are
    two carriers.
travel : how far a carrier has slid along its direction, in mm; of a vise the jaw separation.
arrangement : how many pegs stand on each carrier. The paper's Type I is two and two, its Type II three and
    one.
gap rule : the smallest distance along the direction of travel from a peg of the carrier that stands still to
    one of the carrier that moves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.fixels.carrier import Carrier, Heights, Travel
from workhold.fixels.contacts import CLAMP_TIP, Arrangement, ContactKind, Symmetry
from workhold.fixels.jaw_pair import JawPair
from workhold.fixels.setup_words import Datum, PageWords, SetupWords
from workhold.fixels.strap_set import StrapSet
from workhold.fixels.support_hardware import PinLimits, SupportPads, TopClamp
from workhold.fixels.table import FieldTable, ToolkitField
from workhold.units import Unit

__all__ = [
    "Arrangement",
    "Carrier",
    "ToolkitChange",
    "ToolkitLimit",
    "Symmetry",
    "Toolkit",
    "Travel",
    "ToolkitWording",
]

# The field whose change makes other pegs.
PEG_RADIUS = "peg_radius"
# An eighth of an inch in mm.
EIGHTH = 3.175
# The order in which a person would ask for limits to be lifted.
LIFTED = ("bodies", "travel", "reach", "holes")


@frozen
class ToolkitWording:
    """Phrases for messages about a toolkit that holds nothing.

    Parameters
    ----------
    two : the two pegs of a chord, such as "two pegs of one jaw".
    four : all contacts, such as "four pegs of the two jaws".
    inside : where the part lies, such as "in this vise".
    within : what a fixture must fit, such as "the jaws as asked: with the rows given".
    rules : what four pegs that touch must still do, such as "keeps the smallest gap, closes and clamps".
    backwards : when four contacts that close but do not clamp would hold.
    holes : the rule about holes, such as "holes that the jaws do not have".
    sets : the combinations that are counted, in the plural.
    clear : the last rule for fixtures beside a wall.
    reasons : why it holds nothing, from the first stage to the last; empty for the usual reasons
        (``model.search_report``).
    """

    two: str
    four: str
    inside: str
    within: str
    rules: str
    backwards: str
    holes: str
    sets: str = "sets of four pegs"
    clear: str = "locator clear of the clamp"
    reasons: tuple[str, ...] = ()


@frozen
class ToolkitChange:
    """A change of a toolkit to try where it holds nothing: a phrase, and the new values of fields."""

    words: str
    fields: Mapping[str, Any]


@frozen
class ToolkitLimit:
    """A limit of a toolkit that could be lifted.

    Parameters
    ----------
    rule : what it requires, in a few words, such as "rows of holes".
    bounds : what it limits: the pegs' bodies, the travel, how far a wall reaches, or the holes.
    lifted : the change that lifts it.
    """

    rule: str
    bounds: Literal["bodies", "travel", "reach", "holes"]
    lifted: ToolkitChange


def is_whole(number: float) -> bool:
    """Return whether a number is an integer within 1e-9."""
    return abs(number - round(number)) < 1e-9


class Toolkit:
    """The data that every toolkit has; a toolkit is a frozen attrs class, such as ``fixels.vise.Vise``.

    Attributes
    ----------
    kind : the name of its kind in files.
    table : its fields.
    noun : what it is called, such as "vise".
    locked : what it is with a screw that locks what moves, in words that "locked" follows.
    law : the name of the law by which the time of a search grows, see ``batch.durations``.
    arrangements : what may stand on its carriers.
    clamping : 1 when the moving carrier clamps as its travel gets less (a vise that closes), -1 when it
        clamps as its travel gets more.
    symmetries : motions besides the identity that make two fixtures the same.
    carriers : those that stand still first; at most one moves while a pose is sought.
    gap : the gap rule in mm, or None when there is none.
    wording : what its things are called where it holds nothing.
    setup_words : what setting it up is called on sheets, pictures and pages.
    page : what the page calls it.
    supports, top_clamp : the supports and the clamp on top that its owner has; None where not known.
    pins : what its pegs may bend; None for the usual limits.
    tolerance : how far its pegs and the faces they touch may be off (``model.requirements.Tolerance``), as its
        preset or file says; None where not known. A query takes it where it is given no other.
    """

    __slots__ = ()

    if TYPE_CHECKING:
        # Made from the table of fields, where a type checker does not look.
        def __init__(self, *args: Any, **fields: Any) -> None: ...

        supports: SupportPads | None
        top_clamp: TopClamp | None
        pins: PinLimits | None
        tolerance: Any

    kind: ClassVar[str]
    table: ClassVar[FieldTable]
    noun: ClassVar[str]
    locked: ClassVar[str]
    arrangements: ClassVar[tuple[Arrangement, ...]]
    law: ClassVar[str]
    clamping: ClassVar[int] = 1
    symmetries: ClassVar[tuple[Symmetry, ...]] = ()
    wording: ClassVar[ToolkitWording]
    setup_words: ClassVar[SetupWords]
    page: ClassVar[PageWords]

    @property
    def carriers(self) -> tuple[Carrier, ...]:
        """Carriers, those that stand still first."""
        raise NotImplementedError

    @property
    def ways(self) -> tuple[Toolkit, ...]:
        """Toolkits with only one of its moving carriers each,
        in the order of its arrangements; itself if it has one.
        """
        return (self,)

    @property
    def datum(self) -> Datum:
        """Origin of places, here the first hole of the first plate."""
        return Datum.from_hole(self.plates[0])

    @property
    def plates(self) -> tuple[Carrier, ...]:
        """Carriers with a lattice of holes."""
        return tuple(carrier for carrier in self.carriers if carrier.has_lattice)

    @property
    def peg_diameter(self) -> float | None:
        """Diameter in mm of the pegs that stand in its plates; None where there are none.

        >>> from workhold import Vise
        >>> Vise(pitch=20, columns=3, peg_radius=3).peg_diameter
        6.0
        """
        return 2 * self.plates[0].peg_radius if self.plates else None

    @property
    def is_in_inches(self) -> bool:
        """Whether all pitches are multiples of an eighth of an inch, and none of half a millimetre."""
        pitches = [pitch for carrier in self.plates for pitch in carrier.pitch]
        return all(is_whole(pitch / EIGHTH) and not is_whole(pitch / 0.5) for pitch in pitches)

    @property
    def contacts(self) -> frozenset[ContactKind]:
        """Kinds of contacts of its carriers."""
        return frozenset(carrier.contact for carrier in self.carriers)

    @property
    def tips(self) -> int:
        """Number of clamp tips in a fixture; their contacts are its last."""
        carriers = self.carriers
        return sum(carriers[number].contact is CLAMP_TIP for number in self.arrangements[0].carriers)

    @property
    def heights(self) -> dict[str, Heights]:
        """Heights in mm by role of the carriers that have heights of their own.

        >>> from workhold import Plate
        >>> Plate(pitch=20, peg_radius=3, clamp_heights=(6, 14)).heights
        {'clamp': (6.0, 14.0)}
        """
        return {one.role: one.heights for one in self.carriers if one.heights is not None}

    @property
    def travels(self) -> int:
        """Number of things that move in one fixture, each with its own travel: one jaw, or its clamps."""
        return max(self.tips, 1)

    @property
    def closes_at_once(self) -> bool:
        """Whether a single movement closes it, so that closing can be simulated; False with two clamps."""
        return self.travels == 1

    @property
    def ends_on_walls(self) -> tuple[slice, ...]:
        """Slices of a fixture's contacts, one for each wall,
        that are the ends of the part's contact with it.
        """
        standing = self.arrangements[0].carriers
        flush = [number for number, carrier in enumerate(self.carriers) if not carrier.contact.is_placed]
        walls = [number for number in flush if number in standing]
        return tuple(slice(standing.index(one), standing.index(one) + standing.count(one)) for one in walls)

    @property
    def flat_jaws(self) -> JawPair | None:
        """Pair of flat jaws that hold the part by friction; None for other toolkits."""
        return None

    @property
    def strap_set(self) -> StrapSet | None:
        """Straps that hold the part down by friction; None for other toolkits."""
        return None

    @property
    def holds_by_friction(self) -> bool:
        """Whether friction keeps the part in its place, between flat jaws or under straps."""
        return self.flat_jaws is not None or self.strap_set is not None

    @property
    def half_turned(self) -> tuple[int, ...] | None:
        """Index of the carrier whose place each takes after half a turn of everything, -1 for none.

        None where half a turn makes another toolkit.
        """
        return next((one.carriers for one in self.symmetries if one.half_turns % 2), None)

    @property
    def has_flats(self) -> bool:
        """Whether any carrier's pegs have flats."""
        return any(carrier.flat is not None for carrier in self.carriers)

    @property
    def peg_count(self) -> int:
        """Number of contacts of a fixture, ends on walls included."""
        return len(self.arrangements[0].carriers)

    @property
    def types(self) -> tuple[str, ...]:
        """Names of its types of arrangements, each once."""
        return tuple(dict.fromkeys(arrangement.name for arrangement in self.arrangements))

    @property
    def gap(self) -> float | None:
        """Smallest gap in mm between standing and moving pegs; None where there is no such rule."""
        return None

    @property
    def limits(self) -> tuple[ToolkitLimit, ...]:
        """Limits set by its fields that could be lifted, in the order in which a person would lift them."""
        limits = []
        for row in self.table.fields:
            free = self.find_followed_length(row) if row.follows else row.default
            if row.lifted is not None and getattr(self, row.name) != free:
                change = ToolkitChange(row.lifted.words, {row.name: free})
                limits.append(ToolkitLimit(row.lifted.rule, row.lifted.bounds, change))
        return tuple(sorted(limits, key=lambda limit: LIFTED.index(limit.bounds)))

    def find_followed_length(self, row: ToolkitField) -> float:
        """Return the default in mm of a field that follows another field; of a pitch that in x."""
        value = getattr(self, row.follows)
        return float(value[0] if isinstance(value, tuple) else value)

    def list_further_changes(self, unit: Unit) -> Iterator[ToolkitChange]:
        """Yield changes to try where it holds nothing, besides
        lifting its limits; lengths in words are in ``unit``.
        """
        yield from ()

    @classmethod
    def preset(cls, name: str, **changes: Any) -> Self:
        """Return a toolkit from a preset or a file, perhaps with some fields changed.

        Parameters
        ----------
        name : one of :meth:`presets`, or the path of a toolkit's TOML file.
        changes : fields to change, such as ``columns=2``; lengths in mm.

        Raises
        ------
        InputError
            For an unknown name, a toolkit of another class, and fields that it cannot have.

        Examples
        --------
        >>> from workhold import Plate, Vise
        >>> Vise.preset("plate-20mm", columns=2).pitch, Plate.preset("clamp-plate-20mm").clamp_radius
        ((20.0, 20.0), 5.0)
        """
        from workhold.files.toolkit_file import load_preset_fields, load_preset_tolerance

        given = {**load_preset_fields(cls, name), **changes}
        if PEG_RADIUS not in changes:
            given.setdefault("tolerance", load_preset_tolerance(name))
        try:
            return cls(**given)
        except TypeError as error:
            raise InputError(f"{cls.__name__} cannot be made of {', '.join(given)}: {error}.") from error

    @classmethod
    def presets(cls) -> tuple[str, ...]:
        """Return the names of the presets of this class.

        Examples
        --------
        >>> from workhold import Fence
        >>> Fence.presets()
        ('fence-20mm',)
        """
        from workhold.files.toolkit_file import list_presets_of_kind

        return list_presets_of_kind(cls)

    def with_fields(self, fields: Mapping[str, Any]) -> Self:
        """Return the toolkit with some fields changed; a new peg radius also drops the tolerance."""
        # Other pegs are as good as nobody says.
        others = {"tolerance": None} if PEG_RADIUS in fields else {}
        return evolve(self, **others, **fields)  # type: ignore[misc]

    def without_limits(self, limits: Iterable[ToolkitLimit]) -> Self:
        """Return the toolkit with the given limits lifted."""
        return self.with_fields(
            {name: value for limit in limits for name, value in limit.lifted.fields.items()}
        )

    @property
    def wall(self) -> Carrier | None:
        """Wall that the part lies flush against; None without one."""
        return next((carrier for carrier in self.carriers if carrier.is_wall), None)

    @property
    def wall_with_ends(self) -> Carrier | None:
        """Wall, if it has ends; None for an endless one, and without one."""
        return next((carrier for carrier in self.carriers if carrier.reach is not None), None)

    @property
    def moving(self) -> Carrier:
        """First carrier that moves."""
        return next(carrier for carrier in self.carriers if carrier.travel is not None)

    @property
    def moving_axis(self) -> tuple[float, float]:
        """Unit vector along which the travel of the first moving carrier is counted."""
        travel = self.moving.travel
        assert travel is not None
        return travel.unit

    def find_arrangement(self, name: str, direction: str | None = None) -> Arrangement:
        """Return the first arrangement with this name and, if given, this direction."""
        return next(a for a in self.arrangements if a.name == name and direction in (None, a.direction))

    def count_arrangements(self, arrangement: NDArray[Any]) -> dict[str, int]:
        """Return how many fixtures there are of each type,
        by name, from the indices (N,) of their arrangements.
        """
        counts = dict.fromkeys(self.types, 0)
        for one, count in zip(
            self.arrangements, np.bincount(arrangement, minlength=1).tolist(), strict=False
        ):
            counts[one.name] += count
        return counts

    def find_peg_carriers(self, arrangement: NDArray[Any]) -> NDArray[np.int8]:
        """Return the index (N, K) of each peg's carrier in N
        fixtures, from the indices (N,) of their arrangements.
        """
        return np.array([one.carriers for one in self.arrangements], np.int8).take(arrangement, axis=0)

    def find_carrier(self, name: str) -> Carrier:
        """Return the carrier of a name; raises StopIteration without one."""
        return next(carrier for carrier in self.carriers if carrier.name == name)

    def find_carrier_numbers(self, names: Iterable[str]) -> list[int]:
        """Return the indices of the carriers with these names."""
        known = [carrier.name for carrier in self.carriers]
        return [known.index(name) for name in names]

    def find_arrangement_numbers(self, standing: NDArray[Any]) -> NDArray[np.int64]:
        """Return the index (N,) of the first arrangement with
        ``standing`` (N,) pegs on the first carrier; -1 without one.
        """
        pegs = [one.pegs[0] for one in self.arrangements]
        return np.asarray(
            np.array([pegs.index(k) if k in pegs else -1 for k in range(max(pegs) + 1)])[standing]
        )

    def compute_hole_places(
        self,
        arrangement: NDArray[Any],
        column: NDArray[Any],
        row: NDArray[Any],
        travelled: NDArray[np.float64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return x (N, K) and y (N, K) in mm of the holes of N fixtures.

        Parameters
        ----------
        arrangement : (N,) indices.
        column, row : (N, K) of the holes.
        travelled : travel in mm, (N,) of the one moving carrier, or (N, M) of the last M pegs.
        """
        moved = (
            np.broadcast_to(travelled[:, None], column.shape)
            if travelled.ndim == 1
            else np.zeros(column.shape)
        )
        if travelled.ndim > 1:
            moved[:, -travelled.shape[1] :] = travelled
        offset, pitch = (
            np.array([getattr(one, name) for one in self.carriers]) for name in ("offset", "pitch")
        )
        unit = np.array([(0.0, 0.0) if one.travel is None else one.travel.unit for one in self.carriers])
        carriers = np.array([one.carriers for one in self.arrangements], np.int64)

        def of_pegs(values: NDArray[np.float64]) -> NDArray[np.float64]:
            """Return the values (C,) of carriers for each peg, (N, K)."""
            return np.asarray(values[carriers].take(arrangement, axis=0))

        x, y = (
            of_pegs(offset[:, k]) + holes * of_pegs(pitch[:, k]) + moved * of_pegs(unit[:, k])
            for k, holes in enumerate((column, row))
        )
        return x, y
