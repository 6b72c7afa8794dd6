"""Outlines of carriers with heights of their own, beside the outline that all other pegs meet.

A solid is met by a peg that reaches from a to p as the outline U(a, p + head room). So a clamp whose tip
begins above a flange, or a wall lower than the pegs, meets an outline of its own, with bands of its own. What
is done about that is the least that is right:

- A workpiece keeps the outline of each such carrier as a workpiece of its own, without remarks. Segments are
  numbered on: after those of the workpiece come those of the first outline, and so on, in the order of the
  toolkit's carriers. So a face's number alone says of which outline it is, and nothing that passes numbers on
  has to know of outlines.
- Carriers of the same heights share one outline and its numbers.
- Contacts of a carrier lie on the touchable faces of its outline, trimmed by that outline alone. The search,
  the engines and the proof take rows of features for each of two carriers anyway. A clearance that is looked
  at once more, and a clamp's body, are held to the carrier's outline.
- The part lies flush on a wall with the hull of the wall's outline.
- A face that is avoided stands for the faces of the solid over it, which are avoided in every outline.
- The diameter, by which moments are scaled and chords are bounded, is that of all outlines together. The
  centre that moments are about stays that of the workpiece.
- A rotation of the part counts where it carries every outline onto itself.
- Half a turn does not swap jaws of different heights.

A drawing without heights is the same at all of them, and so has no such outlines.

Glossary
--------
role : the name that carriers of the same heights share, such as "clamp" for the clamps of all directions.
own outline : the outline that carriers of a role meet.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from attrs import evolve

from workhold.errors import InputError
from workhold.fixels.carrier import Carrier, Heights
from workhold.fixels.toolkit import Toolkit
from workhold.model.solid import SolidOutline
from workhold.model.workpiece import Workpiece

__all__ = ["met_by", "numbered_solid", "outline_met", "own_name", "with_own_outlines"]


def outline_met(workpiece: Workpiece, carrier: Carrier) -> tuple[Workpiece, int]:
    """The outline that a carrier meets, and the number of its first segment."""
    return workpiece.outline_of(carrier.role)


def own_name(name: str, heights: Heights) -> str:
    """The name of an outline of a part between two heights, which is the same for all carriers of these."""
    return f"{name}, {heights[0]:g} to {heights[1]:g} mm"


def numbered_solid(workpiece: Workpiece) -> SolidOutline | None:
    """The solid with the bands and faces of all segments, numbered on; None where there is none."""
    if workpiece.solid is None or not workpiece.outlines:
        return workpiece.solid
    every = workpiece.numbered
    return evolve(workpiece.solid, bands=every.bands, faces=every.over)


def met_by(workpiece: Workpiece, toolkit: Toolkit) -> Workpiece:
    """The workpiece with the outlines of a toolkit's carriers, in their order, and no others.

    Raises
    ------
    InputError
        When the solid was read without the heights of a carrier.
    """
    wanted = {} if workpiece.solid is None else toolkit.heights
    if not wanted and not workpiece.outlines:
        return workpiece
    known, chosen = dict(workpiece.outlines), list[tuple[str, Workpiece]]()
    for role, (low, high) in wanted.items():
        own = known.get(role)
        if own is None or own.solid is None or (own.solid.low, own.solid.peg_height) != (low, high):
            raise InputError(
                f"the {role} of this {toolkit.noun} touches from {low:g} to {high:g} mm, and "
                f"{workpiece.name} was read without these heights: read the file of the solid with them, as "
                "workhold design does, or in Python load(..., heights=toolkit.heights)."
            )
        chosen.append((role, own))
    outlines = tuple(chosen)
    return workpiece if outlines == workpiece.outlines else evolve(workpiece, outlines=outlines)


def with_own_outlines(
    workpiece: Workpiece, entries: Mapping[str, Mapping[str, Any]], heights: Mapping[str, Heights]
) -> Workpiece:
    """The workpiece with the outlines of a file's entry ``outlines``.

    Parameters
    ----------
    entries : by role the loops, the bands, and where they are known the solid's faces.
    heights : by role, of the file's toolkit, in its order.

    Raises
    ------
    InputError
        For a workpiece without a solid, and outlines that cannot be, or of roles without heights.
    """
    if workpiece.solid is None:
        raise InputError("it has outlines of carriers, but no solid: leave them out.")
    others = [role for role in entries if role not in heights]
    if others:
        raise InputError(f"it has an outline of the {others[0][:40]}, which has no heights of its own.")
    own = []
    for role, (low, high) in heights.items():
        if role in entries:
            bands, faces = entries[role]["bands"], entries[role].get("solid_faces") or ()
            changed = {"bands": bands, "faces": faces, "bottom": (), "top": (), "top_heights": ()}
            solid = evolve(workpiece.solid, low=low, peg_height=high, **changed)
            name = own_name(workpiece.name, (low, high))
            own.append((role, workpiece.from_loops(name, entries[role]["loops"], solid=solid)))
    return evolve(workpiece, outlines=tuple(own))
