"""Reading of loads in space, and sentences on supports: their sizes, reasons why there are none, and the gain
by friction.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

from workhold.cli.progress import show_progress
from workhold.cli.search_options import parse_load
from workhold.cli.table import format_count
from workhold.cli.values import read_number
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.fixture import Fixture
    from workhold.model.query import Query
    from workhold.model.support_request import SpatialLoad, SupportRequest
    from workhold.model.support_triples import Supports
    from workhold.units import Unit

__all__ = [
    "describe_friction_gain",
    "note_support_sizes",
    "read_spatial_load",
    "describe_stopped_search",
    "find_supports_within_limit",
    "list_clamp_forces_with_friction",
]

# Places of pads and clamp that are looked at under several fixtures, half a minute's work.
MOST_PLACES = 100_000_000


def find_supports_within_limit(
    fixtures: Sequence[Fixture], query: Query, requests: Iterable[SupportRequest], **how: Any
) -> tuple[tuple[Supports, ...], tuple[Supports, ...]]:
    """Return (best supports, best supports of the usual sizes) for each fixture, as far as a limit of work
    allows.

    Arguments and values are those of :func:`workhold.supports.asking.support_with_smaller_sizes`. A bar shows
    progress.
    """
    from workhold.supports.asking import support_with_smaller_sizes
    from workhold.supports.choosing import WorkLimit

    with show_progress("Looking for supports", f"of {format_count(len(fixtures), 'fixture')}") as show:

        def progress(fraction: float) -> None:
            show(fraction, int(fraction * len(fixtures)))

        return support_with_smaller_sizes(
            fixtures, query, requests, cancel=WorkLimit(MOST_PLACES), progress=progress, **how
        )


def describe_stopped_search(last: int, count: int) -> str:
    """Return a sentence on a search of supports that stopped early: the last fixture done, those left out,
    and how to get them.

    ``last`` is the rank of that fixture, ``count`` the number of fixtures asked for.
    """
    skipped = list(range(last + 1, count + 1))
    rest = f", and under {format_number_runs(skipped)} at none" if skipped else ""
    return (
        f"Pads and clamp have so many places that the search stopped after {MOST_PLACES:,}: under "
        f"{last} it did not look at all sets{rest}. The command supports looks at all sets under "
        "one fixture."
    )


def format_number_runs(numbers: Sequence[int]) -> str:
    """Return ascending numbers as text, three and more consecutive ones as a range.

    Examples
    --------
    >>> format_number_runs([1, 3, 4, 6, 7, 8, 20])
    '1, 3, 4, 6 to 8, 20'
    """
    runs: list[list[int]] = []
    for rank in numbers:
        if runs and rank == runs[-1][-1] + 1:
            runs[-1].append(rank)
        else:
            runs.append([rank])
    words = (f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs)
    return ", ".join(words)


def note_support_sizes(
    found: Sequence[Supports], usual: Sequence[Supports], bare: Sequence[int], unit: Unit
) -> list[str]:
    """Return sentences on the sizes of the supports found, and on why some fixtures have none.

    Parameters
    ----------
    found, usual : for each fixture in order, its supports listed, and its supports of the usual sizes.
    bare : ranks of the fixtures without supports in ``found``.
    """
    from workhold.supports.words import explain_no_set

    pad, tip = (
        unit.format_length(found[0].request.pad_radius),
        unit.format_length(found[0].request.tip_radius),
    )
    if len(bare) == len(found):
        larger = unit.format_length(usual[0].request.pad_radius)
        sizes = f"pads of radius {pad}" if found is usual else f"pads of radius {larger} down to {pad}"
        which = "usual" if found is usual else "least"
        return [
            f"Under {format_number_runs(bare)} no three supports hold the part, with {sizes}.",
            f"Under {bare[0]}, with the {which} sizes: {explain_no_set(found[0], unit)}",
        ]
    notes = [
        f"Pads of radius {pad} and a tip of radius {tip}; the command supports lists more, with other sizes."
    ]
    if bare:
        notes.append(f"Under {format_number_runs(bare)} no three supports hold the part.")
    if found is not usual:
        notes.append(
            "Larger pads and tips hold the part under none of these fixtures. Under 1: "
            f"{explain_no_set(usual[0], unit)}"
        )
    elif bare:
        notes.append(f"Under {bare[0]}: {explain_no_set(found[bare[0] - 1], unit)}")
    return notes


def list_clamp_forces_with_friction(
    found: Supports, count: int | None, friction: float | None
) -> list[float]:
    """Return for each of the first ``count`` sets (all for None) the least clamp force in N with friction.

    It is [] where ``friction`` is None. Raises InputError without loads, and for a coefficient that is too
    large.
    """
    if friction is None:
        return []
    if not found.loads:
        raise InputError("--friction needs loads: give --load too.")
    return [found.bound_clamp_force(friction, rank) for rank in range(1, len(found.triples[:count]) + 1)]


def describe_friction_gain(friction: float, helped: list[float], unit: Unit) -> str:
    """Return sentences on how far friction could reduce the clamp force.

    ``helped`` are the least clamp forces in N with friction, one for each set listed.
    """
    forces = ", ".join(unit.format_force(force) for force in helped)
    sets = "that set" if len(helped) == 1 else "these sets, in their order,"
    return (
        f"With a friction of {friction:g} at every contact the clamp of {sets} could hold with "
        f"{forces} at best. With friction the forces are not determined: clamp with the force "
        "without friction."
    )


def read_spatial_load(text: str, thickness: float, unit: Unit) -> SpatialLoad:
    """Return a load in space from the text of ``--load``: words of a planar load, and height, axial force and
    tilt.

    Without a height it acts at the part's upper side, ``thickness`` mm above its lower one.
    """
    from workhold.model.support_request import SpatialLoad

    place = f'--load "{text}"'
    own, rest = dict[str, str](), list[str]()
    for word in text.split():
        key, _, value = word.partition("=")
        if key in ("z", "axial", "tilt"):
            own[key] = value
        else:
            rest.append(word)
    acts = any(word.startswith(("force=", "moment=")) for word in rest)
    try:
        planar = parse_load(" ".join(rest if acts else [*rest, "force=1"]), unit.millimetres)
    except InputError as error:
        raise InputError(str(error).replace(" force=1", "")) from error
    heights = read_number_range(place, own.get("z"), (thickness, thickness))
    scale = unit.millimetres
    tilt = own.get("tilt", "0,0").split(",")
    if len(tilt) != 2:
        raise InputError(f"{place} cannot be used at 'tilt': give tilt=ABOUTX,ABOUTY in N mm.")
    return SpatialLoad(
        points=planar.points,
        heights=(heights[0] * scale, heights[1] * scale) if "z" in own else heights,
        force=planar.force if acts else 0.0,
        directions=planar.directions,
        axial=read_number_range(place, own.get("axial"), (0.0, 0.0)),
        moment=planar.moment,
        tilt=(read_number(tilt[0]), read_number(tilt[1])),
        name=planar.name,
    )


def read_number_range(place: str, text: str | None, usual: tuple[float, float]) -> tuple[float, float]:
    """Return (low, high) from one number or LOW..HIGH,
    ``usual`` for None; raise InputError for anything else.
    """
    if text is None:
        return usual
    low, _, high = text.partition("..")
    found = read_number(low), read_number(high or low)
    if not all(map(isfinite, found)):
        raise InputError(f"{place} cannot be used at '{text}': give a number, or a range LOW..HIGH.")
    return found
