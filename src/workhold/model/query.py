"""A query: everything that is asked of a design, one type from the command line, Python and the page to the
result.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, cast

from attrs import evolve, field, frozen

from workhold.asking.search import SearchQuestion
from workhold.errors import InputError, refuse_kind
from workhold.fixels.toolkit import Toolkit
from workhold.model.first_choice import has_house_order, list_ranking_figures
from workhold.model.friction import SAFETY, Coefficients, to_coefficients
from workhold.model.jaw_hold import choose_hold_ranking
from workhold.model.own_outlines import adapt_outlines_to_toolkit
from workhold.model.program import Program
from workhold.model.quality import (
    CLOSURE_MARGIN,
    FIGURE_RANKING,
    FIGURES,
    JAW_FORCE_NEEDED,
    LOAD_REACTION,
    PIN_KEYS,
    PROGRAM_FIGURE,
    SEATING_FIGURES,
    adapt_ranking_to_loads,
    resolve_ranking,
    to_tuple,
    to_words,
)
from workhold.model.raw_block import RawBlock, enclose_in_block, raise_load, raise_program, to_raw_block
from workhold.model.requirements import Load, Restrictions, Tolerance
from workhold.model.straps import choose_strap_ranking
from workhold.model.workpiece import Workpiece

__all__ = ["Query"]

LOAD_KEYS = (FIGURES[LOAD_REACTION].key, FIGURES[JAW_FORCE_NEEDED].key)
SEATING_KEYS = {figure.key for figure in SEATING_FIGURES}


def to_restrictions(value: Restrictions | None) -> Restrictions:
    """Return the restrictions; for None, an object that restricts nothing."""
    return Restrictions() if value is None else value


def make_tolerance(value: Tolerance | None) -> Tolerance:
    """Return the value unchanged, also None: the query replaces None once it knows the toolkit."""
    return cast(Tolerance, value)


def to_loads(loads: Load | Iterable[Load]) -> tuple[Load, ...]:
    """Return loads as a tuple, from one load or from several."""
    return (loads,) if isinstance(loads, Load) else to_tuple("loads", loads)


# What parts of a query must be, and how to get one.
KINDS: dict[str, tuple[type, str]] = {
    "workpiece": (Workpiece, "give a Workpiece, such as workhold.load('part.dxf')"),
    "toolkit": (Toolkit, "give a toolkit, such as workhold.Vise(pitch=10, columns=2, peg_radius=3)"),
    "restrictions": (Restrictions, "give Restrictions"),
    "tolerance": (Tolerance, "give a Tolerance"),
}


def refuse_other_kinds(query: Query) -> None:
    """Raise InputError where workpiece, toolkit, restrictions,
    tolerance or a load of a query has a wrong type.
    """
    for name, (kind, remedy) in KINDS.items():
        refuse_kind(getattr(query, name), kind, f"the {name}", remedy)
    loads: tuple[Any, ...] = query.loads
    for load in loads:
        if not isinstance(load, Load):
            raise InputError(
                f"a load cannot be {load!r}: give Load objects, such as workhold.model.requirements.Load."
            )


@frozen
class Query(SearchQuestion):
    """A part, a toolkit, and all requirements of the fixtures.

    Parameters
    ----------
    workpiece, toolkit : the part, and the toolkit to hold it in.
    types : names of the toolkit's arrangements to search, such as "I" or ("I", "II"); None for all.
    contact_margin : smallest distance in mm between a contact and the end of its feature.
    restrictions : faces not to touch, places where no peg may stand, angles of the part; None means no
        restriction.
    rank_by : names of the figures of quality to rank by, the most important first, see ``model.quality``.
        None is the usual order, see :mod:`workhold.model.first_choice`.
    tolerance : tolerances of pegs and faces, for the location error; None is the toolkit's own if it has one,
        as presets have, or else the usual one. The workpiece's departure is added to that of the faces.
    loads : loads that the fixture must resist.
    best : number of fixtures to search for and list, the best ones; None for all.
    jaw_force : force in N with which the vise is closed, for warnings of pegs that let go, or with which each
        strap presses at its tip; None where it is not decided.
    listing : with two clamps, "best" lists one fixture for each seat and pair of directions with the number
        of pairs of clamps there, "all" lists every one. None stands for "best"; other toolkits take only
        None.
    seating : number of the first fixtures for which to work out where else their pegs can hold the part;
        these are ordered anew (see ``workhold.seating``). None for no seating.
    opening : with seating, list only fixtures that catch the part with the jaws open, or the clamp drawn
        back, by this length in mm from where they hold it. Wrong seats farther open do not count.
    foolproof : with seating, list only fixtures without a wrong seat that a caliper could take for the right
        one.
    program : of the machine: list only fixtures that its tools do not come near, and judge them under its
        forces; None where it is not known.
    peg_height : height in mm of pegs, clamps and walls over the plane on which the part lies; None where
        nobody says. A program needs it; for a part read from a solid it is the solid's.
    max_location_error : list only fixtures whose location error is at most this, in mm; None for any.
    thickness : thickness of the part in mm, for the bending of pegs and the grip of flat jaws; None where
        unknown, and for a solid, which has its own.
    friction : coefficients of friction by name where flat jaws or straps hold the part, such as {"jaw":
        0.15}; None for the usual ones (``model.friction``).
    safety : factor on the loads where friction holds the part; None for the usual 2.
    weight : weight of the part in N, without the safety factor, where straps hold it; None counts as 0.
    raw : by how much the raw block of a first operation is larger than the finished part, such as {"side": 3,
        "top": 2, "bottom": 5} in mm; the jaws then touch the block, with the part inside. None where the part
        itself is held. The query's workpiece, thickness, loads and program are then those of the block.
    strapped : number of the best seats on a plate with straps for which places of straps are searched; None
        for 20.

    Raises
    ------
    InputError
        For an unknown arrangement or figure, one named twice, and numbers out of range. Also for a figure of
        loads without loads, what needs seating without it, and a program without a peg height.
    """

    workpiece: Workpiece
    toolkit: Toolkit
    types: tuple[str, ...] = field(default=None, converter=to_words)
    restrictions: Restrictions = field(default=None, converter=to_restrictions)
    rank_by: tuple[str, ...] = field(default=None, converter=to_words)
    tolerance: Tolerance = field(default=None, converter=make_tolerance)
    loads: tuple[Load, ...] = field(default=(), converter=to_loads)
    program: Program | None = None
    friction: Coefficients | None = field(default=None, converter=to_coefficients, kw_only=True)
    raw: RawBlock | None = field(default=None, converter=to_raw_block, kw_only=True)

    def __attrs_post_init__(self) -> None:
        given: Any = self.tolerance
        if given is None:
            object.__setattr__(self, "tolerance", getattr(self.toolkit, "tolerance", None) or Tolerance())
        refuse_other_kinds(self)
        self.lay_in_raw_block()
        object.__setattr__(self, "workpiece", adapt_outlines_to_toolkit(self.workpiece, self.toolkit))
        object.__setattr__(self, "tolerance", self.tolerance.with_departure(self.workpiece.departure))
        known = self.toolkit.types
        object.__setattr__(self, "types", check_arrangements(self.types, known))
        pairs = self.toolkit.travel_count > 1
        self.refuse_loads_across()
        if self.toolkit.flat_jaws is not None:
            object.__setattr__(self, "rank_by", choose_hold_ranking(self.rank_by))
        elif self.toolkit.strap_set is not None:
            object.__setattr__(self, "rank_by", choose_strap_ranking(self.rank_by))
        else:
            asked = self.is_loaded, pairs, self.seating is not None, self.toolkit.wall_with_ends is not None
            object.__setattr__(self, "rank_by", resolve_ranking(self.rank_by, *asked))
        if PROGRAM_FIGURE.key in self.rank_by and self.program is None:
            raise InputError(f"there is no program to rank by the {PROGRAM_FIGURE.words}: give one.")
        if self.program is not None:
            object.__setattr__(self, "program", self.program.keep_forces_on(self.workpiece.outer_loops))
        if self.toolkit.flat_jaws is not None:
            object.__setattr__(self, "peg_height", None)
        elif self.program is not None or self.peg_height is not None:
            object.__setattr__(self, "peg_height", choose_peg_height(self.peg_height, self.workpiece))
        if self.workpiece.solid is not None:
            object.__setattr__(self, "thickness", None)
            if self.program is None:
                object.__setattr__(self, "peg_height", None)
        if (
            self.toolkit.flat_jaws is None
            and not self.knows_heights
            and not set(PIN_KEYS).isdisjoint(self.rank_by)
        ):
            raise InputError(
                "how far pegs bend depends on how high they touch the part, which is not known: give the "
                "part's thickness, or the height of the pegs."
            )
        if self.listing is not None and not pairs:
            raise InputError(
                f"the listing cannot be {self.listing!r}: only fixtures with two clamps have one."
            )
        if pairs and self.listing is None:
            object.__setattr__(self, "listing", "best")
        self.refuse_untouchable()
        if self.has_seating_rules and self.seating is None:
            raise InputError(
                "an opening, or foolproof, needs the seating of fixtures, which is worked out for the "
                "first ones only: give their number, such as seating 100."
            )

    def lay_in_raw_block(self) -> None:
        """Replace the workpiece by the raw block around the part, if the query has one.

        Thickness, loads and program, which are given for the finished part, are then those of the block. A
        part that is already in a block is not changed.
        """
        raw = self.raw
        if raw is None:
            if self.workpiece.finished is not None:
                raise InputError(f"{self.workpiece.name} is a raw block: say by how much it is larger.")
            return
        if self.toolkit.flat_jaws is None:
            raise InputError(
                f"a raw block is held between the flat jaws of a plain vise, which a {self.toolkit.noun} does not have: "
                "take one, or leave the raw block out."
            )
        bottom = raw.bottom
        if self.workpiece.finished is None:
            if self.part_height is None:
                raise InputError(
                    "how thick the part is decides how high its raw block is: give its thickness."
                )
            object.__setattr__(self, "thickness", raw.compute_height(self.part_height))
            object.__setattr__(self, "loads", tuple(raise_load(load, bottom) for load in self.loads))
            object.__setattr__(self, "workpiece", enclose_in_block(self.workpiece, raw))
        elif not self.workpiece.is_alike(enclose_in_block(self.workpiece.finished, raw)):
            raise InputError(f"{self.workpiece.name} is not the raw block around its finished part.")
        of_block = {*self.restrictions.avoid, *self.restrictions.touch}
        if not of_block <= set(range(4)):
            raise InputError(
                f"face {min(of_block - set(range(4)))} is not there yet: the raw block has the faces 0 to 3, counted from "
                "the lower one in the drawing counter-clockwise."
            )
        program, height = self.program, self.thickness
        if program is None or height is None:
            return
        if program.raised != bottom or (program.forces is not None and not program.is_placed):
            object.__setattr__(self, "program", raise_program(program, bottom, height))

    def refuse_loads_across(self) -> None:
        """Raise InputError for loads and options that do not fit the toolkit's way of holding the part.

        Pegs hold without friction: no load along z, no friction, no safety factor. Flat jaws have no pegs: no
        contact margin, seating, keep-out zone or largest location error; loads along z, and forces of a
        program, need the part's height. Straps are checked by :meth:`refuse_beside_straps`.
        """
        across = next((number for number, load in enumerate(self.loads, 1) if load.upward), None)
        self.refuse_beside_straps()
        if self.toolkit.strap_set is not None:
            return
        if self.toolkit.flat_jaws is None:
            if across is not None:
                raise InputError(
                    f"load {across} acts along z, which nothing keeps the part from following but friction: hold it "
                    "in a plain vise or under straps, or find supports and a clamp on top."
                )
            for name, value in (("friction", self.friction), ("safety factor", self.safety)):
                if value is not None:
                    raise InputError(
                        f"the {name} counts where flat jaws or straps hold the part; pegs are reckoned without "
                        "friction: leave it out, or take a plain vise or a plate with straps."
                    )
            return
        if across is not None and self.part_height is None:
            raise InputError(
                f"load {across} acts along z, and how high the part is decides what holds it: give its thickness."
            )
        only_of_pegs = {
            "a contact margin": self.contact_margin > 0.0,
            "a largest location error": self.max_location_error is not None,
            "seating": self.seating is not None,
            "a keep-out zone": bool(self.restrictions.zones),
        }
        if self.program is not None and self.program.forces is not None and self.part_height is None:
            raise InputError(
                "the tools of the program press on the part, and how high it is decides what holds it: give its "
                "thickness."
            )
        for asked, is_given in only_of_pegs.items():
            if is_given:
                raise InputError(f"{asked} is asked of pegs, and flat jaws have none: leave it out.")

    def refuse_beside_straps(self) -> None:
        """Raise InputError for a weight or a number of strapped seats without straps.

        With straps, raise it for loads or a program where the part's thickness is not known, and for
        seating.
        """
        only_of_straps = {"a weight": self.weight, "a number of strapped seats": self.strapped}
        if self.toolkit.strap_set is None:
            for asked, value in only_of_straps.items():
                if value is not None:
                    raise InputError(
                        f"{asked} counts where straps hold the part: leave it out, or take a plate with straps."
                    )
            return
        if self.is_loaded and self.part_height is None:
            raise InputError("how thick the part is decides what straps hold: give its thickness.")
        if self.program is not None and self.part_height is None:
            raise InputError(
                "how thick the part is decides at which heights tools pass the straps: give its thickness."
            )
        if self.seating is not None:
            raise InputError(
                "seating is not looked at with straps: leave it out; a hand's push that seats the part is told for "
                "the best seats."
            )

    @property
    def part_height(self) -> float | None:
        """Height of the part in mm: the solid's, else the thickness; None where neither is known."""
        solid = self.workpiece.solid
        return self.thickness if solid is None else solid.height

    @property
    def safety_factor(self) -> float:
        """Factor on loads where friction holds the part."""
        return SAFETY if self.safety is None else self.safety

    @property
    def unit_force(self) -> float | None:
        """Given jaw force times the safety factor, in N; None without a jaw force.

        Divided by the force that loads need (safety factor included), it is the factor by which all loads may
        grow.
        """
        return None if self.jaw_force is None else self.jaw_force * self.safety_factor

    def refuse_untouchable(self) -> None:
        """Raise InputError for faces to touch that do not exist or are more than a fixture's contacts, and
        for any with two clamps.
        """
        faces, toolkit = self.restrictions.touch, self.toolkit
        if not faces:
            return
        if toolkit.travel_count > 1:
            raise InputError(
                "faces to touch cannot be asked for with two clamps: take one clamp, or list all and "
                "choose among them."
            )
        if toolkit.peg_count and len(faces) > toolkit.peg_count:
            raise InputError(
                f"{len(faces)} faces are to be touched, and a fixture has {toolkit.peg_count} contacts: name fewer."
            )
        unknown = [face for face in faces if not 0 <= face < len(self.workpiece.numbered.segments)]
        if unknown:
            known = ", ".join(str(face.number) for face in self.workpiece.faces)
            raise InputError(
                f"face {unknown[0]} of {self.workpiece.name} does not exist: its faces are {known}."
            )

    @property
    def is_sifted(self) -> bool:
        """Whether some fixtures that hold the part are left out because of faces to touch or a largest
        location error.
        """
        return bool(self.restrictions.touch) or self.max_location_error is not None

    @property
    def has_seating_rules(self) -> bool:
        """Whether fixtures are left out by their seating (``foolproof`` or ``opening``)."""
        return self.foolproof or self.opening is not None

    @property
    def pressed_top(self) -> float | None:
        """Height in mm up to which pegs touch a prism: the lesser of thickness and peg height.

        It is None for a solid, and where neither is known.
        """
        known = [one for one in (self.thickness, self.peg_height) if one is not None]
        return min(known) if known and self.workpiece.solid is None else None

    @property
    def knows_heights(self) -> bool:
        """Whether the heights at which pegs touch the part are known."""
        return self.workpiece.solid is not None or self.pressed_top is not None

    @property
    def program_to_clear(self) -> tuple[Program, float] | None:
        """Program whose tools must clear the fixture, and the height of the pegs in mm; None if one of them
        is missing.
        """
        if self.program is None or self.peg_height is None:
            return None
        return self.program, self.peg_height

    @property
    def is_loaded(self) -> bool:
        """Whether a load or the forces of the program's tools act on the part."""
        return bool(self.loads) or (self.program is not None and self.program.forces is not None)

    @property
    def asked(self) -> tuple[str, ...]:
        """Names of all requirements that exclude fixtures: those of the query and limits of the toolkit."""
        return (*self.restricted_by, *(limit.rule for limit in self.toolkit.limits))

    @property
    def restricted_by(self) -> tuple[str, ...]:
        """Names in :attr:`asked` that come from the query, not from the toolkit."""
        rules = {
            "faces to avoid": bool(self.restrictions.avoid),
            "keep-out zones": bool(self.restrictions.zones),
            "tools of the program": self.program is not None,
            "angles of the part": bool(self.restrictions.angles),
            "contact margin": self.contact_margin > 0.0,
            "faces to touch": bool(self.restrictions.touch),
            "largest location error": self.max_location_error is not None,
            "types sought": len(self.types) < len(self.toolkit.types),
        }
        return tuple(name for name, is_asked in rules.items() if is_asked)

    @property
    def asked_of_places(self) -> tuple[str, ...]:
        """Names in :attr:`asked` that leave fewer places for pegs along the part, or fewer holes."""
        places = ("faces to avoid", "keep-out zones", "tools of the program")
        holes = (limit.rule for limit in self.toolkit.limits if limit.bounds != "travel")
        return (*(name for name in self.restricted_by if name in places), *holes)

    @property
    def without_program(self) -> Query:
        """Copy of the query without its program and without the ranking figures that need one."""
        of_program = {PROGRAM_FIGURE.key} if self.loads else {PROGRAM_FIGURE.key, *LOAD_KEYS}
        ranking = [key for key in self.rank_by if key not in of_program]
        known = list_ranking_figures(ranking)
        return evolve(self, program=None, rank_by=ranking if known else None)

    @property
    def without_seating(self) -> Query:
        """Query to answer first, before seating is computed: without rules and figures of seating.

        It asks for at least as many fixtures as need a seating. It is the query itself if no seating is asked
        for.
        """
        if self.seating is None:
            return self
        if not self.toolkit.closes_at_once:
            return evolve(self, seating=None)
        known = [key for key in self.rank_by if key not in SEATING_KEYS]
        needed = len(known) < len(self.rank_by)
        return evolve(
            self,
            rank_by=[*dict.fromkeys((*known, *adapt_ranking_to_loads(FIGURE_RANKING, self.is_loaded)))]
            if needed
            else known,
            best=None if self.best is None else max(self.best, self.seating),
            seating=None,
            opening=None,
            foolproof=False,
        )

    @property
    def has_house_order(self) -> bool:
        """Whether the ranking is the usual order, in which a fixture's rank depends on the best of all."""
        return has_house_order(self.rank_by)

    @property
    def by_margin_alone(self) -> bool:
        """Whether fixtures are ranked by the closure margin only, which a search can bound."""
        return self.rank_by == (FIGURES[CLOSURE_MARGIN].key,)


