"""The rows that kernels of seating pass to each other, and the records that all of them take.

A pair is two contacts of one jaw, a two-contact curve over psi, which is the orientation of the pegs seen
from the part (= -theta). It is a chord curve, or one peg in a pocket, about which the part turns.

- KIND : 0 for a chord, 1 for a pocket.
- SOURCE : number of the curve or the pocket.
- FIRST_PEG, SECOND_PEG : tail and head of a chord; the second is -1 for a pocket.
- ANGLE : of the chord in the vise frame, so that alpha = psi + angle.
- PIVOT_X, PIVOT_Y : of a pocket.

A cell is a part of a pair's range.

- LOW, HIGH : of psi.
- SPEED : bound of how fast the instant centre moves, in mm per radian.
- BOTTOM, TOP : bounds of the height.
- PAIR : its number.
- VAGUE : 1 beside a tangency, where the speed is unbounded.

A candidate is a configuration that may be an equilibrium.

- THETA, PLACE_X, PLACE_Y, SEPARATION : the configuration.
- CONTACTS : how many; four pegs from PEG on, four pieces from PIECE on, and four forces from FORCE on, per
  unit of jaw force, have room for them.
- SECOND : second derivative of the separation along the motion that three contacts leave free, up to a
  positive factor; 0 of four contacts. The direction of that motion is from MOTION on (theta, x, y).
- DOUBT : 1 where bounds did not decide that it exists.
- CLEAR : least clearance in mm of the pegs that do not touch.
- RESIDUAL : how far the forces are from a balance.

A node is a configuration (theta, x, y, S) on a descent path.

- STEP, STEP_ALONG : how long the next steps are in mm, of linear programs and along both faces.
- COSINE, SINE : of theta.
- TURNED, MOVED : how far in radians and in mm the path has turned and moved since it
  began, all of it counted.
"""

from __future__ import annotations

from math import inf, nan
from typing import NamedTuple

import numpy as np

from workhold.kernels.base.compiling import (
    ByteVector,
    IntMatrix,
    IntVector,
    Matrix,
    Vector,
)

KIND, SOURCE, FIRST_PEG, SECOND_PEG, ANGLE, PIVOT_X, PIVOT_Y = range(7)
PAIR_LENGTH = 7
LOW, HIGH, SPEED, BOTTOM, TOP, PAIR, VAGUE = range(7)
CELL_LENGTH = 7
THETA, PLACE_X, PLACE_Y, SEPARATION, CONTACTS, PEG = range(6)
PIECE, FORCE, SECOND, MOTION = 9, 13, 17, 18
DOUBT, CLEAR, RESIDUAL = 21, 22, 23
CANDIDATE_LENGTH = 24
# The columns of a candidate that are its configuration.
CONFIG = slice(THETA, SEPARATION + 1)
STEP, STEP_ALONG, COSINE, SINE, TURNED, MOVED = range(4, 10)
NODE_LENGTH = 10
# Rows of the work space in which ranges wait to be looked at.
DEPTH = 128


class HeldPart(NamedTuple):
    """A part held by four pegs of two jaws, and its two-contact curves.

    Parameters
    ----------
    pairs : (H, 7) with columns KIND, SOURCE, FIRST_PEG, SECOND_PEG, ANGLE, PIVOT_X, PIVOT_Y.
    curves, reals : whole numbers and reals of the chord curves, a row each, see ``base.tables``.
    rows : (N, 10) pieces of the boundary on which the pegs' centres lie.
    pegs : (4, 2) places of the pegs at jaw separation 0, in mm.
    right : (4,) 1 for pegs of the right jaw, which moves along x, 0 for others.
    parts : (2, 2) first and past-the-last number of the pieces that pegs of the left jaw (row 0) and of the
        right jaw (row 1) touch.
    """

    pairs: Matrix
    curves: IntMatrix
    reals: Matrix
    rows: Matrix
    pegs: Matrix
    right: IntVector
    parts: IntMatrix


class JawCells(NamedTuple):
    """The cells of one jaw, in the frame of its own pegs.

    Parameters
    ----------
    cells : (C, 7), in ascending order of LOW; those that reach beyond a turn occur a second time, a turn
        lower.
    before : how many pairs of the pattern (the pegs of both jaws) come before those of this jaw.
    height : of the jaw's first peg in the pattern, in mm.
    """

    cells: Matrix
    before: int
    height: float


class Obstacles(NamedTuple):
    """The constraints on a part among pegs while the jaws close.

    Parameters
    ----------
    rows : (N, 10) pieces.
    spans : (N, 4) lowest and highest parameter at which each piece counts (beyond a pocket it counts a little
        further than its ends), then for arcs the cosines of both.
    discs : (N, 3) disc that holds each piece as far as it counts: centre x, y and radius in mm.
    pegs, right, parts : as in ``HeldPart``.
    size : of the part in mm; a turn in radians times this is compared with shifts.
    stop : the smallest jaw separation, in mm.
    hull : (H, 6) pieces of the part's hull, which may touch a wall, see ``kernels.seating.obstacles``; no
        rows where there is no wall.
    half_plane : (3,) unit vector from the wall to the part, along x or y, and the wall's coordinate along it
        in mm.
    most : the largest jaw separation, in mm.
    """

    rows: Matrix
    spans: Matrix
    discs: Matrix
    pegs: Matrix
    right: IntVector
    parts: IntMatrix
    size: float
    stop: float
    hull: Matrix
    half_plane: Vector
    most: float = inf


