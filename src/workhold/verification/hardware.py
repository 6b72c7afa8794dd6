"""What the rules of a verification ask of a kind of toolkit; all that is a vise's or a plate's own stands behind this.

On purpose a toolkit is asked for its fields alone here, and not for its carriers and arrangements: the model's own
description of them is what is checked.

Glossary
--------
way : unit vector along which a peg moves as the travel grows.
pattern : the holes of a fixture in a form in which equal fixtures have equal ones, with the place of the workpiece.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from math import cos, radians, sin
from typing import Any, ClassVar

from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query
from workhold.model.toolkit import Toolkit
from workhold.verification.contacts import Contact, Pose
from workhold.verification.findings import Finding
from workhold.verification.outline import Outline
from workhold.verification.sides import Side

__all__ = ["Hardware", "Key", "Place", "Rank", "from_anchor"]

Key = tuple[Any, ...]
# Orientation, place in the workpiece's frame of the first peg that stands still, and how far from it each moving one is.
Place = tuple[float, ...]
# Type and holes, orientation in radians, and faces, by which fixtures that are equally good are put in order.
Rank = tuple[list[int], float, list[int]]


class Hardware(ABC):
    """The rules of one kind of toolkit.

    Attributes
    ----------
    names : of the pegs of a fixture, in their order, for messages.
    travel_words : what the travel is called.
    slack_words : what is wrong where the clamping force is none.
    wider_words : what queries there are that a listing also meets.
    least_clamping : the clamping force is more than this, the shares scaled to sum 1.
    """

    names: ClassVar[tuple[str, ...]]
    travel_words: ClassVar[str]
    wider_words: ClassVar[str]
    least_clamping: ClassVar[float]

    @property
    def same_words(self) -> str:
        """What is said of a fixture that an earlier one already is."""
        return "it is the same as"

    @property
    @abstractmethod
    def toolkit(self) -> Toolkit:
        """The toolkit."""

    @property
    @abstractmethod
    def slack_words(self) -> str:
        """What is wrong where the clamping force is none."""

    @property
    @abstractmethod
    def largest_radius(self) -> float:
        """Of its pegs, in mm."""

    @abstractmethod
    def taken(self, fixture: Fixture) -> Fixture:
        """A fixture as it is read, with the travel that its file may leave to be derived.

        Raises
        ------
        InputError
            When it is of another kind of toolkit.
        """

    @abstractmethod
    def contact(self, peg: Peg, side: Side) -> Contact:
        """The contact of a peg with a side."""

    def contacts(self, fixture: Fixture, outline: Outline) -> list[Contact]:
        """The contacts of all pegs of a fixture, in their order."""
        return [self.contact(peg, outline.faces[peg.face]) for peg in fixture.pegs]

    def shared_faces(self, fixture: Fixture, contacts: Sequence[Contact]) -> list[int]:
        """Numbers of what the pegs touch: the same for those that an error of a face moves alike."""
        return [peg.face for peg in fixture.pegs]

    @abstractmethod
    def hole_findings(self, fixture: Fixture) -> Iterator[Finding]:
        """What is wrong with the holes, and with the places x, y written for them."""

    @abstractmethod
    def standing_findings(
        self, fixture: Fixture, contacts: list[Contact], pose: Pose, outline: Outline
    ) -> Iterator[Finding]:
        """Whether everything can stand as it does at a proven pose."""

    @abstractmethod
    def broken_restriction(self, fixture: Fixture, query: Query) -> str:
        """What a fixture breaks of what the toolkit rules out, in one sentence without a full stop; empty for nothing."""

    @abstractmethod
    def body_radius(self, peg: Peg) -> float:
        """Radius in mm of the thickest part of a peg."""

    @abstractmethod
    def patterns(self, fixture: Fixture) -> Iterator[tuple[Key, Place]]:
        """Each pattern that names a fixture.

        There are two where a half turn of the toolkit leaves the holes as they are, and none where the pegs are not those of
        a fixture.
        """

    @abstractmethod
    def rank(self, fixture: Fixture) -> Rank:
        """By what a fixture stands among those that are equally good."""


def from_anchor(fixture: Fixture, anchor: Peg) -> tuple[float, float]:
    """Where a peg's centre is in the workpiece's frame, in mm; by a motion of its own, not ``Pose``, which is checked."""
    theta = radians(fixture.pose.theta_deg)
    x, y = anchor.x - fixture.pose.x, anchor.y - fixture.pose.y
    return cos(theta) * x + sin(theta) * y, cos(theta) * y - sin(theta) * x
