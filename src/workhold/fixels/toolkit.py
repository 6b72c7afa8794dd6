"""Toolkits: carriers of pegs, their holes, the moving carriers, and the direction in which these clamp.

A toolkit is data. All code that searches, proves, lists, draws and writes fixtures uses the data below and
does not depend on the kind of toolkit. A new kind is a small module with these data, such as ``fixels.vise``.

Glossary
--------
carrier : a lattice of holes that carries pegs; it is fixed or slides along a line. A vise's jaws are two
    carriers.
travel : the distance in mm that a carrier has slid along its direction; for a vise the jaw separation.
arrangement : the number of pegs on each carrier. The paper's Type I is two and two, its Type II three and
    one.
gap rule : the smallest distance along the direction of travel from a peg of the fixed carrier to a peg of the
    moving one.
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
    """Phrases for messages about a toolkit without fixtures.

    Parameters
    ----------
    two : the two pegs of a chord, such as "two pegs of one jaw".
    four : all contacts, such as "four pegs of the two jaws".
    inside : place of the part, such as "in this vise".
    within : the limits that a fixture must fit, such as "the jaws as asked: with the rows given".
    rules : the further conditions on four touching pegs, such as "keeps the smallest gap, closes and clamps".
    backwards : the case in which four contacts that close but do not clamp would hold.
    holes : the rule about holes, such as "holes that the jaws do not have".
    sets : the combinations that are counted, in the plural.
    clear : the last rule for fixtures beside a wall.
    reasons : reasons why there is no fixture, from the first stage to the last; empty for the usual reasons
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
    """A change to try for a toolkit that cannot hold the part: ``words`` is a phrase, ``fields`` are new
    values by field name.
    """

    words: str
    fields: Mapping[str, Any]


@frozen
class ToolkitLimit:
    """A limit of a toolkit that could be lifted.

    Parameters
    ----------
    rule : the limit in a few words, such as "rows of holes".
    bounds : the limited property: the pegs' bodies, the travel, the extent of a wall, or the holes.
    lifted : the change that lifts it.
    """

    rule: str
    bounds: Literal["bodies", "travel", "reach", "holes"]
    lifted: ToolkitChange


def is_whole(number: float) -> bool:
    """Return whether a number is an integer within 1e-9."""
    return abs(number - round(number)) < 1e-9


