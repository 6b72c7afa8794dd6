"""The seating of a fixture: seats, the pass, the cage, and the figures that follow from them."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, isfinite
from typing import Any

from attrs import evolve, frozen

from workhold.fixels.toolkit import Toolkit
from workhold.model.pose import Pose

__all__ = [
    "CAGE_SHORT",
    "CLOSE_READING",
    "DECIMALS",
    "DRY_STEEL",
    "SMALL_CAPTURE",
    "Cage",
    "CagePass",
    "Seat",
    "SeatContact",
    "Seating",
]

# Of lengths in mm, angles in degrees and forces in files.
DECIMALS = 9
# Limits of warnings (docs/quality.md, "With seating"). mm: jaws are opened by hand to about a millimetre, and
# a part is put down with about the room that this gives at each peg.
SMALL_CAPTURE = 1.0
# mm: each of two readings of a caliper is off by up to 0.03, and tolerances of 0.01 at four contacts move it
# as much.
CLOSE_READING = 0.1
# The coefficient of friction that dry steel reaches.
DRY_STEEL = 0.2
# mm: less is none as it is written.
SAME_READING = 5e-4
# What is done so that a part can be put in, of jaws that clamp by closing (1) and by opening (-1), and of a
# clamp.
JAWS = {1: "the jaws are opened", -1: "the jaws are closed"}
CLAMP = "the clamp is drawn back"
# By how much the extremes of a cage may fall short at most: in degrees of turns, of shifts this part of their
# range.
CAGE_SHORT = {"theta_deg": 0.5, "share": 0.01}
# A written seat is the fixture's own when pose, in degrees and mm, and separation agree to this.
IS_OWN = 1e-5


@frozen
class SeatContact:
    """A peg on a face or on a corner of the part.

    Parameters
    ----------
    peg : index of the peg in the fixture's pegs.
    face : number of the face, or of the face that begins at the corner.
    corner : whether the peg touches the corner at which ``face`` begins.
    """

    peg: int
    face: int
    corner: bool

    @property
    def words(self) -> str:
        """Words for the face or corner that the peg touches, such as "face 3"."""
        return f"corner {self.face}" if self.corner else f"face {self.face}"

    def to_fields(self) -> dict[str, int]:
        """Return the contact as result files have it:
        "peg" (index from 0), and "corner" or "face" with the number.
        """
        return {"peg": self.peg, "corner" if self.corner else "face": self.face}

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any]) -> SeatContact:
        """Return the contact that a result file has, the inverse of :meth:`to_fields`."""
        corner = fields.get("corner")
        return cls(fields["peg"], fields["face"] if corner is None else corner, corner is not None)


@frozen
class Seat:
    """An equilibrium in which the part can come to rest when the vise closes.

    Parameters
    ----------
    kind : fixture, corner, pocket, curved, loose, or unsettled.
    pose : pose of the part; if ``mirrored``, of the part turned over (x to -x in its own frame).
    jaw_separation : jaw separation S in mm; for a clamp, its travel.
    difference : ``jaw_separation`` minus that of the fixture, in mm.
    mirrored, same_place : whether the part is turned over, and whether it covers the same area as in the
        fixture.
    contacts, forces : contacts, and for each its force per unit of jaw force; empty for kinds loose and
        unsettled.
    depth : opening in mm beyond which the part can leave this seat for another; None if it never can, or if
        that is unknown.
    is_own : whether the seat is the fixture's own pose.
    """

    kind: str
    pose: Pose
    jaw_separation: float
    difference: float
    mirrored: bool
    same_place: bool
    contacts: tuple[SeatContact, ...]
    forces: tuple[float, ...]
    depth: float | None
    is_own: bool

    @property
    def is_wrong(self) -> bool:
        """Whether the part lies elsewhere than in the fixture: in neither its own seat nor one that covers
        the same area.
        """
        return not (self.is_own or self.same_place)

    def to_fields(self) -> dict[str, Any]:
        """Return the seat as result files have it;
        lengths in mm and angles in degrees, rounded, None for inf.
        """
        return {
            "kind": self.kind,
            "pose": list_pose_fields(self.pose),
            "jaw_separation": round_length(self.jaw_separation),
            "difference": round_length(self.difference),
            "mirrored": self.mirrored,
            "same_place": self.same_place,
            "contacts": [contact.to_fields() for contact in self.contacts],
            "forces": [round_length(force) for force in self.forces],
            "depth": round_length(self.depth),
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any]) -> Seat:
        """Return the seat that a result file has, with ``is_own`` False, which the fixture has to decide."""
        return cls(
            fields["kind"],
            Pose(**fields["pose"]),
            fields["jaw_separation"],
            fields["difference"],
            fields["mirrored"],
            fields["same_place"],
            tuple(map(SeatContact.from_fields, fields["contacts"])),
            tuple(fields["forces"]),
            fields["depth"],
            False,
        )

    def is_at(self, pose: Pose) -> bool:
        """Return whether the seat is the fixture's own:
        settled, not mirrored, in this pose and at no difference of opening.
        """
        turn = abs((self.pose.theta_deg - pose.theta_deg + 180.0) % 360.0 - 180.0)
        away = max(turn, abs(self.pose.x - pose.x), abs(self.pose.y - pose.y), abs(self.difference))
        return not self.mirrored and self.kind != "unsettled" and away < IS_OWN


@frozen
class CagePass:
    """The equilibrium through which a part gets out of its cage first.

    Parameters
    ----------
    pose, jaw_separation, contacts : pose of the part, separation in mm, and contacts at this equilibrium.
    """

    pose: Pose
    jaw_separation: float
    contacts: tuple[SeatContact, ...]


@frozen
class Cage:
    """Range in which a part can lie and still settle in its place, with the jaws open by less than the
    capture opening.

    Parameters
    ----------
    theta_deg, x, y : (least, largest) turn in degrees, and shift of the centre of its box in mm. The ranges
        are never too large; they are too small by at most ``CAGE_SHORT``.
    """

    theta_deg: tuple[float, float]
    x: tuple[float, float]
    y: tuple[float, float]


@frozen(repr=False)
class Seating:
    """The seats of a part on the pegs of a fixture, and the region from which closing leads into the
    fixture's own seat.

    Parameters
    ----------
    capture_opening : largest opening of the jaws in mm from which a part in the cage still settles in its
        place; None if it never gets out.
    room_factor : sum of the contact forces per unit of jaw force: jaws opened by s mm leave a gap of s /
        room_factor at all pegs at once.
    lowest_pass : pass through which the part first gets out of the cage; None if it never does.
    way_out : opening in mm beyond which the part can leave all pegs; None if it never can.
    cage, placing : ranges of the part's distance from its place; None if the cage is unbounded.
    sticking_friction : coefficient of friction below which the part cannot stick near its seat.
    stop : the separation in mm at which the vise is closed, or opened, without the part; None where nothing
        stops it.
    seats : all seats in order of separation, the fixture's own included.
    unsettled : cases that could not be settled and why, one sentence each.
    opening, most : limits on the seats that count: reached with the jaws opened by less than ``opening`` and
        at a separation up to ``most``, both in mm; None for no limit.
    clamping : 1 where the separation decreases as the toolkit clamps, -1 where it increases.
    opened : clause on how to make room for the part, such as "the jaws are opened".
    """

    capture_opening: float | None
    room_factor: float
    lowest_pass: CagePass | None
    way_out: float | None
    cage: Cage | None
    placing: float | None
    sticking_friction: float
    stop: float | None
    seats: tuple[Seat, ...]
    unsettled: tuple[str, ...] = ()
    opening: float | None = None
    most: float | None = None
    clamping: int = 1
    opened: str = JAWS[1]

    @property
    def words(self) -> str:
        """Phrase with the allowed opening of the jaws and the number of wrong seats."""
        caught = (
            "never lost" if self.capture_opening is None else f"caught below {self.capture_opening:.3f} mm"
        )
        caught = "it is not known how far you may open" if self.is_capture_unknown else caught
        wrong = len(self.list_wrong_seats())
        return f"{caught}, {wrong:,} wrong seat{'s' * (wrong != 1)}"

    def __repr__(self) -> str:
        return f"<Seating: {self.words}>"

    def _repr_html_(self) -> str:
        from workhold.presenting.notebook import render_seating_html

        return render_seating_html(self)

    def with_toolkit(self, toolkit: Toolkit, opening: float | None = None) -> Seating:
        """Return a copy with ``most``, ``clamping`` and ``opened`` of the toolkit, and with ``opening`` in mm
        as given.
        """
        travel, sign = toolkit.moving.travel, toolkit.clamping
        most, opened = (
            None if travel is None else travel.most,
            JAWS[sign] if toolkit.moving.on is None else CLAMP,
        )
        return evolve(self, opening=opening, most=most, clamping=sign, opened=opened)

    @property
    def is_capture_unknown(self) -> bool:
        """Whether the cage could not be computed, so that the capture opening is unknown."""
        return self.lowest_pass is None and self.capture_opening is not None

    @property
    def drop_room(self) -> float | None:
        """Gap in mm at every peg, to first order, with the jaws open by the capture opening; None where that
        is None.
        """
        return None if self.capture_opening is None else self.capture_opening / self.room_factor

    def list_wrong_seats(self, opening: float | None = None) -> list[Seat]:
        """Return the wrong seats that can be reached within an opening and the toolkit's largest separation.

        Parameters
        ----------
        opening : how far the jaws are opened, in mm; :attr:`opening` if None.
        """
        reach = self.opening if opening is None else opening
        wrong = [seat for seat in self.seats if seat.is_wrong]
        if reach is not None:
            wrong = [seat for seat in wrong if self.clamping * seat.difference < reach]
        return [seat for seat in wrong if self.most is None or seat.jaw_separation <= self.most]

    def find_least_reading(self, opening: float | None = None) -> float | None:
        """Return the least difference in mm between the fixture's opening and that of a wrong seat.

        Return None if there is no wrong seat.
        """
        return min((abs(seat.difference) for seat in self.list_wrong_seats(opening)), default=None)

    def is_caught_from(self, opening: float) -> bool:
        """Return whether the part, let go anywhere in its cage with the jaws open by ``opening`` mm, settles
        in its place.
        """
        return self.capture_opening is None or opening < self.capture_opening

    @property
    def is_foolproof(self) -> bool:
        """Whether a caliper reading of the opening tells each wrong seat within reach from the fixture."""
        reading = self.find_least_reading()
        return reading is None or round(reading, DECIMALS) >= CLOSE_READING

    @property
    def is_hardly_caught(self) -> bool:
        """Whether the capture opening is known and smaller than :data:`SMALL_CAPTURE`."""
        return self.capture_opening is not None and round(self.capture_opening, DECIMALS) < SMALL_CAPTURE

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings as sentences without a capital and full stop; lengths in mm."""
        out, reading = list[str](), self.find_least_reading()
        if self.is_capture_unknown:
            out.append("it is not known how far you may open without losing the part")
        elif self.is_hardly_caught:
            out.append(
                f"the part is caught only while {self.opened} by less than {self.capture_opening:.3f} mm"
            )
        if reading is not None and round(reading, DECIMALS) < CLOSE_READING:
            words = f"only {reading:.3f} mm differently, which a caliper hardly shows"
            out.append(f"a wrong seat reads {'the same' if reading < SAME_READING else words}")
        return tuple(out)

    @property
    def warning_count(self) -> int:
        """Number of warnings by the seating, to be added to the warnings by the figures of quality.

        A small capture opening counts for two, because a part let go in its cage needs no reading.
        """
        return len(self.warnings) + self.is_hardly_caught

    @property
    def figures(self) -> dict[str, float]:
        """Figures of ``model.quality.SEATING_FIGURES`` by key; inf if one has no bound."""
        known = {
            "capture_opening": self.capture_opening,
            "drop_room": self.drop_room,
            "way_out": self.way_out,
            "placing": 0.0 if self.is_capture_unknown else self.placing,
            "sticking_friction": self.sticking_friction,
            "wrong_seats": float(len(self.list_wrong_seats())),
            "reading": self.find_least_reading(),
        }
        return {name: inf if value is None else value for name, value in known.items()}

    def to_fields(self) -> dict[str, Any]:
        """Return the seating as a result file has it:
        lengths in mm, angles in degrees, rounded, None for inf.
        """
        top, opening = self.lowest_pass, round_length(self.capture_opening)
        # Of numbers as they are written, so that reading and writing changes nothing.
        factor = round(self.room_factor, DECIMALS)
        return {
            "capture_opening": opening,
            "drop_room": None if opening is None else round_length(opening / factor),
            "room_factor": factor,
            "pass": None
            if top is None
            else {
                "pose": list_pose_fields(top.pose),
                "jaw_separation": round_length(top.jaw_separation),
                "contacts": [contact.to_fields() for contact in top.contacts],
            },
            "way_out": round_length(self.way_out),
            "cage": None
            if self.cage is None
            else {
                name: [round_length(end) for end in getattr(self.cage, name)]
                for name in ("theta_deg", "x", "y")
            },
            "cage_short": None if self.cage is None else dict(CAGE_SHORT),
            "placing": round_length(self.placing),
            "sticking_friction": round_length(self.sticking_friction),
            "stop": round_length(self.stop),
            "seats": [seat.to_fields() for seat in self.seats],
            "wrong_seats": len(self.list_wrong_seats()),
            "reading": round_length(self.find_least_reading()),
            "unsettled": list(self.unsettled),
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], pose: Pose) -> Seating:
        """Return the seating that a result file has for a fixture in this pose;
        derived fields of the file are not read.
        """
        top, cage = fields["pass"], fields["cage"]
        seats = [Seat.from_fields(seat) for seat in fields["seats"]]
        lowest = None
        if top is not None:
            lowest = CagePass(
                Pose(**top["pose"]),
                top["jaw_separation"],
                tuple(map(SeatContact.from_fields, top["contacts"])),
            )
        friction = fields["sticking_friction"]
        return cls(
            fields["capture_opening"],
            fields["room_factor"],
            lowest,
            fields["way_out"],
            None if cage is None else Cage(*(tuple(cage[name]) for name in ("theta_deg", "x", "y"))),
            fields["placing"],
            inf if friction is None else friction,
            fields["stop"],
            tuple(evolve(seat, is_own=seat.is_at(pose)) for seat in seats),
            tuple(fields["unsettled"]),
        )


def round_length(value: float | None) -> float | None:
    """Return a number rounded as files have it; None for None, inf and NaN."""
    return None if value is None or not isfinite(value) else round(value, DECIMALS) + 0.0


def list_pose_fields(pose: Pose) -> dict[str, float | None]:
    """Return a pose as result files have it: "theta_deg" in degrees, "x" and "y" in mm, rounded."""
    return {"theta_deg": round_length(pose.theta_deg), "x": round_length(pose.x), "y": round_length(pose.y)}
