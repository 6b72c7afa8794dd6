"""Supports under a fixture, and the clamp on top, in the picture of a widget."""

from __future__ import annotations

from collections.abc import Callable

from workhold.drawing.scene import Scene, View
from workhold.drawing.supports_drawn import (
    SUPPORT,
    PlannedSupports,
    draw_pad,
    draw_tip,
    draw_triangle,
    size_of,
)
from workhold.model.recounted import ChosenSupports
from workhold.model.support_triples import SupportPad, Supports
from workhold.supports.words import why_none
from workhold.units import MILLIMETRE

__all__ = ["draw_set", "set_words"]

# Of the name of a support, page units.
NAME = 12.0


def draw_set(
    scene: Scene, chosen: ChosenSupports, view: View, group_for: Callable[[SupportPad], Scene]
) -> None:
    """Draws a set of three with the names of its holes.

    Parameters
    ----------
    group_for : the group of a support, which moves with the jaw that it stands on.
    """
    planned = PlannedSupports.of(chosen)
    corners, radius = [view(place) for place in planned.places], size_of(planned.pad_radius, view)
    draw_triangle(scene.group("stands"), corners)
    for pad, (x, y) in zip(chosen.pads, corners, strict=True):
        group = group_for(pad)
        draw_pad(group, (x, y), radius)
        group.text((x, y + radius + NAME), pad.hole, NAME, "middle", bold=True, fill=SUPPORT, halo=3.0)
    draw_tip(scene.group("stands"), view(planned.clamp), size_of(planned.tip_radius, view))


def set_words(found: Supports) -> str:
    """The best set of three and the clamp on top in a sentence, or why there is none."""
    if not found.triples:
        return why_none(found, MILLIMETRE)
    chosen, number = ChosenSupports.of(found), MILLIMETRE.number
    x, y = chosen.clamp.at
    holes = ", ".join(pad.hole for pad in chosen.pads)
    return f"Supports in {holes}; the clamp on top presses at ({number(x)}, {number(y)})."
