"""What is said beside a list of supports, in the same words wherever it is shown."""

from __future__ import annotations

from collections.abc import Sequence

from workhold.model.support_triples import Supports, Triple
from workhold.model.workpiece import Workpiece
from workhold.units import Unit

__all__ = ["flat_faces_notes", "listing_notes"]

# Openings that differ by less, in mm, are one.
SAME_OPENING = 1e-6


def listing_notes(
    found: Supports, listed: Sequence[Triple], unit: Unit, keep_off: Sequence[str]
) -> list[str]:
    """What has to be known about some sets of three that no figure of them says.

    Parameters
    ----------
    keep_off : what keeps pads off the lower side and the tip off the upper one, as it is called there.
    """
    notes = []
    if found.loads and listed and found.jaw_force > 0:
        notes.append(f"All for a closing force of {found.jaw_force:.0f} N, without friction.")
    moved = {one.travel for one in listed if one.travel is not None}
    if any(abs(one - found.fixture.jaw_separation) > SAME_OPENING for one in moved):
        notes.append(
            "With these supports the jaws stand elsewhere in their holes, opened to "
            f"{', '.join(unit.text(one) for one in sorted(moved))}; columns are counted as for the fixture."
        )
    return notes + flat_faces_notes(found.query.workpiece, keep_off)


def flat_faces_notes(workpiece: Workpiece, keep_off: Sequence[str]) -> list[str]:
    """Says that a solid is taken to be flat below or on top, where no level face of it is known.

    Parameters
    ----------
    keep_off : as of :func:`listing_notes`.
    """
    solid = workpiece.solid
    if solid is None:
        return []
    if solid.lies_on_no_face:
        return ["The part lies on no level face, so no support can stand under it: turn another side up."]
    names = ("bottom", "top")
    lacking = [k for k, name in enumerate(names) if not getattr(solid, name)]
    if not lacking:
        return []
    sides = " and ".join(names[k] for k in lacking)
    return [
        f"No level face of the part is known at its {sides}, which is taken to be flat as far as the outline "
        f"goes: keep pads and tip off the rest with {' and '.join(keep_off[k] for k in lacking)}."
    ]
