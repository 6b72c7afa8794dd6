"""Parts between flat jaws, and results of them, for tests of several rooms."""

from __future__ import annotations

import workhold
from workhold import Load, PlainVise, Workpiece


def rectangle(width=100.0, depth=60.0, name="block"):
    return Workpiece.from_points(name, [(0, 0), (width, 0), (width, depth), (0, depth)])


def vise(**changes):
    usual = {"jaw_width": 152, "jaw_height": 44, "max_opening": 150, "parallels": [20, 32]}
    return PlainVise(**{**usual, **changes})


DISC = Workpiece.from_loops("disc", [[[-20, 0, 1], [20, 0, 1]]])
TRIANGLE = Workpiece.from_points("triangle", [(0, 0), (60, 0), (20, 45)])
ELL = Workpiece.from_points("ell", [(0, 0), (60, 0), (60, 22), (24, 22), (24, 58), (0, 58)])
LOADS = (
    Load(points=(50, 30), force=500, directions=0, height=23),
    Load(points=(30, 20), force=200, moment=2000),
    Load(points=(58, 25), force=300, directions=315, upward=80),
)


def held(part=None, toolkit=None, **asked):
    """The result of a part in a vise; its thickness is 25 mm, and the friction 0.15, where nothing else is said."""
    usual = {"thickness": 25.0, "friction": {"jaw": 0.15}}
    return workhold.design(part or rectangle(), toolkit or vise(), **{**usual, **asked})
