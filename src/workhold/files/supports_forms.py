"""The form of a file of supports, checked by pydantic, and its parts as objects of the model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from attrs import define, field, frozen
from pydantic import Field, ValidationError

from workhold.errors import InputError
from workhold.files.budget import LIMITS
from workhold.files.input_forms import LONGEST_NAME
from workhold.files.result.forms import FormPart
from workhold.files.text import parse_json, read_text
from workhold.model.requirements import ANY_DIRECTION, Zone, circle_zone, make_zone, polygon_zone
from workhold.model.support_request import SpatialLoad, SupportRequest, compute_usual_head

__all__ = ["FORMAT", "ReadFigures", "ReadTriple", "SupportsPart", "read_supports_part"]

FORMAT = "workhold-supports/1"
# As many triples as are listed at most, 150,000, take ten lists and objects each, and 32 values.
TIMES = 2.5
Two = Annotated[list[float], Field(min_length=2, max_length=2)]
Ring = Annotated[list[float], Field(min_length=4, max_length=4)]
Loop = list[Annotated[list[float], Field(min_length=3, max_length=3)]]
# Written as a list, which a strict form does not take for a tuple.
Hole = Annotated[tuple[str, int, int], Field(strict=False)]


class ZonePart(FormPart):
    """A keep-out zone: a circle (x, y, radius), a polygon, or a loop with arcs; lengths in mm."""

    circle: Annotated[list[float], Field(min_length=3, max_length=3)] | None = None
    polygon: list[Two] | None = None
    loop: Loop | None = None

    def to_zone(self) -> Zone:
        """Return the zone; raise InputError for a form that describes no zone."""
        if self.circle is not None:
            return circle_zone(*self.circle)
        if self.polygon is not None:
            return polygon_zone(self.polygon)
        return make_zone(self.loop or [])


class HeightsPart(FormPart):
    """Thickness of the part and band of the pegs, in mm."""

    thickness: float
    band: Two


class PadsPart(FormPart):
    """The supports' pads, and their allowed places."""

    pad_radius: float
    pad_margin: float = 0.0
    bottom: list[Loop] | None = None
    zones: list[ZonePart] = Field(default_factory=list)


class TipPart(FormPart):
    """The clamp on top, and its allowed places."""

    tip_radius: float
    inside: float | None = None
    top: list[Loop] | None = None
    top_heights: list[float] | None = None
    tip_margin: float = 0.0
    head_radius: float | None = None
    rising: list[Loop] = Field(default_factory=list)
    rising_heights: list[float] = Field(default_factory=list)
    hanging: list[Loop] = Field(default_factory=list)
    hanging_heights: list[float] = Field(default_factory=list)
    zones: list[ZonePart] = Field(default_factory=list)
    reach: list[Ring] | None = None
    point: Two | None = None


class SpatialLoadPart(FormPart):
    """A load in space, as :class:`SpatialLoad`."""

    name: str = Field("", max_length=LONGEST_NAME)
    points: list[Two] = Field(default_factory=list)
    force: float = 0.0
    directions: Two = Field(default_factory=lambda: list(ANY_DIRECTION))
    heights: Two | None = None
    axial: Two = Field(default_factory=lambda: [0.0, 0.0])
    moment: float = 0.0
    tilt: Two = Field(default_factory=lambda: [0.0, 0.0])

    def to_load(self, thickness: float) -> SpatialLoad:
        """Return the load, with heights that are not given filled in for a part of a thickness in mm; raise
        InputError for an impossible load.
        """
        return SpatialLoad(**dict(self)).with_height(thickness)


class ClampFiguresPart(FormPart):
    """The figures at one point of the clamp."""

    at: Two | None = None
    clamp_needed: float
    support_force: float | None = None
    arm: float
    share: float
    lift: float
    hangs: bool = False


class TriplePart(FormPart):
    """Three supports."""

    holes: Annotated[list[Hole], Field(min_length=3, max_length=3)]
    jaw_separation: float | None = None
    marginal: bool = False
    standing: float
    overhang: float | None = None
    arm: float
    arm_at: Two
    best: ClampFiguresPart
    given: ClampFiguresPart | None = None


@frozen
class ReadTriple:
    """Three supports of a file: the content of a ``TriplePart`` in a quarter of its memory."""

    holes: tuple[tuple[str, int, int], ...]
    jaw_separation: float | None
    marginal: bool
    standing: float
    overhang: float | None
    arm: float
    arm_at: tuple[float, float]
    best: ReadFigures
    given: ReadFigures | None


@frozen
class ReadFigures:
    """The figures at one point of the clamp, as ``ClampFiguresPart``."""

    at: tuple[float, float] | None
    clamp_needed: float
    support_force: float | None
    arm: float
    share: float
    lift: float
    hangs: bool

    @classmethod
    def from_part(cls, part: ClampFiguresPart) -> ReadFigures:
        """Make the figures at one point of the clamp from their checked form."""
        at = None if part.at is None else (part.at[0], part.at[1])
        return cls(at, part.clamp_needed, part.support_force, part.arm, part.share, part.lift, part.hangs)


