"""Tables and sentences for the terminal: of results, fixtures, and solids seen at the height of the pegs."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, hypot, inf, nan, pi
from typing import TYPE_CHECKING

from workhold.cli.hold_tables import explain_first_hold, tabulate_hold_setup, tabulate_holds
from workhold.cli.table import Table, format_count
from workhold.fixels.contacts import FLAT_PIN
from workhold.model.solid import flip_up_axis
from workhold.presenting.figure_words import (
    find_edgeless_distance,
    find_figure_unit,
    format_figure_number,
    format_ranked_figure,
    format_rounded,
    group_peg_columns,
    list_shown_figures,
    make_short_heading,
    mark_edgeless,
    name_peg_place,
)
from workhold.units import MILLIMETRE, Unit

if TYPE_CHECKING:
    from workhold.fixels.toolkit import Toolkit
    from workhold.geometry.loop import Face
    from workhold.listing.identity import ShownEntries
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.model.search_report import ProofReport
    from workhold.model.setup import LengthSetting
    from workhold.model.solid import FileSolid, HeightRow
    from workhold.model.workpiece import Workpiece

__all__ = [
    "tabulate_face_heights",
    "count_fixtures_in_words",
    "tabulate_faces",
    "tabulate_fixture_setup",
    "tabulate_peg_heights",
    "explain_missing_face_numbers",
    "suggest_other_heights",
    "describe_proof_and_undecided",
    "tabulate_quality",
    "tabulate_result",
    "explain_sliding_part",
    "tabulate_solids",
    "describe_part_overhang",
    "count_unfit_in_words",
]

# Numbers of further pieces of faces that are named on the terminal.
MOST_FURTHER = 8
# Undecided candidates, and other heights of the pegs, that are named on the terminal.
MOST_NAMED = 3
UNDECIDED = (
    "  Every fixture in the list holds the part; one more may exist at such a place. Nearly "
    "equal sizes cause this: another peg radius or pitch decides it."
)


def count_fixtures_in_words(result: Result) -> str:
    """Return a phrase on how many fixtures there are, of which type,
    and how many are distinct under the part's symmetry.
    """
    total = sum(result.found.values())
    kinds = ", ".join(f"{count} of type {kind}" for kind, count in result.found.items())
    of_types = f": {kinds}" if len(result.toolkit.types) > 1 else ""
    found = f"{format_count(total, 'fixture')}{of_types}"
    if result.pairs is not None and result.seats is not None:
        each = f", the best of {format_count(result.pairs, 'pair')} of clamps at each seat"
        found += each if result.query.listing == "best" else f" at {format_count(result.seats, 'seat')}"
    sentence = f"{found}; {sum(result.distinct.values())} distinct under the part's symmetry"
    if result.query.has_seating_rules:
        sentence += f"; {format_count(len(result), 'fixture')} of the first {result.query.seating} listed for their seating"
    elif len(result) < total:
        sentence += f"; the best {len(result)} are kept"
    return sentence


def explain_first_fixture(result: Result, unit: Unit) -> str:
    """Return a sentence on why the first fixture is ranked first; "" where the usual order is not used."""
    if result.holds:
        return explain_first_hold(result, unit)
    from workhold.statics.why_first import explain_why_first

    return explain_why_first(result, unit)


def count_unfit_in_words(unfit: int, toolkit: Toolkit | None = None) -> str:
    """Return a sentence on how many fixtures are hidden as unfit for a workshop, why, and how to see them."""
    are = "is not a fixture" if unfit == 1 else "are not fixtures"
    why = "the part may lie anywhere, or one peg hardly holds"
    if toolkit is not None and toolkit.flat_jaws is not None:
        why = "a jaw touches a corner alone"
    elif toolkit is not None and toolkit.strap_set is not None:
        why = "no push by hand seats the part"
    return f"{unfit:,} of them {are} for a workshop ({why}) and not shown: --unfit shows them."


def describe_proof_and_undecided(result: Result, written: str | None = None) -> list[str]:
    """Return a line on the proof of the search, then lines that name the first undecided candidates.

    ``written`` is the name of the JSON file that lists all of them, or None. The list is empty without a
    proof.
    """
    proof = result.proof
    if proof is None:
        return []
    lost, sentence = len(proof.undecided), describe_proof(proof, result.complete)
    if lost == 0:
        return [f"{sentence}, none undecided."]
    named = [
        f"  Type {item.type} on faces {', '.join(map(str, item.faces))} at {item.theta_deg:.6f} degrees: "
        f"{item.reason}."
        for item in proof.undecided[:MOST_NAMED]
    ]
    if lost > MOST_NAMED:
        others = "The other one is" if lost == MOST_NAMED + 1 else f"The other {lost - MOST_NAMED} are"
        where = (
            f'under "proof" in {written}' if written else 'under "proof" in a JSON file written with --out'
        )
        named.append(f"  {others} {where}.")
    return [f"{sentence}, {lost} undecided:", *named, UNDECIDED]


def describe_proof(proof: ProofReport, complete: bool) -> str:
    """Return a phrase on how the search was proven, with the numbers of candidates."""
    settled = max(proof.escalated - len(proof.undecided), 0)
    candidates = "1 candidate" if proof.candidates == 1 else f"{proof.candidates:,} candidates"
    if proof.cells == 0:
        # The paper's algebra does not go through ranges of orientation: its candidates come from polynomials.
        head, candidates = "Proven one by one", f"{candidates} of the polynomials"
    elif not complete:
        head = "Proven so far"
    else:
        head = "Not proven throughout" if proof.undecided else "Proven"
    return f"{head}: {candidates}, {proof.verified:,} verified, {settled:,} decided by interval arithmetic"


def tabulate_result(result: Result, entries: ShownEntries, count: int, unit: Unit = MILLIMETRE) -> Table:
    """Return a table of the first ``count`` entries of a result, one line each; lengths are shown in
    ``unit``.

    Figures that fixtures are ranked by are rounded as the ranking rounds them (all but the last to two
    digits), so that the table shows the order that it is sorted in.
    """
    if result.toolkit.holds_by_friction:
        return tabulate_holds(result, entries, count, unit)
    from workhold.model.setup import list_length_settings
    from workhold.statics.judging import are_unfit

    figures, ranked = list_shown_figures(result)
    headings = [f">{make_short_heading(figure, unit)}" for figure in figures]
    toolkit = result.toolkit
    groups, opening = group_peg_columns(toolkit), f">{toolkit.moving.measure} {unit.abbreviation}"
    pairs = [">best of"] if result.query.listing == "best" else []
    columns = (">rank", ">like it", *groups, *pairs, opening, ">angle deg", *headings, "type")
    table = Table(columns, spare=max(len(headings) - (3 if result.seating else 1), 0) + 1)
    # Of two clamps there are two lengths to set, which leave less room: to choose by, fewer decimals will do.
    decimals, degrees_decimals = (unit.decimals, 3) if toolkit.closes_at_once else (unit.decimals - 2, 1)
    red, longest = (
        are_unfit(result.table.quality, result.query.tolerance),
        find_edgeless_distance(result.workpiece, toolkit),
    )
    for index, like in zip(entries.index[:count].tolist(), entries.like[:count].tolist(), strict=True):
        fixture = result[index]
        known = mark_edgeless(fixture.figures, longest)
        if red[index]:
            table.red.add(len(table.rows))
        table.add_row(
            str(index + 1),
            f"+{like:,}" if like else "",
            *(
                " ".join(name_peg_place(peg, toolkit) for peg in fixture.pegs if peg.carrier in names)
                for names in groups.values()
            ),
            *(f"{result.table.pairs[index]:,}" for _ in pairs),
            " ".join(
                unit.format_number(setting.length, decimals)
                for setting in list_length_settings(fixture, toolkit)
            ),
            format_rounded(fixture.pose.written_deg, degrees_decimals),
            *(
                (format_ranked_figure if figure in ranked[:-1] else format_figure_number)(
                    figure, known.get(figure.key, nan), unit
                )
                for figure in figures
            ),
            toolkit.find_arrangement(fixture.type, fixture.direction).title,
        )
    return table


def tabulate_quality(
    fixture: Fixture,
    mover: str,
    unit: Unit = MILLIMETRE,
    jaw_force: float | None = None,
    longest: float = inf,
) -> Table:
    """Return a table of a fixture's figures of quality with their meanings, in which ``mover`` (such as
    "jaw") is named.

    ``jaw_force`` is in N, None where unknown. An edge distance above ``longest`` mm means that there is no
    edge.
    """
    from workhold.model.quality import FIGURES, PIN_KEYS, PROGRAM_FIGURE
    from workhold.statics.bent_pegs import describe_force

    table = Table(("figure", ">value", "unit", "better", "meaning"))
    known = mark_edgeless(fixture.quality, longest)
    for figure in (*FIGURES, PROGRAM_FIGURE):
        if figure.key in known:
            of = find_figure_unit(figure, unit)
            better = "more" if figure.more_is_better else "less"
            value = format_figure_number(figure, known[figure.key], unit)
            words, meaning = figure.name_for(mover)
            if figure.key in PIN_KEYS:
                at = describe_force(jaw_force, mover, unit)
                meaning = meaning.replace(f"at the {mover} force or for each kN of it", at)
            table.add_row(words, value, of, better, meaning)
    return table


def describe_part_overhang(fixture: Fixture, result: Result, unit: Unit) -> list[str]:
    """Return up to two sentences: how the setup sheet moves the set-up to the middle of its plate, and how
    far the part hangs over.
    """
    from workhold.drawing.panel import describe_move
    from workhold.model.moved_setup import describe_overhang, find_move_to_middle, move_fixture_by_holes

    toolkit, move = result.toolkit, find_move_to_middle(fixture, result.toolkit, result.workpiece)
    words = describe_overhang(
        move_fixture_by_holes(fixture, toolkit, move), toolkit, result.workpiece, unit.format_length
    )
    moved = ""
    if move != (0, 0):
        moved = f"The setup sheet puts the whole set-up in the middle of the {toolkit.plates[0].noun}, "
        moved += f"{describe_move(move)}."
    return [said for said in (moved, words) if said]


def tabulate_fixture_setup(
    fixture: Fixture, toolkit: Toolkit, rank: int, total: int, unit: Unit = MILLIMETRE
) -> tuple[Table | str, ...]:
    """Return sentences and a table on how to set up one fixture,
    lengths in a unit; ``rank`` counts from 1.
    """
    if fixture.hold is not None:
        return tabulate_hold_setup(fixture, rank, total, unit)
    from workhold.model.setup import list_length_settings

    noun, several = toolkit.moving.noun, len(toolkit.plates) > 1
    x, y = f">x {unit.abbreviation}", f">y {unit.abbreviation}"
    per = f">force per {noun} force{' of both' * (len(fixture.travels) > 1)}"
    flats = FLAT_PIN in toolkit.contacts
    pegs = Table(("hole", noun if several else "peg", x, y, ">face", *[">flat at"] * flats, per))
    for peg in fixture.pegs:
        stands_on = peg.carrier if several else toolkit.find_carrier(peg.carrier).peg
        where = unit.format_number(peg.x), unit.format_number(peg.y)
        looks = ["" if peg.flat_deg is None else f"{format_rounded(peg.flat_deg, 2)}°"] * flats
        pegs.add_row(
            name_peg_place(peg, toolkit), stands_on, *where, peg.touched, *looks, f"{peg.force:z.3f}"
        )
    pose = fixture.pose
    return (
        f"Fixture {rank} of {total}, type {toolkit.find_arrangement(fixture.type, fixture.direction).title}",
        *(describe_length_setting(setting, unit) for setting in list_length_settings(fixture, toolkit)),
        *describe_clamp_order(fixture),
        f"The part is turned by {format_rounded(pose.written_deg, 3)} degrees, its origin lies at "
        f"{format_place((pose.x, pose.y), unit)} {unit.abbreviation} from {toolkit.datum.full}",
        pegs,
    )


def describe_length_setting(setting: LengthSetting, unit: Unit) -> str:
    """Return a sentence on a length to set."""
    mover, length = setting.carrier, unit.format_length(setting.length)
    if setting.tip is None:
        return f"{setting.name[0].upper()}{setting.name[1:]} {length}"
    place = setting.mounting.there.format(place=setting.place)
    return f"The {mover.noun}, {place}, pushes {mover.direction_words}; {setting.title} {length}"


def describe_clamp_order(fixture: Fixture) -> list[str]:
    """Return sentences on the order and forces of two clamps; [] for other fixtures."""
    from workhold.model.clamps import compute_clamp_shares, describe_tightening_order, name_clamps

    order = describe_tightening_order(fixture)
    if not order:
        return []
    each = [
        f"{share:.0%} at {name}"
        for name, share in zip(name_clamps(fixture), compute_clamp_shares(fixture), strict=True)
    ]
    return [
        order,
        f"Forces are stated for {' and '.join(each)} of the clamp force, which is the sum of both clamps.",
    ]


def tabulate_faces(workpiece: Workpiece, unit: Unit = MILLIMETRE) -> Table:
    """Return a table of the numbered faces of a part; lengths are shown in ``unit``.

    The column of ends is left out where there is little room, as a face ends where the next one begins.
    """
    table = Table((">face", "kind", f"size {unit.abbreviation}", "loop", "from", "to"), spare=1)
    loop_of, pieces = list[str](), workpiece.pieces
    for index, loop in enumerate(workpiece.loops):
        outer = f"piece {index + 1}" if pieces > 1 else "outer"
        loop_of += [outer if index < pieces else f"hole {index - pieces + 1}"] * len(loop)
    for face in workpiece.faces:
        kind, size, start, end = describe_face(face, unit)
        table.add_row(str(face.number), kind, size, loop_of[face.number], start, end)
    return table


def explain_missing_face_numbers(workpiece: Workpiece) -> list[str]:
    """Return a sentence on why some numbers are not in the table of faces; [] where none is missing."""
    further = [str(number) for face in workpiece.faces for number in face.segments if number != face.number]
    if not further:
        return []
    shown = ", ".join(further[:MOST_FURTHER]) + (" and more" if len(further) > MOST_FURTHER else "")
    one = len(further) == 1
    return [
        f"No face has the number {shown}: {'that is a further piece' if one else 'these are further pieces'} "
        "of a face drawn in pieces, such as a circle in two halves, and a face has the number of its first "
        "piece."
    ]


def describe_face(face: Face, unit: Unit) -> tuple[str, str, str, str]:
    """Return kind, size, start and end of a face as text, lengths in a unit."""
    from workhold.geometry.segment import Arc

    segment = face.segment
    start, end = format_place(segment.start, unit), format_place(segment.end, unit)
    if not isinstance(segment, Arc):
        length = hypot(segment.end[0] - segment.start[0], segment.end[1] - segment.start[1])
        return "line", f"length {unit.format_number(length)}", start, end
    kind = "arc, convex" if segment.sign > 0 else "arc, concave"
    radius = unit.format_number(segment.radius)
    if segment.half_sweep > pi - 1e-9:
        return kind, f"radius {radius}, full circle", f"about {format_place(segment.center, unit)}", ""
    return kind, f"radius {radius}, sweep {degrees(2 * segment.half_sweep):.2f} deg", start, end


def format_place(point: tuple[float, float], unit: Unit) -> str:
    """Return a point (x, y) in mm as numbers in the unit, without its abbreviation, such as "(1.00, 2.00)"."""
    return f"({unit.format_number(point[0])}, {unit.format_number(point[1])})"


def tabulate_solids(solids: Sequence[FileSolid], unit: Unit) -> Table:
    """Return a table of the solids in a STEP file."""
    short, named = unit.abbreviation, any(solid.name for solid in solids)
    table = Table((">solid", *(("name",) if named else ()), f"size {short}", "lowest corner"))
    for solid in solids:
        size = " x ".join(unit.format_number(length) for length in solid.size)
        corner = ", ".join(unit.format_number(value) for value in solid.low)
        table.add_row(str(solid.number), *((solid.name,) if named else ()), size, f"({corner})")
    return table


def tabulate_face_heights(workpiece: Workpiece, unit: Unit) -> list[Table]:
    """Return a table of the heights at which each face is touched; [] for a part without heights."""
    solid = workpiece.solid
    if solid is None:
        return []
    table = Table((">face", f"touched at heights {unit.abbreviation}", "faces of the solid"))
    for face in workpiece.faces:
        band = solid.bands[face.number]
        words = "never" if band is None else " to ".join(unit.format_number(end) for end in band)
        over = sorted({number for k in face.segments for number in (solid.faces[k] if solid.faces else ())})
        table.add_row(str(face.number), words, ", ".join(str(number) for number in over))
    return [table]


def tabulate_peg_heights(rows: Sequence[HeightRow], unit: Unit) -> list[Table]:
    """Return a table of the outlines that pegs of other heights meet; [] where other heights were not tried."""
    if not rows:
        return []
    names = ("pegs above", "up to", "outline", "touchable", "least band")
    table = Table(tuple(f">{name} {unit.abbreviation}" for name in names))
    for row in rows:
        lengths = (row.low, row.high, row.border, row.touchable, row.band)
        table.add_row(*(unit.format_number(length) for length in lengths))
    return [table]


def touches_parallel_faces_only(workpiece: Workpiece) -> bool:
    """Return whether all faces of a solid that pegs can
    touch are flat and parallel, and there is at least one.
    """
    from workhold.geometry.segment import are_parallel_lines

    assert workpiece.solid is not None
    bands, every = workpiece.solid.bands, workpiece.numbered.faces
    touched = (face for face in every if any(bands[k] is not None for k in face.segments))
    return are_parallel_lines(face.segment for face in touched)


def explain_sliding_part(workpiece: Workpiece, rows: Sequence[HeightRow]) -> list[str]:
    """Return advice for a solid that slides along all faces that pegs of any height touch; [] for other
    parts.
    """
    if workpiece.solid is None or not touches_parallel_faces_only(workpiece):
        return []
    if any(row.touchable > 0 and not row.slides for row in rows):
        return []
    return [
        "Pegs of any height can touch only flat faces that are parallel to one another, such as "
        "the ends and shoulders of a shaft that lies. Nothing keeps the part from sliding along "
        "them, in this or any other toolkit. Pegs do not touch round sides that lie: hold the "
        "part in vee blocks or soft jaws with its end against a work stop, or turn another side "
        "up (--axis)."
    ]


def suggest_other_heights(workpiece: Workpiece, rows: Sequence[HeightRow], unit: Unit) -> list[str]:
    """Return sentences on remedies where pegs of this height cannot hold a solid: other heights, or another
    side up.

    ``rows`` are the outlines at other heights; those with more to touch are named first. The list is empty
    for a part without a solid.
    """
    solid = workpiece.solid
    if solid is None:
        return []
    if said := explain_sliding_part(workpiece, rows):
        return said
    slides = touches_parallel_faces_only(workpiece)
    others = [
        row
        for row in rows
        if not row.low < solid.peg_height <= row.high and row.touchable > 0 and not (slides and row.slides)
    ]
    longest = sorted(others, key=lambda row: (-row.touchable, -row.high))[:MOST_NAMED]
    named = [f"--peg-height {unit.format_number(row.high)}" for row in longest]
    turned = flip_up_axis(solid.axis)
    offers = f"its other side up (--axis={turned}): workhold features shows what pegs can touch in each."
    if not named:
        return [f"This may help: {offers}"]
    return [f"Another outline may help, that of {', '.join(named)}, or {offers}"]
