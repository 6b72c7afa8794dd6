"""What edges kept from cell to cell spare changes no piece."""

from __future__ import annotations

from itertools import pairwise
from random import Random
from typing import Any

import numpy as np
import pytest

from curve_examples import HEIGHT, POSITION, pieces_of, pitch_of, random_table
from workhold.kernels.base.tables import (
    CURVE,
    EDGE_LENGTH,
    EDGE_X,
    HIGH,
    LEFTWARD_HIGH,
    PIECE_LENGTH,
    RIGHTWARD_LOW,
    X_STANDING,
)
from workhold.kernels.curves.pieces import write_pieces


def written(*given: Any) -> np.ndarray:
    """The pieces that a cell has."""
    pieces = np.empty((4096, PIECE_LENGTH))
    count = write_pieces(*given, np.empty((2, EDGE_LENGTH)), pieces)
    assert count >= 0
    return pieces[:count]


@pytest.mark.thorough
def test_pieces_without_room_are_told() -> None:
    """Rather than written past the end."""
    features, table = random_table(Random(5))
    members, kept = np.arange(len(table)), np.full((len(table), EDGE_LENGTH + 1), np.nan)
    given = (-1.0, 1.0, members, features, table.curves, pitch_of(table), 0.0, HEIGHT, np.inf, kept)
    assert write_pieces(*given, np.empty((2, EDGE_LENGTH)), np.empty((1, PIECE_LENGTH))) == -1


def told(pieces: np.ndarray, mode: float) -> np.ndarray:
    """What pieces tell: of positions no directions of forces."""
    return np.delete(pieces, slice(RIGHTWARD_LOW, LEFTWARD_HIGH + 1), axis=1) if mode == POSITION else pieces


@pytest.mark.thorough
@pytest.mark.parametrize("mode", [HEIGHT, POSITION])
def test_neighbouring_cells_share_their_edges(mode: float) -> None:
    """The pieces are those that each cell has by itself, to the last digit; of every curve the last edge is kept."""
    random = Random(5)
    for width in (0.05, 0.7, 2.5):
        features, table = random_table(random)
        pitch, members = pitch_of(table), np.arange(len(table))
        kept = np.full((len(members), EDGE_LENGTH + 1), np.nan)
        for low, high in pairwise((-1.0 + width * np.arange(6)).tolist()):
            alone = pieces_of(features, table, low, high, mode)
            given = (members, features, table.curves, pitch, 0.0, mode, np.inf, kept)
            shared = written(low, high, *given)
            np.testing.assert_array_equal(told(shared, mode), told(alone, mode))
            for curve in np.unique(alone[:, CURVE]).astype(int):
                assert kept[curve, EDGE_LENGTH] in alone[alone[:, CURVE] == curve, HIGH]


@pytest.mark.thorough
def test_only_pieces_that_stand_too_far_right_are_left_out() -> None:
    """Those that do not are there as they are, and of those that do most are left out, many without an edge of their own."""
    random = Random(8)
    far = gone = 0
    for _ in range(12):
        features, table = random_table(random)
        pitch, members = pitch_of(table), np.arange(len(table))
        kept, farthest = np.full((len(members), EDGE_LENGTH + 1), np.nan), random.uniform(-10, 10)
        for low, high in pairwise((random.uniform(-4, 4) + 0.02 * np.arange(8)).tolist()):
            alone = pieces_of(features, table, low, high, POSITION)
            given = (members, features, table.curves, pitch, 0.0, POSITION, farthest, kept)
            fewer = written(low, high, *given)
            is_far = alone[:, X_STANDING] > farthest
            left = fewer[fewer[:, X_STANDING] <= farthest]
            np.testing.assert_array_equal(told(left, POSITION), told(alone[~is_far], POSITION))
            known = {row.tobytes() for row in told(alone, POSITION)}
            assert all(row.tobytes() in known for row in told(fewer, POSITION))
            far, gone = far + int(is_far.sum()), gone + len(alone) - len(fewer)
    assert 0.5 * far < gone < far


def test_an_edge_of_another_stretch_tells_nothing() -> None:
    """How fast the instant centre moves is known in its own stretch only."""
    features, table = random_table(Random(11))
    members, kept = np.arange(len(table)), np.zeros((len(table), EDGE_LENGTH + 1))
    kept[:, EDGE_X], kept[:, EDGE_LENGTH] = 1e9, -10.0
    given = (
        members,
        features,
        table.curves,
        pitch_of(table),
        0.0,
        POSITION,
        1000.0,
        kept,
    )
    pieces = written(0.0, 0.05, *given)
    assert len(pieces)
    np.testing.assert_array_equal(
        told(pieces, POSITION), told(pieces_of(features, table, 0.0, 0.05, POSITION), POSITION)
    )