class SelfMotions(NamedTuple):
    """W self-motions of a part: curves of configurations with one separation along which some contacts stay.

    Parameters
    ----------
    configs : (M, 4) theta, x, y, S along all self-motions, one after the other.
    counts : (W,) how many of the configurations belong to each.
    closed : (W,) 1 where the last configuration is beside the first.
    across : (W, 2), see ``Manifolds``.
    pegs, pieces : (W, 4) numbers of the pegs between which each leads, of which a wall is the last, and the
        piece that each peg has to touch; -1 for none.
    clear : (M, 4) clearances of these pegs in mm; -inf in the first column where one of them hinders.
    """

    configs: Matrix
    counts: IntVector
    closed: ByteVector
    across: Matrix
    pegs: IntMatrix
    pieces: IntMatrix
    clear: Matrix

    @classmethod
    def allocate(cls, count: int, configs: int) -> SelfMotions:
        """Return empty arrays for ``count`` self-motions with ``configs``
        configurations; pegs and pieces are -1, counts 0.
        """
        numbers = np.full((2, count, 4), -1)
        made = (
            np.empty((configs, 4)),
            np.zeros(count, np.int64),
            np.zeros(count, np.int8),
            np.empty((count, 2)),
        )
        return cls(*made, numbers[0], numbers[1], np.zeros((configs, 4)))

    def take_first(self, count: int) -> SelfMotions:
        """Return the first ``count`` self-motions, copied."""
        along = int(self.counts[:count].sum())
        configs, clear = np.array(self.configs[:along]), np.array(self.clear[:along])
        whole = np.array(self.counts[:count]), np.array(self.closed[:count]), np.array(self.across[:count])
        return SelfMotions(configs, *whole, np.array(self.pegs[:count]), np.array(self.pieces[:count]), clear)


class Manifolds(NamedTuple):
    """F equilibrium manifolds: connected sets of equilibria with one separation, along which the part is
    loose.

    Parameters
    ----------
    rows : (F, 24) a candidate of each, with its contacts: the middle of the part of the set where the most
        pegs touch.
    configs : (M, 4) theta, x, y, S along all sets, one after the other.
    begins : (F + 1,) number of the first configuration of each set and, last, M.
    closed : (F,) 1 for a whole turn, which has no ends.
    across : (F, 2) direction (x, y) in which the part gives way to both sides, NaN where it does not.
    """

    rows: Matrix
    configs: Matrix
    begins: IntVector
    closed: ByteVector
    across: Matrix

    @classmethod
    def allocate(cls, count: int, configs: int) -> Manifolds:
        """Return empty arrays for ``count`` sets with ``configs`` configurations; ``begins`` is 0."""
        begins = np.zeros(count + 1, np.int64)
        made = np.empty((count, CANDIDATE_LENGTH)), np.empty((configs, 4)), begins
        return cls(*made, np.empty(count, np.int8), np.empty((count, 2)))

    def take_first(self, count: int) -> Manifolds:
        """Return the first ``count`` sets, as views of these arrays."""
        begins = self.begins[: count + 1]
        kept = self.rows[:count], self.configs[: begins[-1]], begins
        return Manifolds(*kept, self.closed[:count], self.across[:count])


class DescentWorkSpace(NamedTuple):
    """Work space for the steps of a descent among N pieces.

    Parameters
    ----------
    near : (64, 7) rows with gradient (4), clearance, peg and piece, see ``closing.write_near_clearances``.
    basis, triangle : (5, 4) and (5, 6).
    step, way, trial : (4,).
    members : (8,).
    known : (4, 4) for each peg a place (x, y) on the part, the clearance there in mm, and the nearest piece
        there. Place and clearance are a disc in which the peg is free.
    lists, counts : (4, N) and (4,) pieces near each peg, and how many.
    places : (4, 3) place (x, y) about which they were listed, and reach in mm.
    turn : (3,) an orientation in radians, its cosine and its sine; NaN before the first.
    """

    near: Matrix
    basis: Matrix
    triangle: Matrix
    step: Vector
    way: Vector
    trial: Vector
    members: IntVector
    known: Matrix
    lists: IntMatrix
    counts: IntVector
    places: Matrix
    turn: Vector

    @classmethod
    def allocate(cls, count: int) -> DescentWorkSpace:
        """Return work space for a part with ``count`` pieces."""
        step, way, trial = np.empty(4), np.empty(4), np.empty(4)
        listed = np.empty((4, count), np.int64), np.empty(4, np.int64), np.empty((4, 3))
        normals = np.empty((64, 7)), np.empty((5, 4)), np.empty((5, 6))
        return cls(
            *normals, step, way, trial, np.empty(8, np.int64), np.empty((4, 4)), *listed, np.full(3, nan)
        )