@define(eq=False)
class TripleReader:
    """A hook that checks triples and makes them small one by one, while the JSON is parsed.

    Parameters
    ----------
    count : number of triples read.
    holes : cache of holes, because many triples share them.
    """

    count: int = 0
    holes: dict[tuple[str, int, int], tuple[str, int, int]] = field(factory=dict)

    def read(self, entry: dict[str, Any]) -> Any:
        """Return the triple that a JSON object of the file describes; an object that is not a triple is returned
        unchanged.
        """
        return self.read_triple(entry) if entry.keys() >= {"holes", "standing"} else entry

    def read_triple(self, entry: Any) -> ReadTriple:
        """Return a triple from its JSON object; raise pydantic's ValidationError for an object that is not a
        triple.
        """
        part = TriplePart.model_validate(entry)
        self.count += 1
        return ReadTriple(
            tuple(self.holes.setdefault(hole, hole) for hole in part.holes),
            part.jaw_separation,
            part.marginal,
            part.standing,
            part.overhang,
            part.arm,
            (part.arm_at[0], part.arm_at[1]),
            ReadFigures.from_part(part.best),
            None if part.given is None else ReadFigures.from_part(part.given),
        )


class CountsPart(FormPart):
    """Number of holes and of triples."""

    positions: Annotated[int, Field(ge=0)]
    triples: Annotated[int, Field(ge=0)] | None = None


class SupportsPart(FormPart):
    """The whole file; workpiece, toolkit and fixture are read as those of a result."""

    format: Literal["workhold-supports/1"]
    solid: dict[str, Any] | None = None
    workpiece: dict[str, Any]
    outlines: dict[str, Any] | None = None
    vise: dict[str, Any] | None = None
    toolkit: dict[str, Any] | None = None
    fixture: dict[str, Any]
    heights: HeightsPart
    supports: PadsPart
    clamp: TipPart
    loads: list[SpatialLoadPart] = Field(default_factory=list)
    jaw_force: Annotated[float, Field(ge=0)]
    complete: bool = True
    counts: CountsPart
    # They are checked one by one, see ``TripleReader``.
    triples: list[Any]

    def to_head(self) -> dict[str, Any]:
        """Return the JSON object of a result file without fixtures for the same part and toolkit."""
        toolkit = {"vise": self.vise} if self.vise is not None else {"toolkit": self.toolkit}
        space = {"solid": self.solid, "outlines": self.outlines}
        known = {name: value for name, value in space.items() if value is not None}
        return {
            "format": "workhold-result/1",
            "workpiece": self.workpiece,
            **known,
            **toolkit,
            "counts": {},
        }

    def to_request(self) -> SupportRequest:
        """Return the request for supports.

        Raises
        ------
        InputError
            When one of its values is impossible.
        """
        pads, tip = self.supports, self.clamp
        walls = self.fixture.get("wall", {}).get("bands", []) if "wall" in self.fixture else []
        pegs = [peg.get("band") for peg in self.fixture.get("pegs", ()) if isinstance(peg, dict)]
        # The ends of a wall stand behind what stands still in holes.
        first = sum(peg.get("role") != "jaw" for peg in self.fixture.get("pegs", ())[:1])
        ends = [*walls, None, None][:2] if "wall" in self.fixture else []
        bands = [*pegs[:first], *ends, *pegs[first:]]
        low, high = self.heights.band
        return SupportRequest(
            self.heights.thickness,
            pads.pad_radius,
            tip.tip_radius,
            band=(low, high),
            bands=tuple(None if one is None else (one[0], one[1]) for one in bands) if any(bands) else None,
            pad_margin=pads.pad_margin,
            bottom=read_face_loops(pads.bottom),
            top=read_face_loops(tip.top),
            top_heights=tip.top_heights,
            bottom_zones=tuple(one.to_zone() for one in pads.zones),
            top_zones=tuple(one.to_zone() for one in tip.zones),
            inside=tip.tip_radius if tip.inside is None else tip.inside,
            reach=tip.reach,
            point=tip.point,
            tip_margin=tip.tip_margin,
            head_radius=compute_usual_head(tip.tip_radius) if tip.head_radius is None else tip.head_radius,
            rising=tip.rising,
            rising_heights=tip.rising_heights,
            hanging=tip.hanging,
            hanging_heights=tip.hanging_heights,
        )


def read_face_loops(loops: list[Loop] | None) -> list[Loop] | None:
    """Return the loops of a face as the model has them: [] for a face that does
    not exist, None if the file does not give the face.
    """
    return None if loops is None else [loop for loop in loops if loop]


def read_supports_part(path: Path) -> SupportsPart:
    """Return the content of a file of supports, its form checked.

    Raises
    ------
    InputError
        When it cannot be read, or is no such file.
    """
    reader, place = TripleReader(), ""
    try:
        place = "triples"
        content = parse_json(read_text(path, LIMITS["supports"]), reader.read, TIMES)
        place = ""
        part = SupportsPart.model_validate(content)
        place, reader.count = "triples", 0
        # What lacks the keys of a triple was passed over.
        for number, one in enumerate(part.triples):
            if not isinstance(one, ReadTriple):
                reader.count = number
                reader.read_triple(one)
        return part
    except InputError as error:
        raise InputError(f"{path} is not a file of supports: {error}") from error
    except ValidationError as error:
        fault = error.errors()[0]
        key = ".".join(map(str, (place, reader.count, *fault["loc"]) if place else fault["loc"]))
        raise InputError(
            f"{path} is not a complete file of supports: {key} cannot be used: {fault['msg'].lower()}."
        ) from error
