"""The boundary on which a peg's centre lies while it touches a part, and the inner corners of this boundary.

Glossary
--------
obstacle boundary : the boundary of the region that a part forbids to the centre of a peg (its C-obstacle): T.
    Lozano-Perez, "Spatial planning: a configuration space approach", IEEE Transactions on Computers C-32
    (1983).
piece : a straight or circular part of the boundary; a peg's centre on it touches one face, or one corner of
    the part.
pocket : a corner of the boundary in which a peg touches two pieces at once.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import atan2, pi
from typing import Any, TypeVar

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.contact.curves import CurveTable, LatticeSteps, loosen_rows, make_curve_table, number_centers
from workhold.contact.problem import move_rows_to_origin
from workhold.conventions import END_SLACK, SAME_CENTER
from workhold.geometry.segment import make_segment_rows
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, REST_X, SIGN, X, Y
from workhold.kernels.base.tables import HEAD, TAIL
from workhold.kernels.seating.columns import Obstacles
from workhold.model.seating import SeatContact
from workhold.model.workpiece import Workpiece
from workhold.seating.part_features import PartHull, TouchedFeature, find_pockets, list_touched_pieces
from workhold.seating.pattern import Pattern

__all__ = ["ObstacleBoundary", "contains"]

Array = NDArray[np.float64]
Found = TypeVar("Found")
# mm. How far past a pocket a piece still counts for a peg beside it.
PAST_POCKET = 0.05


@define(frozen=True, eq=False, slots=False)
class ObstacleBoundary:
    """The boundary on which the centres of pegs lie while they touch a part.

    If moving pegs have another radius than fixed ones, each kind has its own boundary, and the pieces of the
    two follow one after the other.

    Parameters
    ----------
    rows : (N, 10) straight and circular pieces in mm, relative to the centre of the part's bounding box.
    parts : (2, 2) first and past-the-last index of the pieces for fixed pegs (row 0) and for moving pegs (row
        1).
    touches : for each piece, the face or corner of the part that a peg on it touches.
    pockets : (V, 6) corners in which a peg touches two pieces at once: place (x, y), and the outward normals
        of the two pieces.
    pocket_pieces : (V, 2) indices of these two pieces.
    hull : the features of the part that may touch a wall.
    mirrored : whether the part is turned over.
    contacts, tables : caches of :meth:`make_contacts` and of :meth:`find_chord_curves`.
    found : cache of :meth:`find_once`.
    """

    rows: Array
    parts: NDArray[np.int64]
    touches: tuple[TouchedFeature, ...]
    pockets: Array
    pocket_pieces: NDArray[np.int64]
    hull: PartHull
    mirrored: bool = False
    contacts: dict[int, tuple[SeatContact, ...]] = field(factory=dict, init=False)
    tables: dict[tuple[float, int], CurveTable] = field(factory=dict, init=False)
    found: dict[Callable[[ObstacleBoundary], Any], Any] = field(factory=dict, init=False)

    @classmethod
    def from_workpiece(cls, workpiece: Workpiece, radii: tuple[float, float]) -> ObstacleBoundary:
        """Return the boundary of a part for pegs with two radii in mm (above 0): that of fixed pegs, that of
        moving pegs.
        """
        rows, touches, pockets, whose, starts = (
            list[Array](),
            list[TouchedFeature](),
            list[Array](),
            list[Any](),
            [0],
        )
        for radius in dict.fromkeys(radii):
            touched = list_touched_pieces(workpiece, radius)
            pieces = [piece for _, piece in touched]
            rows.append(move_rows_to_origin(make_segment_rows(pieces), workpiece.center))
            touches += [touch for touch, _ in touched]
            places, numbers = find_pockets(pieces, rows[-1])
            pockets.append(places)
            whose.append(numbers + starts[-1])
            starts.append(starts[-1] + len(pieces))
        every = np.concatenate(rows)
        every.setflags(write=False)
        parts = np.array([starts[:2], starts[-2:]], dtype=np.int64)
        return cls(
            every,
            parts,
            tuple(touches),
            np.concatenate(pockets),
            np.concatenate(whose),
            PartHull.from_workpiece(workpiece),
        )

    def can_touch(self, side: int, piece: int) -> bool:
        """Return whether a piece belongs to fixed pegs (``side`` 0) or moving pegs (``side`` 1)."""
        return bool(self.parts[side, 0] <= piece < self.parts[side, 1])

    def make_obstacles(self, pattern: Pattern, size: float, stop: float) -> Obstacles:
        """Return the part's pieces and the pegs of a pattern, in the form that the kernels take.

        ``size`` is the part's in mm: a turn in radians times ``size`` is compared with shifts. ``stop`` is
        the least jaw separation in mm.
        """
        pegs = np.array(pattern.pegs), pattern.right, self.parts
        hull, half_plane = np.zeros((0, 6)), np.zeros(3)
        if pattern.half_plane is not None:
            hull, half_plane = np.array(self.hull.rows), np.array(pattern.half_plane)
        return Obstacles(self.pieces, self.spans, self.wide_discs, *pegs, size, stop, hull, half_plane)

    @cached_property
    def pieces(self) -> Array:
        """A writable copy of ``rows``, as the kernels need it."""
        return np.array(self.rows)

    @cached_property
    def loose(self) -> Array:
        """The pieces (N, 10), each slightly longer at both ends, for finding chord curves."""
        return loosen_rows(self.rows)

    @cached_property
    def discs(self) -> Array:
        """For each piece a disc that contains it: centre x, y and radius in mm (N, 3)."""
        rows, whole = self.loose, self.loose[:, HALF_EXTENT] >= pi / 2.0
        is_arc = rows[:, IS_ARC] != 0.0
        out = np.array(rows[:, [X, Y, HALF_EXTENT]], order="C")
        out[is_arc, 2] = rows[is_arc, RADIUS]
        # Shorter arcs about their own middle, from which the ends are farthest.
        short = is_arc & ~whole
        out[short, :2] += rows[short, RADIUS, None] * rows[short][:, [AXIS_X, AXIS_Y]]
        out[short, 2] = 2.0 * rows[short, RADIUS] * np.sin(rows[short, HALF_EXTENT] / 2.0)
        return out

    @cached_property
    def wide_discs(self) -> Array:
        """The ``discs`` (N, 3) with radii larger by ``PAST_POCKET``."""
        return np.asarray(self.discs + np.array([0.0, 0.0, PAST_POCKET]))

    @cached_property
    def spans(self) -> Array:
        """The range of parameters in which each piece counts, as (N, 4): lowest, highest, and the cosines of
        both.

        Parameters are in mm on a line and in radians on an arc, 0 at the middle. The range is slightly longer
        than the piece. At a pocket it is longer by ``PAST_POCKET`` mm, so that both pieces of the pocket keep
        a peg off near it.
        """
        rows = self.rows
        hair = np.where(rows[:, IS_ARC] != 0.0, END_SLACK / np.maximum(rows[:, RADIUS], END_SLACK), END_SLACK)
        out = np.stack([-rows[:, HALF_EXTENT] - hair, rows[:, HALF_EXTENT] + hair], axis=1)
        for (x, y, *_), pieces in zip(self.pockets, self.pocket_pieces, strict=True):
            for k in pieces:
                unit = rows[k, RADIUS] if rows[k, IS_ARC] != 0.0 else 1.0
                end = 1 if compute_parameter(rows[k], x, y) > 0.0 else 0
                out[k, end] += (2 * end - 1) * PAST_POCKET / unit
        return np.concatenate([out, np.cos(np.clip(out, -pi, pi))], axis=1)

    @cached_property
    def concentric(self) -> list[list[int]]:
        """The indices of all arcs, in one list for each centre."""
        groups: list[list[int]] = []
        for k in np.flatnonzero(self.rows[:, IS_ARC] != 0.0).tolist():
            center = self.rows[k, [X, Y]]
            group = next(
                (g for g in groups if np.hypot(*(self.rows[g[0], [X, Y]] - center)) <= SAME_CENTER), None
            )
            groups.append([k]) if group is None else group.append(k)
        return groups

    @cached_property
    def all_touches(self) -> tuple[TouchedFeature, ...]:
        """The features of ``touches`` (one for each piece), and after those the features that may touch a
        wall.
        """
        return self.touches + self.hull.touches

    @cached_property
    def corners(self) -> NDArray[np.bool_]:
        """For each of ``all_touches``, whether it is a corner."""
        return np.array([touch.corner for touch in self.all_touches])

    @cached_property
    def rings(self) -> list[tuple[list[tuple[int, float]], list[tuple[int, float]]]]:
        """For each centre, two lists of arcs: those for fixed pegs and those for moving pegs.

        An arc is given by its index and its radius in mm, negative where it is concave. Centres without arcs
        for both kinds of pegs are left out.
        """
        signed = (self.rows[:, SIGN] * self.rows[:, RADIUS]).tolist()
        both = (
            tuple([(k, signed[k]) for k in group if first <= k < end] for first, end in self.parts.tolist())
            for group in self.concentric
        )
        return [(standing, moving) for standing, moving in both if standing and moving]

    def make_contacts(
        self, pegs: NDArray[np.int64], pieces: NDArray[np.int64]
    ) -> list[tuple[SeatContact, ...]]:
        """Return the contacts of each of N seats; seats with equal contacts share one tuple.

        Parameters
        ----------
        pegs : (N, 4) number of the touching peg of each contact, -1 where a seat has fewer contacts.
        pieces : (N, 4) for each contact the index in ``all_touches`` of what the peg touches.
        """
        count = len(self.all_touches)
        codes = np.where(pegs < 0, 0, 1 + pegs * count + pieces)
        keys: list[int] = (codes @ (1 + 4 * count) ** np.arange(4)).tolist()
        for k, key in enumerate(keys):
            if key not in self.contacts:
                touching = (
                    (peg, self.all_touches[at])
                    for peg, at in zip(pegs[k].tolist(), pieces[k].tolist(), strict=True)
                    if peg >= 0
                )
                self.contacts[key] = tuple(
                    [SeatContact(peg, touch.face, touch.corner) for peg, touch in touching]
                )
        return [self.contacts[key] for key in keys]

    @cached_property
    def centers(self) -> dict[int, NDArray[np.int64]]:
        """For each of ``parts``, the numbers of the pieces' centres, see ``contact.curves.number_centers``.

        The keys are the indices of the parts' first pieces.
        """
        return {first: number_centers(self.loose[first:end]) for first, end in self.parts.tolist()}

    def find_once(self, find: Callable[[ObstacleBoundary], Found], anew: bool = False) -> Found:
        """Return ``find(self)`` from a cache; it is called only the first time.

        With ``anew``, call it again and keep the new result.
        """
        if anew or find not in self.found:
            self.found[find] = find(self)
        kept: Found = self.found[find]
        return kept

    def find_chord_curves(self, length: float, side: int) -> CurveTable:
        """Return the curves of a chord of given length in mm between two pegs that both touch the part;
        cached.

        ``side`` is 0 for fixed pegs, 1 for moving pegs. The tail of a chord is on the piece with the lower
        index, and the chord's direction in the part's frame (alpha) is used as its orientation (psi).
        """
        first, end = self.parts[side].tolist()
        key = round(length, 9), first
        if key not in self.tables:
            # Rounded, so that whoever asks first gets the curves that all others get.
            steps = LatticeSteps(
                np.array([round(length, 12)]),
                np.array([0, 1]),
                np.array([[1, 0]], dtype=np.int64),
                np.array([0.0]),
            )
            table = make_curve_table(self.loose[first:end], steps, centers=self.centers[first])
            for integers in (table.curves.integers, table.sliding_pairs.integers):
                integers[:, [TAIL, HEAD]] += first
            self.tables[key] = table
        return self.tables[key]

    def compute_normal(self, number: int, x: float, y: float) -> tuple[float, float]:
        """Return the outward unit normal of the piece with index ``number`` at a point (x, y) on it."""
        row = self.rows[number].tolist()
        if row[IS_ARC] == 0.0:
            return row[AXIS_Y], -row[AXIS_X]
        dx, dy = row[SIGN] * (x - row[X]) / row[RADIUS], row[SIGN] * (y - row[Y]) / row[RADIUS]
        return float(dx), float(dy)

    @cached_property
    def turned_over(self) -> ObstacleBoundary:
        """The boundary of the part turned over: x becomes -x, relative to the centre of its box."""
        rows = np.array(self.rows)
        is_arc = rows[:, IS_ARC] != 0.0
        rows[:, X] *= -1.0
        rows[:, REST_X] *= -1.0
        rows[is_arc, AXIS_X] *= -1.0
        rows[~is_arc, AXIS_Y] *= -1.0
        rows.setflags(write=False)
        pockets = self.pockets * np.array([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0])
        return ObstacleBoundary(
            rows,
            self.parts,
            self.touches,
            pockets,
            self.pocket_pieces,
            self.hull.turned_over,
            not self.mirrored,
        )


def contains(row: Array, x: float, y: float) -> bool:
    """Return whether a point (x, y) on the whole line or circle of a piece (10,) lies on the piece, up to
    rounding.
    """
    unit = row[RADIUS] if row[IS_ARC] != 0.0 else 1.0
    whole = row[IS_ARC] != 0.0 and row[HALF_EXTENT] >= pi
    return bool(whole or abs(compute_parameter(row, x, y)) <= row[HALF_EXTENT] + END_SLACK / unit)


def compute_parameter(row: Array, x: float, y: float) -> float:
    """Return the parameter of a point (x, y) on a piece (10,): mm on a line, radians on an arc, 0 at the
    middle.
    """
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        return float(dx * row[AXIS_X] + dy * row[AXIS_Y])
    return atan2(row[AXIS_X] * dy - row[AXIS_Y] * dx, row[AXIS_X] * dx + row[AXIS_Y] * dy)