class Toolkit:
    """The base class of all toolkits; each kind is a frozen attrs class, such as ``fixels.vise.Vise``.

    Attributes
    ----------
    kind : name of the kind in files.
    table : its fields.
    noun : word for such a toolkit, such as "vise".
    locked : words for a toolkit whose movement a screw can lock, such as "a screw vise, its jaw"; "locked"
        follows.
    law : key in ``batch.durations`` of the law for the duration of a search.
    arrangements : the possible numbers of contacts on the carriers.
    clamping : 1 if the moving carrier clamps as its travel shrinks (a vise that closes), -1 if it clamps as
        its travel grows.
    symmetries : rotations, besides the identity, that carry the toolkit onto itself.
    carriers : fixed carriers come first; at most one moves while a pose is computed.
    gap : smallest distance in mm along the travel between fixed and moving pegs; None for no such rule.
    wording : phrases for messages where the toolkit holds nothing.
    setup_words : texts about setting it up, on sheets, pictures and pages.
    page : texts for the web page.
    supports, top_clamp : the supports and the clamp on top that its owner has; None where not known.
    pins : limits of the bending of its pegs; None for the usual limits.
    tolerance : how far its pegs and the faces they touch may be off (``model.requirements.Tolerance``), as
        its preset or file says; None where not known. A query uses it where it has no tolerance of its own.
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
        """The carriers, the fixed ones first."""
        raise NotImplementedError

    @property
    def ways(self) -> tuple[Toolkit, ...]:
        """Toolkits that each have only one of its clamps, one for each direction; itself where only one
        carrier moves.
        """
        return (self,)

    @property
    def datum(self) -> Datum:
        """The origin of places; unless a kind has another one, the first hole of the first plate."""
        return Datum.from_hole(self.plates[0])

    @property
    def plates(self) -> tuple[Carrier, ...]:
        """The carriers that have a lattice of holes."""
        return tuple(carrier for carrier in self.carriers if carrier.has_lattice)

    @property
    def peg_diameter(self) -> float | None:
        """The diameter in mm of the pegs in the first plate; None for a toolkit without plates.

        >>> from workhold import Vise
        >>> Vise(pitch=20, columns=3, peg_radius=3).peg_diameter
        6.0
        """
        return 2 * self.plates[0].peg_radius if self.plates else None

    @property
    def is_in_inches(self) -> bool:
        """Whether every pitch is a multiple of an eighth of an inch, and none is a multiple of half a
        millimetre.
        """
        pitches = [pitch for carrier in self.plates for pitch in carrier.pitch]
        return all(is_whole(pitch / EIGHTH) and not is_whole(pitch / 0.5) for pitch in pitches)

    @property
    def contacts(self) -> frozenset[ContactKind]:
        """The kinds of contacts that its carriers make."""
        return frozenset(carrier.contact for carrier in self.carriers)

    @property
    def tip_count(self) -> int:
        """The number of clamp tips in a fixture; they are the last of its contacts."""
        carriers = self.carriers
        return sum(carriers[number].contact is CLAMP_TIP for number in self.arrangements[0].carriers)

    @property
    def heights(self) -> dict[str, Heights]:
        """The lower and upper end in mm of each role of carriers for which heights are given.

        >>> from workhold import Plate
        >>> Plate(pitch=20, peg_radius=3, clamp_heights=(6, 14)).heights
        {'clamp': (6.0, 14.0)}
        """
        return {one.role: one.heights for one in self.carriers if one.heights is not None}

    @property
    def travel_count(self) -> int:
        """The number of separate travels in a fixture: that of each clamp, or 1 for a jaw."""
        return max(self.tip_count, 1)

    @property
    def closes_at_once(self) -> bool:
        """Whether one movement closes it, so that closing can be simulated; False with two clamps."""
        return self.travel_count == 1

    @property
    def ends_on_walls(self) -> tuple[slice, ...]:
        """For each wall, the slice of a fixture's contacts that are the two ends of the part's contact with
        this wall.
        """
        standing = self.arrangements[0].carriers
        flush = [number for number, carrier in enumerate(self.carriers) if not carrier.contact.is_placed]
        walls = [number for number in flush if number in standing]
        return tuple(slice(standing.index(one), standing.index(one) + standing.count(one)) for one in walls)

    @property
    def flat_jaws(self) -> JawPair | None:
        """The two flat jaws that hold the part by friction; None for other toolkits."""
        return None

    @property
    def strap_set(self) -> StrapSet | None:
        """The straps that hold the part down by friction; None for other toolkits."""
        return None

    @property
    def holds_by_friction(self) -> bool:
        """Whether friction holds the part, between flat jaws or under straps."""
        return self.flat_jaws is not None or self.strap_set is not None

    @property
    def half_turned(self) -> tuple[int, ...] | None:
        """For each carrier the index of the carrier onto which half a turn of the toolkit carries it; -1 for
        none.

        None for the whole where half a turn does not carry the toolkit onto itself.
        """
        return next((one.carriers for one in self.symmetries if one.half_turns % 2), None)

    @property
    def has_flats(self) -> bool:
        """Whether the pegs of some carrier have flats."""
        return any(carrier.flat is not None for carrier in self.carriers)

    @property
    def peg_count(self) -> int:
        """The number of contacts of a fixture; each contact with a wall counts as two, one for each end."""
        return len(self.arrangements[0].carriers)

    @property
    def types(self) -> tuple[str, ...]:
        """The names of its arrangements, each once."""
        return tuple(dict.fromkeys(arrangement.name for arrangement in self.arrangements))

    @property
    def gap(self) -> float | None:
        """The smallest distance in mm along the travel between fixed and moving pegs; None for no such rule."""
        return None

    @property
    def limits(self) -> tuple[ToolkitLimit, ...]:
        """The limits set by its fields that could be lifted, in the order in which a person would lift them."""
        limits = []
        for row in self.table.fields:
            free = self.find_followed_length(row) if row.follows else row.default
            if row.lifted is not None and getattr(self, row.name) != free:
                change = ToolkitChange(row.lifted.words, {row.name: free})
                limits.append(ToolkitLimit(row.lifted.rule, row.lifted.bounds, change))
        return tuple(sorted(limits, key=lambda limit: LIFTED.index(limit.bounds)))

    def find_followed_length(self, row: ToolkitField) -> float:
        """Return the default in mm of a field that follows another field: the other's value, of a pitch that
        in x.
        """
        value = getattr(self, row.follows)
        return float(value[0] if isinstance(value, tuple) else value)

    def list_further_changes(self, unit: Unit) -> Iterator[ToolkitChange]:
        """Yield changes to try where the toolkit holds no part, in addition to lifting its limits.

        ``unit`` is the unit of lengths in the changes' words.
        """
        yield from ()

    @classmethod
    def preset(cls, name: str, **changes: Any) -> Self:
        """Return a toolkit from a preset or a file, perhaps with some fields changed.

        Parameters
        ----------
        name : one of :meth:`presets`, or the path of a toolkit's TOML file, or of a vise of FreeCAD.
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
        """Return the toolkit with some fields changed.

        With another peg radius the tolerance becomes None, as nothing is known of the new pegs.
        """
        # Other pegs are as good as nobody says.
        others = {"tolerance": None} if PEG_RADIUS in fields else {}
        return evolve(self, **others, **fields)  # type: ignore[misc]

    def without_limits(self, limits: Iterable[ToolkitLimit]) -> Self:
        """Return the toolkit with these limits lifted."""
        return self.with_fields(
            {name: value for limit in limits for name, value in limit.lifted.fields.items()}
        )

    @property
    def wall(self) -> Carrier | None:
        """The wall that the part lies flush against; None if there is none."""
        return next((carrier for carrier in self.carriers if carrier.is_wall), None)

    @property
    def wall_with_ends(self) -> Carrier | None:
        """The wall, if it has ends; None if it is endless or there is none."""
        return next((carrier for carrier in self.carriers if carrier.reach is not None), None)

    @property
    def moving(self) -> Carrier:
        """The first carrier that moves; StopIteration where none does."""
        return next(carrier for carrier in self.carriers if carrier.travel is not None)

    @property
    def moving_axis(self) -> tuple[float, float]:
        """The unit vector (x, y) of the direction in which the first moving carrier's travel grows."""
        travel = self.moving.travel
        assert travel is not None
        return travel.unit

    def find_arrangement(self, name: str, direction: str | None = None) -> Arrangement:
        """Return the first arrangement with this name and this direction; with direction None, the first with
        this name.

        Raises
        ------
        StopIteration
            Where there is none.
        """
        return next(a for a in self.arrangements if a.name == name and direction in (None, a.direction))

    def count_arrangements(self, arrangement: NDArray[Any]) -> dict[str, int]:
        """Return the number of fixtures of each type, by the type's name.

        ``arrangement`` (N,) has for each fixture the index of its arrangement.
        """
        counts = dict.fromkeys(self.types, 0)
        for one, count in zip(
            self.arrangements, np.bincount(arrangement, minlength=1).tolist(), strict=False
        ):
            counts[one.name] += count
        return counts

    def find_peg_carriers(self, arrangement: NDArray[Any]) -> NDArray[np.int8]:
        """Return for each of the K contacts of N fixtures the index of its carrier (N, K).

        ``arrangement`` (N,) has for each fixture the index of its arrangement.
        """
        return np.array([one.carriers for one in self.arrangements], np.int8).take(arrangement, axis=0)

    def find_carrier(self, name: str) -> Carrier:
        """Return the carrier with this name.

        Raises
        ------
        StopIteration
            If there is none.
        """
        return next(carrier for carrier in self.carriers if carrier.name == name)

    def find_carrier_numbers(self, names: Iterable[str]) -> list[int]:
        """Return the indices of the carriers with these names."""
        known = [carrier.name for carrier in self.carriers]
        return [known.index(name) for name in names]

    def find_arrangement_numbers(self, standing: NDArray[Any]) -> NDArray[np.int64]:
        """Return for each of N fixtures the index (N,) of its arrangement; -1 where none fits.

        ``standing`` (N,) is the number of contacts on the first carrier; the first arrangement with that
        number is taken.
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
        """Return (1) x and (2) y in mm of the holes of the K contacts of N fixtures, both (N, K).

        Parameters
        ----------
        arrangement : (N,) index of each fixture's arrangement.
        column, row : (N, K) of the holes, counted from 0.
        travelled : travels in mm: (N,) of the one carrier that moves, or (N, M) of the last M contacts.
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

        def repeat_for_pegs(values: NDArray[np.float64]) -> NDArray[np.float64]:
            """Return for each contact (N, K) the value of its carrier, from the values (C,) of the C
            carriers.
            """
            return np.asarray(values[carriers].take(arrangement, axis=0))

        x, y = (
            repeat_for_pegs(offset[:, k])
            + holes * repeat_for_pegs(pitch[:, k])
            + moved * repeat_for_pegs(unit[:, k])
            for k, holes in enumerate((column, row))
        )
        return x, y
