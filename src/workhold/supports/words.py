"""Words about a list of supports, the same wherever the list is shown, and why a list is empty.

For an empty list these conditions are tested in turn: three holes have room for a pad; three such holes fit
the plates; their triangle is large enough for the clamp; there is a place for the tip in the triangle. The
first that fails is explained in one sentence, with a remedy.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations, islice
from math import floor

import numpy as np
from attrs import evolve

from workhold.errors import join_words as listed_words
from workhold.model.support_request import SupportRequest
from workhold.model.support_triples import Supports, Triple
from workhold.model.workpiece import Workpiece
from workhold.supports.asking import SMALLER
from workhold.supports.holes import CarrierRoom, HolesUnderPart, find_holes_under_face
from workhold.supports.listing import SupportSearch
from workhold.units import MILLIMETRE, Unit

__all__ = [
    "write_flat_faces_notes",
    "write_listing_notes",
    "place_notes",
    "list_set_headings",
    "format_set_row",
    "explain_no_set",
]

# Largest number of triples that are examined; where there are more, surely one fits.
MOST_LOOKED_AT = 200_000
# Openings that differ by less, in mm, are one.
SAME_OPENING = 1e-6


def explain_no_set(found: Supports, unit: Unit) -> str:
    """Return a sentence that explains why there is no set of three supports; lengths in the given unit."""
    return f"No three supports hold the part with the clamp between them: {explain_reason(found, unit)}"


def explain_reason(found: Supports, unit: Unit) -> str:
    """Return the end of a sentence: the first obstacle to a set of three supports, and a remedy."""
    request, toolkit = found.request, found.query.toolkit
    turned = "" if found.query.workpiece.solid is None else "; another side up would help"
    if request.bottom is not None and not request.bottom:
        return f"the part lies on no level face under which a pad could stand{turned}."
    if request.top is not None and not request.top:
        solid = found.query.workpiece.solid
        if solid is not None and solid.unclear_heights:
            return f"no clamp can press from above: {describe_unclear_faces(solid.unclear_heights, unit)}{turned}."
        return (
            "no clamp can press from above, because no level face of the part is open upward; "
            f"crowns, fillets and slopes do not count as flat{turned}."
        )
    search = SupportSearch(found.query, request, ())
    plain = SupportSearch(found.query, evolve(request, top_zones=(), reach=None), ())
    if plain.find_places(found.fixture).is_empty:
        return explain_no_place_for_tip(request, turned, unit)
    if found.query.program is not None and search.find_places(found.fixture).is_empty:
        return (
            "the tools of the program and the keep-outs leave no place on the upper face where a tip "
            f"of radius {unit.format_length(request.tip_radius)} could stay; a smaller tip would help, or "
            "another set-up for the cuts under it, or another way to hold the part down."
        )
    holes = find_holes_under_face(found.fixture, toolkit, search.bottom, request)
    if found.positions < 3:
        bare = evolve(request, pad_radius=0.0, pad_margin=0.0)
        return explain_few_holes(
            found, find_holes_under_face(found.fixture, toolkit, search.bottom, bare), unit
        )
    sets = np.array(list(islice(combinations(range(len(holes.row)), 3), MOST_LOOKED_AT)), np.int64)
    sets = sets[CarrierRoom.from_fixture(found.fixture, toolkit, holes).place_sets(sets).fits]
    if not len(sets):
        return (
            f"{found.positions} holes could hold a support, but no three of them fit the columns, the rows "
            "and the gap together with the pegs; more columns or a smaller gap would help, or "
            "another fixture."
        )
    widest = max(compute_incircle_radius(holes.points[one]) for one in sets)
    if widest < request.inside:
        return (
            f"in the largest triangle of them a clamp is {unit.format_length(widest)} from every side, "
            f"and {unit.format_length(request.inside)} is asked for; a smaller tip would help, or less distance "
            "inside the triangle."
        )
    helps = [
        "a smaller tip",
        *(["a smaller head"] if request.rising else []),
        "less distance inside the triangle",
    ]
    helps += ["other keep-outs on top or the clamp's reach"] if request.top_zones or request.reach else []
    return (
        f"the tip of radius {unit.format_length(request.tip_radius)} finds no place on the upper face "
        f"inside any triangle of the {found.positions} holes that could hold a support; "
        f"{', or '.join(helps)} would help."
    )


def describe_unclear_faces(heights: Sequence[float], unit: Unit) -> str:
    """Return a phrase that says that the space beside level faces at some heights is not known, with a
    remedy.

    ``heights`` are in mm.
    """
    faces = "face" if len(heights) == 1 else "faces"
    at = listed_words([unit.format_length(height) for height in heights])
    return (
        f"so much of the part, or so many curves, stand beside the level {faces} at a height of "
        f"{at} that it is not known where a clamp has room; a file without those details would "
        "help"
    )


def explain_no_place_for_tip(request: SupportRequest, turned: str, unit: Unit) -> str:
    """Return the end of a sentence: the tip fits on none of the upper faces, and a remedy.

    The phrase ``turned`` is added at its end.
    """
    margin = f", {unit.format_length(request.tip_margin)} from its border" if request.tip_margin else ""
    head = (
        f" and a head of radius {unit.format_length(request.head_radius)} above it" if request.rising else ""
    )
    smaller = "a smaller tip or head" if head else "a smaller tip"
    return (
        "no clamp can press from above, because no level face of the part that is open upward "
        f"has room for a tip of radius {unit.format_length(request.tip_radius)}{margin}{head}; {smaller} "
        f"would help{turned}."
    )


def explain_few_holes(found: Supports, bare: HolesUnderPart, unit: Unit) -> str:
    """Return the end of a sentence: fewer than three holes have room for a pad, and a remedy.

    ``bare`` are the holes for a pad of radius 0 without margin.
    """
    request, few = found.request, ("no hole has", "only one hole has", "only two holes have")[found.positions]
    spare = np.sort(bare.spare)[::-1] - request.pad_margin
    pad = f"{few} room for a pad of radius {unit.format_length(request.pad_radius)}"
    if len(spare) < 3 or spare[2] <= 0.0:
        return (
            f"{pad}, and fewer than three lie under the lower face clear of the pegs at all; a finer pitch "
            "would help, or another fixture."
        )
    # Rounded down, so that a pad of the radius that is said fits.
    enough = floor(spare[2] * 100) / 100
    least = SMALLER[-1][0]
    if enough < min(least, request.pad_radius):
        turned = "" if found.query.workpiece.solid is None else ", another side up"
        return (
            f"{pad}, and no three have it for pads of radius {unit.format_length(least)}; a finer pitch would "
            f"help{turned}, or another fixture."
        )
    return f"{pad}; three have it for pads of radius {unit.format_length(enough)}."


def compute_incircle_radius(corners: np.ndarray) -> float:
    """Return the radius of the incircle of a triangle (3, 2), in the same unit."""
    a, b, c = corners
    twice = abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
    return float(twice / sum(np.hypot(*(q - p)) for p, q in ((a, b), (b, c), (c, a))))


def list_set_headings(unit: Unit, loaded: bool) -> tuple[str, ...]:
    """Return the headings of a table of sets of three, see :func:`format_set_row`.

    A heading that begins with ``>`` marks a column of numbers. ``loaded`` adds columns for forces.
    """
    of = unit.abbreviation
    forces = (f">clamp force {unit.force}", f">support force {unit.force}") if loaded else ()
    return ("supports", f"clamp at {of}", *forces, f">tipping arm {of}", f">stands by {of}")


def format_set_row(triple: Triple, unit: Unit, loaded: bool) -> list[str]:
    """Return the cells of a table's row for a set of three, as text.

    ``loaded`` adds cells for forces.
    """
    clamp = triple.clamp
    sizes = (clamp.clamp_needed, clamp.support_force or 0.0) if loaded else ()
    return [
        " ".join(pad.hole for pad in triple.supports),
        f"({unit.format_number(clamp.at[0])}, {unit.format_number(clamp.at[1])})",
        *(unit.format_force_number(size, 0) for size in sizes),
        unit.format_number(clamp.arm),
        unit.format_number(triple.standing),
    ]


def write_listing_notes(
    found: Supports, listed: Sequence[Triple], unit: Unit, keep_off: Sequence[str]
) -> list[str]:
    """Return notes on the limits of the figures of listed sets of three, a sentence or two each.

    Parameters
    ----------
    keep_off : names of the options that keep pads off the lower side, and the tip off the upper one.
    """
    notes = []
    if found.loads and listed and found.jaw_force > 0:
        notes.append(
            f"All figures are for a closing force of {unit.format_force(found.jaw_force)}, without friction."
        )
    moved = {one.travel for one in listed if one.travel is not None}
    if any(abs(one - found.fixture.travel) > SAME_OPENING for one in moved):
        notes.append(
            "With these supports the jaws stand elsewhere in their holes, opened to "
            f"{', '.join(unit.format_length(one) for one in sorted(moved))}; columns are counted as for the fixture."
        )
    notes += place_notes(dict(enumerate(listed, 1)))
    return notes + write_flat_faces_notes(found.query.workpiece, keep_off)


def place_notes(listed: Mapping[int, Triple]) -> list[str]:
    """Return notes on sets from which the part falls before it is
    clamped, and on sets whose clamp presses over air.

    Parameters
    ----------
    listed : the sets, by their numbers in the list.
    """
    falls = [number for number, one in listed.items() if not one.stands]
    hangs = [number for number, one in listed.items() if one.clamp.hangs]
    notes = []
    if falls:
        notes.append(
            f"On {name_sets(falls, listed)} the part does not stand by itself: hold it down until it is clamped."
        )
    if hangs:
        notes.append(
            f"Over {name_sets(hangs, listed)} the clamp presses where there is air below the part: put "
            "something under the part there, or it bends."
        )
    return notes


def name_sets(some: Sequence[int], every: Mapping[int, Triple]) -> str:
    """Return the numbers ``some`` as words, or "each" where they are all of ``every``."""
    return "each" if len(some) == len(every) else listed_words([str(number) for number in some])


def write_flat_faces_notes(
    workpiece: Workpiece, keep_off: Sequence[str], unit: Unit = MILLIMETRE
) -> list[str]:
    """Return notes on a solid that has no level face below or on top, or is treated as flat because no level
    face is known.

    Parameters
    ----------
    keep_off : see :func:`write_listing_notes`.
    """
    solid = workpiece.solid
    if solid is None:
        return []
    notes = []
    if solid.lies_on_no_face:
        notes.append(
            "The part lies on no level face, so no support can stand under it: turn another side up."
        )
    if solid.unclear_heights:
        words = describe_unclear_faces(solid.unclear_heights, unit)
        notes.append(f"{words[:1].upper()}{words[1:]}.")
    elif solid.has_no_top:
        notes.append(
            "No level face of the part is open to above, so no clamp can press on it from above: turn another "
            "side up, or hold it down by other means."
        )
    levels = (("bottom", solid.bottom, keep_off[0]), ("top", solid.top, keep_off[1]))
    lacking = [(name, off) for name, loops, off in levels if loops is None]
    if not lacking:
        return notes
    sides, off = (" and ".join(words) for words in zip(*lacking, strict=True))
    return [
        *notes,
        f"It is not known which faces at the part's {sides} are level, so all of it counts as "
        f"flat as far as the outline goes: keep pads and tip off the rest with {off}.",
    ]
