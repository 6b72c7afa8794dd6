"""A cage that opens by a channel that sampling steps over."""

from __future__ import annotations

from itertools import pairwise
from math import radians
from typing import Any

import numpy as np
import pytest

from seating_examples import Obstacle, closed, solved

# theta in degrees, x and y of the middle of the part's box: a way past the notched part's lowest pass, with the jaws three
# thousandths of a millimetre further open. Found by sampling with arithmetic of its own.
CHANNEL = [
    (3.00236, 46.16847, 30.79864),
    (2.40236, 46.26659, 30.72204),
    (1.80236, 46.30824, 30.65244),
    (1.50236, 46.30009, 30.62089),
    (1.20236, 46.26533, 30.5919),
    (1.05236, 46.23513, 30.57847),
    (0.98236, 46.21745, 30.57246),
    (0.91236, 46.19718, 30.56662),
    (0.84236, 46.17402, 30.56096),
    (0.77236, 46.14763, 30.55548),
    (0.71236, 46.12211, 30.55092),
    (0.60236, 46.06721, 30.54291),
    (0.51236, 46.0128, 30.5367),
    (0.38236, 45.91397, 30.52821),
    (0.24236, 45.76667, 30.51956),
]


def way() -> Any:
    """The channel's configurations."""
    opened = solved(2)[1].jaw_separation + 2.6705 + 0.003
    return np.array([(radians(theta), x, y, opened) for theta, x, y in CHANNEL])


def test_the_notched_part_leaves_its_cage_by_a_narrow_channel():
    """A peg in its hole and one below it pinch the web between them: within a degree of turn the channel is hundredths of a
    millimetre wide and narrower. A grid of half a degree steps over it, to a pass half a millimetre higher."""
    solver, fixture, told = solved(2)
    assert told.capture_opening < 2.6705
    obstacle = Obstacle(solver.workpiece, fixture, solver.toolkit.peg_radius)
    for one, two in pairwise(way()):
        assert min(obstacle.free(one + t * (two - one)) for t in np.linspace(0.0, 1.0, 12)) > 1e-4
    home = closed(obstacle, way()[0], solver.outline.arm, told.stop)
    assert np.abs(home - obstacle.start(fixture)).max() < 1e-4


@pytest.mark.prove
def test_beyond_the_channel_closing_leads_elsewhere():
    """Down, but not back."""
    solver, fixture, told = solved(2)
    obstacle = Obstacle(solver.workpiece, fixture, solver.toolkit.peg_radius)
    away = closed(obstacle, way()[-1], solver.outline.arm, told.stop)
    assert away[3] < way()[-1, 3] - 0.1
    assert away[0] < radians(0.25)
