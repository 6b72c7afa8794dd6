"""The directions in which a clamp may push, as files name them."""

from __future__ import annotations

from math import pi

__all__ = ["DIRECTIONS", "TOWARDS"]

# In the order in which fixtures are listed. Each has the angle of the line along which the clamp's travel is counted, which
# is the other way.
DIRECTIONS = {"-x": 0.0, "+x": pi, "-y": pi / 2, "+y": -pi / 2}
# In words, on a plan whose y runs up.
TOWARDS = {"-x": "to the left", "+x": "to the right", "-y": "downward", "+y": "upward"}