def choose_peg_height(given: float | None, workpiece: Workpiece) -> float:
    """Return the height in mm of pegs, clamps and walls: ``given``, else that of the part's solid.

    Raises InputError if neither is known, and if ``given`` is not the peg height with which the solid was
    read.
    """
    solid = workpiece.solid
    if given is None and solid is None:
        raise InputError(
            f"{workpiece.name} is an outline without heights, so it is not known which moves of the "
            "program pass over the pegs: give its thickness, and the peg height where pegs are not "
            "as high as the part."
        )
    height = given if given is not None else solid.peg_height if solid is not None else 0.0
    if solid is not None and height != solid.peg_height:
        raise InputError(
            f"pegs of {height:g} mm are asked for, but the outline is the one that pegs of "
            f"{solid.peg_height:g} mm can meet: read the part with the peg height that is asked for."
        )
    return height


def check_arrangements(names: Sequence[str] | None, known: Sequence[str]) -> tuple[str, ...]:
    """Return the named arrangements in the toolkit's order (``known``), or all of them for None.

    Raises InputError for a name that is not known, and for an empty list of names.
    """
    for name in names or ():
        if name not in known:
            raise InputError(f"type {name} is unknown: choose {' or '.join(known)}.")
    if names is not None and not names:
        raise InputError(f"there is no type to seek: choose {' or '.join(known)}.")
    return tuple(name for name in known if names is None or name in names)
