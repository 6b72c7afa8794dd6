"""The settings of a vise of FreeCAD's CAM workbench for a set-up between two flat jaws.

FreeCAD's development version has vises as files with a set of variables (a VarSet). Such a vise has its origin on
the fixed jaw's face, at the top of the jaws, in the middle of their width. Its moving jaw is at y = -Opening, and the
part between, so that its frame is that of ``model.jaw_hold`` after half a turn.
"""

from __future__ import annotations

from workhold.errors import InputError
from workhold.fixels.jaw_pair import JawPair
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold

__all__ = ["make_freecad_settings"]


def make_freecad_settings(fixture: Fixture, jaws: JawPair | None) -> dict[str, float]:
    """Return the variables of FreeCAD's vise by name, and the pose of the part in it: X, Y, Z and Angle.

    All are in mm, the angle in degrees. X, Y and Z are the place of the origin of the part's drawing, at the
    height of the lower side of the clamped body. A length that the vise does not state is left out.

    Raises
    ------
    InputError
        For a fixture that is not held by two flat jaws, and for a vise without a stated jaw height.
    """
    hold = fixture.hold
    if jaws is None or not isinstance(hold, JawHold):
        raise InputError("FreeCAD's vises have two flat jaws: their settings are for a plain vise alone.")
    if jaws.height is None:
        raise InputError(
            "FreeCAD places a part from the top of the jaws: say how high they are (jaw_height)."
        )
    settings = {
        "JawWidth": jaws.width,
        "JawHeight": jaws.height,
        "MaxOpening": jaws.max_opening,
        "Opening": hold.opening,
        "SeatHeight": hold.parallels,
        "X": jaws.width / 2 - fixture.pose.x,
        "Y": -fixture.pose.y,
        "Z": -jaws.compute_top(hold.parallels),
        "Angle": (fixture.pose.theta_deg + 180.0) % 360.0,
    }
    return {name: round(value, 6) + 0.0 for name, value in settings.items() if value is not None}
