"""Parts of a box in which some rule is broken everywhere."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest

from chord_examples import arc_row, line_row
from sharpness import interpreted
from workhold.kernels.base.tables import Lattice, Limits, Setting
from workhold.kernels.contact.record import FEATURES, LARGEST_RADIUS, PSI, RECORD_LENGTH
from workhold.kernels.proof import interval_newton as in_doubles
from workhold.kernels.proof.variation import NUMBERS, TILT, are_normals_one_sided

LIMITS = Limits(-np.inf, 0.0, 20.0, 99.0, 1.0, 0.0, 0.0)
SETTING = Setting(Lattice(1.0, 1.0, 0.0), LIMITS, 0.0, 0.0, 0.0)
# The top of a part from x = -10 to 10, rounded at both ends by arcs that join it tangentially.
TOP = [
    np.append(line_row(0, 0, pi, 10.0), [1e-9, 1e-9]),
    np.append(arc_row(10, -5, 5.0, pi / 4, pi / 4), [1e-9, 1e-9]),
    np.append(arc_row(-10, -5, 5.0, 3 * pi / 4, pi / 4), [1e-9, 1e-9]),
]


def normals(*angles: float) -> np.ndarray:
    """Work space (3, 4, 2) with unit normals at some angles."""
    pairs = np.zeros((3, 4, 2))
    pairs[2] = [(cos(angle), sin(angle)) for angle in angles]
    return pairs


def tilted(*tilts: float) -> np.ndarray:
    """Numbers of a part whose normals turn by so much."""
    numbers = np.zeros((NUMBERS, 4))
    numbers[TILT] = tilts
    return numbers


@pytest.mark.parametrize("turned", [0.0, 2.0, 4.0])
def test_normals_face_one_way_up_to_what_each_may_turn(turned: float) -> None:
    """Four within 1.5 radians of the first do, unless one may turn so far that it is square to it; opposite ones never."""
    at = [turned + angle for angle in (0.0, 0.3, -0.8, 1.5)]
    assert are_normals_one_sided(normals(*at), tilted(0, 0, 0, 0))
    assert are_normals_one_sided(normals(*at), tilted(0.9, 0.9, 0.6, 0.9 * cos(1.5)))
    for k in range(4):
        wide = [0.0, 0.0, 0.0, 0.0]
        wide[k] = 1.01 * cos(at[k] - turned)
        assert not are_normals_one_sided(normals(*at), tilted(*wide))
        assert not are_normals_one_sided(normals(*at[:k], turned + pi, *at[k + 1 :]), tilted(0, 0, 0, 0))
    assert not are_normals_one_sided(normals(turned, turned + 2.0, turned - 2.0, turned), tilted(0, 0, 0, 0))


def test_pegs_in_a_row_along_a_rounded_top_are_dropped_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two on the line and one on either arc at its tangent joint: where the part lies along the row is known to a tenth of a
    millimetre only, but all push down on it. Without a look at the normals it takes more than a hundred parts."""
    row = np.zeros(RECORD_LENGTH)
    row[:FEATURES] = 3.0
    row[FEATURES : FEATURES + 4] = 0, 0, 1, 2
    row[FEATURES + 4 : FEATURES + 8] = 0, 4, 13, 0
    row[PSI:] = 0.0, -3.0, 0.0, -7.0, 1e-12, 0.1
    assert row[LARGEST_RADIUS] == 0.1
    features = np.array(TOP)
    left, _, right = np.linalg.svd(in_doubles.compute_jacobians(row[None], features, SETTING)[0])
    frame, roots = np.stack([left, right.T]), np.empty((4, RECORD_LENGTH))
    monkeypatch.setattr(in_doubles, "MOST_PARTS", 2)
    assert (
        interpreted(in_doubles.find_solutions)(
            row, features, SETTING, frame, in_doubles.make_newton_space(), roots
        )
        == 0
    )
