"""The command ``supports``: three supports under a fixture, and where a clamp on top presses down."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TextIO

import typer
from attrs import asdict, frozen

from workhold.cli.commands import make_option, print_remark, spread_option_groups
from workhold.cli.declared import (
    make_list_attribute,
    make_option_attributes,
    make_word_attribute,
    read_separated_lengths,
    read_words,
    read_zone,
)
from workhold.cli.ending import INTERRUPTED, set_event_on_interrupt
from workhold.cli.options import SHOWN_UNIT, RankArgument, ResultArgument, read_rank, read_result_with_rank
from workhold.cli.outputs import FORCE, JSON, print_json, refuse_output
from workhold.cli.progress import show_progress
from workhold.cli.search_options import FRICTION, JAW_FORCE
from workhold.cli.setup_sheets import PART_FILE, list_asked_model_files, write_bodies
from workhold.cli.support_words import (
    describe_friction_gain,
    describe_stopped_search,
    find_supports_within_limit,
    list_clamp_forces_with_friction,
    note_support_sizes,
    read_spatial_load,
)
from workhold.cli.table import Table, print_tables
from workhold.cli.values import (
    choose_printed_unit,
    read_optional_count,
    read_optional_force,
    read_optional_length,
    read_positive_number,
    read_unit,
)
from workhold.errors import InputError
from workhold.fixels.support_hardware import CLAMP, CLAMP_SECTION, PADS, SUPPORTS_SECTION

if TYPE_CHECKING:
    from pathlib import Path

    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.model.support_request import SpatialLoad, SupportRequest
    from workhold.model.support_triples import Supports, Triple
    from workhold.model.workpiece import Workpiece
    from workhold.units import Unit

__all__ = ["read_asked_thickness", "report_supported", "supports"]

# Fixtures for which a search looks for supports.
MOST_SUPPORTED = 20
# What keeps pads and the clamp off places.
KEEP_OFF = ("--keep-out-below", "--keep-out-above")
PART = "Heights of the part"


THICKNESS = make_option(PART, "LENGTH", "Thickness of the part; that of its solid if not given.")
BAND = make_option(
    PART,
    "LOW:HIGH",
    "Heights at which pegs may press on the part's faces. If not given, the heights of its solid, or all heights.",
)
BELOW = make_option(
    SUPPORTS_SECTION, "ZONE", "A place that no pad may stand under, circle=X,Y,RADIUS or polygon=X,Y;X,Y;X,Y."
)
ABOVE = make_option(
    CLAMP_SECTION, "ZONE", "A place on which the tip may not stand, such as where the cutter goes."
)
CLAMP_AT = make_option(CLAMP_SECTION, "X,Y", "Place of the clamp; the best one if not given.")
LOADS_IN_SPACE = make_option(
    "Loads",
    "LOAD",
    "A load as in show, with these words besides: z=HEIGHT or z=LOW..HIGH, axial=FORCE or "
    "axial=LOW..HIGH downward, and tilt=ABOUTX,ABOUTY. If not given, the loads of the result "
    "act at the part's upper side.",
)
SUPPORT_HEIGHT = make_option(
    SUPPORTS_SECTION,
    "LENGTH",
    "Standout of the supports above the plates, in --glb and --step; the toolkit's, or 10mm, if not given.",
)
# What is asked of supports and of the clamp, as toolkits have it.
OF_HARDWARE = [row for table in (PADS, CLAMP) for row in table.fields if row.typed]


@frozen(
    these=make_option_attributes(
        OF_HARDWARE,
        pad_radius={"thickness": make_word_attribute(THICKNESS), "band": make_word_attribute(BAND)},
        tip_radius={
            "keep_out_below": make_list_attribute(BELOW),
            "support_height": make_word_attribute(SUPPORT_HEIGHT),
        },
        reach={"keep_out_above": make_list_attribute(ABOVE)},
        clamp_at=make_word_attribute(CLAMP_AT),
        load=make_list_attribute(LOADS_IN_SPACE),
        jaw_force=make_word_attribute(JAW_FORCE),
        friction=make_word_attribute(FRICTION),
    )
)
class SupportOptions:
    """The options of supports and the clamp on top, as typed; None for those not given."""

    if TYPE_CHECKING:
        thickness: str | None
        band: str | None
        keep_out_below: list[str] | None
        support_height: str | None
        keep_out_above: list[str] | None
        clamp_at: str | None
        load: list[str] | None
        jaw_force: str | None
        friction: str | None

    def read_sizes(self, unit: Unit) -> dict[str, Any]:
        """Return the fields of a ``SupportRequest``
        (``model.support_request``) that were given, lengths in mm.
        """
        own = read_words(OF_HARDWARE, self, unit) | {
            "band": None if self.band is None else read_separated_lengths("--band", self.band, ":", 2, unit),
            "bottom_zones": [read_zone(KEEP_OFF[0], text, unit) for text in self.keep_out_below or ()],
            "top_zones": [read_zone(KEEP_OFF[1], text, unit) for text in self.keep_out_above or ()],
            "point": None
            if self.clamp_at is None
            else read_separated_lengths("--clamp-at", self.clamp_at, ",", 2, unit),
        }
        return {name: value for name, value in own.items() if value is not None}


@frozen
class SupportsTask:
    """A search for supports, and where its answer goes.

    Parameters
    ----------
    count : number of sets of three that are listed; None for all.
    closing : jaw force in N; None for the force that is needed.
    raised : height in mm of the supports above the plates.
    models : files to write in three dimensions.
    part : STEP file with the part's own shape, for the models.
    unit, printed : unit of lengths typed, and of lengths shown.
    """

    result: Result
    rank: int
    request: SupportRequest
    smaller: Sequence[SupportRequest]
    loads: list[SpatialLoad] | None
    count: int | None
    closing: float | None
    friction: float | None
    raised: float | None
    out: str | None
    models: Sequence[Path]
    part: str | None
    unit: Unit
    printed: Unit

    @property
    def fixture(self) -> Fixture:
        """The fixture of the rank."""
        return self.result[self.rank - 1]


@spread_option_groups
def supports(
    result_file: ResultArgument,
    number_: RankArgument,
    *,
    words: SupportOptions,
    triples: str = make_option(None, "K", "Number of sets of three to list.", default="3"),
    out: str | None = make_option(
        None, "FILE", "Write all sets of three, with every figure, into this file."
    ),
    glb: str | None = make_option(
        None, "FILE", "Write the fixture on the best set in three dimensions into this .glb file."
    ),
    step: str | None = make_option(
        None, "FILE", "The same as a STEP assembly, for CAM, into this .step file."
    ),
    part: str | None = PART_FILE,
    force: bool = FORCE,
    unit: str | None = SHOWN_UNIT,
    json_: bool = JSON,
) -> None:
    """Report where three supports hold the part up under fixture N, and where a clamp presses it down.

    Pegs hold a part in the plane, but they do not keep it from tipping. Three supports do, with a clamp that
    presses inside their triangle, whatever the heights at which the pegs press. The list begins with the set
    whose clamp needs the least force under the loads.

    Example: workhold supports part.json 1 --thickness 12 --load "force=150 at=20,15 z=8..12 axial=-20..60"
    """
    rank = read_rank(number_)
    count = read_optional_count("--triples", triples)
    if out is not None:
        refuse_output(out, (result_file,), force)
    raised = words.support_height
    models = list_asked_model_files(glb, step, (result_file, part), force, support_height=raised, part=part)
    asked = parse(result_file, rank, words, count, out, models, part, unit)
    found = find_supports_of_fixture(asked)
    helped = list_clamp_forces_with_friction(found, count, asked.friction)
    write(asked, found)
    written = [path for path in (out, glb, step) if path is not None]
    report(found, count, rank, written, asked.printed, json_, asked.friction, helped)
    if found.stopped:
        raise typer.Exit(INTERRUPTED)


def parse(
    result_file: str,
    rank: int,
    words: SupportOptions,
    count: int | None,
    out: str | None,
    models: Sequence[Path],
    part: str | None,
    unit: str | None,
) -> SupportsTask:
    """Return what was typed as a task, with the result read."""
    shown = read_unit(unit)
    closing = read_optional_force("--jaw-force", words.jaw_force)
    friction = None if words.friction is None else read_positive_number("--friction", words.friction)
    raised = read_optional_length("--support-height", words.support_height, shown)
    result = read_result_with_rank(result_file, rank)
    from workhold.supports.asking import try_smaller_requests

    high = read_asked_thickness(True, words.thickness, result.workpiece, shown)
    assert high is not None
    request, *smaller = try_smaller_requests(result.query, high, words.read_sizes(shown))
    request.refuse_fat_pads(result.toolkit)
    loads = [read_spatial_load(text, high, shown) for text in words.load] if words.load else None
    printed = choose_printed_unit(unit, result.toolkit)
    return SupportsTask(
        result,
        rank,
        request,
        smaller,
        loads,
        count,
        closing,
        friction,
        raised,
        out,
        models,
        part,
        shown,
        printed,
    )


def find_supports_of_fixture(asked: SupportsTask) -> Supports:
    """Return the supports found, with smaller pads if there is no place for pads of the usual size.

    After Ctrl-C, return the best found so far.
    """
    from workhold.supports.asking import support_with_smaller_sizes

    with (
        set_event_on_interrupt("the best of the sets so far is kept") as cancel,
        show_progress("Looking for supports", "of 1 fixture") as show,
    ):
        (found,), _ = support_with_smaller_sizes(
            [asked.fixture],
            asked.result.query,
            [asked.request, *asked.smaller],
            asked.loads,
            asked.closing,
            asked.count if asked.out is None else None,
            cancel=cancel,
            progress=lambda fraction: show(fraction, 0),
        )
    if found.triples and found.request.pad_radius < asked.request.pad_radius:
        pad, tip = (
            asked.printed.format_length(found.request.pad_radius),
            asked.printed.format_length(found.request.tip_radius),
        )
        print_remark(
            f"the usual sizes find no place, so the pads have a radius of {pad} and the tip one of {tip}."
        )
    return found


def write(asked: SupportsTask, found: Supports) -> None:
    """Write the file of supports, and the bodies of the best set;
    raise InputError for bodies where there is no set.
    """
    if asked.out is not None:
        from workhold.files.supports_file import write_supports

        write_supports(found, asked.out, overwrite=True)
    if not asked.models:
        return
    from workhold.model.support_triples import ChosenSupports
    from workhold.presenting.assembly import Assembly, read_part_shape

    if not found.triples:
        from workhold.supports.words import explain_no_set

        why = explain_no_set(found, asked.printed)
        raise InputError(f"{why[:1].lower()}{why[1:]}")
    best, shape = ChosenSupports.from_supports(found), read_part_shape(asked.part, asked.result.workpiece)
    lengths = {"support_height": asked.raised}
    write_bodies(
        Assembly.from_fixture(asked.fixture, asked.result, lengths, best, shape), asked.models, asked.unit
    )


def read_asked_thickness(wanted: bool, text: str | None, workpiece: Workpiece, unit: Unit) -> float | None:
    """Return the thickness of a part in mm: as typed, else its solid's height; None where supports are not
    wanted.

    Raises InputError where neither is known, and for a thickness typed for a solid where supports are not
    wanted.
    """
    if not wanted:
        if text is not None and workpiece.solid is not None:
            raise InputError("the solid gives the part's thickness: leave --thickness out.")
        return None
    solid = workpiece.solid
    high = read_optional_length("--thickness", text, unit) or (None if solid is None else solid.height)
    if high is None:
        raise InputError("the thickness of the part is not known: give --thickness.")
    return high


def report_supported(result: Result, thickness: float, unit: Unit, stream: TextIO) -> tuple[Supports, ...]:
    """Print the best three supports of each of the best twenty fixtures, and return the supports of all of
    these.

    The supports are of the usual sizes or, where these hold up none of the fixtures, of smaller ones.
    """
    from workhold.supports.asking import try_smaller_requests
    from workhold.supports.words import format_set_row, list_set_headings, place_notes, write_flat_faces_notes

    fixtures = [result[k] for k in range(min(MOST_SUPPORTED, len(result)))]
    if not fixtures:
        return ()
    requests = try_smaller_requests(result.query, thickness)
    found, usual = find_supports_within_limit(fixtures, result.query, requests)
    with_loads = result.query.is_loaded
    table = Table((">rank", *list_set_headings(unit, with_loads)))
    for rank, one in enumerate(found, 1):
        if one.triples:
            table.add_row(str(rank), *format_set_row(one.triples[0], unit, with_loads))
    bare = [rank for rank, one in enumerate(found, 1) if not one.triples and not one.stopped]
    notes = note_support_sizes(found, usual, bare, unit)
    if found[-1].stopped:
        notes.append(describe_stopped_search(len(found), len(fixtures)))
    best = [triple for one in found for triple in one.triples]
    print_tables(
        "",
        *([table] if table.rows else []),
        *notes,
        *place_notes({rank: one.triples[0] for rank, one in enumerate(found, 1) if one.triples}),
        *explain_holes_before_first(best),
        *write_flat_faces_notes(result.workpiece, KEEP_OFF, unit),
        stream=stream,
    )
    return found


def explain_holes_before_first(listed: Sequence[Triple]) -> list[str]:
    """Return a sentence on how holes before column A or row 1 are named; [] where no set uses one."""
    if all(min(pad.column, pad.row) >= 0 for triple in listed for pad in triple.supports):
        return []
    return ["A hole before column A or row 1 is written as (column,row), where A1 is (1,1)."]


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
    """Print the sets listed, as tables or JSON, what friction could add, and what was written."""
    listed = found.triples[:count]
    if as_json:
        rows = [asdict(triple) for triple in listed]
        counts = {"positions": found.positions, "sets": found.count}
        more = {} if friction is None else {"friction": friction, "needed_with_friction": helped}
        print_json(fixture=rank, jaw_force=found.jaw_force, **counts, triples=rows, written=written, **more)
        return
    if not found.triples:
        from workhold.supports.words import explain_no_set

        print_tables(f"Fixture {rank}: {explain_no_set(found, unit)}")
    else:
        print_sets(found, listed, rank, unit)
        if friction is not None:
            print_tables(describe_friction_gain(friction, helped, unit))
    if found.count is not None and found.count > len(listed) and not written:
        print_remark("more sets can be listed with --triples, and written into a file with --out.")
    if written:
        print_tables(f"Written to {', '.join(written)}.")
    if found.stopped:
        print_remark("stopped before all sets were examined: there may be better ones.")


def print_sets(found: Supports, listed: Sequence[Triple], rank: int, unit: Unit) -> None:
    """Print a table of the sets listed and notes on them."""
    from workhold.supports.words import format_set_row, list_set_headings

    with_loads = bool(found.loads)
    table = Table((">set", *list_set_headings(unit, with_loads)))
    for place, triple in enumerate(listed, 1):
        table.add_row(str(place), *format_set_row(triple, unit, with_loads))
    number_of = "" if found.count is None else f" of {found.count}"
    head = f"Fixture {rank}: the best {len(listed)}{number_of} sets of three supports and a clamp on top."
    print_tables(head, table, *list_support_notes(found, listed, unit))


def list_support_notes(found: Supports, listed: Sequence[Triple], unit: Unit) -> list[str]:
    """Return sentences on how to read the table of sets, and on the holes and faces used."""
    from workhold.conventions import STEADY
    from workhold.supports.words import write_listing_notes

    notes = [
        "The clamp presses at this point of the part's coordinates. Its force times the tipping "
        "arm is the tipping moment that it resists. If the last figure is at least "
        f"{unit.format_length(STEADY)}, the part stands before it is clamped."
    ]
    return notes + explain_holes_before_first(listed) + write_listing_notes(found, listed, unit, KEEP_OFF)
