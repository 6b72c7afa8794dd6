"""The command ``supports``: three supports under a fixture, and where a clamp on top presses down."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TextIO

import typer
from attrs import asdict

from workhold.cli.commands import option, print_remark
from workhold.cli.declared import read_zone
from workhold.cli.ending import INTERRUPTED, ask_to_stop
from workhold.cli.options import SHOWN_UNIT, RankArgument, ResultArgument, asked_rank, result_with
from workhold.cli.outputs import FORCE, JSON, print_json, refuse_output
from workhold.cli.progress import progress_bar
from workhold.cli.search_options import FRICTION, JAW_FORCE
from workhold.cli.setup_sheets import PART_FILE, asked_models, write_bodies
from workhold.cli.support_words import (
    friction_words,
    size_notes,
    spatial_load,
    stopped_words,
    supported_within,
    with_friction,
)
from workhold.cli.table import Table, print_tables
from workhold.cli.values import (
    length,
    length_unit,
    optional_count,
    optional_force,
    optional_length,
    positive_number,
    printed_unit,
)
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.result import Result
    from workhold.model.support_triples import Supports, Triple
    from workhold.model.workpiece import Workpiece
    from workhold.units import Unit

__all__ = ["asked_thickness", "report_supported", "supports"]

# Fixtures for which a search looks for supports.
MOST_SUPPORTED = 20
# What keeps pads and the clamp off places.
KEEP_OFF = ("--keep-out-below", "--keep-out-above")
PART, SUPPORTS, CLAMP = "Heights of the part", "Supports", "The clamp on top"


def supports(
    result_file: ResultArgument,
    number_: RankArgument,
    thickness: str | None = option(PART, "LENGTH", "How thick the part is; that of its solid if not given."),
    band: str | None = option(
        PART,
        "LOW:HIGH",
        "Heights at which pegs may press on its faces; those of its solid, or all, if not given.",
    ),
    pad_radius: str | None = option(
        SUPPORTS,
        "LENGTH",
        "Radius of the supports' round pads; the toolkit's, or 4mm, or less where the holes ask for it, if "
        "not given.",
    ),
    pad_margin: str | None = option(
        SUPPORTS,
        "LENGTH",
        "Least distance of a pad from the border of the face below; the toolkit's, or 0mm, if not given.",
    ),
    keep_out_below: list[str] | None = option(
        SUPPORTS, "ZONE", "A place that no pad may stand under, circle=X,Y,RADIUS or polygon=X,Y;X,Y;X,Y."
    ),
    tip_radius: str | None = option(
        CLAMP, "LENGTH", "Radius of the clamp's round tip; the toolkit's, or 5mm, if not given."
    ),
    inside: str | None = option(
        CLAMP,
        "LENGTH",
        "Least distance of the clamp from the triangle's sides; the toolkit's, or the tip's radius, if not "
        "given.",
    ),
    tip_margin: str | None = option(
        CLAMP,
        "LENGTH",
        "Least distance of the tip from the border of its face; the toolkit's, or 0mm, if not given.",
    ),
    head_radius: str | None = option(
        CLAMP,
        "LENGTH",
        "Radius of the clamp's head, within which nothing of the part rises above the face; the toolkit's, or "
        "one and a half times the tip's, if not given.",
    ),
    keep_out_above: list[str] | None = option(
        CLAMP, "ZONE", "A place that the tip may not stand on, such as where the cutter goes."
    ),
    reach: list[str] | None = option(
        CLAMP,
        "X,Y,LEAST,MOST",
        "A ring about a point of the toolkit in which the tip can stand; the toolkit's, or everywhere, if "
        "not given.",
    ),
    clamp_at: str | None = option(CLAMP, "X,Y", "Where the clamp presses; its best place if not given."),
    load: list[str] | None = option(
        "Loads",
        "LOAD",
        "A load as in show, and with it z=HEIGHT or z=LOW..HIGH, axial=FORCE or axial=LOW..HIGH downward, "
        "and tilt=ABOUTX,ABOUTY; those of the result, at the part's upper side, if not given.",
    ),
    jaw_force: str | None = JAW_FORCE,
    friction: str | None = FRICTION,
    triples: str = option(None, "K", "How many sets of three to list.", default="3"),
    out: str | None = option(None, "FILE", "Write all sets of three, with every figure, into this file."),
    glb: str | None = option(
        None, "FILE", "Write the fixture on the best set in three dimensions into this .glb file."
    ),
    step: str | None = option(None, "FILE", "The same as a STEP assembly, for CAM, into this .step file."),
    support_height: str | None = option(
        SUPPORTS,
        "LENGTH",
        "How far supports stand out of the plates, in --glb and --step; the toolkit's, or 10mm, if not "
        "given.",
    ),
    part: str | None = PART_FILE,
    force: bool = FORCE,
    unit: str | None = SHOWN_UNIT,
    json_: bool = JSON,
) -> None:
    """Report where three supports hold the part up under fixture N, and where a clamp presses it down.

    Pegs hold a part in the plane and resist no tipping. Three supports and a clamp inside their triangle do,
    at whatever heights the pegs press. The sets are in order of the clamp force that the loads ask for.

    Example: workhold supports part.json 1 --thickness 12 --load "force=150 at=20,15 z=8..12 axial=-20..60"
    """
    rank = asked_rank(number_)
    shown = length_unit(unit)
    count = optional_count("--triples", triples)
    closing = optional_force("--jaw-force", jaw_force)
    coefficient = None if friction is None else positive_number("--friction", friction)
    if out is not None:
        refuse_output(out, (result_file,), force)
    models = asked_models(glb, step, (result_file, part), force, support_height=support_height, part=part)
    raised = optional_length("--support-height", support_height, shown)
    result = result_with(result_file, rank)
    printed = printed_unit(unit, result.toolkit)
    from workhold.supports.asking import requests_by_size, supported_by_size

    high = asked_thickness(True, thickness, result.workpiece, shown)
    assert high is not None
    own = {
        "pad_radius": optional_length("--pad-radius", pad_radius, shown),
        "pad_margin": optional_length("--pad-margin", pad_margin, shown),
        "tip_radius": optional_length("--tip-radius", tip_radius, shown),
        "inside": optional_length("--inside", inside, shown),
        "tip_margin": optional_length("--tip-margin", tip_margin, shown),
        "head_radius": optional_length("--head-radius", head_radius, shown),
        "reach": [lengths("--reach", text, ",", 4, shown) for text in reach] if reach else None,
        "band": None if band is None else lengths("--band", band, ":", 2, shown),
        "bottom_zones": [read_zone(KEEP_OFF[0], text, shown) for text in keep_out_below or ()],
        "top_zones": [read_zone(KEEP_OFF[1], text, shown) for text in keep_out_above or ()],
        "point": None if clamp_at is None else lengths("--clamp-at", clamp_at, ",", 2, shown),
    }
    asked = {name: value for name, value in own.items() if value is not None}
    request, *smaller = requests_by_size(result.query, high, asked)
    request.refuse_fat_pads(result.toolkit)
    loads = [spatial_load(text, high, shown) for text in load] if load else None
    with (
        ask_to_stop("the best of what was looked at is kept") as cancel,
        progress_bar("Looking for supports", "of 1 fixture") as show,
    ):
        (found,), _ = supported_by_size(
            [result[rank - 1]],
            result.query,
            [request, *smaller],
            loads,
            closing,
            count if out is None else None,
            cancel=cancel,
            progress=lambda fraction: show(fraction, 0),
        )
    if found.triples and found.request.pad_radius < request.pad_radius:
        pad, tip = printed.text(found.request.pad_radius), printed.text(found.request.tip_radius)
        print_remark(f"the usual sizes find no place: the pads have a radius of {pad}, the tip one of {tip}.")
    helped = with_friction(found, count, coefficient)
    if out is not None:
        from workhold.files.supports_file import write_supports

        write_supports(found, out, overwrite=True)
    if models:
        from workhold.model.support_triples import ChosenSupports
        from workhold.presenting.assembly import Assembly, shape_in

        if not found.triples:
            from workhold.supports.words import why_no_set

            why = why_no_set(found, printed)
            raise InputError(f"{why[:1].lower()}{why[1:]}")
        best, shape = ChosenSupports.of(found), shape_in(part, result.workpiece)
        assembly = Assembly.of(result[rank - 1], result, {"support_height": raised}, best, shape)
        write_bodies(assembly, models, shown)
    written = [path for path in (out, glb, step) if path is not None]
    report(found, count, rank, written, printed, json_, coefficient, helped)
    if found.stopped:
        raise typer.Exit(INTERRUPTED)


def asked_thickness(wanted: bool, text: str | None, workpiece: Workpiece, unit: Unit) -> float | None:
    """How thick a part is in mm, where supports are wanted: as it is said, or as its solid is high.

    Refuses where nobody knows, or it is said of a solid without supports.
    """
    if not wanted:
        if text is not None and workpiece.solid is not None:
            raise InputError("how thick the part is, its solid says: leave --thickness out.")
        return None
    solid = workpiece.solid
    high = optional_length("--thickness", text, unit) or (None if solid is None else solid.height)
    if high is None:
        raise InputError("how thick the part is, is not known: give --thickness.")
    return high


def report_supported(result: Result, thickness: float, unit: Unit, stream: TextIO) -> tuple[Supports, ...]:
    """Prints which three supports hold up the best fixtures of a result best, if any do, and returns them.

    They are of the usual sizes, or where these hold up none of the fixtures, of smaller ones.
    """
    from workhold.supports.asking import requests_by_size
    from workhold.supports.words import flat_faces_notes, place_notes, set_headings, set_row

    fixtures = [result[k] for k in range(min(MOST_SUPPORTED, len(result)))]
    if not fixtures:
        return ()
    requests = requests_by_size(result.query, thickness)
    found, usual = supported_within(fixtures, result.query, requests)
    with_loads = result.query.is_loaded
    table = Table((">rank", *set_headings(unit, with_loads)))
    for rank, one in enumerate(found, 1):
        if one.triples:
            table.add_row(str(rank), *set_row(one.triples[0], unit, with_loads))
    bare = [rank for rank, one in enumerate(found, 1) if not one.triples and not one.stopped]
    notes = size_notes(found, usual, bare, unit)
    if found[-1].stopped:
        notes.append(stopped_words(len(found), len(fixtures)))
    best = [triple for one in found for triple in one.triples]
    print_tables(
        "",
        *([table] if table.rows else []),
        *notes,
        *place_notes({rank: one.triples[0] for rank, one in enumerate(found, 1) if one.triples}),
        *before_first(best),
        *flat_faces_notes(result.workpiece, KEEP_OFF, unit),
        stream=stream,
    )
    return found


def before_first(listed: Sequence[Triple]) -> list[str]:
    """Says how holes before column A or row 1 are named, where there are such."""
    if all(min(pad.column, pad.row) >= 0 for triple in listed for pad in triple.supports):
        return []
    return ["A hole before column A or row 1 stands as (column,row), where A1 is (1,1)."]


def lengths(name: str, text: str, mark: str, count: int, unit: Unit) -> tuple[float, ...]:
    """Some lengths in mm with a mark between them."""
    words = text.split(mark)
    if len(words) != count:
        raise InputError(f"{name} {text!r} cannot be used: give {count} lengths with {mark!r} between them.")
    return tuple(length(name, word, unit) for word in words)


def report(
    found: Supports,
    count: int | None,
    rank: int,
    written: list[str],
    unit: Unit,
    as_json: bool,
    friction: float | None,
    helped: list[float],
) -> None:
    listed = found.triples[:count]
    if as_json:
        rows = [asdict(triple) for triple in listed]
        counts = {"positions": found.positions, "sets": found.count}
        more = {} if friction is None else {"friction": friction, "needed_with_friction": helped}
        print_json(fixture=rank, jaw_force=found.jaw_force, **counts, triples=rows, written=written, **more)
        return
    if not found.triples:
        from workhold.supports.words import why_no_set

        print_tables(f"Fixture {rank}: {why_no_set(found, unit)}")
    else:
        print_sets(found, listed, rank, unit)
        if friction is not None:
            print_tables(friction_words(friction, helped, unit))
    if found.count is not None and found.count > len(listed) and not written:
        print_remark("more sets can be listed with --triples, and written into a file with --out.")
    if written:
        print_tables(f"Written to {', '.join(written)}.")
    if found.stopped:
        print_remark("stopped before all sets were looked at: there may be better ones.")


def print_sets(found: Supports, listed: Sequence[Triple], rank: int, unit: Unit) -> None:
    from workhold.supports.words import set_headings, set_row

    with_loads = bool(found.loads)
    table = Table((">set", *set_headings(unit, with_loads)))
    for place, triple in enumerate(listed, 1):
        table.add_row(str(place), *set_row(triple, unit, with_loads))
    number_of = "" if found.count is None else f" of {found.count}"
    head = f"Fixture {rank}: the best {len(listed)}{number_of} sets of three supports and a clamp on top."
    print_tables(head, table, *notes_of(found, listed, unit))


def notes_of(found: Supports, listed: Sequence[Triple], unit: Unit) -> list[str]:
    from workhold.conventions import STEADY
    from workhold.supports.words import listing_notes

    notes = [
        "The clamp presses at that point of the part's coordinates. Its force times the tipping arm is the "
        f"moment that tips the part; where the last figure is at least {unit.text(STEADY)}, the part stands "
        "before it is clamped."
    ]
    return notes + before_first(listed) + listing_notes(found, listed, unit, KEEP_OFF)
