"""What is told of a fixture's seating: seats, the pass, the cage, and the figures that follow from them."""

from __future__ import annotations

from math import isfinite
from typing import Any

from attrs import frozen

from workhold.model.fixture import Pose

__all__ = ["Cage", "Contact", "Pass", "Seat", "Seating"]

# Of lengths in mm, angles in degrees and forces in files.
DECIMALS = 9


@frozen
class Contact:
    """A peg on a face or on a corner of the part.

    Parameters
    ----------
    peg : its place in the fixture's pegs.
    face : number of the face, or of the face that begins at the corner.
    corner : whether it is the corner.
    """

    peg: int
    face: int
    corner: bool

    @property
    def words(self) -> str:
        """What the peg touches, in words."""
        return f"corner {self.face}" if self.corner else f"face {self.face}"

    def as_fields(self) -> dict[str, int]:
        """The contact as files have it; pegs count from 0."""
        return {"peg": self.peg, "corner" if self.corner else "face": self.face}


@frozen
class Seat:
    """Where closing the vise comes to rest.

    Parameters
    ----------
    kind : fixture, corner, pocket, curved, loose, or unsettled.
    pose : of the part, turned over (x to -x in its own frame) where it is ``mirrored``.
    jaw_separation : S in mm.
    difference : S less that of the fixture.
    mirrored, same_place : whether the part is turned over, and whether it covers the fixture's place all the same.
    contacts, forces : what touches, and each force per unit of jaw force; none of what is loose or not settled.
    depth : how far in mm the jaws open before the part can get elsewhere; None where it never can, or that was not asked.
    is_own : whether it is the fixture's own.
    """

    kind: str
    pose: Pose
    jaw_separation: float
    difference: float
    mirrored: bool
    same_place: bool
    contacts: tuple[Contact, ...]
    forces: tuple[float, ...]
    depth: float | None
    is_own: bool

    @property
    def is_wrong(self) -> bool:
        """Whether the part in it lies elsewhere."""
        return not (self.is_own or self.same_place)

    def as_fields(self) -> dict[str, Any]:
        """The seat as files have it."""
        return {
            "kind": self.kind,
            "pose": pose_fields(self.pose),
            "jaw_separation": length(self.jaw_separation),
            "difference": length(self.difference),
            "mirrored": self.mirrored,
            "same_place": self.same_place,
            "contacts": [contact.as_fields() for contact in self.contacts],
            "forces": [length(force) for force in self.forces],
            "depth": length(self.depth),
        }


@frozen
class Pass:
    """The equilibrium through which a part gets out of its cage first.

    Parameters
    ----------
    pose, jaw_separation, contacts : there.
    """

    pose: Pose
    jaw_separation: float
    contacts: tuple[Contact, ...]


@frozen
class Cage:
    """How far a part may lie off its pose, jaws open by less than the capture opening, and still come home.

    Parameters
    ----------
    theta_deg, x, y : least and largest turn in degrees, and shift of the centre of its box in mm.
    """

    theta_deg: tuple[float, float]
    x: tuple[float, float]
    y: tuple[float, float]


@frozen
class Seating:
    """What a fixture's pegs can do with its part besides holding it in its pose.

    Parameters
    ----------
    capture_opening : in mm, how far the jaws may be open when the part is let go in the cage; None where it never gets out.
    room_factor : sum of the forces: opening by s gives s over this of room at every peg at once.
    lowest_pass : at which the cage ends; None where it does not.
    way_out : in mm, how far the jaws open before the part can leave all pegs; None where it never can.
    cage, placing : how far the part may be off; None where the cage has no end.
    sticking_friction : the coefficient below which it cannot stick near its seat.
    stop : the smallest jaw separation in mm.
    seats : all, by their separations, the fixture's own among them.
    unsettled : why what was not settled was not, one sentence each.
    """

    capture_opening: float | None
    room_factor: float
    lowest_pass: Pass | None
    way_out: float | None
    cage: Cage | None
    placing: float | None
    sticking_friction: float
    stop: float
    seats: tuple[Seat, ...]
    unsettled: tuple[str, ...] = ()

    @property
    def drop_room(self) -> float | None:
        """Room in mm at every peg when the jaws are open by the capture opening, to first order."""
        return None if self.capture_opening is None else self.capture_opening / self.room_factor

    def wrong_within(self, opening: float | None = None, most: float | None = None) -> list[Seat]:
        """The seats in which the part lies elsewhere and that can be reached.

        Parameters
        ----------
        opening : how far the jaws are opened, in mm; as far as they go if None.
        most : the largest jaw separation; without end if None.
        """
        wrong = [seat for seat in self.seats if seat.is_wrong]
        if opening is not None:
            wrong = [seat for seat in wrong if seat.difference < opening]
        return [seat for seat in wrong if most is None or seat.jaw_separation <= most]

    def reading_of(self, opening: float | None = None, most: float | None = None) -> float | None:
        """What a measurement of the opening must resolve to tell wrong seats, in mm; None where there are none."""
        return min((abs(seat.difference) for seat in self.wrong_within(opening, most)), default=None)

    def as_fields(self) -> dict[str, Any]:
        """The seating as a result file has it: lengths in mm, angles in degrees."""
        top = self.lowest_pass
        return {
            "capture_opening": length(self.capture_opening),
            "drop_room": length(self.drop_room),
            "room_factor": length(self.room_factor),
            "pass": None
            if top is None
            else {
                "pose": pose_fields(top.pose),
                "jaw_separation": length(top.jaw_separation),
                "contacts": [contact.as_fields() for contact in top.contacts],
            },
            "way_out": length(self.way_out),
            "cage": None
            if self.cage is None
            else {name: [length(end) for end in getattr(self.cage, name)] for name in ("theta_deg", "x", "y")},
            "placing": length(self.placing),
            "sticking_friction": length(self.sticking_friction),
            "stop": length(self.stop),
            "seats": [seat.as_fields() for seat in self.seats],
            "wrong_seats": len(self.wrong_within()),
            "reading": length(self.reading_of()),
            "unsettled": list(self.unsettled),
        }


def length(value: float | None) -> float | None:
    """A number as files have it; what is infinite is none."""
    return None if value is None or not isfinite(value) else round(value, DECIMALS) + 0.0


def pose_fields(pose: Pose) -> dict[str, float | None]:
    """A pose as files have it."""
    return {"theta_deg": length(pose.theta_deg), "x": length(pose.x), "y": length(pose.y)}
