"""Whether two programs mean the same fixture: by where the pegs are on the part, whatever holes are called.

A fixture is where its pegs touch the part, which way each is pushed, and how the lattice lies about it. All
of this is seen from the part. So names of pegs, whole steps of the lattice, and the half turn that swaps two
jaws make no difference. Rotations of the part onto itself are applied where they are asked for.

Glossary
--------
place : of a fixture, (P, 6): of each peg x and y on the part in mm, the direction it is pushed in, and the
    axis of the lattice. The direction is zero for a peg that stands still. Directions and axes have the
    length of half the part's extent.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.benchmark.entry import Entered
from workhold.geometry.symmetry import centroid_of_joints, rotated, rotations_onto_itself
from workhold.model.workpiece import Workpiece

__all__ = ["Comparison", "Places", "compared"]

Array = NDArray[np.float64]


@define(frozen=True, eq=False)
class Places:
    """The fixtures of a list by their places, and the rotations of the part onto itself.

    Parameters
    ----------
    part : what is held.
    entered : the fixtures.
    """

    part: Workpiece
    entered: Sequence[Entered]
    places: list[Array] = field(init=False)

    @places.default
    def all_places(self) -> list[Array]:
        """The places of all fixtures."""
        low, high = (np.array(corner) for corner in (self.box[:2], self.box[2:]))
        scale = float(np.hypot(*(high - low)) / 2)
        return [place_of(one, scale) for one in self.entered]

    @property
    def box(self) -> Array:
        """The bounding box of the vertices of the part."""
        points = np.concatenate([loop[:, :2] for loop in self.part.loops])
        return np.concatenate([points.min(0), points.max(0)])

    def images(self, place: Array) -> list[Array]:
        """A place under all rotations of the part onto itself, the place itself first."""
        every = self.part.numbered
        faces = [face.segment for face in every.faces]
        kept = centroid_of_joints(faces)
        out = []
        for rotation in rotations_onto_itself(faces, every.marks):
            x, y = rotated(place[:, 0] - kept[0], place[:, 1] - kept[1], rotation.angle)
            pushed = rotated(place[:, 2], place[:, 3], rotation.angle)
            axis = rotated(place[:, 4], place[:, 5], 2 * rotation.angle)
            out.append(np.column_stack([x + kept[0], y + kept[1], *pushed, *axis]))
        return out


def place_of(entered: Entered, scale: float) -> Array:
    """The place (P, 6) of a fixture.

    Parameters
    ----------
    scale : in mm, by which directions are multiplied.
    """
    theta = np.radians(entered.theta_deg)
    rows = []
    for peg in entered.pegs:
        x, y = rotated(peg.x - entered.x, peg.y - entered.y, -theta)
        push = rotated(scale * peg.push[0], scale * peg.push[1], -theta)
        rows.append((x, y, *push, scale * np.cos(2 * theta), -scale * np.sin(2 * theta)))
    return np.array(rows, np.float64).reshape(-1, 6)


@frozen
class Comparison:
    """Another program's list beside the complete one.

    Parameters
    ----------
    listed, theirs : how many fixtures are in each.
    found, missed : numbers of fixtures of the complete list, from 0.
    extra : numbers of theirs that are no fixtures of it.
    repeated : numbers of theirs that they list before.
    """

    listed: int
    theirs: int
    found: tuple[int, ...]
    missed: tuple[int, ...]
    extra: tuple[int, ...]
    repeated: tuple[int, ...]

    @property
    def share(self) -> float:
        """The part of the complete list that is found; 1 where that is empty."""
        return len(self.found) / self.listed if self.listed else 1.0


def compared(complete: Places, theirs: Places, tolerance: float, symmetric: bool) -> Comparison:
    """Compares another program's list with the complete one.

    Parameters
    ----------
    tolerance : in mm, how far pegs and directions may be off, these at half the part's extent.
    symmetric : whether a fixture stands for all that a rotation of the part carries it into.
    """
    index = Index.of(complete.places, tolerance)
    hits, met = set[int](), set[int | None]()
    extra, repeated = list[int](), list[int]()
    for number, place in enumerate(theirs.places):
        own = index.nearest(place)
        images = complete.images(place)[1:] if symmetric else []
        known = {one for one in (own, *map(index.nearest, images)) if one is not None}
        if not known:
            extra.append(number)
        elif own in met:
            repeated.append(number)
        hits |= known
        met.add(own)
    missed = tuple(number for number in range(len(complete.places)) if number not in hits)
    return Comparison(
        listed=len(complete.places),
        theirs=len(theirs.places),
        found=tuple(sorted(hits)),
        missed=missed,
        extra=tuple(extra),
        repeated=tuple(repeated),
    )


@frozen(eq=False)
class Index:
    """Places sorted by the sum of their pegs' x, to look one up.

    Parameters
    ----------
    places : all of them.
    sums : (N, 2) of their pegs' x and y.
    order : (N,) by x.
    tolerance : in mm.
    """

    places: Sequence[Array]
    sums: Array
    order: NDArray[np.intp]
    tolerance: float

    @classmethod
    def of(cls, places: Sequence[Array], tolerance: float) -> Index:
        """The index of some places."""
        sums = np.array([place[:, :2].sum(axis=0) for place in places]).reshape(-1, 2)
        return cls(places, sums, np.argsort(sums[:, 0], kind="stable"), tolerance)

    def nearest(self, place: Array) -> int | None:
        """The number of the place nearest to one, if that is within the tolerance."""
        x, y = place[:, :2].sum(axis=0)
        room = self.tolerance * len(place)
        low, high = np.searchsorted(self.sums[self.order, 0], [x - room, x + room])
        best, found = self.tolerance, None
        for number in self.order[low:high].tolist():
            other = self.places[number]
            if abs(self.sums[number, 1] - y) > room or other.shape != place.shape:
                continue
            apart = np.abs(other[:, None] - place[None]).max(axis=-1)
            worst = float(max(apart.min(axis=0).max(), apart.min(axis=1).max()))
            if worst <= best:
                best, found = worst, number
        return found
