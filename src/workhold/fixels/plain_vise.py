"""A machine vise with two flat jaws, which hold the part by friction, on parallels and against a work stop."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from math import inf, pi
from typing import TYPE_CHECKING, Any

from workhold.errors import InputError
from workhold.fixels import fields
from workhold.fixels.carrier import Carrier, Heights
from workhold.fixels.jaw_pair import JawPair
from workhold.fixels.making import make_class_from_table, refuse_all_out_of_bounds
from workhold.fixels.setup_words import Datum, PageWords, SetupWords
from workhold.fixels.table import REQUIRED, FieldTable, PageLabel
from workhold.fixels.toolkit import Arrangement, Toolkit, ToolkitChange, ToolkitWording, Travel
from workhold.units import Unit

__all__ = ["PlainVise"]

# Of the jaws' width: how wide a work stop is taken to be where nobody says.
STOP_SHARE = 0.07
# mm. Thin parallels, which are in fewer tools' way.
THIN_PARALLEL = 3.0


@make_class_from_table
class PlainVise(Toolkit):
    """A vise with two flat, parallel jaws: the part stands on parallels and is held by friction.

    The fixed jaw stands along x at y = 0, the part above it on a hull edge, a straight piece of the boundary
    of the part's convex hull. The moving jaw closes along -y. Each hull edge, work stop and height of
    parallels makes one fixture.

    Parameters
    ----------
    jaw_width : width of both jaws in mm.
    jaw_height : height of the jaws above the vise's bed in mm; None for any height.
    max_opening : the largest distance between the jaws in mm, or None for no limit.
    parallels : heights in mm of the parallels that can be used; empty where the part lies on the bed.
    stop : "left", "right" or "both": the ends of the jaws at which a work stop can be; None without one.
    stop_offset : distance in mm, inward from the end of the jaws, at which the stop touches the part.
    least_grip : the least height in mm that both jaws must grip.
    max_force : rated clamping force in N; None where not known.
    jaw_thickness : how thick the jaws are, for the tools of a program, in mm; None for any thickness.
    screw_lead : how far a turn of the screw moves the jaw, in mm; None where not known.
    parallel_thickness : of each parallel in mm, for the tools of a program; None for 8 mm.
    stop_width : of the work stop across the jaws in mm, for the tools of a program; None for 7 % of the jaws'
        width.
    supports, top_clamp, pins, tolerance : fields of every toolkit, which flat jaws do not need.

    Raises
    ------
    InputError
        For values that are not finite and positive, and jaws that stand no higher than any of the parallels.

    Examples
    --------
    >>> from workhold import PlainVise
    >>> PlainVise(jaw_width=152, jaw_height=44, parallels=[32, 20]).parallels
    (20.0, 32.0)
    """

    kind = "plain-vise"
    table = FieldTable(
        "plain vise",
        "A vise with two flat jaws",
        (
            fields.JAW_WIDTH.relabel(
                PageLabel("Width of the jaws", is_usual=True),
                help="How wide the flat jaws are.",
                default=REQUIRED,
                unset="",
                lifted=None,
                missing="width of its jaws",
            ),
            fields.JAW_HEIGHT,
            fields.MAX_OPENING.relabel(
                PageLabel("Largest opening", "no limit", is_usual=True), at_least="", below=""
            ),
            fields.PARALLELS,
            fields.STOP,
            fields.STOP_OFFSET,
            fields.LEAST_GRIP,
            fields.MAX_FORCE,
            fields.JAW_THICKNESS,
            fields.SCREW_LEAD,
            fields.PARALLEL_THICKNESS,
            fields.STOP_WIDTH,
        ),
    )
    noun = "plain vise"
    locked = "a screw vise, its jaw"
    law = "fence"
    arrangements = (Arrangement("plain", (0, 0)),)
    wording = ToolkitWording(
        two="flat jaws",
        four="two flat jaws",
        inside="in this vise",
        within="the jaws as asked: with the width, height, opening and parallels given",
        rules="is pressed by both jaws",
        backwards="the jaws are pressed apart, not when they close",
        holes="holes that the jaws do not have",
        sets="sides of the part, parallels and stops",
        clear="vise clear of the program",
        reasons=(
            "The part cannot lie flush against the fixed jaw: no straight piece of its convex hull is there to lie "
            "on it, or none at an angle and on faces that are allowed.",
            "No jaw can grip the part high enough: the jaws do not reach far enough above the parallels.",
            "What both jaws touch does not lie opposite: as they close the part turns away.",
            "The part is wider than the jaws open, or a jaw touches what is to be avoided.",
        ),
    )
    setup_words = SetupWords(
        standing="Jaws",
        located_by="The fixed jaw",
        put="Put the part on the parallels, {holes} against the fixed jaw.",
        against="flush against the fixed jaw",
        touching="flush",
        resting="flush against the fixed jaw",
    )
    page = PageWords(
        "Plain vise, two flat jaws and parallels",
        "Close vise",
        {
            fields.JAW_WIDTH.name: 152.0,
            fields.JAW_HEIGHT.name: 44.0,
            fields.MAX_OPENING.name: 150.0,
            fields.PARALLELS.name: [20.0, 25.0, 32.0],
        },
    )

    jaw_width: float
    jaw_height: float | None
    max_opening: float | None
    parallels: tuple[float, ...]
    stop: str | None
    stop_offset: float
    least_grip: float
    max_force: float | None
    jaw_thickness: float | None
    screw_lead: float | None
    parallel_thickness: float | None
    stop_width: float | None

    if TYPE_CHECKING:
        # As the table makes it, for editors and mypy; a test compares the two.
        def __init__(
            self,
            jaw_width: float,
            jaw_height: float | None = None,
            max_opening: float | None = None,
            parallels: float | Iterable[float] | None = (),
            stop: str | None = None,
            stop_offset: float = 0.0,
            least_grip: float = 3.0,
            max_force: float | None = None,
            jaw_thickness: float | None = None,
            screw_lead: float | None = None,
            *,
            parallel_thickness: float | None = None,
            stop_width: float | None = None,
            supports: Any = None,
            top_clamp: Any = None,
            pins: Any = None,
            tolerance: Any = None,
        ) -> None: ...

    def __attrs_post_init__(self) -> None:
        refuse_all_out_of_bounds(self)
        lowest = min(self.parallels, default=0.0)
        if self.jaw_height is not None and self.jaw_height <= lowest:
            raise InputError(
                f"jaws {self.jaw_height:g} mm high do not reach above parallels of {lowest:g} mm: give lower ones, "
                "or how high the jaws stand above the bed."
            )

    @cached_property
    def flat_jaws(self) -> JawPair:
        """The two flat jaws, with the vise's dimensions and ratings."""
        return JawPair(
            width=self.jaw_width,
            height=self.jaw_height,
            thickness=self.jaw_thickness,
            max_opening=getattr(self, fields.MAX_OPENING.name),
            parallels=self.parallels or (0.0,),
            least_grip=self.least_grip,
            stops=("left", "right") if self.stop == "both" else (self.stop,),
            stop_offset=self.stop_offset,
            max_force=self.max_force,
            screw_lead=self.screw_lead,
            parallel_thickness=self.parallel_thickness,
            stop_width=STOP_SHARE * self.jaw_width if self.stop_width is None else self.stop_width,
        )

    @cached_property
    def carriers(self) -> tuple[Carrier, ...]:
        """The fixed jaw, and the jaw that moves."""
        travel = Travel(pi / 2, 0.0, getattr(self, fields.MAX_OPENING.name))
        size = (1.0, 1.0), None, None, 0.0, 0.0
        fixed = Carrier("fixed jaw", *size, noun="jaw", width=self.jaw_width, is_jaw=True)
        return fixed, Carrier(
            "moving jaw", *size, travel=travel, noun="jaw", width=self.jaw_width, is_jaw=True
        )

    @property
    def heights(self) -> dict[str, Heights]:
        """For each height of parallels, the heights in mm that the jaws cover: (0, top) above the part's
        lower side.

        The keys are the roles of ``JawPair.name_outline_role``. Jaws of any height, and jaws not above the
        parallels, are left out.
        """
        jaws = self.flat_jaws
        tops = {one: jaws.compute_top(one) for one in jaws.parallels}
        return {jaws.name_outline_role(one): (0.0, top) for one, top in tops.items() if 0.0 < top < inf}

    @property
    def datum(self) -> Datum:
        """The origin of places: the left end of the fixed jaw's face, at the height of the parallels' top."""
        name = "the left end of the fixed jaw"
        return Datum(
            name=name,
            point=name,
            full=name,
            mark="(0, 0)",
            x="the left end of the jaws",
            y="the fixed jaw",
            lines=("the left end of the jaws", "the fixed jaw"),
            rows_from="the fixed jaw",
            substitute=name,
        )

    @property
    def is_in_inches(self) -> bool:
        """Whether the jaw width is a multiple of an eighth of an inch, and not of half a millimetre."""
        eighths, halves = self.jaw_width / 3.175, self.jaw_width / 0.5
        return abs(eighths - round(eighths)) < 1e-9 < abs(halves - round(halves))

    def list_further_changes(self, unit: Unit) -> Iterator[ToolkitChange]:
        """Yield changes of the parallels and of the work stop that a workshop can make at once.

        With parallels: none, half as high as the lowest, as high as the jaws allow, and thin ones. With a
        work stop: at the other end, and none.
        """
        if self.parallels:
            yield ToolkitChange("without parallels, on the bed", {fields.PARALLELS.name: ()})
            lower = min(self.parallels) / 2
            yield ToolkitChange(
                f"on parallels of {unit.format_length(lower)}", {fields.PARALLELS.name: (lower,)}
            )
            thin = {fields.PARALLEL_THICKNESS.name: THIN_PARALLEL}
            if self.parallel_thickness is None or self.parallel_thickness > THIN_PARALLEL:
                yield ToolkitChange(f"with parallels {unit.format_length(THIN_PARALLEL)} thick", thin)
        highest = 0.0 if self.jaw_height is None else self.jaw_height - self.least_grip
        if highest > max(self.parallels, default=0.0):
            yield ToolkitChange(
                f"on parallels of {unit.format_length(highest)}", {fields.PARALLELS.name: (highest,)}
            )
        if self.stop in ("left", "right"):
            other = "right" if self.stop == "left" else "left"
            yield ToolkitChange(f"with the work stop at the {other} end", {fields.STOP.name: other})
        if self.stop is not None:
            yield ToolkitChange("without a work stop", {fields.STOP.name: None})
