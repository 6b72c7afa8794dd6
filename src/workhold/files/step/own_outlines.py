"""Outlines of a solid as rows of numbers: that of all pegs, and those of carriers of other heights."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.files.step.heights import HeightOutline, StandingSolid
from workhold.files.step.which_height import vertices_of
from workhold.geometry.loop import loop_segments, signed_area
from workhold.model.solid import Band, SolidOutline

__all__ = ["OrderedLoops", "OwnDrawing", "ordered_loops", "own_drawings"]


@frozen(eq=False)
class OrderedLoops:
    """The loops of an outline, outer ones first, the largest of them before all.

    Parameters
    ----------
    loops : vertices (N, 3) of each, in mm.
    bands, faces : of every segment, as ``SolidOutline`` has them.
    feet : how many loops are outer ones.
    """

    loops: tuple[NDArray[np.float64], ...]
    bands: tuple[Band | None, ...]
    faces: tuple[tuple[int, ...], ...]
    feet: int


def ordered_loops(outline: HeightOutline) -> OrderedLoops:
    """The loops of an outline with what may be touched of them."""
    loops = [vertices_of(loop) for loop in outline.loops]
    areas = [signed_area(loop_segments(loop)) for loop in loops]
    order = sorted(range(len(loops)), key=lambda k: -areas[k])
    strips = [strip for k in order for strip in outline.loops[k]]
    return OrderedLoops(
        tuple(loops[k] for k in order),
        tuple(strip.band for strip in strips),
        tuple(strip.faces for strip in strips),
        sum(area > 0 for area in areas),
    )


@frozen(eq=False)
class OwnDrawing:
    """What carriers of a role meet of a solid: loops (N, 3) in mm, and the solid with their bands."""

    role: str
    loops: tuple[NDArray[np.float64], ...]
    solid: SolidOutline


def own_drawings(
    solid: StandingSolid, heights: Mapping[str, Sequence[float]], found: SolidOutline
) -> Iterator[OwnDrawing]:
    """What carriers with heights of their own meet.

    Parameters
    ----------
    heights : by role, in mm.
    found : the solid as all other pegs meet it.

    Raises
    ------
    InputError
        Naming the role, where such an outline cannot be made or has nothing to touch.
    """
    for role, (low, high) in heights.items():
        where = f"along {found.axis}, from {low:g} to {high:g} mm, where the {role} reaches"
        if low >= solid.height:
            raise InputError(
                f"{where}, there is nothing of the part, which is {solid.height:.6g} mm high: give heights "
                f"of the {role} that begin below that."
            )
        try:
            ordered = ordered_loops(solid.outline(high, found.head_room, found.least_band, low))
        except InputError as error:
            raise InputError(
                f"{where}, {str(error).rstrip('.')}: give other heights of the {role}."
            ) from error
        if not any(ordered.bands):
            raise InputError(
                f"{where}, no upright face of the part is at least {found.least_band:g} mm high: give other "
                f"heights of the {role}."
            )
        own = evolve(found, low=low, peg_height=high, bands=ordered.bands, faces=ordered.faces)
        own = evolve(own, bottom=(), top=(), top_heights=())
        yield OwnDrawing(role, ordered.loops, own)
