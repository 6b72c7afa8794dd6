"""The contents of a setup sheet besides the fixture: its details, caliper measurements, and cautions.

The details are paper, unit, names, dates, and the effect of the loads.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date
from math import dist, inf
from typing import Any

from attrs import evolve, field, frozen

from workhold.asking.sheet import SheetQuestion
from workhold.drawing.hold_cautions import list_hold_cautions
from workhold.drawing.scene import LengthUnit
from workhold.drawing.seating_words import SeatingSentences, capitalize_sentence
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.bodies import SUPPORT_HEIGHT
from workhold.model.first_side import FirstSide
from workhold.model.fixture import Fixture
from workhold.model.moved_setup import find_move_to_middle, move_fixture_by_holes, move_to
from workhold.model.part_bending import BendingFigures
from workhold.model.program import Program
from workhold.model.requirements import Load, Tolerance
from workhold.model.result import Result
from workhold.model.seating import Seating
from workhold.model.setup import PartZero, choose_part_zero
from workhold.model.support_bodies import find_support_height
from workhold.model.support_triples import ChosenSupports
from workhold.model.workpiece import Workpiece
from workhold.seating.clamping import HandLoading, plan_hand_loading
from workhold.statics.bent_pegs import BentPegs, compute_bent_pegs
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.statics.judging import is_astray, is_near_edge, is_strong, is_unfit, is_weak, lets_go
from workhold.statics.loads import LoadCase, compute_load_cases
from workhold.statics.program_clearance import ToolClearance, find_nearest_passing
from workhold.statics.program_forces import CuttingNeed, find_cutting_need
from workhold.statics.why_first import explain_why_first
from workhold.units import MILLIMETRE, Unit
from workhold.version import __version__

__all__ = [
    "PAPERS",
    "Caution",
    "SheetDetails",
    "choose_caliper_check",
    "list_cautions",
    "measure_edge_distances",
    "find_part_lift",
    "find_shift_on_plate",
    "list_result_cautions",
    "collect_sheet_details",
]

# Width and height in mm, upright: ISO 216 and ANSI/ASME Y14.1.
# What of the question stands on the sheet as it was asked for.
AS_ASKED = ("paper", "part_name", "machine_position", "peg_length", "dowel", "plate_thickness")
PAPERS = {"a4": (210.0, 297.0), "letter": (215.9, 279.4)}


@frozen
class SheetDetails:
    """Everything on a setup sheet that does not follow from the fixture.

    Parameters
    ----------
    number, count : the fixture's rank in its result, and the number of fixtures listed there.
    day : the date written on the sheet.
    result_hash : SHA-256 of the result file in hexadecimal; empty for a result without a file.
    version : of the program.
    paper : "a4" or "letter"; None is letter for lengths in inches, else A4.
    unit : of lengths.
    part_name : written instead of the workpiece's own name; None for that name.
    tolerance : tolerances of pegs and faces, for which the location error is computed.
    jaw_force : jaw force in N; None if not given.
    friction : coefficient of friction that was asked for with the loads.
    loads : loads on the part, and the peg forces under each.
    zero : part zero; the drawing's origin if None.
    machine_position : place, in mm in the machine's own coordinates, of the hole that places are measured
        from; None when not known.
    thickness : of the part, in mm. This and the next two are None where they are to be written on the paper
        by hand.
    peg_length, peg_height : length of the pegs, and how far they stand out of the jaws, in mm.
    dowel : the pegs and their fit in the user's words; None takes the words of the tolerance.
    others : number of other fixtures of the result that use the same holes.
    why_first : why this is the first choice, in a sentence; empty for others.
    seating : other places in which the pegs can hold the part; None where the sheet does not show them.
    by_hand : how the part is put between two clamps; None where the sheet does not show it.
    not_seated : why there is no seating though it was asked for, in a sentence.
    supports : three supports under the part and a clamp on top; None where there are none.
    support_height : of these supports, in mm; None where it is not given.
    plate_thickness : of the plates that pegs stand through, in mm; None where it is not given.
    first_side : the set-up before this one, in which another side of the part was up; None where there was
        none.
    program : what the machine does while the part is held; None without a program.
    passing : where its tools come nearest to what holds the part; None where that is not known.
    cutting : the jaw force that the program's tools ask for; None where their forces are not known.
    bending : how far clamping bends the part; None where it was not asked for. Figures without a mesh have no
        picture.
    bend : largest bending or movement of the part in mm without a caution.
    bent : how far the pegs bend; None where it is not known how high they press.
    listed_as : noun of what ``number`` counts.
    moved : (columns, rows) by which the set-up is moved from where the fixture is listed.
    is_asked_place : whether the place on the plate was asked for.
    """

    number: int
    count: int
    day: date
    result_hash: str
    version: str
    paper: str | None = None
    unit: Unit = MILLIMETRE
    part_name: str | None = None
    tolerance: Tolerance = field(factory=Tolerance)
    jaw_force: float | None = None
    friction: float | None = None
    loads: tuple[LoadCase, ...] = ()
    zero: PartZero | None = None
    machine_position: tuple[float, float] | None = None
    thickness: float | None = None
    peg_length: float | None = None
    peg_height: float | None = None
    dowel: str | None = None
    others: int = 0
    why_first: str = ""
    seating: Seating | None = None
    by_hand: HandLoading | None = None
    not_seated: str = ""
    supports: ChosenSupports | None = None
    support_height: float | None = None
    plate_thickness: float | None = None
    first_side: FirstSide | None = None
    program: Program | None = None
    passing: ToolClearance | None = None
    cutting: CuttingNeed | None = None
    bending: BendingFigures | None = None
    bend: float | None = None
    bent: BentPegs | None = None
    listed_as: str = "Fixture"
    moved: tuple[int, int] = (0, 0)
    is_asked_place: bool = False

    @property
    def paper_size(self) -> str:
        """The key of the paper, "a4" or "letter".

        It is the paper asked for; if none is, "letter" for lengths in inches and "a4" for mm.
        """
        return self.paper or ("letter" if self.unit.force == "lbf" else "a4")


# Two zeros this near to each other, in mm, are one.
ZERO_OFF = 0.001
UNFIT = (
    "No workshop can use this fixture: the part may lie anywhere, or one peg hardly holds. Choose another."
)


@frozen
class Caution:
    """A caution of a setup sheet.

    Parameters
    ----------
    kind : "unfit", "zero", "edge", "closure", "amplification", "location", "bending", "load", "capture",
        "reading" or "pose".
    sentence : for people; lengths in it are in mm or inch as asked for.
    """

    kind: str
    sentence: str


@frozen
class CaliperCheck:
    """Two holes whose distance gives the jaw opening.

    Parameters
    ----------
    left, right : (column, row) of a hole on the first carrier, and of a hole on the other.
    distance : between their centres, in mm.
    placed : number of the two holes with a peg of the fixture.
    """

    left: tuple[int, int]
    right: tuple[int, int]
    distance: float
    placed: int


def choose_caliper_check(fixture: Fixture, toolkit: Toolkit) -> CaliperCheck:
    """Return the pair of holes between which to measure the opening.

    One is in the first carrier's last column and one in the other carrier's first, which face each other. The
    holes are as level as possible, so that calipers square to the plates span them. Among equally level
    pairs, those with most pegs of the fixture come first, then those in the lowest rows.
    """
    first, second = toolkit.carriers
    rows = sorted({peg.row for peg in fixture.pegs})
    used = {(peg.carrier, peg.column, peg.row) for peg in fixture.pegs}
    last, travelled = first.column_count - 1, fixture.travel
    shift = round((second.offset[1] - first.offset[1]) / first.pitch[1])
    best: tuple[float, int, int, int] | None = None
    for low, high in {
        (row + a, row + a + b - shift) for row in [*rows, 0] for a in (-1, 0, 1) for b in (-1, 0, 1)
    }:
        if min(low, high) < 0 or (first.rows is not None and max(low, high) >= first.rows):
            continue
        if first.is_blocked(last, low) or second.is_blocked(0, high):
            continue
        tilt = abs(second.compute_hole_center(0, high)[1] - first.compute_hole_center(last, low)[1])
        placed = ((first.name, last, low) in used) + ((second.name, 0, high) in used)
        key = (round(tilt, 9), -placed, low, high)
        best = key if best is None else min(best, key)
    _, placed, low, high = best or (0.0, 0, rows[0], rows[0])
    distance = dist(first.compute_hole_center(last, low), second.compute_hole_center(0, high, travelled))
    return CaliperCheck((last, low), (0, high), distance, -placed)


def measure_edge_distances(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> list[float]:
    """Return for each peg the distance in mm along the touched face from its centre to the nearer edge.

    An edge ends the peg's path along the face. The distance is inf where there is none (a whole circle,
    tangent joints).
    """
    return [
        float(edge)
        for edge in TouchableFeatures.from_workpiece(workpiece, toolkit)
        .compute_for_fixture(fixture, toolkit)
        .edges[0]
    ]


def list_cautions(
    fixture: Fixture, toolkit: Toolkit, distances: Sequence[float], details: SheetDetails, lengths: LengthUnit
) -> list[Caution]:
    """Return the cautions of a fixture, in this order: unfit, program zero, contacts, forces, bending, loads,
    seating.

    ``distances`` are those of :func:`measure_edge_distances`. If the seating is not known, the last caution
    is instead about other fixtures in the same holes.
    """
    found: list[Caution] = []
    margin, error = fixture.quality.get("closure_margin", inf), fixture.quality.get("location_error", 0.0)
    off = details.tolerance.peg + details.tolerance.face
    if is_unfit(margin, error, off):
        found.append(Caution("unfit", UNFIT))
    program, zero = details.program, details.zero
    if program is not None and zero is not None and dist(zero.point, program.zero) > ZERO_OFF:
        x, y = (lengths.format_number(value) for value in program.zero)
        words = (
            f"The program's X0 Y0 is at x {x}, y {y} {lengths.sign} of the drawing, and this sheet's "
            "is elsewhere"
        )
        found.append(
            Caution("zero", f"{words}: set the machine's zero at the program's, or post the program again.")
        )
    for peg, distance in zip(fixture.pegs, distances, strict=True):
        if is_near_edge(distance):
            place = f"{peg.hole} touches {peg.touching} only {lengths.format_length(distance)} from its end"
            found.append(Caution("edge", f"{place}: a burr or a broken edge there shifts the part."))
    if is_weak(margin):
        weakest = min(fixture.pegs, key=lambda peg: peg.force)
        words = (
            f"{weakest.hole} has only {margin:.2%} of the hold (an even share is {100 // len(fixture.pegs)}%)"
        )
        found.append(Caution("closure", f"Weak closure: {words}."))
    largest = max(fixture.pegs, key=lambda peg: peg.force)
    if is_strong(largest.force):
        alone, moving = len(fixture.travels) == 1, toolkit.moving
        pushers = f"the {moving.pushers}" if alone else f"both {moving.noun}s together"
        words = f"{largest.hole} pushes {largest.force:.1f} times as hard as {pushers}: tighten gently"
        found.append(Caution("amplification", f"{words}, because it may mark {largest.touching}."))
    if is_astray(error, off):
        words = f"Pegs and faces within tolerance may still shift the part by {lengths.format_length(error)}"
        found.append(Caution("location", f"{words}: probe it after clamping."))
    if details.bent is not None:
        of_pegs = details.bent.list_cautions(toolkit.moving.noun, lengths.unit)
        found += [Caution("bending", one) for one in of_pegs]
    if details.jaw_force is not None:
        lifting = [
            (n, case)
            for n, case in enumerate(details.loads, 1)
            if lets_go(case.needed.value, details.jaw_force)
        ]
        for number, case in sorted(lifting, key=lambda pair: -pair[1].needed.value)[:1]:
            name, peg = case.load.name or f"load {number}", fixture.pegs[case.needed.peg]
            more = lengths.unit.format_force_rounded_up(case.needed.value)
            words = f"Under {name}, {peg.hole} lets go at the {lengths.unit.format_force(details.jaw_force)} given"
            found.append(Caution("load", f"{words}: clamp with more than {more} {lengths.unit.force}."))
    if details.cutting is not None and (details.cutting.room or 0.0) < 0.0:
        sentences = details.cutting.list_sentences(toolkit.moving.noun, lengths.unit, len(fixture.travels))
        found.append(Caution("load", " ".join(sentences[:2])))
    if details.seating is not None:
        seated = SeatingSentences(details.seating, fixture, toolkit, lengths)
        return found + [Caution(kind, sentence) for kind, sentence in seated.list_cautions()]
    if details.others:
        holes = "holes" if toolkit.tip_count else "four holes"
        ways = "one other way" if details.others == 1 else f"{details.others} other ways"
        found.append(
            Caution(
                "pose",
                f"The same {holes} hold this part in {ways}: check the angle and the faces.",
            )
        )
    return found


def find_shift_on_plate(fixture: Fixture, result: Result, at: str | None) -> tuple[int, int]:
    """Return (columns, rows) by which a fixture is moved on its plate from its listed place.

    It is moved to the hole ``at``, or if that is None to the plate's middle.
    """
    if at is None:
        return find_move_to_middle(fixture, result.toolkit, result.workpiece)
    return move_to(fixture, result.toolkit, at)


def find_part_lift(supports: ChosenSupports | None, support_height: float | None) -> float:
    """Return the height in mm of the part's lower side above the plates: that of its supports, or 0 without
    supports.
    """
    if supports is None:
        return 0.0
    own = find_support_height(supports.supports.query.toolkit) if support_height is None else support_height
    return SUPPORT_HEIGHT if own is None else own


def find_pressed_height(
    thickness: float | None, peg_height: float | None, supports: ChosenSupports | None, lift: float
) -> float | None:
    """Return the height in mm, above the part's lower side, up to which pegs press on a prism; None if
    unknown.

    It is the smaller of two heights, either of which may be unknown: the part's thickness (if None, the
    thickness in the request for supports), and ``peg_height``, measured from the plates, minus ``lift``.
    """
    if thickness is None and supports is not None:
        thickness = supports.supports.request.thickness
    known = [one for one in (thickness, None if peg_height is None else peg_height - lift) if one is not None]
    return max(min(known), 0.0) if known else None


def choose_zero_to_set(
    program: Program | None, workpiece: Workpiece, question: SheetQuestion, unit: Unit
) -> PartZero:
    """Return the part zero to set at the machine.

    It is the requested one, else that of the program, else the usual one.
    """
    if program is not None and question.zero is None:
        return PartZero(program.zero, "place given" if any(program.zero) else "origin of the drawing")
    return choose_part_zero(workpiece, question.zero, unit)


def collect_hold_details(
    result: Result,
    rank: int,
    question: SheetQuestion,
    result_hash: str,
    unit: Unit,
    number: int | None,
    count: int | None,
    listed_as: str,
) -> tuple[Fixture, SheetDetails]:
    """Return (fixture, details of its setup sheet) for the fixture with this rank, from 1, in which friction
    holds the part.

    The details are without those of pegs.
    """
    query = result.query
    details = SheetDetails(
        number=rank if number is None else number,
        count=len(result) if count is None else count,
        day=date.min if question.day is None else question.day,
        result_hash=result_hash,
        version=__version__,
        unit=unit,
        zero=choose_zero_to_set(query.program, result.workpiece, question, unit),
        program=query.program,
        thickness=query.part_height,
        listed_as=listed_as,
        **{name: getattr(question, name) for name in AS_ASKED},
    )
    return result[rank - 1], details


def list_result_cautions(result: Result, rank: int, **asked: Any) -> list[Caution]:
    """Return the cautions of the setup sheet of the fixture with this rank.

    Arguments are those of :func:`collect_sheet_details`.
    """
    fixture, details = collect_sheet_details(result, rank, **asked)
    if fixture.hold is not None:
        return [Caution(kind, words) for kind, words in list_hold_cautions(fixture)]
    pitch = min(min(carrier.pitch) for carrier in result.toolkit.carriers)
    lengths = LengthUnit.from_typical_length(details.unit, pitch)
    distances = measure_edge_distances(fixture, result.workpiece, result.toolkit)
    return list_cautions(fixture, result.toolkit, distances, details, lengths)


def collect_sheet_details(
    result: Result,
    rank: int,
    *,
    result_hash: str = "",
    unit: Unit = MILLIMETRE,
    loads: Sequence[Load] | None = None,
    others: int | None = None,
    number: int | None = None,
    count: int | None = None,
    supports: ChosenSupports | None = None,
    first_side: FirstSide | None = None,
    listed_as: str = "Fixture",
    bending: BendingFigures | None = None,
    **asked: Any,
) -> tuple[Fixture, SheetDetails]:
    """Return (fixture with all its figures of quality, details of its setup sheet).

    Parameters
    ----------
    rank : of the fixture, from 1.
    loads : loads used instead of the result's; None for the result's.
    others : number of other fixtures in the same holes; None to count them in the result.
    number, count : for a fixture taken out of a larger result, its rank there and the number of fixtures
        listed there.
    supports : see :class:`SheetDetails`. The sheet then shows the fixture of the supports, moved so that all
        its holes have names.
    result_hash, unit, first_side, listed_as, bending : see :class:`SheetDetails`.
    asked : the fields of a :class:`workhold.asking.sheet.SheetQuestion`.

    Raises
    ------
    InputError
        For an impossible jaw force, coefficient of friction, part zero or place on the plate.
    """
    from workhold.seating.solver import SeatingSolver
    from workhold.statics.quality import measure_fixture

    question = SheetQuestion(**asked)
    if result.toolkit.holds_by_friction:
        held, details = collect_hold_details(
            result, rank, question, result_hash, unit, number, count, listed_as
        )
        return held, evolve(details, bending=bending, bend=question.bend)
    at, jaw, friction, seating = question.at, question.jaw, question.friction, question.seating
    peg_height, support_height = question.peg_height, question.support_height
    loads = result.query.loads if loads is None else loads
    jaw_force = result.query.jaw_force if question.jaw_force is None else question.jaw_force
    fixture = measure_fixture(result, rank - 1, loads, jaw_force)
    workpiece, toolkit = result.workpiece, result.toolkit
    known, not_seated = result[rank - 1].seating if seating is not False else None, ""
    if supports is not None and at is not None:
        supports = supports.move_to_hole(at)
    move = find_shift_on_plate(fixture, result, at) if supports is None else supports.recounted.move
    placed = move_fixture_by_holes(fixture, toolkit, move) if supports is None else supports.recounted.fixture
    if placed.pegs != fixture.pegs:
        # The readings of its seats would be those of other holes.
        seating, known = seating or known is not None, None
        fixture = evolve(placed, quality=fixture.quality)
    if seating is None and not toolkit.closes_at_once:
        seating = rank <= (result.query.seating or 0)
    put_in = None if not seating or toolkit.closes_at_once else plan_hand_loading(fixture, workpiece, toolkit)
    if seating and known is None and put_in is None:
        try:
            known = SeatingSolver(workpiece, toolkit).solve(fixture)
        except InputError as error:
            not_seated = capitalize_sentence(str(error))
    program, reach = result.query.program, result.query.peg_height
    if peg_height is None and reach is not None:
        # The query's height is above where the part lies, the sheet's above the plates.
        peg_height = reach + find_part_lift(supports, support_height)
    cutting, passing = (
        find_cutting_need(result, rank - 1, jaw_force, jaw),
        find_nearest_passing(result, rank - 1),
    )
    named = [peg.hole for peg in result[rank - 1].pegs], [peg.hole for peg in fixture.pegs]
    if cutting is not None:
        cutting = cutting.rename_holes(*named)
    if passing is not None:
        passing = passing.rename_holes(*named)
    cases = compute_load_cases(fixture, workpiece, toolkit, loads, jaw_force, friction, jaw)
    thickness = question.thickness or result.query.thickness
    lift = find_part_lift(supports, support_height)
    bent = compute_bent_pegs(
        fixture,
        workpiece,
        toolkit,
        pressed_top=find_pressed_height(thickness, peg_height, supports, lift),
        jaw_force=jaw_force,
        lift=lift,
    )
    details = SheetDetails(
        number=rank if number is None else number,
        count=len(result) if count is None else count,
        day=date.min if question.day is None else question.day,
        result_hash=result_hash,
        version=__version__,
        unit=unit,
        tolerance=result.query.tolerance,
        jaw_force=jaw_force,
        friction=friction,
        loads=cases,
        zero=choose_zero_to_set(program, workpiece, question, unit),
        peg_height=peg_height,
        others=result.table.count_in_same_holes(rank - 1) if others is None else others,
        why_first=explain_why_first(result, unit) if rank == (number or 1) == 1 else "",
        seating=known,
        by_hand=put_in,
        not_seated=not_seated,
        supports=supports,
        support_height=support_height,
        program=program,
        passing=passing,
        cutting=cutting,
        moved=move,
        is_asked_place=at is not None,
        bending=bending,
        bend=question.bend,
        bent=bent,
        thickness=thickness,
        first_side=first_side,
        listed_as=listed_as,
        **{name: getattr(question, name) for name in AS_ASKED},
    )
    return fixture, details
